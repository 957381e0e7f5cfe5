//! The finest triangles within a polygon, whole ones and cut ones, for sums over an area.
//!
//! Over each triangle the ground is a plane, so an integral over a polygon is exact when it is the sum over what the
//! polygon leaves of each triangle. The polygon is halved along lines of posts until a part of it fills its rectangle of
//! cells, which is then taken whole, or one cell is left, whose two triangles cut it:
//!
//! ```text
//!  ┌───────┬───────┐
//!  │  ____ │__     │      a line of posts halves the rectangle; each half is clipped by that one
//!  │ /     │██\    │      line alone (Sutherland and Hodgman 1974); a full half (██) or an empty
//!  │/______│███\   │      one is not halved further
//!  └───────┴───────┘
//! ```
//!
//! A ring clipped so may run there and back along a line that cut it. Sums over the signed triangles of a fan are right
//! all the same: such stretches cancel, and so do holes, which run the other way round.
//!
//! Costs the length of the border in cells times the logarithm of its number of vertices, and one step for each whole
//! triangle.

use std::ops::Range;

use glam::DVec2;
use rayon::prelude::*;

use crate::cell_triangle::CellTriangle;
use crate::lattice::{Lattice, Post};
use sandtable_geom::polygon;

/// Rows of cells that one thread takes at a time; fixed, so that sums are the same for any number of threads.
const BAND: u32 = 64;

/// The share by which a part may fall short of its rectangle and still fill it: more than areas of a few thousand cells
/// lose to rounding, and negligible in any sum. It is applied only to parts with all vertices on the rectangle's border.
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

/// A polygon over a lattice, in grid positions.
#[derive(Clone, Debug)]
pub struct GridRegion {
    /// The outer ring counter-clockwise, holes clockwise.
    rings: Vec<Vec<DVec2>>,
    cells: CellRange,
    /// Of the whole polygon, on the lattice and off it.
    area_cells: f64,
}

/// A rectangle of cells, by the columns and rows of their south-west posts.
#[derive(Clone, Debug)]
struct CellRange {
    columns: Range<u32>,
    rows: Range<u32>,
}

/// The part of one of the finest triangles that lies in a polygon.
#[derive(Clone, Copy, Debug)]
pub struct TrianglePiece<'a> {
    /// The cell, by its south-west post.
    pub cell: Post,
    /// Which of its triangles.
    pub triangle: CellTriangle,
    /// A ring within the triangle, from the cell's south-west corner in cells; only its signed fan is meaningful, see
    /// [`TrianglePiece::fan`].
    pub ring: &'a [DVec2],
    /// Whether it is the whole triangle.
    pub extent: PieceExtent,
}

/// The extent of a piece within its triangle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PieceExtent {
    /// All of it.
    Whole,
    /// Some of it, or some of a hole in it.
    Part,
}

impl TrianglePiece<'_> {
    /// Triangles whose signed areas add up to the piece: three corners and the area in cells, negative for what must be
    /// subtracted.
    pub fn fan(&self) -> impl Iterator<Item = ([DVec2; 3], f64)> + '_ {
        polygon::fan(self.ring).map(|corners| (corners, polygon::doubled_triangle_area(corners) * 0.5))
    }

    /// Its area in cells.
    pub fn area_cells(&self) -> f64 {
        self.fan().map(|(_, area)| area).sum()
    }

    /// Whether all corners of its triangle have data, given the heights of its cell's.
    pub fn has_data(&self, corners: [f64; 4]) -> bool {
        self.triangle.corner_indices().iter().all(|&corner| !corners[corner].is_nan())
    }
}

impl GridRegion {
    /// The polygon of an outer ring and holes, in map coordinates and either way round, that do not cross themselves or
    /// each other.
    ///
    /// # Errors
    /// See [`RegionError`].
    pub fn new(lattice: &Lattice, rings: &[Vec<DVec2>]) -> Result<Self, RegionError> {
        let mut oriented = Vec::with_capacity(rings.len());
        for (index, ring) in rings.iter().enumerate() {
            let mut ring: Vec<DVec2> = ring.iter().map(|&at| lattice.grid_from_map(at)).collect();
            if ring.len() < 3 {
                return Err(RegionError::TooFew(index));
            }
            if !ring.iter().all(|at| at.is_finite()) {
                return Err(RegionError::NotFinite(index));
            }
            if (polygon::doubled_area(&ring) > 0.0) != (index == 0) {
                ring.reverse();
            }
            oriented.push(ring);
        }
        let bounds = polygon::bounds(oriented.first().ok_or(RegionError::TooFew(0))?);
        let last = lattice.last_grid();
        let low = bounds.min.clamp(DVec2::ZERO, last).floor().as_uvec2();
        let high = bounds.max.clamp(DVec2::ZERO, last).ceil().as_uvec2();
        let cells = CellRange { columns: low.x..high.x, rows: low.y..high.y };
        Ok(Self { area_cells: area(&oriented), rings: oriented, cells })
    }

