//! Builds a [`VectorLayer`] from the positions that a reader finds.
//!
//! A position has three numbers, the third NaN without an elevation. The builder leaves out and counts positions that
//! are not finite, lines of one vertex and rings of two. It removes the closing vertex of rings, and splits a feature
//! of several kinds of shape into one each for its points, lines and polygons.
//!
//! A record that cannot be read is left out, and the layer states where it is and why, so that one odd record does not
//! cost the others. Where none is sound the file is refused with the first error, and so it is where most coordinates
//! lie out of range: then their system is another.

use std::fmt::Display;
use std::iter;

use glam::{DVec2, DVec3};

use crate::broken_records::BrokenRecords;
use crate::error::VectorError;
use crate::feature::{Feature, Geometry, Polygon, Properties, VectorLayer};
use crate::tally::RecordTally;
use sandtable_geom::crs::Crs;

/// The vertices of a line or a ring.
pub(crate) type Vertices = Vec<DVec3>;

pub(crate) fn position(x: f64, y: f64, elevation: Option<f64>) -> DVec3 {
    DVec3::new(x, y, elevation.unwrap_or(f64::NAN))
}

pub(crate) struct LayerBuilder {
    crs: Crs,
    /// The records so far, also those left out.
    feature_count: usize,
    /// The records with a usable shape.
    sound_count: usize,
    features: Vec<Feature>,
    omitted: [RecordTally; OMISSIONS.len()],
    broken: BrokenRecords,
    out_of_range: BrokenRecords,
    notes: Vec<String>,
    faults: Vec<String>,
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
    Elevation,
}

/// How often each [`Omission`] occurred in a record.
type OmissionCounts = [usize; OMISSIONS.len()];

/// What was left out: one, and several.
const OMISSIONS: [[&str; 2]; 6] = [
    ["feature without a usable geometry", "features without a usable geometry"],
    ["position of less than two numbers", "positions of less than two numbers"],
    ["position that is not a number", "positions that are not numbers"],
    ["line of less than two vertices", "lines of less than two vertices"],
    ["ring of less than three vertices", "rings of less than three vertices"],
    ["elevation that is not a number", "elevations that are not numbers"],
];

impl LayerBuilder {
    pub fn new(crs: Crs) -> Self {
        Self {
            crs,
            feature_count: 0,
            sound_count: 0,
            features: Vec::new(),
            omitted: Default::default(),
            broken: BrokenRecords::default(),
            out_of_range: BrokenRecords::default(),
            notes: Vec::new(),
            faults: Vec::new(),
        }
    }

    /// Returns the system of the coordinates.
    pub fn crs(&self) -> &Crs {
        &self.crs
    }

    /// Adds the file's next feature. One without a usable shape, or with coordinates that cannot be of the layer's
    /// system, is counted and left out.
    pub fn add(&mut self, parts: FeatureParts, properties: Properties) {
        let number = self.feature_count + 1;
        self.add_at(parts, properties, || format!("feature {number}"));
    }

    /// [`Self::add`] of the record at a place of the file, which is computed where a message names it.
    pub fn add_at(&mut self, parts: FeatureParts, mut properties: Properties, place: impl Fn() -> String) {
        self.feature_count += 1;
        self.omitted[Omission::Feature as usize].add_many(usize::from(parts.is_empty()), &place);
        self.omitted.iter_mut().zip(parts.omitted).for_each(|(tally, count)| tally.add_many(count, &place));
        let shapes: Vec<_> = parts.into_shapes().collect();
        let checked =
            shapes.iter().try_for_each(|(geometry, _)| check_range(geometry, &self.crs, self.feature_count));
        if let Err(error) = checked {
            return self.out_of_range.add(place(), error);
        }
        self.sound_count += usize::from(!shapes.is_empty());
        let last = shapes.len().saturating_sub(1);
        for (index, (geometry, elevations)) in shapes.into_iter().enumerate() {
            let properties = if index == last { std::mem::take(&mut properties) } else { properties.clone() };
            self.features.push(Feature { geometry, elevations, properties });
        }
    }

    /// Leaves out the file's next feature, which cannot be read.
    pub fn add_broken(&mut self, place: impl Display, error: VectorError) {
        self.feature_count += 1;
        self.report_broken(place, error);
    }

    /// Reports a part of a feature that cannot be read, such as a point of a track, and is left out.
    pub fn report_broken(&mut self, place: impl Display, error: VectorError) {
        self.broken.add(place, error);
    }

    /// Returns how many features were added, with a usable shape or without.
    pub fn feature_count(&self) -> usize {
        self.feature_count
    }

