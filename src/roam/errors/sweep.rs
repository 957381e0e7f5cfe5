//! One sweep over all vertices, finest level first, that computes each vertex's error by a measure and raises it to those
//! of its children.
//!
//! The rows of a level are streamed from south to north through a small working set, and every level passes to the next
//! coarser one every other post of every other row and one error a cell:
//!
//! ```text
//! high  e───E───e───E───e    e  evens: the posts of the next coarser level
//!       │       │       │    E  east edges:  own, raised to the cells around
//! mid   N   C   N   C   N    N  north edges: own, raised to the cells around
//!       │       │       │    C  centers:     own, raised to the four edges around;
//! low   e───E───e───E───e       the cells of the next coarser level
//! ```
//!
//! Heights are read once and errors are written once, all else stays in the cache, and every loop runs over contiguous
//! slices, written so that compilers vectorize it for any processor. A recursion over triangles would visit the same vertices
//! in an order that neither caches nor vector units can follow. Bands of rows run in parallel and start a few rows early
//! instead of waiting for each other; levels coarser than a band follow, on a lattice a sixty-fourth the size.

use rayon::prelude::*;

use crate::errors::scan::larger;
use crate::layout::PatchLayout;

/// A measure of a vertex's own error.
pub trait OwnError {
    /// Whether values may be NaN. Where they may not, a sweep stops at the first NaN.
    const HOLES: bool;

    /// The own error of a vertex from the values at the ends of its hypotenuse and at itself.
    fn own(from: f32, to: f32, at: f32) -> f32;
}

/// Own errors that are already known, at their vertices.
pub struct KnownErrors;

impl OwnError for KnownErrors {
    const HOLES: bool = true;

    fn own(_: f32, _: f32, at: f32) -> f32 {
        at
    }
}

/// Levels that a band sweeps in one go. Its rows start 2³ rows early; the rest is 1/64 of the vertices.
const BAND_LEVELS: u32 = 3;

/// Rows of a band at least, so that the rows it starts early are few beside its own.
const BAND_ROWS: usize = 64;

/// Rows of a band at most whose values are made when it is swept: few enough that they are still in the cache then, and many
/// beside those that it starts early.
const MADE_ROWS: usize = 256;

/// A lattice of values, one error a cell of it, and where errors go.
#[derive(Clone, Copy)]
pub struct SweepSource<'a> {
    /// Heights or own errors, row by row.
    values: &'a [f32],
    /// The row of the first of them.
    first_row: usize,
    /// The largest error below each cell; none on the finest level.
    cells: Option<&'a [f32]>,
    columns: usize,
    rows: usize,
    /// Cells along a patch's side.
    patch: usize,
}

impl<'a> SweepSource<'a> {
    /// One value a vertex of the layout.
    ///
    /// # Panics
    /// Unless there is.
    pub fn new(values: &'a [f32], layout: &PatchLayout) -> Self {
        assert_eq!(values.len(), layout.vertex_count(), "one value a vertex");
        let (columns, rows) = (layout.columns(), layout.rows());
        Self { values, first_row: 0, cells: None, columns, rows, patch: layout.patch() as usize }
    }

    /// Writes every vertex's error, 0 at the patch corners. In parallel, the same for any number of threads.
    ///
    /// Returns `false`, and leaves `out` meaningless, where a value is NaN and the measure allows none.
    #[must_use]
    pub fn sweep<M: OwnError>(&self, out: &mut [f32]) -> bool {
        let levels = self.band_levels();
        let side = 1usize << levels;
        let (columns, rows) = self.coarse_cells(side);
        let mut cells = vec![0f32; columns * rows];
        let mut bands = self.bands(side, usize::MAX, (1, &mut *out), &mut cells);
        let sound = match bands.as_mut_slice() {
            [only] => only.sweep::<M>(levels),
            many => many.par_iter_mut().map(|band| band.sweep::<M>(levels)).reduce(|| true, |a, b| a && b),
        };
        if side == self.patch || !sound {
            return sound;
        }
        let mut values = vec![0f32; (columns + 1) * (rows + 1)];
        let from_rows = self.values.chunks_exact(self.columns).step_by(side);
        for (coarse, fine) in values.chunks_exact_mut(columns + 1).zip(from_rows) {
            copy_every(side, fine, coarse);
        }
        self.sweep_coarse::<M>((&values, &cells), side, (1, out))
    }

