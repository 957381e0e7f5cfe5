//! Roofs over footprints: flat, gabled, pyramidal; hipped ones are made in [`crate::roof_hipped`], those over
//! inward corners by [`crate::straight_skeleton`].
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
use crate::roof_hipped::hipped;
use crate::straight_skeleton;
use sandtable_description::words;
use sandtable_geom::polygon;

/// How much of its best-fitting rectangle a footprint must fill to be roofed like one.
const RECTANGULAR: f64 = 0.82;

/// The most vertices of a footprint for which its best-fitting rectangle is looked for.
const MOST_VERTICES: usize = 400;

/// A roof with a rise of one.
#[derive(Clone, Debug, PartialEq)]
pub struct UnitRoof {
    /// Its shape; not always the stated one.
    pub shape: words::RoofShape,
    /// The footprint's rings with the rise at each vertex, 0..=1; all 0 but at gables.
    pub edge: Vec<Vec<DVec3>>,
    /// Flat polygons, counter-clockwise seen from above, X, Y and rise.
    pub faces: Vec<Vec<DVec3>>,
    /// How far it is in plan from the eaves to the ridge, meters; 0 for a flat one. Rise over run is its pitch.
    pub run_m: f64,
}

/// The roof of the stated shape over a footprint, or the nearest that can be made: a gabled one needs nearly a
/// rectangle, else it is hipped; a hipped one needs a footprint without courtyards and of no more than 64 sides, a
/// pyramidal one a middle that sees every wall; else they are flat.
pub fn roof(footprint: &BuildingFootprint, wanted: words::RoofShape) -> UnitRoof {
    let made = match wanted {
        words::RoofShape::Flat => None,
        words::RoofShape::Gabled => {
            gabled(footprint).or_else(|| hipped(footprint)).or_else(|| bent(footprint))
        }
        words::RoofShape::Hipped => hipped(footprint).or_else(|| bent(footprint)),
        words::RoofShape::Pyramidal => pyramidal(footprint),
    };
    made.unwrap_or_else(|| flat(footprint))
}

/// The footprint's rings at the eaves.
pub(crate) fn level_edge(footprint: &BuildingFootprint) -> Vec<Vec<DVec3>> {
    footprint.rings().iter().map(|ring| ring.iter().map(|at| at.extend(0.0)).collect()).collect()
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
fn gabled(footprint: &BuildingFootprint) -> Option<UnitRoof> {
    let ring = footprint.exterior();
    let frame = RoofRectangle::around(ring).filter(|_| !footprint.has_courtyards())?;
    if footprint.area_m2() < RECTANGULAR * frame.area_m2() {
        return None;
    }
    let aside = |at: DVec2| (at - frame.center).dot(frame.along.perp());
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

/// No vertex of a gabled roof's footprint may lie nearer to the ridge, meters.
const LEAST_ASIDE_M: f64 = 0.02;

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

/// Planes from every wall up to one point over the middle.
fn pyramidal(footprint: &BuildingFootprint) -> Option<UnitRoof> {
    let ring = footprint.exterior();
    let middle = centroid(ring);
    let distance =
        |(from, to): (DVec2, DVec2)| (to - from).perp_dot(middle - from) / (to - from).length().max(1e-9);
    let nearest = polygon::edges(ring).map(distance).fold(f64::INFINITY, f64::min);
    if footprint.has_courtyards() || nearest < LEAST_VIEW_M {
        return None;
    }
    let top = middle.extend(1.0);
    let faces = polygon::edges(ring).map(|(from, to)| vec![from.extend(0.0), to.extend(0.0), top]).collect();
    Some(UnitRoof { shape: words::RoofShape::Pyramidal, edge: level_edge(footprint), faces, run_m: nearest })
}

/// How far the middle must lie within every wall's line for one point to roof them all, meters.
const LEAST_VIEW_M: f64 = 0.05;

/// The center of a ring's area.
pub fn centroid(ring: &[DVec2]) -> DVec2 {
    let first = ring.first().copied().unwrap_or_default();
    let (mut sum, mut area) = (DVec2::ZERO, 0.0);
    for (from, to) in polygon::edges(ring) {
        let (a, b) = (from - first, to - first);
        sum += (a + b) * a.perp_dot(b);
        area += a.perp_dot(b);
    }
    if area == 0.0 { first } else { first + sum / (3.0 * area) }
}

/// The smallest rectangle around a ring that has a side along one of its edges.
#[derive(Clone, Copy, Debug, PartialEq)]
struct RoofRectangle {
    center: DVec2,
    /// A unit vector along the longer sides.
    along: DVec2,
    /// Half the longer and half the shorter side.
    half: DVec2,
}

impl RoofRectangle {
    fn around(ring: &[DVec2]) -> Option<Self> {
        if ring.len() > MOST_VERTICES {
            return None;
        }
        let frames = polygon::edges(ring).filter_map(|(from, to)| (to - from).try_normalize());
        frames.map(|along| Self::along(ring, along)).min_by(|a, b| a.area_m2().total_cmp(&b.area_m2()))
    }

    fn along(ring: &[DVec2], along: DVec2) -> Self {
        let spans = |way: DVec2| {
            let reach = ring.iter().map(|at| (at - ring[0]).dot(way));
            reach.fold((0.0, 0.0), |(low, high), at| (f64::min(low, at), f64::max(high, at)))
        };
        let ((x0, x1), (y0, y1)) = (spans(along), spans(along.perp()));
        let center = ring[0] + along * (x0 + x1) / 2.0 + along.perp() * (y0 + y1) / 2.0;
        let half = DVec2::new(x1 - x0, y1 - y0) / 2.0;
        if half.x >= half.y {
            Self { center, along, half }
        } else {
            Self { center, along: along.perp(), half: DVec2::new(half.y, half.x) }
        }
    }

    fn area_m2(&self) -> f64 {
        4.0 * self.half.x * self.half.y
    }
}

/// A face of a roof that does not face up.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("face {face} of a {shape:?} roof covers {area_m2} m²")]
pub struct UnitRoofError {
    /// Its place among the roof's faces.
    pub face: usize,
    /// The roof's shape.
    pub shape: words::RoofShape,
    /// What it covers in plan, not above 0.
    pub area_m2: f64,
}

/// The area in plan that a roof's faces cover, in square meters; each must face up.
///
/// # Errors
/// The first face that does not.
pub fn check(roof: &UnitRoof) -> Result<f64, UnitRoofError> {
    let mut sum = 0.0;
    for (face, corners) in roof.faces.iter().enumerate() {
        let ring: Vec<DVec2> = corners.iter().map(|at| at.truncate()).collect();
        let area_m2 = polygon::doubled_area(&ring) / 2.0;
        if area_m2 <= 0.0 {
            return Err(UnitRoofError { face, shape: roof.shape, area_m2 });
        }
        sum += area_m2;
    }
    Ok(sum)
}

#[cfg(test)]
mod tests {
    use super::*;

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
