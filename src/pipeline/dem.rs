//! Opening elevation: one file, the tiles in a folder, or those that a virtual raster lists.

use std::path::{Path, PathBuf};

use crate::dem::error::DemErrorKind;
use crate::dem::mosaic::{Mosaic, MosaicError, Tiles};
use crate::dem::mosaic_windows::MosaicWindows;
use crate::dem::raster::Raster;
use crate::dem::read::{self, DemHints, DemOptions};
use crate::dem::vrt::{self, VrtTiles};
use crate::dem::windows::{WINDOW_CACHE_BYTES, Windows};
use crate::pipeline::elevation_files::{self, CompanionFiles};
use crate::pipeline::error::FileError;
use crate::pipeline::files::{self, ReadFileError};
use crate::remote::address::is_address_path;

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

impl OpenDemError {
    /// The file or folder that cannot be opened; `None` where tiles do not fit together.
    pub fn file(&self) -> Option<&Path> {
        match self {
            Self::File(error) => Some(&error.path),
            Self::Format(error) => Some(&error.path),
            Self::NoTiles(path) => Some(path),
            Self::Tiles(_) => None,
        }
    }
}

/// Opens the elevation file at `path` with its sidecars, or joins the tiles in the folder at `path`, or those that the virtual
/// raster there lists.
///
/// # Errors
/// See [`OpenDemError`].
pub fn open(path: &Path, options: &DemOptions) -> Result<Mosaic, OpenDemError> {
    let Some(tiles) = TileFiles::of(path, options)? else { return open_tiles(&[path], options) };
    let mosaic = open_tiles(&tiles.paths, &tiles.options(options))?;
    tiles.check(path, &mosaic.raster)?;
    Ok(mosaic)
}

/// The tiles that a path stands for.
struct TileFiles {
    paths: Vec<PathBuf>,
    /// The virtual raster that lists them, where one does.
    vrt: Option<VrtTiles>,
}

impl TileFiles {
    /// The tiles of a folder or a virtual raster; `None` of a file of its own.
    fn of(path: &Path, options: &DemOptions) -> Result<Option<Self>, OpenDemError> {
        if path.is_dir() {
            return Ok(Some(Self { paths: tiles_in(path)?, vrt: None }));
        }
        if !vrt::is_vrt(&files::file_name(path)) || options.raw.is_some() {
            return Ok(None);
        }
        let vrt = VrtTiles::read(&elevation_files::read(path)?).map_err(FileError::at(path))?;
        if is_address_path(path) {
            vrt.check_beside().map_err(FileError::at(path))?;
        }
        Ok(Some(Self { paths: vrt.paths(path), vrt: Some(vrt) }))
    }

    /// The options for the tiles: what the caller states of missing data counts, else what the virtual raster does.
    fn options(&self, options: &DemOptions) -> DemOptions {
        let nodata = options.nodata.or(self.vrt.as_ref().and_then(|vrt| vrt.nodata));
        DemOptions { nodata, ..options.clone() }
    }

    /// Checks what the tiles of the virtual raster at `path` join to.
    fn check(&self, path: &Path, joined: &Raster) -> Result<(), OpenDemError> {
        Ok(self.vrt.as_ref().map_or(Ok(()), |vrt| vrt.check(joined)).map_err(FileError::at(path))?)
    }
}

/// The tiles in a folder, at least one, sorted by name.
fn tiles_in(folder: &Path) -> Result<Vec<PathBuf>, OpenDemError> {
    let mut tiles = files::list_folder(folder)?;
    tiles.retain(|tile| read::is_tile_name(&files::file_name(tile)));
    if tiles.is_empty() { Err(OpenDemError::NoTiles(folder.to_owned())) } else { Ok(tiles) }
}

/// Opened elevation: in memory, or to be read where it is needed.
pub enum OpenedDem {
    /// All of it.
    Kept(Box<Mosaic>),
    /// Any window of it.
    Windows(Box<dyn Windows + Send>),
}

