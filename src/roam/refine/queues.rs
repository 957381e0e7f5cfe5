//! Two priority queues and an exact budget of drawn triangles: ROAM as Duchaineau et al. published it in 1997.
//!
//! The split queue holds the vertices that could be activated next, one for each leaf triangle or pair of them;
//! the merge queue those that could go next, the diamonds. A priority is the criterion's excess. While there are
//! too many triangles the lowest diamond is merged; while the best split promises more than the lowest diamond
//! holds, one is traded for the other. A split is weighed with everything it forces: where lower diamonds cannot
//! make room for all of it, nothing is changed and the next one is tried.
//!
//! Priorities are asked anew each frame, as in the paper without its deferral, so a frame costs a question for
//! every leaf and every diamond however little changes; only members of the queues are kept. Queues are binary
//! heaps of (priority, vertex index), which settles ties the same way every time.
//!
//! Two ways out of the published loop's known trouble, a budget that the view cannot use: what cannot be seen or
//! has no error is never split for the budget's sake, and what has become so is merged at once.
//!
//! The budget is one of triangles that are drawn. Those over no data and beyond the border cost nothing, though
//! what they are split into may; where no split ever draws anything, none is made for the budget's sake. A merge
//! may then draw more than it takes away, at the edge of a hole: each trade is weighed with all its merges, down
//! to those that have become idle, so that every trade leaves a better mesh and the loop ends.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use crate::roam::active::ActiveSet;
use crate::roam::bintree::Triangle;
use crate::roam::criterion::Criterion;
use crate::roam::graph::Vertex;
use crate::roam::layout::PatchLayout;
use crate::roam::patched_ground::PatchedGround;
use crate::roam::refine::changes::{ChangeTally, RefinementChanges};
use crate::roam::refine::drawn::{Count, Drawn};
use crate::roam::refine::listed::ListedPatches;
use crate::roam::refine::members::VertexSet;

/// So many splits in turn may find no room before an update is content. What is left over is a triangle or two
/// of the budget; trying every other leaf for them would cost more than the whole frame.
const MOST_REFUSALS: usize = 32;

/// So many leaf triangles, drawn or not, there are at most for each drawn one of the budget, the roots of listed
/// patches not counted: the edges of holes may not take all the time, however long they are.
pub const MOST_LEAVES: usize = 8;

/// What the queues work toward.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Goal {
    /// Every vertex that the criterion wants, however many triangles that takes. Where no vertex's excess is above
    /// its parents', the mesh is that of [`rebuild`](crate::roam::refine::rebuild::rebuild).
    Tolerance,
    /// As fine as so many drawn triangles allow, below the tolerance too.
    Budget(usize),
    /// Every vertex that the criterion wants, but at most so many drawn triangles.
    ToleranceWithin(usize),
}

impl Goal {
    /// The most triangles in so many listed patches; none where there is no limit.
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

    /// A vertex is split for its own sake only above this excess, and merged as soon as it may be at or below it.
    fn floor(self) -> f32 {
        match self {
            Self::Budget(_) => 0.0,
            Self::Tolerance | Self::ToleranceWithin(_) => 1.0,
        }
    }

