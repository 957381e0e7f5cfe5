//! The restricted quadtree's triangles, top-down from five-vertex nodes.
//!
//! A node is a square whose center is active. Its triangles are a fan round the center, over the corners and the active edge
//! vertices, so four bits determine it. Up to quarter turns these are six patterns, here with the numbers of the ring:
//!
//! ```text
//!   0: none           1: west           2: west, south    3: west, east     4: all but north  5: all
//!   6───────4         6───────4         6───────4         6───────4         6───────4         6───5───4
//!   │ ╲   ╱ │         │ ╲   ╱ │         │ ╲   ╱ │         │ ╲   ╱ │         │ ╲   ╱ │         │ ╲ │ ╱ │
//!   │   c   │         7───c   │         7───c   │         7───c───3         7───c───3         7───c───3
//!   │ ╱   ╲ │         │ ╱   ╲ │         │ ╱ │ ╲ │         │ ╱   ╲ │         │ ╱ │ ╲ │         │ ╱ │ ╲ │
//!   0───────2         0───────2         0───1───2         0───────2         0───1───2         0───1───2
//! ```
//!
//! A quarter between two active edge vertices is a child's square. Where the child's center is inactive, its two triangles
//! along the diagonal to the center are those of the fan; where it is active, the child draws its own fan instead. The center
//! of a child has these two edge vertices as parents, so there is no other case. Only a patch whose own center is inactive is
//! no fan but two triangles, along the diagonal that alternates from patch to patch.
//!
//! Source: the restricted quadtree with five-vertex nodes, six patterns and quarter turns, after Lindstrom et al. 1996. The
//! triangles are those of the bintree from the same bits.

use crate::active::ActiveSet;
use crate::bintree::Triangle;
use crate::emit::bintree::{key, vertex};
use crate::emit::walk::WalkKey;
use crate::graph::Vertex;

/// A side of a fan's triangles: from one place of the ring to another, counter-clockwise.
type Rim = (u8, u8);

/// The six basic patterns, as the outer sides of their triangles.
const BASIC: [&[Rim]; 6] = [
    &[(0, 2), (2, 4), (4, 6), (6, 0)],
    &[(0, 2), (2, 4), (4, 6), (6, 7), (7, 0)],
    &[(0, 1), (1, 2), (2, 4), (4, 6), (6, 7), (7, 0)],
    &[(0, 2), (2, 3), (3, 4), (4, 6), (6, 7), (7, 0)],
    &[(0, 1), (1, 2), (2, 3), (3, 4), (4, 6), (6, 7), (7, 0)],
    &[(0, 1), (1, 2), (2, 3), (3, 4), (4, 5), (5, 6), (6, 7), (7, 0)],
];

/// The basic pattern and the quarter turns counter-clockwise that make the pattern of four edge vertices: west 1,
/// south 2, east 4, north 8.
const TURNS: [(usize, u8); 16] = [
    (0, 0),
    (1, 0),
    (1, 1),
    (2, 0),
    (1, 2),
    (3, 0),
    (2, 1),
    (4, 0),
    (1, 3),
    (2, 3),
    (3, 1),
    (4, 3),
    (2, 2),
    (4, 2),
    (4, 1),
    (5, 0),
];

/// A pattern turned into place.
#[derive(Clone, Copy)]
struct TriangleFan {
    count: usize,
    rims: [Rim; 8],
    /// The bit of the child whose square the triangle lies in, 0 where it lies in two.
    quarters: [u8; 8],
}

/// The patterns of all sixteen states.
const FANS: [TriangleFan; 16] = turned_patterns();

const fn turned_patterns() -> [TriangleFan; 16] {
    let mut fans = [TriangleFan { count: 0, rims: [(0, 0); 8], quarters: [0; 8] }; 16];
    let mut state = 0;
    while state < 16 {
        let (basic, turns) = TURNS[state];
        let rims = BASIC[basic];
        fans[state].count = rims.len();
        let mut at = 0;
        while at < rims.len() {
            let (from, to) = ((rims[at].0 + 2 * turns) % 8, (rims[at].1 + 2 * turns) % 8);
            fans[state].rims[at] = (from, to);
            fans[state].quarters[at] = quarter(from, to);
            at += 1;
        }
        state += 1;
    }
    fans
}

