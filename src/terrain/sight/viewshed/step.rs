//! Compares a ring with the one before: ground that faces the observer rises from each to the next, and then the new ring
//! alone is the horizon.
//!
//! ```text
//!      before j   ring j            On the ray of a post of the ring, the ring before lies between the post of the same
//!         o────────o                number and the one before it; on the ray of a post of the ring before, the ring lies
//!         │  ╲     │  rise          between the post of the same number and the next. So all are compared without a search.
//!         │    ╲ ──│──► u = y / x
//!         o────────o
//! ```

use std::ops::Range;

use crate::sight::viewshed::ring::PostRing;
use sandtable_base::vectorized::vectorized;

/// How the posts, edges and cells of a ring stand to the ring before; of blocks that may rise alone.
///
/// Everything on the ring before is known to the horizon, or lower: what is lower than that is hidden whatever else is.
#[derive(Default)]
pub(super) struct RingStep {
    /// `v` of a post over the ring before on the post's ray; NaN where either has none.
    pub rise: Vec<f64>,
    /// `v` of the edge from a post on, over the post of the same number on the ring before.
    over: Vec<f64>,
    /// `v` of the next post over the diagonal from a post in to the next on the ring before.
    pub bulge: Vec<f64>,
    /// `v` of the post of the same number on the ring before, over that diagonal.
    ledge: Vec<f64>,
    /// Whether the edge from a post on is higher than the ring before and all of the strip between.
    pub is_ahead: Vec<bool>,
    /// Whether it is lower than the ring before.
    pub is_behind: Vec<bool>,
    /// Whether the rung at a post and the diagonal of the cell that begins there are nowhere higher than both rings.
    is_flat: Vec<bool>,
}

/// How a ring lies to the one before.
#[derive(Clone, Copy)]
struct StepFrame {
    /// The index of a post in the ring before, less its index in the ring.
    shift: usize,
    /// 1 where the diagonal of the cell at the first post runs inward from the ring, else 0.
    inward: usize,
    /// The error of the ring before's edges.
    error: f64,
}

impl StepFrame {
    /// Whether the diagonal of a cell runs from the ring inward to the next post of the ring before.
    #[inline(always)]
    fn is_inward(self, index: usize) -> bool {
        (index + self.inward) % 2 == 1
    }
}

impl RingStep {
    /// Compares nothing.
    pub fn skip(&mut self, ring: &PostRing) {
        for flags in [&mut self.is_ahead, &mut self.is_behind, &mut self.is_flat] {
            flags.clear();
            flags.resize(ring.heights.len(), false);
        }
    }

    /// Compares the ring with the one before; `parity` is 0 where diagonals join the even posts of that. Its posts are seen where
    /// they were not.
    pub fn measure(&mut self, before: &mut PostRing, ring: &PostRing, parity: i64) {
        self.skip(ring);
        for values in [&mut self.rise, &mut self.over, &mut self.bulge, &mut self.ledge] {
            values.resize(ring.heights.len(), f64::NAN);
        }
        let Ok(shift) = usize::try_from(ring.first - before.first) else { return };
        let inward = (ring.first + parity).rem_euclid(2) as usize;
        let frame = StepFrame { shift, inward, error: before.edge_error };
        let mut posts = 0..0;
        while let Some(next) = ring.next_rising(posts.end) {
            posts = next;
            before.see(posts.start + shift..posts.end + shift + 1);
            vectorized(
                #[inline(always)]
                || {
                    self.measure_posts(before, ring, frame, posts.clone());
                    self.compare_edges(ring, frame, posts.clone());
                },
            );
        }
    }

