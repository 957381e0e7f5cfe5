//! The vertical distance of the shown triangles from the elevation model, at every post they cover.
//!
//! The posts of every shown triangle are compared once with its plane, without sampling and independently of any criterion.
//! A post on an edge is covered by several triangles and counts once: a bitmap marks the posts inside a patch, and those on
//! its border are merged at the end.
//!
//! Not measured: posts without data, posts of patches that are not shown, and posts under triangles that are left out
//! because a corner has no data.

use rayon::prelude::*;

use crate::errors::plane::PostPlane;
use crate::errors::rows::{RowSpan, RowSpans};
use crate::layout::PatchLayout;
use crate::shown::{LocalTriangle, PatchList};
use sandtable_terrain::lattice::{Lattice, Post};

/// `|shown − elevation model|` over posts.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HeightDifference {
    /// The number of posts measured.
    pub posts: u64,
    sum: f64,
    squares: f64,
    max_m: f64,
    max_px: f64,
}

impl HeightDifference {
    /// The mean in meters; `None` where nothing was measured.
    pub fn mean_m(&self) -> Option<f64> {
        (self.posts > 0).then(|| self.sum / self.posts as f64)
    }

    /// The root of the mean square in meters; `None` where nothing was measured.
    pub fn rms_m(&self) -> Option<f64> {
        (self.posts > 0).then(|| (self.squares / self.posts as f64).sqrt())
    }

    /// The largest in meters; `None` where nothing was measured.
    pub fn max_m(&self) -> Option<f64> {
        (self.posts > 0).then_some(self.max_m)
    }

    /// The longest in the picture, pixels; `None` where nothing was measured.
    pub fn max_px(&self) -> Option<f64> {
        (self.posts > 0).then_some(self.max_px)
    }

    /// Both measurements as one.
    pub fn with(self, other: Self) -> Self {
        Self {
            posts: self.posts + other.posts,
            sum: self.sum + other.sum,
            squares: self.squares + other.squares,
            max_m: self.max_m.max(other.max_m),
            max_px: self.max_px.max(other.max_px),
        }
    }

    fn add(&mut self, off_m: f64, seen_px: f64) {
        let one = Self { posts: 1, sum: off_m, squares: off_m * off_m, max_m: off_m, max_px: seen_px };
        *self = self.with(one);
    }
}

/// Measures the triangles of `shown`, which holds no patch twice; in parallel over patches, the same for any number of
/// threads. `seen_px` returns the pixels between a post with data and the height that is shown there, `None` for a post out
/// of the picture, which is not measured.
pub fn height_difference(
    lattice: &Lattice,
    layout: &PatchLayout,
    shown: &[PatchList],
    seen_px: impl Fn(Post, f64) -> Option<f64> + Sync,
) -> HeightDifference {
    let patches: Vec<PatchMeasure> =
        shown.par_iter().map(|list| PatchScan::new(lattice, layout, list, &seen_px).measured()).collect();
    let mut border: Vec<BorderPost> = patches.iter().flat_map(|patch| &patch.border).copied().collect();
    // Neighbors agree about a border post but for rounding; the larger counts.
    border.sort_unstable_by(|a, b| a.post.cmp(&b.post).then(b.off_m.total_cmp(&a.off_m)));
    border.dedup_by_key(|measured| measured.post);
    let mut total = patches.iter().fold(HeightDifference::default(), |sum, patch| sum.with(patch.inside));
    border.iter().for_each(|measured| total.add(measured.off_m, measured.seen_px));
    total
}

/// The measurement of one patch.
struct PatchMeasure {
    inside: HeightDifference,
    border: Vec<BorderPost>,
}

/// The measurement of a post on a patch's border.
#[derive(Clone, Copy)]
struct BorderPost {
    /// Its index in the lattice.
    post: usize,
    off_m: f64,
    seen_px: f64,
}

/// A patch under measurement.
struct PatchScan<'a, S> {
    lattice: &'a Lattice,
    layout: &'a PatchLayout,
    list: &'a PatchList,
    seen_px: &'a S,
    first: Post,
    last: Post,
    is_measured: Vec<bool>,
    result: PatchMeasure,
}

