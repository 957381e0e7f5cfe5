//! How far work on a scene is, for another thread to read when it wants to: the step, and its share where the step counts.

use std::sync::{Mutex, PoisonError};

use sandtable_render::drawn_rows::DrawnRows;
use sandtable_terrain::stop_flag::StopFlag;

/// The step that work on a scene is at, and how far that step is.
///
/// ```
/// use sandtable_sheet::step_watch::StepWatch;
/// let watch = StepWatch::default();
/// watch.begin("packing");
/// watch.counted().stretch(0.0..1.0, 4);
/// watch.counted().did(3);
/// assert_eq!((watch.step(), watch.share()), ("packing", Some(0.75)));
/// watch.begin("writing");
/// assert_eq!(watch.share(), None);
/// ```
#[derive(Debug, Default)]
pub struct StepWatch {
    step: Mutex<&'static str>,
    drawn: DrawnRows,
    counted: StopFlag,
}

impl StepWatch {
    /// Says that a step begins.
    pub fn begin(&self, step: &'static str) {
        self.counted.part(0.0..1.0);
        *self.step.lock().unwrap_or_else(PoisonError::into_inner) = step;
    }

    /// The step that began last; empty before the first.
    pub fn step(&self) -> &'static str {
        *self.step.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The share of that step that is done, 0..=1; `None` where it does not count.
    pub fn share(&self) -> Option<f64> {
        self.drawn.share().or_else(|| self.counted.share())
    }

    /// Where a renderer counts the rows that it has drawn.
    pub fn drawn(&self) -> &DrawnRows {
        &self.drawn
    }

    /// Where a step that draws no picture says how far it is.
    pub fn counted(&self) -> &StopFlag {
        &self.counted
    }
}
