//! The sweep: ring by ring outward through a wedge of rays, each post held against the horizon of what lies before it.
//!
//! ```text
//!   y ▲                    ╱ u = 1        A wedge lies between two rays of an eighth of the circle, turned so that
//!     │            o───o─╱─o              rings run across it: x counts rings from the observer, y posts along them,
//!     │        o───o───╱───o              and u = y / x names a ray.
//!     │    o───o───o─╱─o───o
//!     │    │ ╲ │ ╱ │╱  │ ╱ │              Between two rings lies a strip of cells, whose edges are the ring edges on
//!  observer ───o───o───o───o──► x         both sides, the rungs that join them, and the diagonals.
//!           ring n−1   ring n
//! ```
//!
//! A post on ring n is seen where it stands higher than the horizon of the rings and strips before. Both are known
//! within a small error ([`Margins`]), which decides all but the near ties; those are looked at along their own line,
//! so that the answer is that of [`super::see`] on every post.
//!
//! What makes it fast: a post that stands lower than the least horizon all around it (most of them, in hills) is
//! hidden, and edges between two such posts leave the horizon as it is; nothing more is done for them. A rung or a
//! diagonal matters only where it stands out over both rings that it joins, as a ridge does; two interpolations tell.

use std::ops::RangeInclusive;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::terrain::lattice::{Lattice, Post};
use crate::terrain::sight::viewshed::frame::OctantFrame;
use crate::terrain::sight::viewshed::horizon::{Doubt, Horizon, HorizonEdge};

/// How far off the numbers here may be from those of a line of sight.
#[derive(Clone, Copy, Debug)]
pub(super) struct Margins {
    /// Meters of height, at a crossing.
    pub height_m: f64,
    /// Posts, across a ray.
    pub across: f64,
    /// Meters that curvature bends the ground between two crossings a cell apart, at most, at a distance of one cell.
    pub bend_m: f64,
}

/// Rings nearer than this many cells are looked at line by line: too few posts to gain from a sweep, and the observer's
/// own cell has edges on all sides.
const NEAR: f64 = 3.0;

/// An edge that spans less than this share of the way from post to post, seen from the observer, is nearly along the
/// rays: where a ray crosses it is ill determined, so it is doubted and not trusted to hide.
const NARROW: f64 = 1.0 / 64.0;

/// Nearer than this share of a cell `rise / x` says nothing; what stands there is doubted for the whole wedge.
pub(super) const NEAREST: f64 = 1.0 / 16.0;

/// The last ray of the last wedge of an eighth, with what rounding may add: a post on the border of two eighths may be
/// looked at twice, but not by neither.
const LAST: f64 = 1.0 + 4.0 * f64::EPSILON;

/// Rings read at once: where rings run across the rows of the lattice, a cache line holds the heights of so many.
const CHUNK: usize = 16;

/// What a sweep looks through.
pub(super) struct SweepScene<'a> {
    pub lattice: &'a Lattice,
    /// Height of the eye, meters.
    pub eye_m: f64,
    /// Meters of a target above the ground.
    pub target_m: f64,
    /// What curvature takes from heights, per square meter of distance.
    pub drop_per_square_m: f64,
    pub range_m: f64,
    pub margins: Margins,
}

/// What single lines of sight say.
#[derive(Clone, Copy)]
pub(super) struct SightLines<'a> {
    /// Whether a post can be seen.
    pub exact: &'a dyn Fn(Post) -> bool,
    /// Whether nothing that ends at a post can stand before it by rounding.
    pub sure: &'a dyn Fn(Post) -> bool,
}

/// Looks at every post of a wedge: sets what is seen in `visible`, in the order of the lattice's heights. `lines` are
/// asked where only looking along the line can tell; the number of times is returned.
pub(super) fn sweep(
    scene: &SweepScene<'_>,
    frame: &OctantFrame,
    (from, to): (f64, f64),
    lines: SightLines<'_>,
    visible: &[AtomicBool],
) -> usize {
    let mut sweep = Sweep {
        scene,
        frame,
        from,
        to,
        lines,
        visible,
        horizon: Horizon::new(from, to),
        near: f64::NEG_INFINITY,
        bend: bend(scene, frame),
        chunk: RingChunk::default(),
        before: PostRing::default(),
        ring: PostRing::default(),
        looked: 0,
    };
    sweep.run();
    sweep.looked
}

