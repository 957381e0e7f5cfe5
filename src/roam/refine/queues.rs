//! Two priority queues and an exact budget of drawn triangles: ROAM as published by Duchaineau et al. 1997.
//!
//! The split queue holds the vertices that could be activated next, one for each leaf triangle or pair of leaf triangles;
//! the merge queue those that could be deactivated next, the diamonds. A priority is the criterion's excess. While there
//! are too many triangles, the lowest diamond is merged; while the best split has a higher priority than the lowest
//! diamond, one is traded for the other. A split counts with all splits that it forces: where lower diamonds cannot make
//! room for all of them, nothing is changed and the next split is tried.
//!
//! Priorities are computed for each frame, as in the paper without its deferral, so a frame costs an evaluation of every
//! leaf and every diamond; only the members of the queues are kept. The queues are binary heaps of (priority, vertex
//! index), so that ties are settled the same way every time.
//!
//! The published loop has trouble with a budget that the view cannot use. Here a vertex that is out of view or has no error
//! is never split for the budget's sake, and is merged at once.
//!
//! The budget counts drawn triangles. Those over no data and beyond the border cost nothing, though their descendants may;
//! where no descendant is ever drawn, no split is made for the budget's sake. A merge at the edge of a hole may then draw
//! more triangles than it removes: each trade counts with all its merges, down to those that have become idle, so every
//! trade leaves a better mesh and the loop ends.

use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::ops::Add;

use crate::active::ActiveSet;
use crate::bintree::Triangle;
use crate::criterion::Criterion;
use crate::graph::Vertex;
use crate::layout::PatchLayout;
use crate::patched_ground::PatchedGround;
use crate::refine::changes::{ChangeTally, RefinementChanges};
use crate::refine::drawn::{Count, Drawn};
use crate::refine::listed::ListedPatches;
use crate::refine::members::VertexSet;

/// The consecutive splits that may find no room before an update ends. A triangle or two of the budget stay unused; trying
/// every other leaf for them would cost more than the rest of the frame.
const MOST_REFUSALS: usize = 32;

/// The most leaf triangles, drawn or not, for each drawn one of the budget, without the roots of listed patches: it bounds
/// the time spent on the edges of holes.
pub const MOST_LEAVES: usize = 8;

/// The goal of the queues.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Goal {
    /// Every vertex that the criterion wants, whatever the number of triangles. Where no vertex's excess is above its
    /// parents', the mesh is that of [`rebuild`](crate::refine::rebuild::rebuild).
    Tolerance,
    /// As fine as this number of drawn triangles allows, below the tolerance too.
    Budget(usize),
    /// Every vertex that the criterion wants, within this number of drawn triangles.
    ToleranceWithin(usize),
}

impl Goal {
    /// The most triangles in a number of listed patches; `None` where there is no limit.
    fn most(self, patches: usize) -> Option<Count> {
        match self {
            Self::Tolerance => None,
            Self::Budget(most) | Self::ToleranceWithin(most) => {
                let leaves = most.saturating_mul(MOST_LEAVES).saturating_add(2 * patches);
                let [drawn, leaves] = [most, leaves].map(|count| i64::try_from(count).unwrap_or(i64::MAX));
                Some(Count { drawn, leaves })
            }
        }
    }

    /// A vertex is split for its own sake only above this excess, and is idle, and merged, at or below it.
    fn floor(self) -> f32 {
        match self {
            Self::Budget(_) => 0.0,
            Self::Tolerance | Self::ToleranceWithin(_) => 1.0,
        }
    }
}

/// A mesh that follows the view by trading splits for merges.
#[derive(Clone, Debug)]
pub struct Queues<'a> {
    active: ActiveSet,
    drawn: Drawn<'a>,
    goal: Goal,
    listed: ListedPatches,
    tally: ChangeTally,
    count: Count,
    splittable: VertexSet,
    mergeable: VertexSet,
    splits: BinaryHeap<u64>,
    merges: BinaryHeap<Reverse<u64>>,
    forced: Vec<Vertex>,
    undo: Vec<(Vertex, u64)>,
    aside: Vec<Reverse<u64>>,
}

