//! The width of a pixel on the ground, across a line.

use glam::{DVec2, DVec3};

use sandtable_geom::rect::Rect;
use sandtable_scene::symbols::px_scale;
use sandtable_view::camera::Camera;
use sandtable_view::frustum::Frustum;

/// The most that a width grows because ground is seen at a low angle. Ground is seldom level where it is seen lower than
/// at twenty degrees.
const MOST_FORESHORTENING: f64 = 3.0;

/// The pixels of a picture, on the ground.
pub(super) struct LineScale<'a> {
    camera: &'a Camera,
    /// Pixels of the picture in one of a picture 1080 lines high.
    pub px: f64,
    /// Whether each place is in the picture's middle.
    turns: bool,
    /// Whether the picture is seen from all sides, although it is planned for the camera.
    is_all_round: bool,
}

impl<'a> LineScale<'a> {
    pub fn new(camera: &'a Camera) -> Self {
        Self { camera, px: px_scale(camera.size().1), turns: false, is_all_round: false }
    }

    /// The scale for an eye that turns around where the camera is: pixels as they are when it looks at the place.
    pub fn around(camera: &'a Camera) -> Self {
        Self { turns: camera.parallel_frame().is_none(), ..Self::new(camera) }
    }

    /// The scale for pictures that are seen from all sides, with `px` of their pixels in one of a picture 1080 lines high; it
    /// is planned for the camera.
    pub fn all_round(camera: &'a Camera, px: f64) -> Self {
        Self { px, is_all_round: true, ..Self::new(camera) }
    }

    /// The part of space in view; `None` where the eye turns around.
    pub fn frustum(&self) -> Option<Frustum> {
        (!self.turns).then(|| Frustum::new(self.camera))
    }

    /// Rightward, upward and forward for a place `offset` from the eye.
    pub fn axes(&self, offset: DVec3) -> [DVec3; 3] {
        let own = [self.camera.right(), self.camera.up(), self.camera.forward()].map(|axis| axis.as_dvec3());
        let Some(forward) = offset.try_normalize().filter(|_| self.turns) else { return own };
        let right = forward.cross(DVec3::Z).try_normalize().unwrap_or(DVec3::X);
        [right, right.cross(forward), forward]
    }

    /// Meters of level ground, across a line through `at` along `along` (of length 1), in a pixel across the line on the
    /// picture.
    pub fn meters_per_px(&self, at: DVec3, along: DVec2) -> f64 {
        let offset = at - self.camera.eye().as_dvec3();
        let [along, across] = [along, along.perp()].map(|way| self.on_picture(offset, way.extend(0.0)));
        let foreshortened = across.perp_dot(along.normalize_or_zero()).abs();
        self.meters_per_px_at(self.depth_m(offset)) / foreshortened.max(1.0 / MOST_FORESHORTENING)
    }

    /// The pixels, of a picture 1080 lines high, that lie between `at` and what is `rise_m` meters above it; where the picture
    /// is seen from all sides, the most.
    pub fn rise_px(&self, at: DVec3, rise_m: f64) -> f64 {
        let offset = at - self.camera.eye().as_dvec3();
        let length = if self.is_all_round { 1.0 } else { self.on_picture(offset, DVec3::Z).length() };
        length * rise_m / (self.px * self.meters_per_px_at(self.depth_m(offset)))
    }

    /// The depth of a place `offset` from the eye, meters; at least that of the near plane.
    fn depth_m(&self, offset: DVec3) -> f64 {
        let [_, _, forward] = self.axes(offset);
        offset.dot(forward).max(f64::from(self.camera.planes().0))
    }

    /// What a meter along `way` at a place `offset` from the eye spans on the picture, rightward and upward, in what a meter
    /// square to the view spans there.
    fn on_picture(&self, offset: DVec3, way: DVec3) -> DVec2 {
        let [right, up, forward] = self.axes(offset);
        if self.camera.parallel_frame().is_some() {
            return DVec2::new(way.dot(right), way.dot(up) * f64::from(self.camera.stretch()));
        }
        let away = way.dot(forward) / self.depth_m(offset);
        DVec2::new(way.dot(right) - offset.dot(right) * away, way.dot(up) - offset.dot(up) * away)
    }

    /// Meters in a pixel, square to the view, at the place of a rectangle at height `z` that is the nearest to the eye.
    pub fn nearest_meters_per_px(&self, rect: &Rect, z: f64) -> f64 {
        let eye = self.camera.eye().as_dvec3();
        let nearest = eye.truncate().clamp(rect.min, rect.max).extend(z);
        self.meters_per_px_at(nearest.distance(eye))
    }

    /// Meters in a pixel at a depth, square to the view.
    pub fn meters_per_px_at(&self, depth_m: f64) -> f64 {
        1.0 / f64::from(self.camera.pixels_per_meter((depth_m as f32).max(self.camera.planes().0)))
    }
}