    /// Writes the errors of the vertices of a layout in every `every`-th column and row, 1 or 2, from the own ones of all: `own` writes
    /// these into zeros, row by row from a row on that is a multiple of 8, or of the patch. No more of them are held than those of a
    /// few rows for each thread; those of some rows are made twice. In parallel, the same for any number of threads.
    pub fn sweep_made(
        layout: &PatchLayout,
        own: impl Fn(usize, &mut [f32]) + Sync,
        every: usize,
        out: &mut [f32],
    ) {
        let (columns, rows) = (layout.columns(), layout.rows());
        let source = SweepSource {
            values: &[],
            first_row: 0,
            cells: None,
            columns,
            rows,
            patch: layout.patch() as usize,
        };
        let levels = source.band_levels();
        let side = 1usize << levels;
        let (coarse_columns, coarse_rows) = source.coarse_cells(side);
        let mut cells = vec![0f32; coarse_columns * coarse_rows];
        let mut values = vec![0f32; (coarse_columns + 1) * (coarse_rows + 1)];
        let bands = source.bands(side, MADE_ROWS, (every, &mut *out), &mut cells);
        let mut rest = values.as_mut_slice();
        let mut coarse = Vec::with_capacity(bands.len());
        for band in &bands {
            let (own, others) =
                std::mem::take(&mut rest).split_at_mut(band.rows.div_ceil(side) * (coarse_columns + 1));
            coarse.push(own);
            rest = others;
        }
        bands.into_par_iter().zip(coarse).with_max_len(1).for_each(|(band, coarse)| {
            let SweepReach { south, north } = band.reach(levels);
            let mut values = vec![0f32; (north + 1 - south) * columns];
            own(south, &mut values);
            let kept = values[(band.first - south) * columns..].chunks_exact(columns).step_by(side);
            for (coarse, fine) in coarse.chunks_exact_mut(coarse_columns + 1).zip(kept) {
                copy_every(side, fine, coarse);
            }
            let source = SweepSource { values: &values, first_row: south, ..band.source };
            let mut all = vec![0f32; if every == 1 { 0 } else { band.rows * columns }];
            let SweepBand { first, rows, out, cells, .. } = band;
            let written = if every == 1 { &mut *out } else { &mut all };
            let sound = SweepBand { source, first, rows, out: written, cells }.sweep::<KnownErrors>(levels);
            debug_assert!(sound, "own errors are taken as they are");
            let kept = all.chunks_exact(columns).step_by(every);
            for (out, all) in out.chunks_exact_mut((columns - 1) / every + 1).zip(kept) {
                copy_every(every, all, out);
            }
        });
        if side < source.patch {
            let sound = source.sweep_coarse::<KnownErrors>((&values, &cells), side, (every, out));
            debug_assert!(sound, "own errors are taken as they are");
        }
    }

    /// Levels that bands sweep.
    fn band_levels(&self) -> u32 {
        self.patch.ilog2().min(BAND_LEVELS)
    }

    /// Columns and rows of cells of `side`.
    fn coarse_cells(&self, side: usize) -> (usize, usize) {
        ((self.columns - 1) / side, (self.rows - 1) / side)
    }

    /// Sweeps the levels coarser than those of bands: `values` are those of every vertex on a multiple of `side`, `cells` the errors
    /// below each cell between them; `out` holds every `every`-th column and row.
    fn sweep_coarse<M: OwnError>(
        &self,
        (values, cells): (&[f32], &[f32]),
        side: usize,
        (every, out): (usize, &mut [f32]),
    ) -> bool {
        let (columns, rows) = self.coarse_cells(side);
        let patch = self.patch / side;
        let (columns, rows) = (columns + 1, rows + 1);
        let source = SweepSource { values, first_row: 0, cells: Some(cells), columns, rows, patch };
        let mut errors = vec![0f32; values.len()];
        let sound = source.sweep::<M>(&mut errors);
        let step = side / every;
        let to_rows = out.chunks_exact_mut((self.columns - 1) / every + 1).step_by(step);
        for (coarse, fine) in errors.chunks_exact(columns).zip(to_rows) {
            coarse.iter().zip(fine.iter_mut().step_by(step)).for_each(|(coarse, fine)| *fine = *coarse);
        }
        sound
    }

