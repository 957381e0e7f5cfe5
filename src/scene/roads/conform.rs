//! Roads that the ground follows.
//!
//! ```text
//!  meetings ─► network_survey ─► earthworks/alignment: design ─► denser posts ─► earthworks/grading ─► report, profiles
//!                                                         └─► route::cut: ground, bridges, tunnels
//! ```

use std::collections::BTreeMap;
use std::ops::Range;

use crate::builder::SceneBuilder;
use crate::report::ConformedRoadRow;
use crate::roads::centerline::Centerline;
use crate::roads::meetings::{RoadMeetings, meetings};
use crate::roads::network_survey::{NetworkSurvey, Rules, conforms};
use crate::roads::profiles::RoadProfile;
use crate::roads::route::Route;
use sandtable_base::limits::{GROUND_POSTS, ROAD_CROSSINGS, ROAD_PAIRS};
use sandtable_base::message::numbers::{counted, fixed};
use sandtable_description::diagnostic::Diagnostic;
use sandtable_description::document::Document;
use sandtable_description::finding_code::FindingCode;
use sandtable_earthworks::alignment::design::design;
use sandtable_earthworks::alignment::network::NodeId;
use sandtable_earthworks::alignment::{Alignment, Support, SupportSpan};
use sandtable_earthworks::grading::grade;
use sandtable_earthworks::grading::strip::{GradingStrip, StripEnd};
use sandtable_terrain::densify;
use sandtable_terrain::lattice::Lattice;
use sandtable_terrain::volumes::Volumes;

/// The length of a vertical curve in meters: for a crest between grades of 4 % up and down at 50 km/h.
const CURVE_M: f64 = 50.0;

/// A vertical curve is at least so many cells long: the kinks of the ground's own planes are no kinks of the land.
const CURVE_CELLS: f64 = 2.0;

/// Over how many meters the grade of a bridge is taken beside its end.
const GRADE_OVER_M: f64 = 2.0;

/// The part of a bridge's length below which ground may be moved at either end: as far as its abutments reach.
const ABUTMENT_SHARE: f64 = 0.25;

/// Posts across the narrowest carriageway that the ground follows; the lattice grows with the square.
const POSTS_ACROSS: f64 = 4.0;

/// Designs the roads that the ground follows, grades the ground for them and cuts them where bridges and tunnels begin.
///
/// The lattice may get more posts; its origin, its extent and all heights beside the earthworks stay as they are.
///
/// # Errors
/// More roads conform than can be held.
pub fn conform(
    document: &Document,
    lattice: &mut Lattice,
    roads: &mut Vec<Centerline>,
    collected: &mut SceneBuilder,
) -> Result<(), Diagnostic> {
    let rules: Vec<Option<Rules>> =
        roads.iter().map(|road| Rules::of(document, road, &mut collected.default_counts)).collect();
    if rules.iter().all(Option::is_none) {
        return Ok(());
    }
    let is_on_ground = |road: &Centerline| road.street.alignment.is_on_ground();
    let crosses = |road: &Centerline| is_on_ground(road) && conforms(&document.roads[road.table]);
    let meetings = meetings(roads, crosses);
    if meetings.is_tangled {
        let note = format!(
            "conforming roads cross each other too often to find every place: they meet at their vertices only; for more \
             crossings {ROAD_CROSSINGS:#}, for more comparisons {ROAD_PAIRS:#}"
        );
        let place = longest_table(document, roads.iter().filter(|road| crosses(road)));
        collected.findings.add(FindingCode::Tangled, place, note);
    }
    let survey = NetworkSurvey::of(document, lattice, roads, &rules, &meetings)?;
    let curve_m = CURVE_M.max(CURVE_CELLS * lattice.measured_cell().max_element());
    let design = design(&survey.network, &survey.pins, curve_m);
    let routes: Vec<Route> = survey.routes(&design).into_iter().map(Route::with_ends).collect();
    let beyond = span_ends(roads, &routes, &meetings);
    let works = Earthworks { roads, rules: &rules, beyond, meetings: &meetings };
    let volumes = works.build(lattice, &routes, collected);
    for (route, volumes) in routes.iter().zip(&volumes) {
        report_road(&roads[route.road], route, volumes, collected);
    }
    note_totals(document, roads, &routes, &volumes, collected);
    replace(roads, &routes);
    Ok(())
}

/// Where the table is stated that has the most vertices of `roads`; the first of equal ones.
fn longest_table<'a>(document: &Document, roads: impl Iterator<Item = &'a Centerline>) -> Range<usize> {
    let mut vertices: BTreeMap<usize, usize> = BTreeMap::new();
    for road in roads {
        *vertices.entry(road.table).or_default() += road.street.alignment.line.points().len();
    }
    let longest = vertices.into_iter().rev().max_by_key(|&(_, count)| count);
    longest.map(|(table, _)| document.roads[table].source.span()).unwrap_or_default()
}

