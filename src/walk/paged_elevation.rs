//! Elevation files that are larger than a window holds in memory: read in windows, with an overview that is held.

use std::fs::File;
use std::io;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use sandtable_base::limits::RASTER_SAMPLES;
use sandtable_dem::hints::DemHints;
use sandtable_dem::tiff::windows::GeoTiffWindows;
use sandtable_files::disk;
use sandtable_files::error::FileError;
use sandtable_raster::error::DemErrorKind;
use sandtable_raster::raster::{Raster, Samples};
use sandtable_raster::reduced::reduced_by_overview;
use sandtable_raster::warp;
use sandtable_raster::windows::{RasterWindow, Windows};
use sandtable_roam::layout::DEFAULT_PATCH;
use sandtable_roam::paging::ground::{PagingError, finest_that_fits};
use sandtable_terrain::lattice::Lattice;

/// The most cells along the overview's longer side: it is a scene of its own, which opens in a second or two.
const OVERVIEW_CELLS: u32 = 1024;

/// Bytes of decoded blocks that are kept of the terrain: a row of tiles of 256 samples across the widest image that has few
/// enough patches.
const TERRAIN_CACHE: usize = 72 << 20;

/// The same for questions, which are local.
const QUESTION_CACHE: usize = 16 << 20;

/// Why a large file cannot be shown.
#[derive(Debug, thiserror::Error)]
pub enum PagedElevationError {
    /// Its samples cannot be read.
    #[error(transparent)]
    Samples(#[from] FileError<DemErrorKind>),
    /// It has too many patches.
    #[error(transparent)]
    Paging(#[from] Box<FileError<PagingError>>),
}

/// A file in windows.
pub type ElevationWindows = WatchedWindows<GeoTiffWindows<File>>;

/// A large elevation file.
pub struct PagedElevation {
    /// The terrain, which is refined.
    pub terrain: ElevationWindows,
    /// The same terrain, for height queries.
    pub questions: ElevationWindows,
    /// The same terrain, for the light on the ground near the eye.
    pub near: ElevationWindows,
    /// All of it, its samples further apart: the south-west one lies where it does in the terrain.
    pub overview: Arc<Raster>,
}

/// Counts the samples that are read, and can stop the reading.
#[derive(Debug, Default)]
pub struct ReadingWatch {
    samples: AtomicU64,
    is_stopped: AtomicBool,
}

/// Windows whose reading is counted and can be stopped.
pub struct WatchedWindows<W> {
    windows: W,
    watch: Arc<ReadingWatch>,
}

impl ReadingWatch {
    /// Samples read so far, each as often as it was.
    pub fn samples(&self) -> u64 {
        self.samples.load(Ordering::Relaxed)
    }

    /// Makes all further reading fail.
    pub fn stop(&self) {
        self.is_stopped.store(true, Ordering::Relaxed);
    }
}

impl<W> WatchedWindows<W> {
    /// The watch over `windows`.
    pub fn new(windows: W) -> Self {
        Self { windows, watch: Arc::default() }
    }

    /// A handle for another thread that counts the samples read.
    pub fn watch(&self) -> &Arc<ReadingWatch> {
        &self.watch
    }
}

impl<W: Windows> Windows for WatchedWindows<W> {
    fn metadata(&self) -> &Raster {
        self.windows.metadata()
    }

    fn samples(&mut self, window: RasterWindow) -> Result<Samples, DemErrorKind> {
        if self.watch.is_stopped.load(Ordering::Relaxed) {
            let source = Box::new(io::Error::from(io::ErrorKind::Interrupted));
            return Err(DemErrorKind::Undecodable { format: self.windows.metadata().driver, source });
        }
        let samples = self.windows.samples(window)?;
        self.watch.samples.fetch_add(window.samples() as u64, Ordering::Relaxed);
        Ok(samples)
    }

    fn announce(&mut self, windows: &[RasterWindow]) {
        self.windows.announce(windows);
    }

    fn overview(&self, step: u32) -> Option<(u32, Box<dyn Windows + Send + '_>)> {
        let (times, windows) = self.windows.overview(step)?;
        Some((times, Box::new(WatchedWindows { windows, watch: Arc::clone(&self.watch) })))
    }
}

impl PagedElevation {
    /// Opens the file at `path` where it is a GeoTIFF in meters of more than `most_samples`, and makes its overview: of one
    /// that the file holds, or else of all its samples; `None` of others, which are held in memory or refused by their reader.
    ///
    /// # Errors
    /// See [`PagedElevationError`].
    pub fn open(path: &Path, most_samples: u64) -> Result<Option<Self>, PagedElevationError> {
        let Some(first) = windows(path, TERRAIN_CACHE) else { return Ok(None) };
        let (columns, rows) = first.size();
        let samples = u64::from(columns) * u64::from(rows);
        let metadata = first.metadata();
        if samples <= most_samples || Lattice::frame(metadata).is_err() {
            return Ok(None);
        }
        let paging = |error: PagingError| Box::new(FileError::<PagingError>::new(path, error));
        match warp::check_metric(metadata) {
            // What fits is resampled in memory.
            Err(_) if samples <= RASTER_SAMPLES.get() => return Ok(None),
            Err(error) => return Err(paging(PagingError::NotMetric(error)).into()),
            Ok(()) => {}
        }
        let fitting = |file| finest_that_fits(file, DEFAULT_PATCH).map_err(paging).map(WatchedWindows::new);
        let mut terrain = fitting(first)?;
        let (second, third) = (windows(path, QUESTION_CACHE), windows(path, TERRAIN_CACHE));
        let Some((second, third)) = second.zip(third) else { return Ok(None) };
        let (questions, near) = (fitting(second)?, fitting(third)?);
        let (columns, rows) = terrain.size();
        let step = (columns.max(rows) - 1).div_ceil(OVERVIEW_CELLS).next_power_of_two();
        let overview =
            reduced_by_overview(&mut terrain, step).map_err(FileError::<DemErrorKind>::at(path))?;
        Ok(Some(Self { terrain, questions, near, overview: Arc::new(overview) }))
    }
}

/// A GeoTIFF in windows; `None` of what is not one, or cannot be read so.
fn windows(path: &Path, cache_bytes: usize) -> Option<GeoTiffWindows<File>> {
    if path.is_dir() {
        return None;
    }
    // What cannot be opened is said by the reader of whole files.
    let file = File::open(path).ok()?;
    let companions = disk::beside(path);
    let hints = DemHints { companions: &companions, ..DemHints::default() };
    GeoTiffWindows::open(&disk::file_name(path), file, &hints, cache_bytes).ok()
}
