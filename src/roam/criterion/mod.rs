//! Criteria: whether a vertex's error shows in a view, one file each.
//!
//! A criterion is a function of a vertex and a view. Any criterion works with any refiner, except where a refiner needs
//! more than [`Criterion`] promises and names it in its types.

pub mod anisotropic;
pub mod block;
pub mod flat;
mod lens;
pub mod midpoint;
pub mod screen;
pub mod spheres;

use crate::graph::Vertex;

/// A measure of vertices.
pub trait Criterion: Sync {
    /// The error that shows while `vertex`, a vertex of the layout but no patch corner, is inactive, as a multiple of the
    /// tolerance. The vertex is wanted above 1. 0 where it has no error or is out of view, infinite where it must be active
    /// from everywhere; never NaN.
    fn excess(&self, vertex: Vertex) -> f32;

    /// Whether the vertex is wanted.
    fn wants(&self, vertex: Vertex) -> bool {
        self.excess(vertex) > 1.0
    }
}
