//! The kinds `fill` and `flow` on land larger than the memory: the bits that `kinds` gives, band by band.

use std::ops::Range;

use glam::DVec2;
use rayon::prelude::*;

use super::band_fill::BandFill;
use super::band_flats::BandFlats;
use super::band_flow::BandFlow;
use super::bands::{BandArray, BandStore, LandBands};
use super::kinds::{DepressionRow, depression_figures, drained_area};
use crate::arguments::AnalysisArguments;
use crate::outcome::{Figure, PostValues};
use sandtable_terrain::stop_flag::StopFlag;

/// What is known of land in bands.
enum BandedWork {
    /// Its depressions: their depths, or the ground without them.
    Fill { fill: BandFill, shows_depth: bool },
    /// Where water flows: drained areas, or directions.
    Flow { flow: BandFlow, shows_area: bool },
}

/// `fill` or `flow` on land that is kept in a [`BandStore`], ready to give the values of each band.
pub struct BandedWater {
    bands: LandBands,
    cell_m2: f64,
    work: BandedWork,
    /// What is filled of each row, once its band was asked for.
    filled: Vec<DepressionRow>,
}

impl BandedWater {
    /// Whether an analysis is one that can be made in bands: `fill`, or `flow` in eight directions, with depressions filled.
    pub fn makes(arguments: &AnalysisArguments) -> bool {
        let fills = || arguments.word("depressions") == "fill";
        match arguments.kind().name {
            "fill" => fills(),
            "flow" => fills() && arguments.word("method") == "d8",
            _ => false,
        }
    }

    /// The bytes that a store of so many posts keeps.
    pub fn kept_bytes(arguments: &AnalysisArguments, posts: u64) -> u64 {
        let each = if arguments.kind().name == "fill" {
            BandArray::Toward.before()
        } else {
            BandArray::Codes.before() + BandArray::Codes.bytes()
        };
        posts * each
    }

    /// Prepares an analysis that [`BandedWater::makes`] of land of so many columns and rows, `cell` apart in meters.
    ///
    /// # Errors
    /// Those of the store; [`AnalysisError::Memory`](crate::error::AnalysisError::Memory) and
    /// [`AnalysisError::Stopped`](crate::error::AnalysisError::Stopped).
    pub fn new<S: BandStore>(
        arguments: &AnalysisArguments,
        (cell, columns, rows): (DVec2, usize, usize),
        store: &mut S,
        stop: &StopFlag,
    ) -> Result<Self, S::Error> {
        Self::of_bands(arguments, (cell, LandBands::new(columns, rows)), store, stop)
    }

    /// [`BandedWater::new`] with other bands.
    pub(super) fn of_bands<S: BandStore>(
        arguments: &AnalysisArguments,
        (cell, bands): (DVec2, LandBands),
        store: &mut S,
        stop: &StopFlag,
    ) -> Result<Self, S::Error> {
        let fill = BandFill::new(&bands, store, stop)?;
        let show = arguments.word("show");
        let work = if arguments.kind().name == "fill" {
            BandedWork::Fill { fill, shows_depth: show != "filled" }
        } else {
            let flats = BandFlats::new(&bands, (&fill, cell), store, stop)?;
            let flow = BandFlow::new(&bands, &flats, store, stop)?;
            BandedWork::Flow { flow, shows_area: show != "direction" }
        };
        let filled = vec![DepressionRow::default(); bands.rows];
        Ok(Self { bands, cell_m2: cell.x * cell.y, work, filled })
    }

    /// The rows of a band but the southernmost, which has up to twice as many; bands end where such from the north do.
    pub fn band_rows(&self) -> usize {
        self.bands.band_rows()
    }

    /// The rows of the band that a row lies in, and the values of their posts.
    ///
    /// # Errors
    /// Those of the store.
    pub fn band_of_row<S: BandStore>(
        &mut self,
        row: usize,
        store: &mut S,
    ) -> Result<(Range<usize>, PostValues), S::Error> {
        let (bands, band) = (&self.bands, self.bands.band_of(row));
        let rows = bands.rows_of(band);
        let values = match &self.work {
            BandedWork::Fill { fill, shows_depth } => {
                let mut filled = fill.filled(bands, store, rows.clone(), rows.start)?;
                let heights = store.heights(rows.clone())?;
                let of_row = |(filled, heights): (&mut [f32], &[f32])| {
                    let row = DepressionRow::of(filled, heights);
                    if *shows_depth {
                        filled.iter_mut().zip(heights).for_each(|(filled, height)| *filled -= height);
                    }
                    row
                };
                let columns = bands.columns;
                let told: Vec<DepressionRow> =
                    filled.par_chunks_mut(columns).zip(heights.par_chunks(columns)).map(of_row).collect();
                self.filled[rows.clone()].copy_from_slice(&told);
                PostValues::Numbers(filled)
            }
            BandedWork::Flow { shows_area: false, .. } => {
                PostValues::Codes(bands.read(store, BandArray::Codes, rows.clone())?)
            }
            BandedWork::Flow { flow, .. } => {
                let counts = flow.counts(bands, band, store)?;
                let area = |posts: u32| drained_area(f64::from(posts), self.cell_m2);
                PostValues::Numbers(counts.into_par_iter().with_min_len(1 << 14).map(area).collect())
            }
        };
        Ok((rows, values))
    }

    /// The figures of all bands that were asked for.
    pub fn figures(&self) -> Vec<Figure> {
        match self.work {
            BandedWork::Fill { .. } => depression_figures(&self.filled, self.cell_m2),
            BandedWork::Flow { .. } => Vec::new(),
        }
    }
}
