//! Natural neighbor interpolation (Sibson 1981) without insertions into the triangulation.
//!
//! A site at the cell's center q would take from each neighbor part of its Voronoi region; the height is the mean of
//! the neighbors' by the areas taken. The triangles that would vanish, those whose circumcircle holds q (Bowyer and
//! Watson 1981), are found by walking outward from the triangle around q. Their sides to the outside form the ring of
//! natural neighbors:
//!
//! ```text
//!        v2───────v1          C: circumcenter of a triangle that would vanish (stored)
//!       ╱ ╲   C  ╱  ╲         G: circumcenter of q and a side of the ring (new)
//!      ╱  C╲ ·q ╱ C  ╲        q's region is the polygon of the Gs; what it takes from v lies between the Gs of v's
//!    v3─────╲──╱──────v0      two sides and the Cs of the vanishing triangles at v
//! ```
//!
//! The areas need no list of neighbors. By the shoelace formula the area taken from v is half the sum, over the sides
//! p→p′ of its polygon, of p × p′. A side C→C′ across the edge ab bounds what is taken from a and, the other way
//! round, from b. So it adds (C × C′)(z_b − z_a) to the weighted sum of heights, each side C→G of the ring does the
//! same, and G→G′ at v adds (G × G′) z_v. The sum of the latter products alone is the sum of all weights. Each product
//! is taken from q, where it is small and keeps its digits.

use glam::DVec2;
use rayon::prelude::*;

use crate::gridding::error::GridError;
use crate::gridding::hull::Hull;
use crate::gridding::linear::CellCenters;
use crate::gridding::sites::Sites;
use crate::gridding::tin::Tin;
use crate::gridding::web::{OUTSIDE, delaunay, neighbors};

/// Rows a task. A task starts its walk from the first triangle, whatever thread it runs on: where a center lies on an
/// edge, the walk to it decides on which side it is taken.
const BAND_ROWS: usize = 16;

/// A center nearer to a site than this part of the extent takes its height: circles through either are then the same.
const SNAP: f64 = 1e-11;

/// A center nearer to a side of the hull than this part of the side's length lies on it.
const ON_SIDE: f64 = 1e-12;

struct SearchTriangle {
    circumcenter: DVec2,
    radius2: f64,
    corners: [u32; 3],
    /// The triangles beyond the sides from corner i to corner i + 1.
    neighbors: [u32; 3],
}

pub(super) struct Naturals {
    at: Vec<DVec2>,
    z: Vec<f64>,
    cells: Vec<SearchTriangle>,
    snap2: f64,
}

/// Sides yet to be crossed: the triangle and the side, the next in counter-clockwise order on top. A task reuses it.
type OpenSides = Vec<(u32, u8)>;

impl Naturals {
    pub fn new(sites: &Sites) -> Result<Self, GridError> {
        let web = delaunay(sites)?;
        let (tin, neighbors) = rayon::join(|| Tin::from_web(&web), || neighbors(&web));
        let cells = tin.triangles.iter().zip(neighbors).map(|(&corners, neighbors)| {
            let [a, b, c] = corners.map(|corner| tin.vertices[corner as usize].truncate());
            let from_a = circumcenter(b - a, c - a);
            SearchTriangle { circumcenter: a + from_a, radius2: from_a.length_squared(), corners, neighbors }
        });
        let high = sites.at.iter().fold(DVec2::ZERO, |high, at| high.max(*at));
        let snap = high.length() * SNAP;
        Ok(Self {
            cells: cells.collect(),
            at: tin.vertices.iter().map(|vertex| vertex.truncate()).collect(),
            z: tin.vertices.iter().map(|vertex| vertex.z).collect(),
            snap2: snap * snap,
        })
    }

    /// Sets every cell in the hull to its height; other cells stay.
    pub fn fill(&self, hull: &Hull, cells: &CellCenters, out: &mut [f64]) {
        let width = cells.x.len();
        let columns = hull.columns(cells);
        let bands = out.par_chunks_mut(BAND_ROWS * width).zip(cells.y.par_chunks(BAND_ROWS));
        let bands = bands.zip(columns.par_chunks(BAND_ROWS));
        bands.for_each_init(OpenSides::new, |open, ((out, y), columns)| {
            let mut row_start = 0;
            for ((row, &y), columns) in out.chunks_mut(width).zip(y).zip(columns) {
                let mut around = row_start;
                for (index, column) in columns.clone().enumerate() {
                    let q = DVec2::new(cells.x[column], y);
                    around = self.locate(q, around);
                    if index == 0 {
                        row_start = around;
                    }
                    row[column] = self.height(q, around, open);
                }
            }
        });
    }

    /// The triangle around `q`, or at the border nearest to it, found by walking from another toward it.
    fn locate(&self, q: DVec2, from: u32) -> u32 {
        let mut at = from;
        // But for rounding, a walk meets no triangle twice (Devillers, Pion and Teillaud 2002).
        for _ in 0..self.cells.len() {
            let cell = &self.cells[at as usize];
            let [a, b, c] = cell.corners.map(|corner| self.at[corner as usize] - q);
            let beyond =
                [(a, b), (b, c), (c, a)].iter().zip(cell.neighbors).find_map(|((from, to), neighbor)| {
                    (neighbor != OUTSIDE && from.perp_dot(*to) < 0.0).then_some(neighbor)
                });
            match beyond {
                Some(neighbor) => at = neighbor,
                None => break,
            }
        }
        at
    }

