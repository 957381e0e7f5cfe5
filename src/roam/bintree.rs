//! The triangle bintree as pure arithmetic: a triangle is its three corners.

use crate::graph::Vertex;

/// A right isosceles triangle, counter-clockwise seen from above.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Triangle {
    /// The right-angled corner.
    pub apex: Vertex,
    /// The end of the hypotenuse that follows the apex counter-clockwise.
    pub left: Vertex,
    /// The other end of the hypotenuse.
    pub right: Vertex,
}

impl Triangle {
    /// The two triangles of the square patch with south-west corner `corner` and side `side`, a power of two. The diagonal
    /// between them alternates from patch to patch, as in the vertex graph.
    #[inline]
    pub const fn roots(corner: Vertex, side: i32) -> [Self; 2] {
        let (south_east, north_west) = (corner.moved(side, 0), corner.moved(0, side));
        let north_east = corner.moved(side, side);
        if (corner.x / side + corner.y / side) % 2 == 0 {
            [
                Self { apex: south_east, left: north_east, right: corner },
                Self { apex: north_west, left: corner, right: north_east },
            ]
        } else {
            [
                Self { apex: corner, left: south_east, right: north_west },
                Self { apex: north_east, left: north_west, right: south_east },
            ]
        }
    }

    /// The middle of the hypotenuse: activating this vertex splits the triangle.
    #[inline]
    pub const fn split_vertex(&self) -> Vertex {
        self.left.middle(self.right)
    }

    /// The halves left and right of the line from the apex to the middle of the hypotenuse.
    #[inline]
    pub const fn split(&self) -> [Self; 2] {
        let apex = self.split_vertex();
        [Self { apex, left: self.apex, right: self.left }, Self { apex, left: self.right, right: self.apex }]
    }

    /// Whether no grid vertex lies on its hypotenuse, so that it cannot be split.
    #[inline]
    pub const fn is_finest(&self) -> bool {
        let dx = self.left.x - self.right.x;
        let dy = self.left.y - self.right.y;
        dx * dx + dy * dy <= 2
    }

    /// Its corners, counter-clockwise.
    #[inline]
    pub const fn corners(&self) -> [Vertex; 3] {
        [self.apex, self.left, self.right]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn doubled_area(triangle: &Triangle) -> i32 {
        let [a, b, c] = triangle.corners();
        (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x)
    }

    fn visit(triangle: Triangle, seen: &mut Vec<Triangle>) {
        seen.push(triangle);
        if !triangle.is_finest() {
            for half in triangle.split() {
                visit(half, seen);
            }
        }
    }

    #[test]
    fn halves_keep_orientation_area_and_the_graph_s_parents() {
        for corner in [Vertex::new(0, 0), Vertex::new(8, 0), Vertex::new(0, 8), Vertex::new(8, 8)] {
            let mut seen = Vec::new();
            for root in Triangle::roots(corner, 8) {
                visit(root, &mut seen);
            }
            for triangle in seen {
                assert!(doubled_area(&triangle) > 0, "{triangle:?}");
                if !triangle.is_finest() {
                    let vertex = triangle.split_vertex();
                    assert!(vertex.parents().contains(&triangle.apex), "{triangle:?} at {vertex:?}");
                    let halves: i32 = triangle.split().iter().map(doubled_area).sum();
                    assert_eq!(halves, doubled_area(&triangle));
                }
            }
        }
    }

    #[test]
    fn the_finest_diagonals_are_those_of_the_ground_lattice() {
        use sandtable_terrain::cell_triangle::Diagonal;
        use sandtable_terrain::lattice::Post;
        let mut seen = Vec::new();
        for root in Triangle::roots(Vertex::new(0, 0), 8) {
            visit(root, &mut seen);
        }
        for triangle in seen.iter().filter(|triangle| triangle.is_finest()) {
            let (left, right) = (triangle.left, triangle.right);
            let rises = (left.x - right.x) * (left.y - right.y) > 0;
            let cell = Post { column: left.x.min(right.x) as u32, row: left.y.min(right.y) as u32 };
            assert_eq!(rises, Diagonal::of_cell(cell) == Diagonal::Rising);
        }
    }
}
