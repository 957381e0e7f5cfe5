//! The part of a raster that holds data, as a rectangle of its grid, and the outline of that rectangle.

use glam::DVec2;

use crate::dem::raster::Raster;
use crate::geom::rect::Rect;

/// Points along a side of a raster whose extent is projected: so many miss less than a thousandth of a cell.
const SIDE_POINTS: u32 = 400;

/// The smallest grid rectangle around the valid samples, out to their edges; `None` where there is none.
pub(super) fn data_extent(raster: &Raster) -> Option<Rect> {
    let width = raster.width as usize;
    let mut around = Rect::EMPTY;
    for row in 0..raster.height as usize {
        let valid = |column: &usize| !raster.samples.get(row * width + column).is_nan();
        if let (Some(first), Some(last)) = ((0..width).find(valid), (0..width).rev().find(valid)) {
            around = around.with(DVec2::new(first as f64, row as f64));
            around = around.with(DVec2::new(last as f64 + 1.0, row as f64 + 1.0));
        }
    }
    (!around.is_empty()).then_some(around)
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
    use crate::dem::raster::tests::small;

    #[test]
    fn the_rectangle_reaches_to_the_outer_edges_of_valid_samples() {
        let hole = f32::NAN;
        let raster = small(3, 3, vec![hole, hole, hole, hole, 1.0, 2.0, hole, hole, hole]);
        assert_eq!(data_extent(&raster), Some(Rect { min: DVec2::new(1.0, 1.0), max: DVec2::new(3.0, 2.0) }));
        assert_eq!(data_extent(&small(1, 1, vec![hole])), None);
    }
}
