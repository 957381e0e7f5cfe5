//! The steps of a command: a spinner with the current one on a terminal, nothing elsewhere, and the time of each.

use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

/// Times the steps of a command and shows the current one.
pub struct StepTimer {
    bar: ProgressBar,
    starts: Mutex<Vec<(&'static str, Instant)>>,
}

impl Default for StepTimer {
    fn default() -> Self {
        let bar = ProgressBar::new_spinner();
        bar.enable_steady_tick(Duration::from_millis(100));
        let style = ProgressStyle::with_template("{spinner} {msg} [{elapsed}]");
        let style = style.unwrap_or_else(|_| ProgressStyle::default_spinner());
        Self { bar: bar.with_style(style), starts: Mutex::default() }
    }
}

impl StepTimer {
    pub fn begin(&self, step: &'static str) {
        self.bar.set_message(step);
        self.starts.lock().unwrap_or_else(PoisonError::into_inner).push((step, Instant::now()));
    }

    /// Removes the spinner and returns every step with its time in seconds, in the order in which they first began; of one
    /// that began several times, the sum.
    pub fn finish(&self) -> Vec<(&'static str, f64)> {
        self.bar.finish_and_clear();
        let starts = self.starts.lock().unwrap_or_else(PoisonError::into_inner);
        let ends = starts.iter().skip(1).map(|(_, start)| *start).chain([Instant::now()]);
        let mut times: Vec<(&'static str, f64)> = Vec::new();
        for (&(step, start), end) in starts.iter().zip(ends) {
            let seconds = (end - start).as_secs_f64();
            match times.iter_mut().find(|(other, _)| *other == step) {
                Some((_, sum)) => *sum += seconds,
                None => times.push((step, seconds)),
            }
        }
        times
    }
}

impl Drop for StepTimer {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}
