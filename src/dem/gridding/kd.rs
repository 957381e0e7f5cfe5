//! The sites nearest to a position: a k-d tree (Bentley 1975) over halves, searched by the offsets to its planes (Arya
//! and Mount 1993).
//!
//! A grid of buckets is as fast where points lie evenly. Surveys do not: a bucket sized for the mean holds half the
//! points of a dense patch, and a lake is a desert of empty ones. The tree's leaves follow the points, and a search
//! costs about the same everywhere. (Neither `rstar` nor `kiddo` searches by quadrant, and both return sites that are
//! equally far in an order of their own.)
//!
//! Each level halves its sites at their median along the longer side, so that ranges need no storage: a subtree is a
//! slice of `sites` and its planes a slice of `planes`, its own first, the left half's next, then the right half's.

use std::cmp::Ordering;

use glam::DVec2;

/// Sites in a leaf at most: below some eight, walking the tree costs more than comparing all of a leaf.
const LEAF: usize = 8;

/// Subtrees of more sites are built by two threads.
const PARALLEL: usize = 16_384;

/// A line that splits a subtree: no site of its left half lies above it, none of its right half below.
#[derive(Clone, Copy, Debug, Default)]
struct SplitLine {
    axis: usize,
    at: f64,
}

/// Sites in the order of a tree.
pub(super) struct KdTree {
    sites: Vec<(DVec2, u32)>,
    planes: Vec<SplitLine>,
}

/// A site and its squared distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Near {
    pub distance2: f64,
    pub site: u32,
}

impl Near {
    /// Nearer first; of two equally far the one that comes first among the sites.
    pub fn order(&self, other: &Self) -> Ordering {
        self.distance2.total_cmp(&other.distance2).then(self.site.cmp(&other.site))
    }
}

trait Search {
    /// Whether it needs sites of a box `offset` away along each axis; 0 where it is not known to lie on one side.
    fn needs(&self, offset: DVec2) -> bool;

    fn take(&mut self, at: DVec2, site: u32);
}

/// How many sites more than wanted are gathered before the farthest are dropped. Keeping them sorted all the time
/// costs more than the search; a search that starts with a good bound never drops any before its end.
const SPARE: usize = 32;

/// The sites nearest to `q`.
pub(super) struct NearestSites {
    q: DVec2,
    near: Vec<Near>,
    wanted: usize,
    /// Nothing farther is needed.
    limit2: f64,
}

impl NearestSites {
    /// Memory for searches of the `wanted` nearest, at least 1.
    pub fn new(wanted: usize) -> Self {
        Self { q: DVec2::ZERO, near: Vec::new(), wanted, limit2: 0.0 }
    }

    /// The result of the last search, nearest first.
    pub fn near(&self) -> &[Near] {
        &self.near
    }

    /// Searches a list of sites instead of a tree; `limit2` as for [`KdTree::nearest_k`].
    pub fn choose(&mut self, q: DVec2, limit2: f64, candidates: &[(DVec2, u32)]) {
        self.start(q, limit2);
        for &(at, site) in candidates {
            self.offer(Near { distance2: (at - q).length_squared(), site });
        }
        self.finish();
    }

    fn offer(&mut self, near: Near) {
        if near.distance2 > self.limit2 {
            return;
        }
        self.near.push(near);
        if self.near.len() == self.wanted + SPARE {
            let (_, last, _) = self.near.select_nth_unstable_by(self.wanted - 1, Near::order);
            self.limit2 = last.distance2;
            self.near.truncate(self.wanted);
        }
    }

    fn start(&mut self, q: DVec2, limit2: f64) {
        (self.q, self.limit2) = (q, limit2);
        self.near.clear();
    }

    fn finish(&mut self) {
        self.near.sort_unstable_by(Near::order);
        self.near.truncate(self.wanted);
    }
}

impl Search for NearestSites {
    fn needs(&self, offset: DVec2) -> bool {
        // Rounding only ever lowers it: each step is rounded as a site's own distance is, from a smaller number.
        offset.length_squared() <= self.limit2
    }

    fn take(&mut self, at: DVec2, site: u32) {
        self.offer(Near { distance2: (at - self.q).length_squared(), site });
    }
}

