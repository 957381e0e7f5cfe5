//! The source of patches: a raster read in windows, and a bounded cache of patches.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::{DVec2, Vec2, Vec3};

use crate::block::{BlockError, BlockSource, PatchBlock, RootSphere};
use crate::errors::ErrorMap;
use crate::graph::Vertex;
use crate::layout::{DEFAULT_PATCH, MOST_PATCHES, PatchLayout};
use crate::paging::region::{PagedFrame, PagedRegion, Patches};
use crate::paging::summary::{self, PatchSummary};
use crate::patched_ground::PatchedGround;
use crate::spheres::SphereMap;
use sandtable_raster::cache::LruCache;
use sandtable_raster::error::DemError;
use sandtable_raster::warp;
use sandtable_raster::warp::error::WarpError;
use sandtable_raster::windows::{Windows, WithOverviews};
use sandtable_terrain::lattice::{Lattice, LatticeError};

/// The parameters of paging.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PagingOptions {
    /// Cells along a patch's side: a power of two from 2 to 1024. Default [`DEFAULT_PATCH`].
    pub patch: u32,
    /// The most patches that are kept; at least 1. A walk reads hardly anything twice where all patches fit whose spheres
    /// the eye is inside. Default 256, 8 MiB in patches of 64.
    pub capacity: usize,
}

impl Default for PagingOptions {
    fn default() -> Self {
        Self { patch: DEFAULT_PATCH, capacity: 256 }
    }
}

/// The largest patch; the surroundings of a larger one would be too many posts to measure for each.
const LARGEST_PATCH: u32 = 1024;

/// Why terrain cannot be paged.
#[derive(Debug, thiserror::Error)]
pub enum PagingError {
    /// The raster would have to be resampled, which is not done in pieces.
    #[error(
        "{0}; terrain that is read in pieces is not resampled: warp the file first, for example with gdalwarp"
    )]
    NotMetric(#[source] WarpError),
    /// The raster is no lattice.
    #[error(transparent)]
    Lattice(#[from] LatticeError),
    /// Too many patches, or sizes that make none.
    #[error(
        "{columns} x {rows} posts make too many patches of {patch} cells a side, or none: at most {MOST_PATCHES} are taken, of 2 to {LARGEST_PATCH} cells, a power of two; choose larger ones, or add overviews to the file, for example with: gdaladdo FILE 2 4 8"
    )]
    Patches {
        /// Posts per row.
        columns: u32,
        /// Rows.
        rows: u32,
        /// Cells along a patch's side.
        patch: u32,
    },
    /// A part of the terrain cannot be read.
    #[error(transparent)]
    Block(#[from] BlockError),
    /// An overview cannot be opened.
    #[error(transparent)]
    Dem(#[from] DemError),
}

/// The work of a source of patches.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PagingCounts {
    /// Patches that were read and measured.
    pub loads: u64,
    /// Requests for patches that were kept.
    pub hits: u64,
    /// Patches that were dropped for others.
    pub evictions: u64,
    /// The most patches that were kept at any time.
    pub peak: usize,
}

/// Terrain of which only some patches are in memory.
///
/// `S` measures a ground: from a piece of the terrain, whose positions are those of the whole, to its nested spheres. Its
/// result for a vertex may depend on the ground under the triangles that the vertex and its descendants split alone, and not
/// on where the piece begins; then every patch is bit for bit that of the whole terrain in memory.
///
/// Memory: the cache, one region of 3 × 3 to 4 × 3 patches while a patch is read, 32 bytes a patch of the terrain, and the
/// buffers of the windows. Patches that were handed out live as long as they are held.
pub struct PagedGround<W, S> {
    windows: W,
    spheres: S,
    frame: PagedFrame,
    summaries: Vec<PatchSummary>,
    cache: LruCache<usize, Arc<PatchBlock>>,
    capacity: usize,
    counts: PagingCounts,
}

/// Measures plain nested spheres: the own radius is the exact error times `reach` meters of distance a meter of error.
pub fn exact_spheres(reach: f32) -> impl Fn(PatchedGround<'_>) -> SphereMap {
    move |ground| {
        let errors = ErrorMap::exact(ground.lattice, ground.layout);
        let own = errors.values().iter().map(|error| error * reach).collect();
        SphereMap::nested(ground, own)
    }
}

