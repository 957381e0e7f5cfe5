//! Finds the legs of polylines that are near each other: an index for where lines cross.

use glam::DVec2;

use crate::polyline::Polyline;
use crate::rect::Rect;
use crate::rect_tree::RectTree;

/// A leg of one of several lines.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LineLeg {
    /// The index of the line.
    pub line: usize,
    /// Its ends.
    pub ends: [DVec2; 2],
    /// The stations of its ends.
    pub stations: [f64; 2],
}

impl LineLeg {
    /// The legs of the line that has this index.
    pub fn all(line: usize, polyline: &Polyline) -> impl Iterator<Item = Self> + '_ {
        let stations = polyline.stations().windows(2);
        polyline.legs().zip(stations).map(move |(ends, at)| Self { line, ends, stations: [at[0], at[1]] })
    }

    fn rect(&self) -> Rect {
        Rect::around(self.ends)
    }
}

/// Legs in a tree.
pub struct LegTree {
    legs: Vec<LineLeg>,
    tree: RectTree,
}

impl LegTree {
    /// The tree of `legs`.
    pub fn new(legs: Vec<LineLeg>) -> Self {
        let rects: Vec<Rect> = legs.iter().map(LineLeg::rect).collect();
        Self { tree: RectTree::new(&rects), legs }
    }

    /// The legs, in the given order.
    pub fn legs(&self) -> &[LineLeg] {
        &self.legs
    }

    /// The indices of the legs whose rectangles meet that of `leg`, in ascending order.
    pub fn near(&self, leg: &LineLeg) -> Vec<usize> {
        self.tree.meeting_in_order(&leg.rect())
    }
}
