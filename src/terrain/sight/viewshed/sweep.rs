//! The sweep: ring by ring outward through a wedge of rays, each post compared with the horizon of the ground before it.
//!
//! ```text
//!   y ▲                    ╱ u = 1        A wedge lies between two rays of an octant, turned so that rings run across
//!     │            o───o─╱─o              it: x counts rings from the observer, y posts along them, and u = y / x
//!     │        o───o───╱───o              names a ray.
//!     │    o───o───o─╱─o───o
//!     │    │ ╲ │ ╱ │╱  │ ╱ │              Between two rings lies a strip of cells, whose edges are the ring edges on
//!  observer ───o───o───o───o──► x         both sides, the rungs that join them, and the diagonals.
//!           ring n−1   ring n
//! ```
//!
//! A post on ring n is visible where it is higher than the horizon of the rings and strips before. Both are known within a
//! small error ([`Margins`]), which decides all but the near ties; for those the line of sight is computed, so that the
//! answer equals that of the lines of sight on every post.
//!
//! It is fast because a post lower than the least horizon all around it (most of them, in hills) is hidden, and edges
//! between two such posts do not change the horizon. A rung or a diagonal matters only where it rises above both rings that
//! it joins, as a ridge does, which two interpolations decide. Where ground faces the observer, each ring is compared with the
//! one before alone ([`RingStep`]).

use std::ops::RangeInclusive;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::lattice::{Lattice, Post};
use crate::sight::viewshed::bucket::{Doubt, EdgeChain};
use crate::sight::viewshed::frame::OctantFrame;
use crate::sight::viewshed::horizon::{Horizon, HorizonEdge, HorizonSpan};
use crate::sight::viewshed::ring::{BLOCK, PostRing, RingChunk, RingPost, RingView};
use crate::sight::viewshed::rises::RiseTests;
use crate::sight::viewshed::step::RingStep;
use crate::stop_flag::StopFlag;

/// How far the sweep's numbers may differ from those of a line of sight.
#[derive(Clone, Copy, Debug)]
pub(super) struct Margins {
    /// Meters of height, at a crossing.
    pub height_m: f64,
    /// Posts, across a ray.
    pub across: f64,
    /// Meters that curvature bends the ground between two crossings a cell apart, at most, at a distance of one cell.
    pub bend_m: f64,
}

/// Rings nearer than this many cells are decided by lines of sight: too few posts to gain from a sweep, and the observer's
/// own cell has edges on all sides.
pub(super) const NEAR: f64 = 3.0;

/// An edge that spans less than this share of the distance between posts, seen from the observer, is nearly along the
/// rays: its crossing with a ray is ill determined, so it is a doubt and hides nothing.
const NARROW: f64 = 1.0 / 64.0;

/// Nearer than this share of a cell `rise / x` is meaningless: a bound of the whole wedge, or the begin of the line to a post,
/// decides whether ground there hides it.
pub(super) const NEAREST: f64 = 1.0 / 256.0;

/// The last ray of the last wedge of an octant, plus rounding: a post on the border of two octants may be decided twice,
/// but must not be left out.
const LAST: f64 = 1.0 + 4.0 * f64::EPSILON;

/// The input of a sweep.
pub(super) struct SweepScene<'a> {
    pub lattice: &'a Lattice,
    /// Height of the eye, meters.
    pub eye_m: f64,
    /// Height of the target above the ground, meters.
    pub target_m: f64,
    /// The drop by curvature per square meter of distance.
    pub drop_per_square_m: f64,
    pub range_m: f64,
    pub margins: Margins,
    /// Set when the answer is no longer needed.
    pub stop: &'a StopFlag,
}

/// The tests of single posts that the sweep falls back on.
#[derive(Clone, Copy)]
pub(super) struct PostTests<'a> {
    /// Whether the line of sight to a post is clear.
    pub sees: &'a (dyn Fn(Post) -> bool + Sync),
    /// Whether its first part, 0..=1, is.
    pub is_clear_near: &'a (dyn Fn(Post, f64) -> bool + Sync),
    /// Whether rounding cannot leave a diagonal that ends at a post before it.
    pub is_clear_of_diagonals: &'a (dyn Fn(Post) -> bool + Sync),
}

