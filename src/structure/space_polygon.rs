//! Polygons with holes anywhere in space, cut into triangles.
//!
//! A polygon is projected along its normal (Newell 1972) and cut there by ear clipping; the triangles keep its vertices,
//! so that one that is not quite flat stays closed with its neighbors.

use std::collections::BTreeMap;

use glam::{DVec2, DVec3};

use sandtable_geom::polygon::triangulate;

/// The most vertices of a polygon that is cut: the time of ear clipping grows with their square at worst.
pub const MOST_VERTICES: usize = 4096;

/// The triangles of a polygon as triples of positions in its rings laid end to end, counter-clockwise where its outer
/// ring is; none of one without area or with more than [`MOST_VERTICES`] vertices.
pub fn triangles(rings: &[Vec<DVec3>]) -> Vec<[usize; 3]> {
    let vertices: Vec<DVec3> = rings.iter().flatten().copied().collect();
    let Some(&origin) = vertices.first() else { return Vec::new() };
    let outer = &rings[0];
    let next = outer.iter().cycle().skip(1);
    let normal: DVec3 = outer.iter().zip(next).map(|(a, b)| (*a - origin).cross(*b - origin)).sum();
    let Some(normal) = normal.try_normalize().filter(|_| vertices.len() <= MOST_VERTICES) else {
        return Vec::new();
    };
    if let [0, 1, 2] = (0..vertices.len()).collect::<Vec<_>>()[..] {
        return vec![[0, 1, 2]];
    }
    let (right, up) = normal.any_orthonormal_pair();
    let flat = |at: &DVec3| DVec2::new((*at - origin).dot(right), (*at - origin).dot(up));
    let planes: Vec<Vec<DVec2>> = rings.iter().map(|ring| ring.iter().map(flat).collect()).collect();
    // The cut returns positions: the vertex of each is found by its bits.
    let bits = |at: DVec2| at.to_array().map(|part| (part + 0.0).to_bits());
    let mut numbers = BTreeMap::new();
    planes.iter().flatten().enumerate().for_each(|(number, &at)| {
        numbers.entry(bits(at)).or_insert(number);
    });
    let corner = |at: DVec2| numbers.get(&bits(at)).copied();
    triangulate(&planes[0], &planes[1..])
        .into_iter()
        .filter_map(|[a, b, c]| Some([corner(a)?, corner(b)?, corner(c)?]))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DQuat;

    fn square(half: f64) -> Vec<DVec3> {
        [(-half, -half), (half, -half), (half, half), (-half, half)]
            .map(|(x, y)| DVec3::new(x, y, 0.0))
            .to_vec()
    }

    #[test]
    fn a_wall_with_a_window_keeps_its_area_and_its_side_however_it_stands() {
        let hole: Vec<DVec3> = square(1.0).into_iter().rev().collect();
        for turn in 0..8 {
            let turned = DQuat::from_axis_angle(DVec3::new(0.6, 0.0, 0.8), f64::from(turn));
            let place = |at: &DVec3| turned * *at + DVec3::new(85_000.0, 447_000.0, 12.0);
            let rings = [square(3.0), hole.clone()].map(|ring| ring.iter().map(place).collect::<Vec<_>>());
            let vertices: Vec<DVec3> = rings.iter().flatten().copied().collect();
            let areas: Vec<DVec3> = triangles(&rings)
                .into_iter()
                .map(|[a, b, c]| (vertices[b] - vertices[a]).cross(vertices[c] - vertices[a]) / 2.0)
                .collect();
            let total: f64 = areas.iter().map(|area| area.length()).sum();
            assert!((total - 32.0).abs() < 1e-6, "{total}");
            let side: DVec3 = areas.into_iter().sum();
            assert!(side.abs_diff_eq(turned * DVec3::Z * 32.0, 1e-6), "{side}");
        }
    }

    #[test]
    fn what_has_no_area_or_too_many_vertices_has_no_triangles() {
        assert!(triangles(&[]).is_empty());
        assert!(triangles(&[vec![DVec3::ZERO, DVec3::X, DVec3::X * 2.0]]).is_empty());
        let circle = |index: usize| DVec3::new(libm::cos(index as f64), libm::sin(index as f64), 0.0);
        assert!(triangles(&[(0..=MOST_VERTICES).map(circle).collect()]).is_empty());
    }
}
