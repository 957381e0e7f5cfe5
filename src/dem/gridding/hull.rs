//! The cells between the points: the convex hull of the sites, cut by the rows of cells.

use std::ops::Range;

use glam::DVec2;

use crate::gridding::linear::{CellCenters, crossing};
use crate::gridding::sites::Sites;
use sandtable_geom::convex;

/// The corners of the convex hull, counter-clockwise; the ends of the line where all sites lie on one.
pub(super) struct Hull {
    corners: Vec<DVec2>,
}

impl Hull {
    pub fn new(sites: &Sites) -> Self {
        let mut corners = convex::hull(&sites.at);
        if let (true, [first, .., last]) = (corners.is_empty(), &sites.at[..]) {
            corners = vec![*first, *last];
        }
        Self { corners }
    }

    pub fn is_flat(&self) -> bool {
        self.corners.len() < 3
    }

    /// For each row of cells, the columns whose centers lie inside or on the border; empty for rows outside.
    pub fn columns(&self, cells: &CellCenters) -> Vec<Range<usize>> {
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

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use sandtable_geom::rect::Rect;
    use sandtable_raster::cell_grid::CellGrid;

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
        let cells = CellCenters::new(&CellGrid::around(extent, 1.0).expect("a grid"), sites.origin);
        assert_eq!(hull.columns(&cells), [0..1, 0..2, 0..3, 0..4, 0..5]);
    }
}
