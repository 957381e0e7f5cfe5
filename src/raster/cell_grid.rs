//! Square cells in rows from the north-west: the lattices that rasters are gridded and resampled to.

use glam::{DAffine2, DVec2};

use crate::raster::north_up;
use sandtable_base::limits::RASTER_SAMPLES;
use sandtable_geom::rect::Rect;

/// How many cells a side of a stated extent may be off a whole number: decimal fractions are not exact in binary.
const SLACK_CELLS: f64 = 1e-6;

/// A lattice of square cells, north up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CellGrid {
    corner: DVec2,
    cell: f64,
    width: u32,
    height: u32,
}

/// Why a lattice of cells cannot be made.
#[derive(Clone, Debug, thiserror::Error, PartialEq)]
#[allow(missing_docs, reason = "the messages explain the variants")]
pub enum CellGridError {
    #[error("the cell size is {0}; it must be a number above 0")]
    Cell(f64),
    #[error("the extent from {}, {} to {}, {} holds nothing: give west, south, east, north", .0.min.x, .0.min.y, .0.max.x, .0.max.y)]
    Empty(Rect),
    #[error(
        "{columns} x {rows} cells are more than the {RASTER_SAMPLES} of a raster; make cells of {enough:.3}, or {RASTER_SAMPLES:#}"
    )]
    TooMany { columns: f64, rows: f64, enough: f64 },
}

impl CellGrid {
    /// The cells that cover `extent`, their edges on multiples of `cell`: grids of neighboring surveys with the same
    /// cell size then fit each other.
    ///
    /// # Errors
    /// [`CellGridError`]; an extent without width or height still has one column or row.
    pub fn around(extent: Rect, cell: f64) -> Result<Self, CellGridError> {
        check(extent, cell)?;
        let low = (extent.min / cell).floor();
        let high = (extent.max / cell).ceil().max(low + 1.0);
        Self::new(DVec2::new(low.x, high.y) * cell, cell, high - low, extent)
    }

    /// The cells from the north-west corner of `extent` that cover it; where it is no whole number of cells wide or
    /// high, the last column or row reaches beyond it.
    ///
    /// # Errors
    /// [`CellGridError`].
    pub fn within(extent: Rect, cell: f64) -> Result<Self, CellGridError> {
        check(extent, cell)?;
        let size = ((extent.max - extent.min) / cell - SLACK_CELLS).ceil().max(DVec2::ONE);
        Self::new(DVec2::new(extent.min.x, extent.max.y), cell, size, extent)
    }

    fn new(corner: DVec2, cell: f64, size: DVec2, extent: Rect) -> Result<Self, CellGridError> {
        let cells = size.x * size.y;
        if cells.is_finite() && cells <= RASTER_SAMPLES.get() as f64 {
            return Ok(Self { corner, cell, width: size.x as u32, height: size.y as u32 });
        }
        let sides = extent.max - extent.min;
        let by_area = (sides.x * sides.y / RASTER_SAMPLES.get() as f64).sqrt();
        let enough = by_area.max(sides.max_element() / RASTER_SAMPLES.get() as f64) * 1.01;
        Err(CellGridError::TooMany { columns: size.x, rows: size.y, enough })
    }

    /// The side of a cell in map units.
    #[inline]
    pub fn cell(&self) -> f64 {
        self.cell
    }

    /// Cells a row; at least 1.
    #[inline]
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Rows; at least 1.
    #[inline]
    pub fn height(&self) -> u32 {
        self.height
    }

    /// The outer north-west corner in map coordinates.
    #[inline]
    pub fn corner(&self) -> DVec2 {
        self.corner
    }

    /// The map position of the center of a cell.
    #[inline]
    pub fn center(&self, column: u32, row: u32) -> DVec2 {
        self.corner + DVec2::new(f64::from(column) + 0.5, -(f64::from(row) + 0.5)) * self.cell
    }

    /// Grid position to map coordinates, as [`crate::raster::Raster::map_from_grid`].
    pub fn map_from_grid(&self) -> DAffine2 {
        north_up(self.corner, DVec2::splat(self.cell))
    }
}

fn check(extent: Rect, cell: f64) -> Result<(), CellGridError> {
    if !(cell > 0.0 && cell.is_finite()) {
        return Err(CellGridError::Cell(cell));
    }
    let is_sound = extent.min.is_finite() && extent.max.is_finite() && !extent.is_empty();
    if is_sound { Ok(()) } else { Err(CellGridError::Empty(extent)) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rect(west: f64, south: f64, east: f64, north: f64) -> Rect {
        Rect { min: DVec2::new(west, south), max: DVec2::new(east, north) }
    }

    #[test]
    fn edges_lie_on_multiples_of_the_cell_and_cover_the_points() {
        let grid = CellGrid::around(rect(101.0, -3.0, 119.9, 10.0), 10.0).expect("a grid");
        assert_eq!((grid.corner(), grid.width(), grid.height()), (DVec2::new(100.0, 10.0), 2, 2));
        assert_eq!(grid.center(1, 0), DVec2::new(115.0, 5.0));
        let point = CellGrid::around(rect(10.0, 10.0, 10.0, 10.0), 10.0).expect("one cell");
        assert_eq!((point.width(), point.height()), (1, 1));
    }

    #[test]
    fn a_stated_extent_keeps_its_north_west_corner() {
        let grid = CellGrid::within(rect(0.5, 0.5, 1.0, 0.8), 0.1).expect("a grid");
        assert_eq!((grid.corner(), grid.width(), grid.height()), (DVec2::new(0.5, 0.8), 5, 3));
        assert_eq!(CellGrid::within(rect(0.0, 0.0, 25.0, 21.0), 10.0).map(|grid| grid.width()), Ok(3));
    }

    #[test]
    fn sizes_and_extents_that_make_no_cells_are_refused() {
        for cell in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(matches!(CellGrid::around(rect(0.0, 0.0, 1.0, 1.0), cell), Err(CellGridError::Cell(_))));
        }
        assert!(matches!(CellGrid::within(rect(1.0, 0.0, 0.0, 1.0), 1.0), Err(CellGridError::Empty(_))));
        assert!(matches!(CellGrid::within(rect(0.0, f64::NAN, 1.0, 1.0), 1.0), Err(CellGridError::Empty(_))));
        let Err(CellGridError::TooMany { enough, .. }) = CellGrid::around(rect(0.0, 0.0, 1e6, 1e6), 1.0)
        else {
            panic!("accepted");
        };
        assert!(CellGrid::around(rect(0.0, 0.0, 1e6, 1e6), enough).is_ok());
        assert!(CellGrid::around(rect(0.0, 0.0, 1e300, 1e300), 1e-300).is_err());
    }
}