    /// Returns whether no feature with a usable shape was added.
    pub fn is_empty(&self) -> bool {
        self.features.is_empty()
    }

    /// Returns whether some record could not be read.
    pub fn has_broken_records(&self) -> bool {
        self.broken.count() + self.out_of_range.count() > 0
    }

    /// Adds a note on how the file is read.
    pub fn note(&mut self, note: impl Into<String>) {
        self.notes.push(note.into());
    }

    /// Adds a note on something that is wrong with the file.
    pub fn fault(&mut self, fault: impl Into<String>) {
        self.faults.push(fault.into());
    }

    /// Notes what was counted as left out, if anything was.
    pub fn note_omitted(&mut self, tally: &RecordTally, one: &str, many: &str) {
        self.notes.extend(tally.text(one, many).map(|text| format!("left out: {text}")));
    }

    /// Returns the layer.
    ///
    /// # Errors
    /// The first error of a record where no record is sound, and [`VectorError::NotDegrees`] or
    /// [`VectorError::TooFar`] where more records lie out of range than within.
    pub fn finish(self) -> Result<VectorLayer, VectorError> {
        let Self { crs, features, omitted, broken, out_of_range, notes, mut faults, sound_count, .. } = self;
        faults.splice(0..0, broken.text().into_iter().chain(out_of_range.text()));
        if out_of_range.count() > sound_count {
            out_of_range.first_error()?;
        }
        if features.is_empty() {
            broken.first_error()?;
        }
        let counted = omitted.iter().zip(OMISSIONS).filter_map(|(tally, [one, many])| tally.text(one, many));
        let notes = counted.map(|text| format!("left out: {text}")).chain(notes).collect();
        Ok(VectorLayer { features, crs, notes, faults })
    }
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

    /// Counts an elevation that is there and is no number; its position is kept.
    pub fn count_elevation(&mut self) {
        self.omitted[Omission::Elevation as usize] += 1;
    }

    /// Returns how many vertices it has.
    pub fn vertex_count(&self) -> usize {
        let rings = self.polygons.iter().flatten();
        self.points.len() + self.lines.iter().chain(rings).map(Vec::len).sum::<usize>()
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
        builder.add(parts, Properties::new());
        builder.finish().expect("degrees")
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
            let mut builder = LayerBuilder::new(Crs::local());
            builder.add(parts, Properties::new());
            let read = builder.finish();
            assert_eq!(
                matches!(read, Err(VectorError::TooFar { feature: 1, .. })),
                is_refused,
                "{x}: {read:?}"
            );
        }
    }

    fn point(x: f64, y: f64) -> FeatureParts {
        let mut parts = FeatureParts::default();
        parts.add_points(vec![DVec3::new(x, y, f64::NAN)]);
        parts
    }

    #[test]
    fn few_records_out_of_range_are_left_out_and_many_refuse_the_layer() {
        let read = |latitudes: &[f64]| {
            let mut builder = LayerBuilder::new(Crs::wgs84());
            latitudes.iter().for_each(|&y| builder.add(point(1.0, y), Properties::new()));
            builder.finish()
        };
        let layer = read(&[1.0, 91.0]).expect("one of two");
        assert_eq!(layer.features.len(), 1);
        assert!(
            layer.faults[0]
                .starts_with("left out: 1 record that cannot be read: feature 2: a vertex at (1, 91)"),
            "{:?}",
            layer.faults
        );
        let error = read(&[1.0, 91.0, 92.0]).expect_err("two of three").to_string();
        assert!(error.contains("feature 2 has a vertex at (1, 91)"), "{error}");
    }

    #[test]
    fn broken_records_are_left_out_and_reported_unless_there_are_no_others() {
        let broken = |number: usize| VectorError::broken("file", format!("line {number}"), "no number");
        let mut builder = LayerBuilder::new(Crs::wgs84());
        (1..=5).for_each(|number| builder.add_broken(format!("line {number}"), broken(number)));
        builder.add(point(1.0, 2.0), Properties::new());
        let layer = builder.finish().expect("one is sound");
        let expected = "left out: 5 records that cannot be read: line 1: no number; line 2: no number; line 3: no number; ...";
        assert_eq!((layer.features.len(), &layer.faults[..]), (1, &[expected.to_owned()][..]));
        let mut alone = LayerBuilder::new(Crs::wgs84());
        alone.add_broken("line 7", broken(7));
        assert!(alone.finish().expect_err("nothing is sound").to_string().contains("line 7: no number"));
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
            [
                "left out: 2 positions that are not numbers (feature 1)",
                "left out: 1 line of less than two vertices (feature 1)"
            ]
        );
    }
}
