//! Models: every file read once, every placement checked against the ground.
//!
//! ```text
//!  [[model]] at / instances ─► placements ─► footings: pads level the ground ─► told: gaps, volumes
//!  [[scatter]] ───────────────────────────────────────────────────────────────► placements by the thousand
//! ```
//!
//! A placement names a model, a place in plan and how it meets the ground; how high it stands is worked out when it is
//! drawn ([`crate::scene::placement`]).

pub mod footings;
pub mod library;
pub mod model_report;

use std::ops::Range;

use glam::DVec2;

use crate::description::diagnostic::Diagnostic;
use crate::description::document::Document;
use crate::description::features::{FeatureSource, ModelPlacement};
use crate::description::scalar::Scalar;
use crate::description::words::Footing;
use crate::model::Model;
use crate::scene::assets::Assets;
use crate::scene::attributes::Attributes;
use crate::scene::builder::SceneBuilder;
use crate::scene::models::library::Library;
use crate::scene::scatter;
use crate::scene::sources::{Sourced, Sources};
use crate::scene::world_frame::WorldFrame;
use crate::scene::{FeatureKind, GroundFit, Placement};
use crate::terrain::full_resolution::FullResolution;
use crate::terrain::lattice::Lattice;
use crate::terrain::triangle_surface::TriangleSurface;

/// The most models that stand in a scene, however they came there: some fifty megabytes of placements, and more than
/// a picture has room to show.
pub const MAX_MODELS: usize = 1_000_000;

/// What one `[[model]]` came to.
pub struct Group<'a> {
    /// The table.
    pub table: &'a ModelPlacement,
    /// Its placements among all.
    pub placements: Range<usize>,
    /// Points that lie off the ground.
    pub off: usize,
    /// Points that name none of the variants.
    pub unknown: usize,
}

/// Reads the document's models, places and strews them, and levels the pads that they ask for.
///
/// # Errors
/// A file or a source cannot be had or read, a model stands off the ground, or there are more than can be placed.
pub fn place(
    document: &Document,
    (places, sources, assets): (&WorldFrame<'_>, &Sources<'_>, &Assets),
    lattice: &mut Lattice,
    collected: &mut SceneBuilder,
) -> Result<(Vec<Model>, Vec<Placement>), Diagnostic> {
    let mut library = Library::new(document, assets);
    let tables = document.models.iter();
    let (groups, mut placements) = stand_tables(tables, (places, sources), &mut library, lattice, collected)?;
    let volumes = footings::lay(document, &groups, &placements, (&library, places), lattice)?;
    model_report::tell(&groups, &placements, (&library, &volumes, places), lattice, collected);
    scatter::strew(document, (places, sources), lattice, (&mut library, &mut placements), collected)?;
    Ok((library.into_models(), placements))
}

/// Levels the pads that models ask for; no other model is read.
///
/// # Errors
/// As for [`place`], for the models on pads.
pub fn level_pads(
    document: &Document,
    (places, sources, assets): (&WorldFrame<'_>, &Sources<'_>, &Assets),
    lattice: &mut Lattice,
) -> Result<(), Diagnostic> {
    let mut library = Library::new(document, assets);
    let tables = document.models.iter().filter(|table| *table.footing == Footing::Pad);
    let mut unused = SceneBuilder::default();
    let (groups, placements) = stand_tables(tables, (places, sources), &mut library, lattice, &mut unused)?;
    footings::lay(document, &groups, &placements, (&library, places), lattice).map(drop)
}

