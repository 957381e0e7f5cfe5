//! Along a line from block to block: over those that rule themselves out in one step, into the others.
//!
//! ```text
//!            level 2 ┌───────────────┐
//!                    │               │      the line leaves a block that ruled itself out where the line meets
//!  level 0 ┌──┬──┐   │    one step   │      the next column or row of posts at its border, and tries the block
//!      ────┼──┼──┼───┼───────────────┼──►   above where the borders of both are one
//!          └──┴──┘   │               │
//!                    └───────────────┘
//! ```
//!
//! What is asked is up to a [`Probe`]. It sees the crossings of every block that it did not rule out, in order and the
//! same to the last bit as [`crossings`](crate::terrain::sight::crossings::crossings) finds them: both stand on the same
//! walk, and a walk always begins at a crossing. A probe that rules out only blocks whose crossings it would not have
//! answered to therefore answers as if it had seen all.
//!
//! There is no stack: the block at hand follows from the position and the level, so that going up costs nothing.

use std::ops::ControlFlow;

use glam::DVec2;

use crate::terrain::lattice::Lattice;
use crate::terrain::sight::crossings::{Crossing, POSITION_ERROR, Parts, crossings_within};
use crate::terrain::sight::pyramid::{FACTOR, Pyramid};

/// What is asked of the ground along a line.
pub(in crate::terrain) trait Probe {
    /// What ends the walk.
    type Found;

    /// Whether no crossing between these parts can matter, on ground that is nowhere there higher than `highest_m` nor,
    /// should the probe ask, lower than `lowest_m` tells.
    fn rules_out(&self, parts: Parts, highest_m: f64, lowest_m: impl FnOnce() -> f64) -> bool;

    /// Is told that the crossings between these parts come next, all of them.
    fn enter(&mut self, _parts: Parts) {}

    /// Looks at a crossing. One at the border of two blocks may be shown twice in a row.
    fn see(&mut self, crossing: Crossing) -> ControlFlow<Self::Found>;
}

/// Shows `probe` the crossings of the line `from`..`to` in order, but for those of blocks that it rules out. Both ends
/// are grid positions on the lattice, of which `pyramid` is.
pub(in crate::terrain) fn descend<P: Probe>(
    lattice: &Lattice,
    pyramid: &Pyramid,
    (from, to): (DVec2, DVec2),
    probe: &mut P,
) -> ControlFlow<P::Found> {
    let axes = [
        Axis::new(from.x, to.x, lattice.columns() - 1),
        Axis::new(from.y, to.y, lattice.rows() - 1),
    ];
    let top = pyramid.levels() - 1;
    let (mut level, mut part) = (0, 0.0);
    loop {
        let bits = Pyramid::side_bits(level);
        let block = [axes[0].cell(part) >> bits, axes[1].cell(part) >> bits];
        let exits = [axes[0].exit(block[0], bits), axes[1].exit(block[1], bits)];
        let out = exits[0].min(exits[1]).min(1.0);
        let highest_m = f64::from(pyramid.highest(level, block));
        let ruled_out =
            probe.rules_out((part, out), highest_m, || f64::from(pyramid.lowest(level, block)));
        if !ruled_out && level > 0 {
            level -= 1;
            continue;
        }
        if !ruled_out {
            probe.enter((part, out));
            crossings_within(lattice, from, to, (part, out), |crossing| probe.see(crossing))?;
        }
        if out >= 1.0 {
            return ControlFlow::Continue(());
        }
        let axis = usize::from(exits[1] < exits[0]);
        if ruled_out && level < top && axes[axis].leaves_parent(block[axis]) {
            level += 1;
        }
        part = part.max(out);
    }
}

/// One coordinate of a line, in cells.
struct Axis {
    from: f64,
    length: f64,
    /// Added to a position so that one on a line of posts falls into the cell ahead.
    nudge: f64,
    last_cell: f64,
}

impl Axis {
    fn new(from: f64, to: f64, cells: u32) -> Self {
        let length = to - from;
        let nudge = if length < 0.0 { -POSITION_ERROR } else { POSITION_ERROR };
        Self { from, length, nudge, last_cell: f64::from(cells - 1) }
    }

    /// The cell ahead at a part of the line, within the lattice.
    #[inline]
    fn cell(&self, part: f64) -> u32 {
        // What is below 0 becomes 0.
        (self.from + self.length * part + self.nudge).min(self.last_cell) as u32
    }

    /// The part at which the line leaves a block with sides of 2^`bits` cells: that of the crossing with the column or
    /// row of posts there, as `crossings` has it; infinite where it never does.
    #[inline]
    fn exit(&self, block: u32, bits: u32) -> f64 {
        if self.length == 0.0 {
            return f64::INFINITY;
        }
        let ahead = u32::from(self.length > 0.0);
        let line = f64::from(block + ahead) * f64::from(1u32 << bits);
        (line - self.from) / self.length
    }

    /// Whether a line that leaves this block leaves the block of the level above as well.
    #[inline]
    fn leaves_parent(&self, block: u32) -> bool {
        let ahead = u32::from(self.length > 0.0);
        (block + ahead).is_multiple_of(FACTOR)
    }
}