impl<'a> Queues<'a> {
    /// The queues at the roots of all patches of a ground, whose heights decide which triangles are drawn.
    pub fn new(ground: PatchedGround<'a>, goal: Goal) -> Self {
        let layout = *ground.layout;
        Self {
            active: ActiveSet::new(layout),
            drawn: Drawn::new(ground),
            goal,
            listed: ListedPatches::new(&layout),
            tally: ChangeTally::new(&layout),
            count: Count::default(),
            splittable: VertexSet::new(&layout),
            mergeable: VertexSet::new(&layout),
            splits: BinaryHeap::new(),
            merges: BinaryHeap::new(),
            forced: Vec::new(),
            undo: Vec::new(),
            aside: Vec::new(),
        }
    }

    /// The active vertices.
    pub fn active(&self) -> &ActiveSet {
        &self.active
    }

    /// The drawn triangles of the listed patches: the leaves with an area and data at their corners. Never above the
    /// budget, except for the two roots of every listed patch, which always exist.
    pub fn triangles(&self) -> usize {
        self.count.drawn as usize
    }

    /// All leaf triangles of the listed patches, including those beyond the lattice's border or over no data. Never above
    /// [`MOST_LEAVES`] times the budget and two for every listed patch.
    pub fn leaves(&self) -> usize {
        self.count.leaves as usize
    }

    /// Adjusts the mesh to a view; `patches` are the south-west corners of patches of the layout. A vertex that is merged
    /// and then forced to return counts both ways, and its patches are dirty.
    pub fn update(&mut self, criterion: &impl Criterion, patches: &[Vertex]) -> RefinementChanges {
        let layout = *self.active.layout();
        self.listed.renew(&layout, patches);
        self.recount(&layout);
        self.gather(criterion);
        self.merge_excess(criterion);
        let mut refusals = 0;
        while let Some((priority, vertex)) = self.next_split() {
            if self.trade(criterion, priority, vertex) {
                refusals = 0;
            } else if refusals == MOST_REFUSALS {
                break;
            } else {
                refusals += 1;
            }
        }
        self.tally.take()
    }

    /// Counts the triangles of patches that entered and left, and adds the leaves of those that entered.
    fn recount(&mut self, layout: &PatchLayout) {
        for &corner in &self.listed.left {
            self.count = self.count - count(&self.active, &self.drawn, corner);
        }
        for &corner in &self.listed.entered {
            self.count = self.count + count(&self.active, &self.drawn, corner);
            for root in Triangle::roots(corner, layout.patch()) {
                visit_leaves(&self.active, &root, &mut |leaf| {
                    if !leaf.is_finest() {
                        self.splittable.insert(layout, leaf.split_vertex());
                    }
                });
            }
        }
    }

    /// Fills both queues with this frame's priorities.
    fn gather(&mut self, criterion: &impl Criterion) {
        let (goal, active, listed) = (self.goal, &self.active, &self.listed);
        let evaluation = QueueEvaluation { goal, drawn: &self.drawn, listed, criterion };
        let mut splits = std::mem::take(&mut self.splits).into_vec();
        splits.clear();
        self.splittable.retain(active.layout(), |vertex, index| {
            let is_leaf = is_splittable(active, listed, vertex);
            let excess = if is_leaf { evaluation.priority(vertex) } else { 0.0 };
            if excess > goal.floor() {
                splits.push(entry(excess, index));
            }
            is_leaf
        });
        self.splits = BinaryHeap::from(splits);

        let mut merges = std::mem::take(&mut self.merges).into_vec();
        merges.clear();
        let capped = goal != Goal::Tolerance;
        self.mergeable.retain(active.layout(), |vertex, index| {
            let is_free = active.is_mergeable(vertex);
            if is_free {
                let excess = evaluation.diamond_priority(active.layout(), vertex);
                if capped || excess <= goal.floor() {
                    merges.push(Reverse(entry(excess, index)));
                }
            }
            is_free
        });
        self.merges = BinaryHeap::from(merges);
    }

    fn evaluation<'b, C>(&'b self, criterion: &'b C) -> QueueEvaluation<'b, C> {
        QueueEvaluation { goal: self.goal, drawn: &self.drawn, listed: &self.listed, criterion }
    }

    /// Merges idle diamonds, and the lowest ones until the budget holds or only roots are left.
    fn merge_excess(&mut self, criterion: &impl Criterion) {
        while let Some((priority, vertex)) = self.lowest_diamond() {
            if !self.is_idle(priority) && self.has_room(Count::default()) {
                break;
            }
            self.merge_lowest(criterion, vertex);
        }
    }

    fn is_idle(&self, priority: u64) -> bool {
        excess_of(priority) <= self.goal.floor()
    }

