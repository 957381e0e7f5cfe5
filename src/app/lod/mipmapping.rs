//! GeoMipMap: choose a level for each patch, write the lists of those whose own or neighbors' levels changed.

use crate::app::lod::follow::Follow;
use crate::app::lod::kept::{PatchLists, Stale};
use crate::app::lod::prepared::PreparedGround;
use crate::roam::culling::{Culling, cull};
use crate::roam::emit::geomipmap::{PatchLevels, Pyramids, triangles};
use crate::roam::emit::world::drawn_posts;
use crate::roam::graph::Vertex;
use crate::roam::layout::PatchLayout;
use crate::roam::shown::{LocalTriangle, PatchList, local};
use crate::view::camera::Camera;

/// The static method at work.
pub struct Mipmapping<'a> {
    terrain: &'a PreparedGround,
    pyramids: Pyramids,
    levels: Option<PatchLevels>,
    stale: Vec<usize>,
    lists: PatchLists<Vec<LocalTriangle>>,
    view: Vec<Vertex>,
}

impl<'a> Mipmapping<'a> {
    /// Measures all levels of all patches.
    pub fn new(terrain: &'a PreparedGround) -> Self {
        Self {
            terrain,
            pyramids: Pyramids::new(&terrain.lattice, &terrain.layout),
            levels: None,
            stale: Vec::new(),
            lists: PatchLists::new(terrain.layout),
            view: Vec::new(),
        }
    }

    /// Lists the patches whose level is another, and those beside them: their stitches may be others.
    fn note_stale(&mut self, levels: &PatchLevels) {
        let layout = &self.terrain.layout;
        let last = self.levels.as_ref();
        let is_same = |corner| last.is_some_and(|last| last.at(layout, corner) == levels.at(layout, corner));
        self.stale.clear();
        for corner in layout.patches().filter(|&corner| !is_same(corner)) {
            self.stale.extend(with_neighbors(layout, corner));
        }
    }
}

/// The places of a patch and of those around it.
fn with_neighbors(layout: &PatchLayout, corner: Vertex) -> impl Iterator<Item = usize> {
    let (layout, at) = (*layout, (corner.x / layout.patch(), corner.y / layout.patch()));
    let around = layout.patches_within((at.0 - 1, at.1 - 1), (at.0 + 1, at.1 + 1));
    around.map(move |corner| layout.patch_index(corner))
}

impl Follow for Mipmapping<'_> {
    fn prepare(&mut self, _: &Camera) {}

    fn update(&mut self, camera: &Camera) {
        let (terrain, ground) = (self.terrain, self.terrain.ground());
        cull(ground, &terrain.heights, &Culling::frustum(camera), &mut self.view);
        let levels = self.pyramids.for_view(ground, &terrain.heights, camera, terrain.tolerance_px);
        self.note_stale(&levels);
        self.lists.renew(&self.view, Stale::Patches(&self.stale), |corner, list| {
            write(terrain, &levels, corner, list);
            3 * list.len()
        });
        self.levels = Some(levels);
    }

    fn sent_bytes(&self) -> usize {
        self.lists.written_bytes()
    }

    fn shown(&mut self) -> Vec<PatchList> {
        self.lists.shown(|corner, list| PatchList::of_triangles(corner, list.clone().into()))
    }
}

fn write(terrain: &PreparedGround, levels: &PatchLevels, corner: Vertex, list: &mut Vec<LocalTriangle>) {
    list.clear();
    let is_whole = terrain.is_whole(corner);
    triangles(&terrain.layout, levels, [corner], |corners| {
        if is_whole || drawn_posts(terrain.ground(), corners).is_some() {
            list.push(corners.map(|vertex| local(&terrain.layout, corner, vertex)));
        }
    });
}
