//! Relief times half a block's side over distance (the quadtree rule of the outdoor terrain chapter, after Röttger).
//!
//! Refined while `err · r / d − k > 0`: err is the highest less the lowest post of a block (the [relief](ErrorMap::relief)),
//! r half its side, d the distance from the eye to its middle, k a constant in meters. On the vertex graph a block is the
//! square or diamond that a vertex is the middle of, and r its step.
//!
//! It promises no bound: a plane that slopes is refined like a ridge, and d is not the distance of the block's nearest
//! point. It errs on the fine side, most of all for large blocks, which keeps the quadtree's levels close to each other.
//! Not monotone: splits must be forced.

use glam::Vec3;

use crate::criterion::Criterion;
use crate::errors::ErrorMap;
use crate::graph::Vertex;
use crate::patched_ground::PatchedGround;
use sandtable_view::camera::Camera;

/// err · r / d over k.
#[derive(Clone, Copy, Debug)]
pub struct BlockRelief<'a> {
    ground: PatchedGround<'a>,
    relief: &'a ErrorMap,
    eye: Vec3,
    cell_m: f32,
    over_k: f32,
}

impl<'a> BlockRelief<'a> {
    /// The criterion for one camera. The finest blocks are refined where their relief spans `tolerance_px` pixels, above
    /// 0: with a post's spacing c and λ the pixels of a meter at a distance of one meter, k = τ · c / λ.
    pub fn new(ground: PatchedGround<'a>, relief: &'a ErrorMap, camera: &Camera, tolerance_px: f32) -> Self {
        let cell_m = ground.lattice.cell().max_element() as f32;
        Self::with_k(ground, relief, camera.eye(), tolerance_px * cell_m / camera.pixels_per_meter(1.0))
    }

    /// The criterion as published, for an eye in world space; `k_m`, meters, is above 0.
    pub fn with_k(ground: PatchedGround<'a>, relief: &'a ErrorMap, eye: Vec3, k_m: f32) -> Self {
        let cell_m = ground.lattice.cell().max_element() as f32;
        Self { ground, relief, eye, cell_m, over_k: 1.0 / k_m }
    }
}

impl Criterion for BlockRelief<'_> {
    #[inline]
    fn excess(&self, vertex: Vertex) -> f32 {
        let relief = self.relief.at(self.ground.layout, vertex);
        if relief == 0.0 || relief == f32::INFINITY {
            return relief;
        }
        let half_side = vertex.step() as f32 * self.cell_m;
        relief * half_side * self.over_k / self.ground.position(vertex).distance(self.eye)
    }
}
