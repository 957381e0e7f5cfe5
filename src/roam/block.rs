//! One patch on its own: what refinement needs to know of its vertices, and where it comes from.

use std::sync::Arc;

use glam::Vec3;

use crate::roam::graph::Vertex;
use crate::roam::layout::PatchLayout;
use crate::roam::patched_ground::PatchedGround;
use crate::roam::spheres::SphereMap;

/// The vertices of one patch, (patch + 1)² of them, row by row from the south-west; those on a border are the same
/// in both patches that share it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PatchBlock {
    /// World X of each column and Y of each row, meters.
    pub plan: [Vec<f32>; 2],
    /// Drawn Z, meters; NaN without data.
    pub z: Vec<f32>,
    /// Radius of the nested sphere, meters.
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
    /// Its radius, meters.
    pub radius: f32,
}

/// Where patches come from: the memory, or a file larger than it.
pub trait BlockSource {
    /// The patches.
    fn layout(&self) -> &PatchLayout;

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
    pub ground: PatchedGround<'a>,
    /// The spheres of its vertices.
    pub spheres: &'a SphereMap,
}

impl BlockSource for WholeGround<'_> {
    fn layout(&self) -> &PatchLayout {
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
    pub fn cut(ground: PatchedGround<'_>, spheres: &SphereMap, corner: Vertex) -> Self {
        let side = ground.layout.patch() + 1;
        let plan = [
            (0..side).map(|x| ground.plan(corner.moved(x, 0)).x).collect(),
            (0..side).map(|y| ground.plan(corner.moved(0, y)).y).collect(),
        ];
        let mut block = Self {
            plan,
            z: Vec::with_capacity((side * side) as usize),
            radii: Vec::with_capacity((side * side) as usize),
        };
        for y in 0..side {
            block.append_row(ground, spheres, corner.moved(0, y));
        }
        block
    }

    /// Appends the vertices from `first` to the end of the row in its patch.
    fn append_row(&mut self, ground: PatchedGround<'_>, spheres: &SphereMap, first: Vertex) {
        let side = ground.layout.patch() as usize + 1;
        let start = ground.layout.index(first);
        self.radii.extend_from_slice(&spheres.values()[start..start + side]);
        let (from, to) = (first, first.moved(side as i32 - 1, 0));
        let (from, to) = (ground.layout.post(from), ground.layout.post(to));
        let row = &ground.lattice.heights()[ground.lattice.index(from)..=ground.lattice.index(to)];
        self.z.extend_from_slice(row);
        // Vertices beyond the east border stand for the last post.
        let last = self.z[self.z.len() - 1];
        self.z.extend(std::iter::repeat_n(last, side - row.len()));
    }
}
