//! One tile of a virtual raster: which of its samples are taken, and where they go.
//!
//! ```text
//!   SrcRect in the tile          DstRect in the virtual raster, in whole samples
//!   ┌─────────────┐              ┌───────────┐
//!   │  ┌───────┐  │              │   ┌───┐   │   The middle of each sample of the target lies in one sample
//!   │  │       │  │    ──────►   │   │ · │   │   of the tile, and that one is taken: GDAL's nearest sample,
//!   │  └───────┘  │              │   └───┘   │   by which virtual rasters are read where they name no other.
//!   └─────────────┘              └───────────┘
//! ```
//!
//! What reaches beyond the virtual raster is cut off. Where a tile with overviews is made coarser, GDAL takes its samples of one
//! of these; here they are always the tile's own. Source: GDAL, `VRTSimpleSource` and `GDALRasterBand::IRasterIO`.

use glam::{DAffine2, DVec2};

use crate::vrt_fault::{PLACE, broken, shortened, unsupported};
use sandtable_base::limits::RASTER_SAMPLES;
use sandtable_raster::error::DemErrorKind;
use sandtable_raster::raster::{Raster, Samples};
use sandtable_raster::windows::{RasterWindow, Windows};

/// How far, in samples, a middle may lie before a border and still count as beyond it: GDAL's.
const TIE: f64 = 1e-10;

/// A tile of a virtual raster.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct VrtSource {
    /// Its file, `/` between folders, relative to the virtual raster's or absolute.
    pub file: String,
    /// The value that means no data in the tile, as the virtual raster states it.
    pub nodata: Option<f64>,
    /// A second one: that of the virtual raster, where the tile has another.
    pub also_nodata: Option<f64>,
    /// Columns and rows that are taken; `None` for the whole tile.
    taken: Option<[TakenSamples; 2]>,
}

/// A rectangle of a source: `xOff`, `yOff`, `xSize`, `ySize`.
pub(super) type VrtRect = [f64; 4];

/// Columns, or rows, of a tile that are taken: the middle of the one with number `i` lies `first + (i + ½) × step` samples into
/// the tile.
#[derive(Clone, Copy, Debug, PartialEq)]
struct TakenSamples {
    first: f64,
    step: f64,
    count: u32,
    /// Where the rectangle in the tile ends.
    end: f64,
}

impl TakenSamples {
    /// Of `from` its offset and size in the tile, of `to` those in a virtual raster of `all` samples; `None` where it lies
    /// beyond that.
    fn new(from: [f64; 2], to: [f64; 2], all: u32) -> Result<Option<Self>, DemErrorKind> {
        let [start, size] = to.map(f64::round);
        if (to[0] - start).abs() > PLACE || (to[1] - size).abs() > PLACE {
            return Err(unsupported("a tile between its samples".to_owned()));
        }
        if !(size >= 1.0 && from[1] > 0.0 && from[0] > -PLACE) {
            return Err(broken("a rectangle holds no samples".to_owned()));
        }
        let (cut, end) = ((-start).max(0.0), (start + size).min(f64::from(all)));
        let count = end - start - cut;
        if count < 1.0 {
            return Ok(None);
        }
        let is_scaled = (from[1] - to[1]).abs() > PLACE;
        let step = if is_scaled { from[1] / size } else { 1.0 };
        let whole = from[0].round();
        // GDAL writes offsets that it has computed.
        let offset = if (from[0] - whole).abs() > PLACE { from[0] } else { whole };
        let end = from[0] + from[1];
        Ok(Some(Self { first: offset + cut * step, step, count: count as u32, end }))
    }

    fn is_shifted(&self) -> bool {
        self.step == 1.0
    }

    /// The sample of a tile of `size` that is taken as the one with number `at`.
    fn sample(&self, at: u32, size: u32) -> u32 {
        let middle = self.first + (f64::from(at) + 0.5) * self.step + TIE;
        (middle.floor().max(0.0) as u32).min(size - 1)
    }

    fn is_all_of(&self, size: u32) -> bool {
        *self == Self { first: 0.0, step: 1.0, count: size, end: self.end }
    }
}

impl VrtSource {
    /// States the rectangle of the tile and that of the virtual raster of `size`; says whether any of it lies there.
    ///
    /// # Errors
    /// The rectangles are broken, or the tile does not begin and end between samples of the virtual raster.
    pub(super) fn place(
        &mut self,
        from: VrtRect,
        to: VrtRect,
        size: (u32, u32),
    ) -> Result<bool, DemErrorKind> {
        let columns = TakenSamples::new([from[0], from[2]], [to[0], to[2]], size.0)?;
        let rows = TakenSamples::new([from[1], from[3]], [to[1], to[3]], size.1)?;
        self.taken = columns.zip(rows).map(|(columns, rows)| [columns, rows]);
        Ok(self.taken.is_some())
    }

