//! Bridges and tunnels: from spans to solids, decks to stand on, and rows of the report.
//!
//! ```text
//!  spans::collect ─► SpanChain::all ─► levels::settle ─┬─► a bridge for each span: structure::bridge
//!                                                    ├─► portals where a tunnel's chain enters a hill
//!                                                    └─► an underpass: the road stays on the ground
//! ```
//!
//! **Tunnels.** Only the portals of a tunnel are drawn, where the hill rises over them. A short tunnel under ground that is
//! hardly higher than its ends is an underpass: what it passes under, a railway or a house, is not in the elevation model.
//! The road stays on the ground there, as a map would show it.

use std::collections::BTreeSet;

use rayon::prelude::*;

use crate::builder::SceneBuilder;
use crate::feature::{FeatureKind, described};
use crate::feature_meshes::{Coat, Solid};
use crate::report::SpanRow;
use crate::roads::centerline::Centerline;
use crate::roads::chains::{ChainEnd, SpanChain};
use crate::roads::levels::{self, ChainRun, Site};
use crate::roads::profiles::BridgeProfile;
use crate::roads::spans::{self, RoadSpan};
use crate::sources::Sources;
use crate::symbols::DeckLine;
use sandtable_base::limits::BRIDGE_PIERS;
use sandtable_description::diagnostic::Diagnostic;
use sandtable_description::document::Document;
use sandtable_description::finding_code::FindingCode;
use sandtable_earthworks::alignment::chain::{ChainLink, Direction};
use sandtable_earthworks::alignment::{Alignment, Support};
use sandtable_geom::polyline::{VertexKey, vertex_key};
use sandtable_geom::profile::Profile;
use sandtable_geom::rect::Rect;
use sandtable_ribbon::texture::RibbonSurface;
use sandtable_structure::bridge::{self, Across, BridgeOptions, BridgeSolids, magnified};
use sandtable_structure::deck::DeckSection;
use sandtable_structure::deck_profile::ClearancePoint;
use sandtable_structure::tunnel::Portal;
use sandtable_terrain::lattice::Lattice;
use sandtable_terrain::query::deck::{Deck, DeckError};
use sandtable_terrain::triangle_surface::SurfaceTriangle;

/// The longest underpass, in meters: under a broad road or a railway yard.
const LONGEST_UNDERPASS_M: f64 = 60.0;

/// The ground that a tunnel has over it somewhere, at least, in meters; less is an underpass, or too little to show.
const LEAST_COVER_M: f64 = 3.0;

/// How far up a portal's wall the hill has to rise behind it.
const BURIED: f64 = 0.4;

/// How high the soffit is over the ground where an abutment ends, in meters: high enough to see through below.
const ABUTMENT_M: f64 = 1.5;

/// How far from the middle of its mouth a road may run, in meters.
const OFF_CENTER_M: f64 = 0.5;

/// Stations of a profile nearer to each other than this are one, in meters.
const MERGE_M: f64 = 1e-6;

/// The longest part of a bridge that an abutment takes.
const LONGEST_ABUTMENT: f64 = 0.25;

