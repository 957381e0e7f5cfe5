//! Plans the nested grounds of a picture: which parts of a reduced ground need more samples, and how many.
//!
//! ```text
//!  ┌───────────────────┐  the ground of the scene: all of it, means of many samples
//!  │  ┌───────────┐    │
//!  │  │ ┌───────┐ │    │  nested grounds, each with posts half as far apart as the one around it: rectangles around what
//!  │  │ │  ┌─┐  │ │    │  is in view where a pixel shows a post of the ground around as wider than half a pixel
//!  │  │ │  └∧┘  │ │    │
//!  └──┴─┴───────┴─┴────┘
//! ```
//!
//! A rectangle holds no more posts than a picture has use for: ground in view is taken from the eye on until it is full, and
//! what is farther away belongs to the ground around. The heights in view are known from the reduced ground, so that an eye
//! that is high above it reads little, and one that looks down reads what its picture shows.

use glam::{DVec2, Vec3};

use sandtable_geom::aabb::Aabb;
use sandtable_geom::rect::Rect;
use sandtable_scene::finer_elevation::level_samples;
use sandtable_scene::framing::shown_step::SQUARE_PX;
use sandtable_scene::scene_model::SceneModel;
use sandtable_terrain::lattice::{Lattice, Post};
use sandtable_view::camera::Camera;
use sandtable_view::frustum::Frustum;

/// The sides of the blocks that rectangles consist of, in cells of the scene's ground: powers of two, as its triangles are,
/// few of which are cut at the border of a nested ground then.
const BLOCK: u32 = 16;

/// Posts of a nested ground for each pixel of a picture: in perspective half of them are out of view.
const POSTS_PER_PIXEL: u64 = 2;

/// The same where rays are parallel, and no pixel shows less ground than another: a nested ground then shows all of it.
const POSTS_PER_PARALLEL_PIXEL: u64 = 16;

/// The greatest part of a block's relief by which samples may be above or below their means.
const ABOVE_MEANS: f32 = 0.5;

/// A nested ground: the posts of a part of the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct NestedPlan {
    /// The side of the squares of samples that its heights are means of.
    pub step: u32,
    /// Its rectangle in world space, with borders along posts of the scene's ground.
    pub rect: Rect,
}

/// The nested grounds of a picture of `scene`, whose heights are means of `step` × `step` samples, the coarsest first. Each
/// lies within the one before.
pub(super) fn nested_plans(scene: &SceneModel, camera: &Camera, step: u32) -> Vec<NestedPlan> {
    let blocks = SeenBlock::of(scene, camera);
    let cell_m = scene.lattice.cell() / f64::from(step);
    let (width, height) = camera.size();
    let per_pixel =
        if camera.parallel_frame().is_some() { POSTS_PER_PARALLEL_PIXEL } else { POSTS_PER_PIXEL };
    let most = level_samples().max(u64::from(width) * u64::from(height) * per_pixel) as f64;
    let mut plans: Vec<NestedPlan> = Vec::new();
    let steps = (0..step.ilog2()).rev().map(|power| 1 << power);
    for step in steps {
        let own_m = cell_m * f64::from(step);
        let mut rect: Option<Rect> = None;
        // The widest squares that a block may show rise from block to block.
        for block in blocks.iter().take_while(|block| block.square_m < 2.0 * own_m.max_element()) {
            let with = rect.map_or(block.rect, |rect| {
                Rect::around([rect.min, rect.max, block.rect.min, block.rect.max])
            });
            if (with.size() / own_m).element_product() > most {
                break;
            }
            rect = Some(with);
        }
        let Some(rect) = rect else { continue };
        // All of the ground around would be covered.
        if plans.last().is_some_and(|around| around.rect == rect) {
            plans.pop();
        }
        plans.push(NestedPlan { step, rect });
    }
    plans
}

/// A block of the scene's ground that may be in view.
#[derive(Clone, Copy, Debug)]
struct SeenBlock {
    rect: Rect,
    /// The side of the squares of samples that are half a pixel wide where it is nearest, in meters.
    square_m: f64,
}

impl SeenBlock {
    /// Those of a scene, the nearest first.
    fn of(scene: &SceneModel, camera: &Camera) -> Vec<Self> {
        let (lattice, frustum) = (&*scene.lattice, Frustum::new(camera));
        let last = [lattice.columns() - 1, lattice.rows() - 1];
        let starts = |axis: usize| (0..last[axis]).step_by(BLOCK as usize);
        let mut blocks: Vec<Self> = starts(1)
            .flat_map(|row| starts(0).map(move |column| Post { column, row }))
            .filter_map(|first| {
                let end = Post {
                    column: (first.column + BLOCK).min(last[0]),
                    row: (first.row + BLOCK).min(last[1]),
                };
                let (low, high) = z_range(lattice, first, end)?;
                let [min, max] = [first, end].map(|post| post.grid() * lattice.cell());
                let z = |height_m: f32| scene.scale.world_z(height_m);
                let bounds = Aabb { min: min.as_vec2().extend(z(low)), max: max.as_vec2().extend(z(high)) };
                let seen = frustum.may_see(bounds.min, bounds.max);
                seen.then(|| Self { rect: Rect { min, max }, square_m: square_m(&bounds, camera) })
            })
            .collect();
        let place = |block: &Self| [block.rect.min.y, block.rect.min.x];
        let order = |a: &Self, b: &Self| {
            let ([ay, ax], [by, bx]) = (place(a), place(b));
            a.square_m.total_cmp(&b.square_m).then(ay.total_cmp(&by)).then(ax.total_cmp(&bx))
        };
        blocks.sort_by(order);
        blocks
    }
}

/// Between what elevations the samples of a block lie, as its means have it; `None` without data.
fn z_range(lattice: &Lattice, first: Post, end: Post) -> Option<(f32, f32)> {
    let start = (f32::INFINITY, f32::NEG_INFINITY);
    let (low, high) = (first.row..=end.row).fold(start, |range, row| {
        let from = lattice.index(Post { column: first.column, row });
        let heights = &lattice.heights()[from..=from + (end.column - first.column) as usize];
        heights.iter().fold(range, |(low, high), &height| (low.min(height), high.max(height)))
    });
    let more = (high - low) * ABOVE_MEANS;
    (low <= high).then_some((low - more, high + more))
}

/// The width of [`SQUARE_PX`] pixels where a box comes nearest to the camera, meters; 0 at the eye.
fn square_m(bounds: &Aabb, camera: &Camera) -> f64 {
    let size: Vec3 = bounds.size();
    let depth_m =
        (bounds.center() - camera.eye()).dot(camera.forward()) - 0.5 * size.dot(camera.forward().abs());
    // Depth says little beside the eye.
    let aside_m = camera.eye().clamp(bounds.min, bounds.max).distance(camera.eye());
    let half = f64::from(camera.tan_half_fov().length()).hypot(1.0) as f32;
    let depth_m = depth_m.max(aside_m / half);
    if depth_m <= 0.0 && camera.parallel_frame().is_none() {
        return 0.0;
    }
    SQUARE_PX / f64::from(camera.pixels_per_meter(depth_m))
}

/// Whether a place lies in a rectangle, not on its border.
pub(super) fn is_within(rect: &Rect, at: DVec2) -> bool {
    rect.min.cmplt(at).all() && at.cmplt(rect.max).all()
}
