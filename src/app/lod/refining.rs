//! Bits of vertices set by any criterion: cull patches, refine those in view, write the lists that changed.

use crate::app::lod::follow::Follow;
use crate::app::lod::kept::{PatchLists, Stale};
use crate::app::lod::method::{CriterionKind, IndexEmitter, Refiner};
use crate::app::lod::prepared::{PreparedGround, WithCriterion};
use crate::app::lod::writing::{IndexList, Writer};
use crate::roam::active::ActiveSet;
use crate::roam::criterion::Criterion;
use crate::roam::culling::{Culling, cull};
use crate::roam::graph::Vertex;
use crate::roam::layout::PatchLayout;
use crate::roam::refine::changes::RefinementChanges;
use crate::roam::refine::coherent::Coherent;
use crate::roam::refine::queues::{Goal, Queues};
use crate::roam::refine::rebuild::rebuild;
use crate::roam::shown::PatchList;
use crate::view::camera::Camera;

/// A refiner at work.
pub struct Refining<'a> {
    rule: CriterionKind,
    terrain: &'a PreparedGround,
    bits: RefinerState<'a>,
    writer: Writer<'a>,
    lists: PatchLists<IndexList>,
    view: Vec<Vertex>,
}

/// The refiners with what they remember.
enum RefinerState<'a> {
    Rebuild(ActiveSet),
    Coherent(Box<Coherent>),
    Queues(Box<Queues<'a>>),
}

/// A refiner's update as something that is done with a criterion.
struct UpdateStep<'s, 'a> {
    bits: &'s mut RefinerState<'a>,
    layout: &'s PatchLayout,
    patches: &'s [Vertex],
}

impl WithCriterion for UpdateStep<'_, '_> {
    /// What changed, where the refiner knows.
    type Out = Option<RefinementChanges>;

    fn call(self, criterion: &impl Criterion) -> Self::Out {
        match self.bits {
            RefinerState::Rebuild(active) => {
                *active = rebuild(self.layout, criterion, self.patches.iter().copied());
                None
            }
            RefinerState::Coherent(coherent) => Some(coherent.update(criterion, self.patches)),
            RefinerState::Queues(queues) => Some(queues.update(criterion, self.patches)),
        }
    }
}

impl<'a> RefinerState<'a> {
    fn new(refiner: Refiner, terrain: &'a PreparedGround, budget: Option<usize>) -> Self {
        let layout = terrain.layout;
        match refiner {
            Refiner::Rebuild => Self::Rebuild(ActiveSet::new(layout)),
            Refiner::Coherent => Self::Coherent(Box::new(Coherent::new(layout))),
            Refiner::Queues => {
                let goal = budget.map_or(Goal::Tolerance, Goal::Budget);
                Self::Queues(Box::new(Queues::new(terrain.ground(), goal)))
            }
        }
    }

    fn active(&self) -> &ActiveSet {
        match self {
            Self::Rebuild(active) => active,
            Self::Coherent(coherent) => coherent.active(),
            Self::Queues(queues) => queues.active(),
        }
    }
}

impl<'a> Refining<'a> {
    /// By this criterion; queues keep the budget where there is one.
    pub fn new(
        lists: IndexEmitter,
        rule: CriterionKind,
        refiner: Refiner,
        terrain: &'a PreparedGround,
        budget: Option<usize>,
    ) -> Self {
        Self {
            rule,
            terrain,
            bits: RefinerState::new(refiner, terrain, budget),
            writer: Writer::new(lists, terrain),
            lists: PatchLists::new(terrain.layout),
            view: Vec::new(),
        }
    }
}

impl Follow for Refining<'_> {
    fn prepare(&mut self, camera: &Camera) {
        self.terrain.make(self.rule, camera);
    }

    fn update(&mut self, camera: &Camera) {
        let terrain = self.terrain;
        cull(terrain.ground(), &terrain.heights, &Culling::frustum(camera), &mut self.view);
        let step = UpdateStep { bits: &mut self.bits, layout: &terrain.layout, patches: &self.view };
        let changes = terrain.with_criterion(self.rule, camera, step);
        let stale = changes.as_ref().map_or(Stale::All, |changes| Stale::Patches(&changes.dirty));
        let (writer, active) = (&mut self.writer, self.bits.active());
        self.lists.renew(&self.view, stale, |corner, list| writer.write(active, corner, list));
    }

    fn sent_bytes(&self) -> usize {
        self.lists.written_bytes()
    }

    fn shown(&mut self) -> Vec<PatchList> {
        self.lists.shown(|corner, list| self.writer.draw(corner, list))
    }
}
