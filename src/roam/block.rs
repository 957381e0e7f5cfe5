//! One patch on its own: what refinement needs to know of its vertices, and where it comes from.

use std::sync::Arc;

use glam::{Vec2, Vec3};

use crate::roam::graph::Vertex;
use crate::roam::ground::Ground;
use crate::roam::layout::Layout;
use crate::roam::spheres::SphereMap;

/// The vertices of one patch, (patch + 1)² of them, row by row from the south-west; those on a border are the same
/// in both patches that share it.
#[derive(Clone, Debug, PartialEq)]
pub struct PatchBlock {
    /// World X of each column and Y of each row, metres.
    pub plan: [Vec<f32>; 2],
    /// Drawn Z, metres; NaN without data.
    pub z: Vec<f32>,
    /// Radius of the nested sphere, metres.
    pub radii: Vec<f32>,
}

/// Why a patch cannot be had.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("the patch at column {column}, row {row} of the elevation model cannot be read: {reason}")]
pub struct BlockError {
    /// Its south-west post, counted eastward.
    pub column: u32,
    /// Counted northward.
    pub row: u32,
    /// What went wrong.
    pub reason: String,
}

/// The sphere in the middle of a patch: nothing in the patch is active while the eye is outside it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RootSphere {
    /// The patch's middle, drawn world space.
    pub center: Vec3,
    /// Its radius, metres.
    pub radius: f32,
}

/// Where patches come from: the memory, or a file larger than it.
pub trait BlockSource {
    /// The patches.
    fn layout(&self) -> &Layout;

    /// The sphere in the middle of the patch with south-west corner `corner`, known without reading the patch.
    fn root(&self, corner: Vertex) -> RootSphere;

    /// The patch with south-west corner `corner`.
    ///
    /// # Errors
    /// See [`BlockError`].
    fn block(&mut self, corner: Vertex) -> Result<Arc<PatchBlock>, BlockError>;
}

/// Patches of a ground that is in memory.
#[derive(Clone, Copy, Debug)]
pub struct WholeGround<'a> {
    /// The heights.
    pub ground: Ground<'a>,
    /// The spheres of its vertices.
    pub spheres: &'a SphereMap,
}

impl BlockSource for WholeGround<'_> {
    fn layout(&self) -> &Layout {
        self.ground.layout
    }

    fn root(&self, corner: Vertex) -> RootSphere {
        let half = self.ground.layout.patch() / 2;
        let middle = corner.moved(half, half);
        let radius = self.spheres.at(self.ground.layout, middle);
        RootSphere { center: self.ground.position(middle), radius }
    }

    fn block(&mut self, corner: Vertex) -> Result<Arc<PatchBlock>, BlockError> {
        Ok(Arc::new(PatchBlock::cut(self.ground, self.spheres, corner)))
    }
}

impl PatchBlock {
    /// The patch with south-west corner `corner` of a ground in memory.
    pub fn cut(ground: Ground<'_>, spheres: &SphereMap, corner: Vertex) -> Self {
        let side = ground.layout.patch() + 1;
        let along = |step: fn(i32) -> Vertex, axis: fn(Vec2) -> f32| -> Vec<f32> {
            (0..side).map(|at| axis(ground.plan(corner.moved(step(at).x, step(at).y)))).collect()
        };
        let plan = [along(|at| Vertex::new(at, 0), |at| at.x), along(|at| Vertex::new(0, at), |at| at.y)];
        let vertices = || (0..side).flat_map(move |y| (0..side).map(move |x| corner.moved(x, y)));
        let z = |vertex| ground.lattice.height(ground.layout.post(vertex)) * ground.exaggeration;
        Self {
            plan,
            z: vertices().map(z).collect(),
            radii: vertices().map(|vertex| spheres.at(ground.layout, vertex)).collect(),
        }
    }
}
