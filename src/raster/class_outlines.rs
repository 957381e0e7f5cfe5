//! Polygons around the patches of a [`ClassGrid`], which neighbors share: no gap and no overlap between them.
//!
//! The borders between patches are cut into arcs at the nodes, where three or more of them meet. An arc is made smooth once and
//! both of its patches take it, one forward and one backward.
//!
//! ```text
//!   ┌──┐            a border runs through the middles of the sides of cells; each middle moves to the mean of those
//!   │  └──┐         before and after it, but stays within its own diamond, a little inside of the corners of the side and
//!   │     │         the centers of the two cells: diamonds of different sides do not overlap, so borders do not cross
//!   ◇──┐  └──
//! ```
//!
//! The frame of the grid and the nodes stay where they are. So the areas of all outlines sum to that of the grid.

use glam::{DVec2, IVec2};
use rayon::prelude::*;

use crate::class_grid::ClassGrid;
use crate::class_sieve::ClassPatches;
use sandtable_geom::segment;
use sandtable_geom::simplify::simplified;

/// The outline of one patch, in cells from the grid's upper left corner: X by columns, Y by rows downward.
#[derive(Clone, Debug, PartialEq)]
pub struct PatchOutline {
    /// The class of its cells.
    pub class: u8,
    /// Their number.
    pub cells: u32,
    /// The ring around it, without repeating the first vertex.
    pub exterior: Vec<DVec2>,
    /// The rings around what lies in it, run through the other way.
    pub holes: Vec<Vec<DVec2>>,
}

/// The course of outlines.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OutlineCourse {
    /// Along the sides of cells.
    Cells,
    /// Smooth, no further than half a cell from there.
    Smooth,
}

/// How far the middle of a side moves, in cells along X and Y together: less than 0.5, at which borders on both sides of a cell
/// could touch.
const MOST_MOVED: f64 = 0.4;

/// How often the middles of sides move to the mean of their neighbors: enough that a straight border of any direction, whose
/// stairs may be several cells long, shows none of them.
const PASSES: usize = 24;

/// The square of the sides around a patch for each such pass: each takes a share of the area of a small patch, all of them together
/// about three percent.
const SQUARED_SIDES_PER_PASS: usize = 640;

/// The distance in cells within which vertices are left out: less than what the moving leaves between two borders.
const TOLERANCE: f64 = 0.06;

/// That distance in grids of up to [`FEW_CELLS`] a side, of which a picture shows each cell: corners would show, too.
const FINE_TOLERANCE: f64 = 0.02;

/// Cells of a side that take several pixels of a picture each.
const FEW_CELLS: u32 = 400;

/// The outlines of all patches of a grid, those of [`NO_CLASS`](crate::class_grid::NO_CLASS) too, in the order of their first cells.
pub fn outlines(grid: &ClassGrid, course: OutlineCourse) -> Vec<PatchOutline> {
    let patches = ClassPatches::of(grid);
    let borders = PatchBorders { grid, patches: &patches };
    let arcs = borders.arcs();
    let lines: Vec<Vec<DVec2>> = arcs.par_iter().map(|arc| borders.line(arc, course)).collect();
    let outline = |(class, cells): (&u8, &u32)| PatchOutline {
        class: *class,
        cells: *cells,
        exterior: Vec::new(),
        holes: Vec::new(),
    };
    let mut found: Vec<PatchOutline> = patches.classes.iter().zip(&patches.sizes).map(outline).collect();
    for ArcRing { patch, halves } in borders.rings(&arcs) {
        let mut ring = Vec::new();
        let mut doubled_area = 0;
        for HalfArc { arc, is_back } in halves {
            let line = &lines[arc];
            // The last vertex of an open arc is the first of the next.
            let count = line.len() - usize::from(!arcs[arc].is_closed());
            match is_back {
                false => ring.extend(line.iter().take(count)),
                true => ring.extend(line.iter().rev().take(count)),
            }
            let own = arcs[arc].doubled_area();
            doubled_area += if is_back { -own } else { own };
        }
        let outline = &mut found[patch as usize];
        if doubled_area > 0 {
            outline.exterior = ring;
        } else {
            outline.holes.push(ring);
        }
    }
    found
}

/// A direction along the sides of cells: east, south, west, north, each to the right of the one before.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct SideDirection(u8);

