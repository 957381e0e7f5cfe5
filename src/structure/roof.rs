//! Roofs over footprints: flat and gabled here, the others in files of their own.
//!
//! A roof is made with a rise of one from eaves to ridge; the building stretches it. Its faces cover the footprint in
//! plan, no more and no less, and its edge is the footprint's, with a vertex more where a ridge meets a gable, so that
//! walls and roof close:
//!
//! ```text
//!   gabled  ●───────────●     each side of the ridge one plane: the eaves of a
//!           │           │     footprint that is not quite a rectangle are not
//!    ridge  ○───────────○     quite level, and still nothing gapes
//!           │           │
//!           ●───────────●
//! ```

use glam::{DVec2, DVec3};

use crate::building_footprint::BuildingFootprint;
use crate::roof_domed::{dome, pyramidal};
use crate::roof_hipped::hipped;
use crate::roof_mansard::mansard;
use crate::roof_rectangle::{RoofRectangle, RoofTurn};
use crate::roof_ridged::{gambrel, half_hipped, round, saltbox};
use crate::roof_skillion::skillion;
use crate::straight_skeleton;
use crate::unit_roof::{LEAST_ASIDE_M, UnitRoof, level_edge};
use sandtable_description::words;
use sandtable_geom::polygon;

/// The roof of the stated shape over a footprint, or the nearest that can be made, with its ridge along the longer sides.
pub fn roof(footprint: &BuildingFootprint, wanted: words::RoofShape) -> UnitRoof {
    turned_roof(footprint, wanted, RoofTurn::Along)
}

/// The roof of the stated shape over a footprint, or the nearest that can be made, turned as stated: one with a ridge needs
/// nearly a rectangle, else it is hipped; a hipped one needs a footprint without courtyards and of no more than 64 sides, a
/// pyramid or a dome a middle that sees every wall; else they are flat. A skillion lies over every footprint.
pub fn turned_roof(footprint: &BuildingFootprint, wanted: words::RoofShape, turn: RoofTurn) -> UnitRoof {
    let over_hips = || hipped(footprint).or_else(|| bent(footprint));
    let over_gables = || gabled(footprint, turn).or_else(over_hips);
    let made = match wanted {
        words::RoofShape::Flat => None,
        words::RoofShape::Gabled => over_gables(),
        words::RoofShape::Hipped => over_hips(),
        words::RoofShape::Pyramidal => pyramidal(footprint),
        words::RoofShape::Skillion => skillion(footprint, turn),
        words::RoofShape::HalfHipped => half_hipped(footprint, turn).or_else(over_hips),
        words::RoofShape::Gambrel => gambrel(footprint, turn).or_else(over_gables),
        words::RoofShape::Saltbox => saltbox(footprint, turn).or_else(over_gables),
        words::RoofShape::Round => round(footprint, turn).or_else(over_gables),
        words::RoofShape::Mansard => over_hips().map(|hips| mansard(hips.clone()).unwrap_or(hips)),
        words::RoofShape::Dome => dome(footprint).or_else(|| pyramidal(footprint)),
    };
    made.unwrap_or_else(|| flat(footprint))
}

fn flat(footprint: &BuildingFootprint) -> UnitRoof {
    let [outer, courtyards @ ..] = footprint.rings() else {
        return UnitRoof { shape: words::RoofShape::Flat, edge: Vec::new(), faces: Vec::new(), run_m: 0.0 };
    };
    let level = |points: &[DVec2]| points.iter().map(|at| at.extend(0.0)).collect();
    let faces = if courtyards.is_empty() {
        vec![level(outer)]
    } else {
        polygon::triangulate(outer, courtyards).iter().map(|corners| level(corners)).collect()
    };
    UnitRoof { shape: words::RoofShape::Flat, edge: level_edge(footprint), faces, run_m: 0.0 }
}

/// Two planes from the ridge, along the middle of the best-fitting rectangle, down to the eaves.
fn gabled(footprint: &BuildingFootprint, turn: RoofTurn) -> Option<UnitRoof> {
    let ring = footprint.exterior();
    let frame =
        RoofRectangle::filled(ring, footprint.area_m2(), turn).filter(|_| !footprint.has_courtyards())?;
    let aside = |at: DVec2| frame.aside(at);
    let run_m = ring.iter().map(|&at| aside(at).abs()).fold(0.0, f64::max);
    let (with_ridge, crossings) = crossed(ring, aside)?;
    let risen = |at: &DVec2| at.extend((1.0 - aside(*at).abs() / run_m).max(0.0));
    let edge: Vec<DVec3> = with_ridge
        .iter()
        .enumerate()
        .map(|(index, at)| if crossings.contains(&index) { at.extend(1.0) } else { risen(at) })
        .collect();
    let [first, second] = crossings;
    let side = edge[first..=second].to_vec();
    let other = edge[second..].iter().chain(&edge[..=first]).copied().collect();
    Some(UnitRoof { shape: words::RoofShape::Gabled, edge: vec![edge], faces: vec![side, other], run_m })
}

/// The ring with a vertex at both crossings of the line where `aside` is 0, and their indices; `None` otherwise.
fn crossed(ring: &[DVec2], aside: impl Fn(DVec2) -> f64) -> Option<(Vec<DVec2>, [usize; 2])> {
    let (mut with, mut crossings) = (Vec::with_capacity(ring.len() + 2), Vec::new());
    for (from, to) in polygon::edges(ring) {
        let (before, after) = (aside(from), aside(to));
        // A vertex on the ridge leaves it to chance which edge crosses, and one beside it makes a sliver of a gable.
        if before.abs() < LEAST_ASIDE_M {
            return None;
        }
        with.push(from);
        if (before > 0.0) != (after > 0.0) {
            crossings.push(with.len());
            with.push(from.lerp(to, before / (before - after)));
        }
    }
    <[usize; 2]>::try_from(crossings).ok().map(|crossings| (with, crossings))
}

