//! The two ways of [resampling](crate::warp::resample) a raster that stays on disk, with the same bits.

use glam::DVec2;
use rayon::prelude::*;

use crate::error::DemErrorKind;
use crate::raster::{Raster, Samples};
use crate::sample::bilinear_at_grid;
use crate::warp::resample::{CellMeans, Resampler};
use crate::warp::valid_search::SAMPLES_AT_ONCE;
use crate::windows::{RasterPart, RasterWindow, Windows};
use sandtable_geom::rect::Rect;

/// The side of the squares of cells that are computed at a time. Their positions take some megabytes; in a long row of cells,
/// the source around them would be much larger where it is turned against them.
const TILE: u32 = 512;

/// Samples on each side of a position that bilinear heights need.
const HALO: u32 = 2;

/// The source's values at the centers of cells in a window of the output. `resampler` is of the source without its samples.
pub(super) fn bilinear_window(
    source: &mut (impl Windows + ?Sized),
    resampler: &Resampler<'_>,
    window: RasterWindow,
) -> Result<Samples, DemErrorKind> {
    let mut all = Samples::absent(window.samples(), source.metadata().samples.is_wide());
    for tile in window.tiles(TILE) {
        let samples = bilinear_tile(source, resampler, tile)?;
        for (from, to) in tile.shared_rows(window) {
            all.copy_from(to, &samples, from);
        }
    }
    Ok(all)
}

fn bilinear_tile(
    source: &mut (impl Windows + ?Sized),
    resampler: &Resampler<'_>,
    tile: RasterWindow,
) -> Result<Samples, DemErrorKind> {
    let whole = source.metadata().without_samples();
    let columns = tile.column..tile.column + tile.width;
    let rows = (tile.row..tile.row + tile.height).into_par_iter();
    let positions: Vec<DVec2> =
        rows.flat_map_iter(|row| resampler.row_positions(row, columns.clone())).collect();
    let around = Rect::around(positions.iter().copied().filter(|at| at.is_finite()));
    let needed = match around.is_empty() {
        true => RasterWindow { column: 0, row: 0, width: 1, height: 1 },
        false => RasterWindow::around(source.size(), around.min, around.max, HALO),
    };
    let part = RasterPart { whole: &whole, window: needed, samples: source.samples(needed)? };
    let heights = positions.par_iter().map(|&at| bilinear_at_grid(&part, at).parts().0);
    Ok(match part.samples {
        Samples::F32(_) => Samples::F32(heights.map(|height| height as f32).collect()),
        Samples::F64(_) => Samples::F64(heights.collect()),
    })
}

/// The means of the source's samples in each cell. All of the source is read once, some rows at a time.
pub(super) fn average(
    source: &mut (impl Windows + ?Sized),
    resampler: &Resampler<'_>,
) -> Result<Raster, DemErrorKind> {
    let mut means = CellMeans::new(resampler);
    for band in RasterWindow::all(source.size()).bands(SAMPLES_AT_ONCE) {
        means.add_rows(band.row as usize, &source.samples(band)?);
    }
    Ok(means.raster(source.metadata().samples.is_wide()))
}