impl<'a, S: Fn(Post, f64) -> Option<f64>> PatchScan<'a, S> {
    fn new(lattice: &'a Lattice, layout: &'a PatchLayout, list: &'a PatchList, seen_px: &'a S) -> Self {
        let patch = layout.patch();
        let (first, last) = (layout.post(list.corner), layout.post(list.corner.moved(patch, patch)));
        let posts = (last.column - first.column + 1) as usize * (last.row - first.row + 1) as usize;
        let result = PatchMeasure { inside: HeightDifference::default(), border: Vec::new() };
        Self { lattice, layout, list, seen_px, first, last, is_measured: vec![false; posts], result }
    }

    fn measured(mut self) -> PatchMeasure {
        for triangle in self.list.triangles.iter() {
            self.scan(triangle);
        }
        self.result
    }

    fn scan(&mut self, triangle: &LocalTriangle) {
        let posts = triangle.map(|index| self.layout.post(self.list.vertex(self.layout, index)));
        let Some(plane) = PostPlane::new(self.lattice, posts).filter(PostPlane::has_data) else {
            return;
        };
        for RowSpan { row, first, last } in RowSpans::new(posts) {
            if row == self.first.row || row == self.last.row {
                (first..=last).for_each(|column| self.measure_on_border(Post { column, row }, &plane));
                continue;
            }
            for column in [self.first.column, self.last.column] {
                if (first..=last).contains(&column) {
                    self.measure_on_border(Post { column, row }, &plane);
                }
            }
            let (first, last) = (first.max(self.first.column + 1), last.min(self.last.column - 1));
            if first <= last {
                self.measure_inside(RowSpan { row, first, last }, &plane);
            }
        }
    }

    /// Measures the posts of a row off the patch's border.
    fn measure_inside(&mut self, span: RowSpan, plane: &PostPlane) {
        let start = Post { column: span.first, row: span.row };
        let (place, count) = (self.place(start), (span.last - span.first + 1) as usize);
        let heights = &self.lattice.heights()[self.lattice.index(start)..][..count];
        let is_measured = &mut self.is_measured[place..place + count];
        let shown = plane.height(start);
        let mut sum = HeightDifference::default();
        for (at, (&height, is_measured)) in heights.iter().zip(is_measured).enumerate() {
            if height.is_nan() || std::mem::replace(is_measured, true) {
                continue;
            }
            let shown_m = shown + plane.per_column * at as f64;
            if let Some(seen_px) = (self.seen_px)(start.offset(at as u32, 0), shown_m) {
                sum.add((f64::from(height) - shown_m).abs(), seen_px);
            }
        }
        self.result.inside = self.result.inside.with(sum);
    }

    fn measure_on_border(&mut self, post: Post, plane: &PostPlane) {
        let (place, height) = (self.place(post), self.lattice.height(post));
        let is_new = !height.is_nan() && !std::mem::replace(&mut self.is_measured[place], true);
        let shown_m = plane.height(post);
        if is_new && let Some(seen_px) = (self.seen_px)(post, shown_m) {
            let off_m = (f64::from(height) - shown_m).abs();
            self.result.border.push(BorderPost { post: self.lattice.index(post), off_m, seen_px });
        }
    }

