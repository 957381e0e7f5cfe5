//! An OpenStreetMap extract in memory: nodes, ways and relations by id, each text once.

use std::collections::HashMap;
use std::sync::Arc;

use glam::DVec3;

use crate::broken_records::BrokenRecords;
use crate::builder::{Vertices, position};
use crate::tally::RecordTally;
use sandtable_base::limits::OSM_BYTES;

/// Bytes that an allocation takes beyond its content.
const ALLOCATION_BYTES: usize = 16;
/// Units of coordinates in a degree.
pub(super) const UNITS_PER_DEGREE: f64 = 1e7;

/// The extract takes more memory than it may.
#[derive(Debug, thiserror::Error)]
#[error(
    "it takes more than {OSM_BYTES} bytes of memory; cut it down with 'osmium extract', or {OSM_BYTES:#}"
)]
pub(super) struct OsmMemoryExceeded;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct TextId(u32);

pub(super) type OsmTags = Box<[(TextId, TextId)]>;

/// A position, in ten-millionths of a degree.
#[derive(Clone, Copy, Debug)]
pub(super) struct OsmNode {
    pub id: i64,
    pub longitude: i32,
    pub latitude: i32,
}

#[derive(Debug)]
pub(super) struct OsmWay {
    pub id: i64,
    /// The ids of its nodes.
    pub refs: Box<[i64]>,
    pub tags: OsmTags,
}

/// The parts of a way that the extract has.
pub(super) struct OsmRuns {
    /// Of one vertex or more each.
    pub runs: Vec<Vertices>,
    /// Whether the extract has all of it.
    pub is_whole: bool,
}

/// A list of ways; members of other kinds are not kept.
#[derive(Debug)]
pub(super) struct OsmRelation {
    pub id: i64,
    pub members: Box<[OsmMember]>,
    pub tags: OsmTags,
}

/// A way in a relation.
#[derive(Clone, Copy, Debug)]
pub(super) struct OsmMember {
    /// The way's id.
    pub way: i64,
    /// Whether its role is that of a hole; any other role is outer.
    pub is_inner: bool,
}

/// All of an extract.
#[derive(Default)]
pub(super) struct OsmData {
    nodes: Vec<OsmNode>,
    pub tagged_nodes: Vec<(OsmNode, OsmTags)>,
    /// Sorted by id after [`Self::sort`].
    pub ways: Vec<OsmWay>,
    pub relations: Vec<OsmRelation>,
    /// Objects that are marked as deleted, which are not kept.
    pub deleted: RecordTally,
    /// Objects that cannot be read.
    pub broken: BrokenRecords,
    /// A sentence about bytes that are not of the file's encoding.
    pub fault: Option<String>,
    texts: Vec<Arc<str>>,
    text_ids: HashMap<Arc<str>, TextId>,
    bytes: usize,
}

/// The bytes that a text takes, with two handles and an entry of the map.
fn text_bytes(text: &str) -> usize {
    const HANDLES: usize = 64;
    text.len() + HANDLES
}

impl OsmNode {
    pub fn degrees(self) -> (f64, f64) {
        (f64::from(self.longitude) / UNITS_PER_DEGREE, f64::from(self.latitude) / UNITS_PER_DEGREE)
    }
}

/// Additions. Each fails with [`OsmMemoryExceeded`].
impl OsmData {
    /// Returns the index of a text, which is added where it is new.
    pub fn text(&mut self, text: &str) -> Result<TextId, OsmMemoryExceeded> {
        if let Some(&known) = self.text_ids.get(text) {
            return Ok(known);
        }
        self.charge(text_bytes(text))?;
        let id = TextId(self.texts.len() as u32);
        let text: Arc<str> = text.into();
        self.texts.push(Arc::clone(&text));
        self.text_ids.insert(text, id);
        Ok(id)
    }

    pub fn add_node(&mut self, node: OsmNode, tags: OsmTags) -> Result<(), OsmMemoryExceeded> {
        self.charge(size_of::<OsmNode>())?;
        self.nodes.push(node);
        if !tags.is_empty() {
            self.charge(size_of::<(OsmNode, OsmTags)>() + ALLOCATION_BYTES + size_of_val(&*tags))?;
            self.tagged_nodes.push((node, tags));
        }
        Ok(())
    }

    pub fn add_way(&mut self, way: OsmWay) -> Result<(), OsmMemoryExceeded> {
        let content = size_of_val(&*way.refs) + size_of_val(&*way.tags);
        self.charge(size_of::<OsmWay>() + 2 * ALLOCATION_BYTES + content)?;
        self.ways.push(way);
        Ok(())
    }

    pub fn add_relation(&mut self, relation: OsmRelation) -> Result<(), OsmMemoryExceeded> {
        let content = size_of_val(&*relation.members) + size_of_val(&*relation.tags);
        self.charge(size_of::<OsmRelation>() + 2 * ALLOCATION_BYTES + content)?;
        self.relations.push(relation);
        Ok(())
    }

