//! The exact error of every vertex: a bound.
//!
//! The error of a triangle is the largest vertical distance between its plane and any post it covers, not only the middle of
//! its hypotenuse, since a midpoint error is no bound (for a tolerance of 5 m, midpoint errors leave 7 to 10 m). The error of
//! a vertex is that of the triangles it splits.
//!
//! Two cases make an error infinite, so that refinement continues down to the posts: a triangle that covers both data and
//! no data, and one that is not exact over a pinned post (see [`Lattice::pin`]).
//!
//! Every level measures every post about once, 2·log₂(patch) levels. Where all posts under a vertex's triangles are plain,
//! they are measured in f32 by [`PostTriangle`]; holes, pinned posts and the border's shrunken triangles are measured in f64,
//! post by post, by [`triangle_error`]. The choice depends on the posts under those triangles alone: an error measured by
//! itself is bit for bit the one measured with all others. Both agree within one part in a million of the relief under the
//! triangle.

use std::ops::Range;

use rayon::iter::repeat_n;
use rayon::prelude::*;

use crate::bintree::Triangle;
use crate::errors::ErrorMap;
use crate::errors::near::{self, BlockPosts};
use crate::errors::plane::PostPlane;
use crate::errors::rows::{RowSpan, RowSpans};
use crate::errors::scan::{Hypotenuse, PostTriangle, Worst, larger, largest};
use crate::errors::survey::TileSurvey;
use crate::errors::sweep::SweepSource;
use crate::graph::Vertex;
use crate::layout::PatchLayout;
use sandtable_terrain::lattice::{Lattice, Post};

/// Vertices up to this step are measured block by block while the block's posts are in the cache; those beyond are few, and
/// their posts are scanned in strips.
const NEAR_STEP: i32 = 32;

/// Rows of vertices of one block, a multiple of [`NEAR_STEP`] and of [`near::PERIOD`]: the gathered posts of a block take
/// 15 KiB, which the first cache holds.
const BLOCK_ROWS: usize = 32;

/// Rows of posts of one strip: enough work for a task, little enough that all threads have some.
const STRIP_ROWS: i32 = 64;

impl ErrorMap {
    /// The exact errors of `lattice`; in parallel, the same for any number of threads.
    pub fn exact(lattice: &Lattice, layout: &PatchLayout) -> Self {
        Self { errors: raised_errors(lattice, layout, 1) }
    }
}

/// The errors of [`ErrorMap::exact`] in every `every`-th column and row, 1 or 2.
pub(super) fn raised_errors(lattice: &Lattice, layout: &PatchLayout, every: usize) -> Vec<f32> {
    let counted = |count: usize| (count - 1) / every + 1;
    let (columns, rows) = (counted(layout.columns()), counted(layout.rows()));
    if layout.patch() > 2 * NEAR_STEP {
        let errors = ErrorMap::raised(own_errors(lattice, layout), layout).errors;
        let rows = errors.chunks_exact(layout.columns()).step_by(every);
        return rows.flat_map(|row| row.iter().step_by(every).copied()).collect();
    }
    let measured = MeasuredLattice { lattice, layout, survey: TileSurvey::new(lattice) };
    // All threads fill them: new memory takes time when it is first written.
    let mut errors: Vec<f32> = repeat_n(0.0, columns * rows).collect();
    SweepSource::sweep_made(layout, |south, own| measured.rows(south, own), every, &mut errors);
    errors
}

/// Every vertex's [`own_error`], in the order of [`PatchLayout::index`]; 0 at patch corners, which split nothing.
pub fn own_errors(lattice: &Lattice, layout: &PatchLayout) -> Vec<f32> {
    let measured = MeasuredLattice { lattice, layout, survey: TileSurvey::new(lattice) };
    let mut errors = vec![0f32; layout.vertex_count()];
    errors.par_chunks_mut(BLOCK_ROWS * layout.columns()).enumerate().for_each(|(band, errors)| {
        measured.band((band * BLOCK_ROWS) as i32, errors);
    });
    for (vertex, error) in measured.far_vertices() {
        errors[layout.index(vertex)] = error;
    }
    errors
}

