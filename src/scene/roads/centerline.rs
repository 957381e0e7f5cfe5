//! The document's roads as centerlines, each with what it is to become.

use std::collections::BTreeMap;

use glam::DVec2;
use rayon::prelude::*;

use crate::attributes::{Attributes, DefaultCounts};
use crate::builder::SceneBuilder;
use crate::feature::FeatureKind;
use crate::meant_number::Meaning;
use crate::near;
use crate::scene_findings::FeatureTable;
use crate::sources::Sources;
use crate::symbols::DeckLine;
use crate::tag_notes::{NumberLimits, TagNotes};
use sandtable_description::diagnostic::Diagnostic;
use sandtable_description::document::Document;
use sandtable_description::features::RoadTable;
use sandtable_description::finding_code::FindingCode;
use sandtable_description::words::{self, Markings, ProfileMode};
use sandtable_draw::list::FeatureId;
use sandtable_earthworks::alignment::{Alignment, Support, Width};
use sandtable_geom::polyline::Polyline;
use sandtable_geom::profile::Profile;
use sandtable_geom::rect::Rect;
use sandtable_ribbon::junction::Street;
use sandtable_ribbon::stroke::StrokeOptions;
use sandtable_ribbon::texture::{RibbonSurface, texture_length_m};

/// How far from the ground a centerline may run whose road still reaches it, in meters.
const REACH_M: f64 = 1000.0;

/// The roads of which a thread reads the keys in one go.
const ROADS: usize = 64;

/// A road, or the part of one that has one support.
#[derive(Clone, Debug)]
pub struct Centerline {
    /// Its carriageway.
    pub street: Street,
    /// The width of the unpaved strip on either side in meters; 0 for none.
    pub shoulder_m: f64,
    /// The deck that carries it, once it is planned, where it is a bridge.
    pub deck: Option<DeckLine>,
    /// Its feature.
    pub feature: FeatureId,
    /// The index of its table in the document.
    pub table: usize,
    /// Its properties in the file.
    pub attributes: Attributes,
    /// The levels that it is to have, meters, where its table takes those of its file.
    pub own_levels: Option<Profile>,
}

/// The centerlines of the document's roads that come near the ground.
///
/// # Errors
/// A source cannot be had.
pub fn collect(
    document: &Document,
    sources: &Sources<'_>,
    extent: &Rect,
    collected: &mut SceneBuilder,
) -> Result<Vec<Centerline>, Diagnostic> {
    let mut all = Vec::new();
    for (table, road) in document.roads.iter().enumerate() {
        let lines = sources.lines(&road.source)?;
        let mut without_levels = 0;
        let widths_m = lines.first().and_then(|line| near::widths_m(road.widths.as_deref(), &line.shape));
        let named =
            FeatureTable { kind: FeatureKind::Road, name: road.name.as_deref(), source: &road.source };
        let near = near::lines(lines, extent, REACH_M, &named, &mut collected.findings);
        let read = |(attributes, line)| ReadRoad::new((table, road), attributes, line);
        let read: Vec<ReadRoad> = near.into_par_iter().with_min_len(ROADS).map(read).collect();
        for read in read {
            let mut centerline = read.add(road, collected);
            if road.profile == ProfileMode::Own {
                centerline.own_levels = own_levels(&centerline, sources);
                without_levels += usize::from(centerline.own_levels.is_none());
            }
            if let Some(widths_m) = &widths_m {
                centerline.vary(widths_m);
            }
            all.push(centerline);
        }
        if without_levels > 0 {
            let noun = FeatureKind::Road.noun(without_levels);
            let message = format!(
                "{without_levels} {noun} without elevations all along in the file: the ground follows as with `profile = \"conform\"`"
            );
            collected.findings.add(FindingCode::DefaultTaken, road.source.span(), message);
        }
    }
    Ok(all)
}

/// The elevations that a road's file states along it; `None` where a vertex is without one.
fn own_levels(road: &Centerline, sources: &Sources<'_>) -> Option<Profile> {
    let crs = road.attributes.crs()?;
    let mut levels: BTreeMap<[u64; 2], f64> = BTreeMap::new();
    for (at, elevation_m) in road.attributes.elevations_m() {
        // The same arithmetic as that which placed the line.
        let world = sources.frame.world(crs, at).ok()?;
        levels.entry(bits(world)).or_insert(elevation_m);
    }
    let line = &road.street.alignment.line;
    let values: Option<Vec<f64>> = line.points().iter().map(|at| levels.get(&bits(*at)).copied()).collect();
    Profile::new(line.stations().to_vec(), values?)
}

fn bits(at: DVec2) -> [u64; 2] {
    at.to_array().map(f64::to_bits)
}

impl Centerline {
    fn vary(&mut self, widths_m: &[f64]) {
        let Street { alignment, width_m, options, surface, .. } = &mut self.street;
        *width_m = widths_m.iter().sum::<f64>() / widths_m.len() as f64;
        options.texture_length_m = texture_length_m(*surface, *width_m);
        let widths = Profile::new(alignment.line.stations().to_vec(), widths_m.to_vec());
        alignment.width = widths.map_or(Width::Constant(*width_m), Width::Varying);
    }
}

/// A road line with what its table says of it, before it is a feature.
struct ReadRoad {
    centerline: Centerline,
    name: String,
    default_counts: DefaultCounts,
    tag_notes: TagNotes,
}

