//! Many bilinear heights at once, to the last bit what single questions answer, several times as fast.
//!
//! Positions go through in chunks of 128, each in three passes over arrays on the stack, so that the compiler makes
//! vector code of the first and the last, and nothing but reads is left in the second, where many cache misses are then
//! under way at once:
//!
//! ```text
//! positions ─► cell and part of it ─► four corners of each ─► height
//!              (vectors)              (reads only)            (vectors)
//! ```
//!
//! No pass branches on what it finds. A position outside, and one that a special rule applies to, gets NaN for its part of
//! the cell, a hole has NaN for its height, and both come out as NaN heights: those are asked again one by one. So one
//! rule decides every special case, and the passes need only be right where all goes well.
//!
//! **Layout.** Row by row, the four corners of a cell lie in two cache lines and two pages. Positions near each other share
//! them; scattered over a large ground, each costs two misses. Scattered chunks therefore read [`HeightTiles`], once it is
//! made, where a cell lies in one line.
//!
//! Only the instructions that every x86-64 has are used (SSE2): choosing wider ones while running needs `unsafe` calls,
//! which this crate forbids. Rounding down is therefore done by adding and taking away a large number.

use std::array::TryFromSliceError;

use glam::{DMat2, DVec2};
use rayon::prelude::*;

use crate::dem::answer::{Answer, Status};
use crate::dem::raster::{Raster, Samples};
use crate::dem::sample::ON_CENTER;
use crate::terrain::lattice::Lattice;
use crate::terrain::query::source::raster_height;
use crate::terrain::query::tiles::{HeightTiles, TileSlot};
use crate::terrain::query::{Interpolation, ground_height};

/// Positions per chunk: the arrays of one take 6 KiB and stay in the first cache. With fewer than 32 the passes cost
/// more than what is in them, with more than 512 the arrays leave the cache.
const CHUNK: usize = 128;

/// Positions per task of a batch that is spread over threads: a few hundredths of a millisecond.
pub const TASK: usize = 4096;

/// Positions of which [`answers`] keeps heights and statuses apart at a time, on the stack.
const PARTS: usize = 4 * CHUNK;

/// A chunk whose positions span more rows than this is scattered: each then has pages of its own.
const COHERENT_ROWS: f64 = 64.0;

/// 1.5 · 2⁵²: a number added to it is rounded to a whole one, which its lowest bits then hold.
const WHOLE: f64 = 6_755_399_441_055_744.0;

/// Where the positions of a chunk lie: the cell's column and row, whole numbers, and the part of it, east and north (of a
/// raster: south); NaN for what must be asked by itself.
struct CellPositions {
    column: [f64; CHUNK],
    row: [f64; CHUNK],
    x: [f64; CHUNK],
    y: [f64; CHUNK],
}

/// The corners of the cells of a chunk: of each two in the row that comes first, and two in the next.
struct CellCorners<S> {
    first: [[S; 2]; CHUNK],
    next: [[S; 2]; CHUNK],
}

impl CellPositions {
    const EMPTY: Self = Self { column: [0.0; CHUNK], row: [0.0; CHUNK], x: [0.0; CHUNK], y: [0.0; CHUNK] };

    /// Whether the positions lie so far apart that each has cache lines of its own.
    fn are_scattered(&self) -> bool {
        let (mut low, mut high) = (self.row[0], self.row[0]);
        for &row in &self.row {
            low = if row < low { row } else { low };
            high = if row > high { row } else { high };
        }
        high - low > COHERENT_ROWS
    }
}

