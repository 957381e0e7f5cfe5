//! The look of water: one blue, lighter along the shore and deeper far from it and over depths ([`bathymetry`]), a dark
//! line between it and the land, which is wet there, and sky and relief in it ([`water_relief`](crate::water_relief)).
//!
//! A calm surface mirrors what lies at the mirrored angle, by Fresnel's law in the approximation of Schlick (1994): two
//! hundredths of it from above and nearly all at a grazing angle. Waves turn part of the surface toward the eye, so that
//! even distant water keeps most of its own color. Ripples tilt the mirror near the eye, where they are wider than pixels.

use glam::{Vec2, Vec3};

use crate::bathymetry::bathymetry;
use crate::color::Srgba;
use crate::ground_grain::noise;
use crate::lighting::Lighting;
use crate::shown::shown;
use crate::water_relief::relief_shown;

/// The colors of water.
///
/// On the ground map, water is a number with the shore at 0.5 (see [`GroundPost::water`]), which says how far a pixel lies
/// from the shore in pixels, `a = (water − 0.5) / change`, `change` being its change across the pixel. Water covers
/// `c = clamp(a + 0.5, 0, 1)` of the pixel and the line along the shore `l = clamp(1.25 − |a|, 0, 1)`. Land grows wetter toward
/// the shore, `w = clamp(4 · water − 1, 0, 1)²`; the color is `mix(land · (1 − WET · w), water, c) · (1 − SHORE · l)`.
///
/// [`GroundPost::water`]: crate::ground::GroundPost::water
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WaterColor;

impl WaterColor {
    /// Water at the shore, at the height of 0 and above.
    pub const SHALLOW: Srgba = Srgba::opaque(116, 170, 203);
    /// Water a little off the shore: the blue of all that is too small to have a middle.
    pub const SURFACE: Srgba = Srgba::opaque(92, 150, 190);
    /// Open water.
    pub const OPEN: Srgba = Srgba::opaque(72, 128, 174);
    /// The distance at which the color is that of [`Self::SURFACE`], as a share of the way from the shore to open
    /// water.
    pub const OFF_SHORE: f32 = 0.3;
    /// The line along a shore.
    pub const SHORE_LINE: Srgba = Srgba::opaque(46, 96, 138);
    /// The share by which the line along the shore is darker than land and water.
    pub const SHORE: f32 = 0.4;
    /// The share by which wet land is darker at the shore: sand and soil lose more when soaked, but shores would look like walls.
    pub const WET: f32 = 0.3;
    /// Half the width of that line in pixels, and half a pixel.
    pub const SHORE_PX: f32 = 1.25;
    /// The share of light from straight above that water mirrors.
    pub const MIRRORED: f32 = 0.02;
    /// The most that it mirrors of the sky: waves hide the rest.
    pub const MOST_MIRRORED: f32 = 0.5;

    /// The color in linear light of water over a bed at `height_m`, a share of the way from the shore to open water.
    pub fn tint(height_m: f32, off_shore: f32) -> Vec3 {
        let own = bathymetry().linear_at(height_m);
        let near = (off_shore / Self::OFF_SHORE).clamp(0.0, 1.0);
        let far = ((off_shore - Self::OFF_SHORE) / (1.0 - Self::OFF_SHORE)).clamp(0.0, 1.0);
        Self::SHALLOW.linear().lerp(own, near).lerp(own.min(Self::OPEN.linear()), far)
    }

    /// The color in linear light of a pixel of `land`, whose `shore` says what of it is water, over a bed at `height_m`.
    pub fn over(land: Vec3, height_m: f32, shore: &ShorePixel) -> Vec3 {
        let land = land * (1.0 - Self::WET * shore.wet);
        land.lerp(Self::tint(height_m, shore.off_shore), shore.cover) * (1.0 - Self::SHORE * shore.line)
    }
}

/// A pixel on or beside water.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShorePixel {
    /// The share of it that is under water.
    pub cover: f32,
    /// The share of it that the line along the shore covers.
    pub line: f32,
    /// How wet the land is, 0..=1.
    pub wet: f32,
    /// How far it lies from the shore, as a share of the way to open water.
    pub off_shore: f32,
}

impl ShorePixel {
    /// The least change across a pixel that counts: where there is none, a pixel is land or water.
    const LEAST_CHANGE: f32 = 1e-4;

