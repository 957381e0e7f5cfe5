//! GeoMipMap (de Boer 2000): static levels of detail, one a patch, with stitched borders.
//!
//! Level l of a patch joins every 2ˡ-th post by right triangles whose diagonals alternate as the lattice's do, so level 0 is
//! the ground itself. The error of each level is measured once; a view then chooses a level a patch, and each patch's
//! triangles follow from its own level and its neighbors'.
//!
//! Two patches of different levels meet at the posts of the coarser: the finer drops the posts between along that side. Only
//! the outermost row of its cells changes; corners are cut along their diagonals, so the sides are independent:
//!
//! ```text
//!     o───o───o───o───o───o───o          the row inside keeps its step s
//!   ╱  ╲  │  ╱  ╲  │  ╱  ╲  │  ╱  ╲
//! o───────o───────o───────o───────o      the border has the coarser one, S
//! ```
//!
//! Each border edge is joined to the post of the inner row that faces its middle; each edge of the inner row to the nearest
//! border post. All stitched triangles have an edge along their side and so keep area and orientation where the layout maps
//! vertices onto the lattice's border.
//!
//! A level that covers both data and no data is never chosen, and neither are coarse levels beside it: holes are those of the
//! full mesh. The levels are not an [`ActiveSet`](crate::active::ActiveSet), since stitched triangles are not the
//! bintree's. The measured error is that of whole levels; stitched triangles are within the coarser neighbor's on the border,
//! and no bound is promised inside their row.

use glam::Vec3;
use rayon::prelude::*;

use crate::bintree::Triangle;
use crate::culling::PatchHeights;
use crate::errors::exact::triangle_error;
use crate::graph::Vertex;
use crate::layout::PatchLayout;
use crate::patched_ground::PatchedGround;
use crate::quadtree::{NodeSide, SIDES};
use sandtable_terrain::lattice::Lattice;
use sandtable_view::camera::Camera;

/// The error of every level of every patch.
#[derive(Clone, Debug, PartialEq)]
pub struct Pyramids {
    layout: PatchLayout,
    errors: Vec<Vec<f32>>,
}

/// The level of every patch, in the layout's patch order.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PatchLevels(Vec<u32>);

impl Pyramids {
    /// Measures all levels; in parallel over patches. Costs a few visits a post and level.
    pub fn new(lattice: &Lattice, layout: &PatchLayout) -> Self {
        let patches: Vec<Vertex> = layout.patches().collect();
        let errors = patches.par_iter().map(|&corner| level_errors(lattice, layout, corner)).collect();
        Self { layout: *layout, errors }
    }

    /// The number of levels of a patch: from the posts, 0, to a single square.
    pub fn level_count(&self) -> u32 {
        self.layout.patch().trailing_zeros() + 1
    }

    /// The largest vertical distance in meters between the ground and the patch at `level`: 0 at level 0, infinite where the
    /// level would cover a hole. Never less than a finer level's.
    pub fn error_m(&self, corner: Vertex, level: u32) -> f32 {
        self.errors[self.layout.patch_index(corner)][level as usize]
    }

    /// The coarsest levels whose errors, at the point of the patch's box nearest to the eye, span no more than
    /// `tolerance_px` pixels.
    pub fn for_view(
        &self,
        ground: PatchedGround<'_>,
        heights: &PatchHeights,
        camera: &Camera,
        tolerance_px: f32,
    ) -> PatchLevels {
        // As in the screen-space criterion: pixels at the picture's corner, where they are largest.
        let aslant = 1.0 + camera.tan_half_fov().length_squared();
        let meters_at_one = tolerance_px / (camera.pixels_per_meter(1.0) * aslant);
        self.chosen(|corner| match heights.bounds(ground, corner) {
            // Parallel rays show an error as large at any distance.
            Some(_) if camera.parallel_frame().is_some() => meters_at_one,
            Some((min, max)) => nearest_m(camera.eye(), min, max) * meters_at_one,
            None => f32::INFINITY,
        })
    }

    /// The coarsest levels that are within `tolerance_m` of the ground.
    pub fn within(&self, tolerance_m: f32) -> PatchLevels {
        self.chosen(|_| tolerance_m)
    }

