//! Models: every file read once, every placement checked against the ground.

use std::collections::BTreeMap;

use toml::Spanned;

use crate::description::diagnostic::Diagnostic;
use crate::description::document::Document;
use crate::description::expression::Quantity;
use crate::model::kind::Model;
use crate::model::read;
use crate::scene::assets::Assets;
use crate::scene::attributes::Attributes;
use crate::scene::collected::Collected;
use crate::scene::kind::{FeatureKind, Placement};
use crate::scene::place::Places;
use crate::terrain::lattice::Lattice;

/// Reads the document's models and places them.
///
/// # Errors
/// A file cannot be had or read, or a model stands off the ground.
pub fn place(
    document: &Document,
    places: &Places<'_>,
    assets: &Assets,
    lattice: &Lattice,
    collected: &mut Collected,
) -> Result<(Vec<Model>, Vec<Placement>), Diagnostic> {
    let (mut models, mut placements) = (Vec::new(), Vec::new());
    let mut loaded: BTreeMap<&str, usize> = BTreeMap::new();
    for table in &document.models {
        let file = table.file.get_ref().as_str();
        let model = match loaded.get(file) {
            Some(&model) => model,
            None => {
                models.push(load(document, assets, &table.file, collected)?);
                *loaded.entry(file).or_insert(models.len() - 1)
            }
        };
        let Some(at) = &table.at else { continue };
        let world = places.point(at, table.crs.as_ref())?;
        places.on_ground(lattice, at, world)?;
        let none = Attributes::default();
        let number = |stated: &Option<Spanned<Quantity>>, default: f64| {
            none.number(stated.as_ref()).unwrap_or(default) as f32
        };
        placements.push(Placement {
            model,
            at: world.as_vec2(),
            clamp: table.clamp.as_ref().map(Spanned::get_ref).copied().unwrap_or_default(),
            height_m: number(&table.height, 0.0),
            heading_rad: number(&table.heading, 0.0).to_radians(),
            scale: number(&table.scale, 1.0),
            feature: collected.add(FeatureKind::Model, table.name.clone().unwrap_or_else(|| file.to_owned())),
        });
    }
    Ok((models, placements))
}

fn load(
    document: &Document,
    assets: &Assets,
    file: &Spanned<String>,
    collected: &mut Collected,
) -> Result<Model, Diagnostic> {
    let wrong = |reason: String| document.error(file, reason);
    let bytes = assets.read(file.get_ref()).map_err(|error| wrong(error.to_string()))?;
    let companions = assets.beside(file.get_ref()).map_err(|error| wrong(error.to_string()))?;
    let model = read::read(file.get_ref(), &bytes, &companions).map_err(|error| wrong(error.to_string()))?;
    collected.notes.extend(model.notes.iter().map(|note| format!("{}: {note}", file.get_ref())));
    Ok(model)
}
