//! OpenStreetMap extracts, as XML (`.osm`) and as protocol buffers (`.osm.pbf`): features by their tags.
//!
//! OpenStreetMap has nodes, ways (lists of nodes) and relations (lists of those). What is a line and what an area
//! only tags say; the rules are those of GDAL's `osmconf.ini`, so that its layers hold the same features:
//!
//! | layer | holds |
//! |---|---|
//! | `points` | nodes with a tag that says something |
//! | `lines` | ways that are not areas |
//! | `multipolygons` | closed ways that their tags make areas, and relations of the type multipolygon or boundary |
//! | `roads`, `railways`, `waterways` | of `lines` those tagged `highway`, `railway`, `waterway` |
//! | `water` | of `multipolygons` `natural=water`, `waterway=riverbank` and `landuse=reservoir` |
//! | `buildings` | of `multipolygons` those tagged `building` |
//!
//! All tags become properties, as text, beside `osm_id` (of areas made of one way: `osm_way_id`). A node's tag `ele`
//! is its elevation. Coordinates are kept to 10⁻⁷ degrees, about a centimeter, as OpenStreetMap itself keeps them.
//!
//! ```text
//! pbf ◄─ protobuf ─┐
//! xml ─────────────┴─► data ─► mod (by tags) ◄─ areas (rings of relations)
//! ```

mod areas;
mod data;
mod pbf;
mod protobuf;
mod xml;

use glam::DVec3;

use crate::geom::crs::Crs;
use crate::vector::collect::{Collector, FeatureParts, Properties, position};
use crate::vector::error::VectorError;
use crate::vector::feature::VectorLayer;
use crate::vector::osm::areas::Areas;
use crate::vector::osm::data::{OsmData, OsmTags, OsmWay};

/// Whether `bytes` are an extract as protocol buffers.
pub(super) fn is_pbf(bytes: &[u8]) -> bool {
    bytes.get(4..).is_some_and(|rest| rest.starts_with(b"\x0a\x09OSMHeader"))
}

/// The layer `wanted` of an extract as protocol buffers.
///
/// # Errors
/// [`VectorError`]; none or another layer is one.
pub(super) fn read_pbf(
    bytes: &[u8],
    stated: Option<&Crs>,
    wanted: Option<&str>,
) -> Result<VectorLayer, VectorError> {
    let kind = OsmLayer::named(wanted)?;
    features(&pbf::read(bytes)?, stated, kind)
}

/// The layer `wanted` of an extract as XML.
///
/// # Errors
/// As [`read_pbf`].
pub(super) fn read_xml(
    bytes: &[u8],
    stated: Option<&Crs>,
    wanted: Option<&str>,
) -> Result<VectorLayer, VectorError> {
    let kind = OsmLayer::named(wanted)?;
    features(&xml::read(bytes)?, stated, kind)
}

/// A layer of an extract.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum OsmLayer {
    Points,
    Lines,
    Multipolygons,
    Roads,
    Railways,
    Waterways,
    Water,
    Buildings,
}

/// Every layer by its name.
const LAYERS: [(&str, OsmLayer); 8] = [
    ("points", OsmLayer::Points),
    ("lines", OsmLayer::Lines),
    ("multipolygons", OsmLayer::Multipolygons),
    ("roads", OsmLayer::Roads),
    ("railways", OsmLayer::Railways),
    ("waterways", OsmLayer::Waterways),
    ("water", OsmLayer::Water),
    ("buildings", OsmLayer::Buildings),
];

/// Keys that make a closed way an area (`closed_ways_are_polygons`).
const AREA_KEYS: [&str; 16] = [
    "aeroway",
    "amenity",
    "boundary",
    "building",
    "craft",
    "geological",
    "historic",
    "landuse",
    "leisure",
    "military",
    "natural",
    "office",
    "place",
    "shop",
    "sport",
    "tourism",
];
/// Keys and values that do.
const AREA_TAGS: [(&str, &str); 2] = [("highway", "platform"), ("public_transport", "platform")];
/// Keys that say nothing of what a thing is (`unsignificant`).
const SAYING_NOTHING: [&str; 6] = ["created_by", "converted_by", "source", "time", "ele", "attribution"];

impl OsmLayer {
    fn named(wanted: Option<&str>) -> Result<Self, VectorError> {
        let names = LAYERS.map(|(name, _)| name);
        let Some(wanted) = wanted else { return Err(VectorError::which_layer(&names)) };
        let found = LAYERS.iter().find(|(name, _)| *name == wanted);
        found.map(|&(_, kind)| kind).ok_or_else(|| VectorError::no_such_layer(wanted, &names))
    }

    /// Whether things with these tags, of the right shape, belong to it.
    fn holds(self, data: &OsmData, tags: OsmTags) -> bool {
        match self {
            Self::Points | Self::Lines | Self::Multipolygons => saying(data, tags).next().is_some(),
            Self::Roads => data.value(tags, "highway").is_some(),
            Self::Railways => data.value(tags, "railway").is_some(),
            Self::Waterways => data.value(tags, "waterway").is_some(),
            Self::Water => {
                let water = [("natural", "water"), ("waterway", "riverbank"), ("landuse", "reservoir")];
                water.iter().any(|&(key, value)| data.value(tags, key) == Some(value))
            }
            Self::Buildings => data.value(tags, "building").is_some(),
        }
    }
}

