//! The strength of a scene's relief shading: gentle ground is shaded more than mountains, so that both fill the scale from
//! dark to light.
//!
//! It depends on the ground and the sun alone, so that all pictures of a scene under one sun are shaded alike.

use glam::{DVec2, UVec2, Vec2, Vec3};
use rayon::prelude::*;

use crate::vertical_scale::VerticalScale;
use sandtable_draw::color::luminance;
use sandtable_draw::ground::ColorRamp;
use sandtable_draw::lighting::{ReliefPoint, ReliefShading};
use sandtable_terrain::lattice::{Lattice, Post};

/// The mean slope, meters per meter, to which the slopes of gentle ground are raised for their shading: that of hills. More
/// of it shows more relief and darker pictures.
const SHADED_SLOPE: f64 = 0.45;

/// The greatest z-factor: above it the noise of a plain would look like hills.
const MOST_Z_FACTOR: f64 = 5.0;

/// The slopes that are measured: about as many squared.
const SLOPES: u32 = 256;

/// One place of the land of so many is darker than [`DARK`].
const DARKER: usize = 33;

/// The luminance of the darkest places: CIE lightness 32.
const DARK: f32 = 0.0709;

/// The greatest gain of shade: above it every dent of a plain would be a hole.
const MOST_SHADE_GAIN: f32 = 6.0;

/// The strength of the relief shading of a ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReliefStrength {
    /// The factor on slopes, at least 1.
    pub z_factor: f32,
    /// See [`ReliefShading::shade_gain`].
    pub shade_gain: f32,
}

impl ReliefStrength {
    /// The strength for the land of `lattice`, drawn at `scale` in the colors of `ramp`, under a sun in direction `to_sun`
    /// (unit vector).
    pub fn of(
        lattice: &Lattice,
        scale: VerticalScale,
        ramp: &ColorRamp,
        to_sun: Vec3,
        is_water: impl Fn(usize) -> bool,
    ) -> Self {
        let slopes = land_slopes(lattice, scale, is_water);
        let sum: f64 = slopes.iter().map(|place| f64::from(place.rise.length())).sum();
        let mean = sum / slopes.len().max(1) as f64;
        let z_factor = (SHADED_SLOPE / mean.max(1e-9)).clamp(1.0, MOST_Z_FACTOR) as f32;
        Self { z_factor, shade_gain: shade_gain(&slopes, z_factor, ramp, &ReliefShading::new(to_sun)) }
    }
}

/// Where the ground of `lattice` falls to as a whole: the sum of its downhill slopes as a part of the sum of their lengths,
/// 0..=1; water, which is level, adds nothing.
pub fn fall(lattice: &Lattice) -> Vec2 {
    let slopes = land_slopes(lattice, VerticalScale(1.0), |_| false);
    let (sum, lengths) = slopes.iter().fold((DVec2::ZERO, 0.0), |(sum, lengths), place| {
        (sum - place.rise.as_dvec2(), lengths + f64::from(place.rise.length()))
    });
    (sum / lengths.max(1e-9)).as_vec2()
}

/// A slope and where it lies in the range of heights.
struct LandSlope {
    /// Rise eastward and northward of the drawn ground, meters per meter.
    rise: Vec2,
    /// Elevation in meters, true to scale.
    height_m: f32,
}

/// Slopes of the land over steps of the same length.
fn land_slopes(lattice: &Lattice, scale: VerticalScale, is_water: impl Fn(usize) -> bool) -> Vec<LandSlope> {
    let last = UVec2::new(lattice.columns(), lattice.rows()) - 1;
    let step = (last.max_element() / SLOPES).max(1);
    let reach_m = lattice.cell() * f64::from(step);
    let mut slopes = Vec::new();
    for row in (0..=last.y.saturating_sub(step)).step_by(step as usize) {
        for column in (0..=last.x.saturating_sub(step)).step_by(step as usize) {
            let height = |column: u32, row: u32| {
                f64::from(lattice.height(Post { column: column.min(last.x), row: row.min(last.y) }))
            };
            let own = height(column, row);
            let rise = DVec2::new(height(column + step, row), height(column, row + step)) - own;
            let rise = (rise / reach_m).as_vec2();
            if rise.is_finite() && !is_water(lattice.index(Post { column, row })) {
                let rise = Vec2::new(scale.world_z(rise.x), scale.world_z(rise.y));
                slopes.push(LandSlope { rise, height_m: own as f32 });
            }
        }
    }
    slopes
}

