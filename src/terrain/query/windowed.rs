//! Heights of rasters that stay on disk: positions are grouped by the place that they lie in, and what a group needs is
//! read once.
//!
//! ```text
//! ┌──────┬──────┬──────┐   squares of the grid, in rows; the positions of one are answered together, from the
//! │  · · │      │ ·    │   samples around them and a few more on each side, which the interpolations need
//! ├──────┼──────┼──────┤
//! │      │   ···│      │   squares without positions are not read
//! └──────┴──────┴──────┘
//! ```
//!
//! Answers equal those on the raster in memory to the last bit: positions keep their grid coordinates in the whole.

use glam::DVec2;
use rayon::prelude::*;

use crate::lattice::{Lattice, LatticeError, Post};
use crate::post_rect::PostRect;
use crate::query::source::{SourceTransform, raster_height};
use crate::query::{Interpolation, ground_height};
use sandtable_geom::crs::Crs;
use sandtable_raster::answer::Answer;
use sandtable_raster::error::DemErrorKind;
use sandtable_raster::windows::{RasterPart, RasterWindow, Windows};

/// The side of a square, in samples: as large as the tiles of most files, so that a square meets few.
const SQUARE: u32 = 256;

/// Samples or posts on each side of positions that interpolations may need: the cubic two, and its border one more.
const HALO: u32 = 3;

/// Squares that are read together.
const SQUARES_AT_ONCE: usize = 32;

/// How far from the raster, in samples, a position may lie and have a height.
const BEYOND: f64 = 1.0;

