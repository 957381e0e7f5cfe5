//! The places where a picture shows each 100 km square, for its letters.

use std::collections::BTreeMap;

use glam::{DVec2, UVec2, Vec2};

use sandtable_annotate::grid::SquareName;
use sandtable_draw::list::FeatureId;
use sandtable_geom::crs::Crs;
use sandtable_geom::mgrs::GridSquare;
use sandtable_render::picture::Rendering;
use sandtable_scene::scene_model::SceneModel;
use sandtable_view::camera::Camera;

/// The pixels from one place that is looked at to the next.
const STEP: u32 = 24;
/// A square that shows on less than this share of the picture has no letters.
const LEAST_SHARE: f32 = 0.015;

/// The letters of the squares that a picture shows, each at the place that is nearest to the middle of what shows of it.
pub fn square_names(scene: &SceneModel, camera: &Camera, picture: &Rendering) -> Vec<SquareName> {
    let size = UVec2::new(picture.pixels.width(), picture.pixels.height());
    let mut shown: BTreeMap<GridSquare, Vec<Vec2>> = BTreeMap::new();
    let steps = size / STEP;
    for index in 0..steps.element_product() {
        let pixel = UVec2::new(index % steps.x, index / steps.x) * STEP + STEP / 2;
        let at = (pixel.y * size.x + pixel.x) as usize;
        let is_ground = ![FeatureId::NONE, FeatureId::PLINTH].contains(&picture.features[at]);
        let middle = pixel.as_vec2() + 0.5;
        let world = camera.point_at(middle, picture.depth_m[at]);
        let square = Some(world.truncate().as_dvec2()).filter(|_| is_ground).and_then(|at| square(scene, at));
        if let Some(square) = square {
            shown.entry(square).or_default().push(middle);
        }
    }
    let least = (steps.element_product() as f32 * LEAST_SHARE).max(1.0) as usize;
    let name = |(square, places): (GridSquare, Vec<Vec2>)| {
        let mean = places.iter().sum::<Vec2>() / places.len() as f32;
        let nearest =
            places.iter().min_by(|a, b| a.distance_squared(mean).total_cmp(&b.distance_squared(mean)));
        nearest.map(|&at_px| SquareName { at_px, letters: square.letters })
    };
    shown.into_iter().filter(|(_, places)| places.len() >= least).filter_map(name).collect()
}

fn square(scene: &SceneModel, world: DVec2) -> Option<GridSquare> {
    let place = scene.crs.transform(&Crs::wgs84(), world + scene.lattice.origin()).ok()?;
    GridSquare::at(place)
}
