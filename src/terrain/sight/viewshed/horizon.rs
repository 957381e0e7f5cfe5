//! The horizon that a wedge of rays sees: the upper envelope of terrain edges, exact but for a stated error.
//!
//! A ray leaves the observer at `y = u·x`. Seen from there, a terrain edge is a segment in the plane of `u` and
//! `v = rise / x`: a point on it hides whatever lies on the same ray, farther off and lower in `v`. The horizon is the
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
//! Every piece carries how far off it may be. Where one edge hides another by less than that, the greater error
//! stays, so that `v ± error` always holds the true horizon.

/// A terrain edge as the observer sees it, `u0` < `u1`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct HorizonEdge {
    pub u0: f64,
    pub v0: f64,
    pub u1: f64,
    pub v1: f64,
    /// How far off `v` may be between them.
    pub error: f64,
}

impl HorizonEdge {
    fn slope(&self) -> f64 {
        (self.v1 - self.v0) / (self.u1 - self.u0)
    }
}

/// A stretch of the horizon from `u` to the next piece's, or to the end of the bucket.
#[derive(Clone, Copy, Debug, PartialEq)]
struct HorizonPiece {
    u: f64,
    v: f64,
    slope: f64,
    error: f64,
}

impl HorizonPiece {
    const NOTHING: f64 = f64::NEG_INFINITY;

    fn at(&self, u: f64) -> f64 {
        self.v + self.slope * (u - self.u)
    }
}

/// Rays on which something may stand as high as `v` and nobody can say without looking: an edge almost along the rays,
/// or a post beside a gap in the data.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Doubt {
    pub u0: f64,
    pub u1: f64,
    pub v: f64,
}

#[derive(Clone, Debug, Default)]
struct Bucket {
    pieces: Vec<HorizonPiece>,
    doubts: Vec<Doubt>,
}

/// Where the horizon stands on one ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct HorizonSpan {
    /// Certainly no lower.
    pub low: f64,
    /// Certainly no higher.
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
}

/// How many buckets to either side a floor takes in: an edge with an end in a bucket ends at most so many away, where
/// there are no more buckets than posts across the wedge.
const REACH: usize = 3;

impl Horizon {
    /// A horizon that hides nothing.
    pub fn new(from: f64, to: f64) -> Self {
        let mut horizon = Self {
            from,
            to,
            count: 1,
            buckets: vec![Bucket::default()],
            low: Vec::new(),
            floor: Vec::new(),
            floor_is_stale: true,
            scratch: Vec::new(),
        };
        horizon.buckets[0].pieces.push(HorizonPiece {
            u: 0.0,
            v: HorizonPiece::NOTHING,
            slope: 0.0,
            error: 0.0,
        });
        horizon.measure_all();
        horizon
    }

    /// Splits buckets until there are more than half as many as `posts` lie across the wedge, but no more than those.
    pub fn grow(&mut self, posts: f64) {
        while (self.count * 2) as f64 <= posts {
            self.split();
        }
    }

