//! Views whose eye depends on the picture's shape: what they show fills it, and they look north or nearly so.

use std::f32::consts::FRAC_PI_4;

use glam::{DVec2, UVec2, Vec2, Vec3};
use rayon::prelude::*;

use crate::framing::fit::{FitFrame, fitted_eye, projected};
use crate::plinth::base_z;
use crate::scene_model::SceneModel;
use crate::scene_view::FittedView;
use sandtable_geom::convex::hull;
use sandtable_geom::polygon::doubled_area;
use sandtable_geom::rect::Rect;
use sandtable_terrain::lattice::{Lattice, Post};
use sandtable_view::axes::DirectionAxes;

/// The share of the picture left free on each side: for the title above and the scale bar below.
pub(super) const LEFT_RIGHT: f32 = 0.025;
pub(super) const BELOW: f32 = 0.045;
pub(super) const ABOVE: f32 = 0.06;

/// About as many posts as this along each side of what is shown stand for its silhouette.
const POSTS: u32 = 128;

/// The pitches of which the one is chosen that fills the picture best: 40°, 45° and 50°.
const PITCHES: [f32; 3] = [FRAC_PI_4 * 40.0 / 45.0, FRAC_PI_4, FRAC_PI_4 * 50.0 / 45.0];

/// Pitches for ground that is long from south to north or from west to east, where those fill little: 30°, 35°, 55° and 60°.
const MORE_PITCHES: [f32; 4] =
    [FRAC_PI_4 * 30.0 / 45.0, FRAC_PI_4 * 35.0 / 45.0, FRAC_PI_4 * 55.0 / 45.0, FRAC_PI_4 * 60.0 / 45.0];

/// The directions, from the north, of views that keep north in the upper part of the picture: people know their place so.
const TURNS: [f32; 7] = [
    0.0,
    FRAC_PI_4 * -15.0 / 45.0,
    FRAC_PI_4 * 15.0 / 45.0,
    FRAC_PI_4 * -30.0 / 45.0,
    FRAC_PI_4 * 30.0 / 45.0,
    -FRAC_PI_4,
    FRAC_PI_4,
];

/// The share of the picture that a view toward the north at a usual pitch fills at least; where it fills less, it looks
/// aside or from another height. More of it turns more blocks out of their north.
const LEAST_FILLED: f64 = 0.6;

/// How many times as much a view that looks aside fills at least, to be worth a north that is not straight up.
const TURN_GAIN: f64 = 1.1;

/// The cells of a picture, across and down, that are told filled or empty where ground lacks data: coarse enough for the
/// points of a silhouette to lie in each cell of the ground.
const COVER_CELLS: [usize; 2] = [48, 30];

/// The pitches among which a fitted view chooses.
pub(super) fn pitches() -> impl Iterator<Item = f32> + Clone {
    PITCHES.into_iter().chain(MORE_PITCHES)
}

/// The directions among which a fitted view chooses, clockwise from north.
pub(super) fn turns() -> impl Iterator<Item = f32> + Clone {
    TURNS.into_iter()
}

/// The eye and the target of a fitted view on a picture of `size` pixels; its directions are tried on all threads.
pub fn fitted_aim(scene: &SceneModel, view: &FittedView, fov_y_rad: f32, size: (u32, u32)) -> (Vec3, Vec3) {
    let points = silhouette(scene, view.shown);
    let half = half_picture(fov_y_rad, size);
    let frame = free_frame(half);
    let lacks_data = lacks_data(&scene.lattice, view.shown);
    let aimed = |azimuth_rad: f32, pitch_rad: f32| {
        let axes = DirectionAxes::new(azimuth_rad, pitch_rad);
        let eye = fitted_eye(&points, &axes, &frame);
        let corners = projected(&points, &axes, eye).map(|corner| corner.as_dvec2());
        let filled = if lacks_data {
            covered_share(corners, half)
        } else {
            doubled_area(&hull(&corners.collect::<Vec<DVec2>>())) / 2.0 / f64::from(4.0 * half.x * half.y)
        };
        Aimed { axes, eye, filled }
    };
    let pitched = |azimuth_rad: f32, pitches: &[f32]| {
        let views: Vec<Aimed> = pitches.par_iter().map(|&pitch_rad| aimed(azimuth_rad, pitch_rad)).collect();
        fullest(views)
    };
    let usual = |azimuth_rad: f32| pitched(azimuth_rad, &PITCHES);
    let Aimed { axes, eye, .. } = match (view.azimuth_rad, view.pitch_rad) {
        (Some(azimuth_rad), Some(pitch_rad)) => aimed(azimuth_rad, pitch_rad),
        (Some(azimuth_rad), None) => usual(azimuth_rad),
        (None, stated) => {
            let north = stated.map_or_else(|| usual(0.0), |pitch_rad| aimed(0.0, pitch_rad));
            if north.filled < LEAST_FILLED {
                let all: Vec<f32> = stated.map_or_else(|| pitches().collect(), |pitch_rad| vec![pitch_rad]);
                let mut views: Vec<Aimed> =
                    TURNS.par_iter().map(|&turn_rad| pitched(turn_rad, &all)).collect();
                let north = views.remove(0);
                let aside = fullest(views);
                if aside.filled > north.filled * TURN_GAIN { aside } else { north }
            } else {
                north
            }
        }
    };
    (eye, eye + axes.forward * scene.bounds.0.distance(scene.bounds.1).max(1.0))
}

