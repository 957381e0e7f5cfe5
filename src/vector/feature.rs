//! Features of a vector file.

use std::collections::BTreeMap;
use std::iter;

use glam::DVec2;

use sandtable_geom::crs::{Crs, CrsError};

/// The properties of a feature, by name.
pub type Properties = BTreeMap<String, serde_json::Value>;

/// All features of one layer.
#[derive(Clone, Debug)]
pub struct VectorLayer {
    /// In the file's order.
    pub features: Vec<Feature>,
    /// The system of all coordinates: the file's own, else its format's default.
    pub crs: Crs,
    /// Notes for the user on what the format allows and a scene cannot use, such as features without a shape.
    pub notes: Vec<String>,
    /// Sentences for the user on what is wrong with the file: records that cannot be read and are left out.
    pub faults: Vec<String>,
}

/// One feature.
#[derive(Clone, Debug, PartialEq)]
pub struct Feature {
    /// Its shape; multi-part shapes hold several lines, polygons or points.
    pub geometry: Geometry,
    /// The elevation of every vertex in the order of [`Geometry::vertices`], in the file's vertical unit, NaN for a
    /// vertex without one; `None` where no vertex has one.
    pub elevations: Option<Vec<f64>>,
    /// Its properties.
    pub properties: Properties,
}

/// Shapes of one kind. Coordinates are (easting, northing) or (longitude, latitude).
#[derive(Clone, Debug, PartialEq)]
pub enum Geometry {
    /// Points.
    Points(Vec<DVec2>),
    /// Lines of at least two vertices.
    Lines(Vec<Vec<DVec2>>),
    /// Polygons.
    Polygons(Vec<Polygon>),
}

/// A polygon with holes. Rings are closed without repeating the first vertex and run in either direction.
#[derive(Clone, Debug, PartialEq)]
pub struct Polygon {
    /// The outer ring, at least three vertices.
    pub exterior: Vec<DVec2>,
    /// Holes, at least three vertices each.
    pub holes: Vec<Vec<DVec2>>,
}

impl VectorLayer {
    /// Returns the faults of the file, then the notes.
    pub fn reading_notes(&self) -> impl Iterator<Item = &String> {
        self.faults.iter().chain(&self.notes)
    }

    /// Returns the same features in the system `to`.
    ///
    /// # Errors
    /// [`CrsError`] for the first vertex that either system cannot express.
    pub fn transformed(mut self, to: &Crs) -> Result<Self, CrsError> {
        if self.crs != *to {
            for vertex in self.features.iter_mut().flat_map(|feature| feature.geometry.vertices_mut()) {
                *vertex = self.crs.transform(to, *vertex)?;
            }
            self.crs = to.clone();
        }
        Ok(self)
    }
}

impl Feature {
    /// Returns its lines; none for points and polygons.
    pub fn lines(&self) -> &[Vec<DVec2>] {
        if let Geometry::Lines(lines) = &self.geometry { lines } else { &[] }
    }

    /// Returns its polygons; none for points and lines.
    pub fn polygons(&self) -> &[Polygon] {
        if let Geometry::Polygons(polygons) = &self.geometry { polygons } else { &[] }
    }

    /// Returns its points; none for lines and polygons.
    pub fn points(&self) -> &[DVec2] {
        if let Geometry::Points(points) = &self.geometry { points } else { &[] }
    }
}

impl Geometry {
    /// Returns `points`, `lines` or `polygons`.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Points(_) => "points",
            Self::Lines(_) => "lines",
            Self::Polygons(_) => "polygons",
        }
    }

    /// Returns all vertices, part by part, a polygon's outer ring before its holes.
    pub fn vertices(&self) -> Box<dyn Iterator<Item = &DVec2> + '_> {
        match self {
            Self::Points(points) => Box::new(points.iter()),
            Self::Lines(lines) => Box::new(lines.iter().flatten()),
            Self::Polygons(polygons) => Box::new(polygons.iter().flat_map(Polygon::rings).flatten()),
        }
    }

    fn vertices_mut(&mut self) -> Box<dyn Iterator<Item = &mut DVec2> + '_> {
        match self {
            Self::Points(points) => Box::new(points.iter_mut()),
            Self::Lines(lines) => Box::new(lines.iter_mut().flatten()),
            Self::Polygons(polygons) => Box::new(
                polygons
                    .iter_mut()
                    .flat_map(|polygon| iter::once(&mut polygon.exterior).chain(&mut polygon.holes))
                    .flatten(),
            ),
        }
    }
}

impl Polygon {
    /// Returns the outer ring, then the holes.
    pub fn rings(&self) -> impl Iterator<Item = &Vec<DVec2>> {
        iter::once(&self.exterior).chain(&self.holes)
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
        let layer =
            VectorLayer { features: vec![feature], crs: Crs::wgs84(), notes: Vec::new(), faults: Vec::new() };
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