impl ReadRoad {
    /// Evaluates what a table, the document's `table`-th, says of a road line.
    fn new((table, road): (usize, &RoadTable), attributes: Attributes, line: Polyline) -> Self {
        let (mut default_counts, mut tag_notes) = (DefaultCounts::new(), TagNotes::default());
        let word = attributes.value_or_default(&road.surface);
        let surface = surface(word, attributes.value_or_default(&road.markings));
        let width_m = attributes.number(&road.width, &mut default_counts);
        let shoulder_m = attributes.number(&road.shoulder, &mut default_counts);
        let support = support(road, &attributes);
        let street = Street {
            alignment: Alignment { support, ..Alignment::on_ground(line, width_m) },
            width_m,
            options: StrokeOptions {
                join: road.join,
                miter_limit: road.miter_limit,
                ..StrokeOptions::of(surface, width_m)
            },
            level: level(road, &attributes, support, &mut tag_notes),
            surface,
        };
        let name = attributes.name(road.name.as_deref());
        let (deck, feature, own_levels) = (None, FeatureId::NONE, None);
        let centerline = Centerline { street, shoulder_m, deck, feature, table, attributes, own_levels };
        Self { centerline, name, default_counts, tag_notes }
    }

    /// Makes it a feature.
    fn add(self, road: &RoadTable, collected: &mut SceneBuilder) -> Centerline {
        for (key, count) in self.default_counts {
            *collected.default_counts.entry(key).or_default() += count;
        }
        collected.tag_notes.append(self.tag_notes);
        let origin = self.centerline.attributes.origin(&road.source);
        Centerline { feature: collected.add(FeatureKind::Road, self.name, origin), ..self.centerline }
    }
}

/// A pavement, with what is painted on asphalt.
pub(crate) fn surface(word: words::RoadSurface, markings: Markings) -> RibbonSurface {
    match (word, markings) {
        (words::RoadSurface::Gravel, _) => RibbonSurface::Gravel,
        (words::RoadSurface::Track, _) => RibbonSurface::Track,
        (words::RoadSurface::Asphalt, Markings::Dashed) => RibbonSurface::Asphalt,
        (words::RoadSurface::Asphalt, Markings::Solid) => RibbonSurface::AsphaltSolid,
        (words::RoadSurface::Asphalt, Markings::Edges) => RibbonSurface::AsphaltEdges,
        (words::RoadSurface::Asphalt, Markings::None) => RibbonSurface::AsphaltPlain,
    }
}

/// The support of a road, by the expressions stated for it, else by its OpenStreetMap tags.
pub(crate) fn support(road: &RoadTable, attributes: &Attributes) -> Support {
    let holds = |stated: &Option<_>, property| match stated {
        Some(expression) => attributes.holds(expression),
        None => attributes.affirm(property),
    };
    match (holds(&road.tunnel, "tunnel"), holds(&road.bridge, "bridge")) {
        (true, _) => Support::Tunnel,
        (false, true) => Support::Bridge,
        (false, false) => Support::Ground,
    }
}

fn level(road: &RoadTable, attributes: &Attributes, support: Support, notes: &mut TagNotes) -> i32 {
    let limits = NumberLimits { low: -1000.0, includes_low: true, high: 1000.0 };
    let tagged = || notes.number(attributes, &["layer"], Meaning::Count, limits);
    let by_support = match support {
        Support::Ground => 0.0,
        Support::Bridge => 1.0,
        Support::Tunnel => -1.0,
    };
    let level = attributes.value(road.level.as_ref()).or_else(tagged).unwrap_or(by_support);
    level.round().clamp(-20.0, 20.0) as i32
}

#[cfg(test)]
pub(in crate::roads) mod tests {
    use super::*;
    use glam::DVec2;
    use sandtable_description::parse::parse;

    /// A road along these points, six meters wide, from the document's first table.
    pub fn road(points: &[(f64, f64)], support: Support, level: i32) -> Centerline {
        let line = Polyline::new(points.iter().map(|&(x, y)| DVec2::new(x, y)), 0.0).expect("a line");
        let street = Street {
            alignment: Alignment { support, ..Alignment::on_ground(line, 6.0) },
            width_m: 6.0,
            options: StrokeOptions::default(),
            level,
            surface: RibbonSurface::Asphalt,
        };
        Centerline {
            street,
            shoulder_m: 0.0,
            deck: None,
            feature: FeatureId(2),
            table: 0,
            attributes: Attributes::default(),
            own_levels: None,
        }
    }

    /// The road of a scene file with these keys.
    fn table(keys: &str) -> RoadTable {
        let text = format!("[terrain]\ndem = \"a\"\n[[road]]\n{keys}\n");
        parse("road.toml", &text).expect("a valid scene").roads.remove(0)
    }

    #[test]
    fn widths_stay_with_their_points_where_points_are_merged() {
        let road = table("points = [[0, 0], [0.001, 0], [9, 0]]\nwidths = [3, 4, 5]");
        let shape = [DVec2::ZERO, DVec2::X * 0.001, DVec2::X * 9.0];
        assert_eq!(near::widths_m(road.widths.as_deref(), &shape), Some(vec![3.0, 5.0]));
    }
}
