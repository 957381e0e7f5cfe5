//! A survey of vector files: which tables of a scene file could take their features.
//!
//! Each [`TableRule`] is a table that could be written, with the expression that selects its features. The expression
//! is evaluated for every feature, so that the counts are those of the scene, and no table is written that selects
//! nothing. Where no rule matches a layer, its name may still say what it holds. The names of places and districts are
//! kept, since one of them may be the scene's title.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::ptr;
use std::sync::Arc;

use glam::DVec2;
use serde_json::Value;

use crate::buildings::SurveyedBuildings;
use crate::named::{NamedArea, NamedDistrict, NamedPlace, districts, named_place, names, only_area, parks};
use crate::rules::{BOUNDARIES, NAMES, PEAKS, RULES, TableRule};
use sandtable_base::limits::{ASSET_BYTES, COMPANION_BYTES};
use sandtable_dem::hints::DemHints;
use sandtable_dem::tiff::windows::is_tiff;
use sandtable_description::expression::Expression;
use sandtable_files::addressed;
use sandtable_files::disk::{self, ReadFileError};
use sandtable_files::error::FileError;
use sandtable_geom::crs::Crs;
use sandtable_geom::polygon;
use sandtable_scene::attributes::Attributes;
use sandtable_scene::class_raster::{ClassRaster, ClassRasterError, SampledLegend};
use sandtable_vector::error::VectorError;
use sandtable_vector::feature::{Feature, Geometry, VectorLayer};
use sandtable_vector::hints::VectorHints;
use sandtable_vector::read;

