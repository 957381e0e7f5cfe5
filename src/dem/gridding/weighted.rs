//! Heights by distance: k nearest sites, the nearest of each quadrant, or the nearest alone.
//!
//! Weights are relative to the nearest site's, (d₀/d)^power, which gives the same mean and never overflows next to a
//! site; a center on a site takes its height.

use std::ops::Range;

use glam::DVec2;
use rayon::prelude::*;

use crate::gridding::hull::Hull;
use crate::gridding::kd::{KdTree, Near, NearestSites};
use crate::gridding::linear::CellCenters;
use crate::gridding::method::GriddingMethod;
use crate::gridding::sites::Sites;

/// Cells along the side of a tile whose cells share a search.
const TILE: usize = 8;

/// The most candidates that the cells of a tile share, for each site that a cell needs, and at least. Comparing so many
/// costs about as much as a search of the tree for each cell.
const CANDIDATES_PER_SITE: usize = 10;
const LEAST_CANDIDATES: usize = 64;

/// The factor that widens a bound on distances, against rounding.
const SLACK: f64 = 1.0 + 1e-9;

struct Tile<'a> {
    /// The first column.
    left: usize,
    /// The centers of its columns.
    x: &'a [f64],
    /// The centers of its rows.
    y: &'a [f64],
    /// For each row, the columns of the grid that lie in the hull.
    columns: &'a [Range<usize>],
}

impl Tile<'_> {
    /// The tile's part of `columns`.
    fn part(&self, columns: &Range<usize>) -> Range<usize> {
        columns.start.max(self.left)..columns.end.min(self.left + self.x.len())
    }

    /// The middle of its cells' centers, and the distance of the farthest from it.
    fn circle(&self) -> (DVec2, f64) {
        let corner = DVec2::new(self.x[0], self.y[0]);
        let opposite = DVec2::new(self.x[self.x.len() - 1], self.y[self.y.len() - 1]);
        let center = (corner + opposite) * 0.5;
        (center, center.distance(corner).max(center.distance(opposite)))
    }
}

/// Buffers that a task reuses for every tile.
struct SearchScratch {
    found: NearestSites,
    candidates: Vec<(DVec2, u32)>,
}

pub(super) struct WeightedSites<'a> {
    sites: &'a Sites,
    tree: KdTree,
    method: GriddingMethod,
}

impl<'a> WeightedSites<'a> {
    /// Sites for a method by distance; any other counts as the nearest.
    pub fn new(sites: &'a Sites, method: GriddingMethod) -> Self {
        Self { sites, tree: KdTree::new(&sites.at), method }
    }

    /// Sets every cell in the hull to its height; other cells stay.
    pub fn fill(&self, hull: &Hull, cells: &CellCenters, out: &mut [f64]) {
        let columns = hull.columns(cells);
        let width = cells.x.len();
        if let GriddingMethod::Quadrant { power } = self.method {
            out.par_chunks_mut(width).zip(&cells.y).zip(columns).for_each(|((row, &y), columns)| {
                for column in columns {
                    row[column] = self.by_quadrants(DVec2::new(cells.x[column], y), power);
                }
            });
            return;
        }
        let bands =
            out.par_chunks_mut(TILE * width).zip(cells.y.par_chunks(TILE)).zip(columns.par_chunks(TILE));
        bands.for_each_init(
            || SearchScratch { found: NearestSites::new(self.wanted()), candidates: Vec::new() },
            |scratch, ((out, y), columns)| {
                for left in (0..width).step_by(TILE) {
                    let x = &cells.x[left..(left + TILE).min(width)];
                    self.fill_tile(&Tile { left, x, y, columns }, width, scratch, out);
                }
            },
        );
    }

    fn wanted(&self) -> usize {
        match self.method {
            GriddingMethod::InverseDistance { k, .. } => k as usize,
            _ => 1,
        }
    }