    /// All cells of a lattice.
    pub fn whole(lattice: &Lattice) -> Self {
        let last = lattice.last_grid();
        let corners = [(0.0, 0.0), (last.x, 0.0), (last.x, last.y), (0.0, last.y)].map(DVec2::from);
        Self {
            rings: vec![corners.into()],
            cells: CellRange { columns: 0..lattice.columns() - 1, rows: 0..lattice.rows() - 1 },
            area_cells: last.x * last.y,
        }
    }

    /// Its area in cells, on the lattice and off it.
    pub fn area_cells(&self) -> f64 {
        self.area_cells
    }

    /// Whether a grid position lies in it or on its border.
    pub fn contains(&self, at: DVec2) -> bool {
        let is_on = |(from, to): (DVec2, DVec2)| {
            (to - from).perp_dot(at - from) == 0.0 && (from - at).dot(to - at) <= 0.0
        };
        polygon::contains(self.rings.iter().map(Vec::as_slice), at)
            || self.rings.iter().flat_map(|ring| polygon::edges(ring)).any(is_on)
    }

    /// Sums over all pieces: one sum for each band of rows from the south, in order, to which `add` adds each piece.
    pub fn fold<T: Default + Send>(&self, add: impl Fn(&mut T, TrianglePiece<'_>) + Sync) -> Vec<T> {
        let Range { start, end } = self.cells.rows.clone();
        let bands: Vec<u32> = (start..end).step_by(BAND as usize).collect();
        let sum_of = |first: u32| {
            let rows = first..end.min(first + BAND);
            let cells = CellRange { columns: self.cells.columns.clone(), rows };
            let mut sum = T::default();
            visit(clipped_to(&self.rings, &cells), cells, &mut |piece| add(&mut sum, piece));
            sum
        };
        bands.into_par_iter().map(sum_of).collect()
    }
}

/// The area within rings, holes clockwise.
fn area(rings: &[Vec<DVec2>]) -> f64 {
    rings.iter().map(|ring| polygon::doubled_area(ring) * 0.5).sum()
}

impl CellRange {
    /// Its south-west and its north-east corner.
    fn corners(&self) -> [DVec2; 2] {
        let (columns, rows) = (&self.columns, &self.rows);
        [(columns.start, rows.start), (columns.end, rows.end)]
            .map(|(column, row)| Post { column, row }.grid())
    }

    /// Whether the rings leave nothing of it out.
    fn is_filled(&self, rings: &[Vec<DVec2>]) -> bool {
        let [low, high] = self.corners();
        let on_border = |at: &DVec2| at.x == low.x || at.x == high.x || at.y == low.y || at.y == high.y;
        let size = high - low;
        rings.iter().flatten().all(on_border) && area(rings) >= size.x * size.y * (1.0 - FULL)
    }

