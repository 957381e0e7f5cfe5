//! Vertical exaggeration: the one factor between elevations and world Z.
//!
//! Elevations are meters, true to scale; earthworks, reports and height queries have no other. World Z is drawn: whatever
//! a scene model holds in world space has been through [`VerticalScale`]. What is built on the ground keeps its own height.

use std::ops::{Div, Mul};
use std::sync::Arc;

use glam::{DVec2, Vec3};

use sandtable_geom::rect::Rect;
use sandtable_terrain::full_resolution::FullResolution;
use sandtable_terrain::lattice::Lattice;
use sandtable_terrain::triangle_surface::{SurfaceTriangle, TriangleSurface};

/// World Z per meter of elevation, above 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VerticalScale(pub f32);

impl VerticalScale {
    /// World Z of an elevation in meters, or of a difference of elevations.
    pub fn world_z<T: From<f32> + Mul<Output = T>>(self, elevation_m: T) -> T {
        elevation_m * T::from(self.0)
    }

    /// The elevation in meters that is drawn at `world_z`.
    pub fn elevation_m<T: From<f32> + Div<Output = T>>(self, world_z: T) -> T {
        world_z / T::from(self.0)
    }

    /// The finest triangles of a lattice that earthworks still change, as they are drawn.
    pub fn ground(self, lattice: &Lattice) -> DrawnGround<'_> {
        DrawnGround { lattice, scale: self }
    }

    /// The lattice as it is drawn: `lattice` itself where that is true to scale.
    pub fn drawn(self, lattice: &Arc<Lattice>) -> Arc<Lattice> {
        if self.0 == 1.0 { Arc::clone(lattice) } else { Arc::new(lattice.stretched(self.0)) }
    }
}

/// The finest triangles of a lattice, at drawn heights.
#[derive(Clone, Copy, Debug)]
pub struct DrawnGround<'a> {
    /// The elevations, meters.
    pub lattice: &'a Lattice,
    /// Their scale.
    pub scale: VerticalScale,
}

impl DrawnGround<'_> {
    /// Its box in world space, given the lowest and the highest elevation in meters.
    pub fn bounds(&self, (low_m, high_m): (f32, f32)) -> (Vec3, Vec3) {
        let Rect { min, max } = self.lattice.extent();
        let corner = |plan: DVec2, height_m| plan.as_vec2().extend(self.scale.world_z(height_m));
        (corner(min, low_m), corner(max, high_m))
    }
}

impl TriangleSurface for DrawnGround<'_> {
    fn visit_facets(&self, rect: &Rect, visit: &mut dyn FnMut(&SurfaceTriangle)) {
        FullResolution { lattice: self.lattice }.visit_facets(rect, &mut |facet| {
            visit(&facet.map(|corner| corner.with_z(self.scale.world_z(corner.z))));
        });
    }

    fn displayed_z(&self, at: DVec2) -> Option<f64> {
        FullResolution { lattice: self.lattice }.displayed_z(at).map(|height_m| self.scale.world_z(height_m))
    }
}
