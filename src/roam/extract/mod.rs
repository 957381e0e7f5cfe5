//! Triangles for a tolerance without a view: the mesh of a terrain for a file or a tile.
//!
//! An error map never grows toward the children, so the vertices whose error is above a tolerance are closed under parents,
//! and no walk from the roots is needed. Three passes in storage order:
//!
//! 1. One bit a vertex: error above the tolerance, or patch corner.
//! 2. Vertices are numbered in that order; a vertex's number is the count of bits before it.
//! 3. A triangle that is no root has a right-angled corner that some split has made. So the triangles around
//!    each vertex are those over its four quadrants whose own split vertex is not active:
//!
//! ```text
//! o───────q───────o        m an edge middle, q the corners around it (its hypotenuse's ends and its parents),
//! │     ╱ │ ╲     │        c its children: the triangle m, q, q exists where c is not active. A center is the
//! │   c   │   c   │        same, turned by 45°.
//! │ ╱     │     ╲ │
//! q───────m───────q
//! ```
//!
//! A recursion from the roots visits every inner triangle too, branches at each, and looks up each corner's number in a table
//! as large as the terrain.

mod bits;

use crate::bintree::Triangle;
use crate::emit::world::doubled_area;
use crate::errors::ErrorMap;
use crate::extract::bits::{ActiveBits, places};
use crate::graph::Vertex;
use crate::layout::PatchLayout;
use sandtable_terrain::lattice::Post;

/// A mesh of posts, and the memory it was made in: extracting again reuses it.
#[derive(Clone, Debug, Default)]
pub struct Extract {
    vertices: Vec<u32>,
    /// As long as the longest list so far; the first `count` are the mesh's.
    triangles: Vec<[u32; 3]>,
    count: usize,
    bits: ActiveBits,
}

impl Extract {
    /// The posts used, each once, as the lattice numbers them: row by row from the south-west.
    pub fn vertices(&self) -> &[u32] {
        &self.vertices
    }

    /// Corners of the triangles by their place in [`Extract::vertices`], counter-clockwise seen from above, in an
    /// order that depends on nothing but the mesh.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles[..self.count]
    }

    /// Drops the triangles with a corner for which `keep`, called with the post's number, returns false, and the vertices
    /// that become unused; for posts without data.
    pub fn retain(&mut self, keep: impl Fn(u32) -> bool) {
        let corners: Vec<u32> = self.vertices.clone();
        self.renumber(&corners, |posts| posts.iter().all(|&post| keep(post)));
    }

    /// Gives every vertex the post in `posts`, and merges those that share one.
    fn renumber(&mut self, posts: &[u32], keep: impl Fn([u32; 3]) -> bool) {
        let mut sorted = posts.to_vec();
        sorted.sort();
        sorted.dedup();
        let place: Vec<u32> =
            posts.iter().map(|post| sorted.partition_point(|other| other < post) as u32).collect();
        let mut number = vec![u32::MAX; sorted.len()];
        let mut kept = 0;
        for index in 0..self.count {
            let corners = self.triangles[index].map(|corner| corner as usize);
            let [a, b, c] = corners.map(|corner| place[corner]);
            if a == b || b == c || c == a || !keep(corners.map(|corner| posts[corner])) {
                continue;
            }
            for corner in [a, b, c] {
                number[corner as usize] = 0;
            }
            self.triangles[kept] = [a, b, c];
            kept += 1;
        }
        self.count = kept;
        self.vertices.clear();
        for (number, &post) in number.iter_mut().zip(&sorted).filter(|(number, _)| **number == 0) {
            *number = self.vertices.len() as u32;
            self.vertices.push(post);
        }
        for triangle in &mut self.triangles[..kept] {
            *triangle = triangle.map(|corner| number[corner as usize]);
        }
    }
}

/// Writes to `out` the triangles of all patches, split wherever the error is above `tolerance_m`, 0 or more.
///
/// Where patches reach past the lattice's border, triangles beyond it are left out. Posts without data are not: see
/// [`Extract::retain`].
pub fn extract(layout: &PatchLayout, errors: &ErrorMap, tolerance_m: f32, out: &mut Extract) {
    out.bits.set(layout, errors.values(), tolerance_m);
    out.bits.number(&mut out.vertices);
    let most = ActiveBits::most_triangles(layout, &out.vertices);
    if out.triangles.len() < most {
        out.triangles = vec![[0; 3]; most];
    }
    let stars = Star::all(&out.bits);
    let mut emit = Emitter { bits: &out.bits, stars: &stars, triangles: &mut out.triangles, count: 0 };
    emit.roots(layout);
    emit.rows();
    out.count = emit.count;
    clamp_to_border(layout, out);
}

