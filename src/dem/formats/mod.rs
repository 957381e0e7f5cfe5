//! File formats of elevation, one file each, declared in one list.
//!
//! A new format is a file with a `FORMAT` and its line in [`FORMATS`]: recognition, reading, writing, the extensions of
//! tiles in folders and archives, and the formats that messages list all come from that declaration.

mod ascii;
mod bt;
mod dted;
mod ehdr;
mod envi;
mod header;
pub mod height_encoding;
mod hgt;
mod plain_raster;
mod png;
pub mod raw;
mod sample_layout;
mod surfer;
mod terragen;
pub(crate) mod text;
mod usgs;
mod xyz;

use std::borrow::Cow;
use std::error::Error;
use std::fs::File;
use std::io::{self, Cursor, Read, Seek, Write};
use std::ops::Range;
use std::sync::Arc;

use crate::error::DemErrorKind;
use crate::raster::Raster;
use crate::read::DemFile;
use crate::tiff::geotiff;
use crate::windows::Windows;
use crate::write::{WriteError, WriteWindowsError, WrittenDem, WrittenWindows};
use sandtable_base::limits::UNPACKED_RASTER_BYTES;

/// The formats, in the order in which their content is tried.
pub static FORMATS: [&DemFormat; 13] = [
    &geotiff::FORMAT,
    &ascii::FORMAT,
    &envi::FORMAT,
    &ehdr::FORMAT,
    &hgt::FORMAT,
    &dted::FORMAT,
    &usgs::FORMAT,
    &bt::FORMAT,
    &terragen::FORMAT,
    &surfer::FORMAT,
    &xyz::FORMAT,
    &png::FORMAT,
    &raw::FORMAT,
];

type DemWriter = fn(&Raster, &str) -> Result<WrittenDem, WriteError>;

/// Opens the content of a file, of whose bytes only the first are given; the number is that of the bytes to be cached.
type WindowsOpener =
    fn(&DemFile, Box<dyn FileContent>, usize) -> Result<Box<dyn Windows + Send>, DemErrorKind>;

type WindowsWriter =
    fn(&mut (dyn Windows + Send), &mut dyn WrittenContent) -> Result<WrittenWindows, WriteWindowsError>;

/// A file that is being written, in order but for its head.
pub trait WrittenContent: Write + Seek + Send {}

impl<C: Write + Seek + Send> WrittenContent for C {}

/// The content of a file that stays where it is: on disk, or on a server.
pub trait FileContent: Read + Seek + Send {
    /// Says which bytes are read next, in ascending order, to content that is far away and fetches them together.
    fn announce(&mut self, _ranges: &[Range<u64>]) {}

    /// The same content for threads that read it by the place of its bytes; `None` where these wait for each other.
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

/// The extensions of the formats that are written, for messages.
pub const WRITTEN_EXTENSIONS: &str = ".tif, .asc, .bt, .hgt or .png";

/// The declaration of a format.
#[derive(Debug)]
pub struct DemFormat {
    /// Its name in messages.
    pub name: &'static str,
    /// Extensions of this format alone, in lower case, without the dot: such files are tiles in folders and archives.
    pub extensions: &'static [&'static str],
    /// Extensions that pictures and tables have as well.
    pub shared_extensions: &'static [&'static str],
    pub(crate) recognition: Recognition,
    pub(crate) reader: fn(&DemFile) -> Result<Raster, DemErrorKind>,
    /// Opens a file to be read in windows; `None` where the format is read whole.
    pub(crate) windows: Option<WindowsOpener>,
    /// The most bytes that a file has which starts with these: a packed one is unpacked no further.
    pub(crate) most_bytes: fn(&[u8]) -> u64,
    /// Writes a raster; `None` where the format is only read. The text is the stem of the file's name.
    pub(crate) writer: Option<DemWriter>,
    /// Writes a raster that is read in windows: the bytes of `writer`; `None` where the format is written from memory.
    pub windows_writer: Option<WindowsWriter>,
}

