//! Bits of vertices set by any criterion: cull patches, refine those in view, write the lists that changed.

use crate::app::lod::follow::Follow;
use crate::app::lod::kept::{Kept, Stale};
use crate::app::lod::method::{Lists, Refiner, Rule};
use crate::app::lod::prepared::{Prepared, WithCriterion};
use crate::app::lod::writing::{IndexList, Writer};
use crate::roam::active::ActiveSet;
use crate::roam::criterion::Criterion;
use crate::roam::culling::{Culling, cull};
use crate::roam::graph::Vertex;
use crate::roam::layout::Layout;
use crate::roam::refine::changes::Changes;
use crate::roam::refine::coherent::Coherent;
use crate::roam::refine::queues::{Goal, Queues};
use crate::roam::refine::rebuild::rebuild;
use crate::roam::shown::PatchList;
use crate::view::camera::Camera;

/// A refiner at work.
pub struct Refining<'a> {
    rule: Rule,
    terrain: &'a Prepared,
    bits: Bits<'a>,
    writer: Writer<'a>,
    lists: Kept<IndexList>,
    view: Vec<Vertex>,
}

/// The refiners with what they remember.
enum Bits<'a> {
    Rebuild(ActiveSet),
    Coherent(Box<Coherent>),
    Queues(Box<Queues<'a>>),
}

/// A refiner's update as something that is done with a criterion.
struct Step<'s, 'a> {
    bits: &'s mut Bits<'a>,
    layout: &'s Layout,
    patches: &'s [Vertex],
}

impl WithCriterion for Step<'_, '_> {
    /// What changed, where the refiner knows.
    type Out = Option<Changes>;

    fn call(self, criterion: &impl Criterion) -> Self::Out {
        match self.bits {
            Bits::Rebuild(active) => {
                *active = rebuild(self.layout, criterion, self.patches.iter().copied());
                None
            }
            Bits::Coherent(coherent) => Some(coherent.update(criterion, self.patches)),
            Bits::Queues(queues) => Some(queues.update(criterion, self.patches)),
        }
    }
}

impl<'a> Bits<'a> {
    fn new(refiner: Refiner, terrain: &'a Prepared, budget: Option<usize>) -> Self {
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
        lists: Lists,
        rule: Rule,
        refiner: Refiner,
        terrain: &'a Prepared,
        budget: Option<usize>,
    ) -> Self {
        Self {
            rule,
            terrain,
            bits: Bits::new(refiner, terrain, budget),
            writer: Writer::new(lists, terrain),
            lists: Kept::new(terrain.layout),
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
        let step = Step { bits: &mut self.bits, layout: &terrain.layout, patches: &self.view };
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
