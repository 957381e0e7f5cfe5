//! Vertices refined by any criterion: patches are culled, those in view refined, and the lists that changed written.

use crate::lod::follower::LodFollower;
use crate::lod::index_lists::{IndexList, IndexWriter};
use crate::lod::lod_ground::{LodGround, WithCriterion};
use crate::lod::method::{CriterionKind, IndexEmitter, Refiner};
use crate::lod::patch_lists::{PatchLists, Stale};
use sandtable_roam::active::ActiveSet;
use sandtable_roam::criterion::Criterion;
use sandtable_roam::culling::{Culling, cull};
use sandtable_roam::graph::Vertex;
use sandtable_roam::layout::PatchLayout;
use sandtable_roam::refine::changes::RefinementChanges;
use sandtable_roam::refine::coherent::Coherent;
use sandtable_roam::refine::queues::{Goal, Queues};
use sandtable_roam::refine::rebuild::rebuild;
use sandtable_roam::shown::PatchList;
use sandtable_view::camera::Camera;

/// A refiner at work.
pub struct RefiningFollower<'a> {
    ground: &'a LodGround,
    criterion: CriterionKind,
    state: RefinerState<'a>,
    writer: IndexWriter<'a>,
    lists: PatchLists<IndexList>,
    view: Vec<Vertex>,
}

/// The refiners with what they keep from frame to frame.
enum RefinerState<'a> {
    Rebuild(ActiveSet),
    Coherent(Box<Coherent>),
    Queues(Box<Queues<'a>>),
}

/// The update of a refiner, to be called with a criterion. Returns the changes if the refiner records them.
struct RefinerUpdate<'s, 'a> {
    state: &'s mut RefinerState<'a>,
    layout: &'s PatchLayout,
    patches: &'s [Vertex],
}

impl WithCriterion for RefinerUpdate<'_, '_> {
    type Out = Option<RefinementChanges>;

    fn call(self, criterion: &impl Criterion) -> Self::Out {
        match self.state {
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
    fn new(refiner: Refiner, ground: &'a LodGround, budget: Option<usize>) -> Self {
        match refiner {
            Refiner::Rebuild => Self::Rebuild(ActiveSet::new(*ground.measured.layout())),
            Refiner::Coherent => Self::Coherent(Box::new(Coherent::new(*ground.measured.layout()))),
            Refiner::Queues => {
                let goal = budget.map_or(Goal::Tolerance, Goal::Budget);
                Self::Queues(Box::new(Queues::new(ground.measured.patched(), goal)))
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

impl<'a> RefiningFollower<'a> {
    /// Refines by `criterion`; queues keep to `budget` triangles where one is given.
    pub fn new(
        ground: &'a LodGround,
        lists: IndexEmitter,
        criterion: CriterionKind,
        refiner: Refiner,
        budget: Option<usize>,
    ) -> Self {
        Self {
            ground,
            criterion,
            state: RefinerState::new(refiner, ground, budget),
            writer: IndexWriter::new(lists, &ground.measured),
            lists: PatchLists::new(*ground.measured.layout()),
            view: Vec::new(),
        }
    }
}

impl LodFollower for RefiningFollower<'_> {
    fn prepare(&mut self, camera: &Camera) {
        self.ground.prepare(self.criterion, camera);
    }

    fn update(&mut self, camera: &Camera) {
        let ground = self.ground;
        cull(ground.measured.patched(), ground.measured.heights(), &Culling::frustum(camera), &mut self.view);
        let update =
            RefinerUpdate { state: &mut self.state, layout: ground.measured.layout(), patches: &self.view };
        let changes = ground.with_criterion(self.criterion, camera, update);
        let stale = changes.as_ref().map_or(Stale::All, |changes| Stale::Patches(&changes.dirty));
        let (writer, active) = (&mut self.writer, self.state.active());
        self.lists.update(&self.view, stale, |corner, list| writer.write(active, corner, list));
    }

    fn sent_bytes(&self) -> usize {
        self.lists.written_bytes()
    }

    fn shown(&mut self) -> Vec<PatchList> {
        self.lists.shown(|corner, list| self.writer.triangles(corner, list))
    }
}
