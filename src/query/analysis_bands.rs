//! Rasters of analyses: in memory, or made band by band while a file is written, so that elevation larger than the memory can
//! be analyzed.
//!
//! ```text
//!  elevation file                       a band of rows and, on both sides, as many more as the kind reaches
//!  ┌────────────┐   ┌────────────┐
//!  │····halo····│   │            │      read ─► analyzed on its own ─► the rows of the band ─► written
//!  ├────────────┤ ─►├────────────┤
//!  │    band    │   │    band    │      A value depends on no post farther away, so that the file has the bytes of one
//!  ├────────────┤   ├────────────┤      that is written from the whole.
//!  │····halo····│   │            │
//!  └────────────┘   └────────────┘
//! ```
//!
//! Depressions and flow depend on all of the land; `water_bands` makes them.

use std::hint::black_box;
use std::ops::Range;
use std::sync::Arc;

use glam::DVec2;
use rayon::prelude::*;

use crate::analysis::{AnalyzeError, WrittenArgument, read};
use crate::dataset::Dataset;
use crate::ground::GroundError;
use crate::post_raster::{node_header, part_header};
use crate::water_bands::{MOST_IN_MEMORY, WaterBands};
use crate::windowed_elevation::WindowedElevation;
use sandtable_analysis::arguments::AnalysisArguments;
use sandtable_analysis::land::Land;
use sandtable_analysis::outcome::{Outcome, OutcomeRaster, PostValues, ValueClass};
use sandtable_analysis::run::run;
use sandtable_analysis::water::banded::BandedWater;
use sandtable_catalog::kind::{AnalysisKind, AnalysisYield};
use sandtable_catalog::parameter::EXTENT;
use sandtable_geom::crs::Crs;
use sandtable_raster::error::DemErrorKind;
use sandtable_raster::raster::{Raster, Samples};
use sandtable_raster::windows::{RasterWindow, Windows};
use sandtable_terrain::lattice::{Lattice, Post};
use sandtable_terrain::post_rect::PostRect;
use sandtable_terrain::stop_flag::StopFlag;

/// Posts of a band for each thread: what threads share is large enough to be worth sharing, and caches hold it.
const THREAD_POSTS: usize = 1 << 17;

/// The most posts of a band, whatever the number of threads.
const BAND_POSTS: usize = 1 << 20;

/// Rows of a band for each row of its halo: those are analyzed twice.
const ROWS_PER_HALO: u32 = 32;

/// The most posts of a band with its halo. A post takes some 25 bytes while two bands are at work, so these are 400 MB.
const MOST_POSTS: u32 = 1 << 24;

/// The raster of an analysis, computed where it is read.
pub struct AnalysisBands<'a> {
    elevation: &'a WindowedElevation,
    arguments: AnalysisArguments,
    reach: u32,
    /// Of a kind of water, whose values depend on all of the land.
    water: Option<WaterBands<'a>>,
    crs: Crs,
    header: Raster,
    stop: &'a StopFlag,
    /// What the analysis says besides its raster.
    outcome: Outcome,
    /// How a picture divides the values; empty where that depends on all of them.
    classes: Vec<ValueClass>,
    /// Why a band could not be analyzed.
    problem: Option<AnalyzeError>,
}

/// The raster of an analysis of a dataset, to be made band by band; `None` where the elevation is kept in memory, or the kind
/// looks farther than some posts, at what lies on the ground, or gives more than a raster. Depressions and flow of so much
/// elevation that they need half a gigabyte of memory are prepared here and made in bands; smaller ones are faster in memory.
///
/// # Errors
/// As [`analyze`](crate::analysis::analyze).
pub fn analysis_bands<'a>(
    dataset: &'a Dataset,
    (kind, written): (&'static AnalysisKind, &[WrittenArgument]),
    crs: &Crs,
    stop: &'a StopFlag,
) -> Result<Option<AnalysisBands<'a>>, AnalyzeError> {
    let Some(elevation) = dataset.windowed() else { return Ok(None) };
    made_in_bands((dataset, elevation), (kind, written), crs, (MOST_IN_MEMORY, stop))
}

