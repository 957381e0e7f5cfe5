//! Signals that end the program: it leaves no half-written file behind.
//!
//! A thread waits for them. It removes the [parts](sandtable_files::part_file) of files that are being written and then
//! lets the signal do what it does to any program, so that a shell sees why it ended; after Ctrl-C it says what is kept. A second signal ends the program
//! at once, should a file system not answer. What the parent told this program to ignore, as `nohup` does, it ignores.

use std::io::{self, IsTerminal, stderr};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::thread;

use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM, SIGXFSZ};
use signal_hook::flag;
use signal_hook::iterator::Signals;
use signal_hook::low_level::emulate_default_handler;

use crate::output::warn;
use sandtable_files::part_file::abandon_all;

/// The signals by which users and systems end programs.
const ENDING: [i32; 3] = [SIGINT, SIGTERM, SIGHUP];

/// Handles signals from now on, as far as the system lets it. `kept` is what is said after Ctrl-C.
pub fn handle(kept: &'static str) {
    // Without a thread or a handler the program ends as any other; the next one removes what it leaves.
    let _ = try_to_handle(kept);
}

fn try_to_handle(kept: &'static str) -> io::Result<()> {
    // A file beyond the limit of `ulimit -f` is an error of writing, not the program's end.
    flag::register(SIGXFSZ, Arc::default())?;
    let heeded = heeded();
    let is_second = Arc::new(AtomicBool::new(false));
    for &signal in &heeded {
        flag::register_conditional_default(signal, Arc::clone(&is_second))?;
        flag::register(signal, Arc::clone(&is_second))?;
    }
    let mut signals = Signals::new(&heeded)?;
    let wait = move || {
        for signal in signals.forever() {
            let _nobody_writes = abandon_all();
            if signal == SIGINT {
                // A terminal shows the current step in its last line.
                let clear = if stderr().is_terminal() { "\r\u{1b}[K" } else { "" };
                warn(&format!("{clear}interrupted: {kept}"));
            }
            let _ = emulate_default_handler(signal);
        }
    };
    thread::Builder::new().name("signals".into()).spawn(wait)?;
    Ok(())
}

/// Those signals that end programs and that this program was not started to ignore.
pub fn heeded() -> Vec<i32> {
    ENDING.into_iter().filter(|&signal| !is_ignored(signal)).collect()
}

/// Whether this program was started with `signal` ignored; where the system does not tell, it was not.
fn is_ignored(signal: i32) -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let mask = mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).unwrap_or(0);
    mask >> (signal - 1) & 1 == 1
}
