//! Last frame's mesh, adjusted by forced splits and forced merges: no queues (the patch-based ROAM of 000).
//!
//! A triangle is *visited* if it is a root of a listed patch, or the half of a visited triangle whose split vertex
//! is wanted. Every vertex with a visited triangle is kept in a list with the last answer; each frame asks all of
//! them once more, and only where an answer changes something happens:
//!
//! - newly wanted: the vertex is activated, its inactive parents first (forced split), and the halves are visited;
//! - no longer wanted: everything below that was visited only through it is left (forced merge). A vertex that is
//!   neither wanted by a visited triangle nor has an active child goes; its parents are then looked at in turn,
//!   since they may have been there for it alone.
//!
//! So a vertex is active exactly when a visited triangle wants it or one that descends from it: the mesh equals
//! that of [`rebuild`](crate::roam::refine::rebuild::rebuild) for the same criterion and patches, bit for bit,
//! whatever the criterion and whatever came before. Two bits a vertex say which of its triangles are visited; one
//! would not do, since without a monotone criterion one of them can be there by force alone.
//!
//! 000 walks last frame's triangles from the roots instead. The list asks each vertex once, where a walk meets it
//! from both of its triangles, and has no triangles to take apart on the way.
//!
//! Cost: one question a vertex that is or could be split, and splits and merges only where the mesh changes.

use crate::roam::active::ActiveSet;
use crate::roam::bintree::Triangle;
use crate::roam::criterion::Criterion;
use crate::roam::graph::Vertex;
use crate::roam::layout::PatchLayout;
use crate::roam::refine::changes::{ChangeTally, RefinementChanges};
use crate::roam::refine::listed::ListedPatches;

/// What becomes of a patch that is no longer listed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Hidden {
    /// It is merged as far as its neighbors allow: the mesh is that of a rebuild, and a patch costs nothing once
    /// it is out of view.
    #[default]
    Forget,
    /// It stays as it was last seen and is adjusted when it is listed again, as 000 has it: turning back and
    /// forth costs no splits. The mesh is finer than a rebuild's where unlisted patches force their neighbors.
    Keep,
}

/// The triangle on the side of the smaller (y, x) is visited.
const BEFORE: u8 = 1;
/// The triangle on the other side is visited.
const AFTER: u8 = 2;
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
    taken_up: Vec<Vertex>,
    given_up: Vec<Vertex>,
    fresh: Vec<Vertex>,
    released: Vec<Vertex>,
}

impl Coherent {
    /// The roots of all patches, which are forgotten once they are no longer listed.
    pub fn new(layout: PatchLayout) -> Self {
        Self::with_hidden(layout, Hidden::default())
    }

    /// The roots of all patches.
    pub fn with_hidden(layout: PatchLayout, hidden: Hidden) -> Self {
        let empty = Vec::new;
        Self {
            active: ActiveSet::new(layout),
            states: vec![0; layout.vertex_count()],
            known: empty(),
            listed: ListedPatches::new(&layout),
            hidden,
            tally: ChangeTally::new(&layout),
            taken_up: empty(),
            given_up: empty(),
            fresh: empty(),
            released: empty(),
        }
    }

    /// The bits.
    pub fn active(&self) -> &ActiveSet {
        &self.active
    }

    /// Adjusts the mesh to a view; `patches` are the south-west corners of patches of the layout.
    pub fn update(&mut self, criterion: &impl Criterion, patches: &[Vertex]) -> RefinementChanges {
        let layout = *self.active.layout();
        self.listed.renew(&layout, patches);
        if self.hidden == Hidden::Forget {
            for place in 0..self.listed.left().len() {
                for root in Triangle::roots(self.listed.left()[place], layout.patch()) {
                    self.leave(&layout, root.split_vertex(), side(root.split_vertex(), root.apex));
                }
            }
        }
        self.ask_again(&layout, criterion);
        while let Some(vertex) = self.given_up.pop() {
            self.give_up(&layout, vertex);
        }
        while let Some(vertex) = self.taken_up.pop() {
            self.take_up(&layout, vertex);
        }
        for place in 0..self.listed.entered().len() {
            for root in Triangle::roots(self.listed.entered()[place], layout.patch()) {
                self.visit(&layout, root.split_vertex(), side(root.split_vertex(), root.apex));
            }
        }
        while let Some(vertex) = self.fresh.pop() {
            if criterion.wants(vertex) {
                self.take_up(&layout, vertex);
            }
        }
        self.release(&layout);
        self.tally.take()
    }

    /// Asks every vertex with a visited triangle again, notes where the answer is another, and strikes off the
    /// others.
    fn ask_again(&mut self, layout: &PatchLayout, criterion: &impl Criterion) {
        let (states, listed, keeps) = (&mut self.states, &self.listed, self.hidden == Hidden::Keep);
        let (taken_up, given_up) = (&mut self.taken_up, &mut self.given_up);
        self.known.retain(|&vertex| {
            let state = &mut states[layout.index(vertex)];
            if *state & (BEFORE | AFTER) == 0 {
                *state = 0;
                return false;
            }
            if !keeps || is_listed(layout, listed, vertex) {
                match (criterion.wants(vertex), *state & WANTED != 0) {
                    (true, false) => taken_up.push(vertex),
                    (false, true) => given_up.push(vertex),
                    _ => {}
                }
            }
            true
        });
    }

