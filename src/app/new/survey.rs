//! What vector files hold, in the words of a scene file.
//!
//! Each [`TableRule`] is a table that could be written, with the expression that chooses its features. The very expression is
//! asked of every feature, so that what is counted here is what the scene will hold, and no table is written that would
//! choose nothing. A layer in which no rule finds anything may still say by its name what it is.

use std::path::Path;
use std::sync::Arc;

use crate::app::failure::CliError;
use crate::app::files;
use crate::description::expression::Expression;
use crate::scene::attributes::Attributes;
use crate::vector::error::VectorError;
use crate::vector::feature::{Geometry, VectorLayer};
use crate::vector::hints::VectorHints;
use crate::vector::read;

/// One layer of a file.
pub(super) struct SurveyedLayer {
    /// How a scene asks for it; `None` where the file has one layer.
    pub layer: Option<String>,
    /// The tables that take something from it, in the order in which they are drawn.
    pub found: Vec<TableMatch>,
    /// What no table takes: `lines`, `polygons` or `points`, and how many.
    pub rest: Vec<(&'static str, usize)>,
}

/// A table and how many features it takes.
pub(super) struct TableMatch {
    pub rule: &'static TableRule,
    pub count: usize,
    /// Whether they must be chosen, or are all that there is.
    pub chosen: Chosen,
}

/// Which features of a layer a table takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Chosen {
    /// Those for which the rule holds.
    ByRule,
    /// All.
    All,
}

/// A table that may be written.
pub(super) struct TableRule {
    /// The table's name.
    pub table: &'static str,
    /// What its features are.
    pub what: &'static str,
    /// The shape that they have, as [`Geometry::kind`] calls it.
    pub shape: &'static str,
    /// The expression that holds for them.
    pub condition: &'static str,
    /// The width, in meters or as an expression, for things drawn to scale.
    pub width: Option<&'static str>,
    /// Further keys as they are written.
    pub keys: &'static [&'static str],
    /// What the name of a layer or a file contains that holds nothing else.
    pub names: &'static [&'static str],
}

