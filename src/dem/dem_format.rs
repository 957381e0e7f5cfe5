//! The declaration of a format: how its files are recognized, read, opened in windows and written.
//!
//! The declarations know nothing of each other; [`FORMATS`](crate::formats::FORMATS) lists them.

use std::borrow::Cow;
use std::error::Error;

use crate::dem_file::DemFile;
use crate::written::{WriteError, WriteWindowsError, WrittenDem, WrittenWindows};
use sandtable_base::limits::UNPACKED_RASTER_BYTES;
use sandtable_raster::content::{FileContent, WrittenContent};
use sandtable_raster::error::DemErrorKind;
use sandtable_raster::raster::Raster;
use sandtable_raster::windows::Windows;

/// Writes a raster under the name of a file.
type DemWriter = fn(&Raster, &str) -> Result<WrittenDem, WriteError>;

/// Opens the content of a file, of whose bytes only the first are given; the number is that of the bytes to be cached.
type WindowsOpener =
    fn(&DemFile, Box<dyn FileContent>, usize) -> Result<Box<dyn Windows + Send>, DemErrorKind>;

type WindowsWriter =
    fn(&mut (dyn Windows + Send), &mut dyn WrittenContent) -> Result<WrittenWindows, WriteWindowsError>;

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
    /// `None` where the format is only read.
    pub(crate) writer: Option<FormatWriter>,
    /// Writes a raster that is read in windows: the bytes of `writer`; `None` where the format is written from memory.
    pub windows_writer: Option<WindowsWriter>,
}

/// How files of a format are written.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FormatWriter {
    /// The extensions that are written, in lower case, without the dot.
    pub extensions: &'static [&'static str],
    pub write: DemWriter,
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
    /// Whether files of this format have an extension, which is in lower case.
    pub(crate) fn has_extension(&self, extension: &str) -> bool {
        self.extensions.contains(&extension) || self.shared_extensions.contains(&extension)
    }

    pub(crate) fn broken(&self, reason: impl Into<String>) -> DemErrorKind {
        DemErrorKind::broken(self.name, reason)
    }

    /// A file of this format that a decoder or the file system refuses.
    pub(crate) fn undecodable(&self, source: impl Error + Send + Sync + 'static) -> DemErrorKind {
        DemErrorKind::undecodable(self.name, source)
    }

    pub(crate) fn unsupported(
        &self,
        what: impl Into<Box<dyn Error + Send + Sync>>,
        remedy: &'static str,
    ) -> DemErrorKind {
        DemErrorKind::unsupported(self.name, what, remedy)
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
