//! Anew for every frame: cull patches, refine from their roots, write all lists.

use crate::app::lod::follow::{Follow, Sending};
use crate::app::lod::method::Rule;
use crate::app::lod::prepared::{Prepared, WithCriterion};
use crate::roam::active::ActiveSet;
use crate::roam::criterion::Criterion;
use crate::roam::culling::patches_in_view;
use crate::roam::graph::Vertex;
use crate::roam::layout::Layout;
use crate::roam::refine::rebuild::rebuild;
use crate::roam::shown::PatchList;
use crate::view::camera::Camera;
use crate::view::frustum::Frustum;

/// The bintree rebuilt for every frame.
pub struct Rebuilding<'a> {
    rule: Rule,
    terrain: &'a Prepared,
    lists: Vec<PatchList>,
}

impl<'a> Rebuilding<'a> {
    /// By this criterion.
    pub fn new(rule: Rule, terrain: &'a Prepared) -> Self {
        Self { rule, terrain, lists: Vec::new() }
    }
}

/// Rebuilding as something that is done with a criterion.
struct Rebuild<'a> {
    layout: &'a Layout,
    patches: &'a [Vertex],
}

impl WithCriterion for Rebuild<'_> {
    type Out = ActiveSet;

    fn call(self, criterion: &impl Criterion) -> ActiveSet {
        rebuild(self.layout, criterion, self.patches.iter().copied())
    }
}

impl Follow for Rebuilding<'_> {
    fn prepare(&mut self, camera: &Camera) {
        if self.rule == Rule::Spheres {
            self.terrain.spheres(camera);
        }
    }

    fn update(&mut self, camera: &Camera) {
        let (terrain, ground) = (self.terrain, self.terrain.ground());
        let patches = patches_in_view(ground, &terrain.heights, &Frustum::of(camera));
        let refine = Rebuild { layout: &terrain.layout, patches: &patches };
        let active = terrain.with_criterion(self.rule, camera, refine);
        self.lists.clear();
        self.lists.extend(patches.iter().map(|&corner| PatchList::bintree(ground, &active, corner)));
    }

    fn shown(&self) -> Vec<PatchList> {
        self.lists.clone()
    }

    fn sending(&self) -> Sending {
        Sending::Everything
    }
}
