//! Files of every kind, from bytes.

use sandtable::dem::formats::FORMATS;
use sandtable::dem::points::{self as point_files, PointHints};
use sandtable::dem::read::{self as dem, DemHints};
use sandtable::description::expression::Expression;
use sandtable::description::parse::parse_bytes;
use sandtable::description::scalar::Scalar;
use sandtable::model::error::CompanionError;
use sandtable::model::{Companions, Model, gltf, obj, three_ds};
use sandtable::vector::hints::VectorHints;
use sandtable::vector::read as vector;

/// A raster; the first byte chooses the extension, behind which some formats hide.
pub fn elevation(bytes: &[u8]) {
    let Some((&first, bytes)) = bytes.split_first() else { return };
    let extensions: Vec<&str> = FORMATS.iter().flat_map(|format| format.extensions.iter().copied()).collect();
    let name = format!("file.{}", extensions[usize::from(first) % extensions.len()]);
    let hints = DemHints { height_scale: Some(0.1), cell: Some(10.0), ..DemHints::default() };
    if let Ok(raster) = dem::read(&name, bytes, &hints) {
        assert!(raster.width > 0 && raster.height > 0, "a raster without samples");
        assert!(raster.map_from_grid.is_finite(), "a raster that lies nowhere");
    }
}

/// Scattered points: tables and LAS.
pub fn points(bytes: &[u8]) {
    if let Ok(cloud) = point_files::read(bytes, &PointHints { crs: None, classes: &[] }) {
        assert!(cloud.points.iter().all(|point| point.is_finite()), "a point that is nowhere");
    }
}

/// Vectors of every format, which the content decides.
pub fn vectors(bytes: &[u8]) {
    let _ = vector::read("file", bytes, &VectorHints::default());
}

/// A companion of any name: the bytes of the file itself, so that files that name others read something.
struct OwnBytes<'a>(&'a [u8]);

impl Companions for OwnBytes<'_> {
    fn load(&self, _: &str) -> Result<Vec<u8>, CompanionError> {
        Ok(self.0.to_vec())
    }
}

/// What every reader of models promises.
fn check_model(model: &Model) {
    for part in &model.parts {
        let count = part.mesh.vertices.len();
        assert!(
            part.mesh.triangles.iter().flatten().all(|corner| corner.index() < count),
            "a corner beyond the last"
        );
        assert!(part.material.0 < model.materials.len() as u32, "a material beyond the last");
    }
    if let Some(bounds) = model.bounds() {
        assert!(bounds.min.is_finite() && bounds.max.is_finite(), "a model without bounds");
    }
}

pub fn models_3ds(bytes: &[u8]) {
    if let Ok(model) = three_ds::read(bytes, &OwnBytes(bytes)) {
        check_model(&model);
    }
}

pub fn models_obj(bytes: &[u8]) {
    if let Ok(model) = obj::read(bytes, &OwnBytes(bytes)) {
        check_model(&model);
    }
}

pub fn models_gltf(bytes: &[u8]) {
    if let Ok(model) = gltf::read(bytes, &OwnBytes(bytes)) {
        check_model(&model);
    }
}

/// A scene file; whatever is wrong with it can be printed.
pub fn scene_text(bytes: &[u8]) {
    if let Err(errors) = parse_bytes("scene.toml", bytes) {
        assert!(!errors.to_string().is_empty(), "an error that says nothing");
    }
}

/// An expression over properties, evaluated where it can be read.
pub fn expressions(bytes: &[u8]) {
    let text = String::from_utf8_lossy(bytes);
    let properties = [("width", Scalar::Number(4.0)), ("name", Scalar::Text("Ridge Road".to_owned()))];
    match Expression::parse(&text) {
        Ok(expression) => drop(expression.value(&|key: &str| {
            properties.iter().find(|(name, _)| *name == key).map(|(_, value)| value.clone())
        })),
        Err(error) => assert!(!error.to_string().is_empty(), "an error that says nothing"),
    }
}