impl SideDirection {
    const ALL: [Self; 4] = [Self(0), Self(1), Self(2), Self(3)];

    fn step(self) -> IVec2 {
        [IVec2::X, IVec2::Y, IVec2::NEG_X, IVec2::NEG_Y][usize::from(self.0)]
    }

    fn turned(self, quarters_right: u8) -> Self {
        Self((self.0 + quarters_right) % 4)
    }

    /// From a corner to the cell on the right of the side that leaves it.
    fn right(self) -> IVec2 {
        [IVec2::ZERO, IVec2::NEG_X, IVec2::NEG_ONE, IVec2::NEG_Y][usize::from(self.0)]
    }

    fn left(self) -> IVec2 {
        self.turned(3).right()
    }
}

/// Sides of cells between the same two patches from one node to the next, or all around.
struct BorderArc {
    /// Corners of cells, one more than sides.
    corners: Vec<IVec2>,
    first: SideDirection,
    last: SideDirection,
    /// The patches on the right and on the left; `None` beyond the grid.
    patches: [Option<u32>; 2],
    ends_at_nodes: bool,
}

impl BorderArc {
    /// Whether it runs all around without a node.
    fn is_closed(&self) -> bool {
        !self.ends_at_nodes
    }

    /// Its part of twice the area of a ring, positive of one with its patch on the right.
    fn doubled_area(&self) -> i64 {
        let cross = |a: IVec2, b: IVec2| i64::from(a.x) * i64::from(b.y) - i64::from(b.x) * i64::from(a.y);
        self.corners.windows(2).map(|ends| cross(ends[0], ends[1])).sum()
    }
}

/// An arc in one of its two directions.
#[derive(Clone, Copy)]
struct HalfArc {
    arc: usize,
    is_back: bool,
}

/// A ring with its patch on the right.
struct ArcRing {
    patch: u32,
    halves: Vec<HalfArc>,
}

struct PatchBorders<'a> {
    grid: &'a ClassGrid,
    patches: &'a ClassPatches,
}

