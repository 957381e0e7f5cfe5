//! The vertex graph of one patch as a table, shared by all patches of the same orientation.
//!
//! Around a vertex are four corners, counter-clockwise: the ends of the hypotenuse that it splits and, between
//! them, its two parents. Its activation replaces the two triangles on either side of the hypotenuse by four:
//!
//! ```text
//!        ring 2                    triangle j of v is (v, ring j, ring j+1);
//!       ╱  │  ╲                    child j of v splits it;
//!  ring 3──v──ring 1               triangles 0 and 1 are what activating v makes of parent
//!       ╲  │  ╱                    ring 1's triangle, 2 and 3 of parent ring 3's
//!        ring 0
//! ```
//!
//! Arithmetic would compute this for every vertex and frame; the table takes 28 bytes a vertex, is read at once, and stays in
//! the second-level cache. Vertices are numbered by level, coarsest first, and row by row within a level, so that a patch of
//! a few triangles reads few cache lines.

use crate::graph::{Vertex, VertexKind};

/// No vertex, no triangle, no place: outside the patch or not there.
pub const NONE: u16 = u16::MAX;

/// The middle of the patch, where refinement starts; before it only the four corners are numbered.
pub const CENTER: u16 = 4;

/// The changes around one vertex of a patch when it is activated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TopologyNode {
    /// The corners around it; parents are 1 and 3, [`NONE`] outside the patch.
    pub ring: [u16; 4],
    /// The vertices that split its four triangles, [`NONE`] where there is none in the patch.
    pub children: [u16; 4],
    /// The triangles that it splits, by [`triangle`]: those of parents 1 and 3; meaningless where they are not.
    pub splits: [u32; 2],
}

/// The number of triangle `side` of a vertex. A patch corner owns one triangle, side 0: the root it is apex of.
pub fn triangle(vertex: u16, side: usize) -> u32 {
    u32::from(vertex) * 4 + side as u32
}

/// All vertices of a patch, coarsest level first.
#[derive(Clone, Debug)]
pub struct Topology {
    side: i32,
    nodes: Vec<TopologyNode>,
    places: Vec<[u8; 2]>,
    numbers: Vec<u16>,
    roots: [[u16; 3]; 2],
}

impl Topology {
    /// The patch of `side` cells, a power of two of at most 128, whose roots are those of the patch at `corner`.
    pub fn new(side: i32, corner: Vertex) -> Self {
        // Only the parity of the patch matters, and small coordinates keep away from overflow.
        let corner = Vertex::new((corner.x / side + corner.y / side) % 2 * side, 0);
        let place = VertexNumbering::new(side, corner);
        let mut nodes: Vec<TopologyNode> = place.vertices.iter().map(|&vertex| place.node(vertex)).collect();
        let places =
            place.vertices.iter().map(|at| [(at.x - corner.x) as u8, (at.y - corner.y) as u8]).collect();
        for parent in 0..nodes.len() {
            for child in 0..4 {
                let below = nodes[parent].children[child];
                if below != NONE {
                    let side_of = usize::from(nodes[below as usize].ring[3] == parent as u16);
                    nodes[below as usize].splits[side_of] = triangle(parent as u16, child);
                }
            }
        }
        let roots = crate::bintree::Triangle::roots(corner, side)
            .map(|root| root.corners().map(|vertex| place.local(vertex)));
        let ring = nodes[CENTER as usize].ring;
        nodes[CENTER as usize].splits = [triangle(ring[1], 0), triangle(ring[3], 0)];
        Self { side, nodes, places, numbers: place.numbers, roots }
    }

    /// Column and row in the patch of every vertex, in the order of their numbers.
    pub fn places(&self) -> &[[u8; 2]] {
        &self.places
    }

    /// The vertices in the order of their numbers.
    pub fn nodes(&self) -> &[TopologyNode] {
        &self.nodes
    }

    /// A vertex's place in a patch stored row by row.
    #[inline]
    pub fn row_major(&self, vertex: u16) -> usize {
        let [column, row] = self.places[vertex as usize].map(usize::from);
        row * (self.side as usize + 1) + column
    }

    /// The two root triangles, apex, left, right: the index list of a patch in which nothing is active.
    pub fn roots(&self) -> &[[u16; 3]; 2] {
        &self.roots
    }

    /// The numbers of the vertices of a patch stored row by row.
    pub fn numbers(&self) -> &[u16] {
        &self.numbers
    }

    /// Whether the vertex is a corner of the patch.
    pub fn is_corner(vertex: u16) -> bool {
        vertex < CENTER
    }

    /// The vertex that splits a triangle, [`NONE`] for the finest.
    pub fn middle(&self, triangle: u32) -> u16 {
        let (vertex, side) = ((triangle / 4) as u16, (triangle % 4) as usize);
        if Self::is_corner(vertex) { CENTER } else { self.nodes[vertex as usize].children[side] }
    }

    /// The number of the triangle with these corners, in the order of [`Topology::corners`].
    pub fn triangle_of(&self, [apex, right, _]: [u16; 3]) -> u32 {
        let ring = self.nodes[apex as usize].ring;
        let side =
            if Self::is_corner(apex) { 0 } else { (1..4).find(|&side| ring[side] == right).unwrap_or(0) };
        triangle(apex, side)
    }

