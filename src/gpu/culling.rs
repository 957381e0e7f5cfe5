//! What stands, in groups of neighbors that are drawn or left out together.
//!
//! ```text
//!   cells of the ground, in Morton's order (1966):    0 1 4 5
//!                                                     2 3 6 7      neighbors lie near each other in a buffer
//! ```
//!
//! A window draws a scene of which it sees a part. Whatever is drawn alike is therefore sorted by cells, and a frame draws the
//! ranges of those cells that it sees; ranges that follow each other are one call.

use std::ops::Range;

use glam::{UVec2, Vec2, Vec3};
use rayon::prelude::*;

use sandtable_draw::list::{DepthLayer, DrawItem, DrawList};
use sandtable_geom::aabb::Aabb;
use sandtable_view::camera::Camera;
use sandtable_view::frustum::Frustum;

/// Cells along each side of what stands, as a power of two: more leave out more of what is not seen, and take more tests.
const CELL_BITS: u32 = 5;

/// Groups whose largest item is smaller than this many pixels are not drawn: a pixel's samples miss most of them.
pub const LEAST_PX: f32 = 0.5;

/// Items that are drawn or left out together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ItemGroup {
    /// The box around them in world space.
    pub bounds: Aabb,
    /// The diagonal of the largest one's box, in meters.
    pub largest_m: f32,
}

/// The number of a group in a plan.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GroupId(pub u32);

/// A camera that sees some groups.
#[derive(Clone, Copy, Debug)]
pub struct CullingView {
    camera: Camera,
    frustum: Frustum,
}

/// The cells of what stands.
#[derive(Clone, Copy, Debug)]
pub struct ItemCells {
    min: Vec2,
    per_m: Vec2,
}

impl ItemGroup {
    /// The group of one item.
    pub fn of(bounds: Aabb) -> Self {
        Self { bounds, largest_m: bounds.size().length() }
    }

    /// Both together.
    pub fn with(self, other: Self) -> Self {
        let (min, max) = (self.bounds.min.min(other.bounds.min), self.bounds.max.max(other.bounds.max));
        Self { bounds: Aabb { min, max }, largest_m: self.largest_m.max(other.largest_m) }
    }
}

impl CullingView {
    /// What `camera` sees.
    pub fn new(camera: &Camera) -> Self {
        Self { camera: *camera, frustum: Frustum::new(camera) }
    }

    /// Whether any of what a box holds may be seen, however small it is.
    pub fn reaches(&self, bounds: &Aabb) -> bool {
        self.frustum.may_see(bounds.min, bounds.max)
    }

    /// Whether any of a group may be seen.
    pub fn shows(&self, ItemGroup { bounds, largest_m }: &ItemGroup) -> bool {
        let camera = &self.camera;
        let ahead_m = camera.forward().dot(bounds.center() - camera.eye());
        let nearest_m = ahead_m - camera.forward().abs().dot(bounds.size()) * 0.5;
        let largest_px = camera.pixels_per_meter(nearest_m.max(camera.planes().0)) * largest_m;
        // What is not finite is drawn.
        let is_small = largest_px < LEAST_PX;
        !is_small && self.reaches(bounds)
    }
}

impl ItemCells {
    /// The cells of items with these boxes.
    pub fn new<'a>(bounds: impl IntoIterator<Item = &'a Aabb>) -> Self {
        let around = Aabb::around(bounds.into_iter().map(Aabb::center)).unwrap_or_default();
        let cells = (1 << CELL_BITS) as f32;
        Self { min: around.min.truncate(), per_m: cells / around.size().truncate().max(Vec2::ONE) }
    }

    /// The number of the cell of an item, neighbors one after the other.
    pub fn of(&self, bounds: &Aabb) -> u32 {
        let cell = (bounds.center().truncate() - self.min) * self.per_m;
        let UVec2 { x, y } = cell.as_uvec2().min(UVec2::splat((1 << CELL_BITS) - 1));
        (0..CELL_BITS)
            .fold(0, |code, bit| code | (x >> bit & 1) << (2 * bit) | (y >> bit & 1) << (2 * bit + 1))
    }
}

