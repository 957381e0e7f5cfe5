//! The threads that commands compute with: as many as the system lets be started.
//!
//! They are started before the pool that they serve, which waits for each thread that it was promised.

use std::env;
use std::error::Error;
use std::io;
use std::num::NonZero;
use std::sync::mpsc::{Sender, channel};
use std::thread::{self, Builder};

use rayon::{ThreadBuilder, ThreadPool, ThreadPoolBuilder};

use crate::error::CliError;

/// The wanted number of threads: the stated one, else that of `RAYON_NUM_THREADS`, else one per processor.
pub fn wanted(stated: Option<usize>) -> usize {
    let of_environment =
        || env::var("RAYON_NUM_THREADS").ok()?.parse().ok().filter(|&count: &usize| count > 0);
    let of_processors = || thread::available_parallelism().map_or(1, NonZero::get);
    stated.or_else(of_environment).unwrap_or_else(of_processors)
}

/// Starts `count` threads that all commands share; fewer where the system refuses some.
///
/// # Errors
/// Not even one can be started.
pub fn start(count: usize) -> Result<(), CliError> {
    let mut idle = idle_threads(count)?;
    let threads = ThreadPoolBuilder::new().num_threads(idle.len());
    threads
        .spawn_handler(|thread| employ(&mut idle, thread))
        .build_global()
        .map_err(|error| no_thread(&error))
}

/// `count` threads of their own for one command; fewer where the system refuses some.
///
/// # Errors
/// Not even one can be started.
pub fn pool(count: usize) -> Result<ThreadPool, CliError> {
    let mut idle = idle_threads(count)?;
    let threads = ThreadPoolBuilder::new().num_threads(idle.len());
    threads.spawn_handler(|thread| employ(&mut idle, thread)).build().map_err(|error| no_thread(&error))
}

/// A thread that waits for its place in a pool; it ends where it gets none.
type IdleThread = Sender<ThreadBuilder>;

/// At most `count` threads.
fn idle_threads(count: usize) -> Result<Vec<IdleThread>, CliError> {
    let mut idle = Vec::new();
    for _ in 0..count {
        let (place, places) = channel::<ThreadBuilder>();
        let work = move || {
            if let Ok(thread) = places.recv() {
                thread.run();
            }
        };
        match Builder::new().spawn(work) {
            Ok(_) => idle.push(place),
            Err(error) if idle.is_empty() => return Err(no_thread(&error)),
            Err(_) => break,
        }
    }
    Ok(idle)
}

/// Gives a thread of a pool to one that is idle.
fn employ(idle: &mut Vec<IdleThread>, thread: ThreadBuilder) -> io::Result<()> {
    let place = idle.pop().ok_or_else(|| io::Error::other("there are fewer threads than promised"))?;
    place.send(thread).map_err(|_| io::Error::other("a thread has ended"))
}

fn no_thread(error: &dyn Error) -> CliError {
    CliError::input(format!(
        "no thread can be started to compute with: {error}; let this process have more memory or threads"
    ))
}