/// The gain at which one place of [`DARKER`] is darker than [`DARK`], no shadow being cast.
fn shade_gain(slopes: &[LandSlope], z_factor: f32, ramp: &ColorRamp, shading: &ReliefShading) -> f32 {
    let darkening_gain = |LandSlope { rise, height_m }: &LandSlope| {
        let normal = (-*rise * z_factor).extend(1.0).normalize();
        let elevation = ramp.elevation(*height_m);
        let point = ReliefPoint { normal, form: normal, sun_visibility: 1.0, sky_visibility: 1.0, elevation };
        let brightness = ReliefShading::hard(DARK / luminance(ramp.linear_at(*height_m)).max(DARK));
        let (relief, _) = shading.relief(&point);
        if relief < 0.0 { (brightness - 1.0) / relief } else { f32::INFINITY }
    };
    let mut gains: Vec<f32> = slopes.par_iter().map(darkening_gain).collect();
    if gains.is_empty() {
        return ReliefShading::GAIN;
    }
    let place = gains.len() / DARKER;
    let (_, gain, _) = gains.select_nth_unstable_by(place, f32::total_cmp);
    gain.clamp(ReliefShading::GAIN, MOST_SHADE_GAIN)
}

#[cfg(test)]
mod tests {
    use super::*;
    use sandtable_draw::color::Srgba;
    use sandtable_draw::lighting::Lighting;

    const SIDE: u32 = 129;

    /// Hills 10 cells apart whose sides are about as steep as `steepness`.
    fn hills(steepness: f32) -> Lattice {
        let wave = |place: u32| libm::sinf(place as f32 * 0.6);
        let heights = (0..SIDE * SIDE)
            .map(|index| 200.0 + steepness * 20.0 * (wave(index % SIDE) + wave(index / SIDE)))
            .collect();
        Lattice::new(DVec2::ZERO, DVec2::splat(10.0), SIDE, heights).expect("sound")
    }

    fn strength(lattice: &Lattice, is_water: impl Fn(usize) -> bool) -> ReliefStrength {
        let ramp = ColorRamp::new(vec![(0.0, Srgba::opaque(0x80, 0x90, 0x60))]).expect("one stop");
        ReliefStrength::of(lattice, VerticalScale(1.0), &ramp, Lighting::default().to_sun, is_water)
    }

    #[test]
    fn one_place_of_many_is_dark_on_plains_and_on_hills() {
        for steepness in [0.1, 0.3] {
            let lattice = hills(steepness);
            let ReliefStrength { z_factor, shade_gain } = strength(&lattice, |_| false);
            let shading = ReliefShading { shade_gain, ..ReliefShading::new(Lighting::default().to_sun) };
            let albedo = Srgba::opaque(0x80, 0x90, 0x60).linear();
            let slopes = land_slopes(&lattice, VerticalScale(1.0), |_| false);
            let is_dark = |slope: &&LandSlope| {
                let normal = (-slope.rise * z_factor).extend(1.0).normalize();
                let (relief, _) = shading.relief(&ReliefPoint {
                    normal,
                    form: normal,
                    sun_visibility: 1.0,
                    sky_visibility: 1.0,
                    elevation: 0.0,
                });
                luminance(albedo * ReliefShading::soft(1.0 + shade_gain * relief)) < DARK
            };
            let share = slopes.iter().filter(is_dark).count() as f64 / slopes.len() as f64;
            assert!((0.02..0.05).contains(&share), "{steepness}: {share} with {z_factor} and {shade_gain}");
        }
    }

    #[test]
    fn ground_without_forms_or_land_has_a_strength() {
        let flat = Lattice::new(DVec2::ZERO, DVec2::splat(10.0), 3, vec![5.0; 9]).expect("sound");
        let greatest = ReliefStrength { z_factor: MOST_Z_FACTOR as f32, shade_gain: MOST_SHADE_GAIN };
        assert_eq!(strength(&flat, |_| false), greatest);
        let least = ReliefStrength { shade_gain: ReliefShading::GAIN, ..greatest };
        assert_eq!(strength(&flat, |_| true), least);
    }
}
