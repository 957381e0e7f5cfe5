//! Saying that something was not tested, so that it is heard.

use std::io::Write;

/// Tells on standard error what could not be tested and why, also where the test passes: the test runner keeps
/// what passing tests print, but not what they write themselves.
pub fn skipped(why: &str) {
    let _ = writeln!(std::io::stderr(), "SKIPPED: {why}");
}
