//! The ground under structures: straight lines draped on the triangles of a ground, and the height at a point.
//!
//! A line is cut where it passes from one triangle to the next. Between two cuts the ground under it is straight, so what
//! is built from cut to cut lies exactly on the ground:
//!
//! ```text
//!  from ●──────┬───────┬────● to       seen from above: three triangles, two cuts
//!             ╱ ╲       ╲
//! ```

use glam::DVec2;

use crate::triangle_surface::{TriangleSurface, plan, plane_z};
use sandtable_geom::convex;
use sandtable_geom::profile::Profile;
use sandtable_geom::rect::Rect;

/// A position this far beside a triangle, in meters, still lies in it: more than rounding, so that no line falls between
/// two triangles, and less than is ever visible.
const BESIDE_M: f64 = 1e-7;

/// The most pieces in which the triangles near a long line are looked up; one rectangle around the line would hold many
/// triangles that it does not meet.
const MOST_PIECES: f64 = 64.0;

/// The length of a piece in meters, before [`MOST_PIECES`] limits their number.
const PIECE_M: f64 = 100.0;

/// World Z along the line `from`..`to` draped on `ground`, with a station, 0 at its start and 1 at its end, at every edge of
/// the ground's triangles: several profiles where the ground has gaps, none where there is no ground or the line is a point.
pub fn ground_runs(ground: &dyn TriangleSurface, from: DVec2, to: DVec2) -> Vec<Profile> {
    let length = from.distance(to);
    if !(length.is_finite() && length > BESIDE_M) {
        return Vec::new();
    }
    let pieces = (length / PIECE_M).ceil().clamp(1.0, MOST_PIECES) as u32;
    let mut over = Vec::new();
    for piece in 0..pieces {
        let [low, high] = [piece, piece + 1].map(|at| f64::from(at) / f64::from(pieces));
        let rect = Rect::around([from.lerp(to, low), from.lerp(to, high)]).grown(BESIDE_M);
        ground.visit_facets(&rect, &mut |facet| {
            if let Some((enter, leave)) = convex::clip_line(&plan(facet), (from, to), BESIDE_M) {
                let z = |part: f64| plane_z(facet, from.lerp(to, part));
                over.push([enter.max(low), leave.min(high)].map(|part| DVec2::new(part, z(part))));
            }
        });
    }
    over.retain(|[enter, leave]| enter.x < leave.x);
    over.sort_by(|a, b| a[0].x.total_cmp(&b[0].x).then(a[1].x.total_cmp(&b[1].x)));
    joined(&over, 4.0 * BESIDE_M / length)
}

/// Joins the stretches over single triangles, parts and heights in ascending order, to runs; gaps up to `gap` are rounding.
fn joined(over: &[[DVec2; 2]], gap: f64) -> Vec<Profile> {
    let mut runs: Vec<Vec<DVec2>> = Vec::new();
    for &[enter, leave] in over {
        let reached = runs.last().and_then(|run| run.last()).map_or(f64::NEG_INFINITY, |end| end.x);
        match runs.last_mut() {
            Some(run) if enter.x <= reached + gap => run.extend((leave.x > reached + gap).then_some(leave)),
            _ if leave.x - enter.x > gap => runs.push(vec![enter, leave]),
            _ => {}
        }
    }
    let profile = |run: Vec<DVec2>| {
        let (parts, heights) = run.into_iter().map(|at| (at.x, at.y)).unzip();
        Profile::new(parts, heights)
    };
    runs.into_iter().filter_map(profile).collect()
}

/// The ground that a picture's structures stand on: as displayed, or at full resolution where that ground is out of view,
/// since a structure on it may still be in view.
#[derive(Clone, Copy)]
pub struct SupportSurface<'a> {
    /// The displayed ground.
    pub displayed: &'a dyn TriangleSurface,
    /// The ground at full resolution.
    pub ground: &'a dyn TriangleSurface,
}

impl SupportSurface<'_> {
    /// World Z of the ground at a world position; `None` where there is no data.
    pub fn z(&self, at: DVec2) -> Option<f64> {
        self.displayed.displayed_z(at).or_else(|| self.ground.displayed_z(at))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::full_resolution::FullResolution;
    use crate::lattice::Lattice;
    use proptest::prelude::*;

    fn rough(holes: &[usize]) -> Lattice {
        let mut heights: Vec<f32> = (0..400).map(|index| libm::sinf(index as f32 * 2.3) * 5.0).collect();
        for &hole in holes {
            heights[hole] = f32::NAN;
        }
        Lattice::new(DVec2::ZERO, DVec2::new(10.0, 7.0), 20, heights).expect("sound")
    }

    proptest! {
        #[test]
        fn a_run_lies_on_the_ground_throughout(
            from in (-20.0..210.0f64, -20.0..150.0f64), to in (-20.0..210.0f64, -20.0..150.0f64),
            snapped in proptest::bool::ANY,
        ) {
            let lattice = rough(&[]);
            let ground = FullResolution { lattice: &lattice };
            let onto = |at: (f64, f64)| {
                let at = DVec2::from(at);
                if snapped { (at / DVec2::new(10.0, 7.0)).round() * DVec2::new(10.0, 7.0) } else { at }
            };
            let (from, to) = (onto(from), onto(to));
            let found = ground_runs(&ground, from, to);
            for step in 0..=200 {
                let part = f64::from(step) / 200.0;
                // A line that only touches the border has no ground under it.
                let near = [part - 1e-3, part + 1e-3].map(|part| ground.displayed_z(from.lerp(to, part)));
                let (Some(z), [Some(_), Some(_)]) = (ground.displayed_z(from.lerp(to, part)), near) else {
                    continue;
                };
                if from == to || part == 0.0 || part == 1.0 { continue }
                let run = found.iter().find(|run| (run.span()[0] - 1e-6..=run.span()[1] + 1e-6).contains(&part));
                prop_assert!(run.is_some(), "nothing at {part} of {found:?}");
                let off = (run.expect("checked").at(part) - z).abs();
                prop_assert!(off < 1e-4, "{off} m at {part}");
            }
            prop_assert!(found.len() <= 1);
        }
    }

    #[test]
    fn a_hole_splits_a_line() {
        let lattice = rough(&[10 * 20 + 10]);
        let ground = FullResolution { lattice: &lattice };
        let found = ground_runs(&ground, DVec2::new(0.0, 71.0), DVec2::new(190.0, 71.0));
        assert_eq!(found.len(), 2);
        assert!(found[0].span()[1] < 0.55 && found[1].span()[0] > 0.5);
    }

    #[test]
    fn points_and_lines_that_are_not_finite_have_no_runs() {
        let lattice = rough(&[]);
        let ground = FullResolution { lattice: &lattice };
        assert!(ground_runs(&ground, DVec2::ONE, DVec2::ONE).is_empty());
        assert!(ground_runs(&ground, DVec2::ONE, DVec2::NAN).is_empty());
    }
}
