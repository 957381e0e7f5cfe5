//! Along a line from block to block: over those that rule themselves out in one step, into the others.
//!
//! ```text
//!            side 16 ┌───────────────┐
//!                    │               │      from a block that ruled itself out on to the next one as large, or to the
//!   side 4 ┌──┬──┐   │    one step   │      next one larger where the borders of both are one; into one that did not,
//!      ────┼──┼──┼───┼───────────────┼──►   down to single cells and the crossings in them
//!          └──┴──┘   │               │
//!                    └───────────────┘
//! ```
//!
//! What is asked is up to a [`Probe`]. It sees the crossings of every cell that it did not rule out, in order, with the
//! values that [`crossings`](crate::terrain::sight::crossings::crossings) finds, to the last bit: where a block ends is
//! where the line meets its border's column or row of posts, by the same division, and a crossing's height is told by
//! the same functions. A probe that rules out only what it would not have answered to therefore answers as if it had
//! seen all.
//!
//! There is no stack, and no position is turned into a block: each axis keeps its block's number and the part at which
//! the line leaves it. Going up drops the number's last bits; going down asks whether the line has passed the block's
//! middle, whose part is the nearer half's exit.

use std::ops::ControlFlow;

use glam::DVec2;

use crate::terrain::lattice::Lattice;
use crate::terrain::sight::crossings::{CellEdge, LineCrossing, LinePart, crossing_at, diagonal_between};
use crate::terrain::sight::pyramid::{FACTOR_BITS, FINEST_BITS, Pyramid};

/// What is asked of the ground along a line.
pub(in crate::terrain) trait Probe {
    /// What ends the walk.
    type Found;

    /// Whether no crossing between these parts can matter, on ground that is nowhere there higher than `highest_m` nor,
    /// should the probe ask, lower than `lowest_m` tells.
    fn rules_out(&self, parts: LinePart, highest_m: f64, lowest_m: impl FnOnce() -> f64) -> bool;

    /// Is told that what was last seen lies before cells that were ruled out, and that crossings from this part on come
    /// next; that at the part itself is among them, where there is one.
    fn resume(&mut self, _part: f64) {}

    /// Looks at a crossing.
    fn see(&mut self, crossing: LineCrossing) -> ControlFlow<Self::Found>;

    /// Is told that all crossings up to the line's end were seen since the walk last resumed.
    fn finish(&mut self) {}
}

/// Shows `probe` the crossings of the line `from`..`to` in order, but for those of cells and blocks that it rules out.
/// Both ends are grid positions on the lattice, of which `pyramid` is.
pub(in crate::terrain) fn descend<P: Probe>(
    lattice: &Lattice,
    pyramid: &Pyramid,
    (from, to): (DVec2, DVec2),
    probe: &mut P,
) -> ControlFlow<P::Found> {
    let mut x = AxisWalk::new(from.x, to.x, lattice.columns() - 1);
    let mut y = AxisWalk::new(from.y, to.y, lattice.rows() - 1);
    let top_bits = pyramid.top_bits();
    let (mut bits, mut part, mut entered) = (0, 0.0, None);
    let mut was_seen = false;
    loop {
        let out = x.exit.min(y.exit).min(1.0);
        let parts = (part, out);
        let ruled_out = if bits == 0 {
            let corners = corners(lattice, x.block, y.block);
            probe.rules_out(parts, highest_of(corners), || lowest_of(corners))
        } else {
            let block = [x.block, y.block];
            let highest = f64::from(pyramid.highest(bits, block));
            probe.rules_out(parts, highest, || f64::from(pyramid.lowest(bits, block)))
        };
        if !ruled_out && bits > 0 {
            let halvings = if bits == FINEST_BITS { FINEST_BITS } else { FACTOR_BITS };
            for _ in 0..halvings {
                bits -= 1;
                x.halve(bits, part);
                y.halve(bits, part);
            }
            continue;
        }
        let (leaves_x, leaves_y) = (x.exit == out, y.exit == out);
        let left = if out < 1.0 { Some(edge_left(&x, &y, leaves_x, leaves_y, bits)) } else { None };
        if !ruled_out {
            if !was_seen {
                probe.resume(part);
                if let Some(edge) = entered {
                    probe.see(crossing_at(lattice, (from, to), part, edge))?;
                }
            }
            if let Some(crossing) = diagonal_between(lattice, from, to, parts) {
                probe.see(crossing)?;
            }
            match left {
                Some(edge) => probe.see(crossing_at(lattice, (from, to), out, edge))?,
                None => probe.finish(),
            }
        }
        if left.is_none() {
            return ControlFlow::Continue(());
        }
        was_seen = !ruled_out;
        (part, entered) = (out, left);
        let rising_bits = if bits == 0 { FINEST_BITS } else { FACTOR_BITS };
        let mut rises = (ruled_out || bits == 0) && bits < top_bits;
        let mut leaves_larger = false;
        if leaves_x {
            x.advance(bits);
            leaves_larger |= x.is_first_of(rising_bits);
        }
        if leaves_y {
            y.advance(bits);
            leaves_larger |= y.is_first_of(rising_bits);
        }
        rises &= leaves_larger;
        if rises {
            x.rise(bits, rising_bits);
            y.rise(bits, rising_bits);
            bits += rising_bits;
        }
    }
}

