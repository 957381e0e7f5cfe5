//! An index of the areas of a sheet that are drawn on, in square cells, so that a query examines only nearby marks.

use glam::Vec2;

use crate::pixel_box::{PixelBox, PixelSegment};

/// The side of a cell in pixels: about the length of a short name.
const CELL_PX: f32 = 64.0;
/// The most cells in a row or a column; larger sheets have larger cells.
const MOST_CELLS: f32 = 256.0;

/// Boxes and lines with a number each.
#[derive(Clone, Debug)]
pub struct OccupiedSheet {
    origin: Vec2,
    cell: Vec2,
    columns: usize,
    rows: usize,
    cells: Vec<Vec<u32>>,
    marks: Vec<OccupiedMark>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum OccupiedShape {
    Box(PixelBox),
    Leader(PixelSegment),
}

#[derive(Clone, Copy, Debug)]
pub struct OccupiedMark {
    pub shape: OccupiedShape,
    /// Given by the caller.
    pub number: usize,
}

impl OccupiedSheet {
    /// An empty sheet for `bounds`; marks outside are kept in the cells at its border.
    pub fn new(bounds: &PixelBox) -> Self {
        let size = bounds.size().max(Vec2::ONE);
        let size = if size.is_finite() { size } else { Vec2::ONE };
        let counts = (size / CELL_PX).ceil().clamp(Vec2::ONE, Vec2::splat(MOST_CELLS));
        let (columns, rows) = (counts.x as usize, counts.y as usize);
        let cells = vec![Vec::new(); columns * rows];
        Self { origin: bounds.min, cell: size / counts, columns, rows, cells, marks: Vec::new() }
    }

    pub fn add(&mut self, shape: OccupiedShape, number: usize) {
        let area = match shape {
            OccupiedShape::Box(area) => area,
            OccupiedShape::Leader(line) => {
                PixelBox { min: line.from.min(line.to), max: line.from.max(line.to) }
            }
        };
        let mark = self.marks.len() as u32;
        for cell in self.cells_of(&area) {
            self.cells[cell].push(mark);
        }
        self.marks.push(OccupiedMark { shape, number });
    }

    /// The marks that may intersect `area`; a mark in several cells is returned several times.
    pub fn near<'a>(&'a self, area: &PixelBox) -> impl Iterator<Item = &'a OccupiedMark> + use<'a> {
        self.cells_of(area).flat_map(|cell| &self.cells[cell]).map(|&mark| &self.marks[mark as usize])
    }

    fn cells_of(&self, area: &PixelBox) -> impl Iterator<Item = usize> + use<> {
        let index = |at: Vec2| {
            // A float becomes an index saturating, NaN 0.
            let cell = (at - self.origin) / self.cell;
            ((cell.x as usize).min(self.columns - 1), (cell.y as usize).min(self.rows - 1))
        };
        let ((left, top), (right, bottom)) = (index(area.min), index(area.max));
        let columns = self.columns;
        (top..=bottom).flat_map(move |row| (left..=right).map(move |column| row * columns + column))
    }
}
