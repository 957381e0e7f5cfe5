//! The contour lines of a picture, traced on it: what may carry a number, and which lines go round hollows.
//!
//! The ground's shader draws contours pixel by pixel; nothing knows them as lines. Here the elevations of the ground that
//! the picture shows are read at every few pixels, from the map that the lines are drawn by, and traced, so that a line ends
//! where a hill hides it, and the work is that of the picture, not of the ground.

use glam::Vec2;
use rayon::prelude::*;

use crate::shown_elevation::shown_elevation_m;
use sandtable_annotate::annotation::{ContourMarks, NumberedContour};
use sandtable_annotate::nice::format_number;
use sandtable_draw::list::DrawList;
use sandtable_geom::isolines::{Isoline, ValueGrid, isolines};
use sandtable_render::picture::Rendering;
use sandtable_scene::scene_model::SceneModel;
use sandtable_view::camera::Camera;

/// The rows of elevations read from a picture: on fewer, lines leave the drawn ones; on more, time is spent.
const ROWS: usize = 180;
/// The least distance of the elevations read, in pixels.
const LEAST_STEP: usize = 3;
/// Depths of neighboring pixels that differ by more than this share belong to two hills.
const SAME_HILL: f32 = 0.06;
/// Numbered lines closer than this are not traced: they run together. Lines in a cell.
const MOST_IN_CELL: usize = 1;
/// Lines round hollows are drawn with a tick every so many pixels, of so many pixels.
const TICK_EVERY_PX: f32 = 22.0;
const TICK_PX: f32 = 5.0;
/// Hollows narrower than this have no ticks, in pixels.
const LEAST_HOLLOW_PX: f32 = 14.0;

/// The marks of the scene's contour lines; `None` where it has none.
pub fn contour_marks(
    scene: &SceneModel,
    list: &DrawList,
    camera: &Camera,
    picture: &Rendering,
) -> Option<ContourMarks> {
    let contours = scene.contours.filter(|contours| contours.interval_m > 0.0)?;
    let read = ReadGround::new(list, camera, picture);
    let numbered_m = contours.interval_m * contours.major_every.max(1) as f32;
    let grid = ValueGrid { columns: read.columns, values: &read.elevations_m };
    let is_open = |column: usize, row: usize| read.is_one_hill(column, row);
    let lines = |interval_m: f32| isolines(&grid, interval_m, MOST_IN_CELL, is_open);
    let (numbered, all) = rayon::join(|| lines(numbered_m), || lines(contours.interval_m));
    let hollows = all.iter().filter(|line| line.is_closed() && is_hollow(line));
    Some(ContourMarks {
        numbered: numbered.iter().map(|line| read.numbered(line, numbered_m)).collect(),
        ticks: hollows.flat_map(|line| ticks(&read.on_picture(line))).collect(),
        color: contours.color,
    })
}

/// Elevations of the bare ground at every few pixels.
struct ReadGround {
    columns: usize,
    step: usize,
    /// Meters; NaN where the picture shows something else.
    elevations_m: Vec<f32>,
    depths_m: Vec<f32>,
}

impl ReadGround {
    fn new(list: &DrawList, camera: &Camera, picture: &Rendering) -> Self {
        let (width, height) = (picture.pixels.width() as usize, picture.pixels.height() as usize);
        let step = (height / ROWS).max(LEAST_STEP);
        let (columns, rows) = (width.div_ceil(step), height.div_ceil(step));
        let read = |index: usize| {
            let (x, y) = (index % columns * step, index / columns * step);
            let pixel = Vec2::new(x as f32 + 0.5, y as f32 + 0.5);
            let elevation_m = shown_elevation_m(list, camera, picture, pixel).unwrap_or(f32::NAN);
            (elevation_m, picture.depth_m[y * width + x])
        };
        let (elevations_m, depths_m) = (0..columns * rows).into_par_iter().map(read).unzip();
        Self { columns, step, elevations_m, depths_m }
    }

