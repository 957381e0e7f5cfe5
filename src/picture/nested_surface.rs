//! The displayed ground of a picture with nested grounds, as one surface.

use std::sync::Arc;

use glam::{DVec2, Vec3};

use crate::hole::outside;
use sandtable_geom::rect::Rect;
use sandtable_roam::displayed::DisplayedTerrain;
use sandtable_terrain::triangle_surface::{SurfaceTriangle, TriangleSurface};

/// A displayed ground.
pub(super) struct SurfacePart {
    /// The ground, in a world space of its own.
    pub surface: Arc<DisplayedTerrain>,
    /// The origin of that in the world space of the whole.
    pub origin: DVec2,
}

/// Grounds, each without the part that a finer one shows.
pub(super) struct NestedSurface {
    /// The coarsest.
    pub outer: SurfacePart,
    /// The others, from the coarsest, with their rectangles.
    pub nested: Vec<(Rect, SurfacePart)>,
}

impl TriangleSurface for NestedSurface {
    fn visit_facets(&self, rect: &Rect, visit: &mut dyn FnMut(&SurfaceTriangle)) {
        let parts = std::iter::once(&self.outer).chain(self.nested.iter().map(|(_, part)| part));
        let mut holes = self.nested.iter().map(|(hole, _)| hole);
        for SurfacePart { surface, origin } in parts {
            let (hole, moved) = (holes.next(), origin.as_vec2().extend(0.0));
            let own = Rect { min: rect.min - *origin, max: rect.max - *origin };
            surface.visit_facets(&own, &mut |facet| {
                let facet = facet.map(|corner| corner + moved);
                match hole {
                    Some(hole) => {
                        outside(hole, facet, |corner| *corner, Vec3::lerp, &mut |piece| visit(piece))
                    }
                    None => visit(&facet),
                }
            });
        }
    }
}
