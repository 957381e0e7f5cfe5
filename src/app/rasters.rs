//! Writing rasters: the format by the name's extension, the file and what belongs beside it, no input replaced.

use std::path::{Path, PathBuf};

use crate::app::failure::CliError;
use crate::app::files;
use crate::dem::formats::DemFormat;
use crate::dem::raster::Raster;
use crate::dem::write::{self, Companion, WrittenDem};

/// The format that a file's name asks for, where it may be written and is none of `inputs`.
///
/// # Errors
/// The extension is that of no format, or the file cannot be there.
pub fn format_of(out: &Path, inputs: &[PathBuf]) -> Result<&'static DemFormat, CliError> {
    let extension = out.extension().unwrap_or_default().to_string_lossy();
    let format = DemFormat::to_write(&extension).ok_or_else(|| {
        let place = out.display();
        CliError::Usage(format!(
            "{place}: rasters are written as .tif, .asc, .bt, .hgt or .png; name a file that ends so"
        ))
    })?;
    for input in inputs {
        files::check_file_place(out, input, "this is a file that is read; name another to write to")?;
    }
    Ok(format)
}

/// Writes a raster: its companions, then the file, so that where the file is there, all of it is.
///
/// # Errors
/// The format cannot hold the raster, or a file cannot be written or would replace one of `inputs` or what belongs to it.
pub fn write(
    raster: &Raster,
    format: &DemFormat,
    out: &Path,
    inputs: &[PathBuf],
) -> Result<WrittenDem, CliError> {
    let stem = out.file_stem().unwrap_or_default().to_string_lossy();
    let about_out = |error: write::WriteError| CliError::input(format!("{}: {error}", out.display()));
    let written = write::write(raster, format, &stem).map_err(about_out)?;
    for companion in &written.companions {
        for input in inputs {
            check_companion(&out.with_extension(companion.extension), companion, input)?;
        }
    }
    for companion in &written.companions {
        files::write_whole(&out.with_extension(companion.extension), &companion.bytes)?;
    }
    files::write_whole(out, &written.bytes)?;
    Ok(written)
}

/// A companion may take the place neither of an input nor of a sidecar of one, unless it is the same.
fn check_companion(place: &Path, companion: &Companion, input: &Path) -> Result<(), CliError> {
    files::check_file_place(place, input, "this is a file that is read; name another to write to")?;
    let sidecar = input.with_extension(companion.extension).canonicalize().ok();
    if sidecar.is_some() && sidecar == place.canonicalize().ok() && files::read(place)? != companion.bytes {
        let reason = "this belongs to a file that is read and would be replaced; name another to write to";
        return Err(CliError::input(format!("{}: {reason}", place.display())));
    }
    Ok(())
}
