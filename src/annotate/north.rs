//! The north arrow: a compass needle on the ground plane, as the camera sees it, upper right.
//!
//! In an oblique view the ground is foreshortened, and a direction on the picture alone does not show north. The arrow
//! is drawn on the ground plane and projected with it: its ring shows the tilt, and its needle points along the
//! meridian. The letter stays upright. Below the ring, or beside it, it says which north it is: true north, or that of the
//! grid where nothing more is known.

use glam::Vec2;
use tiny_skia::{Path, PathBuilder, Rect};

use crate::composer::Composer;
use crate::drawing::{Drawing, polygon, polyline};
use crate::sheet::{FRAME, HALO, INK, PANEL, PAPER, Sheet};
use crate::text::{CAP_HEIGHT, TextStyle};
use sandtable_view::camera::Camera;

/// The least tilt of a legible needle; views nearer the horizon are drawn with this tilt.
const FLATTEST: f32 = 0.4;
/// Below this tilt the ground's direction cannot be recovered from its direction on the picture.
const LEAST_TILT: f32 = 0.02;
/// Radius of the ring in design pixels.
const RADIUS: f32 = 40.0;
/// The size of what it says, and the space above that, in design pixels.
const CAPTION: [f32; 2] = [12.0, 4.0];
/// Space between ring and letter, in ems of the letter.
const LETTER_GAP: f32 = 0.16;

/// The direction of north and the foreshortening of the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NorthArrow {
    /// The direction of north at the picture's middle; X right and Y down. Any length but zero.
    pub direction: Vec2,
    /// The ratio of a length into the picture to the same length across it, as they appear: the sine of the angle at
    /// which the camera looks down. 1 looking straight down, 0 at the horizon.
    pub foreshortening: f32,
    /// Which north it is.
    pub kind: NorthKind,
}

/// What a north arrow points to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NorthKind {
    /// The pole, along the meridian.
    True,
    /// Where northings grow, for ground without a place on Earth.
    Grid,
}

impl NorthKind {
    /// What the arrow says.
    fn caption(self) -> &'static str {
        match self {
            Self::True => "true north",
            Self::Grid => "grid north",
        }
    }
}

impl NorthArrow {
    /// The direction `north` of world X and Y, which is north of this kind, as `camera` sees it on the ground at the middle
    /// of its picture.
    pub fn from_camera(camera: &Camera, north: Vec2, kind: NorthKind) -> Self {
        let foreshortening = (camera.forward().z.abs() * camera.stretch()).clamp(LEAST_TILT, 1.0);
        // The right of the picture is level, and what is ahead lies to its left. A level view, whose horizon would hide
        // whether north is ahead, is tilted.
        let right = camera.right().truncate();
        let ahead = right.perp();
        let direction = Vec2::new(north.dot(right), -north.dot(ahead) * foreshortening);
        Self { direction, foreshortening, kind }
    }
}

/// Where an arrow says which north it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum CaptionPlace {
    /// Below it, on a picture.
    Below,
    /// To its right, in a column.
    Beside,
}

/// The arrow around the origin; `None` where its direction is zero or not finite.
pub(crate) fn compose(arrow: &NorthArrow, caption: CaptionPlace, composer: &mut Composer) -> Option<Drawing> {
    let sheet = composer.sheet;
    let plane = ArrowPlane::new(arrow, sheet.px(RADIUS))?;
    let mut drawing = Drawing::default();
    drawing.fill(plane.ring()?, PANEL);
    drawing.stroke(&plane.ring()?, sheet.hairline(), FRAME);
    for quarter in [Vec2::X, Vec2::NEG_X, Vec2::NEG_Y] {
        let tick = polyline(&[plane.on_picture(quarter * 0.86), plane.on_picture(quarter)])?;
        drawing.stroke(&tick, sheet.hairline(), INK);
    }
    draw_needle(&plane, &sheet, &mut drawing)?;
    draw_letter(&plane, composer, &mut drawing);
    draw_caption((arrow.kind, caption), composer, &mut drawing);
    Some(drawing)
}

