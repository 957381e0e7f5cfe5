//! The horizon over a wedge of rays: the upper envelope of terrain edges, exact but for a stated error.
//!
//! A ray leaves the observer at `y = u·x`. Seen from there, a terrain edge is a segment in the plane of `u` and
//! `v = rise / x`: a point on it hides everything on the same ray that is farther off and lower in `v`. The horizon is the
//! greatest `v` of the edges passed so far, as a piecewise linear function of `u` (the envelope of Katz, Overmars and
//! Sharir 1992, kept in buckets instead of a tree: edges are short, so an insertion touches one bucket or two, and a
//! bucket holds a piece or two).
//!
//! ```text
//!  v            ╱╲                      bucket   0       1       2       3
//!  │     __    ╱  ╲_____                pieces  ├───┤──┤├──────┤├─┤─────┤├──
//!  │____╱  ╲__╱         ╲__             low      the least of each bucket's pieces
//!  └───────┴───────┴───────┴─── u       floor    the least low of the buckets around
//! ```
//!
//! Every piece carries its error. Where one edge hides another by less than that, the greater error is kept, so that
//! `v ± error` always contains the true horizon.

use std::ops::RangeInclusive;

use crate::sight::viewshed::bucket::{Bucket, ChainStanding, Doubt, EdgeChain, HorizonPiece};
use crate::sight::viewshed::ring::PostRing;

/// A terrain edge as the observer sees it, `u0` < `u1`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct HorizonEdge {
    pub u0: f64,
    pub v0: f64,
    pub u1: f64,
    pub v1: f64,
    /// The error of `v` between them.
    pub error: f64,
}

impl HorizonEdge {
    fn slope(&self) -> f64 {
        (self.v1 - self.v0) / (self.u1 - self.u0)
    }
}

/// Bounds of the horizon on one ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct HorizonSpan {
    /// A lower bound.
    pub low: f64,
    /// An upper bound.
    pub high: f64,
}

/// The horizon over the rays `from`..`to`, which lie within 0..=1.
#[derive(Clone, Debug)]
pub(super) struct Horizon {
    from: f64,
    to: f64,
    /// A power of two, so that borders of buckets are exact.
    count: usize,
    buckets: Vec<Bucket>,
    low: Vec<f64>,
    floor: Vec<f64>,
    floor_is_stale: bool,
    scratch: Vec<HorizonPiece>,
    /// The number of the ring whose edges are the horizon of a bucket, which has not got them; 0 for none.
    fronts: Vec<usize>,
    /// Those buckets, of the ring before and of the ring.
    front_buckets: Vec<usize>,
    next_fronts: Vec<usize>,
}

/// The buckets to either side that a floor takes in: an edge with an end in a bucket ends at most this many away, where there
/// are no more buckets than posts across the wedge.
const REACH: usize = 3;

/// The rays on which a ring may be a bucket's horizon without the bucket having it: beyond, rungs or diagonals are so nearly
/// along the rays that only lines of sight decide.
const FRONT_RAYS: (f64, f64) = (1.0 / 32.0, 31.0 / 32.0);

impl Horizon {
    /// A horizon that hides nothing.
    pub fn new(from: f64, to: f64) -> Self {
        let nothing = HorizonPiece { u: 0.0, v: f64::NEG_INFINITY, slope: 0.0, error: 0.0 };
        let mut horizon = Self {
            from,
            to,
            count: 1,
            buckets: vec![Bucket { pieces: vec![nothing], doubts: Vec::new() }],
            low: Vec::new(),
            floor: Vec::new(),
            floor_is_stale: true,
            scratch: Vec::new(),
            fronts: vec![0],
            front_buckets: Vec::new(),
            next_fronts: Vec::new(),
        };
        horizon.measure_all();
        horizon
    }

    /// Splits buckets until there are more than half as many as `posts` lie across the wedge, but no more than those.
    pub fn grow(&mut self, posts: f64, before: &PostRing) {
        while (self.count * 2) as f64 <= posts {
            self.end_ring(before);
            self.split();
        }
    }

