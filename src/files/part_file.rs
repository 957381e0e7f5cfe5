//! A file while it is written: a part, which becomes the file when it is whole.
//!
//! A part lies beside the file that it will be, as `sandtable-PID-NUMBER.part` with the process that writes it. What ends
//! a program decides who removes its parts:
//!
//! ```text
//! an error     ─► the part itself, when it is dropped
//! a signal     ─► `abandon_all`, called by the program's handler
//! kill -9, or power lost ─► the next program that writes into the folder
//! ```
//!
//! Parts that belong together are completed there rather than removed where their record is.
//!
//! The last is safe because a writer holds a lock on its part (`flock` on Unix), which the system releases with the
//! process: a part whose lock is free has no writer. The number of a process is no proof, since it comes back, and is
//! another one in a container that shares the folder.

use std::collections::BTreeSet;
use std::fs::{self, File, TryLockError};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use crate::part_name::{PartName, PartRole};
use crate::set_record::{self, SetRecords};

/// How often another name is tried where one is taken, mostly by a program in another container with the same process
/// number.
const MOST_TRIES: u32 = 1000;

/// The parts of this process.
#[derive(Debug)]
struct LiveParts {
    paths: BTreeSet<PathBuf>,
    /// The folders whose stale parts were removed.
    swept: BTreeSet<PathBuf>,
    /// The number in the next name.
    next: u64,
}

static LIVE: Mutex<LiveParts> =
    Mutex::new(LiveParts { paths: BTreeSet::new(), swept: BTreeSet::new(), next: 1 });

fn live() -> MutexGuard<'static, LiveParts> {
    LIVE.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A part; its file is removed when it is dropped.
#[derive(Debug)]
pub struct PartFile {
    path: PathBuf,
    file: File,
}

impl PartFile {
    /// An empty part in `folder`, whose stale sets are completed and whose stale parts are removed at the first.
    ///
    /// # Errors
    /// The system refuses.
    pub fn create(folder: &Path) -> io::Result<Self> {
        let mut live = live();
        for _ in 0..MOST_TRIES {
            let path = live.next_path(folder);
            let file = match File::options().read(true).write(true).create_new(true).open(&path) {
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists => continue,
                opened => opened?,
            };
            // Where the file system has no locks, nobody takes this part for stale either.
            let _ = file.lock();
            live.paths.insert(path.clone());
            let part = Self { path, file };
            // A program that found it before it was locked has removed it.
            if part.path.exists() {
                if live.swept.insert(folder.to_owned()) {
                    set_record::complete(folder, &live.paths, &part.file);
                    remove_stale(folder, &live.paths);
                }
                return Ok(part);
            }
            live.paths.remove(&part.path);
        }
        Err(io::ErrorKind::AlreadyExists.into())
    }

    /// The file to write to.
    pub fn file(&self) -> &File {
        &self.file
    }
}

impl Drop for PartFile {
    fn drop(&mut self) {
        let mut live = live();
        if live.paths.remove(&self.path) {
            let _ = fs::remove_file(&self.path);
        }
    }
}

impl LiveParts {
    fn next_path(&mut self, folder: &Path) -> PathBuf {
        let name = PartName { process: std::process::id(), number: self.next, role: PartRole::Part };
        self.next += 1;
        folder.join(name.to_string())
    }

    /// Another name of the file at `path` in the same folder, under which it outlives being replaced; `None` where there
    /// is no such file or the file system has no links.
    fn keep(&mut self, path: &Path) -> Option<PathBuf> {
        let kept = self.next_path(path.parent()?);
        fs::hard_link(path, &kept).ok()?;
        self.paths.insert(kept.clone());
        Some(kept)
    }

    fn remove(&mut self, path: &Path) {
        let _ = fs::remove_file(path);
        self.paths.remove(path);
    }
}

/// A file that a part has become.
struct ReplacedFile<'a> {
    path: &'a Path,
    /// The file that was there before, under another name.
    kept: Option<PathBuf>,
}

/// Gives parts the names of the files that they are to be, in order, and replaces what has these names: all of them or,
/// where one fails, none. No signal comes between; after `kill -9` the next program completes it.
///
/// # Errors
/// The path that the system refuses, and why.
pub fn publish(parts: Vec<(PartFile, PathBuf)>) -> Result<(), (PathBuf, io::Error)> {
    let mut live = live();
    let mut replaced: Vec<ReplacedFile> = Vec::new();
    let is_one = parts.len() == 1;
    let mut failure = None;
    let records = if is_one {
        None
    } else {
        let paths = parts.iter().map(|(part, path)| (part.path.as_path(), path.as_path()));
        Some(SetRecords::write(paths, &mut live.next)?)
    };
    for (part, path) in &parts {
        let kept = if is_one { None } else { live.keep(path) };
        match fs::rename(&part.path, path) {
            Ok(()) => {
                live.paths.remove(&part.path);
                replaced.push(ReplacedFile { path, kept });
            }
            Err(error) => {
                kept.iter().for_each(|kept| live.remove(kept));
                failure = Some((path.clone(), error));
                break;
            }
        }
    }
    // From here on the set is whole: all of its files are there, or none will be.
    drop(records);
    for ReplacedFile { path, kept } in replaced.iter().rev() {
        match (&failure, kept) {
            (None, Some(kept)) => live.remove(kept),
            (None, None) => {}
            (Some(_), Some(kept)) => {
                let _ = fs::rename(kept, path);
                live.paths.remove(kept);
            }
            (Some(_), None) => drop(fs::remove_file(path)),
        }
    }
    // Parts take the lock when they are dropped.
    drop(live);
    failure.map_or(Ok(()), Err)
}

/// Removes every part of this process, and blocks new parts and publication while the result is alive: for a program
/// that ends now.
pub fn abandon_all() -> impl Sized {
    let live = live();
    live.paths.iter().for_each(|path| drop(fs::remove_file(path)));
    live
}

/// Removes the parts in `folder` whose writers are gone.
fn remove_stale(folder: &Path, own: &BTreeSet<PathBuf>) {
    let Ok(entries) = fs::read_dir(folder) else { return };
    for entry in entries.flatten() {
        let path = entry.path();
        let name = PartName::parse(&entry.file_name()).filter(|name| name.role == PartRole::Part);
        if let Some(name) = name
            && entry.file_type().is_ok_and(|kind| kind.is_file())
            && !own.contains(&path)
        {
            let _ = remove_if_stale(&path, name);
        }
    }
}

fn remove_if_stale(path: &Path, name: PartName) -> Result<(), TryLockError> {
    let file = File::open(path).map_err(TryLockError::Error)?;
    file.try_lock()?;
    // Its writer may have died since the folder was listed, with the record of a set that another program completes now.
    if set_record::has_record(path, name) {
        return Ok(());
    }
    // Under the lock: a writer that is about to lock it sees afterwards that it is gone.
    fs::remove_file(path).map_err(TryLockError::Error)
}
