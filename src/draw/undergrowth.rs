//! The ground of woods: leaf litter, scrub and the shade of crowns, darker and browner than open ground.
//!
//! From afar, where trees are smaller than pixels, it alone shows where woods are: so it keeps a breath of green.

use glam::Vec3;

use crate::color::Srgba;

/// The color of ground under trees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Undergrowth;

impl Undergrowth {
    /// Its color.
    pub const COLOR: Srgba = Srgba::opaque(88, 92, 52);
    /// The greatest share of undergrowth over the ground's own color, so that the ramp still shows the height.
    pub const MOST: f32 = 0.85;

    /// The share of it at a place, from the mean of [`GroundPost::water`] around it, which is negative under trees.
    ///
    /// [`GroundPost::water`]: crate::ground::GroundPost::water
    pub fn cover(water: f32) -> f32 {
        (-water).clamp(0.0, 1.0) * Self::MOST
    }

    /// The color in linear light of `land` with that much undergrowth.
    pub fn over(land: Vec3, cover: f32) -> Vec3 {
        land.lerp(Self::COLOR.linear(), cover)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn woods_darken_open_ground_and_water_is_none() {
        let land = Srgba::opaque(230, 220, 180).linear();
        assert_eq!(Undergrowth::over(land, Undergrowth::cover(1.0)), land);
        assert_eq!(Undergrowth::over(land, Undergrowth::cover(0.0)), land);
        let dense = Undergrowth::over(land, Undergrowth::cover(-1.0));
        assert!(dense.cmplt(land * 0.6).all(), "{dense}");
        assert_eq!(Undergrowth::cover(-9.0), Undergrowth::MOST);
    }
}