    /// Whether the corners of a cell are on one face of the ground.
    fn is_one_hill(&self, column: usize, row: usize) -> bool {
        let first = row * self.columns + column;
        let corners = [first, first + 1, first + self.columns, first + self.columns + 1];
        let depths = corners.map(|index| self.depths_m[index]);
        let (near, far) =
            depths.iter().fold((f32::MAX, 0.0f32), |(near, far), &at| (near.min(at), far.max(at)));
        far <= near * (1.0 + SAME_HILL)
    }

    fn on_picture(&self, line: &Isoline) -> Vec<Vec2> {
        line.points.iter().map(|at| at.as_vec2() * self.step as f32 + 0.5).collect()
    }

    fn numbered(&self, line: &Isoline, interval_m: f32) -> NumberedContour {
        let elevation = line.level as f64 * f64::from(interval_m);
        let decimals = (0..3).find(|&decimals| {
            let scaled = f64::from(interval_m) * 10f64.powi(decimals);
            (scaled - scaled.round()).abs() < 1e-4
        });
        NumberedContour {
            text: format_number(elevation, decimals.unwrap_or(2) as usize),
            level: line.level,
            path_px: self.on_picture(line),
        }
    }
}

/// Whether the higher ground is outside a ring: the ring has it on its left as seen on the picture, so it runs
/// counter-clockwise there round a summit and clockwise round a hollow.
fn is_hollow(ring: &Isoline) -> bool {
    let doubled: f64 = ring.points.windows(2).map(|leg| leg[0].perp_dot(leg[1])).sum();
    doubled > 0.0
}

/// Ticks from a ring round a hollow, inward.
fn ticks(ring: &[Vec2]) -> Vec<[Vec2; 2]> {
    let (min, max) =
        ring.iter().fold((Vec2::INFINITY, Vec2::NEG_INFINITY), |(min, max), at| (min.min(*at), max.max(*at)));
    if (max - min).min_element() < LEAST_HOLLOW_PX {
        return Vec::new();
    }
    let (mut walked, mut ticks) = (TICK_EVERY_PX * 0.5, Vec::new());
    for leg in ring.windows(2) {
        walked += leg[0].distance(leg[1]);
        if walked < TICK_EVERY_PX {
            continue;
        }
        walked = 0.0;
        // Lower ground is on the right.
        if let Some(along) = (leg[1] - leg[0]).try_normalize() {
            ticks.push([leg[1], leg[1] + Vec2::new(-along.y, along.x) * TICK_PX]);
        }
    }
    ticks
}

#[cfg(test)]
mod tests {
    use super::*;
    use sandtable_draw::ground::Contours;

    #[test]
    fn a_ring_round_a_hollow_has_ticks_inward_and_one_round_a_summit_is_none() {
        for sign in [1.0f32, -1.0] {
            let height = |n: usize| {
                let at = Vec2::new((n % 41) as f32 - 20.0, (n / 41) as f32 - 20.0);
                sign * (50.3 - at.length())
            };
            let values: Vec<f32> = (0..41 * 41).map(height).collect();
            let lines = isolines(&ValueGrid { columns: 41, values: &values }, 5.0, 3, |_, _| true);
            let rings: Vec<&Isoline> = lines.iter().filter(|line| line.is_closed()).collect();
            assert!(!rings.is_empty());
            for ring in rings {
                assert_eq!(is_hollow(ring), sign < 0.0);
                let path: Vec<Vec2> = ring.points.iter().map(|at| at.as_vec2() * 6.0).collect();
                if sign < 0.0 {
                    for [from, to] in ticks(&path) {
                        let center = Vec2::splat(120.0);
                        assert!(to.distance(center) < from.distance(center) - 3.0);
                    }
                }
            }
        }
    }

    #[test]
    fn intermediate_lines_are_gone_at_three_pixels_and_numbered_ones_are_not() {
        let contours = Contours {
            interval_m: 10.0,
            major_every: 5,
            color: sandtable_draw::color::Srgba::WHITE,
            width_px: 1.0,
            lit: None,
        };
        for spacing_px in [1.0, 2.0, 3.0] {
            assert_eq!(contours.strength(10.0, 10.0 / spacing_px), 0.0);
        }
        assert!(contours.strength(50.0, 10.0 / 3.0) > 0.5);
        assert!(contours.strength(10.0, 1.0) > 0.5);
    }
}
