//! The rings of posts that a sweep passes, as the observer sees them, read some rings at a time.

use std::ops::{Range, RangeInclusive};

use crate::sight::viewshed::frame::OctantFrame;

/// Rings read at once: where rings run across the rows of the lattice, a cache line holds the heights of as many.
const CHUNK: usize = 16;

/// A post of a ring as the observer sees it.
#[derive(Clone, Copy)]
pub(super) struct RingPost {
    /// The ray that it lies on.
    pub u: f64,
    /// Rise over `x`, lowered by curvature; NaN where there is no data.
    pub v: f64,
}

/// How a ring's posts are seen: the factors of [`RingPost::u`] and [`RingPost::v`].
#[derive(Clone, Copy, Default)]
pub(super) struct RingView {
    /// One over the ring's distance.
    pub inverse: f64,
    /// How far the observer stands beyond post 0.
    pub offset: f64,
    pub eye_m: f64,
    /// The drop by curvature along the rings, and along a ring for each square of `u`.
    pub along: f64,
    pub across: f64,
}

impl RingView {
    #[inline(always)]
    fn u(&self, j: i64) -> f64 {
        (j as f64 - self.offset) * self.inverse
    }

    #[inline(always)]
    fn v(&self, height: f32, u: f64) -> f64 {
        (f64::from(height) - self.eye_m) * self.inverse - self.drop(u)
    }

    #[inline(always)]
    fn drop(&self, u: f64) -> f64 {
        self.along + self.across * u * u
    }

    /// An upper bound of `v` of posts up to `height` on the rays between two, to the last bit: sums and products keep the
    /// order of what they are made of.
    fn bound(&self, height: f32, (u0, u1): (f64, f64)) -> f64 {
        let least = self.drop(u0).min(self.drop(u1)).min(self.drop(u0.max(0.0)));
        (f64::from(height) - self.eye_m) * self.inverse - least
    }
}

/// Posts of a ring that are looked at together: where the highest is below the horizon around all, each is.
pub(super) const BLOCK: usize = 16;

/// A ring of posts within the wedge, and a few beyond.
#[derive(Default)]
pub(super) struct PostRing {
    pub number: usize,
    /// Distance from the observer in rings.
    pub x: f64,
    /// The first post.
    pub first: i64,
    /// Meters.
    pub heights: Vec<f32>,
    pub view: RingView,
    /// [`RingPost::u`] and [`RingPost::v`] of the posts of blocks that may rise, and of one more on either side.
    pub u: Vec<f64>,
    pub v: Vec<f64>,
    /// Whether a post, or a target on one, may rise above the horizon, for each [`BLOCK`] of posts.
    pub may_rise: Vec<bool>,
    /// Whether a post may rise above the horizon.
    pub is_prominent: Vec<bool>,
    pub any_prominent: bool,
    /// The error of `v` here and in the strip before.
    pub error: f64,
    /// The error of `v` on the ring's own edges.
    pub edge_error: f64,
    /// Whether `u` and `v` of the posts of a block are known.
    is_seen: Vec<bool>,
}

impl PostRing {
    /// Takes on the heights of a ring's posts; none is prominent yet.
    pub fn fill(&mut self, heights: &[f32]) {
        self.heights.clear();
        self.heights.extend_from_slice(heights);
        self.is_prominent.clear();
        self.is_prominent.resize(heights.len(), false);
        self.may_rise.clear();
        self.may_rise.resize(heights.len().div_ceil(BLOCK), false);
        self.is_seen.clear();
        self.is_seen.resize(self.may_rise.len(), false);
        self.u.resize(heights.len(), 0.0);
        self.v.resize(heights.len(), 0.0);
    }

    /// The indices of the posts of a block.
    pub fn block(&self, block: usize) -> Range<usize> {
        block * BLOCK..(block * BLOCK + BLOCK).min(self.heights.len())
    }

    /// The next posts from one on, a block's first, whose blocks all may rise.
    pub fn next_rising(&self, from: usize) -> Option<Range<usize>> {
        let blocks = &self.may_rise;
        let first = (from.div_ceil(BLOCK)..blocks.len()).find(|&block| blocks[block])?;
        let end = (first..blocks.len()).find(|&block| !blocks[block]).unwrap_or(blocks.len());
        Some(first * BLOCK..(end * BLOCK).min(self.heights.len()))
    }

    /// The rays of a block's first and last posts, and an upper bound of `v` of all; −∞ where none has data.
    pub fn block_bound(&self, block: usize) -> ((f64, f64), f64) {
        let posts = self.block(block);
        let [u0, u1] = [posts.start, posts.end - 1].map(|index| self.view.u(self.first + index as i64));
        // Comparisons with NaN are false; unlike `max` they are vectorized.
        let higher = |high: f32, &height: &f32| if height > high { height } else { high };
        let high = self.heights[posts].iter().fold(f32::NEG_INFINITY, higher);
        ((u0, u1), self.view.bound(high, (u0, u1)))
    }

    /// Computes `u` and `v` of the posts of a block, and of one more on either side.
    pub fn see_block(&mut self, block: usize) {
        self.is_seen[block] = true;
        let posts = self.block(block);
        let posts = posts.start.saturating_sub(1)..(posts.end + 1).min(self.heights.len());
        let (first, view) = (self.first + posts.start as i64, self.view);
        let out = self.u[posts.clone()].iter_mut().zip(&mut self.v[posts.clone()]);
        for (step, ((u, v), &height)) in out.zip(&self.heights[posts]).enumerate() {
            *u = view.u(first + step as i64);
            *v = view.v(height, *u);
        }
    }

