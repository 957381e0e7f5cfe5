//! Data in memory that a scene's text names.

use std::sync::Arc;

use crate::api::dem::Dem;
use crate::api::error::Error;
use sandtable_geom::crs::Crs;
use sandtable_scene::given_data::GivenData;
use sandtable_vector::feature::VectorLayer;
use sandtable_vector::feature_table::{FeatureColumn, layer_of_wkb};

/// Features in memory: shapes with properties, in one coordinate system. Cheap to clone.
#[derive(Clone, Debug)]
pub struct FeatureLayer {
    layer: Arc<VectorLayer>,
}

impl FeatureLayer {
    /// The features of `shapes`, each well-known binary or `None`, and of `columns`, a value a shape, which are moved.
    ///
    /// Rows without a shape are left out.
    ///
    /// # Errors
    /// [`Error::Features`]: no shape can be read, or most lie where the system has no coordinates.
    pub fn from_wkb<'a>(
        crs: Crs,
        shapes: impl IntoIterator<Item = Option<&'a [u8]>>,
        columns: Vec<FeatureColumn>,
    ) -> Result<Self, Error> {
        Ok(Self { layer: Arc::new(layer_of_wkb(crs, shapes, columns)?) })
    }

    /// How many features there are; one for each kind of shape of a row.
    pub fn feature_count(&self) -> usize {
        self.layer.features.len()
    }

    /// The system of their coordinates.
    pub fn crs(&self) -> &Crs {
        &self.layer.crs
    }
}

/// Elevation, features and contents of files in memory, each under the name by which the text of a scene states it. They are
/// not looked for on the disk. Cheap to clone.
#[derive(Clone, Debug, Default)]
pub struct SceneData {
    pub(in crate::api) given: GivenData,
}

impl SceneData {
    /// Adds elevation, for `dem` of `[terrain]`.
    pub fn add_dem(&mut self, name: &str, dem: &Dem) {
        self.given.add_raster(name, Arc::clone(&dem.raster));
    }

    /// Adds features, for `file` of a table of features.
    pub fn add_features(&mut self, name: &str, features: &FeatureLayer) {
        self.given.add_layer(name, Arc::clone(&features.layer));
    }

    /// Adds the content of a file of a format that a scene reads, such as GeoJSON, CSV or a model's.
    pub fn add_file(&mut self, name: &str, bytes: Vec<u8>) {
        self.given.add_file(name, bytes.into());
    }
}
