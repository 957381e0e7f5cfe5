//! Classes of land cover cell by cell: the grid that outlines are traced in, and how it is made of a finer one.

/// The class of a cell without data.
pub const NO_CLASS: u8 = 0;

/// Classes row by row from the first row of a raster: numbers that the caller gives a meaning, and [`NO_CLASS`].
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ClassGrid {
    width: u32,
    height: u32,
    cells: Vec<u8>,
}

impl ClassGrid {
    /// A grid of `width` cells per row.
    ///
    /// # Panics
    /// The cells are none, or no whole number of rows.
    pub fn new(width: u32, cells: Vec<u8>) -> Self {
        assert!(width > 0 && !cells.is_empty(), "a grid has cells");
        assert!(cells.len().is_multiple_of(width as usize), "{} cells in rows of {width}", cells.len());
        Self { width, height: (cells.len() / width as usize) as u32, cells }
    }

    /// Cells per row, at least 1.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Rows, at least 1.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// The cells, row by row.
    pub fn cells(&self) -> &[u8] {
        &self.cells
    }

    /// The cells, to be changed.
    pub fn cells_mut(&mut self) -> &mut [u8] {
        &mut self.cells
    }

    /// The cells that share a side with the one at an index: above, left, right, below.
    pub(crate) fn beside(&self, index: usize) -> impl Iterator<Item = usize> + use<> {
        let (width, last) = (self.width as usize, self.cells.len());
        let column = index % width;
        let above = index.checked_sub(width);
        let left = (column > 0).then(|| index - 1);
        let right = (column + 1 < width).then_some(index + 1);
        let below = Some(index + width).filter(|below| *below < last);
        [above, left, right, below].into_iter().flatten()
    }
}

/// Makes a grid of the most frequent class of each square of `step` × `step` cells, from rows in their order.
///
/// Of classes that are equally frequent the lowest counts, so that the result does not depend on how the rows come.
#[derive(Debug)]
pub struct MajorityGrid {
    width: usize,
    step: usize,
    /// Rows of the square that is being counted.
    rows: usize,
    /// How often each class is in each square of the row: 256 numbers a square.
    counts: Vec<u32>,
    /// The highest class so far.
    highest: u8,
    cells: Vec<u8>,
}

/// Values of a class.
const CLASSES: usize = 256;

impl MajorityGrid {
    /// A grid of rows of `width` cells, both at least 1.
    ///
    /// # Panics
    /// One of them is 0.
    pub fn new(width: u32, step: u32) -> Self {
        assert!(width > 0 && step > 0, "rows of {width} cells, squares of {step}");
        let (width, step) = (width as usize, step as usize);
        let counts = if step == 1 { Vec::new() } else { vec![0; width.div_ceil(step) * CLASSES] };
        Self { width, step, rows: 0, counts, highest: NO_CLASS, cells: Vec::new() }
    }

    /// Adds the next row.
    ///
    /// # Panics
    /// It has another number of cells.
    pub fn add_row(&mut self, row: &[u8]) {
        assert_eq!(row.len(), self.width, "cells of a row");
        if self.step == 1 {
            self.cells.extend_from_slice(row);
            return;
        }
        for (square, counts) in row.chunks(self.step).zip(self.counts.chunks_exact_mut(CLASSES)) {
            for class in square {
                counts[usize::from(*class)] += 1;
                self.highest = self.highest.max(*class);
            }
        }
        self.rows += 1;
        if self.rows == self.step {
            self.end_squares();
        }
    }

    fn end_squares(&mut self) {
        self.rows = 0;
        for counts in self.counts.chunks_exact_mut(CLASSES) {
            let counts = &mut counts[..=usize::from(self.highest)];
            // The last of equal maxima is that of the lowest class, in descending order.
            let most = counts.iter().enumerate().rev().max_by_key(|(_, count)| **count);
            self.cells.push(most.map_or(NO_CLASS, |(class, _)| class as u8));
            counts.fill(0);
        }
    }

    /// The grid of all rows.
    ///
    /// # Panics
    /// No row was added.
    pub fn finish(mut self) -> ClassGrid {
        if self.rows > 0 {
            self.end_squares();
        }
        ClassGrid::new(self.width.div_ceil(self.step) as u32, self.cells)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_square_has_its_most_frequent_class_and_of_equal_ones_the_lowest() {
        let rows = [[3, 3, 7, 5, 9], [1, 3, 5, 7, 9], [2, 2, 0, 0, 4]];
        let mut grid = MajorityGrid::new(5, 2);
        rows.iter().for_each(|row| grid.add_row(row));
        assert_eq!(grid.finish(), ClassGrid::new(3, vec![3, 5, 9, 2, 0, 4]));
        let mut same = MajorityGrid::new(5, 1);
        rows.iter().for_each(|row| same.add_row(row));
        assert_eq!(same.finish().cells(), rows.as_flattened());
    }

    #[test]
    fn cells_have_neighbors_within_the_grid() {
        let grid = ClassGrid::new(3, vec![0; 6]);
        let beside = |index| grid.beside(index).collect::<Vec<_>>();
        assert_eq!((beside(0), beside(4)), (vec![1, 3], vec![1, 3, 5]));
        assert_eq!(beside(2), [1, 5]);
    }
}
