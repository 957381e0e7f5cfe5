//! The `sandtable` program, as a process of its own.

use std::process::ExitCode;

use sandtable::{Invocation, run_program};

fn main() -> ExitCode {
    ExitCode::from(run_program(&Invocation::of_this_process()))
}
