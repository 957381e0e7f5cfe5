//! The part of a raster within a rectangle.

use glam::{DAffine2, DVec2};

use crate::dem::raster::{Raster, Samples};
use crate::geom::rect::Rect;

/// The samples of `raster` with their centers in `rect`, a rectangle in its map coordinates (where the raster is turned
/// against them: in the smallest rectangle of samples around that), and `margin` more on each side as far as there are any.
/// `None` where these are less than two samples a side.
pub fn crop(raster: &Raster, rect: &Rect, margin: u32) -> Option<Raster> {
    let corners =
        [rect.min, DVec2::new(rect.min.x, rect.max.y), rect.max, DVec2::new(rect.max.x, rect.min.y)];
    let centers = Rect::around(corners.map(|corner| raster.grid_from_map(corner) - 0.5));
    let margin = f64::from(margin);
    let last = DVec2::new(f64::from(raster.width - 1), f64::from(raster.height - 1));
    let low = (centers.min.ceil() - margin).max(DVec2::ZERO);
    let high = (centers.max.floor() + margin).min(last);
    let size = high - low;
    if size.is_nan() || size.min_element() < 1.0 {
        return None;
    }
    let (first, last) = (low.as_uvec2(), high.as_uvec2());
    let columns = first.x as usize..last.x as usize + 1;
    let rows = (first.y..=last.y).map(|row| row as usize * raster.width as usize);
    let ranges = rows.map(|start| start + columns.start..start + columns.end);
    let samples = match &raster.samples {
        Samples::F32(samples) => Samples::F32(ranges.flat_map(|range| &samples[range]).copied().collect()),
        Samples::F64(samples) => Samples::F64(ranges.flat_map(|range| &samples[range]).copied().collect()),
    };
    Some(Raster {
        width: last.x - first.x + 1,
        height: last.y - first.y + 1,
        samples,
        map_from_grid: raster.map_from_grid * DAffine2::from_translation(low),
        ..raster.without_samples()
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dem::read::{DemHints, read};

    /// Five by four samples 10 m apart, the south-west one at (105, 205).
    fn raster() -> Raster {
        let text = "ncols 5\nnrows 4\nxllcorner 100\nyllcorner 200\ncellsize 10\n\
                    1 2 3 4 5\n6 7 8 9 10\n11 12 13 14 15\n16 17 18 19 20";
        read("a.asc", text.as_bytes(), &DemHints::default()).expect("sound")
    }

    fn cropped(min: (f64, f64), max: (f64, f64), margin: u32) -> Option<Raster> {
        crop(&raster(), &Rect { min: min.into(), max: max.into() }, margin)
    }

    #[test]
    fn samples_within_the_rectangle_stay_in_their_places() {
        let part = cropped((114.0, 211.0), (136.0, 226.0), 0).expect("three by two samples");
        assert_eq!((part.width, part.height), (3, 2));
        assert_eq!(part.samples.iter().collect::<Vec<_>>(), [7.0, 8.0, 9.0, 12.0, 13.0, 14.0]);
        assert_eq!(part.extent(), Rect { min: DVec2::new(110.0, 210.0), max: DVec2::new(140.0, 230.0) });
    }

    #[test]
    fn a_margin_ends_at_the_raster_s_border() {
        let part = cropped((114.0, 211.0), (136.0, 226.0), 9).expect("all of it");
        assert_eq!((part.extent(), part.samples), (raster().extent(), raster().samples));
    }

    #[test]
    fn less_than_two_samples_a_side_are_nothing() {
        assert!(cropped((114.0, 211.0), (116.0, 226.0), 0).is_none());
        assert!(cropped((900.0, 211.0), (990.0, 226.0), 0).is_none());
    }
}
