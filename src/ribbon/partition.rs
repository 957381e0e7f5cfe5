//! Takes ribbons that overlap apart, so that no two triangles lie over one another.
//!
//! Plans are handed in from the one that lies over all others down. Each triangle loses what the triangles before it
//! cover, those of its own plan included (the inner side of a bevelled bend, a line that crosses itself), and what is
//! left of it keeps its texture. Triangles are convex, so what one takes away from another is cut off along its three
//! sides: exact to rounding, with no grid that vertices are snapped to, and the same on every machine.
//!
//! A grid of squares finds the triangles that may overlap: the cost grows with the triangles and with how many of them
//! lie over one another, not with their square.

use std::collections::BTreeMap;

use glam::DVec2;

use crate::geom::polygon;
use crate::geom::rect::Rect;
use crate::mesh::sink::{MeshSink, VertexId};
use crate::ribbon::plan::{PlanMesh, PlanVertex, TextureMap};

/// Triangles, overlaps and leftovers smaller than this are rounding, in square metres: a sliver of 10 m by 0.1 mm.
const SLIVER_M2: f64 = 1e-3;

/// The same plans without what those before them cover.
pub fn apart<'a>(plans: impl IntoIterator<Item = &'a PlanMesh> + Clone) -> Vec<PlanMesh> {
    let mut covered = Covered::new(plans.clone());
    plans.into_iter().map(|plan| covered.lay(plan)).collect()
}

/// The area in square metres that more than one triangle of `plans` covers, counted once for every pair: 0 but for
/// rounding after [`apart`].
pub fn overlap_m2<'a>(plans: impl IntoIterator<Item = &'a PlanMesh> + Clone) -> f64 {
    let mut covered = Covered::new(plans.clone());
    let mut overlap = 0.0;
    for triangle in plans.into_iter().flat_map(PlanMesh::corners) {
        let corners = triangle.map(|corner| corner.at);
        for over in covered.near(&corners) {
            overlap += shared_m2(&corners, &covered.triangles[over]);
        }
        covered.add(corners);
    }
    overlap
}

/// What of `plan` lies on `ground`, whose own triangles do not overlap; its texture is kept.
pub fn within(plan: &PlanMesh, ground: &PlanMesh) -> PlanMesh {
    let mut covered = Covered::new([plan, ground]);
    ground.corners().for_each(|triangle| covered.add(triangle.map(|corner| corner.at)));
    let mut inside = PlanMesh::default();
    let (mut piece, mut scratch) = (Vec::new(), Vec::new());
    for triangle in plan.corners() {
        let (corners, texture) = (triangle.map(|corner| corner.at), TextureMap::of(triangle));
        for under in covered.near(&corners) {
            piece.clear();
            piece.extend(corners);
            polygon::clip_convex(&mut piece, &mut scratch, &covered.triangles[under]);
            for corners in fan(&piece) {
                let ids = corners.map(|at| inside.vertex(PlanVertex { at, uv: texture.at(at) }));
                inside.triangle(ids);
            }
        }
    }
    inside
}

/// The triangles laid so far.
struct Covered {
    triangles: Vec<[DVec2; 3]>,
    squares: BTreeMap<(i64, i64), Vec<usize>>,
    side: f64,
}

