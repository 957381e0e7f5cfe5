//! One patch on its own: the vertices that refinement reads, and their sources.

use std::sync::Arc;

use glam::Vec3;

use crate::graph::Vertex;
use crate::layout::PatchLayout;
use crate::patched_ground::PatchedGround;
use crate::spheres::SphereMap;
use sandtable_raster::error::DemErrorKind;
use sandtable_terrain::lattice::LatticeError;

/// The (patch + 1)² vertices of one patch, row by row from the south-west; those on a border are the same in both patches
/// that share it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PatchBlock {
    /// World X of each column and Y of each row, meters.
    pub plan: [Vec<f32>; 2],
    /// Displayed Z, meters; NaN without data.
    pub z: Vec<f32>,
    /// Radius of the nested sphere, meters.
    pub radii: Vec<f32>,
}

/// A patch that cannot be read.
#[derive(Debug, thiserror::Error)]
#[error("the patch at column {column}, row {row} of the elevation model cannot be read: {source}")]
pub struct BlockError {
    /// The column of its south-west post, counted eastward.
    pub column: u32,
    /// The row of its south-west post, counted northward.
    pub row: u32,
    /// The cause.
    pub source: BlockFault,
}

/// Why a patch cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum BlockFault {
    /// The samples cannot be read.
    #[error(transparent)]
    Read(#[from] DemErrorKind),
    /// The samples are no lattice.
    #[error(transparent)]
    Lattice(#[from] LatticeError),
    /// The patch with its surroundings has more vertices than a layout may have.
    #[error("{columns} x {rows} posts are too many at once")]
    TooMany {
        /// Posts per row.
        columns: u32,
        /// Rows.
        rows: u32,
    },
}

/// The sphere in the middle of a patch: no vertex of the patch is active while the eye is outside it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RootSphere {
    /// The patch's middle, world space.
    pub center: Vec3,
    /// Its radius, meters.
    pub radius: f32,
}

/// A source of patches: memory, or a file larger than it.
pub trait BlockSource {
    /// The patches.
    fn layout(&self) -> &PatchLayout;

    /// The sphere in the middle of the patch with south-west corner `corner`, without reading the patch.
    fn root(&self, corner: Vertex) -> RootSphere;

    /// World positions of the corners of the patch with south-west corner `corner`, without reading the patch: south-west,
    /// south-east, north-west, north-east; Z NaN without data.
    fn corners(&self, corner: Vertex) -> [Vec3; 4];

    /// The patch with south-west corner `corner`.
    ///
    /// # Errors
    /// See [`BlockError`].
    fn block(&mut self, corner: Vertex) -> Result<Arc<PatchBlock>, BlockError>;
}

/// Patches of a ground in memory.
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

    fn corners(&self, corner: Vertex) -> [Vec3; 4] {
        let (ground, side) = (self.ground, self.ground.layout.patch());
        [(0, 0), (side, 0), (0, side), (side, side)].map(|(x, y)| {
            let vertex = corner.moved(x, y);
            ground.plan(vertex).extend(ground.lattice.height(ground.layout.post(vertex)))
        })
    }

    fn block(&mut self, corner: Vertex) -> Result<Arc<PatchBlock>, BlockError> {
        Ok(Arc::new(PatchBlock::new(self.ground, self.spheres, corner)))
    }
}

impl PatchBlock {
    /// The patch with south-west corner `corner` of a ground in memory.
    pub fn new(ground: PatchedGround<'_>, spheres: &SphereMap, corner: Vertex) -> Self {
        let side = ground.layout.patch() + 1;
        let columns = (0..side).map(|x| ground.plan(corner.moved(x, 0)).x).collect();
        let rows = (0..side).map(|y| ground.plan(corner.moved(0, y)).y).collect();
        let [mut z, mut radii] = [0; 2].map(|_| Vec::with_capacity((side * side) as usize));
        for first in (0..side).map(|y| corner.moved(0, y)) {
            let start = ground.layout.index(first);
            radii.extend_from_slice(&spheres.values()[start..start + side as usize]);
            let [from, to] = [first, first.moved(side - 1, 0)]
                .map(|vertex| ground.lattice.index(ground.layout.post(vertex)));
            let row = &ground.lattice.heights()[from..=to];
            z.extend_from_slice(row);
            // Vertices beyond the east border have the last post's height.
            z.extend(std::iter::repeat_n(row[row.len() - 1], side as usize - row.len()));
        }
        Self { plan: [columns, rows], z, radii }
    }
}
