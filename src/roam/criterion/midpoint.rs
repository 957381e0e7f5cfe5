//! Roughness below a hypotenuse's midpoint, seen from its distance (the criterion of 004).
//!
//! `λ · T / d > τ`: T is the largest distance between a midpoint and the mean of its hypotenuse's ends, of the
//! vertex and all below it (a midpoint [`ErrorMap`]); d is the distance from the eye to the hypotenuse's midpoint,
//! λ the pixels of a meter at a distance of one meter.
//!
//! It promises no bound, for two reasons: a midpoint says nothing of the other posts that a triangle covers, and
//! the nearest of these can be much nearer to the eye than the midpoint is. Nor is it monotone, since a child can
//! be nearer than its parents: splits have to be forced.

use crate::roam::criterion::Criterion;
use crate::roam::criterion::lens::Lens;
use crate::roam::errors::ErrorMap;
use crate::roam::graph::Vertex;
use crate::roam::patched_ground::PatchedGround;
use crate::view::camera::Camera;

/// The error of a vertex on the picture, over the tolerance, as if all of it stood at the vertex.
#[derive(Clone, Copy, Debug)]
pub struct Midpoint<'a> {
    ground: PatchedGround<'a>,
    errors: &'a ErrorMap,
    lens: Lens,
}

impl<'a> Midpoint<'a> {
    /// The criterion for one camera; `tolerance_px` is above 0.
    pub fn new(ground: PatchedGround<'a>, errors: &'a ErrorMap, camera: &Camera, tolerance_px: f32) -> Self {
        Self { ground, errors, lens: Lens::new(camera, tolerance_px) }
    }
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
