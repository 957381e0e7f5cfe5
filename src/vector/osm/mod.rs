//! OpenStreetMap extracts, as XML (`.osm`) and as protocol buffers (`.osm.pbf`): features by their tags.
//!
//! OpenStreetMap has nodes, ways (lists of nodes) and relations (lists of those). Only tags state what is a line and
//! what an area. The rules are those of GDAL's `osmconf.ini`, so that its layers hold the same features:
//!
//! | layer | holds |
//! |---|---|
//! | `points` | nodes with a significant tag |
//! | `lines` | ways that are not areas |
//! | `multipolygons` | closed ways that their tags make areas, and relations of the type multipolygon or boundary |
//! | `roads`, `railways`, `waterways` | of `lines` those tagged `highway`, `railway`, `waterway` |
//! | `water` | of `multipolygons` `natural=water`, `waterway=riverbank` and `landuse=reservoir` |
//! | `buildings` | of `multipolygons` those tagged `building` or `building:part` |
//!
//! The nodes of a way that an extract lacks part its line; an area is only there whole.
//!
//! All tags become properties, as text, beside `osm_id` (of areas made of one way: `osm_way_id`). A node's tag `ele`
//! is its elevation. Coordinates are kept to 10⁻⁷ degrees, about a centimeter, as OpenStreetMap keeps them.
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

use rayon::prelude::*;

use crate::builder::{FeatureParts, LayerBuilder, position};
use crate::error::{VectorError, shorten};
use crate::feature::{Properties, VectorLayer};
use crate::hints::VectorHints;
use crate::osm::areas::AreaAssembler;
use crate::osm::data::{OsmData, OsmRelation, OsmRuns, OsmTags, OsmWay};
use crate::tally::RecordTally;

pub(super) fn is_pbf(bytes: &[u8]) -> bool {
    bytes.get(4..).is_some_and(|rest| rest.starts_with(b"\x0a\x09OSMHeader"))
}

/// An extract in memory, of which any number of layers are made: reading it takes longer than making one.
pub(super) struct OsmExtract(OsmData);

impl OsmExtract {
    /// Reads an extract as protocol buffers.
    ///
    /// # Errors
    /// [`VectorError`], also where no layer is requested.
    pub fn of_pbf(bytes: &[u8], hints: &VectorHints) -> Result<Self, VectorError> {
        OsmLayer::requested(hints)?;
        Self::of(pbf::read(bytes)?)
    }

    /// Reads an extract as XML.
    ///
    /// # Errors
    /// As [`OsmExtract::of_pbf`].
    pub fn of_xml(bytes: &[u8], hints: &VectorHints) -> Result<Self, VectorError> {
        OsmLayer::requested(hints)?;
        Self::of(xml::read(bytes)?)
    }

    /// What is broken is an error where nothing else is there.
    fn of(mut data: OsmData) -> Result<Self, VectorError> {
        if data.is_empty() {
            std::mem::take(&mut data.broken).first_error()?;
        }
        Ok(Self(data))
    }

    /// The requested layer.
    ///
    /// # Errors
    /// [`VectorError`], also where no layer is requested.
    pub fn layer(&self, hints: &VectorHints) -> Result<VectorLayer, VectorError> {
        OsmLayer::requested(hints)?.read(&self.0, hints)
    }
}

/// The shape of a layer's features.
#[derive(Clone, Copy)]
enum OsmShape {
    Point,
    Line,
    Area,
}

/// A layer of an extract.
#[derive(Clone, Copy)]
struct OsmLayer {
    name: &'static str,
    shape: OsmShape,
    /// The keys, each with its value or none for any, one of which a feature has; with an empty list any significant
    /// tag.
    tags: &'static [(&'static str, Option<&'static str>)],
}

const LAYERS: [OsmLayer; 8] = [
    OsmLayer { name: "points", shape: OsmShape::Point, tags: &[] },
    OsmLayer { name: "lines", shape: OsmShape::Line, tags: &[] },
    OsmLayer { name: "multipolygons", shape: OsmShape::Area, tags: &[] },
    OsmLayer { name: "roads", shape: OsmShape::Line, tags: &[("highway", None)] },
    OsmLayer { name: "railways", shape: OsmShape::Line, tags: &[("railway", None)] },
    OsmLayer { name: "waterways", shape: OsmShape::Line, tags: &[("waterway", None)] },
    OsmLayer {
        name: "water",
        shape: OsmShape::Area,
        tags: &[("natural", Some("water")), ("waterway", Some("riverbank")), ("landuse", Some("reservoir"))],
    },
    OsmLayer {
        name: "buildings",
        shape: OsmShape::Area,
        tags: &[("building", None), ("building:part", None)],
    },
];

