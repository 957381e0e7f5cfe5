//! The restricted quadtree as pure arithmetic: nodes by their address in base 4, and the five vertices of each.
//!
//! An address has one digit a level, from the root: the parent's lacks the last digit, a child's has one more, and a
//! neighbor's follows by counting in the digits of its axis with a carry. A node stores five vertices; its corners belong to
//! nodes above. In patches of 2ⁿ cells the root is the patch and the nodes with n − 1 digits, two cells wide, are the finest.
//!
//! ```text
//! ┌───┬───┐            ●── north ──●        ●  a vertex of a node above
//! │ 2 │ 3 │            │           │
//! ├───┼───┤          west center east      south = {0, 1}   west = {0, 2}
//! │ 0 │ 1 │            │           │        north = {2, 3}   east = {1, 3}
//! └───┴───┘            ●── south ──●
//! ```
//!
//! A center depends on the two corners of its node on the diagonal perpendicular to the line to the parent's center; an edge
//! vertex depends on the two centers beside it. These are [`Vertex::parents`].
//!
//! Source: the restricted quadtree with five-vertex nodes and base-4 indices, after Lindstrom et al. 1996.

use std::fmt;

use crate::graph::Vertex;

/// The most digits of an address: a patch of 4096 cells has nodes of two cells after 11.
pub const MOST_DIGITS: u32 = 15;

/// The bits of an address's digits that count eastward, and northward.
const EAST_BITS: u32 = 0x5555_5555;
const NORTH_BITS: u32 = 0xAAAA_AAAA;

/// A node's place in the quadtree of its patch, as digits in base 4: two bits a digit below a leading one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Address(u32);

/// A side of a node, in the order its edge vertices are stored: counter-clockwise from the west.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NodeSide {
    /// Toward smaller x.
    West,
    /// Toward smaller y.
    South,
    /// Toward larger x.
    East,
    /// Toward larger y.
    North,
}

/// All sides in their order.
pub const SIDES: [NodeSide; 4] = [NodeSide::West, NodeSide::South, NodeSide::East, NodeSide::North];

impl NodeSide {
    /// The step toward this side, in x and y.
    pub const fn step(self) -> (i32, i32) {
        match self {
            Self::West => (-1, 0),
            Self::South => (0, -1),
            Self::East => (1, 0),
            Self::North => (0, 1),
        }
    }
}

impl Address {
    /// The address without digits.
    pub const ROOT: Self = Self(1);

    /// The address written as `digits`, each 0 to 3; `None` for other characters and past [`MOST_DIGITS`].
    pub fn parse(digits: &str) -> Option<Self> {
        digits.chars().try_fold(Self::ROOT, |address, digit| address.child(digit.to_digit(4)?))
    }

    /// The number of its digits: how far below the root the node is.
    pub const fn level(self) -> u32 {
        (31 - self.0.leading_zeros()) / 2
    }

    /// The last digit; `None` for the root.
    pub const fn digit(self) -> Option<u32> {
        if self.0 == 1 { None } else { Some(self.0 & 3) }
    }

    /// The address without its last digit; `None` for the root.
    pub const fn parent(self) -> Option<Self> {
        if self.0 == 1 { None } else { Some(Self(self.0 >> 2)) }
    }

    /// The address with one more digit, 0 to 3; `None` for other numbers and past [`MOST_DIGITS`].
    pub const fn child(self, digit: u32) -> Option<Self> {
        if digit > 3 || self.level() == MOST_DIGITS { None } else { Some(Self(self.0 << 2 | digit)) }
    }

    /// The neighbor on the same level, and whether the carry left the patch: then it is the address in the
    /// next patch on that side.
    ///
    /// Digit by digit from the last: a digit on the near half moves to the far half and the count ends; one on the far half
    /// moves to the near half with a carry. One addition does it for all digits, since the bits of the other axis propagate
    /// the carry.
    pub const fn neighbor(self, side: NodeSide) -> (Self, bool) {
        let top = 1 << (2 * self.level());
        let digits = self.0 ^ top;
        let (axis, forward) = match side {
            NodeSide::West => (EAST_BITS, false),
            NodeSide::South => (NORTH_BITS, false),
            NodeSide::East => (EAST_BITS, true),
            NodeSide::North => (NORTH_BITS, true),
        };
        let (own, other, one) = (digits & axis, digits & !axis, axis & 3);
        let sum = if forward { (own | !axis).wrapping_add(one) } else { own.wrapping_sub(one) };
        let counted = sum & axis;
        (Self(top | counted & (top - 1) | other), counted & !(top - 1) != 0)
    }

    /// The place of the node among those of its level, counted from the south-west.
    fn place(self) -> (i32, i32) {
        (0..self.level()).fold((0, 0), |(x, y), level| {
            let digit = (self.0 >> (2 * level) & 3) as i32;
            (x | (digit & 1) << level, y | (digit >> 1) << level)
        })
    }
}

impl fmt::Display for Address {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        (0..self.level()).rev().try_for_each(|level| write!(f, "{}", self.0 >> (2 * level) & 3))
    }
}

