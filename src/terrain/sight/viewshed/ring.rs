//! The rings of posts that a sweep passes, as the observer sees them, read some rings at a time.

use crate::terrain::sight::viewshed::frame::OctantFrame;

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

/// A ring of posts within the wedge, and a few beyond.
#[derive(Default)]
pub(super) struct PostRing {
    pub number: usize,
    /// Distance from the observer in rings.
    pub x: f64,
    /// The first post.
    pub first: i64,
    /// Meters.
    pub heights: Vec<f64>,
    /// [`RingPost::u`] and [`RingPost::v`] of each post.
    pub u: Vec<f64>,
    pub v: Vec<f64>,
    /// Whether a post may rise above the horizon.
    pub is_prominent: Vec<bool>,
    pub any_prominent: bool,
    /// The error of `v` here and in the strip before.
    pub error: f64,
}

impl PostRing {
    /// The post after the last.
    pub fn end(&self) -> i64 {
        self.first + self.v.len() as i64
    }

    pub fn get(&self, j: i64) -> Option<RingPost> {
        let index = usize::try_from(j - self.first).ok()?;
        Some(RingPost { u: *self.u.get(index)?, v: *self.v.get(index)? })
    }

    /// Whether post `j` exists and is prominent.
    pub fn is_prominent(&self, j: i64) -> bool {
        let index = usize::try_from(j - self.first).ok();
        index.and_then(|index| self.is_prominent.get(index)).is_some_and(|&is_prominent| is_prominent)
    }

    /// Whether the edge from a post to the next, given by the first's index, has data and an end that is prominent.
    #[inline]
    pub fn is_prominent_edge(&self, index: usize) -> bool {
        let (is_prominent, v) = (&self.is_prominent[index..index + 2], &self.v[index..index + 2]);
        (is_prominent[0] || is_prominent[1]) && !(v[0] + v[1]).is_nan()
    }

    /// Whether post `j` exists without data.
    pub fn is_gap(&self, j: i64) -> bool {
        self.get(j).is_some_and(|post| post.v.is_nan())
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
