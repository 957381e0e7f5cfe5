//! The program `sandtable`: the command line, with the height service and the window where they are built in.

use crate::api::gpu_renderer::GPU;
use sandtable_cli::invocation::Invocation;
use sandtable_cli::{BuiltInPrograms, ServeProgram, ViewProgram};

#[cfg(feature = "serve")]
const SERVE: Option<ServeProgram> = Some(|options| Ok(sandtable_serve::run(options)?));

#[cfg(not(feature = "serve"))]
const SERVE: Option<ServeProgram> = None;

#[cfg(feature = "viewer")]
const VIEW: Option<ViewProgram> = Some(|options| Ok(sandtable_viewer::run(options)?));

#[cfg(not(feature = "viewer"))]
const VIEW: Option<ViewProgram> = None;

/// Runs the program `sandtable` (feature `cli`), which prints answers and errors, and returns its exit code: 0 done, 1 the input
/// is wrong, 2 wrong usage.
///
/// It handles signals and starts threads for the whole process, so a process runs it once.
pub fn run_program(invocation: &Invocation) -> u8 {
    sandtable_cli::main(invocation, BuiltInPrograms { serve: SERVE, view: VIEW, gpu: GPU })
}