impl Covered {
    /// Nothing yet, in a grid that suits the triangles to come.
    fn new<'a>(plans: impl IntoIterator<Item = &'a PlanMesh>) -> Self {
        let (mut sum, mut count) = (0.0, 0.0);
        for triangle in plans.into_iter().flat_map(PlanMesh::corners) {
            sum += Rect::around(triangle.map(|corner| corner.at)).size().max_element();
            count += 1.0;
        }
        // A square as large as a triangle holds a few of them, and a triangle lies in a few squares.
        let side = if count > 0.0 { f64::max(sum / count, 1.0) } else { 1.0 };
        Self { triangles: Vec::new(), squares: BTreeMap::new(), side }
    }

    /// What is left of a plan over which everything so far lies; it is then a part of everything.
    fn lay(&mut self, plan: &PlanMesh) -> PlanMesh {
        let mut left = PlanMesh::default();
        let mut kept: BTreeMap<VertexId, VertexId> = BTreeMap::new();
        for (&ids, triangle) in plan.triangles.iter().zip(plan.corners()) {
            let corners = triangle.map(|corner| corner.at);
            let over = self.near(&corners);
            if !over.iter().any(|&over| shared_m2(&corners, &self.triangles[over]) > SLIVER_M2) {
                let mut keep =
                    |id: VertexId| *kept.entry(id).or_insert_with(|| left.vertex(plan.vertices[id.index()]));
                let ids = ids.map(&mut keep);
                left.triangle(ids);
                self.add(corners);
                continue;
            }
            let texture = TextureMap::of(triangle);
            for piece in self.uncovered(&corners, &over) {
                for corners in fan(&piece) {
                    let ids = corners.map(|at| left.vertex(PlanVertex { at, uv: texture.at(at) }));
                    left.triangle(ids);
                    self.add(corners);
                }
            }
        }
        left
    }

    /// The convex pieces of a triangle that none of the triangles `over` covers.
    fn uncovered(&self, corners: &[DVec2; 3], over: &[usize]) -> Vec<Vec<DVec2>> {
        let mut pieces = vec![corners.to_vec()];
        for &over in over {
            let window = &self.triangles[over];
            let mut kept = Vec::with_capacity(pieces.len());
            for piece in pieces {
                if shared_m2(&piece, window) > SLIVER_M2 {
                    polygon::cut_away(piece, window, &mut kept);
                } else {
                    kept.push(piece);
                }
            }
            pieces = kept;
        }
        pieces.retain(|piece| polygon::doubled_area(piece) > 2.0 * SLIVER_M2);
        pieces
    }

    fn add(&mut self, corners: [DVec2; 3]) {
        let index = self.triangles.len();
        self.triangles.push(corners);
        for square in squares(&corners, self.side) {
            self.squares.entry(square).or_default().push(index);
        }
    }

    /// The triangles that may overlap this one, in the order in which they were laid.
    fn near(&self, corners: &[DVec2; 3]) -> Vec<usize> {
        let mut near: Vec<usize> = squares(corners, self.side)
            .filter_map(|square| self.squares.get(&square))
            .flatten()
            .copied()
            .collect();
        near.sort_unstable();
        near.dedup();
        near
    }
}

/// The squares that the rectangle around a triangle meets.
fn squares(corners: &[DVec2; 3], side: f64) -> impl Iterator<Item = (i64, i64)> + use<> {
    let bounds = Rect::around(*corners);
    let (low, high) = ((bounds.min / side).floor(), (bounds.max / side).floor());
    (low.y as i64..=high.y as i64).flat_map(move |y| (low.x as i64..=high.x as i64).map(move |x| (x, y)))
}

/// The area that two convex polygons share.
fn shared_m2(polygon: &[DVec2], window: &[DVec2; 3]) -> f64 {
    if !polygon::bounds(polygon).meets(&polygon::bounds(window)) {
        return 0.0;
    }
    let (mut piece, mut scratch) = (polygon.to_vec(), Vec::new());
    polygon::clip_convex(&mut piece, &mut scratch, window);
    if piece.len() < 3 { 0.0 } else { polygon::doubled_area(&piece) / 2.0 }
}

/// A convex polygon in triangles; those without an area, which cutting at a corner leaves, are left out.
fn fan(piece: &[DVec2]) -> impl Iterator<Item = [DVec2; 3]> + '_ {
    let pairs = piece.get(1..).unwrap_or_default().windows(2).map(|pair| [piece[0], pair[0], pair[1]]);
    pairs.filter(|corners| polygon::doubled_area(corners) > 2.0 * SLIVER_M2)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::polyline::Polyline;
    use crate::ribbon::stroke::{Continuations, StrokeOptions, stroke};
    use proptest::prelude::*;

    fn ribbon(points: &[(f64, f64)], width_m: f64) -> PlanMesh {
        let line = Polyline::new(points.iter().map(|&(x, y)| DVec2::new(x, y)), 0.01).expect("a line");
        let mut plan = PlanMesh::default();
        let options = StrokeOptions { width_m, ..StrokeOptions::default() };
        stroke(&line, Continuations::default(), &options, &mut plan);
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
    fn a_bevelled_bend_lies_over_itself_no_more() {
        let bend = [ribbon(&[(0.0, 0.0), (100.0, 0.0), (60.0, 8.0)], 12.0)];
        assert!(overlap_m2(&bend) > 10.0);
        assert!(overlap_m2(&apart(&bend)) < 1e-2);
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
            let whole = crate::geom::region::Region::covered(rings.iter().map(|ring| &ring[..])).area();
            let area: f64 = parts.iter().map(PlanMesh::area_m2).sum();
            prop_assert!((whole - area).abs() < 0.2, "{whole} {area}");
        }
    }
}
