//! A view all around, or part of the way, on a cylinder with an upright axis through the eye.
//!
//! Columns are azimuths, as far apart everywhere; up a column, pixels are tangents of the angle above the horizon, to the same
//! scale where the horizon is: so uprights are upright, and the horizon is level.
//!
//! # Strips
//! ```text
//!  ┌──┬──┬──┬──┬──┬──┐    A cylinder is drawn as strips, each the middle of a picture in perspective by a level camera.
//!  │  │  │  │  │  │  │    A strip is so narrow that a pixel of the picture is off its place on the cylinder by no
//!  └──┴──┴──┴──┴──┴──┘    more than STRIP_ERROR_PX: its pixels are taken as they are.
//! ```
//! A place `x` pixels beside a strip's middle, at an angle `a = x / f` from it, is drawn at `f tan a`; one at `y` pixels above
//! the horizon at `y / cos a`. So at the border of the strip it is off by `f (tan a − a)` and `y (1 / cos a − 1)`.
//!
//! Why not on the cylinder at once: triangles have straight edges in perspective alone, and both renderers would need to cut
//! them. Why not from wide pictures, resampled: it blurs, more at some columns than at others.

use std::f32::consts::{PI, TAU};
use std::ops::Range;

use glam::{Vec2, Vec3};

use crate::camera::{Camera, CameraError, Projected};

/// How far a pixel may be off its place on the cylinder: less than the filter of a pixel is wide, and not seen.
pub const STRIP_ERROR_PX: f32 = 0.25;

/// A strip has at least so many columns: narrower ones cost more than they show.
const LEAST_COLUMNS: u32 = 8;

/// An eye that looks around, the part of the horizon that it sees and the size of the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Panorama {
    /// The eye, in world space.
    pub eye: Vec3,
    /// The azimuth of the left border, clockwise from north, radians.
    pub from_rad: f32,
    /// How far round the picture reaches, radians; a full turn at most.
    pub span_rad: f32,
    /// Width and height of the picture in pixels.
    pub size: (u32, u32),
    /// The horizon of the eye is the upper border of this row, which may be off the picture.
    pub horizon_row: i32,
    /// Near and far planes of its strips, meters.
    pub planes: (f32, f32),
}

/// Columns of a panorama that are drawn by one camera.
#[derive(Clone, Debug, PartialEq)]
pub struct PanoramaStrip {
    /// Its columns.
    pub columns: Range<u32>,
    /// The camera, whose picture is as wide as the strip.
    pub camera: Camera,
    /// The row of the camera's picture that is the uppermost of the panorama.
    pub first_row: u32,
}

impl Panorama {
    /// Pixels per radian of azimuth, and per unit of the tangent above the horizon.
    pub fn pixels_per_radian(&self) -> f32 {
        self.size.0 as f32 / self.span_rad
    }

    /// The azimuth of a column's position, clockwise from north, radians.
    pub fn azimuth_rad(&self, x_px: f32) -> f32 {
        self.from_rad + x_px / self.pixels_per_radian()
    }

    /// Where an azimuth is on the picture, in pixels from the left border; `None` beside it.
    pub fn x_px(&self, azimuth_rad: f32) -> Option<f32> {
        let round = |turn: f32| if turn < 0.0 { turn + TAU } else { turn };
        // What rounding puts a little to the left of the border is on it.
        let turn = round((azimuth_rad - self.from_rad + 1e-5) % TAU) - 1e-5;
        (turn <= self.span_rad).then(|| (turn * self.pixels_per_radian()).max(0.0))
    }

    /// The row at a tangent above the horizon, in pixels from the upper border.
    pub fn y_px(&self, rise: f32) -> f32 {
        self.horizon_row as f32 - rise * self.pixels_per_radian()
    }

    /// Where a world point is on the picture, and its distance from the eye in plan; `None` beside the picture's azimuths and
    /// straight above or below the eye.
    pub fn project(&self, world: Vec3) -> Option<Projected> {
        let offset = world - self.eye;
        let distance_m = offset.truncate().length();
        if distance_m < self.planes.0 {
            return None;
        }
        let x = self.x_px(libm::atan2f(offset.x, offset.y))?;
        Some(Projected { pixel: Vec2::new(x, self.y_px(offset.z / distance_m)), depth_m: distance_m })
    }

    /// A camera in perspective with pixels of the same size that looks level toward the middle of the picture, as high as it.
    ///
    /// # Errors
    /// See [`CameraError`].
    pub fn guide(&self) -> Result<Camera, CameraError> {
        let (width, height) = self.size;
        let size = ((height / 9).saturating_mul(16).max(1), height);
        self.level_camera(self.azimuth_rad(width as f32 * 0.5), size)
    }

