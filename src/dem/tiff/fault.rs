//! Errors of GeoTIFF files.

use std::error::Error;
use std::io;

use tiff::TiffError;

use sandtable_base::limits::TIFF_TAG_BYTES;
use sandtable_raster::error::DemErrorKind;

/// The format in messages.
pub(crate) const NAME: &str = "GeoTIFF";

/// The remedy for an unsupported compression.
pub(crate) const TO_DEFLATE: &str =
    "convert it, for example with: gdal_translate -co COMPRESS=DEFLATE FILE out.tif";

/// The error of a file that contradicts itself.
pub(crate) fn broken(reason: impl Into<String>) -> DemErrorKind {
    DemErrorKind::broken(NAME, reason)
}

/// The error of a file that cannot be read: broken, as far as the system reads it.
pub(crate) fn unread(error: io::Error) -> DemErrorKind {
    DemErrorKind::unread(NAME, error)
}

/// The error of a file that uses what is not read.
pub(crate) fn unsupported(
    what: impl Into<Box<dyn Error + Send + Sync>>,
    remedy: &'static str,
) -> DemErrorKind {
    DemErrorKind::unsupported(NAME, what, remedy)
}

/// The decoder's error in the words of the other readers.
pub(crate) fn decode_error(error: TiffError) -> DemErrorKind {
    match error {
        TiffError::UnsupportedError(what) => unsupported(what, TO_DEFLATE),
        TiffError::LimitsExceeded => broken(format!(
            "a tag claims more than the file holds, or than the {TIFF_TAG_BYTES} bytes that are read of one: {TIFF_TAG_BYTES:#}"
        )),
        TiffError::IoError(error) if error.get_ref().is_some() => unread(error),
        other => DemErrorKind::undecodable(NAME, other),
    }
}