/// A node: the patch it lies in, counted from the south-west, and its address there.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct QuadNode {
    /// Patches eastward.
    pub east: i32,
    /// Patches northward.
    pub north: i32,
    /// The place within the patch.
    pub address: Address,
}

impl fmt::Display for QuadNode {
    /// As `east,north:digits`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{},{}:{}", self.east, self.north, self.address)
    }
}

/// A node's ground: its south-west corner and its side in cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NodeSquare {
    /// The south-west corner.
    pub corner: Vertex,
    /// A power of two, from 2.
    pub side: i32,
}

impl NodeSquare {
    /// The vertex in the middle.
    pub const fn center(self) -> Vertex {
        self.corner.moved(self.side / 2, self.side / 2)
    }

    /// The vertex in the middle of an edge.
    pub const fn edge(self, side: NodeSide) -> Vertex {
        let ((dx, dy), half) = (side.step(), self.side / 2);
        self.center().moved(dx * half, dy * half)
    }

    /// The five vertices of the node in their stored order: center, west, south, east, north.
    pub fn vertices(self) -> [Vertex; 5] {
        let [west, south, east, north] = SIDES.map(|side| self.edge(side));
        [self.center(), west, south, east, north]
    }
}

impl QuadNode {
    /// The node above; `None` for a root.
    pub fn parent(self) -> Option<Self> {
        Some(Self { address: self.address.parent()?, ..self })
    }

    /// The node below in one quarter; `None` past [`MOST_DIGITS`] or for digits above 3.
    pub fn child(self, digit: u32) -> Option<Self> {
        Some(Self { address: self.address.child(digit)?, ..self })
    }

    /// The node of the same level beyond a side, across the patch's border too; its patch may lie outside the
    /// terrain.
    pub const fn neighbor(self, side: NodeSide) -> Self {
        let (address, leaves_patch) = self.address.neighbor(side);
        let (dx, dy) = if leaves_patch { side.step() } else { (0, 0) };
        Self { east: self.east + dx, north: self.north + dy, address }
    }

