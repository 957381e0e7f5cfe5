//! The command line: one file per command; progress, exit codes. Only here are the clock, the environment and
//! the arguments read.

pub mod arguments;
pub mod check;
pub mod convert;
pub mod dataset;
pub mod dem;
pub mod export;
pub mod failure;
pub mod files;
pub mod grid;
pub mod ground;
pub mod height;
pub mod labels;
pub mod load;
pub mod lod;
pub mod los;
pub mod map;
pub mod mesh;
pub mod model;
pub mod new;
pub mod output;
pub mod picture;
pub mod places;
pub mod points;
pub mod profile;
pub mod progress;
pub mod rasters;
pub mod render;
pub mod report;
pub mod schema;
pub mod serve;
pub mod viewshed;

use std::process::ExitCode;

use clap::Parser;

use crate::app::arguments::{Arguments, Command, DemCommand, ModelCommand};
use crate::app::failure::CliError;

/// Runs the program: parses the arguments, runs the command, reports what went wrong.
///
/// Exit codes: 0 done, 1 the input is wrong, 2 usage.
pub fn main() -> ExitCode {
    match run(&Arguments::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            failure.report();
            failure.exit_code()
        }
    }
}

fn run(arguments: &Arguments) -> Result<(), CliError> {
    match &arguments.command {
        Command::Render(options) => render::run(options),
        Command::Check(options) => check::run(options),
        Command::Dem { command: DemCommand::Info(options) } => dem::info(options),
        Command::Model { command: ModelCommand::Info(options) } => model::info(options),
        Command::Height(options) => height::run(options),
        Command::Dem { command: DemCommand::Convert(options) } => convert::run(options),
        Command::Dem { command: DemCommand::Grid(options) } => grid::run(options),
        Command::Profile(options) => profile::run(options),
        Command::Los(options) => los::run(options),
        Command::Viewshed(options) => viewshed::run(options),
        Command::Serve(options) => serve::run(options),
        Command::Export(options) => export::run(options),
        Command::Report(options) => report::run(options),
        Command::Mesh(options) => mesh::run(options),
        Command::Schema => schema::run(),
        Command::New(options) => new::run(options),
        Command::Lod(options) => lod::run(options),
    }
}
