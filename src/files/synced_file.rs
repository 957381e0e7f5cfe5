//! A file whose bytes go to the disk while more of them are made.
//!
//! A file gets its name when all of it is on the disk. The system keeps what is written in memory for long, so that a program
//! that writes quickly would wait at its end for most of the file; a thread asks for it piece by piece instead.

use std::fs::File;
use std::io::{self, Seek, SeekFrom, Write};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread::{self, JoinHandle};

/// Bytes after which the disk is asked to take what was written: smaller files are written as they would be, and for larger
/// ones asking costs little.
const SYNCED_TOGETHER: usize = 8 << 20;

/// A file that is being written.
#[derive(Debug)]
pub struct SyncedFile<'a> {
    file: &'a File,
    /// Bytes since the disk was asked last.
    unsynced: usize,
    /// What asks it; none of a small file.
    syncing: Option<Syncing>,
}

/// A thread that asks the disk, and waits for it.
#[derive(Debug)]
struct Syncing {
    ask: SyncSender<()>,
    thread: JoinHandle<io::Result<()>>,
}

impl Syncing {
    fn new(file: &File) -> io::Result<Self> {
        let file = file.try_clone()?;
        let (ask, asked) = sync_channel(1);
        let sync = move |asked: Receiver<()>| asked.into_iter().try_for_each(|()| file.sync_data());
        let thread = thread::Builder::new().name("disk".to_owned()).spawn(move || sync(asked))?;
        Ok(Self { ask, thread })
    }

    /// The first error of the disk.
    fn finish(self) -> io::Result<()> {
        drop(self.ask);
        self.thread.join().unwrap_or_else(|_| Err(io::Error::other("the file could not be synchronized")))
    }
}

impl<'a> SyncedFile<'a> {
    /// A file that is written from its start.
    pub fn new(file: &'a File) -> Self {
        Self { file, unsynced: 0, syncing: None }
    }

    /// Waits for the disk, which may not have all bytes yet.
    ///
    /// # Errors
    /// What the disk refused: the system states it once, so that a later request for all bytes would succeed.
    pub fn finish(mut self) -> io::Result<()> {
        self.syncing.take().map_or(Ok(()), Syncing::finish)
    }

    fn wrote(&mut self, bytes: usize) {
        self.unsynced += bytes;
        if self.unsynced < SYNCED_TOGETHER {
            return;
        }
        if self.syncing.is_none() {
            // Where there can be no more threads, the disk is asked at the end alone.
            self.syncing = Syncing::new(self.file).ok();
        }
        // A disk that is still at work is asked again later.
        if self.syncing.as_ref().is_some_and(|syncing| syncing.ask.try_send(()).is_ok()) {
            self.unsynced = 0;
        }
    }
}

impl Drop for SyncedFile<'_> {
    fn drop(&mut self) {
        // What was written so far is discarded, and its errors with it; the thread must not outlive the file's lock.
        let _ = self.syncing.take().map(Syncing::finish);
    }
}

impl Write for SyncedFile<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let written = self.file.write(bytes)?;
        self.wrote(written);
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

impl Seek for SyncedFile<'_> {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.file.seek(to)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn a_large_file_is_synchronized_meanwhile_and_holds_all_that_was_written() {
        let path = std::env::temp_dir().join(format!("sandtable-synced-{}", std::process::id()));
        let file = File::create(&path).expect("a file");
        let mut out = SyncedFile::new(&file);
        let piece: Vec<u8> = (0..1 << 20).map(|index: u32| (index % 251) as u8).collect();
        for _ in 0..20 {
            assert!(out.syncing.is_none() || out.unsynced < 20 << 20);
            out.write_all(&piece).expect("written");
        }
        assert!(out.syncing.is_some());
        out.rewind().expect("a file");
        out.write_all(b"head").expect("written");
        out.finish().expect("synchronized");
        let read = fs::read(&path).expect("there");
        assert!(read.len() == 20 << 20 && read.starts_with(b"head") && read.ends_with(&piece));
        fs::remove_file(path).expect("removed");
    }

    #[test]
    fn a_small_file_needs_no_thread() {
        let path = std::env::temp_dir().join(format!("sandtable-unsynced-{}", std::process::id()));
        let file = File::create(&path).expect("a file");
        let mut out = SyncedFile::new(&file);
        out.write_all(b"few").expect("written");
        assert!(out.syncing.is_none());
        out.finish().expect("nothing to wait for");
        fs::remove_file(path).expect("removed");
    }
}
