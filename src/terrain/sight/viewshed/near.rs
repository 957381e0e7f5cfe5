//! The strips of cells around the observer. The edges of the first pass the observer on all sides, so all are clipped to the
//! wedge; where they come too near for `rise / x` to be meaningful, they count as high as their higher end.

use crate::sight::viewshed::ring::{PostRing, RingPost};
use crate::sight::viewshed::sweep::{NEAREST, Sweep};

impl Sweep<'_> {
    /// Adds the strip that the observer stands in, or one of the next, to the horizon.
    pub(super) fn near_strip(&mut self, ring: usize) {
        let parity = self.frame.parity(ring - 1);
        for j in 0..self.ring.end().min(self.before.end()) {
            let corner = |ring: &PostRing, j: i64| {
                let height = *ring.heights.get(usize::try_from(j - ring.first).ok()?)?;
                Some(WedgePoint { x: ring.x, y: j as f64 - self.frame.offset, height: f64::from(height) })
            };
            let (a, d) = (corner(&self.before, j), corner(&self.before, j + 1));
            let (b, c) = (corner(&self.ring, j), corner(&self.ring, j + 1));
            let diagonal = if (j + parity) % 2 == 0 { a.zip(c) } else { b.zip(d) };
            // A ring nearer than NEAREST is not added as a ring.
            let along = b.zip(c).filter(|_| self.ring.x < NEAREST);
            for (from, to) in [a.zip(b), diagonal, along].into_iter().flatten() {
                self.near_edge(from, to);
            }
        }
    }

    fn near_edge(&mut self, from: WedgePoint, to: WedgePoint) {
        let slack = 4.0 * self.scene.margins.across;
        let is_observer = |corner: &WedgePoint| corner.x == 0.0 && corner.y == 0.0;
        if (from.height + to.height).is_nan() {
            // Posts of farther rings are added with their rings. Rounding may move a crossing onto a post beside the observer.
            let is_beside =
                |end: &WedgePoint| end.x.abs() <= slack && end.y.abs() <= slack && !is_observer(end);
            for end in [from, to] {
                if end.x < NEAREST && (end.x > 0.0 || is_beside(&end)) && !end.height.is_nan() {
                    self.raise_near(end.height);
                }
            }
            return;
        }
        if is_observer(&from) || is_observer(&to) {
            return;
        }
        let at = |t: f64| from.toward(&to, t);
        let in_wedge = clip_part((0.0, 1.0), (from.y + slack, to.y + slack));
        let in_wedge =
            in_wedge.and_then(|part| clip_part(part, (from.x - from.y + slack, to.x - to.y + slack)));
        let Some((start, end)) = in_wedge else { return };
        if at(start).x < NEAREST || at(end).x < NEAREST {
            let near = clip_part((start, end), (NEAREST - from.x, NEAREST - to.x));
            let high = near.map_or(f64::NEG_INFINITY, |(start, end)| at(start).height.max(at(end).height));
            self.raise_near(high);
        }
        let Some((start, end)) = clip_part((start, end), (from.x - NEAREST, to.x - NEAREST)) else { return };
        let (from, to) = (at(start), at(end));
        let (near, far) = if from.x <= to.x { (from, to) } else { (to, from) };
        if near.x >= NEAREST {
            self.near_parts(near, far);
        }
    }

    /// Adds an edge part by part, each no more than twice as far at its end as at its begin: what curvature bends the far ones
    /// is little, whatever it bends the nearest.
    fn near_parts(&mut self, near: WedgePoint, far: WedgePoint) {
        let mut start = near;
        loop {
            let is_last = far.x <= 2.0 * start.x;
            let stop =
                if is_last { far } else { near.toward(&far, (2.0 * start.x - near.x) / (far.x - near.x)) };
            let parts = [self.seen(&start), self.seen(&stop)];
            let (xs, ends) = ((start.x, stop.x.max(start.x)), [start.x == near.x, is_last]);
            self.cross_part(parts, ends, xs, self.error(xs.0, xs.1));
            if is_last {
                return;
            }
            start = stop;
        }
    }

    /// A point as the observer sees it.
    fn seen(&self, point: &WedgePoint) -> RingPost {
        let u = point.y / point.x;
        let drop = point.x * (self.bend.along + self.bend.across * u * u);
        RingPost { u, v: (point.height - self.scene.eye_m) / point.x - drop }
    }

    /// Raises the bound of the ground nearer than [`NEAREST`] to ground of this height anywhere in the wedge.
    fn raise_near(&mut self, height_m: f64) {
        let margin = self.scene.margins.height_m + (self.bend.along + self.bend.across).abs();
        let rise = height_m - self.scene.eye_m + margin;
        self.near = self.near.max(if rise >= 0.0 { f64::INFINITY } else { rise / NEAREST });
    }
}

/// A post, or a point on an edge, in the frame of the wedge.
#[derive(Clone, Copy)]
struct WedgePoint {
    x: f64,
    y: f64,
    height: f64,
}

impl WedgePoint {
    fn toward(&self, to: &Self, t: f64) -> Self {
        let blend = |from: f64, to: f64| from + (to - from) * t;
        Self { x: blend(self.x, to.x), y: blend(self.y, to.y), height: blend(self.height, to.height) }
    }
}

/// The part of `part` where a value that changes evenly from `ends.0` at 0 to `ends.1` at 1 is not negative.
fn clip_part(part: (f64, f64), ends: (f64, f64)) -> Option<(f64, f64)> {
    let (first, last) = ends;
    let zero = first / (first - last);
    let part = match (first >= 0.0, last >= 0.0) {
        (true, true) => part,
        (false, false) => return None,
        (true, false) => (part.0, part.1.min(zero)),
        (false, true) => (part.0.max(zero), part.1),
    };
    (part.0 <= part.1).then_some(part)
}
