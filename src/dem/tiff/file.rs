//! A TIFF file that several decoders read, each from its own place.
//!
//! A decoder stands on one image; coming back to another means reading its tables of blocks again. So a raster and
//! its mask get a decoder each, over one file. Photometric tags are rewritten on the way (see
//! [`crate::dem::tiff::neutral`]), since the file itself is not ours to change.

use std::io::{self, Read, Seek, SeekFrom};
use std::sync::{Arc, Mutex, PoisonError};

use crate::dem::tiff::neutral;

/// A place in a shared file.
#[derive(Debug)]
pub(crate) struct TiffFile<R> {
    file: Arc<Mutex<R>>,
    rewritten: Arc<[(usize, [u8; 2])]>,
    length: u64,
    at: u64,
}

impl<R> Clone for TiffFile<R> {
    fn clone(&self) -> Self {
        let (file, rewritten) = (Arc::clone(&self.file), Arc::clone(&self.rewritten));
        Self { file, rewritten, length: self.length, at: self.at }
    }
}

impl<R: Read + Seek> TiffFile<R> {
    /// The start of a file.
    pub fn new(mut file: R) -> io::Result<Self> {
        let length = file.seek(SeekFrom::End(0))?;
        let bytes = usize::try_from(length).map_err(io::Error::other)?;
        let rewritten = neutral::rewritten(&mut file, bytes).into();
        Ok(Self { file: Arc::new(Mutex::new(file)), rewritten, length, at: 0 })
    }

    /// The file's bytes; they fit a usize.
    pub fn length(&self) -> usize {
        self.length as usize
    }

    /// Puts the rewritten bytes over those that were read from `start`.
    fn rewrite(&self, start: u64, bytes: &mut [u8]) {
        for (place, new) in self.rewritten.iter() {
            for (offset, &byte) in new.iter().enumerate() {
                let within = (*place as u64 + offset as u64).checked_sub(start);
                let within = within.and_then(|within| usize::try_from(within).ok());
                if let Some(slot) = within.and_then(|within| bytes.get_mut(within)) {
                    *slot = byte;
                }
            }
        }
    }
}

impl<R: Read + Seek> Read for TiffFile<R> {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        // A reader that panicked elsewhere left nothing half done here: the place is set anew below.
        let mut file = self.file.lock().unwrap_or_else(PoisonError::into_inner);
        file.seek(SeekFrom::Start(self.at))?;
        let count = file.read(bytes)?;
        drop(file);
        self.rewrite(self.at, &mut bytes[..count]);
        self.at += count as u64;
        Ok(count)
    }
}

impl<R: Read + Seek> Seek for TiffFile<R> {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        let found = match to {
            SeekFrom::Start(at) => Some(at),
            SeekFrom::End(by) => self.length.checked_add_signed(by),
            SeekFrom::Current(by) => self.at.checked_add_signed(by),
        };
        self.at = found.ok_or_else(|| io::Error::from(io::ErrorKind::InvalidInput))?;
        Ok(self.at)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Cursor;

    #[test]
    fn two_places_in_one_file_do_not_disturb_each_other() {
        let mut first = TiffFile::new(Cursor::new((0..9u8).collect::<Vec<_>>())).expect("memory");
        let mut second = first.clone();
        let next = |file: &mut TiffFile<_>| {
            let mut bytes = [0; 2];
            file.read_exact(&mut bytes).expect("inside");
            bytes
        };
        assert_eq!((next(&mut first), next(&mut first)), ([0, 1], [2, 3]));
        second.seek(SeekFrom::End(-4)).expect("inside");
        assert_eq!((next(&mut second), next(&mut first)), ([5, 6], [4, 5]));
    }

    #[test]
    fn rewritten_bytes_are_seen_wherever_a_read_starts() {
        let bytes = [b'I', b'I', 42, 0, 8, 0, 0, 0, 1, 0, 6, 1, 3, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0];
        let mut file = TiffFile::new(Cursor::new(bytes)).expect("memory");
        for start in 0..bytes.len() as u64 {
            let mut read = Vec::new();
            file.seek(SeekFrom::Start(start)).expect("inside");
            file.read_to_end(&mut read).expect("memory");
            let mut wanted = bytes;
            wanted[18] = 1;
            assert_eq!(read, wanted[start as usize..]);
        }
    }
}
