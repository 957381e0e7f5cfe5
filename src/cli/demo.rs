//! `sandtable demo`: a scene with its data out of the program, drawn and opened.

use std::env;
use std::io::{IsTerminal, stdout};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use clap::Args;

use crate::error::CliError;
use crate::new::shell;
use crate::output::print_summary;
use crate::render::{self, RenderArguments};
use sandtable_new::demo::write_demo;

#[derive(Debug, Args)]
#[command(
    after_help = "The picture is opened where the program runs in a terminal and there is a display. Nothing is overwritten."
)]
pub struct DemoArguments {
    /// The folder for the scene, its data and its picture; it must be new or empty
    #[arg(value_name = "DIR", default_value = "sandtable-demo")]
    pub folder: PathBuf,
}

/// Writes the demonstration, draws it with `threads` threads, and opens the picture.
pub fn run(arguments: &DemoArguments, threads: usize) -> Result<(), CliError> {
    let scene = write_demo(&arguments.folder)?;
    let picture = scene.with_file_name("picture.png");
    render::run(&RenderArguments::of_scene(&scene, &picture), threads, None)?;
    if stdout().is_terminal() && has_display() {
        open(&picture);
    }
    let scene = shell(&scene);
    print_summary(&[
        "try next:".to_owned(),
        format!("  sandtable render {scene} --camera lake"),
        format!("  sandtable check {scene}"),
        format!("  sandtable height {scene} --at -84.2,36.3 --crs EPSG:4326"),
        format!("  sandtable export {scene} -o demo.html"),
    ])
}

/// Whether a picture can be shown: Windows and macOS have a display, other systems say so in the environment.
fn has_display() -> bool {
    let is_set = |name| env::var_os(name).is_some_and(|value| !value.is_empty());
    cfg!(any(windows, target_os = "macos")) || is_set("DISPLAY") || is_set("WAYLAND_DISPLAY")
}

/// Opens a file with the program that the user has for it. Without one nothing happens: its path is printed.
fn open(path: &Path) {
    let program = if cfg!(windows) {
        "explorer"
    } else if cfg!(target_os = "macos") {
        "open"
    } else {
        "xdg-open"
    };
    let mut command = Command::new(program);
    command.arg(path).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    let _nobody_to_show_it = command.spawn();
}