/// One layer of a file.
pub(super) struct SurveyedLayer {
    /// Its name in a scene file; `None` where the file has one layer.
    pub name: Option<String>,
    /// The tables that take something from it, in drawing order.
    pub matches: Vec<TableMatch>,
    /// Features that no table takes, by shape.
    pub rest: Vec<LeftFeatures>,
    /// The names of cities, towns and the like.
    pub places: Vec<NamedPlace>,
    /// Districts with administrative boundaries.
    pub districts: Vec<NamedDistrict>,
    /// Vertices of its coasts, up to [`MOST_COAST`], in its system.
    pub coast: Vec<DVec2>,
    /// Whether its features have the property `fclass` of Geofabrik's shapefiles.
    pub has_fclass: bool,
    /// Its coordinate system.
    pub crs: Crs,
    /// Segments of the features that tables draw, boundaries and coasts apart, in its system, and points as segments without length;
    /// of all features where there are none of these. Evenly chosen, up to [`MOST_SEGMENTS`].
    pub segments: Vec<[DVec2; 2]>,
    /// Whether any of these segments meets the ground, once that is known.
    pub is_on_ground: bool,
    /// Its buildings; `None` where it has none.
    pub buildings: Option<SurveyedBuildings>,
    /// The likely height of buildings that tell none, meters, once the scene's system is known.
    pub building_height_m: Option<f64>,
    /// Peaks with names.
    pub peaks: Vec<NamedPlace>,
    /// Parks with names.
    pub parks: Vec<NamedArea>,
    /// The area of a layer that holds one named area and nothing else, of no known kind.
    pub only_area: Option<NamedArea>,
    /// Names of features of any kind, up to [`MOST_NAMES`].
    pub names: Vec<String>,
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

/// The features of one shape that no table takes.
pub(super) struct LeftFeatures {
    /// `lines`, `polygons` or `points`.
    pub kind: &'static str,
    pub count: usize,
    /// The property that most likely names them; `None` where none does.
    pub name_property: Option<String>,
    /// The [`MOST_EXAMPLES`] properties that most of them have, each with a value.
    pub examples: Vec<(String, Value)>,
}

/// As many segments tell where the features of a layer lie: more would only take longer.
const MOST_SEGMENTS: usize = 1 << 15;

/// As many properties as a reader looks over.
const MOST_EXAMPLES: usize = 12;

/// As many vertices of a coast say whether it runs through a model: a coast is long.
const MOST_COAST: usize = 4096;

/// A vector file that cannot be surveyed.
#[derive(Debug, thiserror::Error)]
pub enum SurveyError {
    /// The file cannot be read.
    #[error(transparent)]
    File(#[from] ReadFileError),
    /// The file is not one that is read.
    #[error(transparent)]
    Vector(#[from] FileError<VectorError>),
    /// The file is a raster, but none of land cover.
    #[error(transparent)]
    LandCover(#[from] Box<ClassRasterError>),
}

/// The classification of a raster of land cover, or of that at an address; `None` of a file that is no TIFF.
///
/// # Errors
/// See [`SurveyError`]: the file holds other values than classes, too.
pub(super) fn land_cover(file: &Path) -> Result<Option<SampledLegend>, SurveyError> {
    let (head, content) = addressed::open(file)?;
    if !is_tiff(&head) {
        return Ok(None);
    }
    let companions = addressed::companions(file, COMPANION_BYTES.get());
    let hints = DemHints { companions: &|name| companions.get(name), ..DemHints::default() };
    let raster = ClassRaster::of_content(&disk::file_name(file), content, &hints);
    companions.check()?;
    let legend = raster.and_then(|mut raster| raster.sampled_legend());
    Ok(Some(legend.map_err(Box::new)?))
}

/// Surveys each layer of a vector file, or of that at an address.
///
/// # Errors
/// See [`SurveyError`].
pub(super) fn layers(file: &Path) -> Result<Vec<SurveyedLayer>, SurveyError> {
    let bytes = addressed::read(file, ASSET_BYTES.get())?;
    let name = disk::file_name(file);
    let companions = addressed::companions(file, ASSET_BYTES.get());
    let found = |name: &str| companions.get(name);
    let read = |layer: Option<&str>| {
        read::read(&name, &bytes, &VectorHints { layer, companions: &found, ..VectorHints::default() })
    };
    let vector = FileError::<VectorError>::at(file);
    let surveyed = match read(None) {
        Ok(layer) => Ok(vec![survey(Arc::new(layer), None, &name)]),
        Err(VectorError::WhichLayer { names, .. }) => {
            let layers = distinct(names).into_iter().map(|name| {
                let layer = read(Some(&name)).map_err(&vector)?;
                Ok(survey(Arc::new(layer), Some(name.clone()), &name))
            });
            layers.collect::<Result<_, _>>().map(without_excerpts)
        }
        Err(error) => Err(vector(error).into()),
    };
    companions.check()?;
    surveyed
}

/// All features of a file of units and graphics.
///
/// # Errors
/// See [`SurveyError`].
pub(super) fn read_whole(file: &Path) -> Result<VectorLayer, SurveyError> {
    let bytes = addressed::read(file, ASSET_BYTES.get())?;
    let companions = addressed::companions(file, ASSET_BYTES.get());
    let found = |name: &str| companions.get(name);
    let hints = VectorHints { companions: &found, ..VectorHints::default() };
    let layer = read::read(&disk::file_name(file), &bytes, &hints);
    companions.check()?;
    Ok(layer.map_err(FileError::<VectorError>::at(file))?)
}

/// The layers of one file without the matches that another layer is named after: of a file with a layer of all
/// buildings, the schools are among them.
fn without_excerpts(mut layers: Vec<SurveyedLayer>) -> Vec<SurveyedLayer> {
    for rule in RULES {
        let is_named_after =
            |layer: &SurveyedLayer| rule.is_named_in(layer.name.as_deref().unwrap_or_default());
        let takes = |layer: &SurveyedLayer| layer.matches.iter().any(|found| ptr::eq(found.rule, rule));
        if layers.iter().any(|layer| is_named_after(layer) && takes(layer)) {
            for layer in layers.iter_mut().filter(|layer| !is_named_after(layer)) {
                layer.matches.retain(|found| !ptr::eq(found.rule, rule));
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
    // What the scene is about: not what no table takes, nor boundaries and coasts, which lead far away, nor distant names.
    let mut around = vec![false; layer.features.len()];
    let mut built = vec![false; layer.features.len()];
    let mut of_coast = vec![false; layer.features.len()];
    let mut peaks = Vec::new();
    let mut matches = Vec::new();
    let mut places = Vec::new();
    for rule in RULES {
        let condition = Expression::parse(rule.condition).expect("a test parses every condition");
        let takes = |&index: &usize| {
            fits(rule, &layer.features[index].geometry)
                && Attributes::new(Arc::clone(&layer), index).holds(&condition)
        };
        let indices: Vec<usize> = (0..taken.len()).filter(takes).collect();
        let count = indices.len();
        if let Some(label) = rule.label.as_ref().filter(|label| label.is_title) {
            places.extend(indices.iter().filter_map(|&index| named_place(&layer, index, label)));
        }
        if let Some(label) = rule.label.as_ref().filter(|_| rule.what == PEAKS) {
            peaks.extend(indices.iter().filter_map(|&index| named_place(&layer, index, label)));
        }
        if rule.table == "building" {
            indices.iter().for_each(|&index| built[index] = true);
        }
        if rule.table == "coast" {
            indices.iter().for_each(|&index| of_coast[index] = true);
        }
        let leads_away = rule.what == BOUNDARIES || rule.table == "coast";
        if !leads_away && rule.label.is_none() {
            indices.iter().for_each(|&index| around[index] = true);
        }
        indices.into_iter().for_each(|index| taken[index] = true);
        let selection =
            if count == taken.len() { FeatureSelection::All } else { FeatureSelection::ByCondition };
        matches.extend((count > 0).then_some(TableMatch { rule, count, selection }));
    }
    if let (true, Some(found)) = (matches.is_empty(), match_by_name(&layer, title)) {
        taken = layer.features.iter().map(|feature| fits(found.rule, &feature.geometry)).collect();
        if found.rule.table == "building" {
            built.clone_from(&taken);
        }
        if found.rule.table == "coast" {
            of_coast.clone_from(&taken);
        }
        matches.push(found);
    }
    let left = layer.features.iter().zip(&taken).filter(|(_, taken)| !**taken).map(|(feature, _)| feature);
    let left: Vec<&Feature> = left.collect();
    let rest = ["lines", "polygons", "points"].into_iter().filter_map(|kind| left_features(&left, kind));
    let rest = rest.collect();
    let is_around = |index: usize| around[index] || !(around.contains(&true) || of_coast[index]);
    let shown = layer.features.iter().enumerate().filter(|(index, _)| is_around(*index));
    let segments = segments(&shown.map(|(_, feature)| &feature.geometry).collect::<Vec<_>>());
    let (parks, names) = (parks(&layer), names(&layer));
    let only_area = only_area(&layer).filter(|_| matches.is_empty());
    let built = || layer.features.iter().zip(&built).filter(|(_, built)| **built).map(|(feature, _)| feature);
    let buildings = built().next().map(|_| SurveyedBuildings::new(built()));
    let districts = districts(&layer);
    let coast =
        coast(layer.features.iter().zip(&of_coast).filter(|(_, of)| **of).map(|(feature, _)| feature));
    let has_fclass = layer.features.iter().any(|feature| feature.properties.contains_key("fclass"));
    let crs = layer.crs.clone();
    SurveyedLayer {
        name,
        matches,
        rest,
        places,
        districts,
        coast,
        has_fclass,
        crs,
        segments,
        is_on_ground: false,
        buildings,
        building_height_m: None,
        peaks,
        parks,
        only_area,
        names,
    }
}

/// Evenly chosen segments of lines and outlines, and points as segments without length.
fn segments(shapes: &[&Geometry]) -> Vec<[DVec2; 2]> {
    let all = || shapes.iter().flat_map(|shape| segments_of(shape));
    let step = all().count().div_ceil(MOST_SEGMENTS).max(1);
    all().step_by(step).collect()
}

fn segments_of(shape: &Geometry) -> Box<dyn Iterator<Item = [DVec2; 2]> + '_> {
    fn course(points: &[DVec2]) -> impl Iterator<Item = [DVec2; 2]> + '_ {
        points.windows(2).map(|ends| [ends[0], ends[1]])
    }
    match shape {
        Geometry::Points(points) => Box::new(points.iter().map(|&at| [at, at])),
        Geometry::Lines(lines) => Box::new(lines.iter().flat_map(|line| course(line))),
        Geometry::Polygons(polygons) => Box::new(
            polygons
                .iter()
                .flat_map(|polygon| polygon::edges(&polygon.exterior))
                .map(|(from, to)| [from, to]),
        ),
    }
}

/// Evenly chosen vertices of coasts.
fn coast<'a>(coasts: impl Iterator<Item = &'a Feature> + Clone) -> Vec<DVec2> {
    let vertices = || coasts.clone().flat_map(|feature| feature.geometry.vertices());
    let step = vertices().count().div_ceil(MOST_COAST).max(1);
    vertices().step_by(step).copied().collect()
}

/// The table that the name of a layer suggests.
fn match_by_name(layer: &VectorLayer, title: &str) -> Option<TableMatch> {
    RULES.iter().filter(|rule| rule.is_named_in(title)).find_map(|rule| {
        let count = layer.features.iter().filter(|feature| fits(rule, &feature.geometry)).count();
        (count > 0).then_some(TableMatch { rule, count, selection: FeatureSelection::All })
    })
}

fn fits(rule: &TableRule, geometry: &Geometry) -> bool {
    geometry.kind() == rule.shape
}

/// The features of a shape among those `left`, with the properties that most of them have, each with its first value;
/// `None` where there are none.
fn left_features(left: &[&Feature], kind: &'static str) -> Option<LeftFeatures> {
    let of_kind = || left.iter().filter(|feature| feature.geometry.kind() == kind);
    let mut found: BTreeMap<&str, (usize, &Value)> = BTreeMap::new();
    for (name, value) in of_kind().flat_map(|feature| &feature.properties) {
        let says_something = match value {
            Value::String(text) => !text.trim().is_empty(),
            Value::Number(_) | Value::Bool(_) => true,
            _ => false,
        };
        if says_something {
            found.entry(name).or_insert((0, value)).0 += 1;
        }
    }
    let mut found: Vec<_> = found.into_iter().collect();
    // Stable: by name where equally many have them.
    found.sort_by_key(|(_, (count, _))| std::cmp::Reverse(*count));
    let example = |(name, (_, value)): (&str, (usize, &Value))| (name.to_owned(), value.clone());
    let examples = found.into_iter().take(MOST_EXAMPLES).map(example).collect();
    let count = of_kind().count();
    let name_property = name_property(&of_kind().copied().collect::<Vec<_>>());
    (count > 0).then_some(LeftFeatures { kind, count, name_property, examples })
}

/// The property that most likely names features: one of [`NAMES`], one whose own name says so, or that whose texts differ
/// most from feature to feature.
fn name_property(features: &[&Feature]) -> Option<String> {
    /// The least share of features with a text of its own.
    const LEAST_DISTINCT: f64 = 0.8;
    /// Longer texts are notes.
    const LONGEST: usize = 40;
    let mut texts: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
    for (key, value) in features.iter().flat_map(|feature| &feature.properties) {
        if let Some(text) = value.as_str().map(str::trim).filter(|text| !text.is_empty()) {
            texts.entry(key).or_default().insert(text);
        }
    }
    let is_short = |texts: &BTreeSet<&str>| texts.iter().all(|text| text.chars().count() <= LONGEST);
    let is_name = |key: &str| {
        let key = key.to_lowercase();
        ["name", "nom", "label", "title"].iter().any(|word| key.contains(word))
    };
    let keys = || texts.iter().filter(|(_, texts)| is_short(texts)).map(|(key, _)| *key);
    let distinct = || {
        let of_own = texts.iter().filter(|(key, texts)| {
            let is_code = key.to_lowercase().ends_with("id")
                || texts.iter().any(|text| !text.contains(char::is_alphabetic));
            !is_code && is_short(texts) && texts.len() as f64 >= features.len() as f64 * LEAST_DISTINCT
        });
        of_own.max_by_key(|(_, texts)| texts.len()).map(|(key, _)| *key)
    };
    let known = NAMES.into_iter().find(|name| keys().any(|key| key == *name));
    known.or_else(|| keys().find(|key| is_name(key))).or_else(distinct).map(str::to_owned)
}

#[cfg(test)]
mod tests {
    use super::*;
    use sandtable_vector::feature::Polygon;

    #[test]
    fn of_openstreetmap_the_complete_layers_are_taken() {
        let names = ["points", "lines", "multipolygons", "roads", "water"].map(String::from).to_vec();
        assert_eq!(distinct(names), ["points", "lines", "multipolygons"]);
        assert_eq!(distinct(vec!["roads".into(), "water".into()]), ["roads", "water"]);
    }

    /// The tables that take something from a layer of features of one shape with these properties: what they are and how
    /// many they take, and how many features are left.
    fn surveyed(title: &str, kind: &str, properties: &[&str]) -> (Vec<(&'static str, usize)>, usize) {
        let corners = [DVec2::ZERO, DVec2::X, DVec2::Y];
        let feature = |properties: &&str| Feature {
            geometry: match kind {
                "points" => Geometry::Points(vec![DVec2::ZERO]),
                "lines" => Geometry::Lines(vec![corners.to_vec()]),
                _ => Geometry::Polygons(vec![Polygon { exterior: corners.to_vec(), holes: Vec::new() }]),
            },
            elevations: None,
            properties: serde_json::from_str(properties).expect("an object"),
        };
        let features = properties.iter().map(feature).collect();
        let layer = VectorLayer { features, crs: Crs::wgs84(), notes: Vec::new(), faults: Vec::new() };
        let found = survey(Arc::new(layer), None, title);
        let left = found.rest.iter().map(|rest| rest.count).sum();
        (found.matches.iter().map(|found| (found.rule.what, found.count)).collect(), left)
    }

    #[test]
    fn the_schemas_of_many_countries_are_recognized() {
        type Case =
            (&'static str, &'static str, &'static [&'static str], &'static [(&'static str, usize)], usize);
        let cases: [Case; 17] = [
            (
                "gis_osm_roads_free_1",
                "lines",
                &[r#"{"fclass": "primary"}"#, r#"{"fclass": "track_grade3"}"#, r#"{"fclass": "busway"}"#],
                &[("Tracks and paths", 1), ("Main roads", 1)],
                1,
            ),
            ("gis_osm_landuse", "polygons", &[r#"{"fclass": "forest"}"#], &[("Land cover", 1)], 0),
            (
                "bgt_wegdeel",
                "polygons",
                &[r#"{"bgt_functie": "fietspad", "bgt_fysiekvoorkomen": "erf"}"#],
                &[("Carriageways and paths as areas (BGT)", 1)],
                0,
            ),
            (
                "bgt_waterdeel",
                "polygons",
                &[r#"{"bgt_type": "waterloop"}"#, r#"{"bgt_type": "greppel, droge sloot"}"#],
                &[("Water (BGT)", 1)],
                1,
            ),
            (
                "bgt_begroeidterreindeel",
                "polygons",
                &[r#"{"bgt_fysiekvoorkomen": "loofbos"}"#],
                &[("Plant cover (BGT)", 1)],
                0,
            ),
            ("onbegroeidterreindeel", "polygons", &[r#"{"oms": 1}"#], &[("Bare ground (BGT)", 1)], 0),
            ("pand", "polygons", &[r#"{"identificatieBAGPND": "0344"}"#], &[("Buildings (BGT, BAG)", 1)], 0),
            (
                "tl_2023_08031_roads",
                "lines",
                &[
                    r#"{"MTFCC": "S1100"}"#,
                    r#"{"MTFCC": "S1400"}"#,
                    r#"{"MTFCC": "S1500"}"#,
                    r#"{"MTFCC": "R1011"}"#,
                ],
                &[("Trails (TIGER)", 1), ("Streets (TIGER)", 1), ("Main roads (TIGER)", 1)],
                1,
            ),
            ("linearwater", "lines", &[r#"{"MTFCC": "H3010"}"#], &[("Streams and rivers (TIGER)", 1)], 0),
            (
                "areawater",
                "polygons",
                &[r#"{"MTFCC": "H2030"}"#, r#"{"MTFCC": "H3010"}"#],
                &[("Lakes (TIGER)", 1)],
                1,
            ),
            (
                "RoadLink",
                "lines",
                &[r#"{"class": "A Road"}"#, r#"{"class": "B Road"}"#, r#"{"class": "Unknown"}"#],
                &[("Streets (OS)", 1), ("Country roads (OS)", 1), ("Main roads (OS)", 1)],
                0,
            ),
            ("Road", "lines", &[r#"{"CLASSIFICA": "Local Street"}"#], &[("Streets (OS)", 1)], 0),
            (
                "WatercourseLink",
                "lines",
                &[r#"{"form": "inlandRiver"}"#, r#"{"form": "lake"}"#],
                &[("Watercourses (OS)", 1)],
                1,
            ),
            ("SU_Woodland", "polygons", &[r#"{"FEATCODE": 15400}"#], &[("Woods", 1)], 0),
            (
                "TRONCON_DE_ROUTE",
                "lines",
                &[r#"{"NATURE": "Chemin"}"#, r#"{"NATURE": "Route à 1 chaussée", "LARGEUR": 4.5}"#],
                &[("Tracks and paths (BD TOPO)", 1), ("Roads (BD TOPO)", 1)],
                0,
            ),
            (
                "TRONCON_HYDROGRAPHIQUE",
                "lines",
                &[r#"{"NATURE": "Ecoulement naturel"}"#],
                &[("Watercourses (BD TOPO)", 1)],
                0,
            ),
            (
                "BATIMENT",
                "polygons",
                &[r#"{"NATURE": "Indifférenciée", "HAUTEUR": 7.5}"#],
                &[("Buildings (BD TOPO)", 1)],
                0,
            ),
        ];
        for (title, kind, properties, wanted, left) in cases {
            assert_eq!(surveyed(title, kind, properties), (wanted.to_vec(), left), "{title}");
        }
    }

    #[test]
    fn no_two_rules_take_the_same_feature_or_its_name() {
        let is_name = |what: &str| RULES.iter().any(|rule| rule.what == what && rule.label.is_some());
        let values = RULES.iter().flat_map(|rule| rule.condition.split('\'').skip(1).step_by(2));
        for value in values {
            let rules = |property: &str| {
                let properties = serde_json::json!({ property: value, "name": "a", "NAME": "a" }).to_string();
                ["points", "lines", "polygons"].map(|kind| surveyed("", kind, &[&properties]).0)
            };
            for property in
                ["highway", "fclass", "nature", "class", "MTFCC", "place", "bgt_fysiekvoorkomen", "form"]
            {
                for taken in rules(property) {
                    let names = taken.iter().filter(|(what, _)| is_name(what)).count();
                    assert!(names <= 1 && taken.len() - names <= 1, "{property} = {value}: {taken:?}");
                }
            }
        }
    }
}