    fn split(&mut self) {
        let old = std::mem::take(&mut self.buckets);
        self.count *= 2;
        for (index, bucket) in old.into_iter().enumerate() {
            let middle = self.border(2 * index + 1);
            let (before, after): (Vec<_>, Vec<_>) =
                bucket.pieces.into_iter().partition(|piece| piece.u < middle);
            // The last piece before the middle continues after it, unless one begins there.
            let across = before.last().filter(|_| after.first().is_none_or(|first| first.u > middle));
            let after = across.map(|piece| piece.from(middle)).into_iter().chain(after).collect();
            let doubts =
                |holds: &dyn Fn(&Doubt) -> bool| bucket.doubts.iter().copied().filter(holds).collect();
            let first = Bucket { pieces: before, doubts: doubts(&|doubt| doubt.u0 < middle) };
            let second = Bucket { pieces: after, doubts: doubts(&|doubt| doubt.u1 >= middle) };
            self.buckets.extend([first, second]);
        }
        self.fronts = vec![0; self.count];
        self.measure_all();
    }

    fn border(&self, index: usize) -> f64 {
        index as f64 / self.count as f64
    }

    fn measure_all(&mut self) {
        self.low = (0..self.count).map(|index| self.least(index)).collect();
        self.floor.clear();
        self.floor.resize(self.count, f64::INFINITY);
        self.floor_is_stale = true;
    }

    /// A lower bound of the horizon in a bucket; ∞ beyond the wedge, where nothing reads it.
    fn least(&self, index: usize) -> f64 {
        let end = self.border(index + 1);
        if end <= self.from || self.border(index) >= self.to {
            return f64::INFINITY;
        }
        self.buckets[index].least(end)
    }

    /// For each of the equal buckets of 0..=1 a lower bound of the horizon, in it and as far around as an edge reaches that
    /// ends in it.
    pub fn floor(&mut self) -> &mut Vec<f64> {
        if self.floor_is_stale {
            self.floor_is_stale = false;
            // Beyond the reach of the wedge's edges, lows are infinite, and so are floors.
            let (first, last) = (self.bucket_of(self.from), self.bucket_of(self.to));
            let (first, end) = (first.saturating_sub(REACH), (last + REACH + 1).min(self.count));
            self.floor[first..end].copy_from_slice(&self.low[first..end]);
            for by in 1..=REACH {
                // The lows of the buckets after each, and before.
                let last = (end + by).min(self.count);
                if first + by < last {
                    lower(&mut self.floor[first..last - by], &self.low[first + by..last]);
                }
                let start = first.max(by);
                if start < end {
                    lower(&mut self.floor[start..end], &self.low[start - by..end - by]);
                }
            }
        }
        &mut self.floor
    }

    fn bucket_of(&self, u: f64) -> usize {
        ((u * self.count as f64) as usize).min(self.count - 1)
    }

    /// The bounds of the horizon on the ray `u`, `None` where only a line of sight to `v` decides; `ray_error` is the error
    /// of `u`.
    pub fn span(&self, u: f64, v: f64, ray_error: f64) -> Option<HorizonSpan> {
        let bucket = &self.buckets[self.bucket_of(u)];
        let (at, error) = bucket.level(u);
        let span = HorizonSpan { low: at - error, high: at + error };
        let applies = |doubt: &Doubt| {
            u >= doubt.u0 - ray_error && u <= doubt.u1 + ray_error && v <= doubt.v && v >= span.low
        };
        (!bucket.doubts.iter().any(applies)).then_some(span)
    }

    /// The horizon on the ray `u` and its error, `None` where only a line of sight decides; `ray_error` is the error of `u`.
    pub fn level(&self, u: f64, ray_error: f64) -> Option<(f64, f64)> {
        let bucket = &self.buckets[self.bucket_of(u)];
        let (at, error) = bucket.level(u);
        let applies =
            |doubt: &Doubt| u >= doubt.u0 - ray_error && u <= doubt.u1 + ray_error && doubt.v >= at - error;
        (!bucket.doubts.iter().any(applies)).then_some((at, error))
    }

