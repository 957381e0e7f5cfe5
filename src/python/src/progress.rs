//! Work on another thread, whose progress Python says meanwhile.

use std::panic::resume_unwind;
use std::sync::mpsc::{self, RecvTimeoutError};
use std::thread;
use std::time::Duration;

use pyo3::prelude::*;
use sandtable::StepWatch;

/// The module of Python that shows progress.
const HALF: &str = "sandtable._progress";

/// How often progress is said: often enough to move, and so rarely that it costs nothing.
const SAID_EVERY: Duration = Duration::from_millis(100);

/// A step and, where it counts, its share.
pub type StepShare = (&'static str, Option<f64>);

/// Work that another thread does.
pub struct SaidWork<'a> {
    /// How far it is; `None` before there is anything to say.
    pub how_far: &'a (dyn Fn() -> Option<StepShare> + Sync),
    /// Ends it early, where it can.
    pub stop: &'a (dyn Fn() + Sync),
}

/// What `compute` gives, which says to a watch how far it is; as [`said_meanwhile`], but that it cannot be ended early.
pub fn watched<T: Send>(
    py: Python<'_>,
    progress: Option<&Bound<'_, PyAny>>,
    compute: impl FnOnce(&StepWatch) -> T + Send,
) -> PyResult<T> {
    let watch = StepWatch::default();
    let how_far = || Some((watch.step(), watch.share())).filter(|(step, _)| !step.is_empty());
    said_meanwhile(py, progress, &SaidWork { how_far: &how_far, stop: &|| () }, || compute(&watch))
}

/// What `compute` gives. Where `progress`, as the user gave it, asks for it, that is computed on another thread while Python says how
/// far it is; an exception, also of a signal, stops it.
pub fn said_meanwhile<T: Send>(
    py: Python<'_>,
    progress: Option<&Bound<'_, PyAny>>,
    work: &SaidWork<'_>,
    compute: impl FnOnce() -> T + Send,
) -> PyResult<T> {
    let said = py.import(HALF)?.call_method1("of", (progress,))?;
    if said.is_none() {
        return Ok(py.detach(compute));
    }
    let heard = said.as_unbound();
    let computed = py.detach(|| computed_beside(heard, work, compute));
    said.call_method1("end", (computed.is_ok(),))?;
    computed
}

fn computed_beside<T: Send>(
    said: &Py<PyAny>,
    work: &SaidWork<'_>,
    compute: impl FnOnce() -> T + Send,
) -> PyResult<T> {
    thread::scope(|threads| {
        let (working, ended) = mpsc::channel::<()>();
        let computing = threads.spawn(move || {
            let computed = compute();
            drop(working);
            computed
        });
        while let Err(RecvTimeoutError::Timeout) = ended.recv_timeout(SAID_EVERY) {
            let heard = Python::attach(|py| {
                py.check_signals()?;
                (work.how_far)().map_or(Ok(()), |at| said.call_method1(py, "at", at).map(drop))
            });
            if let Err(error) = heard {
                (work.stop)();
                return Err(error);
            }
        }
        Ok(computing.join().unwrap_or_else(|panic| resume_unwind(panic)))
    })
}