    /// The pixel where [`GroundPost::water`] is `water` and changes by `change` across it.
    ///
    /// [`GroundPost::water`]: crate::ground::GroundPost::water
    pub fn new(water: f32, change: f32) -> Self {
        let away_px = (water - 0.5) / change.max(Self::LEAST_CHANGE);
        let wet = (4.0 * water - 1.0).clamp(0.0, 1.0);
        Self {
            cover: (away_px + 0.5).clamp(0.0, 1.0),
            line: (WaterColor::SHORE_PX - away_px.abs()).clamp(0.0, 1.0),
            wet: wet * wet,
            off_shore: ((water - 0.75) * 4.0).clamp(0.0, 1.0),
        }
    }

    /// Whether nothing of the pixel shows land, nor the line along the shore.
    pub fn is_open(&self) -> bool {
        self.cover >= 1.0 && self.line <= 0.0
    }
}

/// Ripples: wavelengths in meters with the steepness of each.
pub(crate) const RIPPLES: [(f32, f32); 3] = [(1.9, 0.030), (7.3, 0.035), (29.0, 0.030)];

/// A ripple shows in full where it is this many pixels wide, and not at all where it is half as wide.
pub(crate) const RIPPLE_PX: f32 = 8.0;

/// Ripples show where the ray is this much flatter than straight down (1 less its fall), and in full that much above: from
/// high up, the mirror that they tilt shows next to nothing.
pub(crate) const RIPPLE_GRAZING: [f32; 2] = [0.3, 0.7];

/// The slope of the water's surface eastward and northward at world X and Y, over a pixel `pixel_m` meters wide, seen along
/// `ray` of unit length.
pub fn ripples(at: Vec2, pixel_m: f32, ray: Vec3) -> Vec2 {
    let [none, all] = RIPPLE_GRAZING;
    let low = ((1.0 + ray.z - none) / (all - none)).clamp(0.0, 1.0);
    let mut slope = Vec2::ZERO;
    for (wave_m, steepness) in RIPPLES {
        let shown = low * shown(wave_m, RIPPLE_PX, pixel_m);
        if shown > 0.0 {
            let place = at / wave_m;
            slope += Vec2::new(noise(place), noise(place + Vec2::new(37.5, 17.25))) * (shown * steepness);
        }
    }
    slope
}

/// A water's surface as it mirrors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WaterMirror {
    /// The share of a pixel that is water.
    pub share: f32,
    /// Its slope eastward and northward; see [`ripples`].
    pub slope: Vec2,
}

