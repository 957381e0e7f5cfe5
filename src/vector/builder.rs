//! Builds a [`VectorLayer`] from the positions that a reader finds.
//!
//! A position has three numbers, the third NaN without an elevation. The builder leaves out and counts positions that
//! are not finite, lines of one vertex and rings of two. It removes the closing vertex of rings, and splits a feature
//! of several kinds of shape into one each for its points, lines and polygons.

use std::iter;

use glam::{DVec2, DVec3};

use crate::error::VectorError;
use crate::feature::{Feature, Geometry, Polygon, Properties, VectorLayer};
use sandtable_geom::crs::Crs;

/// The vertices of a line or a ring.
pub(crate) type Vertices = Vec<DVec3>;

pub(crate) fn position(x: f64, y: f64, elevation: Option<f64>) -> DVec3 {
    DVec3::new(x, y, elevation.unwrap_or(f64::NAN))
}

pub(crate) struct LayerBuilder {
    crs: Crs,
    feature_count: usize,
    features: Vec<Feature>,
    omitted: OmissionCounts,
    notes: Vec<String>,
}

#[derive(Default)]
pub(crate) struct FeatureParts {
    points: Vertices,
    lines: Vec<Vertices>,
    /// Each its rings, the outer one first, none of them closed.
    polygons: Vec<Vec<Vertices>>,
    omitted: OmissionCounts,
}

#[derive(Clone, Copy)]
enum Omission {
    Feature,
    ShortPosition,
    PositionNotFinite,
    ShortLine,
    SmallRing,
}

/// How often each [`Omission`] occurred.
type OmissionCounts = [usize; 5];

const OMISSIONS: [&str; 5] = [
    "features without a usable geometry",
    "positions of less than two numbers",
    "positions that are not numbers",
    "lines of less than two vertices",
    "rings of less than three vertices",
];

impl LayerBuilder {
    pub fn new(crs: Crs) -> Self {
        let omitted = OmissionCounts::default();
        Self { crs, feature_count: 0, features: Vec::new(), omitted, notes: Vec::new() }
    }

    /// Adds the file's next feature. One without a usable shape is counted and left out.
    ///
    /// # Errors
    /// [`VectorError::NotDegrees`] or [`VectorError::TooFar`].
    pub fn add(&mut self, parts: FeatureParts, mut properties: Properties) -> Result<(), VectorError> {
        self.feature_count += 1;
        self.omitted[Omission::Feature as usize] += usize::from(parts.is_empty());
        self.omitted.iter_mut().zip(parts.omitted).for_each(|(sum, count)| *sum += count);
        let mut shapes = parts.into_shapes().peekable();
        while let Some((geometry, elevations)) = shapes.next() {
            check_range(&geometry, &self.crs, self.feature_count)?;
            let is_last = shapes.peek().is_none();
            let properties = if is_last { std::mem::take(&mut properties) } else { properties.clone() };
            self.features.push(Feature { geometry, elevations, properties });
        }
        Ok(())
    }

    /// Returns how many features were added, with a usable shape or without.
    pub fn feature_count(&self) -> usize {
        self.feature_count
    }

    /// Returns whether no feature with a usable shape was added.
    pub fn is_empty(&self) -> bool {
        self.features.is_empty()
    }

    pub fn note(&mut self, note: impl Into<String>) {
        self.notes.push(note.into());
    }

    /// Notes that `count` of something were left out, if any.
    pub fn note_omitted(&mut self, count: usize, what: &str) {
        self.notes.extend(omission_note(count, what));
    }

    pub fn finish(self) -> VectorLayer {
        let counted = self.omitted.into_iter().zip(OMISSIONS);
        let notes =
            counted.filter_map(|(count, what)| omission_note(count, what)).chain(self.notes).collect();
        VectorLayer { features: self.features, crs: self.crs, notes }
    }
}

fn omission_note(count: usize, what: &str) -> Option<String> {
    (count > 0).then(|| format!("left out: {count} {what}"))
}

impl FeatureParts {
    pub fn add_points(&mut self, mut points: Vertices) {
        self.keep_finite(&mut points);
        self.points.append(&mut points);
    }

    /// Adds a line; one of less than two vertices is left out.
    pub fn add_line(&mut self, mut vertices: Vertices) {
        self.keep_finite(&mut vertices);
        if vertices.len() < 2 {
            self.omitted[Omission::ShortLine as usize] += 1;
        } else {
            self.lines.push(vertices);
        }
    }

    /// Adds a polygon, its outer ring first, closed or not. Rings of less than three vertices are left out, and with
    /// the outer ring the polygon.
    pub fn add_polygon(&mut self, rings: impl IntoIterator<Item = Vertices>) {
        let mut rings = rings.into_iter().map(|mut ring| {
            self.keep_finite(&mut ring);
            let ring = open_ring(ring);
            self.omitted[Omission::SmallRing as usize] += usize::from(ring.is_none());
            ring
        });
        let exterior = rings.next().flatten();
        let holes: Vec<Vertices> = rings.flatten().collect();
        self.polygons.extend(exterior.map(|exterior| iter::once(exterior).chain(holes).collect()));
    }

    pub fn count_short_position(&mut self) {
        self.omitted[Omission::ShortPosition as usize] += 1;
    }

    pub fn is_empty(&self) -> bool {
        self.points.is_empty() && self.lines.is_empty() && self.polygons.is_empty()
    }

