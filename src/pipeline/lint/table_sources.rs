//! The sources of all tables of a document.

use std::borrow::Cow;

use crate::description::document::Document;
use crate::description::features::FeatureSource;

/// A table with a source.
pub struct TableSource<'a> {
    /// What its features are, for messages.
    pub noun: &'static str,
    /// Where they come from.
    pub source: Cow<'a, FeatureSource>,
    /// Whether the elevations of its file would be those of what stands on the ground, not of the ground.
    pub is_raised: bool,
}

/// The tables of a document that have a source, in the order of the page of keys.
pub fn table_sources(document: &Document) -> Vec<TableSource<'_>> {
    let laid = |noun, source| TableSource { noun, source: Cow::Borrowed(source), is_raised: false };
    let raised = |noun, source| TableSource { is_raised: true, ..laid(noun, source) };
    let of_file = |noun, source: Option<FeatureSource>| {
        source.map(|source| TableSource { noun, source: Cow::Owned(source), is_raised: false })
    };
    let instances = document.models.iter().filter_map(|table| table.instances.as_ref());
    let mut all: Vec<TableSource<'_>> = Vec::new();
    all.extend(document.roads.iter().map(|table| laid("roads", &table.source)));
    all.extend(document.bridges.iter().map(|table| raised("bridges", &table.source)));
    all.extend(document.rivers.iter().map(|table| laid("rivers", &table.source)));
    all.extend(document.lakes.iter().map(|table| laid("lakes", &table.source)));
    all.extend(document.areas.iter().map(|table| laid("areas", &table.source)));
    all.extend(document.earthworks.iter().map(|table| laid("earthworks", &table.source)));
    all.extend(document.buildings.iter().map(|table| raised("buildings", &table.source)));
    all.extend(document.fences.iter().map(|table| laid("lines", &table.source)));
    all.extend(instances.map(|source| laid("models", source)));
    all.extend(document.scatters.iter().map(|table| laid("areas of models", &table.source)));
    all.extend(document.graphics.iter().map(|table| laid("graphics", &table.source)));
    all.extend(document.labels.iter().filter_map(|table| of_file("labels", table.source())));
    all.extend(document.symbols.iter().filter_map(|table| of_file("symbols", table.source())));
    all
}
