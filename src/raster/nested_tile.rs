//! Tiles whose cells are whole multiples of the finest tile's, brought to its grid.
//!
//! ```text
//! ┌───┬───┬───┬───┐   edges nest: the sides of the large cells lie on sides of small ones
//! │   ·   │   ·   │
//! ├───┼───┼───┼───┤   or nodes nest: their centers lie on centers of small ones, as those of formats whose
//! │   ·   │   ·   │   values lie on nodes; of an odd multiple both are the same
//! └───┴───┴───┴───┘
//! ```
//!
//! Between the samples of the larger cells heights are bilinear, as everywhere; a sample's own center keeps its value.

use glam::{DAffine2, DMat2, DVec2};
use rayon::prelude::*;

use crate::error::DemErrorKind;
use crate::mosaic::ALIGNMENT;
use crate::raster::{Raster, SampleFloat, Samples};
use crate::sample::{SampleGrid, bilinear_at_grid};
use crate::windows::{RasterPart, RasterWindow, Windows};

/// Samples on each side of a position that bilinear heights need.
const HALO: u32 = 2;

/// How the samples of a tile become those of a finer grid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Refinement {
    /// Finer cells along a side of a cell, by columns and rows; one of them is more than 1.
    pub times: [u32; 2],
    /// The corner of the finer grid in the tile's.
    first: DVec2,
    /// Columns and rows of the finer grid.
    size: (u32, u32),
}

impl Refinement {
    /// The refinement of a tile to the grid of `finest`; `None` where its cells are as large, or do not nest.
    pub fn new(tile: &Raster, finest: &Raster) -> Option<Self> {
        let [own, fine] = [tile, finest].map(|raster| raster.map_from_grid.matrix2);
        let ratio = DVec2::new(
            own.x_axis.dot(fine.x_axis) / fine.x_axis.length_squared(),
            own.y_axis.dot(fine.y_axis) / fine.y_axis.length_squared(),
        );
        let times = ratio.round();
        // The axes must agree over the longest side, in finer cells.
        let axes = own - DMat2::from_cols(fine.x_axis * times.x, fine.y_axis * times.y);
        let longest = f64::from(tile.width.max(tile.height));
        let apart = DVec2::new(axes.x_axis.length(), axes.y_axis.length()) * longest;
        let nests = apart.cmple(finest.spacing() * ALIGNMENT).all()
            && times.min_element() >= 1.0
            && times.max_element() > 1.0
            && times.max_element() <= f64::from(u16::MAX);
        if !nests {
            return None;
        }
        let corner = finest.grid_from_map(tile.map_from_grid.translation);
        let (x, width) = Self::axis(corner.x, times.x, tile.width)?;
        let (y, height) = Self::axis(corner.y, times.y, tile.height)?;
        Some(Self { times: [times.x as u32, times.y as u32], first: DVec2::new(x, y), size: (width, height) })
    }

    /// Along one axis, where the finer grid starts in the tile's and how many samples it has. `corner` is the tile's in the
    /// finer grid.
    fn axis(corner: f64, times: f64, count: u32) -> Option<(f64, u32)> {
        let is_whole = |at: f64| (at - at.round()).abs() <= ALIGNMENT;
        let edges = f64::from(count) * times;
        let nodes = f64::from(count - 1) * times + 1.0;
        let (first, size) = match (is_whole(corner), is_whole(corner + times / 2.0 - 0.5)) {
            (true, _) => (0.0, edges),
            (false, true) => (0.5 - 0.5 / times, nodes),
            (false, false) => return None,
        };
        (size <= f64::from(u32::MAX)).then_some((first, size as u32))
    }

    /// The tile in the finer grid, without its samples.
    pub fn header(&self, tile: &Raster) -> Raster {
        let [across, down] = self.times.map(f64::from);
        let scale = DMat2::from_diagonal(DVec2::new(1.0 / across, 1.0 / down));
        let tile_from_finer = DAffine2 { matrix2: scale, translation: self.first };
        let (width, height) = self.size;
        let map_from_grid = tile.map_from_grid * tile_from_finer;
        Raster { width, height, map_from_grid, ..tile.without_samples() }
    }

    /// The position in the tile's grid of the center of a sample of the finer one.
    fn place(&self, column: u32, row: u32) -> DVec2 {
        let [across, down] = self.times.map(f64::from);
        self.first + DVec2::new((f64::from(column) + 0.5) / across, (f64::from(row) + 0.5) / down)
    }

    /// The samples of a window of the finer grid, of a tile of which enough is held.
    pub fn samples(&self, tile: &(impl SampleGrid + Sync), window: RasterWindow, is_wide: bool) -> Samples {
        if is_wide { self.values::<f64>(tile, window) } else { self.values::<f32>(tile, window) }
    }

    fn values<T: SampleFloat>(&self, tile: &(impl SampleGrid + Sync), window: RasterWindow) -> Samples {
        let RasterWindow { column, row, width, height } = window;
        let rows = (row..row + height).into_par_iter();
        let value =
            |column: u32, row: u32| T::from_f64(bilinear_at_grid(tile, self.place(column, row)).parts().0);
        let values = rows.flat_map_iter(|row| (column..column + width).map(move |column| value(column, row)));
        T::into_samples(values.collect())
    }
}