    fn chosen(&self, tolerance_m: impl Fn(Vertex) -> f32) -> PatchLevels {
        let coarsest = |corner: Vertex| {
            let errors = &self.errors[self.layout.patch_index(corner)];
            let tolerance_m = tolerance_m(corner);
            errors.iter().rposition(|&error| error.is_finite() && error <= tolerance_m).unwrap_or(0) as u32
        };
        let mut levels: Vec<u32> = self.layout.patches().map(coarsest).collect();
        for corner in self.layout.patches().filter(|&corner| self.has_hole(corner)) {
            for neighbor in SIDES.into_iter().filter_map(|side| beside(&self.layout, corner, side)) {
                levels[self.layout.patch_index(neighbor)] = 0;
            }
        }
        PatchLevels(levels)
    }

    /// Whether the patch must be drawn at level 0 for its holes, or for pinned posts.
    fn has_hole(&self, corner: Vertex) -> bool {
        self.errors[self.layout.patch_index(corner)].get(1).is_some_and(|error| error.is_infinite())
    }
}

impl PatchLevels {
    /// Given levels, one a patch in the layout's order; `None` where their number is wrong or one is coarser than a single
    /// square. Holes are kept only where a level is fine enough.
    pub fn new(layout: &PatchLayout, levels: Vec<u32>) -> Option<Self> {
        let coarsest = layout.patch().trailing_zeros();
        let sound = levels.len() == layout.patch_count() && levels.iter().all(|&level| level <= coarsest);
        sound.then_some(Self(levels))
    }

    /// The level of a patch.
    pub fn at(&self, layout: &PatchLayout, corner: Vertex) -> u32 {
        self.0[layout.patch_index(corner)]
    }

    /// The step between posts along one side of a patch: the coarser of the two that meet there.
    fn border_step(&self, layout: &PatchLayout, corner: Vertex, side: NodeSide) -> i32 {
        let own = self.at(layout, corner);
        let other = beside(layout, corner, side).map_or(own, |neighbor| self.at(layout, neighbor));
        1 << own.max(other)
    }
}

/// Calls `emit` with the triangles of the patches whose south-west corners are listed, counter-clockwise.
/// Patches that are not listed still determine the posts on borders.
pub fn triangles(
    layout: &PatchLayout,
    levels: &PatchLevels,
    patches: impl IntoIterator<Item = Vertex>,
    mut emit: impl FnMut([Vertex; 3]),
) {
    for corner in patches {
        let step = 1 << levels.at(layout, corner);
        if step == layout.patch() {
            Triangle::roots(corner, step).iter().for_each(|half| emit(half.corners()));
            continue;
        }
        inner_cells(layout, corner, step, &mut emit);
        for side in SIDES {
            let edge = PatchEdge { corner, patch: layout.patch(), step, side };
            match levels.border_step(layout, corner, side) {
                border if border == step => edge.plain(&mut emit),
                border => edge.stitched(border, &mut emit),
            }
        }
    }
}

/// The triangles of all cells that do not touch a side.
fn inner_cells(layout: &PatchLayout, corner: Vertex, step: i32, emit: &mut impl FnMut([Vertex; 3])) {
    let inner = || (step..layout.patch() - step).step_by(step as usize);
    for y in inner() {
        for x in inner() {
            Triangle::roots(corner.moved(x, y), step).iter().for_each(|half| emit(half.corners()));
        }
    }
}

/// The outermost cells of a patch along one side, cut off at the corners' diagonals.
#[derive(Clone, Copy)]
struct PatchEdge {
    corner: Vertex,
    patch: i32,
    step: i32,
    side: NodeSide,
}

impl PatchEdge {
    /// The vertex `along` the side, counter-clockwise, and `inward` of it.
    fn at(&self, along: i32, inward: i32) -> Vertex {
        let far = self.patch;
        match self.side {
            NodeSide::South => self.corner.moved(along, inward),
            NodeSide::East => self.corner.moved(far - inward, along),
            NodeSide::North => self.corner.moved(far - along, far - inward),
            NodeSide::West => self.corner.moved(inward, far - along),
        }
    }

