//! Light, haze and sky: one formula for both renderers.
//!
//! A surface point with albedo `a`, unit normal `n`, sun visibility `s` and sky visibility `v` (both 1 where nothing is
//! in the way) shows `lit = a · (s · sun · max(n·to_sun, 0) + v · mix(bounce, sky, (n.z + 1) / 2))` and, `d` meters
//! from the eye, `mix(lit, haze.color, 1 − exp(−d / haze.distance_m))`. Where nothing is drawn, a ray with unit
//! direction `r` shows `mix(haze.color, zenith, sqrt(max(r.z, 0)))`.

use glam::Vec3;

/// The light of a scene; colors are linear.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lighting {
    /// Unit vector from the ground toward the sun.
    pub to_sun: Vec3,
    /// Light of the sun on a surface that faces it.
    pub sun: Vec3,
    /// Light of the sky on a surface that faces up.
    pub sky: Vec3,
    /// Light bounced from the ground on a surface that faces down.
    pub bounce: Vec3,
    /// Haze with distance.
    pub haze: Haze,
    /// The sky's color overhead.
    pub zenith: Vec3,
}

/// Haze that thickens with distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Haze {
    /// The color of the horizon, linear.
    pub color: Vec3,
    /// The distance in meters at which 63 % of the color is haze; infinite for clear air.
    pub distance_m: f32,
}

impl Default for Lighting {
    /// The cartographic convention: light from the north-west, 45° high, on a clear day.
    fn default() -> Self {
        Self {
            to_sun: Vec3::new(-0.5, 0.5, std::f32::consts::FRAC_1_SQRT_2),
            sun: Vec3::new(0.95, 0.91, 0.82),
            sky: Vec3::new(0.34, 0.38, 0.45),
            bounce: Vec3::new(0.16, 0.14, 0.12),
            haze: Haze { color: Vec3::new(0.66, 0.76, 0.86), distance_m: f32::INFINITY },
            zenith: Vec3::new(0.16, 0.34, 0.66),
        }
    }
}

impl Lighting {
    /// The light that a surface point returns, before haze; see the module's formula.
    pub fn shade(&self, albedo: Vec3, normal: Vec3, sun_visibility: f32, sky_visibility: f32) -> Vec3 {
        let direct = self.sun * (normal.dot(self.to_sun).max(0.0) * sun_visibility);
        let ambient = self.bounce.lerp(self.sky, normal.z * 0.5 + 0.5) * sky_visibility;
        albedo * (direct + ambient)
    }

    /// `color` as seen through `distance_m` meters of air.
    pub fn add_haze(&self, color: Vec3, distance_m: f32) -> Vec3 {
        let clear = libm::expf(-distance_m / self.haze.distance_m);
        self.haze.color.lerp(color, clear)
    }

    /// The color of the sky in direction `ray`, which need not be of unit length.
    pub fn sky_color(&self, ray: Vec3) -> Vec3 {
        let rise = ray.normalize_or_zero().z.max(0.0).sqrt();
        self.haze.color.lerp(self.zenith, rise)
    }
}