/// The tags that say what a thing is.
fn saying(data: &OsmData, tags: OsmTags) -> impl Iterator<Item = (&str, &str)> {
    data.tags(tags).filter(|(key, _)| !SAYING_NOTHING.contains(key))
}

/// Whether a closed way with these tags is an area.
fn makes_area(data: &OsmData, tags: OsmTags) -> bool {
    match data.value(tags, "area") {
        Some("yes") => true,
        Some("no") => false,
        _ => data.tags(tags).any(|tag| AREA_KEYS.contains(&tag.0) || AREA_TAGS.contains(&tag)),
    }
}

fn features(data: &OsmData, stated: Option<&Crs>, kind: OsmLayer) -> Result<VectorLayer, VectorError> {
    let mut collector = Collector::new(stated.cloned().unwrap_or_else(Crs::wgs84));
    match kind {
        OsmLayer::Points => points(data, &mut collector)?,
        OsmLayer::Lines | OsmLayer::Roads | OsmLayer::Railways | OsmLayer::Waterways => {
            lines(data, kind, &mut collector)?
        }
        OsmLayer::Multipolygons | OsmLayer::Water | OsmLayer::Buildings => areas(data, kind, &mut collector)?,
    }
    Ok(collector.finish())
}

fn points(data: &OsmData, collector: &mut Collector) -> Result<(), VectorError> {
    for (node, tags) in data.tagged_nodes() {
        if !OsmLayer::Points.holds(data, tags) {
            continue;
        }
        let elevation = data.value(tags, "ele").and_then(|text| text.trim().parse().ok());
        let (x, y) = node.degrees();
        let mut parts = FeatureParts::default();
        parts.point(position(x, y, elevation));
        collector.add(parts, properties(data, tags, "osm_id", node.id))?;
    }
    Ok(())
}

fn lines(data: &OsmData, kind: OsmLayer, collector: &mut Collector) -> Result<(), VectorError> {
    let mut cut = 0;
    for way in data.ways() {
        if !kind.holds(data, way.tags) || is_area(data, way) {
            continue;
        }
        let line = data.positions(way);
        cut += usize::from(line.len() < data.refs(way).len());
        if line.len() >= 2 {
            let mut parts = FeatureParts::default();
            parts.line(line);
            collector.add(parts, properties(data, way.tags, "osm_id", way.id))?;
        }
    }
    if cut > 0 {
        collector.note(format!("{cut} ways leave the extract; only what lies within it is there"));
    }
    Ok(())
}

fn areas(data: &OsmData, kind: OsmLayer, collector: &mut Collector) -> Result<(), VectorError> {
    let mut areas = Areas::new(data);
    let mut incomplete = 0;
    for relation in data.relations() {
        if !matches!(data.value(relation.tags, "type"), Some("multipolygon" | "boundary")) {
            continue;
        }
        let tags = areas.tags_of(relation);
        if !kind.holds(data, tags) {
            continue;
        }
        match areas.polygons(relation)? {
            Some(polygons) => {
                let mut parts = FeatureParts::default();
                polygons.into_iter().for_each(|rings| parts.polygon(rings));
                collector.add(parts, properties(data, tags, "osm_id", relation.id))?;
                areas.stand_for_outer_ways(relation, tags);
            }
            None => incomplete += 1,
        }
    }
    collector.left_out(incomplete, "areas of relations that leave the extract or do not close");
    for way in data.ways() {
        if !kind.holds(data, way.tags) || !is_area(data, way) || areas.stand_for(way) {
            continue;
        }
        let mut parts = FeatureParts::default();
        parts.polygon([data.positions(way)]);
        if !parts.is_empty() {
            collector.add(parts, properties(data, way.tags, "osm_way_id", way.id))?;
        }
    }
    Ok(())
}

/// Whether the way is closed and its tags make it an area.
fn is_area(data: &OsmData, way: &OsmWay) -> bool {
    let refs = data.refs(way);
    refs.len() >= 4 && refs.first() == refs.last() && makes_area(data, way.tags)
}

fn properties(data: &OsmData, tags: OsmTags, id_key: &str, id: i64) -> Properties {
    let mut properties: Properties =
        data.tags(tags).map(|(key, value)| (key.to_owned(), value.into())).collect();
    properties.insert(id_key.into(), id.to_string().into());
    properties
}

/// A ring or a line.
type OsmLine = Vec<DVec3>;

#[cfg(test)]
mod tests {
    use super::*;
    use std::fmt::Write;

    /// A grid of nodes, numbered row by row from 1, ten to a row, a hundredth of a degree apart.
    fn extract(content: &str) -> String {
        let mut text = String::from("<osm>");
        for id in 1..=100 {
            let (column, row) = ((id - 1) % 10, (id - 1) / 10);
            write!(text, "<node id='{id}' lat='48.0{row}' lon='15.0{column}'/>").expect("memory");
        }
        text + content + "</osm>"
    }

