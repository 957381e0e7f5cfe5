//! The roads that the ground follows as a network to be designed: what is stated for each, and the ground under them.

use std::ops::Range;

use crate::attributes::DefaultCounts;
use crate::roads::centerline::Centerline;
use crate::roads::meetings::{RoadMeetings, RoadStop};
use crate::roads::route::Route;
use sandtable_base::limits::ROAD_STATIONS;
use sandtable_description::diagnostic::Diagnostic;
use sandtable_description::document::Document;
use sandtable_description::features::RoadTable;
use sandtable_description::words::ProfileMode;
use sandtable_earthworks::alignment::SupportSpan;
use sandtable_earthworks::alignment::chain::LineEnd;
use sandtable_earthworks::alignment::design::Design;
use sandtable_earthworks::alignment::network::{RoadSection, SectionNetwork};
use sandtable_earthworks::alignment::spans::EarthworkLimits;
use sandtable_earthworks::grading::strip;
use sandtable_geom::profile::Profile;
use sandtable_terrain::lattice::Lattice;
use sandtable_terrain::profile::profile;

/// The rules for a road that the ground follows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rules {
    /// The steepest rise, meters per meter.
    pub max_grade: f64,
    /// What embankments and cuttings may be.
    pub limits: EarthworkLimits,
    /// Its cross section.
    pub section: strip::CrossSection,
}

impl Rules {
    /// The rules of a road; `None` where it follows the ground.
    pub fn of(document: &Document, road: &Centerline, counts: &mut DefaultCounts) -> Option<Self> {
        let table = &document.roads[road.table];
        if !conforms(table) {
            return None;
        }
        Some(Self {
            max_grade: road.attributes.number(&table.max_grade, counts) / 100.0,
            limits: EarthworkLimits {
                max_fill_m: table.max_fill.unwrap_or(f64::INFINITY),
                max_cut_m: table.max_cut.unwrap_or(f64::INFINITY),
            },
            section: strip::CrossSection {
                shoulder_m: road.attributes.value_or_default(&table.shoulder),
                crown: table.crown / 100.0,
                fill_slope: table.fill_slope,
                cut_slope: table.cut_slope,
            },
        })
    }
}

/// Whether the ground follows the roads of a table.
pub fn conforms(table: &RoadTable) -> bool {
    table.profile != ProfileMode::Drape
}

/// A network of roads to be designed, with the ground where single roads end.
pub struct NetworkSurvey {
    /// The sections between nodes.
    pub network: SectionNetwork,
    /// One a node: the stated level, the ground where a single road ends, NaN elsewhere.
    pub pins: Vec<f64>,
    /// One a road of the network.
    surveyed: Vec<SurveyedRoad>,
}

struct SurveyedRoad {
    road: usize,
    sections: Range<usize>,
    /// Where its sections begin along it.
    starts_m: Vec<f64>,
}

impl NetworkSurvey {
    /// Surveys the roads that have rules.
    ///
    /// # Errors
    /// They have more stations than can be held.
    pub fn of(
        document: &Document,
        lattice: &Lattice,
        roads: &[Centerline],
        rules: &[Option<Rules>],
        meetings: &RoadMeetings,
    ) -> Result<Self, Diagnostic> {
        let network = SectionNetwork { nodes: meetings.nodes, sections: Vec::new() };
        let mut survey = Self { network, pins: Vec::new(), surveyed: Vec::new() };
        let mut stations = 0.0;
        for (index, (road, rules)) in roads.iter().zip(rules).enumerate() {
            let Some(rules) = rules else { continue };
            stations += stations_of(lattice, road);
            if stations > ROAD_STATIONS.get() as f64 {
                return Err(too_many(document, road));
            }
            survey.add(lattice, index, road, rules, &meetings.stops[index]);
        }
        survey.pin();
        Ok(survey)
    }

