//! Separates ribbons that overlap, so that no two triangles lie over one another.
//!
//! Plans are handed in from the one that lies over all others down. Each triangle loses what the triangles before it
//! cover, those of its own plan included (the inner side of a sharp bend, a line that crosses itself), and what is left
//! of it keeps its texture. Triangles are convex, so what one takes away from another is cut off along its three sides:
//! exact to rounding, with no grid that vertices are snapped to, and the same on every machine.
//!
//! What is taken away is what the triangles before cover as they were handed in, not what was left of them: both cover
//! the same ground, and so each triangle is cut without waiting for any other. A tree of rectangles finds the triangles
//! that may overlap: the cost grows with the triangles and with how many of them lie over one another, not with their
//! square.

use std::collections::BTreeMap;

use glam::DVec2;
use rayon::prelude::*;

use crate::cutting::{self, SLIVER_M2};
use crate::plan::{PlanMesh, TextureMap};
use sandtable_geom::convex::{self, ConvexClip};
use sandtable_geom::morton;
use sandtable_geom::polygon;
use sandtable_geom::rect::Rect;
use sandtable_geom::rect_tree::RectTree;
use sandtable_mesh::sink::{MeshSink, VertexId};

/// How many triangles are cut in one go by a thread: a few thousand cuts, against a hand-over of a microsecond.
const CHUNK: usize = 256;

/// How many plans are put together in one go by a thread: a road has some ten triangles.
const PLANS: usize = 64;

/// The plans, each without the ground that the plans before it cover.
pub fn apart<'a>(plans: impl IntoIterator<Item = &'a PlanMesh> + Clone) -> Vec<PlanMesh> {
    let covering = Covering::new(plans.clone());
    let rests: Vec<Rest> = covering.each(|clip, triangle| covering.rest(triangle, clip));
    let mut later = &rests[..];
    let with_rests = |plan: &'a PlanMesh| (plan, later.split_off(..plan.triangles.len()).unwrap_or_default());
    let each: Vec<(&PlanMesh, &[Rest])> = plans.into_iter().map(with_rests).collect();
    let left =
        || each.into_par_iter().with_min_len(PLANS).map(|(plan, rests)| left_of(plan, rests)).collect();
    let (left, ()) = rayon::join(left, || drop(covering));
    rests.into_par_iter().with_min_len(CHUNK).for_each(drop);
    left
}

/// The area in square meters that more than one triangle of `plans` covers, counted once for every pair: 0 but for
/// rounding after [`apart`].
pub fn overlap_m2<'a>(plans: impl IntoIterator<Item = &'a PlanMesh>) -> f64 {
    let covering = Covering::new(plans);
    covering.each(|_, triangle| covering.overlap_m2(triangle)).into_iter().sum()
}

/// The part of `plan` that lies on `ground`, whose own triangles do not overlap; its texture is kept.
pub fn within(plan: &PlanMesh, ground: &PlanMesh) -> PlanMesh {
    let covering = Covering::new([ground]);
    let mut inside = PlanMesh::default();
    for triangle in plan.corners() {
        let (corners, texture) = (triangle.map(|corner| corner.at), TextureMap::of(triangle));
        for under in covering.near(&corners) {
            let piece = convex::intersection(&corners, &covering.triangles[under], SLIVER_M2);
            inside.write(piece.iter().flat_map(|piece| fan(piece)), &texture);
        }
    }
    inside
}

/// What is left of a triangle.
enum Rest {
    /// All of it.
    Whole,
    /// Convex pieces, counter-clockwise; none where it is covered.
    Pieces(Vec<Vec<DVec2>>),
}

/// What is left of a plan, given what is left of each of its triangles.
fn left_of(plan: &PlanMesh, rests: &[Rest]) -> PlanMesh {
    let mut left = PlanMesh::default();
    let mut kept: BTreeMap<VertexId, VertexId> = BTreeMap::new();
    for ((&ids, triangle), rest) in plan.triangles.iter().zip(plan.corners()).zip(rests) {
        match rest {
            Rest::Whole => {
                let mut keep =
                    |id: VertexId| *kept.entry(id).or_insert_with(|| left.vertex(plan.vertices[id.index()]));
                let ids = ids.map(&mut keep);
                left.triangle(ids);
            }
            Rest::Pieces(pieces) => {
                left.write(pieces.iter().flat_map(|piece| fan(piece)), &TextureMap::of(triangle));
            }
        }
    }
    left
}

/// All triangles of some plans, in their order.
struct Covering {
    triangles: Vec<[DVec2; 3]>,
    tree: RectTree,
    /// The order in which triangles are taken away from another one: near ones together, so that fewer pieces arise.
    ranks: Vec<u32>,
}

