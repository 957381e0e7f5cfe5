//! Two priority queues and an exact budget of triangles: ROAM as Duchaineau et al. published it in 1997.
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

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use crate::roam::active::ActiveSet;
use crate::roam::bintree::Triangle;
use crate::roam::criterion::Criterion;
use crate::roam::graph::Vertex;
use crate::roam::layout::Layout;
use crate::roam::refine::changes::{Changes, Tally};
use crate::roam::refine::listed::Listed;
use crate::roam::refine::members::Members;

/// So many splits in turn may find no room before an update is content. What is left over is a triangle or two
/// of the budget; trying every other leaf for them would cost more than the whole frame.
const MOST_REFUSALS: usize = 32;

/// What the queues work towards.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Goal {
    /// Every vertex that the criterion wants, however many triangles that takes. Where no vertex's excess is above
    /// its parents', the mesh is that of [`rebuild`](crate::roam::refine::rebuild::rebuild).
    Tolerance,
    /// As fine as so many triangles allow, below the tolerance too.
    Budget(usize),
    /// Every vertex that the criterion wants, but at most so many triangles.
    ToleranceWithin(usize),
}

impl Goal {
    fn most_triangles(self) -> usize {
        match self {
            Self::Tolerance => usize::MAX,
            Self::Budget(most) | Self::ToleranceWithin(most) => most,
        }
    }

    /// A vertex is split for its own sake only above this excess, and merged as soon as it may be at or below it.
    fn floor(self) -> f32 {
        match self {
            Self::Budget(_) => 0.0,
            Self::Tolerance | Self::ToleranceWithin(_) => 1.0,
        }
    }
}

/// A mesh that follows the view by trading splits for merges.
#[derive(Clone, Debug)]
pub struct Queues {
    active: ActiveSet,
    goal: Goal,
    listed: Listed,
    tally: Tally,
    triangles: usize,
    splittable: Members,
    mergeable: Members,
    splits: BinaryHeap<u64>,
    merges: BinaryHeap<Reverse<u64>>,
    forced: Vec<Vertex>,
    undo: Vec<(Vertex, u64)>,
    aside: Vec<Reverse<u64>>,
}

