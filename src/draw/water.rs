//! The look of water: one blue, darker with depth ([`bathymetry`]) and along the shore, and the sky in it.
//!
//! A calm surface mirrors what lies at the mirrored angle, by Fresnel's law in the approximation of Schlick (1994): two
//! hundredths of it from above and nearly all at a grazing angle. Waves turn part of the surface toward the eye, so that
//! even distant water keeps most of its own color.

use glam::Vec3;

use crate::draw::bathymetry::bathymetry;
use crate::draw::color::Srgba;
use crate::draw::lighting::Lighting;

/// The colors of water.
///
/// On the ground map it covers `c = clamp((water − 0.5) · 4 + 0.5, 0, 1)` of a pixel, over which the color is
/// `mix(land, water, c) · (1 − SHORE · 4 c (1 − c))`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WaterColor;

impl WaterColor {
    /// Water at the height of 0 and above.
    pub const SURFACE: Srgba = Srgba::opaque(92, 150, 190);
    /// The line along a shore.
    pub const SHORE_LINE: Srgba = Srgba::opaque(46, 96, 138);
    /// By which share a pixel half land and half water is darker than both.
    pub const SHORE: f32 = 0.4;
    /// The share of light from straight above that water mirrors.
    pub const MIRRORED: f32 = 0.02;
    /// The most that it mirrors of the sky: waves hide the rest.
    pub const MOST_MIRRORED: f32 = 0.5;

    /// The share of a pixel that is under water, from the mean of [`GroundPost::water`] around it.
    ///
    /// [`GroundPost::water`]: crate::draw::ground::GroundPost::water
    pub fn cover(water: f32) -> f32 {
        ((water - 0.5) * 4.0 + 0.5).clamp(0.0, 1.0)
    }

    /// The color in linear light of a pixel of `land`, a share of which is water over a bed at `height_m`.
    pub fn over(land: Vec3, height_m: f32, share: f32) -> Vec3 {
        let water = bathymetry().linear_at(height_m);
        land.lerp(water, share) * (1.0 - Self::SHORE * 4.0 * share * (1.0 - share))
    }
}

impl Lighting {
    /// `color` of a level surface, `water` of which is water, with the sky that it mirrors, before haze. `ray` points from
    /// the eye to the surface and need not be of unit length.
    pub fn mirror_sky(&self, color: Vec3, ray: Vec3, water: f32) -> Vec3 {
        let ray = ray.normalize_or_zero();
        let grazing = 1.0 - (-ray.z).clamp(0.0, 1.0);
        let fifth = grazing * grazing * grazing * grazing * grazing;
        let share = WaterColor::MIRRORED + (WaterColor::MOST_MIRRORED - WaterColor::MIRRORED) * fifth;
        color.lerp(self.sky_color(Vec3::new(ray.x, ray.y, -ray.z)), share * water)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn water_mirrors_more_sky_the_lower_it_is_seen_and_land_none() {
        let light = Lighting::default();
        let own = WaterColor::SURFACE.linear();
        let changed = |down: f32| light.mirror_sky(own, Vec3::new(0.0, 1.0, -down), 1.0).distance(own);
        assert!(
            changed(9.0) < 0.03 && changed(0.5) > 1.5 * changed(1.5),
            "{} {}",
            changed(0.5),
            changed(1.5)
        );
        assert_eq!(light.mirror_sky(own, Vec3::new(0.0, 1.0, -0.1), 0.0), own);
    }

    #[test]
    fn a_shore_is_darker_than_land_and_water() {
        let land = Vec3::splat(0.4);
        assert_eq!(WaterColor::over(land, 10.0, 0.0), land);
        assert_eq!(WaterColor::over(land, 10.0, 1.0), WaterColor::SURFACE.linear());
        assert!(WaterColor::over(land, 10.0, 0.5).max_element() < 0.3);
    }
}