    /// Bands of rows, each a multiple of `side` and at most about `most`, the last with one row more; `out` holds every `every`-th
    /// column and row.
    fn bands<'b>(
        &self,
        side: usize,
        most: usize,
        (every, mut out): (usize, &'b mut [f32]),
        mut cells: &'b mut [f32],
    ) -> Vec<SweepBand<'b>>
    where
        'a: 'b,
    {
        let threads = rayon::current_num_threads();
        let height = match threads {
            1 => self.rows,
            _ => ((self.rows - 1).div_ceil(threads * 4)).max(BAND_ROWS),
        };
        let height = height.min(most).next_multiple_of(side);
        let mut bands = Vec::new();
        let mut first = 0;
        while first + 1 < self.rows {
            let rest = self.rows - first;
            // The last row alone is no band.
            let rows = if rest <= height + 1 { rest } else { height };
            let (own, others) = out.split_at_mut(rows.div_ceil(every) * ((self.columns - 1) / every + 1));
            let (own_cells, other_cells) = cells.split_at_mut(rows / side * ((self.columns - 1) / side));
            bands.push(SweepBand { source: *self, first, rows, out: own, cells: own_cells });
            (out, cells, first) = (others, other_cells, first + rows);
        }
        bands
    }
}

/// Rows that one thread writes.
struct SweepBand<'a> {
    source: SweepSource<'a>,
    first: usize,
    rows: usize,
    out: &'a mut [f32],
    /// The errors of the coarsest centers, one for every square between the band's rows.
    cells: &'a mut [f32],
}

/// The working set of a level: the last rows from the next finer one, and what was computed from them.
#[derive(Default)]
struct SweepLevel {
    /// Source by row modulo 4.
    rows: [Vec<f32>; 4],
    /// Errors of the cells by row modulo 4, with a 0 before and after each row.
    cells: [Vec<f32>; 4],
    /// Every other value of a row.
    odds: Vec<f32>,
    mid_evens: Vec<f32>,
    low_east: Vec<f32>,
    high_east: Vec<f32>,
    north: Vec<f32>,
    center: Vec<f32>,
    around: Vec<f32>,
    /// Written by the finest level where coarser ones write later.
    zeros: Vec<f32>,
}

impl SweepLevel {
    fn new(columns: usize) -> Self {
        let row = |length: usize| vec![0f32; length];
        Self {
            rows: std::array::from_fn(|_| row(columns)),
            cells: std::array::from_fn(|_| row(columns + 1)),
            odds: row(columns / 2),
            mid_evens: row(columns / 2 + 1),
            low_east: row(columns / 2),
            high_east: row(columns / 2),
            north: row(columns / 2 + 1),
            center: row(columns / 2),
            around: row(columns + 1),
            zeros: row(columns / 2),
        }
    }
}

/// Where a sweep of a band starts and ends: rows of the source, ends included.
#[derive(Clone, Copy)]
struct SweepReach {
    south: usize,
    north: usize,
}

