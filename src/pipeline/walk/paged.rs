//! A walk over bare terrain that is larger than memory.
//!
//! Patches whose spheres the eye is inside are read and refined as in any walk. The others are two triangles each, and there
//! are many: 64 × 64 of them make one block, which is handed over as if it were a patch of their corners:
//!
//! ```text
//!  ┌──┬──┬──┬──┐   a block: one vertex a corner of its patches, two triangles a patch,
//!  │╱ │ ╲│╱ │ ╲│   none where a patch is near (N): that is handed over as itself
//!  ├──┼──┼──┼──┤
//!  │ ╲│N │N │╱ │   A block's number is past those of all patches; it has as many vertices
//!  └──┴──┴──┴──┘   as any patch.
//! ```

use std::sync::Arc;

use glam::{DVec2, Vec3};

use crate::dem::windows::Windows;
use crate::draw::patches::{GroundChanges, PatchId, PatchTriangles, PatchVertices};
use crate::pipeline::walk::frame::{WalkError, WalkFrame, WalkStatistics};
use crate::pipeline::walk::shown::ShownPatches;
use crate::roam::bintree::Triangle;
use crate::roam::block::{BlockSource, PatchBlock};
use crate::roam::graph::Vertex;
use crate::roam::paging::ground::{PagedGround, PagingCounts, PagingError, PagingOptions, exact_spheres};
use crate::roam::patched_ground::PatchedGround;
use crate::roam::refine::deferred::Deferred;
use crate::roam::refine::deferred::surface::DeferredSurface;
use crate::roam::shown::LocalTriangle;
use crate::roam::spheres::SphereMap;
use crate::terrain::triangle_surface::TriangleSurface;
use crate::view::camera::Camera;
use crate::view::frustum::Frustum;

/// The parameters of a walk over terrain on disk.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PagedWalkOptions {
    /// Meters of distance per meter of error, see [`reach`](crate::roam::spheres::reach): it stays as it is, since other
    /// spheres would mean to read all of the terrain again.
    pub reach: f32,
    /// Patches of at most 128 cells a side, and how many of them are kept.
    pub paging: PagingOptions,
    /// How many patches the renderer keeps, those in view included.
    pub kept_patches: usize,
}

