//! The command line: one file a command, which turns arguments into the options of a library, runs
//! it and prints the result.

mod address_space;
mod analyze;
mod arguments;
mod catalog;
mod check;
mod completions;
mod convert;
mod dem_info;
mod demo;
mod error;
mod explain;
mod export;
mod first_steps;
mod fly;
mod gather;
mod grid;
mod height;
pub mod invocation;
mod licenses;
mod limit;
mod lod;
mod lod_selection;
mod los;
mod mesh;
mod model;
mod new;
mod options;
mod output;
mod output_format;
mod pick;
mod picture_maker;
mod plan;
mod plan_analysis;
mod positions;
mod profile;
mod progress;
mod remote;
mod render;
mod render_series;
mod report;
mod schema;
mod serve;
#[cfg(unix)]
mod signals;
#[cfg(unix)]
mod supervisor;
mod symbol;
mod threads;
mod values;
mod view;
mod viewshed;
mod work;

use std::error::Error;

use clap::Parser;

use crate::arguments::{Arguments, Command, DemCommand, ModelCommand};
use crate::error::CliError;
use crate::invocation::Invocation;
use sandtable_editing::viewing::ViewerOptions;
use sandtable_query::service::ServiceOptions;
use sandtable_render::OtherRenderer;

/// A height service: serves until a signal ends it.
pub type ServeProgram = fn(&ServiceOptions) -> Result<(), Box<dyn Error + Send + Sync>>;

/// A window on a scene: returns when it is closed.
pub type ViewProgram = fn(&ViewerOptions) -> Result<(), Box<dyn Error + Send + Sync>>;

/// The implementations of `serve`, `view` and `--backend gpu`; `None` where they are not built in.
#[derive(Clone, Copy, Debug, Default)]
pub struct BuiltInPrograms {
    /// Runs `serve`.
    pub serve: Option<ServeProgram>,
    /// Runs `view`.
    pub view: Option<ViewProgram>,
    /// Draws for `--backend gpu`.
    pub gpu: Option<OtherRenderer>,
}

/// Runs the program: parses the arguments, runs the command, reports errors. Returns the exit code: 0 done, 1 the input is
/// wrong, 2 usage.
///
/// It handles signals and starts threads for the whole process, so a process runs it once.
pub fn main(invocation: &Invocation, programs: BuiltInPrograms) -> u8 {
    let arguments = match Arguments::try_parse_from(&invocation.arguments) {
        Ok(arguments) => arguments,
        Err(help_or_error) => {
            let _nobody_reads = help_or_error.print();
            return u8::try_from(help_or_error.exit_code()).unwrap_or(2);
        }
    };
    if arguments.quiet {
        output::be_quiet();
    }
    #[cfg(unix)]
    if let Some(code) = invocation.restart.as_ref().and_then(supervisor::supervise) {
        return code;
    }
    let Some(command) = &arguments.command else {
        return first_steps::print_first_steps().map_or_else(|error| error.report(), |()| 0);
    };
    let done = run(&arguments, command, invocation, programs);
    remote::note_traffic();
    match done {
        Ok(()) => 0,
        Err(error) => first_steps::with_next_command(error, command).report(),
    }
}

fn run(
    arguments: &Arguments,
    command: &Command,
    invocation: &Invocation,
    programs: BuiltInPrograms,
) -> Result<(), CliError> {
    // Before anything is read: what reads a limit holds it.
    limit::set(&arguments.limit, &invocation.arguments)?;
    remote::set(&arguments.allow_remote, &invocation.arguments)?;
    let threads = address_space::threads_for(command, invocation.restart.as_ref())?;
    // A picture has threads of its own.
    if !matches!(command, Command::Render(_) | Command::Demo(_)) {
        threads::start(threads)?;
    }
    // The service ends by itself, when its last answers are read, and writes no files.
    #[cfg(unix)]
    if !matches!(command, Command::Serve(_)) {
        signals::handle(command.kept());
    }
    first_steps::check_scene(command)?;
    match command {
        Command::Render(arguments) => render::run(arguments, threads, programs.gpu),
        Command::Pick(arguments) => pick::run(arguments),
        Command::Fly(arguments) => fly::run(arguments, programs.gpu),
        Command::Check(arguments) => check::run(arguments),
        Command::Explain(arguments) => explain::run(arguments),
        Command::Demo(arguments) => demo::run(arguments, threads),
        Command::New(arguments) => new::run(arguments),
        Command::Symbol(arguments) => symbol::run(arguments),
        Command::Schema => schema::run(),
        Command::Catalog => catalog::run(),
        Command::Completions(arguments) => completions::run(arguments),
        Command::Licenses => licenses::run(),
        Command::Dem { command: DemCommand::Info(arguments) } => dem_info::run(arguments),
        Command::Dem { command: DemCommand::Convert(arguments) } => convert::run(arguments),
        Command::Dem { command: DemCommand::Grid(arguments) } => grid::run(arguments),
        Command::Model { command: ModelCommand::Info(arguments) } => model::run(arguments),
        Command::Height(arguments) => height::run(arguments),
        Command::Profile(arguments) => profile::run(arguments),
        Command::Los(arguments) => los::run(arguments),
        Command::Viewshed(arguments) => viewshed::run(arguments),
        Command::Analyze(command) => analyze::run(command),
        Command::Plan { command } => plan::run(command),
        Command::Work(arguments) => work::run(arguments, programs.gpu),
        Command::Gather(arguments) => gather::run(arguments),
        Command::Serve(arguments) => serve::run(arguments, programs.serve),
        Command::View(arguments) => view::run(arguments, programs.view),
        Command::Report(arguments) => report::run(arguments),
        Command::Export(arguments) => export::run(arguments),
        Command::Mesh(arguments) => mesh::run(arguments),
        Command::Lod(arguments) => lod::run(arguments),
    }
}
