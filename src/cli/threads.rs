//! The threads that commands compute with: as many as the system lets be started.

use std::io;
use std::thread::Builder;

use rayon::{ThreadBuilder, ThreadPool, ThreadPoolBuildError, ThreadPoolBuilder};

use crate::cli::error::CliError;

/// Starts the threads that all commands share, one for each processor; fewer where the system refuses some.
///
/// # Errors
/// Not even one can be started.
pub fn start() -> Result<(), CliError> {
    ThreadPoolBuilder::new().spawn_handler(spawn).build_global().map_err(|error| refused(&error))
}

/// Threads of their own for one command, so many or, for 0, one for each processor; fewer where the system refuses some.
///
/// # Errors
/// Not even one can be started.
pub fn pool(count: usize) -> Result<ThreadPool, CliError> {
    let threads = ThreadPoolBuilder::new().num_threads(count).spawn_handler(spawn);
    threads.build().map_err(|error| refused(&error))
}

/// Starts a thread. All but the first may be missing: the others do their work.
fn spawn(thread: ThreadBuilder) -> io::Result<()> {
    let is_first = thread.index() == 0;
    match Builder::new().spawn(|| thread.run()) {
        Err(error) if is_first => Err(error),
        _ => Ok(()),
    }
}

fn refused(error: &ThreadPoolBuildError) -> CliError {
    CliError::input(format!(
        "no thread can be started to compute with: {error}; let this process have more memory or threads"
    ))
}