/// Opens elevation as [`open`] does, but does not read it where it holds more than `most_kept` samples and can be read in
/// windows.
///
/// # Errors
/// See [`OpenDemError`].
pub fn open_either(path: &Path, options: &DemOptions, most_kept: u64) -> Result<OpenedDem, OpenDemError> {
    let windows = match TileFiles::of(path, options)? {
        Some(tiles) => open_mosaic(&tiles.paths, &tiles.options(options)).and_then(|windows| {
            let header = windows.as_ref().map(|windows| windows.metadata());
            header.map_or(Ok(()), |header| tiles.check(path, header))?;
            Ok(windows)
        }),
        None => open_windows(path, options),
    };
    let fault = match windows {
        Ok(Some(windows)) if samples(&*windows) > most_kept => return Ok(OpenedDem::Windows(windows)),
        // It would be the same again, and a server may take half a minute for it.
        Err(error @ OpenDemError::File(_)) => return Err(error),
        windows => windows.err(),
    };
    open(path, options).map(|mosaic| OpenedDem::Kept(Box::new(mosaic))).map_err(|whole| {
        match (whole, fault) {
            // The reason why there are no windows has a remedy that keeps all samples.
            (OpenDemError::Format(FileError { cause: DemErrorKind::TooLarge { .. }, .. }), Some(fault)) => {
                fault
            }
            (whole, _) => whole,
        }
    })
}

/// Opens one elevation file of more than `most_kept` samples that can be read in windows; `None` for any other, for tiles, and for
/// one that is broken, of which [`open`] says why.
pub fn open_large(path: &Path, options: &DemOptions, most_kept: u64) -> Option<Box<dyn Windows + Send>> {
    if path.is_dir() || vrt::is_vrt(&files::file_name(path)) {
        return None;
    }
    open_windows(path, options).ok().flatten().filter(|windows| samples(&**windows) > most_kept)
}

fn samples(windows: &dyn Windows) -> u64 {
    let (width, height) = windows.size();
    u64::from(width) * u64::from(height)
}

/// The windows of the mosaic of tiles, opened by their headers; `None` where one has none.
fn open_mosaic(
    paths: &[PathBuf],
    options: &DemOptions,
) -> Result<Option<Box<dyn Windows + Send>>, OpenDemError> {
    let mut headers = Vec::new();
    for path in paths {
        let Some(tile) = open_windows(path, options)? else { return Ok(None) };
        headers.push((files::file_name(path), tile.metadata().without_samples()));
    }
    let (paths, options) = (paths.to_vec(), options.clone());
    let opener = move |index: usize| match open_windows(&paths[index], &options) {
        Ok(Some(tile)) => Ok(tile),
        Err(OpenDemError::Format(error)) => Err(error.cause),
        Err(OpenDemError::File(error)) if is_address_path(&error.path) => {
            Err(DemErrorKind::Unread(error.into()))
        }
        Ok(None) | Err(_) => Err(DemErrorKind::Changed),
    };
    Ok(Some(Box::new(MosaicWindows::new(headers, Box::new(opener))?)))
}

/// The windows of an elevation file; `None` where its format is read whole.
fn open_windows(path: &Path, options: &DemOptions) -> Result<Option<Box<dyn Windows + Send>>, OpenDemError> {
    let (head, content) = elevation_files::open(path)?;
    let companions = CompanionFiles::beside(path);
    let hints = DemHints { companions: &|name| companions.get(name), ..options.clone().into() };
    let windows = read::open_windows(&files::file_name(path), &head, content, &hints, WINDOW_CACHE_BYTES);
    companions.check()?;
    Ok(windows.map_err(|error| FileError::<DemErrorKind>::new(path, error.kind))?)
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
    let hints = DemHints { companions: &files::beside(path), ..options.clone().into() };
    read::format_by_head(&files::file_name(path), &head, &hints)
}

fn open_file(path: &Path, options: &DemOptions) -> Result<Raster, OpenDemError> {
    let bytes = elevation_files::read(path)?;
    let companions = CompanionFiles::beside(path);
    let hints = DemHints { companions: &|name| companions.get(name), ..options.clone().into() };
    let raster = read::read(&files::file_name(path), &bytes, &hints);
    companions.check()?;
    Ok(raster.map_err(|error| FileError::<DemErrorKind>::new(path, error.kind))?)
}

/// A warning for the user where the tiles at `path` contradict each other.
pub fn warning(path: &Path, mosaic: &Mosaic) -> Option<String> {
    (mosaic.differing > 0).then(|| format!("{}: {}", path.display(), mosaic.note()))
}
