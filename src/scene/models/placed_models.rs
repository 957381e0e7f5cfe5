//! The placements of `[[model]]` tables: a model, a position in plan and how it meets the ground.

use std::ops::Range;

use glam::DVec2;

use crate::attributes::{Attributes, DefaultCounts};
use crate::builder::SceneBuilder;
use crate::feature::FeatureKind;
use crate::feature_origin::FeatureOrigin;
use crate::models::library::Library;
use crate::placed_model::{GroundFit, Placement};
use crate::scene_findings::SceneFindings;
use crate::sources::{Sourced, Sources};
use crate::world_frame::WorldFrame;
use sandtable_base::limits::SCENE_MODELS;
use sandtable_base::message::suggest::listed;
use sandtable_description::diagnostic::Diagnostic;
use sandtable_description::document::Document;
use sandtable_description::feature_source::FeatureSource;
use sandtable_description::features::ModelPlacement;
use sandtable_description::finding_code::FindingCode;
use sandtable_description::scalar::Scalar;
use sandtable_description::words::Clamp;
use sandtable_draw::list::FeatureId;
use sandtable_terrain::full_resolution::FullResolution;
use sandtable_terrain::lattice::Lattice;
use sandtable_terrain::triangle_surface::TriangleSurface;

/// The placements of one `[[model]]`.
pub struct InstanceGroup<'a> {
    /// The table.
    pub table: &'a ModelPlacement,
    /// Its placements among all.
    pub placements: Range<usize>,
    /// Points that lie off the ground.
    pub off: usize,
    /// Points that name none of the variants.
    pub unknown: usize,
}

/// The models of some tables, each in its place.
pub struct PlacedModels<'a> {
    /// The models.
    pub library: Library<'a>,
    /// The tables.
    pub groups: Vec<InstanceGroup<'a>>,
    /// The placements of all groups, then those of scatters.
    pub placements: Vec<Placement>,
}

impl<'a> PlacedModels<'a> {
    /// The models of some tables, each in its place. `collected` keeps an error where a file or a source cannot be read, a model
    /// stands off the ground, or there are more than can be placed.
    pub(super) fn new(
        tables: impl Iterator<Item = &'a ModelPlacement>,
        sources: &Sources<'a>,
        lattice: &Lattice,
        collected: &mut SceneBuilder,
    ) -> Self {
        let library = Library::new(sources.frame.document, sources.assets);
        let mut placed = Self { library, groups: Vec::new(), placements: Vec::new() };
        for table in tables {
            let added = placed.add_table(table, sources, lattice, collected);
            collected.errors.keep(added);
        }
        placed
    }

    fn add_table(
        &mut self,
        table: &'a ModelPlacement,
        sources: &Sources<'_>,
        lattice: &Lattice,
        collected: &mut SceneBuilder,
    ) -> Result<(), Diagnostic> {
        let (first, frame) = (self.placements.len(), sources.frame);
        let (mut off, mut unknown) = (0, 0);
        if let Some(at) = &table.at {
            let world = frame.point(at, table.crs.as_ref())?;
            frame.on_ground(lattice, at, world)?;
            let model = self.library.get(&table.file, table.file.span(), collected)?;
            let name = table.name.clone().unwrap_or_else(|| table.file.to_string());
            let feature = collected.add(FeatureKind::Model, name, FeatureOrigin::stated(at.span()));
            let point = Sourced { attributes: Attributes::default(), shape: world, crossings: 0 };
            self.add(table, model, &point, feature, frame, &mut collected.default_counts);
        } else if let Some(source) = &table.instances {
            let points = sources.points(source)?;
            within(frame.document, source, first + points.len())?;
            let mut choice = ModelChoice::new(table, &mut self.library, collected)?;
            for point in points {
                if (FullResolution { lattice }).displayed_z(point.shape).is_none() {
                    off += 1;
                    continue;
                }
                let model = choice.of(&point.attributes);
                let name = point.attributes.name(table.name.as_deref());
                let feature = collected.add(FeatureKind::Model, name, point.attributes.origin(source));
                self.add(table, model, &point, feature, frame, &mut collected.default_counts);
            }
            choice.find_unused(&mut collected.findings);
            unknown = choice.unknown;
        }
        self.groups.push(InstanceGroup { table, placements: first..self.placements.len(), off, unknown });
        Ok(())
    }

    fn add(
        &mut self,
        table: &ModelPlacement,
        model: usize,
        point: &Sourced<DVec2>,
        feature: FeatureId,
        frame: &WorldFrame<'_>,
        counts: &mut DefaultCounts,
    ) {
        let attributes = &point.attributes;
        let height_m = f64::from(attributes.number_or(table.height.as_ref(), 0.0, counts) as f32);
        let heading_deg = attributes.number(&table.heading, counts) as f32;
        let scale = attributes.number(&table.scale, counts) as f32;
        let clamp = self.library.clamp(model, table.clamp);
        self.placements.push(Placement {
            model,
            at: point.shape.as_vec2(),
            clamp,
            height: match clamp {
                Clamp::Absolute => frame.scale.world_z(height_m),
                Clamp::Ground | Clamp::Relative => height_m,
            },
            heading_rad: heading_deg.to_radians(),
            scale,
            standing: GroundFit {
                anchor: table.anchor,
                tilt_rad: (table.tilt as f32).to_radians(),
                sink_m: table.sink as f32,
                footing: *table.footing,
            },
            feature,
        });
    }
}

/// Checks that a scene has no more models than [`SCENE_MODELS`].
///
/// # Errors
/// There are more; the error points at `source`.
pub fn within(document: &Document, source: &FeatureSource, count: usize) -> Result<(), Diagnostic> {
    if count <= SCENE_MODELS.count() {
        return Ok(());
    }
    let message = format!("with these, more than {SCENE_MODELS} models stand in the scene");
    Err(document.error_at(source.span(), message).with_help(format!(
        "take fewer points or a lower density, choose among them with `where`, or {SCENE_MODELS:#}"
    )))
}

struct ModelChoice<'a> {
    table: &'a ModelPlacement,
    file: usize,
    variants: Vec<ModelVariant<'a>>,
    unknown: usize,
}

/// A model that a point may name.
struct ModelVariant<'a> {
    value: &'a str,
    model: usize,
    is_used: bool,
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
                let model = library.get(name, given.span(), collected)?;
                variants.push(ModelVariant { value, model, is_used: false });
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
        match self.variants.iter_mut().find(|variant| value.as_deref() == Some(variant.value)) {
            Some(variant) => {
                variant.is_used = true;
                variant.model
            }
            None => {
                self.unknown += 1;
                self.file
            }
        }
    }

    /// Finds the variants that no point names.
    fn find_unused(&self, findings: &mut SceneFindings) {
        let unused = self.variants.iter().filter(|variant| !variant.is_used);
        let unused: Vec<&str> = unused.map(|variant| variant.value).collect();
        if let (Some(given), [_, ..]) = (&self.table.variants, &unused[..]) {
            let message = format!("no point names the variant {}", listed(&unused));
            findings.add(FindingCode::UnusedVariant, given.span().unwrap_or_default(), message);
        }
    }
}
