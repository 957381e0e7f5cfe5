//! Data in memory that stand in for files: what a program has read itself, under the names that a scene file gives them.

use std::collections::BTreeMap;
use std::sync::Arc;

use sandtable_raster::raster::Raster;
use sandtable_vector::feature::VectorLayer;

/// Elevation, features and the bytes of files, each under its name in the scene file. A name that is given is not looked for
/// on the disk.
///
/// Cheap to clone.
#[derive(Clone, Debug, Default)]
pub struct GivenData {
    rasters: BTreeMap<String, Arc<Raster>>,
    layers: BTreeMap<String, Arc<VectorLayer>>,
    files: BTreeMap<String, Arc<[u8]>>,
}

impl GivenData {
    /// Gives elevation.
    pub fn add_raster(&mut self, name: impl Into<String>, raster: Arc<Raster>) {
        self.rasters.insert(name.into(), raster);
    }

    /// Gives features.
    pub fn add_layer(&mut self, name: impl Into<String>, layer: Arc<VectorLayer>) {
        self.layers.insert(name.into(), layer);
    }

    /// Gives the content of a file of any format that a scene reads.
    pub fn add_file(&mut self, name: impl Into<String>, bytes: Arc<[u8]>) {
        self.files.insert(name.into(), bytes);
    }

    /// The elevation called `name`, if it is given.
    pub fn raster(&self, name: &str) -> Option<&Arc<Raster>> {
        self.rasters.get(name)
    }

    /// The features called `name`, if they are given.
    pub fn layer(&self, name: &str) -> Option<&Arc<VectorLayer>> {
        self.layers.get(name)
    }

    /// The bytes of the file called `name`, if they are given.
    pub fn file(&self, name: &str) -> Option<&[u8]> {
        self.files.get(name).map(|bytes| &bytes[..])
    }
}
