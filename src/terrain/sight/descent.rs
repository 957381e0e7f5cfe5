//! A walk along a line from block to block of the [`Pyramid`]: over blocks that are ruled out in one step, into the
//! others.
//!
//! ```text
//!            side 16 ┌───────────────┐
//!                    │               │      from a block that is ruled out to the next one as large, or to the next
//!   side 4 ┌──┬──┐   │    one step   │      larger one where the borders of both coincide; into any other, down to
//!      ────┼──┼──┼───┼───────────────┼──►   single cells and the crossings in them
//!          └──┴──┘   │               │
//!                    └───────────────┘
//! ```
//!
//! A [`Probe`] decides which blocks are ruled out. It visits the crossings of every other cell, in order, with the values
//! that [`crossings`](crate::sight::crossings::crossings) computes, to the last bit: a block ends where the line
//! meets its border's column or row of posts, by the same division, and the same functions compute a crossing's height. So
//! a probe that rules out only crossings without effect on its answer answers as if it had visited all.
//!
//! There is no stack, and no position is converted to a block: each axis keeps its block's number and the part at which the
//! line leaves it. Ascending drops the number's last bits; descending compares the line's part with that of the block's
//! middle, which is the nearer half's exit.

use std::ops::ControlFlow;

use glam::DVec2;

use crate::lattice::{Lattice, Post};
use crate::pyramid::{FINEST_BITS, Pyramid};
use crate::sight::crossings::{CellEdge, LineCrossing, LinePart, crossing_at, diagonal_between};

/// A search along a line.
pub(crate) trait Probe {
    /// The result that ends the walk.
    type Found;

    /// Whether no crossing in this part of the line has an effect, on ground that is nowhere there higher than `highest_m`
    /// nor lower than `lowest_m()`.
    fn rules_out(&self, part: LinePart, highest_m: f64, lowest_m: impl FnOnce() -> f64) -> bool;

    /// Resets what depends on the crossing before: cells were ruled out since, and the next crossing, one at `_part` itself
    /// included, follows them.
    fn resume(&mut self, _part: f64) {}

    /// Visits a crossing.
    fn visit(&mut self, crossing: LineCrossing) -> ControlFlow<Self::Found>;

    /// Notes that all crossings up to the line's end were visited since the walk last resumed.
    fn finish(&mut self) {}
}

/// Shows `probe` the crossings of the line `from`..`to` in order, except those of blocks that it rules out. Both ends are
/// grid positions on the lattice, whose pyramid is `pyramid`.
pub(crate) fn descend<P: Probe>(
    lattice: &Lattice,
    pyramid: &Pyramid,
    ends: (DVec2, DVec2),
    probe: &mut P,
) -> ControlFlow<P::Found> {
    let mut walk = BlockWalk::new(lattice, ends);
    let (mut part, mut entered, mut was_visited) = (0.0, None, false);
    loop {
        let exit = walk.exit();
        let block_part = (part, exit);
        let is_ruled_out = walk.is_ruled_out(lattice, pyramid, block_part, probe);
        if !is_ruled_out && walk.bits > 0 {
            walk.descend(part);
            continue;
        }
        let edge = (exit < 1.0).then(|| walk.exit_edge(exit));
        if !is_ruled_out {
            if !was_visited {
                probe.resume(part);
                if let Some(edge) = entered {
                    probe.visit(crossing_at(lattice, ends, part, edge))?;
                }
            }
            if let Some(crossing) = diagonal_between(lattice, ends, block_part) {
                probe.visit(crossing)?;
            }
            match edge {
                Some(edge) => probe.visit(crossing_at(lattice, ends, exit, edge))?,
                None => probe.finish(),
            }
        }
        if edge.is_none() {
            return ControlFlow::Continue(());
        }
        was_visited = !is_ruled_out;
        (part, entered) = (exit, edge);
        walk.advance(exit, pyramid.top_bits());
    }
}

/// The block that a line is in.
struct BlockWalk {
    x: AxisWalk,
    y: AxisWalk,
    /// The block's side is 2 to this power, in cells.
    bits: u32,
}

impl BlockWalk {
    fn new(lattice: &Lattice, (from, to): (DVec2, DVec2)) -> Self {
        let x = AxisWalk::new(from.x, to.x, lattice.columns() - 1);
        Self { x, y: AxisWalk::new(from.y, to.y, lattice.rows() - 1), bits: 0 }
    }

    /// The part at which the line leaves the block, at most 1.
    #[inline]
    fn exit(&self) -> f64 {
        self.x.exit.min(self.y.exit).min(1.0)
    }

