//! The horizon over a few rays, piece by piece, and how edges change it.
//!
//! An edge is merged with the pieces that it meets, or, where edges that join end to end are higher everywhere, they take
//! the place of all pieces: on a slope that faces the observer each ring of posts hides the one before.

use std::ops::RangeInclusive;

/// A stretch of the horizon from `u` to the next piece's, or to the end of the bucket.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct HorizonPiece {
    pub u: f64,
    pub v: f64,
    pub slope: f64,
    pub error: f64,
}

impl HorizonPiece {
    #[inline]
    pub fn at(&self, u: f64) -> f64 {
        self.v + self.slope * (u - self.u)
    }

    /// This piece from `u` on.
    pub fn from(&self, u: f64) -> Self {
        if u == self.u { *self } else { Self { u, v: self.at(u), ..*self } }
    }
}

/// Rays on which ground may reach `v`, which only a line of sight decides: at an edge almost along the rays, or at a post
/// beside a gap in the data.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Doubt {
    pub u0: f64,
    pub u1: f64,
    pub v: f64,
}

/// Edges of the same error that join end to end: the points where they do, `u` ascending, two or more.
#[derive(Clone, Copy, Debug)]
pub(super) struct EdgeChain<'a> {
    pub u: &'a [f64],
    pub v: &'a [f64],
    /// One over the step of `u` from each point to the next, which is the same for all.
    pub per_step: f64,
    /// The error of `v` on them.
    pub error: f64,
    /// Whether an edge is higher than the ring before and the strip between; of none where nothing is known.
    pub is_ahead: &'a [bool],
}

impl EdgeChain<'_> {
    /// The number of edges.
    pub fn edges(&self) -> usize {
        self.u.len() - 1
    }

    /// A lower bound of `v` on some.
    pub fn least(&self, edges: RangeInclusive<usize>) -> f64 {
        let points = &self.v[*edges.start()..=*edges.end() + 1];
        points.iter().fold(f64::INFINITY, |low, &v| if v < low { v } else { low }) - self.error
    }

    /// The line of an edge.
    #[inline]
    pub fn line(&self, edge: usize) -> HorizonPiece {
        let (u, v) = (self.u[edge], self.v[edge]);
        HorizonPiece { u, v, slope: (self.v[edge + 1] - v) * self.per_step, error: self.error }
    }
}

/// How edges stand to the pieces of a bucket.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ChainStanding {
    /// They hide all pieces, and the bucket then holds the edges with their own error.
    Ahead,
    /// They change nothing.
    Behind,
    /// They hide some.
    Mixed,
}

/// The pieces of the horizon over some rays, the first at their begin, and what is in doubt there.
#[derive(Clone, Debug, Default)]
pub(super) struct Bucket {
    pub pieces: Vec<HorizonPiece>,
    pub doubts: Vec<Doubt>,
}

impl Bucket {
    /// The horizon on a ray of the bucket, and its error.
    #[inline]
    pub fn level(&self, u: f64) -> (f64, f64) {
        let mut piece = &self.pieces[0];
        for next in &self.pieces[1..] {
            if next.u > u {
                break;
            }
            piece = next;
        }
        (piece.at(u), piece.error)
    }

    /// A lower bound of the horizon up to the bucket's `end`.
    pub fn least(&self, end: f64) -> f64 {
        let ends = self.pieces.iter().skip(1).map(|next| next.u).chain([end]);
        let least = |piece: &HorizonPiece, end: f64| piece.v.min(piece.at(end)) - piece.error;
        self.pieces.iter().zip(ends).fold(f64::INFINITY, |low, (piece, end)| low.min(least(piece, end)))
    }