    /// The triangle over the border from `from` to `to`, its third corner on the row inside.
    fn outer(&self, from: i32, to: i32, inner: i32) -> [Vertex; 3] {
        [self.at(inner, self.step), self.at(from, 0), self.at(to, 0)]
    }

    /// The triangle under the row inside from `from` to `to`, its third corner on the border.
    fn inner(&self, from: i32, to: i32, outer: i32) -> [Vertex; 3] {
        [self.at(outer, 0), self.at(to, self.step), self.at(from, self.step)]
    }

    /// The level's own cells: diagonals rise from even posts and fall to them.
    fn plain(&self, emit: &mut impl FnMut([Vertex; 3])) {
        let step = self.step;
        for from in (0..self.patch).step_by(step as usize) {
            let rises = from / step % 2 == 0;
            let to = from + step;
            emit(self.outer(from, to, if rises { to } else { from }));
            if from > 0 && to < self.patch {
                emit(self.inner(from, to, if rises { from } else { to }));
            }
        }
    }

    /// The cells with a border whose posts are `border` apart, at least twice the step.
    fn stitched(&self, border: i32, emit: &mut impl FnMut([Vertex; 3])) {
        let half = border / 2;
        for from in (0..self.patch).step_by(border as usize) {
            emit(self.outer(from, from + border, from + half));
        }
        for from in (self.step..self.patch - self.step).step_by(self.step as usize) {
            emit(self.inner(from, from + self.step, (from + half) / border * border));
        }
    }
}

/// The patch beyond a side, where there is one.
fn beside(layout: &PatchLayout, corner: Vertex, side: NodeSide) -> Option<Vertex> {
    let (dx, dy) = side.step();
    let patch = layout.patch();
    let place = (corner.x / patch + dx, corner.y / patch + dy);
    layout.patches_within(place, place).next()
}

/// Meters from the eye to the nearest point of a box; 0 inside.
fn nearest_m(eye: Vec3, min: Vec3, max: Vec3) -> f32 {
    eye.distance(eye.clamp(min, max))
}

/// The errors of a patch's levels, each raised to those of the finer ones.
fn level_errors(lattice: &Lattice, layout: &PatchLayout, corner: Vertex) -> Vec<f32> {
    let mut worst = 0f32;
    let coarser = (1..=layout.patch().trailing_zeros()).map(|level| {
        worst = worst.max(level_error(lattice, layout, corner, 1 << level));
        worst
    });
    std::iter::once(0.0).chain(coarser).collect()
}

