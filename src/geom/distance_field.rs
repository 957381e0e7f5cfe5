//! Distances on a grid to what is outside a region: the exact Euclidean transform of Felzenszwalb and Huttenlocher (2012).
//!
//! The squared distance is the lower envelope of parabolas, found along the rows and then along the columns, each in linear
//! time.

/// A grid of cells, row by row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RegionGrid {
    /// Cells in a row.
    pub columns: usize,
    /// The distance between cells along a row and across rows, in meters, above 0.
    pub step_m: [f64; 2],
}

/// The distance in meters from each cell to the nearest that is not inside: 0 for those, infinite where all are inside.
pub fn distances_m(is_inside: &[bool], grid: RegionGrid) -> Vec<f64> {
    let columns = grid.columns.max(1);
    let rows = is_inside.len() / columns;
    let mut field: Vec<f64> =
        is_inside.iter().map(|&inside| if inside { f64::INFINITY } else { 0.0 }).collect();
    let mut envelope = Envelope::default();
    for row in field.chunks_exact_mut(columns) {
        envelope.transform(row, grid.step_m[0]);
    }
    let mut line = vec![0.0; rows];
    for column in 0..columns {
        for (row, value) in line.iter_mut().enumerate() {
            *value = field[row * columns + column];
        }
        envelope.transform(&mut line, grid.step_m[1]);
        for (row, value) in line.iter().enumerate() {
            field[row * columns + column] = value.sqrt();
        }
    }
    field
}

/// The lower envelope of the parabolas over a line, kept for its memory.
#[derive(Default)]
struct Envelope {
    /// The cells whose parabolas are part of it, rising, each with its height and where it begins.
    parabolas: Vec<(f64, f64, f64)>,
}

impl Envelope {
    /// Replaces squared distances with the least over the line of themselves and the squared way there.
    fn transform(&mut self, line: &mut [f64], step_m: f64) {
        self.parabolas.clear();
        for (index, &height) in line.iter().enumerate().filter(|(_, height)| height.is_finite()) {
            let at = index as f64 * step_m;
            let mut from = f64::NEG_INFINITY;
            while let Some(&(before, other, begins)) = self.parabolas.last() {
                from = ((height + at * at) - (other + before * before)) / (2.0 * (at - before));
                if from > begins {
                    break;
                }
                self.parabolas.pop();
                from = f64::NEG_INFINITY;
            }
            self.parabolas.push((at, height, from));
        }
        let Some(&first) = self.parabolas.first() else { return };
        let (mut current, mut next) = (first, 1);
        for (index, value) in line.iter_mut().enumerate() {
            let at = index as f64 * step_m;
            while let Some(&parabola) = self.parabolas.get(next).filter(|parabola| parabola.2 <= at) {
                (current, next) = (parabola, next + 1);
            }
            *value = (at - current.0) * (at - current.0) + current.1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_distance_is_that_to_the_nearest_cell_outside() {
        let (columns, rows) = (23usize, 17usize);
        let grid = RegionGrid { columns, step_m: [3.0, 5.0] };
        let is_inside: Vec<bool> =
            (0..columns * rows).map(|index| (index * 7919 + index * index * 31) % 11 > 0).collect();
        let found = distances_m(&is_inside, grid);
        for (index, &distance_m) in found.iter().enumerate() {
            let place = |index: usize| [(index % columns) as f64 * 3.0, (index / columns) as f64 * 5.0];
            let [x, y] = place(index);
            let outside = (0..is_inside.len()).filter(|&other| !is_inside[other]).map(place);
            let nearest = outside.map(|[u, v]| libm::hypot(u - x, v - y)).fold(f64::INFINITY, f64::min);
            assert!((distance_m - nearest).abs() < 1e-9, "{index}: {distance_m} {nearest}");
        }
    }

    #[test]
    fn without_an_outside_all_is_infinitely_far() {
        let grid = RegionGrid { columns: 3, step_m: [1.0; 2] };
        assert!(distances_m(&[true; 6], grid).iter().all(|distance| distance.is_infinite()));
        assert_eq!(distances_m(&[], grid), Vec::<f64>::new());
    }
}
