//! Last frame's mesh adjusted by forced splits and forced merges, without queues (patch-based ROAM, Lin et al.).
//!
//! A triangle is *visited* if it is a root of a listed patch, or a half of a visited triangle whose split vertex is wanted.
//! Every vertex with a visited triangle is kept in a list with the criterion's last answer. Each frame evaluates the
//! criterion once for each, and acts only where the answer changes:
//!
//! - newly wanted: the vertex is activated, its inactive parents first (forced split), and the halves are visited;
//! - no longer wanted: everything below that was visited only through it is left (forced merge). A vertex that no visited
//!   triangle wants and that has no active child is deactivated; its parents are then examined in turn, since they may have
//!   been active for it alone.
//!
//! So a vertex is active exactly when a visited triangle wants it or one of its descendants: the mesh equals that of
//! [`rebuild`](crate::refine::rebuild::rebuild) for the same criterion and patches, bit for bit, whatever the
//! criterion and the frames before. Two bits a vertex say which of its triangles are visited; one would not do, since with
//! a criterion that is not monotone one of them can exist by force alone.
//!
//! Lin et al. walk last frame's triangles from the roots. The list evaluates each vertex once, where a walk meets it from
//! both of its triangles.
//!
//! Costs one evaluation per vertex that is or could be split, and splits and merges only where the mesh changes.

use crate::active::ActiveSet;
use crate::bintree::Triangle;
use crate::criterion::Criterion;
use crate::graph::Vertex;
use crate::layout::PatchLayout;
use crate::refine::changes::{ChangeTally, RefinementChanges};
use crate::refine::listed::ListedPatches;

/// The treatment of a patch that is no longer listed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Hidden {
    /// It is merged as far as its neighbors allow: the mesh is that of a rebuild, and a patch out of view costs nothing.
    #[default]
    Forget,
    /// It stays as it was last seen and is adjusted when it is listed again, as Lin et al. publish it: turning back and
    /// forth costs no splits. The mesh is finer than a rebuild's where unlisted patches force their neighbors.
    Keep,
}

/// The bits of [`Vertex::side_bit`]: which of the vertex's triangles are visited.
const VISITED: u8 = 3;
/// The last answer was yes; never set where neither triangle is visited.
const WANTED: u8 = 4;
/// The vertex is in the list.
const KNOWN: u8 = 8;

/// A mesh that follows the view by splits and merges.
#[derive(Clone, Debug)]
pub struct Coherent {
    active: ActiveSet,
    states: Vec<u8>,
    known: Vec<Vertex>,
    listed: ListedPatches,
    hidden: Hidden,
    tally: ChangeTally,
    newly_wanted: Vec<Vertex>,
    newly_unwanted: Vec<Vertex>,
    fresh: Vec<Vertex>,
    released: Vec<Vertex>,
}

impl Coherent {
    /// The roots of all patches, with [`Hidden::Forget`].
    pub fn new(layout: PatchLayout) -> Self {
        Self::with_hidden(layout, Hidden::default())
    }

    /// The roots of all patches.
    pub fn with_hidden(layout: PatchLayout, hidden: Hidden) -> Self {
        let [known, newly_wanted, newly_unwanted, fresh, released] = [const { Vec::new() }; 5];
        Self {
            active: ActiveSet::new(layout),
            states: vec![0; layout.vertex_count()],
            known,
            listed: ListedPatches::new(&layout),
            hidden,
            tally: ChangeTally::new(&layout),
            newly_wanted,
            newly_unwanted,
            fresh,
            released,
        }
    }

    /// The active vertices.
    pub fn active(&self) -> &ActiveSet {
        &self.active
    }

    /// Adjusts the mesh to a view; `patches` are the south-west corners of patches of the layout.
    pub fn update(&mut self, criterion: &impl Criterion, patches: &[Vertex]) -> RefinementChanges {
        let layout = *self.active.layout();
        self.listed.renew(&layout, patches);
        if self.hidden == Hidden::Forget {
            for place in 0..self.listed.left.len() {
                for root in Triangle::roots(self.listed.left[place], layout.patch()) {
                    self.leave(&layout, root.split_vertex(), root.split_vertex().side_bit(root.apex));
                }
            }
        }
        self.evaluate_known(&layout, criterion);
        while let Some(vertex) = self.newly_unwanted.pop() {
            self.unwant(&layout, vertex);
        }
        while let Some(vertex) = self.newly_wanted.pop() {
            self.want(&layout, vertex);
        }
        for place in 0..self.listed.entered.len() {
            for root in Triangle::roots(self.listed.entered[place], layout.patch()) {
                self.visit(&layout, root.split_vertex(), root.split_vertex().side_bit(root.apex));
            }
        }
        while let Some(vertex) = self.fresh.pop() {
            if criterion.wants(vertex) {
                self.want(&layout, vertex);
            }
        }
        self.release(&layout);
        self.tally.take()
    }