/// The farthest that ring and letter reach from the center in any direction: its distance from the border.
pub(crate) fn reach(sheet: &Sheet) -> f32 {
    let letter = sheet.type_px(LETTER_SIZE) * (CAP_HEIGHT + LETTER_GAP) + letter_halo(sheet);
    (sheet.px(RADIUS) + letter).ceil()
}

/// The ground around the arrow's center: north along Y, east along X, the ring at distance 1.
struct ArrowPlane {
    north: Vec2,
    radius: Vec2,
}

impl ArrowPlane {
    fn new(arrow: &NorthArrow, radius: f32) -> Option<Self> {
        let tilt = if arrow.foreshortening.is_finite() { arrow.foreshortening.clamp(0.0, 1.0) } else { 1.0 };
        let direction = arrow.direction.try_normalize()?;
        // Seen from above, before foreshortening.
        let north = Vec2::new(direction.x * tilt.max(LEAST_TILT), direction.y).try_normalize()?;
        Some(Self { north, radius: Vec2::new(1.0, tilt.max(FLATTEST)) * radius })
    }

    fn on_picture(&self, ground: Vec2) -> Vec2 {
        (self.north * ground.y + self.north.perp() * ground.x) * self.radius
    }

    fn ring(&self) -> Option<Path> {
        let Vec2 { x, y } = self.radius;
        PathBuilder::from_oval(Rect::from_ltrb(-x, -y, x, y)?)
    }
}

/// A slender needle, dark to the right of north and light to its left, notched at its foot.
fn draw_needle(plane: &ArrowPlane, sheet: &Sheet, drawing: &mut Drawing) -> Option<()> {
    let [tip, foot] = [Vec2::new(0.0, 0.98), Vec2::new(0.0, -0.52)].map(|point| plane.on_picture(point));
    let [right, left] = [0.25, -0.25].map(|x| plane.on_picture(Vec2::new(x, -0.7)));
    let outline = polygon(&[tip, right, foot, left])?;
    drawing.stroke(&outline, sheet.px(3.0), HALO);
    drawing.fill(polygon(&[tip, left, foot])?, PAPER);
    drawing.fill(polygon(&[tip, right, foot])?, INK);
    drawing.stroke(&outline, sheet.hairline(), INK);
    Some(())
}

/// Draws the letter beyond the tip on the ring's outward normal, so that it clears the ring at any tilt.
fn draw_letter(plane: &ArrowPlane, composer: &mut Composer, drawing: &mut Drawing) {
    let letter = composer.line("N", composer.style(LETTER_SIZE, TextStyle::BOLD));
    let half = Vec2::new(letter.advance, letter.style.cap_px()) * 0.5;
    let tip = plane.on_picture(Vec2::Y);
    let outward = (tip / (plane.radius * plane.radius)).normalize_or(Vec2::NEG_Y);
    // The reach of the letter's box along the normal, and a gap.
    let away = outward.abs().dot(half) + letter.style.size_px * LETTER_GAP;
    let start = tip + outward * away + Vec2::new(-half.x, half.y);
    drawing.write_haloed(&letter, start.round(), letter_halo(&composer.sheet), INK);
}

/// Writes which north it is, clear of all else.
fn draw_caption((kind, place): (NorthKind, CaptionPlace), composer: &mut Composer, drawing: &mut Drawing) {
    let [size, gap] = CAPTION;
    let line = composer.line(kind.caption(), composer.style(size, TextStyle::REGULAR));
    let (cap, gap, corner) = (line.style.cap_px(), composer.sheet.px(gap), drawing.bounds().max);
    let start = match place {
        CaptionPlace::Below => Vec2::new(-line.advance * 0.5, corner.y + gap + cap),
        CaptionPlace::Beside => Vec2::new(corner.x + 2.0 * gap, cap * 0.5),
    };
    drawing.write_haloed(&line, start.round(), letter_halo(&composer.sheet), INK);
}

