//! From positions as files hold them to a [`VectorLayer`]: what every reader puts its shapes into.
//!
//! Readers hand over positions of three numbers, the third NaN where the file gives no elevation. Here positions
//! that are no numbers, lines of one vertex and rings of two are left out and counted, rings lose their closing
//! vertex, and a feature of several kinds of shape becomes up to three, one each for its points, lines and
//! polygons.

use std::collections::BTreeMap;

use glam::{DVec2, DVec3};
use serde_json::Value;

use crate::geom::crs::Crs;
use crate::vector::error::VectorError;
use crate::vector::feature::{Feature, Geometry, Polygon, VectorLayer};

/// A feature's properties, by name.
pub(crate) type Properties = BTreeMap<String, Value>;

/// The position (x, y) at an elevation, NaN for none.
pub(crate) fn position(x: f64, y: f64, elevation: Option<f64>) -> DVec3 {
    DVec3::new(x, y, elevation.unwrap_or(f64::NAN))
}

/// Gathers the features of one layer.
pub(crate) struct Collector {
    crs: Crs,
    /// Features that the file holds so far, with a shape or without.
    seen: usize,
    features: Vec<Feature>,
    left: Left,
    notes: Vec<String>,
}

/// The shapes of one feature.
#[derive(Default)]
pub(crate) struct FeatureParts {
    points: Vec<DVec3>,
    lines: Vec<Vec<DVec3>>,
    polygons: Vec<PolygonRings>,
    left: Left,
}

/// A polygon's rings: the outer one, not closed, and the holes.
struct PolygonRings {
    exterior: Vec<DVec3>,
    holes: Vec<Vec<DVec3>>,
}

/// What was left out.
#[derive(Default)]
struct Left {
    without_geometry: usize,
    short_positions: usize,
    not_finite: usize,
    short_lines: usize,
    small_rings: usize,
}

impl Collector {
    /// No features yet, in `crs`.
    pub fn new(crs: Crs) -> Self {
        Self { crs, seen: 0, features: Vec::new(), left: Left::default(), notes: Vec::new() }
    }

    /// The file's next feature; one without a usable shape is counted and left out.
    ///
    /// # Errors
    /// [`VectorError::NotDegrees`].
    pub fn add(&mut self, parts: FeatureParts, properties: Properties) -> Result<(), VectorError> {
        self.seen += 1;
        let empty = parts.is_empty();
        self.left.add(&parts.left);
        self.left.without_geometry += usize::from(empty);
        let mut properties = Some(properties);
        let mut shapes = parts.into_shapes().peekable();
        while let Some((geometry, elevations)) = shapes.next() {
            check_degrees(&geometry, &self.crs, self.seen)?;
            let properties = if shapes.peek().is_some() { properties.clone() } else { properties.take() };
            let properties = properties.expect("taken only for the last shape");
            self.features.push(Feature { geometry, elevations, properties });
        }
        Ok(())
    }

    /// How many features the file holds so far, with a shape or without.
    pub fn seen(&self) -> usize {
        self.seen
    }

    /// Something for the user to know.
    pub fn note(&mut self, note: String) {
        self.notes.push(note);
    }

    /// Says that `count` of something were left out, where there were any.
    pub fn left_out(&mut self, count: usize, what: &str) {
        if count > 0 {
            self.note(format!("left out: {count} {what}"));
        }
    }

    /// All features that came of it.
    pub fn finish(self) -> VectorLayer {
        let mut notes = self.left.notes();
        notes.extend(self.notes);
        VectorLayer { features: self.features, crs: self.crs, notes }
    }
}

impl FeatureParts {
    /// Adds a point.
    pub fn point(&mut self, at: DVec3) {
        self.points.extend(self.left.finite(vec![at]));
    }

    /// Adds a line; one of less than two vertices is left out.
    pub fn line(&mut self, vertices: Vec<DVec3>) {
        let vertices = self.left.finite(vertices);
        match vertices.len() {
            0 | 1 => self.left.short_lines += 1,
            _ => self.lines.push(vertices),
        }
    }

    /// Adds a polygon, its outer ring first, closed or not; rings of less than three vertices are left out, and
    /// with the outer one the polygon.
    pub fn polygon(&mut self, rings: impl IntoIterator<Item = Vec<DVec3>>) {
        let mut rings = rings.into_iter().map(|ring| open_ring(self.left.finite(ring)));
        let exterior = rings.next().flatten();
        let holes: Vec<_> = rings.collect();
        self.left.small_rings +=
            usize::from(exterior.is_none()) + holes.iter().filter(|hole| hole.is_none()).count();
        if let Some(exterior) = exterior {
            self.polygons.push(PolygonRings { exterior, holes: holes.into_iter().flatten().collect() });
        }
    }

    /// Counts a position of less than two numbers.
    pub fn short_position(&mut self) {
        self.left.short_positions += 1;
    }

    /// Whether nothing usable was added.
    pub fn is_empty(&self) -> bool {
        self.points.is_empty() && self.lines.is_empty() && self.polygons.is_empty()
    }

