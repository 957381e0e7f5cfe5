//! GeoMipMap: a level for each patch; the lists are written where a patch's or a neighbor's level changed.

use crate::lod::follower::LodFollower;
use crate::lod::lod_ground::LodGround;
use crate::lod::patch_lists::{PatchLists, Stale};
use sandtable_roam::culling::{Culling, cull};
use sandtable_roam::emit::geomipmap::{PatchLevels, Pyramids, triangles};
use sandtable_roam::graph::Vertex;
use sandtable_roam::layout::PatchLayout;
use sandtable_roam::shown::{LocalTriangle, PatchList};
use sandtable_view::camera::Camera;

/// GeoMipMap at work.
pub struct GeomipmapFollower<'a> {
    ground: &'a LodGround,
    pyramids: Pyramids,
    levels: Option<PatchLevels>,
    stale: Vec<usize>,
    lists: PatchLists<Vec<LocalTriangle>>,
    view: Vec<Vertex>,
}

impl<'a> GeomipmapFollower<'a> {
    /// Measures all levels of all patches.
    pub fn new(ground: &'a LodGround) -> Self {
        Self {
            ground,
            pyramids: Pyramids::new(ground.measured.lattice(), ground.measured.layout()),
            levels: None,
            stale: Vec::new(),
            lists: PatchLists::new(*ground.measured.layout()),
            view: Vec::new(),
        }
    }

    /// Lists the patches whose level changed and their neighbors, whose stitches may change.
    fn list_stale(&mut self, levels: &PatchLevels) {
        let (layout, last) = (self.ground.measured.layout(), self.levels.as_ref());
        let is_same = |corner| last.is_some_and(|last| last.at(layout, corner) == levels.at(layout, corner));
        self.stale.clear();
        for corner in layout.patches().filter(|&corner| !is_same(corner)) {
            self.stale.extend(with_neighbors(layout, corner));
        }
    }
}

/// The indices of a patch and of those around it.
fn with_neighbors(layout: &PatchLayout, corner: Vertex) -> impl Iterator<Item = usize> {
    let (layout, at) = (*layout, (corner.x / layout.patch(), corner.y / layout.patch()));
    let around = layout.patches_within((at.0 - 1, at.1 - 1), (at.0 + 1, at.1 + 1));
    around.map(move |corner| layout.patch_index(corner))
}

impl LodFollower for GeomipmapFollower<'_> {
    fn update(&mut self, camera: &Camera) {
        let (ground, patched) = (self.ground, self.ground.measured.patched());
        cull(patched, ground.measured.heights(), &Culling::frustum(camera), &mut self.view);
        let levels = self.pyramids.for_view(patched, ground.measured.heights(), camera, ground.tolerance_px);
        self.list_stale(&levels);
        self.lists.update(&self.view, Stale::Patches(&self.stale), |corner, list| {
            list.clear();
            let drawn = ground.measured.drawn_in(corner);
            triangles(ground.measured.layout(), &levels, [corner], |corners| list.extend(drawn(corners)));
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
