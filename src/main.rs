//! The `sandtable` program: the command line, with the height service where it is built in.

use std::process::ExitCode;

use sandtable::cli::ServeProgram;

#[cfg(feature = "serve")]
const SERVE: Option<ServeProgram> = Some(|options| Ok(sandtable::serve::run(options)?));

#[cfg(not(feature = "serve"))]
const SERVE: Option<ServeProgram> = None;

fn main() -> ExitCode {
    sandtable::cli::main(SERVE)
}