    /// How edges of a chain stand that cover the bucket, whose borders are `begin` and `end`.
    pub fn standing(
        &self,
        chain: &EdgeChain<'_>,
        edges: RangeInclusive<usize>,
        (begin, end): (f64, f64),
    ) -> ChainStanding {
        let (mut is_ahead, mut is_behind) = (true, true);
        let (mut edge, mut start) = (*edges.start(), begin);
        let mut line = chain.line(edge);
        let mut pieces = self.pieces.iter();
        let Some(mut old) = pieces.next() else { return ChainStanding::Mixed };
        let mut next = pieces.next();
        // Stretch by stretch on which both are straight.
        loop {
            let (old_stop, line_stop) = (next.map_or(end, |next| next.u), lesser(chain.u[edge + 1], end));
            let stop = lesser(old_stop, line_stop);
            let (first, last) = (line.at(start) - old.at(start), line.at(stop) - old.at(stop));
            // As the merge of a single edge decides it: a lead counts where it is no less than the loser's error, or that is no
            // more than the winner's.
            let lead = if old.error <= chain.error { 0.0 } else { old.error };
            let lag = if chain.error <= old.error { 0.0 } else { -chain.error };
            is_ahead &= (first >= lead) & (last >= lead);
            is_behind &= (first <= lag) & (last <= lag);
            if stop >= end || !(is_ahead || is_behind) {
                break;
            }
            if let Some(piece) = next.filter(|_| stop == old_stop) {
                (old, next) = (piece, pieces.next());
            }
            if stop == line_stop {
                edge += 1;
                line = chain.line(edge);
            }
            start = stop;
        }
        match (is_ahead, is_behind) {
            (_, true) => ChainStanding::Behind,
            (true, _) => ChainStanding::Ahead,
            _ => ChainStanding::Mixed,
        }
    }

    /// Lets edges of a chain take the place of all pieces, from the bucket's `begin` on.
    pub fn replace(&mut self, chain: &EdgeChain<'_>, edges: RangeInclusive<usize>, begin: f64) {
        self.pieces.clear();
        self.pieces.extend(edges.map(|edge| chain.line(edge).from(chain.u[edge].max(begin))));
    }

    /// Merges a line with the pieces from `part.0` to `part.1`; returns whether that changed any. The bucket ends at `last`;
    /// what `scratch` holds does not matter.
    pub fn insert(
        &mut self,
        line: &HorizonPiece,
        part: (f64, f64),
        last: f64,
        scratch: &mut Vec<HorizonPiece>,
    ) -> bool {
        self.changes(line, part) && self.merge(&|_| (*line, part.1), 0, part, last, scratch)
    }

    /// Merges edges of a chain; returns whether that changed any piece. The bucket begins at `borders.0` and ends at
    /// `borders.1`; what `scratch` holds does not matter.
    pub fn insert_chain(
        &mut self,
        chain: &EdgeChain<'_>,
        edges: RangeInclusive<usize>,
        borders: (f64, f64),
        scratch: &mut Vec<HorizonPiece>,
    ) -> bool {
        let part = (chain.u[*edges.start()].max(borders.0), chain.u[*edges.end() + 1].min(borders.1));
        let line = |edge: usize| (chain.line(edge), chain.u[edge + 1]);
        part.0 < part.1 && self.merge(&line, *edges.start(), part, borders.1, scratch)
    }

