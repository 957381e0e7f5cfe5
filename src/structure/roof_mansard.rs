//! Mansard roofs: a hipped roof with two pitches, the lower one the steeper.
//!
//! Every face of the hipped roof is cut at one height; what lies above and below is stretched each by itself, so that the
//! faces stay flat and neighbors still meet.

use glam::DVec3;

use crate::unit_roof::UnitRoof;
use sandtable_description::words;
use sandtable_geom::polygon;

/// How far inward the pitch changes, as a share of the run, and the rise there.
const BEND: (f64, f64) = (0.35, 0.7);

/// A corner of the hipped roof nearer to the bend than this leaves no room for a face, as a share of the run.
const LEAST_GAP: f64 = 0.01;

/// The mansard roof over the plan of a hipped one; `None` where a face does not cross the bend once on each side.
pub(crate) fn mansard(hipped: UnitRoof) -> Option<UnitRoof> {
    let mut faces = Vec::with_capacity(2 * hipped.faces.len());
    for face in &hipped.faces {
        if face.iter().any(|at| (at.z - BEND.0).abs() < LEAST_GAP) {
            return None;
        }
        let (mut below, mut above, mut crossings) = (Vec::new(), Vec::new(), 0);
        for (from, to) in polygon::edges(face) {
            if from.z < BEND.0 { &mut below } else { &mut above }.push(bent(from));
            if (from.z < BEND.0) != (to.z < BEND.0) {
                let at = crossing(from, to);
                below.push(at);
                above.push(at);
                crossings += 1;
            }
        }
        if !matches!(crossings, 0 | 2) {
            return None;
        }
        faces.extend([below, above].into_iter().filter(|face| face.len() > 2));
    }
    Some(UnitRoof { shape: words::RoofShape::Mansard, faces, ..hipped })
}

/// Where an edge of the hipped roof crosses the bend: the same bits for the faces on both of its sides.
fn crossing(from: DVec3, to: DVec3) -> DVec3 {
    let (low, high) = if from.z < to.z { (from, to) } else { (to, from) };
    let at = low.lerp(high, (BEND.0 - low.z) / (high.z - low.z));
    DVec3 { z: BEND.1, ..at }
}

fn bent(at: DVec3) -> DVec3 {
    let (inward, rise) = BEND;
    let z = if at.z < inward {
        at.z * (rise / inward)
    } else {
        rise + (at.z - inward) * ((1.0 - rise) / (1.0 - inward))
    };
    DVec3 { z: z.min(1.0), ..at }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::building_footprint::BuildingFootprint;
    use crate::roof_hipped::hipped;
    use crate::unit_roof::check;
    use glam::DVec2;

    #[test]
    fn every_face_of_the_hipped_roof_is_cut_in_two() {
        for turn_deg in [0.0, 33.0, 90.0, 217.0_f64] {
            let turn = DVec2::from_angle(turn_deg.to_radians());
            let corners = [(0.0, 0.0), (12.0, 0.0), (12.0, 8.0), (0.0, 8.0)];
            let ring: Vec<DVec2> = corners.iter().map(|&at| turn.rotate(DVec2::from(at))).collect();
            let house = BuildingFootprint::parts(&ring, &[]).remove(0);
            let roof = mansard(hipped(&house).expect("convex")).expect("it bends");
            assert_eq!(roof.faces.len(), 8);
            assert!((check(&roof).expect("upward") - 96.0).abs() < 1e-2);
            let bends = roof.faces.iter().flatten().filter(|at| at.z == BEND.1).count();
            assert_eq!(bends, 4 * 4, "two corners for each half of each face");
        }
    }
}