    /// A visited triangle's vertex is wanted: it is activated, the halves are visited.
    fn take_up(&mut self, layout: &PatchLayout, vertex: Vertex) {
        let state = &mut self.states[layout.index(vertex)];
        if *state & WANTED != 0 || *state & (BEFORE | AFTER) == 0 {
            return;
        }
        *state |= WANTED;
        let visited = *state;
        let tally = &mut self.tally;
        self.active.activate_each(vertex, &mut |vertex| tally.split(layout, vertex));
        for half in halves(vertex, visited) {
            self.visit(layout, half, side(half, vertex));
        }
    }

    /// The triangle on one side of a vertex is visited.
    fn visit(&mut self, layout: &PatchLayout, vertex: Vertex, side: u8) {
        let state = &mut self.states[layout.index(vertex)];
        let before = *state;
        *state |= side | KNOWN;
        if before & KNOWN == 0 {
            self.known.push(vertex);
        }
        if before & (BEFORE | AFTER) == 0 {
            self.fresh.push(vertex);
        } else if before & WANTED != 0 && before & side == 0 {
            for half in halves(vertex, side) {
                self.visit(layout, half, self::side(half, vertex));
            }
        }
    }

    /// A vertex is no longer wanted: what was visited through it is left.
    fn give_up(&mut self, layout: &PatchLayout, vertex: Vertex) {
        let state = &mut self.states[layout.index(vertex)];
        if *state & WANTED == 0 {
            return;
        }
        *state &= !WANTED;
        let visited = *state;
        self.released.push(vertex);
        for half in halves(vertex, visited) {
            self.leave(layout, half, side(half, vertex));
        }
    }

    /// The triangle on one side of a vertex is no longer visited.
    fn leave(&mut self, layout: &PatchLayout, vertex: Vertex, side: u8) {
        let state = &mut self.states[layout.index(vertex)];
        let before = *state;
        *state &= !side;
        if before & side == 0 || before & WANTED == 0 {
            return;
        }
        if *state & (BEFORE | AFTER) == 0 {
            *state &= !WANTED;
            self.released.push(vertex);
        }
        for half in halves(vertex, side) {
            self.leave(layout, half, self::side(half, vertex));
        }
    }

    /// Deactivates what no visited triangle wants and no active child needs.
    fn release(&mut self, layout: &PatchLayout) {
        while let Some(vertex) = self.released.pop() {
            let free = layout.contains(vertex) && self.states[layout.index(vertex)] & WANTED == 0;
            if free && self.active.merge(vertex) {
                self.tally.merge(layout, vertex);
                self.released.extend(vertex.parents());
            }
        }
    }

    /// Whether the bits are closed under parents, every active vertex is wanted or has an active child, and every
    /// vertex with a visited triangle is known.
    ///
    /// # Errors
    /// A sentence naming the first vertex that is wrong.
    pub fn check(&self) -> Result<(), String> {
        self.active.check()?;
        let layout = self.active.layout();
        for index in 0..layout.vertex_count() {
            let vertex = Vertex::new((index % layout.columns()) as i32, (index / layout.columns()) as i32);
            let (state, is_active) = (self.states[index], self.active.is_active(vertex));
            if state & WANTED != 0 && !is_active {
                return Err(format!("{vertex:?} is wanted and not active"));
            }
            if state & WANTED == 0 && self.active.is_mergeable(vertex) {
                return Err(format!("{vertex:?} is active, and nothing asks for it"));
            }
            let visited = state & (BEFORE | AFTER) != 0;
            if visited && state & KNOWN == 0 || !visited && state & WANTED != 0 {
                return Err(format!("{vertex:?} has the state {state:#b}, which cannot be"));
            }
        }
        Ok(())
    }
}

/// The bit of the triangle that `vertex` splits and whose right-angled corner is `apex`.
#[inline]
fn side(vertex: Vertex, apex: Vertex) -> u8 {
    if (apex.y, apex.x) < (vertex.y, vertex.x) { BEFORE } else { AFTER }
}

/// The vertices that split the halves of those triangles at `vertex` whose bits are set in `sides`.
fn halves(vertex: Vertex, sides: u8) -> impl Iterator<Item = Vertex> {
    let ends = vertex.hypotenuse();
    let split = if vertex.has_children() { sides } else { 0 };
    let apexes = vertex.parents().into_iter().filter(move |&apex| split & side(vertex, apex) != 0);
    apexes.flat_map(move |apex| ends.map(|end| apex.middle(end)))
}

/// Whether one of the triangles that `vertex` splits lies in a listed patch.
fn is_listed(layout: &PatchLayout, listed: &ListedPatches, vertex: Vertex) -> bool {
    let inside = |&apex: &Vertex| layout.contains(apex) && listed.holds(layout.patch_holding(vertex, apex));
    vertex.parents().iter().any(inside)
}
