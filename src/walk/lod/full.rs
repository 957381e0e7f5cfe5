//! Every post: nothing is refined, patches out of view are left out.
//!
//! All patches that are drawn whole share one index list; those that a border cuts or that have holes have their own.
//! All are sent before the flight.

use std::sync::Arc;

use crate::lod::follower::LodFollower;
use sandtable_roam::culling::{Culling, cull};
use sandtable_roam::emit::full;
use sandtable_roam::graph::Vertex;
use sandtable_roam::measured_ground::MeasuredGround;
use sandtable_roam::shown::{LocalTriangle, PatchList};
use sandtable_view::camera::Camera;

/// The full mesh.
pub struct FullFollower<'a> {
    ground: &'a MeasuredGround,
    lists: Vec<PatchList>,
    view: Vec<Vertex>,
}

impl<'a> FullFollower<'a> {
    /// Makes the lists of all patches.
    pub fn new(ground: &'a MeasuredGround) -> Self {
        let mut whole: Option<Arc<Vec<LocalTriangle>>> = None;
        let list = |corner: Vertex| {
            let triangles = if ground.is_whole(corner) {
                Arc::clone(whole.get_or_insert_with(|| triangles(ground, corner)))
            } else {
                triangles(ground, corner)
            };
            PatchList::of_triangles(corner, triangles)
        };
        Self { ground, lists: ground.layout().patches().map(list).collect(), view: Vec::new() }
    }
}

fn triangles(ground: &MeasuredGround, corner: Vertex) -> Arc<Vec<LocalTriangle>> {
    let (mut list, drawn) = (Vec::new(), ground.drawn_in(corner));
    full::triangles(ground.layout(), [corner], |corners| list.extend(drawn(corners)));
    Arc::new(list)
}

impl LodFollower for FullFollower<'_> {
    fn update(&mut self, camera: &Camera) {
        cull(self.ground.patched(), self.ground.heights(), &Culling::frustum(camera), &mut self.view);
    }

    fn sent_bytes(&self) -> usize {
        0
    }

    fn shown(&mut self) -> Vec<PatchList> {
        self.view.iter().map(|&corner| self.lists[self.ground.layout().patch_index(corner)].clone()).collect()
    }
}
