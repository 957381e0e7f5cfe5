//! Features as a vector file holds them.

use std::collections::BTreeMap;

use glam::DVec2;

use crate::geom::crs::Crs;

/// All features of one file.
#[derive(Clone, Debug)]
pub struct Layer {
    /// In the file's order.
    pub features: Vec<Feature>,
    /// The system of all coordinates: what the file states, else its format's default.
    pub crs: Crs,
}

/// One feature.
#[derive(Clone, Debug)]
pub struct Feature {
    /// Its shape; multi-part shapes hold several lines, polygons or points.
    pub geometry: Geometry,
    /// Its properties, by name.
    pub properties: BTreeMap<String, serde_json::Value>,
}

/// Coordinates are (easting, northing) or (longitude, latitude).
#[derive(Clone, Debug, PartialEq)]
pub enum Geometry {
    /// Points.
    Points(Vec<DVec2>),
    /// Lines of at least two vertices.
    Lines(Vec<Vec<DVec2>>),
    /// Polygons.
    Polygons(Vec<Polygon>),
}

/// A polygon with holes; rings are closed without repeating the first vertex, in either direction.
#[derive(Clone, Debug, PartialEq)]
pub struct Polygon {
    /// The outer ring, at least three vertices.
    pub exterior: Vec<DVec2>,
    /// Holes, at least three vertices each.
    pub holes: Vec<Vec<DVec2>>,
}
