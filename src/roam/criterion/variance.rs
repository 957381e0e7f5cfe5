//! Variance times the land's width over distance (the criterion of 000).
//!
//! `error = k · Variance · LandWidth / Distance`, refined while above 1. Variance is the largest distance between
//! a midpoint and the mean of its hypotenuse's ends below a vertex (a midpoint [`ErrorMap`]), Distance runs from
//! the eye to the hypotenuse's midpoint, LandWidth is the longer side of the whole terrain: it makes k mean the
//! same on a large and a small terrain seen from the same number of widths away.
//!
//! k is a measure of quality without a unit of its own. Where it is to mean pixels it must be
//! `λ / (LandWidth · τ)`, with λ the pixels of a meter at a distance of one meter and τ the tolerance; the width
//! then cancels, and the criterion is [`Midpoint`](crate::roam::criterion::midpoint::Midpoint)'s.
//!
//! Like that one it promises no bound and is not monotone.

use glam::Vec3;

use crate::roam::criterion::Criterion;
use crate::roam::criterion::lens::Lens;
use crate::roam::errors::ErrorMap;
use crate::roam::graph::Vertex;
use crate::roam::patched_ground::PatchedGround;
use crate::view::camera::Camera;

/// k · Variance · LandWidth / Distance.
#[derive(Clone, Copy, Debug)]
pub struct Variance<'a> {
    ground: PatchedGround<'a>,
    errors: &'a ErrorMap,
    lens: Lens,
}

impl<'a> Variance<'a> {
    /// The criterion for one camera, k such that it stands for a tolerance of `tolerance_px` pixels, above 0.
    pub fn new(ground: PatchedGround<'a>, errors: &'a ErrorMap, camera: &Camera, tolerance_px: f32) -> Self {
        let k = camera.pixels_per_meter(1.0) / (land_width_m(ground) * tolerance_px);
        Self::with_k(ground, errors, camera.eye(), k)
    }

    /// The criterion as published, for an eye in drawn world space; the greater `k`, 0 or more, the finer.
    pub fn with_k(ground: PatchedGround<'a>, errors: &'a ErrorMap, eye: Vec3, k: f32) -> Self {
        Self { ground, errors, lens: Lens::of_strength(eye, k * land_width_m(ground)) }
    }
}

/// The longer side of the terrain, meters.
fn land_width_m(ground: PatchedGround<'_>) -> f32 {
    ground.lattice.extent().size().max_element() as f32
}

impl Criterion for Variance<'_> {
    #[inline]
    fn excess(&self, vertex: Vertex) -> f32 {
        let variance = self.errors.at(self.ground.layout, vertex);
        if variance == 0.0 {
            return 0.0;
        }
        self.lens.excess(variance, self.ground.position(vertex).distance(self.lens.eye))
    }

    #[inline]
    fn wants(&self, vertex: Vertex) -> bool {
        let variance = self.errors.at(self.ground.layout, vertex);
        variance > 0.0
            && self.lens.shows(variance, self.ground.position(vertex).distance_squared(self.lens.eye))
    }
}
