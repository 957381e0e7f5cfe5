//! The finest triangles of the ground as facets: what is planned on the ground before any camera sees it, and what stands
//! where nothing is displayed, asks the ground itself in the same way as the displayed one.

use crate::geom::rect::Rect;
use crate::terrain::facets::{Facet, Facets};
use crate::terrain::lattice::{Lattice, Post};
use crate::terrain::query::pieces::Half;

/// The finest triangles of a lattice, heights drawn times `exaggeration`; those with a corner without data are left out.
#[derive(Clone, Copy, Debug)]
pub struct Finest<'a> {
    /// The heights.
    pub lattice: &'a Lattice,
    /// How many times heights are stretched.
    pub exaggeration: f32,
}

impl Finest<'_> {
    fn facet(&self, cell: Post, half: Half) -> Option<Facet> {
        let corners = half.corners().map(|corner| {
            let post = Post { column: cell.column + corner.x as u32, row: cell.row + corner.y as u32 };
            self.lattice.position(post).extend(self.lattice.height(post) * self.exaggeration)
        });
        corners.iter().all(|corner| !corner.z.is_nan()).then_some(corners)
    }
}

impl Facets for Finest<'_> {
    fn visit_facets(&self, rect: &Rect, visit: &mut dyn FnMut(&Facet)) {
        if !rect.meets(&self.lattice.extent()) {
            return;
        }
        let (low, high) = (self.lattice.grid_at(rect.min).floor(), self.lattice.grid_at(rect.max).floor());
        let span = |low: f64, high: f64, posts: u32| {
            let cell = |at: f64| at.clamp(0.0, f64::from(posts - 2)) as u32;
            cell(low)..=cell(high)
        };
        for row in span(low.y, high.y, self.lattice.rows()) {
            for column in span(low.x, high.x, self.lattice.columns()) {
                let cell = Post { column, row };
                let facets = Half::of_cell(cell).map(|half| self.facet(cell, half));
                facets.iter().flatten().for_each(&mut *visit);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::terrain::query::{Interpolation, ground_height};
    use glam::DVec2;

    #[test]
    fn its_height_is_that_of_the_planar_ground_times_the_exaggeration() {
        let heights = (0..63).map(|index| libm::sinf(index as f32 * 1.7) * 9.0).collect();
        let lattice =
            Lattice::new(DVec2::new(500.0, 700.0), DVec2::new(10.0, 20.0), 9, heights).expect("sound");
        let finest = Finest { lattice: &lattice, exaggeration: 2.0 };
        for index in 0..200 {
            let at = DVec2::new(f64::from(index * 37 % 800) / 10.0, f64::from(index * 53 % 1200) / 10.0);
            let planar = ground_height(&lattice, Interpolation::Planar, at + lattice.origin());
            let expected = planar.height_m().expect("inside") * 2.0;
            let found = finest.displayed_z(at).expect("inside");
            assert!((found - expected).abs() < 1e-4, "{found} {expected} at {at}");
        }
        assert_eq!(finest.displayed_z(DVec2::new(-1.0, 5.0)), None);
    }
}