    /// Adds rays that only lines of sight decide.
    pub fn doubt(&mut self, doubt: Doubt) {
        if doubt.u1 < self.from || doubt.u0 > self.to {
            return;
        }
        for index in self.bucket_of(doubt.u0)..=self.bucket_of(doubt.u1) {
            let low = self.low[index];
            if doubt.v >= low {
                let doubts = &mut self.buckets[index].doubts;
                doubts.retain(|doubt| doubt.v >= low);
                doubts.push(doubt);
            }
        }
    }

    /// Adds an edge; its parts off the wedge have no effect.
    pub fn insert(&mut self, edge: &HorizonEdge) {
        if edge.u1 <= self.from || edge.u0 >= self.to {
            return;
        }
        let line = HorizonPiece { u: edge.u0, v: edge.v0, slope: edge.slope(), error: edge.error };
        let high = edge.v0.max(edge.v1) + edge.error;
        for index in self.bucket_of(edge.u0)..=self.bucket_of(edge.u1) {
            self.insert_in(index, &line, (edge.u0, edge.u1), high);
        }
    }

    /// Adds the part of an edge that lies within a bucket; `high` is an upper bound of the edge.
    fn insert_in(&mut self, index: usize, line: &HorizonPiece, (u0, u1): (f64, f64), high: f64) {
        // An edge may end where a bucket begins.
        let border = self.border(index + 1);
        let part = (u0.max(self.border(index)), u1.min(border));
        if part.0 < part.1
            && high > self.low[index]
            && self.buckets[index].insert(line, part, border, &mut self.scratch)
        {
            let least = self.least(index);
            // A front may be higher than the pieces.
            self.low[index] = if self.fronts[index] == 0 { least } else { self.low[index].max(least) };
            self.floor_is_stale = true;
        }
    }

    /// Adds edges that join end to end; their parts off the wedge have no effect. The horizon is as after
    /// [`Horizon::insert`] of each, but most buckets of a slope that faces the observer are decided at once: they hold the new
    /// edges, or what they held.
    pub fn insert_chain(&mut self, chain: &EdgeChain<'_>, ring: usize, before: &PostRing) {
        let last = chain.edges();
        let (start, end) = (chain.u[0].max(self.from), chain.u[last].min(self.to));
        if start >= end {
            return;
        }
        let mut first = 0;
        for index in self.bucket_of(start)..=self.bucket_of(end) {
            let borders = (self.border(index), self.border(index + 1));
            while first < last && chain.u[first + 1] <= borders.0 {
                first += 1;
            }
            if first == last || chain.u[first] >= borders.1 {
                return;
            }
            let mut through = first;
            while through + 1 < last && chain.u[through + 1] < borders.1 {
                through += 1;
            }
            self.insert_front(index, chain, first..=through, borders, (ring, before));
            first = through;
        }
    }

