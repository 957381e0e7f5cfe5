//! The locator: the whole model in plan, small, with the place of the eye and the ground that it sees.

use glam::Vec2;

use crate::composer::Composer;
use crate::drawing::{Drawing, polygon};
use crate::pixel_box::PixelBox;
use crate::sheet::{HALO, INK};
use sandtable_draw::color::Srgba;
use sandtable_draw::pixels::Pixels;

/// What the picture shows, on the relief.
const SEEN: Srgba = Srgba([0xc8, 0x1e, 0x2a, 0x2c]);
const SEEN_EDGE: Srgba = Srgba([0xc8, 0x1e, 0x2a, 0xff]);

/// The model in plan, north up.
#[derive(Clone, Debug, PartialEq)]
pub struct LocatorMap {
    /// Its relief, as it is painted.
    pub relief: Pixels,
    /// The corners of the ground that the picture shows, in pixels of the relief.
    pub seen: Vec<Vec2>,
    /// The eye, where it is above the model.
    pub eye: Option<Vec2>,
}

/// What is drawn on the relief, whose upper left corner is the origin.
pub(crate) fn compose(locator: &LocatorMap, composer: &Composer) -> Drawing {
    let sheet = composer.sheet;
    let size = Vec2::new(locator.relief.width() as f32, locator.relief.height() as f32);
    let area = PixelBox { min: Vec2::ZERO, max: size };
    let mut drawing = Drawing::default();
    if let Some(path) = polygon(&clipped(&locator.seen, area)) {
        drawing.fill(path.clone(), SEEN);
        drawing.stroke(&path, sheet.px(1.4).max(1.0), SEEN_EDGE);
    }
    if let Some(eye) = locator.eye.filter(|eye| area.grown(-sheet.px(5.0)).contains(*eye)) {
        drawing.disc(eye, sheet.px(5.0).max(3.0), HALO);
        drawing.disc(eye, sheet.px(3.4).max(2.0), SEEN_EDGE);
    }
    drawing.frame(area, sheet.hairline().round(), INK);
    drawing
}

/// The part of a convex polygon in a box (Sutherland and Hodgman 1974).
fn clipped(polygon: &[Vec2], area: PixelBox) -> Vec<Vec2> {
    let sides = [
        (Vec2::X, area.min.x),
        (Vec2::NEG_X, -area.max.x),
        (Vec2::Y, area.min.y),
        (Vec2::NEG_Y, -area.max.y),
    ];
    sides.into_iter().fold(polygon.to_vec(), |corners, (inward, least)| {
        let inside = |at: Vec2| at.dot(inward) - least;
        let mut kept = Vec::with_capacity(corners.len() + 1);
        for (index, &to) in corners.iter().enumerate() {
            let from = corners[(index + corners.len() - 1) % corners.len()];
            let (before, after) = (inside(from), inside(to));
            if (before < 0.0) != (after < 0.0) {
                kept.push(from + (to - from) * (before / (before - after)));
            }
            if after >= 0.0 {
                kept.push(to);
            }
        }
        kept
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_seen_is_cut_to_the_model() {
        let area = PixelBox { min: Vec2::ZERO, max: Vec2::splat(10.0) };
        let corners = clipped(&[Vec2::new(-10.0, 5.0), Vec2::new(20.0, -25.0), Vec2::new(20.0, 35.0)], area);
        assert!(corners.len() >= 4 && corners.iter().all(|at| area.grown(1e-4).contains(*at)), "{corners:?}");
        assert!(clipped(&[Vec2::splat(20.0), Vec2::splat(30.0), Vec2::new(20.0, 30.0)], area).is_empty());
    }
}
