//! GPX 1.0 and 1.1 (Topografix, 2002 and 2004): what receivers record and planners draw, always on WGS 84.
//!
//! ```text
//! gpx ─┬─ wpt                    layer waypoints
//!      ├─ rte ── rtept           layer routes, a line each;  route_points
//!      └─ trk ── trkseg ── trkpt layer tracks, a line for each segment;  track_points
//! ```
//!
//! `ele` is the elevation of a point in meters. Extensions are not read.

use glam::DVec3;
use serde_json::{Number, Value};

use crate::geom::crs::Crs;
use crate::vector::collect::{Collector, FeatureParts, Properties, position};
use crate::vector::error::VectorError;
use crate::vector::feature::VectorLayer;
use crate::vector::xml::{self, Element, Xml};

const FORMAT: &str = "GPX file";
/// The layers that are chosen from where none is asked for, and those that are had by name besides.
const LAYERS: [&str; 5] = ["waypoints", "routes", "tracks", "route_points", "track_points"];
const MAIN_LAYERS: usize = 3;
/// The elements that become properties.
const PROPERTIES: [&str; 7] = ["name", "cmt", "desc", "src", "sym", "type", "number"];

/// One layer of a GPX file, `wanted`, or the only one that holds anything.
///
/// # Errors
/// [`VectorError`]; a point without latitude or longitude is one.
pub(super) fn read(
    bytes: &[u8],
    stated: Option<&Crs>,
    wanted: Option<&str>,
) -> Result<VectorLayer, VectorError> {
    let text = xml::decode(bytes, FORMAT)?;
    if let Some(wanted) = wanted.filter(|wanted| !LAYERS.contains(wanted)) {
        return Err(VectorError::no_such_layer(wanted, &LAYERS));
    }
    let crs = stated.cloned().unwrap_or_else(Crs::wgs84);
    let wanted = wanted.and_then(|wanted| LAYERS.iter().position(|&name| name == wanted));
    let mut file = GpxFile { layers: LAYERS.map(|_| Collector::new(crs.clone())), wanted };
    let mut xml = Xml::new(&text, FORMAT);
    xml.root()?;
    xml.children(|xml, element| file.read(xml, element))?;
    xml.end()?;
    let layers = file.layers.map(Collector::finish);
    let holding: Vec<usize> = (0..MAIN_LAYERS).filter(|&index| !layers[index].features.is_empty()).collect();
    let chosen = match (wanted, &holding[..]) {
        (Some(wanted), _) => wanted,
        (None, []) => 0,
        (None, &[only]) => only,
        (None, several) => {
            let names: Vec<&str> = several.iter().map(|&index| LAYERS[index]).collect();
            return Err(VectorError::which_layer(&names));
        }
    };
    Ok(layers.into_iter().nth(chosen).expect("chosen among them"))
}

struct GpxFile {
    layers: [Collector; LAYERS.len()],
    wanted: Option<usize>,
}

/// A point on the way.
struct GpxPoint {
    at: DVec3,
    properties: Properties,
}