/// The bit of the child that holds the triangle over one step of the ring: children are 0 south-west, 1
/// south-east, 2 north-west, 3 north-east.
const fn quarter(from: u8, to: u8) -> u8 {
    match (from, to) {
        (7, 0) | (0, 1) => 1,
        (1, 2) | (2, 3) => 2,
        (5, 6) | (6, 7) => 4,
        (3, 4) | (4, 5) => 8,
        _ => 0,
    }
}

/// A node to visit: its center and its level below the patch.
#[derive(Clone, Copy)]
struct Visit {
    center: WalkKey,
    level: u32,
}

/// The ring of a node with its active vertices and children.
struct NodeRing {
    ring: [WalkKey; 8],
    state: usize,
    children: u8,
}

/// The walk from the root of a patch.
struct Descent<'a> {
    active: &'a ActiveSet,
    origin: WalkKey,
    finest: u32,
}

impl<'a> Descent<'a> {
    fn new(active: &'a ActiveSet) -> Self {
        let origin = key(active.layout(), Vertex::new(0, 0));
        Self { active, origin, finest: active.layout().patch().trailing_zeros() - 1 }
    }

    /// Calls `visit` with every node of a patch whose center is active.
    fn nodes(&self, corner: Vertex, mut visit: impl FnMut(WalkKey, &NodeRing)) {
        let half = self.active.layout().patch() / 2;
        let center = key(self.active.layout(), corner.moved(half, half));
        let mut waiting = Vec::with_capacity(3 * self.finest as usize + 1);
        waiting.push(Visit { center, level: 0 });
        while let Some(node) = waiting.pop() {
            let around = self.around(node, half >> node.level, &mut waiting);
            visit(node.center, &around);
        }
    }

    /// The ring of a node of half side `half`; puts its active children on `waiting`.
    fn around(&self, node: Visit, half: i32, waiting: &mut Vec<Visit>) -> NodeRing {
        let at = |x: i32, y: i32| key(self.active.layout(), Vertex::new(x, y));
        let (zero, east, north) = (self.origin, at(half, 0), at(0, half));
        let center = node.center;
        let (w, e) = (center.moved(east, zero), center.moved(zero, east));
        let (s, n) = (center.moved(north, zero), center.moved(zero, north));
        let corners =
            [w.moved(north, zero), e.moved(north, zero), w.moved(zero, north), e.moved(zero, north)];
        let bit = |key: WalkKey| usize::from(self.active.bit(key.index()));
        let state = bit(w) | bit(s) << 1 | bit(e) << 2 | bit(n) << 3;
        let mut children = 0;
        if node.level < self.finest {
            for (digit, corner) in corners.into_iter().enumerate() {
                let child = center.middle(corner);
                if self.active.bit(child.index()) {
                    children |= 1 << digit;
                    waiting.push(Visit { center: child, level: node.level + 1 });
                }
            }
        }
        let [sw, se, nw, ne] = corners;
        NodeRing { ring: [sw, s, se, e, ne, n, nw, w], state, children }
    }

    /// The two triangles of a patch whose center is inactive.
    fn undivided(&self, corner: Vertex) -> Option<[Triangle; 2]> {
        let roots = Triangle::roots(corner, self.active.layout().patch());
        (!self.active.is_active(roots[0].split_vertex())).then_some(roots)
    }
}

/// Calls `emit` with the triangles of the patches whose south-west corners are listed, counter-clockwise; those
/// of a fan from its center.
pub fn triangles(
    active: &ActiveSet,
    patches: impl IntoIterator<Item = Vertex>,
    mut emit: impl FnMut([Vertex; 3]),
) {
    let columns = active.layout().columns() as i32;
    let descent = Descent::new(active);
    for corner in patches {
        if let Some(roots) = descent.undivided(corner) {
            roots.iter().for_each(|root| emit(root.corners()));
            continue;
        }
        descent.nodes(corner, |center, around| {
            let (center, ring) = (vertex(columns, center), around.ring.map(|key| vertex(columns, key)));
            let fan = &FANS[around.state];
            for (&(from, to), &quarter) in fan.rims.iter().zip(&fan.quarters).take(fan.count) {
                if quarter & around.children == 0 {
                    emit([center, ring[usize::from(from)], ring[usize::from(to)]]);
                }
            }
        });
    }
}

