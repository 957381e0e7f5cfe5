//! Views whose eye depends on the picture's shape: what they show fills it.

use std::f32::consts::{FRAC_PI_2, FRAC_PI_4};

use glam::{DVec2, DVec3, Vec2, Vec3};

use crate::framing::fit::{FitFrame, fitted_eye, projected};
use crate::plinth::base_z;
use crate::scene_model::SceneModel;
use crate::scene_view::FittedView;
use sandtable_geom::convex::hull;
use sandtable_geom::polygon::doubled_area;
use sandtable_geom::rect::Rect;
use sandtable_terrain::lattice::Post;
use sandtable_view::axes::DirectionAxes;

/// The share of the picture left free on each side: for the title above and the scale bar below.
pub(super) const LEFT_RIGHT: f32 = 0.025;
pub(super) const BELOW: f32 = 0.045;
pub(super) const ABOVE: f32 = 0.06;

/// About as many posts as this along each side of what is shown stand for its silhouette.
const POSTS: u32 = 128;

/// The pitches between which the one is chosen that fills the picture best: 40°, 45° and 50°.
pub(super) const PITCHES: [f32; 3] = [FRAC_PI_4 * 40.0 / 45.0, FRAC_PI_4, FRAC_PI_4 * 50.0 / 45.0];

/// The share of the picture that a view toward the north fills at least; ground that is longer from south to north than
/// the picture is high is seen from its long side instead. More of it turns more blocks out of their north.
const LEAST_FILLED: f64 = 0.6;

/// How many times as much a view from the long side fills at least, to be worth a north that is not up.
const TURN_GAIN: f64 = 1.15;

/// The eye and the target of a fitted view on a picture of `size` pixels.
pub fn fitted_aim(scene: &SceneModel, view: &FittedView, fov_y_rad: f32, size: (u32, u32)) -> (Vec3, Vec3) {
    let points = silhouette(scene, view.shown);
    let half = half_picture(fov_y_rad, size);
    let frame = free_frame(half);
    let aimed = |azimuth_rad: f32, pitch_rad: f32| {
        let axes = DirectionAxes::new(azimuth_rad, pitch_rad);
        let eye = fitted_eye(&points, &axes, &frame);
        let corners: Vec<DVec2> = projected(&points, &axes, eye).map(|corner| corner.as_dvec2()).collect();
        let filled = doubled_area(&hull(&corners)) / 2.0 / f64::from(4.0 * half.x * half.y);
        Aimed { axes, eye, filled }
    };
    let toward = |azimuth_rad: f32| match view.pitch_rad {
        Some(pitch_rad) => aimed(azimuth_rad, pitch_rad),
        None => {
            let [first, others @ ..] = PITCHES.map(|pitch_rad| aimed(azimuth_rad, pitch_rad));
            others.into_iter().fold(first, |best, next| if next.filled > best.filled { next } else { best })
        }
    };
    let Aimed { axes, eye, .. } = match view.azimuth_rad {
        Some(azimuth_rad) => toward(azimuth_rad),
        None => {
            let north = toward(0.0);
            let side = || toward(from_lower_side(&points));
            if north.filled < LEAST_FILLED {
                Some(side()).filter(|side| side.filled > north.filled * TURN_GAIN).unwrap_or(north)
            } else {
                north
            }
        }
    };
    (eye, eye + axes.forward * scene.bounds.0.distance(scene.bounds.1).max(1.0))
}

/// Half of a picture of `size` pixels, as tangents of angles from the axis of view: across and down.
pub(super) fn half_picture(fov_y_rad: f32, (width, height): (u32, u32)) -> Vec2 {
    libm::tanf(fov_y_rad / 2.0) * Vec2::new(width as f32 / height as f32, 1.0)
}

/// The part of a picture that a fitted view fills.
pub(super) fn free_frame(half: Vec2) -> FitFrame {
    FitFrame {
        min: -half * (1.0 - 2.0 * Vec2::new(LEFT_RIGHT, BELOW)),
        max: half * (1.0 - 2.0 * Vec2::new(LEFT_RIGHT, ABOVE)),
    }
}

/// A view of a direction that is fitted.
struct Aimed {
    axes: DirectionAxes,
    eye: Vec3,
    /// The share of the picture that it fills.
    filled: f64,
}

/// The azimuth, to the east or to the west, of a view from the side where the ground is lower: less of it is hidden.
fn from_lower_side(points: &[Vec3]) -> f32 {
    let count = points.len() as f64;
    let mean = points.iter().map(|point| point.as_dvec3()).sum::<DVec3>() / count;
    let rise: f64 = points.iter().map(|point| (point.as_dvec3() - mean).x * f64::from(point.z)).sum();
    if rise < 0.0 { -FRAC_PI_2 } else { FRAC_PI_2 }
}

/// Points of the drawn ground within `shown`, its border among them; of the whole ground also the foot of the block.
/// Where all posts shown lack data, the corners of its box.
pub(super) fn silhouette(scene: &SceneModel, shown: Option<Rect>) -> Vec<Vec3> {
    let lattice = &scene.lattice;
    let (cell, last) =
        (lattice.cell(), DVec2::new(f64::from(lattice.columns() - 1), f64::from(lattice.rows() - 1)));
    let within = shown.unwrap_or(Rect { min: DVec2::ZERO, max: lattice.extent().size() });
    let low = (within.min / cell).floor().clamp(DVec2::ZERO, last).as_uvec2();
    let high = (within.max / cell).ceil().clamp(DVec2::ZERO, last).as_uvec2();
    let base_z = base_z(scene.bounds);
    let mut points = Vec::new();
    for row in spread(low.y, high.y) {
        for column in spread(low.x, high.x) {
            let post = Post { column, row };
            let height_m = lattice.height(post);
            if height_m.is_nan() {
                continue;
            }
            let plan = lattice.position(post);
            points.push(plan.extend(scene.scale.world_z(height_m)));
            if shown.is_none() {
                points.push(plan.extend(base_z));
            }
        }
    }
    if points.is_empty() {
        let (min, max) = scene.bounds;
        points.extend([min, max, Vec3::new(min.x, max.y, min.z), Vec3::new(max.x, min.y, min.z)]);
    }
    points
}

/// About [`POSTS`] numbers from `low` to `high`, both among them.
fn spread(low: u32, high: u32) -> impl Iterator<Item = u32> {
    let step = ((high - low) / POSTS).max(1) as usize;
    (low..high).step_by(step).chain([high])
}
