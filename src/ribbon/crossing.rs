//! The ground that ribbons share where their lines cross, or run beside one another, without a vertex in common.
//!
//! Ribbons are convex pieces, so what two of them share is a convex polygon: found pair by pair, with a tree of rectangles
//! that leaves out the pairs that are far apart. What lies in a junction already is left out too.

use glam::DVec2;
use rayon::prelude::*;

use crate::junction::JunctionNode;
use crate::plan::PlanMesh;
use sandtable_geom::convex;
use sandtable_geom::polygon;
use sandtable_geom::rect::Rect;
use sandtable_geom::rect_tree::RectTree;

/// Ground smaller than this is rounding, in square meters: a sliver of 10 m by 0.1 mm.
const SLIVER_M2: f64 = 1e-3;

/// A piece that overlaps more others than this is shared as a whole, so that overlaps do not grow with the square.
const MOST: usize = 64;

/// Ground that two ribbons share.
#[derive(Clone, Debug, PartialEq)]
pub struct RibbonOverlap {
    /// Convex, counter-clockwise.
    pub outline: Vec<DVec2>,
    /// Which two, the lesser number first.
    pub ribbons: [usize; 2],
}

/// The ground that `ribbons` of one kind share outside `nodes`, in the order of the ribbons. Crossings may overlap one
/// another.
pub fn crossings(
    ribbons: &[PlanMesh],
    are_alike: impl Fn(usize, usize) -> bool + Sync,
    nodes: &[JunctionNode],
) -> Vec<RibbonOverlap> {
    let pieces_of = |(ribbon, plan): (usize, &PlanMesh)| {
        plan.convex_parts().into_iter().map(move |outline| ConvexPiece { outline, ribbon })
    };
    let pieces: Vec<ConvexPiece> = ribbons.par_iter().enumerate().flat_map_iter(pieces_of).collect();
    let rects: Vec<Rect> = pieces.par_iter().map(|piece| polygon::bounds(&piece.outline)).collect();
    let (tree, joined) = rayon::join(|| RectTree::new(&rects), || Joined::new(nodes));
    let shared = |one: &ConvexPiece| {
        let mut found = Vec::new();
        for other in tree.meeting_in_order(&polygon::bounds(&one.outline)) {
            let other = &pieces[other];
            if other.ribbon < one.ribbon && are_alike(other.ribbon, one.ribbon) {
                found.extend(crossing([other, one]).filter(|crossing| !joined.holds(&crossing.outline)));
            }
            if found.len() > MOST {
                break;
            }
        }
        if found.len() > MOST {
            found.truncate(1);
            found[0].outline.clone_from(&one.outline);
        }
        found.sort_by_key(|crossing| crossing.ribbons);
        found
    };
    pieces.par_iter().flat_map_iter(shared).collect()
}

struct ConvexPiece {
    outline: Vec<DVec2>,
    ribbon: usize,
}

fn crossing([one, other]: [&ConvexPiece; 2]) -> Option<RibbonOverlap> {
    let outline = convex::intersection(&one.outline, &other.outline, SLIVER_M2)?;
    Some(RibbonOverlap { outline, ribbons: [one.ribbon, other.ribbon] })
}

struct Joined<'a> {
    nodes: &'a [JunctionNode],
    tree: RectTree,
}

impl<'a> Joined<'a> {
    fn new(nodes: &'a [JunctionNode]) -> Self {
        let rects: Vec<Rect> = nodes.iter().map(|node| polygon::bounds(&node.outline)).collect();
        Self { nodes, tree: RectTree::new(&rects) }
    }

    /// Whether one of them covers all of a convex polygon.
    fn holds(&self, outline: &[DVec2]) -> bool {
        let covers = |node: usize| outline.iter().all(|&at| convex::touches(&self.nodes[node].outline, at));
        self.tree.meeting(&polygon::bounds(outline)).any(covers)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stroke::{StrokeOptions, StrokePath, stroke};
    use sandtable_earthworks::alignment::Alignment;
    use sandtable_geom::polyline::Polyline;

    fn ribbon(points: [(f64, f64); 2], width_m: f64) -> PlanMesh {
        let line = Polyline::new(points.map(DVec2::from), 0.0).expect("a line");
        let mut plan = PlanMesh::default();
        let alignment = Alignment::on_ground(line, width_m);
        stroke(&StrokePath::alone(&alignment), &StrokeOptions::default(), &mut plan);
        plan
    }

    #[test]
    fn a_crossing_is_what_both_cover_however_it_is_turned() {
        for quarter in 0..4 {
            let turn = |point: (f64, f64)| (0..quarter).fold(point, |(x, y), _| (-y, x));
            let along = ribbon([(-50.0, 0.0), (50.0, 0.0)].map(turn), 8.0);
            let across = ribbon([(0.0, -50.0), (0.0, 60.0)].map(turn), 6.0);
            let ribbons = [along, across];
            let found = crossings(&ribbons, |_, _| true, &[]);
            let area: f64 = found.iter().map(|crossing| polygon::doubled_area(&crossing.outline) / 2.0).sum();
            assert!((area - 48.0).abs() < 1e-9, "{area}");
            assert!(found.iter().all(|crossing| crossing.ribbons == [0, 1]));
            assert!(crossings(&ribbons, |_, _| false, &[]).is_empty(), "not alike");
            let square = [(-9.0, -9.0), (9.0, -9.0), (9.0, 9.0), (-9.0, 9.0)].map(DVec2::from).to_vec();
            let node = JunctionNode { outline: square, street: 0, rank: 0 };
            assert!(crossings(&ribbons, |_, _| true, &[node]).is_empty(), "joined already");
        }
    }
}
