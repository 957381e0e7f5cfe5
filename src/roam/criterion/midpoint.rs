//! The midpoint error at the distance of the vertex, in two published forms.
//!
//! T is the largest distance between a midpoint and the mean of its hypotenuse's ends, of the vertex and all below it (a
//! midpoint [`ErrorMap`]); d is the distance from the eye to the hypotenuse's midpoint, λ the pixels of a meter at a
//! distance of one meter, τ the tolerance.
//!
//! - Zhang et al. (patch-based ROAM by roughness): refined where `λ · T / d > τ`.
//! - Lin et al. (patch-based ROAM): `error = k · Variance · LandWidth / Distance`, refined where above 1, with Variance = T
//!   and LandWidth the longer side of the terrain: k means the same on a large and a small terrain seen from the same
//!   number of widths away. k has no unit; with `k = λ / (LandWidth · τ)` the width cancels, and the two forms agree.
//!
//! Neither promises a bound: a midpoint says nothing about the other posts that a triangle covers, and the nearest of these
//! can be much nearer to the eye. Neither is monotone, since a child can be nearer than its parents: splits must be forced.

use glam::Vec3;

use crate::criterion::Criterion;
use crate::criterion::lens::Lens;
use crate::errors::ErrorMap;
use crate::graph::Vertex;
use crate::patched_ground::PatchedGround;
use sandtable_view::camera::Camera;

/// The error of a vertex as if all of it were at the vertex, over the tolerance.
#[derive(Clone, Copy, Debug)]
pub struct Midpoint<'a> {
    ground: PatchedGround<'a>,
    errors: &'a ErrorMap,
    lens: Lens,
}

impl<'a> Midpoint<'a> {
    /// The form of Zhang et al. for one camera; `tolerance_px` is above 0.
    pub fn new(ground: PatchedGround<'a>, errors: &'a ErrorMap, camera: &Camera, tolerance_px: f32) -> Self {
        Self { ground, errors, lens: Lens::new(camera, tolerance_px) }
    }

    /// The form of Lin et al. for one camera, with the k of a tolerance of `tolerance_px` pixels, above 0.
    pub fn by_land_width(
        ground: PatchedGround<'a>,
        errors: &'a ErrorMap,
        camera: &Camera,
        tolerance_px: f32,
    ) -> Self {
        let k = camera.pixels_per_meter(1.0) / (land_width_m(ground) * tolerance_px);
        Self::with_k(ground, errors, camera.eye(), k)
    }

    /// The form of Lin et al. as published, for an eye in world space; the greater `k`, 0 or more, the finer.
    pub fn with_k(ground: PatchedGround<'a>, errors: &'a ErrorMap, eye: Vec3, k: f32) -> Self {
        Self { ground, errors, lens: Lens { eye, scale: k * land_width_m(ground), is_parallel: false } }
    }
}

/// The longer side of the terrain, meters.
fn land_width_m(ground: PatchedGround<'_>) -> f32 {
    ground.lattice.extent().size().max_element() as f32
}

impl Criterion for Midpoint<'_> {
    #[inline]
    fn excess(&self, vertex: Vertex) -> f32 {
        let error = self.errors.at(self.ground.layout, vertex);
        if error == 0.0 {
            return 0.0;
        }
        self.lens.excess(error, self.ground.position(vertex).distance(self.lens.eye))
    }

    #[inline]
    fn wants(&self, vertex: Vertex) -> bool {
        let error = self.errors.at(self.ground.layout, vertex);
        error > 0.0 && self.lens.shows(error, self.ground.position(vertex).distance_squared(self.lens.eye))
    }
}
