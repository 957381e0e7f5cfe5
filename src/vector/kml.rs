//! KML 2.2 (OGC 07-147r2, 2008) and its archives (KMZ): placemarks, always on WGS 84.
//!
//! Every placemark is a feature. Its properties are `name`, `description`, `folder` (the name of the folder or
//! document that it lies in, by which it can be asked for as a layer), `altitudeMode`, and all of its extended
//! data as text. What is only there for looking at (overlays, styles, models, links) is not read.
//!
//! Altitudes are meters above the sea, but relative to the ground where `altitudeMode` says so, and then no
//! elevations. Programs that have none write 0: where all are 0 and the mode is not `absolute`, there are none.

use glam::DVec3;

use crate::geom::crs::Crs;
use crate::vector::collect::{Collector, FeatureParts, Properties, position};
use crate::vector::error::VectorError;
use crate::vector::feature::VectorLayer;
use crate::vector::xml::{self, Element, Xml};

const FORMAT: &str = "KML file";

/// All placemarks of a KML file, or those in the folder named `wanted`.
///
/// # Errors
/// [`VectorError`]; coordinates that are no numbers are one.
pub(super) fn read(
    bytes: &[u8],
    stated: Option<&Crs>,
    wanted: Option<&str>,
) -> Result<VectorLayer, VectorError> {
    let text = xml::decode(bytes, FORMAT)?;
    let crs = stated.cloned().unwrap_or_else(Crs::wgs84);
    let mut file = KmlFile { wanted, found: false, folders: Vec::new(), collector: Collector::new(crs) };
    let mut xml = Xml::new(&text, FORMAT);
    let root = xml.root()?;
    match root.name() {
        "kml" => file.container(&mut xml, "")?,
        _ => file.feature(&mut xml, &root, "")?,
    }
    xml.end()?;
    match wanted.filter(|_| !file.found) {
        Some(wanted) => {
            let names: Vec<&str> = file.folders.iter().map(String::as_str).collect();
            Err(VectorError::no_such_layer(wanted, &names))
        }
        None => Ok(file.collector.finish()),
    }
}

struct KmlFile<'w> {
    wanted: Option<&'w str>,
    /// Whether a folder has the wanted name.
    found: bool,
    /// The names of the folders that hold placemarks, in order.
    folders: Vec<String>,
    collector: Collector,
}

/// One placemark while it is read.
#[derive(Default)]
struct Placemark {
    parts: FeatureParts,
    properties: Properties,
}

/// One shape's vertices as written, by ring or line, and how their altitudes are meant.
#[derive(Default)]
struct KmlShape {
    mode: Option<String>,
    lists: Vec<Vec<DVec3>>,
}

impl KmlFile<'_> {
    /// What lies in the element just opened, a folder or document that has the name `name` until it says its own.
    fn container(&mut self, xml: &mut Xml<'_>, name: &str) -> Result<(), VectorError> {
        let mut name = name.to_owned();
        xml.children(|xml, element| match element.name() {
            "name" => {
                name = xml.text()?;
                Ok(())
            }
            _ => self.feature(xml, element, &name),
        })
    }

    fn feature<'a>(
        &mut self,
        xml: &mut Xml<'a>,
        element: &Element<'a>,
        folder: &str,
    ) -> Result<(), VectorError> {
        match element.name() {
            // A folder without a name has none, not that of the folder it lies in.
            "Document" | "Folder" => self.container(xml, ""),
            "Placemark" => {
                let mut placemark = Placemark::default();
                xml.children(|xml, element| placemark.read(xml, element))?;
                self.add(placemark, folder)
            }
            _ => xml.skip(),
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
        self.found = true;
        self.collector.add(placemark.parts, placemark.properties)
    }
}

impl Placemark {
    fn read<'a>(&mut self, xml: &mut Xml<'a>, element: &Element<'a>) -> Result<(), VectorError> {
        match element.name() {
            name @ ("name" | "description") => {
                let text = xml.text()?;
                self.properties.insert(name.into(), text.into());
                Ok(())
            }
            "ExtendedData" => self.extended_data(xml),
            _ => self.shape(xml, element),
        }
    }

    /// `Data` with a `value`, or `SchemaData` with `SimpleData`.
    fn extended_data(&mut self, xml: &mut Xml<'_>) -> Result<(), VectorError> {
        xml.children(|xml, element| match element.name() {
            "Data" => {
                let name = element.attribute("name").map(String::from);
                xml.children(|xml, element| match element.name() {
                    "value" => self.keep(xml, name.as_deref()),
                    _ => xml.skip(),
                })
            }
            "SchemaData" => xml.children(|xml, element| match element.name() {
                "SimpleData" => self.keep(xml, element.attribute("name").as_deref()),
                _ => xml.skip(),
            }),
            _ => xml.skip(),
        })
    }

    fn keep(&mut self, xml: &mut Xml<'_>, name: Option<&str>) -> Result<(), VectorError> {
        let text = xml.text()?;
        if let Some(name) = name {
            self.properties.insert(name.into(), text.into());
        }
        Ok(())
    }

    fn shape<'a>(&mut self, xml: &mut Xml<'a>, element: &Element<'a>) -> Result<(), VectorError> {
        match element.name() {
            "MultiGeometry" | "MultiTrack" => xml.children(|xml, element| self.shape(xml, element)),
            "Point" => {
                let shape = self.read_shape(xml)?;
                shape.into_iter().flatten().for_each(|at| self.parts.point(at));
                Ok(())
            }
            "LineString" | "LinearRing" | "Track" => {
                let shape = self.read_shape(xml)?;
                shape.into_iter().for_each(|line| self.parts.line(line));
                Ok(())
            }
            "Polygon" => {
                let rings = self.read_shape(xml)?;
                if !rings.is_empty() {
                    self.parts.polygon(rings);
                }
                Ok(())
            }
            _ => xml.skip(),
        }
    }

    /// The lists of vertices of the shape just opened, their altitudes kept where they are elevations.
    fn read_shape(&mut self, xml: &mut Xml<'_>) -> Result<Vec<Vec<DVec3>>, VectorError> {
        let mut shape = KmlShape::default();
        let mut track = Vec::new();
        xml.children(|xml, element| shape.read(xml, element, &mut track))?;
        if !track.is_empty() {
            shape.lists.push(track);
        }
        let mode = shape.mode.as_deref().unwrap_or_default();
        let flat = shape.lists.iter().flatten().all(|at| at.z == 0.0 || at.z.is_nan());
        if mode.starts_with("relative") || (mode != "absolute" && flat) {
            shape.lists.iter_mut().flatten().for_each(|at| at.z = f64::NAN);
        }
        if !mode.is_empty() {
            self.properties.entry("altitudeMode".into()).or_insert_with(|| mode.into());
        }
        Ok(shape.lists)
    }
}

