//! The interface between a displayed ground and the features on it.

use glam::{DVec2, Vec3};

use sandtable_geom::convex;
use sandtable_geom::rect::Rect;

/// One displayed triangle in world space, counter-clockwise seen from above.
pub type SurfaceTriangle = [Vec3; 3];

/// A displayed ground surface: triangles that meet edge to edge, one above every covered point.
pub trait TriangleSurface: Send + Sync {
    /// Calls `visit` with every displayed triangle that meets the world rectangle; may add a few that do not.
    fn visit_facets(&self, rect: &Rect, visit: &mut dyn FnMut(&SurfaceTriangle));

    /// World Z of the displayed surface at a world position; `None` where nothing is displayed.
    fn displayed_z(&self, at: DVec2) -> Option<f64> {
        let mut z = None;
        self.visit_facets(&Rect { min: at, max: at }, &mut |facet| {
            if z.is_none() && facet_contains(facet, at) {
                z = Some(plane_z(facet, at));
            }
        });
        z
    }
}

/// The corners of a triangle in plan.
pub fn plan(facet: &SurfaceTriangle) -> [DVec2; 3] {
    facet.map(|corner| corner.truncate().as_dvec2())
}

/// Whether the plan position lies in the triangle or on its border.
pub fn facet_contains(facet: &SurfaceTriangle, at: DVec2) -> bool {
    convex::contains(&plan(facet), at)
}

/// World Z of the triangle's plane at a plan position. The triangle must have a plan area.
pub fn plane_z(facet: &SurfaceTriangle, at: DVec2) -> f64 {
    let [a, b, c] = facet.map(Vec3::as_dvec3);
    let normal = (b - a).cross(c - a);
    a.z - (normal.x * (at.x - a.x) + normal.y * (at.y - a.y)) / normal.z
}
