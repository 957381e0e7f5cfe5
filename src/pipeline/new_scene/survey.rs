//! A survey of vector files: which tables of a scene file could take their features.
//!
//! Each [`TableRule`] is a table that could be written, with the expression that selects its features. The expression
//! is evaluated for every feature, so that the counts are those of the scene, and no table is written that selects
//! nothing. Where no rule matches a layer, its name may still say what it holds.

use std::path::Path;
use std::sync::Arc;

use glam::DVec2;

use crate::description::expression::Expression;
use crate::geom::crs::Crs;
use crate::geom::rect::Rect;
use crate::pipeline::error::FileError;
use crate::pipeline::files::{self, ReadFileError};
use crate::scene::attributes::Attributes;
use crate::vector::error::VectorError;
use crate::vector::feature::{Geometry, VectorLayer};
use crate::vector::hints::VectorHints;
use crate::vector::read;

/// One layer of a file.
pub(super) struct SurveyedLayer {
    /// Its name in a scene file; `None` where the file has one layer.
    pub name: Option<String>,
    /// The tables that take something from it, in drawing order.
    pub matches: Vec<TableMatch>,
    /// Features that no table takes: `lines`, `polygons` or `points`, and how many.
    pub rest: Vec<(&'static str, usize)>,
    /// Its coordinate system.
    pub crs: Crs,
    /// Corners and middles of the sides of the box of its features, in its system; none where it has no feature.
    pub corners: Vec<DVec2>,
}

/// A table and how many features it takes.
pub(super) struct TableMatch {
    pub rule: &'static TableRule,
    pub count: usize,
    pub selection: FeatureSelection,
}

/// Which features of a layer a table takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum FeatureSelection {
    /// Those for which the rule's condition holds.
    ByCondition,
    /// All.
    All,
}

/// A table that may be written.
pub(super) struct TableRule {
    pub table: &'static str,
    /// The kind of its features.
    pub what: &'static str,
    /// Their shape, as [`Geometry::kind`] names it.
    pub shape: &'static str,
    /// The expression that selects them.
    pub condition: &'static str,
    /// The width in meters of features that are drawn to scale.
    pub width_m: Option<f64>,
    /// Further keys as they are written.
    pub keys: &'static [&'static str],
    /// Parts of the name of a layer or a file that holds nothing else.
    pub names: &'static [&'static str],
}

/// A vector file that cannot be surveyed.
#[derive(Debug, thiserror::Error)]
pub enum SurveyError {
    /// The file cannot be read.
    #[error(transparent)]
    File(#[from] ReadFileError),
    /// The file is not one that is read.
    #[error(transparent)]
    Vector(#[from] FileError<VectorError>),
}

/// The rules in the order in which tables are written: what lies lower first.
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
        width_m: None,
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
        width_m: None,
        keys: &["level_rule = \"lowest\""],
        names: &["lake", "water", "reservoir"],
    },
    TableRule {
        table: "river",
        what: "Streams",
        shape: "lines",
        condition: "waterway in ('stream', 'ditch', 'drain', 'brook')",
        width_m: Some(3.0),
        keys: &[],
        names: &["stream", "creek"],
    },
    TableRule {
        table: "river",
        what: "Rivers",
        shape: "lines",
        condition: "waterway in ('river', 'canal')",
        width_m: Some(12.0),
        keys: &[],
        names: &["river", "waterway"],
    },
    TableRule {
        table: "road",
        what: "Tracks and paths",
        shape: "lines",
        condition: "highway in ('track', 'path', 'footway', 'cycleway', 'bridleway', 'steps')",
        width_m: Some(2.5),
        keys: &["surface = \"track\""],
        names: &["track", "trail", "path"],
    },
    TableRule {
        table: "road",
        what: "Streets",
        shape: "lines",
        condition: "highway in ('unclassified', 'residential', 'living_street', 'pedestrian', 'service', 'road')",
        width_m: Some(5.0),
        keys: &["surface = \"if(surface in ('unpaved', 'gravel', 'dirt', 'ground'), 'gravel', 'asphalt')\""],
        names: &["road", "street"],
    },
    TableRule {
        table: "road",
        what: "Country roads",
        shape: "lines",
        condition: "highway in ('secondary', 'secondary_link', 'tertiary', 'tertiary_link')",
        width_m: Some(7.0),
        keys: &["surface = \"if(surface in ('unpaved', 'gravel', 'dirt', 'ground'), 'gravel', 'asphalt')\""],
        names: &[],
    },
    TableRule {
        table: "road",
        what: "Main roads",
        shape: "lines",
        condition: "highway in ('motorway', 'motorway_link', 'trunk', 'trunk_link', 'primary', 'primary_link')",
        width_m: Some(10.0),
        keys: &["surface = \"asphalt\""],
        names: &["highway"],
    },
    TableRule {
        table: "building",
        what: "Buildings",
        shape: "polygons",
        condition: "building",
        width_m: None,
        keys: &["height = \"height ?? `building:levels` * 3 ?? levels * 3 ?? 6\""],
        names: &["building", "footprint", "house"],
    },
    TableRule {
        table: "fence",
        what: "Fences, walls and hedges",
        shape: "lines",
        condition: "barrier in ('fence', 'wall', 'hedge', 'city_wall', 'retaining_wall')",
        width_m: None,
        keys: &["kind = \"match(barrier, 'fence', 'fence', 'hedge', 'hedge', 'wall')\""],
        names: &["fence"],
    },
    TableRule {
        table: "fence",
        what: "Power lines",
        shape: "lines",
        condition: "power in ('line', 'minor_line')",
        width_m: None,
        keys: &["kind = \"power-line\""],
        names: &["power"],
    },
    TableRule {
        table: "fence",
        what: "Boundaries",
        shape: "lines",
        condition: "boundary = 'administrative' and not highway and not waterway",
        width_m: None,
        keys: &["kind = \"boundary\""],
        names: &["boundar", "border"],
    },
];

