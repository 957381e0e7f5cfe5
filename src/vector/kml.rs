//! KML 2.2 (OGC 07-147r2, 2008): placemarks, on WGS 84.
//!
//! Every placemark is a feature. Its properties are `name`, `description`, `folder` (the folder or document that holds
//! it, whose name also requests it as a layer), `altitudeMode`, and its extended data as text. Overlays, styles, models
//! and links are not read.
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
use crate::xml::{self, XmlElement, XmlReader};

const FORMAT: &str = "KML file";

/// Reads all placemarks, or those in the folders that have the name of the requested layer.
///
/// # Errors
/// [`VectorError`], also for coordinates that are not numbers.
pub(super) fn read(bytes: &[u8], hints: &VectorHints) -> Result<VectorLayer, VectorError> {
    let text = xml::decode(bytes, FORMAT)?;
    let mut reader = KmlReader {
        xml: XmlReader::new(&text, FORMAT),
        wanted: hints.layer,
        folders: Vec::new(),
        layer: LayerBuilder::new(hints.crs_or_wgs84()),
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
        None => Ok(reader.layer.finish()),
    }
}

struct KmlReader<'a> {
    xml: XmlReader<'a>,
    wanted: Option<&'a str>,
    /// The names of the folders that hold placemarks, in order.
    folders: Vec<String>,
    layer: LayerBuilder,
}

#[derive(Default)]
struct Placemark {
    parts: FeatureParts,
    properties: Properties,
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
                self.add(self.placemark(&element)?, folder)
            }
            _ => self.xml.skip(),
        }
    }

    fn add(&mut self, mut placemark: Placemark, folder: &str) -> Result<(), VectorError> {
        if !folder.is_empty() {
            if !self.folders.iter().any(|known| known == folder) {
                self.folders.push(folder.to_owned());
            }
            placemark.properties.insert("folder".into(), folder.into());
        }
        if self.wanted.is_some_and(|wanted| wanted != folder) {
            return Ok(());
        }
        self.layer.add(placemark.parts, placemark.properties)
    }

    fn placemark(&self, element: &XmlElement<'_>) -> Result<Placemark, VectorError> {
        let mut placemark = Placemark::default();
        for child in element.children() {
            match child.name() {
                name @ ("name" | "description") => {
                    placemark.properties.insert(name.into(), child.text().into());
                }
                "ExtendedData" => placemark.add_extended_data(child),
                _ => self.add_shape(child, &mut placemark)?,
            }
        }
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
        let (mut lists, mut track) = (Vec::new(), Vertices::new());
        for child in shape.children() {
            match child.name() {
                "coordinates" => lists.push(self.coordinates(child)?),
                // Of a gx:Track: "longitude latitude altitude".
                "coord" => track.push(self.check(child, vertex(child.text().split_whitespace()))?),
                "outerBoundaryIs" => drop(lists.splice(0..0, self.rings(child)?)),
                "innerBoundaryIs" => lists.extend(self.rings(child)?),
                _ => {}
            }
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

    fn rings(&self, boundary: &XmlElement<'_>) -> Result<Vec<Vertices>, VectorError> {
        let rings = boundary.children_named("LinearRing");
        rings
            .flat_map(|ring| ring.children_named("coordinates"))
            .map(|element| self.coordinates(element))
            .collect()
    }

    fn coordinates(&self, element: &XmlElement<'_>) -> Result<Vertices, VectorError> {
        self.check(element, vertices(&element.text()))
    }

    fn check<T>(&self, element: &XmlElement<'_>, result: Result<T, InvalidTuple>) -> Result<T, VectorError> {
        result.map_err(|error| self.xml.broken_at(element, error))
    }
}

impl Placemark {
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
fn vertices(text: &str) -> Result<Vertices, InvalidTuple> {
    let mut vertices = Vertices::new();
    let mut tuple = String::new();
    for word in text.split_whitespace() {
        let continues = tuple.ends_with(',') || word.starts_with(',');
        if !continues && !tuple.is_empty() {
            vertices.push(vertex(tuple.split(','))?);
            tuple.clear();
        }
        tuple.push_str(word);
    }
    if !tuple.is_empty() {
        vertices.push(vertex(tuple.split(','))?);
    }
    Ok(vertices)
}

fn vertex<'a>(parts: impl Iterator<Item = &'a str> + Clone) -> Result<DVec3, InvalidTuple> {
    let mut numbers = parts.clone().map(|part| part.parse::<f64>().ok());
    match (numbers.next().flatten(), numbers.next().flatten()) {
        (Some(x), Some(y)) => Ok(position(x, y, numbers.next().flatten())),
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
    fn coordinates_that_are_not_numbers_are_refused_with_the_line() {
        let error = read(
            b"<kml>\n<Placemark><Point><coordinates>1,x</coordinates></Point></Placemark></kml>",
            &VectorHints::default(),
        );
        let error = error.expect_err("no number").to_string();
        assert!(error.contains("line 2") && error.contains("'1,x'"), "{error}");
    }
}
