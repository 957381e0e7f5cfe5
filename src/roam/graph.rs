//! The vertex graph as pure arithmetic on coordinates.
//!
//! With `k` the largest power of two that divides both coordinates, a vertex is the center of a square of side 2k where
//! both coordinates divided by k are odd, else the middle of an edge of length 2k:
//!
//! ```text
//! o───────e───────o      k = 1: c is a center (both odd), e are edge middles
//! │       │       │      k = 2 and more: o
//! e───────c───────e
//! │       │       │      a triangle is split at its hypotenuse's middle, which is
//! o───────e───────o      then the right-angled corner of both halves
//! ```
//!
//! A split needs the two triangles that share the hypotenuse, and they exist once their right-angled corners are active:
//! these corners are the vertex's parents. The parents of an edge middle are the two centers beside it; those of a center
//! are the two edge middles among the corners of its square.

/// A grid vertex, counted from the south-west corner of the first patch.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Vertex {
    /// Eastward.
    pub x: i32,
    /// Northward.
    pub y: i32,
}

/// The kind of a vertex: what it is the middle of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VertexKind {
    /// A square of side 2k: its hypotenuse is a diagonal.
    Center,
    /// An edge of length 2k that runs east.
    EastEdge,
    /// An edge of length 2k that runs north.
    NorthEdge,
}

impl Vertex {
    /// The vertex at (`x`, `y`).
    #[inline]
    pub const fn new(x: i32, y: i32) -> Self {
        Self { x, y }
    }

    /// This vertex moved by (`dx`, `dy`).
    #[inline]
    pub const fn moved(self, dx: i32, dy: i32) -> Self {
        Self { x: self.x + dx, y: self.y + dy }
    }

    /// The vertex halfway to `other`; exact for the ends of a hypotenuse.
    #[inline]
    pub const fn middle(self, other: Self) -> Self {
        Self { x: (self.x + other.x) / 2, y: (self.y + other.y) / 2 }
    }

    /// Half the side of the square, or half the length of the edge, that this vertex is the middle of. Meaningless for the
    /// origin, which is a patch corner whatever the patch size.
    #[inline]
    pub const fn step(self) -> i32 {
        let bits = self.x | self.y;
        bits & bits.wrapping_neg()
    }

    /// What this vertex is the middle of.
    #[inline]
    pub const fn kind(self) -> VertexKind {
        let step = self.step();
        match ((self.x & step) != 0, (self.y & step) != 0) {
            (true, true) => VertexKind::Center,
            (true, false) => VertexKind::EastEdge,
            _ => VertexKind::NorthEdge,
        }
    }

    /// The ends of the hypotenuse that this vertex splits.
    #[inline]
    pub const fn hypotenuse(self) -> [Self; 2] {
        let step = self.step();
        match self.kind() {
            VertexKind::EastEdge => [self.moved(-step, 0), self.moved(step, 0)],
            VertexKind::NorthEdge => [self.moved(0, -step), self.moved(0, step)],
            VertexKind::Center if self.diagonal_rises() => [self.moved(-step, -step), self.moved(step, step)],
            VertexKind::Center => [self.moved(-step, step), self.moved(step, -step)],
        }
    }

    /// The vertices that must be active before this one: the right-angled corners of the two triangles that share its
    /// hypotenuse. On the border of the terrain one of them lies outside.
    #[inline]
    pub const fn parents(self) -> [Self; 2] {
        let step = self.step();
        match self.kind() {
            VertexKind::EastEdge => [self.moved(0, -step), self.moved(0, step)],
            VertexKind::NorthEdge => [self.moved(-step, 0), self.moved(step, 0)],
            VertexKind::Center if self.diagonal_rises() => [self.moved(-step, step), self.moved(step, -step)],
            VertexKind::Center => [self.moved(-step, -step), self.moved(step, step)],
        }
    }

    /// The bit, 1 or 2, of the triangle that this vertex splits and whose right-angled corner is `apex`, a parent: 1 for
    /// the parent that is smaller in (y, x).
    #[inline]
    pub const fn side_bit(self, apex: Self) -> u8 {
        if apex.y < self.y || (apex.y == self.y && apex.x < self.x) { 1 } else { 2 }
    }

    /// Whether any vertex has this one as a parent: all but the edge middles of the finest level have.
    #[inline]
    pub const fn has_children(self) -> bool {
        (self.x ^ self.y) & 1 == 0
    }

    /// The vertices that have this one as a parent.
    #[inline]
    pub fn children(self) -> impl Iterator<Item = Self> {
        let step = self.step();
        let (reach, offsets) = match self.kind() {
            VertexKind::Center => (step, [(-1, 0), (1, 0), (0, -1), (0, 1)]),
            _ => (step / 2, [(-1, -1), (1, -1), (-1, 1), (1, 1)]),
        };
        let present = if reach > 0 { 4 } else { 0 };
        offsets.into_iter().take(present).map(move |(dx, dy)| self.moved(dx * reach, dy * reach))
    }

    /// Whether a center's hypotenuse runs from south-west to north-east: it joins the corners of its square whose
    /// coordinates, in units of the square's side, are both even or both odd.
    #[inline]
    const fn diagonal_rises(self) -> bool {
        (self.x ^ self.y) & (self.step() * 2) == 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn inner_vertices() -> impl Iterator<Item = Vertex> {
        (1..64).flat_map(|x| (1..64).map(move |y| Vertex::new(x, y)))
    }

    #[test]
    fn every_child_names_its_parent_and_every_parent_its_child() {
        for vertex in inner_vertices().filter(|vertex| vertex.step() < 32) {
            for child in vertex.children() {
                assert!(child.parents().contains(&vertex), "{vertex:?} of {child:?}");
            }
            assert_eq!(vertex.has_children(), vertex.children().count() > 0, "{vertex:?}");
            for parent in vertex.parents() {
                assert!(parent.children().any(|child| child == vertex), "{parent:?} of {vertex:?}");
            }
        }
    }

    #[test]
    fn the_ends_and_the_parents_are_the_four_corners_around_a_vertex() {
        for vertex in inner_vertices() {
            let [from, to] = vertex.hypotenuse();
            assert_eq!(from.middle(to), vertex);
            for parent in vertex.parents() {
                let square = |a: Vertex, b: Vertex| (a.x - b.x).pow(2) + (a.y - b.y).pow(2);
                assert_eq!(square(parent, from), square(parent, to), "right-angled at {parent:?}");
                assert_eq!(square(parent, from) * 2, square(from, to));
            }
        }
    }

    #[test]
    fn parents_are_on_the_next_coarser_level() {
        for vertex in inner_vertices().filter(|vertex| vertex.step() < 16) {
            for parent in vertex.parents().into_iter().filter(|parent| parent.step() < 32) {
                match vertex.kind() {
                    VertexKind::Center => assert_eq!(parent.step(), vertex.step() * 2),
                    _ => assert_eq!((parent.step(), parent.kind()), (vertex.step(), VertexKind::Center)),
                }
            }
        }
    }
}
