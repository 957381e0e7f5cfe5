//! Helpers that make features: properties, and world positions as map coordinates.

use glam::{DVec2, DVec3, Vec3};
use serde_json::{Map, Value};

use super::{ExportFeature, ExportShape};
use sandtable_draw::list::FeatureId;
use sandtable_scene::scene_model::SceneModel;

/// Properties from names with values; empty texts are left out.
pub(super) fn properties<const N: usize>(pairs: [(&str, Value); N]) -> Map<String, Value> {
    let is_stated = |(_, value): &(&str, Value)| !value.is_null() && value.as_str() != Some("");
    pairs.into_iter().filter(is_stated).map(|(name, value)| (name.to_owned(), value)).collect()
}

/// A length or height to a millimeter.
pub(super) fn meters(length: f64) -> Value {
    if length.is_finite() { Value::from((length * 1000.0).round() / 1000.0) } else { Value::Null }
}

/// A scene's positions as those of its map.
pub(super) struct MapPlaces<'a> {
    pub scene: &'a SceneModel,
}

impl MapPlaces<'_> {
    /// World X and Y on the map, without a height.
    pub fn flat(&self, world: DVec2) -> DVec3 {
        (world + self.scene.lattice.origin()).extend(f64::NAN)
    }

    /// A world position on the map with its elevation.
    pub fn at(&self, world: Vec3) -> DVec3 {
        let flat = world.truncate().as_dvec2() + self.scene.lattice.origin();
        flat.extend(self.scene.scale.elevation_m(f64::from(world.z)))
    }

    /// Rings in world space as a polygon.
    pub fn polygon(&self, rings: &[Vec<DVec2>]) -> ExportShape {
        ExportShape::Polygon(
            rings.iter().map(|ring| ring.iter().map(|&at| self.flat(at)).collect()).collect(),
        )
    }

    /// Places in world space as a line.
    pub fn line(&self, points: &[DVec2]) -> ExportShape {
        ExportShape::Line(points.iter().map(|&at| self.flat(at)).collect())
    }

    /// The name of a feature that has one.
    pub fn name(&self, feature: FeatureId) -> Value {
        let found = feature.index().and_then(|index| self.scene.features.get(index));
        Value::from(found.map_or("", |feature| feature.name.as_str()))
    }
}

/// A feature that is no symbol.
pub(super) fn feature(shape: ExportShape, properties: Map<String, Value>) -> ExportFeature {
    ExportFeature { shape, properties, symbol: None }
}