/// A part of the ground that cannot be made.
#[derive(Debug, thiserror::Error)]
pub enum LatticePartError {
    /// The samples are no ground.
    #[error(transparent)]
    Lattice(#[from] LatticeError),
    /// The samples cannot be read.
    #[error(transparent)]
    Read(#[from] DemErrorKind),
}

/// The positions in a square, by index, and the samples around them.
struct PositionGroup {
    indices: Vec<usize>,
    window: RasterWindow,
}

/// [`source_heights`](crate::query::source::source_heights) of a raster that is read in windows.
///
/// # Errors
/// Samples cannot be read; `out` then means nothing.
///
/// # Panics
/// Where `out` is not as long as `at`.
pub fn windowed_source_heights(
    windows: &mut (impl Windows + ?Sized),
    from: &Crs,
    interpolation: Interpolation,
    at: &[DVec2],
    out: &mut [Answer],
) -> Result<(), DemErrorKind> {
    let whole = windows.metadata().without_samples();
    let transform = SourceTransform::new(&whole, from);
    let positions: Vec<DVec2> = at.par_iter().map(|&at| transform.position(at)).collect();
    let grid = positions.par_iter().map(|&at| whole.grid_from_map(at)).collect();
    each_group(windows, grid, out, |window, windows, group, out| {
        let part = RasterPart { whole: &whole, window, samples: windows.samples(window)? };
        let answers = group.par_iter().map(|&index| raster_height(&part, interpolation, positions[index]));
        answers.zip(group).collect::<Vec<_>>().into_iter().for_each(|(answer, &index)| out[index] = answer);
        Ok(())
    })
}

/// The heights of the ground at map positions, as [`ground_height`] answers each on the lattice of all of `windows`: a
/// north-up raster in meters.
///
/// # Errors
/// Samples cannot be read, or hold what is no height; `out` then means nothing.
///
/// # Panics
/// Where `out` is not as long as `at`.
pub fn windowed_ground_heights(
    windows: &mut (impl Windows + ?Sized),
    interpolation: Interpolation,
    at: &[DVec2],
    out: &mut [Answer],
) -> Result<(), LatticePartError> {
    let whole = windows.metadata().without_samples();
    Lattice::frame(&whole)?;
    let grid = at.par_iter().map(|&at| whole.grid_from_map(at)).collect();
    each_group(windows, grid, out, |window, windows, group, out| {
        let lattice = lattice_part(windows, posts_of(window, whole.height))?;
        group.iter().for_each(|&index| out[index] = ground_height(&lattice, interpolation, at[index]));
        Ok(())
    })
}

/// The lattice of a north-up raster in meters with the heights of some posts.
///
/// # Errors
/// Samples cannot be read, or hold what is no height.
pub fn lattice_part(
    windows: &mut (impl Windows + ?Sized),
    held: PostRect,
) -> Result<Lattice, LatticePartError> {
    let frame = Lattice::frame(windows.metadata())?;
    let heights = post_heights(windows, held)?;
    Ok(Lattice::held_part(frame, windows.size(), held, heights)?)
}

/// The heights of the posts of a north-up raster in a rectangle, in meters, row by row from the south-west; NaN without data.
///
/// # Errors
/// The samples cannot be read.
///
/// # Panics
/// Where the rectangle reaches beyond the raster.
pub fn post_heights(
    windows: &mut (impl Windows + ?Sized),
    posts: PostRect,
) -> Result<Vec<f32>, DemErrorKind> {
    let (width, height) = (posts.width() as u32, posts.height() as u32);
    // Rasters are counted from the north.
    let row = windows.size().1 - 1 - posts.last.row;
    let mut heights = Vec::new();
    windows.read(RasterWindow { column: posts.first.column, row, width, height }, &mut heights)?;
    reverse_rows(&mut heights, posts.width());
    Ok(heights)
}

/// The posts of a window of a raster with `rows` rows.
fn posts_of(window: RasterWindow, rows: u32) -> PostRect {
    let RasterWindow { column, row, width, height } = window;
    let (south, north) = (rows - row - height, rows - 1 - row);
    PostRect { first: Post { column, row: south }, last: Post { column: column + width - 1, row: north } }
}

/// Heights up to which one thread swaps rows sooner than all.
const SWAPPED_ALONE: usize = 1 << 18;

/// Puts the last row first, in place.
fn reverse_rows(values: &mut [f32], width: usize) {
    let half = values.len() / width / 2 * width;
    let (first, rest) = values.split_at_mut(half);
    let second = rest.len() - half;
    let rest = &mut rest[second..];
    let swap = |(row, opposite): (&mut [f32], &mut [f32])| row.swap_with_slice(opposite);
    if half > SWAPPED_ALONE {
        first.par_chunks_mut(width).zip(rest.par_chunks_mut(width).rev()).for_each(swap);
    } else {
        first.chunks_mut(width).zip(rest.chunks_mut(width).rev()).for_each(swap);
    }
}

/// Calls `answer` with each group of positions near the raster, given in its grid; all other answers are
/// [`Answer::Outside`].
fn each_group<W: Windows + ?Sized, E>(
    windows: &mut W,
    grid: Vec<DVec2>,
    out: &mut [Answer],
    mut answer: impl FnMut(RasterWindow, &mut W, &[usize], &mut [Answer]) -> Result<(), E>,
) -> Result<(), E> {
    assert_eq!(grid.len(), out.len(), "one answer per position");
    out.fill(Answer::Outside);
    for groups in groups(&grid, windows.size()).chunks(SQUARES_AT_ONCE) {
        let needed: Vec<RasterWindow> = groups.iter().map(|group| group.window).collect();
        windows.announce(&needed);
        for group in groups {
            answer(group.window, windows, &group.indices, out)?;
        }
    }
    Ok(())
}

fn groups(grid: &[DVec2], size: (u32, u32)) -> Vec<PositionGroup> {
    let last = DVec2::new(f64::from(size.0 - 1), f64::from(size.1 - 1));
    let is_near = |at: DVec2| at.cmpge(DVec2::splat(-BEYOND)).all() && at.cmple(last + 1.0 + BEYOND).all();
    let square = |index: &usize| {
        let sample = grid[*index].clamp(DVec2::ZERO, last).as_uvec2() / SQUARE;
        (sample.y, sample.x)
    };
    let mut near: Vec<usize> = (0..grid.len()).filter(|&index| is_near(grid[index])).collect();
    near.sort_by_key(square);
    let group = |indices: &[usize]| {
        let ends = |bound: fn(DVec2, DVec2) -> DVec2| {
            indices.iter().map(|&index| grid[index]).reduce(bound).unwrap_or_default()
        };
        let window = RasterWindow::around(size, ends(DVec2::min), ends(DVec2::max), HALO);
        PositionGroup { indices: indices.to_vec(), window }
    };
    near.chunk_by(|a, b| square(a) == square(b)).map(group).collect()
}