/// Builds the bridges and tunnels of the document's roads and tables. Roads through underpasses become roads on the ground.
///
/// # Errors
/// A source cannot be read, or needs too many piers.
pub fn build(
    document: &Document,
    sources: &Sources<'_>,
    lattice: &Lattice,
    roads: &mut [Centerline],
    collected: &mut SceneBuilder,
) -> Result<(), Diagnostic> {
    let extent = lattice.extent();
    let spans = spans::collect(document, sources, roads, &extent, collected)?;
    if spans.is_empty() {
        return Ok(());
    }
    check_piers(document, &spans)?;
    let water = water(collected).map_err(|error| document.error_at(0..0, WaterError(error)))?;
    let site = Site { lattice, water: &water, scale: sources.frame.scale };
    let chains = SpanChain::all(&spans, roads);
    let runs = levels::settle(&spans, &chains, roads, &site);
    let mouths: BTreeSet<VertexKey> = spans
        .iter()
        .filter(|span| span.street.alignment.support == Support::Tunnel)
        .flat_map(|span| span.street.alignment.line.ends().map(vertex_key))
        .collect();
    let support = |chain: &SpanChain| spans[chain.links[0].line].street.alignment.support;
    let planned: Vec<Vec<PlannedBridge<'_>>> = chains
        .par_iter()
        .zip(&runs)
        .map(|(chain, run)| match run {
            Some(run) if support(chain) == Support::Bridge => {
                let (spans, site, mouths) = (&spans, &site, &mouths);
                BuiltChain { spans, chain, run, site, mouths }.planned(&extent).collect()
            }
            _ => Vec::new(),
        })
        .collect();
    for (chain, run) in chains.iter().zip(&runs) {
        let Some(run) = run else {
            let span = &spans[chain.links[0].line];
            let kind = if span.street.alignment.support == Support::Tunnel { "tunnel" } else { "bridge" };
            let what = described(kind, &span.name);
            let message = format!("{what} left out: no ground lies along it");
            collected.findings.add(FindingCode::LeftOut, span.place.span.clone(), message);
            continue;
        };
        if support(chain) == Support::Tunnel {
            let built = BuiltChain { spans: &spans, chain, run, site: &site, mouths: &mouths };
            built.tunnel(&extent, roads, collected);
        }
    }
    let bridges: Vec<PlannedBridge<'_>> = planned.into_iter().flatten().collect();
    collected.decks = bridges.iter().flat_map(|planned| bridge::deck(&planned.sections)).collect();
    let decks = Deck::new(&collected.decks).map_err(|error| document.error_at(0..0, error))?;
    let built: Vec<BuiltBridge<'_>> = bridges.into_par_iter().map(|planned| planned.build(&decks)).collect();
    for built in built {
        if let Some(road) = spans[built.planned.link.line].road {
            roads[road].deck = Some(built.planned.deck_line());
        }
        built.add(collected);
    }
    Ok(())
}

fn check_piers(document: &Document, spans: &[RoadSpan]) -> Result<(), Diagnostic> {
    let wanted = |span: &&RoadSpan| {
        span.street.alignment.line.length() / span.pier_spacing_m.unwrap_or(levels::PIER_SPACING_M)
    };
    let bridges = spans.iter().filter(|span| span.street.alignment.support == Support::Bridge);
    let count: f64 = bridges.clone().map(|span| wanted(&span)).sum();
    let most = bridges.max_by(|a, b| wanted(a).total_cmp(&wanted(b)));
    match most {
        Some(span) if count > BRIDGE_PIERS.get() as f64 => {
            let message =
                format!("the scene's bridges ask for {count:.0} piers, at most {BRIDGE_PIERS} are built");
            let help = format!("give a wider pier_spacing, fewer or shorter bridges, or {BRIDGE_PIERS:#}");
            Err(document.error_at(span.place.span.clone(), message).with_help(help))
        }
        _ => Ok(()),
    }
}

/// Where there is water, at height 0.
fn water(collected: &SceneBuilder) -> Result<Deck, DeckError> {
    let of_water = collected
        .ribbons
        .iter()
        .filter(|ribbon| ribbon.surface.is_channel() || ribbon.surface == RibbonSurface::Lake);
    let corners = of_water.flat_map(|ribbon| ribbon.plan.corners());
    let facets: Vec<SurfaceTriangle> =
        corners.map(|corners| corners.map(|corner| corner.at.as_vec2().extend(0.0))).collect();
    Deck::new(&facets)
}

/// The water under bridges cannot be indexed.
#[derive(Debug, thiserror::Error)]
#[error("water under bridges")]
struct WaterError(#[source] DeckError);

/// A bridge true to scale.
struct PlannedBridge<'a> {
    chain: BuiltChain<'a>,
    link: &'a ChainLink,
    alignment: Alignment,
    options: BridgeOptions,
    sections: Vec<DeckSection>,
}

