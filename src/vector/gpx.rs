//! GPX 1.0 and 1.1 (Topografix, 2002 and 2004): waypoints, routes and tracks on WGS 84.
//!
//! ```text
//! gpx ─┬─ wpt                    layer waypoints
//!      ├─ rte ── rtept           layer routes, a line each;  route_points
//!      └─ trk ── trkseg ── trkpt layer tracks, a line for each segment;  track_points
//! ```
//!
//! `ele` is the elevation of a point in meters. Extensions are not read.
//!
//! Written by hand. `gpx` 0.10 refuses valid files: those with `magvar` (GPX 1.1), with `course` or the elements of
//! other namespaces (GPX 1.0), and with times that are dates. It refuses 180° E, rewrites times, reports no lines, and
//! builds six more crates.

use glam::DVec3;
use serde_json::Number;

use crate::builder::{FeatureParts, LayerBuilder, Vertices, position};
use crate::error::VectorError;
use crate::feature::{Properties, VectorLayer};
use crate::hints::VectorHints;
use crate::xml::{self, DecodedXml, XmlElement, XmlReader};
use sandtable_geom::crs::Crs;

const FORMAT: &str = "GPX file";
/// The first three are the choice where none is requested; the others are only read by name.
const LAYERS: [&str; 5] = ["waypoints", "routes", "tracks", "route_points", "track_points"];
const MAIN_LAYERS: usize = 3;
const WAYPOINTS: usize = 0;
const ROUTES: usize = 1;
const TRACKS: usize = 2;
const ROUTE_POINTS: usize = 3;
const TRACK_POINTS: usize = 4;
/// The elements that become properties.
const PROPERTIES: [&str; 7] = ["name", "cmt", "desc", "src", "sym", "type", "number"];

/// Reads the requested layer, or the only one that holds anything.
///
/// Points without latitude and longitude on Earth are left out and reported.
///
/// # Errors
/// [`VectorError`], also where no point of the layer is sound.
pub(super) fn read(bytes: &[u8], hints: &VectorHints) -> Result<VectorLayer, VectorError> {
    let DecodedXml { text, fault } = xml::decode(bytes, FORMAT)?;
    let wanted = hints.layer.map(|_| hints.choose_layer(&LAYERS)).transpose()?;
    let layers = LAYERS.map(|_| LayerBuilder::new(hints.crs_or_wgs84()));
    let is_geographic = hints.crs.is_none_or(Crs::is_geographic);
    let mut reader = GpxReader { xml: XmlReader::new(&text, FORMAT), layers, wanted, is_geographic };
    reader.read()?;
    let has_features = |index: &usize| !reader.layers[*index].is_empty();
    let chosen = match (wanted, &(0..MAIN_LAYERS).filter(has_features).collect::<Vec<_>>()[..]) {
        (Some(wanted), _) => wanted,
        (None, []) => {
            let is_broken = |index: &usize| reader.layers[*index].has_broken_records();
            (0..MAIN_LAYERS).find(is_broken).unwrap_or(WAYPOINTS)
        }
        (None, &[only]) => only,
        (None, several) => {
            let names: Vec<&str> = several.iter().map(|&index| LAYERS[index]).collect();
            return Err(VectorError::which_layer(&names));
        }
    };
    let mut layer = reader.layers.into_iter().nth(chosen).expect("an index of a layer");
    fault.into_iter().for_each(|fault| layer.fault(fault));
    layer.finish()
}

struct GpxReader<'a> {
    xml: XmlReader<'a>,
    layers: [LayerBuilder; LAYERS.len()],
    wanted: Option<usize>,
    /// Whether coordinates are degrees, as they are unless another system is stated.
    is_geographic: bool,
}

/// A point's position.
struct GpxPosition {
    position: DVec3,
    /// Whether it has an elevation that is no number.
    has_unread_elevation: bool,
}

impl<'a> GpxReader<'a> {
    fn read(&mut self) -> Result<(), VectorError> {
        self.xml.root()?;
        while let Some(child) = self.xml.next_child()? {
            match child.name() {
                "wpt" => {
                    let point = self.xml.read(child)?;
                    self.add_point(WAYPOINTS, &point);
                }
                "rte" => self.read_route()?,
                "trk" => self.read_track()?,
                _ => self.xml.skip()?,
            }
        }
        self.xml.finish()
    }