/// Replaces the vertices beyond a border by their posts.
fn clamp_to_border(layout: &PatchLayout, out: &mut Extract) {
    let (columns, rows) = (layout.columns() as i32, layout.rows() as i32);
    let last = layout.post(Vertex::new(columns - 1, rows - 1));
    if (last.column as i32, last.row as i32) == (columns - 1, rows - 1) {
        return;
    }
    let post = |&index: &u32| {
        let post = layout.post(Vertex::new(index as i32 % columns, index as i32 / columns));
        post.row * (last.column + 1) + post.column
    };
    let posts: Vec<u32> = out.vertices.iter().map(post).collect();
    let width = last.column + 1;
    let has_area = |posts: [u32; 3]| {
        doubled_area(posts.map(|post| Post { column: post % width, row: post / width })) != 0
    };
    out.renumber(&posts, has_area);
}

/// The offsets in storage, wrapping around, of a vertex's corners and children: counter-clockwise, every child between its
/// corner and the next. Centers and edge middles then differ in numbers and not in code, since a branch would hardly be
/// predicted.
#[derive(Clone, Copy, Default)]
struct Star {
    /// In the numbers of even vertices.
    corners: [usize; 4],
    /// In words.
    child_rows: [usize; 4],
    /// In columns.
    child_columns: [usize; 4],
}

impl Star {
    /// Those of edge middles and centers alternately, from the finest step.
    fn all(bits: &ActiveBits) -> Vec<Self> {
        let steps = (0..bits.patch.ilog2()).map(|level| 1isize << level);
        let first = |step: isize| [((step, 0), (step / 2, step / 2)), ((-step, -step), (0, -step))];
        steps.flat_map(first).map(|(corner, child)| Self::new(bits, corner, child)).collect()
    }

    fn new(bits: &ActiveBits, mut corner: (isize, isize), mut child: (isize, isize)) -> Self {
        let mut star = Self::default();
        for at in 0..4 {
            star.corners[at] = (corner.1 / 2 * bits.even_width as isize + corner.0 / 2) as usize;
            star.child_rows[at] = (child.1 * bits.width as isize) as usize;
            star.child_columns[at] = child.0 as usize;
            (corner, child) = ((-corner.1, corner.0), (-child.1, child.0));
        }
        star
    }
}

/// The pass that writes triangles.
struct Emitter<'a> {
    bits: &'a ActiveBits,
    stars: &'a [Star],
    triangles: &'a mut [[u32; 3]],
    count: usize,
}

