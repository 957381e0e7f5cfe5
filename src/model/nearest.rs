//! The nearest point of a triangle, and how far a surface's looks differ there.

use glam::{DVec3, Vec2, Vec3, Vec4};

use crate::draw::list::DrawVertex;

/// What a step of color from black to white counts, as a part of the length over which it moves: as much as
/// moving its middle by half that length.
const COLOR_WEIGHT: f64 = 0.5;

/// What normals at right angles count, as a part of the length over which they move. On a smooth ball it makes
/// the looks count about as much as the shape.
const NORMAL_WEIGHT: f64 = 0.1;

/// The shares of the corners at the point of triangle `a b c` nearest to `p`: each in 0..=1, together 1
/// (Ericson, "Real-Time Collision Detection", 2005, 5.1.5).
pub(super) fn nearest_shares(p: DVec3, [a, b, c]: [DVec3; 3]) -> [f64; 3] {
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
        let share = part(d1, d1 - d3);
        return [1.0 - share, share, 0.0];
    }
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        let share = part(d2, d2 - d6);
        return [1.0 - share, 0.0, share];
    }
    if va <= 0.0 && d4 >= d3 && d5 >= d6 {
        let share = part(d4 - d3, (d4 - d3) + (d5 - d6));
        return [0.0, 1.0 - share, share];
    }
    let (second, third) = (part(vb, va + vb + vc), part(vc, va + vb + vc));
    [1.0 - second - third, second, third]
}

fn part(of: f64, whole: f64) -> f64 {
    if whole > 0.0 { of / whole } else { 0.0 }
}

/// The point with these shares.
pub(super) fn blend([a, b, c]: [DVec3; 3], [first, second, third]: [f64; 3]) -> DVec3 {
    a * first + b * second + c * third
}

/// How far the looks of a triangle at `shares` are off those of `wanted`, in the model's units: colors and normals
/// as if they had moved over `reach`, texture coordinates by how far they have moved on the triangle.
pub(super) fn difference(
    wanted: &DrawVertex,
    corners: [&DrawVertex; 3],
    shares: [f64; 3],
    reach: f64,
) -> f64 {
    let shares = shares.map(|share| share as f32);
    let mean = |value: &dyn Fn(&DrawVertex) -> Vec4| {
        corners.iter().zip(shares).fold(Vec4::ZERO, |sum, (corner, share)| sum + value(corner) * share)
    };
    let off = |value: &dyn Fn(&DrawVertex) -> Vec4| f64::from((mean(value) - value(wanted)).length());
    let color = off(&|vertex| Vec4::from(vertex.color.0.map(|channel| f32::from(channel) / 255.0)));
    let normal = off(&|vertex| Vec3::from(vertex.normal).extend(0.0));
    let uv = off(&|vertex| Vec2::from(vertex.uv).extend(0.0).extend(0.0));
    let moved = if uv > 0.0 { uv * length_per_uv(corners) } else { 0.0 };
    (color * COLOR_WEIGHT + normal * NORMAL_WEIGHT) * reach + moved
}

/// Units of the model per unit of texture coordinates; 0 where the texture stands still.
fn length_per_uv(corners: [&DrawVertex; 3]) -> f64 {
    let [a, b, c] = corners.map(|corner| Vec3::from(corner.position));
    let [ua, ub, uc] = corners.map(|corner| Vec2::from(corner.uv));
    let area = (b - a).cross(c - a).length();
    let area_uv = (ub - ua).perp_dot(uc - ua).abs();
    if area_uv > 0.0 { f64::from((area / area_uv).sqrt()) } else { 0.0 }
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
            let found = blend(triangle, nearest_shares(p, triangle));
            assert!((found - nearest).length() < 1e-12, "{p}: {found}");
        }
    }

    #[test]
    fn a_triangle_without_area_has_a_nearest_point_too() {
        let shares = nearest_shares(DVec3::ONE, [DVec3::ZERO; 3]);
        assert!((shares.iter().sum::<f64>() - 1.0).abs() < 1e-12);
    }
}
