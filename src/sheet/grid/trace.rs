//! Traces the visible parts of a line on the ground.
//!
//! A line is halved until its pieces are short on the picture, and no longer than some cells of the ground. Each piece
//! is kept where neither end lies behind what the picture shows there. Toward the horizon, where lines run together,
//! ordinary lines end first.

use glam::{DVec2, Vec2};

use crate::grid::lines::{GroundGrid, GroundLine};
use sandtable_geom::rect::Rect;
use sandtable_geom::simplify::simplified;
use sandtable_picture::nested_ground::NestedHeights;
use sandtable_render::picture::Rendering;
use sandtable_scene::scene_model::SceneModel;
use sandtable_view::camera::{Camera, Projected};

/// The length of a piece on the picture in pixels: shorter ones cost more and show no more of the ground's shape.
const PIECE_PX: f32 = 3.0;
/// The length of a piece in cells of the ground: between longer ones a hill is lost.
const PIECE_CELLS: f64 = 6.0;
/// How often a piece is halved at most.
const MOST_HALVINGS: u32 = 14;
/// Lines that are nearer to their neighbors than this are left out, in pixels of a picture 1080 pixels high.
const LEAST_APART_PX: f32 = 9.0;
/// How far the drawn ground may lie before the true one, in pixels of it.
const SLACK_PX: f32 = 3.0;
/// The lowest slope of a view, as a sine, for which that is computed.
const FLATTEST: f32 = 0.08;
/// By how much a drawn line may miss the traced one, in pixels.
const MISS_PX: f64 = 0.2;

/// Traces lines on one picture.
pub struct LineTracer<'a> {
    camera: &'a Camera,
    picture: &'a Rendering,
    scene: &'a SceneModel,
    nested: &'a NestedHeights,
    longest_m: f64,
    least_apart_px: f32,
    frame: Rect,
}

/// A point of a line.
#[derive(Clone, Copy)]
struct TracedPoint {
    at: DVec2,
    /// Where it is on the picture; `None` behind the eye and where there is no ground.
    seen: Option<Projected>,
}

/// The runs of a line so far.
#[derive(Default)]
struct TracedRuns {
    runs: Vec<Vec<Vec2>>,
    is_open: bool,
}

impl<'a> LineTracer<'a> {
    pub fn new(
        scene: &'a SceneModel,
        nested: &'a NestedHeights,
        camera: &'a Camera,
        picture: &'a Rendering,
    ) -> Self {
        let (width, height) = camera.size();
        Self {
            camera,
            picture,
            scene,
            nested,
            longest_m: nested.finest(&scene.lattice).cell().max_element() * PIECE_CELLS,
            least_apart_px: LEAST_APART_PX * (height as f32 / 1080.0).max(0.4),
            frame: Rect { min: DVec2::ZERO, max: DVec2::new(width.into(), height.into()) },
        }
    }

    /// The parts of a line that show, in pixels.
    pub fn runs(&self, line: &GroundLine, grid: &GroundGrid) -> Vec<Vec<Vec2>> {
        let multiple = if line.is_index { grid.index_every } else { 1 };
        let mut traced = TracedRuns::default();
        for part in &line.parts {
            traced.is_open = false;
            let points: Vec<TracedPoint> = part.iter().map(|&at| self.point(at)).collect();
            for pair in points.windows(2) {
                let apart_m = grid.apart_m(line, pair[0].at) * multiple as f64;
                self.trace([pair[0], pair[1]], MOST_HALVINGS, apart_m, &mut traced);
            }
        }
        traced.runs.retain(|run| run.len() > 1);
        traced.runs.iter().map(|run| thinned(run)).collect()
    }

    fn point(&self, at: DVec2) -> TracedPoint {
        let seen =
            self.nested.drawn_z(self.scene, at).and_then(|z| self.camera.project(at.extend(z).as_vec3()));
        TracedPoint { at, seen }
    }

    fn trace(&self, [from, to]: [TracedPoint; 2], halvings: u32, apart_m: f64, traced: &mut TracedRuns) {
        if halvings > 0 && self.is_long(from, to) {
            let middle = self.point(from.at.midpoint(to.at));
            self.trace([from, middle], halvings - 1, apart_m, traced);
            self.trace([middle, to], halvings - 1, apart_m, traced);
            return;
        }
        let ends = from.seen.zip(to.seen).filter(|(start, end)| self.shows(start) && self.shows(end));
        let ends = ends.filter(|(start, _)| self.is_apart(from, to, start, apart_m));
        match ends {
            Some((start, end)) => traced.extend(&self.frame, start.pixel, end.pixel),
            None => traced.is_open = false,
        }
    }