    /// Whether `more` triangles are within the budget.
    fn has_room(&self, more: Count) -> bool {
        let after = self.count + more;
        let within = |most: Count| after.drawn <= most.drawn && after.leaves <= most.leaves;
        self.goal.most(self.listed.now.len()).is_none_or(within)
    }

    /// Splits a vertex with the splits that it forces, merging lower diamonds and those that become idle; returns `false`
    /// and changes nothing where these make too little room.
    fn trade(&mut self, criterion: &impl Criterion, priority: u64, vertex: Vertex) -> bool {
        self.forced.clear();
        list_forced(&self.active, vertex, &mut self.forced);
        let each = self.forced.iter().map(|&vertex| self.drawn.added(&self.listed, vertex));
        let needed = each.fold(Count::default(), Count::add);
        self.undo.clear();
        let fits = loop {
            let lowest = self.lowest_diamond();
            if self.has_room(needed) && !lowest.is_some_and(|(lowest, _)| self.is_idle(lowest)) {
                break true;
            }
            match lowest {
                Some((lowest, diamond)) if excess_of(lowest) < excess_of(priority) => {
                    if self.is_needed(diamond) {
                        self.merges.pop();
                        self.aside.push(Reverse(lowest));
                    } else {
                        self.undo.push((diamond, lowest));
                        self.merge_lowest(criterion, diamond);
                    }
                }
                _ => break false,
            }
        };
        self.merges.extend(self.aside.drain(..));
        if fits {
            self.split_forced(criterion)
        } else {
            self.undo_merges()
        }
        fits
    }

    /// Whether a vertex of the forced split has `diamond` for a parent.
    fn is_needed(&self, diamond: Vertex) -> bool {
        self.forced.iter().any(|vertex| vertex.parents().contains(&diamond))
    }

    /// Activates the vertices of the forced split, parents before children.
    fn split_forced(&mut self, criterion: &impl Criterion) {
        let layout = *self.active.layout();
        for place in 0..self.forced.len() {
            let vertex = self.forced[place];
            self.active.activate(vertex);
            self.tally.split(&layout, vertex);
            self.count = self.count + self.drawn.added(&self.listed, vertex);
            for child in layout.children(vertex) {
                self.offer_split(criterion, child);
            }
            self.offer_merge(criterion, vertex);
        }
    }

    /// Undoes the merges of a trade that found no room.
    fn undo_merges(&mut self) {
        while let Some((vertex, priority)) = self.undo.pop() {
            self.active.activate(vertex);
            self.tally.undo_merge();
            self.count = self.count + self.drawn.added(&self.listed, vertex);
            self.mergeable.insert(self.active.layout(), vertex);
            self.merges.push(Reverse(priority));
        }
    }

    /// Merges the diamond that [`Queues::lowest_diamond`] returned last.
    fn merge_lowest(&mut self, criterion: &impl Criterion, diamond: Vertex) {
        self.merges.pop();
        self.active.merge(diamond);
        self.tally.merge(self.active.layout(), diamond);
        self.count = self.count - self.drawn.added(&self.listed, diamond);
        self.offer_split(criterion, diamond);
        for parent in diamond.parents() {
            self.offer_merge(criterion, parent);
        }
    }

    fn offer_split(&mut self, criterion: &impl Criterion, vertex: Vertex) {
        if !is_splittable(&self.active, &self.listed, vertex) {
            return;
        }
        let layout = self.active.layout();
        self.splittable.insert(layout, vertex);
        let excess = self.evaluation(criterion).priority(vertex);
        if excess > self.goal.floor() {
            self.splits.push(entry(excess, layout.index(vertex)));
        }
    }

    fn offer_merge(&mut self, criterion: &impl Criterion, vertex: Vertex) {
        if !self.active.is_mergeable(vertex) {
            return;
        }
        let layout = self.active.layout();
        self.mergeable.insert(layout, vertex);
        let excess = self.evaluation(criterion).diamond_priority(layout, vertex);
        self.merges.push(Reverse(entry(excess, layout.index(vertex))));
    }

    /// Takes the best split off its queue.
    fn next_split(&mut self) -> Option<(u64, Vertex)> {
        while let Some(best) = self.splits.pop() {
            let vertex = vertex_of(self.active.layout(), best);
            if is_splittable(&self.active, &self.listed, vertex) {
                return Some((best, vertex));
            }
        }
        None
    }

