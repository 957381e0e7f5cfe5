//! The triangles of one part of the ground after the other, with numbers for their vertices.
//!
//! A vertex has the number of its first use, as in a mesh that is emitted whole. Numbers are held for one part at a time; a
//! vertex on the border to a later part takes its number along.

use std::ops::ControlFlow;

use crate::active::ActiveSet;
use crate::emit::bintree;
use crate::emit::world::doubled_area;
use crate::graph::Vertex;
use crate::parts::{BorderCarry, PartPlan};
use sandtable_mesh::sink::VertexId;
use sandtable_terrain::lattice::Post;

/// A triangle with the numbers of its vertices.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NumberedTriangle {
    /// Its posts, counter-clockwise seen from above.
    pub posts: [Post; 3],
    /// The numbers of the vertices on them.
    pub ids: [VertexId; 3],
    /// Which of the vertices no triangle before has; they are numbered in this order.
    pub is_first: [bool; 3],
}

impl NumberedTriangle {
    /// The posts of the vertices that no triangle before has, in the order of their numbers.
    pub fn first_posts(&self) -> impl Iterator<Item = Post> {
        self.posts.into_iter().zip(self.is_first).filter_map(|(post, is_first)| is_first.then_some(post))
    }
}

/// Numbers are one higher here; fresh memory need not be written.
const NOT_NUMBERED: u32 = 0;

/// Emits the triangles of parts, which must follow each other from the first.
pub struct PartEmitter<'a> {
    active: &'a ActiveSet,
    plan: PartPlan,
    borders: BorderCarry<u32>,
    numbers: Vec<u32>,
    count: u32,
}

impl<'a> PartEmitter<'a> {
    /// For the mesh of the active vertices.
    pub fn new(active: &'a ActiveSet, plan: PartPlan) -> Self {
        let borders = BorderCarry::new(active.layout(), NOT_NUMBERED);
        Self { active, plan, borders, numbers: Vec::new(), count: 0 }
    }

    /// Calls `each` with the triangles of the next part that have an area, and data at all corners, until it breaks.
    pub fn emit<B>(
        &mut self,
        part: usize,
        has_data: impl Fn(Post) -> bool,
        mut each: impl FnMut(&NumberedTriangle) -> ControlFlow<B>,
    ) -> ControlFlow<B> {
        let rect = self.plan.posts(part);
        let rows = (rect.first.row, rect.last.row);
        self.borders.enter(rect, rows, &mut self.numbers);
        let (numbers, count) = (&mut self.numbers, &mut self.count);
        let mut number = |post: Post| {
            let row = (post.row - rect.first.row) as usize;
            let slot = &mut numbers[row * rect.width() + (post.column - rect.first.column) as usize];
            let is_first = *slot == NOT_NUMBERED;
            if is_first {
                *count += 1;
                *slot = *count;
            }
            (VertexId(*slot - 1), is_first)
        };
        for corner in self.plan.patches(part) {
            drawn(
                self.active,
                corner,
                &has_data,
                |_| true,
                |posts| {
                    let [a, b, c] = posts.map(&mut number);
                    each(&NumberedTriangle { posts, ids: [a.0, b.0, c.0], is_first: [a.1, b.1, c.1] })
                },
            )?;
        }
        self.borders.leave(rect, rows, &self.numbers);
        ControlFlow::Continue(())
    }
}

/// Calls `each` with the posts of the leaves of a patch that have an area, and data at all corners, until it breaks; without
/// those below triangles for whose posts `enter` returns false.
pub fn drawn<B>(
    active: &ActiveSet,
    corner: Vertex,
    has_data: impl Fn(Post) -> bool,
    enter: impl Fn([Post; 3]) -> bool,
    mut each: impl FnMut([Post; 3]) -> ControlFlow<B>,
) -> ControlFlow<B> {
    let broken = std::cell::RefCell::new(ControlFlow::Continue(()));
    let posts = |corners: [Vertex; 3]| corners.map(|vertex| active.layout().post(vertex));
    let goes_on = |corners| broken.borrow().is_continue() && enter(posts(corners));
    bintree::triangles_where(active, corner, goes_on, |corners| {
        let posts = posts(corners);
        if doubled_area(posts) != 0 && posts.iter().all(|&post| has_data(post)) {
            *broken.borrow_mut() = each(posts);
        }
    });
    broken.into_inner()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::emit::examples::{activations, active_set, lattice, mesh_of};
    use proptest::prelude::*;
    use sandtable_mesh::sink::MeshSink;
    use sandtable_mesh::trimesh::TriMesh;

    proptest! {
        #[test]
        fn parts_have_the_vertices_and_triangles_of_the_whole_in_its_order(
            (columns, rows, vertices) in activations(), most in 1usize..2000,
            holes in proptest::collection::vec(0usize..3000, 0..4),
        ) {
            let (ground, active) = (lattice(columns, rows, &holes), active_set(columns, rows, 16, &vertices));
            let layout = active.layout();
            let whole = mesh_of(&ground, layout, |place| bintree::triangles(&active, layout.patches(), place));
            let plan = PartPlan::of_vertices(*layout, most);
            let (mut emitter, mut mesh) = (PartEmitter::new(&active, plan), TriMesh::default());
            for part in 0..plan.count() {
                let done = emitter.emit(part, |post| !ground.height(post).is_nan(), |triangle| {
                    for post in triangle.first_posts() {
                        mesh.vertex(ground.position(post).extend(ground.height(post)));
                    }
                    mesh.triangle(triangle.ids);
                    ControlFlow::<()>::Continue(())
                });
                prop_assert!(done.is_continue());
            }
            prop_assert_eq!(mesh, whole);
        }
    }

    #[test]
    fn a_break_is_the_end_of_the_part() {
        let active = active_set(33, 33, 16, &[(3, 5), (20, 20)]);
        let mut emitter = PartEmitter::new(&active, PartPlan::whole(*active.layout()));
        let mut count = 0;
        let end = emitter.emit(
            0,
            |_| true,
            |_| {
                count += 1;
                if count == 3 { ControlFlow::Break("enough") } else { ControlFlow::Continue(()) }
            },
        );
        assert_eq!((end, count), (ControlFlow::Break("enough"), 3));
    }
}