    #[inline]
    fn is_ruled_out(&self, lattice: &Lattice, pyramid: &Pyramid, part: LinePart, probe: &impl Probe) -> bool {
        let block = Post { column: self.x.block, row: self.y.block };
        if self.bits == 0 {
            let [a, b, c, d] = lattice.corner_heights(block);
            let highest_m = f64::from(a.max(b).max(c.max(d)));
            probe.rules_out(part, highest_m, || f64::from(a.min(b).min(c.min(d))))
        } else {
            let highest_m = f64::from(pyramid.highest(self.bits, block));
            probe.rules_out(part, highest_m, || f64::from(pyramid.lowest(self.bits, block)))
        }
    }

    /// The edge by which the line leaves the block.
    #[inline]
    fn exit_edge(&self, exit: f64) -> CellEdge {
        match (self.x.exit == exit, self.y.exit == exit) {
            (true, true) => {
                CellEdge::Post(DVec2::new(self.x.far_line(self.bits), self.y.far_line(self.bits)))
            }
            (true, false) => CellEdge::Column(self.x.far_line(self.bits)),
            _ => CellEdge::Row(self.y.far_line(self.bits)),
        }
    }

    /// To the next smaller block that holds the line after `part`.
    #[inline]
    fn descend(&mut self, part: f64) {
        let halvings = if self.bits == FINEST_BITS { FINEST_BITS } else { 1 };
        for _ in 0..halvings {
            self.bits -= 1;
            self.x.halve(self.bits, part);
            self.y.halve(self.bits, part);
        }
    }

    /// To the next block, and from there to the larger one of at most 2^`top_bits` cells a side that the line enters with
    /// it.
    #[inline]
    fn advance(&mut self, exit: f64, top_bits: u32) {
        let doublings = if self.bits == 0 { FINEST_BITS } else { 1 };
        let mut enters_larger = false;
        for axis in [&mut self.x, &mut self.y] {
            if axis.exit == exit {
                axis.advance(self.bits);
                enters_larger |= axis.is_first_of(doublings);
            }
        }
        if enters_larger && self.bits < top_bits {
            self.x.ascend(self.bits, doublings);
            self.y.ascend(self.bits, doublings);
            self.bits += doublings;
        }
    }
}

/// One coordinate of a line, and the block that it is in.
struct AxisWalk {
    from: f64,
    length: f64,
    /// 1 where the coordinate grows or stays, 0 where it falls: added to a block's number it gives its far border.
    ahead: u32,
    /// The block, counted from the lattice's first.
    block: u32,
    /// The part at which the line leaves it.
    exit: f64,
}

impl AxisWalk {
    /// In the cell ahead of the line's start.
    fn new(from: f64, to: f64, cells: u32) -> Self {
        let length = to - from;
        let ahead = u32::from(length >= 0.0);
        // `from` lies on the lattice and is not below 0, so casting rounds down.
        let behind = from as u32;
        let is_on_line = f64::from(behind) == from;
        let block = if ahead == 0 && is_on_line { behind.saturating_sub(1) } else { behind.min(cells - 1) };
        // A line that stays on the lattice's far border runs along the last cells.
        let from = if length == 0.0 { from.min(f64::from(cells) - 0.5) } else { from };
        let mut axis = Self { from, length, ahead, block, exit: 0.0 };
        axis.exit = axis.part(axis.far_line(0));
        axis
    }

    /// The part at which the line meets a column or row of posts, as `crossings` computes it.
    #[inline]
    fn part(&self, line: f64) -> f64 {
        if self.length == 0.0 {
            return if line <= self.from { f64::NEG_INFINITY } else { f64::INFINITY };
        }
        (line - self.from) / self.length
    }

    /// The column or row of posts at the block's far border.
    #[inline]
    fn far_line(&self, bits: u32) -> f64 {
        f64::from((self.block + self.ahead) << bits)
    }

    /// To the next block of the same size.
    #[inline]
    fn advance(&mut self, bits: u32) {
        // At the lattice's border the line has ended before.
        self.block = self.block.wrapping_add(2 * self.ahead).wrapping_sub(1);
        self.exit = self.part(self.far_line(bits));
    }

    /// Whether this block is the first that the line enters of a larger one, of 2^`doublings` such blocks a side.
    #[inline]
    fn is_first_of(&self, doublings: u32) -> bool {
        let last = (1 << doublings) - 1;
        self.block & last == if self.ahead == 1 { 0 } else { last }
    }

    /// To the larger block, of 2^`doublings` such blocks a side.
    #[inline]
    fn ascend(&mut self, bits: u32, doublings: u32) {
        let border = (self.block + self.ahead) << bits;
        self.block >>= doublings;
        if (self.block + self.ahead) << (bits + doublings) != border {
            self.exit = self.part(self.far_line(bits + doublings));
        }
    }

    /// To the half of the block, now with sides of 2^`bits` cells, that holds the line after `part`.
    #[inline]
    fn halve(&mut self, bits: u32, part: f64) {
        let middle = self.part(f64::from((2 * self.block + 1) << bits));
        let is_passed = middle <= part;
        if !is_passed {
            self.exit = middle;
        }
        self.block = 2 * self.block + u32::from(is_passed == (self.ahead == 1));
    }
}
