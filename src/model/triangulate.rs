//! Triangulates polygons in space.
//!
//! Convex polygons, which nearly all are, become fans. Others are projected along their Newell normal and cut by ear
//! clipping, which copes with polygons that cross themselves or are folded; where it gives nothing, they become fans too.

use glam::{DVec2, DVec3, Vec3};

use sandtable_geom::polygon::triangulate_ring;

/// The most corners of a polygon that is cut by ear clipping, whose time grows with their square at worst. A larger one
/// becomes a fan.
const MAX_CORNERS: usize = 512;

/// Triples of indices into `corners`, oriented like the polygon; none for fewer than three corners.
pub(super) fn triangulate(corners: &[Vec3]) -> Vec<[usize; 3]> {
    if corners.len() < 4 || corners.len() > MAX_CORNERS {
        return fan(corners.len());
    }
    let flat = project(corners);
    if is_convex(&flat) {
        return fan(corners.len());
    }
    let cut = triangulate_ring(&flat);
    if cut.is_empty() { fan(corners.len()) } else { cut }
}

fn fan(corners: usize) -> Vec<[usize; 3]> {
    (2..corners).map(|corner| [0, corner - 1, corner]).collect()
}

/// The polygon projected along its normal (Newell 1972), counter-clockwise.
fn project(corners: &[Vec3]) -> Vec<DVec2> {
    let origin = corners[0].as_dvec3();
    let points: Vec<DVec3> = corners.iter().map(|corner| corner.as_dvec3() - origin).collect();
    let next = |index: usize| points[(index + 1) % points.len()];
    let normal: DVec3 = (0..points.len()).map(|index| points[index].cross(next(index))).sum();
    let (right, up) = normal.normalize_or(DVec3::Z).any_orthonormal_pair();
    points.iter().map(|point| DVec2::new(point.dot(right), point.dot(up))).collect()
}

/// Whether no corner turns clockwise and the polygon turns once.
fn is_convex(flat: &[DVec2]) -> bool {
    let count = flat.len();
    let mut reversals = 0;
    for index in 0..count {
        let [a, b, c] = [flat[index], flat[(index + 1) % count], flat[(index + 2) % count]];
        if (b - a).perp_dot(c - b) < 0.0 {
            return false;
        }
        reversals += usize::from(((b - a).x < 0.0) != ((c - b).x < 0.0));
    }
    reversals <= 2
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An L with a corner that turns inward, whose fan from the first corner would cover what is outside.
    const ELL: [Vec3; 6] = [
        Vec3::new(2.0, 0.0, 0.0),
        Vec3::new(2.0, 1.0, 0.0),
        Vec3::new(1.0, 1.0, 0.0),
        Vec3::new(1.0, 2.0, 0.0),
        Vec3::new(0.0, 2.0, 0.0),
        Vec3::new(0.0, 0.0, 0.0),
    ];

    fn doubled_areas(corners: &[Vec3]) -> (Vec3, f32) {
        let mut sum = Vec3::ZERO;
        let mut lengths = 0.0;
        for [a, b, c] in triangulate(corners) {
            let area = (corners[b] - corners[a]).cross(corners[c] - corners[a]);
            sum += area;
            lengths += area.length();
        }
        (sum, lengths)
    }

    #[test]
    fn a_concave_polygon_keeps_its_area_in_every_position() {
        for turn in 0..4 {
            let rotation = glam::Quat::from_axis_angle(Vec3::new(0.6, 0.0, 0.8), turn as f32 * 0.7);
            let corners = ELL.map(|corner| rotation * corner * 100.0 + Vec3::new(5e3, -2e3, 80.0));
            let (sum, lengths) = doubled_areas(&corners);
            assert!((lengths - 60_000.0).abs() < 60.0, "{lengths}");
            assert!(sum.abs_diff_eq(rotation * Vec3::Z * 60_000.0, 60.0), "{sum}");
        }
    }

    #[test]
    fn a_square_is_a_fan() {
        let square = [Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1.0, 0.0), Vec3::Y];
        assert_eq!(triangulate(&square), [[0, 1, 2], [0, 2, 3]]);
    }

    #[test]
    fn points_and_lines_have_no_triangles_but_folded_polygons_do() {
        assert!(triangulate(&[Vec3::ZERO]).is_empty() && triangulate(&[Vec3::ZERO, Vec3::X]).is_empty());
        assert!(!triangulate(&[Vec3::ZERO, Vec3::X, Vec3::X, Vec3::ZERO]).is_empty());
    }
}
