//! Roofs of one cross-section along a ridge: gambrel, saltbox and round ones, and the half-hipped.
//!
//! The footprint is cut along lines beside the ridge at which the section bends. Each line must cross the outline twice,
//! so that the strip between two neighbors is one flat face:
//!
//! ```text
//!       ___                 ●────────────────●
//!     ╱     ╲     bend      ○────────────────○
//!    │       │    ridge     ○────────────────○     faces are strips, gables
//!    │       │    bend      ○────────────────○     have a vertex at each line
//!    │       │              ●────────────────●
//! ```

use glam::{DVec2, DVec3};

use crate::building_footprint::BuildingFootprint;
use crate::roof_rectangle::{RoofRectangle, RoofTurn};
use crate::unit_roof::{LEAST_ASIDE_M, UnitRoof};
use sandtable_description::words;
use sandtable_geom::polygon;

/// A bend of a section: how far aside from the ridge, as a share of half the width, −1..=1, and the rise there.
type Bend = (f64, f64);

/// Two pitches on each side, the lower one the steeper: a barn's.
const GAMBREL: [Bend; 5] = [(-1.0, 0.0), (-0.6, 0.62), (0.0, 1.0), (0.6, 0.62), (1.0, 0.0)];

/// A ridge off the middle, so that one slope is long and the other short.
const SALTBOX: [Bend; 3] = [(-1.0, 0.0), (0.4, 1.0), (1.0, 0.0)];

/// Faces of a round roof: their edges shade it as a curve.
const ROUND_FACES: u32 = 8;

/// How high the gable of a half-hipped roof reaches.
const HALF_HIP: f64 = 0.5;

/// The roof with the section of a gambrel.
pub(crate) fn gambrel(footprint: &BuildingFootprint, turn: RoofTurn) -> Option<UnitRoof> {
    ridged(footprint, turn, words::RoofShape::Gambrel, &GAMBREL)
}

/// The roof with one long slope: toward the direction that is stated, else to the right of the ridge.
pub(crate) fn saltbox(footprint: &BuildingFootprint, turn: RoofTurn) -> Option<UnitRoof> {
    let frame = RoofRectangle::filled(footprint.exterior(), footprint.area_m2(), turn)?;
    let is_mirrored = matches!(turn, RoofTurn::Facing(way) if way.dot(frame.along.perp()) > 0.0);
    let mut section = SALTBOX;
    if is_mirrored {
        section.reverse();
        section.iter_mut().for_each(|(aside, _)| *aside = -*aside);
    }
    ridged(footprint, turn, words::RoofShape::Saltbox, &section)
}

/// The roof with the section of half a circle.
pub(crate) fn round(footprint: &BuildingFootprint, turn: RoofTurn) -> Option<UnitRoof> {
    let bend = |index: u32| {
        let angle = std::f64::consts::PI * f64::from(index) / f64::from(ROUND_FACES);
        match index {
            0 => (-1.0, 0.0),
            ROUND_FACES => (1.0, 0.0),
            _ => (-libm::cos(angle), libm::sin(angle)),
        }
    };
    let section: Vec<Bend> = (0..=ROUND_FACES).map(bend).collect();
    ridged(footprint, turn, words::RoofShape::Round, &section)
}

/// A vertex of the outline with its rise; the bend that it lies on where it was added for that.
#[derive(Clone, Copy)]
struct CutVertex {
    at: DVec3,
    aside: f64,
    bend: Option<usize>,
}

/// The roof of a section along the ridge of the best-fitting rectangle; `None` where the footprint does not take it.
fn ridged(
    footprint: &BuildingFootprint,
    turn: RoofTurn,
    shape: words::RoofShape,
    section: &[Bend],
) -> Option<UnitRoof> {
    let (cut, run_m) = cut(footprint, turn, section)?;
    let last = section.len() - 2;
    let strip = |index: usize| -> Vec<DVec3> {
        let is_in = |vertex: &&CutVertex| match vertex.bend {
            Some(bend) => bend == index || bend == index + 1,
            None => {
                (index == 0 || vertex.aside > section[index].0)
                    && (index == last || vertex.aside < section[index + 1].0)
            }
        };
        cut.iter().filter(is_in).map(|vertex| vertex.at).collect()
    };
    let faces: Vec<Vec<DVec3>> = (0..=last).map(strip).collect();
    let edge = vec![cut.iter().map(|vertex| vertex.at).collect()];
    faces.iter().all(|face| face.len() > 2).then_some(UnitRoof { shape, edge, faces, run_m })
}

/// The outline with a vertex wherever an inner bend of the section crosses it, and half its width; `None` where a bend does
/// not cross it twice, or runs by a vertex.
fn cut(footprint: &BuildingFootprint, turn: RoofTurn, section: &[Bend]) -> Option<(Vec<CutVertex>, f64)> {
    let ring = footprint.exterior();
    let frame =
        RoofRectangle::filled(ring, footprint.area_m2(), turn).filter(|_| !footprint.has_courtyards())?;
    let run_m = ring.iter().map(|&at| frame.aside(at).abs()).fold(0.0, f64::max);
    let inner = 1..section.len() - 1;
    let (mut cut, mut crossings) =
        (Vec::with_capacity(ring.len() + 2 * section.len()), vec![0; section.len()]);
    for (from, to) in polygon::edges(ring) {
        let (before, after) = (frame.aside(from), frame.aside(to));
        if inner.clone().any(|bend| (before - section[bend].0 * run_m).abs() < LEAST_ASIDE_M) {
            return None;
        }
        cut.push(CutVertex {
            at: from.extend(rise_at(section, before / run_m)),
            aside: before / run_m,
            bend: None,
        });
        let mut add = |bend: usize| {
            let line = section[bend].0 * run_m;
            if (before > line) != (after > line) {
                crossings[bend] += 1;
                let at = from.lerp(to, (before - line) / (before - after)).extend(section[bend].1);
                cut.push(CutVertex { at, aside: section[bend].0, bend: Some(bend) });
            }
        };
        if before < after {
            inner.clone().for_each(&mut add);
        } else {
            inner.clone().rev().for_each(&mut add);
        }
    }
    inner.clone().all(|bend| crossings[bend] == 2).then_some((cut, run_m))
}

