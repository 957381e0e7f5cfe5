//! A mesh of the ground with a verified error bound.
//!
//! The bound is not taken on trust from the arithmetic that chose the triangles: the mesh is measured in f64 at every
//! post, and refined further where rounding broke the bound. With every post a vertex there is no error left, so the
//! refinement ends.

use std::sync::Arc;

use crate::mesh::trimesh::TriMesh;
use crate::roam::bound::{self, BoundError, Deviation};
use crate::roam::closure::least_closure;
use crate::roam::displayed::DisplayedTerrain;
use crate::roam::layout::PatchLayout;
use crate::terrain::lattice::Lattice;

/// The side of the largest patch in cells: flat ground needs fewer triangles in larger patches.
const LARGEST_PATCH: u32 = 4096;

/// The rounding error of f32 distances, as a share of the relief.
const ROUNDING: f64 = 1e-6;

/// A tolerance that no triangle keeps.
const KEEP_EVERY_POST: f64 = -1.0;

/// A mesh and its measured distance from the ground.
pub struct BoundedMesh {
    /// World space: meters from the south-west post, Z up.
    pub mesh: TriMesh,
    /// Vertical distances at the posts.
    pub deviation: Deviation,
}

/// Ground that gives no mesh.
#[derive(Debug, thiserror::Error)]
pub enum MeshError {
    /// The ground has too many posts.
    #[error("{columns} x {rows} posts are more than one mesh can be made of; cut it into parts")]
    TooLarge {
        /// Posts per row.
        columns: u32,
        /// Rows.
        rows: u32,
    },
    /// No three posts of a cell have data.
    #[error("nowhere do three posts of one cell have data, so there is no triangle to write")]
    Empty,
    /// The mesh cannot be measured.
    #[error(transparent)]
    Bound(#[from] BoundError),
}

impl BoundedMesh {
    /// The mesh of `lattice` with the fewest triangles that is off by at most `max_error_m` at every post.
    ///
    /// # Errors
    /// See [`MeshError`].
    pub fn new(lattice: &Arc<Lattice>, max_error_m: f64) -> Result<Self, MeshError> {
        let (columns, rows) = (lattice.columns(), lattice.rows());
        let layout = layout(lattice).ok_or(MeshError::TooLarge { columns, rows })?;
        let (low, high) = lattice.height_range();
        let slack_m = (f64::from(high) - f64::from(low)) * ROUNDING;
        let reduced = |slack_m: f64| (max_error_m - slack_m).max(0.0);
        let mut bounded = Self::with_tolerance(lattice, &layout, reduced(slack_m))?;
        for tolerance_m in [reduced(16.0 * slack_m), KEEP_EVERY_POST] {
            if bounded.deviation.max_m > max_error_m {
                bounded = Self::with_tolerance(lattice, &layout, tolerance_m)?;
            }
        }
        if bounded.mesh.triangles.is_empty() { Err(MeshError::Empty) } else { Ok(bounded) }
    }

    fn with_tolerance(
        lattice: &Arc<Lattice>,
        layout: &PatchLayout,
        tolerance_m: f64,
    ) -> Result<Self, MeshError> {
        let active = least_closure(lattice, layout, tolerance_m.min(f64::from(f32::MAX)) as f32);
        let mut mesh = TriMesh::default();
        DisplayedTerrain::new(Arc::clone(lattice), active, layout.patches().collect()).emit(&mut mesh);
        let deviation = bound::measure(lattice, &mesh)?;
        Ok(Self { mesh, deviation })
    }
}

/// One patch over everything, or as few as possible.
fn layout(lattice: &Lattice) -> Option<PatchLayout> {
    let (columns, rows) = (lattice.columns(), lattice.rows());
    let whole = (columns.max(rows) - 1).next_power_of_two().clamp(2, LARGEST_PATCH);
    // Most vertices of such a patch over a long and narrow terrain would lie beyond its border.
    let narrow = 2 * (columns.min(rows) - 1).next_power_of_two().max(2);
    let largest = whole.min(narrow).ilog2();
    (1..=largest).rev().find_map(|log| PatchLayout::new(columns, rows, 1 << log))
}
