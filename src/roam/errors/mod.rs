//! How far the triangles at each vertex are off the ground: object-space errors, computed once, from the finest
//! level up.
//!
//! An error map holds one number a vertex, in meters without exaggeration, and never grows from a vertex to its
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

use crate::roam::errors::scan::larger;
use crate::roam::errors::sweep::{KnownErrors, SweepSource};
use crate::roam::graph::{Vertex, VertexKind};
use crate::roam::layout::PatchLayout;
use crate::roam::levels::{ChildRows, PassRow, both_sides};

/// The object-space error of every vertex, in meters without exaggeration.
#[derive(Clone, Debug, PartialEq)]
pub struct ErrorMap {
    errors: Vec<f32>,
}

impl ErrorMap {
    /// The map of the vertices' own errors, in the order of [`PatchLayout::index`], each raised to those of its
    /// children.
    ///
    /// # Panics
    /// Where there is not one error a vertex.
    pub fn raised(own: Vec<f32>, layout: &PatchLayout) -> Self {
        assert_eq!(own.len(), layout.vertex_count(), "one error a vertex");
        let mut map = Self { errors: own };
        map.raise_to_children(layout);
        map
    }

    /// All errors, in the order of [`PatchLayout::index`].
    pub fn values(&self) -> &[f32] {
        &self.errors
    }

    /// The errors of the row of vertices `y`.
    #[inline]
    pub(in crate::roam) fn row(&self, layout: &PatchLayout, y: usize) -> &[f32] {
        &self.errors[y * layout.columns()..][..layout.columns()]
    }

    /// The error at a vertex of the layout it was measured with: meters, or infinite.
    #[inline]
    pub fn at(&self, layout: &PatchLayout, vertex: Vertex) -> f32 {
        self.errors[layout.index(vertex)]
    }

    /// Sets the errors of a row of a pass again from the vertices' own, which `own` says of each column, and those of
    /// their children, which are as they shall be; adds the vertices whose error changed to `changed`.
    #[inline]
    pub(in crate::roam) fn renew_row(
        &mut self,
        layout: &PatchLayout,
        row: PassRow,
        mut own: impl FnMut(usize) -> f32,
        changed: &mut Vec<Vertex>,
    ) {
        let (reach, columns) = (row.pass.child_reach(), layout.columns());
        let ChildRows { here, south, north } = row.of(&mut self.errors, layout);
        let mut put = |here: &mut [f32], x: usize, error: f32| {
            if std::mem::replace(&mut here[x], error) != error {
                changed.push(Vertex::new(x as i32, row.y as i32));
            }
        };
        if row.pass.is_finest() {
            row.columns().for_each(|x| put(here, x, own(x)));
        } else if row.pass.kind == VertexKind::Center {
            for x in row.columns() {
                let below = larger(larger(here[x - reach], here[x + reach]), larger(south[x], north[x]));
                put(here, x, larger(own(x), below));
            }
        } else {
            for x in row.columns() {
                let [west, east] = both_sides(x, reach, columns);
                let below = larger(larger(south[west], south[east]), larger(north[west], north[east]));
                put(here, x, larger(own(x), below));
            }
        }
    }

    /// Makes every vertex's error at least that of its children, finest level first; patch corners get none.
    fn raise_to_children(&mut self, layout: &PatchLayout) {
        let mut raised = vec![0f32; self.errors.len()];
        let sound = SweepSource::new(&self.errors, layout).sweep::<KnownErrors>(&mut raised);
        debug_assert!(sound, "given errors are taken as they are");
        self.errors = raised;
    }

    /// Whether no vertex has a smaller error than one of its children.
    ///
    /// # Errors
    /// A sentence naming the first pair that is out of order.
    pub fn check(&self, layout: &PatchLayout) -> Result<(), String> {
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