/// The edge by which the line leaves the block.
#[inline]
fn edge_left(x: &AxisWalk, y: &AxisWalk, leaves_x: bool, leaves_y: bool, bits: u32) -> CellEdge {
    match (leaves_x, leaves_y) {
        (true, true) => CellEdge::Post(DVec2::new(x.far_line(bits), y.far_line(bits))),
        (true, false) => CellEdge::Column(x.far_line(bits)),
        _ => CellEdge::Row(y.far_line(bits)),
    }
}

/// As [`Lattice::corner_heights`].
#[inline]
fn corners(lattice: &Lattice, column: u32, row: u32) -> [f32; 4] {
    let stride = lattice.columns() as usize;
    let south = row as usize * stride + column as usize;
    let heights = &lattice.heights()[south..south + stride + 2];
    [heights[0], heights[1], heights[stride], heights[stride + 1]]
}

fn highest_of(corners: [f32; 4]) -> f64 {
    f64::from(corners[0].max(corners[1]).max(corners[2].max(corners[3])))
}

fn lowest_of(corners: [f32; 4]) -> f64 {
    f64::from(corners[0].min(corners[1]).min(corners[2].min(corners[3])))
}

/// One coordinate of a line, and the block that it is in.
struct AxisWalk {
    from: f64,
    length: f64,
    /// 1 where the coordinate grows or stays, 0 where it falls: what is added to a block's number for its far border.
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
        // `from` lies on the lattice and is not below 0, where casting rounds down.
        let behind = from as u32;
        let on_line = f64::from(behind) == from;
        let block = if ahead == 0 && on_line { behind.saturating_sub(1) } else { behind.min(cells - 1) };
        // A line that stays on the lattice's far border runs along the last cells.
        let from = if length == 0.0 { from.min(f64::from(cells) - 0.5) } else { from };
        let mut axis = Self { from, length, ahead, block, exit: 0.0 };
        axis.exit = axis.part(axis.far_line(0));
        axis
    }

    /// The part at which the line meets a column or row of posts, as `crossings` has it.
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

    /// Whether the line comes into a block of 2^`larger_bits` of these, along a side, with this one.
    #[inline]
    fn is_first_of(&self, larger_bits: u32) -> bool {
        let last = (1 << larger_bits) - 1;
        self.block & last == if self.ahead == 1 { 0 } else { last }
    }

    /// To the block of 2^`larger_bits` of these along a side.
    #[inline]
    fn rise(&mut self, bits: u32, larger_bits: u32) {
        let border = (self.block + self.ahead) << bits;
        self.block >>= larger_bits;
        if (self.block + self.ahead) << (bits + larger_bits) != border {
            self.exit = self.part(self.far_line(bits + larger_bits));
        }
    }

    /// To the half of the block, now with sides of 2^`bits` cells, in which the line runs on from `part`.
    #[inline]
    fn halve(&mut self, bits: u32, part: f64) {
        let middle = self.part(f64::from((2 * self.block + 1) << bits));
        let passed = middle <= part;
        if !passed {
            self.exit = middle;
        }
        self.block = 2 * self.block + u32::from(passed == (self.ahead == 1));
    }
}
