//! Finds the labels whose places are hidden from a camera, without drawing a picture.
//!
//! A picture is dear: its ground is refined, what lies on it cut, and every pixel drawn. Whether the ground hides a place
//! is known from the ground along one line, and whether a building, a bridge or a model does from a few rays. So the depths
//! of a picture are made up: nothing is near anywhere but at the places that are hidden. Scattered plants hide none.

use std::collections::BTreeMap;

use glam::{Vec2, Vec3};

use crate::ground_line::ground_along;
use crate::standing::standing_index;
use sandtable_draw::color::Srgba;
use sandtable_draw::list::FeatureId;
use sandtable_draw::pixels::Pixels;
use sandtable_geom::polyline::Polyline;
use sandtable_render::picture::Rendering;
use sandtable_scene::feature::FeatureKind;
use sandtable_scene::label_course::LabelCourse;
use sandtable_scene::scene_label::SceneLabel;
use sandtable_scene::scene_model::SceneModel;
use sandtable_view::camera::{Camera, Projected};
use sandtable_walk::pick::{StandingIndex, pixel_ray};

/// The most places that are looked at; those of more labels count as seen. Bounds the time of a check.
const MOST_PLACES: usize = 2000;

/// What is nearer to a place than this share of its distance from the eye hides nothing: pictures are as lenient.
const LENIENT: f32 = 0.02;

/// Pixels around a place that take its depth, as [`is_seen`](sandtable_sheet::line_labels::is_seen) reads them.
const AROUND_PX: i64 = 2;

/// The pixels around a place of which one that shows it is enough, as `is_seen` has it: the middle and the corners.
const LOOKED_AT: [[f32; 2]; 5] = [[0.0, 0.0], [-1.0, -2.0], [1.0, -2.0], [-1.0, 1.0], [1.0, 1.0]];

/// The visibility of the places of labels.
pub struct LabelSight {
    /// A picture in which they are hidden or not; all else is far away.
    pub picture: Rendering,
    /// The feature before the place of a label, by the label's text.
    pub behind: BTreeMap<String, FeatureId>,
}

/// The sight that `camera` has of the places of all labels.
pub fn label_sight(scene: &SceneModel, camera: &Camera) -> LabelSight {
    let (width, height) = camera.size();
    let count = width as usize * height as usize;
    let mut depth_m = vec![f32::INFINITY; count];
    let mut behind = BTreeMap::new();
    let index = standing_index(scene, &|feature, _| is_opaque(scene, feature));
    for LabelPlace { label, at } in places(scene).take(MOST_PLACES) {
        let Some(Projected { pixel, depth_m: distance_m }) = camera.project(at) else { continue };
        let is_inside = pixel.x >= 0.0 && pixel.y >= 0.0 && pixel.x < width as f32 && pixel.y < height as f32;
        if !is_inside {
            continue;
        }
        if !is_behind_ground(scene, camera, at, distance_m) {
            let Some(feature) = standing_before(&index, camera, pixel, distance_m) else { continue };
            behind.entry(label.text.clone()).or_insert(feature);
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
    let picture = Rendering { pixels, depth_m, features: vec![FeatureId::PLINTH; count] };
    LabelSight { picture, behind }
}

/// Whether a feature is one that nothing is seen through.
fn is_opaque(scene: &SceneModel, feature: FeatureId) -> bool {
    let kind = feature.index().and_then(|index| scene.features.get(index)).map(|feature| feature.kind);
    matches!(kind, Some(FeatureKind::Building | FeatureKind::Bridge | FeatureKind::Model))
}

/// A place of a label, world space.
struct LabelPlace<'a> {
    label: &'a SceneLabel,
    at: Vec3,
}

/// The places of all labels: where they are wished on the ground and above it, along their lines and outlines.
fn places(scene: &SceneModel) -> impl Iterator<Item = LabelPlace<'_>> {
    scene.labels.iter().flat_map(|label| {
        let course: Vec<Vec3> = match &label.course {
            LabelCourse::Place => Vec::new(),
            LabelCourse::Along(lines) => lines.concat(),
            LabelCourse::Across(rings) => rings.concat(),
        };
        let raised = (label.anchor != label.ground).then_some(label.anchor);
        let places = [label.ground].into_iter().chain(raised).chain(course);
        places.map(move |at| LabelPlace { label, at })
    })
}

/// Whether the ground rises above the line from a place, world space, to the eye.
fn is_behind_ground(scene: &SceneModel, camera: &Camera, place: Vec3, distance_m: f32) -> bool {
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

/// What stands before all pixels around a place at a depth.
fn standing_before(index: &StandingIndex, camera: &Camera, pixel: Vec2, depth_m: f32) -> Option<FeatureId> {
    let before = |offset: [f32; 2]| {
        let ray = pixel_ray(camera, pixel + Vec2::from(offset));
        index.pick(ray, f64::from(depth_m * (1.0 - LENIENT)) * ray.direction.length())
    };
    let (_, feature) = before(LOOKED_AT[0])?;
    LOOKED_AT[1..].iter().all(|&offset| before(offset).is_some()).then_some(feature)
}