    fn read_route(&mut self) -> Result<(), VectorError> {
        let (mut properties, mut parts) = (Properties::new(), FeatureParts::default());
        let (mut line, start) = (Vertices::new(), self.xml.offset());
        while let Some(child) = self.xml.next_child()? {
            match child.name() {
                "rtept" => line.extend(self.read_vertex(child, [ROUTES, ROUTE_POINTS], &mut parts)?),
                _ => self.read_property(child, &mut properties)?,
            }
        }
        if !line.is_empty() {
            parts.add_line(line);
        }
        let xml = &self.xml;
        self.layers[ROUTES].add_at(parts, properties, || xml.line_at(start));
        Ok(())
    }

    fn read_track(&mut self) -> Result<(), VectorError> {
        let (mut properties, mut parts) = (Properties::new(), FeatureParts::default());
        let start = self.xml.offset();
        while let Some(child) = self.xml.next_child()? {
            match child.name() {
                "trkseg" => {
                    let line = self.read_segment(&mut parts)?;
                    parts.add_line(line);
                }
                _ => self.read_property(child, &mut properties)?,
            }
        }
        let xml = &self.xml;
        self.layers[TRACKS].add_at(parts, properties, || xml.line_at(start));
        Ok(())
    }

    fn read_segment(&mut self, parts: &mut FeatureParts) -> Result<Vertices, VectorError> {
        let mut line = Vertices::new();
        while let Some(child) = self.xml.next_child()? {
            match child.name() {
                "trkpt" => line.extend(self.read_vertex(child, [TRACKS, TRACK_POINTS], parts)?),
                _ => self.xml.skip()?,
            }
        }
        Ok(line)
    }

    /// Reads a point of a line of a layer, and adds it to the layer of points where that is requested; `None` for one
    /// that is left out.
    fn read_vertex(
        &mut self,
        element: XmlElement<'a>,
        [lines, points]: [usize; 2],
        parts: &mut FeatureParts,
    ) -> Result<Option<DVec3>, VectorError> {
        let point = self.xml.read(element)?;
        if self.wanted == Some(points) {
            self.add_point(points, &point);
        }
        Ok(match self.position(&point) {
            Ok(GpxPosition { position, has_unread_elevation }) => {
                if has_unread_elevation {
                    parts.count_elevation();
                }
                Some(position)
            }
            Err(error) => {
                self.layers[lines].report_broken("a point", error);
                None
            }
        })
    }

    fn read_property(
        &mut self,
        element: XmlElement<'a>,
        properties: &mut Properties,
    ) -> Result<(), VectorError> {
        if !PROPERTIES.contains(&element.name()) {
            return self.xml.skip();
        }
        let element = self.xml.read(element)?;
        properties.insert(element.name().into(), element.text().into());
        Ok(())
    }

    fn add_point(&mut self, layer: usize, point: &XmlElement<'_>) {
        let GpxPosition { position, has_unread_elevation } = match self.position(point) {
            Ok(position) => position,
            Err(error) => return self.layers[layer].add_broken("a point", error),
        };
        let is_property =
            |child: &&XmlElement<'_>| PROPERTIES.contains(&child.name()) || child.name() == "time";
        let property = |child: &XmlElement<'_>| (child.name().to_owned(), child.text().into());
        let mut properties: Properties = point.children().filter(is_property).map(property).collect();
        if let Some(elevation) = Number::from_f64(position.z) {
            properties.insert("ele".into(), elevation.into());
        }
        let mut parts = FeatureParts::default();
        parts.add_points(vec![position]);
        if has_unread_elevation {
            parts.count_elevation();
        }
        let xml = &self.xml;
        self.layers[layer].add_at(parts, properties, || xml.line_of(point));
    }

