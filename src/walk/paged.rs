//! A walk over bare terrain that is larger than memory.
//!
//! Patches whose spheres the eye is inside are read and refined as in any walk, the nearest first and no more in an update
//! than its options say: until it is read, a patch is shown as if it were far. The others are two triangles each, in blocks of
//! 64 × 64 that are handed over as if they were patches (see `far_block`), numbered past all patches.

use std::sync::Arc;

use glam::DVec2;

use crate::far_block::{FarBlock, backdrop, far_blocks};
use crate::frame::{WalkError, WalkFrame, WalkStatistics};
use crate::shown::ShownPatches;
use sandtable_draw::patches::{GroundChanges, PatchId, PatchTriangles, PatchVertices};
use sandtable_raster::windows::Windows;
use sandtable_roam::block::{BlockSource, PatchBlock};
use sandtable_roam::graph::Vertex;
use sandtable_roam::paging::ground::{PagedGround, PagingCounts, PagingError, PagingOptions, exact_spheres};
use sandtable_roam::patched_ground::PatchedGround;
use sandtable_roam::refine::deferred::Deferred;
use sandtable_roam::refine::deferred::surface::DeferredSurface;
use sandtable_roam::spheres::SphereMap;
use sandtable_terrain::triangle_surface::TriangleSurface;
use sandtable_view::camera::Camera;
use sandtable_view::frustum::Frustum;

/// The parameters of a walk over terrain on disk.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PagedWalkOptions {
    /// Meters of distance per meter of error, see [`reach`](sandtable_roam::spheres::reach): it stays as it is, since other
    /// spheres would mean to read all of the terrain again.
    pub reach: f32,
    /// Patches of at most 128 cells a side, and how many of them are kept.
    pub paging: PagingOptions,
    /// How many patches the renderer keeps, those in view included.
    pub kept_patches: usize,
    /// The most patches that are refined at a time: the nearest ones that need it.
    pub most_near: usize,
    /// The most patches that are read in an update; those left wait for the updates that follow.
    pub most_loads: usize,
}

