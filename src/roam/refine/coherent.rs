//! Last frame's mesh, adjusted by forced splits and forced merges: no queues (the patch-based ROAM of 000).
//!
//! A triangle that is visited and whose split vertex is wanted is *split of its own accord*; one bit a triangle
//! remembers that from frame to frame. Each frame walks those triangles from the roots of the listed patches and
//! asks each one's vertex again:
//!
//! - wanted and not yet split: the vertex is activated, its inactive parents first (forced split), and the
//!   halves are looked at in turn;
//! - split and no longer wanted: the triangle and everything below it that was split only through it loses its
//!   bit (forced merge). A vertex that neither of its triangles asks for and that has no active child goes; its
//!   parents are then looked at in turn, since they may have been there for it alone.
//!
//! So a vertex is active exactly when a triangle asks for it or for one that descends from it: the mesh equals
//! that of [`rebuild`](crate::roam::refine::rebuild::rebuild) for the same criterion and patches, bit for bit,
//! whatever the criterion and whatever came before. A bit a vertex would not do: where a criterion is not
//! monotone, one of a vertex's two triangles can be visited while the other is there by force alone.
//!
//! Cost: one question a visited triangle, as a rebuild has it, but splits and merges only where the mesh changes.

use crate::roam::active::ActiveSet;
use crate::roam::bintree::Triangle;
use crate::roam::criterion::Criterion;
use crate::roam::graph::Vertex;
use crate::roam::layout::Layout;
use crate::roam::refine::changes::{Changes, Tally};
use crate::roam::refine::listed::Listed;

/// What becomes of a patch that is no longer listed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Hidden {
    /// It is merged as far as its neighbours allow: the mesh is that of a rebuild, and the memory of a patch
    /// costs nothing once it is out of view.
    #[default]
    Forget,
    /// It stays as it was last seen and is adjusted when it is listed again, as 000 has it: turning back and
    /// forth costs no splits. The mesh is finer than a rebuild's where unlisted patches force their neighbours.
    Keep,
}

/// A mesh that follows the view by splits and merges.
#[derive(Clone, Debug)]
pub struct Coherent {
    active: ActiveSet,
    split: TriangleBits,
    listed: Listed,
    hidden: Hidden,
    tally: Tally,
    stack: Vec<Triangle>,
    released: Vec<Vertex>,
}

impl Coherent {
    /// The roots of all patches, which are forgotten once they are no longer listed.
    pub fn new(layout: Layout) -> Self {
        Self::with_hidden(layout, Hidden::default())
    }

    /// The roots of all patches.
    pub fn with_hidden(layout: Layout, hidden: Hidden) -> Self {
        Self {
            active: ActiveSet::new(layout),
            split: TriangleBits { bits: vec![0; (2 * layout.vertex_count()).div_ceil(64)] },
            listed: Listed::new(&layout),
            hidden,
            tally: Tally::new(&layout),
            stack: Vec::new(),
            released: Vec::new(),
        }
    }

    /// The bits.
    pub fn active(&self) -> &ActiveSet {
        &self.active
    }

    /// Adjusts the mesh to a view; `patches` are the south-west corners of patches of the layout.
    pub fn update(&mut self, criterion: &impl Criterion, patches: &[Vertex]) -> Changes {
        let layout = *self.active.layout();
        self.listed.renew(&layout, patches);
        if self.hidden == Hidden::Forget {
            for place in 0..self.listed.left().len() {
                for root in Triangle::roots(self.listed.left()[place], layout.patch()) {
                    self.withdraw(&layout, &root);
                }
            }
        }
        for place in 0..self.listed.now().len() {
            self.stack.extend(Triangle::roots(self.listed.now()[place], layout.patch()));
            self.adjust(&layout, criterion);
        }
        self.release(&layout);
        self.tally.take()
    }

    /// Asks every visited triangle on and below the stack again.
    fn adjust(&mut self, layout: &Layout, criterion: &impl Criterion) {
        while let Some(triangle) = self.stack.pop() {
            let vertex = triangle.split_vertex();
            let bit = TriangleBits::of(layout, vertex, triangle.apex);
            let was = self.split.get(bit);
            if criterion.wants(vertex) {
                if !was {
                    self.split.set(bit);
                    let tally = &mut self.tally;
                    self.active.activate_each(vertex, &mut |vertex| tally.split(layout, vertex));
                }
                if vertex.has_children() {
                    self.stack.extend(triangle.split());
                }
            } else if was {
                self.withdraw(layout, &triangle);
            }
        }
    }

    /// Takes back the split of a triangle, and of all below it.
    fn withdraw(&mut self, layout: &Layout, triangle: &Triangle) {
        let vertex = triangle.split_vertex();
        let bit = TriangleBits::of(layout, vertex, triangle.apex);
        if !self.split.get(bit) {
            return;
        }
        self.split.clear(bit);
        self.released.push(vertex);
        if vertex.has_children() {
            for half in triangle.split() {
                self.withdraw(layout, &half);
            }
        }
    }

    /// Deactivates what no triangle asks for and no active child needs.
    fn release(&mut self, layout: &Layout) {
        while let Some(vertex) = self.released.pop() {
            if layout.contains(vertex) && !self.split.either(layout, vertex) && self.active.merge(vertex) {
                self.tally.merge(layout, vertex);
                self.released.extend(vertex.parents());
            }
        }
    }

    /// Whether the bits are closed under parents, and every active vertex is asked for or has an active child.
    ///
    /// # Errors
    /// A sentence naming the first vertex that is wrong.
    pub fn check(&self) -> Result<(), String> {
        self.active.check()?;
        let layout = self.active.layout();
        for index in 0..layout.vertex_count() {
            let vertex = Vertex::new((index % layout.columns()) as i32, (index / layout.columns()) as i32);
            let asked_for = self.split.either(layout, vertex);
            if asked_for && !self.active.is_active(vertex) {
                return Err(format!("{vertex:?} is asked for and not active"));
            }
            if !asked_for && self.active.is_mergeable(vertex) {
                return Err(format!("{vertex:?} is active, and nothing asks for it"));
            }
        }
        Ok(())
    }
}

/// One bit a triangle that can be split: two a vertex, one for each side of the hypotenuse.
#[derive(Clone, Debug)]
struct TriangleBits {
    bits: Vec<u64>,
}

impl TriangleBits {
    /// The bit of the triangle that `vertex` splits and whose right-angled corner is `apex`.
    #[inline]
    fn of(layout: &Layout, vertex: Vertex, apex: Vertex) -> usize {
        2 * layout.index(vertex) + usize::from((apex.y, apex.x) > (vertex.y, vertex.x))
    }

    #[inline]
    fn get(&self, bit: usize) -> bool {
        self.bits[bit / 64] >> (bit % 64) & 1 == 1
    }

    fn set(&mut self, bit: usize) {
        self.bits[bit / 64] |= 1 << (bit % 64);
    }

    fn clear(&mut self, bit: usize) {
        self.bits[bit / 64] &= !(1 << (bit % 64));
    }

    fn either(&self, layout: &Layout, vertex: Vertex) -> bool {
        let bit = 2 * layout.index(vertex);
        self.bits[bit / 64] >> (bit % 64) & 3 != 0
    }
}
