//! Which places of labels the ground hides from a camera, without drawing a picture.
//!
//! A picture is dear: its ground is refined, what lies on it cut, and every pixel drawn. Whether the ground hides a place
//! is known from the ground along one line. So the depths of a picture are made up: nothing is near anywhere but at the
//! places that the ground hides. Buildings and models hide none.

use glam::Vec3;

use crate::draw::color::Srgba;
use crate::draw::list::FeatureId;
use crate::draw::pixels::Pixels;
use crate::geom::polyline::Polyline;
use crate::pipeline::lint::ground_line::ground_along;
use crate::render::picture::Rendering;
use crate::scene::SceneModel;
use crate::scene::label_course::LabelCourse;
use crate::view::camera::{Camera, Projected};

/// The most places that are looked at; those of more labels count as seen. Bounds the time of a check.
const MOST_PLACES: usize = 2000;

/// The ground nearer to a place than this share of its distance from the eye hides nothing: pictures are as lenient.
const LENIENT: f32 = 0.02;

/// Pixels around a place that take its depth, as [`is_seen`](crate::pipeline::line_labels::is_seen) reads them.
const AROUND_PX: i64 = 2;

/// A picture of the ground as `camera` sees it, in which the places of labels are hidden or not; all else is far away.
pub fn label_depths(scene: &SceneModel, camera: &Camera) -> Rendering {
    let (width, height) = camera.size();
    let count = width as usize * height as usize;
    let mut depth_m = vec![f32::INFINITY; count];
    for place in places(scene).take(MOST_PLACES) {
        let Some(Projected { pixel, depth_m: distance_m }) = camera.project(place) else { continue };
        let is_inside = pixel.x >= 0.0 && pixel.y >= 0.0 && pixel.x < width as f32 && pixel.y < height as f32;
        if !is_inside || !is_hidden(scene, camera, place, distance_m) {
            continue;
        }
        for y in pixel.y as i64 - AROUND_PX..=pixel.y as i64 + AROUND_PX {
            for x in pixel.x as i64 - AROUND_PX..=pixel.x as i64 + AROUND_PX {
                if (0..i64::from(width)).contains(&x) && (0..i64::from(height)).contains(&y) {
                    // Something halfway to the place.
                    depth_m[(y * i64::from(width) + x) as usize] = distance_m / 2.0;
                }
            }
        }
    }
    let pixels = Pixels::filled(width, height, Srgba::WHITE);
    // Neither sky nor ground: who measures heights or widths on a picture finds nothing to measure.
    Rendering { pixels, depth_m, features: vec![FeatureId::PLINTH; count] }
}

/// The places of all labels on the ground: above it where they are wished there, along their lines and outlines.
fn places(scene: &SceneModel) -> impl Iterator<Item = Vec3> + '_ {
    scene.labels.iter().flat_map(|label| {
        let course: Vec<Vec3> = match &label.course {
            LabelCourse::Place => Vec::new(),
            LabelCourse::Along(lines) => lines.concat(),
            LabelCourse::Across(rings) => rings.concat(),
        };
        [label.anchor].into_iter().chain(course)
    })
}

/// Whether the ground rises above the line from a place, world space, to the eye.
fn is_hidden(scene: &SceneModel, camera: &Camera, place: Vec3, distance_m: f32) -> bool {
    let toward = camera.toward_eye(place).normalize_or_zero();
    // Above the highest ground nothing hides it.
    let up_m = (scene.bounds.1.z - place.z).max(0.0) / toward.z.max(1e-6);
    let reach_m = match camera.parallel_frame() {
        Some(_) => up_m,
        None => up_m.min(place.distance(camera.eye())),
    };
    let end = place + toward * reach_m;
    let plan = [place, end].map(|at| at.truncate().as_dvec2());
    let Some(line) = Polyline::new(plan, 0.0) else { return false };
    let Some(ground) = ground_along(scene, &line) else { return false };
    let (length_m, rise_m) = (line.length(), f64::from(end.z - place.z));
    let near_m = f64::from(LENIENT * distance_m);
    let mut stations = ground.stations().iter().zip(ground.values());
    stations.any(|(&station_m, &height_m)| {
        let ray_z = f64::from(place.z) + rise_m * station_m / length_m;
        station_m > near_m && scene.scale.world_z(height_m) > ray_z
    })
}