impl PatchBorders<'_> {
    fn size(&self) -> IVec2 {
        IVec2::new(self.grid.width() as i32, self.grid.height() as i32)
    }

    fn patch(&self, cell: IVec2) -> Option<u32> {
        let is_within = cell.cmpge(IVec2::ZERO).all() && cell.cmplt(self.size()).all();
        is_within
            .then(|| self.patches.patch_of[cell.y as usize * self.grid.width() as usize + cell.x as usize])
    }

    /// The patches on the right and on the left of the side that leaves a corner.
    fn sides(&self, corner: IVec2, direction: SideDirection) -> [Option<u32>; 2] {
        [direction.right(), direction.left()].map(|cell| self.patch(corner + cell))
    }

    fn is_border(&self, corner: IVec2, direction: SideDirection) -> bool {
        let [right, left] = self.sides(corner, direction);
        right != left
    }

    /// Whether arcs end at a corner: more than two borders meet, or the frame turns.
    fn is_node(&self, corner: IVec2) -> bool {
        let is_frame_corner = |at: i32, size: i32| at == 0 || at == size;
        let size = self.size();
        is_frame_corner(corner.x, size.x) && is_frame_corner(corner.y, size.y)
            || SideDirection::ALL.into_iter().filter(|along| self.is_border(corner, *along)).count() > 2
    }

    /// All arcs, each once: those from nodes first, then those all around.
    fn arcs(&self) -> Vec<BorderArc> {
        let size = self.size();
        let across = size.x as usize + 1;
        // Sides to the east and to the south of each corner.
        let mut is_taken = vec![[false; 2]; across * (size.y as usize + 1)];
        let mut arcs = Vec::new();
        for only_nodes in [true, false] {
            for y in 0..=size.y {
                for x in 0..=size.x {
                    let corner = IVec2::new(x, y);
                    if only_nodes && !self.is_node(corner) {
                        continue;
                    }
                    for along in SideDirection::ALL {
                        let [at, slot] = side_slot(corner, along, across);
                        if self.is_border(corner, along) && !is_taken[at][slot] {
                            let arc = self.arc(corner, along);
                            let mut direction = arc.first;
                            for ends in arc.corners.windows(2) {
                                direction = direction_of(ends[1] - ends[0]).unwrap_or(direction);
                                let [at, slot] = side_slot(ends[0], direction, across);
                                is_taken[at][slot] = true;
                            }
                            arcs.push(arc);
                        }
                    }
                }
            }
        }
        arcs
    }

    /// The arc that leaves a corner, up to the next node or back to where it began.
    fn arc(&self, start: IVec2, first: SideDirection) -> BorderArc {
        let mut corners = vec![start];
        let (mut at, mut along) = (start, first);
        loop {
            at += along.step();
            corners.push(at);
            if at == start || self.is_node(at) {
                break;
            }
            let onward = [0, 1, 3].map(|quarters| along.turned(quarters));
            along = onward.into_iter().find(|next| self.is_border(at, *next)).expect("a border has no end");
        }
        let patches = self.sides(start, first);
        BorderArc { corners, first, last: along, patches, ends_at_nodes: self.is_node(start) }
    }

    /// The rings of all patches.
    fn rings(&self, arcs: &[BorderArc]) -> Vec<ArcRing> {
        let mut starts: Vec<((i32, i32, SideDirection), HalfArc)> = Vec::new();
        for (arc, found) in arcs.iter().enumerate().filter(|(_, arc)| arc.ends_at_nodes) {
            let ends = [found.corners[0], found.corners[found.corners.len() - 1]];
            let back = found.last.turned(2);
            starts.push(((ends[0].x, ends[0].y, found.first), HalfArc { arc, is_back: false }));
            starts.push(((ends[1].x, ends[1].y, back), HalfArc { arc, is_back: true }));
        }
        starts.sort_unstable_by_key(|(start, _)| *start);
        let leaving = |corner: IVec2, along: SideDirection| {
            let found = starts.binary_search_by_key(&(corner.x, corner.y, along), |(start, _)| *start);
            starts[found.expect("arcs leave a node along its borders")].1
        };
        let mut is_taken = vec![[false; 2]; arcs.len()];
        let mut rings = Vec::new();
        for arc in 0..arcs.len() {
            for is_back in [false, true] {
                let Some(patch) = arcs[arc].patches[usize::from(is_back)] else { continue };
                let mut half = HalfArc { arc, is_back };
                let mut halves = Vec::new();
                while !is_taken[half.arc][usize::from(half.is_back)] {
                    is_taken[half.arc][usize::from(half.is_back)] = true;
                    halves.push(half);
                    let BorderArc { corners, first, last, .. } = &arcs[half.arc];
                    if arcs[half.arc].is_closed() {
                        break;
                    }
                    let (at, along) = match half.is_back {
                        false => (corners[corners.len() - 1], *last),
                        true => (corners[0], first.turned(2)),
                    };
                    half = leaving(at, self.onward(at, along, patch));
                }
                if !halves.is_empty() {
                    rings.push(ArcRing { patch, halves });
                }
            }
        }
        rings
    }

    /// Where the ring of a patch goes on from a node: around the cell that it came along, so that cells that share only a corner
    /// stay apart.
    fn onward(&self, corner: IVec2, along: SideDirection, patch: u32) -> SideDirection {
        let turns = [1, 0, 3].map(|quarters| along.turned(quarters));
        let is_onward = |next: &SideDirection| {
            let [right, left] = self.sides(corner, *next);
            right == Some(patch) && left != right
        };
        turns.into_iter().find(is_onward).expect("a ring has no end")
    }

    /// The course of an arc; of a closed one without repeating its first vertex.
    fn line(&self, arc: &BorderArc, course: OutlineCourse) -> Vec<DVec2> {
        let corners = &arc.corners[..arc.corners.len() - usize::from(arc.is_closed())];
        match course {
            OutlineCourse::Cells => corners.iter().map(|corner| corner.as_dvec2()).collect(),
            OutlineCourse::Smooth => {
                let size = self.size().as_dvec2();
                let middles: Vec<DVec2> =
                    arc.corners.windows(2).map(|ends| (ends[0] + ends[1]).as_dvec2() / 2.0).collect();
                let is_frame = |at: DVec2| at.cmpeq(DVec2::ZERO).any() || at.cmpeq(size).any();
                let side = self.grid.width().max(self.grid.height());
                let slack = if side <= FEW_CELLS { FINE_TOLERANCE } else { TOLERANCE };
                let moved = smoothed(&middles, &arc.corners, arc.is_closed(), is_frame);
                if arc.is_closed() {
                    return thinned_ring(&moved, slack);
                }
                let ends = [arc.corners[0], arc.corners[arc.corners.len() - 1]].map(|end| end.as_dvec2());
                let mut line = vec![ends[0]];
                // Next to a node, where borders are near each other, no vertex is left out.
                thinned(&moved, slack, &mut line);
                line.push(ends[1]);
                line
            }
        }
    }
}