/// The placements of some tables, and which of them are whose.
fn stand_tables<'a>(
    tables: impl Iterator<Item = &'a ModelPlacement>,
    (places, sources): (&WorldFrame<'_>, &Sources<'_>),
    library: &mut Library<'_>,
    lattice: &Lattice,
    collected: &mut SceneBuilder,
) -> Result<(Vec<Group<'a>>, Vec<Placement>), Diagnostic> {
    let mut placements = Vec::new();
    let mut groups = Vec::new();
    for table in tables {
        let first = placements.len();
        let (mut off, mut unknown) = (0, 0);
        if let Some(at) = &table.at {
            let world = places.point(at, table.crs.as_ref())?;
            places.on_ground(lattice, at, world)?;
            let model = library.get(&table.file, table.file.span(), collected)?;
            let name = table.name.clone().unwrap_or_else(|| table.file.to_string());
            placements.push(placed(
                table,
                (library, model),
                (&Attributes::default(), world),
                name,
                collected,
            ));
        } else if let Some(source) = &table.instances {
            let points = sources.points(source)?;
            within(places.document, source, placements.len() + points.len())?;
            let mut choice = ModelChoice::new(table, library, collected)?;
            for Sourced { attributes, shape } in points {
                let ground = FullResolution { lattice };
                if ground.displayed_z(shape).is_none() {
                    off += 1;
                    continue;
                }
                let model = choice.of(&attributes);
                let name = attributes.name(table.name.as_deref());
                placements.push(placed(table, (library, model), (&attributes, shape), name, collected));
            }
            unknown = choice.unknown;
        }
        groups.push(Group { table, placements: first..placements.len(), off, unknown });
    }
    Ok((groups, placements))
}

/// Refuses more models than [`MAX_MODELS`].
///
/// # Errors
/// There are more, said at the place of `source`.
pub fn within(document: &Document, source: &FeatureSource, count: usize) -> Result<(), Diagnostic> {
    if count <= MAX_MODELS {
        return Ok(());
    }
    let message = format!("with these, more than {MAX_MODELS} models stand in the scene");
    Err(document
        .error_at(source.span(), message)
        .with_help("take fewer points or a lower density, or choose among them with `where`"))
}

fn placed(
    table: &ModelPlacement,
    (library, model): (&Library<'_>, usize),
    (attributes, at): (&Attributes, DVec2),
    name: String,
    collected: &mut SceneBuilder,
) -> Placement {
    let counts = &mut collected.default_counts;
    let height_m = attributes.number_or(table.height.as_ref(), 0.0, counts) as f32;
    let heading_deg = attributes.number(&table.heading, counts) as f32;
    let scale = attributes.number(&table.scale, counts) as f32;
    Placement {
        model,
        at: at.as_vec2(),
        clamp: library.clamp(model, table.clamp),
        height_m,
        heading_rad: heading_deg.to_radians(),
        scale,
        standing: standing(table),
        feature: collected.add(FeatureKind::Model, name),
    }
}

fn standing(table: &ModelPlacement) -> GroundFit {
    GroundFit {
        anchor: table.anchor,
        tilt_rad: (table.tilt as f32).to_radians(),
        sink_m: table.sink as f32,
        footing: *table.footing,
    }
}

/// Which model stands at which of a table's points.
struct ModelChoice<'a> {
    table: &'a ModelPlacement,
    file: usize,
    variants: Vec<(&'a str, usize)>,
    unknown: usize,
}

impl<'a> ModelChoice<'a> {
    fn new(
        table: &'a ModelPlacement,
        library: &mut Library<'_>,
        collected: &mut SceneBuilder,
    ) -> Result<Self, Diagnostic> {
        let file = library.get(&table.file, table.file.span(), collected)?;
        let mut variants = Vec::new();
        if let Some(given) = &table.variants {
            for (value, name) in given.iter() {
                variants.push((value.as_str(), library.get(name, given.span(), collected)?));
            }
        }
        Ok(Self { table, file, variants, unknown: 0 })
    }

    fn of(&mut self, attributes: &Attributes) -> usize {
        let Some(variant) = &self.table.variant else { return self.file };
        let value = variant.value(&|name| attributes.get(name)).map(|value| match value {
            Scalar::Text(text) => text,
            Scalar::Number(number) => number.to_string(),
            Scalar::Bool(value) => value.to_string(),
        });
        let found = self.variants.iter().find(|(variant, _)| value.as_deref() == Some(*variant));
        found.map_or_else(
            || {
                self.unknown += 1;
                self.file
            },
            |&(_, model)| model,
        )
    }
}
