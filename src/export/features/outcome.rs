//! The outcome of an analysis as a file of features: its points, lines and areas, or the outlines of its classes.

use std::path::{Path, PathBuf};

use glam::{DVec2, DVec3, IVec2};
use serde_json::{Map, Value};

use super::{
    ExportFeature, ExportKind, ExportLayer, ExportShape, ExportedFeatures, FeatureExportError, FeatureFormat,
    LayerLook, MadeFile, bring_to, geopackage, json,
};
use sandtable_analysis::outcome::{
    ClassLook, FeatureRole, Outcome, OutcomeFeature, OutcomeRaster, OutcomeShape, PropertyValue, ValueClass,
};
use sandtable_draw::color::Srgba;
use sandtable_files::disk;
use sandtable_files::output_files::OutputFiles;
use sandtable_geom::cell_outlines::cell_outlines;
use sandtable_geom::crs::Crs;
use sandtable_terrain::lattice::Lattice;

/// The width of lines of a layer, millimeters.
const WIDTH_MM: f32 = 0.5;

/// The ground and the system of an outcome.
#[derive(Clone, Copy)]
pub struct OutcomeFrame<'a> {
    /// The posts that values of rasters belong to.
    pub ground: &'a Lattice,
    /// The system of its features.
    pub crs: &'a Crs,
}

/// Writes the features of an outcome to `path`; where it has none, the areas of the classes of its raster. `title` names the
/// collection, and `inputs` are files that are not to be replaced.
///
/// # Errors
/// [`FeatureExportError`]; nothing is written then.
pub fn export_outcome(
    outcome: &Outcome,
    frame: OutcomeFrame<'_>,
    path: &Path,
    format: FeatureFormat,
    title: &str,
    inputs: &[PathBuf],
) -> Result<ExportedFeatures, FeatureExportError> {
    disk::check_output(path, inputs)?;
    let made = made(outcome, frame, format, title)?;
    let mut outputs = OutputFiles::default();
    outputs.write(path, &made.bytes)?;
    outputs.publish()?;
    Ok(made.told)
}

/// The bytes of the file that [`export_outcome`] writes.
///
/// # Errors
/// [`FeatureExportError::Make`] and those of the system.
pub fn outcome_bytes(
    outcome: &Outcome,
    frame: OutcomeFrame<'_>,
    format: FeatureFormat,
    title: &str,
) -> Result<Vec<u8>, FeatureExportError> {
    made(outcome, frame, format, title).map(|made| made.bytes)
}

/// The features of an outcome as GeoJSON in their own system.
pub fn outcome_geojson(outcome: &Outcome, title: &str) -> String {
    String::from_utf8_lossy(&json::file(&role_layers(&outcome.features), title).bytes).into_owned()
}

fn made(
    outcome: &Outcome,
    frame: OutcomeFrame<'_>,
    format: FeatureFormat,
    title: &str,
) -> Result<MadeFile, FeatureExportError> {
    let mut layers = match (&outcome.raster, outcome.features.is_empty()) {
        (Some(raster), true) => class_layers(raster, frame.ground),
        _ => role_layers(&outcome.features),
    };
    if layers.is_empty() {
        return Err(FeatureExportError::Make(
            "the analysis found no features, and its raster has no classes".into(),
        ));
    }
    let wgs84 = Crs::wgs84();
    let system = if format.is_geographic() { &wgs84 } else { frame.crs };
    bring_to(&mut layers, frame.crs, system)?;
    match format {
        FeatureFormat::GeoPackage => geopackage::file(&layers, system, &[]),
        FeatureFormat::GeoJson => Ok(json::file(&layers, title)),
        FeatureFormat::Kmz | FeatureFormat::Msdl | FeatureFormat::Nvg => {
            Err(FeatureExportError::Make("analyses are written as .gpkg or .geojson".into()))
        }
    }
}

/// A layer for each role and kind of shape.
fn role_layers(features: &[OutcomeFeature]) -> Vec<ExportLayer> {
    let mut layers: Vec<ExportLayer> = Vec::new();
    for feature in features {
        let (names, stroke) = role_look(feature.role);
        let (shape, kind) = shape(&feature.shape);
        let name = names[kind as usize];
        let fill = (kind == ExportKind::Polygons).then(|| Srgba([stroke.0[0], stroke.0[1], stroke.0[2], 60]));
        let mut properties: Map<String, Value> =
            feature.properties.iter().map(|(name, value)| ((*name).to_owned(), json_value(value))).collect();
        if !feature.name.is_empty() {
            properties.entry("name").or_insert_with(|| Value::from(feature.name.as_str()));
        }
        let made = ExportFeature { shape, properties, symbol: None };
        match layers.iter_mut().find(|layer| layer.name == name) {
            Some(layer) => layer.features.push(made),
            None => layers.push(ExportLayer {
                name,
                kind,
                label: "name",
                look: LayerLook { stroke, width_mm: WIDTH_MM, fill },
                features: vec![made],
            }),
        }
    }
    layers
}

