//! The patches of terrain on disk that are in memory, for heights and rays that wait for no disk.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::DVec2;

use sandtable_draw::patches::PatchId;
use sandtable_raster::answer::Answer;
use sandtable_roam::block::PatchBlock;
use sandtable_roam::graph::Vertex;
use sandtable_roam::paging::region::PagedFrame;
use sandtable_terrain::lattice::{Lattice, LatticeError};
use sandtable_terrain::query::{Interpolation, ground_height};
use sandtable_terrain::sight::ground::SightGround;
use sandtable_terrain::sight::ray::{Ray, RayHit};

/// Patches with all their posts: heights between them are those of the whole terrain, to the last bit.
pub struct PageHeights {
    frame: PagedFrame,
    pages: BTreeMap<PatchId, SightGround>,
}

/// A patch for [`PageHeights`].
///
/// # Errors
/// See [`LatticeError`].
pub fn page(frame: &PagedFrame, corner: Vertex, block: &PatchBlock) -> Result<SightGround, LatticeError> {
    let side = frame.layout.patch();
    let (first, last) = (frame.layout.post(corner), frame.layout.post(corner.moved(side, side)));
    let (columns, rows) = (last.column - first.column + 1, last.row - first.row + 1);
    // Vertices beyond the border have no posts.
    let lines = block.z.chunks_exact(side as usize + 1).take(rows as usize);
    let heights = lines.flat_map(|line| &line[..columns as usize]).copied().collect();
    let lattice = Lattice::part((frame.origin, frame.cell), first, columns, heights)?;
    Ok(SightGround::new(Arc::new(lattice)))
}

impl PageHeights {
    /// No patches yet.
    pub fn new(frame: PagedFrame) -> Self {
        Self { frame, pages: BTreeMap::new() }
    }

    /// Takes over patches that were read, and drops others.
    pub fn update(&mut self, new: Vec<(PatchId, SightGround)>, dropped: &[PatchId]) {
        dropped.iter().for_each(|patch| {
            self.pages.remove(patch);
        });
        self.pages.extend(new);
    }

    /// Drops all patches.
    pub fn clear(&mut self) {
        self.pages.clear();
    }

    /// The number of patches.
    pub fn count(&self) -> usize {
        self.pages.len()
    }

    /// Map coordinates of the terrain's south-west post: the origin of world space.
    pub fn origin(&self) -> DVec2 {
        self.frame.origin
    }

    /// The patch that holds a world position; `None` where it is not in memory.
    pub fn page_at(&self, at: DVec2) -> Option<&Arc<Lattice>> {
        let (side, (east, north)) = (f64::from(self.frame.layout.patch()), self.frame.layout.patch_grid());
        let grid = at / self.frame.cell;
        let last = DVec2::new(east as f64 - 1.0, north as f64 - 1.0);
        let patch = (grid / side).floor().min(last);
        let is_inside = patch.cmpge(DVec2::ZERO).all();
        let id = is_inside.then_some(PatchId((patch.y * east as f64 + patch.x) as u32))?;
        self.pages.get(&id).map(SightGround::lattice)
    }

    /// The height of the ground at a world position; `None` where its patch is not in memory.
    pub fn height(&self, at: DVec2) -> Option<Answer> {
        let page = self.page_at(at)?;
        Some(ground_height(page, Interpolation::Planar, at + self.frame.origin))
    }

    /// The point where a ray in world space first meets the ground of these patches.
    pub fn pick(&self, ray: Ray) -> Option<RayHit> {
        let hits = self.pages.values().filter_map(|page| page.pick(ray, f64::INFINITY));
        hits.min_by(|a, b| a.distance_m.total_cmp(&b.distance_m))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;
    use sandtable_raster::raster::{Raster, Samples, north_up_nodes};
    use sandtable_roam::block::BlockSource;
    use sandtable_roam::paging::ground::{PagedGround, PagingOptions, exact_spheres};

    /// 45 × 45 posts, so that patches of 16 cells reach beyond the border.
    fn raster() -> Raster {
        let height = |at: u32| if at == 700 { f32::NAN } else { (at * 7919 % 101) as f32 };
        let samples = Samples::F32((0..45 * 45).map(height).collect());
        Raster::new(45, samples).placed(north_up_nodes(DVec2::new(5e5, 4e6), DVec2::splat(10.0)))
    }

    #[test]
    fn heights_and_rays_in_pages_are_those_of_the_whole_terrain_to_the_last_bit() {
        let whole = Arc::new(Lattice::from_raster(&raster()).expect("sound"));
        let options = PagingOptions { patch: 16, capacity: 20 };
        let mut ground = PagedGround::open(raster(), exact_spheres(10.0), &options).expect("sound");
        let frame = *ground.frame();
        let mut pages = PageHeights::new(frame);
        assert_eq!(pages.height(DVec2::splat(100.0)), None);
        let corners: Vec<Vertex> = frame.layout.patches().collect();
        for (id, corner) in (0..).map(PatchId).zip(corners) {
            let block = ground.block(corner).expect("in memory");
            pages.update(vec![(id, page(&frame, corner, &block).expect("sound"))], &[]);
        }
        let sight = SightGround::new(Arc::clone(&whole));
        let mut met = 0;
        for step in 0..400u16 {
            let at = DVec2::new(f64::from(step * 37 % 441), f64::from(step * 91 % 439)) + 0.3;
            assert_eq!(
                pages.height(at),
                Some(ground_height(&whole, Interpolation::Planar, at + whole.origin()))
            );
            let direction = DVec3::new(0.3, f64::from(step % 7) - 3.0, -1.0);
            let ray = Ray { origin: at.extend(300.0), direction };
            let (own, all) = (pages.pick(ray), sight.pick(ray, f64::INFINITY));
            let distance = |hit: Option<RayHit>| hit.map(|hit| hit.distance_m);
            assert!(distance(own).zip(distance(all)).is_none_or(|(own, all)| (own - all).abs() < 1e-6));
            assert_eq!(own.is_some(), all.is_some(), "{ray:?}");
            met += usize::from(own.is_some());
        }
        assert!(met > 80, "{met} met");
        pages.update(Vec::new(), &[PatchId(0)]);
        assert_eq!((pages.height(DVec2::splat(50.0)), pages.count()), (None, 8));
    }
}
