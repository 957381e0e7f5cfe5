//! Military symbols of a scene on its picture.

use glam::Vec3;

use crate::line_labels::is_seen;
use sandtable_annotate::annotation::{PictureSymbol, SymbolHeight};
use sandtable_description::words::StylePreset;
use sandtable_geom::position::notation::PositionForm;
use sandtable_picture::nested_ground::NestedHeights;
use sandtable_render::picture::Rendering;
use sandtable_scene::military::{SceneSymbol, SymbolSize};
use sandtable_scene::scene_model::SceneModel;
use sandtable_view::camera::Camera;

/// The heights in pixels between which a symbol of a size on the ground stays: legible, and not in the way.
const HEIGHTS_PX: [f32; 2] = [16.0, 120.0];
/// The arrow of movement points to where this part of the distance to the eye leads, in the picture.
const STEP_SHARE: f32 = 0.01;

/// The symbols in front of the camera, with their places on the picture.
pub fn picture_symbols(
    scene: &SceneModel,
    nested: &NestedHeights,
    camera: &Camera,
    picture: &Rendering,
) -> Vec<PictureSymbol> {
    let symbols = scene.military.iter().filter_map(|symbol| {
        let ground = nested.lifted(scene, symbol.ground);
        picture_symbol(scene, symbol, (ground, camera), picture)
    });
    match scene.preset {
        Some(StylePreset::Print) => symbols.map(in_black_and_white).collect(),
        _ => symbols.collect(),
    }
}

fn in_black_and_white(symbol: PictureSymbol) -> PictureSymbol {
    PictureSymbol { symbol: symbol.symbol.in_black_and_white(), ..symbol }
}

fn picture_symbol(
    scene: &SceneModel,
    symbol: &SceneSymbol,
    (place, camera): (Vec3, &Camera),
    picture: &Rendering,
) -> Option<PictureSymbol> {
    let ground = camera.project(place)?;
    let height = match symbol.size {
        SymbolSize::Design(height) => SymbolHeight::Design(height),
        SymbolSize::Ground(meters) => {
            let pixels = meters * camera.pixels_per_meter(ground.depth_m);
            SymbolHeight::Pixels(pixels.clamp(HEIGHTS_PX[0], HEIGHTS_PX[1]))
        }
    };
    let toward = symbol.direction_rad.and_then(|direction| {
        let step =
            Vec3::new(libm::sinf(direction), libm::cosf(direction), 0.0) * ground.depth_m.abs() * STEP_SHARE;
        (camera.project(place + step)?.pixel - ground.pixel).try_normalize()
    });
    Some(PictureSymbol {
        symbol: symbol.symbol.clone(),
        texts: symbol.texts.clone(),
        name: symbol.name.clone(),
        reference: Some(reference(scene, symbol.ground)),
        anchor_px: ground.pixel,
        direction_px: toward,
        depth_m: ground.depth_m,
        visible: is_seen(picture, ground.pixel, ground.depth_m),
        is_on_map: camera.forward().z < MAP_FORWARD_Z,
        rank: symbol.rank,
        height,
    })
}

/// The grid reference of a place in world space; map coordinates where the map has no place on Earth.
fn reference(scene: &SceneModel, place: Vec3) -> String {
    let at = scene.lattice.origin() + place.truncate().as_dvec2();
    PositionForm::Usng.write(&scene.crs, at).unwrap_or_else(|_| format!("{:.0} E {:.0} N", at.x, at.y))
}

/// A camera that looks down more steeply than this draws a map, on which symbols need no staff.
const MAP_FORWARD_Z: f32 = -0.995;
