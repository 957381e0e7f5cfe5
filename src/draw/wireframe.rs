//! Wireframe: the edges of triangles as thin dark lines over the surface, as papers on terrain show their meshes.
//!
//! A pixel on an edge is a little of each of the two triangles that meet there, and both find the same distance of its center
//! from their edge. The line is therefore whole and smooth, and needs no look at neighbors. Where triangles are a few pixels high their edges would
//! blacken the ground; there they fade.

use glam::Vec3;

use crate::color::Srgba;

/// The color of lines; its alpha is how much of the ground a line hides.
pub const LINE: Srgba = Srgba([24, 24, 30, 200]);

/// The width of a line in pixels: thinner ones break up, wider ones hide small triangles.
pub const WIDTH_PX: f32 = 1.0;

/// Triangles this many pixels high show no edges, and as high as the second whole ones.
pub const FADE_PX: [f32; 2] = [2.0, 7.0];

/// The share of a pixel that the edges of its triangle cover, 0..=1; by the distances of the pixel's center from the
/// three edges, and the triangle's heights over them, in pixels.
pub fn edge_cover(from_edges_px: Vec3, heights_px: Vec3) -> f32 {
    let [none, all] = FADE_PX;
    let shown = ((heights_px.min_element() - none) / (all - none)).clamp(0.0, 1.0);
    (WIDTH_PX * 0.5 + 0.5 - from_edges_px.min_element()).clamp(0.0, 1.0) * shown
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_triangles_that_meet_draw_a_line_of_its_width() {
        let half: f32 =
            (0..100).map(|step| edge_cover(Vec3::new(step as f32 * 0.02, 9.0, 9.0), Vec3::splat(20.0))).sum();
        assert!((half * 0.02 - 0.5 * WIDTH_PX).abs() < 0.05, "{half}");
    }

    #[test]
    fn edges_of_small_triangles_fade() {
        let cover = |height_px| edge_cover(Vec3::new(0.0, 1.0, 1.0), Vec3::new(50.0, 50.0, height_px));
        assert_eq!([cover(1.0), cover(7.0)], [0.0, 1.0]);
        assert!((0.3..0.7).contains(&cover(4.5)), "{}", cover(4.5));
    }
}