impl SweepBand<'_> {
    /// The rows that a sweep of `levels` reads.
    fn reach(&self, levels: u32) -> SweepReach {
        // The ends of the reach give wrong values within the coarsest square beside them.
        let early = 1usize << levels;
        let south = self.first.saturating_sub(early);
        let north = (self.first + self.rows - 1).next_multiple_of(early) + early;
        SweepReach { south, north: north.min(self.source.rows - 1) }
    }

    fn sweep<M: OwnError>(&mut self, levels: u32) -> bool {
        let reach = self.reach(levels);
        let mut stages: Vec<SweepLevel> =
            (0..=levels).map(|level| SweepLevel::new(((self.source.columns - 1) >> level) + 1)).collect();
        for pair in 0..(reach.north - reach.south) / 2 {
            if !M::HOLES && self.has_hole(reach, pair) {
                return false;
            }
            self.take_cells(&mut stages[0], reach, pair);
            self.step::<M>(&mut stages, 0, reach, pair);
        }
        true
    }

    /// Whether a value is NaN, of those that one step of the finest level reads first.
    fn has_hole(&self, reach: SweepReach, pair: usize) -> bool {
        let columns = self.source.columns;
        let rows = if pair == 0 { 0..3 } else { 2 * pair + 1..2 * pair + 3 };
        let values = &self.source.values[(reach.south - self.source.first_row + rows.start) * columns..];
        values[..rows.len() * columns].iter().fold(false, |hole, value| hole | value.is_nan())
    }

    /// Copies the cells that one step needs into the finest stage.
    fn take_cells(&self, stage: &mut SweepLevel, reach: SweepReach, pair: usize) {
        let Some(cells) = self.source.cells else { return };
        let width = self.source.columns - 1;
        for row in 2 * pair..2 * pair + 3 {
            let kept = &mut stage.cells[row % 4][1..=width];
            match cells.chunks_exact(width).nth(reach.south + row) {
                Some(cells) => kept.copy_from_slice(cells),
                None => kept.fill(0.0),
            }
        }
    }

    /// Works off rows 2·pair to 2·pair + 2 of a level, counted from the reach's south end in the level's steps.
    fn step<M: OwnError>(&mut self, stages: &mut [SweepLevel], level: usize, reach: SweepReach, pair: usize) {
        let last = ((reach.north - reach.south) >> (level + 1)) - 1;
        let (finer, coarser) = stages.split_at_mut(level + 1);
        let (here, next) = (&mut finer[level], &mut coarser[0]);
        let source = self.source;
        let SweepLevel { rows, cells, odds, mid_evens, low_east, high_east, north, center, around, zeros } =
            here;
        let row = |index: usize| match level {
            0 => {
                &source.values[(reach.south - source.first_row + index) * source.columns..][..source.columns]
            }
            _ => rows[index % 4].as_slice(),
        };
        let raised = level > 0 || source.cells.is_some();
        if pair == 0 {
            split(row(0), &mut next.rows[0], odds);
            own_east::<M>(&next.rows[0], odds, high_east);
            if raised {
                raise_east(&cells[0], high_east);
            }
            self.write_east(level, reach.south, high_east, zeros);
        }
        std::mem::swap(low_east, high_east);
        split(row(2 * pair + 2), &mut next.rows[(pair + 1) % 4], odds);
        let (low_evens, high_evens) = (&next.rows[pair % 4], &next.rows[(pair + 1) % 4]);
        own_east::<M>(high_evens, odds, high_east);
        split(row(2 * pair + 1), mid_evens, odds);
        own_north::<M>(low_evens, mid_evens, high_evens, north);
        if raised {
            larger_of_rows(&cells[2 * pair % 4], &cells[(2 * pair + 1) % 4], around);
            raise_north(around, north);
            if pair == last {
                cells[(2 * pair + 2) % 4].fill(0.0);
            }
            larger_of_rows(&cells[(2 * pair + 1) % 4], &cells[(2 * pair + 2) % 4], around);
            raise_east(around, high_east);
        }
        let squares_south = reach.south >> (level + 1);
        if (squares_south + pair).is_multiple_of(2) {
            own_center::<M>(low_evens, odds, high_evens, center);
        } else {
            own_center::<M>(high_evens, odds, low_evens, center);
        }
        raise_center(low_east, high_east, north, center);
        next.cells[pair % 4][1..=center.len()].copy_from_slice(center);

        self.write_mid(level, reach.south + ((2 * pair + 1) << level), north, center);
        self.write_east(level, reach.south + ((2 * pair + 2) << level), high_east, zeros);
        if level + 2 == stages.len() {
            let center = &stages[level].center;
            self.write_cells(level, reach.south + ((2 * pair) << level), center);
            return;
        }
        if pair >= 2 && pair.is_multiple_of(2) {
            self.step::<M>(stages, level + 1, reach, pair / 2 - 1);
        }
        if pair == last {
            self.step::<M>(stages, level + 1, reach, pair / 2);
        }
    }

    /// The row's slice of the output, where the band writes it.
    fn out_row(&mut self, row: usize) -> Option<&mut [f32]> {
        let columns = self.source.columns;
        let own = row.checked_sub(self.first).filter(|&own| own < self.rows)?;
        Some(&mut self.out[own * columns..][..columns])
    }

    fn write_east(&mut self, level: usize, row: usize, east: &[f32], zeros: &[f32]) {
        let Some(out) = self.out_row(row) else { return };
        if level == 0 {
            join(zeros, east, out);
            *out.last_mut().expect("a row has at least three vertices") = 0.0;
        } else {
            let spots = out[1 << level..].iter_mut().step_by(2 << level);
            spots.zip(east).for_each(|(spot, &east)| *spot = east);
        }
    }

    fn write_mid(&mut self, level: usize, row: usize, north: &[f32], center: &[f32]) {
        let Some(out) = self.out_row(row) else { return };
        let step = 1 << level;
        if level == 0 {
            join(north, center, out);
        } else {
            let squares = out.chunks_exact_mut(2 * step).zip(north.iter().zip(center));
            squares.for_each(|(square, (&north, &center))| (square[0], square[step]) = (north, center));
        }
        if let (Some(spot), Some(&north)) = (out.last_mut(), north.last()) {
            *spot = north;
        }
    }

    fn write_cells(&mut self, level: usize, row: usize, center: &[f32]) {
        let Some(own) = row.checked_sub(self.first) else { return };
        let width = center.len();
        if let Some(cells) =
            self.cells.get_mut((own >> (level + 1)) * width..).filter(|rest| !rest.is_empty())
        {
            cells[..width].copy_from_slice(center);
        }
    }
}

