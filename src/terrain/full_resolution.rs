//! The finest triangles of the ground as a displayed surface.
//!
//! Whatever is computed on displayed triangles can be computed on these, so that pictures and reports follow one rule.

use glam::{DVec2, Vec3};

use crate::cell_triangle::CellTriangle;
use crate::lattice::{Lattice, Post};
use crate::query::{Interpolation, ground_height};
use crate::triangle_surface::{SurfaceTriangle, TriangleSurface};
use sandtable_geom::rect::Rect;

/// All triangles of a lattice, two a cell, those without data left out.
#[derive(Clone, Copy, Debug)]
pub struct FullResolution<'a> {
    /// The heights.
    pub lattice: &'a Lattice,
}

impl FullResolution<'_> {
    /// The first and the last cell that a world rectangle meets; `None` where it lies beside the lattice.
    fn cells(&self, rect: &Rect) -> Option<(Post, Post)> {
        if !rect.meets(&self.lattice.extent()) {
            return None;
        }
        let last = self.lattice.last_grid() - 1.0;
        let cell = |at: DVec2| Post::at_grid(self.lattice.grid_at(at).clamp(DVec2::ZERO, last));
        Some((cell(rect.min), cell(rect.max)))
    }

    /// The number of cells that [`TriangleSurface::visit_facets`] visits for a world rectangle.
    pub fn cell_count(&self, rect: &Rect) -> u64 {
        self.cells(rect).map_or(0, |(first, last)| {
            u64::from(last.column - first.column + 1) * u64::from(last.row - first.row + 1)
        })
    }

    /// The two triangles of a cell, counter-clockwise seen from above; Z NaN where there is no data.
    fn triangles(&self, cell: Post) -> [SurfaceTriangle; 2] {
        let corner = |east: u32, north: u32| -> Vec3 {
            let post = cell.offset(east, north);
            self.lattice.position(post).extend(self.lattice.height(post))
        };
        let corners = [corner(0, 0), corner(1, 0), corner(0, 1), corner(1, 1)];
        CellTriangle::of_cell(cell).map(|triangle| triangle.corner_indices().map(|index| corners[index]))
    }
}

impl TriangleSurface for FullResolution<'_> {
    fn visit_facets(&self, rect: &Rect, visit: &mut dyn FnMut(&SurfaceTriangle)) {
        let Some((first, last)) = self.cells(rect) else { return };
        for row in first.row..=last.row {
            for column in first.column..=last.column {
                let has_data = |facet: &&SurfaceTriangle| facet.iter().all(|corner| corner.z.is_finite());
                self.triangles(Post { column, row }).iter().filter(has_data).for_each(&mut *visit);
            }
        }
    }

    fn displayed_z(&self, at: DVec2) -> Option<f64> {
        ground_height(self.lattice, Interpolation::Planar, at + self.lattice.origin()).height_m()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::triangle_surface::{facet_contains, plane_z};
    use sandtable_geom::polygon;

    fn lattice(hole: Option<usize>) -> Lattice {
        let mut heights: Vec<f32> = (0..63).map(|index| libm::sinf(index as f32 * 0.7) * 9.0).collect();
        hole.into_iter().for_each(|hole| heights[hole] = f32::NAN);
        Lattice::new(DVec2::new(700.0, 900.0), DVec2::new(10.0, 4.0), 9, heights).expect("sound")
    }

    #[test]
    fn the_facets_are_the_planar_ground() {
        let lattice = lattice(None);
        let finest = FullResolution { lattice: &lattice };
        for step in 0..500 {
            let at = DVec2::new(f64::from(step * 37 % 799) / 10.0, f64::from(step * 53 % 239) / 10.0);
            let mut found = Vec::new();
            finest.visit_facets(&Rect { min: at, max: at }, &mut |facet| {
                if facet_contains(facet, at) {
                    found.push(plane_z(facet, at));
                }
            });
            let height = finest.displayed_z(at).expect("inside");
            assert!(!found.is_empty() && found.iter().all(|z| (z - height).abs() < 1e-5), "{at}: {found:?}");
        }
    }

    #[test]
    fn the_facets_cover_the_ground_once_except_holes() {
        for (hole, triangles) in [(None, 96), (Some(20), 96 - 8), (Some(0), 94)] {
            let lattice = lattice(hole);
            let finest = FullResolution { lattice: &lattice };
            let mut count = 0;
            finest.visit_facets(&lattice.extent().grown(50.0), &mut |facet| {
                let plan = facet.map(|corner| corner.truncate().as_dvec2());
                assert_eq!(polygon::doubled_area(&plan), 40.0);
                count += 1;
            });
            let fewer = if hole == Some(20) { count == 88 || count == 92 } else { count == triangles };
            assert!(fewer, "{hole:?}: {count}");
        }
        let lattice = lattice(None);
        let beside = Rect { min: DVec2::splat(-9.0), max: DVec2::splat(-1.0) };
        assert_eq!(FullResolution { lattice: &lattice }.cell_count(&beside), 0);
    }
}