/// Whether each item of a checked list may be in the picture of `camera`; the ground always is.
pub fn seen_items(list: &DrawList, camera: &Camera) -> Vec<bool> {
    let frustum = Frustum::new(camera);
    let runs: Vec<Range<usize>> = list.runs().collect();
    let of_run = |run: &Range<usize>| -> Vec<bool> {
        let first = &list.items[run.start];
        if first.layer == DepthLayer::Ground {
            return vec![true; run.len()];
        }
        let of_mesh = mesh_bounds(list, first);
        let is_seen = |item: &DrawItem| {
            let Aabb { min, max } = placed_bounds(item, &of_mesh);
            frustum.may_see(min, max)
        };
        list.items[run.clone()].iter().map(is_seen).collect()
    };
    runs.par_iter().flat_map_iter(of_run).collect()
}

/// The box around what `item` draws, in its mesh's space.
pub fn mesh_bounds(list: &DrawList, item: &DrawItem) -> Aabb {
    let mesh = &list.meshes[item.mesh.0 as usize];
    let drawn = &mesh.triangles[item.triangles.start as usize..item.triangles.end as usize];
    Aabb::around(drawn.iter().flatten().map(|id| Vec3::from_array(mesh.vertices[id.index()].position)))
        .unwrap_or_default()
}

/// The box around a box of a mesh's space where `item` places it.
pub fn placed_bounds(item: &DrawItem, of_mesh: &Aabb) -> Aabb {
    let corners = of_mesh.corners().map(|corner| item.world_from_mesh.transform_point3(corner));
    Aabb::around(corners).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cube(center: Vec3, half_m: f32) -> ItemGroup {
        ItemGroup::of(Aabb { min: center - half_m, max: center + half_m })
    }

    #[test]
    fn a_group_is_drawn_where_it_is_in_view_and_not_too_small() {
        let camera = Camera::new(Vec3::ZERO, Vec3::Y, 1.0, (800, 800), (1.0, 50_000.0)).expect("sound");
        let view = CullingView::new(&camera);
        assert!(view.shows(&cube(Vec3::Y * 100.0, 1.0)));
        assert!(!view.shows(&cube(Vec3::Y * -100.0, 1.0)), "behind");
        assert!(!view.shows(&cube(Vec3::new(100.0, 50.0, 0.0), 1.0)), "beside");
        assert!(!view.shows(&cube(Vec3::Y * 20_000.0, 1.0)), "a tenth of a pixel");
        assert!(view.shows(&cube(Vec3::Y * 20_000.0, 300.0)));
        assert!(view.shows(&cube(Vec3::ZERO, 0.01)), "around the eye");
        let small_and_far = cube(Vec3::Y * 20_000.0, 1.0).with(cube(Vec3::Y * 10.0, 0.5));
        assert!(view.shows(&small_and_far), "one of both is near");
    }

    #[test]
    fn cells_cover_what_stands_and_neighbors_follow_each_other() {
        let boxes: Vec<Aabb> = (0..64u16)
            .map(|index| Vec3::new(f32::from(index % 8), f32::from(index / 8), 0.0) * 100.0)
            .map(|center| cube(center, 5.0).bounds)
            .collect();
        let cells = ItemCells::new(&boxes);
        let of = |x: usize, y: usize| cells.of(&boxes[y * 8 + x]);
        assert_eq!((of(0, 0), of(7, 7)), (0, 1023));
        let mut all: Vec<u32> = boxes.iter().map(|bounds| cells.of(bounds)).collect();
        all.sort_unstable();
        all.dedup();
        assert_eq!(all.len(), 64);
        let south_west = (0..4).flat_map(|y| (0..4).map(move |x| (x, y))).map(|(x, y)| of(x, y));
        assert_eq!(south_west.filter(|cell| *cell < 256).count(), 16, "a quarter is one range");
    }

    #[test]
    fn items_at_one_place_have_one_cell() {
        let here = cube(Vec3::splat(7.0), 2.0).bounds;
        assert_eq!(ItemCells::new([&here, &here]).of(&here), 0);
        assert_eq!(ItemCells::new([]).of(&here), 1023, "and a box beside all of them the last");
    }
}