/// The finest image of `file` whose patches of `patch` cells a side are few enough: the file's own, or the first of its
/// overviews in the order of the file that fits.
///
/// # Errors
/// None fits, or the one that does cannot be opened.
pub fn finest_that_fits<W: WithOverviews>(file: W, patch: u32) -> Result<W, PagingError> {
    let (columns, rows) = file.size();
    let fits = |columns, rows| PatchLayout::paged(columns, rows, patch).is_some();
    if fits(columns, rows) {
        return Ok(file);
    }
    match file.overview_sizes().into_iter().position(|(columns, rows)| fits(columns, rows)) {
        Some(overview) => Ok(file.at_overview_size(overview)?),
        None => Err(PagingError::Patches { columns, rows, patch }),
    }
}

impl<W: Windows, S: Fn(PatchedGround<'_>) -> SphereMap> PagedGround<W, S> {
    /// Reads the whole terrain once, piece by piece, for the summaries of its patches.
    ///
    /// # Errors
    /// [`PagingError`]: the raster is not north-up or not in meters, has too many patches or no data at all, or a piece of it
    /// cannot be read.
    pub fn open(mut windows: W, spheres: S, options: &PagingOptions) -> Result<Self, PagingError> {
        warp::check_metric(windows.metadata()).map_err(PagingError::NotMetric)?;
        let (origin, cell) = Lattice::frame(windows.metadata())?;
        let ((columns, rows), patch) = (windows.size(), options.patch);
        let layout = PatchLayout::paged(columns, rows, patch).filter(|_| patch <= LARGEST_PATCH);
        let layout = layout.ok_or(PagingError::Patches { columns, rows, patch })?;
        let frame = PagedFrame { layout, origin, cell };
        let summaries = summary::summaries(&mut windows, &frame, &spheres)?;
        if summaries.iter().all(|summary| summary.low > summary.high) {
            return Err(LatticeError::Empty.into());
        }
        let capacity = options.capacity.max(1);
        let (cache, counts) = (LruCache::new(capacity), PagingCounts::default());
        Ok(Self { windows, spheres, frame, summaries, cache, capacity, counts })
    }

    /// The summary of the patch with south-west corner `corner`.
    pub fn summary(&self, corner: Vertex) -> &PatchSummary {
        &self.summaries[self.frame.layout.patch_index(corner)]
    }

    /// The box of the patch with south-west corner `corner` in world space; `None` without data.
    pub fn bounds(&self, corner: Vertex) -> Option<(Vec3, Vec3)> {
        let (summary, side) = (self.summary(corner), self.frame.layout.patch());
        let far = self.plan(corner.moved(side, side));
        (summary.low <= summary.high)
            .then(|| (self.plan(corner).extend(summary.low), far.extend(summary.high)))
    }

    /// Whether the eye is outside all spheres of the patch with south-west corner `corner`: it is then drawn as its two root
    /// triangles, without being read.
    pub fn is_far(&self, corner: Vertex, eye: Vec3) -> bool {
        let half = self.frame.layout.patch() / 2;
        self.summary(corner).is_far(self.plan(corner.moved(half, half)), eye)
    }

    /// World X and Y of a vertex, meters.
    pub fn plan(&self, vertex: Vertex) -> Vec2 {
        (self.frame.layout.post(vertex).grid() * self.frame.cell).as_vec2()
    }

    /// Map coordinates of the south-west post: the origin of world space.
    pub fn origin(&self) -> DVec2 {
        self.frame.origin
    }

    /// The raster that is read.
    pub fn windows(&self) -> &W {
        &self.windows
    }

    /// The work so far.
    pub fn counts(&self) -> PagingCounts {
        self.counts
    }

    /// The terrain without its heights.
    pub fn frame(&self) -> &PagedFrame {
        &self.frame
    }

    /// Whether the patch with south-west corner `corner` is kept now, so that it need not be read.
    pub fn is_kept(&self, corner: Vertex) -> bool {
        self.cache.contains(self.frame.layout.patch_index(corner))
    }

    /// The number of patches that are kept now.
    pub fn kept(&self) -> usize {
        self.cache.weight()
    }

    /// Checks that the cache is in order and within its capacity, that the counts add up, and that kept patches agree about
    /// the borders they share and with their summaries.
    ///
    /// # Panics
    /// Where they do not.
    pub fn check(&self) {
        self.cache.check();
        let PagingCounts { loads, evictions, peak, .. } = self.counts;
        let kept = self.cache.weight();
        let is_sound = kept <= peak && peak <= self.capacity && loads - evictions == kept as u64;
        assert!(is_sound, "{kept} kept, at most {peak} of {}: {:?}", self.capacity, self.counts);
        let blocks: BTreeMap<usize, &Arc<PatchBlock>> = self.cache.iter().collect();
        for corner in self.frame.layout.patches() {
            if let Some(block) = blocks.get(&self.frame.layout.patch_index(corner)) {
                self.check_block(corner, block, &blocks);
            }
        }
    }

    fn check_block(&self, corner: Vertex, block: &PatchBlock, blocks: &BTreeMap<usize, &Arc<PatchBlock>>) {
        let (layout, side) = (&self.frame.layout, self.frame.layout.patch());
        let at = |x: i32, y: i32| (y * (side + 1) + x) as usize;
        let radius = block.radii[at(side / 2, side / 2)];
        assert_eq!(radius, self.summary(corner).radius, "the largest sphere of the patch at {corner:?}");
        for (east, north) in [(1, 0), (0, 1)] {
            let other = corner.moved(east * side, north * side);
            let other = Some(other).filter(|&other| layout.contains(other.moved(side, side)));
            let Some(other) = other.and_then(|other| blocks.get(&layout.patch_index(other))) else {
                continue;
            };
            for along in 0..=side {
                let own = at(east * side + north * along, north * side + east * along);
                let others = at(north * along, east * along);
                // Patch corners split nothing: their radii mean nothing.
                let radius = |radius: f32| if along % side == 0 { 0 } else { radius.to_bits() };
                assert_eq!(
                    (block.z[own].to_bits(), radius(block.radii[own])),
                    (other.z[others].to_bits(), radius(other.radii[others])),
                    "the patch at {corner:?} and its neighbor at {along}"
                );
            }
        }
    }

    /// Reads and measures a patch.
    fn load(&mut self, corner: Vertex) -> Result<PatchBlock, BlockError> {
        let patches = Patches::one(&self.frame.layout, corner);
        let region = PagedRegion::read(&mut self.windows, &self.frame, patches);
        let region =
            region.map_err(|source| BlockError { column: corner.x as u32, row: corner.y as u32, source })?;
        let spheres = (self.spheres)(region.ground());
        Ok(PatchBlock::new(region.ground(), &spheres, region.own(corner)))
    }
}