    /// Adds all that the next block of the same file holds: blocks mark nothing as deleted, and have no encoding of their own.
    pub fn append(&mut self, block: Self) -> Result<(), OsmMemoryExceeded> {
        let Self { mut nodes, mut tagged_nodes, mut ways, mut relations, .. } = block;
        let texts: usize = block.texts.iter().map(|text| text_bytes(text)).sum();
        self.charge(block.bytes - texts)?;
        let ids = block.texts.iter().map(|text| self.text(text)).collect::<Result<Vec<_>, _>>()?;
        let renumber = |tags: &mut OsmTags| {
            for id in tags.iter_mut().flat_map(|(key, value)| [key, value]) {
                *id = ids[id.0 as usize];
            }
        };
        tagged_nodes.iter_mut().for_each(|(_, tags)| renumber(tags));
        ways.iter_mut().for_each(|way| renumber(&mut way.tags));
        relations.iter_mut().for_each(|relation| renumber(&mut relation.tags));
        self.nodes.append(&mut nodes);
        self.tagged_nodes.append(&mut tagged_nodes);
        self.ways.append(&mut ways);
        self.relations.append(&mut relations);
        self.broken.append(block.broken);
        Ok(())
    }

    fn charge(&mut self, bytes: usize) -> Result<(), OsmMemoryExceeded> {
        self.bytes += bytes;
        if self.bytes > OSM_BYTES.count() { Err(OsmMemoryExceeded) } else { Ok(()) }
    }
}

impl OsmData {
    /// Nothing yet, of a file with a fault in its encoding.
    pub fn new(fault: Option<String>) -> Self {
        Self { fault, ..Self::default() }
    }

    /// Sorts nodes and ways by id, which lookups need. Files mostly are sorted already.
    pub fn sort(&mut self) {
        if !self.nodes.is_sorted_by_key(|node| node.id) {
            self.nodes.sort_by_key(|node| node.id);
        }
        if !self.ways.is_sorted_by_key(|way| way.id) {
            self.ways.sort_by_key(|way| way.id);
        }
    }

    /// Returns the index of the way `id`, `None` where the extract lacks it.
    pub fn way_index(&self, id: i64) -> Option<usize> {
        self.ways.binary_search_by_key(&id, |way| way.id).ok()
    }

    /// Returns whether the extract holds nothing.
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty() && self.ways.is_empty() && self.relations.is_empty()
    }

    /// Returns the position of a node, in degrees without an elevation; `None` where the extract lacks it.
    fn position(&self, id: i64) -> Option<DVec3> {
        let index = self.nodes.binary_search_by_key(&id, |node| node.id).ok()?;
        let (x, y) = self.nodes[index].degrees();
        Some(position(x, y, None))
    }

    /// Returns the positions of the nodes `refs`; `None` where the extract lacks any of them.
    pub fn positions(&self, refs: &[i64]) -> Option<Vertices> {
        refs.iter().map(|&id| self.position(id)).collect()
    }

    /// Returns the positions of the nodes `refs`, parted where the extract lacks nodes. Where the first node is also the
    /// last, the run through it is one.
    pub fn runs(&self, refs: &[i64]) -> OsmRuns {
        let (mut runs, mut is_whole, mut is_running) = (Vec::<Vertices>::new(), true, false);
        for &id in refs {
            let Some(at) = self.position(id) else {
                (is_whole, is_running) = (false, false);
                continue;
            };
            match runs.last_mut().filter(|_| is_running) {
                Some(run) => run.push(at),
                None => runs.push(vec![at]),
            }
            is_running = true;
        }
        let starts = refs.first().is_some_and(|&id| self.position(id).is_some());
        if !is_whole && starts && refs.first() == refs.last() && runs.len() > 1 {
            let first = runs.remove(0);
            runs.last_mut().into_iter().for_each(|last| last.extend(&first[1..]));
        }
        OsmRuns { runs, is_whole }
    }

    pub fn tags(&self, tags: &OsmTags) -> impl Iterator<Item = (&str, &str)> {
        let text = |TextId(index): TextId| &*self.texts[index as usize];
        tags.iter().map(move |&(key, value)| (text(key), text(value)))
    }

    /// Returns the value of `key`, `None` where the tags lack it.
    pub fn value(&self, tags: &OsmTags, key: &str) -> Option<&str> {
        self.tags(tags).find(|tag| tag.0 == key).map(|tag| tag.1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fill(data: &mut OsmData, id: i64, tags: &[(&str, &str)]) {
        let tags: Result<OsmTags, OsmMemoryExceeded> =
            tags.iter().map(|(key, value)| Ok((data.text(key)?, data.text(value)?))).collect();
        let way = OsmWay { id, refs: Box::new([1, 2]), tags: tags.expect("memory") };
        data.add_node(OsmNode { id, longitude: 0, latitude: 0 }, way.tags.clone()).expect("memory");
        data.add_way(way).expect("memory");
    }

    #[test]
    fn blocks_keep_their_texts_where_they_are_put_together() {
        let blocks = [[("highway", "track"), ("name", "Rim")], [("name", "highway"), ("surface", "track")]];
        let (mut all, mut whole) = (OsmData::default(), OsmData::default());
        for (id, tags) in (1..).zip(&blocks) {
            let mut block = OsmData::default();
            fill(&mut block, id, tags);
            all.append(block).expect("memory");
            fill(&mut whole, id, tags);
        }
        for (index, tags) in blocks.iter().enumerate() {
            assert_eq!(all.tags(&all.ways[index].tags).collect::<Vec<_>>(), tags);
            assert_eq!(all.tags(&all.tagged_nodes[index].1).collect::<Vec<_>>(), tags);
        }
        assert_eq!((all.texts.len(), all.bytes), (5, whole.bytes), "texts that both have are charged once");
    }
}