/// [`analysis_bands`], with kinds of water in bands of more posts than `most_in_memory`.
fn made_in_bands<'a>(
    (dataset, elevation): (&'a Dataset, &'a WindowedElevation),
    (kind, written): (&'static AnalysisKind, &[WrittenArgument]),
    crs: &Crs,
    (most_in_memory, stop): (u64, &'a StopFlag),
) -> Result<Option<AnalysisBands<'a>>, AnalyzeError> {
    let is_part = written.iter().any(|argument| argument.name == EXTENT.name);
    if is_part || kind.yields != AnalysisYield::Raster {
        return Ok(None);
    }
    let failed = |error| AnalyzeError::from(dataset.without_ground(error));
    let ground_crs = elevation.ground_crs().map_err(failed)?;
    let arguments = read(kind, written, crs, &ground_crs)?;
    let header = elevation.plan().map_err(failed)?.header();
    let (origin, cell) = Lattice::frame(header).map_err(|error| failed(Arc::new(error.into())))?;
    let size = (header.width, header.height);
    let is_water = BandedWater::makes(&arguments) && u64::from(size.0) * u64::from(size.1) > most_in_memory;
    if !is_water && !kind.layers.is_empty() {
        return Ok(None);
    }
    let Some(reach) = arguments.reach_posts(cell).or(is_water.then_some(0)) else { return Ok(None) };
    // A few posts say what the raster is, and what is wrong with the arguments.
    let last =
        Post { column: (2 * reach + 2).min(header.width - 1), row: (2 * reach + 2).min(header.height - 1) };
    let corner = PostRect { first: Post { column: 0, row: 0 }, last };
    let ground = Arc::new(elevation.ground_cut(corner).map_err(failed)?);
    let mut outcome = run(&Land::bare(ground, ground_crs.clone()), &arguments, stop)?;
    let raster = outcome.raster.take();
    if is_water {
        outcome.figures.clear();
    }
    let Some(raster) = raster
        .filter(|_| outcome.figures.is_empty() && outcome.tables.is_empty() && outcome.features.is_empty())
    else {
        return Ok(None);
    };
    let make_water = || WaterBands::new((dataset, elevation), &arguments, (cell, size), stop);
    let water = is_water.then(make_water).transpose()?;
    let north_west = origin + DVec2::new(0.0, f64::from(header.height - 1)) * cell;
    let (data_type, nodata) = described(&raster.values);
    keep_freed_memory();
    let header = node_header((north_west, cell), size, &ground_crs, (raster.name, data_type, nodata));
    Ok(Some(AnalysisBands {
        elevation,
        arguments,
        reach,
        water,
        crs: ground_crs,
        header,
        stop,
        outcome,
        classes: raster.classes,
        problem: None,
    }))
}

/// Posts of a band.
fn band_posts() -> u32 {
    (THREAD_POSTS * rayon::current_num_threads()).clamp(2 * THREAD_POSTS, BAND_POSTS) as u32
}

/// Lets the allocator keep the memory of a band for the next one.
///
/// Each band takes the same few buffers. The GNU allocator gives freed memory back to the system beyond a bound that it learns
/// from the largest buffer that was freed, and page by page new memory costs more than what is computed in it. A buffer that is
/// freed untouched teaches it; other allocators lose nothing.
fn keep_freed_memory() {
    /// Bytes of the largest buffer that it learns from.
    const LEARNED_FROM: usize = 31 << 20;
    drop(black_box(Vec::<u8>::with_capacity(LEARNED_FROM)));
}

/// The raster of values of the type of `values` at posts of a ground, north up, without its samples; `name` is its driver.
pub fn posts_header(
    values: &PostValues,
    name: &'static str,
    place: (&Lattice, PostRect),
    crs: &Crs,
) -> Raster {
    let (data_type, nodata) = described(values);
    part_header(place, crs, (name, data_type), nodata)
}

/// The type of an outcome's raster and its value for no data.
fn described(values: &PostValues) -> (&'static str, f64) {
    match values {
        PostValues::Numbers(_) => ("Float32", -9999.0),
        PostValues::Codes(_) => ("Byte", f64::from(PostValues::NO_CODE)),
    }
}

