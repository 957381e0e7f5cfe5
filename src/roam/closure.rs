//! The least mesh that keeps an error bound.
//!
//! Errors raised to those of the children let one threshold choose vertices, but split triangles that are good enough.
//! Here a triangle is split only where it is itself off by more than the tolerance, and where a neighbor forces it (the
//! forced split of Duchaineau et al. 1997).
//!
//! Both rules have the form "if this vertex is active, so is that one": an active vertex activates its parents, and the
//! right-angled corner of a triangle that is off by too much activates the middle of its hypotenuse. Such rules have a
//! least fixed point, whatever the order in which they are applied: any mesh of bintree triangles that keeps the bound has
//! at least its vertices. Every triangle is examined once, when the vertex that makes it is activated.

use std::sync::Arc;

use crate::active::ActiveSet;
use crate::bintree::Triangle;
use crate::errors::exact::{triangle_error, triangles_split_at};
use crate::errors::scan::PostTriangle;
use crate::errors::survey::TileSurvey;
use crate::graph::Vertex;
use crate::layout::PatchLayout;
use crate::parts::{HeldGround, PartPlan, PartedGround};
use sandtable_terrain::lattice::Lattice;

/// The fewest active vertices that leave no triangle off by more than `tolerance_m` at any post it covers, no triangle
/// over both data and no data but the finest, and pinned posts exact.
///
/// Distances are measured within one part in a million of the relief under a triangle. A negative or NaN tolerance keeps
/// all vertices.
pub fn least_closure(lattice: &Arc<Lattice>, layout: &PatchLayout, tolerance_m: f32) -> ActiveSet {
    let Ok(active) = least_closure_of_parts(&mut HeldGround::new(lattice, *layout), tolerance_m);
    active
}

/// [`least_closure`] of ground that is read part by part: the same vertices. A part is read again where neighbors force
/// triangles of it apart after it was examined.
///
/// # Errors
/// A part cannot be read.
pub fn least_closure_of_parts<G: PartedGround>(
    ground: &mut G,
    tolerance_m: f32,
) -> Result<ActiveSet, G::Error> {
    let plan = ground.plan();
    let (layout, parts) = (*plan.layout(), plan.count());
    let roots =
        |part| plan.patches(part).flat_map(|corner| Triangle::roots(corner, layout.patch())).collect();
    let mut growth = Growth {
        plan,
        tolerance_m: if tolerance_m.is_nan() { -1.0 } else { tolerance_m },
        active: ActiveSet::new(layout),
        waiting: (0..parts).map(roots).collect(),
    };
    while growth.waiting.iter().any(|waiting| !waiting.is_empty()) {
        for part in 0..parts {
            if !growth.waiting[part].is_empty() {
                growth.examine(part, &*ground.part(part)?);
            }
        }
    }
    Ok(growth.active)
}

struct Growth {
    plan: PartPlan,
    tolerance_m: f32,
    active: ActiveSet,
    /// Triangles of the mesh that were not examined, by the part that they lie in.
    waiting: Vec<Vec<Triangle>>,
}

impl Growth {
    /// Examines the triangles of a part until none waits there.
    fn examine(&mut self, part: usize, lattice: &Lattice) {
        let survey = TileSurvey::new(lattice);
        while let Some(triangle) = self.waiting[part].pop() {
            // A neighbor may have forced it apart meanwhile.
            let vertex = triangle.split_vertex();
            if !self.active.is_active(vertex) && self.is_off(lattice, &survey, &triangle) {
                self.force(vertex);
            }
        }
    }

    /// Whether a triangle is off by more than the tolerance at any post it covers.
    fn is_off(&self, lattice: &Lattice, survey: &TileSurvey, triangle: &Triangle) -> bool {
        match PostTriangle::new(lattice, triangle).filter(|posts| survey.covers(posts)) {
            Some(posts) => posts.exceeds(self.tolerance_m),
            None => triangle_error(lattice, self.plan.layout(), triangle) > self.tolerance_m,
        }
    }

