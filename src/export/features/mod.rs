//! A scene's features as files of GIS and of staffs: what it shows, layer by layer, in map coordinates.
//!
//! ```text
//!  SceneModel ─► layers    symbols, graphics, roads, water, contours, sight ... as points, lines and polygons
//!                   ├─► geopackage   every layer a table, with styles for QGIS
//!                   ├─► json         every feature with the name of its layer
//!                   ├─► kmz          a folder a layer, symbols as pictures
//!                   ├─► msdl         units, equipment and graphics of sides
//!                   └─► nvg          points, lines and polygons with codes and styles
//! ```

pub mod analysis_json;
mod features_of;
mod geopackage;
mod json;
mod kmz;
mod layers;
mod msdl;
mod nvg;
pub mod outcome;
mod outlines;
mod qgis_style;
mod xml_text;

use std::path::Path;

use glam::DVec3;
use serde_json::{Map, Value};
use thiserror::Error;

use sandtable_draw::color::Srgba;
use sandtable_files::disk::{self, WriteFileError};
use sandtable_files::output_files::OutputFiles;
use sandtable_geom::crs::{Crs, CrsError};
use sandtable_scene::scene_model::SceneModel;

/// A format of features.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FeatureFormat {
    /// OGC GeoPackage 1.3.
    GeoPackage,
    /// GeoJSON (RFC 7946).
    GeoJson,
    /// KML 2.2 in an archive with its pictures.
    Kmz,
    /// Military Scenario Definition Language 1.0 (SISO-STD-007).
    Msdl,
    /// NATO Vector Graphics 2.0.
    Nvg,
}

impl FeatureFormat {
    /// The format of files with this extension, in any case.
    pub fn from_extension(extension: &str) -> Option<Self> {
        match extension.to_ascii_lowercase().as_str() {
            "gpkg" => Some(Self::GeoPackage),
            "geojson" => Some(Self::GeoJson),
            "kmz" => Some(Self::Kmz),
            "msdl" => Some(Self::Msdl),
            "nvg" => Some(Self::Nvg),
            _ => None,
        }
    }

    /// Whether its coordinates are longitude and latitude, whatever is asked for.
    pub fn is_geographic(self) -> bool {
        self != Self::GeoPackage
    }
}

/// The shape of a feature: map coordinates and heights, NaN without one. Rings are not closed; the first is the outer one.
#[derive(Clone, Debug, PartialEq)]
pub enum ExportShape {
    /// A place.
    Point(DVec3),
    /// A line.
    Line(Vec<DVec3>),
    /// A polygon.
    Polygon(Vec<Vec<DVec3>>),
}

impl ExportShape {
    fn vertices_mut(&mut self) -> Box<dyn Iterator<Item = &mut DVec3> + '_> {
        match self {
            Self::Point(at) => Box::new(std::iter::once(at)),
            Self::Line(line) => Box::new(line.iter_mut()),
            Self::Polygon(rings) => Box::new(rings.iter_mut().flatten()),
        }
    }

    /// All vertices.
    pub fn vertices(&self) -> Box<dyn Iterator<Item = &DVec3> + '_> {
        match self {
            Self::Point(at) => Box::new(std::iter::once(at)),
            Self::Line(line) => Box::new(line.iter()),
            Self::Polygon(rings) => Box::new(rings.iter().flatten()),
        }
    }
}

/// A feature of a layer.
#[derive(Clone, Debug, PartialEq)]
pub struct ExportFeature {
    /// Its shape.
    pub shape: ExportShape,
    /// Its properties; those of overlays have the names of [`sandtable_vector::overlay_schema`].
    pub properties: Map<String, Value>,
    /// Of a military symbol, its number in the scene.
    pub symbol: Option<usize>,
}

impl ExportFeature {
    /// A property as text; empty where it has none.
    fn text(&self, name: &str) -> String {
        match self.properties.get(name) {
            Some(Value::Null) | None => String::new(),
            Some(value) => written(value),
        }
    }
}

