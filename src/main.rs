//! The `sandtable` program: the command line, with the height service and the window where they are built in.

use std::process::ExitCode;

use sandtable::cli::{BuiltInPrograms, ServeProgram, ViewProgram};

#[cfg(feature = "serve")]
const SERVE: Option<ServeProgram> = Some(|options| Ok(sandtable::serve::run(options)?));

#[cfg(not(feature = "serve"))]
const SERVE: Option<ServeProgram> = None;

#[cfg(feature = "viewer")]
const VIEW: Option<ViewProgram> = Some(|options| Ok(sandtable::viewer::run(options)?));

#[cfg(not(feature = "viewer"))]
const VIEW: Option<ViewProgram> = None;

fn main() -> ExitCode {
    sandtable::cli::main(BuiltInPrograms { serve: SERVE, view: VIEW })
}
