//! The finest triangles within a polygon, whole ones and cut ones, for whatever is summed over an area.
//!
//! Over each triangle the ground is a plane, so an integral over a polygon is exact when it is the sum over what the
//! polygon leaves of each triangle. The polygon is halved along lines of posts until a part of it fills its rectangle of
//! cells, which is then taken whole, or one cell is left, whose two triangles cut it:
//!
//! ```text
//!  ┌───────┬───────┐
//!  │  ____ │__     │      a line of posts halves the rectangle; each half is clipped by that one
//!  │ /     │██\    │      line alone (Sutherland and Hodgman 1974); what is full (██) or empty
//!  │/______│███\   │      needs no further look
//!  └───────┴───────┘
//! ```
//!
//! A ring clipped so may run back along a line that it has been cut by, there and back. Sums over the signed triangles of a
//! fan take no harm: such stretches cancel, and so do holes, which run the other way round.
//!
//! Costs the length of the border in cells times the logarithm of its number of vertices, and one step for each whole
//! triangle.

use std::ops::Range;

use glam::DVec2;
use rayon::prelude::*;

use crate::geom::polygon;
use crate::terrain::lattice::{Lattice, Post};
use crate::terrain::query::Diagonal;

/// Rows of cells that one thread takes at a time; fixed, so that sums are the same for any number of threads.
const BAND: u32 = 64;

/// By what share a part may fall short of its rectangle and still fill it: more than areas of a few thousand cells lose
/// to rounding, less than anybody measures. Only parts with all vertices on the rectangle's border are asked.
const FULL: f64 = 1e-9;

/// Why rings enclose no region.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum RegionError {
    /// There is no ring, or one with fewer than three vertices.
    #[error("ring {0} of the polygon has fewer than three vertices")]
    TooFew(usize),
    /// A vertex is not finite.
    #[error("ring {0} of the polygon has a coordinate that is not a finite number")]
    NotFinite(usize),
}

/// A polygon over a lattice, in grid coordinates: columns and rows of posts.
#[derive(Clone, Debug)]
pub struct GridRegion {
    /// The outer ring counter-clockwise, holes clockwise.
    rings: Vec<Vec<DVec2>>,
    cells: Cells,
    /// Of the whole polygon, on the lattice and off it.
    area_cells: f64,
}

/// A rectangle of cells, by the columns and rows of their south-west posts.
#[derive(Clone, Debug)]
struct Cells {
    columns: Range<u32>,
    rows: Range<u32>,
}

/// One of the two triangles of a cell, named after the corner with its right angle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Half {
    /// South-east of a rising diagonal.
    SouthEast,
    /// North-west of a rising diagonal.
    NorthWest,
    /// South-west of a falling diagonal.
    SouthWest,
    /// North-east of a falling diagonal.
    NorthEast,
}

/// What a polygon leaves of one of the finest triangles.
#[derive(Clone, Copy, Debug)]
pub struct TrianglePiece<'a> {
    /// The cell, by its south-west post.
    pub cell: Post,
    /// Which of its triangles.
    pub half: Half,
    /// A ring within the triangle, from the cell's south-west corner in cells; its signed fan is what counts, see
    /// [`TrianglePiece::fan`].
    pub ring: &'a [DVec2],
    /// Whether it is the whole triangle.
    pub extent: PieceExtent,
}

/// How much of a triangle a piece is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PieceExtent {
    /// All of it.
    Whole,
    /// Some of it, or some of a hole in it.
    Part,
}

impl Half {
    /// The halves of a cell.
    pub fn of_cell(cell: Post) -> [Self; 2] {
        match Diagonal::of_cell(u64::from(cell.column), u64::from(cell.row)) {
            Diagonal::Rising => [Self::SouthEast, Self::NorthWest],
            Diagonal::Falling => [Self::SouthWest, Self::NorthEast],
        }
    }

