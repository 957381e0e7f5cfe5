//! Heights by distance: k nearest sites, one of each quadrant, or the nearest alone.
//!
//! Weights are taken relative to the nearest site's, (d₀/d)^power, which is the same mean and never overflows next to
//! a site; a centre on a site takes its height.

use glam::DVec2;
use rayon::prelude::*;

use crate::dem::gridding::Method;
use crate::dem::gridding::hull::Hull;
use crate::dem::gridding::kd::{Found, KdTree};
use crate::dem::gridding::linear::Positions;
use crate::dem::gridding::sites::Sites;

/// What the bound on the next cell's distances is widened by, against its rounding.
const SLACK: f64 = 1.0 + 1e-9;

/// Sites that can be asked by distance.
pub(super) struct Weighted<'a> {
    sites: &'a Sites,
    tree: KdTree,
    method: Method,
}

impl<'a> Weighted<'a> {
    /// Sites for a method that goes by distance; any other is taken as the nearest.
    pub fn new(sites: &'a Sites, method: Method) -> Self {
        Self { sites, tree: KdTree::new(&sites.at), method }
    }

    /// Gives every cell in the hull its height; other cells are left as they are.
    pub fn fill(&self, hull: &Hull, cells: &Positions, out: &mut [f64]) {
        let columns = hull.columns(cells);
        let wanted = match self.method {
            Method::InverseDistance { k, .. } => k as usize,
            _ => 1,
        };
        let rows = out.par_chunks_mut(cells.x.len()).zip(&cells.y).zip(columns);
        rows.for_each_init(|| Found::new(wanted), |found, ((row, &y), columns)| {
            // So many sites lie within this of the cell before; a cell on, it is at most a cell more.
            let mut within = f64::INFINITY;
            let mut before = 0.0;
            for (height, &x) in row[columns.clone()].iter_mut().zip(&cells.x[columns]) {
                let q = DVec2::new(x, y);
                *height = match self.method {
                    Method::Quadrant { power } => self.by_quadrants(q, power),
                    _ => {
                        self.tree.nearest_k(q, (within + (x - before)) * SLACK, found);
                        self.by_nearest(found)
                    }
                };
                before = x;
                let last = found.distances2.get(wanted - 1);
                within = last.map_or(f64::INFINITY, |distance2| distance2.sqrt());
            }
        });
    }

    fn by_nearest(&self, found: &Found) -> f64 {
        let z = |site: &u32| self.sites.z[*site as usize];
        match self.method {
            Method::InverseDistance { power, .. } => {
                mean(found.distances2.iter().copied().zip(found.sites.iter().map(z)), power)
            }
            _ => found.sites.first().map_or(f64::NAN, z),
        }
    }

    fn by_quadrants(&self, q: DVec2, power: f64) -> f64 {
        let mut found = self.tree.quadrants(q);
        found.sort_by(|a, b| match (a, b) {
            (Some(a), Some(b)) => a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)),
            (a, b) => a.is_none().cmp(&b.is_none()),
        });
        mean(found.iter().flatten().map(|&(distance2, site)| (distance2, self.sites.z[site as usize])), power)
    }
}

/// The mean of heights at squared distances, nearest first; NaN for none.
fn mean(sites: impl Iterator<Item = (f64, f64)>, power: f64) -> f64 {
    let mut sites = sites;
    let Some((nearest2, nearest_z)) = sites.next() else { return f64::NAN };
    if nearest2 == 0.0 {
        return nearest_z;
    }
    // Differences from the nearest keep a level plain level.
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