    /// Adds those edges of a chain of a ring that meet a bucket. Where they alone are its horizon from now on, the bucket does
    /// not get them: ground that faces the observer hides them behind the next ring.
    fn insert_front(
        &mut self,
        index: usize,
        chain: &EdgeChain<'_>,
        edges: RangeInclusive<usize>,
        borders: (f64, f64),
        (ring, before): (usize, &PostRing),
    ) {
        if self.low[index] == f64::INFINITY {
            return;
        }
        let covers = chain.u[*edges.start()] <= borders.0 && chain.u[*edges.end() + 1] >= borders.1;
        let mut is_front = covers && self.buckets[index].doubts.is_empty();
        if is_front && self.fronts[index] == 0 {
            is_front = borders.0 >= FRONT_RAYS.0 && borders.1 <= FRONT_RAYS.1 && !chain.is_ahead.is_empty();
            match self.buckets[index].standing(chain, edges.clone(), borders) {
                ChainStanding::Ahead if is_front => {}
                standing => return self.insert_part(index, chain, edges, borders, standing),
            }
        } else if !(is_front && chain.is_ahead[edges.clone()].iter().all(|&is_ahead| is_ahead)) {
            let was_front = self.fronts[index] != 0;
            self.settle(index, before);
            // Ahead of the ring before here, and not there.
            let is_mixed = was_front && chain.is_ahead[edges.clone()].iter().any(|&is_ahead| is_ahead);
            let standing = match covers && !is_mixed {
                true => self.buckets[index].standing(chain, edges.clone(), borders),
                false => ChainStanding::Mixed,
            };
            return self.insert_part(index, chain, edges, borders, standing);
        }
        self.fronts[index] = ring;
        self.next_fronts.push(index);
        self.low[index] = self.low[index].max(chain.least(edges));
        self.floor_is_stale = true;
    }

    /// Adds those edges of a chain that meet a bucket, and stand like this to it.
    fn insert_part(
        &mut self,
        index: usize,
        chain: &EdgeChain<'_>,
        edges: RangeInclusive<usize>,
        borders: (f64, f64),
        standing: ChainStanding,
    ) {
        match standing {
            ChainStanding::Behind => return,
            ChainStanding::Ahead => self.buckets[index].replace(chain, edges, borders.0),
            ChainStanding::Mixed => {
                if !self.buckets[index].insert_chain(chain, edges, borders, &mut self.scratch) {
                    return;
                }
            }
        }
        self.low[index] = self.least(index);
        self.floor_is_stale = true;
    }

    /// Gives a bucket the edges of the ring before that are its horizon.
    fn settle(&mut self, index: usize, before: &PostRing) {
        if std::mem::take(&mut self.fronts[index]) == 0 {
            return;
        }
        let borders = (self.border(index), self.border(index + 1));
        let posts = before.over(borders);
        let chain = EdgeChain {
            u: &before.u[posts.clone()],
            v: &before.v[posts],
            per_step: before.x,
            error: before.edge_error,
            is_ahead: &[],
        };
        let edges = 0..=chain.edges() - 1;
        let standing = self.buckets[index].standing(&chain, edges.clone(), borders);
        self.insert_part(index, &chain, edges, borders, standing);
    }

    /// Ends a ring: the horizon that still is the ring before is given to its buckets.
    pub fn end_ring(&mut self, before: &PostRing) {
        let mut fronts = std::mem::take(&mut self.front_buckets);
        for index in fronts.drain(..) {
            if self.fronts[index] == before.number {
                self.settle(index, before);
            }
        }
        self.front_buckets = std::mem::replace(&mut self.next_fronts, fronts);
    }

    /// Whether the ring before is the horizon on the ray `u`, and known as [`Horizon::span`] is not.
    pub fn is_front(&self, u: f64) -> bool {
        self.fronts[self.bucket_of(u)] != 0
    }
}

