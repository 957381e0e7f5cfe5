//! A supervisor process for a command under `ulimit -v`, which ends with a message where the command cannot.
//!
//! Rust ends a program by a signal where a small allocation fails, and no program without `unsafe` can change that. So where
//! the address space is limited, the command runs in a process of its own, started by this one with the same arguments, files
//! and limits. This process waits: it ends as that does, but for an abort, which it reports as an error. Signals to it are
//! passed on.

use std::env;
use std::io;
use std::os::unix::process::{ExitStatusExt, parent_id};
use std::process::{Child, ExitStatus, id};
use std::thread;
use std::time::Duration;

use rustix::process::{Pid, Signal, kill_process};
use signal_hook::consts::SIGABRT;
use signal_hook::iterator::Signals;
use signal_hook::low_level::emulate_default_handler;

use crate::address_space::AddressSpace;
use crate::error::CliError;
use crate::invocation::RestartCommand;
use crate::signals;

/// The number of the process that supervises this one, in its environment.
const SUPERVISOR: &str = "SANDTABLE_SUPERVISOR";

/// How long a command may take to end by itself when the terminal has told it to, as it tells all in the foreground, before
/// it is told again.
const PATIENCE: Duration = Duration::from_secs(1);

/// Runs this program again in a child process if its address space is limited, and returns the exit code of the child;
/// `None` without a limit, in the child itself, and where no child can be started.
pub fn supervise(restart: &RestartCommand) -> Option<u8> {
    let space = AddressSpace::of_this_process()?;
    let is_supervised = env::var(SUPERVISOR).is_ok_and(|supervisor| supervisor == parent_id().to_string());
    if is_supervised {
        return None;
    }
    let status = supervised(restart).ok()?;
    Some(match (status.code(), status.signal()) {
        (Some(code), _) => u8::try_from(code).unwrap_or(1),
        (None, Some(SIGABRT)) => CliError::input(format!(
            "the command ended because it needs more than the {} MB of address space that `ulimit -v` lets it have; allow it \
             more, or ask for less at once",
            space.most() / 1_000_000
        ))
        .report(),
        (None, signal) => {
            let signal = signal.unwrap_or(0);
            // Where this process does not end by the same signal, its code is that of a shell.
            let _ = emulate_default_handler(signal);
            u8::try_from(128 + signal).unwrap_or(1)
        }
    })
}

/// How this program ends in a process of its own.
fn supervised(restart: &RestartCommand) -> io::Result<ExitStatus> {
    let mut command = restart.command();
    command.env(SUPERVISOR, id().to_string());
    // A signal that comes before there is a process to pass it on to waits.
    let signals = Signals::new(signals::heeded())?;
    let mut child = command.spawn()?;
    pass_on(signals, &child);
    child.wait()
}

/// Passes signals on to a process from now on. Without a thread for that they have no effect on it.
fn pass_on(mut signals: Signals, child: &Child) {
    let child = i32::try_from(child.id()).ok().and_then(Pid::from_raw);
    let pass = move || {
        for signal in signals.forever() {
            thread::sleep(PATIENCE);
            let (Some(child), Some(signal)) = (child, Signal::from_named_raw(signal)) else { continue };
            let _it_has_ended = kill_process(child, signal);
        }
    };
    let _ = thread::Builder::new().name("signals".into()).spawn(pass);
}
