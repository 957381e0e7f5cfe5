//! Footprints of city objects: what their surfaces cover in plan.

use glam::{DVec2, DVec3};

use crate::cityjson::body::{CitySurface, SurfaceRole};
use sandtable_base::limits::RING_CROSSINGS;
use sandtable_geom::polygon::doubled_area;
use sandtable_geom::region;
use sandtable_geom::self_crossing::count_crossings;

/// The least share of a surface's area that it has in plan where it is not upright.
const LEVEL: f64 = 0.05;

/// Returns the polygons that surfaces cover in plan, each its rings, the outer one first, at the lowest height of the
/// surfaces that are taken: those on the ground, else those that face down, else all that are not upright.
///
/// # Errors
/// The rings cross too often to be resolved.
pub(super) fn footprint(surfaces: &[CitySurface]) -> Result<Vec<Vec<Vec<DVec3>>>, String> {
    let is_level = |surface: &&CitySurface| {
        let area = surface.doubled_area();
        area.z.abs() > LEVEL * area.length()
    };
    let level: Vec<&CitySurface> = surfaces.iter().filter(is_level).collect();
    let of = |wanted: &dyn Fn(&CitySurface) -> bool| -> Vec<&CitySurface> {
        level.iter().copied().filter(|surface| wanted(surface)).collect()
    };
    let taken = [
        of(&|surface| surface.role == Some(SurfaceRole::Ground)),
        of(&|surface| surface.doubled_area().z < 0.0 && surface.role != Some(SurfaceRole::Unseen)),
        level.clone(),
    ];
    let Some(taken) = taken.into_iter().find(|taken| !taken.is_empty()) else { return Ok(Vec::new()) };
    if let [only] = &taken[..] {
        return Ok(vec![only.rings.clone()]);
    }
    let vertices = || taken.iter().flat_map(|surface| surface.rings.iter().flatten());
    let low = vertices().map(|vertex| vertex.z).fold(f64::INFINITY, f64::min);
    let Some(origin) = vertices().next().map(|vertex| vertex.truncate()) else { return Ok(Vec::new()) };
    let flat = |ring: &Vec<DVec3>| ring.iter().map(|at| at.truncate() - origin).collect::<Vec<DVec2>>();
    let plans: Vec<Vec<Vec<DVec2>>> =
        taken.iter().map(|surface| surface.rings.iter().map(flat).collect()).collect();
    if count_crossings(plans.iter().flatten().map(Vec::as_slice), RING_CROSSINGS.count()).is_none() {
        return Err("its surfaces cross each other too often in plan".to_owned());
    }
    // Each by itself, so that all outer rings run counter-clockwise and all holes clockwise.
    let sound: Vec<Vec<DVec2>> = plans
        .iter()
        .flat_map(|rings| region::even_odd(rings.iter().map(Vec::as_slice)))
        .flat_map(|rings| {
            rings.into_iter().enumerate().map(|(number, mut ring)| {
                if (doubled_area(&ring) > 0.0) != (number == 0) {
                    ring.reverse();
                }
                ring
            })
        })
        .collect();
    let joined = region::union(sound.iter().map(Vec::as_slice));
    let lift = |ring: Vec<DVec2>| ring.into_iter().map(|at| (at + origin).extend(low)).collect();
    Ok(joined.into_iter().map(|rings| rings.into_iter().map(lift).collect()).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn surface(ring: &[(f64, f64, f64)], role: Option<SurfaceRole>) -> CitySurface {
        let ring = ring.iter().map(|&at| DVec3::from(at)).collect();
        CitySurface { rings: vec![ring], role, color: None, texture: None }
    }

    fn area(polygons: &[Vec<Vec<DVec3>>]) -> f64 {
        let flat = |ring: &Vec<DVec3>| ring.iter().map(|at| at.truncate()).collect::<Vec<_>>();
        polygons.iter().map(|rings| doubled_area(&flat(&rings[0])).abs() / 2.0).sum()
    }

    #[test]
    fn a_footprint_is_the_ground_surface_else_what_the_surfaces_cover() {
        let ground = [(0.0, 0.0, 3.0), (0.0, 4.0, 3.0), (5.0, 4.0, 3.0), (5.0, 0.0, 3.0)];
        let west = [(0.0, 0.0, 6.0), (3.0, 0.0, 7.0), (3.0, 4.0, 7.0), (0.0, 4.0, 6.0)];
        let east = [(2.0, 0.0, 7.0), (5.0, 0.0, 6.0), (5.0, 4.0, 6.0), (2.0, 4.0, 7.0)];
        let wall = [(0.0, 0.0, 3.0), (5.0, 0.0, 3.0), (5.0, 0.0, 6.0), (0.0, 0.0, 6.0)];
        let roofs = vec![surface(&west, None), surface(&east, None), surface(&wall, None)];
        let polygons = footprint(&roofs).expect("resolved");
        assert_eq!(polygons.len(), 1);
        assert!((area(&polygons) - 20.0).abs() < 1e-6, "overlaps count once: {}", area(&polygons));
        assert!(polygons[0][0].iter().all(|at| at.z == 6.0));
        let with_ground = [roofs, vec![surface(&ground, Some(SurfaceRole::Ground))]].concat();
        assert_eq!(footprint(&with_ground).expect("one")[0][0].len(), 4);
        assert!(footprint(&[surface(&wall, None)]).expect("upright").is_empty());
    }
}
