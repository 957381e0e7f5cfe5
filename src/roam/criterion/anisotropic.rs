//! The screen-space error with the viewing direction (restricted quadtree after Lindstrom et al. 1996).
//!
//! `δ_s² = λ² n² δ² [(Vx−Ex)² + (Vy−Ey)²] / [(Vx−Ex)² + (Vy−Ey)² + (Vz−Ez)²]²`: a vertical error δ at the vertex V seen from
//! the eye E, foreshortened: λδ/d seen level, nothing seen from straight above. Here n is 1 and λ the pixels of a meter at a
//! distance of one meter, so that δ_s is pixels. δ is the error of the vertex and all below it (a raised [`ErrorMap`], the
//! midpoint error in the paper).
//!
//! It promises no bound: V is only one point of the triangles, and where the eye is above V but not above all of them, an
//! error beside it can show. Nor is it monotone: splits must be forced.

use crate::criterion::Criterion;
use crate::criterion::lens::Lens;
use crate::errors::ErrorMap;
use crate::graph::Vertex;
use crate::patched_ground::PatchedGround;
use sandtable_view::camera::Camera;

/// The length of a vertical error in the picture, over the tolerance.
#[derive(Clone, Copy, Debug)]
pub struct Anisotropic<'a> {
    ground: PatchedGround<'a>,
    errors: &'a ErrorMap,
    lens: Lens,
}

impl<'a> Anisotropic<'a> {
    /// The criterion for one camera; `tolerance_px` is above 0.
    pub fn new(ground: PatchedGround<'a>, errors: &'a ErrorMap, camera: &Camera, tolerance_px: f32) -> Self {
        Self { ground, errors, lens: Lens::new(camera, tolerance_px) }
    }
}

impl Criterion for Anisotropic<'_> {
    #[inline]
    fn excess(&self, vertex: Vertex) -> f32 {
        let error = self.errors.at(self.ground.layout, vertex);
        if error == 0.0 {
            return 0.0;
        }
        let sight = self.ground.position(vertex) - self.lens.eye;
        let squared = sight.length_squared();
        let seen = self.lens.excess(error, squared.sqrt());
        // With the eye on the vertex there is no direction to foreshorten by.
        if squared == 0.0 || seen == f32::INFINITY {
            return f32::INFINITY;
        }
        seen * (sight.truncate().length_squared() / squared).sqrt()
    }
}
