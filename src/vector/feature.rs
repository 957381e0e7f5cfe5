//! Features as a vector file holds them.

use std::collections::BTreeMap;

use glam::DVec2;

use crate::geom::crs::{Crs, CrsError};

/// All features of one file.
#[derive(Clone, Debug)]
pub struct VectorLayer {
    /// In the file's order.
    pub features: Vec<Feature>,
    /// The system of all coordinates: what the file states, else its format's default.
    pub crs: Crs,
    /// What the file holds that no feature came of, for the user to know.
    pub notes: Vec<String>,
}

/// One feature.
#[derive(Clone, Debug, PartialEq)]
pub struct Feature {
    /// Its shape; multi-part shapes hold several lines, polygons or points.
    pub geometry: Geometry,
    /// The elevation of every vertex, in the order of [`Geometry::vertices`] and the file's vertical unit, NaN for a
    /// vertex without one; `None` where the file gives the feature no elevations.
    pub elevations: Option<Vec<f64>>,
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

impl VectorLayer {
    /// The same features in the system `to`.
    ///
    /// # Errors
    /// [`CrsError`] for the first vertex that either system cannot express.
    pub fn transformed(mut self, to: &Crs) -> Result<Self, CrsError> {
        if self.crs != *to {
            let from = self.crs.clone();
            for vertex in self.features.iter_mut().flat_map(|feature| feature.geometry.vertices_mut()) {
                *vertex = from.transform(to, *vertex)?;
            }
        }
        self.crs = to.clone();
        Ok(self)
    }
}

impl Feature {
    /// Its lines; none for points and polygons.
    pub fn lines(&self) -> &[Vec<DVec2>] {
        match &self.geometry {
            Geometry::Lines(lines) => lines,
            Geometry::Points(_) | Geometry::Polygons(_) => &[],
        }
    }

    /// Its polygons; none for points and lines.
    pub fn polygons(&self) -> &[Polygon] {
        match &self.geometry {
            Geometry::Polygons(polygons) => polygons,
            Geometry::Points(_) | Geometry::Lines(_) => &[],
        }
    }

    /// Its points; none for lines and polygons.
    pub fn points(&self) -> &[DVec2] {
        match &self.geometry {
            Geometry::Points(points) => points,
            Geometry::Lines(_) | Geometry::Polygons(_) => &[],
        }
    }
}

impl Geometry {
    /// `points`, `lines` or `polygons`.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Points(_) => "points",
            Self::Lines(_) => "lines",
            Self::Polygons(_) => "polygons",
        }
    }

    /// All its vertices, part by part.
    pub fn vertices(&self) -> Box<dyn Iterator<Item = &DVec2> + '_> {
        match self {
            Self::Points(points) => Box::new(points.iter()),
            Self::Lines(lines) => Box::new(lines.iter().flatten()),
            Self::Polygons(polygons) => Box::new(
                polygons
                    .iter()
                    .flat_map(|polygon| polygon.exterior.iter().chain(polygon.holes.iter().flatten())),
            ),
        }
    }

    fn vertices_mut(&mut self) -> Box<dyn Iterator<Item = &mut DVec2> + '_> {
        match self {
            Self::Points(points) => Box::new(points.iter_mut()),
            Self::Lines(lines) => Box::new(lines.iter_mut().flatten()),
            Self::Polygons(polygons) => {
                Box::new(polygons.iter_mut().flat_map(|polygon| {
                    polygon.exterior.iter_mut().chain(polygon.holes.iter_mut().flatten())
                }))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_layer_is_brought_to_another_system_with_its_holes() {
        let ring = |size: f64| {
            vec![DVec2::new(15.0, 48.0), DVec2::new(15.0 + size, 48.0), DVec2::new(15.0, 48.0 + size)]
        };
        let polygon = Polygon { exterior: ring(0.1), holes: vec![ring(0.01)] };
        let geometry = Geometry::Polygons(vec![polygon]);
        let feature = Feature { geometry, elevations: None, properties: BTreeMap::new() };
        let layer = VectorLayer { features: vec![feature], crs: Crs::wgs84(), notes: Vec::new() };
        let utm = Crs::utm_at(15.0, 48.0);
        let moved = layer.transformed(&utm).expect("in the zone");
        assert_eq!(moved.crs, utm);
        let vertices: Vec<_> = moved.features[0].geometry.vertices().copied().collect();
        assert_eq!(vertices.len(), 6);
        assert!(vertices.iter().all(|vertex| vertex.y > 5.0e6), "{vertices:?}");
        assert_eq!(vertices[0], vertices[3]);
        assert!((vertices[0].x - 500_000.0).abs() < 1e-3, "on the central meridian: {}", vertices[0]);
    }
}