impl<W: Windows, S: Fn(PatchedGround<'_>) -> SphereMap> BlockSource for PagedGround<W, S> {
    fn layout(&self) -> &PatchLayout {
        &self.frame.layout
    }

    fn root(&self, corner: Vertex) -> RootSphere {
        let half = self.frame.layout.patch() / 2;
        let summary = self.summary(corner);
        let center = self.plan(corner.moved(half, half)).extend(summary.middle);
        RootSphere { center, radius: summary.radius }
    }

    fn corners(&self, corner: Vertex) -> [Vec3; 4] {
        let (side, z) = (self.frame.layout.patch(), self.summary(corner).corners);
        let at = |(x, y), z: f32| self.plan(corner.moved(x, y)).extend(z);
        [at((0, 0), z[0]), at((side, 0), z[1]), at((0, side), z[2]), at((side, side), z[3])]
    }

    /// A patch that cannot be read is an error now and is read again at the next request; kept patches stay.
    fn block(&mut self, corner: Vertex) -> Result<Arc<PatchBlock>, BlockError> {
        let index = self.frame.layout.patch_index(corner);
        if let Some(block) = self.cache.get(index) {
            self.counts.hits += 1;
            return Ok(Arc::clone(block));
        }
        let block = Arc::new(self.load(corner)?);
        self.counts.loads += 1;
        self.counts.evictions += self.cache.put(index, Arc::clone(&block), 1) as u64;
        self.counts.peak = self.counts.peak.max(self.cache.weight());
        Ok(block)
    }
}
