//! The sources of all tables of a document.

use std::borrow::Cow;

use crate::document::Document;
use crate::feature_source::FeatureSource;

/// A table with a source.
pub struct TableSource<'a> {
    /// What its features are, for messages.
    pub noun: &'static str,
    /// Where they come from.
    pub source: Cow<'a, FeatureSource>,
    /// How they lie.
    pub role: SourceRole,
}

/// The way in which the features of a table lie on the ground.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SourceRole {
    /// Along or at a place of the ground: roads, rivers, fences, models.
    Along,
    /// Above it, so that elevations of theirs are not those of the ground: bridges, buildings.
    Above,
    /// Over a part of it, or all: areas, lakes, graphics. They reach beyond the elevation model without harm.
    Over,
}

/// The tables of a document that have a source, in the order of the page of keys.
pub fn table_sources(document: &Document) -> Vec<TableSource<'_>> {
    use SourceRole::{Above, Along, Over};
    let own = |noun, role, source| TableSource { noun, source: Cow::Borrowed(source), role };
    let of_file = |noun, source: Option<FeatureSource>| {
        source.map(|source| TableSource { noun, source: Cow::Owned(source), role: Along })
    };
    let instances = document.models.iter().filter_map(|table| table.instances.as_ref());
    let mut all: Vec<TableSource<'_>> = Vec::new();
    all.extend(document.roads.iter().map(|table| own("roads", Along, &table.source)));
    all.extend(document.bridges.iter().map(|table| own("bridges", Above, &table.source)));
    all.extend(document.rivers.iter().map(|table| own("rivers", Along, &table.source)));
    all.extend(document.coasts.iter().map(|table| own("coastlines", Over, &table.source)));
    all.extend(document.lakes.iter().map(|table| own("lakes", Over, &table.source)));
    all.extend(document.areas.iter().map(|table| own("areas", Over, &table.source)));
    all.extend(document.earthworks.iter().map(|table| own("earthworks", Over, &table.source)));
    all.extend(document.buildings.iter().map(|table| own("buildings", Above, &table.source)));
    all.extend(document.fences.iter().map(|table| own("lines", Along, &table.source)));
    all.extend(instances.map(|source| own("models", Along, source)));
    all.extend(document.scatters.iter().map(|table| own("areas of models", Over, &table.source)));
    all.extend(document.graphics.iter().map(|table| own("graphics", Over, &table.source)));
    all.extend(document.labels.iter().filter_map(|table| of_file("labels", table.source())));
    all.extend(document.overlays.iter().map(|table| TableSource {
        noun: "overlays",
        source: Cow::Owned(table.source()),
        role: Over,
    }));
    all.extend(document.symbols.iter().filter_map(|table| of_file("symbols", table.source())));
    all
}
