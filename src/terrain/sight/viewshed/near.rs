//! The strip of cells that the observer stands in: its edges pass the observer on all sides, so they are cut to the
//! wedge and, where they come too near for `rise / x` to say anything, taken for as high as their higher end.

use crate::terrain::sight::viewshed::sweep::{NEAREST, PostRing, RingPost, Sweep};

impl Sweep<'_> {
    /// Takes in the strip that the observer stands in, or stands just before: its edges are cut to the wedge.
    pub(super) fn near_strip(&mut self, ring: usize) {
        let parity = self.frame.parity(ring - 1);
        for j in 0..self.ring.end().min(self.before.end()) {
            let corner = |ring: &PostRing, j: i64| {
                let height = *ring.heights.get(usize::try_from(j - ring.first).ok()?)?;
                Some(WedgeCorner { x: ring.x, y: j as f64 - self.frame.offset, height })
            };
            let (a, d) = (corner(&self.before, j), corner(&self.before, j + 1));
            let (b, c) = (corner(&self.ring, j), corner(&self.ring, j + 1));
            let diagonal = if (j + parity) % 2 == 0 { (a, c) } else { (b, d) };
            // a ring nearer than NEAREST is not taken in as a ring
            let along = (self.ring.x < NEAREST, (b, c));
            for (counts, edge) in [(true, (a, b)), (true, diagonal), along] {
                if let (true, (Some(from), Some(to))) = (counts, edge) {
                    self.near_edge(from, to);
                }
            }
        }
    }

    fn near_edge(&mut self, from: WedgeCorner, to: WedgeCorner) {
        if (from.height + to.height).is_nan() {
            // its ends are posts of rings; one nearer than NEAREST still hides what lies right behind it
            for end in
                [from, to].into_iter().filter(|end| end.x < NEAREST && end.x > 0.0 && !end.height.is_nan())
            {
                self.stand_near(end.height);
            }
            return;
        }
        let is_observer = |corner: &WedgeCorner| corner.x == 0.0 && corner.y == 0.0;
        if is_observer(&from) || is_observer(&to) {
            return;
        }
        let slack = 4.0 * self.scene.margins.across;
        let inside = |t: f64| from.toward(&to, t);
        let in_wedge = cut((0.0, 1.0), (from.y + slack, to.y + slack));
        let in_wedge = in_wedge.and_then(|part| cut(part, (from.x - from.y + slack, to.x - to.y + slack)));
        let Some((start, end)) = in_wedge else { return };
        if inside(start).x < NEAREST || inside(end).x < NEAREST {
            let near = cut((start, end), (NEAREST - from.x, NEAREST - to.x));
            let high =
                near.map_or(f64::NEG_INFINITY, |(start, end)| inside(start).height.max(inside(end).height));
            self.stand_near(high);
        }
        let Some((start, end)) = cut((start, end), (from.x - NEAREST, to.x - NEAREST)) else { return };
        let (from, to) = (inside(start), inside(end));
        if from.x >= NEAREST && to.x >= NEAREST {
            let (near_x, far_x) = (from.x.min(to.x), from.x.max(to.x));
            let margins = self.scene.margins;
            let error = (margins.height_m + margins.bend_m * far_x / near_x) / near_x;
            self.cross(self.mark(&from), self.mark(&to), (near_x, far_x), error);
        }
    }

    fn mark(&self, corner: &WedgeCorner) -> RingPost {
        let u = corner.y / corner.x;
        let sag = corner.x * (self.bend.along + self.bend.across * u * u);
        RingPost { u, v: (corner.height - self.scene.eye_m) / corner.x - sag }
    }

    /// Ground of this height stands nearer than [`NEAREST`] somewhere in the wedge.
    fn stand_near(&mut self, height_m: f64) {
        let margin = self.scene.margins.height_m + (self.bend.along + self.bend.across).abs();
        let rise = height_m - self.scene.eye_m + margin;
        self.near = self.near.max(if rise >= 0.0 { f64::INFINITY } else { rise / NEAREST });
    }
}

/// A post, or a place on an edge, in the frame of the wedge.
#[derive(Clone, Copy)]
struct WedgeCorner {
    x: f64,
    y: f64,
    height: f64,
}

impl WedgeCorner {
    fn toward(&self, to: &Self, t: f64) -> Self {
        let blend = |from: f64, to: f64| from + (to - from) * t;
        Self { x: blend(self.x, to.x), y: blend(self.y, to.y), height: blend(self.height, to.height) }
    }
}

/// The part of `part` where what runs evenly from `ends.0` at 0 to `ends.1` at 1 is not negative.
fn cut(part: (f64, f64), ends: (f64, f64)) -> Option<(f64, f64)> {
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
