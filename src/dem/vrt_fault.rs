//! Errors of virtual rasters, and the tolerance for their numbers.

use sandtable_raster::error::DemErrorKind;

/// How far, in cells, a virtual raster may lie from the tiles that it names.
pub(super) const PLACE: f64 = 1e-3;

/// The start of a text of a file, for messages.
pub(super) fn shortened(text: &str) -> String {
    text.chars().take(80).collect()
}

/// The error of a virtual raster that contradicts itself.
pub(super) fn broken(reason: String) -> DemErrorKind {
    DemErrorKind::broken("VRT", reason)
}

/// The error of a virtual raster that uses what is not read.
pub(super) fn unsupported(what: String) -> DemErrorKind {
    DemErrorKind::unsupported("VRT", what, "make a file of it: gdal_translate -co TILED=YES IN.vrt OUT.tif")
}
