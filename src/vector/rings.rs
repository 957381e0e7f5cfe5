//! Polygons out of rings that come in no order: which are outer rings, and which is a hole in which.
//!
//! A ring lies in another where most of three of its vertices do, since rings that touch share vertices. The
//! smallest ring around a hole is the one it is cut from. Looking for it takes time that grows with the square of
//! the number of rings; [`MOST_STEPS`] keeps a hostile file from making that hours.

use glam::{DVec2, DVec3};

use crate::geom::polygon::{contains, doubled_area};
use crate::geom::rect::Rect;

/// The most pairs of rings and edges that are looked at for one file: seconds, and a hundred times what real layers
/// of hundred thousands of polygons take.
pub(crate) const MOST_STEPS: u64 = 1 << 31;

/// What makes a ring a hole.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum HoleRule {
    /// It runs counter-clockwise inside one that runs clockwise (ESRI shapefiles). Where no ring of a shape runs
    /// clockwise, as [`HoleRule::Nesting`].
    Direction,
    /// It lies directly inside an outer ring; a ring inside a hole is an outer ring again (OpenStreetMap).
    Nesting,
}

/// The rings are too many, too much inside each other.
#[derive(Debug)]
pub(crate) struct Entangled;

/// One ring while it is sorted.
struct SortedRing {
    vertices: Vec<DVec3>,
    flat: Vec<DVec2>,
    bounds: Rect,
    /// Positive where it runs counter-clockwise.
    doubled_area: f64,
    parent: Option<usize>,
    is_hole: bool,
}

/// Each polygon's rings, the outer one first: polygons in the order of their outer rings, holes in their own.
///
/// `steps` counts the work down from [`MOST_STEPS`].
///
/// # Errors
/// [`Entangled`] where no steps are left.
pub(crate) fn polygons(
    rings: Vec<Vec<DVec3>>,
    rule: HoleRule,
    steps: &mut u64,
) -> Result<Vec<Vec<Vec<DVec3>>>, Entangled> {
    if rings.len() == 1 {
        return Ok(vec![rings]);
    }
    let mut rings: Vec<SortedRing> = rings.into_iter().map(SortedRing::new).collect();
    let any_clockwise = rings.iter().any(|ring| ring.doubled_area < 0.0);
    let by_direction = rule == HoleRule::Direction && any_clockwise;
    let mut by_size: Vec<usize> = (0..rings.len()).collect();
    by_size.sort_by(|&a, &b| rings[b].size().total_cmp(&rings[a].size()).then(a.cmp(&b)));
    for (rank, &index) in by_size.iter().enumerate() {
        if by_direction && rings[index].doubled_area < 0.0 {
            continue;
        }
        let is_candidate = |&&other: &&usize| !by_direction || rings[other].doubled_area < 0.0;
        let mut parent = None;
        for &other in by_size[..rank].iter().rev().filter(is_candidate) {
            if rings[index].lies_in(&rings[other], steps)? {
                parent = Some(other);
                break;
            }
        }
        rings[index].parent = parent;
        rings[index].is_hole = parent.is_some_and(|parent| !rings[parent].is_hole);
    }
    Ok(grouped(rings))
}

fn grouped(rings: Vec<SortedRing>) -> Vec<Vec<Vec<DVec3>>> {
    let mut place = vec![0; rings.len()];
    let outer = rings.iter().enumerate().filter(|(_, ring)| !ring.is_hole);
    outer.enumerate().for_each(|(polygon, (index, _))| place[index] = polygon);
    let count = rings.iter().filter(|ring| !ring.is_hole).count();
    let mut polygons: Vec<Vec<Vec<DVec3>>> = vec![vec![Vec::new()]; count];
    for (index, ring) in rings.into_iter().enumerate() {
        match ring.parent.filter(|_| ring.is_hole) {
            Some(parent) => polygons[place[parent]].push(ring.vertices),
            None => polygons[place[index]][0] = ring.vertices,
        }
    }
    polygons
}