impl GpxFile {
    fn read<'a>(&mut self, xml: &mut Xml<'a>, element: &Element<'a>) -> Result<(), VectorError> {
        match element.name() {
            "wpt" => {
                let point = self.point(xml, element, 0)?;
                self.add_point(0, point)
            }
            "rte" => self.route(xml),
            "trk" => self.track(xml),
            _ => xml.skip(),
        }
    }

    fn route(&mut self, xml: &mut Xml<'_>) -> Result<(), VectorError> {
        let (mut properties, mut line) = (Properties::new(), Vec::new());
        xml.children(|xml, element| match element.name() {
            "rtept" => self.way_point(xml, element, 3, &mut line),
            name => property(xml, name, &mut properties),
        })?;
        let mut parts = FeatureParts::default();
        if !line.is_empty() {
            parts.line(line);
        }
        self.layers[1].add(parts, properties)
    }

    fn track(&mut self, xml: &mut Xml<'_>) -> Result<(), VectorError> {
        let (mut properties, mut parts) = (Properties::new(), FeatureParts::default());
        xml.children(|xml, element| match element.name() {
            "trkseg" => {
                let mut line = Vec::new();
                xml.children(|xml, element| match element.name() {
                    "trkpt" => self.way_point(xml, element, 4, &mut line),
                    _ => xml.skip(),
                })?;
                parts.line(line);
                Ok(())
            }
            name => property(xml, name, &mut properties),
        })?;
        self.layers[2].add(parts, properties)
    }

    /// A point of a route or a track: a vertex of its line, and a feature of the layer `points` if that is wanted.
    fn way_point<'a>(
        &mut self,
        xml: &mut Xml<'a>,
        element: &Element<'a>,
        points: usize,
        line: &mut Vec<DVec3>,
    ) -> Result<(), VectorError> {
        let point = self.point(xml, element, points)?;
        line.push(point.at);
        if self.wanted == Some(points) { self.add_point(points, point) } else { Ok(()) }
    }

    fn add_point(&mut self, layer: usize, point: GpxPoint) -> Result<(), VectorError> {
        let mut parts = FeatureParts::default();
        parts.point(point.at);
        self.layers[layer].add(parts, point.properties)
    }

    /// The point that `element` is; its properties only where they are for the layer `layer` and that is wanted.
    fn point<'a>(
        &self,
        xml: &mut Xml<'a>,
        element: &Element<'a>,
        layer: usize,
    ) -> Result<GpxPoint, VectorError> {
        let (Some(x), Some(y)) = (element.number("lon"), element.number("lat")) else {
            return Err(xml.broken("a point has no latitude (lat) or longitude (lon) that is a number"));
        };
        let keeps = self.wanted == Some(layer) || layer < MAIN_LAYERS;
        let (mut elevation, mut properties) = (None, Properties::new());
        xml.children(|xml, element| match element.name() {
            "ele" => {
                elevation = xml.text()?.parse().ok();
                Ok(())
            }
            "time" if keeps => {
                let time = xml.text()?;
                properties.insert("time".into(), time.into());
                Ok(())
            }
            name if keeps => property(xml, name, &mut properties),
            _ => xml.skip(),
        })?;
        if let Some(number) = elevation.and_then(Number::from_f64).filter(|_| keeps) {
            properties.insert("ele".into(), Value::Number(number));
        }
        Ok(GpxPoint { at: position(x, y, elevation), properties })
    }
}

/// Keeps the element just opened as a property, if it is one of those.
fn property(xml: &mut Xml<'_>, name: &str, properties: &mut Properties) -> Result<(), VectorError> {
    if !PROPERTIES.contains(&name) {
        return xml.skip();
    }
    let text = xml.text()?;
    properties.insert(name.into(), text.into());
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = r#"<?xml version="1.0"?><gpx version="1.1"><metadata><name>x</name></metadata>
        <wpt lat="48" lon="15"><ele>512.5</ele><name>Summit</name><time>2020-01-01T00:00:00Z</time></wpt>
        <trk><name>Way</name><trkseg><trkpt lat="48" lon="15"><ele>1</ele></trkpt><trkpt lat="49" lon="16"/></trkseg>
        <trkseg><trkpt lat="50" lon="15"/><trkpt lat="51" lon="15"/><trkpt lat="52" lon="15"/></trkseg></trk></gpx>"#;

    fn layer(wanted: &str) -> VectorLayer {
        read(TEXT.as_bytes(), None, Some(wanted)).expect(wanted)
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
        let error = read(TEXT.as_bytes(), None, None).expect_err("two").to_string();
        assert!(error.contains("2 layers") && error.contains("waypoints, tracks"), "{error}");
        let error = read(TEXT.as_bytes(), None, Some("track")).expect_err("none").to_string();
        assert!(error.contains("did you mean 'tracks'?"), "{error}");
    }

    #[test]
    fn a_file_cut_anywhere_is_refused() {
        for end in 0..TEXT.len() {
            assert!(read(&TEXT.as_bytes()[..end], None, Some("tracks")).is_err(), "{end}");
        }
        let error =
            read(b"<gpx>\n<wpt lat='x' lon='2'/></gpx>", None, None).expect_err("no number").to_string();
        assert!(error.contains("line 2") && error.contains("(lat)"), "{error}");
    }
}
