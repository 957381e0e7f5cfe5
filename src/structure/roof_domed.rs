//! Roofs about one point over the middle: pyramids, and domes as a stack of rings.
//!
//! Every ring of a dome is the outline drawn together about its middle, so that the faces between two of them are flat.

use glam::{DVec2, DVec3};

use crate::building_footprint::BuildingFootprint;
use crate::unit_roof::{UnitRoof, centroid, level_edge};
use sandtable_description::words;
use sandtable_geom::polygon;

/// How far the middle must lie within every wall's line for one point to roof them all, meters.
const LEAST_VIEW_M: f64 = 0.05;

/// Rings of faces of a dome, from the eaves to the tip.
const DOME_RINGS: u32 = 6;

/// Planes from every wall up to one point over the middle.
pub(crate) fn pyramidal(footprint: &BuildingFootprint) -> Option<UnitRoof> {
    let (middle, nearest) = middle(footprint)?;
    let top = middle.extend(1.0);
    let faces = polygon::edges(footprint.exterior())
        .map(|(from, to)| vec![from.extend(0.0), to.extend(0.0), top])
        .collect();
    let shape = words::RoofShape::Pyramidal;
    Some(UnitRoof { shape, edge: level_edge(footprint), faces, run_m: nearest })
}

/// A dome of a quarter circle's section.
pub(crate) fn dome(footprint: &BuildingFootprint) -> Option<UnitRoof> {
    let (middle, nearest) = middle(footprint)?;
    let ring = |index: u32| -> Vec<DVec3> {
        let angle = std::f64::consts::FRAC_PI_2 * f64::from(index) / f64::from(DOME_RINGS);
        let (share, rise) = if index == 0 { (1.0, 0.0) } else { (libm::cos(angle), libm::sin(angle)) };
        let drawn_in = |&at: &DVec2| if index == 0 { at } else { middle + (at - middle) * share };
        footprint.exterior().iter().map(|at| drawn_in(at).extend(rise)).collect()
    };
    let mut faces = Vec::new();
    for index in 1..DOME_RINGS {
        let (below, above) = (ring(index - 1), ring(index));
        let quads = polygon::edges(&below).zip(polygon::edges(&above));
        faces.extend(quads.map(|((a, b), (d, c))| vec![a, b, c, d]));
    }
    let (top, last) = (middle.extend(1.0), ring(DOME_RINGS - 1));
    faces.extend(polygon::edges(&last).map(|(from, to)| vec![from, to, top]));
    let shape = words::RoofShape::Dome;
    Some(UnitRoof { shape, edge: level_edge(footprint), faces, run_m: nearest })
}

/// The middle of a footprint from which every wall is seen, and how far it is from the nearest.
fn middle(footprint: &BuildingFootprint) -> Option<(DVec2, f64)> {
    let ring = footprint.exterior();
    let middle = centroid(ring);
    let distance =
        |(from, to): (DVec2, DVec2)| (to - from).perp_dot(middle - from) / (to - from).length().max(1e-9);
    let nearest = polygon::edges(ring).map(distance).fold(f64::INFINITY, f64::min);
    (!footprint.has_courtyards() && nearest >= LEAST_VIEW_M).then_some((middle, nearest))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::unit_roof::check;

    #[test]
    fn a_dome_covers_a_round_tower_ring_by_ring() {
        let vertex = |index: u32| {
            let angle = f64::from(index) * std::f64::consts::TAU / 12.0;
            DVec2::new(libm::cos(angle), libm::sin(angle)) * 5.0
        };
        let ring: Vec<DVec2> = (0..12).map(vertex).collect();
        let tower = BuildingFootprint::parts(&ring, &[]).remove(0);
        let roof = dome(&tower).expect("a middle that sees every wall");
        assert_eq!(roof.faces.len(), 12 * DOME_RINGS as usize);
        assert!((check(&roof).expect("upward") - tower.area_m2()).abs() < 1e-6);
    }
}
