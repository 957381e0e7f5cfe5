//! Cuts a table of points into shards.

use std::io::{self, BufWriter, Seek, SeekFrom, Write};
use std::path::Path;

use glam::DVec2;
use rayon::prelude::*;

use crate::error::{PlanError, PlanFault, ShardError};
use crate::heights::arguments::HeightsArguments;
use crate::heights::squares::{HALO, PointRoutes, PointShard, PointSquares};
use crate::input::{PlanInput, hash};
use crate::plan::{self, PlannedProduct};
use crate::planned_dataset::QueriedDataset;
use crate::point_stream::PointStream;
use crate::shard::{PointRange, Shard, ShardWindow};
use sandtable_base::limits::{PLAN_POINTS, PLAN_SHARDS};
use sandtable_files::disk::{SystemError, WriteFileError};
use sandtable_files::part_file::{self, PartFile};
use sandtable_geom::crs::Crs;
use sandtable_query::positions::WrittenPosition;
use sandtable_raster::raster::Raster;
use sandtable_raster::windows::RasterWindow;
use sandtable_terrain::query::source::SourceTransform;

/// The most points of a shard: 100 MB of positions and answers.
pub const MOST_POINTS: u64 = 1 << 21;
/// The points of a shard where no number of shards is stated: about a second's work.
const USUAL_POINTS: u64 = 1 << 20;
/// The bytes of a position in `points.bin`.
pub const POINT_BYTES: u64 = 16;
/// Bytes of positions that are collected before they are written, for all shards together.
const COLLECTED: usize = 64 << 20;
/// How many samples take the time of one point.
const SAMPLES_A_POINT: f64 = 32.0;

/// Plans the heights of the points that `arguments` name, of their dataset opened, in about `shards` shards; writes the plan
/// to `folder`, which is there, and returns the number of its shards.
///
/// # Errors
/// The points or the elevation cannot be read or queried so, or a file cannot be written.
pub fn plan(
    arguments: HeightsArguments,
    queried: &QueriedDataset,
    shards: Option<u64>,
    folder: &Path,
) -> Result<usize, ShardError> {
    // What is wrong with the question is reported before the points are read.
    arguments.answers(queried, &[])?;
    let table = folder.join(&arguments.points);
    let header = queried.dataset.header();
    let transform = SourceTransform::new(&header, &queried.crs);
    let grid = PointGrid { header: &header, crs: &queried.crs, transform };
    let mut squares = PointSquares::new((header.width, header.height));
    let mut count = 0;
    PointStream::open(&table, &queried.crs)?.each_batch(|positions| {
        count += positions.len() as u64;
        if count > PLAN_POINTS.get() {
            return Err(PlanError::new(&table, PlanFault::TooManyPoints).into());
        }
        grid.of(positions).into_iter().for_each(|at| squares.add(at));
        Ok(())
    })?;
    if count == 0 {
        return Err(PlanError::new(&table, PlanFault::NoPoints).into());
    }
    let each = shards.map_or(USUAL_POINTS, |shards| count.div_ceil(shards)).min(MOST_POINTS / 2);
    let (routes, parts) = squares.part(each);
    if parts.len() as u64 > PLAN_SHARDS.get() {
        return Err(PlanError::new(&table, PlanFault::TooManyShards(parts.len() as u64)).into());
    }
    let hashes = write_points(&table, &grid, routes, &parts, folder)?;
    let size = (header.width, header.height);
    let mut first = 0;
    let lines: Vec<Shard> = (0..)
        .zip(parts.iter().zip(hashes))
        .map(|(id, (part, sha256))| {
            let points = PointRange { first, count: part.count, sha256 };
            first += part.count;
            shard(id, part, size, points)
        })
        .collect();
    let mut inputs = arguments.dataset.inputs(&queried.dataset, folder)?;
    inputs.extend(PlanInput::all(&[(table, arguments.points.clone())])?);
    plan::write(folder, PlannedProduct::Heights(arguments), inputs, &lines)?;
    Ok(lines.len())
}

fn shard(id: usize, part: &PointShard, size: (u32, u32), points: PointRange) -> Shard {
    let first = DVec2::new(f64::from(part.window.column), f64::from(part.window.row));
    let last = first + DVec2::new(f64::from(part.window.width - 1), f64::from(part.window.height - 1));
    let RasterWindow { column, row, width, height } = RasterWindow::around(size, first, last, HALO);
    let name = format!("column {} row {}", part.window.column, part.window.row);
    let cost = part.count as f64 + f64::from(width) * f64::from(height) / SAMPLES_A_POINT;
    let window = ShardWindow::Grid([column, row, width, height]);
    Shard { halo: Some(HALO), points: Some(points), ..Shard::new(id, name, cost, window) }
}