/// The corner that a side lies east or south of, by its index, and which of both.
fn side_slot(corner: IVec2, along: SideDirection, across: usize) -> [usize; 2] {
    let is_back = along.0 >= 2;
    let from = if is_back { corner + along.step() } else { corner };
    // At the frame of the grid sides lead out of it, which are no borders.
    let from = from.max(IVec2::ZERO);
    [from.y as usize * across + from.x as usize, usize::from(along.0 % 2)]
}

fn direction_of(step: IVec2) -> Option<SideDirection> {
    SideDirection::ALL.into_iter().find(|along| along.step() == step)
}

/// The middles of sides after all passes. Before the first and after the last of an open arc are its ends.
fn smoothed(
    middles: &[DVec2],
    corners: &[IVec2],
    is_closed: bool,
    is_fixed: impl Fn(DVec2) -> bool,
) -> Vec<DVec2> {
    let count = middles.len();
    let ends = [corners[0].as_dvec2(), corners[corners.len() - 1].as_dvec2()];
    let mut moved = middles.to_vec();
    let mut next = moved.clone();
    let passes = if is_closed { (count * count / SQUARED_SIDES_PER_PASS).clamp(2, PASSES) } else { PASSES };
    for _ in 0..passes {
        for index in (0..count).filter(|index| !is_fixed(middles[*index])) {
            let before = match index {
                0 if is_closed => moved[count - 1],
                0 => ends[0],
                _ => moved[index - 1],
            };
            let after = match index + 1 {
                end if end == count => {
                    if is_closed {
                        moved[0]
                    } else {
                        ends[1]
                    }
                }
                after => moved[after],
            };
            let by = (before + 2.0 * moved[index] + after) / 4.0 - middles[index];
            let length = by.x.abs() + by.y.abs();
            next[index] = middles[index] + by * (MOST_MOVED / length.max(MOST_MOVED));
        }
        std::mem::swap(&mut moved, &mut next);
    }
    moved
}

/// Adds a line to `out`, without the vertices that lie within `slack` of what is left (Douglas and Peucker 1973).
fn thinned(line: &[DVec2], slack: f64, out: &mut Vec<DVec2>) {
    let apart = |first: usize, last: usize, index: usize| {
        segment::distance_squared((line[first], line[last]), line[index]).sqrt()
    };
    out.extend(simplified(line.len(), slack, apart).into_iter().map(|index| line[index]));
}