    /// The corners of a triangle by number.
    pub fn corners(&self, triangle: u32) -> [u16; 3] {
        let (vertex, side) = ((triangle / 4) as u16, (triangle % 4) as usize);
        if let Some(root) = self.roots.iter().find(|root| root[0] == vertex) {
            return *root;
        }
        let ring = self.nodes[vertex as usize].ring;
        [vertex, ring[side], ring[(side + 1) % 4]]
    }
}

/// A patch's vertices by number, and their numbers by place.
struct VertexNumbering {
    side: i32,
    corner: Vertex,
    vertices: Vec<Vertex>,
    numbers: Vec<u16>,
}

impl VertexNumbering {
    fn new(side: i32, corner: Vertex) -> Self {
        let mut vertices: Vec<Vertex> =
            (0..=side).flat_map(|y| (0..=side).map(move |x| corner.moved(x, y))).collect();
        // On each level squares' centers come before edges' middles.
        vertices.sort_by_key(|at| {
            let is_corner = (at.x | at.y) & (side - 1) == 0;
            if is_corner { (i32::MIN, false) } else { (-at.step(), at.kind() != VertexKind::Center) }
        });
        let mut numbers = vec![NONE; vertices.len()];
        for (number, at) in vertices.iter().enumerate() {
            numbers[((at.y - corner.y) * (side + 1) + at.x - corner.x) as usize] = number as u16;
        }
        Self { side, corner, vertices, numbers }
    }

    fn local(&self, vertex: Vertex) -> u16 {
        let (x, y) = (vertex.x - self.corner.x, vertex.y - self.corner.y);
        let inside = (0..=self.side).contains(&x) && (0..=self.side).contains(&y);
        if inside { self.numbers[(y * (self.side + 1) + x) as usize] } else { NONE }
    }

    fn node(&self, vertex: Vertex) -> TopologyNode {
        if Topology::is_corner(self.local(vertex)) {
            return TopologyNode { ring: [NONE; 4], children: [NONE; 4], splits: [0; 2] };
        }
        let [from, to] = vertex.hypotenuse();
        let [parent, other] = vertex.parents();
        let turn = (from.x - vertex.x) * (parent.y - vertex.y) - (from.y - vertex.y) * (parent.x - vertex.x);
        let ring = if turn > 0 { [from, parent, to, other] } else { [to, parent, from, other] };
        let mut children = [NONE; 4];
        if vertex.children().next().is_some() {
            for (index, child) in children.iter_mut().enumerate() {
                let (a, b) = (ring[index], ring[(index + 1) % 4]);
                if self.local(a) != NONE && self.local(b) != NONE {
                    *child = self.local(a.middle(b));
                }
            }
        }
        TopologyNode { ring: ring.map(|corner| self.local(corner)), children, splits: [0; 2] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_says_what_the_graph_s_arithmetic_says() {
        for corner in [Vertex::new(0, 0), Vertex::new(16, 0), Vertex::new(48, 32)] {
            let topology = Topology::new(16, corner);
            let global = |number: u16| {
                let [x, y] = topology.places()[number as usize].map(i32::from);
                corner.moved(x, y)
            };
            for (number, node) in topology.nodes().iter().enumerate().skip(usize::from(CENTER)) {
                let vertex = global(number as u16);
                let within = |at: &Vertex| {
                    (0..=16).contains(&(at.x - corner.x)) && (0..=16).contains(&(at.y - corner.y))
                };
                let mut parents: Vec<Vertex> = vertex.parents().into_iter().filter(within).collect();
                let mut ring: Vec<Vertex> =
                    [node.ring[1], node.ring[3]].into_iter().filter(|&at| at != NONE).map(global).collect();
                parents.sort_unstable();
                ring.sort_unstable();
                assert_eq!(parents, ring, "{vertex:?}");
                for (side, parent) in [node.ring[1], node.ring[3]].into_iter().enumerate() {
                    if parent != NONE {
                        let corners = topology.corners(node.splits[side]);
                        assert_eq!(corners[0], parent, "{vertex:?} splits {corners:?}");
                        assert!(corners.contains(&node.ring[0]) && corners.contains(&node.ring[2]));
                    }
                }
            }
        }
    }

    #[test]
    fn vertices_are_numbered_once_each_and_coarsest_first() {
        let topology = Topology::new(8, Vertex::new(8, 0));
        let mut seen: Vec<usize> = (0..81).map(|number| topology.row_major(number)).collect();
        assert_eq!((seen[..4].to_vec(), seen[4]), (vec![0, 8, 72, 80], 40));
        for (number, node) in topology.nodes().iter().enumerate() {
            let later = |&child: &u16| child == NONE || usize::from(child) > number;
            assert!(node.children.iter().all(later), "{number} {node:?}");
        }
        seen.sort_unstable();
        assert!(seen.into_iter().eq(0..81));
    }

    #[test]
    fn triangles_are_counter_clockwise() {
        let topology = Topology::new(8, Vertex::new(8, 0));
        for (number, node) in topology.nodes().iter().enumerate() {
            for side in 0..4 {
                if node.ring[side] == NONE || node.ring[(side + 1) % 4] == NONE {
                    continue;
                }
                let at = topology
                    .corners(triangle(number as u16, side))
                    .map(|corner| topology.places()[corner as usize].map(i32::from));
                let named = topology.corners(triangle(number as u16, side));
                assert_eq!(topology.triangle_of(named), triangle(number as u16, side));
                let [a, b, c] = at;
                assert!((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]) > 0, "{at:?}");
            }
        }
    }
}