/// Where positions lie in the grid of a raster.
struct PointGrid<'a> {
    header: &'a Raster,
    /// The system of positions.
    crs: &'a Crs,
    transform: SourceTransform<'a>,
}

impl PointGrid<'_> {
    fn of(&self, positions: &[WrittenPosition<'_>]) -> Vec<DVec2> {
        let grid =
            |position: &WrittenPosition| self.header.grid_from_map(self.transform.position(position.at));
        positions.par_iter().map(grid).collect()
    }
}

/// Writes `points.bin` and `order.bin`; returns the hash of each shard's part of the first.
fn write_points(
    table: &Path,
    grid: &PointGrid<'_>,
    mut routes: PointRoutes,
    parts: &[PointShard],
    folder: &Path,
) -> Result<Vec<String>, ShardError> {
    let (points_path, order_path) = (folder.join("points.bin"), folder.join("order.bin"));
    let failed = |error: io::Error| WriteFileError::new(&points_path, SystemError::from(error));
    let points_part = PartFile::create(folder).map_err(failed)?;
    let order_part = PartFile::create(folder).map_err(failed)?;
    let mut order = BufWriter::new(order_part.file());
    let mut points = ScatteredPoints::new(points_part.file(), parts);
    PointStream::open(table, grid.crs)?.each_batch(|positions| {
        for (position, at) in positions.iter().zip(grid.of(positions)) {
            let shard = routes.shard(at);
            order.write_all(&shard.to_le_bytes()).map_err(failed)?;
            // A table that grows while it is read has more points than were counted.
            if !points.push(shard as usize, position.at).map_err(failed)? {
                return Err(changed(table));
            }
        }
        Ok(())
    })?;
    if !points.finish().map_err(failed)? {
        return Err(changed(table));
    }
    order.into_inner().map_err(|error| failed(error.into_error()))?;
    let mut file = points_part.file().try_clone().map_err(failed)?;
    file.seek(SeekFrom::Start(0)).map_err(failed)?;
    let hashes: io::Result<_> = parts.iter().map(|part| hash(&mut file, part.count * POINT_BYTES)).collect();
    let hashes = hashes.map_err(failed)?;
    for part in [&points_part, &order_part] {
        part.file().sync_all().map_err(failed)?;
    }
    part_file::publish(vec![(points_part, points_path.clone()), (order_part, order_path)])
        .map_err(|(path, error)| WriteFileError::new(&path, SystemError::from(error)))?;
    Ok(hashes)
}

fn changed(table: &Path) -> ShardError {
    PlanError::new(table, PlanFault::Stale("it changes while it is read".into())).into()
}

/// Positions on their way to their shards' parts of a file.
struct ScatteredPoints<W> {
    out: W,
    parts: Vec<PointPart>,
    /// Bytes that are collected for a shard.
    most: usize,
}

struct PointPart {
    /// Where the next bytes go, and where they must end.
    next: u64,
    end: u64,
    collected: Vec<u8>,
}

impl<W: Write + Seek> ScatteredPoints<W> {
    fn new(out: W, parts: &[PointShard]) -> Self {
        let mut end = 0;
        let part = |part: &PointShard| {
            let next = end;
            end += part.count * POINT_BYTES;
            PointPart { next, end, collected: Vec::new() }
        };
        let parts: Vec<PointPart> = parts.iter().map(part).collect();
        let most = (COLLECTED / parts.len().max(1)).clamp(256, 64 << 10);
        Self { out, parts, most }
    }

    /// Adds a point to a shard; `false` where it has all.
    fn push(&mut self, shard: usize, at: DVec2) -> io::Result<bool> {
        let part = &mut self.parts[shard];
        if part.next + part.collected.len() as u64 >= part.end {
            return Ok(false);
        }
        part.collected.extend(at.to_array().into_iter().flat_map(f64::to_le_bytes));
        if part.collected.len() >= self.most {
            part.write(&mut self.out)?;
        }
        Ok(true)
    }

    /// Writes what is collected; `false` where a shard lacks points.
    fn finish(mut self) -> io::Result<bool> {
        for part in &mut self.parts {
            part.write(&mut self.out)?;
        }
        self.out.flush()?;
        Ok(self.parts.iter().all(|part| part.next == part.end))
    }
}

impl PointPart {
    fn write(&mut self, out: &mut (impl Write + Seek)) -> io::Result<()> {
        out.seek(SeekFrom::Start(self.next))?;
        out.write_all(&self.collected)?;
        self.next += self.collected.len() as u64;
        self.collected.clear();
        Ok(())
    }
}