/// A ring without such vertices, of at least three. It has at least four.
fn thinned_ring(ring: &[DVec2], slack: f64) -> Vec<DVec2> {
    let far = |index: &usize| ring[*index].distance_squared(ring[0]);
    let farthest = (1..ring.len()).max_by(|one, other| far(one).total_cmp(&far(other))).unwrap_or(0);
    let mut out = Vec::new();
    thinned(&ring[..=farthest], slack, &mut out);
    out.pop();
    let back: Vec<DVec2> = ring[farthest..].iter().chain(&ring[..1]).copied().collect();
    thinned(&back, slack, &mut out);
    out.pop();
    if out.len() < 3 { ring.to_vec() } else { out }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::class_sieve::sieve;
    use proptest::prelude::*;
    use sandtable_geom::polygon::doubled_area;
    use sandtable_geom::self_crossing::count_crossings;

    impl PatchOutline {
        /// Twice the area within it, holes apart, in cells.
        fn doubled_area(&self) -> f64 {
            let ring = |ring: &Vec<DVec2>| doubled_area(ring);
            ring(&self.exterior) + self.holes.iter().map(ring).sum::<f64>()
        }
    }

    /// Checks what holds of the outlines of every grid: each patch has the area of its cells, and together they have the
    /// area of the grid, before and after the smoothing; no border crosses another.
    fn check(grid: &ClassGrid) {
        for outline in outlines(grid, OutlineCourse::Cells) {
            assert_eq!(outline.doubled_area(), 2.0 * f64::from(outline.cells), "{outline:?}");
            assert!(doubled_area(&outline.exterior) > 0.0);
            assert!(outline.holes.iter().all(|hole| doubled_area(hole) < 0.0));
        }
        let smooth = outlines(grid, OutlineCourse::Smooth);
        let area: f64 = smooth.iter().map(PatchOutline::doubled_area).sum();
        let cells = grid.cells().len() as f64;
        assert!((area - 2.0 * cells).abs() < 1e-9 * cells, "{area} of {}", 2.0 * cells);
        let rings =
            || smooth.iter().flat_map(|outline| std::iter::once(&outline.exterior).chain(&outline.holes));
        assert!(rings().all(|ring| ring.len() >= 3));
        // Borders are shared: each edge is once in one ring and once, the other way, in another, but for those of the frame.
        let edges = |ring: &Vec<DVec2>| sandtable_geom::polygon::edges(ring).collect::<Vec<_>>();
        let mut directed: Vec<[u64; 4]> =
            rings().flat_map(edges).map(|(a, b)| [a.x, a.y, b.x, b.y].map(f64::to_bits)).collect();
        directed.sort_unstable();
        let size = DVec2::new(grid.width().into(), grid.height().into());
        for &[ax, ay, bx, by] in &directed {
            let [a, b] = [[ax, ay], [bx, by]].map(|at| DVec2::from_array(at.map(f64::from_bits)));
            let is_frame = (a.x == b.x && (a.x == 0.0 || a.x == size.x))
                || (a.y == b.y && (a.y == 0.0 || a.y == size.y));
            assert_eq!(directed.binary_search(&[bx, by, ax, ay]).is_err(), is_frame, "{a} to {b}");
        }
        for outline in &smooth {
            let own = std::iter::once(&outline.exterior).chain(&outline.holes).map(Vec::as_slice);
            let crossings = count_crossings(own, 1000);
            assert_eq!(crossings, Some(0), "{outline:?}");
        }
    }

    #[test]
    fn a_patch_in_a_patch_is_a_hole_of_it() {
        let grid = ClassGrid::new(5, vec![1, 1, 1, 1, 1, 1, 2, 2, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1]);
        check(&grid);
        let found = outlines(&grid, OutlineCourse::Cells);
        assert_eq!((found[0].holes.len(), found[1].holes.len(), found[1].cells), (1, 0, 2));
    }

    #[test]
    fn cells_that_share_a_corner_are_two_patches() {
        let grid = ClassGrid::new(3, vec![1, 2, 2, 2, 1, 2, 2, 2, 1]);
        check(&grid);
        assert_eq!(outlines(&grid, OutlineCourse::Cells).len(), 5);
        let single = ClassGrid::new(1, vec![7]);
        check(&single);
        assert_eq!(outlines(&single, OutlineCourse::Smooth)[0].exterior.len(), 8);
    }

    #[test]
    fn a_straight_border_of_any_direction_has_no_stairs() {
        for slope in [0.1, 0.23, 0.5, 0.77, 1.0] {
            let is_below = |x: u32, y: u32| f64::from(y) + 0.5 > 8.0 + slope * (f64::from(x) + 0.5);
            let cells = (0..80).flat_map(|y| (0..60).map(move |x| u8::from(is_below(x, y)))).collect();
            let grid = ClassGrid::new(60, cells);
            check(&grid);
            let line = &outlines(&grid, OutlineCourse::Smooth)[0].exterior;
            let apart = |at: &DVec2| (at.y - 8.0 - slope * at.x).abs() / f64::hypot(1.0, slope);
            let inner = line.iter().filter(|at| at.x > 8.0 && at.x < 52.0 && at.y > 1.0);
            let most = inner.map(apart).fold(0.0, f64::max);
            // Stairs are half a cell off; next to their ends the least distance between borders keeps a part of that.
            assert!(most < 0.25, "{slope}: {most}");
        }
    }

    proptest! {
        #[test]
        fn outlines_of_random_grids_fill_them_and_cross_nothing(
            width in 1u32..16, cells in proptest::collection::vec(0..3u8, 16..220), least in 1u32..9,
        ) {
            let rows = cells.len() / width as usize;
            let mut grid = ClassGrid::new(width, cells[..rows * width as usize].to_vec());
            check(&grid);
            sieve(&mut grid, least);
            check(&grid);
        }
    }
}
