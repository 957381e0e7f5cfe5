//! Opening elevation: one file, the tiles in a folder, or those that a virtual raster lists.

use std::path::{Path, PathBuf};

use sandtable_base::limits::{COMPANION_BYTES, INPUT_BYTES, RASTER_SAMPLES};
use sandtable_dem::hints::{DemHints, DemOptions};
use sandtable_dem::read;
use sandtable_dem::vrt::{self, VrtTiles};
use sandtable_dem::vrt_source::VrtSource;
use sandtable_files::addressed;
use sandtable_files::disk::{self, ReadFileError};
use sandtable_files::error::FileError;
use sandtable_raster::error::DemErrorKind;
use sandtable_raster::mosaic::{Mosaic, MosaicError, Tiles};
use sandtable_raster::mosaic_windows::MosaicWindows;
use sandtable_raster::raster::Raster;
use sandtable_raster::unstated_unit;
use sandtable_raster::windows::{RasterWindow, WINDOW_CACHE_BYTES, Windows};
use sandtable_remote::address::is_address_path;

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
    let opened = tiles.paths.iter().enumerate().map(|(index, path)| (path, tiles.open_whole(index, options)));
    // A virtual raster states its own grid.
    let mut mosaic = join(opened, options.cell.filter(|_| tiles.vrt.is_none()))?;
    if let Some(vrt) = &tiles.vrt {
        let joined = mosaic.raster.size();
        mosaic.raster = vrt.filled(mosaic.raster).map_err(FileError::at(path))?;
        mosaic.gaps += samples(&mosaic.raster) - u64::from(joined.0) * u64::from(joined.1);
    }
    Ok(mosaic)
}

/// The tiles that a path stands for.
#[derive(Clone)]
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
        if !vrt::is_vrt(&disk::file_name(path)) || options.raw.is_some() {
            return Ok(None);
        }
        let mut vrt =
            VrtTiles::read(&addressed::read(path, INPUT_BYTES.get())?).map_err(FileError::at(path))?;
        if is_address_path(path) {
            vrt.check_beside().map_err(FileError::at(path))?;
        }
        vrt.state_nodata(options.nodata);
        Ok(Some(Self { paths: vrt.paths(path), vrt: Some(vrt) }))
    }

    /// How the virtual raster takes a tile; `None` of one in a folder.
    fn source(&self, tile: usize) -> Option<&VrtSource> {
        self.vrt.as_ref().map(|vrt| &vrt.sources[tile])
    }

    /// The options for a tile: what the caller states of missing data counts, else what the virtual raster does.
    fn options(&self, tile: usize, options: &DemOptions) -> DemOptions {
        let nodata = options.nodata.or(self.source(tile).and_then(|source| source.nodata));
        DemOptions { nodata, ..options.clone() }
    }

    /// A tile in memory.
    fn open_whole(&self, tile: usize, options: &DemOptions) -> Result<Raster, OpenDemError> {
        let path = &self.paths[tile];
        let raster = open_file(path, &self.options(tile, options))?;
        match self.source(tile) {
            Some(source) => Ok(source.taken_from(raster).map_err(FileError::at(path))?),
            None => Ok(raster),
        }
    }

    /// A tile in windows; `None` where its format is read whole.
    fn open_windows(
        &self,
        tile: usize,
        options: &DemOptions,
    ) -> Result<Option<Box<dyn Windows + Send>>, OpenDemError> {
        let path = &self.paths[tile];
        match (self.source(tile), open_windows(path, &self.options(tile, options))?) {
            (Some(source), Some(windows)) => {
                Ok(Some(source.taken_windows(windows).map_err(FileError::at(path))?))
            }
            (_, windows) => Ok(windows),
        }
    }
}

