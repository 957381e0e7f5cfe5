//! The relief around every vertex: highest less lowest post of the square or diamond it is the middle of.
//!
//! The range of a triangle is that of its two halves, so one walk from the finest triangles up finds all of them, and reads
//! no post more than six times. Triangles without area, beyond the lattice's border, are ignored.

use rayon::prelude::*;

use crate::bintree::Triangle;
use crate::errors::ErrorMap;
use crate::graph::Vertex;
use crate::layout::PatchLayout;
use sandtable_terrain::lattice::Lattice;

impl ErrorMap {
    /// The relief of `lattice` around every vertex in meters, raised to that of the children: infinite over data and no
    /// data at once, 0 over no data at all. In parallel over patches, the same for any number of threads.
    pub fn relief(lattice: &Lattice, layout: &PatchLayout) -> Self {
        let patches: Vec<Vertex> = layout.patches().collect();
        let measured: Vec<PatchRanges> =
            patches.par_iter().map(|&corner| PatchRanges::new(lattice, layout, corner)).collect();
        let mut ranges = vec![HeightRange::NOTHING; layout.vertex_count()];
        for patch in &measured {
            for (row, own) in patch.ranges.chunks_exact(patch.side).enumerate() {
                let start = layout.index(patch.corner.moved(0, row as i32));
                for (range, own) in ranges[start..start + patch.side].iter_mut().zip(own) {
                    *range = range.with(*own);
                }
            }
        }
        Self::raised(ranges.into_iter().map(HeightRange::relief_m).collect(), layout)
    }
}

/// The heights of some posts.
#[derive(Clone, Copy, Debug)]
struct HeightRange {
    low: f32,
    high: f32,
    torn: bool,
}

impl HeightRange {
    const NOTHING: Self = Self { low: f32::INFINITY, high: f32::NEG_INFINITY, torn: false };

    fn new(height: f32) -> Self {
        if height.is_nan() {
            Self { torn: true, ..Self::NOTHING }
        } else {
            Self { low: height, high: height, torn: false }
        }
    }

    fn with(self, other: Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high), torn: self.torn || other.torn }
    }

    fn relief_m(self) -> f32 {
        match (self.low <= self.high, self.torn) {
            (false, _) => 0.0,
            (true, true) => f32::INFINITY,
            (true, false) => self.high - self.low,
        }
    }
}

/// The ranges of the triangles of one patch, by the vertices that split them, row by row from the south-west.
struct PatchRanges {
    corner: Vertex,
    side: usize,
    ranges: Vec<HeightRange>,
}

impl PatchRanges {
    fn new(lattice: &Lattice, layout: &PatchLayout, corner: Vertex) -> Self {
        let side = layout.patch() as usize + 1;
        let mut patch = Self { corner, side, ranges: vec![HeightRange::NOTHING; side * side] };
        for root in Triangle::roots(corner, layout.patch()) {
            patch.cover(lattice, layout, &root);
        }
        patch
    }

    /// The range of a triangle; the recursion is as deep as the patch has levels.
    fn cover(&mut self, lattice: &Lattice, layout: &PatchLayout, triangle: &Triangle) -> HeightRange {
        if triangle.is_finest() {
            return finest(lattice, layout, triangle);
        }
        let [left, right] = triangle.split();
        let range = self.cover(lattice, layout, &left).with(self.cover(lattice, layout, &right));
        let at = triangle.split_vertex().moved(-self.corner.x, -self.corner.y);
        let slot = &mut self.ranges[at.y as usize * self.side + at.x as usize];
        *slot = slot.with(range);
        range
    }
}

fn finest(lattice: &Lattice, layout: &PatchLayout, triangle: &Triangle) -> HeightRange {
    let posts = triangle.corners().map(|vertex| layout.post(vertex));
    // Legs are one cell long: a corner beyond the border falls on another corner.
    if posts[0] == posts[1] || posts[1] == posts[2] || posts[2] == posts[0] {
        return HeightRange::NOTHING;
    }
    let ranges = posts.map(|post| HeightRange::new(lattice.height(post)));
    ranges.into_iter().fold(HeightRange::NOTHING, HeightRange::with)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec2;
    use proptest::prelude::*;

    /// The relief of the two triangles at a vertex by asking every post whether it lies in them.
    fn plain_m(lattice: &Lattice, layout: &PatchLayout, vertex: Vertex) -> f32 {
        let [from, to] = vertex.hypotenuse();
        let apexes = vertex.parents().into_iter().filter(|&apex| layout.contains(apex));
        let sides: Vec<[Vertex; 3]> = apexes.map(|apex| [apex, from, to]).collect();
        let range = lattice
            .posts()
            .filter(|post| {
                let at = Vertex::new(post.column as i32, post.row as i32);
                sides.iter().any(|corners| covers(corners, at))
            })
            .map(|post| HeightRange::new(lattice.height(post)))
            .fold(HeightRange::NOTHING, HeightRange::with);
        range.relief_m()
    }

    fn covers([a, b, c]: &[Vertex; 3], at: Vertex) -> bool {
        let turn = |from: &Vertex, to: &Vertex| {
            ((to.x - from.x) * (at.y - from.y) - (to.y - from.y) * (at.x - from.x)).signum()
        };
        let turns = [turn(a, b), turn(b, c), turn(c, a)];
        !(turns.contains(&1) && turns.contains(&-1))
    }

    proptest! {
        #[test]
        fn relief_is_highest_less_lowest_post_around_a_vertex(
            heights in proptest::collection::vec(-9.0..9.0f32, 17 * 33), hole in 0usize..17 * 33,
        ) {
            let mut heights = heights;
            heights[hole] = f32::NAN;
            let layout = PatchLayout::new(17, 33, 8).expect("sound");
            let lattice = Lattice::new(DVec2::ZERO, DVec2::ONE, 17, heights).expect("sound");
            let all = layout.patches().next().map(|_| (0..33).flat_map(|y| (0..17).map(move |x| Vertex::new(x, y))));
            let vertices: Vec<Vertex> =
                all.into_iter().flatten().filter(|&vertex| !layout.is_corner(vertex)).collect();
            let mut own = vec![0f32; layout.vertex_count()];
            for &vertex in &vertices {
                own[layout.index(vertex)] = plain_m(&lattice, &layout, vertex);
            }
            let relief = ErrorMap::relief(&lattice, &layout);
            relief.check(&layout);
            prop_assert_eq!(relief, ErrorMap::raised(own, &layout));
        }
    }

    #[test]
    fn ground_beyond_the_border_and_ground_without_data_have_no_relief() {
        let layout = PatchLayout::new(10, 17, 16).expect("sound");
        let mut heights: Vec<f32> = (0..170).map(|index| index as f32).collect();
        heights[..80].fill(f32::NAN);
        let lattice = Lattice::new(DVec2::ZERO, DVec2::ONE, 10, heights).expect("sound");
        let relief = ErrorMap::relief(&lattice, &layout);
        assert_eq!(relief.at(&layout, Vertex::new(13, 13)), 0.0);
        assert_eq!(relief.at(&layout, Vertex::new(4, 2)), 0.0);
        assert_eq!(relief.at(&layout, Vertex::new(8, 8)), f32::INFINITY);
        assert_eq!(relief.at(&layout, Vertex::new(5, 14)), 20.0);
    }
}