/// The largest vertical distance in meters between the ground and the one or two triangles that `vertex` splits, not raised
/// to that of its children: the bits of [`own_errors`]. Infinite and 0 as for [`triangle_error`]; 0 at patch corners.
pub fn own_error(lattice: &Lattice, layout: &PatchLayout, vertex: Vertex) -> f32 {
    if layout.is_corner(vertex) {
        return 0.0;
    }
    match Diamond::new(lattice, layout, vertex).filter(|diamond| diamond.is_plain(lattice)) {
        Some(diamond) => diamond.error(lattice, vertex),
        None => general_error(lattice, layout, vertex),
    }
}

fn general_error(lattice: &Lattice, layout: &PatchLayout, vertex: Vertex) -> f32 {
    let error = |triangle| triangle_error(lattice, layout, &triangle);
    triangles_split_at(layout, vertex).into_iter().flatten().map(error).fold(0.0, f32::max)
}

/// The triangles that `vertex` splits; one of them may be missing at the terrain's border.
#[inline]
pub fn triangles_split_at(layout: &PatchLayout, vertex: Vertex) -> [Option<Triangle>; 2] {
    let [from, to] = vertex.hypotenuse();
    let below = |apex: Vertex| {
        let turn = (from.x - apex.x) * (to.y - apex.y) - (from.y - apex.y) * (to.x - apex.x);
        let (left, right) = if turn > 0 { (from, to) } else { (to, from) };
        layout.contains(apex).then_some(Triangle { apex, left, right })
    };
    let [one, other] = vertex.parents();
    [below(one), below(other)]
}

/// The triangles that a vertex splits, where all their corners are posts.
struct Diamond<'a> {
    first: PostTriangle<'a>,
    second: Option<PostTriangle<'a>>,
}

impl<'a> Diamond<'a> {
    /// `None` where it reaches beyond the lattice.
    fn new(lattice: &'a Lattice, layout: &PatchLayout, vertex: Vertex) -> Option<Self> {
        let on = |triangle: Triangle| PostTriangle::new(lattice, &triangle);
        match triangles_split_at(layout, vertex) {
            [Some(first), Some(second)] => Some(Self { first: on(first)?, second: Some(on(second)?) }),
            [Some(only), None] | [None, Some(only)] => Some(Self { first: on(only)?, second: None }),
            [None, None] => None,
        }
    }

    fn triangles(&self) -> impl Iterator<Item = (&PostTriangle<'a>, Hypotenuse)> {
        let second = self.second.iter().map(|triangle| (triangle, Hypotenuse::Excluded));
        std::iter::once((&self.first, Hypotenuse::Included)).chain(second)
    }

    fn is_plain(&self, lattice: &Lattice) -> bool {
        self.triangles().all(|(triangle, _)| triangle.is_plain(lattice.pinned()))
    }

    fn is_known_plain(&self, survey: &TileSurvey) -> bool {
        self.triangles().all(|(triangle, _)| survey.covers(triangle))
    }

    /// The error where all posts are plain.
    fn error(&self, lattice: &Lattice, vertex: Vertex) -> f32 {
        if self.second.is_some() && vertex.step() <= near::LARGEST_STEP {
            return near::error(lattice.heights(), lattice.columns() as usize, vertex);
        }
        let mut worst = Worst::default();
        for (triangle, hypotenuse) in self.triangles() {
            triangle.scan(0..triangle.rows(), hypotenuse, &mut worst);
        }
        largest(&worst)
    }
}

struct MeasuredLattice<'a> {
    lattice: &'a Lattice,
    layout: &'a PatchLayout,
    survey: TileSurvey,
}

impl<'a> MeasuredLattice<'a> {
    /// Measures the vertices up to [`NEAR_STEP`] of the rows of `errors`, which start at row `south`, a multiple of the steps that
    /// blocks are measured by.
    fn rows(&self, south: usize, errors: &mut [f32]) {
        for (band, errors) in errors.chunks_mut(BLOCK_ROWS * self.layout.columns()).enumerate() {
            self.band((south + band * BLOCK_ROWS) as i32, errors);
        }
    }

