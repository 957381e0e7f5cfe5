//! The elevation at a point between samples.
//!
//! The convention is GDAL's: a value is that of its sample's center. In the outer half sample along the border
//! the nearest row or column is held. Neighbors without data drop out and the weights of the others grow to
//! one; only where none is left is there no data.

use glam::DVec2;

use crate::answer::Answer;
use crate::raster::Raster;

/// How far outside the border, in samples, a point still counts as on it: decimal map coordinates lose this much.
const BORDER: f64 = 1e-6;

/// A position nearer than this, in samples, to a row or column of centers lies on it: rounding in map coordinates must
/// not mix a neighbor, or a hole, into an exact value.
pub const ON_CENTER: f64 = 1e-7;

/// The samples of a raster, or those of them that are held: code that asks for samples near a position works on either,
/// and gives the same bits.
pub trait SampleGrid {
    /// The raster's size, place and units; its `samples` mean nothing and may be empty.
    fn whole(&self) -> &Raster;

    /// The value at `column`, `row` of the whole raster, NaN where there is no data.
    ///
    /// # Panics
    /// Where it is not held.
    fn value(&self, column: u32, row: u32) -> f64;
}

impl SampleGrid for Raster {
    fn whole(&self) -> &Raster {
        self
    }

    #[inline]
    fn value(&self, column: u32, row: u32) -> f64 {
        self.at(column, row)
    }
}

/// The value of the sample that contains a point in the raster's own coordinates.
pub fn nearest(grid: &impl SampleGrid, at_map: DVec2) -> Answer {
    let raster = grid.whole();
    let at = raster.grid_from_map(at_map);
    if !contains(raster, at) {
        return Answer::Outside;
    }
    let column = (at.x.max(0.0) as u32).min(raster.width - 1);
    let row = (at.y.max(0.0) as u32).min(raster.height - 1);
    Answer::from_sample(grid.value(column, row))
}

/// The bilinear value at a point in the raster's own coordinates.
pub fn bilinear(grid: &impl SampleGrid, at_map: DVec2) -> Answer {
    bilinear_at_grid(grid, grid.whole().grid_from_map(at_map))
}

/// The bilinear value at a grid position (column, row), where (0.5, 0.5) is the first sample's center.
pub fn bilinear_at_grid(grid: &impl SampleGrid, at: DVec2) -> Answer {
    let raster = grid.whole();
    if !contains(raster, at) {
        return Answer::Outside;
    }
    let (left, right, across) = neighbors(at.x, raster.width);
    let (above, below, down) = neighbors(at.y, raster.height);
    let corners = [
        (left, above, (1.0 - across) * (1.0 - down)),
        (right, above, across * (1.0 - down)),
        (left, below, (1.0 - across) * down),
        (right, below, across * down),
    ];
    let (mut sum, mut weights) = (0.0, 0.0);
    for (column, row, weight) in corners {
        let value = grid.value(column, row);
        if weight > 0.0 && !value.is_nan() {
            sum += weight * value;
            weights += weight;
        }
    }
    if weights > 0.0 { Answer::from_sample(sum / weights) } else { Answer::NoData }
}

fn contains(raster: &Raster, at: DVec2) -> bool {
    let size = raster.grid_size() + BORDER;
    (-BORDER..=size.x).contains(&at.x) && (-BORDER..=size.y).contains(&at.y)
}

/// The two samples on either side of a position along one axis, and its part of the way from the first to the second.
fn neighbors(at: f64, count: u32) -> (u32, u32, f64) {
    let from_first = (at - 0.5).clamp(0.0, f64::from(count - 1));
    let first = from_first as u32;
    let part = from_first - f64::from(first);
    if part <= ON_CENTER {
        return (first, first, 0.0);
    }
    let second = (first + 1).min(count - 1);
    if part >= 1.0 - ON_CENTER { (second, second, 0.0) } else { (first, second, part) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raster::tests::small;

    #[test]
    fn a_plane_is_kept_between_centers_and_held_beyond_them() {
        let raster = small(3, 2, vec![0.0, 10.0, 20.0, 100.0, 110.0, 120.0]);
        assert_eq!(bilinear(&raster, DVec2::new(1015.0, 2010.0)), Answer::Height(60.0));
        assert_eq!(bilinear(&raster, DVec2::new(1000.0, 2020.0)), Answer::Height(0.0));
        assert_eq!(bilinear(&raster, DVec2::new(1030.0, 2000.0)), Answer::Height(120.0));
        assert_eq!(nearest(&raster, DVec2::new(1019.0, 2011.0)), Answer::Height(10.0));
        assert_eq!(nearest(&raster, DVec2::new(1030.0, 2000.0)), Answer::Height(120.0));
    }

    #[test]
    fn holes_drop_out_and_leave_their_weight_to_the_others() {
        let raster = small(2, 2, vec![f32::NAN, 10.0, f32::NAN, 30.0]);
        assert_eq!(bilinear(&raster, DVec2::new(1010.0, 2010.0)), Answer::Height(20.0));
        assert_eq!(bilinear(&raster, DVec2::new(1005.0, 2010.0)), Answer::NoData);
        assert_eq!(nearest(&raster, DVec2::new(1005.0, 2010.0)), Answer::NoData);
    }

    #[test]
    fn a_hole_is_not_the_edge_of_the_raster() {
        let raster = small(1, 1, vec![f32::NAN]);
        assert_eq!(bilinear(&raster, DVec2::new(1005.0, 2005.0)), Answer::NoData);
        assert_eq!(bilinear(&raster, DVec2::new(1011.0, 2005.0)), Answer::Outside);
        assert_eq!(nearest(&raster, DVec2::new(f64::NAN, 2005.0)), Answer::Outside);
    }
}