/// A hipped roof over a footprint with inward corners.
fn bent(footprint: &BuildingFootprint) -> Option<UnitRoof> {
    let mut faces = straight_skeleton::faces(footprint.exterior()).filter(|_| !footprint.has_courtyards())?;
    let run_m = faces.iter().flatten().map(|corner| corner.z).fold(0.0, f64::max);
    faces.iter_mut().flatten().for_each(|corner| corner.z /= run_m);
    let edge = level_edge(footprint);
    (run_m > LEAST_VIEW_M).then_some(UnitRoof { shape: words::RoofShape::Hipped, edge, faces, run_m })
}

/// A hipped roof over inward corners rises at least so far inward, meters.
const LEAST_VIEW_M: f64 = 0.05;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::unit_roof::check;

    fn footprint(points: &[(f64, f64)], turn_deg: f64) -> BuildingFootprint {
        let turn = DVec2::from_angle(turn_deg.to_radians());
        let ring: Vec<DVec2> = points.iter().map(|&(x, y)| turn.rotate(DVec2::new(x, y))).collect();
        BuildingFootprint::parts(&ring, &[]).remove(0)
    }

    const HOUSE: [(f64, f64); 4] = [(0.0, 0.0), (12.0, 0.0), (12.0, 8.0), (0.0, 8.0)];
    const TURNS: [f64; 4] = [0.0, 33.0, 90.0, 217.0];

    #[test]
    fn a_gabled_roof_has_two_slopes_and_a_ridge_along_the_house() {
        for turn in TURNS {
            let roof = roof(&footprint(&HOUSE, turn), words::RoofShape::Gabled);
            assert_eq!((roof.shape, roof.faces.len()), (words::RoofShape::Gabled, 2));
            assert!((roof.run_m - 4.0).abs() < 1e-6);
            assert!((check(&roof).expect("upward") - 96.0).abs() < 1e-6);
            let gables: Vec<&DVec3> = roof.edge[0].iter().filter(|at| at.z == 1.0).collect();
            assert_eq!(gables.len(), 2);
            assert!((gables[0].truncate().distance(gables[1].truncate()) - 12.0).abs() < 1e-6);
            assert!(roof.edge[0].iter().all(|at| at.z == 1.0 || at.z < 1e-6));
        }
    }

    #[test]
    fn a_pyramidal_roof_s_faces_meet_over_the_middle() {
        for turn in TURNS {
            let roof = roof(&footprint(&HOUSE, turn), words::RoofShape::Pyramidal);
            assert_eq!((roof.shape, roof.faces.len()), (words::RoofShape::Pyramidal, 4));
            assert!((roof.run_m - 4.0).abs() < 1e-6 && (check(&roof).expect("upward") - 96.0).abs() < 1e-6);
        }
    }

    #[test]
    fn a_ridge_runs_across_or_square_to_a_direction_where_that_is_stated() {
        for turn_deg in TURNS {
            let turn = DVec2::from_angle(turn_deg.to_radians());
            // The slopes of a house along X that is turned fall along Y; across it they fall along X.
            for (wish, length_m) in [
                (RoofTurn::Across, 8.0),
                (RoofTurn::Facing(turn), 8.0),
                (RoofTurn::Facing(-turn), 8.0),
                (RoofTurn::Facing(turn.perp()), 12.0),
            ] {
                let roof = turned_roof(&footprint(&HOUSE, turn_deg), words::RoofShape::Gabled, wish);
                let ends: Vec<&DVec3> = roof.edge[0].iter().filter(|at| at.z == 1.0).collect();
                assert!((ends[0].distance(*ends[1]) - length_m).abs() < 1e-6, "{wish:?} at {turn_deg}");
                assert!((check(&roof).expect("upward") - 96.0).abs() < 1e-6);
            }
        }
    }

    #[test]
    fn what_a_shape_does_not_fit_gets_the_nearest_that_does() {
        let bent = [(0.0, 0.0), (20.0, 0.0), (20.0, 6.0), (6.0, 6.0), (6.0, 20.0), (0.0, 20.0)];
        for turn in TURNS {
            let bent = footprint(&bent, turn);
            assert_ne!(roof(&bent, words::RoofShape::Gabled).shape, words::RoofShape::Gabled);
            let flat = roof(&bent, words::RoofShape::Flat);
            assert!((check(&flat).expect("upward") - 204.0).abs() < 1e-6);
        }
    }

    #[test]
    fn a_house_with_a_bay_is_still_gabled_and_covered() {
        let bay = [
            (0.0, 0.0),
            (12.0, 0.0),
            (12.0, 8.0),
            (8.0, 8.0),
            (8.0, 8.8),
            (5.0, 8.8),
            (5.0, 8.0),
            (0.0, 8.0),
        ];
        for turn in TURNS {
            let roof = roof(&footprint(&bay, turn), words::RoofShape::Gabled);
            assert_eq!(roof.shape, words::RoofShape::Gabled);
            assert!((check(&roof).expect("upward") - 98.4).abs() < 1e-6);
        }
    }
}