    fn position(&self, point: &XmlElement<'_>) -> Result<GpxPosition, VectorError> {
        /// Twice round from the prime meridian, for lines that cross the antimeridian.
        const MAX_LONGITUDE: f64 = 360.0;
        let text = point.children_named("ele").last().map(XmlElement::text).filter(|text| !text.is_empty());
        let elevation = text.as_ref().and_then(|text| text.parse().ok());
        let has_unread_elevation = text.is_some() && elevation.is_none();
        let is_on_earth =
            |x: f64, y: f64| !self.is_geographic || (x.abs() <= MAX_LONGITUDE && y.abs() <= 90.0);
        match (point.number("lon"), point.number("lat")) {
            (Some(x), Some(y)) if is_on_earth(x, y) => {
                Ok(GpxPosition { position: position(x, y, elevation), has_unread_elevation })
            }
            (Some(x), Some(y)) => Err(self
                .xml
                .broken_at(point, format!("a point at latitude {y} and longitude {x} is not on Earth"))),
            _ => {
                let reason = "a point has no latitude (lat) or longitude (lon) that is a number";
                Err(self.xml.broken_at(point, reason))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = r#"<?xml version="1.0"?><gpx version="1.1"><metadata><name>x</name></metadata>
        <wpt lat="48" lon="15"><ele>512.5</ele><name>Summit</name><time>2020-01-01T00:00:00Z</time></wpt>
        <trk><name>Way</name><trkseg><trkpt lat="48" lon="15"><ele>1</ele></trkpt><trkpt lat="49" lon="16"/></trkseg>
        <trkseg><trkpt lat="50" lon="15"/><trkpt lat="51" lon="15"/><trkpt lat="52" lon="15"/></trkseg></trk></gpx>"#;

    fn read_layer(bytes: &[u8], layer: Option<&str>) -> Result<VectorLayer, VectorError> {
        read(bytes, &VectorHints { layer, ..VectorHints::default() })
    }

    fn layer(wanted: &str) -> VectorLayer {
        read_layer(TEXT.as_bytes(), Some(wanted)).expect(wanted)
    }

    #[test]
    fn tracks_have_a_line_for_each_segment_and_elevations_where_there_are() {
        let tracks = layer("tracks");
        let [track] = &tracks.features[..] else { panic!("one track") };
        assert_eq!(track.lines().iter().map(Vec::len).collect::<Vec<_>>(), [2, 3]);
        assert_eq!(track.properties["name"], "Way");
        assert_eq!(track.elevations.as_ref().expect("one is known")[0], 1.0);
        assert_eq!(tracks.crs.epsg(), Some(4326));
    }

    #[test]
    fn points_have_their_name_time_and_elevation() {
        let waypoints = layer("waypoints");
        let [point] = &waypoints.features[..] else { panic!("one point") };
        assert_eq!(point.elevations, Some(vec![512.5]));
        assert_eq!((&point.properties["name"], &point.properties["ele"]), (&"Summit".into(), &512.5.into()));
        assert_eq!(layer("track_points").features.len(), 5);
        assert!(layer("routes").features.is_empty());
    }

    #[test]
    fn one_of_several_layers_must_be_asked_for_by_its_name() {
        let error = read_layer(TEXT.as_bytes(), None).expect_err("two").to_string();
        assert!(error.contains("2 layers") && error.contains("waypoints, tracks"), "{error}");
        let error = read_layer(TEXT.as_bytes(), Some("track")).expect_err("none").to_string();
        assert!(error.contains("did you mean 'tracks'?"), "{error}");
    }

    #[test]
    fn a_point_without_a_place_is_left_out_of_its_line_and_reported() {
        let text = "<gpx>\n<wpt lat='1' lon='1'/><wpt lat='x' lon='2'/><trk><trkseg>\n<trkpt lat='1' lon='2'/>
            <trkpt lon='2'/>\n<trkpt lat='95' lon='2'/><trkpt lat='3' lon='4'><ele>high</ele></trkpt></trkseg></trk></gpx>";
        let tracks = read_layer(text.as_bytes(), Some("tracks")).expect("two points are sound");
        assert_eq!(tracks.features[0].lines()[0].len(), 2);
        let [fault] = &tracks.faults[..] else { panic!("one sentence: {:?}", tracks.faults) };
        for part in ["2 records", "line 4: a point has no latitude", "line 5: a point at latitude 95"] {
            assert!(fault.contains(part), "{fault}");
        }
        assert_eq!(tracks.notes, ["left out: 1 elevation that is not a number (line 2)"]);
        let waypoints = read_layer(text.as_bytes(), Some("waypoints")).expect("one point is sound");
        assert_eq!((waypoints.features.len(), waypoints.faults.len()), (1, 1));
    }

    #[test]
    fn a_file_cut_anywhere_is_refused() {
        for end in 0..TEXT.len() {
            assert!(read_layer(&TEXT.as_bytes()[..end], Some("tracks")).is_err(), "{end}");
        }
        let error =
            read_layer(b"<gpx>\n<wpt lat='x' lon='2'/></gpx>", None).expect_err("no number").to_string();
        assert!(error.contains("line 2") && error.contains("(lat)"), "{error}");
    }
}