    /// The node's ground in patches of `patch` cells a side; `None` where it is finer than two cells.
    pub fn square(self, patch: i32) -> Option<NodeSquare> {
        let side = patch >> self.address.level();
        let (x, y) = self.address.place();
        let corner = Vertex::new(self.east * patch + x * side, self.north * patch + y * side);
        (side >= 2).then_some(NodeSquare { corner, side })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::graph::VertexKind;

    const PATCH: i32 = 16;

    impl QuadNode {
        /// The node whose center is `center`, in patches of `patch` cells; `None` for a vertex that is no center.
        pub fn of_center(center: Vertex, patch: i32) -> Option<Self> {
            let half = center.step();
            if center.kind() != VertexKind::Center || half <= 0 || half >= patch {
                return None;
            }
            let (east, north) = (center.x.div_euclid(patch), center.y.div_euclid(patch));
            let levels = (patch / (2 * half)).trailing_zeros();
            let digit = |level: u32| {
                let weight = half << (levels - level);
                u32::from(center.x & weight != 0) | u32::from(center.y & weight != 0) << 1
            };
            let address =
                (0..levels).try_fold(Address::ROOT, |address, level| address.child(digit(level)))?;
            Some(Self { east, north, address })
        }

        /// The two corners of the node that its center depends on: those on the diagonal perpendicular to the line
        /// to the parent's center. `None` for a root, whose corners are always there.
        pub fn center_depends_on(self, patch: i32) -> Option<[Vertex; 2]> {
            let center = self.square(patch)?.center();
            let above = self.parent()?.square(patch)?.center();
            let (dx, dy) = (above.x - center.x, above.y - center.y);
            Some([center.moved(-dy, dx), center.moved(dy, -dx)])
        }

        /// The two centers that an edge vertex depends on: those of the nodes beside it, of which one may lie
        /// outside the terrain.
        pub fn edge_depends_on(self, side: NodeSide, patch: i32) -> Option<[Vertex; 2]> {
            Some([self.square(patch)?.center(), self.neighbor(side).square(patch)?.center()])
        }
    }

    /// All nodes of 3 × 3 patches.
    fn nodes() -> Vec<QuadNode> {
        let mut found: Vec<QuadNode> = (0..9)
            .map(|patch| QuadNode { east: patch % 3, north: patch / 3, address: Address::ROOT })
            .collect();
        let mut next = 0;
        while let Some(node) = found.get(next).copied() {
            next += 1;
            if node.square(PATCH).is_some_and(|square| square.side > 2) {
                found.extend((0..4).filter_map(|digit| node.child(digit)));
            }
        }
        assert_eq!(found.len(), 9 * (1 + 4 + 16 + 64));
        found
    }

    /// The rule of the paper on strings: the digit is mirrored, with a carry where it lay at that side already.
    fn neighbor_by_digits(digits: &str, side: NodeSide) -> (String, bool) {
        let far = match side {
            NodeSide::West => "02",
            NodeSide::South => "01",
            NodeSide::East => "13",
            NodeSide::North => "23",
        };
        let flip = if matches!(side, NodeSide::West | NodeSide::East) { 1 } else { 2 };
        let mut digits: Vec<u32> = digits.chars().filter_map(|digit| digit.to_digit(4)).collect();
        for digit in digits.iter_mut().rev() {
            let carries = far.contains(char::from_digit(*digit, 4).expect("a digit"));
            *digit ^= flip;
            if !carries {
                return (digits.iter().map(u32::to_string).collect(), false);
            }
        }
        (digits.iter().map(u32::to_string).collect(), true)
    }

    #[test]
    fn dropping_a_digit_gives_the_parent_and_appending_one_a_child() {
        for node in nodes() {
            let text = node.address.to_string();
            assert_eq!(Address::parse(&text), Some(node.address));
            assert_eq!(text.len() as u32, node.address.level());
            if let Some(parent) = node.parent() {
                assert_eq!(parent.address.to_string(), text[..text.len() - 1]);
                assert_eq!(node.address.digit().and_then(|digit| parent.child(digit)), Some(node));
            }
        }
        assert_eq!(Address::parse("0124"), None);
        assert_eq!(Address::parse(&"3".repeat(15)).map(Address::level), Some(15));
        assert_eq!(Address::parse(&"3".repeat(16)), None);
    }

    #[test]
    fn neighbors_by_digits_are_the_squares_beyond_each_side_across_patches_too() {
        for node in nodes() {
            let square = node.square(PATCH).expect("two cells at least");
            for side in SIDES {
                let (text, carried) = neighbor_by_digits(&node.address.to_string(), side);
                let (address, leaves) = node.address.neighbor(side);
                assert_eq!((address.to_string(), leaves), (text, carried), "{node} {side:?}");
                let (dx, dy) = side.step();
                let beyond = node.neighbor(side).square(PATCH).expect("the same size");
                let expected = square.corner.moved(dx * square.side, dy * square.side);
                assert_eq!(beyond, NodeSquare { corner: expected, side: square.side }, "{node} {side:?}");
            }
        }
    }

    #[test]
    fn neighbors_are_right_for_the_longest_addresses() {
        for digits in ["333333333333333", "000000000000000", "012301230123012", "222222222222221"] {
            let address = Address::parse(digits).expect("15 digits");
            for side in SIDES {
                let (found, leaves) = address.neighbor(side);
                assert_eq!(
                    (found.to_string(), leaves),
                    neighbor_by_digits(digits, side),
                    "{digits} {side:?}"
                );
            }
        }
    }

    #[test]
    fn a_corner_neighbor_is_the_neighbor_of_a_neighbor() {
        let node = |digits| QuadNode { east: 0, north: 0, address: Address::parse(digits).expect("digits") };
        assert_eq!(node("0").neighbor(NodeSide::North).neighbor(NodeSide::East), node("3"));
        assert_eq!(node("30").neighbor(NodeSide::South).neighbor(NodeSide::West), node("03"));
        assert_eq!(node("3").neighbor(NodeSide::North).to_string(), "0,1:1");
    }

    #[test]
    fn every_vertex_belongs_to_one_node_or_is_a_patch_corner_or_an_edge_vertex_of_two() {
        let mut owners = vec![0; 49 * 49];
        for node in nodes() {
            let square = node.square(PATCH).expect("two cells at least");
            assert_eq!(QuadNode::of_center(square.center(), PATCH), Some(node));
            for vertex in square.vertices() {
                owners[(vertex.y * 49 + vertex.x) as usize] += 1;
            }
        }
        for (index, owned) in owners.into_iter().enumerate() {
            let vertex = Vertex::new(index as i32 % 49, index as i32 / 49);
            let on_border = vertex.x % 48 == 0 || vertex.y % 48 == 0;
            let expected = match vertex.kind() {
                _ if (vertex.x | vertex.y) % PATCH == 0 => 0,
                VertexKind::Center => 1,
                _ if on_border => 1,
                _ => 2,
            };
            assert_eq!(owned, expected, "{vertex:?}");
            if vertex.kind() != VertexKind::Center {
                assert_eq!(QuadNode::of_center(vertex, PATCH), None);
            }
        }
    }

    #[test]
    fn the_dependencies_of_the_five_vertices_are_the_parents_of_the_vertex_graph() {
        let sorted = |mut pair: [Vertex; 2]| {
            pair.sort();
            pair
        };
        for node in nodes() {
            let square = node.square(PATCH).expect("two cells at least");
            match node.center_depends_on(PATCH) {
                Some(corners) => assert_eq!(sorted(corners), sorted(square.center().parents()), "{node}"),
                None => assert_eq!(node.address, Address::ROOT),
            }
            for side in SIDES {
                let centers = node.edge_depends_on(side, PATCH).expect("two cells at least");
                assert_eq!(sorted(centers), sorted(square.edge(side).parents()), "{node} {side:?}");
            }
        }
    }
}
