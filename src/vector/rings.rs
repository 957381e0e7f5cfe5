//! Sorts unordered rings into polygons: finds the outer rings and the holes of each.
//!
//! Many writers know nothing of directions: where those of a shape contradict the places of its rings, the places decide.
//! They do where all rings run the same way, and where a ring that runs as a hole lies in none that runs as an outer one
//! but has rings in it. So do GDAL and QGIS.
//!
//! A ring lies inside another where at least two of three of its vertices do, since rings that touch share vertices.
//! A hole belongs to the smallest ring around it. The search takes time that grows with the square of the number of
//! rings, so a budget stops hostile files.

use glam::DVec2;

use crate::builder::Vertices;
use sandtable_base::limits::RING_STEPS;
use sandtable_geom::polygon::{contains, doubled_area};
use sandtable_geom::rect::Rect;

/// The rule by which a ring is a hole.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum HoleRule {
    /// It runs counter-clockwise inside one that runs clockwise (ESRI shapefiles). A shape whose rings do not keep to
    /// that follows [`HoleRule::Nesting`].
    Direction,
    /// It lies directly inside an outer ring; a ring inside a hole is an outer ring again (OpenStreetMap).
    Nesting,
}

/// The file has too many rings inside one another.
#[derive(Debug, thiserror::Error)]
#[error("too many rings lie inside one another; {RING_STEPS:#}")]
pub(crate) struct RingLimitExceeded;

/// The polygons of one shape.
pub(crate) struct SortedRings {
    /// The rings of each, the outer one first: polygons in the order of their outer rings, holes in their own.
    pub polygons: Vec<Vec<Vertices>>,
    /// Whether directions were to decide, and nesting did: some hole runs as an outer ring, or the other way round.
    pub are_reversed: bool,
}

pub(crate) struct RingSorter {
    rule: HoleRule,
    steps_left: u64,
}

struct SortedRing {
    vertices: Vertices,
    flat: Vec<DVec2>,
    bounds: Rect,
    /// Positive for a counter-clockwise ring.
    doubled_area: f64,
    parent: Option<usize>,
    is_hole: bool,
}

impl RingSorter {
    pub fn new(rule: HoleRule) -> Self {
        Self { rule, steps_left: RING_STEPS.get() }
    }

    /// Returns the polygons of a shape.
    ///
    /// # Errors
    /// [`RingLimitExceeded`] where the budget of the file is spent.
    pub fn polygons(&mut self, rings: Vec<Vertices>) -> Result<SortedRings, RingLimitExceeded> {
        if rings.len() == 1 {
            return Ok(SortedRings { polygons: vec![rings], are_reversed: false });
        }
        let mut rings: Vec<SortedRing> = rings.into_iter().map(SortedRing::new).collect();
        let mut by_size: Vec<usize> = (0..rings.len()).collect();
        by_size.sort_by(|&a, &b| rings[b].size().total_cmp(&rings[a].size()).then(a.cmp(&b)));
        let clockwise = rings.iter().filter(|ring| ring.is_clockwise()).count();
        let by_direction = self.rule == HoleRule::Direction && (1..rings.len()).contains(&clockwise);
        if !by_direction || !self.nest_by_direction(&mut rings, &by_size)? {
            self.nest(&mut rings, &by_size)?;
        }
        // A hole that runs as an outer ring, or a hole in a ring that runs as a hole.
        let contradicts = |ring: &SortedRing| {
            let around = ring.parent.filter(|_| ring.is_hole);
            around.is_some_and(|around| ring.is_clockwise() || !rings[around].is_clockwise())
        };
        let are_reversed = self.rule == HoleRule::Direction && rings.iter().any(contradicts);
        Ok(SortedRings { polygons: grouped(rings), are_reversed })
    }

