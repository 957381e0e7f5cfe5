//! The parts of lines on the ground that are on the picture, and places along them.

use egui::{FontId, Pos2, Rect};
use glam::{Vec2, Vec3};

use crate::window_point::window_point;
use sandtable_view::camera::Camera;

/// Measures letters in points: the width of each, and the height of all.
pub type LetterWidths<'a> = &'a dyn Fn(&[String], &FontId) -> (Vec<f32>, f32);

/// The picture that names are placed on.
pub struct LinePicture<'a> {
    /// How it is seen.
    pub camera: &'a Camera,
    /// Where it is, in points of the window.
    pub rect: Rect,
    /// What names leave free.
    pub taken: &'a [Rect],
    /// Whether a place in world space is in sight.
    pub is_seen: &'a dyn Fn(Vec3) -> bool,
    /// The widths of letters, and their height, in points.
    pub widths: LetterWidths<'a>,
}

/// A vertex of a line on the picture.
#[derive(Clone, Copy, Debug)]
pub struct NamePoint {
    /// On the window, points.
    pub at: Vec2,
    /// On the ground.
    pub world: Vec3,
    /// Along the line on the ground, meters.
    pub station_m: f32,
    /// Along the piece on the picture, points.
    pub along: f32,
}

/// The parts of a line that are on the picture, the longest first. They end at its border, wherever that cuts them: what is
/// set along them does not leap when a vertex leaves the picture.
pub fn pieces(line: &[Vec3], picture: &LinePicture<'_>) -> Vec<Vec<NamePoint>> {
    let (camera, rect) = (picture.camera, picture.rect);
    let on_window = |world: Vec3| {
        let (at, _) = window_point(camera, rect, world)?;
        Some(Vec2::new(at.x, at.y))
    };
    let is_inside = |at: Vec2| rect.contains(Pos2::new(at.x, at.y));
    let (mut found, mut open): (Vec<Vec<NamePoint>>, Vec<NamePoint>) = (Vec::new(), Vec::new());
    let mut station_m = 0.0;
    let mut before: Option<NamePoint> = None;
    for (index, &world) in line.iter().enumerate() {
        station_m += index.checked_sub(1).map_or(0.0, |before| line[before].distance(world));
        let here = on_window(world).map(|at| NamePoint { at, world, station_m, along: 0.0 });
        let leg =
            before.zip(here).and_then(|(from, to)| Some((from, to, shares_within(from.at, to.at, rect)?)));
        if let Some((from, to, [enters, leaves])) = leg {
            if enters > 0.0 {
                found.push(std::mem::take(&mut open));
                push(&mut open, from.toward(&to, enters));
            }
            if leaves < 1.0 {
                push(&mut open, from.toward(&to, leaves));
                found.push(std::mem::take(&mut open));
            }
        }
        match here.filter(|here| is_inside(here.at)) {
            Some(here) => push(&mut open, here),
            None => found.push(std::mem::take(&mut open)),
        }
        before = here;
    }
    found.push(open);
    found.retain(|piece| piece.len() >= 2);
    found.sort_by(|a, b| b[b.len() - 1].along.total_cmp(&a[a.len() - 1].along));
    found
}

fn push(piece: &mut Vec<NamePoint>, point: NamePoint) {
    let along = piece.last().map_or(0.0, |last| last.along + last.at.distance(point.at));
    piece.push(NamePoint { along, ..point });
}

/// The shares of a leg between which it lies in a rectangle; `None` where it does not (Liang and Barsky 1984).
fn shares_within(from: Vec2, to: Vec2, rect: Rect) -> Option<[f32; 2]> {
    let way = to - from;
    let (mut enters, mut leaves) = (0.0f32, 1.0f32);
    for (at, along, low, high) in
        [(from.x, way.x, rect.min.x, rect.max.x), (from.y, way.y, rect.min.y, rect.max.y)]
    {
        if along == 0.0 {
            if at < low || at > high {
                return None;
            }
            continue;
        }
        let (first, last) = ((low - at) / along, (high - at) / along);
        (enters, leaves) = (enters.max(first.min(last)), leaves.min(first.max(last)));
    }
    (enters < leaves).then_some([enters, leaves])
}

