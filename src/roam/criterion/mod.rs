//! When does a vertex's error show? One file per criterion.
//!
//! A criterion is a function of a vertex and a view. It does not know how the mesh is refined, and a refiner
//! does not know what it is asked for: any criterion goes with any refiner, except where a refiner asks for
//! more than [`Criterion`] promises and says so in its types.

pub mod anisotropic;
pub mod block;
pub mod flat;
mod lens;
pub mod midpoint;
pub mod screen;
pub mod spheres;
pub mod variance;

use crate::roam::graph::Vertex;

/// What is asked of every vertex.
pub trait Criterion: Sync {
    /// How many times the tolerance the error of `vertex`, a vertex of the layout that is no patch corner, shows
    /// while the vertex is not active. The vertex is wanted where this is above 1; 0 where it has no error or cannot
    /// be seen, infinite where it must be active from everywhere. Never NaN.
    fn excess(&self, vertex: Vertex) -> f32;

    /// Whether the vertex is wanted.
    fn wants(&self, vertex: Vertex) -> bool {
        self.excess(vertex) > 1.0
    }
}