/// Lowers each of `floor` to the value beside it.
fn lower(floor: &mut [f64], lows: &[f64]) {
    for (floor, &low) in floor.iter_mut().zip(lows) {
        *floor = if low < *floor { low } else { *floor };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Seeded(u64);

    impl Seeded {
        fn part(&mut self) -> f64 {
            self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (self.0 >> 11) as f64 / (1u64 << 53) as f64
        }
    }

    /// Checks that every bucket's pieces follow each other in order and that its low is theirs.
    fn check(horizon: &Horizon) {
        for (index, bucket) in horizon.buckets.iter().enumerate() {
            assert!(bucket.pieces.windows(2).all(|pair| pair[0].u < pair[1].u), "bucket {index}: {bucket:?}");
            assert_eq!(bucket.pieces.first().map(|piece| piece.u), Some(horizon.border(index)));
            assert_eq!(horizon.low[index], horizon.least(index), "the low of bucket {index}");
        }
    }

    #[test]
    fn the_horizon_is_the_greatest_of_all_edges_after_any_splits() {
        let mut seeded = Seeded(5);
        let mut horizon = Horizon::new(0.0, 1.0);
        let mut edges: Vec<HorizonEdge> = Vec::new();
        for turn in 1..=200 {
            if turn % 40 == 0 {
                horizon.grow(f64::from(turn) / 10.0, &PostRing::default());
            }
            let start = seeded.part() * 1.1 - 0.1;
            let end = start + seeded.part() * 0.2 + 1e-6;
            let edge = HorizonEdge { u0: start, v0: seeded.part(), u1: end, v1: seeded.part(), error: 1e-9 };
            horizon.insert(&edge);
            edges.push(edge);
            check(&horizon);
        }
        for _ in 0..2000 {
            let u = seeded.part();
            let over = edges.iter().filter(|edge| edge.u0 <= u && u <= edge.u1);
            let true_v =
                over.map(|edge| edge.v0 + edge.slope() * (u - edge.u0)).fold(f64::NEG_INFINITY, f64::max);
            let span = horizon.span(u, 0.0, 0.0).expect("no doubts");
            assert!(span.low <= true_v && true_v <= span.high, "{u}: {true_v} not in {span:?}");
        }
    }

    #[test]
    fn edges_that_join_end_to_end_change_the_horizon_as_one_by_one() {
        for (from, to) in [(0.0, 1.0), (0.25, 0.5), (0.75, 1.0)] {
            let mut seeded = Seeded(11);
            let (mut together, mut apart) = (Horizon::new(from, to), Horizon::new(from, to));
            for turn in 1..=120_u32 {
                let x = f64::from(turn + 3);
                together.grow(x, &PostRing::default());
                apart.grow(x, &PostRing::default());
                // Slopes that face the observer, walls and hollows.
                let rise = [0.01, 0.0, -0.2][turn as usize % 3] * f64::from(turn);
                let first = (from * x) as usize + (seeded.part() * 3.0) as usize;
                let last = (to * x) as usize + (seeded.part() * 3.0) as usize;
                let u: Vec<f64> = (first..=last.max(first + 1)).map(|j| j as f64 / x).collect();
                let v: Vec<f64> = u.iter().map(|u| rise + u + seeded.part()).collect();
                let error = 1e-9 / x;
                let chain = EdgeChain { u: &u, v: &v, per_step: x, error, is_ahead: &[] };
                together.insert_chain(&chain, 0, &PostRing::default());
                for edge in 0..u.len() - 1 {
                    let (u0, v0, u1, v1) = (u[edge], v[edge], u[edge + 1], v[edge + 1]);
                    apart.insert(&HorizonEdge { u0, v0, u1, v1, error });
                }
                check(&together);
            }
            for _ in 0..2000 {
                let u = from + seeded.part() * (to - from);
                let spans = [&together, &apart].map(|horizon| horizon.span(u, 0.0, 0.0).expect("no doubts"));
                let [one, other] = spans.map(|span| (span.low, span.high));
                let is_same = |a: f64, b: f64| a == b || (a - b).abs() < 1e-12;
                assert!(is_same(one.0, other.0) && is_same(one.1, other.1), "{u}: {spans:?}");
            }
        }
    }

    #[test]
    fn a_doubt_leaves_open_whether_lower_unhidden_ground_is_visible() {
        let mut horizon = Horizon::new(0.0, 1.0);
        horizon.insert(&HorizonEdge { u0: 0.0, v0: 1.0, u1: 1.0, v1: 1.0, error: 0.0 });
        horizon.doubt(Doubt { u0: 0.3, u1: 0.3001, v: 2.0 });
        assert_eq!(horizon.span(0.30005, 1.5, 0.0), None);
        assert!(horizon.span(0.30005, 2.5, 0.0).is_some() && horizon.span(0.30005, 0.5, 0.0).is_some());
        assert!(horizon.span(0.31, 1.5, 0.0).is_some());
    }
}
