//! The `sandtable` program: the command line, with the height service and the window where they are built in.

use std::process::ExitCode;

use sandtable_cli::{BuiltInPrograms, ServeProgram, ViewProgram};
use sandtable_render::OtherRenderer;

#[cfg(feature = "serve")]
const SERVE: Option<ServeProgram> = Some(|options| Ok(sandtable_serve::run(options)?));

#[cfg(not(feature = "serve"))]
const SERVE: Option<ServeProgram> = None;

#[cfg(feature = "viewer")]
const VIEW: Option<ViewProgram> = Some(|options| Ok(sandtable_viewer::run(options)?));

#[cfg(not(feature = "viewer"))]
const VIEW: Option<ViewProgram> = None;

#[cfg(feature = "gpu")]
const GPU: Option<OtherRenderer> =
    Some(|list, camera, progress| Ok(sandtable_gpu::render(list, camera, progress)?));

#[cfg(not(feature = "gpu"))]
const GPU: Option<OtherRenderer> = None;

fn main() -> ExitCode {
    sandtable_cli::main(BuiltInPrograms { serve: SERVE, view: VIEW, gpu: GPU })
}
