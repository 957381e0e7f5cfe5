//! Joins the ways of relations end to end to rings, and rings to polygons with holes.
//!
//! A relation is only read complete: with a way missing or open, its islands would turn into lakes.

use std::collections::BTreeMap;
use std::error::Error;

use crate::builder::Vertices;
use crate::error::VectorError;
use crate::osm::data::{OsmData, OsmRelation, OsmTags, OsmWay};
use crate::osm::significant_tags;
use crate::rings::{HoleRule, RingSorter};
use sandtable_base::limits::OSM_AREA_VERTICES;

/// Assembles areas, and tracks the ways that they replace.
pub(super) struct AreaAssembler<'a> {
    data: &'a OsmData,
    /// By the way's index.
    is_replaced: Vec<bool>,
    sorter: RingSorter,
    vertices_left: usize,
}

impl<'a> AreaAssembler<'a> {
    pub fn new(data: &'a OsmData) -> Self {
        Self {
            data,
            is_replaced: vec![false; data.ways.len()],
            sorter: RingSorter::new(HoleRule::Nesting),
            vertices_left: OSM_AREA_VERTICES.count(),
        }
    }

    /// Returns whether the area of a relation replaces that of the way.
    pub fn replaces(&self, way: &OsmWay) -> bool {
        self.data.way_index(way.id).is_some_and(|index| self.is_replaced[index])
    }

    /// Lets the area of a relation with these tags replace its outer ways. An outer way with other tags, such as the
    /// building that a named site consists of, stays an area; GDAL drops it.
    pub fn replace_outer_ways(&mut self, relation: &OsmRelation, tags: &OsmTags) {
        let data = self.data;
        for index in outer_ways(data, relation) {
            let mut own = significant_tags(data, &data.ways[index].tags);
            self.is_replaced[index] |= own.all(|(key, value)| data.value(tags, key) == Some(value));
        }
    }

    /// Returns the tags of a relation; where it has none but its type, as old relations, those of its first outer way
    /// that has any.
    pub fn tags_of(&self, relation: &'a OsmRelation) -> &'a OsmTags {
        let data = self.data;
        if data.tags(&relation.tags).any(|(key, _)| key != "type") {
            return &relation.tags;
        }
        let mut tags = outer_ways(data, relation).map(|index| &data.ways[index].tags);
        tags.find(|tags| significant_tags(data, tags).next().is_some()).unwrap_or(&relation.tags)
    }

    /// Returns the polygons of a relation, each its rings with the outer one first; `None` where it is incomplete.
    ///
    /// # Errors
    /// The areas of this extract exceed a limit.
    pub fn polygons(&mut self, relation: &OsmRelation) -> Result<Option<Vec<Vec<Vertices>>>, VectorError> {
        let data = self.data;
        let mut ids: Vec<i64> = relation.members.iter().map(|member| member.way).collect();
        ids.sort_unstable();
        ids.dedup();
        let ways: Option<Vec<&OsmWay>> =
            ids.iter().map(|&id| data.way_index(id).map(|index| &data.ways[index])).collect();
        let loops = ways.filter(|ways| !ways.is_empty()).and_then(|ways| closed_loops(&ways));
        let Some(loops) = loops else { return Ok(None) };
        let exceeded = |error: Box<dyn Error + Send + Sync>| {
            let place = format!("relation {}", relation.id);
            VectorError::broken("OpenStreetMap extract", place, error)
        };
        let too_many = || {
            format!(
                "the areas up to here have more than {OSM_AREA_VERTICES} vertices; cut the extract, or {OSM_AREA_VERTICES:#}"
            )
        };
        let vertices = loops.iter().map(Vec::len).sum();
        self.vertices_left =
            self.vertices_left.checked_sub(vertices).ok_or_else(|| exceeded(too_many().into()))?;
        let rings: Option<Vec<Vertices>> = loops.iter().map(|ids| data.positions(ids)).collect();
        let Some(rings) = rings else { return Ok(None) };
        let sorted = self.sorter.polygons(rings).map_err(|error| exceeded(error.into()))?;
        Ok(Some(sorted.polygons))
    }
}

/// Returns the indices of the outer ways of a relation that the extract has.
fn outer_ways<'a>(data: &'a OsmData, relation: &'a OsmRelation) -> impl Iterator<Item = usize> + 'a {
    let outer = relation.members.iter().filter(|member| !member.is_inner);
    outer.filter_map(|member| data.way_index(member.way))
}

/// Joins ways at their ends and returns the ids of the nodes of each loop; `None` where some ways are left over.
fn closed_loops(ways: &[&OsmWay]) -> Option<Vec<Vec<i64>>> {
    let mut ways_at: BTreeMap<i64, Vec<usize>> = BTreeMap::new();
    for (index, way) in ways.iter().enumerate() {
        let (first, last) = (*way.refs.first()?, *way.refs.last()?);
        ways_at.entry(first).or_default().push(index);
        if first != last {
            ways_at.entry(last).or_default().push(index);
        }
    }
    let mut is_free = vec![true; ways.len()];
    let mut loops = Vec::new();
    for index in 0..ways.len() {
        if !is_free[index] {
            continue;
        }
        is_free[index] = false;
        let mut ring = ways[index].refs.to_vec();
        while ring.first() != ring.last() {
            let end = *ring.last()?;
            // Ways in use are removed, so that no list is searched twice.
            let candidates = ways_at.get_mut(&end)?;
            candidates.retain(|&candidate| is_free[candidate]);
            let next = candidates.pop()?;
            is_free[next] = false;
            let refs = &ways[next].refs;
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
