//! Triangle strips: each triangle after the first costs one vertex, or two where the strip turns the same way twice.
//!
//! Any three consecutive vertices of a strip are a triangle, every second one clockwise. A strip continues over the edge of
//! its last two vertices; where the next triangle lies at the other edge, the vertex before the last is repeated (the swap),
//! which makes a triangle without area:
//!
//! ```text
//!         e
//!       ╱ │
//!     ╱   │
//!   a ─── c      a b c d      continues over b–c
//!   │   ╱ │
//!   │ ╱   │      a b a c e    continues over a–c: the triangle (a, b, a) is empty
//!   b ─── d
//! ```
//!
//! The leaves of a bintree in the order of its walk share edge after edge (Pascucci 2000 sends the same curve), so every
//! patch is one strip; holes and borders break it into a few. Strips are made from any triangles in order.

use crate::active::ActiveSet;
use crate::emit::bintree;
use crate::graph::Vertex;

/// Strips one behind the other.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Strips {
    vertices: Vec<Vertex>,
    starts: Vec<usize>,
    triangles: usize,
    end: StripTail,
}

/// The size of strips or fans.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct StripStats {
    /// Triangles with area.
    pub triangles: usize,
    /// Vertices; a list of triangles has three each.
    pub vertices: usize,
    /// Strips, or fans.
    pub strips: usize,
}

impl StripStats {
    /// Vertices a triangle; 3 in a list.
    pub fn vertices_per_triangle(&self) -> f64 {
        self.vertices as f64 / self.triangles.max(1) as f64
    }
}

/// The last triangle of the strip under construction, by the vertices that are not written yet.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum StripTail {
    /// No triangle yet.
    #[default]
    Nothing,
    /// All: its corners can still be rotated.
    Whole([Vertex; 3]),
    /// The last; the others were written in this order. It follows once the edge is known over which the strip continues.
    AllBut {
        /// The earlier one.
        older: Vertex,
        /// The later one.
        newer: Vertex,
        /// The one not written.
        last: Vertex,
    },
}

impl Strips {
    /// Adds the patches whose south-west corners are listed, each a strip of the bintree's leaves for which `keep` returns
    /// true: see [`drawn_posts`](crate::emit::world::drawn_posts).
    pub fn add_patches(
        &mut self,
        active: &ActiveSet,
        patches: impl IntoIterator<Item = Vertex>,
        mut keep: impl FnMut([Vertex; 3]) -> bool,
    ) {
        for corner in patches {
            bintree::triangles(active, [corner], |corners| {
                if keep(corners) {
                    self.push(corners);
                }
            });
            self.finish();
        }
    }

    /// Removes all strips.
    pub fn clear(&mut self) {
        self.vertices.clear();
        self.starts.clear();
        (self.triangles, self.end) = (0, StripTail::Nothing);
    }

    /// Adds a counter-clockwise triangle: to the last strip where it shares an edge with the triangle before, else to a new
    /// strip.
    pub fn push(&mut self, corners: [Vertex; 3]) {
        self.triangles += 1;
        let follows = match self.end {
            StripTail::Nothing => None,
            StripTail::Whole(first) => self.continue_from_first(first, corners),
            StripTail::AllBut { older, newer, last } => self.continue_from(older, newer, last, corners),
        };
        self.end = follows.unwrap_or_else(|| {
            self.finish();
            self.starts.push(self.vertices.len());
            StripTail::Whole(corners)
        });
    }

    /// Ends the last strip.
    pub fn finish(&mut self) {
        match std::mem::take(&mut self.end) {
            StripTail::Nothing => {}
            StripTail::Whole(corners) => self.vertices.extend(corners),
            StripTail::AllBut { last, .. } => self.vertices.push(last),
        }
    }

    fn continue_from_first(&mut self, [a, b, c]: [Vertex; 3], next: [Vertex; 3]) -> Option<StripTail> {
        let turned = [[a, b, c], [b, c, a], [c, a, b]];
        let [outer, older, newer] = turned.into_iter().find(|corners| !next.contains(&corners[0]))?;
        let last = beyond(older, newer, next)?;
        self.vertices.extend([outer, older, newer]);
        Some(StripTail::AllBut { older, newer, last })
    }

    fn continue_from(
        &mut self,
        older: Vertex,
        newer: Vertex,
        last: Vertex,
        next: [Vertex; 3],
    ) -> Option<StripTail> {
        if let Some(beyond) = beyond(newer, last, next) {
            self.vertices.push(last);
            return Some(StripTail::AllBut { older: newer, newer: last, last: beyond });
        }
        let beyond = beyond(older, last, next)?;
        self.vertices.extend([older, last]);
        Some(StripTail::AllBut { older, newer: last, last: beyond })
    }

    /// The vertices of each strip. Call [`Strips::finish`] first after [`Strips::push`].
    pub fn iter(&self) -> impl Iterator<Item = &[Vertex]> {
        let ends = self.starts.iter().skip(1).copied().chain([self.vertices.len()]);
        self.starts.iter().zip(ends).map(|(&start, end)| &self.vertices[start..end])
    }

    /// Their size.
    pub fn stats(&self) -> StripStats {
        StripStats { triangles: self.triangles, vertices: self.vertices.len(), strips: self.starts.len() }
    }
}