    /// Each kind of shape there is, with its elevations.
    fn into_shapes(self) -> impl Iterator<Item = (Geometry, Option<Vec<f64>>)> {
        let points = (!self.points.is_empty()).then(|| {
            let elevations = elevations(self.points.iter());
            (Geometry::Points(flat(self.points)), elevations)
        });
        let lines = (!self.lines.is_empty()).then(|| {
            let elevations = elevations(self.lines.iter().flatten());
            (Geometry::Lines(self.lines.into_iter().map(flat).collect()), elevations)
        });
        let polygons = (!self.polygons.is_empty()).then(|| {
            let vertices = self
                .polygons
                .iter()
                .flat_map(|polygon| polygon.exterior.iter().chain(polygon.holes.iter().flatten()));
            let elevations = elevations(vertices);
            let polygon = |rings: PolygonRings| Polygon {
                exterior: flat(rings.exterior),
                holes: rings.holes.into_iter().map(flat).collect(),
            };
            (Geometry::Polygons(self.polygons.into_iter().map(polygon).collect()), elevations)
        });
        points.into_iter().chain(lines).chain(polygons)
    }
}

impl Left {
    fn finite(&mut self, mut vertices: Vec<DVec3>) -> Vec<DVec3> {
        let given = vertices.len();
        vertices.retain(|vertex| vertex.truncate().is_finite());
        self.not_finite += given - vertices.len();
        vertices
    }

    fn add(&mut self, other: &Self) {
        self.without_geometry += other.without_geometry;
        self.short_positions += other.short_positions;
        self.not_finite += other.not_finite;
        self.short_lines += other.short_lines;
        self.small_rings += other.small_rings;
    }

    fn notes(&self) -> Vec<String> {
        let counted = [
            (self.without_geometry, "features without a usable geometry"),
            (self.short_positions, "positions of less than two numbers"),
            (self.not_finite, "positions that are not numbers"),
            (self.short_lines, "lines of less than two vertices"),
            (self.small_rings, "rings of less than three vertices"),
        ];
        let said = |(count, what)| (count > 0).then(|| format!("left out: {count} {what}"));
        counted.into_iter().filter_map(said).collect()
    }
}

/// The elevations of all vertices; `None` where there are none.
fn elevations<'a>(vertices: impl Iterator<Item = &'a DVec3> + Clone) -> Option<Vec<f64>> {
    let known = vertices.clone().any(|vertex| vertex.z.is_finite());
    let elevation = |vertex: &DVec3| if vertex.z.is_finite() { vertex.z } else { f64::NAN };
    known.then(|| vertices.map(elevation).collect())
}

fn flat(vertices: Vec<DVec3>) -> Vec<DVec2> {
    vertices.into_iter().map(DVec3::truncate).collect()
}

/// A ring without its closing vertex, closed in the file or not; `None` where fewer than three remain.
fn open_ring(mut vertices: Vec<DVec3>) -> Option<Vec<DVec3>> {
    let place = |vertex: Option<&DVec3>| vertex.map(|vertex| vertex.truncate());
    while vertices.len() > 1 && place(vertices.first()) == place(vertices.last()) {
        vertices.pop();
    }
    (vertices.len() >= 3).then_some(vertices)
}

fn check_degrees(geometry: &Geometry, crs: &Crs, feature: usize) -> Result<(), VectorError> {
    /// Twice round from the prime meridian, for lines that cross the antimeridian.
    const MAX_LONGITUDE: f64 = 360.0;
    if !crs.is_geographic() {
        return Ok(());
    }
    let outside = |vertex: &&DVec2| vertex.x.abs() > MAX_LONGITUDE || vertex.y.abs() > 90.0;
    match geometry.vertices().find(outside) {
        Some(at) => Err(VectorError::NotDegrees { feature, x: at.x, y: at.y, crs: crs.name().into() }),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn layer(parts: FeatureParts) -> VectorLayer {
        let mut collector = Collector::new(Crs::wgs84());
        collector.add(parts, Properties::new()).expect("degrees");
        collector.finish()
    }

    #[test]
    fn elevations_stand_in_the_order_of_the_vertices_and_rings_lose_their_last() {
        let ring =
            |z: f64| [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (0.0, 0.0)].map(|(x, y)| DVec3::new(x, y, z));
        let mut parts = FeatureParts::default();
        parts.polygon([ring(1.0).to_vec(), ring(f64::NAN).to_vec(), ring(3.0).to_vec()]);
        let layer = layer(parts);
        let [feature] = &layer.features[..] else { panic!("one feature") };
        let elevations = feature.elevations.as_ref().expect("known");
        assert_eq!(elevations.len(), feature.geometry.vertices().count());
        assert_eq!(elevations[..3], [1.0; 3]);
        assert!(elevations[3..6].iter().all(|elevation| elevation.is_nan()));
        assert_eq!(elevations[6..], [3.0; 3]);
    }

    #[test]
    fn positions_that_are_not_numbers_are_left_out_and_said() {
        let mut parts = FeatureParts::default();
        parts.line(vec![DVec3::new(1.0, 2.0, f64::NAN), DVec3::NAN, DVec3::new(f64::INFINITY, 0.0, 0.0)]);
        parts.point(DVec3::new(1.0, 2.0, f64::NAN));
        let layer = layer(parts);
        assert_eq!(layer.features.len(), 1);
        assert_eq!(layer.features[0].elevations, None);
        assert_eq!(
            layer.notes,
            ["left out: 2 positions that are not numbers", "left out: 1 lines of less than two vertices"]
        );
    }
}