    /// Whether a line changes a piece from `start` to `end`; most do not, and need no merge.
    fn changes(&self, line: &HorizonPiece, (start, end): (f64, f64)) -> bool {
        let pieces = &self.pieces;
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

    /// Merges lines that join end to end, from the one numbered `number` on, with the pieces from `start` to `end`. Each comes
    /// with its end; that of the last is `end` or beyond.
    #[inline(always)]
    fn merge(
        &mut self,
        line: &impl Fn(usize) -> (HorizonPiece, f64),
        mut number: usize,
        (start, end): (f64, f64),
        last: f64,
        scratch: &mut Vec<HorizonPiece>,
    ) -> bool {
        let mut pieces = std::mem::take(scratch);
        let olds = &self.pieces;
        // The pieces that end before are kept, and those that begin after.
        let mut first = 0;
        while first + 1 < olds.len() && olds[first + 1].u <= start {
            first += 1;
        }
        pieces.clear();
        pieces.extend_from_slice(&olds[..first]);
        let mut merged = MergedBucket { pieces, origin: PieceOrigin::None, is_changed: false };
        let (mut new, mut new_stop) = line(number);
        let mut at = first;
        if olds[first].u < start {
            merged.push(PieceOrigin::Old(first as u32), &olds[first], olds[first].u);
        }
        loop {
            let (old, origin) = (&olds[at], PieceOrigin::Old(at as u32));
            let stop = olds.get(at + 1).map_or(last, |next| next.u);
            let (mut from, to) = (if old.u > start { old.u } else { start }, lesser(stop, end));
            while from < to {
                while new_stop <= from {
                    number += 1;
                    (new, new_stop) = line(number);
                }
                let until = lesser(new_stop, to);
                let new = Contender { origin: PieceOrigin::New(number as u32), piece: &new };
                merged.push_greater(Contender { origin, piece: old }, new, from, until);
                from = until;
            }
            if stop > end {
                merged.push(origin, old, end.max(old.u));
            }
            at += 1;
            if stop >= end || at == olds.len() {
                break;
            }
        }
        merged.pieces.extend_from_slice(&olds[at..]);
        let MergedBucket { mut pieces, is_changed, .. } = merged;
        // A crossing may be rounded to the end of the bucket. A piece there covers nothing, and on the last ray, which belongs
        // to the last bucket, it would hide the pieces that end there.
        while pieces.len() > 1 && pieces.last().is_some_and(|piece| piece.u >= last) {
            pieces.pop();
        }
        if is_changed {
            std::mem::swap(&mut pieces, &mut self.pieces);
        }
        *scratch = pieces;
        is_changed
    }
}

/// The lesser of two numbers: unlike `min`, without thought of NaN.
#[inline(always)]
fn lesser(a: f64, b: f64) -> f64 {
    if b < a { b } else { a }
}

/// Where the last stretch of a merged bucket comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
enum PieceOrigin {
    None,
    Old(u32),
    New(u32),
}

/// A piece or a new line, of which the greater becomes part of a merged bucket.
#[derive(Clone, Copy)]
struct Contender<'a> {
    origin: PieceOrigin,
    piece: &'a HorizonPiece,
}

/// A bucket under construction, from its old pieces and new lines.
struct MergedBucket {
    pieces: Vec<HorizonPiece>,
    origin: PieceOrigin,
    is_changed: bool,
}

impl MergedBucket {
    // These run for every stretch.

    /// Lets `piece` apply from `u` on; the last stretch continues if it is the same line with the same error.
    #[inline(always)]
    fn push(&mut self, origin: PieceOrigin, piece: &HorizonPiece, u: f64) {
        match self.pieces.last_mut() {
            Some(last) if self.origin == origin && last.error == piece.error => {}
            Some(last) if last.u == u => *last = HorizonPiece { u, v: piece.at(u), ..*piece },
            _ => self.pieces.push(piece.from(u)),
        }
        self.origin = origin;
        self.is_changed |= matches!(origin, PieceOrigin::New(_));
    }

    /// Pushes the greater of an old piece and a new line, from `start` to `end`.
    #[inline(always)]
    fn push_greater(&mut self, old: Contender<'_>, new: Contender<'_>, start: f64, end: f64) {
        let above = |u: f64| new.piece.at(u) - old.piece.at(u);
        let (first, last) = (above(start), above(end));
        if first <= 0.0 && last <= 0.0 {
            self.push_winner(old, new, -first.max(last), start);
        } else if first >= 0.0 && last >= 0.0 {
            self.push_winner(new, old, first.min(last), start);
        } else {
            let middle = (start + (end - start) * (first / (first - last))).clamp(start, end);
            let (early, late) = if first > 0.0 { (new, old) } else { (old, new) };
            self.push_winner(early, late, 0.0, start);
            self.push_winner(late, early, 0.0, middle);
        }
    }

    /// Pushes the greater piece from `u` on; where it wins by less than the loser's error, it takes on the greater error.
    #[inline(always)]
    fn push_winner(&mut self, winner: Contender<'_>, loser: Contender<'_>, gap: f64, u: f64) {
        let (piece, loser_error) = (winner.piece, loser.piece.error);
        let error = if gap < loser_error { piece.error.max(loser_error) } else { piece.error };
        self.is_changed |= error != piece.error;
        self.push(winner.origin, &HorizonPiece { error, ..*piece }, u);
    }
}
