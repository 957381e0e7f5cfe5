//! How long each step of a run takes, and how much memory is in use at its worst moment.
//!
//! Memory is what Linux calls the high water mark of the resident set: all of the process, what earlier steps
//! left included, not the step's own share. The mark is set back as each step begins, where that is permitted;
//! where it is not, it only rises.

use std::cell::RefCell;
use std::fs;
use std::time::Instant;

/// One step, done.
pub struct Step {
    /// Its name.
    pub name: &'static str,
    /// How long it took.
    pub seconds: f64,
    /// The most memory in use while it ran; `None` where the system does not say.
    pub peak_mib: Option<f64>,
}

/// Steps one after the other.
#[derive(Default)]
pub struct Steps {
    done: RefCell<Vec<Step>>,
    under_way: RefCell<Option<(&'static str, Instant)>>,
}

impl Steps {
    /// Ends the step under way and begins the next.
    pub fn begin(&self, name: &'static str) {
        self.end();
        reset_peak();
        *self.under_way.borrow_mut() = Some((name, Instant::now()));
    }

    /// Ends the step under way and returns them all.
    pub fn finish(self) -> Vec<Step> {
        self.end();
        self.done.into_inner()
    }

    fn end(&self) {
        if let Some((name, start)) = self.under_way.take() {
            let seconds = start.elapsed().as_secs_f64();
            self.done.borrow_mut().push(Step { name, seconds, peak_mib: peak_mib() });
        }
    }
}

/// How memory is measured here, for the reader of the table.
pub fn memory_method() -> &'static str {
    match (peak_mib(), reset_peak()) {
        (None, _) => "not measured on this platform",
        (Some(_), true) => "the whole process at the step's worst moment",
        (Some(_), false) => {
            "the whole process at its worst moment so far, as the mark may not be set back here"
        }
    }
}

/// The high water mark.
fn peak_mib() -> Option<f64> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let kib = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kib: f64 = kib.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kib / 1024.0)
}

/// Sets the high water mark back to what is in use now; false where that is not permitted.
fn reset_peak() -> bool {
    fs::write("/proc/self/clear_refs", "5").is_ok()
}
