//! The program `sandtable` in Python's process.

use std::ffi::OsString;
use std::io::{Write, stderr, stdout};

use pyo3::prelude::*;
use sandtable::{Invocation, RestartCommand, run_program};

/// Runs the program with its arguments, the first of which is its name, and returns the exit code. `restart` are the file to
/// execute and the arguments that start it anew; empty where they are not known.
#[pyfunction]
#[pyo3(name = "_run_program")]
pub fn run_in_process(py: Python<'_>, arguments: Vec<OsString>, restart: Vec<OsString>) -> u8 {
    let executable = restart.first().filter(|executable| !executable.is_empty());
    let restart = executable
        .map(|executable| RestartCommand { executable: executable.into(), arguments: restart.clone() });
    py.detach(|| {
        let code = run_program(&Invocation { arguments, restart });
        // Rust flushes at the end of its own `main` alone. A reader that has gone has all it wants.
        let _ = stdout().flush();
        let _ = stderr().flush();
        code
    })
}
