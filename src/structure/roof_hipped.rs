//! Hipped roofs: a plane of one pitch from every wall.
//!
//! Over a convex footprint the roof is the lowest of the planes that rise inward from its walls, so the face over a wall
//! is where that wall is the nearest: the footprint cut by the bisectors with all others, a convex polygon.
//!
//! ```text
//!   ●───────────────●
//!   │ ╲           ╱ │
//!   │   ○───────○   │      ridge and hips fall out of the cuts
//!   │ ╱           ╲ │
//!   ●───────────────●
//! ```
//!
//! Over a footprint with inward corners that is no longer so: its roof is made by
//! [`crate::straight_skeleton`].

use glam::{DVec2, DVec3};

use crate::building_footprint::BuildingFootprint;
use crate::unit_roof::{UnitRoof, level_edge};
use sandtable_description::words;
use sandtable_geom::polygon;

/// The most walls under a hipped roof: rounder plans cost the cube of their vertices.
const MOST_WALLS: usize = 64;

/// Corners of faces nearer to each other than this are one, in meters.
const WELD_M: f64 = 2e-3;

/// The line of a wall.
#[derive(Clone, Copy)]
struct Wall {
    from: DVec2,
    /// Unit normal into the building.
    inward: DVec2,
}

impl Wall {
    fn distance_m(&self, at: DVec2) -> f64 {
        self.inward.dot(at - self.from)
    }
}

/// The hipped roof of a convex footprint without courtyards; `None` for any other.
pub(crate) fn hipped(footprint: &BuildingFootprint) -> Option<UnitRoof> {
    let ring = footprint.exterior();
    if footprint.has_courtyards() || !footprint.is_convex() || ring.len() > MOST_WALLS {
        return None;
    }
    let walls: Vec<Wall> = polygon::edges(ring)
        .map(|(from, to)| Wall { from, inward: (to - from).normalize_or_zero().perp() })
        .collect();
    let mut corners: Vec<DVec3> = ring.iter().map(|at| at.extend(0.0)).collect();
    let faces: Vec<Vec<usize>> =
        (0..walls.len()).map(|wall| welded(&face(ring, &walls, wall), walls[wall], &mut corners)).collect();
    let run_m = corners.iter().map(|corner| corner.z).fold(0.0, f64::max);
    let risen = |&index: &usize| DVec3 { z: corners[index].z / run_m, ..corners[index] };
    let faces = faces.iter().filter(|face| face.len() > 2).map(|face| face.iter().map(risen).collect());
    let roof = UnitRoof {
        shape: words::RoofShape::Hipped,
        edge: level_edge(footprint),
        faces: faces.collect(),
        run_m,
    };
    (run_m > WELD_M).then_some(roof)
}

/// Where in the footprint the wall is the nearest, counter-clockwise.
fn face(ring: &[DVec2], walls: &[Wall], index: usize) -> Vec<DVec2> {
    let wall = walls[index];
    let (mut left, mut scratch) = (ring.to_vec(), Vec::new());
    for (other_index, other) in walls.iter().enumerate() {
        let across = other.inward - wall.inward;
        if other_index == index || across.length_squared() < 1e-12 {
            continue;
        }
        // Distances from a vertex of the ring keep their digits far from the origin.
        let nearer = wall.distance_m(ring[0]) - other.distance_m(ring[0]);
        let from = ring[0] + across * (nearer / across.length_squared());
        polygon::clip_half_plane(&mut left, &mut scratch, (from, from - across.perp()));
    }
    left
}

/// A face's corners among all corners, the neighbors that are one taken together; X, Y and the distance from the wall.
fn welded(face: &[DVec2], wall: Wall, corners: &mut Vec<DVec3>) -> Vec<usize> {
    let mut found: Vec<usize> = Vec::with_capacity(face.len());
    for &at in face {
        let near = corners.iter().position(|corner| corner.truncate().distance(at) <= WELD_M);
        let index = near.unwrap_or_else(|| {
            corners.push(at.extend(wall.distance_m(at).max(0.0)));
            corners.len() - 1
        });
        if found.last() != Some(&index) {
            found.push(index);
        }
    }
    while found.len() > 1 && found.first() == found.last() {
        found.pop();
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::unit_roof::check;

    fn turned(points: &[(f64, f64)], turn_deg: f64) -> BuildingFootprint {
        let turn = DVec2::from_angle(turn_deg.to_radians());
        let ring: Vec<DVec2> = points.iter().map(|&(x, y)| turn.rotate(DVec2::new(x, y))).collect();
        BuildingFootprint::parts(&ring, &[]).remove(0)
    }

    #[test]
    fn a_house_has_two_trapezes_two_triangles_and_a_ridge() {
        for turn in [0.0, 33.0, 90.0, 217.0] {
            let house = turned(&[(0.0, 0.0), (12.0, 0.0), (12.0, 8.0), (0.0, 8.0)], turn);
            let roof = hipped(&house).expect("convex");
            let mut counts: Vec<usize> = roof.faces.iter().map(Vec::len).collect();
            counts.sort_unstable();
            assert_eq!(counts, [3, 3, 4, 4]);
            assert!((roof.run_m - 4.0).abs() < 1e-6);
            assert!((check(&roof).expect("upward") - 96.0).abs() < 1e-2);
            let ridge: Vec<&DVec3> = roof.faces.iter().flatten().filter(|at| at.z > 0.999).collect();
            assert_eq!(ridge.len(), 6, "two ends, each in three faces");
        }
    }

    #[test]
    fn a_round_tower_has_a_tip_and_an_inward_corner_no_hipped_roof() {
        let vertex = |index: u32| {
            let angle = f64::from(index) * std::f64::consts::TAU / 16.0;
            (libm::cos(angle) * 5.0, libm::sin(angle) * 5.0)
        };
        let tower = turned(&(0..16).map(vertex).collect::<Vec<_>>(), 10.0);
        let roof = hipped(&tower).expect("convex");
        assert_eq!(roof.faces.len(), 16);
        assert!(roof.faces.iter().all(|face| face.len() == 3));
        let bent = [(0.0, 0.0), (20.0, 0.0), (20.0, 6.0), (6.0, 6.0), (6.0, 20.0), (0.0, 20.0)];
        assert_eq!(hipped(&turned(&bent, 0.0)), None);
    }
}
