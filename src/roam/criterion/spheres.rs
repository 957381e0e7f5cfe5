//! Nested spheres as a criterion.

use glam::Vec3;

use crate::criterion::Criterion;
use crate::graph::Vertex;
use crate::patched_ground::PatchedGround;
use crate::spheres::SphereMap;

/// The criterion that a vertex is needed while the eye is inside its sphere.
#[derive(Clone, Copy, Debug)]
pub struct Spheres<'a> {
    ground: PatchedGround<'a>,
    map: &'a SphereMap,
    eye: Vec3,
}

impl<'a> Spheres<'a> {
    /// The spheres of `map` seen from `eye`, world space.
    pub fn new(ground: PatchedGround<'a>, map: &'a SphereMap, eye: Vec3) -> Self {
        Self { ground, map, eye }
    }
}

impl Criterion for Spheres<'_> {
    #[inline]
    fn excess(&self, vertex: Vertex) -> f32 {
        let radius = self.map.at(self.ground.layout, vertex);
        if radius == 0.0 {
            return 0.0;
        }
        (f64::from(radius) / distance(self.eye, self.ground.position(vertex))) as f32
    }

    #[inline]
    fn wants(&self, vertex: Vertex) -> bool {
        let radius = self.map.at(self.ground.layout, vertex);
        radius > 0.0 && distance(self.eye, self.ground.position(vertex)) < f64::from(radius)
    }
}

/// The distance in f64, so that neighbors agree about a vertex to the last bit and nested spheres stay nested.
#[inline]
pub fn distance(eye: Vec3, position: Vec3) -> f64 {
    (eye.as_dvec3() - position.as_dvec3()).length()
}