    /// Measures the vertices up to [`NEAR_STEP`] of the rows of `errors`, which start at row `south`.
    fn band(&self, south: i32, errors: &mut [f32]) {
        let columns = self.layout.columns();
        for west in (0..columns as i32).step_by(near::BLOCK_COLUMNS) {
            let east = (west + near::BLOCK_COLUMNS as i32).min(columns as i32);
            let block = VertexSpan { west, east, south, north: south + (errors.len() / columns) as i32 };
            let finest = 2 * near::LARGEST_STEP.min(self.layout.patch() / 2);
            if finest == 2 * near::LARGEST_STEP && self.is_plain_around(block) {
                self.near(block, errors);
            } else {
                let is_near = |vertex: Vertex| (vertex.x | vertex.y) & (finest - 1) != 0;
                self.each(block, errors, 1, |vertex| is_near(vertex).then(|| self.error(vertex)));
            }
            let most = 2 * NEAR_STEP.min(self.layout.patch() / 2);
            let is_within = |vertex: Vertex| (vertex.x | vertex.y) & (most - 1) != 0;
            self.each(block, errors, finest, |vertex| is_within(vertex).then(|| self.error(vertex)));
        }
    }

    /// Measures the vertices up to [`near::LARGEST_STEP`] of a block of plain ground.
    fn near(&self, block: VertexSpan, errors: &mut [f32]) {
        let (heights, columns) = (self.lattice.heights(), self.lattice.columns() as usize);
        let rows = (block.north - block.south) as usize;
        let gathered = BlockPosts::new(heights, columns, Vertex::new(block.west, block.south), rows);
        for (row, errors) in errors.chunks_exact_mut(self.layout.columns()).enumerate() {
            gathered.measure_row(row, &mut errors[block.west as usize..block.east as usize]);
        }
        if self.reaches_out(block) {
            let is_out = |vertex: Vertex| {
                let step = vertex.step();
                let corner = |by: i32| vertex.moved(by, by);
                step <= near::LARGEST_STEP && !(self.is_post(corner(-step)) && self.is_post(corner(step)))
            };
            self.each(block, errors, 1, |vertex| is_out(vertex).then(|| self.error(vertex)));
        }
    }

    /// Stores what `measure` returns for the vertices of a block on multiples of `stride`.
    fn each(
        &self,
        block: VertexSpan,
        errors: &mut [f32],
        stride: i32,
        measure: impl Fn(Vertex) -> Option<f32>,
    ) {
        for (row, y) in (block.south..block.north).enumerate().step_by(stride as usize) {
            let errors = &mut errors[row * self.layout.columns()..];
            for x in (block.west..block.east).step_by(stride as usize) {
                if let Some(error) = measure(Vertex::new(x, y)) {
                    errors[x as usize] = error;
                }
            }
        }
    }

    /// [`own_error`], which the survey speeds up.
    fn error(&self, vertex: Vertex) -> f32 {
        let diamond = Diamond::new(self.lattice, self.layout, vertex);
        match diamond.filter(|diamond| diamond.is_known_plain(&self.survey)) {
            Some(diamond) => diamond.error(self.lattice, vertex),
            None => own_error(self.lattice, self.layout, vertex),
        }
    }

    fn is_post(&self, vertex: Vertex) -> bool {
        let (columns, rows) = (self.lattice.columns() as i32, self.lattice.rows() as i32);
        (0..columns).contains(&vertex.x) && (0..rows).contains(&vertex.y)
    }

    /// Whether triangles of the block may reach beyond the lattice.
    fn reaches_out(&self, block: VertexSpan) -> bool {
        let (low, high) = (-near::LARGEST_STEP, near::LARGEST_STEP - 1);
        let (first, last) = (Vertex::new(block.west, block.south), Vertex::new(block.east, block.north));
        !(self.is_post(first.moved(low, low)) && self.is_post(last.moved(high, high)))
    }