fn bend(scene: &SweepScene<'_>, frame: &OctantFrame) -> CurvatureDrop {
    let drop = scene.drop_per_square_m;
    CurvatureDrop {
        along: drop * frame.ring_cell_m * frame.ring_cell_m,
        across: drop * frame.cross_cell_m * frame.cross_cell_m,
    }
}

/// What curvature takes from heights, per square cell along and across.
#[derive(Clone, Copy)]
pub(super) struct CurvatureDrop {
    pub(super) along: f64,
    pub(super) across: f64,
}

pub(super) struct Sweep<'a> {
    pub(super) scene: &'a SweepScene<'a>,
    pub(super) frame: &'a OctantFrame,
    from: f64,
    to: f64,
    lines: SightLines<'a>,
    visible: &'a [AtomicBool],
    horizon: Horizon,
    /// As high as anything nearer than [`NEAREST`] may stand.
    pub(super) near: f64,
    pub(super) bend: CurvatureDrop,
    chunk: RingChunk,
    pub(super) before: PostRing,
    pub(super) ring: PostRing,
    looked: usize,
}

/// A ring of posts within the wedge, and a few beyond.
#[derive(Default)]
pub(super) struct PostRing {
    number: usize,
    pub(super) x: f64,
    pub(super) first: i64,
    /// Meters.
    pub(super) heights: Vec<f64>,
    /// Which ray each post stands on.
    u: Vec<f64>,
    /// Rise over `x`, sunk by curvature; NaN where there is no data.
    v: Vec<f64>,
    /// Whether a post may stand out over the horizon.
    loud: Vec<bool>,
    any_loud: bool,
    /// How far off `v` may be here and in the strip before.
    error: f64,
}

/// A post of a ring as the observer sees it.
#[derive(Clone, Copy)]
pub(super) struct RingPost {
    pub(super) u: f64,
    pub(super) v: f64,
}

impl PostRing {
    pub(super) fn end(&self) -> i64 {
        self.first + self.v.len() as i64
    }

    fn get(&self, j: i64) -> Option<RingPost> {
        let index = usize::try_from(j - self.first).ok()?;
        Some(RingPost { u: *self.u.get(index)?, v: *self.v.get(index)? })
    }

    fn is_loud(&self, j: i64) -> bool {
        usize::try_from(j - self.first).ok().and_then(|index| self.loud.get(index)).is_some_and(|&loud| loud)
    }

    /// What the ring edge from post `j` to the next has at the ray `u`; NaN where there is none.
    fn between(&self, j: i64, u: f64) -> f64 {
        match (self.get(j), self.get(j + 1)) {
            (Some(low), Some(high)) => low.v + (high.v - low.v) * ((u - low.u) * self.x),
            _ => f64::NAN,
        }
    }
}

/// Heights of some rings, read together.
#[derive(Default)]
struct RingChunk {
    ring: usize,
    rings: usize,
    first: i64,
    width: usize,
    heights: Vec<f32>,
}

