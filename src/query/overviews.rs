//! Smaller rasters of a dataset, for maps that show many of its samples in a pixel.
//!
//! ```text
//! level 0   at most 2²² samples: the raster itself, or the means over squares of `step` × `step` of its samples
//! level 1   the means over squares twice as wide, and so on, to a small picture
//! ```
//!
//! A file's own overviews are used where it has them; otherwise all of it is read once, window by window, while other
//! queries are answered.

use std::path::Path;
use std::sync::Arc;

use crate::dataset::{Dataset, QueryError};
use crate::windowed_elevation::WindowedElevation;
use sandtable_raster::error::DemErrorKind;
use sandtable_raster::raster::{Raster, Samples};
use sandtable_raster::reduced::{reduced, reduced_by_overview, reduced_size};
use sandtable_raster::stats::Stats;
use sandtable_raster::windows::{RasterWindow, Windows, window_samples};
use sandtable_remote::address::is_address_path;

/// The most samples of the finest level: 16 MB, and a third of that for the others.
const MOST_SAMPLES: u64 = 1 << 22;

/// A level of so few samples is the coarsest: the whole dataset is a small picture.
const FEW_SAMPLES: u64 = 1 << 14;

/// The levels of a dataset.
pub struct Overviews {
    /// How many samples of the dataset a sample of the finest level is wide.
    step: u32,
    /// The finest first; each has samples twice as wide as the one before.
    levels: Vec<Dataset>,
    range_m: (f32, f32),
}

impl Overviews {
    /// Reads the levels of `dataset`, as its elevation is read from its file: without the earthworks of a scene.
    ///
    /// # Errors
    /// [`QueryError::Read`]; [`QueryError::FarAway`] where all of a file behind an address would be read.
    pub fn new(dataset: &Dataset) -> Result<Self, QueryError> {
        let header = dataset.header();
        let samples = |step: u32| {
            let (width, height) = reduced_size((header.width, header.height), step);
            u64::from(width) * u64::from(height)
        };
        let steps = (0..31).map(|power| 1u32 << power);
        let step = steps.clone().find(|&step| samples(step) <= MOST_SAMPLES).unwrap_or(1 << 30);
        let finest = match dataset.windowed() {
            Some(elevation) => Arc::new(of_windows(dataset, elevation, step)?),
            None if step == 1 => Arc::clone(&header),
            None => Arc::new(reduced_by(dataset, &header, step)?),
        };
        let range = Stats::range_of_windows(&mut BorrowedRaster(&finest)).map_err(dataset.unreadable())?;
        let in_meters = |height: f64| (height * finest.meters_per_z) as f32;
        let (low, high) = (in_meters(range.0), in_meters(range.1));
        let range_m = if low <= high { (low, high) } else { (0.0, 0.0) };
        let mut levels = vec![Dataset::from_raster(dataset.name(), Arc::clone(&finest))];
        for finer in steps.filter(|&other| other >= step).take_while(|&finer| samples(finer) > FEW_SAMPLES) {
            // From the finest, not from the one before: the mean of an even number of samples lies beside the sample that it is
            // placed at, each time.
            let raster = reduced_by(dataset, &finest, 2 * (finer / step))?;
            levels.push(Dataset::from_raster(dataset.name(), Arc::new(raster)));
        }
        Ok(Self { step, levels, range_m })
    }

    /// How many samples of the dataset a sample of the finest level is wide.
    pub fn finest_step(&self) -> u32 {
        self.step
    }

    /// The coarsest level whose samples are no wider than `samples` of the dataset, or else the finest: a dataset of its own,
    /// which is queried for its source.
    pub fn no_coarser_than(&self, samples: f64) -> &Dataset {
        let is_fine = |index: &usize| f64::from(self.step) * (1u64 << *index) as f64 <= samples;
        let index = (0..self.levels.len()).take_while(is_fine).last().unwrap_or(0);
        &self.levels[index]
    }

    /// The lowest and the highest height of the finest level, meters; zeros where it has none.
    pub fn range_m(&self) -> (f32, f32) {
        self.range_m
    }
}