/// Calls `emit` with the same triangles as fans: the common corner, then the others counter-clockwise, each
/// following pair one triangle.
pub fn fans(active: &ActiveSet, patches: impl IntoIterator<Item = Vertex>, mut emit: impl FnMut(&[Vertex])) {
    let columns = active.layout().columns() as i32;
    let descent = Descent::new(active);
    let mut fan = Vec::with_capacity(10);
    for corner in patches {
        if let Some([first, second]) = descent.undivided(corner) {
            // Both triangles round one end of the hypotenuse that they share.
            emit(&[first.right, first.apex, first.left, second.apex]);
            continue;
        }
        descent.nodes(corner, |center, around| {
            let key_at = |place: u8| vertex(columns, around.ring[usize::from(place)]);
            rims_in_runs(around, |run| {
                fan.clear();
                fan.push(vertex(columns, center));
                fan.push(key_at(run[0].0));
                fan.extend(run.iter().map(|rim| key_at(rim.1)));
                emit(&fan);
            });
        });
    }
}

/// Calls `visit` with the rims of a node that no child replaces, in unbroken runs, each as long as it can be.
fn rims_in_runs(around: &NodeRing, mut visit: impl FnMut(&[Rim])) {
    let fan = &FANS[around.state];
    let kept = |at: usize| fan.quarters[at % fan.count] & around.children == 0;
    // Starting behind a gap keeps a run that goes over the end of the list in one piece.
    let start = (0..fan.count).find(|&at| !kept(at)).unwrap_or(0);
    let mut run = Vec::with_capacity(8);
    for at in start..start + fan.count {
        if kept(at) {
            run.push(fan.rims[at % fan.count]);
        } else if !run.is_empty() {
            visit(&run);
            run.clear();
        }
    }
    if !run.is_empty() {
        visit(&run);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::emit::bintree;
    use crate::emit::examples::{activations, active_set, lattice, mesh_of, sorted, turned};
    use proptest::prelude::*;
    use sandtable_mesh::check;

    proptest! {
        #[test]
        fn the_restricted_quadtree_of_five_vertex_nodes_emits_the_bintree_s_triangles(
            (columns, rows, vertices) in activations(), patch in 1u32..6,
        ) {
            let active = active_set(columns, rows, 1 << patch, &vertices);
            let patches = || active.layout().patches();
            let expected = sorted(|emit| bintree::triangles(&active, patches(), emit));
            prop_assert_eq!(sorted(|emit| triangles(&active, patches(), emit)), expected);
        }

        #[test]
        fn fans_round_the_centers_hold_the_same_triangles((columns, rows, vertices) in activations()) {
            let active = active_set(columns, rows, 16, &vertices);
            let patches = || active.layout().patches();
            let mut found = Vec::new();
            fans(&active, patches(), |fan| {
                found.extend(fan[1..].windows(2).map(|pair| turned([fan[0], pair[0], pair[1]])));
            });
            found.sort();
            prop_assert_eq!(found, sorted(|emit| triangles(&active, patches(), emit)));
        }

        #[test]
        fn the_quadtree_s_mesh_is_conforming_and_covers_the_ground(
            (columns, rows, vertices) in activations(),
        ) {
            let active = active_set(columns, rows, 16, &vertices);
            let lattice = lattice(columns, rows, &[]);
            let area = lattice.extent().size().x * lattice.extent().size().y;
            let layout = active.layout();
            let mesh = mesh_of(&lattice, layout, |place| triangles(&active, layout.patches(), place));
            prop_assert_eq!(check::check_with_area(&mesh, area).err(), None);
        }
    }

    #[test]
    fn six_patterns_and_their_quarter_turns_make_all_sixteen_states() {
        for (state, fan) in FANS.iter().enumerate() {
            let edge_active = |place: u8| state & [1 << 1, 1 << 2, 1 << 3, 1][usize::from(place / 2)] != 0;
            let mut ring: Vec<u8> = fan.rims[..fan.count].iter().map(|rim| rim.0).collect();
            let closes = (0..fan.count).all(|at| fan.rims[at].1 == fan.rims[(at + 1) % fan.count].0);
            assert!(closes, "the fan of {state:04b} is not closed");
            ring.sort_unstable();
            let expected: Vec<u8> = (0..8).filter(|place| place % 2 == 0 || edge_active(*place)).collect();
            assert_eq!(ring, expected, "state {state:04b}");
        }
        assert_eq!(BASIC.map(<[Rim]>::len), [4, 5, 6, 6, 7, 8]);
    }
}