    /// Searches the tree once for all cells of a tile, where the tile is not much larger than the search of a cell.
    fn fill_tile(&self, tile: &Tile, width: usize, scratch: &mut SearchScratch, out: &mut [f64]) {
        if tile.columns.iter().all(|columns| tile.part(columns).is_empty()) {
            return;
        }
        let SearchScratch { found, candidates } = scratch;
        let wanted = self.wanted();
        let (center, half) = tile.circle();
        self.tree.nearest_k(center, f64::INFINITY, found);
        let enough = found.near().get(wanted - 1).map_or(f64::INFINITY, |near| near.distance2.sqrt());
        // The wanted sites lie within `enough` of the center, so within `enough + half` of any cell; those that a cell
        // needs lie half a tile farther from the center at most.
        let reach = (enough + 2.0 * half) * SLACK;
        let most = LEAST_CANDIDATES.max(CANDIDATES_PER_SITE * wanted);
        let expected = wanted as f64 * (reach / enough).powi(2);
        let mut shares = expected <= most as f64 || self.sites.len() <= most;
        if shares {
            self.tree.gather(center, reach * reach, 2 * most, candidates);
            shares = candidates.len() <= 2 * most;
        }
        for (row, (&y, columns)) in tile.y.iter().zip(tile.columns).enumerate() {
            let mut limit2 = f64::INFINITY;
            for column in tile.part(columns) {
                let q = DVec2::new(tile.x[column - tile.left], y);
                if shares {
                    found.choose(q, limit2, candidates);
                } else {
                    self.tree.nearest_k(q, limit2, found);
                }
                out[row * width + column] = self.by_nearest(found);
                limit2 = match tile.x.get(column + 1 - tile.left) {
                    Some(&x) if found.near().len() == wanted => self.farthest2(found, DVec2::new(x, y)),
                    _ => f64::INFINITY,
                };
            }
        }
    }

    /// The squared distance from `q` to the farthest of the sites found: as many as are wanted lie within it.
    fn farthest2(&self, found: &NearestSites, q: DVec2) -> f64 {
        let distances2 =
            found.near().iter().map(|near| (self.sites.at[near.site as usize] - q).length_squared());
        distances2.fold(0.0, f64::max)
    }

    fn by_nearest(&self, found: &NearestSites) -> f64 {
        match self.method {
            GriddingMethod::InverseDistance { power, .. } => self.mean(found.near(), power),
            _ => found.near().first().map_or(f64::NAN, |near| self.sites.z[near.site as usize]),
        }
    }

    fn by_quadrants(&self, q: DVec2, power: f64) -> f64 {
        let mut found: Vec<Near> = self.tree.quadrants(q).into_iter().flatten().collect();
        found.sort_by(Near::order);
        self.mean(&found, power)
    }

    fn mean(&self, near: &[Near], power: f64) -> f64 {
        mean(near.iter().map(|near| (near.distance2, self.sites.z[near.site as usize])), power)
    }
}

/// The mean of heights at squared distances, nearest first; NaN for none.
fn mean(mut sites: impl Iterator<Item = (f64, f64)>, power: f64) -> f64 {
    let Some((nearest2, nearest_z)) = sites.next() else { return f64::NAN };
    if nearest2 == 0.0 {
        return nearest_z;
    }
    // Sums of differences from the nearest keep level ground level.
    let (mut sum, mut total) = (0.0, 1.0);
    for (distance2, z) in sites {
        let weight = weight(nearest2 / distance2, power);
        sum += weight * (z - nearest_z);
        total += weight;
    }
    nearest_z + sum / total
}

/// A ratio of squared distances to the power of half of `power`.
fn weight(ratio2: f64, power: f64) -> f64 {
    if power == 2.0 {
        ratio2
    } else if power == 1.0 {
        ratio2.sqrt()
    } else {
        libm::pow(ratio2, power * 0.5)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_fall_with_the_power_of_the_distance() {
        let two = |power| mean([(1.0, 0.0), (9.0, 1.0)].into_iter(), power);
        assert!((two(1.0) - 0.25).abs() < 1e-15);
        assert!((two(2.0) - 0.1).abs() < 1e-15);
        assert!((two(3.0) - 1.0 / 28.0).abs() < 1e-12);
        assert_eq!(mean([(0.0, 7.0), (1.0, 9.0)].into_iter(), 2.0), 7.0);
        assert_eq!(mean([(1e-300, 7.0), (1e-300, 9.0)].into_iter(), 3.0), 8.0);
        assert!(mean(std::iter::empty(), 2.0).is_nan());
    }
}