impl AnalysisBands<'_> {
    /// What the analysis says besides its raster. Figures are those of the windows that were read.
    pub fn outcome(&self) -> Outcome {
        let mut outcome = self.outcome.clone();
        outcome.figures.extend(self.water.iter().flat_map(WaterBands::figures));
        outcome
    }

    /// How a picture divides the values; empty where that depends on all of them.
    pub fn classes(&self) -> &[ValueClass] {
        &self.classes
    }

    /// Why the last window could not be analyzed, where it could be read.
    pub fn problem(&mut self) -> Option<AnalyzeError> {
        self.problem.take()
    }

    /// The values of the posts of a window, of a kind of water.
    fn water_values(
        water: &mut WaterBands,
        header: &Raster,
        window: RasterWindow,
    ) -> Result<Vec<f32>, AnalyzeError> {
        let columns = window.column as usize..(window.column + window.width) as usize;
        let (south, mut north) = (header.height - window.row - window.height, header.height - window.row);
        let mut values = Vec::new();
        while north > south {
            let (rows, band) = water.band_of_row(north as usize - 1)?;
            let first = (south as usize).max(rows.start);
            let held = (first - rows.start) as u32..north - rows.start as u32;
            values.extend(from_north(band, header.width as usize, columns.clone(), held.rev()));
            north = first as u32;
        }
        Ok(values)
    }

    /// The values of the posts of a window.
    fn values(&mut self, window: RasterWindow) -> Result<Result<Vec<f32>, AnalyzeError>, DemErrorKind> {
        if let Some(water) = &mut self.water {
            return Ok(Self::water_values(water, &self.header, window));
        }
        let (width, height) = (self.header.width, self.header.height);
        // Rows of the raster run from the north, those of posts from the south.
        let (first, last) = (height - window.row - window.height, height - 1 - window.row);
        let south = first.saturating_sub(self.reach);
        let north = (last + self.reach).min(height - 1);
        // A lattice has two rows at least.
        let (south, north) =
            if south < north { (south, north) } else { (south.saturating_sub(1), north.max(1)) };
        let posts =
            PostRect { first: Post { column: 0, row: south }, last: Post { column: width - 1, row: north } };
        let ground = self.elevation.ground_cut(posts).map_err(|error| match Arc::try_unwrap(error) {
            Ok(GroundError::Read(error)) => error,
            _ => DemErrorKind::Changed,
        })?;
        let land = Land::bare(Arc::new(ground), self.crs.clone());
        let share = |row: u32| f64::from(row) / f64::from(height);
        self.stop.part(share(window.row)..share(window.row + window.height));
        let outcome = match run(&land, &self.arguments, self.stop) {
            Ok(outcome) => outcome,
            Err(error) => return Ok(Err(error.into())),
        };
        let Some(raster) = outcome.raster else { return Err(DemErrorKind::Changed) };
        let columns = window.column as usize..(window.column + window.width) as usize;
        Ok(Ok(from_north(&raster.values, width as usize, columns, (first - south..=last - south).rev())))
    }
}

/// The values of some rows and columns, in the order of the rows.
fn from_north(
    values: &PostValues,
    width: usize,
    columns: Range<usize>,
    rows: impl Iterator<Item = u32>,
) -> Vec<f32> {
    let rows: Vec<usize> = rows.map(|row| row as usize).collect();
    let mut out = vec![0.0; rows.len() * columns.len()];
    out.par_chunks_mut(columns.len()).zip(rows).for_each(|(out, row)| {
        let place = row * width + columns.start..row * width + columns.end;
        match values {
            PostValues::Numbers(numbers) => out.copy_from_slice(&numbers[place]),
            PostValues::Codes(_) => {
                out.iter_mut().zip(place).for_each(|(out, index)| *out = values.value(index));
            }
        }
    });
    out
}