    /// Whether all posts that the block's vertices up to [`near::LARGEST_STEP`] read are known to be plain.
    fn is_plain_around(&self, block: VertexSpan) -> bool {
        let end = (self.lattice.columns() as i32 - 1, self.lattice.rows() as i32 - 1);
        let clamp = |x: i32, y: i32| (x.clamp(0, end.0), y.clamp(0, end.1));
        let reach = near::LARGEST_STEP;
        let first = clamp(block.west - reach, block.south - reach);
        self.survey.is_plain(first, clamp(block.east + reach, block.north + reach))
    }

    /// The vertices beyond [`NEAR_STEP`] with their errors.
    fn far_vertices(&self) -> Vec<(Vertex, f32)> {
        let far = NEAR_STEP * 2;
        let axis = |count: usize| (0..count as i32).step_by(far as usize);
        let mut errors: Vec<(Vertex, f32)> = axis(self.layout.rows())
            .flat_map(|y| axis(self.layout.columns()).map(move |x| Vertex::new(x, y)))
            .filter(|&vertex| !self.layout.is_corner(vertex))
            .map(|vertex| (vertex, 0.0))
            .collect();
        let strips: Vec<(usize, ErrorStrip<'_>)> = errors
            .par_iter()
            .enumerate()
            .flat_map_iter(|(at, &(vertex, _))| self.strips(vertex).into_iter().map(move |strip| (at, strip)))
            .collect();
        let measured: Vec<(usize, f32)> =
            strips.into_par_iter().map(|(at, strip)| (at, self.strip_error(&strip))).collect();
        for (at, error) in measured {
            errors[at].1 = larger(errors[at].1, error);
        }
        errors
    }

    fn strips(&self, vertex: Vertex) -> Vec<ErrorStrip<'a>> {
        let diamond = Diamond::new(self.lattice, self.layout, vertex);
        let plain =
            diamond.filter(|diamond| diamond.is_known_plain(&self.survey) || diamond.is_plain(self.lattice));
        let Some(diamond) = plain else {
            return vec![ErrorStrip::General(vertex)];
        };
        let strips = diamond.triangles().flat_map(|(&triangle, hypotenuse)| {
            let rows = triangle.rows();
            let firsts = (0..rows).step_by(STRIP_ROWS as usize);
            firsts.map(move |first| {
                ErrorStrip::Plain(triangle, hypotenuse, first..rows.min(first + STRIP_ROWS))
            })
        });
        strips.collect()
    }

    fn strip_error(&self, strip: &ErrorStrip<'_>) -> f32 {
        match strip {
            ErrorStrip::General(vertex) => general_error(self.lattice, self.layout, *vertex),
            ErrorStrip::Plain(triangle, hypotenuse, rows) => {
                let mut worst = Worst::default();
                triangle.scan(rows.clone(), *hypotenuse, &mut worst);
                largest(&worst)
            }
        }
    }
}

/// Vertices measured together, ends excluded.
#[derive(Clone, Copy)]
struct VertexSpan {
    west: i32,
    east: i32,
    south: i32,
    north: i32,
}

/// A part of a vertex's error.
enum ErrorStrip<'a> {
    /// All of it, post by post.
    General(Vertex),
    /// That of some rows of a triangle.
    Plain(PostTriangle<'a>, Hypotenuse, Range<i32>),
}

/// The largest vertical distance in meters between a triangle's plane and the posts it covers.
///
/// Infinite where it covers both data and no data, or where it is off a pinned post; 0 where it covers no data at all or has
/// no area.
pub fn triangle_error(lattice: &Lattice, layout: &PatchLayout, triangle: &Triangle) -> f32 {
    let posts = triangle.corners().map(|vertex| layout.post(vertex));
    let Some(plane) = PostPlane::new(lattice, posts) else {
        return 0.0;
    };
    let mut covered = CoveredPosts { slack_m: lattice.pin_slack_m(), ..CoveredPosts::default() };
    for row in RowSpans::new(posts) {
        covered.scan(lattice, &plane, row);
        if covered.error() == f32::INFINITY {
            break;
        }
    }
    covered.error()
}

