//! KML 2.2 (OGC 07-147r2, 2008): placemarks, on WGS 84.
//!
//! Every placemark is a feature. Its properties are `name`, `description`, `folder` (the folder or document that holds
//! it, whose name also requests it as a layer), `altitudeMode`, its extended data as text, and its style and times by the
//! names of [`overlay_schema`](crate::overlay_schema). Overlays, models and links are not read.
//!
//! Altitudes are meters above sea level, which become elevations. Where `altitudeMode` makes them relative to the
//! ground they do not; nor where all are 0 and the mode is not `absolute`, since programs fill in 0.
//!
//! Written by hand. `kml` 0.15 never returns on a file cut short, refuses `<br/>` in a description and a space behind a
//! comma, drops `gx:Track`, takes an absent `altitudeMode` for `clampToGround`, and builds a second `quick-xml`.

use glam::DVec3;

use crate::builder::{FeatureParts, LayerBuilder, Vertices, position};
use crate::error::{VectorError, shorten};
use crate::feature::{Properties, VectorLayer};
use crate::hints::VectorHints;
use crate::kml_style::{self, KmlStyles};
use crate::tally::RecordTally;
use crate::xml::{self, DecodedXml, XmlElement, XmlReader};

const FORMAT: &str = "KML file";

/// Reads all placemarks, or those in the folders that have the name of the requested layer. Placemarks with coordinates
/// that are not numbers are left out and reported.
///
/// # Errors
/// [`VectorError`], also where no placemark is sound.
pub(super) fn read(bytes: &[u8], hints: &VectorHints) -> Result<VectorLayer, VectorError> {
    let DecodedXml { text, fault } = xml::decode(bytes, FORMAT)?;
    let mut reader = KmlReader {
        xml: XmlReader::new(&text, FORMAT),
        wanted: hints.layer,
        folders: Vec::new(),
        layer: LayerBuilder::new(hints.crs_or_wgs84()),
        styles: KmlStyles::default(),
        unplaced: RecordTally::new(),
    };
    let root = reader.xml.root()?;
    match root.name() {
        "kml" => reader.read_container()?,
        _ => reader.read_feature(root, "")?,
    }
    reader.xml.finish()?;
    let names: Vec<&str> = reader.folders.iter().map(String::as_str).collect();
    match reader.wanted.filter(|wanted| !names.contains(wanted)) {
        Some(wanted) => Err(VectorError::no_such_layer(wanted, &names)),
        None => {
            let (one, many) =
                ("moment of a track without a position", "moments of tracks without a position");
            reader.layer.note_omitted(&reader.unplaced, one, many);
            fault.into_iter().for_each(|fault| reader.layer.fault(fault));
            reader.layer.finish()
        }
    }
}

struct KmlReader<'a> {
    xml: XmlReader<'a>,
    wanted: Option<&'a str>,
    /// The names of the folders that hold placemarks, in order.
    folders: Vec<String>,
    layer: LayerBuilder,
    styles: KmlStyles,
    /// Moments of tracks without a position, which KML allows.
    unplaced: RecordTally,
}

#[derive(Default)]
struct Placemark {
    parts: FeatureParts,
    properties: Properties,
    unplaced: usize,
    /// The errors of moments of tracks, which are left out.
    broken: Vec<VectorError>,
}

/// A tuple of coordinates.
struct KmlTuple {
    position: DVec3,
    /// Whether it has an altitude that is no number.
    has_unread_altitude: bool,
}

/// A tuple of coordinates that has no longitude or no latitude.
#[derive(Debug, thiserror::Error)]
#[error("'{0}' is not longitude and latitude")]
struct InvalidTuple(String);

impl<'a> KmlReader<'a> {
    /// Reads the content of the folder or document just opened.
    fn read_container(&mut self) -> Result<(), VectorError> {
        let mut name = String::new();
        while let Some(child) = self.xml.next_child()? {
            match child.name() {
                "name" => name = self.xml.read(child)?.text(),
                _ => self.read_feature(child, &name)?,
            }
        }
        Ok(())
    }

    fn read_feature(&mut self, element: XmlElement<'a>, folder: &str) -> Result<(), VectorError> {
        match element.name() {
            "Document" | "Folder" => self.read_container(),
            "Placemark" => {
                let element = self.xml.read(element)?;
                self.add(&element, folder);
                Ok(())
            }
            "Style" | "StyleMap" => {
                let element = self.xml.read(element)?;
                self.styles.add(&element);
                Ok(())
            }
            _ => self.xml.skip(),
        }
    }

