//! Opening elevation: one file, or the tiles in a folder.

use std::path::{Path, PathBuf};

use crate::dem::error::DemErrorKind;
use crate::dem::formats::height_encoding::HeightEncoding;
use crate::dem::formats::raw::RawLayout;
use crate::dem::mosaic::{Mosaic, MosaicError, Tiles};
use crate::dem::raster::Raster;
use crate::dem::read::{self, DemHints};
use crate::geom::crs::Crs;
use crate::pipeline::error::FileError;
use crate::pipeline::files::{self, ReadFileError};

/// What the caller states about an elevation file beyond its content.
#[derive(Clone, Debug, Default)]
pub struct DemOptions {
    /// Meters per gray value of a PNG, which needs it, or of a RAW file. Default 1 there.
    pub height_scale: Option<f64>,
    /// Height in meters of value 0 of a gray PNG or a RAW file. Default 0.
    pub height_offset: Option<f64>,
    /// What the colors of a PNG mean.
    pub height_encoding: Option<HeightEncoding>,
    /// The layout of a RAW file.
    pub raw: Option<RawLayout>,
    /// Meters between the posts of a file that does not state it.
    pub cell: Option<f64>,
    /// The coordinate system, in place of the one that the file states.
    pub crs: Option<Crs>,
}

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

fn open_file(path: &Path, options: &DemOptions) -> Result<Raster, OpenDemError> {
    let bytes = files::read(path)?;
    let hints = DemHints {
        height_scale: options.height_scale,
        height_offset: options.height_offset,
        height_encoding: options.height_encoding,
        raw: options.raw,
        cell: options.cell,
        crs: options.crs.clone(),
        companions: &files::beside(path),
        ..DemHints::default()
    };
    let raster = read::read(&files::file_name(path), &bytes, &hints);
    Ok(raster.map_err(|error| FileError::<DemErrorKind>::new(path, error.kind))?)
}

/// A warning for the user where the tiles at `path` contradict each other.
pub fn warning(path: &Path, mosaic: &Mosaic) -> Option<String> {
    (mosaic.differing > 0).then(|| format!("{}: {}", path.display(), mosaic.note()))
}