impl Windows for AnalysisBands<'_> {
    fn metadata(&self) -> &Raster {
        &self.header
    }

    fn samples(&mut self, window: RasterWindow) -> Result<Samples, DemErrorKind> {
        window.assert_within(self.size());
        match self.values(window)? {
            Ok(values) => Ok(Samples::F32(values)),
            Err(problem) => {
                self.problem = Some(problem);
                Err(DemErrorKind::Changed)
            }
        }
    }

    fn computed_rows(&self) -> Option<u32> {
        if let Some(water) = &self.water {
            return Some(water.band_rows());
        }
        let most = (MOST_POSTS / self.header.width).saturating_sub(2 * self.reach);
        let wanted = (band_posts() / self.header.width).max(ROWS_PER_HALO * self.reach);
        Some(wanted.min(most).max(1))
    }
}

/// The raster of an outcome in memory, as [`AnalysisBands`] gives it.
pub struct OutcomeWindows<'a> {
    header: Raster,
    values: &'a PostValues,
}

impl<'a> OutcomeWindows<'a> {
    /// Of an analysis of `ground`.
    pub fn new(outcome: &'a OutcomeRaster, ground: &Lattice, crs: &Crs) -> Self {
        Self::at(outcome, (ground, PostRect::all(ground)), crs)
    }

    /// Of an analysis of these posts of a ground.
    pub fn at(outcome: &'a OutcomeRaster, place: (&Lattice, PostRect), crs: &Crs) -> Self {
        let header = posts_header(&outcome.values, outcome.name, place, crs);
        Self { header, values: &outcome.values }
    }

    /// All of it, with its samples.
    pub fn raster(self) -> Raster {
        let samples = self.window_values(RasterWindow::all(self.size()));
        Raster { samples: Samples::F32(samples), ..self.header }
    }

    fn window_values(&self, window: RasterWindow) -> Vec<f32> {
        let Raster { width, height, .. } = self.header;
        let columns = window.column as usize..(window.column + window.width) as usize;
        let rows = (height - window.row - window.height..height - window.row).rev();
        from_north(self.values, width as usize, columns, rows)
    }
}