    fn add(&mut self, lattice: &Lattice, index: usize, road: &Centerline, rules: &Rules, stops: &[RoadStop]) {
        let first = self.network.sections.len();
        for pair in stops.windows(2) {
            let origin = lattice.origin();
            let points = road.street.alignment.line.between(pair[0].station_m, pair[1].station_m);
            let points: Vec<_> = points.into_iter().map(|point| point + origin).collect();
            let stations = profile(lattice, &points);
            let stated =
                |own: &Profile| stations.iter().map(|at| own.at(pair[0].station_m + at.station_m)).collect();
            let stated_m: Option<Vec<f64>> = road.own_levels.as_ref().map(stated);
            // A stated profile is as steep as it is.
            let steepest = road.own_levels.as_ref().map_or(0.0, |own| own.steepest(1e-3));
            self.network.sections.push(RoadSection {
                ends: [pair[0].node, pair[1].node],
                stations_m: stations.iter().map(|at| at.station_m).collect(),
                ground_m: stations.iter().map(|at| at.ground.height_m().unwrap_or(f64::NAN)).collect(),
                max_grade: rules.max_grade.max(steepest),
                support: road.street.alignment.support,
                limits: rules.limits,
                stated_m,
            });
        }
        let starts_m = stops.iter().map(|stop| stop.station_m).collect();
        self.surveyed.push(SurveyedRoad {
            road: index,
            sections: first..self.network.sections.len(),
            starts_m,
        });
    }

    /// A road that ends where no other of the network does ends on the ground, one of stated levels at these.
    fn pin(&mut self) {
        let pin = |arms: Vec<LineEnd>| match arms[..] {
            [LineEnd { line, end }] => {
                let ground = &self.network.sections[line].ground_m;
                ground[end * (ground.len() - 1)]
            }
            _ => f64::NAN,
        };
        self.pins = self.network.arms().into_iter().map(pin).collect();
        // Others meet a road of stated levels at these.
        for section in &self.network.sections {
            let Some([first, .., last]) = section.stated_m.as_deref() else { continue };
            for (node, level) in section.ends.iter().zip([first, last]) {
                self.pins[node.index()] = *level;
            }
        }
    }

    /// The roads with their design; without those that no ground gave a level.
    pub fn routes(&self, design: &Design) -> Vec<Route> {
        self.surveyed.iter().filter_map(|surveyed| self.route(surveyed, design)).collect()
    }

    fn route(&self, surveyed: &SurveyedRoad, design: &Design) -> Option<Route> {
        let (mut stations_m, mut ground_m, mut design_m) = (Vec::new(), Vec::new(), Vec::new());
        let mut spans = Vec::new();
        for (section, &start_m) in surveyed.sections.clone().zip(&surveyed.starts_m) {
            // The node between two sections is the last station of one and the first of the next.
            let skipped = usize::from(!stations_m.is_empty());
            let surveyed = &self.network.sections[section];
            stations_m.extend(surveyed.stations_m.iter().skip(skipped).map(|at| start_m + at));
            ground_m.extend(surveyed.ground_m.iter().skip(skipped));
            design_m.extend(design.levels_m[section].iter().skip(skipped));
            spans.extend(design.spans[section].iter().map(|span| SupportSpan {
                from_m: start_m + span.from_m,
                to_m: start_m + span.to_m,
                ..*span
            }));
        }
        let ground = Profile::new(stations_m.clone(), ground_m)?;
        let design = Profile::new(stations_m, design_m)?;
        let is_level = design.values().iter().all(|level| level.is_finite());
        is_level.then_some(Route { road: surveyed.road, ground, design, spans })
    }
}

/// About how many stations a road will have.
fn stations_of(lattice: &Lattice, road: &Centerline) -> f64 {
    let (extent, cell) = (lattice.extent(), lattice.cell());
    let on_ground = road.street.alignment.line.legs().filter_map(|[from, to]| extent.clip_line(from, to));
    let crossed = on_ground.map(|(from, to)| 2.0 * ((to - from).abs() / cell).element_sum());
    crossed.sum::<f64>() + road.street.alignment.line.points().len() as f64
}

fn too_many(document: &Document, road: &Centerline) -> Diagnostic {
    let message = format!("these roads have more than {ROAD_STATIONS} stations on the elevation model");
    let help = format!(
        "let fewer of them conform, by a `where` or in a scene of a smaller area, or {ROAD_STATIONS:#}"
    );
    document.error_at(document.roads[road.table].source.span(), message).with_help(help)
}