/// What a sweep finds, for each post in the order of the lattice's held heights.
#[derive(Clone, Copy)]
pub(super) enum SweepAnswer<'a> {
    /// The visible posts, which it marks.
    Visible(&'a [AtomicBool]),
    /// The rises of targets that make them visible.
    Rises(RiseTests<'a>),
}

/// Decides every post of a wedge; returns the number of posts decided by a line of sight.
pub(super) fn sweep(
    scene: &SweepScene<'_>,
    frame: &OctantFrame,
    (from, to): (f64, f64),
    tests: PostTests<'_>,
    answer: SweepAnswer<'_>,
) -> usize {
    let drop = |cell_m: f64| scene.drop_per_square_m * cell_m * cell_m;
    let mut sweep = Sweep {
        scene,
        frame,
        from,
        to,
        tests,
        answer,
        horizon: Horizon::new(from, to),
        near: f64::NEG_INFINITY,
        bend: CurvatureDrop { along: drop(frame.ring_cell_m), across: drop(frame.cross_cell_m) },
        chunk: RingChunk::default(),
        before: PostRing::default(),
        ring: PostRing::default(),
        step: RingStep::default(),
        lines: 0,
    };
    sweep.run();
    sweep.lines
}

/// The drop by curvature, per square cell along and across.
#[derive(Clone, Copy)]
pub(super) struct CurvatureDrop {
    pub along: f64,
    pub across: f64,
}

pub(super) struct Sweep<'a> {
    pub scene: &'a SweepScene<'a>,
    pub frame: &'a OctantFrame,
    from: f64,
    to: f64,
    pub tests: PostTests<'a>,
    answer: SweepAnswer<'a>,
    pub horizon: Horizon,
    /// An upper bound of `v` of the ground nearer than [`NEAREST`].
    pub near: f64,
    pub bend: CurvatureDrop,
    chunk: RingChunk,
    pub before: PostRing,
    pub ring: PostRing,
    step: RingStep,
    /// The number of posts decided by a line of sight.
    pub lines: usize,
}

/// Whether the corners of a cell are prominent: `a` and `d` on the ring before, `b` and `c` on the ring, as they join end to
/// end.
#[derive(Clone, Copy)]
struct CellProminence {
    a: bool,
    b: bool,
    c: bool,
    d: bool,
}

/// Whether any of [`BLOCK`] flags from `index` on is set, or the one after them.
#[inline]
fn any(flags: &[bool], index: usize) -> bool {
    let flags = &flags[index..flags.len().min(index + BLOCK + 1)];
    flags.iter().fold(false, |any, &flag| any | flag)
}

/// The least of some numbers, in lanes of which none waits for another; ∞ of none.
#[inline]
fn least(values: &[f64]) -> f64 {
    let lower = |low: f64, &value: &f64| if value < low { value } else { low };
    let mut lanes = [f64::INFINITY; 4];
    let (groups, rest) = values.as_chunks::<4>();
    for group in groups {
        lanes.iter_mut().zip(group).for_each(|(lane, value)| *lane = lower(*lane, value));
    }
    rest.iter().chain(&lanes).fold(f64::INFINITY, lower)
}