impl KmlShape {
    fn read<'a>(
        &mut self,
        xml: &mut Xml<'a>,
        element: &Element<'a>,
        track: &mut Vec<DVec3>,
    ) -> Result<(), VectorError> {
        match element.name() {
            "altitudeMode" => {
                self.mode = Some(xml.text()?);
                Ok(())
            }
            "coordinates" => {
                let text = xml.text()?;
                self.lists.push(coordinates(&text).map_err(|reason| xml.broken(reason))?);
                Ok(())
            }
            // Of a gx:Track: "longitude latitude altitude".
            "coord" => {
                let text = xml.text()?;
                let parts = text.split_whitespace();
                track.push(vertex(parts, &text).map_err(|reason| xml.broken(reason))?);
                Ok(())
            }
            // The outer ring must come first, as the schema has it too.
            "outerBoundaryIs" => {
                let mut outer = Self::default();
                outer.boundary(xml)?;
                self.lists.splice(0..0, outer.lists);
                Ok(())
            }
            "innerBoundaryIs" => self.boundary(xml),
            _ => xml.skip(),
        }
    }

    fn boundary(&mut self, xml: &mut Xml<'_>) -> Result<(), VectorError> {
        xml.children(|xml, element| match element.name() {
            "LinearRing" => {
                let mut track = Vec::new();
                xml.children(|xml, element| self.read(xml, element, &mut track))
            }
            _ => xml.skip(),
        })
    }
}

/// Tuples "longitude,latitude,altitude" apart by white space; white space after a comma, which some programs
/// write, belongs to the tuple.
fn coordinates(text: &str) -> Result<Vec<DVec3>, String> {
    let mut all = Vec::new();
    let mut tuple = String::new();
    for word in text.split_whitespace() {
        let goes_on = tuple.ends_with(',') || (word.starts_with(',') && !tuple.is_empty());
        if !goes_on && !tuple.is_empty() {
            all.push(vertex(tuple.split(','), &tuple)?);
            tuple.clear();
        }
        tuple.push_str(word);
    }
    if !tuple.is_empty() {
        all.push(vertex(tuple.split(','), &tuple)?);
    }
    Ok(all)
}

fn vertex<'a>(mut parts: impl Iterator<Item = &'a str>, whole: &str) -> Result<DVec3, String> {
    let mut number = || parts.next().and_then(|part| part.parse::<f64>().ok());
    match (number(), number()) {
        (Some(x), Some(y)) => Ok(position(x, y, number())),
        _ => {
            let whole: String = whole.chars().take(60).collect();
            Err(format!("'{whole}' is not longitude and latitude"))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec2;

    fn placemark(content: &str) -> VectorLayer {
        let text = format!("<kml><Document><Placemark>{content}</Placemark></Document></kml>");
        read(text.as_bytes(), None, None).expect("well-formed")
    }

    #[test]
    fn polygons_have_their_inner_boundaries_whatever_the_order() {
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
    fn heights_above_the_ground_and_filled_in_zeros_are_no_elevations() {
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
        let count = |wanted| read(text.as_bytes(), None, wanted).map(|layer| layer.features.len());
        assert_eq!(count(None).expect("all"), 2);
        assert_eq!(count(Some("Sights")).expect("one"), 1);
        let error = count(Some("paths")).expect_err("no such folder").to_string();
        assert!(error.contains("did you mean 'Paths'?") && error.contains("Paths, Sights"), "{error}");
    }

    #[test]
    fn coordinates_that_are_no_numbers_are_refused_with_the_line() {
        let error = read(
            b"<kml>\n<Placemark><Point><coordinates>1,x</coordinates></Point></Placemark></kml>",
            None,
            None,
        );
        let error = error.expect_err("no number").to_string();
        assert!(error.contains("line 2") && error.contains("'1,x'"), "{error}");
    }
}