    /// The lowest diamond, left on its queue; stale entries above it are dropped.
    fn lowest_diamond(&mut self) -> Option<(u64, Vertex)> {
        while let Some(&Reverse(lowest)) = self.merges.peek() {
            let vertex = vertex_of(self.active.layout(), lowest);
            if self.active.is_mergeable(vertex) {
                return Some((lowest, vertex));
            }
            self.merges.pop();
        }
        None
    }

    /// Checks that the bits are closed under parents, that the triangles are as many as counted, and that both queues hold
    /// all vertices that could be split or merged.
    ///
    /// # Panics
    /// Where they do not.
    pub fn check(&self) {
        self.active.check();
        let layout = self.active.layout();
        let each = self.listed.now.iter().map(|&corner| count(&self.active, &self.drawn, corner));
        assert_eq!(each.fold(Count::default(), Count::add), self.count, "the triangles and their count");
        for (index, vertex) in layout.vertices().enumerate().filter(|&(_, at)| !layout.is_corner(at)) {
            let is_missing = self.active.is_mergeable(vertex) && !self.mergeable.contains(index);
            assert!(!is_missing, "{vertex:?} could be merged and is not in the queue");
            let is_missing =
                is_splittable(&self.active, &self.listed, vertex) && !self.splittable.contains(index);
            assert!(!is_missing, "{vertex:?} could be split and is not in the queue");
        }
    }
}

/// What a priority depends on.
struct QueueEvaluation<'a, C> {
    goal: Goal,
    drawn: &'a Drawn<'a>,
    listed: &'a ListedPatches,
    criterion: &'a C,
}

impl<C: Criterion> QueueEvaluation<'_, C> {
    /// The excess of a vertex; under a budget 0 where splitting it can never draw anything. Where rounding leaves open on
    /// which side of 1 it lies, [`Criterion::wants`] decides, so that this refiner wants what the others want.
    fn priority(&self, vertex: Vertex) -> f32 {
        if matches!(self.goal, Goal::Budget(_)) && !self.drawn.shows(self.listed, vertex) {
            return 0.0;
        }
        let excess = self.criterion.excess(vertex);
        match (excess - 1.0).abs() < 1e-4 {
            true if self.criterion.wants(vertex) => excess.max(1f32.next_up()),
            true => excess.min(1.0),
            false => excess,
        }
    }

    /// The priority of an active vertex; 0 where none of its triangles lies in a listed patch.
    fn diamond_priority(&self, layout: &PatchLayout, vertex: Vertex) -> f32 {
        let is_listed = self.listed.apexes(layout, vertex).next().is_some();
        if is_listed { self.priority(vertex) } else { 0.0 }
    }
}

/// A queue's entry: the bits of an f32 that is not negative order as it does; the index settles ties.
fn entry(excess: f32, index: usize) -> u64 {
    u64::from(excess.to_bits()) << 32 | index as u64
}

fn excess_of(entry: u64) -> f32 {
    f32::from_bits((entry >> 32) as u32)
}

fn vertex_of(layout: &PatchLayout, entry: u64) -> Vertex {
    layout.vertex(entry as u32 as usize)
}

/// Whether `vertex` is inactive and splits a leaf of a listed patch.
fn is_splittable(active: &ActiveSet, listed: &ListedPatches, vertex: Vertex) -> bool {
    !active.is_active(vertex) && listed.apexes(active.layout(), vertex).any(|apex| active.is_active(apex))
}

/// Lists the inactive vertices that activating `vertex` activates, parents before children, each once.
fn list_forced(active: &ActiveSet, vertex: Vertex, forced: &mut Vec<Vertex>) {
    if !active.layout().contains(vertex) || active.is_active(vertex) || forced.contains(&vertex) {
        return;
    }
    for parent in vertex.parents() {
        list_forced(active, parent, forced);
    }
    forced.push(vertex);
}

/// The triangles of the patch with south-west corner `corner`.
fn count(active: &ActiveSet, drawn: &Drawn<'_>, corner: Vertex) -> Count {
    let mut sum = Count::default();
    for root in Triangle::roots(corner, active.layout().patch()) {
        visit_leaves(active, &root, &mut |leaf| sum = sum + drawn.leaf(corner, leaf));
    }
    sum
}

fn visit_leaves(active: &ActiveSet, triangle: &Triangle, visit: &mut impl FnMut(&Triangle)) {
    if triangle.is_finest() || !active.is_active(triangle.split_vertex()) {
        visit(triangle);
        return;
    }
    for half in triangle.split() {
        visit_leaves(active, &half, visit);
    }
}