/// Size of the letter in design pixels.
const LETTER_SIZE: f32 = 20.0;

fn letter_halo(sheet: &Sheet) -> f32 {
    sheet.px(2.4).max(1.5)
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    fn plane(x: f32, y: f32, foreshortening: f32) -> ArrowPlane {
        let arrow = NorthArrow { direction: Vec2::new(x, y), foreshortening, kind: NorthKind::True };
        ArrowPlane::new(&arrow, 10.0).expect("a direction")
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
    fn the_ring_is_a_circle_from_above_and_never_flatter_than_legible() {
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
            let arrow = NorthArrow { direction, foreshortening: 0.5, kind: NorthKind::True };
            let drawing =
                compose(&arrow, CaptionPlace::Below, &mut Composer::new(1920, 1080)).expect("a direction");
            let bounds = drawing.bounds();
            let reached = bounds.min.abs().max_element().max(bounds.max.x);
            assert!(reached <= reach(&sheet) + 3.0, "{reached} at {angle}");
            assert!(bounds.max.y <= reach(&sheet) + 3.0 + sheet.px(CAPTION[0] + CAPTION[1]), "{angle}");
        }
    }

    #[test]
    fn the_arrow_of_a_camera_points_where_the_camera_projects_north() {
        for (east, north) in [(300.0, 400.0), (-500.0, 20.0), (90.0, -700.0), (0.0, 600.0)] {
            let eye = Vec3::new(0.0, 0.0, 350.0);
            let target = Vec3::new(east, north, 0.0);
            let camera = Camera::new(eye, target, 0.7, (800, 600), (1.0, 9000.0)).expect("a sound camera");
            let pixel = |at: Vec3| camera.project(at).expect("in front of the eye").pixel;
            let seen = pixel(target + Vec3::Y * 0.5) - pixel(target - Vec3::Y * 0.5);
            let arrow = NorthArrow::from_camera(&camera, Vec2::Y, NorthKind::Grid);
            let off = arrow.direction.angle_to(seen);
            assert!(off.abs() < 0.01, "{off} looking at {target}");
        }
    }

    #[test]
    fn true_north_points_where_the_camera_projects_the_meridian() {
        for turn in [0.3f32, 1.15, -2.0, 3.1] {
            let north = Vec2::new(libm::sinf(turn), libm::cosf(turn));
            let target = Vec3::new(200.0, 300.0, 0.0);
            let eye = Vec3::new(-50.0, -90.0, 350.0);
            let camera = Camera::new(eye, target, 0.7, (800, 600), (1.0, 9000.0)).expect("a sound camera");
            let pixel = |at: Vec3| camera.project(at).expect("in front of the eye").pixel;
            let step = (north * 0.5).extend(0.0);
            let seen = pixel(target + step) - pixel(target - step);
            let off = NorthArrow::from_camera(&camera, north, NorthKind::True).direction.angle_to(seen);
            assert!(off.abs() < 0.01, "{off} at {turn}");
        }
    }

    #[test]
    fn a_level_view_still_knows_north_ahead_from_north_behind() {
        for (target, up) in [(Vec3::Y, true), (Vec3::NEG_Y, false)] {
            let camera =
                Camera::new(Vec3::ZERO, target, 0.7, (800, 600), (1.0, 9.0)).expect("a sound camera");
            let arrow = NorthArrow::from_camera(&camera, Vec2::Y, NorthKind::Grid);
            assert_eq!(arrow.direction.y < 0.0, up);
        }
    }

    #[test]
    fn no_direction_no_arrow() {
        for direction in [Vec2::ZERO, Vec2::NAN] {
            let arrow = NorthArrow { direction, foreshortening: 0.5, kind: NorthKind::True };
            assert!(compose(&arrow, CaptionPlace::Below, &mut Composer::new(100, 100)).is_none());
        }
    }
}
