//! How far the triangles at each vertex are off the ground: object-space errors, computed once, from the finest
//! level up.
//!
//! An error map holds one number a vertex, in metres without exaggeration, and never grows from a vertex to its
//! children: a decision "error above a threshold" is then closed under parents by itself. What the number
//! measures differs; one file per measure:
//!
//! - `exact`: the largest vertical distance over every post that the vertex's triangles cover. A bound.
//! - `midpoint`: the vertical distance at the vertex alone. Fast, and no bound.
//! - `relief`: highest less lowest post that they cover. A bound too, and a lazy one.
//!
//! `sweep` raises whatever was measured to what is below it.

pub mod exact;
pub mod midpoint;
pub mod near;
pub mod plane;
pub mod relief;
pub mod rows;
pub mod scan;
pub mod survey;
mod sweep;

use crate::roam::errors::sweep::{Field, Given};
use crate::roam::graph::Vertex;
use crate::roam::layout::Layout;
use crate::roam::levels::Pass;

/// The object-space error of every vertex, in metres without exaggeration.
#[derive(Clone, Debug, PartialEq)]
pub struct ErrorMap {
    errors: Vec<f32>,
}

impl ErrorMap {
    /// The map of the vertices' own errors, in the order of [`Layout::index`], each raised to those of its
    /// children.
    ///
    /// # Panics
    /// Where there is not one error a vertex.
    pub fn raised(own: Vec<f32>, layout: &Layout) -> Self {
        assert_eq!(own.len(), layout.vertex_count(), "one error a vertex");
        let mut map = Self { errors: own };
        map.raise_to_children(layout);
        map
    }

    /// All errors, in the order of [`Layout::index`].
    pub fn values(&self) -> &[f32] {
        &self.errors
    }

    /// The error at a vertex of the layout it was measured with: metres, or infinite.
    #[inline]
    pub fn at(&self, layout: &Layout, vertex: Vertex) -> f32 {
        self.errors[layout.index(vertex)]
    }

    /// Sets the error of a vertex of `pass` again from its own and those of its children, which are as they shall be;
    /// tells whether it changed.
    #[inline]
    pub(in crate::roam) fn renew(&mut self, layout: &Layout, pass: Pass, vertex: Vertex, own: f32) -> bool {
        let (reach, mut error) = (pass.child_reach(), own);
        for &(x, y) in pass.child_offsets() {
            let child = vertex.moved(x * reach, y * reach);
            if layout.contains(child) {
                error = error.max(self.errors[layout.index(child)]);
            }
        }
        std::mem::replace(&mut self.errors[layout.index(vertex)], error) != error
    }

    /// Makes every vertex's error at least that of its children, finest level first; patch corners get none.
    fn raise_to_children(&mut self, layout: &Layout) {
        let mut raised = vec![0f32; self.errors.len()];
        let sound = Field::new(&self.errors, layout).sweep::<Given>(&mut raised);
        debug_assert!(sound, "given errors are taken as they are");
        self.errors = raised;
    }

    /// Whether no vertex has a smaller error than one of its children.
    ///
    /// # Errors
    /// A sentence naming the first pair that is out of order.
    pub fn check(&self, layout: &Layout) -> Result<(), String> {
        for index in 0..layout.vertex_count() {
            let vertex = Vertex::new((index % layout.columns()) as i32, (index / layout.columns()) as i32);
            if layout.is_corner(vertex) {
                continue;
            }
            for child in vertex.children().filter(|&child| layout.contains(child)) {
                let (own, below) = (self.at(layout, vertex), self.at(layout, child));
                if own < below {
                    return Err(format!("{vertex:?} has error {own} m, its child {child:?} has {below} m"));
                }
            }
        }
        Ok(())
    }
}
