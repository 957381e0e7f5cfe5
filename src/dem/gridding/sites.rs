//! The points in the form that all methods use: sorted, one per position, near zero.
//!
//! Points come in any order and some twice (overlapping flight lines, a breakline through a surveyed point). Sorting
//! by x, y and z makes the results independent of the order. Coordinates become offsets from a whole-numbered
//! corner: subtracting it is exact, and circumcenters keep the digits that eastings of half a million would cost.

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use crate::gridding::error::GridError;

/// The largest coordinate: spade's limit is 2²⁰⁰, about 1.6e60.
const LARGEST: f64 = 1e60;

/// Different positions, sorted by x, then y.
pub(super) struct Sites {
    /// The map position of (0, 0).
    pub origin: DVec2,
    /// Positions, from `origin`.
    pub at: Vec<DVec2>,
    /// The height of each position: the mean of all points there.
    pub z: Vec<f64>,
    /// Points beyond the first at their position.
    pub duplicates: usize,
}

impl Sites {
    pub fn new(points: &[DVec3], vertices: &[DVec3]) -> Result<Self, GridError> {
        let is_sound = |point: &DVec3| point.abs().cmplt(DVec3::splat(LARGEST)).all();
        if let Some(point) = points.iter().chain(vertices).find(|point| !is_sound(point)) {
            return Err(GridError::Unplaceable(*point));
        }
        let low = points.iter().chain(vertices).fold(DVec2::INFINITY, |low, point| low.min(point.truncate()));
        let origin = if low.is_finite() { low.floor() } else { DVec2::ZERO };
        // Adding zero turns a negative zero into a positive one, which is the same position.
        let mut sorted: Vec<DVec3> =
            points.iter().chain(vertices).map(|&point| point - origin.extend(0.0) + 0.0).collect();
        sorted.par_sort_unstable_by(|a, b| {
            a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)).then(a.z.total_cmp(&b.z))
        });
        let mut sites = Self {
            origin,
            at: Vec::with_capacity(sorted.len()),
            z: Vec::with_capacity(sorted.len()),
            duplicates: 0,
        };
        for same in sorted.chunk_by(|a, b| a.truncate() == b.truncate()) {
            sites.at.push(same[0].truncate());
            sites.z.push(mean(same));
            sites.duplicates += same.len() - 1;
        }
        Ok(sites)
    }

    pub fn len(&self) -> usize {
        self.at.len()
    }

    /// The site at a map position; `None` where there is none.
    pub fn find(&self, at: DVec2) -> Option<usize> {
        let at = at - self.origin + 0.0;
        self.at.binary_search_by(|site| site.x.total_cmp(&at.x).then(site.y.total_cmp(&at.y))).ok()
    }
}

/// The mean height of points at one position, never outside their range.
fn mean(same: &[DVec3]) -> f64 {
    let (low, high) = (same[0].z, same[same.len() - 1].z);
    let sum: f64 = same.iter().map(|point| point.z - low).sum();
    (low + sum / same.len() as f64).min(high)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn doubles_are_counted_and_take_the_mean() {
        let points = [(7.0, 1.0, 4.0), (-2.5, 0.0, 1.0), (7.0, 1.0, 2.0), (-2.5, -0.0, 1.0)];
        let points = points.map(|(x, y, z)| DVec3::new(x, y, z));
        let sites = Sites::new(&points, &[DVec3::new(7.0, 1.0, 6.0)]).expect("finite");
        assert_eq!((sites.origin, sites.duplicates), (DVec2::new(-3.0, 0.0), 3));
        assert_eq!(sites.at, [DVec2::new(0.5, 0.0), DVec2::new(10.0, 1.0)]);
        assert_eq!(sites.z, [1.0, 4.0]);
        assert_eq!(sites.find(DVec2::new(7.0, 1.0)), Some(1));
        assert_eq!(sites.find(DVec2::new(7.0, 1.5)), None);
    }

    #[test]
    fn points_that_are_not_finite_are_refused() {
        for wrong in
            [DVec3::new(f64::NAN, 0.0, 0.0), DVec3::new(0.0, 1e80, 0.0), DVec3::new(0.0, 0.0, f64::INFINITY)]
        {
            assert!(matches!(Sites::new(&[wrong], &[]), Err(GridError::Unplaceable(_))), "{wrong}");
        }
    }
}