impl Windows for OutcomeWindows<'_> {
    fn metadata(&self) -> &Raster {
        &self.header
    }

    fn samples(&mut self, window: RasterWindow) -> Result<Samples, DemErrorKind> {
        window.assert_within(self.size());
        Ok(Samples::F32(self.window_values(window)))
    }

    fn computed_rows(&self) -> Option<u32> {
        Some((band_posts() / self.header.width).max(1))
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::analysis::{analyze, bare_land};
    use crate::dataset::DatasetOptions;
    use sandtable_dem::dem_format::DemFormat;

    fn dataset(most_kept: u64) -> Dataset {
        let path = concat!(env!("SANDTABLE_ROOT"), "assets/jacksboro/dem.tif");
        let options = DatasetOptions { most_kept, ..DatasetOptions::default() };
        Dataset::open(Path::new(path), &options).expect("the demo's ground")
    }

    fn file_of(windows: &mut (dyn Windows + Send)) -> Vec<u8> {
        let mut out = std::io::Cursor::new(Vec::new());
        let writer = DemFormat::to_write("tif").and_then(|format| format.windows_writer);
        writer.expect("a GeoTIFF is written in windows")(windows, &mut out).expect("memory");
        out.into_inner()
    }

    #[test]
    fn bands_give_the_bytes_of_the_whole_and_any_windows_its_bits() {
        let (on_disk, kept) = (dataset(0), dataset(u64::MAX));
        let stop = StopFlag::default();
        let mut kinds = 0;
        for kind in sandtable_catalog::kinds() {
            let Ok(Some(mut bands)) = analysis_bands(&on_disk, (kind, &[]), &on_disk.crs(), &stop) else {
                continue;
            };
            kinds += 1;
            let land = bare_land(&kept, (kind, &[]), &kept.crs()).expect("ground");
            let whole = analyze(&kept, land, (kind, &[]), &kept.crs(), &stop).expect(kind.name);
            let raster = whole.outcome.raster.as_ref().expect(kind.name);
            let mut of_whole = OutcomeWindows::new(raster, &whole.ground, &whole.crs);
            let size = bands.size();
            assert_eq!(size, of_whole.size());
            for window in RasterWindow::all(size).bands(37 * size.0) {
                let wanted = of_whole.samples(window).expect("memory");
                let found = bands.samples(window).expect("a file");
                let bits = |samples: &Samples| samples.iter().map(f64::to_bits).collect::<Vec<_>>();
                assert!(bits(&found) == bits(&wanted), "{} at row {}", kind.name, window.row);
            }
            assert!(file_of(&mut bands) == file_of(&mut of_whole), "{}", kind.name);
            assert!(whole.outcome.figures.is_empty() && whole.outcome.notes == bands.outcome().notes);
        }
        assert!(kinds >= 5, "{kinds} kinds");
    }

    #[test]
    fn water_in_bands_gives_the_bytes_and_figures_of_the_whole() {
        let (on_disk, kept) = (dataset(0), dataset(u64::MAX));
        let elevation = on_disk.windowed().expect("on disk");
        let stop = StopFlag::default();
        for (kind, show) in
            [("fill", "depth"), ("fill", "filled"), ("flow", "direction"), ("flow", "accumulation")]
        {
            let kind = sandtable_catalog::kind(kind).expect("a kind");
            let written = [WrittenArgument { name: "show".into(), text: show.into() }];
            let crs = on_disk.crs();
            let bands = made_in_bands((&on_disk, elevation), (kind, &written), &crs, (0, &stop));
            let mut bands = bands.expect("prepared").expect("bands");
            let land = bare_land(&kept, (kind, &written), &kept.crs()).expect("ground");
            let whole = analyze(&kept, land, (kind, &written), &kept.crs(), &stop).expect(kind.name);
            let raster = whole.outcome.raster.as_ref().expect(kind.name);
            let mut of_whole = OutcomeWindows::new(raster, &whole.ground, &whole.crs);
            assert!(file_of(&mut bands) == file_of(&mut of_whole), "{show}");
            let outcome = bands.outcome();
            assert_eq!((outcome.figures, outcome.notes), (whole.outcome.figures, whole.outcome.notes));
        }
        let breach = [WrittenArgument { name: "depressions".into(), text: "breach".into() }];
        let kind = sandtable_catalog::kind("flow").expect("a kind");
        let bands = made_in_bands((&on_disk, elevation), (kind, &breach), &on_disk.crs(), (0, &stop));
        assert!(bands.expect("no error").is_none(), "ways out of pits are sought in memory");
    }

    #[test]
    fn all_of_elevation_on_disk_is_the_land_of_an_analysis() {
        let kind = sandtable_catalog::kind("slope").expect("a kind");
        let land = |most_kept: u64| {
            let dataset = dataset(most_kept);
            bare_land(&dataset, (kind, &[]), &dataset.crs()).expect("ground")
        };
        let [on_disk, kept] = [0, u64::MAX].map(land);
        assert_eq!(on_disk.ground.heights().len(), kept.ground.heights().len());
        assert!(
            on_disk
                .ground
                .heights()
                .iter()
                .zip(kept.ground.heights())
                .all(|(a, b)| a.to_bits() == b.to_bits())
        );
    }

    #[test]
    fn wrong_arguments_are_errors_before_anything_is_written() {
        let on_disk = dataset(0);
        let kind = sandtable_catalog::kind("geomorphons").expect("a kind");
        let written = [WrittenArgument { name: "radius".into(), text: "2.5".into() }];
        let stop = StopFlag::default();
        let bands = analysis_bands(&on_disk, (kind, &written), &on_disk.crs(), &stop);
        assert!(bands.is_err_and(|error| error.to_string().contains("whole number")));
    }

    #[test]
    fn bands_are_small_whatever_the_width_and_the_reach() {
        let on_disk = dataset(0);
        let kind = sandtable_catalog::kind("slope").expect("a kind");
        let stop = StopFlag::default();
        let bands = analysis_bands(&on_disk, (kind, &[]), &on_disk.crs(), &stop).ok().flatten();
        let mut bands = bands.expect("bands");
        for (width, reach) in [(1 << 14, 1), (1 << 14, 20), (1 << 14, 500), (1 << 20, 500)] {
            (bands.header.width, bands.reach) = (width, reach);
            let rows = bands.computed_rows().expect("computed");
            assert!(
                rows >= 1 && (rows == 1 || (rows + 2 * reach) * width <= MOST_POSTS),
                "{width} {reach}: {rows}"
            );
        }
    }
}
