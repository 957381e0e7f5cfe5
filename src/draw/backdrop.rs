//! The background of a picture: a sky, or the plain backdrop of a studio.
//!
//! With `z` the rise of a ray of unit length, the sky is `mix(haze.color, zenith, rise(z))`: the haze's color up to the
//! horizon, from there on deeper, and without a step or a bend at the horizon. The studio has no horizon: its color
//! changes evenly from the upper border of the picture to the lower one.

use glam::Vec3;

use crate::color::Srgba;
use crate::lighting::Lighting;

/// The background of a picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Backdrop {
    /// The sky over the haze of the horizon.
    #[default]
    Sky,
    /// A light gray, for a model that is seen as a whole.
    Studio,
}

impl Backdrop {
    /// The studio at the upper border of the picture: a warm gray, darker than below, as where a backdrop curves up.
    pub const STUDIO_TOP: Srgba = Srgba::opaque(222, 220, 215);
    /// The studio at the lower border.
    pub const STUDIO_BOTTOM: Srgba = Srgba::opaque(243, 241, 237);
    /// The rise, sine of the angle above the horizon, within which the sky begins to deepen: smaller shows as a line at
    /// the horizon, larger leaves a low sky colorless.
    pub const HORIZON: f32 = 0.06;
}

impl Lighting {
    /// The color of the sky in direction `ray`, which need not be of unit length.
    pub fn sky_color(&self, ray: Vec3) -> Vec3 {
        let up = ray.normalize_or_zero().z.max(0.0);
        // 1 − (1 − z)² is the deepening of a clear sky; the fraction bends it level at the horizon.
        let rise = up * (2.0 - up) * (up * (1.0 + Backdrop::HORIZON) / (up + Backdrop::HORIZON));
        self.haze.color.lerp(self.zenith, rise)
    }

    /// The color behind everything in direction `ray`, at the share `down` of the picture's height below its upper
    /// border, 0..=1; linear.
    pub fn backdrop_color(&self, ray: Vec3, down: f32) -> Vec3 {
        match self.backdrop {
            Backdrop::Sky => self.sky_color(ray),
            Backdrop::Studio => Backdrop::STUDIO_TOP.linear().lerp(Backdrop::STUDIO_BOTTOM.linear(), down),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sky_meets_the_haze_at_the_horizon_without_a_step_or_a_bend() {
        let light = Lighting::default();
        let at = |degrees: f32| {
            let angle = degrees.to_radians();
            light.sky_color(Vec3::new(0.0, libm::cosf(angle), libm::sinf(angle)))
        };
        assert_eq!(at(-10.0), light.haze.color);
        assert_eq!(at(0.0), light.haze.color);
        assert!(at(90.0).abs_diff_eq(light.zenith, 1e-6));
        let change = |degrees: f32| (at(degrees) - at(degrees + 0.1)).length();
        assert!(change(0.0) < 0.1 * change(5.0), "{} {}", change(0.0), change(5.0));
        let steps: Vec<f32> = (0..90).map(|degrees| at(degrees as f32).x).collect();
        assert!(steps.windows(2).all(|pair| pair[1] < pair[0]), "{steps:?}");
    }

    #[test]
    fn the_studio_is_the_same_in_all_directions_and_lightens_downward() {
        let light = Lighting { backdrop: Backdrop::Studio, ..Lighting::default() };
        assert_eq!(light.backdrop_color(Vec3::Z, 0.3), light.backdrop_color(-Vec3::Y, 0.3));
        assert_eq!(Srgba::from_linear(light.backdrop_color(Vec3::Y, 0.0)), Backdrop::STUDIO_TOP);
        assert_eq!(Srgba::from_linear(light.backdrop_color(Vec3::Y, 1.0)), Backdrop::STUDIO_BOTTOM);
    }
}