    fn split(&mut self) {
        let old = std::mem::take(&mut self.buckets);
        self.count *= 2;
        for (index, bucket) in old.into_iter().enumerate() {
            let middle = self.border(2 * index + 1);
            let mut halves = [Bucket::default(), Bucket::default()];
            for piece in bucket.pieces {
                if piece.u < middle {
                    halves[0].pieces.push(piece);
                    halves[1].pieces.clear();
                    halves[1].pieces.push(HorizonPiece { u: middle, v: piece.at(middle), ..piece });
                } else {
                    if piece.u == middle {
                        halves[1].pieces.clear();
                    }
                    halves[1].pieces.push(piece);
                }
            }
            for doubt in bucket.doubts {
                if doubt.u0 < middle {
                    halves[0].doubts.push(doubt);
                }
                if doubt.u1 >= middle {
                    halves[1].doubts.push(doubt);
                }
            }
            self.buckets.extend(halves);
        }
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

    /// The least that the horizon can be in a bucket; beyond the wedge nobody asks.
    fn least(&self, index: usize) -> f64 {
        let end = self.border(index + 1);
        if end <= self.from || self.border(index) >= self.to {
            return f64::INFINITY;
        }
        let pieces = &self.buckets[index].pieces;
        let ends = pieces.iter().skip(1).map(|next| next.u).chain([end]);
        pieces
            .iter()
            .zip(ends)
            .fold(f64::INFINITY, |least, (piece, end)| least.min(piece.v.min(piece.at(end)) - piece.error))
    }

    /// For each of the equal buckets of 0..=1 a height that the horizon is nowhere below, in it and as far around as
    /// an edge reaches that ends in it.
    pub fn floor(&mut self) -> &mut Vec<f64> {
        if self.floor_is_stale {
            self.floor_is_stale = false;
            // where no edge reaches the wedge from, lows are infinite, and so are floors
            let (first, last) = (self.bucket_of(self.from), self.bucket_of(self.to));
            for index in first.saturating_sub(REACH)..(last + REACH + 1).min(self.count) {
                let around = index.saturating_sub(REACH)..(index + REACH + 1).min(self.count);
                self.floor[index] = self.low[around].iter().fold(f64::INFINITY, |least, &low| least.min(low));
            }
        }
        &mut self.floor
    }

    fn bucket_of(&self, u: f64) -> usize {
        ((u * self.count as f64) as usize).min(self.count - 1)
    }

    /// Where the horizon stands on the ray `u`, `None` where only looking can tell; `shake` is how far off `u` may be
    /// and `v` what is to be seen there.
    pub fn span(&self, u: f64, v: f64, shake: f64) -> Option<HorizonSpan> {
        let bucket = &self.buckets[self.bucket_of(u)];
        let after = bucket.pieces.iter().take_while(|piece| piece.u <= u).count();
        let piece = bucket.pieces[after.saturating_sub(1)];
        let at = piece.at(u);
        let span = HorizonSpan { low: at - piece.error, high: at + piece.error };
        let doubted =
            |doubt: &Doubt| u >= doubt.u0 - shake && u <= doubt.u1 + shake && v <= doubt.v && v >= span.low;
        (!bucket.doubts.iter().any(doubted)).then_some(span)
    }

    /// Takes in what cannot be told without looking.
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

    /// Takes in an edge; what of it lies off the wedge does not matter.
    pub fn insert(&mut self, edge: &HorizonEdge) {
        if edge.u1 <= self.from || edge.u0 >= self.to {
            return;
        }
        let line = HorizonPiece { u: edge.u0, v: edge.v0, slope: edge.slope(), error: edge.error };
        let high = edge.v0.max(edge.v1) + edge.error;
        for index in self.bucket_of(edge.u0)..=self.bucket_of(edge.u1) {
            // an edge may end where a bucket begins
            let (start, end) = (edge.u0.max(self.border(index)), edge.u1.min(self.border(index + 1)));
            if start < end && high > self.low[index] && self.stands_out(index, &line, start, end) {
                self.insert_in(index, &line, start, end);
            }
        }
    }

    /// Whether a line changes a bucket from `start` to `end`: most do not, and need no bucket made anew.
    fn stands_out(&self, index: usize, line: &HorizonPiece, start: f64, end: f64) -> bool {
        let pieces = &self.buckets[index].pieces;
        let (line_start, line_end) = (line.at(start), line.at(end));
        let ends = pieces.iter().skip(1).map(|next| next.u).chain([f64::INFINITY]);
        pieces.iter().zip(ends).any(|(old, stop)| {
            if stop <= start || old.u >= end {
                return false;
            }
            let first = if old.u <= start { line_start - old.at(start) } else { line.at(old.u) - old.v };
            let last = if stop >= end { line_end - old.at(end) } else { line.at(stop) - old.at(stop) };
            let above = first.max(last);
            above > 0.0 || line.error > old.error && -above < line.error
        })
    }

    fn insert_in(&mut self, index: usize, line: &HorizonPiece, start: f64, end: f64) {
        let last = self.border(index + 1);
        let mut merged = Merged { pieces: std::mem::take(&mut self.scratch), tag: Tag::None, changed: false };
        let pieces = &self.buckets[index].pieces;
        for (at, old) in pieces.iter().enumerate() {
            let stop = pieces.get(at + 1).map_or(last, |next| next.u);
            if stop <= start || old.u >= end {
                merged.push(Tag::Old(at), old, old.u);
                continue;
            }
            if old.u < start {
                merged.push(Tag::Old(at), old, old.u);
            }
            merged.greater((at, old), line, old.u.max(start), stop.min(end));
            if stop > end {
                merged.push(Tag::Old(at), old, end);
            }
        }
        let Merged { mut pieces, changed, .. } = merged;
        if changed {
            std::mem::swap(&mut pieces, &mut self.buckets[index].pieces);
            self.low[index] = self.least(index);
            self.floor_is_stale = true;
        }
        pieces.clear();
        self.scratch = pieces;
    }

    /// Whether every bucket's pieces run on in order and its low is theirs.
    #[cfg(test)]
    pub fn check(&self) -> Result<(), String> {
        for (index, bucket) in self.buckets.iter().enumerate() {
            let in_order = bucket.pieces.windows(2).all(|pair| pair[0].u < pair[1].u);
            let first = bucket.pieces.first().map(|piece| piece.u);
            if !in_order || first != Some(self.border(index)) {
                return Err(format!("bucket {index} of {}: {:?}", self.count, bucket.pieces));
            }
            if self.low[index] != self.least(index) {
                return Err(format!("bucket {index}: low {} is not its least", self.low[index]));
            }
        }
        Ok(())
    }
}

/// Whose the last stretch of a bucket being made anew is.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Tag {
    None,
    Old(usize),
    New,
}

