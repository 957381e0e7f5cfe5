//! Spans: the stretches of road that a bridge or a tunnel carries, from the roads and from the tables of bridges.

use std::collections::BTreeSet;
use std::ops::Range;

use glam::DVec2;

use crate::description::diagnostic::Diagnostic;
use crate::description::document::Document;
use crate::description::words;
use crate::geom::polyline::Polyline;
use crate::geom::rect::Rect;
use crate::ribbon::junction::{self, Street, StreetSupport};
use crate::ribbon::stroke::{StrokeOptions, Widths};
use crate::ribbon::texture::{RibbonSurface, texture_length_m};
use crate::scene::FeatureKind;
use crate::scene::builder::SceneBuilder;
use crate::scene::near;
use crate::scene::roads::centerline::{self, Centerline, Support};
use crate::scene::roads::network::rank_of;
use crate::scene::sources::Sources;

/// How far from the ground a bridge may run that still reaches it, in meters.
const REACH_M: f64 = 1000.0;

/// Who says that something is a bridge or a tunnel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SpanOrigin {
    /// The road's own properties, or the expressions over them.
    Tag,
    /// The cut or fill that the road would need.
    Rule,
    /// A table of its own.
    Table,
}

impl SpanOrigin {
    /// As the report says it.
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
    /// The centerline in world coordinates, within the elevation model.
    pub line: Polyline,
    /// What carries it; never the ground.
    pub carried: Support,
    /// Which of the roads it is; `None` where a table states it.
    pub road: Option<usize>,
    /// Its elevation in meters at each vertex, where that is settled.
    pub levels_m: Option<Vec<f64>>,
    /// The vertices beyond both ends, of the roads that go on there.
    pub beyond: [Option<DVec2>; 2],
    /// Its carriageway.
    pub options: StrokeOptions,
    /// What it is paved with.
    pub surface: RibbonSurface,
    /// What passes over what.
    pub level: i32,
    /// The widest span between piers that is stated, in meters, at least 1.
    pub pier_spacing_m: Option<f64>,
    /// The road's name, or the one given; may be empty.
    pub name: String,
    /// Who says that it is one.
    pub by: SpanOrigin,
    /// The place in the scene file, for messages.
    pub place: Range<usize>,
}

impl RoadSpan {
    /// Its first (0) or last (1) vertex.
    pub fn end(&self, end: usize) -> DVec2 {
        let points = self.line.points();
        points[if end == 0 { 0 } else { points.len() - 1 }]
    }
}

/// Where a vertex is, so that vertices that mean one point have one place: to the centimeter, which is what a change of
/// system may round.
pub type PointKey = (i64, i64);

/// The place of a point.
pub fn place(at: DVec2) -> PointKey {
    let at = (at / 0.01).round();
    (at.x as i64, at.y as i64)
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
    let spans = |(index, road)| of_road(document, (index, road), extent, collected);
    let mut all: Vec<RoadSpan> = roads.iter().enumerate().filter_map(spans).collect();
    all.extend(of_tables(document, sources, extent, collected)?);
    go_on(&mut all, roads);
    Ok(all)
}

fn of_road(
    document: &Document,
    (index, road): (usize, &Centerline),
    extent: &Rect,
    collected: &SceneBuilder,
) -> Option<RoadSpan> {
    if road.carried == Support::Ground {
        return None;
    }
    let (line, levels_m) = within(&road.line, road.levels_m.as_deref(), extent)?;
    let table = document.roads.get(road.table)?;
    let is_tagged = centerline::carried(table, &road.attributes) == road.carried;
    // Ids of features count from 2.
    let feature = collected.features.get((road.feature.0 as usize).checked_sub(2)?);
    Some(RoadSpan {
        line,
        carried: road.carried,
        road: Some(index),
        levels_m,
        beyond: [None; 2],
        options: road.options,
        surface: road.surface,
        level: road.level,
        pier_spacing_m: None,
        name: feature.map(|feature| feature.name.clone()).unwrap_or_default(),
        by: if is_tagged { SpanOrigin::Tag } else { SpanOrigin::Rule },
        place: table.source.span(),
    })
}

fn of_tables(
    document: &Document,
    sources: &Sources<'_>,
    extent: &Rect,
    collected: &mut SceneBuilder,
) -> Result<Vec<RoadSpan>, Diagnostic> {
    let mut all = Vec::new();
    for bridge in &document.bridges {
        let given = bridge.name.as_deref();
        let lines = sources.lines(&bridge.source)?;
        for (attributes, line) in
            near::lines(lines, (extent, REACH_M), (FeatureKind::Bridge, given), collected)
        {
            let Some((line, _)) = within(&line, None, extent) else { continue };
            let surface = surface(attributes.value_or_default(&bridge.surface));
            let width_m = attributes.number(&bridge.width, &mut collected.default_counts);
            let options = StrokeOptions {
                width_m,
                texture_length_m: texture_length_m(surface, width_m),
                ..StrokeOptions::default()
            };
            let deck_m = attributes.value(bridge.deck.as_ref());
            all.push(RoadSpan {
                levels_m: deck_m.map(|level| vec![level; line.points().len()]),
                line,
                carried: Support::Bridge,
                road: None,
                beyond: [None; 2],
                options,
                surface,
                level: 1,
                pier_spacing_m: bridge.pier_spacing.stated().copied(),
                name: attributes.name(given),
                by: SpanOrigin::Table,
                place: bridge.source.span(),
            });
        }
    }
    Ok(all)
}