fn rise_at(section: &[Bend], aside: f64) -> f64 {
    let span = section.windows(2).find(|pair| aside <= pair[1].0);
    span.map_or(0.0, |pair| {
        let ((x0, y0), (x1, y1)) = (pair[0], pair[1]);
        (y0 + (y1 - y0) * (aside - x0) / (x1 - x0)).clamp(0.0, 1.0)
    })
}

/// The roof of two slopes whose gables end half way up, in small hips; `None` over other footprints than four-sided ones,
/// and where the hips would meet.
pub(crate) fn half_hipped(footprint: &BuildingFootprint, turn: RoofTurn) -> Option<UnitRoof> {
    if footprint.exterior().len() != 4 {
        return None;
    }
    let beside = 1.0 - HALF_HIP;
    let section = [(-1.0, 0.0), (-beside, HALF_HIP), (0.0, 1.0), (beside, HALF_HIP), (1.0, 0.0)];
    let (cut, run_m) = cut(footprint, turn, &section)?;
    let is_ridge = |vertex: &&CutVertex| vertex.bend == Some(2);
    let ridge: Vec<DVec2> = cut.iter().filter(is_ridge).map(|vertex| vertex.at.truncate()).collect();
    let &[first, second] = &ridge[..] else { return None };
    let inset_m = run_m * beside;
    let along = (second - first).try_normalize().filter(|_| first.distance(second) > 2.5 * inset_m)?;
    let tips = [(first + along * inset_m).extend(1.0), (second - along * inset_m).extend(1.0)];
    let edge: Vec<DVec3> = cut.iter().filter(|vertex| !is_ridge(vertex)).map(|vertex| vertex.at).collect();
    // The ring again, with the tips in place of the ridge's ends: each tip follows and precedes a half-hip's ends.
    let mut faces = vec![Vec::new(), Vec::new()];
    let mut tip = 0;
    for (index, vertex) in cut.iter().enumerate() {
        if is_ridge(&vertex) {
            let [before, after] = [index + cut.len() - 1, index + 1].map(|at| cut[at % cut.len()].at);
            faces.push(vec![before, after, tips[tip]]);
            faces.iter_mut().take(2).for_each(|side| side.push(tips[tip]));
            tip += 1;
        } else {
            faces[usize::from(vertex.aside > 0.0)].push(vertex.at);
        }
    }
    let shape = words::RoofShape::HalfHipped;
    Some(UnitRoof { shape, edge: vec![edge], faces, run_m })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::unit_roof::check;

    fn house(turn_deg: f64) -> BuildingFootprint {
        let turn = DVec2::from_angle(turn_deg.to_radians());
        let corners = [(0.0, 0.0), (12.0, 0.0), (12.0, 8.0), (0.0, 8.0)];
        let ring: Vec<DVec2> = corners.iter().map(|&at| turn.rotate(DVec2::from(at))).collect();
        BuildingFootprint::parts(&ring, &[]).remove(0)
    }

    #[test]
    fn the_strips_of_a_section_cover_the_house_at_every_turn() {
        for turn_deg in [0.0, 33.0, 90.0, 217.0] {
            let house = house(turn_deg);
            for turn in [RoofTurn::Along, RoofTurn::Across, RoofTurn::Facing(DVec2::Y)] {
                for (roof, faces) in [
                    (gambrel(&house, turn), 4),
                    (saltbox(&house, turn), 2),
                    (round(&house, turn), ROUND_FACES as usize),
                ] {
                    let roof = roof.expect("a rectangle takes it");
                    assert_eq!(roof.faces.len(), faces);
                    assert!((check(&roof).expect("upward") - 96.0).abs() < 1e-6, "{:?}", roof.shape);
                    assert_eq!(roof.edge[0].len(), 4 + 2 * (faces - 1));
                }
            }
        }
    }

    #[test]
    fn the_long_slope_of_a_saltbox_falls_as_stated() {
        for (way, east) in [(DVec2::Y, 8.0), (DVec2::NEG_Y, 0.0)] {
            let roof = saltbox(&house(0.0), RoofTurn::Facing(way)).expect("a rectangle takes it");
            let ridge = roof.edge[0].iter().find(|at| at.z == 1.0).expect("a ridge").y;
            assert!((ridge - east).abs() > 4.0, "ridge at {ridge}");
        }
    }

    #[test]
    fn half_hips_are_triangles_over_gables_cut_half_way_up() {
        for turn_deg in [0.0, 33.0, 90.0, 217.0] {
            let roof = half_hipped(&house(turn_deg), RoofTurn::Along).expect("four sides");
            let mut counts: Vec<usize> = roof.faces.iter().map(Vec::len).collect();
            counts.sort_unstable();
            assert_eq!(counts, [3, 3, 6, 6]);
            assert!((check(&roof).expect("upward") - 96.0).abs() < 1e-6);
            assert_eq!(roof.edge[0].iter().filter(|at| at.z == HALF_HIP).count(), 4);
        }
        let narrow = [(0.0, 0.0), (12.0, 0.0), (12.0, 6.0), (0.0, 6.0)].map(DVec2::from);
        let narrow = BuildingFootprint::parts(&narrow, &[]).remove(0);
        assert!(half_hipped(&narrow, RoofTurn::Across).is_none(), "the hips would meet");
    }
}