impl Covering {
    fn new<'a>(plans: impl IntoIterator<Item = &'a PlanMesh>) -> Self {
        let plans: Vec<&PlanMesh> = plans.into_iter().collect();
        let corners = plans.into_par_iter().with_min_len(PLANS).flat_map_iter(PlanMesh::corners);
        let triangles: Vec<[DVec2; 3]> = corners.map(|triangle| triangle.map(|corner| corner.at)).collect();
        let rects: Vec<Rect> =
            triangles.par_iter().with_min_len(CHUNK).map(|&corners| Rect::around(corners)).collect();
        let (tree, ranks) = rayon::join(|| RectTree::new(&rects), || morton::ranks(&rects));
        Self { tree, ranks, triangles }
    }

    /// What `found` says of every triangle, in their order.
    fn each<T: Send>(&self, found: impl Fn(&mut ConvexClip, usize) -> T + Send + Sync) -> Vec<T> {
        let triangles = (0..self.triangles.len()).into_par_iter().with_min_len(CHUNK);
        triangles.map_init(ConvexClip::default, found).collect()
    }

    /// The triangles whose rectangles meet a triangle, in ascending order.
    fn near(&self, corners: &[DVec2; 3]) -> Vec<usize> {
        let mut near = self.tree.meeting_convex(corners);
        near.sort_unstable();
        near
    }

    fn overlap_m2(&self, triangle: usize) -> f64 {
        let corners = &self.triangles[triangle];
        let before = self.near(corners).into_iter().take_while(|&other| other < triangle);
        before.map(|other| shared_m2(corners, &self.triangles[other])).sum()
    }

    /// What no triangle before this one covers.
    fn rest(&self, triangle: usize, clip: &mut ConvexClip) -> Rest {
        let corners = &self.triangles[triangle];
        let mut before = self.tree.meeting_convex(corners);
        before.retain(|&other| other < triangle);
        if before.iter().any(|&other| cutting::covers(&self.triangles[other], corners)) {
            return Rest::Pieces(Vec::new());
        }
        before.sort_unstable_by_key(|&other| self.ranks[other]);
        let windows: Vec<[DVec2; 3]> = before.into_iter().map(|other| self.triangles[other]).collect();
        cutting::rest(corners, &windows, clip).map_or(Rest::Whole, Rest::Pieces)
    }
}

fn shared_m2(one: &[DVec2], other: &[DVec2]) -> f64 {
    convex::intersection(one, other, 0.0).map_or(0.0, |piece| polygon::doubled_area(&piece) / 2.0)
}