    /// The excess of a vertex; under a budget 0 where splitting it can never draw anything. Where rounding leaves
    /// open on which side of 1 it is, the criterion's plain answer settles it, so that this refiner wants what the
    /// others want.
    fn priority(
        self,
        drawn: &Drawn<'_>,
        listed: &ListedPatches,
        criterion: &impl Criterion,
        vertex: Vertex,
    ) -> f32 {
        if matches!(self, Self::Budget(_)) && !drawn.shows(listed, vertex) {
            return 0.0;
        }
        let excess = criterion.excess(vertex);
        match (excess - 1.0).abs() < 1e-4 {
            true if criterion.wants(vertex) => excess.max(1f32.next_up()),
            true => excess.min(1.0),
            false => excess,
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
    /// The roots of all patches of a ground, whose heights say what is drawn.
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

    /// The bits.
    pub fn active(&self) -> &ActiveSet {
        &self.active
    }

    /// How many triangles of the listed patches are drawn: the leaves that have an area and data at their corners.
    /// Never above the budget, but for the two roots of every listed patch: these are always there.
    pub fn triangles(&self) -> usize {
        self.count.drawn as usize
    }

    /// How many leaf triangles the listed patches have, those beyond the lattice's border or over no data included.
    /// Never above [`MOST_LEAVES`] times the budget and two for every listed patch.
    pub fn leaves(&self) -> usize {
        self.count.leaves as usize
    }

    /// Adjusts the mesh to a view; `patches` are the south-west corners of patches of the layout. A vertex
    /// that is merged and then forced to return counts both ways, and its patches are dirty.
    pub fn update(&mut self, criterion: &impl Criterion, patches: &[Vertex]) -> RefinementChanges {
        let layout = *self.active.layout();
        self.listed.renew(&layout, patches);
        self.recount(&layout);
        self.gather(criterion);
        self.merge_what_must_go(criterion);
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

    /// Counts the triangles of patches that came and went, and takes in the leaves of those that came.
    fn recount(&mut self, layout: &PatchLayout) {
        for &corner in self.listed.left() {
            self.count = self.count.minus(count(&self.active, &self.drawn, corner));
        }
        for &corner in self.listed.entered() {
            self.count = self.count.plus(count(&self.active, &self.drawn, corner));
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
        let (goal, active, drawn, listed) = (self.goal, &self.active, &self.drawn, &self.listed);
        let mut splits = std::mem::take(&mut self.splits).into_vec();
        splits.clear();
        self.splittable.retain(active.layout(), |vertex, index| {
            let leaf = !active.is_active(vertex) && has_leaf(active, listed, vertex);
            let excess = if leaf { goal.priority(drawn, listed, criterion, vertex) } else { 0.0 };
            if excess > goal.floor() {
                splits.push(entry(excess, index));
            }
            leaf
        });
        self.splits = BinaryHeap::from(splits);

        let mut merges = std::mem::take(&mut self.merges).into_vec();
        merges.clear();
        let capped = goal != Goal::Tolerance;
        self.mergeable.retain(active.layout(), |vertex, index| {
            let free = active.is_mergeable(vertex);
            if free {
                let shown = listed_apexes(active.layout(), listed, vertex).next().is_some();
                let excess = if shown { goal.priority(drawn, listed, criterion, vertex) } else { 0.0 };
                if capped || excess <= goal.floor() {
                    merges.push(Reverse(entry(excess, index)));
                }
            }
            free
        });
        self.merges = BinaryHeap::from(merges);
    }

    /// Merges what is idle, and whatever is lowest until the budget holds or only roots are left.
    fn merge_what_must_go(&mut self, criterion: &impl Criterion) {
        while let Some((priority, vertex)) = self.lowest_diamond() {
            if !self.is_idle(priority) && self.has_room(Count::default()) {
                break;
            }
            self.merge_lowest(criterion, vertex);
        }
    }

    /// Whether a diamond of this priority goes without another's need.
    fn is_idle(&self, priority: u64) -> bool {
        excess_of(priority) <= self.goal.floor()
    }

    /// Whether so many triangles more are within the budget.
    fn has_room(&self, more: Count) -> bool {
        let after = self.count.plus(more);
        let within = |most: Count| after.drawn <= most.drawn && after.leaves <= most.leaves;
        self.goal.most(self.listed.now().len()).is_none_or(within)
    }

    /// Splits a vertex with what that forces, merging lower diamonds to make room; changes nothing and says
    /// `false` where they make too little. What becomes idle by these merges goes with them.
    fn trade(&mut self, criterion: &impl Criterion, priority: u64, vertex: Vertex) -> bool {
        self.forced.clear();
        list_forced(&self.active, vertex, &mut self.forced);
        let layout = *self.active.layout();
        let each = self.forced.iter().map(|&vertex| self.drawn.added(&self.listed, vertex));
        let needed = each.fold(Count::default(), Count::plus);
        self.undo.clear();
        let mut fits = true;
        loop {
            let lowest = self.lowest_diamond();
            if self.has_room(needed) && !lowest.is_some_and(|(lowest, _)| self.is_idle(lowest)) {
                break;
            }
            match lowest {
                Some((lowest, _)) if excess_of(lowest) >= excess_of(priority) => fits = false,
                Some((lowest, diamond)) if self.is_needed(diamond) => {
                    self.merges.pop();
                    self.aside.push(Reverse(lowest));
                    continue;
                }
                Some((lowest, diamond)) => {
                    self.undo.push((diamond, lowest));
                    self.merge_lowest(criterion, diamond);
                    continue;
                }
                None => fits = false,
            }
            break;
        }
        self.merges.extend(self.aside.drain(..));
        if fits {
            self.split_forced(criterion)
        } else {
            self.take_back(&layout)
        }
        fits
    }

    /// Whether a vertex of the forced split has `diamond` for a parent.
    fn is_needed(&self, diamond: Vertex) -> bool {
        self.forced.iter().any(|vertex| vertex.parents().contains(&diamond))
    }

    /// Activates the vertices of the forced split, parents before their children.
    fn split_forced(&mut self, criterion: &impl Criterion) {
        let layout = *self.active.layout();
        for place in 0..self.forced.len() {
            let vertex = self.forced[place];
            self.active.activate(vertex);
            self.tally.split(&layout, vertex);
            self.count = self.count.plus(self.drawn.added(&self.listed, vertex));
            for child in vertex.children().filter(|&child| layout.contains(child)) {
                self.offer_split(criterion, child);
            }
            self.offer_merge(criterion, vertex);
        }
    }

    /// Undoes the merges of a trade that found no room.
    fn take_back(&mut self, layout: &PatchLayout) {
        while let Some((vertex, priority)) = self.undo.pop() {
            self.active.activate(vertex);
            self.tally.take_back_merge();
            self.count = self.count.plus(self.drawn.added(&self.listed, vertex));
            self.mergeable.insert(layout, vertex);
            self.merges.push(Reverse(priority));
        }
    }

    /// Merges the diamond that [`Queues::lowest_diamond`] has just found.
    fn merge_lowest(&mut self, criterion: &impl Criterion, diamond: Vertex) {
        let layout = *self.active.layout();
        self.merges.pop();
        self.active.merge(diamond);
        self.tally.merge(&layout, diamond);
        self.count = self.count.minus(self.drawn.added(&self.listed, diamond));
        self.offer_split(criterion, diamond);
        for parent in diamond.parents() {
            self.offer_merge(criterion, parent);
        }
    }

    fn offer_split(&mut self, criterion: &impl Criterion, vertex: Vertex) {
        if self.active.is_active(vertex) || !has_leaf(&self.active, &self.listed, vertex) {
            return;
        }
        let layout = self.active.layout();
        self.splittable.insert(layout, vertex);
        let excess = self.goal.priority(&self.drawn, &self.listed, criterion, vertex);
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
        let shown = listed_apexes(layout, &self.listed, vertex).next().is_some();
        let excess =
            if shown { self.goal.priority(&self.drawn, &self.listed, criterion, vertex) } else { 0.0 };
        self.merges.push(Reverse(entry(excess, layout.index(vertex))));
    }

    /// The best split, taken off its queue.
    fn next_split(&mut self) -> Option<(u64, Vertex)> {
        while let Some(found) = self.splits.pop() {
            let vertex = vertex_of(self.active.layout(), found);
            if !self.active.is_active(vertex) && has_leaf(&self.active, &self.listed, vertex) {
                return Some((found, vertex));
            }
        }
        None
    }

    /// The lowest diamond, left on its queue; entries above it that no longer hold are dropped.
    fn lowest_diamond(&mut self) -> Option<(u64, Vertex)> {
        while let Some(&Reverse(found)) = self.merges.peek() {
            let vertex = vertex_of(self.active.layout(), found);
            if self.active.is_mergeable(vertex) {
                return Some((found, vertex));
            }
            self.merges.pop();
        }
        None
    }

    /// Whether the bits are closed under parents, the triangles are as many as counted, and both queues hold
    /// whatever could be split or merged.
    ///
    /// # Errors
    /// A sentence naming the first thing that is wrong.
    pub fn check(&self) -> Result<(), String> {
        self.active.check()?;
        let layout = self.active.layout();
        let each = self.listed.now().iter().map(|&corner| count(&self.active, &self.drawn, corner));
        let there = each.fold(Count::default(), Count::plus);
        if there != self.count {
            return Err(format!("{:?} is counted, {there:?} is there", self.count));
        }
        for index in 0..layout.vertex_count() {
            let vertex = Vertex::new((index % layout.columns()) as i32, (index / layout.columns()) as i32);
            if layout.is_corner(vertex) {
                continue;
            }
            if self.active.is_mergeable(vertex) && !self.mergeable.holds(index) {
                return Err(format!("{vertex:?} could be merged and is not in the queue"));
            }
            let leaf = !self.active.is_active(vertex) && has_leaf(&self.active, &self.listed, vertex);
            if leaf && !self.splittable.holds(index) {
                return Err(format!("{vertex:?} could be split and is not in the queue"));
            }
        }
        Ok(())
    }
}

/// A queue's entry: the bits of an f32 that is 0 or more order as it does; the index settles ties.
fn entry(excess: f32, index: usize) -> u64 {
    u64::from(excess.to_bits()) << 32 | index as u64
}

fn excess_of(entry: u64) -> f32 {
    f32::from_bits((entry >> 32) as u32)
}

fn vertex_of(layout: &PatchLayout, entry: u64) -> Vertex {
    let index = entry as u32 as usize;
    Vertex::new((index % layout.columns()) as i32, (index / layout.columns()) as i32)
}

/// The right-angled corners of the triangles that `vertex` splits in listed patches.
fn listed_apexes(
    layout: &PatchLayout,
    listed: &ListedPatches,
    vertex: Vertex,
) -> impl Iterator<Item = Vertex> {
    let inside =
        move |&apex: &Vertex| layout.contains(apex) && listed.holds(layout.patch_holding(vertex, apex));
    vertex.parents().into_iter().filter(inside)
}

/// Whether one of the triangles that `vertex` would split is there, in a listed patch.
fn has_leaf(active: &ActiveSet, listed: &ListedPatches, vertex: Vertex) -> bool {
    listed_apexes(active.layout(), listed, vertex).any(|apex| active.is_active(apex))
}

/// Lists the inactive vertices that activating `vertex` activates, parents before their children, each once.
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
    let mut found = Count::default();
    for root in Triangle::roots(corner, active.layout().patch()) {
        visit_leaves(active, &root, &mut |leaf| found = found.plus(drawn.leaf(corner, leaf)));
    }
    found
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
