//! Rivers: the ground cut to falling water, and the ribbons of water and banks on it.
//!
//! ```text
//!   ┄┄┄┄┄┄┄┄┄┄┄┄┄┄┄┄┄  bank: a wider ribbon below, of which the water leaves a strip on either side
//!   ─────────────╲ ╲
//!        water    ◯ ╲   confluence: a disc as wide as the widest river there, so that ends leave no gap
//!   ─────────────╱ ╲ ╲
//! ```

use std::collections::BTreeMap;

use glam::DVec2;
use rayon::prelude::*;

use crate::builder::SceneBuilder;
use crate::near::Clipped;
use crate::report::RiverRow;
use crate::sources::Sources;
use crate::symbols::LineSymbol;
use crate::water::culvert::Culvert;
use crate::water::network::{self, Stream};
use crate::water::reaches::reaches;
use sandtable_base::message::numbers::{counted, fixed};
use sandtable_description::diagnostic::Diagnostic;
use sandtable_description::document::Document;
use sandtable_description::finding_code::FindingCode;
use sandtable_description::words::Water;
use sandtable_earthworks::channel;
use sandtable_earthworks::channel::river_cut::{Channel, Climb, Cut, Cuts};
use sandtable_geom::offset::Continuations;
use sandtable_geom::polygon;
use sandtable_geom::polyline::{VertexKey, vertex_key};
use sandtable_geom::rect::Rect;
use sandtable_mesh::sink::MeshSink;
use sandtable_ribbon::junction::{self, Street};
use sandtable_ribbon::plan::{PlanMesh, PlanVertex};
use sandtable_ribbon::stroke::{StrokeOptions, StrokePath, stroke};
use sandtable_ribbon::texture::RibbonSurface;
use sandtable_terrain::lattice::Lattice;

/// The corners of a confluence's disc: its rim lies within a thirteenth of its radius of the circle.
const DISC_CORNERS: u32 = 8;

/// Adds the document's rivers and cuts the ground to those that fall.
///
/// # Errors
/// A source cannot be had, or the beds would cover too much ground.
pub fn lay(
    document: &Document,
    sources: &Sources<'_>,
    lattice: &mut Lattice,
    collected: &mut SceneBuilder,
) -> Result<(), Diagnostic> {
    let streams = network::collect(document, sources, lattice, collected)?;
    let falling: Vec<&Stream> = streams.iter().filter(|stream| stream.water == Water::Falls).collect();
    let channel = |stream: &&Stream| Channel {
        alignment: stream.street.alignment.clone(),
        bank_m: stream.bank_m,
        max_cut_m: stream.max_cut_m,
    };
    let channels: Vec<Channel> = falling.iter().map(channel).collect();
    let cuts = channel::cut(lattice, &channels).map_err(|error| {
        let place = document.rivers.first().map_or(0..0, |river| river.source.span());
        let help = "make them narrower, or say `water = \"drape\"`";
        document.error_at(place, error).with_help(help)
    })?;
    report_cuts(&falling, &cuts, collected);
    report_climbs(&falling, &cuts, lattice.origin(), collected);
    ribbons(&streams, lattice, collected);
    let symbol =
        |stream: &Stream| LineSymbol::of_river(&stream.street, stream.bank_m, &stream.order, stream.feature);
    collected.symbols.extend(streams.iter().map(symbol));
    let culverts = streams.iter().filter(|stream| stream.is_culvert);
    collected.culverts.extend(culverts.map(|stream| Culvert {
        line: stream.street.alignment.line.clone(),
        width_m: stream.street.width_m,
        feature: stream.feature,
    }));
    Ok(())
}

