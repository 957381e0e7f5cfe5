//! The steps of a command: a spinner with the current one on a terminal, nothing elsewhere, and the time of each. Of what is
//! counted, a bar.
//!
//! ```text
//! ⠹ analyzing 37 %, 24 s left [14s]
//! ⠹ drawing 40 %, 9 s left [8s]                       rows of a picture
//! ⠹ drawing, all 40 %, 3 min left [6s]                a step, and what is left of all pictures
//! ███████░░░░░░░ shard 37 of 100, 24 s left [14s]
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
use std::sync::{Arc, Mutex, PoisonError, Weak};
use std::thread;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};

use crate::output::{is_quiet, warn};
use sandtable_sheet::step_watch::StepWatch;
use sandtable_terrain::stop_flag::StopFlag;

/// What is left is estimated after this time, and this share: before, it is a guess.
const LEAST_TIME: Duration = Duration::from_secs(2);
const LEAST_SHARE: f64 = 0.02;

/// Of things that are counted, so many say how long the others take, whatever their share.
const LEAST_COUNT: u64 = 5;

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
    watch: Arc<StepWatch>,
    /// The work that the steps are part of, where that has others.
    series: Option<Series>,
    /// Whether steps and shares are lines of standard error.
    is_lines: bool,
}

impl Default for StepTimer {
    fn default() -> Self {
        Self::new(None)
    }
}

/// Work of which the same steps are done several times, such as one picture after the other.
#[derive(Clone, Debug)]
pub struct Series {
    since: Instant,
    /// How far all of it is.
    pub flag: Arc<StopFlag>,
}

impl Series {
    /// A series that begins now; `what` names it in lines of progress.
    pub fn begin(what: &'static str) -> Self {
        let flag = Arc::<StopFlag>::default();
        if is_lines() {
            write_shares(Arc::downgrade(&flag), move |flag| Some((what, flag.share()?)));
        }
        Self { since: Instant::now(), flag }
    }
}

/// Whether progress is lines of standard error.
fn is_lines() -> bool {
    !is_quiet() && env::var_os(PROGRESS).is_some_and(|value| value == LINES)
}

/// Things that a command does one after the other, counted, with the time that is left.
pub struct CountedBar(ProgressBar);

impl CountedBar {
    /// A bar of `count` things, each of which is called `noun`.
    pub fn new(noun: &'static str, count: u64) -> Self {
        let bar = shown(ProgressBar::new(count));
        if is_lines() {
            bar.set_draw_target(ProgressDrawTarget::hidden());
        }
        let since = Instant::now();
        let left = move |state: &ProgressState, out: &mut dyn Write| {
            let (elapsed, share) = (since.elapsed(), f64::from(state.fraction()));
            if elapsed >= LEAST_TIME && (state.pos() >= LEAST_COUNT || share >= LEAST_SHARE) {
                let _ = write!(out, ", {}", left_text(elapsed, share));
            }
        };
        let template = format!("{{bar:30}} {noun} {{pos}} of {{len}}{{left}} [{{elapsed}}]");
        if let Ok(style) = ProgressStyle::with_template(&template) {
            bar.set_style(style.with_key("left", left));
        }
        bar.enable_steady_tick(LOOK_AGAIN);
        Self(bar)
    }

    /// So many are done.
    pub fn set(&self, done: u64) {
        let percent = |position: u64| 100 * position / self.0.length().unwrap_or(1).max(1);
        let (before, now) = (percent(self.0.position()), percent(done));
        self.0.set_position(done);
        if is_lines() && before != now {
            warn(&format!("progress: working {now} %"));
        }
    }

    /// One more is done.
    pub fn did_one(&self) {
        self.set(self.0.position() + 1);
    }

    /// One need not be done, and tells nothing about the time of the others.
    pub fn skip_one(&self) {
        self.0.set_length(self.0.length().unwrap_or(1).saturating_sub(1));
    }

