//! Nested spheres examined when due: patches are culled, and the walk brings those in view up to date.
//!
//! The walk keeps index lists itself and changes them in place, with its own numbering of vertices; they are sent as
//! they are, triangles beyond the border and over no data included.

use crate::lod::follower::LodFollower;
use crate::lod::lod_ground::LodGround;
use crate::lod::method::SphereRule;
use crate::lod::patch_lists::{PatchLists, Stale};
use sandtable_roam::block::WholeGround;
use sandtable_roam::culling::{Culling, InView};
use sandtable_roam::refine::deferred::Deferred;
use sandtable_roam::shown::PatchList;
use sandtable_view::camera::Camera;

/// A walk over ground in memory.
type WholeWalk<'a> = Deferred<WholeGround<'a>>;

/// The deferred refiner at work.
pub struct DeferredFollower<'a> {
    ground: &'a LodGround,
    spheres: SphereRule,
    walk: Option<WholeWalk<'a>>,
    lists: PatchLists<()>,
    view: InView,
}

impl<'a> DeferredFollower<'a> {
    /// Refines by `spheres`.
    pub fn new(ground: &'a LodGround, spheres: SphereRule) -> Self {
        Self {
            ground,
            spheres,
            walk: None,
            lists: PatchLists::new(*ground.measured.layout()),
            view: InView::default(),
        }
    }
}

fn start<'a>(ground: &'a LodGround, spheres: SphereRule, camera: &Camera) -> WholeWalk<'a> {
    let source = WholeGround { ground: ground.measured.patched(), spheres: ground.spheres(spheres, camera) };
    Deferred::new(source, ground.measured.lattice().cell().min_element())
        .expect("patches of the default size are small enough")
}

impl LodFollower for DeferredFollower<'_> {
    fn prepare(&mut self, camera: &Camera) {
        self.walk = Some(start(self.ground, self.spheres, camera));
    }

    fn update(&mut self, camera: &Camera) {
        let ground = self.ground;
        let view =
            self.view.update(ground.measured.patched(), ground.measured.heights(), Culling::frustum(camera));
        let walk = self.walk.get_or_insert_with(|| start(ground, self.spheres, camera));
        walk.update(camera.eye(), view).expect("ground in memory has every patch");
        let stale = Stale::Patches(&walk.changes().dirty);
        self.lists.update(view, stale, |corner, ()| 3 * walk.indices(corner).len());
    }

    fn sent_bytes(&self) -> usize {
        self.lists.written_bytes()
    }

    fn shown(&mut self) -> Vec<PatchList> {
        let (ground, Some(walk)) = (self.ground, &self.walk) else { return Vec::new() };
        self.lists.shown(|corner, ()| {
            let vertices = |numbers: &[u16; 3]| numbers.map(|number| walk.vertex(corner, number));
            let triangles = walk.indices(corner).iter().map(vertices);
            PatchList::of_vertices(ground.measured.layout(), corner, triangles)
        })
    }
}
