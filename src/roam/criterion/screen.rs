//! The screen-space error whose tolerance holds at every post of the picture.

use crate::criterion::Criterion;
use crate::criterion::lens::Lens;
use crate::culling::PatchHeights;
use crate::errors::ErrorMap;
use crate::errors::coarse::CoarseErrors;
use crate::graph::Vertex;
use crate::patched_ground::PatchedGround;
use crate::spheres::reach;
use sandtable_view::camera::Camera;
use sandtable_view::frustum::Frustum;

/// The largest length that an error could span in the picture, over the tolerance.
///
/// The error is taken at the point of the triangles' box nearest to the eye, and pixels at the picture's corner, where they
/// are largest, so that `|displayed − ground|` never exceeds the tolerance in the picture where the errors are exact
/// (distance-only form of the criterion; a vertical error seen from above shows smaller). Vertices out of view are not
/// wanted.
#[derive(Clone, Copy, Debug)]
pub struct ScreenError<'a> {
    ground: PatchedGround<'a>,
    errors: ScreenedErrors<'a>,
    heights: &'a PatchHeights,
    /// `None` for an eye that turns around: nothing is out of view.
    frustum: Option<Frustum>,
    lens: Lens,
}

/// The errors that a criterion reads.
#[derive(Clone, Copy, Debug)]
pub enum ScreenedErrors<'a> {
    /// All of them, kept from picture to picture.
    Kept(&'a ErrorMap),
    /// Those measured for one picture.
    Coarse(&'a CoarseErrors<'a>),
}

impl<'a> From<&'a ErrorMap> for ScreenedErrors<'a> {
    fn from(errors: &'a ErrorMap) -> Self {
        Self::Kept(errors)
    }
}

impl<'a> From<&'a CoarseErrors<'a>> for ScreenedErrors<'a> {
    fn from(errors: &'a CoarseErrors<'a>) -> Self {
        Self::Coarse(errors)
    }
}

impl<'a> ScreenError<'a> {
    /// The criterion for one camera.
    pub fn new(
        ground: PatchedGround<'a>,
        errors: impl Into<ScreenedErrors<'a>>,
        heights: &'a PatchHeights,
        camera: &Camera,
        tolerance_px: f32,
    ) -> Self {
        let lens = Lens::with_scale(camera, reach(camera, tolerance_px));
        Self { ground, errors: errors.into(), heights, frustum: Some(Frustum::new(camera)), lens }
    }

    /// This criterion for an eye that turns around where the camera is.
    pub fn all_around(self) -> Self {
        Self { frustum: None, ..self }
    }
}

impl Criterion for ScreenError<'_> {
    fn excess(&self, vertex: Vertex) -> f32 {
        let error = match self.errors {
            ScreenedErrors::Kept(errors) => errors.at(self.ground.layout, vertex),
            ScreenedErrors::Coarse(errors) => errors.at(vertex),
        };
        if error == 0.0 {
            return 0.0;
        }
        match self.heights.diamond(self.ground, vertex) {
            Some((min, max)) if self.frustum.is_none_or(|frustum| frustum.may_see(min, max)) => {
                let nearest = self.lens.eye.clamp(min, max);
                self.lens.excess(error, nearest.distance(self.lens.eye))
            }
            _ => 0.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn an_error_is_refined_up_to_the_distance_where_it_spans_the_tolerance() {
        let camera = Camera::new(Vec3::ZERO, Vec3::Y, 0.8, (640, 480), (1.0, 9000.0)).expect("sound");
        let lens = Lens::with_scale(&camera, reach(&camera, 2.0));
        let at = |distance: f32| lens.excess(3.0, distance) > 1.0;
        let seen_px = |distance: f32| 3.0 * camera.pixels_per_meter(distance);
        assert!(at(500.0) && seen_px(500.0) > 2.0);
        let reach = 3.0 * lens.scale;
        assert!(at(reach * 0.999) && !at(reach * 1.001));
        assert!(seen_px(reach) <= 2.0);
    }
}
