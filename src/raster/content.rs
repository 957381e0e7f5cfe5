//! The bytes of files that stay where they are, on disk or on a server, and of files that are being written.
//!
//! Readers of elevation in parts take a [`FileContent`], whatever the format; files and servers implement it alike.

use std::fs::File;
use std::io::{self, Cursor, Read, Seek, Write};
use std::ops::Range;
use std::sync::Arc;

/// A file that is being written, in order but for its head.
pub trait WrittenContent: Write + Seek + Send {}

impl<C: Write + Seek + Send> WrittenContent for C {}

/// The content of a file that stays where it is: on disk, or on a server.
pub trait FileContent: Read + Seek + Send {
    /// Announces the bytes that are read next, in ascending order, so that remote content can fetch them together.
    fn announce(&mut self, _ranges: &[Range<u64>]) {}

    /// The same content for concurrent reads by position; `None` where readers would wait for each other.
    fn by_place(&self) -> Option<Arc<dyn ReadByPlace>> {
        None
    }
}

/// Content that any number of threads read at once: it has no position that they would share.
pub trait ReadByPlace: Send + Sync {
    /// Reads bytes from `start` on, as [`Read::read`] does.
    ///
    /// # Errors
    /// The content cannot be read.
    fn read_by_place(&self, out: &mut [u8], start: u64) -> io::Result<usize>;
}

impl<C: FileContent + ?Sized> FileContent for Box<C> {
    fn announce(&mut self, ranges: &[Range<u64>]) {
        (**self).announce(ranges);
    }

    fn by_place(&self) -> Option<Arc<dyn ReadByPlace>> {
        (**self).by_place()
    }
}

impl<B: AsRef<[u8]> + Send> FileContent for Cursor<B> {}

impl FileContent for File {
    #[cfg(unix)]
    fn by_place(&self) -> Option<Arc<dyn ReadByPlace>> {
        Some(Arc::new(FileByPlace(self.try_clone().ok()?)))
    }
}

/// A file of a system that reads by place.
#[cfg(unix)]
struct FileByPlace(File);

#[cfg(unix)]
impl ReadByPlace for FileByPlace {
    fn read_by_place(&self, out: &mut [u8], start: u64) -> io::Result<usize> {
        std::os::unix::fs::FileExt::read_at(&self.0, out, start)
    }
}
