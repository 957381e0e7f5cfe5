//! Depressions and flow of elevation that stays on disk: bands of rows are read, and what is known of their posts meanwhile lies in
//! a file without a name.

use std::ops::Range;

use glam::DVec2;

use crate::analysis::AnalyzeError;
use crate::dataset::Dataset;
use crate::windowed_elevation::WindowedElevation;
use sandtable_analysis::arguments::AnalysisArguments;
use sandtable_analysis::outcome::{Figure, PostValues};
use sandtable_analysis::water::banded::BandedWater;
use sandtable_analysis::water::bands::{BandArray, BandStore};
use sandtable_files::scratch_file::ScratchFile;
use sandtable_terrain::lattice::Post;
use sandtable_terrain::post_rect::PostRect;
use sandtable_terrain::stop_flag::StopFlag;

/// The most posts that such an analysis keeps in memory: at some 14 bytes a post half a gigabyte. Beyond, it is made in bands.
pub(crate) const MOST_IN_MEMORY: u64 = 1 << 25;

/// The values of posts of elevation on disk, band by band.
pub(crate) struct WaterBands<'a> {
    store: ElevationStore<'a>,
    water: BandedWater,
    /// The rows of the band that was asked for last, from the south, and its values.
    last: Option<(Range<usize>, PostValues)>,
}

/// Elevation on disk, and a file beside it.
struct ElevationStore<'a> {
    dataset: &'a Dataset,
    elevation: &'a WindowedElevation,
    scratch: ScratchFile,
    size: (u32, u32),
}

impl<'a> WaterBands<'a> {
    /// Prepares an analysis that can be made in bands, of elevation of a size whose posts lie `cell` meters apart.
    ///
    /// # Errors
    /// The elevation cannot be read; there is no disk or memory for it; it was stopped.
    pub fn new(
        (dataset, elevation): (&'a Dataset, &'a WindowedElevation),
        arguments: &AnalysisArguments,
        (cell, size): (DVec2, (u32, u32)),
        stop: &StopFlag,
    ) -> Result<Self, AnalyzeError> {
        let posts = u64::from(size.0) * u64::from(size.1);
        let scratch = ScratchFile::create(BandedWater::kept_bytes(arguments, posts))?;
        let mut store = ElevationStore { dataset, elevation, scratch, size };
        let land = (cell, size.0 as usize, size.1 as usize);
        let water = BandedWater::new(arguments, land, &mut store, stop)?;
        Ok(Self { store, water, last: None })
    }

    /// The rows of the band that a row from the south lies in, and the values of their posts.
    ///
    /// # Errors
    /// As [`WaterBands::new`].
    pub fn band_of_row(&mut self, row: usize) -> Result<&(Range<usize>, PostValues), AnalyzeError> {
        let held = match self.last.take().filter(|(rows, _)| rows.contains(&row)) {
            Some(held) => held,
            None => self.water.band_of_row(row, &mut self.store)?,
        };
        Ok(self.last.insert(held))
    }

    /// How many rows from the north are best taken together.
    pub fn band_rows(&self) -> u32 {
        self.water.band_rows() as u32
    }

    /// The figures of all bands that were asked for.
    pub fn figures(&self) -> Vec<Figure> {
        self.water.figures()
    }
}

impl BandStore for ElevationStore<'_> {
    type Error = AnalyzeError;

    fn heights(&mut self, rows: Range<usize>) -> Result<Vec<f32>, AnalyzeError> {
        let posts = PostRect {
            first: Post { column: 0, row: rows.start as u32 },
            last: Post { column: self.size.0 - 1, row: rows.end as u32 - 1 },
        };
        let ground = self.elevation.ground_cut(posts);
        let ground = ground.map_err(|error| self.dataset.without_ground(error))?;
        Ok(ground.heights().to_vec())
    }

    fn read(&mut self, array: BandArray, at: u64, out: &mut [u8]) -> Result<(), AnalyzeError> {
        Ok(self.scratch.read(self.place(array) + at, out)?)
    }

    fn write(&mut self, array: BandArray, at: u64, bytes: &[u8]) -> Result<(), AnalyzeError> {
        Ok(self.scratch.write(self.place(array) + at, bytes)?)
    }
}

impl ElevationStore<'_> {
    /// Where an array begins in the file.
    fn place(&self, array: BandArray) -> u64 {
        array.before() * u64::from(self.size.0) * u64::from(self.size.1)
    }
}