impl Sweep<'_> {
    fn run(&mut self) {
        let far = (self.scene.range_m / self.frame.ring_cell_m + 1.0).min(self.frame.rings as f64) as usize;
        // ring 0 lies at the observer or behind: it only closes the first strip
        for ring in 0..=far.min(self.frame.rings.saturating_sub(1)) {
            if self.posts_of(self.frame.x_of(ring)).is_empty() {
                // the wedge has left the lattice sideways
                break;
            }
            std::mem::swap(&mut self.before, &mut self.ring);
            self.load(ring, far);
            if self.ring.x < NEAREST {
                self.ring.any_loud = true;
                self.ring.loud.iter_mut().for_each(|loud| *loud = true);
                if ring > 0 {
                    self.decide();
                    self.near_strip(ring);
                }
                continue;
            }
            self.horizon.grow(self.ring.x);
            let any_target = self.measure();
            if any_target || self.ring.x <= NEAR {
                self.decide();
            }
            if self.before.x < NEAREST {
                self.near_strip(ring);
            } else if self.before.any_loud || self.ring.any_loud {
                self.strip(ring);
            }
            if self.ring.any_loud {
                self.ring_edges();
            }
        }
    }

    fn posts_of(&self, x: f64) -> RangeInclusive<i64> {
        let x = x.max(0.0);
        let first = (self.from * x + self.frame.offset).floor() as i64 - 2;
        let last = (self.to * x + self.frame.offset).floor() as i64 + 3;
        first.max(0)..=last.min(self.frame.last)
    }

    fn load(&mut self, ring: usize, far: usize) {
        let x = self.frame.x_of(ring);
        if !(self.chunk.ring..self.chunk.ring + self.chunk.rings).contains(&ring) {
            self.read_chunk(ring, far);
        }
        let posts = self.posts_of(x);
        let chunk = &self.chunk;
        let start = (ring - chunk.ring) * chunk.width + (posts.start() - chunk.first) as usize;
        let count = (posts.end() - posts.start() + 1).max(0) as usize;
        let heights = &chunk.heights[start..start + count];
        let into = &mut self.ring;
        (into.number, into.x, into.first) = (ring, x, *posts.start());
        into.heights.clear();
        into.heights.extend(heights.iter().map(|&height| f64::from(height)));
        into.loud.clear();
        into.loud.resize(count, false);
        let (inverse, offset, first) = (x.recip(), self.frame.offset, into.first);
        into.u.clear();
        into.u.extend((0..count).map(|index| ((first + index as i64) as f64 - offset) * inverse));
        into.v.clear();
        let (along, across) = (self.bend.along * x, self.bend.across * x);
        let sunk =
            |(&height, &u): (&f64, &f64)| (height - self.scene.eye_m) * inverse - (along + across * u * u);
        into.v.extend(into.heights.iter().zip(&into.u).map(sunk));
        let near = (x - 1.0).max(NEAREST);
        into.error = (self.scene.margins.height_m + self.scene.margins.bend_m * x / near) / near;
    }

    fn read_chunk(&mut self, ring: usize, far: usize) {
        let last = (ring + CHUNK - 1).min(far).min(self.frame.rings - 1).max(ring);
        let (near, distant) = (self.posts_of(self.frame.x_of(ring)), self.posts_of(self.frame.x_of(last)));
        let chunk = &mut self.chunk;
        (chunk.ring, chunk.rings, chunk.first) = (ring, last - ring + 1, *near.start());
        chunk.width = (distant.end() - near.start() + 1).max(0) as usize;
        chunk.heights.clear();
        chunk.heights.resize(chunk.rings * chunk.width, f32::NAN);
        let heights = self.scene.lattice.heights();
        if self.frame.ring_step.unsigned_abs() == 1 {
            for at in 0..chunk.width {
                let first = self.frame.index(ring, chunk.first + at as i64) as i64;
                for k in 0..chunk.rings {
                    let index = first + k as i64 * self.frame.ring_step;
                    chunk.heights[k * chunk.width + at] = heights[index as usize];
                }
            }
        } else {
            for k in 0..chunk.rings {
                let row = &mut chunk.heights[k * chunk.width..(k + 1) * chunk.width];
                let first = self.frame.index(ring + k, chunk.first) as i64;
                for (at, height) in row.iter_mut().enumerate() {
                    *height = heights[(first + at as i64 * self.frame.cross_step) as usize];
                }
            }
        }
    }

    /// Marks the posts that may stand out over the horizon; returns whether a target on one may.
    fn measure(&mut self) -> bool {
        let floor = self.horizon.floor();
        let (count, last) = (floor.len() as f64, floor.len() - 1);
        let ring = &mut self.ring;
        let (error, lift) = (ring.error, self.scene.target_m / ring.x);
        let (mut any_loud, mut any_target) = (false, false);
        for ((&u, &v), loud) in ring.u.iter().zip(&ring.v).zip(&mut ring.loud) {
            let floor = floor[((u * count) as usize).min(last)];
            *loud = v + error >= floor;
            any_loud |= *loud;
            any_target |= v + lift + error >= floor;
        }
        ring.any_loud = any_loud;
        any_target
    }

    /// Looks at the posts of the ring.
    fn decide(&mut self) {
        let lift = self.scene.target_m / self.ring.x;
        let is_near = self.ring.x <= NEAR;
        let floor = std::mem::take(self.horizon.floor());
        let (count, last) = (floor.len() as f64, floor.len() - 1);
        let is_ground = lift == 0.0 && !is_near;
        for index in 0..self.ring.v.len() {
            if is_ground && !self.ring.loud[index] {
                continue;
            }
            let target = RingPost { u: self.ring.u[index], v: self.ring.v[index] + lift };
            let floor = floor[((target.u * count) as usize).min(last)];
            let is_low = !is_near && target.v + self.ring.error < floor;
            // a border belongs to the wedge that it begins
            let is_inside =
                target.u >= self.from && (target.u < self.to || self.to == 1.0 && target.u <= LAST);
            if !is_low && is_inside && !target.v.is_nan() {
                self.look(self.ring.first + index as i64, target);
            }
        }
        *self.horizon.floor() = floor;
    }

    /// Looks at post `j` of the ring.
    fn look(&mut self, j: i64, target: RingPost) {
        let post = self.frame.post(self.ring.number, j);
        let seen = if self.ring.x <= NEAR { None } else { self.seen(j, target, self.ring.error) };
        let seen = seen.filter(|&seen| !seen || (self.lines.sure)(post)).unwrap_or_else(|| {
            self.looked += 1;
            (self.lines.exact)(post)
        });
        if seen {
            self.visible[self.scene.lattice.index(post)].store(true, Ordering::Relaxed);
        }
    }

    /// Whether the target on post `j` can be seen; `None` where only looking can tell.
    fn seen(&self, j: i64, target: RingPost, error: f64) -> Option<bool> {
        let RingPost { u, v } = target;
        let span = self.horizon.span(u, v - error, self.scene.margins.across / self.ring.x)?;
        if v + error < span.low {
            return Some(false);
        }
        // the one edge of the last strip that the line crosses
        let diagonal = self.last_diagonal(j, u);
        if v + error < diagonal - error {
            return Some(false);
        }
        let is_over = diagonal.is_nan() || v - error > diagonal + error;
        let clear = is_over && v - error > span.high && v - error > self.near;
        clear.then_some(true)
    }

    /// What the diagonal of the last cell on the way to post `j` has on the post's ray, where it does not end at the
    /// post; NaN where it does.
    fn last_diagonal(&self, j: i64, u: f64) -> f64 {
        let joins_post = (self.frame.parity(self.ring.number) + j) % 2 == 0;
        match (self.before.get(j), self.ring.get(j - 1)) {
            (Some(near), Some(far)) if !joins_post => {
                far.v + (near.v - far.v) * ((u - far.u) / (near.u - far.u))
            }
            _ => f64::NAN,
        }
    }

    /// Takes in the ring's own edges.
    fn ring_edges(&mut self) {
        let shake = self.shake(self.ring.x);
        let error = self.ring.error;
        for j in self.ring.first..self.ring.end() {
            let (loud, next_loud) = (self.ring.is_loud(j), self.ring.is_loud(j + 1));
            if !loud && !next_loud {
                continue;
            }
            let Some(mark) = self.ring.get(j) else { continue };
            if loud && (self.is_gap(j - 1) || self.is_gap(j + 1)) {
                self.horizon.doubt(Doubt { u0: mark.u - shake, u1: mark.u + shake, v: mark.v + error });
            }
            let Some(next) = self.ring.get(j + 1) else { continue };
            if (mark.v + next.v).is_nan() {
                continue;
            }
            // beside a gap a ray may just miss the edge
            let ends = (self.is_gap(j - 1), self.is_gap(j + 2));
            let slope = (next.v - mark.v) / (next.u - mark.u);
            let cut = |gap: bool| if gap { shake } else { 0.0 };
            let (start, end) = (cut(ends.0), cut(ends.1));
            self.horizon.insert(&HorizonEdge {
                u0: mark.u + start,
                v0: mark.v + slope * start,
                u1: next.u - end,
                v1: next.v - slope * end,
                error,
            });
        }
    }

    fn is_gap(&self, j: i64) -> bool {
        self.ring.get(j).is_some_and(|mark| mark.v.is_nan())
    }

    fn shake(&self, x: f64) -> f64 {
        2.0 * self.scene.margins.across / x
    }

    /// Takes in the rungs and diagonals of the strip before the ring.
    fn strip(&mut self, ring: usize) {
        let parity = self.frame.parity(ring - 1);
        let first = self.ring.first;
        let (mut a_loud, mut b_loud) = (self.before.is_loud(first), self.ring.is_loud(first));
        for j in first..self.ring.end().min(self.before.end()) {
            let (d_loud, c_loud) = (self.before.is_loud(j + 1), self.ring.is_loud(j + 1));
            let (a_loud, b_loud) =
                (std::mem::replace(&mut a_loud, d_loud), std::mem::replace(&mut b_loud, c_loud));
            if !(a_loud || b_loud || c_loud || d_loud) {
                continue;
            }
            let (Some(a), Some(b)) = (self.before.get(j), self.ring.get(j)) else { continue };
            if (a_loud || b_loud) && !self.rung_is_under(j, a, b) {
                self.cross_edge(b, a);
            }
            let (Some(d), Some(c)) = (self.before.get(j + 1), self.ring.get(j + 1)) else { continue };
            if (j + parity) % 2 == 0 {
                if (a_loud || c_loud) && !self.outward_is_under(j, a, c) {
                    self.cross_edge(a, c);
                }
            } else if (b_loud || d_loud) && !self.inward_is_under(j, [a, b, c, d]) {
                self.cross_edge(b, d);
            }
        }
    }

    /// Whether the rung from `a` out to `b` lies nowhere higher than both rings. All three are straight from `b`'s ray
    /// to `a`'s, so it is enough that either ring is as high where the rung leaves the other.
    fn rung_is_under(&self, j: i64, a: RingPost, b: RingPost) -> bool {
        let within = self.ring.get(j + 1).is_some_and(|c| a.u <= c.u);
        within && a.v <= self.ring.between(j, a.u)
            || self.before.get(j - 1).is_some_and(|near| near.u <= b.u)
                && b.v <= self.before.between(j - 1, b.u)
    }

    /// The same for the diagonal from `a` out to the next post's `c`.
    fn outward_is_under(&self, j: i64, a: RingPost, c: RingPost) -> bool {
        a.u <= c.u && (a.v <= self.ring.between(j, a.u) || c.v <= self.before.between(j, c.u))
    }

    /// The same for the diagonal from `b` in to the next post's `d`, which passes the rays of `a` and `c`.
    fn inward_is_under(&self, j: i64, [a, b, c, d]: [RingPost; 4]) -> bool {
        let at = |u: f64| b.v + (d.v - b.v) * ((u - b.u) / (d.u - b.u));
        let far = self.ring.get(j + 2).is_some_and(|far| d.u <= far.u);
        let near = self.before.get(j - 1).is_some_and(|near| near.u <= b.u);
        let in_order = b.u <= a.u && c.u <= d.u;
        in_order
            && (far && c.v >= at(c.u) && d.v <= self.ring.between(j + 1, d.u)
                || near && a.v >= at(a.u) && b.v <= self.before.between(j - 1, b.u))
    }

    /// Takes in an edge across the strip, from one ray to a later one.
    fn cross_edge(&mut self, from: RingPost, to: RingPost) {
        let error = self.ring.error;
        self.cross(from, to, (self.before.x, self.ring.x), error);
    }

    pub(super) fn cross(&mut self, from: RingPost, to: RingPost, (near_x, far_x): (f64, f64), error: f64) {
        let (from, to) = if from.u <= to.u { (from, to) } else { (to, from) };
        if (from.v + to.v).is_nan() {
            return;
        }
        let shake = self.shake(near_x);
        let width = to.u - from.u;
        if width * far_x < NARROW {
            // exactly along a ray it hides no more than its ends do
            if width > 0.0 {
                self.horizon.doubt(Doubt {
                    u0: from.u - shake,
                    u1: to.u + shake,
                    v: from.v.max(to.v) + error,
                });
            }
            return;
        }
        // a ray may just miss an end of it; there the rings hide as much
        let slope = (to.v - from.v) / width;
        self.horizon.insert(&HorizonEdge {
            u0: from.u + shake,
            v0: from.v + slope * shake,
            u1: to.u - shake,
            v1: to.v - slope * shake,
            error,
        });
    }
}
