//! How the program was started: as a process of its own, or by an interpreter that holds it as a module.

use std::env;
use std::ffi::OsString;
use std::path::PathBuf;
#[cfg(unix)]
use std::process::Command;

/// The arguments of the program, and what starts it again.
#[derive(Clone, Debug)]
pub struct Invocation {
    /// The name of the program, then its arguments.
    pub arguments: Vec<OsString>,
    /// What starts the program again with the same arguments; `None` where that is not known. Under `ulimit -v` the program
    /// does so once or twice.
    pub restart: Option<RestartCommand>,
}

/// A process that runs the program anew.
#[derive(Clone, Debug)]
pub struct RestartCommand {
    /// The file to execute: the program, or the interpreter.
    pub executable: PathBuf,
    /// The name that the process is given, then its arguments.
    pub arguments: Vec<OsString>,
}

impl Invocation {
    /// That of a process which is the program alone.
    pub fn of_this_process() -> Self {
        let arguments: Vec<OsString> = env::args_os().collect();
        let executable = env::current_exe().ok();
        let restart =
            executable.map(|executable| RestartCommand { executable, arguments: arguments.clone() });
        Self { arguments, restart }
    }
}

#[cfg(unix)]
impl RestartCommand {
    /// The process, not yet started.
    pub fn command(&self) -> Command {
        use std::os::unix::process::CommandExt;
        let mut command = Command::new(&self.executable);
        if let Some((name, arguments)) = self.arguments.split_first() {
            command.arg0(name).args(arguments);
        }
        command
    }
}