impl Emitter<'_> {
    /// The roots of patches that are not split.
    fn roots(&mut self, layout: &PatchLayout) {
        let half = layout.patch() / 2;
        for corner in layout.patches() {
            if !self.bits.get((corner.x + half) as usize, (corner.y + half) as usize) {
                for root in Triangle::roots(corner, layout.patch()) {
                    let number = |vertex: Vertex| self.bits.rank(vertex.x as usize, vertex.y as usize);
                    let corners = root.corners().map(number);
                    self.put(corners);
                }
            }
        }
    }

    fn put(&mut self, triangle: [u32; 3]) {
        self.triangles[self.count] = triangle;
        self.count += 1;
    }

    fn rows(&mut self) {
        for y in 0..self.bits.rows {
            if y == 0 || y + 1 == self.bits.rows {
                self.border_row(y);
            } else if y % 2 == 1 {
                self.odd_row(y);
            } else {
                self.even_row(y);
            }
        }
    }

    fn border_row(&mut self, y: usize) {
        for place in 0..self.bits.width {
            for bit in places(self.bits.words[y * self.bits.width + place]) {
                self.around(place * 64 + bit as usize, y);
            }
        }
    }

    /// Finest north edges at even columns, finest centers between them.
    fn odd_row(&mut self, y: usize) {
        let ActiveBits { words, before, width, columns, .. } = self.bits;
        let row = |y: usize| (&words[y * width..][..*width], &before[y * width..][..*width]);
        let ((low, low_before), (mid, mid_before), (high, high_before)) = (row(y - 1), row(y), row(y + 1));
        for place in 0..*width {
            let word = mid[place];
            if word == 0 {
                continue;
            }
            let (south, north) = (low[place], high[place]);
            let first = place * 64;
            let outer = u64::from(place == 0) | u64::from(first + 64 >= *columns) << ((columns - 1) % 64);
            for bit in places(word & EVEN & outer) {
                self.around(first + bit as usize, y);
            }
            for bit in places(word & EVEN & !outer) {
                let own = rank(mid_before[place], word, bit);
                let beside = [rank(high_before[place], north, bit), rank(low_before[place], south, bit)];
                self.put_all(own, beside);
            }
            // An odd column is never a word's first; the vertex east of its last is the next word's first.
            let after = mid.get(place + 1).is_some_and(|next| next & 1 == 1);
            let east = word >> 1 | u64::from(after) << 63;
            for bit in places(word & !EVEN & !(south & north & east & word << 1)) {
                let own = rank(mid_before[place], word, bit);
                let (below, above) =
                    (rank(low_before[place], south, bit), rank(high_before[place], north, bit));
                let has = |word: u64| word >> bit & 1;
                let (below_east, above_east) = (below + has(south) as u32, above + has(north) as u32);
                let (below_west, above_west) = (below - 1, above - 1);
                let children = [has(south), has(east), has(north), has(word << 1)];
                self.put_missing(own, [below_west, below_east, above_east, above_west], children);
            }
        }
    }

    /// Finest east edges at odd columns, coarser vertices between them.
    fn even_row(&mut self, y: usize) {
        let ActiveBits { words, before, width, columns, .. } = self.bits;
        let row = |y: usize| (&words[y * width..][..*width], &before[y * width..][..*width]);
        let ((low, low_before), (mid, mid_before), (high, high_before)) = (row(y - 1), row(y), row(y + 1));
        for place in 0..*width {
            let word = mid[place];
            if word == 0 {
                continue;
            }
            let (south, north) = (low[place], high[place]);
            let first = place * 64;
            for bit in places(word & !EVEN) {
                let own = rank(mid_before[place], word, bit);
                let beside = [rank(high_before[place], north, bit), rank(low_before[place], south, bit)];
                self.put_all(own, beside);
            }
            for bit in places(word & EVEN) {
                let x = first + bit as usize;
                let step = 1usize << (x | y).trailing_zeros();
                if x == 0 || x + 1 == *columns || step >= self.bits.patch {
                    self.around(x, y);
                } else {
                    self.coarse(x, y, step);
                }
            }
        }
    }

    /// The triangles around a vertex inside the layout whose four quadrants are there.
    fn coarse(&mut self, x: usize, y: usize, step: usize) {
        let bits = self.bits;
        let is_center = usize::from(x & y & step != 0);
        let star = &self.stars[2 * step.trailing_zeros() as usize + is_center];
        let row = y * bits.width;
        let child = |at: usize| {
            let x = x.wrapping_add(star.child_columns[at]);
            bits.words[row.wrapping_add(star.child_rows[at]).wrapping_add(x / 64)] >> (x % 64) & 1
        };
        let children = [child(0), child(1), child(2), child(3)];
        if children[0] & children[1] & children[2] & children[3] == 1 {
            return;
        }
        let place = y / 2 * bits.even_width + x / 2;
        let corner = |at: usize| bits.even_numbers[place.wrapping_add(star.corners[at])];
        self.put_missing(bits.even_numbers[place], [corner(0), corner(1), corner(2), corner(3)], children);
    }

    /// The triangles around any vertex, by the graph's own rules: patch corners and the terrain's border.
    fn around(&mut self, x: usize, y: usize) {
        let bits = self.bits;
        let vertex = Vertex::new(x as i32, y as i32);
        if (x | y) & (bits.patch - 1) == 0 {
            return;
        }
        let inside =
            |at: Vertex| (0..bits.columns as i32).contains(&at.x) && (0..bits.rows as i32).contains(&at.y);
        let step = vertex.step();
        let offsets = match (vertex.x & vertex.y & step) != 0 {
            true => [(-1, -1), (1, -1), (1, 1), (-1, 1)],
            false => [(1, 0), (0, 1), (-1, 0), (0, -1)],
        };
        let corners = offsets.map(|(dx, dy)| vertex.moved(dx * step, dy * step));
        let number = |at: Vertex| bits.rank(at.x as usize, at.y as usize);
        for (index, left) in corners.into_iter().enumerate() {
            let right = corners[(index + 1) % 4];
            let child = left.middle(right);
            let split = step > 1 || (vertex.x & vertex.y & 1) != 0;
            if inside(left) && inside(right) && !(split && bits.get(child.x as usize, child.y as usize)) {
                self.put([number(vertex), number(left), number(right)]);
            }
        }
    }

    /// The four triangles around a finest edge middle, `beside` its neighbors north and south.
    #[inline]
    fn put_all(&mut self, own: u32, [b, d]: [u32; 2]) {
        let (a, c) = (own + 1, own - 1);
        let slots = &mut self.triangles[self.count..self.count + 4];
        slots.copy_from_slice(&[[own, a, b], [own, b, c], [own, c, d], [own, d, a]]);
        self.count += 4;
    }

    /// Puts the triangles whose children, 0 or 1, are 0. All are written, and the count keeps the right ones, since a branch
    /// would hardly be predicted.
    fn put_missing(&mut self, own: u32, [a, b, c, d]: [u32; 4], children: [u64; 4]) {
        let slots = &mut self.triangles[self.count..self.count + 4];
        let mut kept = 0;
        for (triangle, child) in
            [[own, a, b], [own, b, c], [own, c, d], [own, d, a]].into_iter().zip(children)
        {
            slots[kept & 3] = triangle;
            kept += 1 - child as usize;
        }
        self.count += kept;
    }
}