/// The rules, in the order in which tables are written: what lies lower first.
pub(super) static RULES: [TableRule; 12] = [
    TableRule {
        table: "area",
        what: "Land cover",
        shape: "polygons",
        condition: "(landuse in ('forest', 'meadow', 'grass', 'farmland', 'farm', 'orchard', 'vineyard', \
                    'residential', 'commercial', 'retail', 'industrial', 'military', 'village_green', \
                    'recreation_ground') or natural in ('wood', 'scrub', 'heath', 'grassland', 'wetland', 'sand', \
                    'beach', 'bare_rock', 'scree') or leisure in ('park', 'garden', 'pitch', 'golf_course', \
                    'nature_reserve')) and not building",
        width: None,
        keys: &[
            "cover = \"match(landuse ?? natural ?? leisure, 'forest', 'forest', 'wood', 'forest', 'scrub', \
                 'scrub', 'heath', 'scrub', 'farmland', 'field', 'farm', 'field', 'orchard', 'orchard', 'vineyard', \
                 'orchard', 'residential', 'built-up', 'commercial', 'built-up', 'retail', 'built-up', \
                 'industrial', 'industry', 'military', 'restricted', 'wetland', 'wetland', 'sand', 'sand', \
                 'beach', 'sand', 'bare_rock', 'rock', 'scree', 'rock', 'meadow')\"",
        ],
        names: &[],
    },
    TableRule {
        table: "lake",
        what: "Lakes",
        shape: "polygons",
        condition: "natural = 'water' or landuse = 'reservoir' or waterway = 'riverbank'",
        width: None,
        keys: &["level_rule = \"lowest\""],
        names: &["lake", "water", "reservoir"],
    },
    TableRule {
        table: "river",
        what: "Streams",
        shape: "lines",
        condition: "waterway in ('stream', 'ditch', 'drain', 'brook')",
        width: Some("3"),
        keys: &[],
        names: &["stream", "creek"],
    },
    TableRule {
        table: "river",
        what: "Rivers",
        shape: "lines",
        condition: "waterway in ('river', 'canal')",
        width: Some("12"),
        keys: &[],
        names: &["river", "waterway"],
    },
    TableRule {
        table: "road",
        what: "Tracks and paths",
        shape: "lines",
        condition: "highway in ('track', 'path', 'footway', 'cycleway', 'bridleway', 'steps')",
        width: Some("2.5"),
        keys: &["surface = \"track\""],
        names: &["track", "trail", "path"],
    },
    TableRule {
        table: "road",
        what: "Streets",
        shape: "lines",
        condition: "highway in ('unclassified', 'residential', 'living_street', 'pedestrian', 'service', 'road')",
        width: Some("5"),
        keys: &["surface = \"if(surface in ('unpaved', 'gravel', 'dirt', 'ground'), 'gravel', 'asphalt')\""],
        names: &["road", "street"],
    },
    TableRule {
        table: "road",
        what: "Country roads",
        shape: "lines",
        condition: "highway in ('secondary', 'secondary_link', 'tertiary', 'tertiary_link')",
        width: Some("7"),
        keys: &["surface = \"if(surface in ('unpaved', 'gravel', 'dirt', 'ground'), 'gravel', 'asphalt')\""],
        names: &[],
    },
    TableRule {
        table: "road",
        what: "Main roads",
        shape: "lines",
        condition: "highway in ('motorway', 'motorway_link', 'trunk', 'trunk_link', 'primary', 'primary_link')",
        width: Some("10"),
        keys: &["surface = \"asphalt\""],
        names: &["highway"],
    },
    TableRule {
        table: "building",
        what: "Buildings",
        shape: "polygons",
        condition: "building",
        width: None,
        keys: &["height = \"height ?? `building:levels` * 3 ?? levels * 3 ?? 6\""],
        names: &["building", "footprint", "house"],
    },
    TableRule {
        table: "fence",
        what: "Fences, walls and hedges",
        shape: "lines",
        condition: "barrier in ('fence', 'wall', 'hedge', 'city_wall', 'retaining_wall')",
        width: None,
        keys: &["kind = \"match(barrier, 'fence', 'fence', 'hedge', 'hedge', 'wall')\""],
        names: &["fence"],
    },
    TableRule {
        table: "fence",
        what: "Power lines",
        shape: "lines",
        condition: "power in ('line', 'minor_line')",
        width: None,
        keys: &["kind = \"power-line\""],
        names: &["power"],
    },
    TableRule {
        table: "fence",
        what: "Boundaries",
        shape: "lines",
        condition: "boundary = 'administrative' and not highway and not waterway",
        width: None,
        keys: &["kind = \"boundary\""],
        names: &["boundar", "border"],
    },
];

/// What each layer of a vector file holds.
///
/// # Errors
/// The file cannot be read; the message names it.
pub(super) fn layers(file: &Path) -> Result<Vec<SurveyedLayer>, CliError> {
    let bytes = files::read(file)?;
    let name = file.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    let beside = files::beside(file);
    let read = |layer: Option<&str>| {
        read::read(&name, &bytes, &VectorHints { crs: None, layer, companions: &beside })
    };
    let wrong = |error: VectorError| CliError::input(format!("{}: {error}", file.display()));
    match read(None) {
        Ok(layer) => Ok(vec![surveyed(Arc::new(layer), None, &name)]),
        Err(VectorError::WhichLayer { names, .. }) => {
            let layers = distinct(names).into_iter().map(|layer| {
                let content = read(Some(&layer)).map_err(wrong)?;
                Ok(surveyed(Arc::new(content), Some(layer.clone()), &layer))
            });
            layers.collect::<Result<_, _>>().map(without_repeats)
        }
        Err(error) => Err(wrong(error)),
    }
}

/// The layers of one file without what another of them is named after: the schools of a file with all buildings are
/// among these.
fn without_repeats(mut layers: Vec<SurveyedLayer>) -> Vec<SurveyedLayer> {
    let named_after = |layer: &SurveyedLayer, rule: &TableRule| {
        let called = layer.layer.as_deref().unwrap_or_default().to_lowercase();
        rule.names.iter().any(|name| called.contains(name))
    };
    for rule in &RULES {
        let takes = |layer: &SurveyedLayer| layer.found.iter().any(|found| found.rule.what == rule.what);
        if layers.iter().any(|layer| named_after(layer, rule) && takes(layer)) {
            for layer in layers.iter_mut().filter(|layer| !named_after(layer, rule)) {
                layer.found.retain(|found| found.rule.what != rule.what);
            }
        }
    }
    layers
}

