//! The vertical distances of a mesh from ground that is in memory part by part, measured at every post.
//!
//! The measure is that of `bound`: the triangles as they are written, in f64, and of a post in several the largest distance.
//! A part's triangles are visited again for each band of rows whose distances are held; those beyond the band are left out
//! with all below them.

use std::convert::Infallible;
use std::ops::ControlFlow;

use crate::active::ActiveSet;
use crate::bound::{BAND_POSTS, Deviation, DeviationSums, distance};
use crate::emit::part::drawn;
use crate::errors::rows::RowSpans;
use crate::parts::{BorderCarry, PartPlan, is_own};
use sandtable_terrain::lattice::{Lattice, Post};
use sandtable_terrain::post_rect::PostRect;

/// The distances of the parts of a mesh, which must follow each other from the first.
pub struct PartDistances<'a> {
    active: &'a ActiveSet,
    plan: PartPlan,
    borders: BorderCarry<f64>,
    distances: Vec<f64>,
    sums: DeviationSums,
    /// The first post without data that a triangle covers.
    over_hole: Option<Post>,
}

impl<'a> PartDistances<'a> {
    /// For the mesh of the active vertices.
    pub fn new(active: &'a ActiveSet, plan: PartPlan) -> Self {
        let (borders, sums) = (BorderCarry::new(active.layout(), f64::NAN), DeviationSums::default());
        Self { active, plan, borders, distances: Vec::new(), sums, over_hole: None }
    }

    /// Measures the next part, whose posts `lattice` holds.
    pub fn add(&mut self, part: usize, lattice: &Lattice) {
        let rect = self.plan.posts(part);
        let at_once = (BAND_POSTS / rect.width() as u32).max(1);
        for first in (rect.first.row..=rect.last.row).step_by(at_once as usize) {
            self.add_rows(part, rect, (first, (first + at_once - 1).min(rect.last.row)), lattice);
        }
    }

    fn add_rows(&mut self, part: usize, rect: PostRect, rows: (u32, u32), lattice: &Lattice) {
        self.borders.enter(rect, rows, &mut self.distances);
        let (distances, over_hole) = (&mut self.distances, &mut self.over_hole);
        let index = |post: Post| {
            (post.row - rows.0) as usize * rect.width() + (post.column - rect.first.column) as usize
        };
        let meets = |posts: [Post; 3]| {
            let of = |post: Post| (post.row >= rows.0, post.row <= rows.1);
            posts.iter().any(|&post| of(post).0) && posts.iter().any(|&post| of(post).1)
        };
        for corner in self.plan.patches(part) {
            let has_data = |post| !lattice.height(post).is_nan();
            let _: ControlFlow<Infallible> = drawn(self.active, corner, has_data, meets, |posts| {
                let corners =
                    posts.map(|post| lattice.position(post).extend(lattice.height(post)).as_dvec3());
                for span in RowSpans::new(posts).within(rows.0, rows.1) {
                    for post in (span.first..=span.last).map(|column| Post { column, row: span.row }) {
                        let distance = distance(lattice, &corners, &posts, post);
                        if distance.is_nan() {
                            over_hole.get_or_insert(post);
                        }
                        let slot = &mut distances[index(post)];
                        *slot = slot.max(distance);
                    }
                }
                ControlFlow::Continue(())
            });
        }
        self.borders.leave(rect, rows, &self.distances);
        let layout = self.plan.layout();
        for row in rows.0..=rows.1 {
            for post in (rect.first.column..=rect.last.column).map(|column| Post { column, row }) {
                if is_own(layout, rect, post) && !lattice.height(post).is_nan() {
                    self.sums.add(post, self.distances[index(post)]);
                }
            }
        }
    }

    /// The deviation of all parts.
    ///
    /// # Errors
    /// A triangle covers this post, which has no data.
    pub fn deviation(self) -> Result<Deviation, Post> {
        match self.over_hole {
            Some(post) => Err(post),
            None => Ok(self.sums.deviation()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bound::measure;
    use crate::closure::least_closure;
    use crate::displayed::DisplayedTerrain;
    use crate::layout::PatchLayout;
    use crate::parts::PartedGround;
    use crate::parts::tests::CutGround;
    use glam::DVec2;
    use proptest::prelude::*;
    use sandtable_mesh::trimesh::TriMesh;
    use std::sync::Arc;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(48))]
        #[test]
        fn parts_measured_one_by_one_are_as_far_off_as_the_mesh_is(
            columns in 3u32..80, rows in 3u32..80, seed in 1u32..1000, most in 1usize..2000, power in 1u32..5,
            tolerance_m in 0f32..9.0, holes in proptest::collection::vec(0usize..6000, 0..5),
        ) {
            let wave = |index: u32| libm::sinf((index % columns) as f32 * 0.3 + (index * seed % 97) as f32 * 0.04);
            let mut heights: Vec<f32> = (0..columns * rows).map(|index| 8.0 * wave(index)).collect();
            let last = heights.len() - 1;
            holes.iter().for_each(|hole| heights[hole % last] = f32::NAN);
            let lattice = Lattice::new(DVec2::ZERO, DVec2::new(3.0, 5.0), columns, heights).expect("sound");
            let (lattice, layout) = (Arc::new(lattice), PatchLayout::new(columns, rows, 1 << power).expect("sound"));
            let active = least_closure(&lattice, &layout, tolerance_m);
            let mut mesh = TriMesh::default();
            DisplayedTerrain::new(lattice.clone(), active.clone(), layout.patches().collect()).emit(&mut mesh);
            let whole = measure(&lattice, &mesh).expect("on posts");
            let plan = PartPlan::of_vertices(layout, most);
            let (mut ground, mut parts) = (CutGround { lattice: (*lattice).clone(), plan }, PartDistances::new(&active, plan));
            for part in 0..plan.count() {
                let Ok(part_ground) = ground.part(part);
                parts.add(part, &part_ground);
            }
            let parts = parts.deviation().expect("no triangle over a hole");
            let counts = |found: &Deviation| (found.measured, found.left_out, found.worst, found.max_m.to_bits());
            prop_assert_eq!(counts(&parts), counts(&whole));
            prop_assert!((parts.mean_m - whole.mean_m).abs() < 1e-12 && (parts.rms_m - whole.rms_m).abs() < 1e-12);
        }
    }
}