/// The even places of a word.
const EVEN: u64 = 0x5555_5555_5555_5555;

/// The number of the vertex at `bit` of `word`, with `before` vertices in front of the word.
#[inline]
fn rank(before: u32, word: u64, bit: u32) -> u32 {
    before + (word & ((1 << bit) - 1)).count_ones()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::criterion::flat::Flat;
    use crate::displayed::DisplayedTerrain;
    use crate::refine::rebuild::rebuild;
    use glam::DVec2;
    use proptest::prelude::*;
    use sandtable_mesh::trimesh::TriMesh;
    use sandtable_terrain::lattice::Lattice;
    use std::sync::Arc;

    fn rough(columns: u32, rows: u32, holes: &[usize]) -> Arc<Lattice> {
        let mut state = 1u32;
        let mut noise = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) as f32 / 16_777_216.0
        };
        let mut heights: Vec<f32> = (0..columns * rows)
            .map(|at| 20.0 * libm::sinf((at % columns) as f32 * 0.11) + 4.0 * noise() * noise())
            .collect();
        for hole in holes {
            heights[hole % (columns * rows) as usize] = f32::NAN;
        }
        Arc::new(Lattice::new(DVec2::ZERO, DVec2::ONE, columns, heights).expect("sound"))
    }

    /// Triangles as sorted posts, the lowest corner first, the way round kept.
    fn sorted(triangles: impl Iterator<Item = [u32; 3]>) -> Vec<[u32; 3]> {
        let mut triangles: Vec<[u32; 3]> = triangles
            .map(|[a, b, c]| [[a, b, c], [b, c, a], [c, a, b]].into_iter().min().expect("three"))
            .collect();
        triangles.sort_unstable();
        triangles
    }

    fn displayed(
        lattice: &Arc<Lattice>,
        layout: &PatchLayout,
        map: &ErrorMap,
        tolerance_m: f32,
    ) -> Vec<[u32; 3]> {
        let active = rebuild(layout, &Flat::new(layout, map, tolerance_m), layout.patches());
        let terrain = DisplayedTerrain::new(lattice.clone(), active, layout.patches().collect());
        let mut mesh = TriMesh::default();
        terrain.emit(&mut mesh);
        let post = |position: glam::Vec3| position.y as u32 * lattice.columns() + position.x as u32;
        sorted((0..mesh.triangles.len()).map(|index| mesh.corners(index).map(post)))
    }

    fn check(out: &Extract) {
        assert!(out.vertices().is_sorted_by(|a, b| a < b), "every post once");
        let mut used = vec![false; out.vertices().len()];
        out.triangles().iter().flatten().for_each(|&corner| used[corner as usize] = true);
        assert!(used.iter().all(|&used| used), "no vertex without a triangle");
    }

    fn posts(out: &Extract) -> Vec<[u32; 3]> {
        check(out);
        sorted(out.triangles().iter().map(|triangle| triangle.map(|corner| out.vertices()[corner as usize])))
    }

    proptest! {
        #[test]
        fn what_is_extracted_is_what_the_refiner_and_the_bintree_show(
            columns in 2u32..180, rows in 2u32..180, power in 1u32..8, snug: bool,
            tolerances in proptest::collection::vec(0f32..6.0, 1..4),
            holes in proptest::collection::vec(0usize..40_000, 0..5),
        ) {
            let patch = 1 << power;
            let fit = |posts: u32| if snug { (posts - 1).next_multiple_of(patch) + 1 } else { posts };
            let (columns, rows) = (fit(columns), fit(rows));
            let lattice = rough(columns, rows, &holes);
            let layout = PatchLayout::new(columns, rows, patch).expect("sound");
            let map = ErrorMap::midpoint(&lattice, &layout);
            let mut out = Extract::default();
            for tolerance_m in tolerances {
                extract(&layout, &map, tolerance_m, &mut out);
                out.retain(|post| !lattice.heights()[post as usize].is_nan());
                prop_assert_eq!(posts(&out), displayed(&lattice, &layout, &map, tolerance_m));
            }
        }
    }

    #[test]
    fn flat_ground_is_two_triangles_a_patch() {
        let layout = PatchLayout::new(129, 65, 64).expect("sound");
        let map = ErrorMap::raised(vec![0.0; 129 * 65], &layout);
        let mut out = Extract::default();
        extract(&layout, &map, 0.0, &mut out);
        assert_eq!((out.vertices().len(), out.triangles().len()), (6, 4));
        check(&out);
    }
}
