//! Labels and cameras in world space.

use glam::Vec3;
use toml::Spanned;

use crate::description::diagnostic::Diagnostic;
use crate::description::document::{CameraTable, Document};
use crate::scene::kind::{Label, Terrain, View};
use crate::scene::place::Places;

/// The document's labels, `{height}` filled in.
///
/// # Errors
/// A label stands off the ground.
pub fn labels(document: &Document, places: &Places<'_>, terrain: &Terrain) -> Result<Vec<Label>, Diagnostic> {
    let label = |table: &crate::description::document::Label| {
        let world = places.point(&table.at, table.crs.as_ref())?;
        let ground = places.on_ground(&terrain.lattice, &table.at, world)?;
        let elevation = format!("{:.0}", ground.z / terrain.exaggeration);
        let above = table.height.as_ref().map_or(0.0, |height| *height.get_ref()) as f32;
        Ok(Label {
            text: table.text.get_ref().replace("{height}", &elevation),
            ground,
            anchor: ground + Vec3::Z * above,
            kind: table.kind.as_ref().map(Spanned::get_ref).copied().unwrap_or_default(),
        })
    };
    document.labels.iter().map(label).collect()
}

/// The document's cameras, or one that sees the whole ground where it has none.
///
/// # Errors
/// A camera's eye or target stands off the ground without an elevation of its own.
pub fn cameras(document: &Document, places: &Places<'_>, terrain: &Terrain) -> Result<Vec<View>, Diagnostic> {
    if document.cameras.is_empty() {
        return Ok(vec![overview(terrain)]);
    }
    document.cameras.iter().map(|table| camera(table, places, terrain)).collect()
}

fn camera(table: &CameraTable, places: &Places<'_>, terrain: &Terrain) -> Result<View, Diagnostic> {
    let metres = |stated: &Option<Spanned<f64>>, default: f64| {
        stated.as_ref().map_or(default, |value| *value.get_ref()) as f32
    };
    let eye_world = places.point(&table.eye, table.crs.as_ref())?;
    let eye = match &table.eye_elevation {
        Some(elevation) => eye_world.as_vec2().extend(*elevation.get_ref() as f32 * terrain.exaggeration),
        None => {
            let ground = places.on_ground(&terrain.lattice, &table.eye, eye_world).map_err(|error| {
                error.with_help("give the camera an eye_elevation where its eye is not above the model")
            })?;
            ground + Vec3::Z * metres(&table.eye_height, 2.0)
        }
    };
    let target_world = places.point(&table.look_at, table.crs.as_ref())?;
    let target = places.on_ground(&terrain.lattice, &table.look_at, target_world)?;
    Ok(View {
        name: table.name.get_ref().clone(),
        eye,
        target: target + Vec3::Z * metres(&table.look_at_height, 0.0),
        fov_y_rad: metres(&table.field_of_view, 40.0).to_radians(),
    })
}

/// From the south, looking down at about 35°, with the whole ground in view.
fn overview(terrain: &Terrain) -> View {
    let (min, max) = terrain.bounds();
    let target = (min + max) / 2.0;
    let reach = (max - min).truncate().max_element();
    let eye = target + Vec3::new(0.0, -1.15 * reach, 0.85 * reach);
    View { name: "overview".into(), eye, target, fov_y_rad: 40f32.to_radians() }
}
