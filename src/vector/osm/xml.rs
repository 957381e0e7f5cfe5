//! Extracts as XML, version 0.6: `node`, `way` and `relation` elements with `tag`, `nd` and `member` in them.

use crate::vector::error::VectorError;
use crate::vector::osm::data::{OsmData, PER_DEGREE, Role, TextId, TooMuch};
use crate::vector::xml::{self, Element, Xml};

const FORMAT: &str = "OpenStreetMap XML";

/// Everything in the file; what is marked deleted is left out.
///
/// # Errors
/// [`VectorError`].
pub(super) fn read(bytes: &[u8]) -> Result<OsmData, VectorError> {
    let text = xml::decode(bytes, FORMAT)?;
    let mut xml = Xml::new(&text, FORMAT);
    let root = xml.root()?;
    if root.name() != "osm" {
        return Err(VectorError::Unsupported {
            format: FORMAT,
            what: format!("<{}>, not an extract", root.name().chars().take(40).collect::<String>()),
            remedy: "apply changes first, for example with: osmium apply-changes".into(),
        });
    }
    let mut data = OsmData::default();
    let mut scratch = ElementScratch::default();
    xml.children(|xml, element| match element.name() {
        "node" | "way" | "relation" => {
            scratch.read(xml, element, &mut data)?;
            scratch.keep(xml, element, &mut data)
        }
        _ => xml.skip(),
    })?;
    xml.end()?;
    data.sort();
    Ok(data)
}

/// What lies in one element, before it is kept.
#[derive(Default)]
struct ElementScratch {
    tags: Vec<(TextId, TextId)>,
    refs: Vec<i64>,
    members: Vec<(i64, Role)>,
}

impl ElementScratch {
    fn read<'a>(
        &mut self,
        xml: &mut Xml<'a>,
        element: &Element<'a>,
        data: &mut OsmData,
    ) -> Result<(), VectorError> {
        self.tags.clear();
        self.refs.clear();
        self.members.clear();
        let is_way = element.name() == "way";
        xml.children(|xml, element| {
            match element.name() {
                "tag" => {
                    let key = element.attribute("k").unwrap_or_default();
                    let value = element.attribute("v").unwrap_or_default();
                    let key = data.text(&key).map_err(|error| too_much(xml, &error))?;
                    let value = data.text(&value).map_err(|error| too_much(xml, &error))?;
                    self.tags.push((key, value));
                }
                "nd" if is_way => self.refs.push(id(xml, element, "ref")?),
                "member" if element.attribute("type").as_deref() == Some("way") => {
                    let is_inner = element.attribute("role").as_deref() == Some("inner");
                    let role = if is_inner { Role::Inner } else { Role::Outer };
                    self.members.push((id(xml, element, "ref")?, role));
                }
                _ => {}
            }
            xml.skip()
        })
    }

    fn keep(&self, xml: &Xml<'_>, element: &Element<'_>, data: &mut OsmData) -> Result<(), VectorError> {
        let deleted = [("visible", "false"), ("action", "delete")];
        if deleted.iter().any(|&(name, value)| element.attribute(name).as_deref() == Some(value)) {
            return Ok(());
        }
        let id = id(xml, element, "id")?;
        let place = if element.name() == "node" { Some(place(xml, element)?) } else { None };
        let kept = data.add_tags(&self.tags).and_then(|tags| match (place, element.name()) {
            (Some(place), _) => data.add_node(id, place, tags),
            (None, "way") => data.add_way(id, &self.refs, tags),
            (None, _) => data.add_relation(id, &self.members, tags),
        });
        kept.map_err(|error| too_much(xml, &error))
    }
}

fn id(xml: &Xml<'_>, element: &Element<'_>, name: &str) -> Result<i64, VectorError> {
    let id = element.attribute(name).and_then(|text| text.parse().ok());
    id.ok_or_else(|| xml.broken(format!("<{}> has no number as its {name}", element.name())))
}

fn place(xml: &Xml<'_>, element: &Element<'_>) -> Result<[i32; 2], VectorError> {
    let (mut longitude, mut latitude) = (None, None);
    for (name, value) in element.raw_attributes() {
        match name {
            "lon" => longitude = value.parse::<f64>().ok(),
            "lat" => latitude = value.parse::<f64>().ok(),
            _ => {}
        }
    }
    match (longitude, latitude) {
        (Some(longitude), Some(latitude)) if longitude.abs() <= 180.0 && latitude.abs() <= 90.0 => {
            Ok([longitude, latitude].map(|degrees| (degrees * PER_DEGREE).round() as i32))
        }
        _ => Err(xml.broken("a node has no latitude (lat) and longitude (lon) on Earth")),
    }
}

fn too_much(xml: &Xml<'_>, _: &TooMuch) -> VectorError {
    xml.broken("it holds more than fits in memory; cut it down with 'osmium extract'")
}
