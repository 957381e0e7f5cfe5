//! Views whose eye depends on the picture's shape: what they show fills it.

use std::f32::consts::FRAC_PI_4;

use glam::{DVec2, Vec2, Vec3};

use crate::geom::convex::hull;
use crate::geom::polygon::doubled_area;
use crate::geom::rect::Rect;
use crate::scene::picture::fit::{FitFrame, fitted_eye, projected};
use crate::scene::plinth::base_z;
use crate::scene::{FittedView, SceneModel};
use crate::terrain::lattice::Post;
use crate::view::axes::DirectionAxes;

/// The share of the picture left free on each side: for the title above and the scale bar below.
pub(super) const LEFT_RIGHT: f32 = 0.025;
pub(super) const BELOW: f32 = 0.045;
pub(super) const ABOVE: f32 = 0.075;

/// About as many posts as this along each side of what is shown stand for its silhouette.
const POSTS: u32 = 128;

/// The pitches between which the one is chosen that fills the picture best: 40°, 45° and 50°.
const PITCHES: [f32; 3] = [FRAC_PI_4 * 40.0 / 45.0, FRAC_PI_4, FRAC_PI_4 * 50.0 / 45.0];

/// The eye and the target of a fitted view on a picture of `size` pixels.
pub(super) fn fitted_aim(
    scene: &SceneModel,
    view: &FittedView,
    fov_y_rad: f32,
    (width, height): (u32, u32),
) -> (Vec3, Vec3) {
    let points = silhouette(scene, view.shown);
    let half = libm::tanf(fov_y_rad / 2.0) * Vec2::new(width as f32 / height as f32, 1.0);
    let frame = FitFrame {
        min: -half * (1.0 - 2.0 * Vec2::new(LEFT_RIGHT, BELOW)),
        max: half * (1.0 - 2.0 * Vec2::new(LEFT_RIGHT, ABOVE)),
    };
    let aimed = |pitch_rad: f32| {
        let axes = DirectionAxes::new(view.azimuth_rad, pitch_rad);
        (axes, fitted_eye(&points, &axes, &frame))
    };
    let (axes, eye) = match view.pitch_rad {
        Some(pitch_rad) => aimed(pitch_rad),
        None => {
            let filled = |&(axes, eye): &(DirectionAxes, Vec3)| {
                let corners: Vec<DVec2> =
                    projected(&points, &axes, eye).map(|corner| corner.as_dvec2()).collect();
                doubled_area(&hull(&corners))
            };
            let [first, others @ ..] = PITCHES.map(aimed);
            others
                .into_iter()
                .fold(first, |best, next| if filled(&next) > filled(&best) { next } else { best })
        }
    };
    (eye, eye + axes.forward * scene.bounds.0.distance(scene.bounds.1).max(1.0))
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