/// Spreads positions over all threads and joins what `task` says of them, heights (NaN where there is none) and statuses,
/// to answers.
///
/// # Panics
/// Where `out` is not as long as `at`.
pub fn answers(
    at: &[DVec2],
    out: &mut [Answer],
    task: impl Fn(&[DVec2], (&mut [f64], &mut [Status])) + Sync,
) {
    assert_eq!(at.len(), out.len(), "one answer per position");
    at.par_chunks(TASK).zip(out.par_chunks_mut(TASK)).for_each(|(at, out)| {
        let (mut heights_m, mut statuses) = ([0.0; PARTS], [Status::Ok; PARTS]);
        for (at, out) in at.chunks(PARTS).zip(out.chunks_mut(PARTS)) {
            let (heights_m, statuses) = (&mut heights_m[..at.len()], &mut statuses[..at.len()]);
            task(at, (&mut *heights_m, &mut *statuses));
            for ((out, &height_m), &status) in out.iter_mut().zip(&*heights_m).zip(&*statuses) {
                *out = status.with_height(height_m);
            }
        }
    });
}

/// The bilinear heights of the ground at map positions: [`ground_height`] of each, NaN where it answers none, and the
/// statuses beside them. Scattered positions read `tiles` where they are given. Returns how many positions were
/// scattered.
///
/// # Panics
/// Where the three slices are not equally long.
pub fn bilinear_ground(
    lattice: &Lattice,
    tiles: Option<&HeightTiles>,
    at: &[DVec2],
    (heights_m, statuses): (&mut [f64], &mut [Status]),
) -> usize {
    assert_eq!((at.len(), at.len()), (heights_m.len(), statuses.len()), "one answer per position");
    let axes = [0, 1].map(|axis| LatticeAxis::of(lattice, axis));
    let mut places = CellPositions::EMPTY;
    let mut corners = CellCorners { first: [[0f32; 2]; CHUNK], next: [[0f32; 2]; CHUNK] };
    let mut scattered = 0;
    for ((at, heights_m), statuses) in
        at.chunks(CHUNK).zip(heights_m.chunks_mut(CHUNK)).zip(statuses.chunks_mut(CHUNK))
    {
        if let (Ok(at), Ok(heights_m)) = whole_chunk(at, heights_m) {
            axes[0].place::<0>(at, &mut places.column, &mut places.x);
            axes[1].place::<1>(at, &mut places.row, &mut places.y);
            let is_scattered = places.are_scattered();
            scattered += CHUNK * usize::from(is_scattered);
            match tiles.filter(|_| is_scattered) {
                Some(tiles) => gather_tiles(tiles, &places, &mut corners),
                None => gather(lattice.heights(), lattice.columns(), &places, &mut corners),
            }
            mix(&places, &corners, heights_m);
        } else {
            heights_m.fill(f64::NAN);
        }
        mend(at, heights_m, statuses, |at| ground_height(lattice, Interpolation::Bilinear, at).parts());
    }
    scattered
}

/// The bilinear heights of a raster at positions in its own coordinates, in meters: [`raster_height`] of each, NaN where
/// it answers none, and the statuses beside them.
///
/// # Panics
/// Where the three slices are not equally long.
pub fn bilinear_raster(raster: &Raster, at: &[DVec2], (heights_m, statuses): (&mut [f64], &mut [Status])) {
    assert_eq!((at.len(), at.len()), (heights_m.len(), statuses.len()), "one answer per position");
    match &raster.samples {
        Samples::F32(samples) => bilinear_samples(raster, samples, at, (heights_m, statuses)),
        Samples::F64(samples) => bilinear_samples(raster, samples, at, (heights_m, statuses)),
    }
}

fn bilinear_samples<S: Copy + Default + Into<f64>>(
    raster: &Raster,
    samples: &[S],
    at: &[DVec2],
    (heights_m, statuses): (&mut [f64], &mut [Status]),
) {
    let grid_from_map = raster.map_from_grid.matrix2.inverse();
    let has_cells = raster.width >= 2 && raster.height >= 2;
    let mut places = CellPositions::EMPTY;
    let mut corners = CellCorners { first: [[S::default(); 2]; CHUNK], next: [[S::default(); 2]; CHUNK] };
    for ((at, heights_m), statuses) in
        at.chunks(CHUNK).zip(heights_m.chunks_mut(CHUNK)).zip(statuses.chunks_mut(CHUNK))
    {
        match whole_chunk(at, heights_m) {
            (Ok(at), Ok(heights_m)) if has_cells => {
                place_between_samples(raster, grid_from_map, at, &mut places);
                gather(samples, raster.width, &places, &mut corners);
                mix_by_weights(&places, &corners, raster.meters_per_z, heights_m);
            }
            _ => heights_m.fill(f64::NAN),
        }
        mend(at, heights_m, statuses, |at| raster_height(raster, Interpolation::Bilinear, at).parts());
    }
}