    /// Measures some posts, and what concerns the first and the last with their neighbors.
    #[inline(always)]
    fn measure_posts(&mut self, before: &PostRing, ring: &PostRing, frame: StepFrame, posts: Range<usize>) {
        let (count, shift) = (ring.heights.len(), frame.shift);
        // From the post before them through the one after, as far as both rings have them.
        let first = posts.start.saturating_sub(1);
        let last = posts.end.min(count - 1).min((before.heights.len() - 1).saturating_sub(shift)).max(first);
        let end = (posts.end + 1).min(count);
        for values in [&mut self.over, &mut self.bulge, &mut self.ledge] {
            values[last..end].fill(f64::NAN);
        }
        self.rise[last + 1..end].fill(f64::NAN);
        if first == 0 {
            self.rise[0] = f64::NAN;
        }
        if first == last {
            return;
        }
        let shrink = before.x / ring.x;
        let edges = last - first;
        let (here, there) = (first..last + 1, first + shift..last + shift + 1);
        let (u, v) = (&ring.u[here.clone()][..edges + 1], &ring.v[here][..edges + 1]);
        let (near_u, near_v) = (&before.u[there.clone()][..edges + 1], &before.v[there][..edges + 1]);
        let rise = &mut self.rise[first..=last][..edges + 1];
        let over = &mut self.over[first..last][..edges];
        let bulge = &mut self.bulge[first..last][..edges];
        let ledge = &mut self.ledge[first..last][..edges];
        // Beyond the octant the numbers of posts differ by more.
        for at in 0..edges {
            let slack = if u[at] >= 0.0 && near_u[at] <= 1.0 { 0.0 } else { f64::NAN };
            let part = 1.0 / (1.0 + u[at]);
            let inward = (near_v[at + 1] - v[at]) * part;
            over[at] = v[at] + near_u[at] * (v[at + 1] - v[at]) - near_v[at] + slack;
            bulge[at] = v[at + 1] - v[at] - inward * shrink + slack;
            ledge[at] = near_v[at] - v[at] - inward * u[at] + slack;
        }
        for at in 1..=edges {
            let slack = if u[at] >= 0.0 && near_u[at] <= 1.0 { 0.0 } else { f64::NAN };
            rise[at] = v[at] - near_v[at] - u[at] * (near_v[at - 1] - near_v[at]) + slack;
        }
    }

    /// Compares the edges and cells that begin at some posts.
    #[inline(always)]
    fn compare_edges(&mut self, ring: &PostRing, frame: StepFrame, posts: Range<usize>) {
        let error = frame.error;
        let (start, end) = (posts.start.max(1), posts.end.min(ring.heights.len().saturating_sub(2)));
        let Some(count) = end.checked_sub(start) else { return };
        let heights = &ring.heights[start - 1..][..count + 3];
        let rise = &self.rise[start..][..count + 1];
        // What concerns the edge after the last is not known.
        let over = &self.over[start..][..count + 1];
        let bulge = &self.bulge[start - 1..][..count + 1];
        let ledge = &self.ledge[start..][..count];
        let is_flat = &mut self.is_flat[start..][..count];
        let is_behind = &mut self.is_behind[start..][..count];
        let is_ahead = &mut self.is_ahead[start..][..count];
        for at in 0..count {
            let is_inward = frame.is_inward(start + at);
            let (low, high) = (rise[at], rise[at + 1]);
            let (is_over, is_next_over) = (over[at] >= 0.0, over[at + 1] >= 0.0);
            let (is_low, is_high_low) = (low <= 0.0, high <= 0.0);
            let is_inward_flat = (bulge[at + 1] >= 0.0) & is_next_over | (ledge[at] >= 0.0) & is_low;
            let is_outward_flat = is_over | is_high_low;
            let is_diagonal_flat = is_inward & is_inward_flat | !is_inward & is_outward_flat;
            is_flat[at] = (is_over | is_low) & is_diagonal_flat;
            is_behind[at] = is_low & is_high_low & (over[at] <= 0.0);
        }
        for at in 0..count {
            let is_inward = frame.is_inward(start + at);
            let is_bulge = is_inward & (bulge[at + 1] >= 0.0) | !is_inward & (bulge[at] >= 0.0);
            // Beside a gap rays to the posts are in doubt.
            let around = heights[at] + heights[at + 3];
            let is_over = (rise[at] >= error) & (rise[at + 1] >= error) & (over[at] >= error);
            is_ahead[at] = is_over & is_bulge & !around.is_nan();
        }
    }

    /// Whether the rung at a post and the diagonal of the cell that begins there are known to be nowhere higher than both rings.
    pub fn is_cell_flat(&self, index: usize) -> bool {
        self.is_flat[index]
    }
}
