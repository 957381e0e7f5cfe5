//! Fits a panorama to its skyline: how high the picture is, and where its horizon lies.
//!
//! ```text
//!   ┌──────────────────────────────────┐
//!   │  names of peaks                  │  NAMES_SHARE of the height, above the highest skyline
//!   │      │        ╱╲    │            │
//!   │   ╱╲ │  ╱╲___╱  ╲  ╱╲            │  the skyline, from its highest to its lowest
//!   │__╱  ╲╱╲╱         ╲╱  ╲___________│
//!   │  ground before it                │  FOREGROUND below the lowest skyline, and below the horizon
//!   └──────────────────────────────────┘
//! ```

use std::f32::consts::TAU;

use crate::scene_model::SceneModel;
use crate::scene_view::PanoramaView;
use sandtable_geom::aabb::Aabb;
use sandtable_terrain::sight::Curvature;
use sandtable_terrain::sight::skyline::{SkylineEye, skyline};
use sandtable_view::camera::far_m;
use sandtable_view::panorama::Panorama;

/// The part of the picture's height above the highest skyline, for names: three rows of them.
const NAMES_SHARE: f32 = 0.36;

/// The ground that shows below the lowest skyline, and at least below the horizon: tangent of the angle, 6°.
const FOREGROUND: f32 = 0.105;

/// Width of the picture of the whole circle, and the least width of that of a part of it, in pixels.
const CIRCLE_PX: f32 = 5760.0;
const LEAST_PX: f32 = 1920.0;

/// The least and the greatest height of a picture by its width: lower ones have no place for names, higher ones are mostly
/// foreground.
const HEIGHTS: [f32; 2] = [1.0 / 7.0, 0.5625];

/// Azimuths at which the skyline is looked for, in a full turn: four a degree.
const AZIMUTHS: f32 = 1440.0;

/// Near plane of a panorama, meters.
const NEAR_M: f32 = 0.5;

/// The heights of a skyline, as they are drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
struct SkylineRange {
    /// Tangents above the horizon.
    low: f32,
    high: f32,
}

impl SkylineRange {
    fn of(scene: &SceneModel, view: &PanoramaView) -> Self {
        let eye = SkylineEye {
            at: scene.lattice.map_point(view.eye),
            height_m: f64::from(scene.scale.elevation_m(view.eye.z)),
        };
        let count = (AZIMUTHS * view.span_rad / TAU).ceil().max(1.0) as u32;
        let mut range = Self { low: f32::INFINITY, high: f32::NEG_INFINITY };
        for number in 0..=count {
            let azimuth = view.from_rad + view.span_rad * number as f32 / count as f32;
            if let Some(seen) = skyline(&scene.lattice, eye, f64::from(azimuth), Curvature::default()) {
                let rise = scene.scale.world_z(seen.rise as f32);
                range = Self { low: range.low.min(rise), high: range.high.max(rise) };
            }
        }
        if range.low <= range.high { range } else { Self { low: 0.0, high: 0.0 } }
    }

    /// From the highest skyline to the lowest ground that shows, tangents.
    fn shown(self) -> f32 {
        self.high - (self.low.min(0.0) - FOREGROUND)
    }
}

/// Width and height of the picture of a panorama whose size nothing states.
pub fn panorama_size(scene: &SceneModel, view: &PanoramaView) -> (u32, u32) {
    let width = (CIRCLE_PX * view.span_rad / TAU).max(LEAST_PX).round();
    let shown_px = SkylineRange::of(scene, view).shown() * width / view.span_rad;
    let height = (shown_px / (1.0 - NAMES_SHARE)).clamp(width * HEIGHTS[0], width * HEIGHTS[1]);
    (width as u32, height.round() as u32)
}

/// The panorama of a view on a picture of `size` pixels: the highest skyline below the place of the names.
pub fn panorama(scene: &SceneModel, view: &PanoramaView, size: (u32, u32)) -> Panorama {
    let (min, max) = scene.bounds;
    let (width, height) = (size.0.max(1), size.1.max(1));
    let per_radian = width as f32 / view.span_rad;
    let high = SkylineRange::of(scene, view).high;
    let horizon = height as f32 * NAMES_SHARE + high * per_radian;
    Panorama {
        eye: view.eye,
        from_rad: view.from_rad,
        span_rad: view.span_rad,
        size: (width, height),
        horizon_row: horizon.round() as i32,
        planes: (NEAR_M, far_m(&Aabb { min, max }, view.eye)),
    }
}
