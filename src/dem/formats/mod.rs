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
pub(crate) mod raw;
pub mod raw_layout;
mod sample_layout;
mod surfer;
mod terragen;
pub(crate) mod text;
mod usgs;
mod xyz;

use crate::dem_format::{DemFormat, Recognition};
use crate::tiff::geotiff;

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

/// The extensions of the formats that are written, for messages.
pub const WRITTEN_EXTENSIONS: &str = ".tif, .asc, .bt, .hgt or .png";

impl DemFormat {
    /// The format that files with an extension, in any case and without the dot, are written in; `None` where none is.
    pub fn to_write(extension: &str) -> Option<&'static Self> {
        let lower = extension.to_ascii_lowercase();
        FORMATS.into_iter().find(|format| format.writer.is_some() && format.has_extension(&lower))
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