    /// Computes `u` and `v` of some posts where they are not known, and of one more on either side.
    pub fn see(&mut self, posts: Range<usize>) {
        for block in posts.start / BLOCK..posts.end.div_ceil(BLOCK).min(self.is_seen.len()) {
            if !self.is_seen[block] {
                self.see_block(block);
            }
        }
    }

    /// The posts whose edges lie over the rays from `begin` to `end`: no more than needed.
    pub fn over(&self, (begin, end): (f64, f64)) -> RangeInclusive<usize> {
        let ray = |index: usize| self.view.u(self.first + index as i64);
        let index = |u: f64| (u * self.x + self.view.offset) as i64 - self.first;
        let most = self.heights.len() - 1;
        let (mut first, mut last) = ((index(begin) - 1).max(0) as usize, (index(end) - 1).max(0) as usize);
        while first + 1 < most && ray(first + 1) <= begin {
            first += 1;
        }
        while last < most && ray(last) < end {
            last += 1;
        }
        first..=last
    }

    /// The post after the last.
    pub fn end(&self) -> i64 {
        self.first + self.heights.len() as i64
    }

    #[inline]
    pub fn get(&self, j: i64) -> Option<RingPost> {
        let &height = self.heights.get(usize::try_from(j - self.first).ok()?)?;
        let u = self.view.u(j);
        Some(RingPost { u, v: self.view.v(height, u) })
    }

    /// Whether post `j` exists and is prominent.
    pub fn is_prominent(&self, j: i64) -> bool {
        let index = usize::try_from(j - self.first).ok();
        index.and_then(|index| self.is_prominent.get(index)).is_some_and(|&is_prominent| is_prominent)
    }

    /// Whether the edge from a post to the next, given by the first's index, has data and an end that is prominent.
    #[inline]
    pub fn is_prominent_edge(&self, index: usize) -> bool {
        let (is_prominent, heights) = (&self.is_prominent[index..index + 2], &self.heights[index..index + 2]);
        (is_prominent[0] || is_prominent[1]) && !(heights[0] + heights[1]).is_nan()
    }

    /// Whether post `j` exists without data.
    pub fn is_gap(&self, j: i64) -> bool {
        let index = usize::try_from(j - self.first).ok();
        index.and_then(|index| self.heights.get(index)).is_some_and(|height| height.is_nan())
    }

    /// Whether a post has no data.
    pub fn any_gap(&self) -> bool {
        self.heights.iter().fold(false, |any, height| any | height.is_nan())
    }

    /// `v` on the ring edge from post `j` to the next at the ray `u`; NaN where there is none.
    pub fn between(&self, j: i64, u: f64) -> f64 {
        match (self.get(j), self.get(j + 1)) {
            (Some(low), Some(high)) => low.v + (high.v - low.v) * ((u - low.u) * self.x),
            _ => f64::NAN,
        }
    }
}

/// Heights of some rings, read together.
#[derive(Default)]
pub(super) struct RingChunk {
    ring: usize,
    rings: usize,
    first: i64,
    width: usize,
    heights: Vec<f32>,
}

impl RingChunk {
    /// Whether it holds a ring.
    pub fn contains(&self, ring: usize) -> bool {
        (self.ring..self.ring + self.rings).contains(&ring)
    }

    /// The last ring of a chunk that begins at `ring`, of `far` and the frame's.
    pub fn last(frame: &OctantFrame, ring: usize, far: usize) -> usize {
        (ring + CHUNK - 1).min(far).min(frame.rings - 1).max(ring)
    }

    /// Reads the posts `first..=end` of the rings `ring..=last` from a lattice's held `heights`.
    pub fn read(
        &mut self,
        frame: &OctantFrame,
        (ring, last): (usize, usize),
        (first, end): (i64, i64),
        heights: &[f32],
    ) {
        (self.ring, self.rings, self.first) = (ring, last - ring + 1, first);
        self.width = (end - first + 1).max(0) as usize;
        self.heights.clear();
        self.heights.resize(self.rings * self.width, f32::NAN);
        if frame.ring_step.unsigned_abs() == 1 {
            // The rings lie side by side: a post and those behind it are neighbors.
            for at in 0..self.width {
                let (post, end) = (self.first + at as i64, self.rings - 1);
                let (start, stop) = (frame.index(ring, post), frame.index(ring + end, post));
                let line = &heights[start.min(stop)..=start.max(stop)];
                for (k, &height) in line.iter().enumerate() {
                    let k = if start <= stop { k } else { end - k };
                    self.heights[k * self.width + at] = height;
                }
            }
        } else {
            for (k, row) in self.heights.chunks_exact_mut(self.width.max(1)).enumerate() {
                let (first, end) = (frame.index(ring + k, self.first), self.first + self.width as i64 - 1);
                let last = frame.index(ring + k, end);
                row.copy_from_slice(&heights[first.min(last)..=first.max(last)]);
                if last < first {
                    row.reverse();
                }
            }
        }
    }

    /// The heights of `count` posts of a ring from post `first` on.
    pub fn heights(&self, ring: usize, first: i64, count: usize) -> &[f32] {
        let start = (ring - self.ring) * self.width + (first - self.first) as usize;
        &self.heights[start..start + count]
    }
}
