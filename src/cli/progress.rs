//! The steps of a command: a spinner with the current one on a terminal, nothing elsewhere, and the time of each.
//!
//! ```text
//! ⠹ analyzing 37 %, 24 s left [14s]
//! ```
//!
//! A program that shows progress of its own, such as the plugin of QGIS, sets the environment variable `SANDTABLE_PROGRESS` to
//! `lines`: then each step, and each percent of a step that knows its share, is a line of standard error.
//!
//! ```text
//! progress: analyzing
//! progress: analyzing 37 %
//! ```

use std::env;
use std::fmt::Write;
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};

use crate::output::{is_quiet, warn};
use sandtable_terrain::stop_flag::StopFlag;

/// What is left is estimated after this time, and this share: before, it is a guess.
const LEAST_TIME: Duration = Duration::from_secs(2);
const LEAST_SHARE: f64 = 0.02;

/// The environment variable that asks for lines, by [`LINES`].
const PROGRESS: &str = "SANDTABLE_PROGRESS";

/// Its value.
const LINES: &str = "lines";

/// The time between two looks at the share: a reader sees it move, and looking costs nothing.
const LOOK_AGAIN: Duration = Duration::from_millis(200);

/// Times the steps of a command and shows the current one.
pub struct StepTimer {
    bar: ProgressBar,
    starts: Mutex<Vec<(&'static str, Instant)>>,
    /// Whether steps and shares are lines of standard error.
    is_lines: bool,
}

impl Default for StepTimer {
    fn default() -> Self {
        let bar = shown(ProgressBar::new_spinner());
        bar.enable_steady_tick(Duration::from_millis(100));
        Self {
            bar: bar.with_style(step_style()),
            starts: Mutex::default(),
            is_lines: !is_quiet() && env::var_os(PROGRESS).is_some_and(|value| value == LINES),
        }
    }
}

/// A bar that a terminal shows, unless the run is quiet.
pub fn shown(bar: ProgressBar) -> ProgressBar {
    if is_quiet() {
        bar.set_draw_target(ProgressDrawTarget::hidden());
    }
    bar
}

/// The step and the time of all.
fn step_style() -> ProgressStyle {
    let style = ProgressStyle::with_template("{spinner} {msg} [{elapsed}]");
    style.unwrap_or_else(|_| ProgressStyle::default_spinner())
}

impl StepTimer {
    /// Shows beside the current step the share that `flag` states, and the time that is left.
    pub fn watch(&self, flag: Arc<StopFlag>) {
        if self.is_lines {
            let step = self.starts.lock().unwrap_or_else(PoisonError::into_inner).last().map(|start| start.0);
            write_shares(step.unwrap_or_default(), &flag);
        }
        let since = Instant::now();
        let share = move |_: &ProgressState, out: &mut dyn Write| {
            let text = flag.share().map(|share| share_text(since.elapsed(), share)).unwrap_or_default();
            // A terminal that cannot be written to has nobody who reads.
            let _ = out.write_str(&text);
        };
        if let Ok(style) = ProgressStyle::with_template("{spinner} {msg}{share} [{elapsed}]") {
            self.bar.set_style(style.with_key("share", share));
        }
    }

    pub fn begin(&self, step: &'static str) {
        if self.is_lines {
            warn(&format!("progress: {step}"));
        }
        self.bar.set_style(step_style());
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

/// Writes each percent of a step as a line, on a thread that ends when nobody else holds the flag.
fn write_shares(step: &'static str, flag: &Arc<StopFlag>) {
    let flag = Arc::downgrade(flag);
    thread::spawn(move || {
        let mut last = None;
        while let Some(flag) = flag.upgrade() {
            let percent = flag.share().map(|share| (share * 100.0).floor() as u8);
            if let Some(percent) = percent.filter(|_| percent != last) {
                warn(&format!("progress: {step} {percent} %"));
                last = Some(percent);
            }
            drop(flag);
            thread::sleep(LOOK_AGAIN);
        }
    });
}

/// The share that is done, 0..=1, after some time, and the time that is left if all goes on alike.
fn share_text(elapsed: Duration, share: f64) -> String {
    let percent = (share * 100.0).floor();
    if elapsed < LEAST_TIME || share < LEAST_SHARE {
        return format!(" {percent} %");
    }
    let left_s = (elapsed.as_secs_f64() * (1.0 - share) / share).ceil();
    let left = if left_s < 120.0 { format!("{left_s} s") } else { format!("{} min", (left_s / 60.0).ceil()) };
    format!(" {percent} %, {left} left")
}

impl Drop for StepTimer {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_time_left_follows_from_the_share_once_there_is_some() {
        let text = |seconds: u64, share: f64| share_text(Duration::from_secs(seconds), share);
        assert_eq!(text(1, 0.5), " 50 %");
        assert_eq!(text(60, 0.001), " 0 %");
        assert_eq!(text(14, 0.37), " 37 %, 24 s left");
        assert_eq!(text(600, 0.5), " 50 %, 10 min left");
        assert_eq!(text(9, 1.0), " 100 %, 0 s left");
    }
}
