//! The raster of all shards of an analysis, or its features.

use std::path::{Path, PathBuf};

use crate::analysis::arguments::{AnalysisPlan, OpenedAnalysis};
use crate::analysis::said::PartSaid;
use crate::analysis::work::ground_posts;
use crate::error::{PlanError, PlanFault, ShardError};
use crate::plan::ShardPlan;
use crate::raster_result::EXTENSION;
use crate::record::result_path;
use sandtable_analysis::outcome::{Outcome, OutcomeRaster, PostValues};
use sandtable_base::limits::RASTER_SAMPLES;
use sandtable_base::limits::memory::check_memory;
use sandtable_dem::dem_format::DemFormat;
use sandtable_dem::hints::DemOptions;
use sandtable_export::features::FeatureFormat;
use sandtable_export::features::outcome::{OutcomeFrame, export_outcome};
use sandtable_files::error::FileError;
use sandtable_files::raster_file::{self, WriteRasterError};
use sandtable_query::analysis_bands::posts_header;
use sandtable_query::dem;
use sandtable_raster::error::DemErrorKind;
use sandtable_raster::raster::{Raster, Samples};
use sandtable_raster::windows::{RasterWindow, Windows};
use sandtable_terrain::post_rect::PostRect;
use sandtable_terrain::stop_flag::StopFlag;

/// Rows that are written at once, as the values of an analysis are.
const BAND_ROWS: u32 = 256;

/// The results of shards as one raster, of which the tiles under the last window are held.
struct TileWindows<'a> {
    /// Says how many samples are joined.
    watch: &'a StopFlag,
    /// The raster without samples.
    header: Raster,
    tiles: Vec<ResultTile>,
    held: Vec<HeldTile>,
}

/// The place of a shard's result in the raster, and its file.
struct ResultTile {
    window: RasterWindow,
    path: PathBuf,
}

/// The samples of a tile, by its number.
struct HeldTile {
    id: usize,
    samples: Vec<f32>,
}

/// What all shards of a plan say together, opened to be written.
struct DoneShards {
    opened: OpenedAnalysis,
    /// What the analysis gives besides its raster.
    outcome: Outcome,
    /// The posts of each shard.
    tiles: Vec<PostRect>,
    /// The posts of all.
    all: PostRect,
}

impl DoneShards {
    fn open(plan: &ShardPlan, arguments: &AnalysisPlan) -> Result<Self, ShardError> {
        let opened = arguments.open(&plan.folder)?;
        let (tally, notes) = PartSaid::of_all(plan)?;
        let mut outcome = opened.parts.summary(&opened.queried.dataset, &tally)?;
        outcome.notes.splice(0..0, notes);
        let tile = |id: usize| ground_posts(plan, &opened, &plan.shard(id)?);
        let tiles: Vec<PostRect> = (0..plan.count()).map(tile).collect::<Result<_, ShardError>>()?;
        let all = tiles.iter().fold(tiles[0], |all, tile| all.with(tile.first).with(tile.last));
        let posts = all.width() as u64 * all.height() as u64;
        if posts > RASTER_SAMPLES.get() {
            let (columns, rows) = (all.width() as u64, all.height() as u64);
            return Err(PlanError::new(&plan.folder, PlanFault::AnalysisPosts { columns, rows }).into());
        }
        Ok(Self { opened, outcome, tiles, all })
    }

    /// The raster of all shards.
    fn windows<'a>(&self, plan: &ShardPlan, watch: &'a StopFlag) -> Result<TileWindows<'a>, ShardError> {
        let (opened, all) = (&self.opened, self.all);
        let frame = opened.parts.frame();
        // The first tile to be written says of what type all are.
        let id = self.tiles.iter().position(|tile| tile.last.row == all.last.row).unwrap_or(0);
        let path = result_path(plan, id, EXTENSION);
        let first = dem::open(&path, &DemOptions::default())?.raster;
        let header = posts_header(&like(&first), opened.kind.name, (&frame.lattice, all), &frame.crs);
        let place = |(id, tile): (usize, &PostRect)| ResultTile {
            window: window_in(*tile, all),
            path: result_path(plan, id, EXTENSION),
        };
        let tiles: Vec<ResultTile> = self.tiles.iter().enumerate().map(place).collect();
        let samples =
            tiles[id].samples(first).map_err(FileError::at(&path)).map_err(WriteRasterError::from)?;
        watch.stretch(0.0..1.0, header.width as usize * header.height as usize);
        Ok(TileWindows { watch, header, tiles, held: vec![HeldTile { id, samples }] })
    }

    /// The samples of all shards, in rows from the north.
    fn samples(
        source: &mut TileWindows<'_>,
        (plan, out): (&ShardPlan, &Path),
        remedy: &'static str,
    ) -> Result<Samples, ShardError> {
        let all = RasterWindow::all(source.size());
        let checked = check_memory((all.samples() * size_of::<f32>()) as u64, "the raster", remedy);
        checked.map_err(|error| PlanError::new(out, PlanFault::Output(error.to_string())))?;
        let samples = source.samples(all);
        Ok(samples.map_err(|error| WriteRasterError::from(FileError::at(&plan.folder)(error)))?)
    }
}