    /// The strips, from left to right.
    ///
    /// # Errors
    /// The picture is so small, or its part of the horizon, that there is no camera for them.
    pub fn strips(&self) -> Result<Vec<PanoramaStrip>, CameraError> {
        let (width, height) = self.size;
        let horizon = i64::from(self.horizon_row);
        let half = horizon.max(i64::from(height) - horizon).clamp(1, i64::from(u32::MAX / 2));
        let first_row = (half - horizon).max(0) as u32;
        let half = half as u32;
        let wide = self.strip_columns(half);
        (0..width)
            .step_by(wide as usize)
            .map(|first| {
                let columns = first..(first + wide).min(width);
                let middle = (columns.start + columns.end) as f32 * 0.5;
                let size = (columns.end - columns.start, half * 2);
                let camera = self.level_camera(self.azimuth_rad(middle), size)?;
                Ok(PanoramaStrip { columns, camera, first_row })
            })
            .collect()
    }

    /// The most columns of a strip whose rows reach `half` pixels above and below the horizon.
    fn strip_columns(&self, half: u32) -> u32 {
        let f = self.pixels_per_radian();
        let off = |columns: u32| {
            let a = columns as f32 * 0.5 / f;
            (f * (libm::tanf(a) - a)).max(half as f32 * (1.0 / libm::cosf(a) - 1.0))
        };
        let widest = (f * PI * 0.25) as u32;
        let fits =
            (LEAST_COLUMNS..=widest.max(LEAST_COLUMNS)).take_while(|&columns| off(columns) <= STRIP_ERROR_PX);
        fits.last().unwrap_or(LEAST_COLUMNS)
    }

    fn level_camera(&self, azimuth_rad: f32, (width, height): (u32, u32)) -> Result<Camera, CameraError> {
        let toward = Vec3::new(libm::sinf(azimuth_rad), libm::cosf(azimuth_rad), 0.0);
        let fov_y = 2.0 * libm::atanf(height as f32 * 0.5 / self.pixels_per_radian());
        // Far from the origin, a target one meter ahead would round.
        let target = self.eye + toward * self.planes.1;
        Camera::new(self.eye, target, fov_y, (width, height), self.planes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn panorama() -> Panorama {
        Panorama {
            eye: Vec3::new(300.0, -200.0, 900.0),
            from_rad: PI,
            span_rad: TAU,
            size: (3000, 500),
            horizon_row: 210,
            planes: (0.5, 90_000.0),
        }
    }

    #[test]
    fn azimuths_are_as_far_apart_everywhere_and_north_is_in_the_middle() {
        let panorama = panorama();
        let at = |east: f32, north: f32, up: f32| {
            let seen = panorama.project(panorama.eye + Vec3::new(east, north, up)).expect("on the picture");
            (seen.pixel.x.round(), seen.pixel.y.round(), seen.depth_m.round())
        };
        assert_eq!(at(0.0, 1000.0, 0.0), (1500.0, 210.0, 1000.0));
        assert_eq!(at(1000.0, 0.0, 0.0), (2250.0, 210.0, 1000.0));
        assert_eq!(at(-1000.0, 0.0, 100.0), (750.0, 162.0, 1000.0));
    }

    #[test]
    fn a_place_beside_the_part_of_the_horizon_is_not_on_the_picture() {
        let part = Panorama { from_rad: 0.2, span_rad: 1.0, ..panorama() };
        assert_eq!((part.x_px(0.1), part.x_px(1.3), part.x_px(0.2)), (None, None, Some(0.0)));
        assert!((part.x_px(0.7 + TAU).expect("once round") - 1500.0).abs() < 0.1);
        assert!((part.x_px(0.7 - TAU).expect("once round") - 1500.0).abs() < 0.1);
        assert_eq!(part.project(part.eye + Vec3::Z * 50.0), None, "straight above the eye");
    }

    #[test]
    fn strips_cover_every_column_once_and_pixels_are_a_quarter_off_at_most() {
        for size in [(3000, 500), (700, 400), (6000, 1100), (400, 40)] {
            let panorama = Panorama { size, horizon_row: (size.1 as f32 * 0.4) as i32, ..panorama() };
            let strips = panorama.strips().expect("sound");
            let mut next = 0;
            let mut worst = 0.0f32;
            for PanoramaStrip { columns, camera, first_row } in &strips {
                assert_eq!(columns.start, next);
                next = columns.end;
                for x in [columns.start as f32 + 0.5, columns.end as f32 - 0.5] {
                    for y in [0.5, size.1 as f32 - 0.5] {
                        let pixel = Vec2::new(x - columns.start as f32, y + *first_row as f32);
                        let world = camera.point_at(pixel, 5000.0);
                        let seen = panorama.project(world).expect("on the picture").pixel;
                        worst = worst.max((seen - Vec2::new(x, y)).abs().max_element());
                    }
                }
            }
            assert_eq!(next, size.0);
            assert!(worst <= STRIP_ERROR_PX + 0.01, "{size:?}: {worst}");
        }
    }
}
