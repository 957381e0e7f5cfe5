//! Spans: what a bridge or a tunnel carries, from the roads and from the tables of bridges.

use std::collections::BTreeSet;

use rayon::prelude::*;

use crate::builder::SceneBuilder;
use crate::feature::FeatureKind;
use crate::feature_origin::FeatureOrigin;
use crate::near;
use crate::roads::centerline::{self, Centerline};
use crate::scene_findings::FeatureTable;
use crate::sources::Sources;
use sandtable_description::diagnostic::Diagnostic;
use sandtable_description::document::Document;
use sandtable_description::words::Markings;
use sandtable_earthworks::alignment::{Alignment, Support, Width};
use sandtable_geom::offset::Continuations;
use sandtable_geom::polyline::{VertexKey, vertex_key};
use sandtable_geom::profile::Profile;
use sandtable_geom::rect::Rect;
use sandtable_ribbon::junction::{self, Street};
use sandtable_ribbon::stroke::StrokeOptions;

/// How far from the ground a bridge may run that still reaches it, in meters.
const REACH_M: f64 = 1000.0;

/// Why something is a bridge or a tunnel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SpanOrigin {
    /// The road's own properties, or the expressions over them.
    Tag,
    /// The cut or fill that the road would need.
    Rule,
    /// A table of bridges.
    Table,
}

impl SpanOrigin {
    /// The word for it in the report.
    pub fn word(self) -> &'static str {
        match self {
            Self::Tag => "tag",
            Self::Rule => "rule",
            Self::Table => "table",
        }
    }
}

/// A bridge or a tunnel, from one end of its line to the other.
#[derive(Clone, Debug)]
pub struct RoadSpan {
    /// Its carriageway within the elevation model: with levels where they are stated or designed, of its mean width, and
    /// never on the ground.
    pub street: Street,
    /// The index of its road; `None` where a table states it.
    pub road: Option<usize>,
    /// What continues it at its ends.
    pub beyond: Continuations,
    /// The widest distance between piers that is stated, in meters, at least 1.
    pub pier_spacing_m: Option<f64>,
    /// The steepest rise that its road states, meters per meter.
    pub max_grade: Option<f64>,
    /// The road's name, or the one stated; may be empty.
    pub name: String,
    /// Why it is one.
    pub origin: SpanOrigin,
    /// Where it is stated, for messages.
    pub place: FeatureOrigin,
}

/// The spans of the document: roads that something other than the ground carries, and its tables of bridges.
///
/// # Errors
/// A source cannot be had.
pub fn collect(
    document: &Document,
    sources: &Sources<'_>,
    roads: &[Centerline],
    extent: &Rect,
    collected: &mut SceneBuilder,
) -> Result<Vec<RoadSpan>, Diagnostic> {
    let so_far = &*collected;
    let span =
        |(index, road)| Some(RoadSpan { road: Some(index), ..road_span(document, road, extent, so_far)? });
    let mut all: Vec<RoadSpan> = roads.par_iter().enumerate().filter_map(span).collect();
    all.extend(table_spans(document, sources, extent, collected)?);
    find_continuations(&mut all, roads);
    Ok(all)
}

/// The span of a road that the ground does not carry.
fn road_span(
    document: &Document,
    road: &Centerline,
    extent: &Rect,
    collected: &SceneBuilder,
) -> Option<RoadSpan> {
    let support = road.street.alignment.support;
    if support == Support::Ground {
        return None;
    }
    let width = Width::Constant(road.street.width_m);
    let alignment = Alignment { width, ..road.street.alignment.within(extent)? };
    let table = document.roads.get(road.table)?;
    let is_tagged = centerline::support(table, &road.attributes) == support;
    Some(RoadSpan {
        street: Street { alignment, ..road.street.clone() },
        road: None,
        beyond: Continuations::default(),
        pier_spacing_m: None,
        max_grade: road.attributes.value(table.max_grade.stated()).map(|percent| percent / 100.0),
        name: collected.name(road.feature).to_owned(),
        origin: if is_tagged { SpanOrigin::Tag } else { SpanOrigin::Rule },
        place: road.attributes.origin(&table.source),
    })
}

fn table_spans(
    document: &Document,
    sources: &Sources<'_>,
    extent: &Rect,
    collected: &mut SceneBuilder,
) -> Result<Vec<RoadSpan>, Diagnostic> {
    let mut all = Vec::new();
    for bridge in &document.bridges {
        let name = bridge.name.as_deref();
        let named = FeatureTable { kind: FeatureKind::Bridge, name, source: &bridge.source };
        let lines = sources.lines(&bridge.source)?;
        for (attributes, line) in near::lines(lines, extent, REACH_M, &named, &mut collected.findings) {
            if line.range_within(extent).is_none() {
                continue;
            }
            let word = attributes.value_or_default(&bridge.surface);
            let surface = centerline::surface(word, Markings::Dashed);
            let width_m = attributes.number(&bridge.width, &mut collected.default_counts);
            let deck_m = attributes.value(bridge.deck.as_ref());
            let level = deck_m.map(|level| Profile::straight(line.length(), [level; 2]));
            let alignment =
                Alignment { level, support: Support::Bridge, ..Alignment::on_ground(line, width_m) };
            let Some(alignment) = alignment.within(extent) else { continue };
            let options = StrokeOptions::of(surface, width_m);
            all.push(RoadSpan {
                street: Street { alignment, width_m, options, level: 1, surface },
                road: None,
                beyond: Continuations::default(),
                pier_spacing_m: bridge.pier_spacing.stated().copied(),
                max_grade: None,
                name: attributes.name(name),
                origin: SpanOrigin::Table,
                place: attributes.origin(&bridge.source),
            });
        }
    }
    Ok(all)
}

/// Finds what continues at the spans' ends, so that their edges are those of the ribbons there.
fn find_continuations(spans: &mut [RoadSpan], roads: &[Centerline]) {
    let ends: BTreeSet<VertexKey> =
        spans.iter().flat_map(|span| span.street.alignment.line.ends()).map(vertex_key).collect();
    let meets = |road: &&Street| {
        let alignment = &road.alignment;
        alignment.is_on_ground() && alignment.line.points().iter().any(|&at| ends.contains(&vertex_key(at)))
    };
    let on_ground: Vec<&Street> = roads.par_iter().map(|road| &road.street).filter(meets).collect();
    let streets: Vec<&Street> = spans.iter().map(|span| &span.street).chain(on_ground).collect();
    let network = junction::connect(&streets);
    for (span, beyond) in spans.iter_mut().zip(network.continuations) {
        span.beyond = beyond;
    }
}