/// The largest error of the triangles that join every `step`-th post.
fn level_error(lattice: &Lattice, layout: &PatchLayout, corner: Vertex, step: i32) -> f32 {
    let starts = || (0..layout.patch()).step_by(step as usize);
    starts()
        .flat_map(|y| starts().map(move |x| corner.moved(x, y)))
        .flat_map(|cell| Triangle::roots(cell, step))
        .map(|triangle| triangle_error(lattice, layout, &triangle))
        .fold(0f32, f32::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::emit::examples::{full_area_m2, lattice, mesh_of, sorted};
    use crate::emit::full;
    use proptest::prelude::*;
    use sandtable_mesh::check;

    fn layout(columns: u32, rows: u32) -> PatchLayout {
        PatchLayout::new(columns, rows, 16).expect("sound")
    }

    proptest! {
        #[test]
        fn stitched_borders_leave_no_t_junction_whatever_the_neighbors_levels(
            columns in 2u32..60, rows in 2u32..60, levels in proptest::collection::vec(0u32..=4, 16),
        ) {
            let (layout, lattice) = (layout(columns, rows), lattice(columns, rows, &[]));
            let levels = PatchLevels::new(&layout, levels[..layout.patch_count()].to_vec()).expect("one a patch");
            let mesh = mesh_of(&lattice, &layout, |place| triangles(&layout, &levels, layout.patches(), place));
            let area = lattice.extent().size().x * lattice.extent().size().y;
            prop_assert_eq!(check::check_with_area(&mesh, area).err(), None);
        }

        #[test]
        fn holes_are_those_of_the_full_mesh(
            columns in 2u32..60, rows in 2u32..60, holes in proptest::collection::vec(0usize..3600, 1..6),
            tolerance_m in 0.0..10.0f32,
        ) {
            let (layout, lattice) = (layout(columns, rows), lattice(columns, rows, &holes));
            let levels = Pyramids::new(&lattice, &layout).within(tolerance_m);
            let mesh = mesh_of(&lattice, &layout, |place| triangles(&layout, &levels, layout.patches(), place));
            let checked = check::check_with_area(&mesh, full_area_m2(&lattice, &layout));
            prop_assert!(checked.is_ok() || mesh.triangles.is_empty(), "{:?}", checked);
        }
    }

    #[test]
    fn level_0_is_the_full_mesh_and_the_coarsest_two_triangles_a_patch() {
        let layout = layout(33, 49);
        let emitted = |level| {
            let levels = PatchLevels::new(&layout, vec![level; layout.patch_count()]).expect("one a patch");
            sorted(|emit| triangles(&layout, &levels, layout.patches(), emit))
        };
        assert_eq!(emitted(0), sorted(|emit| full::triangles(&layout, layout.patches(), emit)));
        assert_eq!(emitted(4).len(), 2 * layout.patch_count());
        assert_eq!(emitted(3).len(), 8 * layout.patch_count());
    }

    #[test]
    fn levels_that_are_no_levels_are_refused() {
        assert_eq!(PatchLevels::new(&layout(33, 33), vec![0; 3]), None);
        assert_eq!(PatchLevels::new(&layout(33, 33), vec![5; 4]), None);
    }

    #[test]
    fn the_error_of_a_level_is_the_largest_height_difference_at_its_posts() {
        let (layout, lattice) = (layout(17, 17), lattice(17, 17, &[]));
        let pyramids = Pyramids::new(&lattice, &layout);
        let corner = Vertex::new(0, 0);
        assert_eq!(pyramids.error_m(corner, 0), 0.0);
        let mut worst = 0f32;
        for level in 1..pyramids.level_count() {
            let levels = PatchLevels::new(&layout, vec![level]).expect("one patch");
            let mesh = mesh_of(&lattice, &layout, |place| triangles(&layout, &levels, [corner], place));
            for post in lattice.posts() {
                let at = lattice.position(post).as_dvec2();
                let facet = (0..mesh.triangles.len())
                    .map(|index| mesh.corners(index))
                    .find(|facet| sandtable_terrain::triangle_surface::facet_contains(facet, at));
                let z = sandtable_terrain::triangle_surface::plane_z(&facet.expect("covered"), at);
                worst = worst.max((z - f64::from(lattice.height(post))).abs() as f32);
            }
            assert!((pyramids.error_m(corner, level) - worst).abs() < 1e-4, "level {level}: {worst}");
        }
    }

    #[test]
    fn far_patches_are_coarser_and_hold_the_tolerance_at_their_nearest_point() {
        let (layout, lattice) = (layout(129, 129), lattice(129, 129, &[]));
        let ground = PatchedGround { lattice: &lattice, layout: &layout };
        let heights = PatchHeights::new(ground);
        let pyramids = Pyramids::new(&lattice, &layout);
        let eye = Vec3::new(10.0, 10.0, 20.0);
        let camera =
            Camera::new(eye, Vec3::new(300.0, 500.0, 0.0), 0.8, (640, 480), (0.5, 9000.0)).expect("sound");
        let levels = pyramids.for_view(ground, &heights, &camera, 12.0);
        assert!(levels.at(&layout, Vertex::new(0, 0)) < levels.at(&layout, Vertex::new(112, 112)));
        for corner in layout.patches() {
            let (min, max) = heights.bounds(ground, corner).expect("data");
            let nearest = nearest_m(eye, min, max);
            let error = pyramids.error_m(corner, levels.at(&layout, corner));
            assert!(error == 0.0 || error * camera.pixels_per_meter(nearest) <= 12.0, "{corner:?}");
        }
    }
}
