//! Skillion roofs: one plane over the whole footprint, of any outline and with courtyards.
//!
//! ```text
//!          ╱│
//!        ╱  │     the plane falls across the longer sides unless it is
//!      ╱    │     turned; what is stated as a point of the compass means
//!     │     │     the side of the house that is nearest to it
//! ```

use glam::{DVec2, DVec3};

use crate::building_footprint::BuildingFootprint;
use crate::roof_rectangle::{RoofRectangle, RoofTurn};
use crate::unit_roof::UnitRoof;
use sandtable_description::words;
use sandtable_geom::polygon;

/// A stated direction that is nearer to square to a side than this means that side, as the cosine of half a point of eight.
const MEANS_A_SIDE: f64 = 0.923_879_532_5;

/// A footprint less deep than this has no slope, meters.
const LEAST_DEPTH_M: f64 = 0.05;

/// The roof of one plane; `None` over a footprint without depth.
pub(crate) fn skillion(footprint: &BuildingFootprint, turn: RoofTurn) -> Option<UnitRoof> {
    let [outer, courtyards @ ..] = footprint.rings() else { return None };
    let fall = fall(footprint, turn)?;
    let origin = outer[0];
    let down = |at: DVec2| (at - origin).dot(fall);
    let reach = |(low, high): (f64, f64), at: &DVec2| (low.min(down(*at)), high.max(down(*at)));
    let (low, high) = outer.iter().fold((f64::INFINITY, f64::NEG_INFINITY), reach);
    let run_m = high - low;
    let risen = |at: &DVec2| at.extend(((high - down(*at)) / run_m).clamp(0.0, 1.0));
    let lifted = |ring: &[DVec2]| -> Vec<DVec3> { ring.iter().map(risen).collect() };
    let faces = if courtyards.is_empty() {
        vec![lifted(outer)]
    } else {
        polygon::triangulate(outer, courtyards).iter().map(|corners| lifted(corners)).collect()
    };
    let edge = footprint.rings().iter().map(|ring| lifted(ring)).collect();
    let shape = words::RoofShape::Skillion;
    (run_m > LEAST_DEPTH_M).then_some(UnitRoof { shape, edge, faces, run_m })
}

/// The unit vector in plan along which the roof falls.
fn fall(footprint: &BuildingFootprint, turn: RoofTurn) -> Option<DVec2> {
    let ring = footprint.exterior();
    match (turn, RoofRectangle::around(ring)) {
        (RoofTurn::Facing(way), Some(frame)) => {
            let across = frame.along.perp();
            let sides = [frame.along, -frame.along, across, -across];
            let nearest = sides.into_iter().max_by(|a, b| a.dot(way).total_cmp(&b.dot(way)));
            nearest.filter(|side| side.dot(way) >= MEANS_A_SIDE).or(Some(way))
        }
        (RoofTurn::Facing(way), None) => Some(way),
        (RoofTurn::Across, Some(frame)) => Some(southward(frame.along)),
        (RoofTurn::Along, Some(frame)) => Some(southward(frame.along.perp())),
        (_, None) => Some(DVec2::NEG_Y),
    }
}

/// Of a direction and its opposite, the one to the south; of east and west the one to the east.
fn southward(way: DVec2) -> DVec2 {
    if way.y < -1e-9 || (way.y < 1e-9 && way.x > 0.0) { way } else { -way }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::unit_roof::check;

    fn footprint(points: &[(f64, f64)]) -> BuildingFootprint {
        let ring: Vec<DVec2> = points.iter().map(|&at| DVec2::from(at)).collect();
        BuildingFootprint::parts(&ring, &[]).remove(0)
    }

    const HOUSE: [(f64, f64); 4] = [(0.0, 0.0), (12.0, 0.0), (12.0, 8.0), (0.0, 8.0)];

    /// The rise at a corner of the house's roof.
    fn rise(roof: &UnitRoof, at: (f64, f64)) -> f64 {
        let corner = roof.edge[0].iter().find(|corner| corner.truncate().distance(DVec2::from(at)) < 1e-9);
        corner.expect("a corner").z
    }

    #[test]
    fn the_plane_falls_to_the_side_that_is_stated() {
        for (turn, low, high, run_m) in [
            (RoofTurn::Along, (12.0, 0.0), (12.0, 8.0), 8.0),
            (RoofTurn::Across, (12.0, 8.0), (0.0, 8.0), 12.0),
            (RoofTurn::Facing(DVec2::Y), (0.0, 8.0), (0.0, 0.0), 8.0),
            (RoofTurn::Facing(DVec2::from_angle(0.3)), (12.0, 0.0), (0.0, 0.0), 12.0),
        ] {
            let roof = skillion(&footprint(&HOUSE), turn).expect("it has depth");
            assert_eq!((rise(&roof, low), rise(&roof, high), roof.run_m), (0.0, 1.0, run_m), "{turn:?}");
            assert!((check(&roof).expect("upward") - 96.0).abs() < 1e-6);
        }
    }

    #[test]
    fn a_direction_between_two_sides_is_kept_and_an_inward_corner_is_roofed() {
        let bent = footprint(&[(0.0, 0.0), (20.0, 0.0), (20.0, 6.0), (6.0, 6.0), (6.0, 20.0), (0.0, 20.0)]);
        let way = DVec2::from_angle(std::f64::consts::FRAC_PI_4);
        let roof = skillion(&bent, RoofTurn::Facing(way)).expect("it has depth");
        assert_eq!(rise(&roof, (0.0, 0.0)), 1.0);
        assert!((rise(&roof, (6.0, 6.0)) - (1.0 - 12.0 / 26.0)).abs() < 1e-9);
        assert!((check(&roof).expect("upward") - 204.0).abs() < 1e-6);
    }
}