/// Reports the cuts: a row for each river, and a note on them all.
fn report_cuts(streams: &[&Stream], cuts: &Cuts, collected: &mut SceneBuilder) {
    for (stream, cut) in streams.iter().zip(&cuts.cuts) {
        collected.report.rivers.push(row(stream, cut));
    }
    let deepest = streams.iter().zip(&cuts.cuts).max_by(|(_, a), (_, b)| a.deepest_m.total_cmp(&b.deepest_m));
    let Some((stream, cut)) = deepest.filter(|(_, cut)| cut.deepest_m > 0.0) else { return };
    let sum = |of: fn(&Cut) -> f64| cuts.cuts.iter().map(of).sum::<f64>();
    let place = if stream.name.is_empty() { String::new() } else { format!(", in '{}'", stream.name) };
    let message = format!(
        "the {} of {}: {} m³ cut, {} m³ filled, {:.1} m deep at most{place}",
        if streams.len() == 1 { "bed" } else { "beds" },
        counted(streams.len(), "river", "rivers"),
        fixed(sum(|cut| cut.volumes.cut_m3), 0),
        fixed(sum(|cut| cut.volumes.fill_m3), 0),
        cut.deepest_m
    );
    collected.findings.add(FindingCode::EarthMoved, 0..0, message);
}

/// Reports where the ground rises downstream: for each table how often, with the reach of the greatest climb. `origin` is
/// the map position of world (0, 0).
fn report_climbs(streams: &[&Stream], cuts: &Cuts, origin: DVec2, collected: &mut SceneBuilder) {
    let mut tables: BTreeMap<(usize, usize), Vec<(&Stream, &Cut)>> = BTreeMap::new();
    let climbing = streams.iter().zip(&cuts.cuts).filter(|(_, cut)| !cut.climbs.is_empty());
    for (stream, cut) in climbing {
        let span =
            collected.feature(stream.feature).map(|river| river.origin.span.clone()).unwrap_or_default();
        tables.entry((span.start, span.end)).or_default().push((stream, cut));
    }
    for ((start, end), rivers) in tables {
        let count: usize = rivers.iter().map(|(_, cut)| cut.climbs.len()).sum();
        let all = rivers.iter().filter_map(|(stream, cut)| Some((stream, greatest(cut)?)));
        let Some((stream, climb)) = all.max_by(|a, b| a.1.rise_m.total_cmp(&b.1.rise_m)) else { continue };
        let name = if stream.name.is_empty() { String::new() } else { format!("in '{}', ", stream.name) };
        let [from, to] =
            [climb.from_m, climb.to_m].map(|station_m| stream.street.alignment.line.at(station_m) + origin);
        let message = format!(
            "the ground rises downstream at {} of {}, by {:.1} m at most ({name}{:.0} to {:.0} m from \
             its source, ({}, {}) to ({}, {})): no cut as deep as `max_cut` lets water fall there, so the \
             ground stays as it is; the lines do not follow the model's valleys, or its cells are too wide for these",
            counted(count, "place", "places"),
            counted(rivers.len(), "river", "rivers"),
            climb.rise_m,
            climb.from_m,
            climb.to_m,
            fixed(from.x, 0),
            fixed(from.y, 0),
            fixed(to.x, 0),
            fixed(to.y, 0)
        );
        collected.findings.add(FindingCode::RiverUphill, start..end, message);
    }
}

fn greatest(cut: &Cut) -> Option<&Climb> {
    cut.climbs.iter().max_by(|a, b| a.rise_m.total_cmp(&b.rise_m))
}

fn row(stream: &Stream, cut: &Cut) -> RiverRow {
    RiverRow {
        name: stream.name.clone(),
        length: stream.street.alignment.line.length(),
        from: cut.levels_m.map(|levels| levels.0),
        to: cut.levels_m.map(|levels| levels.1),
        deepest_cut: cut.deepest_m,
        cut: cut.volumes.cut_m3,
        fill: cut.volumes.fill_m3,
        climbs: cut.climbs.len(),
        greatest_climb: greatest(cut).map(|climb| climb.rise_m),
    }
}