    fn add(&mut self, element: &XmlElement<'_>, folder: &str) {
        if !folder.is_empty() && !self.folders.iter().any(|known| known == folder) {
            self.folders.push(folder.to_owned());
        }
        if self.wanted.is_some_and(|wanted| wanted != folder) {
            return;
        }
        let line = || self.xml.line_of(element);
        match self.placemark(element) {
            Ok(mut placemark) => {
                if !folder.is_empty() {
                    placemark.properties.insert("folder".into(), folder.into());
                }
                self.unplaced.add_many(placemark.unplaced, line);
                for error in placemark.broken {
                    self.layer.report_broken("a track", error);
                }
                self.layer.add_at(placemark.parts, placemark.properties, line);
            }
            Err(error) => self.layer.add_broken("a placemark", error),
        }
    }

    fn placemark(&self, element: &XmlElement<'_>) -> Result<Placemark, VectorError> {
        let mut placemark = Placemark::default();
        for child in element.children() {
            match child.name() {
                name @ ("name" | "description") => {
                    placemark.properties.insert(name.into(), child.text().into());
                }
                "ExtendedData" => placemark.add_extended_data(child),
                "TimeSpan" | "TimeStamp" => kml_style::add_time(child, &mut placemark.properties),
                _ => self.add_shape(child, &mut placemark)?,
            }
        }
        self.styles.apply(element, &mut placemark.properties);
        Ok(placemark)
    }

    fn add_shape(&self, element: &XmlElement<'_>, placemark: &mut Placemark) -> Result<(), VectorError> {
        match element.name() {
            "MultiGeometry" | "MultiTrack" => {
                element.children().try_for_each(|child| self.add_shape(child, placemark))?;
            }
            "Point" => {
                let lists = self.vertex_lists(element, placemark)?;
                placemark.parts.add_points(lists.concat());
            }
            "LineString" | "LinearRing" | "Track" => {
                let lists = self.vertex_lists(element, placemark)?;
                lists.into_iter().for_each(|line| placemark.parts.add_line(line));
            }
            "Polygon" => {
                let rings = self.vertex_lists(element, placemark)?;
                if !rings.is_empty() {
                    placemark.parts.add_polygon(rings);
                }
            }
            _ => {}
        }
        Ok(())
    }

    /// Returns the vertices of a shape by line or ring, the outer ring first, with altitudes where they are elevations.
    fn vertex_lists(
        &self,
        shape: &XmlElement<'_>,
        placemark: &mut Placemark,
    ) -> Result<Vec<Vertices>, VectorError> {
        let (mut lists, mut inner, mut track) = (Vec::new(), Vec::new(), Vertices::new());
        for child in shape.children() {
            match child.name() {
                "coordinates" => lists.push(self.coordinates(child, placemark)?),
                // Of a gx:Track: "longitude latitude altitude", or nothing at a moment without a position.
                "coord" => match child.text() {
                    text if text.is_empty() => placemark.unplaced += 1,
                    text => match self.check(child, tuple(text.split_whitespace())) {
                        Ok(tuple) => track.push(placemark.position(&tuple)),
                        Err(error) => placemark.broken.push(error),
                    },
                },
                "outerBoundaryIs" => lists.extend(self.rings(child, placemark)?),
                "innerBoundaryIs" => inner.extend(self.rings(child, placemark)?),
                _ => {}
            }
        }
        // Holes of nothing are no polygon.
        if !lists.is_empty() {
            lists.append(&mut inner);
        }
        if !track.is_empty() {
            lists.push(track);
        }
        let mode = shape.children_named("altitudeMode").last().map(XmlElement::text).unwrap_or_default();
        let is_flat = lists.iter().flatten().all(|vertex| vertex.z == 0.0 || vertex.z.is_nan());
        if mode.starts_with("relative") || (mode != "absolute" && is_flat) {
            lists.iter_mut().flatten().for_each(|vertex| vertex.z = f64::NAN);
        }
        if !mode.is_empty() {
            placemark.properties.entry("altitudeMode".into()).or_insert_with(|| mode.into());
        }
        Ok(lists)
    }

