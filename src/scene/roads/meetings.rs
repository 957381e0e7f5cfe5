//! The nodes where roads end and meet, along their centerlines.
//!
//! Lines meet where they share a vertex. An end meets whatever is there: a bridge meets the road that leads to it though
//! they have different levels. Lines that both go on meet only where their level is the same, and such lines of one level
//! meet also where they cross without a vertex.

use std::collections::BTreeMap;

use crate::roads::at_grade::crossings;
use crate::roads::centerline::Centerline;
use sandtable_earthworks::alignment::network::NodeId;
use sandtable_geom::polyline::{VertexKey, vertex_key};

/// A crossing this near to a vertex is at that vertex, in meters.
const SAME_M: f64 = 0.01;

/// A node on a centerline.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoadStop {
    /// Meters along the centerline.
    pub station_m: f64,
    /// The node.
    pub node: NodeId,
}

/// The nodes of all roads.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RoadMeetings {
    /// For each road its nodes in order of station: its ends first and last, and between them where others meet it.
    pub stops: Vec<Vec<RoadStop>>,
    /// How many nodes there are.
    pub nodes: usize,
    /// Whether the lines were too tangled to find where they cross without a vertex.
    pub is_tangled: bool,
}

/// A vertex of a road.
#[derive(Clone, Copy)]
struct RoadVertex {
    road: usize,
    index: usize,
    is_end: bool,
}

/// Finds where the roads end and meet. Only roads for which `crosses` holds meet where they cross without a vertex.
pub fn meetings(roads: &[Centerline], crosses: impl Fn(&Centerline) -> bool) -> RoadMeetings {
    let mut places: BTreeMap<VertexKey, Vec<RoadVertex>> = BTreeMap::new();
    for (road, centerline) in roads.iter().enumerate() {
        let points = centerline.street.alignment.line.points();
        for (index, at) in points.iter().enumerate() {
            let is_end = index == 0 || index + 1 == points.len();
            places.entry(vertex_key(*at)).or_default().push(RoadVertex { road, index, is_end });
        }
    }
    let mut found = RoadMeetings { stops: vec![Vec::new(); roads.len()], ..RoadMeetings::default() };
    for vertices in places.values() {
        if vertices.iter().any(|vertex| vertex.is_end) {
            found.join(roads, vertices);
            continue;
        }
        let mut by_level: BTreeMap<i32, Vec<RoadVertex>> = BTreeMap::new();
        for vertex in vertices {
            by_level.entry(roads[vertex.road].street.level).or_default().push(*vertex);
        }
        by_level.values().filter(|alike| alike.len() > 1).for_each(|alike| found.join(roads, alike));
    }
    found.sort();
    found.cross(roads, crosses);
    found.sort();
    found
}

impl RoadMeetings {
    fn node(&mut self) -> NodeId {
        self.nodes += 1;
        NodeId(self.nodes as u32 - 1)
    }

    fn join(&mut self, roads: &[Centerline], vertices: &[RoadVertex]) {
        let node = self.node();
        for vertex in vertices {
            let station_m = roads[vertex.road].street.alignment.line.stations()[vertex.index];
            self.stops[vertex.road].push(RoadStop { station_m, node });
        }
    }

    /// Adds the crossings that have no vertex on both roads.
    fn cross(&mut self, roads: &[Centerline], crosses: impl Fn(&Centerline) -> bool) {
        let Some(crossings) = crossings(roads, crosses) else {
            self.is_tangled = true;
            return;
        };
        let at_vertices: Vec<usize> = self.stops.iter().map(Vec::len).collect();
        for crossing in crossings {
            let held = crossing.map(|(road, station_m)| {
                let stops = &self.stops[road][..at_vertices[road]];
                let place = stops.partition_point(|stop| stop.station_m < station_m - SAME_M);
                stops.get(place).filter(|stop| stop.station_m <= station_m + SAME_M).copied()
            });
            let node = match held {
                [Some(_), Some(_)] => continue,
                [Some(stop), None] | [None, Some(stop)] => stop.node,
                [None, None] => self.node(),
            };
            for ((road, station_m), held) in crossing.into_iter().zip(held) {
                if held.is_none() {
                    self.stops[road].push(RoadStop { station_m, node });
                }
            }
        }
    }

    fn sort(&mut self) {
        self.stops.iter_mut().for_each(|stops| stops.sort_by(|a, b| a.station_m.total_cmp(&b.station_m)));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::roads::centerline::tests::road;
    use sandtable_earthworks::alignment::Support;

    #[test]
    fn ends_meet_whatever_is_there_and_through_roads_only_their_own_level() {
        let east = road(&[(0.0, 0.0), (50.0, 0.0), (100.0, 0.0)], Support::Ground, 0);
        let over = road(&[(50.0, -50.0), (50.0, 0.0), (50.0, 50.0)], Support::Bridge, 1);
        let on = road(&[(50.0, 50.0), (50.0, 90.0)], Support::Ground, 0);
        let found = meetings(&[east, over, on], |_| true);
        assert_eq!(found.nodes, 5);
        assert_eq!(found.stops.iter().map(Vec::len).collect::<Vec<_>>(), [2, 2, 2]);
        assert_eq!(found.stops[1][1].node, found.stops[2][0].node);
    }

    #[test]
    fn a_t_is_a_node_in_the_middle_of_the_road_that_goes_on() {
        let through = road(&[(0.0, 0.0), (50.0, 0.0), (100.0, 0.0)], Support::Ground, 0);
        let side = road(&[(50.0, 0.0), (50.0, 80.0)], Support::Ground, 0);
        let found = meetings(&[through, side], |_| true);
        assert_eq!(found.nodes, 4);
        assert_eq!(found.stops[0][1], RoadStop { station_m: 50.0, node: found.stops[1][0].node });
    }

    #[test]
    fn roads_that_cross_without_a_vertex_meet_once() {
        let east = road(&[(0.0, 0.0), (100.0, 0.0)], Support::Ground, 0);
        let north = road(&[(40.0, -50.0), (40.0, 50.0)], Support::Ground, 0);
        let high = road(&[(60.0, -50.0), (60.0, 50.0)], Support::Bridge, 1);
        let found = meetings(&[east, north, high], |_| true);
        assert_eq!(found.nodes, 7);
        assert_eq!(found.stops[0][1], RoadStop { station_m: 40.0, node: found.stops[1][1].node });
        assert_eq!(found.stops[2].len(), 2);
    }
}