impl<'a> PlannedBridge<'a> {
    /// Its deck, for the symbol of its road.
    fn deck_line(&self) -> DeckLine {
        let street = &self.chain.spans[self.link.line].street;
        DeckLine {
            line: street.alignment.line.clone(),
            level: self.chain.level(self.link),
            parapet_m: bridge::parapet_m(street.width_m),
        }
    }

    /// Builds it as it is drawn.
    fn build(mut self, decks: &Deck) -> BuiltBridge<'a> {
        let site = self.chain.site;
        bridge::end_parapets(&mut self.sections, self.alignment.width.widest_m(), decks);
        for section in &mut self.sections {
            section.edges_m = section.edges_m.map(|edge_m| site.scale.world_z(edge_m));
        }
        let solids = bridge::build(&self.alignment, &self.sections, &self.options, &|at| site.ground_z(at));
        BuiltBridge { planned: self, solids }
    }
}

/// A bridge as it is drawn.
struct BuiltBridge<'a> {
    planned: PlannedBridge<'a>,
    solids: BridgeSolids,
}

impl BuiltBridge<'_> {
    /// Adds it and its row of the report.
    fn add(self, collected: &mut SceneBuilder) {
        let Self { planned: PlannedBridge { chain, link, .. }, solids } = self;
        let (span, level) = (&chain.spans[link.line], chain.level(link));
        let street = &span.street;
        let feature = collected.add(FeatureKind::Bridge, span.name.clone(), span.place.clone());
        let coat = Coat::Surface(street.surface);
        collected.solids.push(Solid { mesh: solids.carriageway, coat, feature });
        collected.solids.push(Solid { mesh: solids.body, coat: Coat::Painted, feature });
        chain.report(link, Some(solids.piers), None, level.steepest(0.0), collected);
        let (line, surface) = (street.alignment.line.clone(), street.surface);
        collected.bridge_profiles.push(BridgeProfile {
            feature,
            line,
            level,
            surface,
            max_grade: span.max_grade,
        });
    }
}

/// A chain with its levels and its site.
#[derive(Clone, Copy)]
struct BuiltChain<'a> {
    spans: &'a [RoadSpan],
    chain: &'a SpanChain,
    run: &'a ChainRun,
    site: &'a Site<'a>,
    /// Where tunnels end.
    mouths: &'a BTreeSet<VertexKey>,
}

