//! Many bilinear heights at once, equal to single queries to the last bit and several times as fast.
//!
//! Positions are processed in chunks of 128, in three passes over arrays on the stack. The first and the last pass are
//! written for the compiler to vectorize; the second only reads, so that many cache misses overlap:
//!
//! ```text
//! positions ─► cell and part of it ─► four corners of each ─► height
//!              (vectors)              (reads only)            (vectors)
//! ```
//!
//! Between the corners, the second pass reads the positions of the next chunk (`ReadAhead`). The first pass would have
//! nothing to do while it waits for them, and in a batch that leaves the cache it would wait as long as all passes take.
//!
//! No pass branches on its data. A position outside, or one that a special rule applies to, gets NaN as its part of the
//! cell; a hole has NaN as its height. Both yield NaN heights, which are then queried one by one. So the rules for special
//! cases are written once, and the passes need only be right for ordinary positions.
//!
//! **Layout.** Row by row, the four corners of a cell lie in two cache lines and two pages. Positions near each other share
//! them; scattered over a large ground, each costs two misses. Scattered chunks therefore read [`HeightTiles`], once they
//! are made, where a cell lies in one line.
//!
//! The passes are compiled for the widest vectors that the processor has (`terrain::vectorized`), and for those that every
//! processor has: there rounding down would be a call, so it is done by adding and subtracting a large number.

use glam::{DMat2, DVec2};
use rayon::prelude::*;

use crate::lattice::Lattice;
use crate::query::source::raster_height;
use crate::query::tiles::{HeightTiles, TileSlot};
use crate::query::{Interpolation, ground_height};
use sandtable_base::vectorized::vectorized;
use sandtable_raster::answer::{Answer, Status};
use sandtable_raster::raster::{Raster, Samples};
use sandtable_raster::sample::ON_CENTER;

/// Positions per chunk: its arrays take 6 KiB and stay in the first cache. Below 32 the passes cost more than their work,
/// above 512 the arrays leave the cache.
const CHUNK: usize = 128;

/// Positions per task of a batch that is spread over threads: a few hundredths of a millisecond.
const TASK: usize = 4096;

/// Positions whose heights and statuses [`answers`] holds on the stack at a time.
const PARTS: usize = 4 * CHUNK;

/// A chunk whose positions span more rows than this is scattered: each position then has pages of its own.
const COHERENT_ROWS: f64 = 64.0;

/// Every so-manieth position of a chunk tells whether it is scattered: a look at all of them takes as long as a tenth of the
/// work, and those of a scattered chunk lie apart wherever they are taken. No divisor of a row's length or of a tile's side,
/// so that positions in the order of a grid are not all taken from one column.
const LOOKED_AT: usize = 17;

/// 1.5 · 2⁵²: a number added to it is rounded to a whole one, held in its lowest bits.
const WHOLE: f64 = 6_755_399_441_055_744.0;

/// The output of a batch: heights in meters, NaN where there is none, and statuses, in slices of equal length.
pub struct HeightSlices<'a> {
    /// Heights in meters.
    pub heights_m: &'a mut [f64],
    /// Statuses of the heights.
    pub statuses: &'a mut [Status],
}

impl HeightSlices<'_> {
    /// Panics unless there is one height and one status for each of `count` positions.
    pub(in crate::query) fn check_len(&self, count: usize) {
        assert_eq!((count, count), (self.heights_m.len(), self.statuses.len()), "one answer per position");
    }

    /// Writes answers.
    ///
    /// # Panics
    /// Where there are not as many.
    pub fn put(&mut self, answers: &[Answer]) {
        self.check_len(answers.len());
        for ((answer, height_m), status) in answers.iter().zip(&mut *self.heights_m).zip(&mut *self.statuses)
        {
            (*height_m, *status) = answer.parts();
        }
    }

    /// In chunks of `size`, the last one shorter where `size` does not divide the length.
    pub(in crate::query) fn chunks_mut(&mut self, size: usize) -> impl Iterator<Item = HeightSlices<'_>> {
        let chunks = self.heights_m.chunks_mut(size).zip(self.statuses.chunks_mut(size));
        chunks.map(|(heights_m, statuses)| HeightSlices { heights_m, statuses })
    }

    /// Writes `answer` of each position.
    pub(in crate::query) fn fill(&mut self, at: &[DVec2], answer: impl Fn(DVec2) -> Answer) {
        for ((&at, height_m), status) in at.iter().zip(&mut *self.heights_m).zip(&mut *self.statuses) {
            (*height_m, *status) = answer(at).parts();
        }
    }
}

