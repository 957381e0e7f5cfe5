//! The ground in the middle of a picture, and the norths there.

use glam::{DVec2, Vec2};

use sandtable_annotate::north::{NorthArrow, NorthKind};
use sandtable_geom::declination::true_north;
use sandtable_render::picture::Rendering;
use sandtable_scene::scene_model::SceneModel;
use sandtable_view::camera::Camera;

/// From one pixel that is looked at to the next, where there is nothing in the very middle.
const STEP: usize = 4;

/// Map coordinates of the ground in the middle of a picture or, where it shows none there, nearest to the middle; the middle
/// of the scene where the picture shows nothing.
pub fn ground_in_middle(scene: &SceneModel, camera: &Camera, picture: &Rendering) -> DVec2 {
    let extent = scene.lattice.map_extent();
    let (width, height) = camera.size();
    let (width, height) = (width as usize, height as usize);
    let middle = Vec2::new(width as f32, height as f32) * 0.5;
    let nearest = |step: usize| {
        let pixels =
            (0..height).step_by(step).flat_map(|row| (0..width).step_by(step).map(move |x| (x, row)));
        let shown = pixels.filter(|(x, row)| picture.depth_m[row * width + x].is_finite());
        let center = |(x, row): (usize, usize)| Vec2::new(x as f32 + 0.5, row as f32 + 0.5);
        shown.min_by(|a, b| {
            center(*a).distance_squared(middle).total_cmp(&center(*b).distance_squared(middle))
        })
    };
    let in_middle =
        Some((width / 2, height / 2)).filter(|(x, row)| picture.depth_m[row * width + x].is_finite());
    let Some((x, row)) = in_middle.or_else(|| nearest(STEP)) else { return extent.center() };
    let pixel = Vec2::new(x as f32 + 0.5, row as f32 + 0.5);
    let world = camera.point_at(pixel, picture.depth_m[row * width + x]);
    // What is beside the model, such as the table, has the norths of its border.
    scene.lattice.map_point(world).clamp(extent.min, extent.max)
}

/// The north arrow of a picture: true north on the ground in its middle; grid north where that has no place on Earth.
pub fn north_arrow(scene: &SceneModel, camera: &Camera, picture: &Rendering) -> NorthArrow {
    match true_north(&scene.crs, ground_in_middle(scene, camera, picture)) {
        Some(north) => NorthArrow::from_camera(camera, north.as_vec2(), NorthKind::True),
        None => NorthArrow::from_camera(camera, Vec2::Y, NorthKind::Grid),
    }
}