    /// Its two halves, cut across the longer side.
    fn halves(&self) -> ([Self; 2], PostLine) {
        let middle = |range: &Range<u32>| range.start + (range.end - range.start) / 2;
        let Self { columns, rows } = self.clone();
        if columns.len() >= rows.len() {
            let middle = middle(&columns);
            let west = Self { columns: columns.start..middle, rows: rows.clone() };
            let line = PostLine { axis: 0, position: f64::from(middle) };
            ([west, Self { columns: middle..columns.end, rows }], line)
        } else {
            let middle = middle(&rows);
            let south = Self { columns: columns.clone(), rows: rows.start..middle };
            let line = PostLine { axis: 1, position: f64::from(middle) };
            ([south, Self { columns, rows: middle..rows.end }], line)
        }
    }
}

/// Visits the pieces of rings that lie within `cells`.
fn visit(rings: Vec<Vec<DVec2>>, cells: CellRange, add: &mut impl FnMut(TrianglePiece<'_>)) {
    if rings.is_empty() || cells.columns.is_empty() || cells.rows.is_empty() {
        return;
    }
    if cells.is_filled(&rings) {
        visit_whole(&cells, add);
    } else if cells.columns.len() == 1 && cells.rows.len() == 1 {
        let cell = Post { column: cells.columns.start, row: cells.rows.start };
        rings.iter().for_each(|ring| visit_cell(ring, cell, add));
    } else {
        let ([first, second], line) = cells.halves();
        visit(line.clip(&rings, LineSide::Below), first, add);
        visit(line.clip(&rings, LineSide::Above), second, add);
    }
}

fn visit_whole(cells: &CellRange, add: &mut impl FnMut(TrianglePiece<'_>)) {
    for row in cells.rows.clone() {
        for column in cells.columns.clone() {
            let cell = Post { column, row };
            for triangle in CellTriangle::of_cell(cell) {
                add(TrianglePiece { cell, triangle, ring: &triangle.corners(), extent: PieceExtent::Whole });
            }
        }
    }
}

/// Visits the pieces that a ring within one cell leaves of its two triangles.
fn visit_cell(ring: &[DVec2], cell: Post, add: &mut impl FnMut(TrianglePiece<'_>)) {
    let local: Vec<DVec2> = ring.iter().map(|&at| at - cell.grid()).collect();
    for triangle in CellTriangle::of_cell(cell) {
        let piece = clip(&local, |at| triangle.side(at), |at| at);
        if piece.len() >= 3 {
            add(TrianglePiece { cell, triangle, ring: &piece, extent: PieceExtent::Part });
        }
    }
}

/// A column (axis 0) or row (axis 1) of posts.
#[derive(Clone, Copy)]
struct PostLine {
    axis: usize,
    position: f64,
}

/// The side of a line of posts that is kept.
#[derive(Clone, Copy)]
enum LineSide {
    Below,
    Above,
}

impl PostLine {
    /// The parts of rings on one side; where they cross the line, they end exactly on it.
    fn clip(self, rings: &[Vec<DVec2>], side: LineSide) -> Vec<Vec<DVec2>> {
        let sign = match side {
            LineSide::Below => -1.0,
            LineSide::Above => 1.0,
        };
        let snap = |mut at: DVec2| {
            at[self.axis] = self.position;
            at
        };
        let distance = |at: DVec2| (at[self.axis] - self.position) * sign;
        rings.iter().map(|ring| clip(ring, distance, snap)).filter(|ring| ring.len() >= 3).collect()
    }
}

/// The parts of rings in a rectangle of cells.
fn clipped_to(rings: &[Vec<DVec2>], cells: &CellRange) -> Vec<Vec<DVec2>> {
    let [low, high] = cells.corners();
    (0..2).fold(rings.to_vec(), |rings, axis| {
        let above = PostLine { axis, position: low[axis] }.clip(&rings, LineSide::Above);
        PostLine { axis, position: high[axis] }.clip(&above, LineSide::Below)
    })
}

/// The part of a ring where `side` is not negative; new vertices go through `snap`.
fn clip(ring: &[DVec2], side: impl Fn(DVec2) -> f64, snap: impl Fn(DVec2) -> DVec2) -> Vec<DVec2> {
    let mut kept = Vec::with_capacity(ring.len() + 4);
    // Not `lerp`, whose two products round: a coordinate that both ends have in common must stay as it is.
    let cut = |before: DVec2, here: DVec2, part: f64| snap(before.lerp_monotonic(here, part));
    polygon::clip(ring, side, cut, &mut kept);
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
        region.fold(|sum: &mut f64, piece| *sum += piece.area_cells()).iter().sum()
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
    fn the_pieces_of_a_star_with_a_hole_add_up_to_its_area() {
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
    fn every_piece_lies_in_its_triangle_and_whole_ones_occur_once() {
        let lattice = level(40, 40);
        let rings = [star(DVec2::new(140.0, 260.0), 37.0, 14)];
        let region = GridRegion::new(&lattice, &rings).expect("sound");
        let found = region.fold(|found: &mut Vec<(Post, CellTriangle, PieceExtent)>, piece| {
            for &at in piece.ring {
                let slack = piece.triangle.side(at).min(at.min_element()).min(1.0 - at.max_element());
                assert!(slack >= -1e-9, "{at} in {:?}", piece.triangle);
            }
            found.push((piece.cell, piece.triangle, piece.extent));
        });
        let whole: Vec<_> =
            found.concat().into_iter().filter(|found| found.2 == PieceExtent::Whole).collect();
        assert!(whole.len() > 100);
        for (index, one) in whole.iter().enumerate() {
            assert!(!whole[index + 1..].contains(one), "{one:?} twice");
        }
    }

    #[test]
    fn there_are_no_pieces_off_the_lattice() {
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
}