/// The third corner of a triangle with the corners `a` and `b`; `None` where it lacks one of them.
fn beyond(a: Vertex, b: Vertex, corners: [Vertex; 3]) -> Option<Vertex> {
    let both = corners.contains(&a) && corners.contains(&b);
    corners.into_iter().find(|&corner| both && corner != a && corner != b)
}

/// Calls `emit` with the triangles of one strip, counter-clockwise, as a graphics processor reads them: those
/// without area left out.
pub fn unstrip(strip: &[Vertex], mut emit: impl FnMut([Vertex; 3])) {
    for (at, three) in strip.windows(3).enumerate() {
        let [a, b, c] = [three[0], three[1], three[2]];
        if a != b && b != c && a != c {
            emit(if at % 2 == 0 { [a, b, c] } else { [b, a, c] });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::emit::examples::{activations, active_set, full_area_m2, lattice, mesh_of, sorted};
    use crate::emit::{quadtree, world};
    use crate::layout::PatchLayout;
    use crate::patched_ground::PatchedGround;
    use proptest::prelude::*;
    use sandtable_mesh::check;

    fn unstripped(strips: &Strips, emit: &mut dyn FnMut([Vertex; 3])) {
        strips.iter().for_each(|strip| unstrip(strip, &mut *emit));
    }

    proptest! {
        #[test]
        fn strips_hold_the_bintree_s_triangles_turned_the_same_way_one_strip_a_patch(
            (columns, rows, vertices) in activations(),
        ) {
            let active = active_set(columns, rows, 16, &vertices);
            let patches = || active.layout().patches();
            let mut strips = Strips::default();
            strips.add_patches(&active, patches(), |_| true);
            prop_assert_eq!(strips.stats().strips, active.layout().patch_count());
            let expected = sorted(|emit| bintree::triangles(&active, patches(), emit));
            prop_assert_eq!(strips.stats().triangles, expected.len());
            prop_assert_eq!(sorted(|emit| unstripped(&strips, emit)), expected);
        }

        #[test]
        fn strips_break_at_holes_and_borders_and_the_mesh_stays_conforming(
            (columns, rows, vertices) in activations(), holes in proptest::collection::vec(0usize..2400, 0..4),
        ) {
            let lattice = lattice(columns, rows, &holes);
            let active = active_set(columns, rows, 16, &vertices);
            let layout = active.layout();
            let ground = PatchedGround { lattice: &lattice, layout };
            let drawn = |corners| world::drawn_posts(ground, corners).is_some();
            let mut strips = Strips::default();
            strips.add_patches(&active, layout.patches(), drawn);
            let kept = |corners: [Vertex; 3]| drawn(corners);
            let mut count = 0;
            unstripped(&strips, &mut |corners| count += usize::from(kept(corners)));
            prop_assert_eq!(count, strips.stats().triangles);
            let mesh = mesh_of(&lattice, layout, |place| unstripped(&strips, place));
            prop_assert_eq!(mesh.triangles.len(), count);
            let checked = check::check(&mesh);
            prop_assert!(checked.is_ok(), "{:?}", checked);
            if holes.is_empty() {
                let area = full_area_m2(&lattice, layout);
                prop_assert_eq!(check::check_with_area(&mesh, area).err(), None);
            }
        }
    }

    #[test]
    fn triangles_that_share_no_edge_start_strips_of_their_own() {
        let triangle = |points: [(i32, i32); 3]| points.map(|(x, y)| Vertex::new(x, y));
        let apart = [triangle([(0, 0), (1, 0), (0, 1)]), triangle([(5, 5), (6, 5), (5, 6)])];
        let mut strips = Strips::default();
        apart.iter().for_each(|&corners| strips.push(corners));
        strips.finish();
        assert_eq!(strips.stats(), StripStats { triangles: 2, vertices: 6, strips: 2 });
        assert_eq!(sorted(|emit| unstripped(&strips, emit)), apart);
    }

    /// A patch of 64 refined round a few places, as views do.
    fn refined() -> ActiveSet {
        let mut active = ActiveSet::new(PatchLayout::new(129, 129, 64).expect("sound"));
        for index in 0..400 {
            let (x, y) = ((index * index * 7 + index * 31) % 129, (index * 53) % 61 + index % 3);
            active.activate(Vertex::new(x, y));
        }
        active
    }

    #[test]
    fn strips_and_fans_save_about_half_of_the_vertices_that_a_list_of_triangles_sends() {
        let active = refined();
        let patches = || active.layout().patches();
        let mut strips = Strips::default();
        strips.add_patches(&active, patches(), |_| true);
        let strips = strips.stats();
        assert!(strips.triangles > 1500, "{strips:?}");
        assert!(strips.vertices_per_triangle() < 1.6, "{strips:?}");
        let mut fans = StripStats::default();
        quadtree::fans(&active, patches(), |fan| {
            fans.triangles += fan.len() - 2;
            fans.vertices += fan.len();
            fans.strips += 1;
        });
        assert_eq!(fans.triangles, strips.triangles);
        assert!(fans.vertices_per_triangle() < 1.9, "{fans:?}");
    }
}