    /// Activates a vertex, its parents first, and adds the halves that they make to those waiting.
    fn force(&mut self, vertex: Vertex) {
        let (plan, waiting) = (&self.plan, &mut self.waiting);
        self.active.activate_each(vertex, &mut |vertex| {
            for split in triangles_split_at(plan.layout(), vertex).into_iter().flatten() {
                let halves = split.split().into_iter().filter(|half| !half.is_finest());
                let patch = plan.layout().patch_holding(vertex, split.apex);
                waiting[plan.part_of(patch)].extend(halves);
            }
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::errors::ErrorMap;
    use crate::parts::tests::CutGround;
    use glam::DVec2;
    use proptest::prelude::*;

    /// The leaf triangles of the mesh.
    fn leaves(active: &ActiveSet) -> Vec<Triangle> {
        let layout = active.layout();
        let mut stack: Vec<Triangle> =
            layout.patches().flat_map(|corner| Triangle::roots(corner, layout.patch())).collect();
        let mut leaves = Vec::new();
        while let Some(triangle) = stack.pop() {
            if triangle.is_finest() || !active.is_active(triangle.split_vertex()) {
                leaves.push(triangle);
            } else {
                stack.extend(triangle.split());
            }
        }
        leaves
    }

    /// The mesh that errors raised to their children give.
    fn saturated(map: &ErrorMap, layout: &PatchLayout, tolerance_m: f32) -> ActiveSet {
        let mut active = ActiveSet::new(*layout);
        for (index, _) in map.values().iter().enumerate().filter(|&(_, &error)| error > tolerance_m) {
            let vertex = Vertex::new((index % layout.columns()) as i32, (index / layout.columns()) as i32);
            if !layout.is_corner(vertex) {
                active.activate(vertex);
            }
        }
        active
    }

    /// The same by whole re-scans until nothing changes, in the opposite order.
    fn plain_closure(lattice: &Lattice, layout: &PatchLayout, tolerance_m: f32) -> ActiveSet {
        let mut active = ActiveSet::new(*layout);
        loop {
            let before = active.count();
            for triangle in leaves(&active).into_iter().rev().filter(|triangle| !triangle.is_finest()) {
                if triangle_error(lattice, layout, &triangle) > tolerance_m {
                    active.activate(triangle.split_vertex());
                }
            }
            if active.count() == before {
                return active;
            }
        }
    }

    fn rough(columns: u32, rows: u32, seed: u32, holes: u32) -> Lattice {
        let random = |index: u32| (index ^ seed).wrapping_mul(2_654_435_761).rotate_left(13) >> 8;
        let height = |index: u32| {
            let (x, y) = ((index % columns) as f32, (index / columns) as f32);
            let wave = libm::sinf(x * 0.21 + seed as f32) * 40.0 + libm::cosf(y * 0.13) * 60.0;
            let hole = random(index.wrapping_mul(7)) % 1000 < holes;
            if hole { f32::NAN } else { wave + (random(index) % 100) as f32 * 0.05 }
        };
        let heights = (0..columns * rows).map(height).collect();
        Lattice::new(DVec2::ZERO, DVec2::splat(10.0), columns, heights).expect("sound")
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(24))]
        #[test]
        fn no_triangle_is_off_and_none_is_split_without_need(
            columns in 5..70u32, rows in 5..70u32, seed in 0..1000u32, holes in 0..3u32, tolerance in 0.5..30f32,
        ) {
            let lattice = Arc::new(rough(columns, rows, seed, holes));
            let layout = PatchLayout::new(columns, rows, 16).expect("sound");
            let least = least_closure(&lattice, &layout, tolerance);
            least.check();
            for triangle in leaves(&least).iter().filter(|triangle| !triangle.is_finest()) {
                let error = triangle_error(&lattice, &layout, triangle);
                prop_assert!(error <= tolerance + 1e-3, "{:?} is off by {}", triangle, error);
            }
            let plain = plain_closure(&lattice, &layout, tolerance);
            prop_assert!(least == plain, "{} against {} vertices", least.count(), plain.count());
            let raised = saturated(&ErrorMap::exact(&lattice, &layout), &layout, tolerance);
            prop_assert!(raised.count() >= least.count());
        }

        #[test]
        fn parts_read_one_by_one_have_the_closure_of_the_whole(
            columns in 5..90u32, rows in 5..90u32, seed in 0..1000u32, holes in 0..3u32, tolerance in -1f32..30.0,
            power in 2u32..6, most in 1usize..2000,
        ) {
            let lattice = Arc::new(rough(columns, rows, seed, holes));
            let layout = PatchLayout::new(columns, rows, 1 << power).expect("sound");
            let plan = PartPlan::of_vertices(layout, most);
            let mut cut = CutGround { lattice: (*lattice).clone(), plan };
            let Ok(parted) = least_closure_of_parts(&mut cut, tolerance);
            prop_assert!(parted == least_closure(&lattice, &layout, tolerance), "{} parts", plan.count());
        }
    }

    #[test]
    fn flat_ground_is_two_triangles_a_patch_and_no_tolerance_keeps_every_rough_post() {
        let layout = PatchLayout::new(33, 33, 32).expect("sound");
        let flat = Lattice::new(DVec2::ZERO, DVec2::ONE, 33, vec![812.3; 33 * 33]).expect("sound");
        assert_eq!(least_closure(&Arc::new(flat), &layout, 0.0).count(), 0);
        let ground = Arc::new(rough(33, 33, 5, 0));
        let every = least_closure(&ground, &layout, -1.0);
        assert_eq!(every.count() + 4, layout.vertex_count());
        assert_eq!(every, least_closure(&ground, &layout, f32::NAN));
    }

    #[test]
    fn pinned_posts_are_kept_exact() {
        let mut lattice = Lattice::new(DVec2::ZERO, DVec2::ONE, 33, vec![1.0; 33 * 33]).expect("sound");
        lattice.pin(sandtable_terrain::lattice::Post { column: 11, row: 7 }, 1.5);
        let least = least_closure(&Arc::new(lattice), &PatchLayout::new(33, 33, 32).expect("sound"), 5.0);
        assert!(least.is_active(Vertex::new(11, 7)));
    }
}
