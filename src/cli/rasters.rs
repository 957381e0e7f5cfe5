//! The format of a raster that a command writes.

use std::path::{Path, PathBuf};

use crate::cli::error::CliError;
use crate::dem::formats::DemFormat;
use crate::pipeline::files;

/// The format that the extension of `path` names, where a file could be written there that replaces none of `inputs`.
pub fn format_for(path: &Path, inputs: &[PathBuf]) -> Result<&'static DemFormat, CliError> {
    let format = DemFormat::to_write(&extension(path)).ok_or_else(|| {
        let path = path.display();
        let formats = "rasters are written as .tif, .asc, .bt, .hgt or .png; name a file that ends so";
        CliError::usage(format!("{path}: {formats}"))
    })?;
    files::check_output(path, inputs)?;
    Ok(format)
}

/// The extension of a path; empty where there is none.
pub fn extension(path: &Path) -> String {
    path.extension().unwrap_or_default().to_string_lossy().into_owned()
}
