//! An extract in memory: nodes, ways and relations as they are, texts once each.
//!
//! ```text
//! nodes  id, longitude, latitude (10⁻⁷ degrees), sorted by id      16 bytes each
//! ways   id, range of refs, range of tags, sorted by id            refs: 8 bytes each
//! tags   pairs of numbers of texts                                  8 bytes each
//! ```

use std::collections::HashMap;
use std::ops::Range;
use std::sync::Arc;

use glam::DVec3;

use crate::vector::collect::position;
use crate::vector::osm::OsmLine;

/// The most bytes that an extract may take in memory. A hostile file of small numbers, well packed, would take
/// thousands of times its size; a city's takes ten.
const MOST_BYTES: usize = 2 << 30;

/// Units of coordinates in a degree.
pub(super) const PER_DEGREE: f64 = 1e7;

/// The extract takes more memory than it may.
#[derive(Debug)]
pub(super) struct TooMuch;

/// A place.
#[derive(Clone, Copy, Debug)]
pub(super) struct OsmNode {
    pub id: i64,
    longitude: i32,
    latitude: i32,
}

/// Where a thing's tags lie.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct OsmTags {
    start: u32,
    end: u32,
}

/// A list of nodes.
#[derive(Debug)]
pub(super) struct OsmWay {
    pub id: i64,
    refs: Range<u32>,
    pub tags: OsmTags,
}

/// A list of ways; members of other kinds are not kept.
#[derive(Debug)]
pub(super) struct Relation {
    pub id: i64,
    members: Range<u32>,
    pub tags: OsmTags,
}

/// The role that a way has in a relation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Role {
    /// Of a hole.
    Inner,
    /// Any other.
    Outer,
}

/// The number of a text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct TextId(u32);

/// All of an extract.
#[derive(Default)]
pub(super) struct OsmData {
    nodes: Vec<OsmNode>,
    node_tags: Vec<(OsmNode, OsmTags)>,
    ways: Vec<OsmWay>,
    refs: Vec<i64>,
    relations: Vec<Relation>,
    members: Vec<(i64, Role)>,
    tags: Vec<(TextId, TextId)>,
    texts: Vec<Arc<str>>,
    numbers: HashMap<Arc<str>, TextId>,
    taken: usize,
}

impl OsmNode {
    /// Longitude and latitude in degrees.
    pub fn degrees(self) -> (f64, f64) {
        (f64::from(self.longitude) / PER_DEGREE, f64::from(self.latitude) / PER_DEGREE)
    }
}

impl OsmData {
    /// The number of a text, which is kept if it is new.
    ///
    /// # Errors
    /// [`TooMuch`].
    pub fn text(&mut self, text: &str) -> Result<TextId, TooMuch> {
        /// A text costs its bytes and what keeps it.
        const OVERHEAD: usize = 64;
        if let Some(&known) = self.numbers.get(text) {
            return Ok(known);
        }
        self.take(text.len() + OVERHEAD)?;
        let number = TextId(self.texts.len() as u32);
        let text: Arc<str> = text.into();
        self.texts.push(Arc::clone(&text));
        self.numbers.insert(text, number);
        Ok(number)
    }

    /// Keeps tags.
    ///
    /// # Errors
    /// [`TooMuch`].
    pub fn add_tags(&mut self, tags: &[(TextId, TextId)]) -> Result<OsmTags, TooMuch> {
        self.take(size_of_val(tags))?;
        let start = self.tags.len() as u32;
        self.tags.extend_from_slice(tags);
        Ok(OsmTags { start, end: self.tags.len() as u32 })
    }

    /// Keeps a node, its coordinates in ten-millionths of a degree.
    ///
    /// # Errors
    /// [`TooMuch`].
    pub fn add_node(
        &mut self,
        id: i64,
        [longitude, latitude]: [i32; 2],
        tags: OsmTags,
    ) -> Result<(), TooMuch> {
        self.take(size_of::<OsmNode>())?;
        let node = OsmNode { id, longitude, latitude };
        self.nodes.push(node);
        if tags.start < tags.end {
            self.take(size_of::<(OsmNode, OsmTags)>())?;
            self.node_tags.push((node, tags));
        }
        Ok(())
    }