    /// The columns and rows that are taken of a tile; `None` for all of them, as they are.
    ///
    /// # Errors
    /// The tile has fewer than are taken.
    fn taken_of(&self, (width, height): (u32, u32)) -> Result<Option<[TakenSamples; 2]>, DemErrorKind> {
        let Some([columns, rows]) = self.taken else { return Ok(None) };
        if columns.end > f64::from(width) + PLACE || rows.end > f64::from(height) + PLACE {
            let (file, [across, down]) = (shortened(&self.file), [columns.end, rows.end]);
            return Err(broken(format!(
                "it takes samples up to column {across} and row {down} of '{file}', which has {width} x {height}"
            )));
        }
        Ok((!(columns.is_all_of(width) && rows.is_all_of(height))).then_some([columns, rows]))
    }

    /// The samples of a tile as the virtual raster has them, in their place.
    ///
    /// # Errors
    /// The tile has fewer samples than are taken, or more are made of them than a raster has.
    pub fn taken_from(&self, tile: Raster) -> Result<Raster, DemErrorKind> {
        if self.taken_of(tile.size())?.is_none() && self.also_nodata.is_none() {
            return Ok(tile);
        }
        let mut windows = SourceWindows::new(Box::new(tile), self.clone())?;
        let (width, height) = windows.size();
        if u64::from(width) * u64::from(height) > RASTER_SAMPLES.get() {
            let file = shortened(&self.file);
            return Err(broken(format!(
                "it makes {width} x {height} samples of '{file}', more than the {RASTER_SAMPLES} of a raster"
            )));
        }
        let samples = windows.samples(RasterWindow::all((width, height)))?;
        Ok(Raster { samples, ..windows.header })
    }

    /// The samples of a tile as the virtual raster has them, of a tile that is read in windows.
    ///
    /// # Errors
    /// The tile has fewer samples than are taken.
    pub fn taken_windows(
        &self,
        tile: Box<dyn Windows + Send>,
    ) -> Result<Box<dyn Windows + Send>, DemErrorKind> {
        if self.taken_of(tile.size())?.is_none() && self.also_nodata.is_none() {
            return Ok(tile);
        }
        Ok(Box::new(SourceWindows::new(tile, self.clone())?))
    }
}

/// The samples of a tile that a virtual raster takes, in their place.
struct SourceWindows {
    tile: Box<dyn Windows + Send>,
    source: VrtSource,
    taken: Option<[TakenSamples; 2]>,
    header: Raster,
}

impl SourceWindows {
    fn new(tile: Box<dyn Windows + Send>, source: VrtSource) -> Result<Self, DemErrorKind> {
        let whole = tile.metadata();
        let taken = source.taken_of(tile.size())?;
        let mut header = whole.without_samples();
        if let Some([columns, rows]) = taken {
            let tile_from_taken = DAffine2 {
                matrix2: glam::DMat2::from_diagonal(DVec2::new(columns.step, rows.step)),
                translation: DVec2::new(columns.first, rows.first),
            };
            header.map_from_grid = whole.map_from_grid * tile_from_taken;
            (header.width, header.height) = (columns.count, rows.count);
        }
        Ok(Self { tile, source, taken, header })
    }

    /// The samples of a window row by row, each of the row of the tile that its middle lies in.
    fn nearest(
        &mut self,
        [columns, rows]: [TakenSamples; 2],
        window: RasterWindow,
    ) -> Result<Samples, DemErrorKind> {
        let (width, height) = self.tile.size();
        let across: Vec<u32> =
            (0..window.width).map(|at| columns.sample(window.column + at, width)).collect();
        let (Some(&west), Some(&east)) = (across.first(), across.last()) else {
            return Ok(Samples::absent(0, self.header.samples.is_wide()));
        };
        let mut out = Samples::absent(window.samples(), self.header.samples.is_wide());
        let mut line: Option<(u32, Samples)> = None;
        for at in 0..window.height {
            let row = rows.sample(window.row + at, height);
            let held = match line.take().filter(|(held, _)| *held == row) {
                Some(held) => held,
                None => {
                    let line = RasterWindow { column: west, row, width: east - west + 1, height: 1 };
                    (row, self.tile.samples(line)?)
                }
            };
            let start = at as usize * window.width as usize;
            for (index, column) in across.iter().enumerate() {
                out.set(start + index, held.1.get((column - west) as usize));
            }
            line = Some(held);
        }
        Ok(out)
    }
}