/// Those of the layers that hold different features: of OpenStreetMap's the whole ones, not the excerpts of them; of
/// GPX not the single points of lines.
fn distinct(names: Vec<String>) -> Vec<String> {
    const OSM: [&str; 3] = ["points", "lines", "multipolygons"];
    const GPX_POINTS: [&str; 2] = ["route_points", "track_points"];
    let has = |wanted: &str| names.iter().any(|name| name == wanted);
    let osm = OSM.iter().all(|layer| has(layer));
    let kept = |name: &String| !osm || OSM.contains(&name.as_str());
    names.iter().filter(|name| kept(name) && !GPX_POINTS.contains(&name.as_str())).cloned().collect()
}

fn surveyed(layer: Arc<VectorLayer>, name: Option<String>, called: &str) -> SurveyedLayer {
    let mut taken = vec![false; layer.features.len()];
    let mut found = Vec::new();
    for rule in &RULES {
        let condition =
            Expression::parse(rule.condition).expect("the rules are expressions, as a test shows");
        let mut count = 0;
        for (index, feature) in layer.features.iter().enumerate() {
            let takes = is_shaped(&feature.geometry, rule.shape)
                && Attributes::new(Arc::clone(&layer), index).holds(&condition);
            if takes {
                taken[index] = true;
                count += 1;
            }
        }
        if count > 0 {
            let chosen = if count == layer.features.len() { Chosen::All } else { Chosen::ByRule };
            found.push(TableMatch { rule, count, chosen });
        }
    }
    if found.is_empty() {
        found.extend(by_name(&layer, called));
        if let Some(found) = found.first() {
            let shaped = |index: usize| is_shaped(&layer.features[index].geometry, found.rule.shape);
            (0..taken.len()).filter(|&index| shaped(index)).for_each(|index| taken[index] = true);
        }
    }
    let rest = ["lines", "polygons", "points"].map(|kind| {
        let left =
            |(index, taken): &(usize, &bool)| !**taken && layer.features[*index].geometry.kind() == kind;
        (kind, taken.iter().enumerate().filter(left).count())
    });
    SurveyedLayer { layer: name, found, rest: rest.into_iter().filter(|rest| rest.1 > 0).collect() }
}

/// Whether a scene takes the shape where it wants `wanted`.
fn is_shaped(geometry: &Geometry, wanted: &str) -> bool {
    geometry.kind() == wanted
}

/// The table that a layer's name speaks of.
fn by_name(layer: &VectorLayer, called: &str) -> Option<TableMatch> {
    let called = called.to_lowercase();
    RULES.iter().find_map(|rule| {
        let count = layer.features.iter().filter(|feature| is_shaped(&feature.geometry, rule.shape)).count();
        let spoken_of = rule.names.iter().any(|name| called.contains(name));
        (count > 0 && spoken_of).then_some(TableMatch { rule, count, chosen: Chosen::All })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::description::parse::parse;

    #[test]
    fn every_rule_makes_a_table_that_is_understood() {
        for rule in &RULES {
            let width = rule.width.map(|width| format!("width = {width}\n")).unwrap_or_default();
            let table = format!(
                "[terrain]\ndem = \"a\"\n[[{}]]\nfile = \"b\"\nwhere = {}\n{width}{}\n",
                rule.table,
                serde_json::Value::from(rule.condition),
                rule.keys.join("\n")
            );
            parse("rule.toml", &table).unwrap_or_else(|errors| panic!("{errors}"));
        }
    }

    #[test]
    fn of_openstreetmap_the_whole_layers_are_taken() {
        let names = ["points", "lines", "multipolygons", "roads", "water"].map(String::from).to_vec();
        assert_eq!(distinct(names), ["points", "lines", "multipolygons"]);
        assert_eq!(distinct(vec!["roads".into(), "water".into()]), ["roads", "water"]);
    }
}