    /// Keeps a way through nodes.
    ///
    /// # Errors
    /// [`TooMuch`].
    pub fn add_way(&mut self, id: i64, refs: &[i64], tags: OsmTags) -> Result<(), TooMuch> {
        self.take(size_of::<OsmWay>() + size_of_val(refs))?;
        let start = self.refs.len() as u32;
        self.refs.extend_from_slice(refs);
        self.ways.push(OsmWay { id, refs: start..self.refs.len() as u32, tags });
        Ok(())
    }

    /// Keeps a relation of ways.
    ///
    /// # Errors
    /// [`TooMuch`].
    pub fn add_relation(&mut self, id: i64, members: &[(i64, Role)], tags: OsmTags) -> Result<(), TooMuch> {
        self.take(size_of::<Relation>() + size_of_val(members))?;
        let start = self.members.len() as u32;
        self.members.extend_from_slice(members);
        self.relations.push(Relation { id, members: start..self.members.len() as u32, tags });
        Ok(())
    }

    fn take(&mut self, bytes: usize) -> Result<(), TooMuch> {
        self.taken += bytes;
        if self.taken > MOST_BYTES { Err(TooMuch) } else { Ok(()) }
    }

    /// Brings nodes and ways into the order of their ids, in which they are looked up. Files mostly are so already.
    pub fn sort(&mut self) {
        if !self.nodes.is_sorted_by_key(|node| node.id) {
            self.nodes.sort_by_key(|node| node.id);
        }
        if !self.ways.is_sorted_by_key(|way| way.id) {
            self.ways.sort_by_key(|way| way.id);
        }
    }

    /// Nodes that have tags, in the file's order.
    pub fn tagged_nodes(&self) -> impl Iterator<Item = (OsmNode, OsmTags)> + '_ {
        self.node_tags.iter().copied()
    }

    /// All ways, sorted by id.
    pub fn ways(&self) -> &[OsmWay] {
        &self.ways
    }

    /// The index of the way with this id; `None` where the extract has it not.
    pub fn way(&self, id: i64) -> Option<usize> {
        self.ways.binary_search_by_key(&id, |way| way.id).ok()
    }

    /// All relations, in the file's order.
    pub fn relations(&self) -> &[Relation] {
        &self.relations
    }

    /// A relation's ways, by id.
    pub fn members(&self, relation: &Relation) -> &[(i64, Role)] {
        &self.members[relation.members.start as usize..relation.members.end as usize]
    }

    /// The ids of a way's nodes.
    pub fn refs(&self, way: &OsmWay) -> &[i64] {
        &self.refs[way.refs.start as usize..way.refs.end as usize]
    }

    /// Where those of a way's nodes are that the extract has.
    pub fn positions(&self, way: &OsmWay) -> OsmLine {
        self.refs(way).iter().filter_map(|&id| self.position(id)).collect()
    }

    /// Where a node is; `None` where the extract has it not.
    pub fn position(&self, id: i64) -> Option<DVec3> {
        let index = self.nodes.binary_search_by_key(&id, |node| node.id).ok()?;
        let (x, y) = self.nodes[index].degrees();
        Some(position(x, y, None))
    }

    /// Keys and values.
    pub fn tags(&self, tags: OsmTags) -> impl Iterator<Item = (&str, &str)> {
        let text = |TextId(number): TextId| &*self.texts[number as usize];
        let all = &self.tags[tags.start as usize..tags.end as usize];
        all.iter().map(move |&(key, value)| (text(key), text(value)))
    }

    /// The value that `key` has.
    pub fn value(&self, tags: OsmTags, key: &str) -> Option<&str> {
        self.tags(tags).find(|tag| tag.0 == key).map(|tag| tag.1)
    }
}
