//! File formats of elevation, one file each, declared in one list.
//!
//! A new format is a file with a `FORMAT` and its line in [`FORMATS`]: recognition, reading, writing, the extensions of
//! tiles in folders and archives, and the formats that messages list all come from that declaration.

mod ascii;
mod bt;
mod degree_square;
mod dted;
mod dted_write;
mod ehdr;
mod ehdr_write;
mod envi;
#[cfg(feature = "gpkg")]
mod gpkg;
#[cfg(feature = "gpkg")]
mod gpkg_tiles;
mod header;
pub mod height_encoding;
mod hfa;
mod hgt;
mod landxml;
mod landxml_tin;
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
mod xyz_write;

use crate::dem_format::{DemFormat, Recognition};
use crate::tiff::geotiff;

/// The formats, in the order in which their content is tried.
pub static FORMATS: &[&DemFormat] = &[
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
    &landxml::FORMAT,
    &hfa::FORMAT,
    #[cfg(feature = "gpkg")]
    &gpkg::FORMAT,
    &raw::FORMAT,
];

/// The extensions of the formats that are written, for messages.
pub const WRITTEN_EXTENSIONS: &str = ".tif, .asc, .flt, .bil, .bt, .xyz, .hgt, .dt0, .dt1, .dt2 or .png";

impl DemFormat {
    /// The format that files with an extension, in any case and without the dot, are written in; `None` where none is.
    pub fn to_write(extension: &str) -> Option<&'static Self> {
        let lower = extension.to_ascii_lowercase();
        let writes =
            |format: &&Self| format.writer.is_some_and(|writer| writer.extensions.contains(&&*lower));
        FORMATS.iter().copied().find(writes)
    }
}

/// The formats that are read, for messages: `GeoTIFF (.tif, .tiff), …`.
pub(crate) fn list() -> String {
    let entries = FORMATS.iter().map(|format| {
        let all = format.extensions.iter().chain(format.shared_extensions);
        let mut extensions: Vec<String> = all.map(|extension| format!(".{extension}")).collect();
        if matches!(format.recognition, Recognition::HeaderFile { .. }) {
            extensions.push("with .hdr".into());
        }
        format!("{} ({})", format.name, extensions.join(", "))
    });
    entries.collect::<Vec<_>>().join(", ")
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
        // Tables of points: a grid among them would pass for more of them.
        assert_eq!((name("csv"), name("txt")), (None, None));
    }

    #[test]
    fn messages_list_every_extension_that_is_written() {
        let written = FORMATS.iter().filter_map(|format| format.writer).flat_map(|writer| writer.extensions);
        let mut written: Vec<String> = written.map(|extension| format!(".{extension}")).collect();
        let mut listed: Vec<&str> =
            WRITTEN_EXTENSIONS.split([',', ' ']).filter(|word| word.starts_with('.')).collect();
        written.retain(|extension| extension != ".tiff");
        written.sort();
        listed.sort_unstable();
        assert_eq!(listed, written);
    }
}