    fn is_long(&self, from: TracedPoint, to: TracedPoint) -> bool {
        let length_m = from.at.distance(to.at);
        match (from.seen, to.seen) {
            (Some(start), Some(end)) if self.is_beside(start.pixel, end.pixel) => false,
            _ if length_m > self.longest_m => true,
            (Some(start), Some(end)) => start.pixel.distance(end.pixel) > PIECE_PX,
            (None, None) => false,
            // Down to some decimeters at the plane of the eye and at the border of the ground.
            _ => length_m > 0.5,
        }
    }

    /// Whether both points lie beyond the same side of the picture, by more than hills between them would reach.
    fn is_beside(&self, start: Vec2, end: Vec2) -> bool {
        let (max, reach) = (self.frame.max.as_vec2(), self.frame.max.as_vec2() * 0.3);
        let (low, high) = (start.min(end), start.max(end));
        high.cmplt(-reach).any() || low.cmpgt(max + reach).any()
    }

    /// Whether nothing lies before a point; of those beside the picture nothing is known.
    fn shows(&self, seen: &Projected) -> bool {
        let (width, height) = self.camera.size();
        let pixel = seen.pixel;
        if !(pixel.x >= 0.0 && pixel.y >= 0.0 && pixel.x < width as f32 && pixel.y < height as f32) {
            return true;
        }
        let steepness = self.camera.forward().z.abs().max(FLATTEST);
        let slack_m = SLACK_PX / (self.camera.pixels_per_meter(seen.depth_m) * steepness);
        let around = |at: f32, end: u32| {
            let at = at as u32;
            at.saturating_sub(1)..=(at + 1).min(end - 1)
        };
        around(pixel.y, height).any(|y| {
            around(pixel.x, width)
                .any(|x| self.picture.depth_m[(y * width + x) as usize] >= seen.depth_m - slack_m)
        })
    }

    /// Whether the next line of its kind is far enough from this one on the picture.
    fn is_apart(&self, from: TracedPoint, to: TracedPoint, start: &Projected, apart_m: f64) -> bool {
        let along = to.at - from.at;
        let Some(across) = along.perp().try_normalize() else { return false };
        let z = self.nested.drawn_z(self.scene, from.at).unwrap_or_default();
        let project = |at: DVec2| self.camera.project(at.extend(z).as_vec3()).map(|seen| seen.pixel);
        let (Some(next), Some(ahead)) = (project(from.at + across * apart_m), project(to.at)) else {
            return true;
        };
        let Some(direction) = (ahead - start.pixel).try_normalize() else { return true };
        direction.perp_dot(next - start.pixel).abs() >= self.least_apart_px
    }
}

impl TracedRuns {
    /// Adds a piece, cut to the picture.
    fn extend(&mut self, frame: &Rect, from: Vec2, to: Vec2) {
        let Some((start, end)) = frame.clip_line(from.as_dvec2(), to.as_dvec2()) else {
            self.is_open = false;
            return;
        };
        let (start, end) = (start.as_vec2(), end.as_vec2());
        match self.runs.last_mut().filter(|_| self.is_open) {
            Some(run) => run.push(end),
            None => self.runs.push(vec![start, end]),
        }
        self.is_open = end == to;
    }
}

/// A run without the points that it does not need.
fn thinned(run: &[Vec2]) -> Vec<Vec2> {
    let off = |from: usize, to: usize, at: usize| {
        let (line, point) = (run[to] - run[from], run[at] - run[from]);
        f64::from(line.perp_dot(point).abs() / line.length())
    };
    simplified(run.len(), MISS_PX, off).into_iter().map(|index| run[index]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_run_ends_where_it_leaves_the_picture_and_another_begins() {
        let frame = Rect { min: DVec2::ZERO, max: DVec2::splat(100.0) };
        let mut traced = TracedRuns::default();
        for pair in [10.0f32, 60.0, 120.0, 130.0].windows(2) {
            traced.extend(&frame, Vec2::new(pair[0], 5.0), Vec2::new(pair[1], 5.0));
        }
        traced.extend(&frame, Vec2::new(120.0, 9.0), Vec2::new(90.0, 9.0));
        let ends: Vec<(f32, f32)> = traced.runs.iter().map(|run| (run[0].x, run[run.len() - 1].x)).collect();
        assert_eq!(ends, [(10.0, 100.0), (100.0, 90.0)]);
    }

    #[test]
    fn points_on_a_straight_line_are_left_out() {
        let run: Vec<Vec2> = (0..20).map(|x| Vec2::new(x as f32, if x < 10 { 0.0 } else { 4.0 })).collect();
        assert_eq!(thinned(&run).len(), 4);
    }
}