    /// Finds the clockwise ring around each counter-clockwise one, and returns whether directions are to be believed:
    /// not where a counter-clockwise ring lies in no clockwise one and has rings in it.
    fn nest_by_direction(
        &mut self,
        rings: &mut [SortedRing],
        by_size: &[usize],
    ) -> Result<bool, RingLimitExceeded> {
        for (rank, &index) in by_size.iter().enumerate() {
            if rings[index].is_clockwise() {
                continue;
            }
            for &larger in by_size[..rank].iter().rev() {
                if rings[larger].is_clockwise() && self.is_inside(&rings[index], &rings[larger])? {
                    rings[index].parent = Some(larger);
                    rings[index].is_hole = true;
                    break;
                }
            }
            if rings[index].parent.is_none() {
                for &smaller in &by_size[rank + 1..] {
                    if self.is_inside(&rings[smaller], &rings[index])? {
                        return Ok(false);
                    }
                }
            }
        }
        Ok(true)
    }

    /// Finds the smallest ring around each; a ring in a hole is an outer ring again.
    fn nest(&mut self, rings: &mut [SortedRing], by_size: &[usize]) -> Result<(), RingLimitExceeded> {
        for (rank, &index) in by_size.iter().enumerate() {
            (rings[index].parent, rings[index].is_hole) = (None, false);
            for &larger in by_size[..rank].iter().rev() {
                if self.is_inside(&rings[index], &rings[larger])? {
                    rings[index].parent = Some(larger);
                    rings[index].is_hole = !rings[larger].is_hole;
                    break;
                }
            }
        }
        Ok(())
    }

    fn is_inside(&mut self, ring: &SortedRing, other: &SortedRing) -> Result<bool, RingLimitExceeded> {
        let fits = other.bounds.contains(ring.bounds.min) && other.bounds.contains(ring.bounds.max);
        let work = if fits { 1 + 3 * other.flat.len() as u64 } else { 1 };
        self.steps_left = self.steps_left.checked_sub(work).ok_or(RingLimitExceeded)?;
        let count = ring.flat.len();
        if !fits || count == 0 {
            return Ok(false);
        }
        let witnesses = [0, count / 3, 2 * count / 3].map(|index| ring.flat[index]);
        let inside = witnesses.iter().filter(|&&vertex| contains([other.flat.as_slice()], vertex)).count();
        Ok(inside >= 2)
    }
}

fn grouped(rings: Vec<SortedRing>) -> Vec<Vec<Vertices>> {
    let mut polygon_of = vec![0; rings.len()];
    let outer = rings.iter().enumerate().filter(|(_, ring)| !ring.is_hole).map(|(index, _)| index);
    outer.enumerate().for_each(|(polygon, index)| polygon_of[index] = polygon);
    let count = rings.iter().filter(|ring| !ring.is_hole).count();
    let mut polygons: Vec<Vec<Vertices>> = vec![vec![Vec::new()]; count];
    for (index, ring) in rings.into_iter().enumerate() {
        match ring.parent.filter(|_| ring.is_hole) {
            Some(parent) => polygons[polygon_of[parent]].push(ring.vertices),
            None => polygons[polygon_of[index]][0] = ring.vertices,
        }
    }
    polygons
}

impl SortedRing {
    fn new(vertices: Vertices) -> Self {
        let flat: Vec<DVec2> = vertices.iter().map(|vertex| vertex.truncate()).collect();
        // Relative to the first vertex, so that small rings far from zero keep the sign of their area.
        let first = flat.first().copied().unwrap_or_default();
        let local: Vec<DVec2> = flat.iter().map(|&vertex| vertex - first).collect();
        let (bounds, doubled_area) = (Rect::around(flat.iter().copied()), doubled_area(&local));
        Self { vertices, flat, bounds, doubled_area, parent: None, is_hole: false }
    }

    fn is_clockwise(&self) -> bool {
        self.doubled_area < 0.0
    }