    /// The index of a post of the patch.
    fn place(&self, post: Post) -> usize {
        let width = (self.last.column - self.first.column + 1) as usize;
        (post.row - self.first.row) as usize * width + (post.column - self.first.column) as usize
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::active::ActiveSet;
    use crate::displayed::DisplayedTerrain;
    use crate::graph::Vertex;
    use crate::patched_ground::PatchedGround;
    use glam::DVec2;
    use proptest::prelude::*;
    use sandtable_terrain::triangle_surface::TriangleSurface;
    use std::sync::Arc;

    fn lattice(columns: u32, rows: u32, holes: &[usize]) -> Arc<Lattice> {
        let mut heights: Vec<f32> =
            (0..columns * rows).map(|index| libm::sinf(index as f32 * 0.37) * 8.0).collect();
        holes.iter().for_each(|&hole| heights[hole % (columns * rows) as usize] = f32::NAN);
        Arc::new(Lattice::new(DVec2::ZERO, DVec2::new(4.0, 2.0), columns, heights).expect("sound"))
    }

    /// By asking the displayed ground for its height at every post, the slow and obvious way.
    fn plainly(lattice: &Lattice, terrain: &DisplayedTerrain) -> HeightDifference {
        let mut whole = HeightDifference::default();
        for post in lattice.posts().filter(|&post| !lattice.height(post).is_nan()) {
            if let Some(z) = terrain.displayed_z(lattice.position(post).as_dvec2()) {
                whole.add((f64::from(lattice.height(post)) - z).abs(), 0.0);
            }
        }
        whole
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]
        #[test]
        fn scanned_differences_are_those_of_the_displayed_ground(
            columns in 2u32..50, rows in 2u32..50,
            vertices in proptest::collection::vec((0..64i32, 0..64i32), 0..40),
            holes in proptest::collection::vec(0usize..2500, 0..3),
            hidden in 0usize..16,
        ) {
            let layout = PatchLayout::new(columns, rows, 16).expect("sound");
            let mut active = ActiveSet::new(layout);
            vertices.iter().for_each(|&(x, y)| active.activate(Vertex::new(x, y)));
            prop_assume!(columns * rows > 4);
            let lattice = lattice(columns, rows, &holes);
            let ground = PatchedGround { lattice: &lattice, layout: &layout };
            let patches: Vec<Vertex> =
                layout.patches().enumerate().filter(|&(at, _)| at != hidden).map(|(_, corner)| corner).collect();
            let lists: Vec<PatchList> =
                patches.iter().map(|&corner| PatchList::bintree(ground, &active, corner)).collect();
            let found = height_difference(&lattice, &layout, &lists, |_, _| Some(0.0));
            let terrain = DisplayedTerrain::new(Arc::clone(&lattice), active, patches);
            let plain = plainly(&lattice, &terrain);
            prop_assert_eq!(found.posts, plain.posts);
            prop_assert_eq!(found.mean_m().is_some(), found.posts > 0);
            for (found, plain) in [
                (found.mean_m(), plain.mean_m()), (found.rms_m(), plain.rms_m()), (found.max_m(), plain.max_m()),
            ] {
                let (found, plain) = (found.unwrap_or(0.0), plain.unwrap_or(0.0));
                prop_assert!((found - plain).abs() < 1e-5, "{found} against {plain}");
            }
        }
    }

    #[test]
    fn the_finest_triangles_are_the_elevation_model() {
        let lattice = lattice(17, 17, &[]);
        let layout = PatchLayout::new(17, 17, 16).expect("sound");
        let mut active = ActiveSet::new(layout);
        (0..289).for_each(|at| active.activate(Vertex::new(at % 17, at / 17)));
        let ground = PatchedGround { lattice: &lattice, layout: &layout };
        let list = PatchList::bintree(ground, &active, Vertex::new(0, 0));
        let found = height_difference(&lattice, &layout, &[list], |_, _| Some(0.0));
        assert_eq!(
            (found.posts, found.max_m(), found.mean_m(), found.rms_m()),
            (289, Some(0.0), Some(0.0), Some(0.0))
        );
        assert_eq!(height_difference(&lattice, &layout, &[], |_, _| Some(0.0)).mean_m(), None);
    }

    #[test]
    fn only_posts_of_the_picture_are_measured_and_the_most_pixels_are_kept() {
        let lattice = lattice(17, 17, &[]);
        let layout = PatchLayout::new(17, 17, 16).expect("sound");
        let ground = PatchedGround { lattice: &lattice, layout: &layout };
        let shown = [PatchList::bintree(ground, &ActiveSet::new(layout), Vertex::new(0, 0))];
        let whole = height_difference(&lattice, &layout, &shown, |_, _| Some(0.0));
        let seen = height_difference(&lattice, &layout, &shown, |post, shown_m| {
            let off_m = (f64::from(lattice.height(post)) - shown_m).abs();
            (post.column < 5).then_some(2.0 * off_m)
        });
        assert_eq!((whole.posts, seen.posts), (17 * 17, 17 * 5));
        let most_px = seen.max_px().expect("posts are seen");
        assert!(most_px > 0.0 && seen.max_m() == Some(most_px / 2.0), "{seen:?}");
        assert!(seen.max_m() <= whole.max_m());
    }
}