    fn way(id: u32, nodes: &[u32], tags: &[(&str, &str)]) -> String {
        let nodes: String = nodes.iter().map(|node| format!("<nd ref='{node}'/>")).collect();
        let tags: String = tags.iter().map(|(key, value)| format!("<tag k='{key}' v='{value}'/>")).collect();
        format!("<way id='{id}'>{nodes}{tags}</way>")
    }

    fn layer(content: &str, wanted: &str) -> VectorLayer {
        read_xml(extract(content).as_bytes(), None, Some(wanted)).expect(wanted)
    }

    const SQUARE: [u32; 5] = [1, 10, 100, 91, 1];

    #[test]
    fn tags_decide_what_is_a_line_and_what_an_area() {
        let content = way(1, &SQUARE, &[("building", "yes")])
            + &way(2, &SQUARE, &[("highway", "service")])
            + &way(3, &SQUARE, &[("highway", "service"), ("area", "yes")])
            + &way(4, &[1, 2], &[("highway", "track"), ("name", "A &amp; B")])
            + &way(5, &[3, 4], &[("source", "guess")]);
        assert_eq!(layer(&content, "lines").features.len(), 2);
        assert_eq!(layer(&content, "multipolygons").features.len(), 2);
        let buildings = layer(&content, "buildings");
        assert_eq!(buildings.features[0].properties["osm_way_id"], "1");
        let roads = layer(&content, "roads");
        assert_eq!(roads.features.len(), 2);
        assert_eq!(roads.features[1].properties["name"], "A & B");
        assert_eq!(roads.features[1].properties["osm_id"], "4");
    }

    #[test]
    fn a_relation_joins_ways_to_rings_with_holes() {
        let relation = "<relation id='9'><member type='way' ref='1' role='outer'/>\
            <member type='way' ref='2' role='outer'/><member type='way' ref='3' role='inner'/>\
            <tag k='type' v='multipolygon'/><tag k='natural' v='water'/></relation>";
        let content = way(1, &[1, 10, 100], &[]) + &way(2, &[1, 91, 100], &[]);
        let content = content + &way(3, &[34, 35, 45, 34], &[("natural", "wood")]) + relation;
        let water = layer(&content, "water");
        let [lake] = &water.features[..] else { panic!("one lake: {:?}", water.notes) };
        let [polygon] = lake.polygons() else { panic!("one polygon") };
        assert_eq!((polygon.exterior.len(), polygon.holes.len()), (4, 1));
        assert_eq!(lake.properties["osm_id"], "9");
        assert_eq!(layer(&content, "multipolygons").features.len(), 2, "the wood is an area of its own");
        let cut = layer(&content.replace("ref='2'", "ref='7'"), "water");
        assert!(cut.features.is_empty() && cut.notes[0].contains("1 areas"), "{:?}", cut.notes);
    }

    #[test]
    fn an_outer_way_that_says_more_than_its_relation_stays_an_area() {
        let relation = "<relation id='9'><member type='way' ref='1' role='outer'/>\
            <tag k='type' v='multipolygon'/><tag k='name' v='Palace'/></relation>";
        let palace = way(1, &SQUARE, &[("building", "yes")]) + relation;
        assert_eq!(layer(&palace, "buildings").features.len(), 1);
        assert_eq!(layer(&palace, "multipolygons").features.len(), 2);
        let same = palace.replace("k='name' v='Palace'", "k='building' v='yes'");
        assert_eq!(layer(&same, "multipolygons").features.len(), 1);
    }

    #[test]
    fn a_relation_without_tags_has_those_of_its_outer_way_which_is_then_no_area_of_its_own() {
        let relation = "<relation id='9'><member type='way' ref='1' role='outer'/>\
            <member type='way' ref='3' role='inner'/><tag k='type' v='multipolygon'/></relation>";
        let content = way(1, &SQUARE, &[("building", "yes")]) + &way(3, &[34, 35, 45, 34], &[]) + relation;
        let buildings = layer(&content, "buildings");
        assert_eq!(buildings.features.len(), 1);
        assert_eq!(buildings.features[0].polygons()[0].holes.len(), 1);
    }

    #[test]
    fn nodes_with_tags_are_points_with_their_elevation() {
        let content = "<node id='200' lat='48.5' lon='15.5'><tag k='natural' v='peak'/><tag k='ele' v='1893'/></node>\
            <node id='201' lat='48.5' lon='15.5'><tag k='source' v='x'/></node>";
        let points = layer(content, "points");
        let [peak] = &points.features[..] else { panic!("one point") };
        assert_eq!(peak.elevations, Some(vec![1893.0]));
    }

    #[test]
    fn without_a_layer_the_layers_are_listed() {
        let error = read_xml(extract("").as_bytes(), None, None).expect_err("which?").to_string();
        assert!(
            error.contains("8 layers") && error.contains("points, lines, multipolygons, roads"),
            "{error}"
        );
    }
}