/// Writes the values of a plan whose shards are all done: the raster that `analyze` writes. Returns the rest of what it gives.
/// `watch` says which share of the raster is joined.
///
/// # Errors
/// A file cannot be read or written, or is not the one of the plan.
pub fn gather(
    plan: &ShardPlan,
    arguments: &AnalysisPlan,
    (out, format): (&Path, &DemFormat),
    watch: &StopFlag,
) -> Result<Outcome, ShardError> {
    let done = DoneShards::open(plan, arguments)?;
    let mut source = done.windows(plan, watch)?;
    if raster_file::write_windows(&mut source, format, out, &plan.folder)?.is_some() {
        return Ok(done.outcome);
    }
    let samples = DoneShards::samples(&mut source, (plan, out), "gather it as a .tif")?;
    let raster = Raster { samples, ..source.header };
    raster_file::write(&raster, format, out, &[done.opened.queried.path])?;
    Ok(done.outcome)
}

/// Writes the features of a plan whose shards are all done: those that `analyze` writes, or the areas of the classes of its
/// raster where it gives no others. Returns what it gives besides its raster.
///
/// # Errors
/// As [`gather`]; the analysis has neither features nor classes.
pub fn gather_features(
    plan: &ShardPlan,
    arguments: &AnalysisPlan,
    (out, format): (&Path, FeatureFormat),
    watch: &StopFlag,
) -> Result<Outcome, ShardError> {
    let mut done = DoneShards::open(plan, arguments)?;
    let OpenedAnalysis { queried, parts, kind } = &done.opened;
    let ground = parts.ground(&queried.dataset)?;
    if done.outcome.features.is_empty() {
        let mut source = done.windows(plan, watch)?;
        let samples = DoneShards::samples(&mut source, (plan, out), "gather its raster as a .tif")?;
        let empty = parts.empty_raster(&queried.dataset, &StopFlag::default())?;
        let values = post_values(&empty.values, &samples, ground.columns() as usize);
        done.outcome.raster = Some(OutcomeRaster { values, ..empty });
    }
    let frame = OutcomeFrame { ground: &ground, crs: &parts.frame().crs };
    let inputs = [queried.path.clone()];
    export_outcome(&done.outcome, frame, out, format, kind.title, &inputs)?;
    Ok(Outcome { raster: None, ..done.outcome })
}

/// No values, of the type of those of a tile.
fn like(tile: &Raster) -> PostValues {
    match tile.data_type {
        "Byte" => PostValues::Codes(Vec::new()),
        _ => PostValues::Numbers(Vec::new()),
    }
}

/// The values of samples in rows from the north, of the type of `like`.
fn post_values(like: &PostValues, samples: &Samples, columns: usize) -> PostValues {
    let from_south: Vec<f32> = samples
        .iter()
        .map(|sample| sample as f32)
        .collect::<Vec<f32>>()
        .chunks(columns)
        .rev()
        .flatten()
        .copied()
        .collect();
    let code = |&value: &f32| if value.is_nan() { PostValues::NO_CODE } else { value as u8 };
    match like {
        PostValues::Numbers(_) => PostValues::Numbers(from_south),
        PostValues::Codes(_) => PostValues::Codes(from_south.iter().map(code).collect()),
    }
}

/// The place of posts among all, in rows from the north.
fn window_in(tile: PostRect, all: PostRect) -> RasterWindow {
    RasterWindow {
        column: tile.first.column - all.first.column,
        row: all.last.row - tile.last.row,
        width: tile.width() as u32,
        height: tile.height() as u32,
    }
}

impl Windows for TileWindows<'_> {
    fn metadata(&self) -> &Raster {
        &self.header
    }

    fn samples(&mut self, window: RasterWindow) -> Result<Samples, DemErrorKind> {
        window.assert_within(self.size());
        let rows = RasterWindow { column: 0, width: self.header.width, ..window };
        self.held.retain(|held| self.tiles[held.id].window.intersection(rows).is_some());
        let mut samples = vec![f32::NAN; window.samples()];
        for (id, tile) in self.tiles.iter().enumerate() {
            if window.intersection(tile.window).is_none() {
                continue;
            }
            let known = self.held.iter().position(|held| held.id == id);
            let at = match known {
                Some(at) => at,
                None => {
                    self.held.push(HeldTile { id, samples: tile.read()? });
                    self.held.len() - 1
                }
            };
            for (to, from) in window.shared_rows(tile.window) {
                samples[to].copy_from_slice(&self.held[at].samples[from]);
            }
        }
        self.watch.did(samples.len());
        Ok(Samples::F32(samples))
    }

    fn computed_rows(&self) -> Option<u32> {
        Some(BAND_ROWS)
    }
}

impl ResultTile {
    /// The samples of the file, which was compared with its record.
    fn read(&self) -> Result<Vec<f32>, DemErrorKind> {
        let opened = dem::open(&self.path, &DemOptions::default());
        self.samples(opened.map_err(|_| DemErrorKind::Changed)?.raster)
    }

    /// The samples of the raster of the file.
    fn samples(&self, raster: Raster) -> Result<Vec<f32>, DemErrorKind> {
        if (raster.width, raster.height) != (self.window.width, self.window.height) {
            return Err(DemErrorKind::Changed);
        }
        Ok(match raster.samples {
            Samples::F32(samples) => samples,
            Samples::F64(samples) => samples.iter().map(|&sample| sample as f32).collect(),
        })
    }
}