    /// Its corners in the cell, counter-clockwise.
    pub fn corners(self) -> [DVec2; 3] {
        let [sw, se, nw, ne] = [DVec2::ZERO, DVec2::X, DVec2::Y, DVec2::ONE];
        match self {
            Self::SouthEast => [sw, se, ne],
            Self::NorthWest => [sw, ne, nw],
            Self::SouthWest => [sw, se, nw],
            Self::NorthEast => [se, ne, nw],
        }
    }

    /// The height of its plane at a position in the cell, from the cell's corner heights (south-west, south-east,
    /// north-west, north-east); NaN where one of its own corners is.
    pub fn height(self, [sw, se, nw, ne]: [f64; 4], at: DVec2) -> f64 {
        match self {
            Self::SouthEast => sw + (se - sw) * at.x + (ne - se) * at.y,
            Self::NorthWest => sw + (ne - nw) * at.x + (nw - sw) * at.y,
            Self::SouthWest => sw + (se - sw) * at.x + (nw - sw) * at.y,
            Self::NorthEast => ne - (ne - nw) * (1.0 - at.x) - (ne - se) * (1.0 - at.y),
        }
    }

    /// How far a position in the cell lies on this half's side of the diagonal.
    fn side(self, at: DVec2) -> f64 {
        match self {
            Self::SouthEast => at.x - at.y,
            Self::NorthWest => at.y - at.x,
            Self::SouthWest => 1.0 - at.x - at.y,
            Self::NorthEast => at.x + at.y - 1.0,
        }
    }
}

impl TrianglePiece<'_> {
    /// Triangles whose signed areas add up to the piece: three corners and the area in cells, negative for what must be
    /// taken away.
    pub fn fan(&self) -> impl Iterator<Item = ([DVec2; 3], f64)> + '_ {
        let first = self.ring.first().copied().unwrap_or_default();
        self.ring.windows(2).skip(1).map(move |pair| {
            let corners = [first, pair[0], pair[1]];
            (corners, (pair[0] - first).perp_dot(pair[1] - first) * 0.5)
        })
    }
}

impl GridRegion {
    /// The polygon whose outer ring and holes, in map coordinates and either way round, do not cross themselves or each
    /// other.
    ///
    /// # Errors
    /// See [`RegionError`].
    pub fn new(lattice: &Lattice, rings: &[Vec<DVec2>]) -> Result<Self, RegionError> {
        let to_grid = |at: &DVec2| lattice.grid_at(*at - lattice.origin());
        let mut oriented = Vec::with_capacity(rings.len());
        for (index, ring) in rings.iter().enumerate() {
            let mut ring: Vec<DVec2> = ring.iter().map(to_grid).collect();
            if ring.len() < 3 {
                return Err(RegionError::TooFew(index));
            }
            if !ring.iter().all(|at| at.is_finite()) {
                return Err(RegionError::NotFinite(index));
            }
            if (signed_area(&ring) > 0.0) != (index == 0) {
                ring.reverse();
            }
            oriented.push(ring);
        }
        if oriented.is_empty() {
            return Err(RegionError::TooFew(0));
        }
        let area_cells = oriented.iter().map(|ring| signed_area(ring)).sum();
        let last = DVec2::new(f64::from(lattice.columns() - 1), f64::from(lattice.rows() - 1));
        let bounds = polygon::bounds(&oriented[0]);
        let low = bounds.min.clamp(DVec2::ZERO, last).floor().as_uvec2();
        let high = bounds.max.clamp(DVec2::ZERO, last).ceil().as_uvec2();
        Ok(Self { rings: oriented, cells: Cells { columns: low.x..high.x, rows: low.y..high.y }, area_cells })
    }

    /// All cells of a lattice.
    pub fn whole(lattice: &Lattice) -> Self {
        let (columns, rows) = (lattice.columns() - 1, lattice.rows() - 1);
        let (east, north) = (f64::from(columns), f64::from(rows));
        let corners = [(0.0, 0.0), (east, 0.0), (east, north), (0.0, north)].map(DVec2::from);
        Self {
            rings: vec![corners.into()],
            cells: Cells { columns: 0..columns, rows: 0..rows },
            area_cells: east * north,
        }
    }