/// How files of a format are recognized.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Recognition {
    /// By their first bytes.
    Content {
        matches: fn(&[u8]) -> bool,
        /// The first bytes in words, for messages.
        start: &'static str,
    },
    Extension,
    /// By a text header in a file beside them.
    HeaderFile {
        matches: fn(&[u8]) -> bool,
    },
    /// By a statement of the caller.
    Statement,
}

/// The limit for files whose first bytes do not tell their size.
pub(crate) fn any_size(_: &[u8]) -> u64 {
    UNPACKED_RASTER_BYTES.get()
}

impl DemFormat {
    /// The format that files with an extension, in any case and without the dot, are written in; `None` where none is.
    pub fn to_write(extension: &str) -> Option<&'static Self> {
        let lower = extension.to_ascii_lowercase();
        FORMATS.into_iter().find(|format| format.writer.is_some() && format.has_extension(&lower))
    }

    /// Whether files of this format have an extension, which is in lower case.
    pub(crate) fn has_extension(&self, extension: &str) -> bool {
        self.extensions.contains(&extension) || self.shared_extensions.contains(&extension)
    }

    pub(crate) fn broken(&self, reason: impl Into<String>) -> DemErrorKind {
        DemErrorKind::Broken { format: self.name, reason: reason.into() }
    }

    /// A file of this format that a decoder or the file system refuses.
    pub(crate) fn undecodable(&self, source: impl Error + Send + Sync + 'static) -> DemErrorKind {
        DemErrorKind::Undecodable { format: self.name, source: Box::new(source) }
    }

    /// A file of this format that cannot be read: broken, as far as the system reads it.
    pub(crate) fn unread(&self, error: io::Error) -> DemErrorKind {
        match error.get_ref() {
            Some(_) => DemErrorKind::Unread(Box::new(error)),
            None => self.undecodable(error),
        }
    }

    pub(crate) fn unsupported(
        &self,
        what: impl Into<Box<dyn Error + Send + Sync>>,
        remedy: &'static str,
    ) -> DemErrorKind {
        DemErrorKind::Unsupported { format: self.name, what: what.into(), remedy }
    }

    /// A raster that has a georeference, with north up, for formats that hold no other; one that only runs the other way
    /// along an axis is mirrored.
    pub(crate) fn north_up<'a>(&self, raster: &'a Raster) -> Result<Cow<'a, Raster>, WriteError> {
        match (raster.georeferenced, raster.is_axis_aligned()) {
            (false, _) => Err(WriteError::NoPlace(self.name)),
            (_, false) => Err(WriteError::NotNorthUp(self.name)),
            _ => Ok(raster.turned_north_up()),
        }
    }
}

/// The formats that are read, for messages: `GeoTIFF (.tif, .tiff), …`.
pub(crate) fn list() -> String {
    let entries = FORMATS.map(|format| {
        let all = format.extensions.iter().chain(format.shared_extensions);
        let mut extensions: Vec<String> = all.map(|extension| format!(".{extension}")).collect();
        if matches!(format.recognition, Recognition::HeaderFile { .. }) {
            extensions.push("with .hdr".into());
        }
        format!("{} ({})", format.name, extensions.join(", "))
    });
    entries.join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_extension_belongs_to_one_format() {
        let mut all: Vec<&str> = FORMATS
            .iter()
            .flat_map(|format| format.extensions.iter().chain(format.shared_extensions))
            .copied()
            .collect();
        let count = all.len();
        all.sort_unstable();
        all.dedup();
        assert_eq!(all.len(), count);
    }

    #[test]
    fn formats_that_are_written_are_found_by_extension() {
        let name = |extension: &str| DemFormat::to_write(extension).map(|format| format.name);
        assert_eq!(
            (name("TIF"), name("png"), name("bt")),
            (Some("GeoTIFF"), Some("PNG"), Some("BT terrain"))
        );
        assert_eq!((name("dem"), name("btz"), name("")), (None, None, None));
    }
}