/// Copies every `side`-th value of a row.
fn copy_every(side: usize, fine: &[f32], coarse: &mut [f32]) {
    coarse.iter_mut().zip(fine.iter().step_by(side)).for_each(|(coarse, fine)| *coarse = *fine);
}

/// A row's values at even places, of which there is one more, and at odd ones.
///
/// Pairs are read as one number, which compilers turn into shuffles; a plain loop becomes single loads.
fn split(row: &[f32], evens: &mut [f32], odds: &mut [f32]) {
    let pairs = bytemuck::cast_slice::<f32, u8>(row).as_chunks::<8>().0;
    for (pair, (even, odd)) in pairs.iter().zip(evens.iter_mut().zip(odds)) {
        let both = u64::from_ne_bytes(*pair);
        let halves = [both as u32, (both >> 32) as u32].map(f32::from_bits);
        [*even, *odd] = if cfg!(target_endian = "little") { halves } else { [halves[1], halves[0]] };
    }
    if let (Some(end), Some(last)) = (evens.last_mut(), row.last()) {
        *end = *last;
    }
}

/// The inverse of [`split`], but for the last value; by fours, which compilers make shuffles of.
fn join(evens: &[f32], odds: &[f32], row: &mut [f32]) {
    let fours = odds.len() / 4 * 4;
    let both = evens.as_chunks::<4>().0.iter().zip(odds.as_chunks::<4>().0);
    for (out, (e, o)) in row.as_chunks_mut::<8>().0.iter_mut().zip(both) {
        *out = [e[0], o[0], e[1], o[1], e[2], o[2], e[3], o[3]];
    }
    let rest = evens[fours..].iter().zip(&odds[fours..]);
    for (out, (&even, &odd)) in row[2 * fours..].as_chunks_mut::<2>().0.iter_mut().zip(rest) {
        *out = [even, odd];
    }
}

fn own_east<M: OwnError>(evens: &[f32], odds: &[f32], out: &mut [f32]) {
    let ends = evens.iter().zip(&evens[1..]);
    for (out, (&at, (&west, &east))) in out.iter_mut().zip(odds.iter().zip(ends)) {
        *out = M::own(west, east, at);
    }
}

fn own_north<M: OwnError>(low: &[f32], mid: &[f32], high: &[f32], out: &mut [f32]) {
    let ends = low.iter().zip(high);
    for (out, (&at, (&south, &north))) in out.iter_mut().zip(mid.iter().zip(ends)) {
        *out = M::own(south, north, at);
    }
}

/// The hypotenuse of an even center joins the near row's value before it to the far row's after it, that of an odd
/// one the near row's after it to the far row's before it. Chosen by masks: a condition would keep the loop scalar.
fn own_center<M: OwnError>(near: &[f32], odds: &[f32], far: &[f32], out: &mut [f32]) {
    let count = out.len();
    let (near, near_after, far, far_after) =
        (&near[..count], &near[1..=count], &far[..count], &far[1..=count]);
    let odds = &odds[..count];
    for index in 0..count {
        let mask = 0u32.wrapping_sub(index as u32 & 1);
        let pick = |even: f32, odd: f32| f32::from_bits(even.to_bits() & !mask | odd.to_bits() & mask);
        let from = pick(near[index], near_after[index]);
        let to = pick(far_after[index], far[index]);
        out[index] = M::own(from, to, odds[index]);
    }
}

fn larger_of_rows(low: &[f32], high: &[f32], out: &mut [f32]) {
    out.iter_mut().zip(low.iter().zip(high)).for_each(|(out, (&low, &high))| *out = larger(low, high));
}

/// `around` holds the cells beside a row, with a 0 before and after.
fn raise_east(around: &[f32], east: &mut [f32]) {
    let pairs = around[1..].as_chunks::<2>().0;
    east.iter_mut().zip(pairs).for_each(|(east, &[a, b])| *east = larger(*east, larger(a, b)));
}

fn raise_north(around: &[f32], north: &mut [f32]) {
    let pairs = around.as_chunks::<2>().0;
    north.iter_mut().zip(pairs).for_each(|(north, &[a, b])| *north = larger(*north, larger(a, b)));
}

fn raise_center(low_east: &[f32], high_east: &[f32], north: &[f32], center: &mut [f32]) {
    let east = low_east.iter().zip(high_east).map(|(&low, &high)| larger(low, high));
    let west_and_east = north.iter().zip(&north[1..]).map(|(&west, &east)| larger(west, east));
    for (center, (east, north)) in center.iter_mut().zip(east.zip(west_and_east)) {
        *center = larger(*center, larger(east, north));
    }
}
