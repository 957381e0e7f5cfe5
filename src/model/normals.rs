//! Corner normals for files without them: flat, by smoothing group, or smooth up to a crease.
//!
//! Vertices are welded where their positions are equal in every bit: exporters split them along texture seams. A corner's
//! normal is the mean of the normals of the triangles around its vertex that it is smooth with, weighted by their angles
//! there (Thürmer and Wüthrich, "Computing vertex normals from polygonal facets", 1998), so that the way a polygon is cut
//! into triangles does not show.

use glam::Vec3;

use sandtable_geom::triangle;
use sandtable_mesh::numbering::{Numbering, weld_key};

/// The most triangles around a vertex that are compared pair by pair. Around a wider fan, such as the tip of a finely cut
/// cone, all are smooth. Bounds the time that a hostile file can take.
const MAX_FAN: usize = 256;

/// Cosine of the sharpest angle between neighbors that looks round where a file does not say: 40° keeps an octagonal
/// column angular and rounds a sphere of ten segments.
pub(super) const CREASE_COS: f32 = 0.766;

/// Which triangles around a vertex share its normal.
#[derive(Clone, Copy, Debug)]
pub(super) enum Smoothing<'a> {
    /// None.
    Flat,
    /// Those whose masks share a bit; one mask a triangle, 0 is flat.
    Groups(&'a [u32]),
    /// Those with equal numbers; one number a triangle, 0 is flat.
    Numbers(&'a [u32]),
    /// Those whose normals' angle has at least this cosine.
    Crease(f32),
}

/// Unit normals of the corners of `triangles`; +Z for a triangle without area that has no neighbor. Indices must be in
/// range, and there must be a mask or number for each triangle.
pub(super) fn corner_normals(
    positions: &[Vec3],
    triangles: &[[u32; 3]],
    smoothing: Smoothing<'_>,
) -> Vec<[Vec3; 3]> {
    let faces: Vec<Vec3> = triangles.iter().map(|&triangle| face_normal(positions, triangle)).collect();
    let is_smooth = |a: usize, b: usize| {
        a == b
            || match smoothing {
                Smoothing::Flat => false,
                Smoothing::Groups(masks) => masks[a] & masks[b] != 0,
                Smoothing::Numbers(numbers) => numbers[a] == numbers[b] && numbers[a] != 0,
                Smoothing::Crease(cos) => faces[a].dot(faces[b]) >= cos,
            }
    };
    let upright = |normal: Vec3| if normal == Vec3::ZERO { Vec3::Z } else { normal };
    let mut normals: Vec<[Vec3; 3]> = faces.iter().map(|&normal| [upright(normal); 3]).collect();
    if matches!(smoothing, Smoothing::Flat) {
        return normals;
    }
    for fan in fans(positions, triangles) {
        let is_wide = fan.len() > MAX_FAN;
        for &spoke in &fan {
            let sum: Vec3 = fan
                .iter()
                .filter(|other| is_wide || is_smooth(spoke.triangle, other.triangle))
                .take(if is_wide { MAX_FAN } else { fan.len() })
                .map(|other| faces[other.triangle] * other.angle)
                .sum();
            if let Some(normal) = sum.try_normalize() {
                normals[spoke.triangle][spoke.corner] = normal;
            }
        }
    }
    normals
}

#[derive(Clone, Copy)]
struct CornerAngle {
    triangle: usize,
    corner: usize,
    angle: f32,
}

/// The corners around every welded vertex, in the order of the vertices' first use.
fn fans(positions: &[Vec3], triangles: &[[u32; 3]]) -> Vec<Vec<CornerAngle>> {
    let mut vertices = Numbering::default();
    let mut fans: Vec<Vec<CornerAngle>> = Vec::new();
    for (triangle, &ids) in triangles.iter().enumerate() {
        let corners = ids.map(|id| positions[id as usize]);
        for (corner, &at) in corners.iter().enumerate() {
            let angle = angle_at(at, corners[(corner + 1) % 3], corners[(corner + 2) % 3]);
            let vertex = vertices.number(weld_key(at));
            if vertex.is_new {
                fans.push(Vec::new());
            }
            fans[vertex.index as usize].push(CornerAngle { triangle, corner, angle });
        }
    }
    fans
}

fn angle_at(at: Vec3, next: Vec3, last: Vec3) -> f32 {
    let cos = (next - at).normalize_or_zero().dot((last - at).normalize_or_zero());
    libm::acosf(cos.clamp(-1.0, 1.0))
}

fn face_normal(positions: &[Vec3], ids: [u32; 3]) -> Vec3 {
    triangle::normal(ids.map(|id| positions[id as usize].as_dvec3())).normalize_or_zero().as_vec3()
}

#[cfg(test)]
mod tests {
    use std::f32::consts::FRAC_1_SQRT_2;

    use super::*;

    /// A ridge along Y: two squares that meet at the top, each cut into two triangles.
    const RIDGE: [Vec3; 6] = [
        Vec3::new(-1.0, 0.0, 0.0),
        Vec3::new(-1.0, 1.0, 0.0),
        Vec3::new(0.0, 0.0, 1.0),
        Vec3::new(0.0, 1.0, 1.0),
        Vec3::new(1.0, 0.0, 0.0),
        Vec3::new(1.0, 1.0, 0.0),
    ];
    const SLOPES: [[u32; 3]; 4] = [[0, 2, 1], [2, 3, 1], [2, 4, 3], [4, 5, 3]];

    #[test]
    fn a_common_group_rounds_the_ridge() {
        let normals = corner_normals(&RIDGE, &SLOPES, Smoothing::Groups(&[1, 1, 3, 3]));
        assert!(normals[0][1].abs_diff_eq(Vec3::Z, 1e-6), "{}", normals[0][1]);
        assert!(normals[0][0].x < -0.7);
    }

    #[test]
    fn groups_without_a_common_bit_and_sharp_creases_keep_it() {
        for smoothing in [Smoothing::Groups(&[1, 1, 2, 2]), Smoothing::Crease(CREASE_COS), Smoothing::Flat] {
            let normals = corner_normals(&RIDGE, &SLOPES, smoothing);
            assert!(normals[0][1].abs_diff_eq(Vec3::new(-FRAC_1_SQRT_2, 0.0, FRAC_1_SQRT_2), 1e-6));
        }
    }

    #[test]
    fn the_cut_of_a_polygon_has_no_weight() {
        let normals = corner_normals(&RIDGE, &SLOPES, Smoothing::Crease(-1.0));
        assert!(normals[0][1].abs_diff_eq(Vec3::Z, 1e-6) && normals[1][1].abs_diff_eq(Vec3::Z, 1e-6));
    }

    #[test]
    fn a_triangle_without_area_points_up() {
        let normals = corner_normals(&[Vec3::ONE], &[[0, 0, 0]], Smoothing::Flat);
        assert_eq!(normals, [[Vec3::Z; 3]]);
    }

    #[test]
    fn a_very_wide_fan_takes_no_longer_than_it_must() {
        let rim = 60_000;
        let positions: Vec<Vec3> = std::iter::once(Vec3::Z)
            .chain((0..=rim).map(|step| {
                let (sin, cos) = libm::sincosf(step as f32 / rim as f32 * std::f32::consts::TAU);
                Vec3::new(cos, sin, 0.0)
            }))
            .collect();
        let triangles: Vec<[u32; 3]> = (1..=rim).map(|step| [0, step, step + 1]).collect();
        assert_eq!(corner_normals(&positions, &triangles, Smoothing::Crease(-1.0)).len(), rim as usize);
    }
}
