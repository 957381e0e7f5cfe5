//! What happens while a user waits: a spinner with the step at hand on a terminal, silence elsewhere; and how
//! long each step took.

use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

/// Times the steps of a command and shows the one at hand.
pub struct StepTimer {
    bar: ProgressBar,
    times: Mutex<Vec<(&'static str, Instant)>>,
}

impl Default for StepTimer {
    fn default() -> Self {
        let bar = ProgressBar::new_spinner();
        bar.enable_steady_tick(Duration::from_millis(100));
        let style = ProgressStyle::with_template("{spinner} {msg} [{elapsed}]");
        Self {
            bar: bar.with_style(style.unwrap_or_else(|_| ProgressStyle::default_spinner())),
            times: Mutex::default(),
        }
    }
}

impl StepTimer {
    /// Says what is done next.
    pub fn begin(&self, step: &'static str) {
        self.bar.set_message(step);
        self.times.lock().unwrap_or_else(PoisonError::into_inner).push((step, Instant::now()));
    }

    /// Takes the spinner away and returns every step with its time in seconds, in order.
    pub fn finish(&self) -> Vec<(&'static str, f64)> {
        self.bar.finish_and_clear();
        let times = self.times.lock().unwrap_or_else(PoisonError::into_inner);
        let ends = times.iter().skip(1).map(|(_, start)| *start).chain([Instant::now()]);
        times.iter().zip(ends).map(|(&(step, start), end)| (step, (end - start).as_secs_f64())).collect()
    }
}

impl Drop for StepTimer {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}