/// Lays water with its white reaches and bars, banks and confluences; narrower water over wider, so that a mouth shows in the
/// river that it flows into.
fn ribbons(streams: &[Stream], lattice: &Lattice, collected: &mut SceneBuilder) {
    let extent = &lattice.extent();
    let streets: Vec<&Street> = streams.iter().map(|stream| &stream.street).collect();
    let network = junction::connect(&streets);
    let widest_m = |index: usize| streams[index].street.width_m;
    let mut order: Vec<usize> = (0..streams.len()).collect();
    order.sort_by(|&a, &b| widest_m(b).total_cmp(&widest_m(a)));
    let of_stream = |&index: &usize| {
        let stream = &streams[index];
        let beyond = ends_of_one_width(stream, network.continuations[index]);
        let mut plans = Vec::new();
        let mut lay = |street: &Street| {
            let mut ribbon = Clipped { plan: PlanMesh::default(), extent };
            let path = StrokePath { beyond, ..StrokePath::alone(&street.alignment) };
            stroke(&path, &street.options, &mut ribbon);
            plans.push((ribbon.plan, street.surface, stream.feature));
        };
        lay(&stream.street);
        if stream.water == Water::Falls && !stream.is_culvert {
            for (alignment, surface) in reaches(&stream.street.alignment, lattice) {
                let width_m = alignment.width.widest_m();
                lay(&Street {
                    alignment,
                    width_m,
                    options: StrokeOptions::of(surface, width_m),
                    surface,
                    ..stream.street
                });
            }
        }
        if stream.bank_m > 0.0 {
            lay(&stream.street.with_more(2.0 * stream.bank_m, RibbonSurface::Bank));
        }
        plans
    };
    let plans: Vec<Vec<_>> = order.par_iter().map(of_stream).collect();
    plans.into_iter().flatten().for_each(|(plan, surface, feature)| collected.lay(plan, surface, feature));
    confluences(streams, &network.continuations, extent, collected);
}

/// What continues a river at its ends: nothing where it tapers, since the other end would be of another width.
fn ends_of_one_width(stream: &Stream, beyond: Continuations) -> Continuations {
    if stream.street.alignment.width.is_constant() { beyond } else { Continuations::default() }
}

/// A river at a vertex: the water's width there, which river it is, and where.
type Meeting = (f64, usize, DVec2);

/// Lays a disc where a river ends on another's vertex and neither simply goes on in the other.
fn confluences(
    streams: &[Stream],
    continuations: &[Continuations],
    extent: &Rect,
    collected: &mut SceneBuilder,
) {
    let mut ends: BTreeMap<VertexKey, bool> = BTreeMap::new();
    for (stream, beyond) in streams.iter().zip(continuations) {
        let beyond = ends_of_one_width(stream, *beyond);
        for (at, beyond) in stream.street.alignment.line.ends().into_iter().zip([beyond.before, beyond.after])
        {
            *ends.entry(vertex_key(at)).or_default() |= beyond.is_none();
        }
    }
    let mut widest: BTreeMap<VertexKey, Vec<Meeting>> = BTreeMap::new();
    for (index, stream) in streams.iter().enumerate() {
        let line = &stream.street.alignment.line;
        for (&at, &station_m) in line.points().iter().zip(line.stations()) {
            let width_m = stream.street.alignment.width.at(station_m);
            if ends.get(&vertex_key(at)).is_some_and(|is_open| *is_open) {
                widest.entry(vertex_key(at)).or_default().push((width_m, index, at));
            }
        }
    }
    for meeting in widest.into_values().filter(|meeting| meeting.len() > 1) {
        let widest = meeting.iter().max_by(|a, b| a.0.total_cmp(&b.0).then(b.1.cmp(&a.1)));
        if let Some(&(width_m, index, at)) = widest {
            let mut plan = Clipped { plan: PlanMesh::default(), extent };
            disc(at, width_m / 2.0, &mut plan);
            collected.lay(plan.plan, RibbonSurface::Confluence, streams[index].feature);
        }
    }
}

fn disc(center: DVec2, radius_m: f64, sink: &mut impl MeshSink<PlanVertex>) {
    let mut vertex = |at: DVec2| sink.vertex(PlanVertex { at, uv: (at / (4.0 * radius_m)).as_vec2() });
    let middle = vertex(center);
    let corner = |index: u32| {
        let angle = f64::from(index) * std::f64::consts::TAU / f64::from(DISC_CORNERS);
        vertex(center + DVec2::new(libm::cos(angle), libm::sin(angle)) * radius_m)
    };
    let rim: Vec<_> = (0..DISC_CORNERS).map(corner).collect();
    polygon::edges(&rim).for_each(|(from, to)| sink.triangle([middle, from, to]));
}
