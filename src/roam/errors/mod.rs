//! Object-space errors: how far the triangles at each vertex are off the ground, from the finest level up.
//!
//! An error map holds one number a vertex, in meters, and never grows from a vertex to its children: the vertices above a
//! threshold are closed under parents. The measures, one file each:
//!
//! - `exact`: the largest vertical distance over every post that the vertex's triangles cover. A bound.
//! - `midpoint`: the vertical distance at the vertex alone. Fast, and no bound.
//! - `relief`: highest less lowest post that they cover. A loose bound.
//!
//! `sweep` raises errors to those of the children.

pub mod coarse;
pub mod exact;
pub mod midpoint;
pub mod near;
pub mod plane;
pub mod relief;
pub mod rows;
pub mod scan;
pub mod survey;
mod sweep;

use crate::errors::scan::larger;
use crate::errors::sweep::{KnownErrors, SweepSource};
use crate::graph::Vertex;
use crate::layout::PatchLayout;
use crate::levels::{ChildPlaces, ChildRows, PassRow, both_sides};

/// The object-space error of every vertex, in meters.
#[derive(Clone, Debug, PartialEq)]
pub struct ErrorMap {
    errors: Vec<f32>,
}

impl ErrorMap {
    /// The vertices' own errors, in the order of [`PatchLayout::index`], each raised to those of its children.
    ///
    /// # Panics
    /// Unless there is one error a vertex.
    pub fn raised(own: Vec<f32>, layout: &PatchLayout) -> Self {
        let mut errors = vec![0f32; own.len()];
        let sound = SweepSource::new(&own, layout).sweep::<KnownErrors>(&mut errors);
        debug_assert!(sound, "given errors are taken as they are");
        Self { errors }
    }

    /// All errors, in the order of [`PatchLayout::index`].
    pub fn values(&self) -> &[f32] {
        &self.errors
    }

    /// The errors of the row of vertices `y`.
    #[inline]
    pub(crate) fn row(&self, layout: &PatchLayout, y: usize) -> &[f32] {
        &self.errors[y * layout.columns()..][..layout.columns()]
    }

    /// The error at a vertex of the layout: meters, or infinite.
    #[inline]
    pub fn at(&self, layout: &PatchLayout, vertex: Vertex) -> f32 {
        self.errors[layout.index(vertex)]
    }

    /// Sets the errors of a row of a pass again from the vertices' `own`, by column, and their children's; adds the vertices
    /// whose error changed to `changed`.
    #[inline]
    pub(crate) fn renew_row(
        &mut self,
        layout: &PatchLayout,
        row: PassRow,
        mut own: impl FnMut(usize) -> f32,
        changed: &mut Vec<Vertex>,
    ) {
        let columns = layout.columns();
        let mut rows = row.values(&mut self.errors, layout);
        match row.pass.children() {
            None => row.renew(&mut rows, |_, _, x| own(x), changed),
            Some(ChildPlaces::Aslant(reach)) => {
                let below = |rows: &ChildRows<'_>, x: usize| {
                    let [west, east] = both_sides(x, reach, columns);
                    let [south, north] = [rows.south, rows.north].map(|row| larger(row[west], row[east]));
                    larger(south, north)
                };
                row.renew(&mut rows, |rows, _, x| larger(own(x), below(rows, x)), changed);
            }
            Some(ChildPlaces::Along(reach)) => {
                let below = |rows: &ChildRows<'_>, x: usize| {
                    let beside = larger(rows.here[x - reach], rows.here[x + reach]);
                    larger(beside, larger(rows.south[x], rows.north[x]))
                };
                row.renew(&mut rows, |rows, _, x| larger(own(x), below(rows, x)), changed);
            }
        }
    }

    /// Checks that no vertex has a smaller error than one of its children.
    ///
    /// # Panics
    /// Where one has.
    pub fn check(&self, layout: &PatchLayout) {
        for (vertex, child) in layout.descents() {
            let (own, below) = (self.at(layout, vertex), self.at(layout, child));
            assert!(own >= below, "{vertex:?} has error {own} m, its child {child:?} has {below} m");
        }
    }
}
