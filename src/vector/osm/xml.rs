//! Extracts as XML, version 0.6: `node`, `way` and `relation` elements with `tag`, `nd` and `member` in them.

use crate::error::{VectorError, shorten};
use crate::osm::data::{
    OsmData, OsmMember, OsmMemoryExceeded, OsmNode, OsmRelation, OsmTags, OsmWay, UNITS_PER_DEGREE,
};
use crate::xml::{self, DecodedXml, XmlElement, XmlReader};

const FORMAT: &str = "OpenStreetMap XML";

/// Reads the file without objects that are marked as deleted and those that are broken, which are counted.
pub(super) fn read(bytes: &[u8]) -> Result<OsmData, VectorError> {
    let DecodedXml { text, fault } = xml::decode(bytes, FORMAT)?;
    let mut xml = XmlReader::new(&text, FORMAT);
    let root = xml.root()?;
    if root.name() != "osm" {
        return Err(VectorError::Unsupported {
            format: FORMAT,
            content: format!("<{}>, not an extract", shorten(root.name())).into(),
            remedy: "apply changes first, for example with: osmium apply-changes",
        });
    }
    let mut data = OsmData::new(fault);
    while let Some(element) = xml.next_child()? {
        if matches!(element.name(), "node" | "way" | "relation") {
            let element = xml.read(element)?;
            add(&xml, &element, &mut data)?;
        } else {
            xml.skip()?;
        }
    }
    xml.finish()?;
    data.sort();
    Ok(data)
}

/// What an object has besides its tags.
enum OsmContent {
    Node(OsmNode),
    Way(i64, Box<[i64]>),
    Relation(i64, Box<[OsmMember]>),
}

fn add(xml: &XmlReader<'_>, element: &XmlElement<'_>, data: &mut OsmData) -> Result<(), VectorError> {
    let is_deleted = |(name, value): (&str, &str)| element.attribute(name).as_deref() == Some(value);
    if [("visible", "false"), ("action", "delete")].into_iter().any(is_deleted) {
        let id = element.attribute("id").unwrap_or_default();
        data.deleted.add(|| format!("{} {}", element.name(), shorten(&id)));
        return Ok(());
    }
    let content = match content(xml, element) {
        Ok(content) => content,
        Err(error) => {
            data.broken.add(element.name(), error);
            return Ok(());
        }
    };
    let added = tags(element, data).and_then(|tags| match content {
        OsmContent::Node(node) => data.add_node(node, tags),
        OsmContent::Way(id, refs) => data.add_way(OsmWay { id, refs, tags }),
        OsmContent::Relation(id, members) => data.add_relation(OsmRelation { id, members, tags }),
    });
    added.map_err(|error| xml.broken_at(element, error))
}

fn content(xml: &XmlReader<'_>, element: &XmlElement<'_>) -> Result<OsmContent, VectorError> {
    let id = id(xml, element, "id")?;
    Ok(match element.name() {
        "node" => OsmContent::Node(node(xml, element, id)?),
        "way" => OsmContent::Way(id, refs(xml, element)?),
        _ => OsmContent::Relation(id, members(xml, element)?),
    })
}

fn tags(element: &XmlElement<'_>, data: &mut OsmData) -> Result<OsmTags, OsmMemoryExceeded> {
    let mut text = |tag: &XmlElement<'_>, name| data.text(&tag.attribute(name).unwrap_or_default());
    element.children_named("tag").map(|tag| Ok((text(tag, "k")?, text(tag, "v")?))).collect()
}

fn refs(xml: &XmlReader<'_>, way: &XmlElement<'_>) -> Result<Box<[i64]>, VectorError> {
    way.children_named("nd").map(|node| id(xml, node, "ref")).collect()
}

fn members(xml: &XmlReader<'_>, relation: &XmlElement<'_>) -> Result<Box<[OsmMember]>, VectorError> {
    let has = |member: &XmlElement<'_>, name, value| member.attribute(name).as_deref() == Some(value);
    let ways = relation.children_named("member").filter(|member| has(member, "type", "way"));
    ways.map(|member| Ok(OsmMember { way: id(xml, member, "ref")?, is_inner: has(member, "role", "inner") }))
        .collect()
}

fn id(xml: &XmlReader<'_>, element: &XmlElement<'_>, name: &str) -> Result<i64, VectorError> {
    let reason = || format!("<{}> has no number as its {name}", shorten(element.name()));
    element.number(name).ok_or_else(|| xml.broken_at(element, reason()))
}

fn node(xml: &XmlReader<'_>, element: &XmlElement<'_>, id: i64) -> Result<OsmNode, VectorError> {
    let degrees = |name, limit: f64| element.number::<f64>(name).filter(|degrees| degrees.abs() <= limit);
    let units = |degrees: f64| (degrees * UNITS_PER_DEGREE).round() as i32;
    match (degrees("lon", 180.0), degrees("lat", 90.0)) {
        (Some(longitude), Some(latitude)) => {
            Ok(OsmNode { id, longitude: units(longitude), latitude: units(latitude) })
        }
        _ => Err(xml.broken_at(element, "a node has no latitude (lat) and longitude (lon) on Earth")),
    }
}