    fn size(&self) -> f64 {
        self.doubled_area.abs()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    /// A square about (`x`, `y`); counter-clockwise, or clockwise where `half` is negative.
    fn square(x: f64, y: f64, half: f64) -> Vertices {
        let side = half.abs();
        [(-side, -half), (side, -half), (side, half), (-side, half)]
            .map(|(dx, dy)| DVec3::new(x + dx, y + dy, 0.0))
            .to_vec()
    }

    fn counts(rings: &[Vertices], rule: HoleRule) -> Vec<usize> {
        let polygons = RingSorter::new(rule).polygons(rings.to_vec()).expect("few rings").polygons;
        assert_eq!(polygons.iter().map(Vec::len).sum::<usize>(), rings.len());
        polygons.iter().map(Vec::len).collect()
    }

    #[test]
    fn holes_go_to_the_smallest_ring_around_them_and_islands_to_none() {
        let rings =
            [square(0.0, 0.0, 1.0), square(0.0, 0.0, 8.0), square(0.0, 0.0, 4.0), square(20.0, 0.0, 2.0)];
        assert_eq!(counts(&rings, HoleRule::Nesting), [1, 2, 1]);
    }

    #[test]
    fn by_direction_a_clockwise_ring_inside_another_is_no_hole() {
        let (big, inside, hole) = (square(0.0, 0.0, -8.0), square(3.0, 3.0, -1.0), square(-3.0, 0.0, 2.0));
        assert_eq!(counts(&[hole, big, inside.clone()], HoleRule::Direction), [2, 1]);
        assert_eq!(
            counts(&[inside, square(0.0, 50.0, 2.0)], HoleRule::Direction),
            [1, 1],
            "a hole in nothing"
        );
    }

    #[test]
    fn rings_whose_directions_contradict_their_places_are_sorted_by_these() {
        let sorted = |rings: &[Vertices]| {
            let sorted = RingSorter::new(HoleRule::Direction).polygons(rings.to_vec()).expect("few");
            (sorted.polygons.iter().map(Vec::len).collect::<Vec<_>>(), sorted.are_reversed)
        };
        let [outer, hole, island] = [8.0, 4.0, 2.0].map(|half| square(0.0, 0.0, half));
        let [outer_cw, hole_cw, island_cw] = [-8.0, -4.0, -2.0].map(|half| square(0.0, 0.0, half));
        let apart = square(40.0, 0.0, -3.0);
        assert_eq!(sorted(&[outer.clone(), hole_cw.clone()]), (vec![2], true), "both turned");
        assert_eq!(sorted(&[outer.clone(), hole.clone()]), (vec![2], true), "both counter-clockwise");
        assert_eq!(sorted(&[outer_cw.clone(), hole_cw.clone()]), (vec![2], true), "both clockwise");
        assert_eq!(sorted(&[outer, hole_cw, island, apart.clone()]), (vec![2, 1, 1], true), "all turned");
        assert_eq!(sorted(&[outer_cw.clone(), hole.clone(), island_cw]), (vec![2, 1], false), "by the book");
        assert_eq!(sorted(&[outer_cw, hole, apart.clone()]), (vec![2, 1], false));
        assert_eq!(sorted(&[apart, square(0.0, 0.0, 1.0)]), (vec![1, 1], false), "apart from each other");
    }

    #[test]
    fn a_small_ring_far_from_zero_keeps_its_direction() {
        let far = DVec2::new(500_000.0, 6_200_000.0);
        let rings = [square(far.x, far.y, -0.5), square(far.x, far.y, 0.1)];
        assert_eq!(counts(&rings, HoleRule::Direction), [2]);
    }

    #[test]
    fn too_many_rings_are_refused() {
        let sorted =
            |rings: Vec<Vertices>| RingSorter { rule: HoleRule::Nesting, steps_left: 30_000 }.polygons(rings);
        let nested = (1..2000).map(|size| square(0.0, 0.0, f64::from(size))).collect();
        assert!(sorted(nested).is_ok(), "each lies in the next, which is looked at first");
        let apart = (1..2000).map(|at| square(f64::from(at * 4), 0.0, 1.0)).collect();
        assert!(sorted(apart).is_err());
    }
}
