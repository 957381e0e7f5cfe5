//! Footings: walls that extend a building's own down to the displayed ground where that is lower than the true ground.
//!
//! A building's own walls end a little below the lowest ground under it. Far away the ground is displayed more coarsely,
//! and may lie lower still; there its walls go on down to it, so that no building floats at any level of detail.

use glam::DVec2;

use crate::faces::Faces;
use sandtable_draw::color::Srgba;
use sandtable_geom::polygon;
use sandtable_geom::rect::Rect;
use sandtable_terrain::support_surface::ground_runs;
use sandtable_terrain::triangle_surface::TriangleSurface;

/// The foot of a building's walls.
#[derive(Clone, Debug, PartialEq)]
pub struct WallFooting {
    /// The outer ring counter-clockwise and the courtyards clockwise, world X and Y.
    pub rings: Vec<Vec<DVec2>>,
    /// World Z at which the building's own walls end.
    pub foot_z: f32,
    /// The walls' color.
    pub color: Srgba,
}

impl WallFooting {
    /// Adds walls from where the building's own end down to the lowest displayed ground along them to `faces`; nothing
    /// where the ground is nowhere lower.
    pub fn build(&self, ground: &dyn TriangleSurface, faces: &mut Faces) {
        // One look at all triangles near it settles it for nearly every building.
        let around = Rect::around(self.rings.iter().flatten().copied());
        let mut lowest = f32::INFINITY;
        ground.visit_facets(&around, &mut |facet| {
            lowest = facet.iter().map(|corner| corner.z).fold(lowest, f32::min);
        });
        if lowest >= self.foot_z {
            return;
        }
        for ring in &self.rings {
            let lowest = polygon::edges(ring)
                .flat_map(|(from, to)| ground_runs(ground, from, to))
                .flat_map(|run| run.values().iter().copied().reduce(f64::min))
                .fold(f64::INFINITY, f64::min) as f32;
            if lowest < self.foot_z {
                faces.walls(ring, (lowest, self.foot_z), self.color);
            }
        }
    }
}
