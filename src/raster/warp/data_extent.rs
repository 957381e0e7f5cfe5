//! The part of a raster that holds data, as a rectangle of its grid, and the outline of that rectangle.

use glam::DVec2;

use crate::raster::{Raster, Samples};
use crate::windows::{RasterWindow, Windows};
use sandtable_geom::rect::Rect;

/// Points along a side of a raster whose extent is projected: enough to miss less than a thousandth of a cell.
const SIDE_POINTS: u32 = 400;

/// The smallest grid rectangle around the valid samples, out to their edges; `None` where there is none.
pub(super) fn data_extent(raster: &Raster) -> Option<Rect> {
    let around = with_valid(Rect::EMPTY, &raster.samples, RasterWindow::all(raster.size()));
    (!around.is_empty()).then_some(around)
}

/// `around` and the valid samples of a window, out to their edges.
pub(super) fn with_valid(around: Rect, samples: &Samples, window: RasterWindow) -> Rect {
    let width = window.width as usize;
    let at = |column: usize, row: usize| DVec2::new(column as f64, row as f64);
    (0..window.height as usize).fold(around, |around, row| {
        let valid = |column: &usize| !samples.get(row * width + column).is_nan();
        let (Some(first), Some(last)) = ((0..width).find(valid), (0..width).rev().find(valid)) else {
            return around;
        };
        let corner = at(window.column as usize, window.row as usize);
        around.with(corner + at(first, row)).with(corner + at(last + 1, row + 1))
    })
}

/// Points along the sides of a rectangle, corners included.
pub(super) fn outline(rect: Rect) -> impl Iterator<Item = DVec2> {
    (0..=SIDE_POINTS).flat_map(move |step| {
        let at = rect.min.lerp(rect.max, f64::from(step) / f64::from(SIDE_POINTS));
        [
            DVec2::new(at.x, rect.min.y),
            DVec2::new(at.x, rect.max.y),
            DVec2::new(rect.min.x, at.y),
            DVec2::new(rect.max.x, at.y),
        ]
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raster::tests::small;

    #[test]
    fn the_rectangle_reaches_to_the_outer_edges_of_valid_samples() {
        let hole = f32::NAN;
        let raster = small(3, 3, vec![hole, hole, hole, hole, 1.0, 2.0, hole, hole, hole]);
        assert_eq!(data_extent(&raster), Some(Rect { min: DVec2::new(1.0, 1.0), max: DVec2::new(3.0, 2.0) }));
        assert_eq!(data_extent(&small(1, 1, vec![hole])), None);
    }
}
