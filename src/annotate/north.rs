//! The north arrow: a needle lying on the ground, seen as the camera sees the ground, upper right.
//!
//! In an oblique view north is not a direction on the picture alone: the ground is foreshortened. The
//! arrow is a compass drawn on the ground plane and projected with it, so that its ring shows the tilt and
//! its needle points along the meridian; the letter stays upright.

use glam::Vec2;
use tiny_skia::{Path, PathBuilder, Rect};

use crate::annotate::drawing::{Drawing, polygon, polyline};
use crate::annotate::sheet::{FRAME, HALO, INK, PANEL, PAPER, Sheet};
use crate::annotate::text::{CAP_HEIGHT, Face, Typesetter, halos, write};

/// Flatter than this the needle could not be read; views nearer the horizon are drawn with this tilt.
const FLATTEST: f32 = 0.3;
/// Below this the ground's direction cannot be told from its direction on the picture.
const HARDLY_TILTED: f32 = 0.02;
/// Radius of the ring in design pixels.
const RADIUS: f32 = 36.0;

/// Which way north is, and how much the ground is foreshortened.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NorthArrow {
    /// The direction of north on the picture, at its middle; X right and Y down. Any length but zero.
    pub direction: Vec2,
    /// How long a length on the ground into the picture appears against the same length across it: the
    /// sine of the angle at which the camera looks down. 1 looking straight down, 0 at the horizon.
    pub foreshortening: f32,
}

/// The arrow around the origin; `None` where its direction is no direction.
pub fn compose(arrow: &NorthArrow, sheet: &Sheet, setter: &mut Typesetter) -> Option<Drawing> {
    let plane = Plane::new(arrow, sheet.px(RADIUS))?;
    let mut drawing = Drawing::default();
    drawing.fill(plane.ring(1.0)?, PANEL);
    drawing.stroke(&plane.ring(1.0)?, sheet.hairline(), FRAME);
    for quarter in [Vec2::X, Vec2::NEG_X, Vec2::NEG_Y] {
        let tick = polyline(&[plane.on_picture(quarter * 0.86), plane.on_picture(quarter)])?;
        drawing.stroke(&tick, sheet.hairline(), INK);
    }
    draw_needle(&plane, sheet, &mut drawing)?;
    draw_letter(&plane, sheet, setter, &mut drawing);
    Some(drawing)
}

/// How far the arrow may reach from its middle in any direction: it is set this far from the border.
pub fn reach(sheet: &Sheet) -> f32 {
    (sheet.px(RADIUS) + letter_distance(sheet) + letter_px(sheet) * 0.55).ceil()
}

/// The ground around the arrow's middle: north along Y, east along X, the ring at distance 1.
struct Plane {
    north: Vec2,
    radius: Vec2,
}

impl Plane {
    fn new(arrow: &NorthArrow, radius: f32) -> Option<Self> {
        let tilt = if arrow.foreshortening.is_finite() { arrow.foreshortening.clamp(0.0, 1.0) } else { 1.0 };
        let direction = arrow.direction.try_normalize()?;
        // Seen from above, before foreshortening.
        let north = Vec2::new(direction.x * tilt.max(HARDLY_TILTED), direction.y).try_normalize()?;
        Some(Self { north, radius: Vec2::new(1.0, tilt.max(FLATTEST)) * radius })
    }

    fn on_picture(&self, ground: Vec2) -> Vec2 {
        let east = Vec2::new(-self.north.y, self.north.x);
        (self.north * ground.y + east * ground.x) * self.radius
    }

    fn ring(&self, share: f32) -> Option<Path> {
        let half = self.radius * share;
        PathBuilder::from_oval(Rect::from_ltrb(-half.x, -half.y, half.x, half.y)?)
    }
}