/// The tiles in a folder, at least one, sorted by name.
fn tiles_in(folder: &Path) -> Result<Vec<PathBuf>, OpenDemError> {
    let mut tiles = disk::list_folder(folder)?;
    tiles.retain(|tile| read::is_tile_name(&disk::file_name(tile)));
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
    let tiles = TileFiles::of(path, options)?;
    let windows = match &tiles {
        Some(tiles) => open_mosaic(tiles, options).and_then(|windows| match (&tiles.vrt, windows) {
            (Some(vrt), Some(windows)) => Ok(Some(vrt.filled_windows(windows).map_err(FileError::at(path))?)),
            (_, windows) => Ok(windows),
        }),
        None => open_windows(path, options),
    };
    let fault = match windows {
        Ok(Some(windows)) if samples(&*windows) > most_kept => return Ok(OpenedDem::Windows(windows)),
        // What was fetched with the header is not fetched again.
        Ok(Some(windows))
            if tiles.is_none() && is_address_path(path) && samples(&*windows) <= RASTER_SAMPLES.get() =>
        {
            let whole = join([(path, whole(path, windows))].into_iter(), None)?;
            return Ok(OpenedDem::Kept(Box::new(whole)));
        }
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
    if path.is_dir() || vrt::is_vrt(&disk::file_name(path)) {
        return None;
    }
    open_windows(path, options).ok().flatten().filter(|windows| samples(&**windows) > most_kept)
}

/// All samples of windows in memory.
fn whole(path: &Path, mut windows: Box<dyn Windows + Send>) -> Result<Raster, OpenDemError> {
    let samples = windows.samples(RasterWindow::all(windows.size())).map_err(FileError::at(path))?;
    Ok(Raster { samples, ..windows.metadata().without_samples() })
}

fn samples(windows: &dyn Windows) -> u64 {
    let (width, height) = windows.size();
    u64::from(width) * u64::from(height)
}

/// The windows of the mosaic of tiles, opened by their headers; `None` where one has none.
fn open_mosaic(
    tiles: &TileFiles,
    options: &DemOptions,
) -> Result<Option<Box<dyn Windows + Send>>, OpenDemError> {
    let mut headers = Vec::new();
    for (index, path) in tiles.paths.iter().enumerate() {
        let Some(tile) = tiles.open_windows(index, options)? else { return Ok(None) };
        headers.push((disk::file_name(path), tile.metadata().without_samples()));
    }
    let (tiles, options) = (tiles.clone(), options.clone());
    let opener = move |index: usize| match tiles.open_windows(index, &options) {
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
    let (head, content) = addressed::open(path)?;
    let companions = addressed::companions(path, COMPANION_BYTES.get());
    let hints = DemHints { companions: &|name| companions.get(name), ..options.clone().into() };
    let windows = read::open_windows(&disk::file_name(path), &head, content, &hints, WINDOW_CACHE_BYTES);
    companions.check()?;
    Ok(windows.map_err(|error| FileError::<DemErrorKind>::new(path, error.kind))?)
}

/// Joins the elevation files at `paths`, tiles of one raster; of samples that tiles share the first tile's is kept. Tiles whose
/// cells do not nest are resampled to the stated `cell`, if any.
///
/// # Errors
/// See [`OpenDemError`].
pub fn open_tiles<P: AsRef<Path>>(paths: &[P], options: &DemOptions) -> Result<Mosaic, OpenDemError> {
    join(paths.iter().map(|path| (path, open_file(path.as_ref(), options))), options.cell)
}

/// Joins tiles, each opened when the ones before it are, in cells of `cell` where they do not fit.
fn join<P: AsRef<Path>>(
    opened: impl Iterator<Item = (P, Result<Raster, OpenDemError>)>,
    cell: Option<f64>,
) -> Result<Mosaic, OpenDemError> {
    let mut tiles = Tiles::default();
    for (path, raster) in opened {
        tiles.push(disk::file_name(path.as_ref()), raster?)?;
    }
    Ok(tiles.join_in_cells(cell)?)
}

/// The name of the format of an elevation file, by its head; `None` where it seems to be no elevation or cannot be read.
pub fn format_by_head(path: &Path, options: &DemOptions) -> Option<&'static str> {
    let head = disk::read_head(path, read::HEAD_BYTES).ok()?;
    let hints = DemHints { companions: &disk::beside(path), ..options.clone().into() };
    read::format_by_head(&disk::file_name(path), &head, &hints)
}

fn open_file(path: &Path, options: &DemOptions) -> Result<Raster, OpenDemError> {
    let bytes = addressed::read(path, INPUT_BYTES.get())?;
    let companions = addressed::companions(path, COMPANION_BYTES.get());
    let hints = DemHints { companions: &|name| companions.get(name), ..options.clone().into() };
    let raster = read::read(&disk::file_name(path), &bytes, &hints);
    companions.check()?;
    Ok(raster.map_err(|error| FileError::<DemErrorKind>::new(path, error.kind))?)
}

/// A warning for the user where the tiles at `path` contradict each other, or the unit of their elevations is taken for
/// granted.
pub fn warning(path: &Path, mosaic: &Mosaic) -> Option<String> {
    let differing = (mosaic.differing > 0).then(|| mosaic.note());
    let notes: Vec<String> = differing.into_iter().chain(unstated_unit::note(&mosaic.raster)).collect();
    (!notes.is_empty()).then(|| format!("{}: {}", path.display(), notes.join("; ")))
}

/// What reading the file at `path` left out or guessed, a sentence each for the user.
pub fn reading_notes(path: &Path, raster: &Raster) -> Vec<String> {
    raster.notes.iter().map(|note| format!("{}: {note}", path.display())).collect()
}

/// The same as [`warning`] of a file that is read where queries need it; `raster` may lack its samples.
pub fn header_warning(path: &Path, raster: &Raster) -> Option<String> {
    unstated_unit::note(raster).map(|note| format!("{}: {note}", path.display()))
}
