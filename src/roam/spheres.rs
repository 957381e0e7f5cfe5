//! Nested spheres: one radius a vertex says from where the vertex is wanted.
//!
//! A vertex is active exactly while the eye is inside its sphere. Each sphere holds the spheres of the vertex's
//! children, so whoever is inside a child's is inside its parents': the active vertices are closed under parents
//! by themselves, and no split is ever forced.
//!
//! `R = r` for a vertex without children, else `R = max(r, max over children c of |p − p_c| + R_c)`, with `r` the
//! distance within which the vertex's own error shows (constrained nested error criterion; Lindstrom and Pascucci
//! 2001 nest spheres the same way).

use glam::Vec3;

use crate::roam::graph::Vertex;
use crate::roam::ground::Ground;
use crate::roam::layout::Layout;

/// Spheres grow by this share from child to parent, so that rounding of f32 radii and f64 distances can never make
/// a child's sphere reach out of its parent's. Smaller than any error that shows, a thousand times the rounding.
const MARGIN: f64 = 1e-6;

/// The radius of every vertex's sphere, metres in drawn world space about the drawn vertex.
#[derive(Clone, Debug, PartialEq)]
pub struct SphereMap {
    radii: Vec<f32>,
}

impl SphereMap {
    /// The spheres whose own radii, in the order of [`Layout::index`], are given: each grown until it holds those of
    /// its children. A vertex that never shows has radius 0 and an own radius of 0; infinite radii are allowed.
    ///
    /// # Panics
    /// Where there is not one radius a vertex.
    pub fn nested(ground: Ground<'_>, own: Vec<f32>) -> Self {
        assert_eq!(own.len(), ground.layout.vertex_count(), "one radius a vertex");
        let mut map = Self { radii: own };
        let layout = ground.layout;
        let mut step = 1;
        while step < layout.patch() {
            for first in [(step, 0), (0, step), (step, step)] {
                for y in (first.1..layout.rows() as i32).step_by(2 * step as usize) {
                    for x in (first.0..layout.columns() as i32).step_by(2 * step as usize) {
                        map.grow(ground, Vertex::new(x, y));
                    }
                }
            }
            step *= 2;
        }
        map
    }

    /// The radius of a vertex's sphere, metres.
    #[inline]
    pub fn at(&self, layout: &Layout, vertex: Vertex) -> f32 {
        self.radii[layout.index(vertex)]
    }

    /// All radii, in the order of [`Layout::index`].
    pub fn values(&self) -> &[f32] {
        &self.radii
    }

    fn grow(&mut self, ground: Ground<'_>, vertex: Vertex) {
        let center = ground.position(vertex);
        let below = vertex
            .children()
            .filter(|&child| ground.layout.contains(child))
            .map(|child| around(center, ground.position(child), self.at(ground.layout, child)))
            .fold(0f32, f32::max);
        let slot = &mut self.radii[ground.layout.index(vertex)];
        *slot = slot.max(below);
    }
}

/// The radius about `center` that holds the sphere of `radius` about `child`; 0 for a child that never shows.
fn around(center: Vec3, child: Vec3, radius: f32) -> f32 {
    if radius == 0.0 {
        return 0.0;
    }
    let distance = (center.as_dvec3() - child.as_dvec3()).length();
    ((distance + f64::from(radius)) * (1.0 + MARGIN)).next_up() as f32
}