    fn rings(
        &self,
        boundary: &XmlElement<'_>,
        placemark: &mut Placemark,
    ) -> Result<Vec<Vertices>, VectorError> {
        let rings = boundary.children_named("LinearRing");
        rings
            .flat_map(|ring| ring.children_named("coordinates"))
            .map(|element| self.coordinates(element, placemark))
            .collect()
    }

    fn coordinates(
        &self,
        element: &XmlElement<'_>,
        placemark: &mut Placemark,
    ) -> Result<Vertices, VectorError> {
        let tuples = self.check(element, tuples(&element.text()))?;
        Ok(tuples.iter().map(|tuple| placemark.position(tuple)).collect())
    }

    fn check<T>(&self, element: &XmlElement<'_>, result: Result<T, InvalidTuple>) -> Result<T, VectorError> {
        result.map_err(|error| self.xml.broken_at(element, error))
    }
}

impl Placemark {
    /// Returns the position of a tuple; counts an altitude that is no number.
    fn position(&mut self, tuple: &KmlTuple) -> DVec3 {
        if tuple.has_unread_altitude {
            self.parts.count_elevation();
        }
        tuple.position
    }

    /// Adds `Data` with a `value`, and `SchemaData` with `SimpleData`.
    fn add_extended_data(&mut self, element: &XmlElement<'_>) {
        for data in element.children_named("Data") {
            data.children_named("value").for_each(|value| self.add_property(data, value));
        }
        let schemas = element.children_named("SchemaData");
        for data in schemas.flat_map(|schema| schema.children_named("SimpleData")) {
            self.add_property(data, data);
        }
    }

    fn add_property(&mut self, named: &XmlElement<'_>, value: &XmlElement<'_>) {
        if let Some(name) = named.attribute("name") {
            self.properties.insert(name.into(), value.text().into());
        }
    }
}

/// Parses tuples "longitude,latitude,altitude" separated by white space. White space around a comma, which some
/// programs write, does not separate.
fn tuples(text: &str) -> Result<Vec<KmlTuple>, InvalidTuple> {
    let mut tuples = Vec::new();
    let mut joined = String::new();
    for word in text.split_whitespace() {
        let continues = joined.ends_with(',') || word.starts_with(',');
        if !continues && !joined.is_empty() {
            tuples.push(tuple(joined.split(','))?);
            joined.clear();
        }
        joined.push_str(word);
    }
    if !joined.is_empty() {
        tuples.push(tuple(joined.split(','))?);
    }
    Ok(tuples)
}