impl<'a> BuiltChain<'a> {
    /// The bridges of the chain, one a span.
    fn planned(self, extent: &Rect) -> impl Iterator<Item = PlannedBridge<'a>> {
        let widest =
            self.chain.links.iter().map(|link| self.spans[link.line].street.width_m).fold(0.0, f64::max);
        let abutments = [0, 1].map(|end| self.abutment_m(end, widest, extent));
        let piers = self.piers(abutments);
        self.chain.links.iter().enumerate().map(move |(index, link)| {
            let span = &self.spans[link.line];
            let is_backward = link.direction == Direction::Backward;
            let own_ends = [index == 0, index + 1 == self.chain.links.len()];
            let mut of_link = [0, 1].map(|end| abutments[end].filter(|_| own_ends[end]));
            if is_backward {
                of_link.reverse();
            }
            let (low, high) = (link.start_m, link.end_m());
            let here = piers.iter().filter(|&&station| station >= low && station < high);
            let across = [0, 1].map(|end| {
                let is_mouth = self.mouths.contains(&vertex_key(span.street.alignment.line.ends()[end]));
                if of_link[end].is_some() && !is_mouth { Across::AsGround } else { Across::Level }
            });
            let options = BridgeOptions {
                depth_m: self.run.depth_m,
                piers_m: here.map(|station| (station - link.reach_m()[0]).abs()).collect(),
                abutments_m: of_link
                    .map(|length| length.map(|length| length.min(span.street.alignment.line.length() / 2.0))),
                across,
                beyond: span.beyond,
                miter_limit: span.street.options.miter_limit,
                texture_length_m: span.street.options.texture_length_m,
            };
            let alignment = Alignment { level: Some(self.level(link)), ..span.street.alignment.clone() };
            let sections = bridge::sections(&alignment, &options, &|at| self.site.ground_m(at));
            PlannedBridge { chain: self, link, alignment, options, sections }
        })
    }

    /// The elevations of a span.
    fn level(&self, link: &ChainLink) -> Profile {
        self.run.profile.slice(link.reach_m()[0], link.reach_m()[1], MERGE_M)
    }

    /// How far the abutment at an end of the chain reaches under it; `None` where the chain goes on or leaves the model.
    fn abutment_m(&self, end: usize, width_m: f64, extent: &Rect) -> Option<f64> {
        let length_m = self.chain.length_m;
        let at = |from_end: f64| if end == 0 { from_end } else { length_m - from_end };
        let leaves = !extent.grown(-1e-3).contains(self.chain.at(self.spans, at(0.0)));
        if matches!(self.chain.ends[end], ChainEnd::Onward(_)) || leaves {
            return None;
        }
        let by = magnified(width_m);
        let longest = (LONGEST_ABUTMENT * length_m).max(length_m.min(by));
        let open = |from_end: f64| {
            let Some(ground_m) = self.site.ground_m(self.chain.at(self.spans, at(from_end))) else {
                return true;
            };
            let above = self.site.scale.world_z(self.run.profile.at(at(from_end)) - ground_m);
            above - self.run.depth_m > ABUTMENT_M * by
        };
        let least = (1.2 * by).min(longest);
        let place = |step: i32| least + (longest - least) * f64::from(step) / 32.0;
        Some((0..32).map(place).find(|&from_end| open(from_end)).unwrap_or(longest))
    }

    /// The stations of the piers along the chain: evenly between the abutments, beside what passes below.
    fn piers(&self, abutments: [Option<f64>; 2]) -> Vec<f64> {
        let from = abutments[0].unwrap_or(0.0);
        let clear = self.chain.length_m - from - abutments[1].unwrap_or(0.0);
        let [first, last] = abutments.map(|abutment| if abutment.is_some() { 1.0 } else { 0.5 });
        // Between n piers are n − 1 spans, and `first` and `last` of one beyond them.
        let count =
            (clear / self.run.spacing_m - first - last + 1.0).ceil().clamp(0.0, BRIDGE_PIERS.get() as f64);
        let spacing = clear / (first + last + count - 1.0).max(1e-9);
        let even = (0..count as usize).map(|pier| from + spacing * (first + pier as f64));
        even.map(|station| self.beside(station, spacing)).collect()
    }

    /// A pier's station moved out of what passes below, where that takes it no farther than a third of a span.
    fn beside(&self, station: f64, spacing: f64) -> f64 {
        let room = 1.5;
        let in_way = |passage: &&levels::Passage| {
            station > passage.reach_m[0] - room && station < passage.reach_m[1] + room
        };
        let Some(passage) = self.run.passages.iter().find(in_way) else { return station };
        let [before, after] = [passage.reach_m[0] - room, passage.reach_m[1] + room];
        let nearest = if station - before < after - station { before } else { after };
        if (nearest - station).abs() <= spacing / 3.0 { nearest } else { station }
    }

    /// The portals of the chain, or a road on the ground in its place.
    fn tunnel(&self, extent: &Rect, roads: &mut [Centerline], collected: &mut SceneBuilder) {
        let cover = |floor: &ClearancePoint| floor.level_m - self.run.profile.at(floor.station_m);
        let cover_m = self.run.ground.iter().map(cover).fold(f64::NEG_INFINITY, f64::max);
        let is_shallow = cover_m < LEAST_COVER_M;
        let open_ends = !self.chain.ends.iter().any(|end| matches!(end, ChainEnd::Onward(_)));
        if is_shallow && open_ends && self.chain.length_m <= LONGEST_UNDERPASS_M {
            for link in &self.chain.links {
                if let Some(road) = self.spans[link.line].road {
                    roads[road].street.alignment.support = Support::Ground;
                }
                self.report(link, None, Some(0), self.run.profile.steepest(0.0), collected);
            }
            return;
        }
        for link in &self.chain.links {
            let span = &self.spans[link.line];
            let feature = collected.add(FeatureKind::Tunnel, span.name.clone(), span.place.clone());
            let portals: Vec<Portal> = if is_shallow {
                Vec::new()
            } else {
                (0..2).filter_map(|end| self.portal(link, end, extent)).collect()
            };
            for portal in &portals {
                let mesh = portal.build(&|at| self.site.ground_z(at));
                collected.solids.push(Solid { mesh, coat: Coat::Painted, feature });
            }
            let grade = self.level(link).steepest(0.0);
            self.report(link, None, Some(portals.len()), grade, collected);
        }
    }

    /// The portal at an end of a span, where it comes out of a hill there.
    fn portal(&self, link: &ChainLink, end: usize, extent: &Rect) -> Option<Portal> {
        let span = &self.spans[link.line];
        let station = link.reach_m()[end];
        let corner = if station <= 0.0 { 0 } else { 1 };
        let is_chain_end = station <= 0.0 || station >= self.chain.length_m;
        let at = span.street.alignment.line.ends()[end];
        if !is_chain_end || self.chain.ends[corner] != ChainEnd::Ground || !extent.grown(-1e-3).contains(at) {
            return None;
        }
        let points = span.street.alignment.line.points();
        let inner = if end == 0 { points[1] } else { points[points.len() - 2] };
        let portal = Portal {
            at,
            level_m: self.site.scale.world_z(self.run.profile.at(station)),
            outward: (at - inner).normalize_or_zero(),
            width_m: span.street.width_m,
        };
        let ground = |at| self.site.ground_z(at);
        let beyond = if end == 0 { span.beyond.before } else { span.beyond.after };
        // As far as the road goes on straight, it runs through the middle of the mouth.
        let straight_m = beyond.map_or(0.0, |next| {
            let off = portal.outward.perp_dot((next - at).normalize_or_zero()).abs();
            (OFF_CENTER_M * magnified(portal.width_m) / off.max(1e-6)).min((next - at).length())
        });
        portal.covered_after_m(BURIED, &ground).map(|_| portal.out_of_the_hill(straight_m, &ground))
    }

    /// Adds a span's row to the report.
    fn report(
        &self,
        link: &ChainLink,
        piers: Option<usize>,
        portals: Option<usize>,
        grade: f64,
        collected: &mut SceneBuilder,
    ) {
        let span = &self.spans[link.line];
        let (low, high) = (link.start_m, link.end_m());
        let under = self.run.ground.iter().filter(|floor| floor.station_m >= low && floor.station_m <= high);
        let above = under.map(|floor| self.run.profile.at(floor.station_m) - floor.level_m);
        let (least, most) =
            above.fold((0.0f64, 0.0f64), |(least, most), here| (least.min(here), most.max(here)));
        let depth_m = self.site.scale.elevation_m(self.run.depth_m);
        let here = self
            .run
            .passages
            .iter()
            .filter(|passage| passage.reach_m[1] >= low && passage.reach_m[0] <= high);
        let clearance = here
            .flat_map(|passage| passage.reach_m.map(|at| self.run.profile.at(at) - depth_m - passage.level_m))
            .reduce(f64::min);
        let kind = match (span.street.alignment.support, portals) {
            (Support::Tunnel, Some(0)) if -least < LEAST_COVER_M => "underpass",
            (Support::Tunnel, _) => "tunnel",
            _ => "bridge",
        };
        collected.report.bridges_and_tunnels.push(SpanRow {
            name: span.name.clone(),
            kind,
            by: span.origin.word(),
            length: span.street.alignment.line.length(),
            greatest_height_above_ground: most,
            greatest_depth_below_ground: -least,
            steepest_grade: grade * 100.0,
            piers,
            portals,
            lowest_clearance: clearance,
        });
    }
}