impl Sweep<'_> {
    fn run(&mut self) {
        let far = (self.scene.range_m / self.frame.ring_cell_m + 1.0).min(self.frame.rings as f64) as usize;
        // Ring 0 lies at the observer or behind: it only bounds the first strip.
        for ring in 0..=far.min(self.frame.rings.saturating_sub(1)) {
            if self.scene.stop.is_stopped() || self.posts_at(self.frame.distance(ring)).is_empty() {
                // Nobody waits, or the wedge has left the lattice sideways.
                break;
            }
            std::mem::swap(&mut self.before, &mut self.ring);
            self.load(ring, far);
            if self.ring.x < NEAREST {
                self.ring.any_prominent = true;
                self.ring.is_prominent.fill(true);
                if ring > 0 {
                    self.answer(true);
                    self.near_strip(ring);
                }
                continue;
            }
            self.horizon.grow(self.ring.x, &self.before);
            let any_target = self.find_prominent();
            if self.before.x < NEAR {
                self.step.skip(&self.ring);
            } else {
                self.step.measure(&mut self.before, &self.ring, self.frame.parity(ring - 1));
            }
            self.answer(any_target || self.ring.x <= NEAR);
            if self.before.x < NEAR {
                self.near_strip(ring);
            } else if self.before.any_prominent || self.ring.any_prominent {
                self.strip(ring);
            }
            if self.ring.any_prominent {
                self.ring_edges();
            }
            self.horizon.end_ring(&self.before);
        }
    }

    /// The posts of a ring at a distance that the wedge needs.
    fn posts_at(&self, x: f64) -> RangeInclusive<i64> {
        let x = x.max(0.0);
        let first = (self.from * x + self.frame.offset).floor() as i64 - 2;
        let last = (self.to * x + self.frame.offset).floor() as i64 + 3;
        first.max(0)..=last.min(self.frame.last)
    }

    fn load(&mut self, ring: usize, far: usize) {
        let x = self.frame.distance(ring);
        if !self.chunk.contains(ring) {
            let last = RingChunk::last(self.frame, ring, far);
            let (near, distant) = (self.posts_at(x), self.posts_at(self.frame.distance(last)));
            let posts = (*near.start(), *distant.end());
            self.chunk.read(self.frame, (ring, last), posts, self.scene.lattice.held_heights());
        }
        let posts = self.posts_at(x);
        let (first, count) = (*posts.start(), (posts.end() - posts.start() + 1).max(0) as usize);
        let heights = self.chunk.heights(ring, first, count);
        let error = self.error((x - 1.0).max(NEAREST), x);
        // A ring's edges also stand for the rungs and diagonals under them, which bend by their strip's error; near the
        // observer, where that is large, no rung is left out for them.
        let edge_error = if x < NEAR { self.error(x.max(NEAREST), x) } else { error };
        let into = &mut self.ring;
        (into.number, into.x, into.first, into.error) = (ring, x, first, error);
        into.edge_error = edge_error;
        into.view = RingView {
            inverse: x.recip(),
            offset: self.frame.offset,
            eye_m: self.scene.eye_m,
            along: self.bend.along * x,
            across: self.bend.across * x,
        };
        into.fill(heights);
    }

    /// The error of `v` of an edge between two distances.
    pub fn error(&self, near_x: f64, far_x: f64) -> f64 {
        let Margins { height_m, bend_m, .. } = self.scene.margins;
        (height_m + bend_m * far_x / near_x) / near_x
    }

    /// Marks the posts that may rise above the horizon; returns whether a target on a post may.
    fn find_prominent(&mut self) -> bool {
        let floor = self.horizon.floor();
        let (count, last) = (floor.len() as f64, floor.len() - 1);
        let bucket = |u: f64| ((u * count) as usize).min(last);
        let ring = &mut self.ring;
        let (error, lift) = (ring.error, self.scene.target_m / ring.x);
        let (mut any_prominent, mut any_target) = (false, false);
        for block in 0..ring.may_rise.len() {
            let ((u0, u1), bound) = ring.block_bound(block);
            let least = least(&floor[bucket(u0)..=bucket(u1)]);
            if bound.max(bound + lift) + error < least {
                continue;
            }
            ring.may_rise[block] = true;
            ring.see_block(block);
            for index in ring.block(block) {
                let (v, floor) = (ring.v[index], floor[bucket(ring.u[index])]);
                let is_prominent = v + error >= floor;
                ring.is_prominent[index] = is_prominent;
                any_prominent |= is_prominent;
                any_target |= v + lift + error >= floor;
            }
        }
        ring.any_prominent = any_prominent;
        any_target
    }

    /// Finds what is asked of the posts of the ring; `any_target` is false where no target on them is visible.
    fn answer(&mut self, any_target: bool) {
        match self.answer {
            SweepAnswer::Visible(visible) if any_target => self.decide(visible),
            SweepAnswer::Visible(_) => {}
            SweepAnswer::Rises(found) => self.find_rises(found),
        }
    }

    /// Whether a ray belongs to the wedge; a border belongs to the wedge that it begins.
    pub fn is_inside(&self, u: f64) -> bool {
        u >= self.from && (u < self.to || self.to == 1.0 && u <= LAST)
    }

    /// Decides the posts of the ring.
    fn decide(&mut self, visible: &[AtomicBool]) {
        let lift = self.scene.target_m / self.ring.x;
        let is_near = self.ring.x <= NEAR;
        let floor = std::mem::take(self.horizon.floor());
        let (count, last) = (floor.len() as f64, floor.len() - 1);
        let is_ground = lift == 0.0 && !is_near;
        let is_measured = self.before.x >= NEAR;
        let hidden = -self.ring.error - self.before.edge_error;
        for block in 0..self.ring.may_rise.len() {
            if is_near {
                self.ring.see_block(block);
            } else if !self.ring.may_rise[block] {
                continue;
            }
            for index in self.ring.block(block) {
                if is_ground && !self.ring.is_prominent[index] {
                    continue;
                }
                let target = RingPost { u: self.ring.u[index], v: self.ring.v[index] + lift };
                let is_low = || {
                    let floor = floor[((target.u * count) as usize).min(last)];
                    !is_near && target.v + self.ring.error < floor
                };
                let is_inside = self.is_inside(target.u);
                // NaN, where it is not known, hides nothing.
                let is_behind = is_measured && self.step.rise[index] + lift < hidden;
                // A prominent post is known not to be low.
                let is_open = !is_behind && is_inside && !target.v.is_nan() && (is_ground || !is_low());
                if is_open {
                    self.decide_post(index, target, visible);
                }
            }
        }
        *self.horizon.floor() = floor;
    }

    fn decide_post(&mut self, index: usize, target: RingPost, visible: &[AtomicBool]) {
        let post = self.frame.post(self.ring.number, self.ring.first + index as i64);
        let decided = if self.ring.x <= NEAR { None } else { self.is_visible(index, target, post) };
        let decided = decided.filter(|&is_visible| !is_visible || (self.tests.is_clear_of_diagonals)(post));
        let is_visible = decided.unwrap_or_else(|| {
            self.lines += 1;
            (self.tests.sees)(post)
        });
        if is_visible {
            visible[self.scene.lattice.index(post)].store(true, Ordering::Relaxed);
        }
    }

    /// Whether the target on a post, also given by its index on the ring, is visible; `None` where only the line of sight decides.
    fn is_visible(&self, index: usize, RingPost { u, v }: RingPost, post: Post) -> Option<bool> {
        let error = self.ring.error;
        let span = if self.horizon.is_front(u) {
            let (level, error) = (self.ring.v[index] - self.step.rise[index], self.before.edge_error);
            HorizonSpan { low: level - error, high: level + error }
        } else {
            self.horizon.span(u, v - error, self.scene.margins.across / self.ring.x)?
        };
        if v + error < span.low {
            return Some(false);
        }
        // The one edge of the last strip that the line crosses.
        let diagonal = self.last_diagonal(index, u);
        if v + error < diagonal - error {
            return Some(false);
        }
        let is_over = diagonal.is_nan() || v - error > diagonal + error;
        let is_clear = is_over && v - error > span.high;
        // The horizon has everything beyond.
        let is_over_near = || {
            let beyond = 2.0 * NEAREST / self.ring.x;
            v - error > self.near || (self.tests.is_clear_near)(post, beyond)
        };
        is_clear.then(is_over_near)
    }

    /// `v` on the diagonal of the last cell before a post at the post's ray; NaN where the diagonal ends at the post.
    fn last_diagonal(&self, index: usize, u: f64) -> f64 {
        if self.before.x >= NEAR && index > 0 && !self.step.bulge[index - 1].is_nan() {
            let j = self.ring.first + index as i64;
            let ends_here = (self.frame.parity(self.ring.number) + j) % 2 == 0;
            return if ends_here { f64::NAN } else { self.ring.v[index] - self.step.bulge[index - 1] };
        }
        self.far_diagonal(index, u)
    }

    /// [`Sweep::last_diagonal`] of any post, whether it was compared with the ring before or not.
    pub fn far_diagonal(&self, index: usize, u: f64) -> f64 {
        let j = self.ring.first + index as i64;
        if (self.frame.parity(self.ring.number) + j) % 2 == 0 {
            return f64::NAN;
        }
        match (self.before.get(j), self.ring.get(j - 1)) {
            (Some(near), Some(far)) => far.v + (near.v - far.v) * ((u - far.u) / (near.u - far.u)),
            _ => f64::NAN,
        }
    }

    /// Adds the ring's own edges to the horizon.
    fn ring_edges(&mut self) {
        self.doubt_beside_gaps();
        let edges = self.ring.heights.len().saturating_sub(1);
        let mut index = 0;
        while index < edges {
            if index % BLOCK == 0 && !any(&self.ring.is_prominent, index) {
                index += BLOCK;
                continue;
            }
            let first = index;
            while index < edges && self.ring.is_prominent_edge(index) && !self.step.is_behind[index] {
                index += 1;
            }
            if first < index {
                self.ring_run(first, index);
            }
            index += 1;
        }
    }

    /// Adds the ring's edges from one post to another, given by their indices.
    fn ring_run(&mut self, mut first: usize, mut last: usize) {
        let (error, cut) = (self.ring.edge_error, self.ray_error(self.ring.x));
        let is_gap = |index: Option<usize>| {
            index.and_then(|index| self.ring.heights.get(index)).is_some_and(|height| height.is_nan())
        };
        // Beside a gap a ray may just miss the edge.
        let cut_at = |is_gap: bool| if is_gap { cut } else { 0.0 };
        let cuts = [cut_at(is_gap(first.checked_sub(1))), cut_at(is_gap(Some(last + 1)))];
        let post = |index: usize| RingPost { u: self.ring.u[index], v: self.ring.v[index] };
        let (start, end) = ([post(first), post(first + 1)], [post(last - 1), post(last)]);
        if first + 1 == last {
            return self.insert(start[0], start[1], cuts, error);
        }
        if cuts[0] > 0.0 {
            self.insert(start[0], start[1], [cuts[0], 0.0], error);
            first += 1;
        }
        if cuts[1] > 0.0 {
            self.insert(end[0], end[1], [0.0, cuts[1]], error);
            last -= 1;
        }
        if first < last {
            let posts = first..=last;
            let (u, v) = (&self.ring.u[posts.clone()], &self.ring.v[posts]);
            let is_far = self.ring.x >= NEAR;
            let is_ahead = if is_far { &self.step.is_ahead[first..last] } else { &[] };
            let chain = EdgeChain { u, v, per_step: self.ring.x, error, is_ahead };
            self.horizon.insert_chain(&chain, self.ring.number, &self.before);
        }
    }

    /// Leaves the rays to prominent posts beside gaps to lines of sight: rungs and diagonals to such a post are cut short of it
    /// by the error of the strip before.
    fn doubt_beside_gaps(&mut self) {
        if !self.ring.any_gap() {
            return;
        }
        let ray_error = self.ray_error((self.ring.x - 1.0).max(NEAREST));
        for j in self.ring.first..self.ring.end() {
            if self.ring.is_prominent(j)
                && (self.ring.is_gap(j - 1) || self.ring.is_gap(j + 1))
                && let Some(post) = self.ring.get(j)
            {
                let (u0, u1) = (post.u - ray_error, post.u + ray_error);
                self.horizon.doubt(Doubt { u0, u1, v: post.v + self.ring.error });
            }
        }
    }

    /// Adds an edge to the horizon, cut short at both ends.
    fn insert(&mut self, from: RingPost, to: RingPost, [start, end]: [f64; 2], error: f64) {
        let slope = (to.v - from.v) / (to.u - from.u);
        self.horizon.insert(&HorizonEdge {
            u0: from.u + start,
            v0: from.v + slope * start,
            u1: to.u - end,
            v1: to.v - slope * end,
            error,
        });
    }

    /// The error of the ray of a crossing at a distance.
    fn ray_error(&self, x: f64) -> f64 {
        2.0 * self.scene.margins.across / x
    }

    /// Adds the rungs and diagonals of the strip before the ring to the horizon.
    fn strip(&mut self, ring: usize) {
        let parity = self.frame.parity(ring - 1);
        let first = self.ring.first;
        let (near, far) =
            (std::mem::take(&mut self.before.is_prominent), std::mem::take(&mut self.ring.is_prominent));
        let near_first = (first - self.before.first).max(0) as usize;
        let near_here = near.get(near_first..).unwrap_or(&[]);
        let count = near_here.len().min(far.len());
        let mut index = 0;
        while index < count {
            if index % BLOCK == 0 && !any(near_here, index) && !any(&far, index) {
                index += BLOCK;
                continue;
            }
            if self.step.is_cell_flat(index) {
                index += 1;
                continue;
            }
            let at = |flags: &[bool], index: usize| flags.get(index).copied().unwrap_or(false);
            let prominent = CellProminence {
                a: near_here[index],
                b: far[index],
                c: at(&far, index + 1),
                d: at(near_here, index + 1),
            };
            if prominent.a || prominent.b || prominent.c || prominent.d {
                self.cell(first + index as i64, parity, prominent);
            }
            index += 1;
        }
        (self.before.is_prominent, self.ring.is_prominent) = (near, far);
    }

    /// Adds the rung at post `j` and the diagonal of the cell that begins there.
    fn cell(&mut self, j: i64, parity: i64, prominent: CellProminence) {
        let (Some(a), Some(b)) = (self.before.get(j), self.ring.get(j)) else { return };
        let xs = (self.before.x, self.ring.x);
        if (prominent.a || prominent.b) && !self.is_rung_under(j, a, b) {
            self.cross(b, a, xs, self.ring.error);
        }
        let (Some(d), Some(c)) = (self.before.get(j + 1), self.ring.get(j + 1)) else { return };
        if (j + parity) % 2 == 0 {
            if (prominent.a || prominent.c) && !self.is_outward_under(j, a, c) {
                self.cross(a, c, xs, self.ring.error);
            }
        } else if (prominent.b || prominent.d) && !self.is_inward_under(j, [a, b, c, d]) {
            self.cross(b, d, xs, self.ring.error);
        }
    }

    /// Whether the rung from `a` out to `b` is nowhere higher than both rings. All three are straight from `b`'s ray to
    /// `a`'s, so it is enough that either ring is as high where the rung leaves the other.
    fn is_rung_under(&self, j: i64, a: RingPost, b: RingPost) -> bool {
        let within = self.ring.get(j + 1).is_some_and(|c| a.u <= c.u);
        within && a.v <= self.ring.between(j, a.u)
            || self.before.get(j - 1).is_some_and(|near| near.u <= b.u)
                && b.v <= self.before.between(j - 1, b.u)
    }

    /// The same for the diagonal from `a` out to the next post's `c`.
    fn is_outward_under(&self, j: i64, a: RingPost, c: RingPost) -> bool {
        a.u <= c.u && (a.v <= self.ring.between(j, a.u) || c.v <= self.before.between(j, c.u))
    }

    /// The same for the diagonal from `b` in to the next post's `d`, which crosses the rays of `a` and `c`.
    fn is_inward_under(&self, j: i64, [a, b, c, d]: [RingPost; 4]) -> bool {
        let at = |u: f64| b.v + (d.v - b.v) * ((u - b.u) / (d.u - b.u));
        let far = self.ring.get(j + 2).is_some_and(|far| d.u <= far.u);
        let near = self.before.get(j - 1).is_some_and(|near| near.u <= b.u);
        let in_order = b.u <= a.u && c.u <= d.u;
        in_order
            && (far && c.v >= at(c.u) && d.v <= self.ring.between(j + 1, d.u)
                || near && a.v >= at(a.u) && b.v <= self.before.between(j - 1, b.u))
    }

    /// Adds an edge between two distances to the horizon.
    fn cross(&mut self, from: RingPost, to: RingPost, xs: (f64, f64), error: f64) {
        self.cross_part([from, to], [true; 2], xs, error);
    }

    /// Adds a part of an edge between two distances to the horizon; where it does not end, the edge goes on.
    pub fn cross_part(
        &mut self,
        [from, to]: [RingPost; 2],
        ends: [bool; 2],
        (near_x, far_x): (f64, f64),
        error: f64,
    ) {
        let ((from, to), [start, end]) =
            if from.u <= to.u { ((from, to), ends) } else { ((to, from), [ends[1], ends[0]]) };
        if (from.v + to.v).is_nan() {
            return;
        }
        let ray_error = self.ray_error(near_x);
        let width = to.u - from.u;
        if width * far_x >= NARROW * (far_x - near_x) {
            // A ray may just miss an end of it; there the rings hide as much.
            let cut = |is_end: bool| if is_end { ray_error } else { 0.0 };
            self.insert(from, to, [cut(start), cut(end)], error);
        } else if width > 0.0 {
            let (u0, u1) = (from.u - ray_error, to.u + ray_error);
            self.horizon.doubt(Doubt { u0, u1, v: from.v.max(to.v) + error });
        }
        // An edge exactly along a ray hides no more than its ends do.
    }
}