/// A slender needle, dark to the right of north and light to its left, notched at its foot.
fn draw_needle(plane: &Plane, sheet: &Sheet, drawing: &mut Drawing) -> Option<()> {
    let [tip, foot] = [Vec2::new(0.0, 0.98), Vec2::new(0.0, -0.42)].map(|point| plane.on_picture(point));
    let [right, left] = [0.42, -0.42].map(|x| plane.on_picture(Vec2::new(x, -0.72)));
    let whole = polygon(&[tip, right, foot, left])?;
    drawing.stroke(&whole, sheet.px(3.0), HALO);
    drawing.fill(polygon(&[tip, left, foot])?, PAPER);
    drawing.fill(polygon(&[tip, right, foot])?, INK);
    drawing.stroke(&whole, sheet.hairline(), INK);
    Some(())
}

fn draw_letter(plane: &Plane, sheet: &Sheet, setter: &mut Typesetter, drawing: &mut Drawing) {
    let letter = setter.line("N", Face::upright(letter_px(sheet), Face::BOLD));
    let tip = plane.on_picture(Vec2::Y);
    let middle = tip + tip.normalize_or(Vec2::NEG_Y) * letter_distance(sheet);
    let half = Vec2::new(-letter.advance * 0.5, letter.face.size_px * CAP_HEIGHT * 0.5);
    let lines = [(&letter, (middle + half).round())];
    halos(drawing, &lines, sheet.px(2.4).max(1.5));
    write(drawing, &lines, INK);
}

fn letter_px(sheet: &Sheet) -> f32 {
    sheet.type_px(20.0)
}

fn letter_distance(sheet: &Sheet) -> f32 {
    letter_px(sheet) * 0.62
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plane(x: f32, y: f32, foreshortening: f32) -> Plane {
        let arrow = NorthArrow { direction: Vec2::new(x, y), foreshortening };
        Plane::new(&arrow, 10.0).expect("a direction")
    }

    #[test]
    fn the_needle_points_where_north_is_on_the_picture() {
        for (x, y, tilt) in [(0.0, -1.0, 0.5), (0.6, -0.8, 0.5), (-0.9, 0.2, 0.9), (0.3, 0.8, 1.0)] {
            let tip = plane(x, y, tilt).on_picture(Vec2::Y);
            let off = tip.normalize().angle_to(Vec2::new(x, y).normalize());
            assert!(off.abs() < 1e-3, "{x} {y} {tilt}: {tip}");
        }
    }

    #[test]
    fn looking_down_the_ring_is_a_circle_and_looking_flat_it_is_not_flatter_than_readable() {
        assert_eq!(plane(0.6, -0.8, 1.0).on_picture(Vec2::Y).length(), 10.0);
        assert_eq!(plane(0.0, -1.0, 0.0).on_picture(Vec2::Y), Vec2::new(0.0, -10.0 * FLATTEST));
    }

    #[test]
    fn east_is_to_the_right_of_north() {
        let plane = plane(0.0, -1.0, 1.0);
        assert_eq!(plane.on_picture(Vec2::X), Vec2::new(10.0, 0.0));
    }

    #[test]
    fn the_arrow_stays_within_its_reach() {
        let sheet = Sheet::new(1920, 1080);
        for step in 0..32 {
            let angle = step as f32 * 0.2;
            let direction = Vec2::new(libm::cosf(angle), libm::sinf(angle));
            let arrow = NorthArrow { direction, foreshortening: 0.5 };
            let drawing = compose(&arrow, &sheet, &mut Typesetter::new()).expect("a direction");
            let bounds = drawing.bounds();
            let reached = bounds.min.abs().max(bounds.max.abs()).max_element();
            assert!(reached <= reach(&sheet) + 3.0, "{reached} at {angle}");
        }
    }

    #[test]
    fn no_direction_no_arrow() {
        for direction in [Vec2::ZERO, Vec2::NAN] {
            let arrow = NorthArrow { direction, foreshortening: 0.5 };
            assert!(compose(&arrow, &Sheet::new(100, 100), &mut Typesetter::new()).is_none());
        }
    }
}
