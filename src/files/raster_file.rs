//! Writing rasters: the file and the files beside it, without replacing an input.

use std::io;
use std::path::{Path, PathBuf};

use crate::disk::{self, ReadFileError, SystemError, WriteFileError};
use crate::error::FileError;
use crate::output_files::OutputFiles;
use sandtable_dem::companion::Companion;
use sandtable_dem::dem_format::DemFormat;
use sandtable_dem::write;
use sandtable_dem::written::{WriteError, WriteWindowsError, WrittenDem, WrittenWindows};
use sandtable_raster::error::DemErrorKind;
use sandtable_raster::raster::Raster;
use sandtable_raster::windows::Windows;

/// A raster that cannot be written.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages explain the variants")]
pub enum WriteRasterError {
    #[error(transparent)]
    Format(#[from] FileError<WriteError>),
    #[error("{}: this belongs to an input file and would be replaced; name another to write to", .0.display())]
    Sidecar(PathBuf),
    #[error(transparent)]
    Read(#[from] ReadFileError),
    #[error(transparent)]
    Samples(#[from] FileError<DemErrorKind>),
    #[error(transparent)]
    File(#[from] WriteFileError),
}

/// Writes a raster to `path` and the files that belong beside it, all or none. `inputs` are the files that it was made
/// of.
///
/// # Errors
/// See [`WriteRasterError`]; nothing replaces one of `inputs` or a sidecar of one.
pub fn write(
    raster: &Raster,
    format: &DemFormat,
    path: &Path,
    inputs: &[PathBuf],
) -> Result<WrittenDem, WriteRasterError> {
    let mut files = OutputFiles::default();
    let written = add(&mut files, raster, format, path, inputs)?;
    files.publish()?;
    Ok(written)
}

/// [`write()`] among other files.
///
/// # Errors
/// As [`write()`].
pub fn add(
    files: &mut OutputFiles,
    raster: &Raster,
    format: &DemFormat,
    path: &Path,
    inputs: &[PathBuf],
) -> Result<WrittenDem, WriteRasterError> {
    let written = write::write(raster, format, &disk::file_name(path)).map_err(FileError::at(path))?;
    for companion in &written.companions {
        check_companion(&path.with_extension(companion.extension), companion, inputs)?;
    }
    for companion in &written.companions {
        files.write(&path.with_extension(companion.extension), &companion.bytes)?;
    }
    files.write(path, &written.bytes)?;
    Ok(written)
}

/// [`write()`] of a raster that is read in windows and is kept as it is; `None` where the format is written from memory.
///
/// # Errors
/// As [`write()`]; of `input`, where samples cannot be read.
pub fn write_windows(
    source: &mut (dyn Windows + Send),
    format: &DemFormat,
    path: &Path,
    input: &Path,
) -> Result<Option<WrittenWindows>, WriteRasterError> {
    let Some(writer) = format.windows_writer else { return Ok(None) };
    let (mut files, mut written) =
        (OutputFiles::default(), Err(WriteWindowsError::Read(DemErrorKind::Changed)));
    let filled = files.write_with(path, |out| {
        written = writer(source, out);
        match &mut written {
            Err(WriteWindowsError::Write(error)) => {
                Err(std::mem::replace(error, io::ErrorKind::Other.into()))
            }
            _ => Ok(()),
        }
    });
    filled?;
    match written {
        Ok(written) => {
            files.publish()?;
            Ok(Some(written))
        }
        Err(WriteWindowsError::Read(error)) => Err(FileError::at(input)(error).into()),
        Err(WriteWindowsError::Write(error)) => {
            Err(WriteFileError::new(path, SystemError::from(error)).into())
        }
    }
}

/// A companion may replace a sidecar of an input only by the same bytes.
fn check_companion(path: &Path, companion: &Companion, inputs: &[PathBuf]) -> Result<(), WriteRasterError> {
    disk::check_output(path, inputs)?;
    let Ok(real) = path.canonicalize() else { return Ok(()) };
    let sidecar = |input: &PathBuf| input.with_extension(companion.extension).canonicalize().ok();
    let is_sidecar = inputs.iter().filter_map(sidecar).any(|sidecar| sidecar == real);
    if is_sidecar && disk::read(path)? != companion.bytes {
        return Err(WriteRasterError::Sidecar(path.to_owned()));
    }
    Ok(())
}