/// A tile in windows, in a finer grid.
pub(crate) struct FinerWindows {
    tile: Box<dyn Windows + Send>,
    refinement: Refinement,
    header: Raster,
}

impl FinerWindows {
    pub fn new(tile: Box<dyn Windows + Send>, refinement: Refinement) -> Self {
        let header = refinement.header(tile.metadata());
        Self { tile, refinement, header }
    }
}

impl Windows for FinerWindows {
    fn metadata(&self) -> &Raster {
        &self.header
    }

    fn samples(&mut self, window: RasterWindow) -> Result<Samples, DemErrorKind> {
        window.assert_within(self.size());
        let (last_column, last_row) = (window.column + window.width - 1, window.row + window.height - 1);
        let low = self.refinement.place(window.column, window.row);
        let high = self.refinement.place(last_column, last_row);
        let needed = RasterWindow::around(self.tile.size(), low, high, HALO);
        let samples = self.tile.samples(needed)?;
        let (whole, is_wide) = (self.tile.metadata(), samples.is_wide());
        let part = RasterPart { whole, window: needed, samples };
        Ok(self.refinement.samples(&part, window, is_wide))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raster::tests::small;

    /// A raster of `small`'s grid whose cells are `times` as large and whose corner lies `column`, `row` finer cells from it.
    fn coarse(times: f64, column: f64, row: f64, width: u32, height: u32) -> Raster {
        let value = |at: u32| (at % width) as f32 * 10.0 + (at / width) as f32;
        let mut tile = small(width, height, (0..width * height).map(value).collect());
        tile.map_from_grid.matrix2 *= times;
        tile.map_from_grid.translation = DVec2::new(1000.0 + 10.0 * column, 2020.0 - 10.0 * row);
        tile
    }

    fn finest() -> Raster {
        small(2, 2, vec![0.0; 4])
    }

    #[test]
    fn edges_or_nodes_nest_and_samples_keep_their_values() {
        // Where edges nest at an even multiple, no finer sample has the place of a sample.
        for (times, column, size, keeps) in [
            (3.0, 2.0, (12, 9), true),
            (2.0, -1.0, (8, 6), false),
            (2.0, 0.5, (7, 5), true),
            (3.0, -7.0, (12, 9), true),
        ] {
            let tile = coarse(times, column, column, 4, 3);
            let refinement = Refinement::new(&tile, &finest()).expect("it nests");
            let header = refinement.header(&tile);
            assert_eq!(header.size(), size, "{times} {column}");
            let corner = finest().grid_from_map(header.map_from_grid.translation);
            assert!((corner - corner.round()).abs().max_element() < 1e-9, "{corner}");
            let samples = refinement.samples(&tile, RasterWindow::all(header.size()), false);
            let finer = Raster { samples, ..header };
            for (row, column) in (0..3).flat_map(|row| (0..4).map(move |column| (row, column))) {
                let center = DVec2::new(f64::from(column) + 0.5, f64::from(row) + 0.5);
                let at = finer.grid_from_map(tile.map_from_grid.transform_point2(center));
                let found = crate::sample::bilinear_at_grid(&finer, at).parts().0;
                assert!(!keeps || (found - tile.at(column, row)).abs() < 1e-4, "{times}: {found}");
            }
        }
    }

    #[test]
    fn cells_that_do_not_nest_have_no_refinement() {
        let none = |tile: &Raster| assert_eq!(Refinement::new(tile, &finest()), None);
        none(&coarse(1.0, 4.0, 4.0, 4, 3));
        none(&coarse(1.5, 0.0, 0.0, 4, 3));
        none(&coarse(2.0, 0.25, 0.0, 4, 3));
        none(&coarse(3.0, 0.5, 0.0, 4, 3));
        let mut turned = coarse(2.0, 0.0, 0.0, 4, 3);
        turned.map_from_grid.matrix2 = DMat2::from_angle(0.01) * turned.map_from_grid.matrix2;
        none(&turned);
        let mut upside_down = coarse(2.0, 0.0, 0.0, 4, 3);
        upside_down.map_from_grid.matrix2.y_axis *= -1.0;
        none(&upside_down);
    }

    #[test]
    fn windows_of_a_refined_tile_are_those_of_all_of_it() {
        let mut tile = coarse(4.0, 0.0, 0.0, 5, 4);
        tile.samples.set(7, f64::NAN);
        let refinement = Refinement::new(&tile, &finest()).expect("it nests");
        let all = refinement.samples(&tile, RasterWindow::all((20, 16)), false);
        let mut windows = FinerWindows::new(Box::new(tile), refinement);
        let bits = |samples: &Samples| samples.iter().map(f64::to_bits).collect::<Vec<_>>();
        for (column, row) in (0..18).flat_map(|column| (0..15).map(move |row| (column, row))) {
            let window = RasterWindow { column, row, width: 3.min(20 - column), height: 2.min(16 - row) };
            let found = windows.samples(window).expect("in memory");
            let wanted: Vec<u64> = window
                .shared_rows(RasterWindow::all((20, 16)))
                .flat_map(|(_, to)| to.map(|at| all.get(at).to_bits()).collect::<Vec<_>>())
                .collect();
            assert_eq!(bits(&found), wanted, "{window:?}");
        }
    }
}
