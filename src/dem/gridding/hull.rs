//! Which cells lie between the points: the convex hull of the sites (Andrew 1979), cut by the rows of cells.

use glam::DVec2;

use crate::dem::gridding::linear::{CellCenters, crossing};
use crate::dem::gridding::sites::Sites;

/// The corners of the convex hull, counter-clockwise, none between two others on a side.
pub(super) struct Hull {
    corners: Vec<DVec2>,
}

impl Hull {
    /// The hull of the sites, which are sorted.
    pub fn new(sites: &Sites) -> Self {
        let mut corners = chain(sites.at.iter().copied());
        corners.pop();
        let back = chain(sites.at.iter().rev().copied());
        corners.extend(&back[..back.len().saturating_sub(1)]);
        Self { corners }
    }

    /// Whether it holds no area: all sites on one line.
    pub fn is_flat(&self) -> bool {
        self.corners.len() < 3
    }

    /// For each row of cells, the columns whose centers lie inside or on the border; empty for rows that pass by.
    pub fn columns(&self, cells: &CellCenters) -> Vec<std::ops::Range<usize>> {
        let mut spans = vec![(f64::INFINITY, f64::NEG_INFINITY); cells.y.len()];
        for (index, &from) in self.corners.iter().enumerate() {
            let to = self.corners[(index + 1) % self.corners.len()];
            for row in cells.rows_between(from.y.min(to.y), from.y.max(to.y)) {
                let (low, high) = crossing(from, to, cells.y[row]);
                let span = &mut spans[row];
                *span = (span.0.min(low), span.1.max(high));
            }
        }
        spans.into_iter().map(|(low, high)| cells.columns_between(low, high)).collect()
    }
}

/// The corners that a walk along sorted sites turns left at, from its first site to its last.
fn chain(sites: impl Iterator<Item = DVec2>) -> Vec<DVec2> {
    let mut corners: Vec<DVec2> = Vec::new();
    for site in sites {
        while let [.., before, last] = corners[..] {
            if (last - before).perp_dot(site - before) > 0.0 {
                break;
            }
            corners.pop();
        }
        corners.push(site);
    }
    corners
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::dem::gridding::frame::CellGrid;
    use crate::geom::rect::Rect;

    fn hull(points: &[(f64, f64)]) -> (Hull, Sites) {
        let points: Vec<DVec3> = points.iter().map(|&(x, y)| DVec3::new(x, y, 0.0)).collect();
        let sites = Sites::new(&points, &[]).expect("finite");
        (Hull::new(&sites), sites)
    }

    #[test]
    fn the_corners_of_a_square_are_its_hull() {
        let square = [(0.0, 0.0), (2.0, 0.0), (1.0, 0.0), (1.0, 1.0), (2.0, 2.0), (0.0, 2.0), (0.5, 1.5)];
        assert_eq!(hull(&square).0.corners.len(), 4);
        for flat in [&[(0.0, 0.0)][..], &[(0.0, 0.0), (1.0, 1.0)], &[(0.0, 0.0), (1.0, 1.0), (3.0, 3.0)], &[]]
        {
            assert!(hull(flat).0.is_flat(), "{flat:?}");
        }
    }

    #[test]
    fn centers_on_the_border_lie_inside() {
        let (hull, sites) = hull(&[(0.5, 0.5), (4.5, 0.5), (0.5, 4.5)]);
        let extent = Rect { min: DVec2::ZERO, max: DVec2::splat(5.0) };
        let cells = CellCenters::new(&CellGrid::around(extent, 1.0).expect("a frame"), sites.origin);
        assert_eq!(hull.columns(&cells), [0..1, 0..2, 0..3, 0..4, 0..5]);
    }
}