/// Slices as arrays, whose length the compiler knows; the last chunk of a batch may be shorter.
type ArrayChunks<'a> =
    (Result<&'a [DVec2; CHUNK], TryFromSliceError>, Result<&'a mut [f64; CHUNK], TryFromSliceError>);

#[inline(always)]
fn whole_chunk<'a>(at: &'a [DVec2], heights_m: &'a mut [f64]) -> ArrayChunks<'a> {
    (at.try_into(), heights_m.try_into())
}

/// One axis of a lattice.
struct LatticeAxis {
    origin: f64,
    cell: f64,
    skipped: f64,
    last: f64,
}

impl LatticeAxis {
    fn of(lattice: &Lattice, axis: usize) -> Self {
        let first = lattice.first();
        let posts = [lattice.columns(), lattice.rows()][axis];
        Self {
            origin: lattice.origin()[axis],
            cell: lattice.cell()[axis],
            skipped: f64::from([first.column, first.row][axis]),
            last: f64::from(posts - 1),
        }
    }

    /// The cell of each position on this axis, 0 or 1, and the part of it, by the steps of [`Lattice::cell_at`].
    #[inline(always)]
    fn place<const AXIS: usize>(
        &self,
        at: &[DVec2; CHUNK],
        cell: &mut [f64; CHUNK],
        part: &mut [f64; CHUNK],
    ) {
        for (index, at) in at.iter().enumerate() {
            let grid = (at.to_array()[AXIS] - self.origin) / self.cell - self.skipped;
            let held = held_within(grid, self.last);
            let floor = rounded_down(held);
            let corner = if floor < self.last - 1.0 { floor } else { self.last - 1.0 };
            cell[index] = corner;
            part[index] = if grid == held { held - corner } else { f64::NAN };
        }
    }
}

/// The samples west and north of each position and the part of the way to the next, by the steps of
/// [`crate::dem::sample`]; NaN for positions on or beyond the outer samples' centers or on lines of centers.
fn place_between_samples(
    raster: &Raster,
    grid_from_map: DMat2,
    at: &[DVec2; CHUNK],
    places: &mut CellPositions,
) {
    let translation = raster.map_from_grid.translation;
    let last = [f64::from(raster.width - 1), f64::from(raster.height - 1)];
    let part_of = |grid: f64, last: f64| {
        let from_first = held_within(grid - 0.5, last);
        let floor = rounded_down(from_first);
        let first = if floor < last - 1.0 { floor } else { last - 1.0 };
        let part = from_first - first;
        (first, if part > ON_CENTER && part < 1.0 - ON_CENTER { part } else { f64::NAN })
    };
    for (index, &at) in at.iter().enumerate() {
        let grid = grid_from_map * (at - translation);
        (places.column[index], places.x[index]) = part_of(grid.x, last[0]);
        (places.row[index], places.y[index]) = part_of(grid.y, last[1]);
    }
}

/// `value` held to 0..=`last`; 0 for NaN.
#[inline(always)]
fn held_within(value: f64, last: f64) -> f64 {
    let from_zero = if value > 0.0 { value } else { 0.0 };
    if from_zero < last { from_zero } else { last }
}

/// The whole number nearest to `value`, which lies within ±2⁵¹.
#[inline(always)]
pub(in crate::terrain::query) fn rounded(value: f64) -> f64 {
    (value + WHOLE) - WHOLE
}