fn surface(word: words::RoadSurface) -> RibbonSurface {
    match word {
        words::RoadSurface::Asphalt => RibbonSurface::Asphalt,
        words::RoadSurface::Gravel => RibbonSurface::Gravel,
        words::RoadSurface::Track => RibbonSurface::Track,
    }
}

/// The line from where it first enters the model to where it last leaves it, with its levels; `None` where it passes by.
fn within(line: &Polyline, levels_m: Option<&[f64]>, extent: &Rect) -> Option<(Polyline, Option<Vec<f64>>)> {
    let points = line.points();
    let inside = |index: &usize| extent.clip_line(points[*index], points[*index + 1]);
    let first = (0..points.len() - 1).find(|index| inside(index).is_some())?;
    let last = (first..points.len() - 1).rev().find(|index| inside(index).is_some())?;
    let (enters, leaves) = (inside(&first)?.0, inside(&last)?.1);
    let station = |segment: usize, at: DVec2| line.stations()[segment] + points[segment].distance(at);
    let between = first + 1..=last;
    let stations: Vec<f64> = std::iter::once(station(first, enters))
        .chain(between.clone().map(|index| line.stations()[index]))
        .chain([station(last, leaves)])
        .collect();
    let kept = std::iter::once(enters).chain(between.map(|index| points[index])).chain([leaves]);
    let mut distinct: Vec<(DVec2, f64)> = kept.zip(stations).collect();
    distinct.dedup_by(|next, kept| next.1 - kept.1 < 1e-6);
    let level = |levels: &[f64], station: f64| {
        let after = line.stations().partition_point(|&reached| reached < station).clamp(1, points.len() - 1);
        let (from, to) = (line.stations()[after - 1], line.stations()[after]);
        levels[after - 1]
            + (levels[after] - levels[after - 1]) * ((station - from) / (to - from)).clamp(0.0, 1.0)
    };
    let levels_m = levels_m
        .filter(|levels| levels.len() == points.len())
        .map(|levels| distinct.iter().map(|&(_, station)| level(levels, station)).collect());
    Some((Polyline::new(distinct.into_iter().map(|(at, _)| at), 0.0)?, levels_m))
}

/// Finds what goes on at the spans' ends, so that their edges are those of the ribbons there.
fn go_on(spans: &mut [RoadSpan], roads: &[Centerline]) {
    let ends: BTreeSet<PointKey> =
        spans.iter().flat_map(|span| [place(span.end(0)), place(span.end(1))]).collect();
    let meets = |road: &&Centerline| {
        road.carried == Support::Ground && road.line.points().iter().any(|&at| ends.contains(&place(at)))
    };
    let of_spans = spans.iter().map(|span| Street {
        line: &span.line,
        widths: Widths::Constant(span.options.width_m),
        options: span.options,
        bed: StreetSupport::Structure,
        level: span.level,
        rank: rank_of(span.surface),
    });
    let of_roads = roads.iter().filter(meets).map(|road| Street {
        line: &road.line,
        widths: road.widths(),
        options: road.options,
        bed: StreetSupport::Ground,
        level: road.level,
        rank: rank_of(road.surface),
    });
    let streets: Vec<Street<'_>> = of_spans.chain(of_roads).collect();
    let network = junction::connect(&streets);
    for (span, beyond) in spans.iter_mut().zip(network.continuations) {
        span.beyond = [beyond.before, beyond.after];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_kept_within_the_model_with_its_levels() {
        let points = [(-10.0, 5.0), (10.0, 5.0), (30.0, 5.0), (90.0, 5.0)].map(|(x, y)| DVec2::new(x, y));
        let line = Polyline::new(points, 0.0).expect("a line");
        let extent = Rect { min: DVec2::ZERO, max: DVec2::splat(50.0) };
        let (kept, levels) = within(&line, Some(&[0.0, 20.0, 40.0, 100.0]), &extent).expect("inside");
        let xs: Vec<f64> = kept.points().iter().map(|at| at.x).collect();
        assert_eq!(xs, [0.0, 10.0, 30.0, 50.0]);
        assert_eq!(levels, Some(vec![10.0, 20.0, 40.0, 60.0]));
        assert!(within(&line, None, &Rect { min: DVec2::splat(100.0), max: DVec2::splat(200.0) }).is_none());
    }
}