/// Surveys each layer of a vector file.
///
/// # Errors
/// See [`SurveyError`].
pub(super) fn layers(file: &Path) -> Result<Vec<SurveyedLayer>, SurveyError> {
    let bytes = files::read(file)?;
    let name = files::file_name(file);
    let companions = files::beside(file);
    let read = |layer: Option<&str>| {
        read::read(&name, &bytes, &VectorHints { crs: None, layer, companions: &companions })
    };
    let vector = FileError::<VectorError>::at(file);
    match read(None) {
        Ok(layer) => Ok(vec![survey(Arc::new(layer), None, &name)]),
        Err(VectorError::WhichLayer { names, .. }) => {
            let layers = distinct(names).into_iter().map(|name| {
                let layer = read(Some(&name)).map_err(&vector)?;
                Ok(survey(Arc::new(layer), Some(name.clone()), &name))
            });
            layers.collect::<Result<_, _>>().map(without_excerpts)
        }
        Err(error) => Err(vector(error).into()),
    }
}

/// The layers of one file without the matches that another layer is named after: of a file with a layer of all
/// buildings, the schools are among them.
fn without_excerpts(mut layers: Vec<SurveyedLayer>) -> Vec<SurveyedLayer> {
    for rule in &RULES {
        let is_named_after =
            |layer: &SurveyedLayer| rule.is_named_in(layer.name.as_deref().unwrap_or_default());
        let takes = |layer: &SurveyedLayer| layer.matches.iter().any(|found| found.rule.what == rule.what);
        if layers.iter().any(|layer| is_named_after(layer) && takes(layer)) {
            for layer in layers.iter_mut().filter(|layer| !is_named_after(layer)) {
                layer.matches.retain(|found| found.rule.what != rule.what);
            }
        }
    }
    layers
}

/// The layers that hold different features: of OpenStreetMap the complete ones without their excerpts, of GPX not the
/// single points of lines.
fn distinct(names: Vec<String>) -> Vec<String> {
    const OSM: [&str; 3] = ["points", "lines", "multipolygons"];
    const GPX_POINTS: [&str; 2] = ["route_points", "track_points"];
    let is_osm = OSM.iter().all(|layer| names.iter().any(|name| name == layer));
    let is_kept = |name: &str| (!is_osm || OSM.contains(&name)) && !GPX_POINTS.contains(&name);
    names.into_iter().filter(|name| is_kept(name)).collect()
}

/// Surveys a layer; `title` is its own name or that of its file.
fn survey(layer: Arc<VectorLayer>, name: Option<String>, title: &str) -> SurveyedLayer {
    let mut taken = vec![false; layer.features.len()];
    let mut matches = Vec::new();
    for rule in &RULES {
        let condition = Expression::parse(rule.condition).expect("a test parses every condition");
        let takes = |&index: &usize| {
            rule.fits(&layer.features[index].geometry)
                && Attributes::new(Arc::clone(&layer), index).holds(&condition)
        };
        let indices: Vec<usize> = (0..taken.len()).filter(takes).collect();
        let count = indices.len();
        indices.into_iter().for_each(|index| taken[index] = true);
        let selection =
            if count == taken.len() { FeatureSelection::All } else { FeatureSelection::ByCondition };
        matches.extend((count > 0).then_some(TableMatch { rule, count, selection }));
    }
    if let (true, Some(found)) = (matches.is_empty(), match_by_name(&layer, title)) {
        taken = layer.features.iter().map(|feature| found.rule.fits(&feature.geometry)).collect();
        matches.push(found);
    }
    let rest = ["lines", "polygons", "points"].map(|kind| {
        let left = layer.features.iter().zip(&taken).filter(|(_, taken)| !**taken);
        (kind, left.filter(|(feature, _)| feature.geometry.kind() == kind).count())
    });
    let bounds = Rect::around(layer.features.iter().flat_map(|feature| feature.geometry.vertices().copied()));
    let corners = if bounds.is_empty() { Vec::new() } else { bounds.grid_points().collect() };
    let rest = rest.into_iter().filter(|rest| rest.1 > 0).collect();
    SurveyedLayer { name, matches, rest, crs: layer.crs.clone(), corners }
}

/// The table that the name of a layer suggests.
fn match_by_name(layer: &VectorLayer, title: &str) -> Option<TableMatch> {
    RULES.iter().filter(|rule| rule.is_named_in(title)).find_map(|rule| {
        let count = layer.features.iter().filter(|feature| rule.fits(&feature.geometry)).count();
        (count > 0).then_some(TableMatch { rule, count, selection: FeatureSelection::All })
    })
}

impl TableRule {
    fn fits(&self, geometry: &Geometry) -> bool {
        geometry.kind() == self.shape
    }

    fn is_named_in(&self, title: &str) -> bool {
        let title = title.to_lowercase();
        self.names.iter().any(|name| title.contains(name))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::description::parse::parse;

    #[test]
    fn every_rule_makes_a_table_that_is_understood() {
        for rule in &RULES {
            let width = rule.width_m.map(|width_m| format!("width = {width_m}\n")).unwrap_or_default();
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
    fn of_openstreetmap_the_complete_layers_are_taken() {
        let names = ["points", "lines", "multipolygons", "roads", "water"].map(String::from).to_vec();
        assert_eq!(distinct(names), ["points", "lines", "multipolygons"]);
        assert_eq!(distinct(vec!["roads".into(), "water".into()]), ["roads", "water"]);
    }
}
