//! Opening elevation: one file, or the tiles in a folder.

use std::path::{Path, PathBuf};

use crate::dem::error::DemErrorKind;
use crate::dem::mosaic::{Mosaic, MosaicError, Tiles};
use crate::dem::raster::Raster;
use crate::dem::read::{self, DemHints};
use crate::pipeline::error::FileError;
use crate::pipeline::files::{self, ReadFileError};

/// Options for opening elevation. Companions are the files beside the opened one.
pub type DemOptions = DemHints<'static>;

/// Elevation that cannot be opened.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages explain the variants")]
pub enum OpenDemError {
    #[error(transparent)]
    File(#[from] ReadFileError),
    #[error(transparent)]
    Format(#[from] FileError<DemErrorKind>),
    #[error("{}: there is no elevation file in this folder", .0.display())]
    NoTiles(PathBuf),
    #[error(transparent)]
    Tiles(#[from] MosaicError),
}

/// Opens the elevation file at `path` with its sidecars, or joins the tiles in the folder at `path`.
///
/// # Errors
/// See [`OpenDemError`].
pub fn open(path: &Path, options: &DemOptions) -> Result<Mosaic, OpenDemError> {
    if !path.is_dir() {
        return open_tiles(&[path], options);
    }
    let mut tiles = files::list_folder(path)?;
    tiles.retain(|tile| read::is_tile_name(&files::file_name(tile)));
    if tiles.is_empty() {
        return Err(OpenDemError::NoTiles(path.to_owned()));
    }
    open_tiles(&tiles, options)
}

/// Joins the elevation files at `paths`, tiles of one raster; of samples that tiles share the first tile's is kept.
///
/// # Errors
/// See [`OpenDemError`].
pub fn open_tiles<P: AsRef<Path>>(paths: &[P], options: &DemOptions) -> Result<Mosaic, OpenDemError> {
    let mut tiles = Tiles::default();
    for path in paths {
        let path = path.as_ref();
        tiles.push(files::file_name(path), open_file(path, options)?)?;
    }
    Ok(tiles.join()?)
}

/// The name of the format of an elevation file, by its head; `None` where it seems to be no elevation or cannot be read.
pub fn format_by_head(path: &Path, options: &DemOptions) -> Option<&'static str> {
    let head = files::read_head(path, read::HEAD_BYTES).ok()?;
    let hints = DemHints { companions: &files::beside(path), ..options.clone() };
    read::format_by_head(&files::file_name(path), &head, &hints)
}

fn open_file(path: &Path, options: &DemOptions) -> Result<Raster, OpenDemError> {
    let bytes = files::read(path)?;
    let hints = DemHints { companions: &files::beside(path), ..options.clone() };
    let raster = read::read(&files::file_name(path), &bytes, &hints);
    Ok(raster.map_err(|error| FileError::<DemErrorKind>::new(path, error.kind))?)
}

/// A warning for the user where the tiles at `path` contradict each other.
pub fn warning(path: &Path, mosaic: &Mosaic) -> Option<String> {
    (mosaic.differing > 0).then(|| format!("{}: {}", path.display(), mosaic.note()))
}
