//! A ribbon covers what a buffer of its line does: held against `geo`'s buffers.

use geo::algorithm::buffer::{Buffer, BufferStyle, LineCap, LineJoin};
use geo::{Area, BooleanOps, LineString, MultiPolygon, Polygon};
use glam::DVec2;
use proptest::prelude::*;
use sandtable_description::words::Join;
use sandtable_earthworks::alignment::Alignment;
use sandtable_geom::polyline::Polyline;
use sandtable_ribbon::partition::{apart, overlap_m2};
use sandtable_ribbon::plan::PlanMesh;
use sandtable_ribbon::stroke::{StrokeOptions, StrokePath, stroke};

/// The area of `geo`'s buffer with flat ends.
fn buffer_m2(points: &[DVec2], width_m: f64, join: Join) -> f64 {
    let line: LineString = points.iter().map(|at| (at.x, at.y)).collect();
    let join = match join {
        Join::Miter => LineJoin::Miter(0.1),
        Join::Bevel => LineJoin::Bevel,
        Join::Round => LineJoin::Round(std::f64::consts::PI / 12.0),
    };
    let style = BufferStyle::new(width_m / 2.0).line_cap(LineCap::Butt).line_join(join);
    line.buffer_with_style(style).unsigned_area()
}

fn laid(points: &[DVec2], width_m: f64, options: &StrokeOptions) -> PlanMesh {
    let line = Polyline::new(points.iter().copied(), 0.01).expect("a line");
    let mut plan = PlanMesh::default();
    stroke(&StrokePath::alone(&Alignment::on_ground(line, width_m)), options, &mut plan);
    plan
}

/// A walk that turns by less than a right angle and a half at each vertex, with room for its width.
fn walk() -> impl Strategy<Value = Vec<DVec2>> {
    prop::collection::vec((20.0..60.0, -2.0..2.0), 1..9).prop_map(|steps| {
        let (mut at, mut heading) = (DVec2::ZERO, 0.0);
        let mut points = vec![at];
        for (length, turn) in steps {
            heading += turn;
            at += DVec2::new(libm::cos(heading), libm::sin(heading)) * length;
            points.push(at);
        }
        points
    })
}

proptest! {
    #[test]
    fn a_ribbon_s_area_is_its_buffer_s_whatever_the_join(points in walk(), width_m in 1.0..12.0) {
        for join in [Join::Bevel, Join::Round, Join::Miter] {
            let options = StrokeOptions { join, miter_limit: 10.0, ..StrokeOptions::default() };
            let plan = laid(&points, width_m, &options);
            let parts = apart([&plan]);
            let (found, expected) = (parts[0].area_m2(), buffer_m2(&points, width_m, join));
            // Arcs have 24 chords a turn here and there, not the same ones.
            let slack = 0.02 * width_m * width_m * points.len() as f64 + 0.05;
            prop_assert!((found - expected).abs() < slack, "{join:?}: {found} m2, a buffer has {expected} m2");
            prop_assert!(overlap_m2(&parts) < 0.05, "{join:?}: {} m2 twice", overlap_m2(&parts));
            for [a, b, c] in plan.corners() {
                prop_assert!((b.at - a.at).perp_dot(c.at - a.at) > 0.0);
            }
        }
    }

}

proptest! {
    // Unions of hundreds of triangles are slow.
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn ribbons_taken_apart_cover_what_they_did_together(
        lines in prop::collection::vec((walk(), -60.0..60.0, -60.0..60.0, 2.0..14.0), 2..6),
    ) {
        let plans: Vec<PlanMesh> = lines
            .iter()
            .map(|(points, x, y, width_m)| {
                let moved: Vec<DVec2> = points.iter().map(|&at| at + DVec2::new(*x, *y)).collect();
                laid(&moved, *width_m, &StrokeOptions::default())
            })
            .collect();
        let parts = apart(&plans);
        let area: f64 = parts.iter().map(PlanMesh::area_m2).sum();
        let triangles = plans.iter().flat_map(PlanMesh::corners).map(|corners| {
            let ring: LineString = corners.iter().map(|corner| (corner.at.x, corner.at.y)).collect();
            MultiPolygon(vec![Polygon::new(ring, Vec::new())])
        });
        let union = triangles.fold(MultiPolygon(Vec::new()), |union, triangle| union.union(&triangle));
        prop_assert!((area - union.unsigned_area()).abs() < 0.3, "{area} m2, together {}", union.unsigned_area());
    }
}