    /// Its area in cells, on the lattice and off it.
    pub fn area_cells(&self) -> f64 {
        self.area_cells
    }

    /// Whether a grid position lies in it or on its border.
    pub fn holds(&self, at: DVec2) -> bool {
        let on = |(from, to): (DVec2, DVec2)| {
            (to - from).perp_dot(at - from) == 0.0 && (from - at).dot(to - at) <= 0.0
        };
        polygon::contains(self.rings.iter().map(Vec::as_slice), at)
            || self.rings.iter().flat_map(|ring| polygon::edges(ring)).any(on)
    }

    /// Adds every piece up: one sum for each band of rows from the south, in order, each made by `add` from its default.
    pub fn fold<T: Default + Send>(&self, add: impl Fn(&mut T, TrianglePiece<'_>) + Sync) -> Vec<T> {
        let Range { start, end } = self.cells.rows.clone();
        let bands: Vec<u32> = (start..end).step_by(BAND as usize).collect();
        let sum_of = |first: u32| {
            let rows = first..end.min(first + BAND);
            let cells = Cells { columns: self.cells.columns.clone(), rows };
            let mut sum = T::default();
            visit(clipped_to(&self.rings, &cells), cells, &mut |piece| add(&mut sum, piece));
            sum
        };
        bands.into_par_iter().map(sum_of).collect()
    }
}

fn signed_area(ring: &[DVec2]) -> f64 {
    // From a vertex of its own: far from the origin, doubled areas would cancel away.
    let origin = ring.first().copied().unwrap_or_default();
    ring.windows(2).map(|pair| (pair[0] - origin).perp_dot(pair[1] - origin)).sum::<f64>() * 0.5
}

impl Cells {
    fn corners(&self) -> (DVec2, DVec2) {
        let at = |column: u32, row: u32| DVec2::new(f64::from(column), f64::from(row));
        (at(self.columns.start, self.rows.start), at(self.columns.end, self.rows.end))
    }

    /// Whether the rings leave nothing of it out.
    fn is_filled(&self, rings: &[Vec<DVec2>]) -> bool {
        let (low, high) = self.corners();
        let on_border = |at: &DVec2| at.x == low.x || at.x == high.x || at.y == low.y || at.y == high.y;
        let size = high - low;
        rings.iter().flatten().all(on_border)
            && rings.iter().map(|ring| signed_area(ring)).sum::<f64>() >= size.x * size.y * (1.0 - FULL)
    }

