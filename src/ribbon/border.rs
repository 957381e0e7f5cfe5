//! The line along an area's outline, inside it, unbroken or in dashes.
//!
//! ```text
//!   ┌──────────────────────    the outline is stroked twice as wide as the line is to be,
//!   │▓▓▓▓▓▓  ▓▓▓▓▓▓  ▓▓▓▓▓     and of that only what lies within the area is kept: half of it,
//!   │▓▓                        or all there is where the area is narrower
//! ```

use glam::DVec2;

use crate::partition;
use crate::plan::PlanMesh;
use crate::stroke::{StrokeOptions, StrokePath, stroke};
use sandtable_earthworks::alignment::Alignment;
use sandtable_geom::offset::Continuations;
use sandtable_geom::polyline::Polyline;

/// A dash and the gap after it, in widths of the line.
const DASH: f64 = 5.0;

/// How much of that is the dash.
const DRAWN: f64 = 0.62;

/// The most dashes along one ring; a longer ring has longer ones.
const MOST_DASHES: f64 = 5000.0;

/// Vertices nearer to each other than this are one, in meters.
const MERGE_M: f64 = 0.01;

/// Whether a line has gaps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dashes {
    /// None.
    Unbroken,
    /// As long as five times the line's width, dash and gap together, a little stretched to fit the ring.
    Dashed,
}

/// The line of `width_m` along the outer ring and the holes of an area, in that area's triangles `area`.
pub fn border(rings: &[&[DVec2]], area: &PlanMesh, width_m: f64, dashes: Dashes) -> PlanMesh {
    strip(rings, area, width_m, dashes, &StrokeOptions::default())
}

/// The strip of `width_m` along the outline within which a cover fades; its texture repeats every `texture_m` meters along
/// the outline, and U runs from 0.5 on the outline to 0 or 1 inside.
pub fn edge(rings: &[&[DVec2]], area: &PlanMesh, width_m: f64, texture_m: f64) -> PlanMesh {
    let options = StrokeOptions { texture_length_m: texture_m, ..StrokeOptions::default() };
    strip(rings, area, width_m, Dashes::Unbroken, &options)
}

fn strip(
    rings: &[&[DVec2]],
    area: &PlanMesh,
    width_m: f64,
    dashes: Dashes,
    options: &StrokeOptions,
) -> PlanMesh {
    let mut strips = PlanMesh::default();
    let mut add = |line: Polyline, beyond: Continuations| {
        let alignment = Alignment::on_ground(line, 2.0 * width_m);
        let path = StrokePath { beyond, ..StrokePath::alone(&alignment) };
        stroke(&path, options, &mut strips);
    };
    for line in rings.iter().filter_map(|ring| closed(ring)) {
        match dashes {
            Dashes::Unbroken => {
                let beyond = Continuations::around(&line);
                add(line, beyond);
            }
            Dashes::Dashed => dashed(&line, width_m).for_each(|dash| add(dash, Continuations::default())),
        }
    }
    partition::within(&strips, area)
}

/// The ring as a line that ends where it begins.
fn closed(ring: &[DVec2]) -> Option<Polyline> {
    let first = *ring.first()?;
    let back = (ring.last() != Some(&first)).then_some(first);
    Polyline::new(ring.iter().copied().chain(back), MERGE_M)
}

fn dashed(line: &Polyline, width_m: f64) -> impl Iterator<Item = Polyline> + '_ {
    let count = (line.length() / (DASH * width_m)).round().clamp(1.0, MOST_DASHES);
    let step_m = line.length() / count;
    (0..count as u32).filter_map(move |index| {
        let from_m = f64::from(index) * step_m;
        line.slice(from_m, from_m + DRAWN * step_m, MERGE_M)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::area;

    fn turned(points: &[(f64, f64)], quarter: u32) -> Vec<DVec2> {
        let turn = |(x, y): (f64, f64)| (0..quarter).fold((x, y), |(x, y), _| (-y, x));
        points.iter().map(|&point| DVec2::from(turn(point))).collect()
    }

    fn bordered(ring: &[DVec2], holes: &[Vec<DVec2>], width_m: f64, dashes: Dashes) -> (PlanMesh, PlanMesh) {
        let mut plan = PlanMesh::default();
        area::fill(ring, holes, 10.0, &mut plan);
        let rings: Vec<&[DVec2]> = std::iter::once(ring).chain(holes.iter().map(Vec::as_slice)).collect();
        let line = border(&rings, &plan, width_m, dashes);
        let apart = partition::apart([&line]).remove(0);
        (plan, apart)
    }

    #[test]
    fn a_square_s_border_runs_inside_it() {
        let square = [(0.0, 0.0), (100.0, 0.0), (100.0, 100.0), (0.0, 100.0)];
        for quarter in 0..4 {
            let (_, line) = bordered(&turned(&square, quarter), &[], 5.0, Dashes::Unbroken);
            assert!((line.area_m2() - (100.0 * 100.0 - 90.0 * 90.0)).abs() < 1e-3, "{}", line.area_m2());
        }
    }

    #[test]
    fn an_area_narrower_than_its_border_is_all_border() {
        let strip = [(0.0, 0.0), (100.0, 0.0), (100.0, 6.0), (0.0, 6.0)];
        for quarter in 0..4 {
            let (plan, line) = bordered(&turned(&strip, quarter), &[], 5.0, Dashes::Unbroken);
            assert!((line.area_m2() - plan.area_m2()).abs() < 1e-2, "{}", line.area_m2());
        }
    }

    #[test]
    fn an_island_has_a_border_of_its_own_on_its_outer_side() {
        let square = turned(&[(0.0, 0.0), (100.0, 0.0), (100.0, 100.0), (0.0, 100.0)], 0);
        let hole = turned(&[(40.0, 40.0), (40.0, 60.0), (60.0, 60.0), (60.0, 40.0)], 0);
        let (_, line) = bordered(&square, &[hole], 5.0, Dashes::Unbroken);
        let expected = 100.0 * 100.0 - 90.0 * 90.0 + 30.0 * 30.0 - 20.0 * 20.0;
        assert!((line.area_m2() - expected).abs() < 1e-2, "{}", line.area_m2());
    }

    #[test]
    fn dashes_cover_their_share_of_the_line() {
        let square = turned(&[(0.0, 0.0), (400.0, 0.0), (400.0, 400.0), (0.0, 400.0)], 0);
        let (_, whole) = bordered(&square, &[], 4.0, Dashes::Unbroken);
        let (_, dashed) = bordered(&square, &[], 4.0, Dashes::Dashed);
        let share = dashed.area_m2() / whole.area_m2();
        assert!((share - DRAWN).abs() < 0.02, "{share}");
    }
}
