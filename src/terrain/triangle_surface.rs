//! The contract between what is displayed and what lies on it.

use glam::{DVec3, Vec3};

use crate::geom::rect::Rect;

/// One displayed triangle in world space, counter-clockwise seen from above.
pub type SurfaceTriangle = [Vec3; 3];

/// A displayed ground surface: triangles that meet edge to edge, one above every covered point.
pub trait TriangleSurface: Send + Sync {
    /// Calls `visit` with every displayed triangle that meets the world rectangle; may add a few that do not.
    fn visit_facets(&self, rect: &Rect, visit: &mut dyn FnMut(&SurfaceTriangle));

    /// World Z of the displayed surface at a world position; `None` where nothing is displayed.
    fn displayed_z(&self, at: glam::DVec2) -> Option<f64> {
        let mut found = None;
        self.visit_facets(&Rect { min: at, max: at }, &mut |facet| {
            if found.is_none() && facet_contains(facet, at) {
                found = Some(plane_z(facet, at));
            }
        });
        found
    }
}

/// Whether the plan position lies in the triangle or on its border.
pub fn facet_contains(facet: &SurfaceTriangle, at: glam::DVec2) -> bool {
    let corners = facet.map(|corner| corner.truncate().as_dvec2());
    (0..3).all(|side| {
        let (from, to) = (corners[side], corners[(side + 1) % 3]);
        (to - from).perp_dot(at - from) >= 0.0
    })
}

/// World Z of the triangle's plane at a plan position. The triangle must have a plan area.
pub fn plane_z(facet: &SurfaceTriangle, at: glam::DVec2) -> f64 {
    let [a, b, c]: [DVec3; 3] = facet.map(Vec3::as_dvec3);
    let normal = (b - a).cross(c - a);
    a.z - (normal.x * (at.x - a.x) + normal.y * (at.y - a.y)) / normal.z
}