impl Queues {
    /// The roots of all patches.
    pub fn new(layout: Layout, goal: Goal) -> Self {
        Self {
            active: ActiveSet::new(layout),
            goal,
            listed: Listed::new(&layout),
            tally: Tally::new(&layout),
            triangles: 0,
            splittable: Members::new(&layout),
            mergeable: Members::new(&layout),
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

    /// How many leaf triangles the listed patches have, those beyond the lattice's border or over no data
    /// included. Never above the budget, but for the two roots of every listed patch: these are always there.
    pub fn triangles(&self) -> usize {
        self.triangles
    }

    /// Adjusts the mesh to a view; `patches` are the south-west corners of patches of the layout. A vertex
    /// that is merged and then forced to return counts both ways, and its patches are dirty.
    pub fn update(&mut self, criterion: &impl Criterion, patches: &[Vertex]) -> Changes {
        let layout = *self.active.layout();
        self.listed.renew(&layout, patches);
        self.recount(&layout);
        self.gather(criterion);
        let mut refusals = 0;
        loop {
            self.merge_the_idle(criterion);
            self.merge_down_to_the_budget(criterion);
            let Some((priority, vertex)) = self.next_split() else { break };
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
    fn recount(&mut self, layout: &Layout) {
        for (patches, came) in [(self.listed.left(), false), (self.listed.entered(), true)] {
            for root in patches.iter().flat_map(|&corner| Triangle::roots(corner, layout.patch())) {
                let mut leaves = 0;
                visit_leaves(&self.active, &root, &mut |leaf| {
                    leaves += 1;
                    if came && !leaf.is_finest() {
                        self.splittable.insert(layout, leaf.split_vertex());
                    }
                });
                self.triangles = if came { self.triangles + leaves } else { self.triangles - leaves };
            }
        }
    }

    /// Fills both queues with this frame's priorities.
    fn gather(&mut self, criterion: &impl Criterion) {
        let (goal, active, listed) = (self.goal, &self.active, &self.listed);
        let mut splits = std::mem::take(&mut self.splits).into_vec();
        splits.clear();
        self.splittable.retain(active.layout(), |vertex, index| {
            let leaf = !active.is_active(vertex) && has_leaf(active, listed, vertex);
            let excess = if leaf { priority(criterion, vertex) } else { 0.0 };
            if excess > goal.floor() {
                splits.push(entry(excess, index));
            }
            leaf
        });
        self.splits = BinaryHeap::from(splits);

        let mut merges = std::mem::take(&mut self.merges).into_vec();
        merges.clear();
        let capped = goal.most_triangles() < usize::MAX;
        self.mergeable.retain(active.layout(), |vertex, index| {
            let free = active.is_mergeable(vertex);
            if free {
                let excess = excess_where_listed(active.layout(), listed, criterion, vertex);
                if capped || excess <= goal.floor() {
                    merges.push(Reverse(entry(excess, index)));
                }
            }
            free
        });
        self.merges = BinaryHeap::from(merges);
    }

    fn merge_the_idle(&mut self, criterion: &impl Criterion) {
        while let Some((priority, vertex)) = self.lowest_diamond() {
            if excess_of(priority) > self.goal.floor() {
                break;
            }
            self.merge_lowest(criterion, vertex);
        }
    }

    /// Merges whatever is lowest until the budget holds, or only roots are left.
    fn merge_down_to_the_budget(&mut self, criterion: &impl Criterion) {
        while self.triangles > self.goal.most_triangles() {
            let Some((_, vertex)) = self.lowest_diamond() else { break };
            self.merge_lowest(criterion, vertex);
        }
    }

    /// Splits a vertex with what that forces, merging lower diamonds to make room; changes nothing and says
    /// `false` where they make too little.
    fn trade(&mut self, criterion: &impl Criterion, priority: u64, vertex: Vertex) -> bool {
        self.forced.clear();
        list_forced(&self.active, vertex, &mut self.forced);
        let layout = *self.active.layout();
        let needed: usize = self.forced.iter().map(|&vertex| added(&layout, &self.listed, vertex)).sum();
        self.undo.clear();
        let mut fits = true;
        while self.triangles + needed > self.goal.most_triangles() {
            match self.lowest_diamond() {
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
            self.triangles += added(&layout, &self.listed, vertex);
            for child in vertex.children().filter(|&child| layout.contains(child)) {
                self.offer_split(criterion, child);
            }
            self.offer_merge(criterion, vertex);
        }
    }

    /// Undoes the merges of a trade that found no room.
    fn take_back(&mut self, layout: &Layout) {
        while let Some((vertex, priority)) = self.undo.pop() {
            self.active.activate(vertex);
            self.tally.take_back_merge();
            self.triangles += added(layout, &self.listed, vertex);
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
        self.triangles -= added(&layout, &self.listed, diamond);
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
        let excess = priority(criterion, vertex);
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
        let excess = excess_where_listed(layout, &self.listed, criterion, vertex);
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
        let mut triangles = 0;
        for root in self.listed.now().iter().flat_map(|&corner| Triangle::roots(corner, layout.patch())) {
            visit_leaves(&self.active, &root, &mut |_| triangles += 1);
        }
        if triangles != self.triangles {
            return Err(format!("{} triangles are counted, {triangles} are there", self.triangles));
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

fn vertex_of(layout: &Layout, entry: u64) -> Vertex {
    let index = entry as u32 as usize;
    Vertex::new((index % layout.columns()) as i32, (index / layout.columns()) as i32)
}

/// The right-angled corners of the triangles that `vertex` splits in listed patches.
fn listed_apexes(layout: &Layout, listed: &Listed, vertex: Vertex) -> impl Iterator<Item = Vertex> {
    let inside =
        move |&apex: &Vertex| layout.contains(apex) && listed.holds(layout.patch_holding(vertex, apex));
    vertex.parents().into_iter().filter(inside)
}

/// How many triangles more the listed patches have once `vertex` is active.
fn added(layout: &Layout, listed: &Listed, vertex: Vertex) -> usize {
    listed_apexes(layout, listed, vertex).count()
}

/// Whether one of the triangles that `vertex` would split is there, in a listed patch.
fn has_leaf(active: &ActiveSet, listed: &Listed, vertex: Vertex) -> bool {
    listed_apexes(active.layout(), listed, vertex).any(|apex| active.is_active(apex))
}

/// The excess of a vertex. Where rounding leaves open on which side of 1 it is, the criterion's plain answer
/// settles it, so that this refiner wants what the others want.
fn priority(criterion: &impl Criterion, vertex: Vertex) -> f32 {
    let excess = criterion.excess(vertex);
    match (excess - 1.0).abs() < 1e-4 {
        true if criterion.wants(vertex) => excess.max(1f32.next_up()),
        true => excess.min(1.0),
        false => excess,
    }
}

/// The excess of a vertex, 0 where it splits no triangle of a listed patch.
fn excess_where_listed(layout: &Layout, listed: &Listed, criterion: &impl Criterion, vertex: Vertex) -> f32 {
    if added(layout, listed, vertex) > 0 { priority(criterion, vertex) } else { 0.0 }
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

fn visit_leaves(active: &ActiveSet, triangle: &Triangle, visit: &mut impl FnMut(&Triangle)) {
    if triangle.is_finest() || !active.is_active(triangle.split_vertex()) {
        visit(triangle);
        return;
    }
    for half in triangle.split() {
        visit_leaves(active, &half, visit);
    }
}