/// Keys that make a closed way an area (`closed_ways_are_polygons`, and the parts of buildings).
const AREA_KEYS: [&str; 17] = [
    "aeroway",
    "amenity",
    "boundary",
    "building",
    "building:part",
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
/// Tags that make a closed way an area.
const AREA_TAGS: [(&str, &str); 2] = [("highway", "platform"), ("public_transport", "platform")];
/// Keys that do not classify a feature (GDAL's `unsignificant`).
const INSIGNIFICANT_KEYS: [&str; 6] = ["created_by", "converted_by", "source", "time", "ele", "attribution"];

impl OsmLayer {
    fn requested(hints: &VectorHints) -> Result<Self, VectorError> {
        hints.choose_layer(&LAYERS.map(|layer| layer.name)).map(|index| LAYERS[index])
    }

    fn read(self, data: &OsmData, hints: &VectorHints) -> Result<VectorLayer, VectorError> {
        if data.is_empty() {
            return LayerBuilder::new(hints.crs_or_wgs84()).finish();
        }
        self.features(data, hints)
    }

    fn features(self, data: &OsmData, hints: &VectorHints) -> Result<VectorLayer, VectorError> {
        let mut layer = LayerBuilder::new(hints.crs_or_wgs84());
        match self.shape {
            OsmShape::Point => self.add_points(data, &mut layer),
            OsmShape::Line => self.add_lines(data, &mut layer),
            OsmShape::Area => self.add_areas(data, &mut layer)?,
        }
        let (one, many) = ("object marked as deleted", "objects marked as deleted");
        layer.note_omitted(&data.deleted, one, many);
        data.broken.text().iter().chain(&data.fault).for_each(|text| layer.fault(text));
        layer.finish()
    }

    /// Returns whether things with these tags, of the layer's shape, belong to it.
    fn holds(self, data: &OsmData, tags: &OsmTags) -> bool {
        let has = |&(key, wanted): &(&str, Option<&str>)| {
            let value = data.value(tags, key);
            value.is_some() && (wanted.is_none() || wanted == value)
        };
        if self.tags.is_empty() {
            significant_tags(data, tags).next().is_some()
        } else {
            self.tags.iter().any(has)
        }
    }

    fn add_points(self, data: &OsmData, layer: &mut LayerBuilder) {
        for (node, tags) in data.tagged_nodes.iter().filter(|(_, tags)| self.holds(data, tags)) {
            let text = data.value(tags, "ele").map(str::trim).filter(|text| !text.is_empty());
            let elevation = text.and_then(|text| text.parse().ok());
            let (x, y) = node.degrees();
            let mut parts = FeatureParts::default();
            parts.add_points(vec![position(x, y, elevation)]);
            if text.is_some() && elevation.is_none() {
                parts.count_elevation();
            }
            let place = || named_place(data, "node", node.id, tags);
            layer.add_at(parts, properties(data, tags, "osm_id", node.id), place);
        }
    }

    fn add_lines<'a>(self, data: &'a OsmData, layer: &mut LayerBuilder) {
        let (mut cut, mut outside) = (RecordTally::new(), RecordTally::new());
        let line = |way: &'a OsmWay| {
            let mut parts = FeatureParts::default();
            let OsmRuns { runs, is_whole } = data.runs(&way.refs);
            let lines = runs.into_iter().filter(|run| is_whole || run.len() > 1);
            lines.for_each(|run| parts.add_line(run));
            (way, parts, is_whole, properties(data, &way.tags, "osm_id", way.id))
        };
        let is_line = |way: &&OsmWay| self.holds(data, &way.tags) && !is_area(data, way);
        let lines: Vec<_> = data.ways.par_iter().filter(is_line).map(line).collect();
        for (way, parts, is_whole, properties) in lines {
            let place = || named_place(data, "way", way.id, &way.tags);
            if !is_whole && parts.is_empty() {
                outside.add(place);
                continue;
            }
            if !is_whole {
                cut.add(place);
            }
            layer.add_at(parts, properties, place);
        }
        if let Some(text) = cut.text("way that leaves the extract", "ways that leave the extract") {
            layer.note(format!("{text}: only the parts within it are there, and each is a line of its own"));
        }
        layer.note_omitted(
            &outside,
            "way that lies outside the extract",
            "ways that lie outside the extract",
        );
    }

    fn add_areas<'a>(self, data: &'a OsmData, layer: &mut LayerBuilder) -> Result<(), VectorError> {
        let mut assembler = AreaAssembler::new(data);
        let (mut open, mut cut) = (RecordTally::new(), RecordTally::new());
        let is_area_relation = |relation: &&OsmRelation| {
            matches!(data.value(&relation.tags, "type"), Some("multipolygon" | "boundary"))
        };
        for relation in data.relations.iter().filter(is_area_relation) {
            let tags = assembler.tags_of(relation);
            if !self.holds(data, tags) {
                continue;
            }
            let place = || named_place(data, "relation", relation.id, tags);
            match assembler.polygons(relation)? {
                Some(polygons) => {
                    let mut parts = FeatureParts::default();
                    polygons.into_iter().for_each(|rings| parts.add_polygon(rings));
                    layer.add_at(parts, properties(data, tags, "osm_id", relation.id), place);
                    assembler.replace_outer_ways(relation, tags);
                }
                None => open.add(place),
            }
        }
        let outline = |way: &'a OsmWay| {
            (way, data.positions(&way.refs), properties(data, &way.tags, "osm_way_id", way.id))
        };
        let is_own_area =
            |way: &&OsmWay| self.holds(data, &way.tags) && is_area(data, way) && !assembler.replaces(way);
        let outlines: Vec<_> = data.ways.par_iter().filter(is_own_area).map(outline).collect();
        for (way, ring, properties) in outlines {
            let place = || named_place(data, "way", way.id, &way.tags);
            // An outline with a gap encloses something else.
            let Some(ring) = ring else {
                cut.add(place);
                continue;
            };
            let mut parts = FeatureParts::default();
            parts.add_polygon([ring]);
            layer.add_at(parts, properties, place);
        }
        layer.note_omitted(
            &open,
            "area of a relation that leaves the extract or does not close",
            "areas of relations that leave the extract or do not close",
        );
        layer.note_omitted(
            &cut,
            "area whose outline leaves the extract",
            "areas whose outlines leave the extract",
        );
        Ok(())
    }
}

