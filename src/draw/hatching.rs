//! Hatching: parallel lines at 45° whose pitch is constant on the picture, whatever they lie on.
//!
//! On maps hatching means that nothing is known or allowed. Its lines belong to the sheet, not to the ground: they keep
//! their distance in near and far parts of a view, so that nobody takes them for furrows.

use std::f32::consts::FRAC_1_SQRT_2;

/// The distance from line to line in pixels: less becomes a gray tone, more looks like single lines.
pub const PITCH_PX: f32 = 8.0;

/// The width of a line in pixels.
pub const WIDTH_PX: f32 = 1.1;

/// The share of a pixel at `at`, in pixels from the picture's upper left corner, that a line covers, 0..=1.
pub fn hatching_cover(at: [f32; 2]) -> f32 {
    let across = (at[0] + at[1]) * FRAC_1_SQRT_2 / PITCH_PX;
    let away_px = (across - across.floor() - 0.5).abs() * PITCH_PX;
    (WIDTH_PX / 2.0 + 0.5 - away_px).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_cover_their_share_of_the_picture_and_run_at_45_degrees() {
        let pixels = (0..200 * 200).map(|index| [(index % 200) as f32 + 0.5, (index / 200) as f32 + 0.5]);
        let share = pixels.map(hatching_cover).sum::<f32>() / 40_000.0;
        assert!((share - WIDTH_PX / PITCH_PX).abs() < 0.01, "{share}");
        for step in 0..40 {
            let along = step as f32;
            assert!(
                (hatching_cover([30.0 + along, 90.0 - along]) - hatching_cover([30.0, 90.0])).abs() < 1e-4
            );
        }
    }
}