struct Earthworks<'a> {
    roads: &'a [Centerline],
    rules: &'a [Option<Rules>],
    /// The nodes where bridges and tunnels begin.
    beyond: BTreeMap<NodeId, BeyondEnd>,
    meetings: &'a RoadMeetings,
}

impl Earthworks<'_> {
    /// Grades the ground for every span on it, and returns the earth moved for each route.
    fn build(&self, lattice: &mut Lattice, routes: &[Route], collected: &mut SceneBuilder) -> Vec<Volumes> {
        let strips: Vec<(usize, GradingStrip)> = routes
            .iter()
            .enumerate()
            .flat_map(|(index, route)| self.strips(route).into_iter().map(move |strip| (index, strip)))
            .collect();
        let (owners, strips): (Vec<usize>, Vec<GradingStrip>) = strips.into_iter().unzip();
        make_denser(lattice, &strips, collected);
        let mut volumes = vec![Volumes::default(); routes.len()];
        if !strips.is_empty() {
            for (owner, moved) in owners.into_iter().zip(grade(lattice, &strips)) {
                volumes[owner] += moved;
            }
        }
        volumes
    }

    fn strips(&self, route: &Route) -> Vec<GradingStrip> {
        let Some(rules) = &self.rules[route.road] else { return Vec::new() };
        let all = route.all_spans();
        let on_ground = all.iter().enumerate().filter(|(_, span)| span.support == Support::Ground);
        let strip = |(index, span): (usize, &SupportSpan)| {
            let street = &self.roads[route.road].street;
            let line = street.alignment.line.slice(span.from_m, span.to_m, 0.0)?;
            let level = Some(route.design.slice(span.from_m, span.to_m, 0.0));
            let alignment = Alignment { level, ..Alignment::on_ground(line, street.width_m) };
            let beside = [index.checked_sub(1).and_then(|before| all.get(before)), all.get(index + 1)];
            let ends = [
                self.end(route, beside[0], 0, [span.from_m, -1.0]),
                self.end(route, beside[1], usize::MAX, [span.to_m, 1.0]),
            ];
            Some(GradingStrip { alignment, section: rules.section, ends })
        };
        on_ground.filter_map(strip).collect()
    }

    /// What stands at an end of a span: by the span beyond, or by what meets the road at its own end. `station_m` is that
    /// of the end, `way` −1 at a start and 1 at an end.
    fn end(
        &self,
        route: &Route,
        beyond: Option<&SupportSpan>,
        stop: usize,
        [station_m, way]: [f64; 2],
    ) -> StripEnd {
        let stops = &self.meetings.stops[route.road];
        let own = beyond.map(|span| BeyondEnd { support: span.support, length_m: span.to_m - span.from_m });
        let other = || self.beyond.get(&stops[stop.min(stops.len() - 1)].node).copied();
        match own.or_else(other) {
            None | Some(BeyondEnd { support: Support::Ground, .. }) => StripEnd::Open,
            Some(BeyondEnd { support: Support::Tunnel, .. }) => StripEnd::Wall,
            Some(BeyondEnd { support: Support::Bridge, length_m }) => {
                let level_m = |out_m: f64| route.design.at(station_m + way * out_m);
                let rise_m = match beyond {
                    Some(_) => level_m(GRADE_OVER_M) - level_m(0.0),
                    None => level_m(0.0) - level_m(-GRADE_OVER_M),
                };
                StripEnd::Abutment { grade: rise_m / GRADE_OVER_M, reach_m: ABUTMENT_SHARE * length_m }
            }
        }
    }
}

/// A bridge or a tunnel that goes on where a road on the ground ends.
#[derive(Clone, Copy)]
struct BeyondEnd {
    support: Support,
    length_m: f64,
}

/// The nodes where a bridge or a tunnel of one road ends that may go on as another on the ground; of several a tunnel,
/// else the shortest.
fn span_ends(roads: &[Centerline], routes: &[Route], meetings: &RoadMeetings) -> BTreeMap<NodeId, BeyondEnd> {
    let mut nodes: BTreeMap<NodeId, BeyondEnd> = BTreeMap::new();
    let mut add = |node: NodeId, end: BeyondEnd| {
        let rank = |end: &BeyondEnd| (end.support != Support::Tunnel, end.length_m);
        let is_kept = |kept: &BeyondEnd| rank(kept) <= rank(&end);
        if end.support != Support::Ground && !nodes.get(&node).is_some_and(is_kept) {
            nodes.insert(node, end);
        }
    };
    for (road, stops) in roads.iter().zip(&meetings.stops) {
        let Alignment { support, line, .. } = &road.street.alignment;
        for stop in [stops[0], stops[stops.len() - 1]] {
            add(stop.node, BeyondEnd { support: *support, length_m: line.length() });
        }
    }
    for route in routes {
        let (all, stops) = (route.all_spans(), &meetings.stops[route.road]);
        for (end, stop) in [(&all[0], stops[0]), (&all[all.len() - 1], stops[stops.len() - 1])] {
            add(stop.node, BeyondEnd { support: end.support, length_m: end.to_m - end.from_m });
        }
    }
    nodes
}