    /// Calls `print` while the bar is off the terminal.
    pub fn beside<T>(&self, print: impl FnOnce() -> T) -> T {
        self.0.suspend(print)
    }
}

impl Drop for CountedBar {
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}

/// A bar that a terminal shows, unless the run is quiet.
fn shown(bar: ProgressBar) -> ProgressBar {
    if is_quiet() {
        bar.set_draw_target(ProgressDrawTarget::hidden());
    }
    bar
}

/// The step, how far it is, how far the series is, and the time of all steps.
fn step_style(series: Option<&Series>, watch: &Arc<StepWatch>) -> ProgressStyle {
    let style = ProgressStyle::with_template("{spinner} {msg}{step}{series} [{elapsed}]");
    let series = series.cloned();
    let (watch, since, is_one) = (Arc::clone(watch), Instant::now(), series.is_none());
    let of_step = move |_: &ProgressState, out: &mut dyn Write| {
        // Of several pictures it is the time of all that is of interest.
        let share = watch.share().filter(|_| is_one);
        let _ = out.write_str(&share.map(|share| share_text(since.elapsed(), share)).unwrap_or_default());
    };
    let share = move |_: &ProgressState, out: &mut dyn Write| {
        let share = series.as_ref().and_then(|series| Some((series.since.elapsed(), series.flag.share()?)));
        let text = share.map(|(elapsed, share)| format!(", all{}", share_text(elapsed, share)));
        let _ = out.write_str(&text.unwrap_or_default());
    };
    let style = style.unwrap_or_else(|_| ProgressStyle::default_spinner());
    style.with_key("series", share).with_key("step", of_step)
}

impl StepTimer {
    /// The steps of a part of a series.
    pub fn of_series(series: &Series) -> Self {
        Self::new(Some(series.clone()))
    }

    fn new(series: Option<Series>) -> Self {
        let bar = shown(ProgressBar::new_spinner());
        bar.enable_steady_tick(Duration::from_millis(100));
        let watch = Arc::new(StepWatch::default());
        let bar = bar.with_style(step_style(series.as_ref(), &watch));
        if is_lines() && series.is_none() {
            write_shares(Arc::downgrade(&watch), |watch: &StepWatch| Some((watch.step(), watch.share()?)));
        }
        Self { bar, starts: Mutex::default(), watch, series, is_lines: is_lines() }
    }

    /// Where steps say how far they are.
    pub fn step_watch(&self) -> &StepWatch {
        &self.watch
    }

    /// The series that the steps are part of.
    pub fn series(&self) -> Option<&Series> {
        self.series.as_ref()
    }

    /// Shows beside the current step the share that `flag` states, and the time that is left.
    pub fn watch(&self, flag: Arc<StopFlag>) {
        if self.is_lines {
            let step = self.watch.step();
            write_shares(Arc::downgrade(&flag), move |flag| Some((step, flag.share()?)));
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
        self.watch.begin(step);
        self.bar.set_style(step_style(self.series.as_ref(), &self.watch));
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

/// Writes each percent of a step as a line, on a thread that ends when nobody else holds what counts the share.
fn write_shares<T: Send + Sync + 'static>(
    counted: Weak<T>,
    of_step: impl Fn(&T) -> Option<(&'static str, f64)> + Send + 'static,
) {
    thread::spawn(move || {
        let mut last = None;
        while let Some(counted) = counted.upgrade() {
            let now = of_step(&counted).map(|(step, share)| (step, (share * 100.0).floor() as u8));
            if let Some((step, percent)) = now.filter(|_| now != last) {
                warn(&format!("progress: {step} {percent} %"));
                last = now;
            }
            drop(counted);
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
    format!(" {percent} %, {}", left_text(elapsed, share))
}

/// The time that is left if all goes on alike.
fn left_text(elapsed: Duration, share: f64) -> String {
    let left_s = (elapsed.as_secs_f64() * (1.0 - share) / share).ceil();
    if left_s < 120.0 { format!("{left_s} s left") } else { format!("{} min left", (left_s / 60.0).ceil()) }
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
