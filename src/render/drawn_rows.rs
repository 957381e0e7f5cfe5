//! How much of a picture the processor has drawn.

use std::sync::atomic::{AtomicU32, Ordering};

/// How many of the rows of a picture are drawn. The renderer adds them up in any order; another thread reads the share when it
/// wants to.
#[derive(Debug, Default)]
pub struct DrawnRows {
    all: AtomicU32,
    drawn: AtomicU32,
}

impl DrawnRows {
    /// The share of the rows that are drawn, 0..=1; `None` before the first is begun, and where an adapter draws.
    ///
    /// ```
    /// assert_eq!(sandtable_render::drawn_rows::DrawnRows::default().share(), None);
    /// ```
    pub fn share(&self) -> Option<f64> {
        let all = self.all.load(Ordering::Relaxed);
        let drawn = self.drawn.load(Ordering::Relaxed).min(all);
        (all > 0).then(|| f64::from(drawn) / f64::from(all))
    }

    /// Says that a picture of so many rows begins.
    pub(crate) fn begin(&self, rows: u32) {
        self.drawn.store(0, Ordering::Relaxed);
        self.all.store(rows, Ordering::Relaxed);
    }

    /// Says that so many more rows are drawn.
    pub(crate) fn add(&self, rows: u32) {
        self.drawn.fetch_add(rows, Ordering::Relaxed);
    }

    /// Says that the picture is drawn.
    pub(crate) fn end(&self) {
        self.all.store(0, Ordering::Relaxed);
    }
}