/// The posts that a triangle covers.
#[derive(Default)]
struct CoveredPosts {
    worst: f32,
    data: bool,
    no_data: bool,
    worst_pinned: f32,
    slack_m: f32,
}

impl CoveredPosts {
    fn scan(&mut self, lattice: &Lattice, plane: &PostPlane, span: RowSpan) {
        let first = lattice.index(Post { column: span.first, row: span.row });
        let height_at = plane.along(span.row);
        for offset in 0..=(span.last - span.first) {
            let post = Post { column: span.first + offset, row: span.row };
            let height = lattice.held_heights()[first + offset as usize];
            if height.is_nan() {
                self.no_data = true;
                continue;
            }
            self.data = true;
            let off = (f64::from(height) - height_at(post.column)).abs() as f32;
            self.worst = self.worst.max(off);
            if lattice.is_pinned(post) {
                self.worst_pinned = self.worst_pinned.max(off);
            }
        }
    }

    fn error(&self) -> f32 {
        let torn = self.data && self.no_data;
        if torn || self.worst_pinned > self.slack_m { f32::INFINITY } else { self.worst }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec2;
    use proptest::prelude::*;

    fn hilly(columns: u32, rows: u32) -> Lattice {
        let heights = (0..columns * rows)
            .map(|index| {
                let (x, y) = ((index % columns) as f32, (index / columns) as f32);
                libm::sinf(x * 0.7) * 5.0 + libm::cosf(y * 0.45 + x * 0.2) * 9.0
            })
            .collect();
        Lattice::new(DVec2::ZERO, DVec2::splat(10.0), columns, heights).expect("sound")
    }

    /// The error by testing every post against the triangle, the slow and obvious way.
    fn plain_error(lattice: &Lattice, layout: &PatchLayout, triangle: &Triangle) -> f32 {
        let posts = triangle.corners().map(|vertex| layout.post(vertex));
        let [a, b, c] = posts.map(|post| {
            glam::DVec3::new(f64::from(post.column), f64::from(post.row), f64::from(lattice.height(post)))
        });
        let normal = (b - a).cross(c - a);
        if normal.z == 0.0 {
            return 0.0;
        }
        let mut worst = 0f32;
        for post in lattice.posts() {
            let at = DVec2::new(f64::from(post.column), f64::from(post.row));
            let inside = [(a, b), (b, c), (c, a)]
                .iter()
                .all(|&(from, to)| (to.truncate() - from.truncate()).perp_dot(at - from.truncate()) >= 0.0);
            if inside {
                let z = a.z - normal.truncate().dot(at - a.truncate()) / normal.z;
                worst = worst.max((f64::from(lattice.height(post)) - z).abs() as f32);
            }
        }
        worst
    }

    #[test]
    fn scanned_errors_equal_the_plain_ones_across_the_border_too() {
        let lattice = hilly(21, 14);
        let layout = PatchLayout::new(21, 14, 8).expect("sound");
        for corner in layout.patches() {
            let mut stack = Triangle::roots(corner, layout.patch()).to_vec();
            while let Some(triangle) = stack.pop().filter(|triangle| !triangle.is_finest()) {
                let (found, plain) =
                    (triangle_error(&lattice, &layout, &triangle), plain_error(&lattice, &layout, &triangle));
                assert!((found - plain).abs() < 1e-4, "{triangle:?}: {found} against {plain}");
                stack.extend(triangle.split());
            }
        }
    }

    /// Hills with some holes and pinned posts.
    fn spoilt(columns: u32, rows: u32, spots: &[(u32, u32)]) -> Lattice {
        let mut lattice = hilly(columns, rows);
        for (index, &(x, y)) in spots.iter().enumerate() {
            let post = Post { column: x % columns, row: y % rows };
            let height = if index % 2 == 0 { f32::NAN } else { lattice.height(post) };
            lattice.pin(post, height);
        }
        lattice
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(32))]
        #[test]
        fn errors_measured_alone_together_and_post_by_post_agree(
            columns in 2..150u32, rows in 2..150u32, log in 1..8u32,
            spots in proptest::collection::vec((0..150u32, 0..150u32), 0..4),
        ) {
            let lattice = spoilt(columns, rows, &spots);
            let layout = PatchLayout::new(columns, rows, 1 << log).expect("sound");
            for (index, &error) in own_errors(&lattice, &layout).iter().enumerate() {
                let (x, y) = (index % layout.columns(), index / layout.columns());
                let vertex = Vertex::new(x as i32, y as i32);
                let alone = own_error(&lattice, &layout, vertex);
                prop_assert_eq!(error.to_bits(), alone.to_bits(), "{:?}: {} and {}", vertex, error, alone);
                if !layout.is_corner(vertex) {
                    let general = general_error(&lattice, &layout, vertex);
                    let same = error == general || (error - general).abs() < 28.0 * 1e-6;
                    prop_assert!(same, "{:?}: {} and {}", vertex, error, general);
                }
            }
        }
    }

    #[test]
    fn errors_raised_while_they_are_measured_are_those_raised_after() {
        for (columns, rows, patch) in
            [(70, 700, 64), (131, 521, 32), (40, 300, 4), (300, 37, 2), (90, 600, 128)]
        {
            for spots in [&[][..], &[(7, 260), (33, 255), (12, 9), (60, 511)]] {
                let lattice = spoilt(columns, rows, spots);
                let layout = PatchLayout::new(columns, rows, patch).expect("sound");
                let after = ErrorMap::raised(own_errors(&lattice, &layout), &layout);
                for threads in [1, 3] {
                    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
                    let found = pool.install(|| ErrorMap::exact(&lattice, &layout));
                    assert!(found == after, "{columns} × {rows} in patches of {patch}, {threads} threads");
                }
            }
        }
    }

    #[test]
    fn steep_planes_have_no_error_to_speak_of() {
        let heights =
            (0..257 * 257).map(|index| 900.0 + (index % 257) as f32 * 3.7 - (index / 257) as f32 * 1.3);
        let lattice = Lattice::new(DVec2::ZERO, DVec2::ONE, 257, heights.collect()).expect("sound");
        let worst = own_errors(&lattice, &PatchLayout::new(257, 257, 256).expect("sound"))
            .into_iter()
            .fold(0.0, f32::max);
        assert!(worst < 1e-3, "{worst}");
    }

    #[test]
    fn errors_never_shrink_toward_the_roots() {
        let lattice = hilly(50, 37);
        let layout = PatchLayout::new(50, 37, 16).expect("sound");
        ErrorMap::exact(&lattice, &layout).check(&layout);
    }

    #[test]
    fn flat_ground_has_no_error_and_a_hole_an_infinite_one() {
        let mut heights = vec![3.0; 17 * 17];
        let layout = PatchLayout::new(17, 17, 16).expect("sound");
        let make =
            |heights: &[f32]| Lattice::new(DVec2::ZERO, DVec2::ONE, 17, heights.to_vec()).expect("sound");
        let center = Vertex::new(8, 8);
        assert_eq!(ErrorMap::exact(&make(&heights), &layout).at(&layout, center), 0.0);
        heights[5 * 17 + 5] = f32::NAN;
        assert_eq!(ErrorMap::exact(&make(&heights), &layout).at(&layout, center), f32::INFINITY);
    }

    #[test]
    fn ground_that_is_pinned_is_refined_to_its_posts() {
        let mut lattice = hilly(17, 17);
        lattice.pin(Post { column: 4, row: 4 }, 50.0);
        let layout = PatchLayout::new(17, 17, 16).expect("sound");
        let map = ErrorMap::exact(&lattice, &layout);
        assert_eq!(map.at(&layout, Vertex::new(4, 4)), f32::INFINITY);
        assert!(map.at(&layout, Vertex::new(12, 12)).is_finite());
    }
}
