//! Footprints: rings as files have them, made sound.
//!
//! Files hold rings that run either way, repeat vertices, cross themselves and touch their own holes. What an odd number
//! of rings run around is kept (the rule by which such a polygon is painted), as polygons that cross nothing; vertices
//! that say nothing are dropped. What encloses less than a quarter of a square meter is no building.

use glam::DVec2;

use sandtable_geom::convex;
use sandtable_geom::polygon;
use sandtable_geom::polyline::kept;
use sandtable_geom::region;

/// Vertices nearer to each other or to their neighbors' line are dropped: less than plaster, more than f32 rounding.
const MERGE_M: f64 = 0.01;

/// A footprint smaller than this is what repairing left over.
const LEAST_M2: f64 = 0.25;

/// A part of a building in plan: an outer ring and courtyards that cross neither themselves nor each other.
#[derive(Clone, Debug, PartialEq)]
pub struct BuildingFootprint {
    rings: Vec<Vec<DVec2>>,
}

impl BuildingFootprint {
    /// The parts that `exterior` and `holes`, in any state, enclose; none where that is no area. Rings that are not
    /// finite enclose nothing.
    pub fn parts(exterior: &[DVec2], holes: &[Vec<DVec2>]) -> Vec<Self> {
        let rings: Vec<Vec<DVec2>> = std::iter::once(exterior)
            .chain(holes.iter().map(Vec::as_slice))
            .filter(|ring| ring.iter().all(|at| at.is_finite()))
            .map(without_needless)
            .filter(|ring| ring.len() > 2)
            .collect();
        let polygons = region::even_odd(rings.iter().map(Vec::as_slice));
        polygons.into_iter().filter_map(Self::sound).collect()
    }

    /// A polygon of a region, its rings turned and cleaned; `None` where it is too small.
    fn sound(rings: Vec<Vec<DVec2>>) -> Option<Self> {
        let mut rings: Vec<Vec<DVec2>> = rings.iter().map(|ring| without_needless(ring)).collect();
        let outer = rings.first().filter(|ring| polygon::doubled_area(ring).abs() > 2.0 * LEAST_M2)?.clone();
        rings.retain(|ring| polygon::doubled_area(ring).abs() > 2.0 * LEAST_M2);
        if rings.first() != Some(&outer) {
            return None;
        }
        for (index, ring) in rings.iter_mut().enumerate() {
            if (polygon::doubled_area(ring) > 0.0) != (index == 0) {
                ring.reverse();
            }
        }
        Some(Self { rings })
    }

    /// The outer ring counter-clockwise, then the courtyards clockwise.
    pub fn rings(&self) -> &[Vec<DVec2>] {
        &self.rings
    }

    /// The outer ring, counter-clockwise.
    pub fn exterior(&self) -> &[DVec2] {
        &self.rings[0]
    }

    /// Whether it has courtyards.
    pub fn has_courtyards(&self) -> bool {
        self.rings.len() > 1
    }

    /// Square meters, courtyards left out.
    pub fn area_m2(&self) -> f64 {
        self.rings.iter().map(|ring| polygon::doubled_area(ring) / 2.0).sum()
    }

    /// Whether no corner of the outer ring turns inward.
    pub fn is_convex(&self) -> bool {
        convex::is_convex(self.exterior())
    }
}

/// A ring without the vertices that lie on their neighbors or on the line between them.
fn without_needless(ring: &[DVec2]) -> Vec<DVec2> {
    let mut kept: Vec<DVec2> = kept(ring, MERGE_M).into_iter().map(|index| ring[index]).collect();
    while kept.len() > 1 && kept[0].distance(kept[kept.len() - 1]) <= MERGE_M {
        kept.pop();
    }
    let mut found: Vec<DVec2> = Vec::with_capacity(kept.len());
    for index in 0..kept.len() {
        let (at, next) = (kept[index], kept[(index + 1) % kept.len()]);
        let before = found.last().copied().unwrap_or(kept[kept.len() - 1]);
        if !lies_between(before, at, next) {
            found.push(at);
        }
    }
    found
}

fn lies_between(from: DVec2, at: DVec2, to: DVec2) -> bool {
    let way = to - from;
    let (along, length) = ((at - from).dot(way), way.length());
    length > 0.0
        && along > 0.0
        && along < length * length
        && (at - from).perp_dot(way).abs() < MERGE_M / 2.0 * length
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(points: &[(f64, f64)]) -> Vec<DVec2> {
        points.iter().map(|&point| DVec2::from(point)).collect()
    }

    #[test]
    fn a_clockwise_ring_with_doubled_and_needless_vertices_is_turned_and_cleaned() {
        let ring =
            at(&[(0.0, 0.0), (0.0, 8.0), (0.0, 8.0), (5.0, 8.0), (10.0, 8.0), (10.0, 0.0), (0.0, 0.0)]);
        let parts = BuildingFootprint::parts(&ring, &[]);
        assert_eq!(parts.len(), 1);
        assert_eq!(parts[0].exterior().len(), 4);
        assert!((parts[0].area_m2() - 80.0).abs() < 1e-6 && parts[0].is_convex());
    }

    #[test]
    fn a_ring_that_crosses_itself_makes_two_buildings_and_a_courtyard_stays_open() {
        let bow = at(&[(0.0, 0.0), (10.0, 10.0), (10.0, 0.0), (0.0, 10.0)]);
        assert_eq!(BuildingFootprint::parts(&bow, &[]).len(), 2);
        let outer = at(&[(0.0, 0.0), (20.0, 0.0), (20.0, 20.0), (0.0, 20.0)]);
        let yard = at(&[(5.0, 5.0), (15.0, 5.0), (15.0, 15.0), (5.0, 15.0)]);
        let parts = BuildingFootprint::parts(&outer, &[yard]);
        assert!(parts[0].has_courtyards() && (parts[0].area_m2() - 300.0).abs() < 1e-6);
        assert!(polygon::doubled_area(&parts[0].rings()[1]) < 0.0);
    }

    #[test]
    fn what_encloses_nothing_is_no_building() {
        for ring in [
            at(&[(0.0, 0.0), (10.0, 0.0), (20.0, 0.0)]),
            at(&[(1.0, 1.0), (1.0, 1.0), (1.0, 1.0)]),
            at(&[(0.0, 0.0), (0.1, 0.0), (0.1, 0.1)]),
            at(&[(0.0, 0.0), (f64::NAN, 0.0), (5.0, 5.0)]),
            Vec::new(),
        ] {
            assert!(BuildingFootprint::parts(&ring, &[]).is_empty(), "{ring:?}");
        }
    }
}