impl SortedRing {
    fn new(vertices: Vec<DVec3>) -> Self {
        let flat: Vec<DVec2> = vertices.iter().map(|vertex| vertex.truncate()).collect();
        // Areas about the first vertex, so that those of small rings far from zero keep their sign.
        let first = flat.first().copied().unwrap_or_default();
        let moved: Vec<DVec2> = flat.iter().map(|&vertex| vertex - first).collect();
        let (bounds, doubled_area) = (Rect::around(flat.iter().copied()), doubled_area(&moved));
        Self { vertices, flat, bounds, doubled_area, parent: None, is_hole: false }
    }

    fn size(&self) -> f64 {
        self.doubled_area.abs()
    }

    fn lies_in(&self, other: &Self, steps: &mut u64) -> Result<bool, Entangled> {
        let looks_inside = other.bounds.contains(self.bounds.min) && other.bounds.contains(self.bounds.max);
        let work = if looks_inside { 1 + 3 * other.flat.len() as u64 } else { 1 };
        *steps = steps.checked_sub(work).ok_or(Entangled)?;
        if !looks_inside || self.flat.is_empty() {
            return Ok(false);
        }
        let count = self.flat.len();
        let witnesses = [0, count / 3, 2 * count / 3].map(|at| self.flat[at]);
        let inside = |at: &&DVec2| contains([other.flat.as_slice()], **at);
        Ok(witnesses.iter().filter(inside).count() >= 2)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A square about (`x`, `y`); counter-clockwise, or clockwise where `half` is negative.
    fn square(x: f64, y: f64, half: f64) -> Vec<DVec3> {
        let side = half.abs();
        [(-side, -half), (side, -half), (side, half), (-side, half)]
            .map(|(dx, dy)| DVec3::new(x + dx, y + dy, 0.0))
            .to_vec()
    }

    fn counts(rings: &[Vec<DVec3>], rule: HoleRule) -> Vec<usize> {
        let mut steps = MOST_STEPS;
        let polygons = polygons(rings.to_vec(), rule, &mut steps).expect("few rings");
        assert_eq!(polygons.iter().map(Vec::len).sum::<usize>(), rings.len());
        polygons.iter().map(Vec::len).collect()
    }

    #[test]
    fn holes_go_to_the_smallest_ring_around_them_and_islands_stand_alone() {
        let rings =
            [square(0.0, 0.0, 1.0), square(0.0, 0.0, 8.0), square(0.0, 0.0, 4.0), square(20.0, 0.0, 2.0)];
        assert_eq!(counts(&rings, HoleRule::Nesting), [1, 2, 1]);
    }

    #[test]
    fn by_direction_a_clockwise_ring_inside_another_is_no_hole() {
        let (big, inside, hole) = (square(0.0, 0.0, -8.0), square(3.0, 3.0, -1.0), square(-3.0, 0.0, 2.0));
        assert_eq!(counts(&[hole, big, inside.clone()], HoleRule::Direction), [2, 1]);
        let all_turned = [square(0.0, 0.0, 8.0), square(0.0, 0.0, 2.0)];
        assert_eq!(counts(&all_turned, HoleRule::Direction), [2], "none runs clockwise: nesting decides");
        assert_eq!(
            counts(&[inside, square(0.0, 50.0, 2.0)], HoleRule::Direction),
            [1, 1],
            "a hole in nothing"
        );
    }

    #[test]
    fn a_small_ring_far_from_zero_keeps_its_direction() {
        let far = DVec2::new(500_000.0, 6_200_000.0);
        let rings = [square(far.x, far.y, -0.5), square(far.x, far.y, 0.1)];
        assert_eq!(counts(&rings, HoleRule::Direction), [2]);
    }

    #[test]
    fn rings_without_end_inside_each_other_stop() {
        let rings: Vec<_> = (1..2000).map(|size| square(0.0, 0.0, f64::from(size))).collect();
        let mut steps = 30_000;
        assert!(
            polygons(rings, HoleRule::Nesting, &mut steps).is_ok(),
            "each lies in the next: found at once"
        );
        let apart: Vec<_> = (1..2000).map(|at| square(f64::from(at * 4), 0.0, 1.0)).collect();
        assert!(polygons(apart, HoleRule::Nesting, &mut 30_000).is_err());
    }
}