impl Windows for SourceWindows {
    fn metadata(&self) -> &Raster {
        &self.header
    }

    fn samples(&mut self, window: RasterWindow) -> Result<Samples, DemErrorKind> {
        window.assert_within(self.size());
        let mut samples = match self.taken {
            None => self.tile.samples(window)?,
            Some([columns, rows]) if columns.is_shifted() && rows.is_shifted() => {
                let (width, height) = self.tile.size();
                let (column, row) = (columns.sample(window.column, width), rows.sample(window.row, height));
                self.tile.samples(RasterWindow { column, row, ..window })?
            }
            Some(taken) => self.nearest(taken, window)?,
        };
        self.source.also_nodata.iter().for_each(|&value| samples.clear(value));
        Ok(samples)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::small_raster::small;

    fn placed(from: VrtRect, to: VrtRect, size: (u32, u32)) -> Result<Option<VrtSource>, DemErrorKind> {
        let mut source = VrtSource { file: "a.tif".into(), ..VrtSource::default() };
        source.place(from, to, size).map(|is_there| is_there.then_some(source))
    }

    fn values(raster: &Raster) -> Vec<f64> {
        raster.samples.iter().collect()
    }

    #[test]
    fn a_part_of_a_tile_keeps_its_place_and_what_lies_beyond_is_cut_off() {
        let tile = small(3, 3, (0..9u8).map(f32::from).collect());
        let source = placed([1.0, 0.0, 2.0, 3.0], [-1.0, 0.0, 2.0, 3.0], (4, 2)).expect("sound");
        let part = source.expect("there").taken_from(tile.clone()).expect("inside");
        assert_eq!((part.size(), values(&part)), ((1, 2), vec![2.0, 5.0]));
        let corner = tile.map_from_grid.transform_point2(DVec2::new(2.0, 0.0));
        assert_eq!(part.map_from_grid.transform_point2(DVec2::ZERO), corner);
        assert_eq!(placed([0.0, 0.0, 3.0, 3.0], [4.0, 0.0, 3.0, 3.0], (4, 2)).expect("sound"), None);
        let source = placed([0.0, 0.0, 4.0, 3.0], [0.0, 0.0, 4.0, 3.0], (4, 3)).expect("sound");
        let error = source.expect("there").taken_from(tile).expect_err("too few columns").to_string();
        assert!(error.contains("column 4") && error.contains("3 x 3"), "{error}");
    }

    #[test]
    fn samples_of_another_size_are_the_ones_that_middles_lie_in() {
        let tile = small(4, 2, (0..8u8).map(f32::from).collect());
        let taken = |from, to, size| {
            let source = placed(from, to, size).expect("sound").expect("there");
            source.taken_from(tile.clone()).expect("inside")
        };
        let finer = taken([0.0, 0.0, 4.0, 2.0], [0.0, 0.0, 6.0, 2.0], (6, 2));
        assert_eq!(values(&finer)[..6], [0.0, 1.0, 1.0, 2.0, 3.0, 3.0]);
        // The middle of two samples is the beginning of the second.
        let coarser = taken([0.0, 0.0, 4.0, 2.0], [0.0, 0.0, 2.0, 1.0], (2, 1));
        assert_eq!((values(&coarser), coarser.spacing()), (vec![5.0, 7.0], tile.spacing() * 2.0));
        let shifted = taken([0.5, 0.0, 3.0, 2.0], [0.0, 0.0, 3.0, 2.0], (3, 2));
        assert_eq!(values(&shifted)[..3], [1.0, 2.0, 3.0]);
    }

    #[test]
    fn two_values_may_mean_no_data() {
        let source = VrtSource { also_nodata: Some(3.0), ..VrtSource::default() };
        let tile = source.taken_from(small(2, 2, vec![1.0, 3.0, 3.0, 4.0])).expect("whole");
        assert!(tile.at(1, 0).is_nan() && tile.at(0, 1).is_nan() && tile.at(1, 1) == 4.0);
    }

    #[test]
    fn a_tile_that_lies_between_samples_is_refused() {
        let half = placed([0.0, 0.0, 2.0, 2.0], [0.5, 0.0, 2.0, 2.0], (4, 2)).expect_err("half a sample off");
        assert!(half.to_string().contains("between its samples"), "{half}");
        for broken in [[0.0, 0.0, 0.0, 2.0], [-1.0, 0.0, 2.0, 2.0], [0.0, 0.0, 2.0, -2.0]] {
            assert!(placed(broken, [0.0, 0.0, 2.0, 2.0], (4, 2)).is_err(), "{broken:?}");
        }
    }
}