/// The view that fills most of the picture, of equals the first; there is at least one.
fn fullest(views: impl IntoIterator<Item = Aimed>) -> Aimed {
    let best = views.into_iter().reduce(|best, next| if next.filled > best.filled { next } else { best });
    best.expect("directions and pitches are listed")
}

/// The share of the cells of a picture that hold one of `points`, as tangents of angles from the axis of view.
pub(super) fn covered_share(points: impl Iterator<Item = DVec2>, half: Vec2) -> f64 {
    let [columns, rows] = COVER_CELLS;
    let mut is_covered = vec![false; columns * rows];
    for point in points {
        let share = (point / half.as_dvec2() + 1.0) / 2.0 * DVec2::new(columns as f64, rows as f64);
        let cell = share.floor().clamp(DVec2::ZERO, DVec2::new(columns as f64 - 1.0, rows as f64 - 1.0));
        is_covered[cell.y as usize * columns + cell.x as usize] = true;
    }
    is_covered.iter().filter(|is_covered| **is_covered).count() as f64 / is_covered.len() as f64
}

/// Whether posts lack data within `shown`.
pub(super) fn lacks_data(lattice: &Lattice, shown: Option<Rect>) -> bool {
    let [low, high] = shown_posts(lattice, shown);
    spread(low.y, high.y, POSTS)
        .any(|row| spread(low.x, high.x, POSTS).any(|column| lattice.height(Post { column, row }).is_nan()))
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

/// Points of the drawn ground within `shown`, its border among them; of the whole ground also the foot of the block.
/// Where all posts shown lack data, the corners of its box.
pub(super) fn silhouette(scene: &SceneModel, shown: Option<Rect>) -> Vec<Vec3> {
    silhouette_of(scene, shown, POSTS)
}

/// [`silhouette`] by about `posts` along each side.
pub(super) fn silhouette_of(scene: &SceneModel, shown: Option<Rect>, posts: u32) -> Vec<Vec3> {
    let lattice = &scene.lattice;
    let [low, high] = shown_posts(lattice, shown);
    let base_z = base_z(scene.bounds);
    let mut points = Vec::new();
    for row in spread(low.y, high.y, posts) {
        for column in spread(low.x, high.x, posts) {
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

/// The columns and rows of the first and the last post of the ground within `shown`.
fn shown_posts(lattice: &Lattice, shown: Option<Rect>) -> [UVec2; 2] {
    let (cell, last) =
        (lattice.cell(), DVec2::new(f64::from(lattice.columns() - 1), f64::from(lattice.rows() - 1)));
    let within = shown.unwrap_or(Rect { min: DVec2::ZERO, max: lattice.extent().size() });
    let post = |at: DVec2| at.clamp(DVec2::ZERO, last).as_uvec2();
    [post((within.min / cell).floor()), post((within.max / cell).ceil())]
}

/// About `count` numbers from `low` to `high`, both among them.
fn spread(low: u32, high: u32, count: u32) -> impl Iterator<Item = u32> {
    let step = ((high - low) / count).max(1) as usize;
    (low..high).step_by(step).chain([high])
}