/// A value as text, without the quotes of JSON.
fn written(value: &Value) -> String {
    value.as_str().map_or_else(|| value.to_string(), str::to_owned)
}

/// The kind of the shapes of a layer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ExportKind {
    /// Points.
    Points,
    /// Lines.
    Lines,
    /// Polygons.
    Polygons,
}

/// How a layer is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LayerLook {
    /// Its lines and points.
    pub stroke: Srgba,
    /// Their width in millimeters.
    pub width_mm: f32,
    /// Its areas.
    pub fill: Option<Srgba>,
}

/// A layer of features of one kind.
#[derive(Clone, Debug, PartialEq)]
pub struct ExportLayer {
    /// Its name: lower case, letters and underscores.
    pub name: &'static str,
    /// What its shapes are.
    pub kind: ExportKind,
    /// The property that names its features on a map; empty where none does.
    pub label: &'static str,
    /// Its look.
    pub look: LayerLook,
    /// In the order of the scene.
    pub features: Vec<ExportFeature>,
}

/// What was exported.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ExportedFeatures {
    /// The layers with the number of their features.
    pub layers: Vec<(&'static str, usize)>,
    /// What the format cannot say.
    pub notes: Vec<String>,
}

/// The reason why features are not exported.
#[derive(Debug, Error)]
pub enum FeatureExportError {
    /// The file cannot be written.
    #[error(transparent)]
    Write(#[from] WriteFileError),
    /// A place has no coordinates in the system that is asked for.
    #[error(transparent)]
    System(#[from] CrsError),
    /// The scene has nothing that the format holds.
    #[error("the scene has nothing that {0} holds; a .gpkg or .geojson has all its features")]
    Empty(&'static str),
    /// The archive or database cannot be made.
    #[error("the file cannot be made: {0}")]
    Make(String),
}

/// Writes the features of a scene that was opened true to scale to `path`, in `crs` or, without it and where the format lets them,
/// in the scene's system. `progress` is called with the name of each step as it begins.
///
/// # Errors
/// [`FeatureExportError`]; nothing is written then.
pub fn export_features(
    scene: &SceneModel,
    path: &Path,
    format: FeatureFormat,
    crs: Option<&Crs>,
    progress: &dyn Fn(&'static str),
) -> Result<ExportedFeatures, FeatureExportError> {
    disk::check_output(path, &scene.files)?;
    progress("collecting features");
    let mut layers = layers::layers(scene);
    let wgs84 = Crs::wgs84();
    let system = if format.is_geographic() { &wgs84 } else { crs.unwrap_or(&scene.crs) };
    bring_to(&mut layers, &scene.crs, system)?;
    progress("writing");
    let title = scene.title.as_deref().unwrap_or("A scene");
    let made = match format {
        FeatureFormat::GeoPackage => geopackage::file(&layers, system, &scene.military)?,
        FeatureFormat::GeoJson => json::file(&layers, title),
        FeatureFormat::Kmz => kmz::file(&layers, title, scene)?,
        FeatureFormat::Msdl => msdl::file(&layers, title, scene)?,
        FeatureFormat::Nvg => nvg::file(&layers)?,
    };
    let mut outputs = OutputFiles::default();
    outputs.write(path, &made.bytes)?;
    outputs.publish()?;
    Ok(made.told)
}

/// A file in memory, and what is told of it.
pub(crate) struct MadeFile {
    pub bytes: Vec<u8>,
    pub told: ExportedFeatures,
}

/// The layers with their numbers of features.
fn counted(layers: &[ExportLayer]) -> Vec<(&'static str, usize)> {
    layers.iter().map(|layer| (layer.name, layer.features.len())).collect()
}

fn bring_to(layers: &mut [ExportLayer], from: &Crs, to: &Crs) -> Result<(), CrsError> {
    if from == to {
        return Ok(());
    }
    let features = layers.iter_mut().flat_map(|layer| &mut layer.features);
    for vertex in features.flat_map(|feature| feature.shape.vertices_mut()) {
        let at = from.transform(to, vertex.truncate())?;
        *vertex = at.extend(vertex.z);
    }
    Ok(())
}
