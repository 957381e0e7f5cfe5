//! The format of a file that a command writes.

use std::path::{Path, PathBuf};

use crate::error::CliError;
use sandtable_dem::dem_format::DemFormat;
use sandtable_dem::formats::WRITTEN_EXTENSIONS;
use sandtable_files::disk;

/// The format that `from_extension` returns for the extension of `path`, after a check that a file can be written there
/// without replacing one of `inputs`. `written` names the extensions in messages.
pub fn output_format<F>(
    path: &Path,
    inputs: &[PathBuf],
    from_extension: impl Fn(&str) -> Option<F>,
    written: &str,
) -> Result<F, CliError> {
    let extension = path.extension().unwrap_or_default().to_string_lossy();
    let format = from_extension(&extension)
        .ok_or_else(|| CliError::usage(format!("{}: {written}; name a file that ends so", path.display())))?;
    disk::check_output(path, inputs)?;
    Ok(format)
}

/// [`output_format`] for a raster.
pub fn raster_format(path: &Path, inputs: &[PathBuf]) -> Result<&'static DemFormat, CliError> {
    output_format(path, inputs, DemFormat::to_write, &format!("rasters are written as {WRITTEN_EXTENSIONS}"))
}