/// Measures the spheres of a piece of the terrain.
type SphereMeasure = Box<dyn Fn(PatchedGround<'_>) -> SphereMap + Send + Sync>;

/// A walk over terrain on disk.
pub struct PagedWalk<W> {
    mesh: Deferred<PagedGround<W, SphereMeasure>>,
    shown: ShownPatches,
    blocks: Vec<FarBlock>,
    cell: DVec2,
    kept: usize,
}

/// Patches that are two triangles each.
#[derive(Clone, Debug)]
struct FarBlock {
    /// The south-west corners of its patches, row by row.
    patches: Vec<Vertex>,
    bounds: Option<(Vec3, Vec3)>,
    /// Those that were near when it was handed over last; `None` while it is not shown.
    near: Option<Vec<Vertex>>,
    is_held: bool,
}

impl<W: Windows> PagedWalk<W> {
    /// Reads the whole terrain once, piece by piece.
    ///
    /// # Errors
    /// See [`PagingError`].
    pub fn open(windows: W, options: &PagedWalkOptions) -> Result<Self, PagingError> {
        let spheres: SphereMeasure = Box::new(exact_spheres(options.reach));
        let ground = PagedGround::open(windows, spheres, &options.paging)?;
        let layout = *ground.layout();
        let (columns, rows) = ground.windows().size();
        let far = ground.plan(Vertex::new(i32::MAX, i32::MAX));
        let cell = far.as_dvec2() / DVec2::new(f64::from(columns - 1), f64::from(rows - 1));
        let blocks = far_blocks(&ground);
        let patch = options.paging.patch;
        let mesh = Deferred::new(ground, cell.min_element());
        let mesh = mesh.ok_or(PagingError::Patches { columns, rows, patch })?;
        let shown = ShownPatches::new(layout.patch_count(), options.kept_patches);
        Ok(Self { mesh, shown, blocks, cell, kept: options.paging.capacity })
    }

    /// Brings the ground up to date with a camera in perspective and returns what changed since the update before.
    ///
    /// # Errors
    /// A patch cannot be read; the update can be repeated.
    pub fn update(&mut self, camera: &Camera) -> Result<WalkFrame, WalkError> {
        let (frustum, eye) = (Frustum::new(camera), camera.eye());
        let ground = self.mesh.source();
        let (mut visible, mut nearby) = (Vec::new(), Vec::new());
        for block in &self.blocks {
            let is_seen = block.bounds.is_some_and(|(min, max)| frustum.may_see(min, max));
            let near = is_seen.then(|| block.near(ground, eye));
            let may_see = |corner: &&Vertex| {
                ground.bounds(**corner).is_some_and(|(min, max)| frustum.may_see(min, max))
            };
            visible.extend(near.iter().flatten().filter(may_see).copied());
            nearby.push(near);
        }
        self.mesh.update(eye, &visible)?;
        let mut statistics = WalkStatistics {
            splits: self.mesh.changes().splits,
            merges: self.mesh.changes().merges,
            ..WalkStatistics::default()
        };
        let mesh = &self.mesh;
        let mut changes = self
            .shown
            .update(mesh, |corner| mesh.block(corner).map_or_else(Vec::new, |block| block_positions(block)));
        let far = self.update_blocks(nearby, &mut changes);
        if self.mesh.meshes() > 2 * self.kept.max(visible.len()) {
            self.mesh.forget(self.kept.max(visible.len()));
        }
        statistics.examined = self.mesh.examined();
        statistics.count(&self.mesh, &changes);
        statistics.triangles += far;
        Ok(WalkFrame { changes, statistics })
    }

    /// World Z of the displayed ground at a world position; `None` without data.
    pub fn ground_z(&self, at: DVec2) -> Option<f64>
    where
        W: Send + Sync,
    {
        DeferredSurface::everywhere(&self.mesh, self.cell).displayed_z(at)
    }

    /// The work of reading so far.
    pub fn counts(&self) -> PagingCounts {
        self.mesh.source().counts()
    }

    /// The terrain.
    pub fn ground(&self) -> &PagedGround<W, impl Fn(PatchedGround<'_>) -> SphereMap + use<W>> {
        self.mesh.source()
    }

    /// Checks the mesh and the cache.
    ///
    /// # Panics
    /// Where they are not sound.
    pub fn check(&self) {
        self.mesh.check();
        self.mesh.source().check();
    }

    /// Hands over the blocks that came into view or hold other near patches; returns how many triangles all show.
    fn update_blocks(&mut self, nearby: Vec<Option<Vec<Vertex>>>, changes: &mut GroundChanges) -> usize {
        let (ground, mut shown) = (self.mesh.source(), 0);
        let first = ground.layout().patch_count() as u32;
        for ((number, block), near) in (first..).zip(&mut self.blocks).zip(nearby) {
            let patch = PatchId(number);
            let Some(near) = near else {
                changes.hidden.extend(block.near.take().map(|_| patch));
                continue;
            };
            shown += 2 * (block.patches.len() - near.len());
            if block.near.as_ref() == Some(&near) {
                continue;
            }
            if !std::mem::replace(&mut block.is_held, true) {
                changes.vertices.push(PatchVertices { patch, positions: block.positions(ground) });
            }
            let triangles = Arc::new(block.triangles(ground, &near));
            changes.triangles.push(PatchTriangles { patch, triangles });
            block.near = Some(near);
        }
        shown
    }
}

/// The blocks of all patches, row by row.
fn far_blocks<W: Windows>(ground: &PagedGround<W, SphereMeasure>) -> Vec<FarBlock> {
    let layout = ground.layout();
    let (side, (east, north)) = (layout.patch() as usize, layout.patch_grid());
    let firsts = (0..north).step_by(side).flat_map(|y| (0..east).step_by(side).map(move |x| (x, y)));
    let block = |(x, y): (usize, usize)| {
        let last = ((x + side - 1) as i32, (y + side - 1) as i32);
        let patches: Vec<Vertex> = layout.patches_within((x as i32, y as i32), last).collect();
        let boxes = patches.iter().filter_map(|&corner| ground.bounds(corner));
        let bounds = boxes.reduce(|(a, b), (c, d)| (a.min(c), b.max(d)));
        FarBlock { patches, bounds, near: None, is_held: false }
    };
    firsts.map(block).collect()
}

impl FarBlock {
    /// The patches that are refined for an eye.
    fn near<W: Windows>(&self, ground: &PagedGround<W, SphereMeasure>, eye: Vec3) -> Vec<Vertex> {
        let has_data = |corner: &Vertex| ground.summary(*corner).low <= ground.summary(*corner).high;
        let near = self.patches.iter().copied().filter(|&corner| !ground.is_far(corner, eye));
        near.filter(has_data).collect()
    }

    /// The vertices, as many as a patch has; those past the last patch are where its corners are.
    fn positions<W: Windows>(&self, ground: &PagedGround<W, SphereMeasure>) -> Vec<[f32; 3]> {
        let (layout, Vertex { x, y }) = (ground.layout(), self.patches[0]);
        let side = layout.patch();
        let mut positions = vec![[0.0; 3]; ((side + 1) * (side + 1)) as usize];
        for &corner in &self.patches {
            let [column, row] = [(corner.x - x) / side, (corner.y - y) / side];
            let corners = ground.corners(corner);
            for (at, [east, north]) in corners.into_iter().zip([[0, 0], [1, 0], [0, 1], [1, 1]]) {
                let z = if at.z.is_nan() { 0.0 } else { at.z };
                positions[((row + north) * (side + 1) + column + east) as usize] = [at.x, at.y, z];
            }
        }
        positions
    }

    /// Two triangles a patch that is not near, but for those without data at a corner.
    fn triangles<W: Windows>(
        &self,
        ground: &PagedGround<W, SphereMeasure>,
        near: &[Vertex],
    ) -> Vec<LocalTriangle> {
        let (side, origin, mut near) = (ground.layout().patch(), self.patches[0], near.iter().peekable());
        let mut triangles = Vec::with_capacity(2 * self.patches.len());
        for &corner in &self.patches {
            if near.next_if(|&&near| near == corner).is_some() {
                continue;
            }
            let z = ground.summary(corner).corners;
            let has_data =
                |at: &Vertex| !z[usize::from(at.x > corner.x) + 2 * usize::from(at.y > corner.y)].is_nan();
            let local =
                |at: Vertex| ((at.y - origin.y) / side * (side + 1) + (at.x - origin.x) / side) as u16;
            let roots = Triangle::roots(corner, side).map(|root| root.corners());
            triangles.extend(
                roots
                    .into_iter()
                    .filter(|corners| corners.iter().all(has_data))
                    .map(|corners| corners.map(local)),
            );
        }
        triangles
    }
}

/// The vertices of a patch, row by row from the south-west; without data at height 0.
fn block_positions(block: &PatchBlock) -> Vec<[f32; 3]> {
    let [east, north] = &block.plan;
    let places = north.iter().flat_map(|&y| east.iter().map(move |&x| (x, y)));
    places.zip(&block.z).map(|((x, y), &z)| [x, y, if z.is_nan() { 0.0 } else { z }]).collect()
}

#[cfg(test)]
mod tests {
    use std::collections::{BTreeMap, BTreeSet};

    use super::*;
    use crate::dem::raster::{Raster, Samples, north_up_nodes};

    /// Hills with a lake without data, 2 × 2 blocks of patches of 8 cells.
    fn raster() -> Raster {
        let side = 16 * 8 - 11;
        let height = |at: u32| {
            let (x, y) = (f64::from(at % side), f64::from(at / side));
            let is_hole = (x - 40.0).hypot(y - 70.0) < 6.0;
            let hills = 60.0 * libm::sin(x * 0.11) * libm::cos(y * 0.13) + 9.0 * libm::sin(x * y);
            if is_hole { f32::NAN } else { hills as f32 }
        };
        let samples = Samples::F32((0..side * side).map(height).collect());
        let north_west = DVec2::new(5e5, 4e6);
        Raster::new(side, samples).placed(north_up_nodes(north_west, DVec2::splat(10.0)))
    }

    fn options(capacity: usize) -> PagedWalkOptions {
        PagedWalkOptions { reach: 12.0, paging: PagingOptions { patch: 8, capacity }, kept_patches: 60 }
    }

    #[test]
    fn blocks_and_near_patches_cover_the_ground_once_and_memory_stays_bounded() {
        let mut walk = PagedWalk::open(raster(), &options(20)).expect("sound");
        let (mut vertices, mut lists) = (BTreeMap::new(), BTreeMap::new());
        let mut areas = BTreeSet::new();
        for frame in 0..12 {
            let eye = Vec3::new(100.0 + 80.0 * frame as f32, -900.0 + 60.0 * frame as f32, 900.0);
            let target = Vec3::new(580.0, 580.0, 0.0);
            // Wide enough to see all of it.
            let camera = Camera::new(eye, target, 2.0, (800, 800), (1.0, 1e5)).expect("sound");
            let frame = walk.update(&camera).expect("in memory");
            walk.check();
            for patch in frame.changes.vertices {
                assert_eq!(patch.positions.len(), 81);
                vertices.insert(patch.patch, patch.positions);
            }
            frame.changes.hidden.iter().for_each(|patch| assert!(lists.remove(patch).is_some(), "{patch:?}"));
            for patch in frame.changes.triangles {
                lists.insert(patch.patch, patch.triangles);
            }
            let doubled = |patch: &PatchId, corners: &LocalTriangle| {
                let [a, b, c] =
                    corners.map(|at| Vec3::from(vertices[patch][usize::from(at)]).truncate().as_dvec2());
                let doubled = (b - a).perp_dot(c - a);
                assert!(doubled > 0.0, "{patch:?} {corners:?}");
                doubled
            };
            let area: f64 = lists
                .iter()
                .flat_map(|(patch, list): (&PatchId, &Arc<Vec<LocalTriangle>>)| {
                    list.iter().map(move |corners| doubled(patch, corners) / 2.0)
                })
                .sum();
            let (whole, hole) = (1160.0f64 * 1160.0, 100.0 * 180.0);
            assert!((whole - hole..whole - 0.4 * hole).contains(&area), "{area} m² of {whole}");
            areas.insert(area as u64);
            assert!(walk.counts().peak <= 20);
        }
        let far = walk.mesh.source().layout().patch_count() as u32;
        assert!(lists.keys().any(|patch| patch.0 >= far) && lists.keys().any(|patch| patch.0 < far));
        let z = walk.ground_z(DVec2::new(600.0, 300.0)).expect("ground");
        assert!(z.abs() < 90.0 && walk.ground_z(DVec2::new(400.0, 460.0)).is_none());
    }
}