    fn keep_finite(&mut self, vertices: &mut Vertices) {
        let count = vertices.len();
        vertices.retain(|vertex| vertex.truncate().is_finite());
        self.omitted[Omission::PositionNotFinite as usize] += count - vertices.len();
    }

    fn into_shapes(self) -> impl Iterator<Item = (Geometry, Option<Vec<f64>>)> {
        let Self { points, lines, polygons, .. } = self;
        let points = (!points.is_empty()).then(|| {
            let elevations = elevations(points.iter());
            (Geometry::Points(flat(points)), elevations)
        });
        let lines = (!lines.is_empty()).then(|| {
            let elevations = elevations(lines.iter().flatten());
            (Geometry::Lines(lines.into_iter().map(flat).collect()), elevations)
        });
        let polygons = (!polygons.is_empty()).then(|| {
            let elevations = elevations(polygons.iter().flatten().flatten());
            let polygon = |rings: Vec<Vertices>| {
                let mut rings = rings.into_iter().map(flat);
                Polygon { exterior: rings.next().unwrap_or_default(), holes: rings.collect() }
            };
            (Geometry::Polygons(polygons.into_iter().map(polygon).collect()), elevations)
        });
        points.into_iter().chain(lines).chain(polygons)
    }
}

/// Returns the elevation of each vertex, or `None` where no vertex has one.
fn elevations<'a>(vertices: impl Iterator<Item = &'a DVec3> + Clone) -> Option<Vec<f64>> {
    let any = vertices.clone().any(|vertex| vertex.z.is_finite());
    let elevation = |vertex: &DVec3| if vertex.z.is_finite() { vertex.z } else { f64::NAN };
    any.then(|| vertices.map(elevation).collect())
}

fn flat(vertices: Vertices) -> Vec<DVec2> {
    vertices.into_iter().map(DVec3::truncate).collect()
}

/// Returns the ring without its closing vertices, or `None` where fewer than three remain.
fn open_ring(mut ring: Vertices) -> Option<Vertices> {
    while let [first, .., last] = ring[..]
        && first.truncate() == last.truncate()
    {
        ring.pop();
    }
    (ring.len() >= 3).then_some(ring)
}

/// Refuses coordinates that cannot be of the system: beyond the degrees there are, or farther from its origin than the
/// scene file may state points.
fn check_range(geometry: &Geometry, crs: &Crs, feature: usize) -> Result<(), VectorError> {
    /// Twice round from the prime meridian, for lines that cross the antimeridian.
    const MAX_LONGITUDE: f64 = 360.0;
    /// In units of the system; no projection of the Earth reaches as far in any.
    const FARTHEST: f64 = 1e9;
    if crs.is_geographic() {
        let is_outside = |vertex: &&DVec2| vertex.x.abs() > MAX_LONGITUDE || vertex.y.abs() > 90.0;
        return match geometry.vertices().find(is_outside) {
            Some(at) => Err(VectorError::NotDegrees { feature, x: at.x, y: at.y, crs: crs.name().into() }),
            None => Ok(()),
        };
    }
    match geometry.vertices().find(|vertex| vertex.abs().max_element() > FARTHEST) {
        Some(at) => Err(VectorError::TooFar { feature, x: at.x, y: at.y }),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn layer(parts: FeatureParts) -> VectorLayer {
        let mut builder = LayerBuilder::new(Crs::wgs84());
        builder.add(parts, Properties::new()).expect("degrees");
        builder.finish()
    }

    #[test]
    fn elevations_follow_the_vertices_and_rings_lose_their_closing_one() {
        let ring =
            |z: f64| [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (0.0, 0.0)].map(|(x, y)| DVec3::new(x, y, z));
        let mut parts = FeatureParts::default();
        parts.add_polygon([ring(1.0).to_vec(), ring(f64::NAN).to_vec(), ring(3.0).to_vec()]);
        let layer = layer(parts);
        let [feature] = &layer.features[..] else { panic!("one feature") };
        let elevations = feature.elevations.as_ref().expect("known");
        assert_eq!(elevations.len(), feature.geometry.vertices().count());
        assert_eq!(elevations[..3], [1.0; 3]);
        assert!(elevations[3..6].iter().all(|elevation| elevation.is_nan()));
        assert_eq!(elevations[6..], [3.0; 3]);
    }

    #[test]
    fn coordinates_that_no_system_has_are_refused() {
        for (x, is_refused) in [(-9.99e8, false), (1.1e9, true), (1e308, true)] {
            let mut parts = FeatureParts::default();
            parts.add_line(vec![DVec3::new(1.0, 2.0, f64::NAN), DVec3::new(x, 0.0, f64::NAN)]);
            let added = LayerBuilder::new(Crs::local()).add(parts, Properties::new());
            assert_eq!(
                matches!(added, Err(VectorError::TooFar { feature: 1, .. })),
                is_refused,
                "{x}: {added:?}"
            );
        }
    }

    #[test]
    fn positions_that_are_not_numbers_are_left_out_and_noted() {
        let mut parts = FeatureParts::default();
        parts.add_line(vec![DVec3::new(1.0, 2.0, f64::NAN), DVec3::NAN, DVec3::new(f64::INFINITY, 0.0, 0.0)]);
        parts.add_points(vec![DVec3::new(1.0, 2.0, f64::NAN)]);
        let layer = layer(parts);
        assert_eq!(layer.features.len(), 1);
        assert_eq!(layer.features[0].elevations, None);
        assert_eq!(
            layer.notes,
            ["left out: 2 positions that are not numbers", "left out: 1 lines of less than two vertices"]
        );
    }
}