    /// The height at `q`, which lies in the triangle `around`.
    fn height(&self, q: DVec2, around: u32, sides: &mut OpenSides) -> f64 {
        let corners = self.cells[around as usize].corners;
        for corner in corners {
            if self.at[corner as usize].distance_squared(q) <= self.snap2 {
                return self.z[corner as usize];
            }
        }
        let sums = self.gather(q, around, sides);
        let height = sums.zero + sums.heights / sums.area;
        match sums.on_side {
            Some(height) => height,
            None if height.is_finite() => height.max(sums.lowest).min(sums.highest),
            None => self.planar(q, corners),
        }
    }

    /// Sums over the triangles that a site at `q` would make vanish.
    fn gather(&self, q: DVec2, around: u32, sides: &mut OpenSides) -> AreaSums {
        sides.clear();
        sides.extend([(around, 2), (around, 1), (around, 0)]);
        let mut sums = AreaSums::new(self.z[self.cells[around as usize].corners[0] as usize]);
        let mut vanishing = 1;
        while let Some((index, side)) = sides.pop() {
            let cell = &self.cells[index as usize];
            let center = cell.circumcenter - q;
            let a = cell.corners[usize::from(side)] as usize;
            let b = cell.corners[NEXT[usize::from(side)]] as usize;
            let neighbor = cell.neighbors[usize::from(side)];
            let beyond = self.cells.get(neighbor as usize).filter(|beyond| beyond.holds(q));
            if let Some(beyond) = beyond {
                sums.across(center, beyond.circumcenter - q, self.z[b] - self.z[a]);
                let back = beyond.neighbors.iter().position(|&back| back == index).unwrap_or(0);
                let [first, second] = [NEXT[back], NEXT[NEXT[back]]];
                sides.extend([(neighbor, second as u8), (neighbor, first as u8)]);
                vanishing += 1;
                if vanishing > self.cells.len() {
                    // Only rounding goes in circles.
                    sums.area = f64::NAN;
                    break;
                }
            } else {
                let (from, to) = (self.at[a] - q, self.at[b] - q);
                let along = to - from;
                if neighbor == OUTSIDE && from.perp_dot(to) <= ON_SIDE * along.length_squared() {
                    let part = (-from.dot(along) / along.length_squared()).clamp(0.0, 1.0);
                    sums.on_side = Some(self.z[a] + part * (self.z[b] - self.z[a]));
                    break;
                }
                sums.ring(center, circumcenter(from, to), self.z[a], self.z[b]);
            }
        }
        sums.close();
        sums
    }

    /// The height at `q` on the plane through three corners, or the nearest corner's where they have no area.
    fn planar(&self, q: DVec2, corners: [u32; 3]) -> f64 {
        let [a, b, c] = corners.map(|corner| self.at[corner as usize] - q);
        let z = corners.map(|corner| self.z[corner as usize]);
        let weights = [b.perp_dot(c), c.perp_dot(a), a.perp_dot(b)].map(|weight| weight.max(0.0));
        let total: f64 = weights.iter().sum();
        if total > 0.0 {
            return (weights[0] * z[0] + weights[1] * z[1] + weights[2] * z[2]) / total;
        }
        let distances2 = [a, b, c].map(|corner| corner.length_squared());
        let nearest = (0..3).min_by(|&i, &j| distances2[i].total_cmp(&distances2[j]));
        nearest.map_or(f64::NAN, |corner| z[corner])
    }
}

/// The corner after each.
const NEXT: [usize; 3] = [1, 2, 0];

impl SearchTriangle {
    fn holds(&self, q: DVec2) -> bool {
        self.circumcenter.distance_squared(q) < self.radius2
    }
}

/// The point as far from zero as from `a` and `b`; not finite where the three lie on one line.
fn circumcenter(a: DVec2, b: DVec2) -> DVec2 {
    let scale = 0.5 / a.perp_dot(b);
    let (a2, b2) = (a.length_squared(), b.length_squared());
    DVec2::new(b.y * a2 - a.y * b2, a.x * b2 - b.x * a2) * scale
}

/// The sums over the sides of all areas taken.
#[derive(Default)]
struct AreaSums {
    /// Heights are summed as differences from this one.
    zero: f64,
    /// Twice the areas times their heights.
    heights: f64,
    /// Twice the areas.
    area: f64,
    first: Option<(DVec2, f64)>,
    last: DVec2,
    lowest: f64,
    highest: f64,
    /// The height, where the center lies on a side of the hull: there the areas have no bound.
    on_side: Option<f64>,
}

impl AreaSums {
    fn new(zero: f64) -> Self {
        Self { zero, lowest: f64::INFINITY, highest: f64::NEG_INFINITY, ..Self::default() }
    }

    /// Adds a side between the areas taken from a and from b, `rise` = z_b − z_a.
    fn across(&mut self, from: DVec2, to: DVec2, rise: f64) {
        self.heights += from.perp_dot(to) * rise;
    }

    /// Adds the next side of the ring, from a to b.
    fn ring(&mut self, center: DVec2, corner: DVec2, z_a: f64, z_b: f64) {
        self.across(center, corner, z_b - z_a);
        match self.first {
            Some(_) => self.at_neighbor(corner, z_a),
            None => self.first = Some((corner, z_a)),
        }
        self.last = corner;
        self.lowest = self.lowest.min(z_a);
        self.highest = self.highest.max(z_a);
    }

    /// Adds the side of q's own region toward a neighbor.
    fn at_neighbor(&mut self, corner: DVec2, z: f64) {
        let product = self.last.perp_dot(corner);
        self.area += product;
        self.heights += product * (z - self.zero);
    }

    fn close(&mut self) {
        if let Some((corner, z)) = self.first {
            self.at_neighbor(corner, z);
        }
    }
}
