//! Cameras that see nothing, that are too far away to show anything, or whose view a near object blocks.
//!
//! A camera whose eye is under the ground is found while the scene is built.

use std::ops::Range;

use glam::{Vec2, Vec3};

use crate::context::LintContext;
use crate::ground_line::{ground_along, place};
use crate::sink::FindingSink;
use crate::standing::standing_index;
use sandtable_description::document::CameraTable;
use sandtable_description::finding_code::FindingCode;
use sandtable_description::stated::Stated;
use sandtable_draw::list::FeatureId;
use sandtable_geom::aabb::Aabb;
use sandtable_geom::polyline::Polyline;
use sandtable_geom::rect::Rect;
use sandtable_scene::scene_model::SceneModel;
use sandtable_scene::scene_view::{SceneView, ViewAim};
use sandtable_sheet::picture::{PictureSize, framed_camera};
use sandtable_view::camera::Camera;
use sandtable_view::frustum::Frustum;
use sandtable_walk::pick::pixel_ray;

/// A scene whose longest side takes fewer pixels of the picture's width cannot be made out.
const LEAST_PX: f32 = 20.0;

/// What is nearer than this share of the way to the point that a camera looks at stands before it.
const NEAR_SHARE: f32 = 0.25;

/// Rays through the picture: one in the middle and one in the middle of each quarter, as shares of its sides.
const RAYS: [[f32; 2]; 5] = [[0.5, 0.5], [0.25, 0.25], [0.75, 0.25], [0.25, 0.75], [0.75, 0.75]];

/// So many of these have to end before the point for the view to count as blocked; the middle one alone may hit a mast.
const BLOCKED_RAYS: usize = 3;

/// Finds such cameras in the scene.
pub fn check(context: &LintContext<'_>, sink: &mut FindingSink) {
    let scene = context.scene;
    for (view, table) in scene.cameras.iter().zip(&context.document.cameras) {
        let span = span_of(table);
        let found = |code, message: String| context.finding(code, span.clone(), message);
        let camera = match framed_camera(scene, view, PictureSize::of(scene, view)) {
            Ok((camera, _)) => camera,
            Err(error) => {
                let message = format!("camera '{}' has no picture: {error}", view.name);
                sink.add(found(FindingCode::CameraSeesNothing, message));
                continue;
            }
        };
        // Its eye is on the ground, and it looks around.
        if let ViewAim::Panorama(_) = view.aim {
            continue;
        }
        let (min, max) = scene.bounds;
        if !Frustum::new(&camera).may_see(min, max) {
            let message = format!(
                "camera '{}' sees nothing of the scene: all of it is {}",
                view.name,
                aside(scene, &camera)
            );
            let help =
                "turn it by `look_at`, or leave out `eye` and `look_at`: then it is fitted to the scene";
            sink.add(found(FindingCode::CameraSeesNothing, message).with_help(help));
            continue;
        }
        let ViewAim::At { eye, target } = view.aim else { continue };
        if let Some(message) = too_far(scene, view, &camera) {
            let help = "write its eye in meters of the scene's system, or leave out `eye` and `look_at`";
            sink.add(found(FindingCode::CameraFar, message).with_help(help));
            continue;
        }
        let message = ground_before(scene, view, eye, target)
            .or_else(|| standing_before(context, view, &camera, target));
        if let Some(message) = message {
            let help = "raise it by `eye_height`, or move it";
            sink.add(found(FindingCode::CameraBlocked, message).with_help(help));
        }
    }
}

fn span_of(table: &CameraTable) -> Range<usize> {
    table.eye.as_ref().and_then(Stated::span).or_else(|| table.name.span()).unwrap_or_default()
}

/// Where all of the scene is that a camera does not see.
fn aside(scene: &SceneModel, camera: &Camera) -> &'static str {
    let (min, max) = scene.bounds;
    let is_before = |corner: Vec3| (corner - camera.eye()).dot(camera.forward()) > 0.0;
    if (Aabb { min, max }).corners().any(is_before) { "beside its picture" } else { "behind it" }
}

/// What a message says of a camera from which the scene is a dot.
fn too_far(scene: &SceneModel, view: &SceneView, camera: &Camera) -> Option<String> {
    let (min, max) = scene.bounds;
    let side_m = (max - min).max_element();
    let nearest = Aabb { min, max }.nearest_to(camera.eye());
    let distance_m = camera.eye().distance(nearest);
    let px = side_m * camera.pixels_per_meter(distance_m.max(1.0));
    (px < LEAST_PX).then(|| {
        format!(
            "camera '{}' is {:.0} km away from the scene, which is {:.2} pixels of its picture wide",
            view.name,
            distance_m / 1000.0,
            px
        )
    })
}

/// What a message says where the ground hides the point that a camera looks at, soon after the eye.
fn ground_before(scene: &SceneModel, view: &SceneView, eye: Vec3, target: Vec3) -> Option<String> {
    let [from, to] = [eye, target].map(|at| at.truncate().as_dvec2());
    let line = Polyline::new([from, to], 0.0)?;
    let ground = ground_along(scene, &line)?;
    let ray_m = |station_m: f64| {
        let part = station_m / line.length();
        f64::from(scene.scale.elevation_m(eye.z)) * (1.0 - part)
            + f64::from(scene.scale.elevation_m(target.z)) * part
    };
    // An eye under the ground is another finding.
    let first_m = ground.values()[0];
    if first_m > ray_m(0.0) {
        return None;
    }
    let stations = ground.stations().iter().zip(ground.values());
    let blocked = stations.take_while(|(station_m, _)| **station_m < f64::from(NEAR_SHARE) * line.length());
    let (&station_m, &height_m) =
        { blocked }.find(|(station_m, height_m)| **height_m > ray_m(**station_m))?;
    Some(format!(
        "camera '{}' looks into the ground {station_m:.0} m before it at {}: it is {height_m:.1} m high there, and the line to \
         `look_at`, {:.0} m away, {:.1} m",
        view.name,
        place(scene, line.at(station_m)),
        line.length(),
        ray_m(station_m)
    ))
}

/// What a message says where something that stands in the scene fills the picture before the point that it looks at.
fn standing_before(
    context: &LintContext<'_>,
    view: &SceneView,
    camera: &Camera,
    target: Vec3,
) -> Option<String> {
    let reach_m = f64::from(camera.eye().distance(target) * NEAR_SHARE);
    let eye = camera.eye().truncate().as_dvec2();
    let is_near = |_: FeatureId, around: &Rect| eye.clamp(around.min, around.max).distance(eye) < reach_m;
    let index = standing_index(context.scene, &is_near);
    let (width, height) = camera.size();
    let rays = RAYS.map(|[x, y]| pixel_ray(camera, Vec2::new(x * width as f32, y * height as f32)));
    let hits: Vec<(f64, FeatureId)> = rays.iter().filter_map(|&ray| index.pick(ray, reach_m)).collect();
    let (distance_m, feature) = hits.iter().copied().min_by(|a, b| a.0.total_cmp(&b.0))?;
    (hits.len() >= BLOCKED_RAYS).then(|| {
        format!(
            "camera '{}' has {} {distance_m:.1} m before it: {} of {} rays through its picture end within a quarter of the \
             way to `look_at`, {:.0} m away",
            view.name,
            context.name(feature),
            hits.len(),
            rays.len(),
            camera.eye().distance(target)
        )
    })
}
