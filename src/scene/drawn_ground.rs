//! The ground at full resolution at displayed heights, while earthworks still change it.
//!
//! The displayed lattice is made once the heights are final; until then this surface multiplies the heights that it reads.

use glam::DVec2;

use crate::geom::rect::Rect;
use crate::terrain::full_resolution::FullResolution;
use crate::terrain::lattice::Lattice;
use crate::terrain::triangle_surface::{SurfaceTriangle, TriangleSurface};

/// The finest triangles of a lattice, their heights multiplied.
#[derive(Clone, Copy, Debug)]
pub struct DrawnGround<'a> {
    /// The heights, meters.
    pub lattice: &'a Lattice,
    /// The factor of displayed heights.
    pub exaggeration: f32,
}

impl TriangleSurface for DrawnGround<'_> {
    fn visit_facets(&self, rect: &Rect, visit: &mut dyn FnMut(&SurfaceTriangle)) {
        FullResolution { lattice: self.lattice }.visit_facets(rect, &mut |facet| {
            visit(&facet.map(|corner| corner.with_z(corner.z * self.exaggeration)));
        });
    }

    fn displayed_z(&self, at: DVec2) -> Option<f64> {
        let height_m = FullResolution { lattice: self.lattice }.displayed_z(at)?;
        Some(height_m * f64::from(self.exaggeration))
    }
}