fn tuple<'a>(parts: impl Iterator<Item = &'a str> + Clone) -> Result<KmlTuple, InvalidTuple> {
    let mut texts = parts.clone();
    let mut number = || texts.next().map(|text| (text, text.parse::<f64>().ok()));
    match (number(), number(), number()) {
        (Some((_, Some(x))), Some((_, Some(y))), altitude) => Ok(KmlTuple {
            position: position(x, y, altitude.and_then(|(_, altitude)| altitude)),
            has_unread_altitude: altitude.is_some_and(|(text, number)| !text.is_empty() && number.is_none()),
        }),
        _ => Err(InvalidTuple(shorten(&parts.collect::<Vec<_>>().join(",")))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec2;

    fn placemark(content: &str) -> VectorLayer {
        let text = format!("<kml><Document><Placemark>{content}</Placemark></Document></kml>");
        read(text.as_bytes(), &VectorHints::default()).expect("well-formed")
    }

    #[test]
    fn boundaries_come_in_any_order() {
        let ring = |size: u32| {
            format!("<LinearRing><coordinates>0,0,9 {size},0,9 0,{size},9 0,0,9</coordinates></LinearRing>")
        };
        let (outer, inner) = (ring(9), ring(1));
        let layer = placemark(&format!(
            "<Polygon><altitudeMode>absolute</altitudeMode><innerBoundaryIs>{inner}</innerBoundaryIs>
             <outerBoundaryIs>{outer}</outerBoundaryIs></Polygon>"
        ));
        let [polygon] = layer.features[0].polygons() else { panic!("one polygon") };
        assert_eq!((polygon.exterior[1].x, polygon.holes.len()), (9.0, 1));
        assert_eq!(layer.features[0].elevations, Some(vec![9.0; 6]));
        assert_eq!(layer.features[0].properties["altitudeMode"], "absolute");
    }

    #[test]
    fn heights_above_ground_and_zeros_filled_in_are_not_elevations() {
        let elevations = |mode: &str, z: u32| {
            let mode = format!("<altitudeMode>{mode}</altitudeMode>");
            let point = format!("<Point>{mode}<coordinates>1,2,{z}</coordinates></Point>");
            placemark(&point).features[0].elevations.clone()
        };
        assert_eq!(elevations("relativeToGround", 7), None);
        assert_eq!(elevations("clampToGround", 0), None);
        assert_eq!(elevations("clampToGround", 7), Some(vec![7.0]));
        assert_eq!(elevations("absolute", 0), Some(vec![0.0]));
    }

    #[test]
    fn extended_data_of_both_kinds_become_properties() {
        let layer = placemark(
            "<name>A &amp; B</name><ExtendedData><Data name='lanes'><displayName>L</displayName><value>2</value></Data>
             <SchemaData><SimpleData name='width'>7</SimpleData></SchemaData></ExtendedData>
             <MultiGeometry><Point><coordinates>1,2</coordinates></Point>
             <LineString><coordinates>1, 2, 3\n 4,5</coordinates></LineString></MultiGeometry>",
        );
        assert_eq!(layer.features.len(), 2);
        for feature in &layer.features {
            assert_eq!(feature.properties["name"], "A & B");
            assert_eq!(
                (&feature.properties["lanes"], &feature.properties["width"]),
                (&"2".into(), &"7".into())
            );
        }
        assert_eq!(layer.features[1].lines(), [[DVec2::new(1.0, 2.0), DVec2::new(4.0, 5.0)]]);
    }

    #[test]
    fn a_name_in_another_encoding_costs_its_letters_alone() {
        let text = b"<kml><Placemark><name>Caf\xe9</name><Point><coordinates>1,2</coordinates></Point></Placemark></kml>";
        let layer = read(text, &VectorHints::default()).expect("well-formed");
        assert_eq!(layer.features[0].properties["name"], "Caf\u{fffd}");
        assert_eq!(layer.faults.len(), 1);
    }

    #[test]
    fn folders_are_layers() {
        let folder = |name: &str| {
            format!(
                "<Folder><name>{name}</name><Placemark><Point><coordinates>1,2</coordinates></Point></Placemark></Folder>"
            )
        };
        let text = format!(
            "<kml><Document><name>All</name>{}{}</Document></kml>",
            folder("Paths"),
            folder("Sights")
        );
        let count = |layer| {
            let hints = VectorHints { layer, ..VectorHints::default() };
            read(text.as_bytes(), &hints).map(|layer| layer.features.len())
        };
        assert_eq!(count(None).expect("all"), 2);
        assert_eq!(count(Some("Sights")).expect("one"), 1);
        let error = count(Some("paths")).expect_err("no such folder").to_string();
        assert!(error.contains("did you mean 'Paths'?") && error.contains("Paths, Sights"), "{error}");
    }

    #[test]
    fn moments_without_a_position_and_odd_placemarks_are_left_out_and_reported() {
        let layer = placemark(
            "<Track><coord>1 2 3</coord>\n<coord/><coord>  </coord>\n<coord>4 x 5</coord><coord>4 5 6</coord></Track>
             </Placemark>\n<Placemark><LineString><coordinates>1,2 3,y</coordinates></LineString></Placemark>
             <Placemark><Point><coordinates>1,2,high</coordinates></Point></Placemark>
             <Placemark><Polygon><innerBoundaryIs><LinearRing><coordinates>1,2 3,4 5,0</coordinates></LinearRing>
             </innerBoundaryIs></Polygon>",
        );
        assert_eq!(layer.features.len(), 2);
        assert_eq!(layer.features[0].lines()[0].len(), 2);
        let expected = "left out: 2 records that cannot be read: line 3: '4,x,5' is not longitude and latitude; \
            line 5: '3,y' is not longitude and latitude";
        assert_eq!(layer.faults, [expected]);
        let expected = [
            "left out: 1 feature without a usable geometry (line 7)",
            "left out: 1 elevation that is not a number (line 6)",
            "left out: 2 moments of tracks without a position (line 1)",
        ];
        assert_eq!(layer.notes, expected);
    }

    #[test]
    fn coordinates_that_are_not_numbers_are_refused_with_the_line() {
        let error = read(
            b"<kml>\n<Placemark><Point><coordinates>1,x</coordinates></Point></Placemark></kml>",
            &VectorHints::default(),
        );
        let error = error.expect_err("no number").to_string();
        assert!(error.contains("line 2") && error.contains("'1,x'"), "{error}");
    }
}
