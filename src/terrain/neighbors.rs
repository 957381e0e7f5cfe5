//! The neighbors of a post, or of a cell of another grid that is stored row by row: all eight, or the four at its sides.

/// The steps to the eight neighbors, columns and rows, from the east counter-clockwise.
pub const STEPS: [(i64, i64); 8] = [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1)];

/// The neighbors that lie on a grid of so many columns and rows, each with the number of its step in [`STEPS`].
pub fn neighbors(index: usize, columns: usize, rows: usize) -> impl Iterator<Item = (usize, usize)> {
    let (column, row) = ((index % columns) as i64, (index / columns) as i64);
    STEPS.into_iter().enumerate().filter_map(move |(step, (east, north))| {
        let (column, row) = (column + east, row + north);
        let is_there = (0..columns as i64).contains(&column) && (0..rows as i64).contains(&row);
        is_there.then(|| (step, row as usize * columns + column as usize))
    })
}

/// The neighbors west, east, south and north, on a grid of so many columns and `cells` in all; `None` beyond its border.
pub fn sides(index: usize, columns: usize, cells: usize) -> [Option<usize>; 4] {
    let column = index % columns;
    [
        (column > 0).then(|| index - 1),
        (column + 1 < columns).then_some(index + 1),
        index.checked_sub(columns),
        Some(index + columns).filter(|&north| north < cells),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_inner_cell_has_eight_neighbors_and_a_corner_three() {
        let around: Vec<usize> = neighbors(4, 3, 3).map(|(_, index)| index).collect();
        assert_eq!(around, [5, 8, 7, 6, 3, 0, 1, 2]);
        let of_corner: Vec<(usize, usize)> = neighbors(0, 3, 3).collect();
        assert_eq!(of_corner, [(0, 1), (1, 4), (2, 3)]);
    }
}
