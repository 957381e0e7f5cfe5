//! The program as a user runs it: what it prints, where, and how it ends.

mod analyze;
mod attacks;
mod catalog;
mod check;
mod convert;
mod export;
mod export_features;
#[cfg(unix)]
mod faults;
mod first_steps;
mod fly;
mod frames;
mod grid;
mod heights;
mod hostile_data;
mod info;
#[cfg(unix)]
mod interrupts;
mod large_heights;
mod licenses;
mod limits;
mod lod;
mod los;
mod manners;
#[cfg(target_os = "linux")]
mod memory;
mod meshes;
mod near_ground;
mod new;
mod pages;
mod pictures;
mod prints;
mod profile;
mod remote;
#[cfg(feature = "cloud")]
mod remote_https;
#[cfg(feature = "cloud")]
mod remote_plans;
#[cfg(feature = "cloud")]
mod remote_servers;
#[cfg(feature = "cloud")]
mod remote_stores;
mod report;
mod schema;
mod series;
mod serve;
#[cfg(unix)]
mod sets;
mod shards;
mod shards_analysis;
mod shards_atlas;
mod shards_atlas_backend;
mod shards_colors;
#[cfg(unix)]
mod shards_killed;
mod shards_tiles;
mod sheets;
#[cfg(unix)]
mod terminals;
mod viewshed;
mod web_mercator;
mod wrong_scenes;

use std::io::Write;
use std::path::Path;
use std::process::{Command, Stdio};

/// One run of the program.
#[derive(Debug)]
struct Ran {
    /// The exit code; −1 where a signal ended it.
    code: i32,
    out: String,
    err: String,
}

impl Ran {
    /// What was printed, of a run that must have succeeded in silence.
    #[track_caller]
    fn ok(self) -> String {
        assert_eq!((self.code, self.err.as_str()), (0, ""), "{self:?}");
        self.out
    }

    /// What was complained of, of a run that must have ended with `code` and printed nothing else.
    #[track_caller]
    fn failed(self, code: i32) -> String {
        assert_eq!((self.code, self.out.as_str()), (code, ""), "{self:?}");
        assert!(!self.err.contains("panicked"), "{}", self.err);
        self.err
    }
}

/// The program, to be run in `folder`.
fn program<A: AsRef<std::ffi::OsStr>>(folder: &Path, arguments: &[A]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_sandtable"));
    command.current_dir(folder).args(arguments).stdin(Stdio::null());
    command
}

/// Runs the program in `folder` to its end.
fn run_in<A: AsRef<std::ffi::OsStr>>(folder: &Path, arguments: &[A]) -> Ran {
    ran(program(folder, arguments).output().expect("the program starts"))
}

/// Runs the program in the project's folder.
fn run<A: AsRef<std::ffi::OsStr>>(arguments: &[A]) -> Ran {
    run_in(Path::new(env!("SANDTABLE_ROOT")), arguments)
}

/// Runs the program in `folder` with something to read on standard input.
fn run_with_input(folder: &Path, arguments: &[&str], input: &str) -> Ran {
    let mut command = program(folder, arguments);
    command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().expect("the program starts");
    let mut stdin = child.stdin.take().expect("a pipe");
    // A program that refuses its other input ends before it reads, and closes the pipe.
    let _ = stdin.write_all(input.as_bytes());
    drop(stdin);
    ran(child.wait_with_output().expect("the program ends"))
}

fn ran(output: std::process::Output) -> Ran {
    Ran {
        code: output.status.code().unwrap_or(-1),
        out: String::from_utf8(output.stdout).expect("UTF-8"),
        err: String::from_utf8(output.stderr).expect("UTF-8"),
    }
}

/// A file of the project.
fn project(path: &str) -> String {
    format!("{}/{path}", env!("SANDTABLE_ROOT"))
}

/// The bytes of a file of the project.
fn bytes_of(path: &str) -> Vec<u8> {
    std::fs::read(project(path)).expect("a file of the project")
}