/// Puts more posts between those there are, where the carriageways are narrower than a few cells.
fn make_denser(lattice: &mut Lattice, strips: &[GradingStrip], collected: &mut SceneBuilder) {
    let widths = strips.iter().map(|strip| strip.alignment.width.widest_m());
    let narrowest_m = widths.fold(f64::INFINITY, f64::min);
    let times = densify::bring_to(lattice, narrowest_m / POSTS_ACROSS);
    let spacing_m = lattice.cell().max_element();
    let mut note = match times {
        0 => String::new(),
        _ => format!(
            "posts every {spacing_m:.3} m were put in for conforming roads; the ground stays as it was"
        ),
    };
    if spacing_m > narrowest_m {
        let mut reason = "; a model of a smaller area could have more posts".to_owned();
        if densify::doublings_for(lattice, narrowest_m / POSTS_ACROSS) > 0 {
            reason.push_str(&format!(", or {GROUND_POSTS:#}"));
        }
        let wide = format!(
            "a conforming road of {narrowest_m} m lies on posts {spacing_m:.3} m apart and is graded wider"
        );
        note = if note.is_empty() { wide + &reason } else { format!("{note}; {wide}{reason}") };
    }
    if !note.is_empty() {
        let code = if spacing_m > narrowest_m { FindingCode::TooFine } else { FindingCode::PostsAdded };
        collected.findings.add(code, 0..0, note);
    }
}

fn report_road(road: &Centerline, route: &Route, volumes: &Volumes, collected: &mut SceneBuilder) {
    let name = collected.name(road.feature).to_owned();
    let all = route.all_spans();
    let support_at =
        |&station: &f64| all.iter().find(|at| station < at.to_m).unwrap_or(&all[all.len() - 1]).support;
    let supports: Vec<Support> = route.stations_m().iter().map(support_at).collect();
    let (ground_m, design_m) = (route.ground.values(), route.design.values());
    let rises: Vec<f64> = (0..supports.len())
        .filter(|&index| supports[index] == Support::Ground)
        .map(|index| design_m[index] - ground_m[index])
        .collect();
    let count = |support| all.iter().filter(|span| span.support == support).count();
    let highest = |sign: f64| rises.iter().fold(0.0, |most: f64, rise| most.max(rise * sign));
    collected.report.conformed_roads.push(ConformedRoadRow {
        name: name.clone(),
        length: road.street.alignment.line.length(),
        // Over less than a millimeter a grade is rounding.
        highest_grade: route.design.steepest(1e-3) * 100.0,
        cut: volumes.cut_m3,
        fill: volumes.fill_m3,
        highest_fill: highest(1.0),
        deepest_cut: highest(-1.0),
        bridges: count(Support::Bridge),
        tunnels: count(Support::Tunnel),
    });
    collected.profiles.push(RoadProfile {
        feature: road.feature,
        name,
        line: road.street.alignment.line.clone(),
        ground: route.ground.clone(),
        design: route.design.clone(),
        supports,
    });
}

/// Notes the earth moved for the roads of each table.
fn note_totals(
    document: &Document,
    roads: &[Centerline],
    routes: &[Route],
    volumes: &[Volumes],
    collected: &mut SceneBuilder,
) {
    let mut tables: BTreeMap<usize, (usize, Volumes, [usize; 2])> = BTreeMap::new();
    for (route, moved) in routes.iter().zip(volumes) {
        let (count, sum, spans) = tables.entry(roads[route.road].table).or_default();
        *count += 1;
        *sum += *moved;
        for span in route.all_spans() {
            spans[0] += usize::from(span.support == Support::Bridge);
            spans[1] += usize::from(span.support == Support::Tunnel);
        }
    }
    for (table, (count, Volumes { cut_m3, fill_m3 }, [bridges, tunnels])) in tables {
        let name =
            document.roads[table].name.as_deref().map(|name| format!(" of '{name}'")).unwrap_or_default();
        let roads = counted(count, "road", "roads");
        let mut note = format!(
            "the ground follows {roads}{name}: {} m³ cut, {} m³ filled",
            fixed(cut_m3, 0),
            fixed(fill_m3, 0)
        );
        if bridges + tunnels > 0 {
            note += &format!(
                "; on bridges {} and in tunnels {}",
                counted(bridges, "time", "times"),
                counted(tunnels, "time", "times")
            );
        }
        collected.findings.add(FindingCode::EarthMoved, document.roads[table].source.span(), note);
    }
}

/// Replaces every designed road by its spans.
fn replace(roads: &mut Vec<Centerline>, routes: &[Route]) {
    let mut cut: BTreeMap<usize, Vec<Centerline>> =
        routes.iter().map(|route| (route.road, route.cut(&roads[route.road]))).collect();
    let parts = std::mem::take(roads).into_iter().enumerate();
    *roads = parts.flat_map(|(index, road)| cut.remove(&index).unwrap_or_else(|| vec![road])).collect();
}
