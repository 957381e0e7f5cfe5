//! Triangles in space: normals and nearest points.

use glam::DVec3;

/// The normal of a counter-clockwise triangle; its length is twice the area.
pub fn normal([a, b, c]: [DVec3; 3]) -> DVec3 {
    (b - a).cross(c - a)
}

/// The barycentric weights of the point of triangle `a b c` nearest to `p`: each in 0..=1, their sum 1
/// (Ericson, "Real-Time Collision Detection", 2005, 5.1.5). Triangles without area are allowed.
pub fn nearest_weights(p: DVec3, [a, b, c]: [DVec3; 3]) -> [f64; 3] {
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let (d1, d2) = (ab.dot(ap), ac.dot(ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return [1.0, 0.0, 0.0];
    }
    let (d3, d4) = (ab.dot(p - b), ac.dot(p - b));
    if d3 >= 0.0 && d4 <= d3 {
        return [0.0, 1.0, 0.0];
    }
    let (d5, d6) = (ab.dot(p - c), ac.dot(p - c));
    if d6 >= 0.0 && d5 <= d6 {
        return [0.0, 0.0, 1.0];
    }
    let (va, vb, vc) = (d3 * d6 - d5 * d4, d5 * d2 - d1 * d6, d1 * d4 - d3 * d2);
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        let t = ratio(d1, d1 - d3);
        return [1.0 - t, t, 0.0];
    }
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        let t = ratio(d2, d2 - d6);
        return [1.0 - t, 0.0, t];
    }
    if va <= 0.0 && d4 >= d3 && d5 >= d6 {
        let t = ratio(d4 - d3, (d4 - d3) + (d5 - d6));
        return [0.0, 1.0 - t, t];
    }
    let (v, w) = (ratio(vb, va + vb + vc), ratio(vc, va + vb + vc));
    [1.0 - v - w, v, w]
}

fn ratio(part: f64, total: f64) -> f64 {
    if total > 0.0 { part / total } else { 0.0 }
}

/// The point of triangle `a b c` with these barycentric weights.
pub fn point_at([a, b, c]: [DVec3; 3], [u, v, w]: [f64; 3]) -> DVec3 {
    a * u + b * v + c * w
}

/// The distance of `p` from a triangle.
pub fn distance(p: DVec3, corners: [DVec3; 3]) -> f64 {
    point_at(corners, nearest_weights(p, corners)).distance(p)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_point_lies_in_the_face_on_an_edge_or_at_a_corner() {
        let triangle = [DVec3::ZERO, DVec3::X * 4.0, DVec3::Y * 4.0];
        for (p, nearest) in [
            (DVec3::new(1.0, 1.0, 5.0), DVec3::new(1.0, 1.0, 0.0)),
            (DVec3::new(1.0, -3.0, 1.0), DVec3::new(1.0, 0.0, 0.0)),
            (DVec3::new(-2.0, 3.0, 0.0), DVec3::new(0.0, 3.0, 0.0)),
            (DVec3::new(4.0, 4.0, 2.0), DVec3::new(2.0, 2.0, 0.0)),
            (DVec3::new(-1.0, -1.0, 0.0), DVec3::ZERO),
            (DVec3::new(9.0, -1.0, 0.0), DVec3::X * 4.0),
            (DVec3::new(0.0, 9.0, 0.0), DVec3::Y * 4.0),
        ] {
            let found = point_at(triangle, nearest_weights(p, triangle));
            assert!((found - nearest).length() < 1e-12, "{p}: {found}");
        }
    }

    #[test]
    fn a_triangle_without_area_has_a_nearest_point_too() {
        let weights = nearest_weights(DVec3::ONE, [DVec3::ZERO; 3]);
        assert!((weights.iter().sum::<f64>() - 1.0).abs() < 1e-12);
    }
}