/// A convex polygon in triangles; those without an area, which cutting at a corner leaves, are left out.
fn fan(piece: &[DVec2]) -> impl Iterator<Item = [DVec2; 3]> + '_ {
    polygon::fan(piece).filter(|corners| polygon::doubled_area(corners) > 2.0 * SLIVER_M2)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stroke::{StrokeOptions, StrokePath, stroke};
    use proptest::prelude::*;
    use sandtable_earthworks::alignment::Alignment;
    use sandtable_geom::polyline::Polyline;

    fn ribbon(points: &[(f64, f64)], width_m: f64) -> PlanMesh {
        let line = Polyline::new(points.iter().map(|&(x, y)| DVec2::new(x, y)), 0.01).expect("a line");
        let mut plan = PlanMesh::default();
        let alignment = Alignment::on_ground(line, width_m);
        stroke(&StrokePath::alone(&alignment), &StrokeOptions::default(), &mut plan);
        plan
    }

    #[test]
    fn a_crossing_belongs_to_the_ribbon_above() {
        let plans = [ribbon(&[(0.0, 50.0), (100.0, 50.0)], 10.0), ribbon(&[(50.0, 0.0), (50.0, 100.0)], 4.0)];
        let parts = apart(&plans);
        assert_eq!((parts[0].vertices.len(), parts[0].triangles.len()), (4, 2));
        assert!((parts[1].area_m2() - 360.0).abs() < 1e-6, "{}", parts[1].area_m2());
        assert!(overlap_m2(&plans) > 39.0 && overlap_m2(&parts) < 1e-6);
    }

    #[test]
    fn what_is_left_keeps_its_texture() {
        let plans = [ribbon(&[(0.0, 50.0), (100.0, 50.0)], 10.0), ribbon(&[(50.0, 0.0), (50.0, 100.0)], 4.0)];
        for corner in apart(&plans)[1].corners().flatten() {
            let across = (corner.at.x - 48.0) / 4.0;
            let along = corner.at.y / StrokeOptions::default().texture_length_m;
            assert!((f64::from(corner.uv.x) - across).abs() < 1e-5, "{corner:?}");
            assert!((f64::from(corner.uv.y) - along).abs() < 1e-5, "{corner:?}");
        }
    }

    #[test]
    fn what_lies_within_is_what_both_cover_with_its_texture() {
        let plans = [ribbon(&[(0.0, 50.0), (100.0, 50.0)], 10.0), ribbon(&[(50.0, 0.0), (50.0, 100.0)], 4.0)];
        let inside = within(&plans[1], &plans[0]);
        assert!((inside.area_m2() - 40.0).abs() < 1e-6, "{}", inside.area_m2());
        for corner in inside.corners().flatten() {
            assert!((f64::from(corner.uv.x) - (corner.at.x - 48.0) / 4.0).abs() < 1e-5, "{corner:?}");
        }
        assert!(within(&plans[1], &PlanMesh::default()).triangles.is_empty());
    }

    #[test]
    fn a_beveled_bend_lies_over_itself_no_more() {
        let bend = [ribbon(&[(0.0, 0.0), (100.0, 0.0), (60.0, 8.0)], 12.0)];
        assert!(overlap_m2(&bend) > 10.0);
        assert!(overlap_m2(&apart(&bend)) < 1e-2);
    }

    /// The area that triangles cover, by the length that they cover of lines across them: between two corners or crossings of
    /// their sides the length changes evenly.
    fn covered_m2(triangles: &[[DVec2; 3]]) -> f64 {
        let sides: Vec<[DVec2; 2]> =
            triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]).collect();
        let mut heights: Vec<f64> = sides.iter().map(|side| side[0].y).collect();
        for (index, [a, b]) in sides.iter().enumerate() {
            for [c, d] in &sides[..index] {
                let (along, other) = (*b - *a, *d - *c);
                let part = (*c - *a).perp_dot(other) / along.perp_dot(other);
                heights.extend((0.0..=1.0).contains(&part).then_some(a.y + part * along.y));
            }
        }
        heights.sort_by(f64::total_cmp);
        let length = |y: f64| {
            let cut = |corners: &[DVec2; 3]| {
                let [a, b, c] = *corners;
                let crossed =
                    [[a, b], [b, c], [c, a]].into_iter().filter(|[from, to]| (from.y > y) != (to.y > y));
                let mut at =
                    crossed.map(|[from, to]| from.x + (y - from.y) / (to.y - from.y) * (to.x - from.x));
                let ends = (at.next()?, at.next()?);
                Some((ends.0.min(ends.1), ends.0.max(ends.1)))
            };
            let mut cuts: Vec<(f64, f64)> = triangles.iter().filter_map(cut).collect();
            cuts.sort_by(|one, other| one.0.total_cmp(&other.0));
            let (mut length, mut end) = (0.0, f64::NEG_INFINITY);
            for (from, to) in cuts {
                length += (to - from.max(end)).max(0.0);
                end = end.max(to);
            }
            length
        };
        heights.windows(2).map(|pair| (pair[1] - pair[0]) * length((pair[0] + pair[1]) / 2.0)).sum()
    }

    #[test]
    fn ribbons_that_a_boolean_union_gets_wrong_lose_nothing() {
        let lines: [(&[(f64, f64)], f64); 4] = [
            (
                &[
                    (140.10924882073508, 131.0934102142137),
                    (143.39610818064295, 127.69550367565512),
                    (0.0, 6.798158160906256),
                ],
                11.0191250072319,
            ),
            (&[(26.861968857715226, 0.0), (0.0, 0.0)], 2.0),
            (&[(161.48125975662666, 0.0), (152.76593640249462, 134.61477145408946)], 6.532771045768634),
            (
                &[(40.93462735216264, 121.01414592364173), (198.39597202267967, 72.58679434959497)],
                2.8973845428248253,
            ),
        ];
        let plans = lines.map(|(points, width_m)| ribbon(points, width_m));
        let triangles: Vec<[DVec2; 3]> =
            plans.iter().flat_map(PlanMesh::corners).map(|corners| corners.map(|corner| corner.at)).collect();
        let area: f64 = apart(&plans).iter().map(PlanMesh::area_m2).sum();
        assert!((covered_m2(&triangles) - area).abs() < 0.2, "{} {area}", covered_m2(&triangles));
    }

    #[test]
    fn the_area_of_triangles_over_each_other_counts_once() {
        let triangle =
            |x: f64, size: f64| [DVec2::new(x, 0.0), DVec2::new(x + size, 0.0), DVec2::new(x, size)];
        assert_eq!(covered_m2(&[triangle(0.0, 2.0)]), 2.0);
        assert_eq!(covered_m2(&[triangle(0.0, 2.0), triangle(0.0, 1.0), triangle(5.0, 2.0)]), 4.0);
        assert!((covered_m2(&[triangle(0.0, 2.0), triangle(1.0, 2.0)]) - 3.5).abs() < 1e-12);
    }

    proptest! {
        #[test]
        fn no_two_triangles_overlap_and_nothing_is_lost(
            lines in prop::collection::vec((prop::collection::vec((0.0..200.0, 0.0..200.0), 2..5), 2.0..15.0), 1..6),
        ) {
            let made = |(points, width): &(Vec<(f64, f64)>, f64)| {
                let line = Polyline::new(points.iter().map(|&(x, y)| DVec2::new(x, y)), 0.01);
                line.map(|_| ribbon(points, *width))
            };
            let plans: Vec<PlanMesh> = lines.iter().filter_map(made).collect();
            let parts = apart(&plans);
            prop_assert!(overlap_m2(&parts) < 0.2, "{}", overlap_m2(&parts));
            let rings: Vec<[DVec2; 3]> =
                plans.iter().flat_map(PlanMesh::corners).map(|corners| corners.map(|corner| corner.at)).collect();
            let whole = covered_m2(&rings);
            let area: f64 = parts.iter().map(PlanMesh::area_m2).sum();
            prop_assert!((whole - area).abs() < 0.2, "{whole} {area}");
        }
    }
}
