//! The eye of a view that is fitted to what it shows.
//!
//! For a fixed direction of view, a point `p` lies within the frame where four linear inequalities hold between its
//! coordinates and those of the eye `e`: with `r`, `u` and `f` the coordinates to the right, up and forward, and the sides
//! of the frame as tangents, `left · (p.f − e.f) ≤ p.r − e.r ≤ right · (p.f − e.f)` and the same with `u`, `bottom` and
//! `top`. The strictest point bounds `e.r + s · e.f` for each side `s`. The nearest eye that meets two opposite bounds
//! lies where they cross: the fit is exact, without a search.

use glam::{Vec2, Vec3};

use sandtable_view::axes::DirectionAxes;

/// The part of a picture to be filled, as tangents of angles from the axis of view: to the right and up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct FitFrame {
    /// The lower left corner.
    pub min: Vec2,
    /// The upper right corner.
    pub max: Vec2,
}

/// The nearest eye whose `frame` holds all `points`, of which there is at least one; where the frame is wider or higher
/// than they need, they are in its middle.
pub(super) fn fitted_eye(points: &[Vec3], axes: &DirectionAxes, frame: &FitFrame) -> Vec3 {
    let mut low = Vec2::INFINITY;
    let mut high = Vec2::NEG_INFINITY;
    for point in points {
        let local = axes.coordinates(*point);
        low = low.min(local.truncate() - frame.min * local.z);
        high = high.max(local.truncate() - frame.max * local.z);
    }
    let forward = ((low - high) / (frame.max - frame.min)).min_element();
    let aside = ((low + frame.min * forward) + (high + frame.max * forward)) / 2.0;
    axes.right * aside.x + axes.up * aside.y + axes.forward * forward
}

/// What all points span as parallel rays along `axes` see them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ParallelSpan {
    /// The least coordinates to the right, up and forward.
    pub min: Vec3,
    /// The greatest.
    pub max: Vec3,
}

impl ParallelSpan {
    /// The span of `points`, of which there is at least one.
    pub fn new(points: impl IntoIterator<Item = Vec3>, axes: &DirectionAxes) -> Self {
        let empty = Self { min: Vec3::INFINITY, max: Vec3::NEG_INFINITY };
        points
            .into_iter()
            .map(|point| axes.coordinates(point))
            .fold(empty, |span, local| Self { min: span.min.min(local), max: span.max.max(local) })
    }
}

/// The points as `eye` sees them, as tangents to the right and up.
pub(super) fn projected(points: &[Vec3], axes: &DirectionAxes, eye: Vec3) -> impl Iterator<Item = Vec2> {
    points.iter().map(move |point| {
        let local = axes.coordinates(*point - eye);
        local.truncate() / local.z
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The corners of a block, 3 by 2 km and 400 m high.
    fn block() -> Vec<Vec3> {
        let side = |corner: u32, bit: u32, length: f32| if corner & bit == 0 { 0.0 } else { length };
        (0..8)
            .map(|corner| Vec3::new(side(corner, 1, 3000.0), side(corner, 2, 2000.0), side(corner, 4, 400.0)))
            .collect()
    }

    #[test]
    fn a_fitted_view_touches_two_opposite_sides_of_its_frame_and_crosses_none() {
        let points = block();
        for (azimuth, pitch) in [(0.0, 0.7), (1.0, 0.2), (3.0, 1.3), (-2.0, 0.9)] {
            for (min, max) in [((-0.5, -0.2), (0.5, 0.3)), ((-0.1, -0.4), (0.3, 0.4))] {
                let frame = FitFrame { min: min.into(), max: max.into() };
                let axes = DirectionAxes::new(azimuth, pitch);
                let eye = fitted_eye(&points, &axes, &frame);
                let [mut low, mut high] = [Vec2::INFINITY, Vec2::NEG_INFINITY];
                for at in projected(&points, &axes, eye) {
                    low = low.min(at);
                    high = high.max(at);
                }
                let [below, above] = [low - frame.min, frame.max - high];
                assert!(below.min(above).min_element() > -1e-3, "{azimuth} {pitch}: {low} {high}");
                let touches = below.abs().max(above.abs());
                assert!(touches.min_element() < 1e-3, "{azimuth} {pitch}: {low} {high}");
            }
        }
    }
}
