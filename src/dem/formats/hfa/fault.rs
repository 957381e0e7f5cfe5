//! What is wrong with a file, in the words of all errors of the format.

use std::error::Error;

use sandtable_raster::error::DemErrorKind;

/// The format's name in messages.
pub(super) const NAME: &str = "Erdas Imagine file";

const TO_TIFF: &str = "convert it, for example with: gdal_translate FILE out.tif";

/// A file that breaks the rules of the format.
pub(super) fn broken(reason: impl Into<String>) -> DemErrorKind {
    DemErrorKind::broken(NAME, reason)
}

/// A sound file with something that is not read.
pub(super) fn unsupported(what: impl Into<Box<dyn Error + Send + Sync>>) -> DemErrorKind {
    DemErrorKind::unsupported(NAME, what, TO_TIFF)
}
