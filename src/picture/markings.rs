//! Markings of roads, fainter where a road is narrow on the picture.
//!
//! A line is a twentieth of its road. Where that is less than half a pixel it only grays the pavement, and where it
//! crawls along the border of pixels it sparkles. So markings lie over the plain road as a surface of their own that lets
//! more and more of it through, place by place: how wide a road is, and which way it runs, is what its texture coordinates
//! say.

use glam::{DVec2, DVec3};

use crate::line_scale::LineScale;
use sandtable_draw::list::DrawMesh;
use sandtable_mesh::sink::VertexId;

/// Markings of a road this wide, in pixels of a picture 1080 lines high, are gone, and of one as wide as the second are
/// whole. Between the two a marking is a quarter to half a pixel wide.
const FADE_PX: [f64; 2] = [5.0, 9.0];

/// The markings over a draped road; its triangles without those that show none.
pub(super) fn faded(road: &DrawMesh, scale: &LineScale<'_>) -> DrawMesh {
    let mut markings = DrawMesh { vertices: road.vertices.clone(), triangles: Vec::new() };
    for &triangle in &road.triangles {
        let alphas = alphas(road, triangle, scale);
        if alphas.iter().any(|&alpha| alpha > 0) {
            triangle
                .iter()
                .zip(alphas)
                .for_each(|(id, alpha)| markings.vertices[id.index()].color.0[3] = alpha);
            markings.triangles.push(triangle);
        }
    }
    if markings.triangles.is_empty() { DrawMesh::default() } else { markings }
}

/// How opaque markings are at the corners of a triangle.
fn alphas(road: &DrawMesh, triangle: [VertexId; 3], scale: &LineScale<'_>) -> [u8; 3] {
    let corners = triangle.map(|id| road.vertices[id.index()]);
    let at = corners.map(|corner| DVec3::from(corner.position.map(f64::from)));
    let across = corners.map(|corner| f64::from(corner.uv[0]));
    let Some(gradient) = gradient(at.map(|at| at.truncate()), across) else { return [0; 3] };
    let along = gradient.normalize_or_zero().perp();
    at.map(|at| {
        let width_px = 1.0 / (gradient.length() * scale.meters_per_px(at, along) * scale.px);
        (255.0 * share(width_px) + 0.5) as u8
    })
}

/// The share of the markings that a road shows which is so many pixels wide, of a picture 1080 lines high.
fn share(width_px: f64) -> f64 {
    let [none, all] = FADE_PX;
    ((width_px - none) / (all - none)).clamp(0.0, 1.0)
}

/// The change of a value per meter over a triangle in plan; `None` where there is none.
fn gradient([a, b, c]: [DVec2; 3], values: [f64; 3]) -> Option<DVec2> {
    let (p, q) = (b - a, c - a);
    let (s, t) = (values[1] - values[0], values[2] - values[0]);
    let gradient = DVec2::new(s * q.y - t * p.y, t * p.x - s * q.x) / p.perp_dot(q);
    (gradient.is_finite() && gradient != DVec2::ZERO).then_some(gradient)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;
    use sandtable_draw::color::Srgba;
    use sandtable_draw::list::DrawVertex;
    use sandtable_mesh::sink::MeshSink;
    use sandtable_view::camera::Camera;

    #[test]
    fn the_change_of_a_value_is_found_whichever_way_a_triangle_lies() {
        let value = |at: DVec2| 0.1 * at.x - 0.3 * at.y + 7.0;
        let corners = [DVec2::new(3.0, 1.0), DVec2::new(9.0, -4.0), DVec2::new(5.0, 20.0)];
        let found = gradient(corners, corners.map(value)).expect("a triangle");
        assert!(found.abs_diff_eq(DVec2::new(0.1, -0.3), 1e-12), "{found}");
        assert_eq!(gradient([DVec2::ZERO; 3], [0.0, 1.0, 2.0]), None);
    }

    #[test]
    fn markings_of_a_road_that_recedes_fade_little_by_little() {
        // A road 7 m wide that leads straight away from an eye above it.
        let camera = Camera::new(
            Vec3::new(0.0, -10.0, 30.0),
            Vec3::new(0.0, 400.0, 0.0),
            0.6,
            (1920, 1080),
            (0.5, 1e4),
        )
        .expect("a camera");
        let mut road = DrawMesh::default();
        let rows: Vec<[VertexId; 2]> = (0..400)
            .map(|row| {
                [0.0f32, 1.0].map(|u| {
                    let position = [7.0 * u - 3.5, 10.0 * row as f32, 0.0];
                    road.vertex(DrawVertex { position, normal: [0.0; 3], uv: [u, 0.0], color: Srgba::WHITE })
                })
            })
            .collect();
        for pair in rows.windows(2) {
            road.triangle([pair[0][0], pair[0][1], pair[1][1]]);
            road.triangle([pair[0][0], pair[1][1], pair[1][0]]);
        }
        let markings = faded(&road, &LineScale::new(&camera));
        let alphas: Vec<u8> = markings.vertices.iter().map(|vertex| vertex.color.0[3]).collect();
        let shown = &alphas[..2 * (markings.triangles.len() / 2)];
        assert_eq!(shown[0], 255);
        assert!(markings.triangles.len() < road.triangles.len(), "far away there are none");
        assert!(shown.windows(3).all(|row| row[2] <= row[0] && row[0] - row[2] < 60), "{shown:?}");
        assert!(shown.iter().filter(|alpha| (1..255).contains(*alpha)).count() > 20, "{shown:?}");
    }
}
