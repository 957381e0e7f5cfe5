//! The elevations that a picture shows, read from the map by which its ground is drawn.

use glam::Vec2;

use sandtable_draw::list::{DrawList, FeatureId};
use sandtable_render::picture::Rendering;
use sandtable_view::camera::Camera;

/// The elevation in meters of the bare ground at a place of the picture, in pixels; `None` where it shows something else.
pub(crate) fn shown_elevation_m(
    list: &DrawList,
    camera: &Camera,
    picture: &Rendering,
    pixel: Vec2,
) -> Option<f32> {
    let index = pixel.y as usize * picture.pixels.width() as usize + pixel.x as usize;
    let depth_m = picture.depth_m[index];
    let is_ground = picture.features[index] == FeatureId::GROUND && depth_m.is_finite();
    if is_ground { list.ground_height_m(camera.point_at(pixel, depth_m).truncate()) } else { None }
}
