//! A flag that ends a computation whose answer nobody needs any more, and that says how far the computation is.
//!
//! ```text
//! whole   0 ──────────────────────────────────────── 1
//! part          band 2 of 4: [0.25, 0.5)                 `part`: of what the caller does several times
//! stretch            [0.6, 1)                            `stretch`: of what the computation does one after the other
//! units              37 of 120 rows                      `did`
//! ```
//!
//! Who waits reads the share when it wants to; the computation calls nobody, and adds up whole numbers in any order: its answer
//! and its time stay what they are.

use std::ops::Range;
use std::sync::atomic::{AtomicBool, AtomicU32, AtomicU64, Ordering};

/// Says that a computation may end early, since its answer is not needed any more, and which share of it is done.
#[derive(Debug, Default)]
pub struct StopFlag {
    is_stopped: AtomicBool,
    part: SharedSpan,
    stretch: SharedSpan,
    /// The units of the stretch, and those that are done.
    units: AtomicU64,
    done: AtomicU64,
}

/// A part of 0..1, kept as what lies before it and after it, as bits of f32: without words, it is all.
#[derive(Debug, Default)]
struct SharedSpan {
    before: AtomicU32,
    after: AtomicU32,
}

impl StopFlag {
    /// Lets the computation end early.
    pub fn stop(&self) {
        self.is_stopped.store(true, Ordering::Relaxed);
    }

    /// Whether it may.
    #[inline]
    pub fn is_stopped(&self) -> bool {
        self.is_stopped.load(Ordering::Relaxed)
    }

    /// Says that the computation that follows is this part, 0..1, of what its caller does.
    pub fn part(&self, part: Range<f64>) {
        self.units.store(0, Ordering::Relaxed);
        self.stretch.set(0.0..1.0);
        self.part.set(part);
    }

    /// Says that this stretch of the computation, 0..1 of its time, begins, and has so many units.
    pub fn stretch(&self, stretch: Range<f64>, units: usize) {
        self.done.store(0, Ordering::Relaxed);
        self.stretch.set(stretch);
        self.units.store(units.max(1) as u64, Ordering::Relaxed);
    }

    /// Says that so many more units of the stretch are done.
    #[inline]
    pub fn did(&self, units: usize) {
        self.done.fetch_add(units as u64, Ordering::Relaxed);
    }

    /// The share of the computation that is done, 0..=1; `None` where it does not say.
    pub fn share(&self) -> Option<f64> {
        let units = self.units.load(Ordering::Relaxed);
        let done = self.done.load(Ordering::Relaxed).min(units);
        let of_stretch = (units > 0).then(|| self.stretch.at(done as f64 / units as f64));
        match of_stretch {
            None if self.part.is_all() => None,
            of_stretch => Some(self.part.at(of_stretch.unwrap_or(0.0))),
        }
    }
}

impl SharedSpan {
    fn set(&self, span: Range<f64>) {
        self.before.store((span.start as f32).to_bits(), Ordering::Relaxed);
        self.after.store((1.0 - span.end as f32).to_bits(), Ordering::Relaxed);
    }

    fn is_all(&self) -> bool {
        self.before.load(Ordering::Relaxed) == 0 && self.after.load(Ordering::Relaxed) == 0
    }

    /// The place of a share of it among all.
    fn at(&self, share: f64) -> f64 {
        let [before, after] =
            [&self.before, &self.after].map(|part| f64::from(f32::from_bits(part.load(Ordering::Relaxed))));
        (before + (1.0 - before - after) * share).clamp(0.0, 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_computation_that_does_not_say_has_no_share() {
        let flag = StopFlag::default();
        assert_eq!((flag.share(), flag.is_stopped()), (None, false));
        flag.did(3);
        assert_eq!(flag.share(), None);
        flag.stop();
        assert!(flag.is_stopped());
    }

    #[test]
    fn units_fill_their_stretch_and_stretches_the_part_of_the_caller() {
        let flag = StopFlag::default();
        flag.stretch(0.5..1.0, 10);
        assert_eq!(flag.share(), Some(0.5));
        flag.did(5);
        assert_eq!(flag.share(), Some(0.75));
        flag.did(50);
        assert_eq!(flag.share(), Some(1.0), "no more than all");
        flag.part(0.25..0.5);
        assert_eq!(flag.share(), Some(0.25));
        flag.stretch(0.0..0.5, 4);
        flag.did(2);
        assert_eq!(flag.share(), Some(0.3125));
    }
}