/// Where the positions of a chunk lie: the cell's column and row, whole numbers, and the part of it, east and north (in a
/// raster: south); NaN for a position that must be queried by itself.
struct CellPositions {
    column: [f64; CHUNK],
    row: [f64; CHUNK],
    x: [f64; CHUNK],
    y: [f64; CHUNK],
}

/// The corners of the cells of a chunk: two of each in the row stored first, and two in the next.
struct CellCorners<S> {
    first: [[S; 2]; CHUNK],
    next: [[S; 2]; CHUNK],
}

/// The positions of a chunk, whose places are taken by those of the next chunk one by one.
struct ReadAhead<'a> {
    at: [DVec2; CHUNK],
    next: &'a [DVec2; CHUNK],
}

impl ReadAhead<'_> {
    #[inline(always)]
    fn read(&mut self, index: usize) {
        self.at[index] = self.next[index];
    }
}

impl CellPositions {
    const EMPTY: Self = Self { column: [0.0; CHUNK], row: [0.0; CHUNK], x: [0.0; CHUNK], y: [0.0; CHUNK] };

    /// Whether the positions lie so far apart that each has cache lines of its own.
    #[inline(always)]
    fn are_scattered(&self) -> bool {
        let (mut low, mut high) = (self.row[0], self.row[0]);
        for &row in self.row.iter().step_by(LOOKED_AT) {
            low = if row < low { row } else { low };
            high = if row > high { row } else { high };
        }
        high - low > COHERENT_ROWS
    }
}