/// The names of the layers of a role, of points, lines and areas, and its color.
fn role_look(role: FeatureRole) -> ([&'static str; 3], Srgba) {
    match role {
        FeatureRole::Place => (["places", "place_lines", "place_areas"], Srgba::opaque(60, 40, 20)),
        FeatureRole::Post => (["posts", "post_lines", "post_areas"], Srgba::opaque(20, 20, 20)),
        FeatureRole::Route => (["route_points", "routes", "route_areas"], Srgba::opaque(190, 30, 120)),
        FeatureRole::Corridor => {
            (["corridor_points", "corridor_lines", "corridors"], Srgba::opaque(200, 60, 20))
        }
        FeatureRole::Haul => (["haul_points", "hauls", "haul_areas"], Srgba::opaque(190, 30, 120)),
        FeatureRole::Isoline => (["isoline_points", "isolines", "isoline_areas"], Srgba::opaque(140, 90, 40)),
        FeatureRole::Stream => (["stream_points", "streams", "stream_areas"], Srgba::opaque(30, 100, 190)),
        FeatureRole::FormLine => (["form_points", "form_lines", "form_areas"], Srgba::opaque(110, 70, 30)),
        FeatureRole::Site => (["site_points", "site_lines", "sites"], Srgba::opaque(30, 130, 60)),
        FeatureRole::Outline => (["outline_points", "outline_lines", "outlines"], Srgba::opaque(60, 60, 60)),
        FeatureRole::Link => (["link_points", "links", "link_areas"], Srgba::opaque(30, 130, 60)),
    }
}

fn shape(shape: &OutcomeShape) -> (ExportShape, ExportKind) {
    let flat = |at: &DVec2| at.extend(f64::NAN);
    let course = |points: &Vec<DVec2>| points.iter().map(flat).collect::<Vec<DVec3>>();
    match shape {
        OutcomeShape::Point(at) => (ExportShape::Point(flat(at)), ExportKind::Points),
        OutcomeShape::Line(line) => (ExportShape::Line(course(line)), ExportKind::Lines),
        OutcomeShape::Area(rings) => {
            (ExportShape::Polygon(rings.iter().map(course).collect()), ExportKind::Polygons)
        }
    }
}

/// The value of a property as JSON.
pub fn json_value(value: &PropertyValue) -> Value {
    match value {
        PropertyValue::Number(number) => Value::from(*number),
        PropertyValue::Whole(number) => Value::from(*number),
        PropertyValue::Text(text) => Value::from(text.as_str()),
        PropertyValue::Truth(truth) => Value::from(*truth),
    }
}

/// The areas of each class of a raster that is drawn, a cell around each post.
fn class_layers(raster: &OutcomeRaster, ground: &Lattice) -> Vec<ExportLayer> {
    let (columns, rows) = (ground.columns() as usize, ground.rows() as usize);
    let corner =
        ground.map_position(sandtable_terrain::lattice::Post { column: 0, row: 0 }) - ground.cell() * 0.5;
    let mut features = Vec::new();
    for (index, class) in raster.classes.iter().enumerate().filter(|(_, class)| is_drawn(class.look)) {
        let below = raster.classes.get(index + 1).map_or(f32::INFINITY, |next| next.from);
        let is_inside = |column: usize, row: usize| {
            let value = raster.values.value(row * columns + column);
            value >= class.from && value < below
        };
        let ring = |corners: &Vec<IVec2>| -> Vec<DVec3> {
            corners.iter().map(|at| (corner + at.as_dvec2() * ground.cell()).extend(f64::NAN)).collect()
        };
        for outline in cell_outlines(columns, rows, is_inside) {
            let rings = std::iter::once(&outline.exterior).chain(&outline.holes).map(ring).collect();
            features.push(ExportFeature {
                shape: ExportShape::Polygon(rings),
                properties: class_properties(raster, class),
                symbol: None,
            });
        }
    }
    if features.is_empty() {
        return Vec::new();
    }
    let look = LayerLook {
        stroke: Srgba::opaque(60, 60, 60),
        width_mm: WIDTH_MM,
        fill: Some(Srgba([200, 120, 40, 90])),
    };
    vec![ExportLayer { name: "classes", kind: ExportKind::Polygons, label: "class", look, features }]
}

/// Whether a class is shown at all: ground without an obstacle is not.
fn is_drawn(look: ClassLook) -> bool {
    look.tint[3] > 0 || look.hatching != sandtable_analysis::outcome::Hatching::None
}

fn class_properties(raster: &OutcomeRaster, class: &ValueClass) -> Map<String, Value> {
    let from = (raster.name.to_owned(), Value::from(f64::from(class.from)));
    [("class".to_owned(), Value::from(class.label.as_str())), from].into_iter().collect()
}
