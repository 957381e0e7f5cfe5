//! A file for values that have no place in memory for a while.
//!
//! It has no name: on Unix that is taken from it as soon as it is open, and Windows is told to. So the system takes its place back
//! when it is closed, however the program ends. It lies in the system's folder for temporary files, which `TMPDIR` names (`TMP` on
//! Windows).

use std::fs::{self, File, OpenOptions};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

use crate::disk::SystemError;

/// How often another name is tried where one is taken.
const MOST_TRIES: u32 = 1000;

/// The variable that names the folder.
const VARIABLE: &str = if cfg!(windows) { "TMP" } else { "TMPDIR" };

/// The number in the next name.
static NEXT: AtomicU64 = AtomicU64::new(1);

/// A file without a name.
#[derive(Debug)]
pub struct ScratchFile {
    file: File,
    folder: PathBuf,
    bytes: u64,
}

/// What the system refuses about a scratch file.
#[derive(Debug, thiserror::Error)]
#[error(
    "{}: {megabytes} MB of disk are needed here meanwhile; make room, or name another folder by {VARIABLE}",
    folder.display()
)]
pub struct ScratchError {
    folder: PathBuf,
    megabytes: u64,
    #[source]
    cause: SystemError,
}

impl ScratchFile {
    /// A file for up to `bytes` bytes in the system's folder for temporary files. Bytes that are never written take no place where
    /// the file system can do that, and read as 0.
    ///
    /// # Errors
    /// The system refuses.
    pub fn create(bytes: u64) -> Result<Self, ScratchError> {
        Self::create_in(&std::env::temp_dir(), bytes)
    }

    /// [`ScratchFile::create`] in a folder.
    ///
    /// # Errors
    /// The system refuses.
    pub fn create_in(folder: &Path, bytes: u64) -> Result<Self, ScratchError> {
        let opened = nameless(folder).and_then(|file| file.set_len(bytes).map(|()| file));
        match opened {
            Ok(file) => Ok(Self { file, folder: folder.to_owned(), bytes }),
            Err(error) => Err(refused(folder, bytes, error)),
        }
    }

    /// Fills `out` with the bytes from `at` on.
    ///
    /// # Errors
    /// The system refuses, or there are fewer.
    pub fn read(&mut self, at: u64, out: &mut [u8]) -> Result<(), ScratchError> {
        let read = self.file.seek(SeekFrom::Start(at)).and_then(|_| self.file.read_exact(out));
        read.map_err(|error| refused(&self.folder, self.bytes, error))
    }

    /// Writes bytes from `at` on.
    ///
    /// # Errors
    /// The system refuses: the disk is full.
    pub fn write(&mut self, at: u64, bytes: &[u8]) -> Result<(), ScratchError> {
        let written = self.file.seek(SeekFrom::Start(at)).and_then(|_| self.file.write_all(bytes));
        written.map_err(|error| refused(&self.folder, self.bytes, error))
    }
}

fn refused(folder: &Path, bytes: u64, error: io::Error) -> ScratchError {
    ScratchError { folder: folder.to_owned(), megabytes: bytes.div_ceil(1_000_000), cause: error.into() }
}

/// A new file without a name.
fn nameless(folder: &Path) -> io::Result<File> {
    for _ in 0..MOST_TRIES {
        let number = NEXT.fetch_add(1, Ordering::Relaxed);
        let path = folder.join(format!("sandtable-{}-{number}.scratch", std::process::id()));
        let file = match options().open(&path) {
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => continue,
            opened => opened?,
        };
        // Windows removes it when it is closed, and not before.
        if !cfg!(windows) {
            fs::remove_file(&path)?;
        }
        return Ok(file);
    }
    Err(io::ErrorKind::AlreadyExists.into())
}

fn options() -> OpenOptions {
    let mut options = File::options();
    options.read(true).write(true).create_new(true);
    #[cfg(unix)]
    std::os::unix::fs::OpenOptionsExt::mode(&mut options, 0o600);
    #[cfg(windows)]
    {
        /// `FILE_FLAG_DELETE_ON_CLOSE`.
        const DELETE_ON_CLOSE: u32 = 0x0400_0000;
        std::os::windows::fs::OpenOptionsExt::custom_flags(&mut options, DELETE_ON_CLOSE);
        std::os::windows::fs::OpenOptionsExt::share_mode(&mut options, 0);
    }
    options
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folder(name: &str) -> PathBuf {
        let folder = std::env::temp_dir().join(format!("sandtable-scratch-{name}-{}", std::process::id()));
        fs::create_dir_all(&folder).expect("a folder");
        folder
    }

    #[test]
    fn what_was_written_is_read_and_the_folder_stays_empty() {
        let folder = folder("kept");
        let mut scratch = ScratchFile::create_in(&folder, 100).expect("a file");
        scratch.write(40, b"water").expect("room");
        let mut out = [7; 8];
        scratch.read(38, &mut out).expect("bytes");
        assert_eq!(&out, b"\0\0water\0");
        scratch.read(96, &mut out).expect_err("no more than 100 bytes");
        if !cfg!(windows) {
            assert_eq!(fs::read_dir(&folder).expect("a folder").count(), 0);
        }
        drop(scratch);
        fs::remove_dir(&folder).expect("an empty folder");
    }

    #[test]
    fn a_folder_that_is_not_there_is_named_with_what_is_needed() {
        let error = ScratchFile::create_in(Path::new("/nowhere/at all"), 3_000_001).expect_err("no folder");
        let said = error.to_string();
        assert!(said.starts_with("/nowhere/at all: 4 MB of disk") && said.contains(VARIABLE), "{said}");
    }
}