/// Spreads positions over all threads and joins the heights and statuses that `task` writes to answers.
///
/// # Panics
/// Where `out` is not as long as `at`.
pub(in crate::query) fn answers(
    at: &[DVec2],
    out: &mut [Answer],
    task: impl Fn(&[DVec2], HeightSlices<'_>) + Sync,
) {
    assert_eq!(at.len(), out.len(), "one answer per position");
    at.par_chunks(TASK).zip(out.par_chunks_mut(TASK)).for_each(|(at, out)| {
        let (mut heights_m, mut statuses) = ([0.0; PARTS], [Status::Ok; PARTS]);
        for (at, out) in at.chunks(PARTS).zip(out.chunks_mut(PARTS)) {
            let (heights_m, statuses) = (&mut heights_m[..at.len()], &mut statuses[..at.len()]);
            task(at, HeightSlices { heights_m, statuses });
            for ((out, &height_m), &status) in out.iter_mut().zip(&*heights_m).zip(&*statuses) {
                *out = status.with_height(height_m);
            }
        }
    });
}

/// Spreads positions over all threads; `task` writes their heights and statuses.
pub(in crate::query) fn spread(
    at: &[DVec2],
    out: HeightSlices<'_>,
    task: impl Fn(&[DVec2], HeightSlices<'_>) + Sync,
) {
    let outs = out.heights_m.par_chunks_mut(TASK).zip(out.statuses.par_chunks_mut(TASK));
    at.par_chunks(TASK)
        .zip(outs)
        .for_each(|(at, (heights_m, statuses))| task(at, HeightSlices { heights_m, statuses }));
}

/// The bilinear heights of the ground at map positions, as [`ground_height`] answers each. Scattered positions read
/// `tiles` where they are given. Returns the number of scattered positions.
///
/// # Panics
/// Where the slices are not as long as `at`.
pub fn bilinear_ground(
    lattice: &Lattice,
    tiles: Option<&HeightTiles>,
    at: &[DVec2],
    out: HeightSlices<'_>,
) -> usize {
    vectorized(
        #[inline(always)]
        || ground_passes(lattice, tiles, at, out),
    )
}

#[inline(always)]
fn ground_passes(
    lattice: &Lattice,
    tiles: Option<&HeightTiles>,
    at: &[DVec2],
    out: HeightSlices<'_>,
) -> usize {
    let axes = [0, 1].map(|axis| LatticeAxis::new(lattice, axis));
    let mut positions = CellPositions::EMPTY;
    let mut corners = CellCorners { first: [[0f32; 2]; CHUNK], next: [[0f32; 2]; CHUNK] };
    let mut scattered = 0;
    in_chunks(
        at,
        out,
        #[inline(always)]
        |ahead, heights_m| {
            place_in_cells(&axes, &ahead.at, &mut positions);
            let is_scattered = positions.are_scattered();
            scattered += CHUNK * usize::from(is_scattered);
            match tiles.filter(|_| is_scattered) {
                Some(tiles) => gather_tiles(tiles, &positions, ahead, &mut corners),
                None => gather(lattice.heights(), lattice.columns(), &positions, ahead, &mut corners),
            }
            mix(&positions, &corners, heights_m);
        },
        |at| ground_height(lattice, Interpolation::Bilinear, at),
    );
    scattered
}

/// The bilinear heights of a raster at positions in its own coordinates, in meters, as [`raster_height`] answers each.
///
/// # Panics
/// Where the slices are not as long as `at`.
pub(in crate::query) fn bilinear_raster(raster: &Raster, at: &[DVec2], out: HeightSlices<'_>) {
    match &raster.samples {
        Samples::F32(samples) => bilinear_samples(raster, samples, at, out),
        Samples::F64(samples) => bilinear_samples(raster, samples, at, out),
    }
}

fn bilinear_samples<S: Copy + Default + Into<f64>>(
    raster: &Raster,
    samples: &[S],
    at: &[DVec2],
    mut out: HeightSlices<'_>,
) {
    if raster.width < 2 || raster.height < 2 {
        return out.fill(at, |at| raster_height(raster, Interpolation::Bilinear, at));
    }
    vectorized(
        #[inline(always)]
        || sample_passes(raster, samples, at, out),
    );
}

#[inline(always)]
fn sample_passes<S: Copy + Default + Into<f64>>(
    raster: &Raster,
    samples: &[S],
    at: &[DVec2],
    out: HeightSlices<'_>,
) {
    let grid_from_map = raster.map_from_grid.matrix2.inverse();
    let mut positions = CellPositions::EMPTY;
    let mut corners = CellCorners { first: [[S::default(); 2]; CHUNK], next: [[S::default(); 2]; CHUNK] };
    in_chunks(
        at,
        out,
        #[inline(always)]
        |ahead, heights_m| {
            place_between_samples(raster, grid_from_map, &ahead.at, &mut positions);
            gather(samples, raster.width, &positions, ahead, &mut corners);
            mix_by_weights(&positions, &corners, raster.meters_per_z, heights_m);
        },
        |at| raster_height(raster, Interpolation::Bilinear, at),
    );
}

/// Runs `passes` over every full chunk, and `single` for each height that they leave NaN and for the positions after the
/// last full chunk.
#[inline(always)]
fn in_chunks(
    at: &[DVec2],
    out: HeightSlices<'_>,
    mut passes: impl FnMut(&mut ReadAhead<'_>, &mut [f64; CHUNK]),
    single: impl Fn(DVec2) -> Answer,
) {
    out.check_len(at.len());
    let (chunks, rest) = at.as_chunks();
    let (heights_m, rest_m) = out.heights_m.as_chunks_mut();
    let (statuses, rest_statuses) = out.statuses.as_chunks_mut();
    if let Some(first) = chunks.first() {
        let mut ahead = ReadAhead { at: *first, next: first };
        let nexts = chunks.iter().skip(1).chain([first]);
        for (((at, next), heights_m), statuses) in chunks.iter().zip(nexts).zip(heights_m).zip(statuses) {
            ahead.next = next;
            passes(&mut ahead, heights_m);
            mend(at, heights_m, statuses, &single);
        }
    }
    HeightSlices { heights_m: rest_m, statuses: rest_statuses }.fill(rest, &single);
}

/// One axis of a lattice.
struct LatticeAxis {
    origin: f64,
    cell: f64,
    skipped: f64,
    last: f64,
}

impl LatticeAxis {
    fn new(lattice: &Lattice, axis: usize) -> Self {
        Self {
            origin: lattice.origin()[axis],
            cell: lattice.cell()[axis],
            skipped: lattice.first().grid()[axis],
            last: lattice.last_grid()[axis],
        }
    }

    /// The cell of a coordinate on this axis, and the part of it, by the steps of [`Lattice::cell_at`].
    #[inline(always)]
    fn place(&self, at: f64) -> (f64, f64) {
        let grid = (at - self.origin) / self.cell - self.skipped;
        let inside = clamped(grid, self.last);
        let corner = lower_of_pair(inside, self.last);
        (corner, if grid == inside { inside - corner } else { f64::NAN })
    }
}

/// The cells of positions on a lattice and the parts of them, both axes in one loop: each alone would read every other number,
/// which vectors do for all but the last.
#[inline(always)]
fn place_in_cells(axes: &[LatticeAxis; 2], at: &[DVec2; CHUNK], positions: &mut CellPositions) {
    for (index, at) in at.iter().enumerate() {
        (positions.column[index], positions.x[index]) = axes[0].place(at.x);
        (positions.row[index], positions.y[index]) = axes[1].place(at.y);
    }
}

/// The samples west and north of each position and the part of the way to the next, by the steps of
/// [`sandtable_raster::sample`]; NaN for positions on or beyond the outer samples' centers or on lines of centers.
#[inline(always)]
fn place_between_samples(
    raster: &Raster,
    grid_from_map: DMat2,
    at: &[DVec2; CHUNK],
    positions: &mut CellPositions,
) {
    let translation = raster.map_from_grid.translation;
    let last = [f64::from(raster.width - 1), f64::from(raster.height - 1)];
    for (index, &at) in at.iter().enumerate() {
        let grid = grid_from_map * (at - translation);
        (positions.column[index], positions.x[index]) = between_centers(grid.x, last[0]);
        (positions.row[index], positions.y[index]) = between_centers(grid.y, last[1]);
    }
}

/// The sample before a grid coordinate and the part of the way to the next; `last` is the last sample.
#[inline(always)]
fn between_centers(grid: f64, last: f64) -> (f64, f64) {
    let from_first = clamped(grid - 0.5, last);
    let first = lower_of_pair(from_first, last);
    let part = from_first - first;
    (first, if part > ON_CENTER && part < 1.0 - ON_CENTER { part } else { f64::NAN })
}

/// `value` clamped to 0..=`last`; 0 for NaN.
#[inline(always)]
fn clamped(value: f64, last: f64) -> f64 {
    let from_zero = if value > 0.0 { value } else { 0.0 };
    if from_zero < last { from_zero } else { last }
}

/// The lower of the two whole numbers around `value`, which lies within 0..=`last`, both of which do too.
#[inline(always)]
fn lower_of_pair(value: f64, last: f64) -> f64 {
    let nearest = rounded(value);
    let floor = nearest - if nearest > value { 1.0 } else { 0.0 };
    if floor < last - 1.0 { floor } else { last - 1.0 }
}

/// The whole number nearest to `value`, which lies within ±2⁵¹.
#[inline(always)]
pub(in crate::query) fn rounded(value: f64) -> f64 {
    (value + WHOLE) - WHOLE
}

/// A whole number from 0 to 2⁵¹ as an index.
#[inline(always)]
pub(in crate::query) fn index_of(whole: f64) -> usize {
    // The mask also proves to the compiler that nothing overflows where something is added.
    ((whole + WHOLE).to_bits() & ((1 << 51) - 1)) as usize
}

/// Reads the corners from rows of `columns` samples.
#[inline(always)]
fn gather<S: Copy>(
    samples: &[S],
    columns: u32,
    positions: &CellPositions,
    ahead: &mut ReadAhead<'_>,
    corners: &mut CellCorners<S>,
) {
    let stride = columns as usize;
    let mut indices = [0usize; CHUNK];
    for (index, (row, column)) in indices.iter_mut().zip(positions.row.iter().zip(&positions.column)) {
        *index = index_of(row * f64::from(columns) + column);
    }
    for (index, &start) in indices.iter().enumerate() {
        ahead.read(index);
        let cell = &samples[start..][..stride + 2];
        corners.first[index] = [cell[0], cell[1]];
        corners.next[index] = [cell[stride], cell[stride + 1]];
    }
}

/// Reads the corners from tiles.
#[inline(always)]
fn gather_tiles(
    tiles: &HeightTiles,
    positions: &CellPositions,
    ahead: &mut ReadAhead<'_>,
    corners: &mut CellCorners<f32>,
) {
    let mut slots = [TileSlot::default(); CHUNK];
    for (slot, (&column, &row)) in slots.iter_mut().zip(positions.column.iter().zip(&positions.row)) {
        *slot = tiles.slot(column, row);
    }
    for (index, &slot) in slots.iter().enumerate() {
        ahead.read(index);
        [corners.first[index], corners.next[index]] = tiles.corners(slot);
    }
}

/// The formula of [`crate::query::cell::bilinear`].
#[inline(always)]
fn mix(positions: &CellPositions, corners: &CellCorners<f32>, heights_m: &mut [f64; CHUNK]) {
    for (index, height_m) in heights_m.iter_mut().enumerate() {
        let [[sw, se], [nw, ne]] = [corners.first[index].map(f64::from), corners.next[index].map(f64::from)];
        let (south, north) = (sw + (se - sw) * positions.x[index], nw + (ne - nw) * positions.x[index]);
        *height_m = south + (north - south) * positions.y[index];
    }
}

/// The formula of [`sandtable_raster::sample`], where all four corners count.
#[inline(always)]
fn mix_by_weights<S: Copy + Into<f64>>(
    positions: &CellPositions,
    corners: &CellCorners<S>,
    meters_per_z: f64,
    heights_m: &mut [f64; CHUNK],
) {
    for (index, height_m) in heights_m.iter_mut().enumerate() {
        let (across, down) = (positions.x[index], positions.y[index]);
        let weights =
            [(1.0 - across) * (1.0 - down), across * (1.0 - down), (1.0 - across) * down, across * down];
        let [[a, b], [c, d]] = [corners.first[index].map(S::into), corners.next[index].map(S::into)];
        let sum = 0.0 + weights[0] * a + weights[1] * b + weights[2] * c + weights[3] * d;
        let total = 0.0 + weights[0] + weights[1] + weights[2] + weights[3];
        *height_m = sum / total * meters_per_z;
    }
}

/// Sets the statuses of a chunk, and queries every position whose height is NaN by itself.
#[inline(always)]
fn mend(
    at: &[DVec2; CHUNK],
    heights_m: &mut [f64; CHUNK],
    statuses: &mut [Status; CHUNK],
    answer: impl Fn(DVec2) -> Answer,
) {
    statuses.fill(Status::Ok);
    // Counted rather than searched: a loop that may end early is not vectorized.
    let missing: u64 = heights_m.iter().map(|height_m| u64::from(height_m.is_nan())).sum();
    if missing == 0 {
        return;
    }
    for ((&at, height_m), status) in at.iter().zip(heights_m).zip(statuses) {
        if height_m.is_nan() {
            (*height_m, *status) = answer(at).parts();
        }
    }
}
