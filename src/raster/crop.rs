//! The part of a raster within a rectangle.

use glam::{DAffine2, DVec2};

use crate::raster::{Raster, Samples};
use crate::windows::{RasterWindow, Windows, window_samples};
use sandtable_geom::rect::Rect;

/// The part of `raster` in [`crop_window`]; `None` where that is.
pub fn crop(raster: &Raster, rect: &Rect, margin: u32) -> Option<Raster> {
    let window = crop_window(raster, rect, margin)?;
    Some(part(raster, window, window_samples(raster, RasterWindow::all(raster.size()), window)))
}

/// The samples of `raster` with their centers in `rect`, a rectangle in its map coordinates (where the raster is turned
/// against them: in the smallest rectangle of samples around that), and `margin` more on each side as far as there are any.
/// `None` where these are less than two samples a side. The raster's own samples are not looked at.
pub fn crop_window(raster: &Raster, rect: &Rect, margin: u32) -> Option<RasterWindow> {
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
    let (width, height) = (last.x - first.x + 1, last.y - first.y + 1);
    Some(RasterWindow { column: first.x, row: first.y, width, height })
}

/// The samples of `window` as a raster of their own, in their places; `whole` is the raster that they are of.
pub fn part(whole: &Raster, window: RasterWindow, samples: Samples) -> Raster {
    let corner = DVec2::new(f64::from(window.column), f64::from(window.row));
    Raster {
        width: window.width,
        height: window.height,
        samples,
        map_from_grid: whole.map_from_grid * DAffine2::from_translation(corner),
        ..whole.without_samples()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raster::north_up;

    /// Five by four samples 10 m apart, the south-west one at (105, 205).
    fn raster() -> Raster {
        let place = north_up(DVec2::new(100.0, 240.0), DVec2::splat(10.0));
        Raster::new(5, Samples::F32((1..=20u8).map(f32::from).collect())).placed(place)
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
