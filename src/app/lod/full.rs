//! Every post: nothing is refined, patches out of view are left out.
//!
//! All patches that are drawn whole have one index list in common; those that a border cuts or that have holes have
//! their own. All are sent before the flight.

use std::sync::Arc;

use crate::app::lod::follow::Follow;
use crate::app::lod::prepared::PreparedGround;
use crate::roam::culling::{Culling, cull};
use crate::roam::emit::full;
use crate::roam::emit::world::drawn_posts;
use crate::roam::graph::Vertex;
use crate::roam::shown::{LocalTriangle, PatchList, local};
use crate::view::camera::Camera;

/// The full mesh.
pub struct Full<'a> {
    terrain: &'a PreparedGround,
    lists: Vec<PatchList>,
    view: Vec<Vertex>,
}

impl<'a> Full<'a> {
    /// Makes the lists of all patches, those that are equal once.
    pub fn new(terrain: &'a PreparedGround) -> Self {
        let mut whole: Option<Arc<Vec<LocalTriangle>>> = None;
        let mut lists = Vec::with_capacity(terrain.layout.patch_count());
        for corner in terrain.layout.patches() {
            lists.push(if terrain.is_whole(corner) {
                let triangles = whole.get_or_insert_with(|| triangles(terrain, corner));
                PatchList::of_triangles(corner, Arc::clone(triangles))
            } else {
                PatchList::of_triangles(corner, triangles(terrain, corner))
            });
        }
        Self { terrain, lists, view: Vec::new() }
    }
}

fn triangles(terrain: &PreparedGround, corner: Vertex) -> Arc<Vec<LocalTriangle>> {
    let mut drawn = Vec::new();
    full::triangles(&terrain.layout, [corner], |corners| {
        if drawn_posts(terrain.ground(), corners).is_some() {
            drawn.push(corners.map(|vertex| local(&terrain.layout, corner, vertex)));
        }
    });
    Arc::new(drawn)
}

impl Follow for Full<'_> {
    fn prepare(&mut self, _: &Camera) {}

    fn update(&mut self, camera: &Camera) {
        let culling = Culling::frustum(camera);
        cull(self.terrain.ground(), &self.terrain.heights, &culling, &mut self.view);
    }

    fn sent_bytes(&self) -> usize {
        0
    }

    fn shown(&mut self) -> Vec<PatchList> {
        let place = |&corner: &Vertex| self.terrain.layout.patch_index(corner);
        self.view.iter().map(|corner| self.lists[place(corner)].clone()).collect()
    }
}