impl NamePoint {
    /// The point at a share of the way to another.
    fn toward(&self, to: &Self, share: f32) -> Self {
        Self {
            at: self.at.lerp(to.at, share),
            world: self.world.lerp(to.world, share),
            station_m: self.station_m + (to.station_m - self.station_m) * share,
            along: 0.0,
        }
    }
}

/// The position along a piece of a station on the ground; `None` where the piece lacks it.
pub fn along_at(piece: &[NamePoint], station_m: f32) -> Option<f32> {
    let after = piece.partition_point(|point| point.station_m < station_m);
    let (from, to) = (piece.get(after.checked_sub(1)?)?, piece.get(after)?);
    let share = (station_m - from.station_m) / (to.station_m - from.station_m).max(1e-6);
    Some(from.along + (to.along - from.along) * share)
}

/// The place on the picture, on the ground, and the station of a length along a piece.
pub fn point_at(piece: &[NamePoint], along: f32) -> (Vec2, Vec3, f32) {
    let after = piece.partition_point(|point| point.along < along).clamp(1, piece.len() - 1);
    let (from, to) = (piece[after - 1], piece[after]);
    let share = ((along - from.along) / (to.along - from.along).max(1e-6)).clamp(0.0, 1.0);
    let station_m = from.station_m + (to.station_m - from.station_m) * share;
    (from.at.lerp(to.at, share), from.world.lerp(to.world, share), station_m)
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use egui::pos2;

    /// A piece through points of the window, ten meters a point.
    pub fn piece(points: &[(f32, f32)]) -> Vec<NamePoint> {
        let mut piece: Vec<NamePoint> = Vec::new();
        for &(x, y) in points {
            let at = Vec2::new(x, y);
            let along = piece.last().map_or(0.0, |last| last.along + last.at.distance(at));
            piece.push(NamePoint { at, world: at.extend(0.0), station_m: along * 10.0, along });
        }
        piece
    }

    #[test]
    fn a_place_on_the_ground_is_found_again_on_the_picture() {
        let piece = piece(&[(0.0, 0.0), (30.0, 40.0), (60.0, 40.0)]);
        let (at, world, station_m) = point_at(&piece, 65.0);
        assert_eq!((at, station_m), (Vec2::new(45.0, 40.0), 650.0));
        assert_eq!(world, at.extend(0.0));
        assert_eq!(along_at(&piece, 650.0), Some(65.0));
        assert_eq!(along_at(&piece, 900.0), None);
    }

    #[test]
    fn pieces_end_at_the_border_of_the_picture() {
        // Straight down on ground at Z 0: a point of the window is a meter there.
        let camera = Camera::new(
            Vec3::new(0.0, 0.0, 100.0),
            Vec3::new(0.0, 1e-4, 0.0),
            2.0 * 1f32.atan(),
            (200, 200),
            (1.0, 1e3),
        );
        let camera = camera.expect("sound");
        let rect = Rect::from_min_max(pos2(0.0, 0.0), pos2(200.0, 200.0));
        let picture = LinePicture {
            camera: &camera,
            rect,
            taken: &[],
            is_seen: &|_| true,
            widths: &|_, _| (Vec::new(), 0.0),
        };
        let line = [(-300.0, 0.0), (300.0, 0.0), (300.0, 50.0), (0.0, 50.0), (0.0, 60.0)];
        let line: Vec<Vec3> = line.iter().map(|&(x, y)| Vec3::new(x, y, 0.0)).collect();
        let found = pieces(&line, &picture);
        let lengths: Vec<f32> = found.iter().map(|piece| piece[piece.len() - 1].along.round()).collect();
        assert_eq!(lengths, [200.0, 110.0], "{found:?}");
        let stations: Vec<f32> = found[0].iter().map(|point| point.station_m.round()).collect();
        assert_eq!(stations, [200.0, 400.0]);
        assert!(pieces(&line[1..3], &picture).is_empty(), "beside the picture");
    }
}
