//! The place on the ground that names the shape of a feature.

use glam::{DVec2, DVec3};

use crate::near::MERGE_M;
use crate::world_frame::WorldFrame;
use sandtable_geom::crs::Crs;
use sandtable_geom::polygon::inner_point;
use sandtable_geom::polyline::Polyline;
use sandtable_terrain::lattice::Lattice;
use sandtable_vector::feature::{Geometry, Polygon};

/// The place on the ground that names a shape of the system `crs`, world space, displayed height; `None` where nothing of it lies on
/// ground with data.
pub fn place(shape: &Geometry, crs: &Crs, frame: &WorldFrame<'_>, lattice: &Lattice) -> Option<DVec3> {
    let extent = lattice.extent();
    let world = |points: &[DVec2]| world_points(points, crs, frame);
    let longest = |best: (DVec2, f64), next: (DVec2, f64)| if next.1 > best.1 { next } else { best };
    let on_ground = |at: DVec2| frame.ground_at(lattice, at).map(|ground| at.extend(f64::from(ground.z)));
    match shape {
        Geometry::Points(points) => {
            points.iter().find_map(|&point| frame.world(crs, point).ok().and_then(on_ground))
        }
        Geometry::Lines(lines) => {
            let lines = lines.iter().filter_map(|line| Polyline::new(world(line)?, MERGE_M));
            let pieces = lines.flat_map(|line| line.clip(&extent));
            let middles = pieces.map(|piece| (piece.at(piece.length() / 2.0), piece.length()));
            middles.reduce(longest).and_then(|(at, _)| on_ground(at))
        }
        Geometry::Polygons(polygons) => {
            let inside = |polygon: &Polygon| {
                let rings: Vec<Vec<DVec2>> =
                    polygon.rings().map(|ring| world(ring)).collect::<Option<_>>()?;
                inner_point(rings.iter().map(Vec::as_slice), &extent)
            };
            polygons.iter().filter_map(inside).reduce(longest).and_then(|(at, _)| on_ground(at))
        }
    }
}

/// Points of the system `crs` in world coordinates; `None` where one has none.
pub(super) fn world_points(points: &[DVec2], crs: &Crs, frame: &WorldFrame<'_>) -> Option<Vec<DVec2>> {
    points.iter().map(|&at| frame.world(crs, at).ok().filter(|at| at.is_finite())).collect()
}