/// A search of all sites at most as far from `q` as the root of `limit2`; of more than `most` it gathers only some.
struct RangeSearch<'a> {
    q: DVec2,
    limit2: f64,
    most: usize,
    gathered: &'a mut Vec<(DVec2, u32)>,
}

impl Search for RangeSearch<'_> {
    fn needs(&self, offset: DVec2) -> bool {
        offset.length_squared() <= self.limit2 && self.gathered.len() <= self.most
    }

    fn take(&mut self, at: DVec2, site: u32) {
        if (at - self.q).length_squared() <= self.limit2 {
            self.gathered.push((at, site));
        }
    }
}

/// The nearest site of each quadrant: south-west, south-east, north-west, north-east. A site due east counts as
/// north-east, one due north as north-east, one due west as north-west and one due south as south-east.
pub(super) type Quadrants = [Option<Near>; 4];

struct QuadrantSearch {
    q: DVec2,
    found: Quadrants,
}

impl Search for QuadrantSearch {
    fn needs(&self, offset: DVec2) -> bool {
        let distance2 = offset.length_squared();
        let is_open = |quadrant: usize| {
            // A box at a positive offset lies below `q` along the axis, one at a negative offset above.
            let sides = [(quadrant & 1, offset.x), (quadrant >> 1, offset.y)];
            sides.iter().all(|&(above, offset)| if above == 1 { offset <= 0.0 } else { offset >= 0.0 })
        };
        let mut found = self.found.iter().enumerate();
        found.any(|(quadrant, found)| {
            is_open(quadrant) && found.is_none_or(|near| distance2 <= near.distance2)
        })
    }

    fn take(&mut self, at: DVec2, site: u32) {
        let quadrant = usize::from(at.x >= self.q.x) + 2 * usize::from(at.y >= self.q.y);
        let near = Near { distance2: (at - self.q).length_squared(), site };
        let nearest = &mut self.found[quadrant];
        if nearest.is_none_or(|best| near.order(&best).is_lt()) {
            *nearest = Some(near);
        }
    }
}

impl KdTree {
    /// The tree of positions, which are sites by their index.
    pub fn new(at: &[DVec2]) -> Self {
        let leaves = at.len().div_ceil(LEAF).next_power_of_two();
        let mut sites: Vec<(DVec2, u32)> = at.iter().zip(0..).map(|(&at, site)| (at, site)).collect();
        let mut planes = vec![SplitLine::default(); leaves - 1];
        build(&mut sites, &mut planes);
        Self { sites, planes }
    }

    pub fn nearest(&self, q: DVec2) -> Option<u32> {
        let mut found = NearestSites::new(1);
        self.nearest_k(q, f64::INFINITY, &mut found);
        found.near.first().map(|near| near.site)
    }

    /// Puts the sites nearest to `q` into `found`, as many as it wants and there are.
    ///
    /// `limit2` is a squared distance within which that many lie; infinite where none is known.
    pub fn nearest_k(&self, q: DVec2, limit2: f64, found: &mut NearestSites) {
        found.start(q, limit2);
        visit(&self.sites, &self.planes, q, DVec2::ZERO, found);
        found.finish();
    }

    /// Puts all sites at most as far from `q` as the root of `limit2` into `gathered`, or more than `most`.
    pub fn gather(&self, q: DVec2, limit2: f64, most: usize, gathered: &mut Vec<(DVec2, u32)>) {
        gathered.clear();
        let mut search = RangeSearch { q, limit2, most, gathered };
        visit(&self.sites, &self.planes, q, DVec2::ZERO, &mut search);
    }

    pub fn quadrants(&self, q: DVec2) -> Quadrants {
        let mut search = QuadrantSearch { q, found: [None; 4] };
        visit(&self.sites, &self.planes, q, DVec2::ZERO, &mut search);
        search.found
    }
}

/// Searches a subtree. `offset` is the offset of its box from `q` along each axis by the planes above it.
fn visit(
    sites: &[(DVec2, u32)],
    planes: &[SplitLine],
    q: DVec2,
    mut offset: DVec2,
    search: &mut impl Search,
) {
    let Some((plane, below)) = planes.split_first() else {
        return sites.iter().for_each(|&(at, site)| search.take(at, site));
    };
    let (left, right) = sites.split_at(sites.len() / 2);
    let (left_planes, right_planes) = below.split_at(below.len() / 2);
    let (left, right) = ((left, left_planes), (right, right_planes));
    let to_plane = q[plane.axis] - plane.at;
    let (near, far) = if to_plane < 0.0 { (left, right) } else { (right, left) };
    visit(near.0, near.1, q, offset, search);
    offset[plane.axis] = to_plane;
    if search.needs(offset) {
        visit(far.0, far.1, q, offset, search);
    }
}