/// Measures the spheres of a piece of the terrain.
type SphereMeasure = Box<dyn Fn(PatchedGround<'_>) -> SphereMap + Send + Sync>;

/// A walk over terrain on disk.
pub struct PagedWalk<W> {
    mesh: Deferred<PagedGround<W, SphereMeasure>>,
    shown: ShownPatches,
    blocks: Vec<FarBlock>,
    cell: DVec2,
    options: PagedWalkOptions,
    is_backdrop_held: bool,
}

/// The patches to refine in an update.
#[derive(Default)]
struct NearPatches {
    /// Those in view, row by row.
    visible: Vec<Vertex>,
    /// Those of each block; `None` of blocks out of view.
    of_blocks: Vec<Option<Vec<Vertex>>>,
    /// How many wait to be read.
    waiting: usize,
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
        Ok(Self { mesh, shown, blocks, cell, options: *options, is_backdrop_held: false })
    }

    /// Brings the ground up to date with a camera in perspective and returns what changed since the update before.
    ///
    /// # Errors
    /// A patch cannot be read; the update can be repeated.
    pub fn update(&mut self, camera: &Camera) -> Result<WalkFrame, WalkError> {
        let NearPatches { visible, of_blocks, waiting } = self.near_patches(camera);
        self.mesh.update(camera.eye(), &visible)?;
        let mut statistics = WalkStatistics {
            splits: self.mesh.changes().splits,
            merges: self.mesh.changes().merges,
            waiting_patches: waiting,
            ..WalkStatistics::default()
        };
        let mesh = &self.mesh;
        let mut changes = self
            .shown
            .update(mesh, |corner| mesh.block(corner).map_or_else(Vec::new, |block| block_positions(block)));
        let far = self.update_blocks(of_blocks, &mut changes);
        self.hand_over_backdrop(&mut changes);
        let kept = self.options.paging.capacity.max(visible.len());
        if self.mesh.meshes() > kept + kept / 4 {
            self.mesh.forget(kept);
        }
        statistics.examined = self.mesh.examined();
        statistics.count(&self.mesh, &changes);
        statistics.triangles += far;
        Ok(WalkFrame { changes, statistics })
    }

    /// The patches in view that are refined for a camera.
    fn near_patches(&self, camera: &Camera) -> NearPatches {
        let (frustum, eye, ground) = (Frustum::new(camera), camera.eye(), self.mesh.source());
        let may_see = |(min, max)| frustum.may_see(min, max);
        let mut near = NearPatches::default();
        let mut found: Vec<(f32, usize, Vertex)> = Vec::new();
        for (number, block) in self.blocks.iter().enumerate() {
            let is_seen = block.bounds.is_some_and(may_see);
            near.of_blocks.push(is_seen.then(Vec::new));
            if is_seen {
                let corners = block.near(ground, eye).into_iter();
                let corners = corners.filter(|&corner| ground.bounds(corner).is_some_and(may_see));
                found
                    .extend(corners.map(|corner| (ground.root(corner).center.distance(eye), number, corner)));
            }
        }
        let index = |corner: Vertex| ground.layout().patch_index(corner);
        found.sort_by(|a, b| a.0.total_cmp(&b.0).then(index(a.2).cmp(&index(b.2))));
        found.truncate(self.options.most_near);
        let mut loads = self.options.most_loads;
        found.retain(|&(_, _, corner)| {
            let is_here = self.mesh.block(corner).is_some() || ground.is_kept(corner);
            let is_taken = is_here || loads > 0;
            loads -= usize::from(is_taken && !is_here);
            near.waiting += usize::from(!is_taken);
            is_taken
        });
        found.sort_by_key(|&(_, _, corner)| index(corner));
        for &(_, number, corner) in &found {
            near.of_blocks[number].iter_mut().for_each(|corners| corners.push(corner));
        }
        near.visible = found.into_iter().map(|(_, _, corner)| corner).collect();
        near
    }

    /// World Z of the displayed ground at a world position; `None` without data.
    pub fn ground_z(&self, at: DVec2) -> Option<f64>
    where
        W: Send + Sync,
    {
        DeferredSurface::everywhere(&self.mesh, self.cell).displayed_z(at)
    }

    /// The vertices of a patch that is refined; `None` of others, and of blocks.
    pub fn page(&self, patch: PatchId) -> Option<(Vertex, &Arc<PatchBlock>)> {
        let layout = self.mesh.source().layout();
        let (east, _) = layout.patch_grid();
        let (x, y) = (patch.0 as usize % east, patch.0 as usize / east);
        let corner = Vertex::new(x as i32 * layout.patch(), y as i32 * layout.patch());
        let is_patch = (patch.0 as usize) < layout.patch_count();
        is_patch.then(|| self.mesh.block(corner)).flatten().map(|block| (corner, block))
    }

    /// Hands everything over again in the next update: for a renderer that starts anew.
    pub fn forget_handed(&mut self) {
        self.shown.forget();
        self.blocks.iter_mut().for_each(|block| (block.near, block.is_held) = (None, false));
        self.is_backdrop_held = false;
    }

    /// The number of patches that are kept refined, in view or not.
    pub fn meshes(&self) -> usize {
        self.mesh.meshes()
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

    /// Hands over the backdrop, once.
    fn hand_over_backdrop(&mut self, changes: &mut GroundChanges) {
        if !std::mem::replace(&mut self.is_backdrop_held, true) {
            let patch = self.backdrop_patch();
            let (positions, triangles) = backdrop(self.mesh.source());
            changes.vertices.push(PatchVertices { patch, positions });
            changes.triangles.push(PatchTriangles { patch, triangles: Arc::new(triangles) });
        }
    }

    /// The backdrop's number: past those of all blocks.
    fn backdrop_patch(&self) -> PatchId {
        PatchId((self.mesh.source().layout().patch_count() + self.blocks.len()) as u32)
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

/// The vertices of a patch, row by row from the south-west; without data at height 0.
fn block_positions(block: &PatchBlock) -> Vec<[f32; 3]> {
    let [east, north] = &block.plan;
    let places = north.iter().flat_map(|&y| east.iter().map(move |&x| (x, y)));
    places.zip(&block.z).map(|((x, y), &z)| [x, y, if z.is_nan() { 0.0 } else { z }]).collect()
}

#[cfg(test)]
mod tests {
    use std::collections::{BTreeMap, BTreeSet};

    use glam::Vec3;

    use super::*;
    use sandtable_raster::raster::{Raster, Samples, north_up_nodes};
    use sandtable_roam::shown::LocalTriangle;

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
        PagedWalkOptions {
            reach: 12.0,
            paging: PagingOptions { patch: 8, capacity },
            kept_patches: 60,
            most_near: usize::MAX,
            most_loads: usize::MAX,
        }
    }

    /// What a renderer has of a walk.
    #[derive(Default)]
    struct Handed {
        vertices: BTreeMap<PatchId, Vec<[f32; 3]>>,
        lists: BTreeMap<PatchId, Arc<Vec<LocalTriangle>>>,
    }

    impl Handed {
        fn take(&mut self, changes: GroundChanges) {
            for patch in changes.vertices {
                assert_eq!(patch.positions.len(), 81);
                self.vertices.insert(patch.patch, patch.positions);
            }
            changes.hidden.iter().for_each(|patch| assert!(self.lists.remove(patch).is_some(), "{patch:?}"));
            for patch in changes.triangles {
                self.lists.insert(patch.patch, patch.triangles);
            }
        }

        /// Square meters in plan of all patches but the backdrop.
        fn area_m2(&self, backdrop: PatchId) -> f64 {
            let doubled = |patch: &PatchId, corners: &LocalTriangle| {
                let [a, b, c] =
                    corners.map(|at| Vec3::from(self.vertices[patch][usize::from(at)]).truncate().as_dvec2());
                let doubled = (b - a).perp_dot(c - a);
                assert!(doubled > 0.0, "{patch:?} {corners:?}");
                doubled
            };
            let lists = self.lists.iter().filter(|(patch, _)| **patch != backdrop);
            lists
                .flat_map(|(patch, list)| list.iter().map(move |corners| doubled(patch, corners) / 2.0))
                .sum()
        }
    }

    /// Sees all of the terrain, from another place in each frame.
    fn camera(frame: u8) -> Camera {
        let along = f32::from(frame);
        let eye = Vec3::new(100.0 + 80.0 * along, -900.0 + 60.0 * along, 900.0);
        Camera::new(eye, Vec3::new(580.0, 580.0, 0.0), 2.0, (800, 800), (1.0, 1e5)).expect("sound")
    }

    /// The terrain but for the lake, square meters.
    fn covered_m2() -> std::ops::Range<f64> {
        let (whole, hole) = (1160.0f64 * 1160.0, 100.0 * 180.0);
        whole - hole..whole - 0.4 * hole
    }

    #[test]
    fn blocks_and_near_patches_cover_the_ground_once_and_memory_stays_bounded() {
        let mut walk = PagedWalk::open(raster(), &options(20)).expect("sound");
        let (mut handed, mut areas) = (Handed::default(), BTreeSet::new());
        for frame in 0..12 {
            let frame = walk.update(&camera(frame)).expect("in memory");
            walk.check();
            handed.take(frame.changes);
            let area = handed.area_m2(walk.backdrop_patch());
            assert!(covered_m2().contains(&area), "{area} m²");
            areas.insert(area as u64);
            assert!(walk.counts().peak <= 20);
        }
        let far = walk.mesh.source().layout().patch_count() as u32;
        let is_shown = |is_near: bool| handed.lists.keys().any(|patch| (patch.0 < far) == is_near);
        assert!(is_shown(true) && is_shown(false));
        let z = walk.ground_z(DVec2::new(600.0, 300.0)).expect("ground");
        assert!(z.abs() < 90.0 && walk.ground_z(DVec2::new(400.0, 460.0)).is_none());
    }

    #[test]
    fn patches_that_wait_to_be_read_are_shown_as_if_they_were_far() {
        let slow = PagedWalkOptions { reach: 150.0, most_loads: 3, most_near: 40, ..options(20) };
        let mut walk = PagedWalk::open(raster(), &slow).expect("sound");
        let (mut handed, mut waited) = (Handed::default(), 0);
        for update in 0.. {
            let before = walk.counts().loads;
            let frame = walk.update(&camera(3)).expect("in memory");
            handed.take(frame.changes);
            assert!(walk.counts().loads - before <= 3);
            let area = handed.area_m2(walk.backdrop_patch());
            assert!(covered_m2().contains(&area), "{area} m² in update {update}");
            if frame.statistics.waiting_patches == 0 {
                break;
            }
            waited += 1;
            assert!(update < 100, "{} wait for ever", frame.statistics.waiting_patches);
        }
        assert!(waited > 5 && walk.mesh.visible().len() == 40, "{waited} updates");
        assert!(walk.update(&camera(3)).expect("in memory").changes == GroundChanges::default());
        walk.forget_handed();
        let again = walk.update(&camera(3)).expect("in memory").changes;
        let mut anew = Handed::default();
        anew.take(again);
        assert_eq!(anew.lists.keys().collect::<Vec<_>>(), handed.lists.keys().collect::<Vec<_>>());
    }

    #[test]
    fn the_backdrop_lies_below_all_ground() {
        let (mut walk, ground) = (PagedWalk::open(raster(), &options(20)).expect("sound"), raster());
        let mut handed = Handed::default();
        handed.take(walk.update(&camera(0)).expect("in memory").changes);
        let patch = walk.backdrop_patch();
        let (vertices, mut seen) = (&handed.vertices[&patch], 0);
        for corners in handed.lists[&patch].iter() {
            let corners = corners.map(|at| Vec3::from(vertices[usize::from(at)]));
            let low = corners.iter().map(|at| at.z).fold(f32::INFINITY, f32::min);
            let middle = corners.iter().sum::<Vec3>() / 3.0;
            for at in corners.into_iter().chain([middle]) {
                let (column, row) = ((at.x / 10.0).round() as u32, 116 - (at.y / 10.0).round() as u32);
                let own = ground.at(column, row) as f32;
                assert!(own.is_nan() || own > at.z.max(low), "{at} under {own}");
                seen += 1;
            }
        }
        assert!(seen > 300, "{seen} places");
    }
}
