//! Spheres of a terrain for another reach, made on another thread.
//!
//! The task holds a snapshot of all that the spheres depend on. Its ground is a source of patches: a mesh can be refined on
//! it before the terrain itself has the spheres.

use std::sync::Arc;

use glam::Vec3;

use crate::block::{BlockError, BlockSource, PatchBlock, RootSphere, WholeGround};
use crate::dynamic::{DynamicOptions, own_radius};
use crate::errors::ErrorMap;
use crate::graph::Vertex;
use crate::layout::PatchLayout;
use crate::patched_ground::PatchedGround;
use crate::roughness::Roughness;
use crate::spheres::SphereMap;
use sandtable_terrain::lattice::Lattice;

/// A task that makes spheres. While it is kept, the next edit copies heights and errors.
#[derive(Clone, Debug)]
pub struct SphereTask {
    pub(super) options: DynamicOptions,
    pub(super) lattice: Arc<Lattice>,
    pub(super) layout: PatchLayout,
    pub(super) errors: Arc<ErrorMap>,
    pub(super) roughness: Option<Arc<Roughness>>,
    /// How often the terrain had been edited.
    pub(super) edits: u64,
}

/// The ground of a task with the spheres that were made.
#[derive(Clone, Debug)]
pub struct TaskGround {
    pub(super) task: SphereTask,
    pub(super) spheres: SphereMap,
}

impl SphereTask {
    /// Makes the spheres.
    pub fn ground(self) -> TaskGround {
        let ground = PatchedGround { lattice: &self.lattice, layout: &self.layout };
        let own = own_radius(&self.options, &self.errors, self.roughness.as_deref());
        let spheres = SphereMap::new(ground, &own);
        TaskGround { task: self, spheres }
    }
}

impl TaskGround {
    /// The heights.
    pub fn lattice(&self) -> &Lattice {
        &self.task.lattice
    }

    /// The reach of the spheres.
    pub fn reach(&self) -> f32 {
        self.task.options.reach
    }

    /// How often the terrain had been edited.
    pub fn edits(&self) -> u64 {
        self.task.edits
    }

    fn source(&self) -> WholeGround<'_> {
        let ground = PatchedGround { lattice: &self.task.lattice, layout: &self.task.layout };
        WholeGround { ground, spheres: &self.spheres }
    }
}

impl BlockSource for TaskGround {
    fn layout(&self) -> &PatchLayout {
        &self.task.layout
    }

    fn root(&self, corner: Vertex) -> RootSphere {
        self.source().root(corner)
    }

    fn corners(&self, corner: Vertex) -> [Vec3; 4] {
        self.source().corners(corner)
    }

    fn block(&mut self, corner: Vertex) -> Result<Arc<PatchBlock>, BlockError> {
        self.source().block(corner)
    }
}