impl Lighting {
    /// `color` of a level surface with what its water mirrors, before haze. `ray`, of unit length, points from the
    /// eye to the surface. `relief` returns the ground that the mirrored ray meets, a unit vector, as its light reaches the
    /// surface; `None` where it meets none, which shows the sky.
    pub fn mirror(
        &self,
        color: Vec3,
        ray: Vec3,
        water: WaterMirror,
        relief: impl FnOnce(Vec3) -> Option<Vec3>,
    ) -> Vec3 {
        let normal = (-water.slope).extend(1.0).normalize();
        let toward = -ray.dot(normal);
        let grazing = 1.0 - toward.clamp(0.0, 1.0);
        let fifth = grazing * grazing * grazing * grazing * grazing;
        let share = WaterColor::MIRRORED + (WaterColor::MOST_MIRRORED - WaterColor::MIRRORED) * fifth;
        let mirrored = ray + normal * (2.0 * toward);
        let sky = self.sky_color(mirrored);
        let shown = relief_shown(share);
        let relief = if shown > 0.0 { relief(mirrored) } else { None };
        color.lerp(relief.map_or(sky, |relief| sky.lerp(relief, shown)), share * water.share)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::water_relief::STEEP;

    fn still(share: f32) -> WaterMirror {
        WaterMirror { share, slope: Vec2::ZERO }
    }

    #[test]
    fn water_mirrors_more_sky_the_lower_it_is_seen_and_land_none() {
        let light = Lighting::default();
        let own = WaterColor::SURFACE.linear();
        let ray = |down: f32| Vec3::new(0.0, 1.0, -down).normalize();
        let changed = |down: f32| light.mirror(own, ray(down), still(1.0), |_| None).distance(own);
        assert!(
            changed(9.0) < 0.03 && changed(0.5) > 1.5 * changed(1.5),
            "{} {}",
            changed(0.5),
            changed(1.5)
        );
        assert_eq!(light.mirror(own, ray(0.1), still(0.0), |_| Some(Vec3::ONE)), own);
    }

    #[test]
    fn low_over_water_relief_takes_the_place_of_the_sky() {
        let light = Lighting::default();
        let own = WaterColor::SURFACE.linear();
        let mirror = |down: f32, relief: &dyn Fn(Vec3) -> Option<Vec3>| {
            light.mirror(own, Vec3::new(0.0, 1.0, -down).normalize(), still(1.0), relief)
        };
        let wall = Vec3::new(0.05, 0.03, 0.01);
        let low = mirror(0.05, &|ray| {
            assert!(ray.abs_diff_eq(Vec3::new(0.0, 1.0, 0.05).normalize(), 1e-6), "{ray}");
            Some(wall)
        });
        let share = (low - own) / (wall - own);
        assert!(share.min_element() > 0.35 && share.abs_diff_eq(Vec3::splat(share.x), 1e-4), "{share}");
        assert_ne!(low, mirror(0.05, &|_| None));
        mirror(0.5, &|_| panic!("seen from above"));
        let steep = Vec3::new(0.0, (1.0 - STEEP * STEEP).sqrt(), -STEEP);
        let steepest: f32 = RIPPLES.iter().map(|ripple| ripple.1).sum();
        let tilted = WaterMirror { share: 1.0, slope: Vec2::new(0.0, steepest) };
        light.mirror(own, steep, tilted, |_| panic!("tilted from the eye"));
    }

    #[test]
    fn a_shore_is_darker_than_land_and_water() {
        let land = Vec3::splat(0.4);
        let over = |water: f32| WaterColor::over(land, 10.0, &ShorePixel::new(water, 0.05));
        assert_eq!(over(0.25), land);
        let off_shore = over(0.25 + 0.5 + 0.25 * WaterColor::OFF_SHORE);
        assert!(off_shore.abs_diff_eq(WaterColor::SURFACE.linear(), 1e-6), "{off_shore}");
        assert!(over(0.5).max_element() < 0.3);
    }

    #[test]
    fn land_is_darker_the_nearer_the_shore_and_dry_land_keeps_its_color() {
        let land = Vec3::splat(0.4);
        let light = |water: f32| WaterColor::over(land, 10.0, &ShorePixel::new(water, 1e-3)).x;
        assert_eq!([light(0.0), light(0.25)], [0.4; 2]);
        assert!(light(0.3) > light(0.4) && light(0.4) > light(0.47) && light(0.47) > 0.28);
    }

    #[test]
    fn a_shore_is_as_wide_on_the_picture_however_large_the_water_is_shown() {
        for change in [0.001, 0.01, 0.1] {
            let at = |px: f32| ShorePixel::new(0.5 + px * change, change);
            assert_eq!((at(0.0).cover, at(0.0).line), (0.5, 1.0));
            assert_eq!((at(1.5).cover, at(1.5).line, at(-1.5).cover, at(-1.5).line), (1.0, 0.0, 0.0, 0.0));
        }
        assert_eq!([0.5, 0.6, 0.7].map(|water| ShorePixel::new(water, 0.1).is_open()), [false, false, true]);
        assert_eq!([0.3, 0.9].map(|water| ShorePixel::new(water, 0.0).cover), [0.0, 1.0]);
    }

    #[test]
    fn water_deepens_from_its_shore_to_its_middle_in_three_stops() {
        let light = |off_shore: f32| WaterColor::tint(0.0, off_shore).element_sum();
        assert_eq!(WaterColor::tint(0.0, 0.0), WaterColor::SHALLOW.linear());
        assert!(WaterColor::tint(5.0, 1.0).abs_diff_eq(WaterColor::OPEN.linear(), 1e-6));
        assert!((0..10).all(|step| light(step as f32 / 10.0) > light((step + 1) as f32 / 10.0)));
    }

    #[test]
    fn ripples_fade_with_distance_and_from_above() {
        let low = Vec3::new(0.0, 1.0, -0.1).normalize();
        let steepest = |pixel_m: f32, ray: Vec3| {
            let places =
                (0..2000).map(|index| Vec2::new((index % 50) as f32 * 0.7, (index / 50) as f32 * 0.9));
            places.map(|at| ripples(at, pixel_m, ray).length()).fold(0.0, f32::max)
        };
        assert!(steepest(0.1, low) > 0.03 && steepest(0.1, low) < 0.15);
        assert!(steepest(3.0, low) < steepest(0.1, low));
        assert_eq!((steepest(8.0, low), steepest(0.1, -Vec3::Z)), (0.0, 0.0));
        let light = Lighting::default();
        let tilted = WaterMirror { share: 1.0, slope: Vec2::new(0.0, -0.05) };
        let own = WaterColor::SURFACE.linear();
        let mirrored = |water| light.mirror(own, low, water, |_| None);
        assert_ne!(mirrored(tilted), mirrored(still(1.0)));
    }
}
