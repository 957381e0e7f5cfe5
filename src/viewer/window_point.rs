//! Where the window shows places of the scene.

use egui::{Pos2, Rect, vec2};
use glam::Vec3;

use sandtable_view::camera::Camera;

/// Where a place is in the window, in points, with its distance along the view in meters. The picture of `camera` fills
/// `rect`; the place may lie beside it. `None` behind the eye.
pub fn window_point(camera: &Camera, rect: Rect, world: Vec3) -> Option<(Pos2, f32)> {
    let seen = camera.project(world)?;
    let (width, height) = camera.size();
    let share = vec2(seen.pixel.x / width as f32, seen.pixel.y / height as f32);
    Some((rect.min + share * rect.size(), seen.depth_m))
}