/// A bucket being made anew.
struct Merged {
    pieces: Vec<HorizonPiece>,
    tag: Tag,
    changed: bool,
}

impl Merged {
    /// `piece` counts from `u` on; what is the same line as before, and no less sure, goes on.
    fn push(&mut self, tag: Tag, piece: &HorizonPiece, u: f64) {
        match self.pieces.last_mut() {
            Some(last) if self.tag == tag && last.error == piece.error => {}
            Some(last) if last.u == u => *last = HorizonPiece { u, v: piece.at(u), ..*piece },
            _ if piece.u == u => self.pieces.push(*piece),
            _ => self.pieces.push(HorizonPiece { u, v: piece.at(u), ..*piece }),
        }
        self.tag = tag;
        self.changed |= tag == Tag::New;
    }

    /// The greater of the old piece `at` and the new line, from `start` to `end`.
    fn greater(&mut self, (at, old): (usize, &HorizonPiece), new: &HorizonPiece, start: f64, end: f64) {
        let (first, last) = (new.at(start) - old.at(start), new.at(end) - old.at(end));
        if first <= 0.0 && last <= 0.0 {
            self.winner(Tag::Old(at), old, new.error, -first.max(last), start);
        } else if first >= 0.0 && last >= 0.0 {
            self.winner(Tag::New, new, old.error, first.min(last), start);
        } else {
            let middle = (start + (end - start) * (first / (first - last))).clamp(start, end);
            let (early, late) = if first > 0.0 { (Tag::New, Tag::Old(at)) } else { (Tag::Old(at), Tag::New) };
            for (tag, u) in [(early, start), (late, middle)] {
                let (piece, other) = if tag == Tag::New { (new, old) } else { (old, new) };
                self.winner(tag, piece, other.error, 0.0, u);
            }
        }
    }

    /// The winner of a stretch; one that wins by less than the loser may be off is as unsure as that.
    fn winner(&mut self, tag: Tag, piece: &HorizonPiece, loser_error: f64, gap: f64, u: f64) {
        let error = if gap < loser_error { piece.error.max(loser_error) } else { piece.error };
        self.changed |= error != piece.error;
        self.push(tag, &HorizonPiece { error, ..*piece }, u);
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

    #[test]
    fn it_is_the_greatest_of_all_edges_however_often_it_is_split() {
        let mut seeded = Seeded(5);
        let mut horizon = Horizon::new(0.0, 1.0);
        let mut edges: Vec<HorizonEdge> = Vec::new();
        for turn in 1..=200 {
            if turn % 40 == 0 {
                horizon.grow(f64::from(turn) / 10.0);
            }
            let start = seeded.part() * 1.1 - 0.1;
            let end = start + seeded.part() * 0.2 + 1e-6;
            let edge = HorizonEdge { u0: start, v0: seeded.part(), u1: end, v1: seeded.part(), error: 1e-9 };
            horizon.insert(&edge);
            edges.push(edge);
            horizon.check().expect("sound");
        }
        for _ in 0..2000 {
            let u = seeded.part();
            let over = edges.iter().filter(|edge| edge.u0 <= u && u <= edge.u1);
            let true_v =
                over.map(|edge| edge.v0 + edge.slope() * (u - edge.u0)).fold(f64::NEG_INFINITY, f64::max);
            let span = horizon.span(u, 0.0, 0.0).expect("nothing is doubted");
            assert!(span.low <= true_v && true_v <= span.high, "{u}: {true_v} not in {span:?}");
        }
    }

    #[test]
    fn a_doubt_leaves_open_what_is_lower_than_it_and_not_hidden() {
        let mut horizon = Horizon::new(0.0, 1.0);
        horizon.insert(&HorizonEdge { u0: 0.0, v0: 1.0, u1: 1.0, v1: 1.0, error: 0.0 });
        horizon.doubt(Doubt { u0: 0.3, u1: 0.3001, v: 2.0 });
        assert_eq!(horizon.span(0.30005, 1.5, 0.0), None);
        assert!(horizon.span(0.30005, 2.5, 0.0).is_some() && horizon.span(0.30005, 0.5, 0.0).is_some());
        assert!(horizon.span(0.31, 1.5, 0.0).is_some());
    }
}