fn build(sites: &mut [(DVec2, u32)], planes: &mut [SplitLine]) {
    let Some((plane, below)) = planes.split_first_mut() else { return };
    let (low, high) = sites
        .iter()
        .fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(low, high), (at, _)| (low.min(*at), high.max(*at)));
    let axis = usize::from(high.y - low.y > high.x - low.x);
    let middle = sites.len() / 2;
    let (left_planes, right_planes) = below.split_at_mut(below.len() / 2);
    if middle == 0 {
        // No site lies left of the plane: it is at the only one, or there is none.
        *plane = SplitLine { axis, at: sites.first().map_or(0.0, |(at, _)| at[axis]) };
    } else {
        let by_axis =
            |a: &(DVec2, u32), b: &(DVec2, u32)| a.0[axis].total_cmp(&b.0[axis]).then(a.1.cmp(&b.1));
        let (_, (at, _), _) = sites.select_nth_unstable_by(middle, by_axis);
        *plane = SplitLine { axis, at: at[axis] };
    }
    let (left, right) = sites.split_at_mut(middle);
    if left.len() > PARALLEL {
        rayon::join(|| build(left, left_planes), || build(right, right_planes));
    } else {
        build(left, left_planes);
        build(right, right_planes);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Positions on a coarse lattice, so that many are equally far.
    fn places(count: u32, seed: u32) -> Vec<DVec2> {
        let mut state = seed;
        let mut next = move || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(state >> 24 & 31)
        };
        (0..count).map(|_| DVec2::new(next(), next())).collect()
    }

    fn sorted(at: &[DVec2], q: DVec2) -> Vec<(f64, u32)> {
        let mut all: Vec<(f64, u32)> =
            at.iter().zip(0..).map(|(at, site)| ((*at - q).length_squared(), site)).collect();
        all.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        all
    }

    #[test]
    fn the_nearest_are_those_of_a_full_search_in_the_same_order() {
        for count in [0, 1, 2, 7, 9, 100, 777] {
            let at = places(count, count + 5);
            let tree = KdTree::new(&at);
            let mut found = NearestSites::new(12);
            for q in places(40, 99).into_iter().map(|q| q * 1.1 - 1.0) {
                tree.nearest_k(q, f64::INFINITY, &mut found);
                let all = sorted(&at, q);
                let near: Vec<(f64, u32)> =
                    found.near().iter().map(|near| (near.distance2, near.site)).collect();
                assert_eq!(near, all[..all.len().min(12)], "{count} places, {q}");
                assert_eq!(tree.nearest(q), all.first().map(|(_, site)| *site));
            }
        }
    }

    #[test]
    fn a_known_distance_changes_nothing() {
        let at = places(500, 3);
        let tree = KdTree::new(&at);
        let (mut free, mut bounded) = (NearestSites::new(5), NearestSites::new(5));
        for q in places(40, 12) {
            tree.nearest_k(q, f64::INFINITY, &mut free);
            tree.nearest_k(q, free.near()[4].distance2, &mut bounded);
            assert_eq!(free.near(), bounded.near());
        }
    }

    #[test]
    fn quadrants_are_those_of_a_full_search() {
        for count in [0, 1, 30, 600] {
            let at = places(count, 41);
            let tree = KdTree::new(&at);
            for q in places(60, 8) {
                let mut wanted = [None; 4];
                for (distance2, site) in sorted(&at, q) {
                    let place = at[site as usize];
                    let quadrant = usize::from(place.x >= q.x) + 2 * usize::from(place.y >= q.y);
                    wanted[quadrant] = wanted[quadrant].or(Some((distance2, site)));
                }
                let found = tree.quadrants(q).map(|near| near.map(|near| (near.distance2, near.site)));
                assert_eq!(found, wanted, "{count} places, {q}");
            }
        }
    }
}
