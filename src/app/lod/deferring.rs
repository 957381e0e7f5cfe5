//! Nested spheres examined when due: cull patches, let the walk bring those in view up to date.
//!
//! The walk keeps index lists itself and changes them in place, with vertices numbered its own way; they are sent
//! as they are, without triangles beyond the border or over no data.

use crate::app::lod::follow::Follow;
use crate::app::lod::kept::{PatchLists, Stale};
use crate::app::lod::method::SphereRule;
use crate::app::lod::prepared::PreparedGround;
use crate::roam::block::WholeGround;
use crate::roam::culling::{Culling, InView};
use crate::roam::graph::Vertex;
use crate::roam::refine::deferred::Deferred;
use crate::roam::shown::PatchList;
use crate::view::camera::Camera;

/// A walk through a ground in memory.
type Walk<'a> = Deferred<WholeGround<'a>>;

/// The deferred refiner at work.
pub struct Deferring<'a> {
    spheres: SphereRule,
    terrain: &'a PreparedGround,
    walk: Option<Walk<'a>>,
    sent: PatchLists<()>,
    view: InView,
}

impl<'a> Deferring<'a> {
    /// By these spheres.
    pub fn new(spheres: SphereRule, terrain: &'a PreparedGround) -> Self {
        Self { spheres, terrain, walk: None, sent: PatchLists::new(terrain.layout), view: InView::default() }
    }
}

/// A walk that starts anywhere.
fn walk<'a>(terrain: &'a PreparedGround, spheres: SphereRule, camera: &Camera) -> Walk<'a> {
    let source = WholeGround { ground: terrain.ground(), spheres: terrain.spheres(spheres, camera) };
    Deferred::new(source, terrain.lattice.cell().min_element())
        .expect("patches of the default size are small enough")
}

impl Follow for Deferring<'_> {
    fn prepare(&mut self, camera: &Camera) {
        self.walk = Some(walk(self.terrain, self.spheres, camera));
    }

    fn update(&mut self, camera: &Camera) {
        let terrain = self.terrain;
        let view = self.view.update(terrain.ground(), &terrain.heights, Culling::frustum(camera));
        let walk = self.walk.get_or_insert_with(|| walk(terrain, self.spheres, camera));
        walk.update(camera.eye(), view).expect("a ground in memory has every patch");
        let stale = Stale::Patches(&walk.changes().dirty);
        self.sent.renew(view, stale, |corner, ()| 3 * walk.indices(corner).len());
    }

    fn sent_bytes(&self) -> usize {
        self.sent.written_bytes()
    }

    fn shown(&mut self) -> Vec<PatchList> {
        let (terrain, Some(walk)) = (self.terrain, &self.walk) else { return Vec::new() };
        self.sent.shown(|corner, ()| drawn(terrain, walk, corner))
    }
}

/// What is drawn of a patch, with vertices numbered row by row.
fn drawn(terrain: &PreparedGround, walk: &Walk<'_>, corner: Vertex) -> PatchList {
    let vertices = |numbers: &[u16; 3]| numbers.map(|number| walk.vertex(corner, number));
    let triangles = walk.indices(corner).iter().map(vertices);
    PatchList::of_vertices(&terrain.layout, corner, triangles)
}