/// The whole number at or below `value`, which lies within ±2⁵¹.
#[inline(always)]
fn rounded_down(value: f64) -> f64 {
    let nearest = rounded(value);
    nearest - if nearest > value { 1.0 } else { 0.0 }
}

/// A whole number from 0 to 2⁵¹ as an index.
#[inline(always)]
pub(in crate::terrain::query) fn index_of(whole: f64) -> usize {
    (whole + WHOLE).to_bits().wrapping_sub(WHOLE.to_bits()) as usize
}

/// Reads the corners from rows of `columns` samples.
fn gather<S: Copy>(samples: &[S], columns: u32, places: &CellPositions, corners: &mut CellCorners<S>) {
    let stride = columns as usize;
    let mut indices = [0usize; CHUNK];
    for (index, (row, column)) in indices.iter_mut().zip(places.row.iter().zip(&places.column)) {
        *index = index_of(row * f64::from(columns) + column);
    }
    for (index, &start) in indices.iter().enumerate() {
        let cell = &samples[start..][..stride + 2];
        corners.first[index] = [cell[0], cell[1]];
        corners.next[index] = [cell[stride], cell[stride + 1]];
    }
}

/// Reads the corners from tiles.
fn gather_tiles(tiles: &HeightTiles, places: &CellPositions, corners: &mut CellCorners<f32>) {
    let mut slots = [TileSlot::default(); CHUNK];
    for (slot, (&column, &row)) in slots.iter_mut().zip(places.column.iter().zip(&places.row)) {
        *slot = tiles.slot(column, row);
    }
    for (index, &slot) in slots.iter().enumerate() {
        [corners.first[index], corners.next[index]] = tiles.corners(slot);
    }
}

/// The formula of [`crate::terrain::query::cell::bilinear`].
fn mix(places: &CellPositions, corners: &CellCorners<f32>, heights_m: &mut [f64; CHUNK]) {
    for (index, height_m) in heights_m.iter_mut().enumerate() {
        let [[sw, se], [nw, ne]] = [corners.first[index].map(f64::from), corners.next[index].map(f64::from)];
        let (south, north) = (sw + (se - sw) * places.x[index], nw + (ne - nw) * places.x[index]);
        *height_m = south + (north - south) * places.y[index];
    }
}

/// The formula of [`crate::dem::sample`], where all four corners count.
fn mix_by_weights<S: Copy + Into<f64>>(
    places: &CellPositions,
    corners: &CellCorners<S>,
    meters_per_z: f64,
    heights_m: &mut [f64; CHUNK],
) {
    for (index, height_m) in heights_m.iter_mut().enumerate() {
        let (across, down) = (places.x[index], places.y[index]);
        let weights =
            [(1.0 - across) * (1.0 - down), across * (1.0 - down), (1.0 - across) * down, across * down];
        let [[a, b], [c, d]] = [corners.first[index].map(S::into), corners.next[index].map(S::into)];
        let sum = 0.0 + weights[0] * a + weights[1] * b + weights[2] * c + weights[3] * d;
        let total = 0.0 + weights[0] + weights[1] + weights[2] + weights[3];
        *height_m = sum / total * meters_per_z;
    }
}

/// Sets the statuses of a chunk, and asks again by itself for every height that is NaN.
fn mend(
    at: &[DVec2],
    heights_m: &mut [f64],
    statuses: &mut [Status],
    alone: impl Fn(DVec2) -> (f64, Status),
) {
    statuses.fill(Status::Ok);
    // Counted rather than sought: a search that may end early is no vector code.
    let missing: u64 = heights_m.iter().map(|height_m| u64::from(height_m.is_nan())).sum();
    if missing == 0 {
        return;
    }
    for ((&at, height_m), status) in at.iter().zip(heights_m).zip(statuses) {
        if height_m.is_nan() {
            (*height_m, *status) = alone(at);
        }
    }
}