/// Returns `way 12 'Main Street'`.
fn named_place(data: &OsmData, kind: &str, id: i64, tags: &OsmTags) -> String {
    match data.value(tags, "name") {
        Some(name) => format!("{kind} {id} '{}'", shorten(name)),
        None => format!("{kind} {id}"),
    }
}

/// Returns the tags that classify a feature.
fn significant_tags<'a>(data: &'a OsmData, tags: &'a OsmTags) -> impl Iterator<Item = (&'a str, &'a str)> {
    data.tags(tags).filter(|(key, _)| !INSIGNIFICANT_KEYS.contains(key))
}

/// Returns whether the way is closed and its tags make it an area.
fn is_area(data: &OsmData, way: &OsmWay) -> bool {
    way.refs.len() >= 4
        && way.refs.first() == way.refs.last()
        && match data.value(&way.tags, "area") {
            Some("yes") => true,
            Some("no") => false,
            _ => data.tags(&way.tags).any(|tag| AREA_KEYS.contains(&tag.0) || AREA_TAGS.contains(&tag)),
        }
}

fn properties(data: &OsmData, tags: &OsmTags, id_key: &str, id: i64) -> Properties {
    let tags = data.tags(tags).map(|(key, value)| (key.to_owned(), value.into()));
    tags.chain([(id_key.to_owned(), id.to_string().into())]).collect()
}

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
        let hints = VectorHints { layer: Some(wanted), ..VectorHints::default() };
        let extract = OsmExtract::of_xml(extract(content).as_bytes(), &hints);
        extract.and_then(|extract| extract.layer(&hints)).expect(wanted)
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
        let expected =
            "left out: 1 area of a relation that leaves the extract or does not close (relation 9)";
        assert!(cut.features.is_empty() && cut.notes == [expected], "{:?}", cut.notes);
    }

    #[test]
    fn an_outer_way_with_other_tags_than_its_relation_stays_an_area() {
        let relation = "<relation id='9'><member type='way' ref='1' role='outer'/>\
            <tag k='type' v='multipolygon'/><tag k='name' v='Palace'/></relation>";
        let palace = way(1, &SQUARE, &[("building", "yes")]) + relation;
        assert_eq!(layer(&palace, "buildings").features.len(), 1);
        assert_eq!(layer(&palace, "multipolygons").features.len(), 2);
        let same = palace.replace("k='name' v='Palace'", "k='building' v='yes'");
        assert_eq!(layer(&same, "multipolygons").features.len(), 1);
    }

    #[test]
    fn a_relation_without_tags_takes_those_of_its_outer_way_and_replaces_it() {
        let relation = "<relation id='9'><member type='way' ref='1' role='outer'/>\
            <member type='way' ref='3' role='inner'/><tag k='type' v='multipolygon'/></relation>";
        let content = way(1, &SQUARE, &[("building", "yes")]) + &way(3, &[34, 35, 45, 34], &[]) + relation;
        let buildings = layer(&content, "buildings");
        assert_eq!(buildings.features.len(), 1);
        assert_eq!(buildings.features[0].polygons()[0].holes.len(), 1);
    }

    #[test]
    fn a_way_that_leaves_the_extract_is_parted_at_the_gap() {
        let road = [("highway", "track"), ("name", "Rim")];
        let roads = layer(&way(4, &[1, 2, 777, 3, 4, 5, 778, 6], &road), "roads");
        let [feature] = &roads.features[..] else { panic!("one road") };
        assert_eq!(feature.lines().iter().map(Vec::len).collect::<Vec<_>>(), [2, 3]);
        let expected = "1 way that leaves the extract (way 4 'Rim'): only the parts within it are there, \
            and each is a line of its own";
        assert_eq!(roads.notes, [expected]);
        // A circle is opened at a node that is there.
        let circle = layer(&way(4, &[2, 1, 777, 3, 4, 2], &road), "roads");
        let [feature] = &circle.features[..] else { panic!("one road") };
        assert_eq!(feature.lines().iter().map(Vec::len).collect::<Vec<_>>(), [4]);
        let outside = layer(&(way(4, &[1, 777, 2], &road) + &way(5, &[1, 2], &road)), "roads");
        assert_eq!(outside.features.len(), 1);
        assert_eq!(outside.notes, ["left out: 1 way that lies outside the extract (way 4 'Rim')"]);
    }

    #[test]
    fn an_area_whose_outline_leaves_the_extract_is_left_out() {
        let house = [("building", "yes")];
        let content = way(1, &[1, 10, 777, 91, 1], &house) + &way(2, &SQUARE, &house);
        let buildings = layer(&content, "buildings");
        assert_eq!(buildings.features.len(), 1);
        assert_eq!(buildings.notes, ["left out: 1 area whose outline leaves the extract (way 1)"]);
    }

    #[test]
    fn odd_and_deleted_objects_are_left_out_and_reported() {
        let content = way(4, &[1, 2], &[("highway", "track")])
            + "\n<node id='300' lat='91' lon='1'/>\n<way id='6'><nd ref='x'/><tag k='highway' v='path'/></way>"
            + "<node id='301' lat='1' lon='1' visible='false'/><way id='7' action='delete'/>";
        let roads = layer(&content, "roads");
        assert_eq!(roads.features.len(), 1);
        let [fault] = &roads.faults[..] else { panic!("one sentence: {:?}", roads.faults) };
        for part in ["2 records", "line 2: a node has no latitude", "line 3: <nd> has no number as its ref"] {
            assert!(fault.contains(part), "{fault}");
        }
        assert_eq!(roads.notes, ["left out: 2 objects marked as deleted (node 301, way 7)"]);
        let only = "<osm><node id='1' lat='x' lon='2'/></osm>";
        let hints = VectorHints { layer: Some("points"), ..VectorHints::default() };
        assert!(OsmExtract::of_xml(only.as_bytes(), &hints).is_err(), "nothing is sound");
    }

    #[test]
    fn parts_of_buildings_are_buildings_and_areas() {
        let content = way(1, &SQUARE, &[("building", "yes")]) + &way(2, &SQUARE, &[("building:part", "yes")]);
        assert_eq!(layer(&content, "buildings").features.len(), 2);
        assert_eq!(layer(&content, "multipolygons").features.len(), 2);
        assert!(layer(&content, "lines").features.is_empty());
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
    fn layers_of_an_extract_read_once_are_those_of_it_read_for_each() {
        let content = way(1, &SQUARE, &[("building", "yes")])
            + &way(4, &[1, 2, 777, 3], &[("highway", "track")])
            + "\n<node id='300' lat='91' lon='1'/>";
        let of = |name: &'static str| VectorHints { layer: Some(name), ..VectorHints::default() };
        let read = OsmExtract::of_xml(extract(&content).as_bytes(), &of("points")).expect("sound");
        for known in LAYERS {
            let (kept, alone) = (read.layer(&of(known.name)).expect("sound"), layer(&content, known.name));
            assert_eq!(format!("{kept:?}"), format!("{alone:?}"), "{}", known.name);
        }
        assert!(read.layer(&VectorHints::default()).is_err());
    }

    #[test]
    fn without_a_layer_the_layers_are_listed() {
        let read = OsmExtract::of_xml(extract("").as_bytes(), &VectorHints::default());
        let error = read.map(drop).expect_err("which?").to_string();
        assert!(
            error.contains("8 layers") && error.contains("points, lines, multipolygons, roads"),
            "{error}"
        );
    }
}