    /// Its two halves, cut across the longer side, and where: on which axis, at which line of posts.
    fn halves(&self) -> ([Self; 2], usize, f64) {
        let Self { columns, rows } = self.clone();
        if columns.len() >= rows.len() {
            let middle = columns.start + (columns.end - columns.start) / 2;
            let west = Self { columns: columns.start..middle, rows: rows.clone() };
            ([west, Self { columns: middle..columns.end, rows }], 0, f64::from(middle))
        } else {
            let middle = rows.start + (rows.end - rows.start) / 2;
            let south = Self { columns: columns.clone(), rows: rows.start..middle };
            ([south, Self { columns, rows: middle..rows.end }], 1, f64::from(middle))
        }
    }
}

/// Visits the pieces of rings that lie within `cells`.
fn visit(rings: Vec<Vec<DVec2>>, cells: Cells, add: &mut impl FnMut(TrianglePiece<'_>)) {
    if rings.is_empty() || cells.columns.is_empty() || cells.rows.is_empty() {
        return;
    }
    if cells.is_filled(&rings) {
        visit_whole(&cells, add);
    } else if cells.columns.len() == 1 && cells.rows.len() == 1 {
        let cell = Post { column: cells.columns.start, row: cells.rows.start };
        rings.iter().for_each(|ring| visit_cell(ring, cell, add));
    } else {
        let ([first, second], axis, line) = cells.halves();
        visit(clipped(&rings, axis, line, LineSide::Below), first, add);
        visit(clipped(&rings, axis, line, LineSide::Above), second, add);
    }
}

fn visit_whole(cells: &Cells, add: &mut impl FnMut(TrianglePiece<'_>)) {
    for row in cells.rows.clone() {
        for column in cells.columns.clone() {
            let cell = Post { column, row };
            for half in Half::of_cell(cell) {
                add(TrianglePiece { cell, half, ring: &half.corners(), extent: PieceExtent::Whole });
            }
        }
    }
}

/// The pieces that a ring within one cell leaves of its two triangles.
fn visit_cell(ring: &[DVec2], cell: Post, add: &mut impl FnMut(TrianglePiece<'_>)) {
    let corner = DVec2::new(f64::from(cell.column), f64::from(cell.row));
    let local: Vec<DVec2> = ring.iter().map(|&at| at - corner).collect();
    for half in Half::of_cell(cell) {
        let piece = clip(&local, |at| half.side(at), |at| at);
        if piece.len() >= 3 {
            add(TrianglePiece { cell, half, ring: &piece, extent: PieceExtent::Part });
        }
    }
}

/// Which side of a line of posts is kept.
#[derive(Clone, Copy)]
enum LineSide {
    Below,
    Above,
}

/// What of the rings lies in a rectangle of cells.
fn clipped_to(rings: &[Vec<DVec2>], cells: &Cells) -> Vec<Vec<DVec2>> {
    let (low, high) = cells.corners();
    let mut kept = clipped(rings, 0, low.x, LineSide::Above);
    kept = clipped(&kept, 0, high.x, LineSide::Below);
    kept = clipped(&kept, 1, low.y, LineSide::Above);
    clipped(&kept, 1, high.y, LineSide::Below)
}

/// What of the rings lies on one side of a line of posts; where they cross it, they end exactly on it.
fn clipped(rings: &[Vec<DVec2>], axis: usize, line: f64, side: LineSide) -> Vec<Vec<DVec2>> {
    let sign = match side {
        LineSide::Below => -1.0,
        LineSide::Above => 1.0,
    };
    let snap = |mut at: DVec2| {
        at[axis] = line;
        at
    };
    let kept = rings.iter().map(|ring| clip(ring, |at| (at[axis] - line) * sign, snap));
    kept.filter(|ring| ring.len() >= 3).collect()
}

/// What of a ring lies where `side` is not negative; new vertices go through `snap`.
fn clip(ring: &[DVec2], side: impl Fn(DVec2) -> f64, snap: impl Fn(DVec2) -> DVec2) -> Vec<DVec2> {
    let mut kept = Vec::with_capacity(ring.len() + 4);
    let Some(&last) = ring.last() else { return kept };
    let (mut before, mut side_before) = (last, side(last));
    for &here in ring {
        let side_here = side(here);
        if (side_before < 0.0) != (side_here < 0.0) {
            // Not `lerp`, whose two products round: what both ends have in common must stay as it is.
            let part = side_before / (side_before - side_here);
            kept.push(snap(before.lerp_monotonic(here, part)));
        }
        if side_here >= 0.0 {
            kept.push(here);
        }
        (before, side_before) = (here, side_here);
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    fn level(columns: u32, rows: u32) -> Lattice {
        let heights = vec![0.0; (columns * rows) as usize];
        Lattice::new(DVec2::new(100.0, 200.0), DVec2::new(2.0, 3.0), columns, heights).expect("sound")
    }

    fn area_of(region: &GridRegion) -> f64 {
        region
            .fold(|sum: &mut f64, piece| *sum += piece.fan().map(|(_, area)| area).sum::<f64>())
            .iter()
            .sum()
    }

    fn star(center: DVec2, reach: f64, count: u32) -> Vec<DVec2> {
        let vertex = |index: u32| {
            let angle = f64::from(index) * std::f64::consts::TAU / f64::from(count);
            let reach = if index.is_multiple_of(2) { reach } else { reach * 0.4 };
            center + DVec2::new(libm::cos(angle), libm::sin(angle)) * reach
        };
        (0..count).map(vertex).collect()
    }

    #[test]
    fn the_pieces_of_a_star_with_a_hole_add_up_to_its_area_either_way_round() {
        let lattice = level(200, 300);
        let center = DVec2::new(300.0, 650.0);
        let mut rings = vec![star(center, 190.0, 30), star(center, 50.0, 12)];
        for _ in 0..2 {
            let region = GridRegion::new(&lattice, &rings).expect("sound");
            let exact = polygon::doubled_area(&rings[0]).abs() - polygon::doubled_area(&rings[1]).abs();
            assert!((area_of(&region) - exact / 2.0 / 6.0).abs() < 1e-8);
            assert!((region.area_cells() - exact / 2.0 / 6.0).abs() < 1e-8);
            rings.iter_mut().for_each(|ring| ring.reverse());
        }
    }

    #[test]
    fn every_piece_lies_in_its_triangle_and_whole_ones_are_not_repeated() {
        let lattice = level(40, 40);
        let rings = [star(DVec2::new(140.0, 260.0), 37.0, 14)];
        let region = GridRegion::new(&lattice, &rings).expect("sound");
        let found = region.fold(|found: &mut Vec<(Post, Half, PieceExtent)>, piece| {
            for &at in piece.ring {
                let slack = piece.half.side(at).min(at.min_element()).min(1.0 - at.max_element());
                assert!(slack >= -1e-9, "{at} in {:?}", piece.half);
            }
            found.push((piece.cell, piece.half, piece.extent));
        });
        let whole: Vec<_> =
            found.concat().into_iter().filter(|found| found.2 == PieceExtent::Whole).collect();
        assert!(whole.len() > 100);
        for (index, one) in whole.iter().enumerate() {
            assert!(!whole[index + 1..].contains(one), "{one:?} twice");
        }
    }

    #[test]
    fn what_lies_off_the_lattice_gives_no_pieces() {
        let lattice = level(11, 11);
        let square = |low: (f64, f64), high: (f64, f64)| {
            [(low.0, low.1), (high.0, low.1), (high.0, high.1), (low.0, high.1)].map(DVec2::from).to_vec()
        };
        let half = GridRegion::new(&lattice, &[square((90.0, 215.0), (110.0, 300.0))]).expect("sound");
        assert_eq!(area_of(&half), 5.0 * 5.0);
        let none = GridRegion::new(&lattice, &[square((0.0, 0.0), (90.0, 90.0))]).expect("sound");
        assert_eq!(area_of(&none), 0.0);
        assert_eq!(area_of(&GridRegion::whole(&lattice)), 100.0);
        let all = GridRegion::new(&lattice, &[square((-1e6, -1e6), (1e6, 1e6))]).expect("sound");
        assert_eq!(area_of(&all), 100.0);
    }

    #[test]
    fn rings_that_enclose_nothing_are_refused() {
        let lattice = level(3, 3);
        assert_eq!(GridRegion::new(&lattice, &[]).err(), Some(RegionError::TooFew(0)));
        let two = vec![DVec2::ZERO, DVec2::ONE];
        assert_eq!(GridRegion::new(&lattice, &[two]).err(), Some(RegionError::TooFew(0)));
        let infinite = vec![DVec2::ZERO, DVec2::ONE, DVec2::INFINITY];
        assert_eq!(GridRegion::new(&lattice, &[infinite]).err(), Some(RegionError::NotFinite(0)));
    }

    #[test]
    fn a_half_s_plane_goes_through_its_corners() {
        let corners = [3.0, 5.0, 11.0, 20.0];
        for half in [Half::SouthEast, Half::NorthWest, Half::SouthWest, Half::NorthEast] {
            for at in half.corners() {
                let post = at.x as usize + 2 * at.y as usize;
                assert_eq!(half.height(corners, at), corners[post], "{half:?} at {at}");
            }
        }
    }
}