    /// Evaluates every vertex with a visited triangle, collects those whose answer changed, and drops the other vertices
    /// from the list.
    fn evaluate_known(&mut self, layout: &PatchLayout, criterion: &impl Criterion) {
        let (states, listed, keeps) = (&mut self.states, &self.listed, self.hidden == Hidden::Keep);
        let (wanted, unwanted) = (&mut self.newly_wanted, &mut self.newly_unwanted);
        self.known.retain(|&vertex| {
            let state = &mut states[layout.index(vertex)];
            if *state & VISITED == 0 {
                *state = 0;
                return false;
            }
            if !keeps || listed.apexes(layout, vertex).next().is_some() {
                match (criterion.wants(vertex), *state & WANTED != 0) {
                    (true, false) => wanted.push(vertex),
                    (false, true) => unwanted.push(vertex),
                    _ => {}
                }
            }
            true
        });
    }

    /// Activates the vertex of a visited triangle and visits the halves.
    fn want(&mut self, layout: &PatchLayout, vertex: Vertex) {
        let state = &mut self.states[layout.index(vertex)];
        if *state & WANTED != 0 || *state & VISITED == 0 {
            return;
        }
        *state |= WANTED;
        let visited = *state;
        let tally = &mut self.tally;
        self.active.activate_each(vertex, &mut |vertex| tally.split(layout, vertex));
        for half in halves(vertex, visited) {
            self.visit(layout, half, half.side_bit(vertex));
        }
    }

    /// Visits the triangle on one side of a vertex.
    fn visit(&mut self, layout: &PatchLayout, vertex: Vertex, side: u8) {
        let state = &mut self.states[layout.index(vertex)];
        let before = *state;
        *state |= side | KNOWN;
        if before & KNOWN == 0 {
            self.known.push(vertex);
        }
        if before & VISITED == 0 {
            self.fresh.push(vertex);
        } else if before & WANTED != 0 && before & side == 0 {
            for half in halves(vertex, side) {
                self.visit(layout, half, half.side_bit(vertex));
            }
        }
    }

    /// Leaves what was visited through a vertex that is no longer wanted.
    fn unwant(&mut self, layout: &PatchLayout, vertex: Vertex) {
        let state = &mut self.states[layout.index(vertex)];
        if *state & WANTED == 0 {
            return;
        }
        *state &= !WANTED;
        let visited = *state;
        self.released.push(vertex);
        for half in halves(vertex, visited) {
            self.leave(layout, half, half.side_bit(vertex));
        }
    }

    /// Leaves the triangle on one side of a vertex.
    fn leave(&mut self, layout: &PatchLayout, vertex: Vertex, side: u8) {
        let state = &mut self.states[layout.index(vertex)];
        let before = *state;
        *state &= !side;
        if before & side == 0 || before & WANTED == 0 {
            return;
        }
        if *state & VISITED == 0 {
            *state &= !WANTED;
            self.released.push(vertex);
        }
        for half in halves(vertex, side) {
            self.leave(layout, half, half.side_bit(vertex));
        }
    }

    /// Deactivates the released vertices that no visited triangle wants and no active child needs.
    fn release(&mut self, layout: &PatchLayout) {
        while let Some(vertex) = self.released.pop() {
            let free = layout.contains(vertex) && self.states[layout.index(vertex)] & WANTED == 0;
            if free && self.active.merge(vertex) {
                self.tally.merge(layout, vertex);
                self.released.extend(vertex.parents());
            }
        }
    }

    /// Checks that the bits are closed under parents, that every active vertex is wanted or has an active child, and that
    /// every vertex with a visited triangle is known.
    ///
    /// # Panics
    /// Where they are not.
    pub fn check(&self) {
        self.active.check();
        for (vertex, &state) in self.active.layout().vertices().zip(&self.states) {
            let (is_wanted, is_visited) = (state & WANTED != 0, state & VISITED != 0);
            assert!(!is_wanted || self.active.is_active(vertex), "{vertex:?} is wanted and not active");
            let is_needless = !is_wanted && self.active.is_mergeable(vertex);
            assert!(!is_needless, "{vertex:?} is active, and nothing needs it");
            let is_sound = if is_visited { state & KNOWN != 0 } else { !is_wanted };
            assert!(is_sound, "{vertex:?} has the impossible state {state:#b}");
        }
    }
}

/// The vertices that split the halves of those triangles at `vertex` whose bits are set in `sides`.
fn halves(vertex: Vertex, sides: u8) -> impl Iterator<Item = Vertex> {
    let ends = vertex.hypotenuse();
    let split = if vertex.has_children() { sides } else { 0 };
    let apexes = vertex.parents().into_iter().filter(move |&apex| split & vertex.side_bit(apex) != 0);
    apexes.flat_map(move |apex| ends.map(|end| apex.middle(end)))
}