fn reduced_by(dataset: &Dataset, raster: &Raster, step: u32) -> Result<Raster, QueryError> {
    reduced(&mut BorrowedRaster(raster), step).map_err(dataset.unreadable())
}

/// The means over squares of samples that stay on disk.
fn of_windows(dataset: &Dataset, elevation: &WindowedElevation, step: u32) -> Result<Raster, QueryError> {
    let means = {
        let mut source = elevation.source();
        // Overviews are small: other queries wait no longer than for a large viewshed.
        let has_overview = source.overview(step / 2).is_some();
        has_overview.then(|| reduced_by_overview(&mut *source, step))
    };
    let means = match means {
        Some(means) => means,
        None if is_address_path(Path::new(dataset.name())) => {
            return Err(QueryError::FarAway { dataset: dataset.name().to_owned() });
        }
        None => reduced(&mut SharedWindows(elevation), step),
    };
    means.map_err(dataset.unreadable())
}

/// A raster in memory that others read, too.
struct BorrowedRaster<'a>(&'a Raster);

impl Windows for BorrowedRaster<'_> {
    fn metadata(&self) -> &Raster {
        self.0
    }

    fn samples(&mut self, window: RasterWindow) -> Result<Samples, DemErrorKind> {
        window.assert_within(self.size());
        Ok(window_samples(self.0, RasterWindow::all(self.size()), window))
    }
}

/// Samples on disk; other queries are answered between two windows.
struct SharedWindows<'a>(&'a WindowedElevation);

impl Windows for SharedWindows<'_> {
    fn metadata(&self) -> &Raster {
        self.0.header()
    }

    fn samples(&mut self, window: RasterWindow) -> Result<Samples, DemErrorKind> {
        self.0.source().samples(window)
    }
}

#[cfg(test)]
mod tests {
    use glam::{DAffine2, DVec2};

    use super::*;
    use sandtable_geom::crs::Crs;
    use sandtable_terrain::query::{Interpolation, Surface};

    /// A plane of 3,000 × 2,000 samples that rises by a meter a sample to the east.
    fn plane() -> Raster {
        let heights = (0..3000 * 2000).map(|index| (index % 3000) as f32).collect();
        let frame =
            DAffine2::from_scale_angle_translation(DVec2::new(10.0, -10.0), 0.0, DVec2::new(5e5, 5e6));
        Raster::new(3000, Samples::F32(heights)).placed(frame)
    }

    fn check(dataset: &Dataset) {
        let overviews = Overviews::new(dataset).expect("readable");
        assert_eq!(overviews.finest_step(), 2, "six million samples are too many");
        assert_eq!(overviews.levels.len(), 5, "1500, 750, 375, 188, 94 samples wide");
        assert_eq!(overviews.range_m(), (0.0, 2997.5));
        let at = [DVec2::new(5e5 + 10_005.0, 5e6 - 9_000.0)];
        for samples in [0.5, 2.0, 3.9, 4.0, 9.0, 16.0, 1e9] {
            let level = overviews.no_coarser_than(samples);
            let wide = level.header().spacing().x / 10.0;
            assert!(wide == 2.0 || wide <= samples, "{wide} of {samples}");
            assert!(2.0 * wide > samples.min(33.0), "{wide} of {samples}");
            let heights =
                level.heights(Surface::Source, Interpolation::Bilinear, &Crs::local(), &at).expect("heights");
            // Half a sample of the raster, and half a sample of the finest level.
            let height = heights[0].height_m().expect("inside");
            assert!((height - 1000.0).abs() <= 1.6, "{height}");
        }
    }

    #[test]
    fn levels_of_a_raster_in_memory_are_means_of_its_samples() {
        check(&Dataset::from_raster("plane", Arc::new(plane())));
    }

    #[test]
    fn levels_of_a_file_on_disk_are_those_in_memory() {
        let elevation = WindowedElevation::new(Box::new(plane()));
        check(&Dataset::from_windows("plane", elevation));
        let far =
            Dataset::from_windows("https://example.org/a.tif", WindowedElevation::new(Box::new(plane())));
        assert!(matches!(Overviews::new(&far), Err(QueryError::FarAway { .. })));
    }
}
