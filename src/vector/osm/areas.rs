//! Areas that relations make of ways: ways are joined end to end to rings, and rings to polygons with holes.
//!
//! A relation is only taken whole: where one of its ways is not in the extract or does not close, its islands
//! would turn into lakes.

use std::collections::BTreeMap;

use crate::vector::error::VectorError;
use crate::vector::osm::OsmLine;
use crate::vector::osm::data::{OsmData, OsmTags, OsmWay, Relation, Role};
use crate::vector::osm::saying;
use crate::vector::rings::{self, HoleRule};

/// The most vertices that the areas of one extract may have: far more than any has, and a gigabyte. Relations can
/// name the same ways again and again.
const MOST_VERTICES: usize = 1 << 25;

/// Makes areas, and knows which ways they stand for.
pub(super) struct Areas<'a> {
    data: &'a OsmData,
    /// By the way's index: whether an area of a relation stands for it.
    stood_for: Vec<bool>,
    steps: u64,
    vertices_left: usize,
}

impl<'a> Areas<'a> {
    /// None yet.
    pub fn new(data: &'a OsmData) -> Self {
        let stood_for = vec![false; data.ways().len()];
        Self { data, stood_for, steps: rings::MOST_STEPS, vertices_left: MOST_VERTICES }
    }

    /// Whether an area of a relation stands for this way, so that it is none of its own.
    pub fn stand_for(&self, way: &OsmWay) -> bool {
        self.data.way(way.id).is_some_and(|index| self.stood_for[index])
    }

    /// Lets the area of a relation with these tags stand for those of its outer ways that say nothing else. An outer
    /// way that says more, as the building that a named site is made of, stays an area of its own; GDAL drops it.
    pub fn stand_for_outer_ways(&mut self, relation: &Relation, tags: OsmTags) {
        let data = self.data;
        for index in outer_ways(data, relation) {
            let mut own = saying(data, data.ways()[index].tags);
            self.stood_for[index] |= own.all(|(key, value)| data.value(tags, key) == Some(value));
        }
    }

    /// The tags of a relation or, where it has none but its type, those of the first of its outer ways that has any:
    /// old relations are tagged so.
    pub fn tags_of(&self, relation: &Relation) -> OsmTags {
        let data = self.data;
        if data.tags(relation.tags).any(|tag| tag.0 != "type") {
            return relation.tags;
        }
        let tags = outer_ways(data, relation).map(|index| data.ways()[index].tags);
        let mut telling = tags.filter(|&tags| saying(data, tags).next().is_some());
        telling.next().unwrap_or(relation.tags)
    }

    /// The polygons of a relation, each its rings, the outer one first; `None` where it is not whole.
    ///
    /// # Errors
    /// The areas of this extract are more than are taken.
    pub fn polygons(&mut self, relation: &Relation) -> Result<Option<Vec<Vec<OsmLine>>>, VectorError> {
        let data = self.data;
        let mut ids: Vec<i64> = data.members(relation).iter().map(|member| member.0).collect();
        ids.sort_unstable();
        ids.dedup();
        let ways: Option<Vec<&OsmWay>> =
            ids.iter().map(|&id| data.way(id).map(|index| &data.ways()[index])).collect();
        let Some(loops) = ways.filter(|ways| !ways.is_empty()).and_then(|ways| closed_loops(data, &ways))
        else {
            return Ok(None);
        };
        let too_much = || {
            VectorError::broken(
                "OpenStreetMap extract",
                format!("relation {}", relation.id),
                "its areas are too many, too much inside each other",
            )
        };
        let vertices = loops.iter().map(Vec::len).sum();
        self.vertices_left = self.vertices_left.checked_sub(vertices).ok_or_else(too_much)?;
        let rings: Vec<OsmLine> =
            loops.iter().map(|ids| ids.iter().filter_map(|&id| data.position(id)).collect()).collect();
        if rings.iter().zip(&loops).any(|(ring, ids)| ring.len() < ids.len()) {
            return Ok(None);
        }
        rings::polygons(rings, HoleRule::Nesting, &mut self.steps).map(Some).map_err(|_| too_much())
    }
}

/// The indices of the outer ways of a relation that the extract has.
fn outer_ways<'a>(data: &'a OsmData, relation: &'a Relation) -> impl Iterator<Item = usize> + 'a {
    let outer = data.members(relation).iter().filter(|member| member.1 == Role::Outer);
    outer.filter_map(|member| data.way(member.0))
}

/// The closed lists of nodes that the ways make, joined at their ends; `None` where some are left over.
fn closed_loops(data: &OsmData, ways: &[&OsmWay]) -> Option<Vec<Vec<i64>>> {
    let mut ends: BTreeMap<i64, Vec<usize>> = BTreeMap::new();
    for (index, way) in ways.iter().enumerate() {
        let refs = data.refs(way);
        let (first, last) = (*refs.first()?, *refs.last()?);
        ends.entry(first).or_default().push(index);
        if first != last {
            ends.entry(last).or_default().push(index);
        }
    }
    let mut is_free = vec![true; ways.len()];
    let mut loops = Vec::new();
    for index in 0..ways.len() {
        if !is_free[index] {
            continue;
        }
        is_free[index] = false;
        let mut ring = data.refs(ways[index]).to_vec();
        while ring.first() != ring.last() {
            let end = *ring.last()?;
            // Ways that were taken are dropped from the list, so that it is not gone through again.
            let candidates = ends.get_mut(&end)?;
            candidates.retain(|&candidate| is_free[candidate]);
            let next = candidates.pop()?;
            is_free[next] = false;
            let refs = data.refs(ways[next]);
            if refs.first() == Some(&end) {
                ring.extend(&refs[1..]);
            } else {
                ring.extend(refs.iter().rev().skip(1));
            }
        }
        loops.push(ring);
    }
    Some(loops)
}
