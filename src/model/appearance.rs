//! The change in appearance of a surface: of color, normal and texture coordinates, measured as lengths.

use glam::{Vec2, Vec3, Vec4};

use sandtable_draw::list::DrawVertex;

/// The weight of a change from black to white, relative to the length over which it moves: as much as moving its middle
/// by half that length.
const COLOR_WEIGHT: f64 = 0.5;

/// The weight of a change of a normal by a right angle, relative to the length over which it moves: on a smooth ball,
/// appearance then counts about as much as shape.
const NORMAL_WEIGHT: f64 = 0.1;

/// The difference in appearance between `expected` and a point of a triangle with these barycentric weights, in the
/// model's units. Colors and normals count as if they had moved over `reach`; texture coordinates count as the distance
/// that they have moved on the triangle.
pub(super) fn difference(
    expected: &DrawVertex,
    corners: [&DrawVertex; 3],
    weights: [f64; 3],
    reach: f64,
) -> f64 {
    let weights = weights.map(|weight| weight as f32);
    let mean = |value: &dyn Fn(&DrawVertex) -> Vec4| {
        corners.iter().zip(weights).fold(Vec4::ZERO, |sum, (corner, weight)| sum + value(corner) * weight)
    };
    let change = |value: &dyn Fn(&DrawVertex) -> Vec4| f64::from((mean(value) - value(expected)).length());
    let color = change(&|vertex| Vec4::from(vertex.color.0.map(|channel| f32::from(channel) / 255.0)));
    let normal = change(&|vertex| Vec3::from(vertex.normal).extend(0.0));
    let uv = change(&|vertex| Vec2::from(vertex.uv).extend(0.0).extend(0.0));
    let moved = if uv > 0.0 { uv * length_per_uv(corners) } else { 0.0 };
    (color * COLOR_WEIGHT + normal * NORMAL_WEIGHT) * reach + moved
}

/// Units of the model per unit of texture coordinates; 0 where all corners have the same texture coordinates.
fn length_per_uv(corners: [&DrawVertex; 3]) -> f64 {
    let [a, b, c] = corners.map(|corner| Vec3::from(corner.position));
    let [ua, ub, uc] = corners.map(|corner| Vec2::from(corner.uv));
    let area = (b - a).cross(c - a).length();
    let area_uv = (ub - ua).perp_dot(uc - ua).abs();
    if area_uv > 0.0 { f64::from((area / area_uv).sqrt()) } else { 0.0 }
}
