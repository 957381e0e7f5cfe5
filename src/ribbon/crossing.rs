//! The ground that ribbons share where their lines cross, or run beside one another, without a vertex in common.
//!
//! Ribbons are convex pieces, so what two of them share is a convex polygon: found pair by pair, with a tree of rectangles
//! that leaves out the pairs that are far apart. What lies in a junction already is left out too.

use glam::DVec2;
use rayon::prelude::*;

use crate::geom::convex;
use crate::geom::polygon;
use crate::geom::rect::Rect;
use crate::geom::rect_tree::RectTree;
use crate::ribbon::junction::Node;
use crate::ribbon::plan::PlanMesh;

/// Ground smaller than this is rounding, in square metres: a sliver of 10 m by 0.1 mm.
const SLIVER_M2: f64 = 1e-3;

/// Ground that two ribbons share.
#[derive(Clone, Debug, PartialEq)]
pub struct Crossing {
    /// Convex, counter-clockwise.
    pub outline: Vec<DVec2>,
    /// Which two, the lesser number first.
    pub ribbons: [usize; 2],
}

/// A convex piece of a ribbon.
struct Piece {
    outline: Vec<DVec2>,
    ribbon: usize,
}

/// What the `ribbons` share that are alike by `class`, outside `nodes`: in the order of the ribbons. Crossings may
/// overlap one another.
pub fn crossings<C: PartialEq + Sync>(ribbons: &[(PlanMesh, C)], nodes: &[Node]) -> Vec<Crossing> {
    let pieces: Vec<Piece> = ribbons
        .par_iter()
        .enumerate()
        .flat_map_iter(|(ribbon, (plan, _))| {
            plan.convex_parts().into_iter().map(move |outline| Piece { outline, ribbon })
        })
        .collect();
    let rects: Vec<Rect> = pieces.iter().map(|piece| polygon::bounds(&piece.outline)).collect();
    let tree = RectTree::new(&rects);
    let joined = Joined::new(nodes);
    let of_piece = |index: usize| {
        let one = &pieces[index];
        let mut before = Vec::new();
        tree.visit(&rects[index], &mut |other| {
            if pieces[other].ribbon < one.ribbon && ribbons[pieces[other].ribbon].1 == ribbons[one.ribbon].1 {
                before.push(other);
            }
        });
        before.sort_unstable();
        let crossing = |other: usize| {
            let outline = convex::shared(&one.outline, &pieces[other].outline, SLIVER_M2)?;
            (!joined.holds(&outline))
                .then_some(Crossing { outline, ribbons: [pieces[other].ribbon, one.ribbon] })
        };
        before.into_iter().filter_map(crossing).collect::<Vec<_>>()
    };
    (0..pieces.len()).into_par_iter().flat_map_iter(of_piece).collect()
}

/// The junctions there are.
struct Joined<'a> {
    nodes: &'a [Node],
    tree: RectTree,
}

impl<'a> Joined<'a> {
    fn new(nodes: &'a [Node]) -> Self {
        let rects: Vec<Rect> = nodes.iter().map(|node| polygon::bounds(&node.outline)).collect();
        Self { nodes, tree: RectTree::new(&rects) }
    }

    /// Whether one of them covers all of a convex polygon.
    fn holds(&self, outline: &[DVec2]) -> bool {
        let mut held = false;
        self.tree.visit(&polygon::bounds(outline), &mut |node| {
            let node = &self.nodes[node].outline;
            held = held || outline.iter().all(|&corner| convex::contains(node, corner));
        });
        held
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::polyline::Polyline;
    use crate::ribbon::stroke::{Continuations, StrokeOptions, stroke};

    fn ribbon(points: [(f64, f64); 2], width_m: f64) -> PlanMesh {
        let line = Polyline::new(points.map(DVec2::from), 0.0).expect("a line");
        let mut plan = PlanMesh::default();
        let options = StrokeOptions { width_m, ..StrokeOptions::default() };
        stroke(&line, Continuations::default(), &options, &mut plan);
        plan
    }

    #[test]
    fn a_crossing_is_what_both_cover_however_it_is_turned() {
        for quarter in 0..4 {
            let turn = |point: (f64, f64)| (0..quarter).fold(point, |(x, y), _| (-y, x));
            let along = ribbon([(-50.0, 0.0), (50.0, 0.0)].map(turn), 8.0);
            let across = ribbon([(0.0, -50.0), (0.0, 60.0)].map(turn), 6.0);
            let found = crossings(&[(along.clone(), 0), (across.clone(), 0)], &[]);
            let area: f64 = found.iter().map(|crossing| polygon::doubled_area(&crossing.outline) / 2.0).sum();
            assert!((area - 48.0).abs() < 1e-9, "{area}");
            assert!(found.iter().all(|crossing| crossing.ribbons == [0, 1]));
            assert!(crossings(&[(along.clone(), 0), (across.clone(), 1)], &[]).is_empty(), "not alike");
            let square = [(-9.0, -9.0), (9.0, -9.0), (9.0, 9.0), (-9.0, 9.0)].map(DVec2::from).to_vec();
            let node = Node { outline: square, street: 0, rank: 0 };
            assert!(crossings(&[(along, 0), (across, 0)], &[node]).is_empty(), "joined already");
        }
    }
}
