//! Light, relief shading, haze and sky: one formula for both renderers.
//!
//! A point of a solid with albedo `a` and unit normal `n` shows
//! `lit = a · (s · sun · max(n·to_sun, 0) + o · mix(bounce, sky, (n.z + 1) / 2))`, `s` and `o` being the shares of the
//! sun and of the sky that reach it past other solids; the ground and what is draped on it is shaded
//! as a relief map, see [`ReliefShading`]. `d` meters from the eye both show `mix(lit, haze.color, 1 − exp(−max(d − haze.near_m, 0) / haze.distance_m))`. Where nothing is drawn,
//! the [`Backdrop`] shows.

use std::f32::consts::FRAC_1_SQRT_2;

use glam::{Vec2, Vec3};

use crate::backdrop::Backdrop;

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
    /// What shows where nothing is drawn.
    pub backdrop: Backdrop,
}

/// Haze that thickens with distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Haze {
    /// The color of the horizon, linear.
    pub color: Vec3,
    /// The distance in meters from the eye at which haze begins, at least 0.
    pub near_m: f32,
    /// How far past `near_m` 63 % of the color is haze, meters; infinite for clear air.
    pub distance_m: f32,
}

/// The shares of the light that reach a point past solids, each 0..=1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReceivedLight {
    /// The share of the sun.
    pub sun: f32,
    /// The share of the sky.
    pub sky: f32,
}

impl ReceivedLight {
    /// All light: a point in the open.
    pub const ALL: Self = Self { sun: 1.0, sky: 1.0 };
}

impl Default for Lighting {
    /// The cartographic convention: light from the north-west, 45° high, on a clear day.
    fn default() -> Self {
        Self {
            to_sun: Vec3::new(-0.5, 0.5, FRAC_1_SQRT_2),
            sun: Vec3::new(0.95, 0.91, 0.82),
            sky: Vec3::new(0.34, 0.38, 0.45),
            bounce: Vec3::new(0.16, 0.14, 0.12),
            haze: Haze { color: Vec3::new(0.66, 0.76, 0.86), near_m: 0.0, distance_m: f32::INFINITY },
            zenith: Vec3::new(0.16, 0.34, 0.66),
            backdrop: Backdrop::Sky,
        }
    }
}

impl Lighting {
    /// The light that a point of a solid in the open returns, before haze; see the module's formula.
    pub fn shade(&self, albedo: Vec3, normal: Vec3) -> Vec3 {
        self.shade_received(albedo, normal, ReceivedLight::ALL)
    }

    /// The light that a point of a solid returns that receives a part of the light, before haze.
    #[inline]
    pub fn shade_received(&self, albedo: Vec3, normal: Vec3, received: ReceivedLight) -> Vec3 {
        let direct = self.sun * (normal.dot(self.to_sun).max(0.0) * received.sun);
        let ambient = self.bounce.lerp(self.sky, normal.z * 0.5 + 0.5) * received.sky;
        albedo * (direct + ambient)
    }

    /// `color` as seen through `distance_m` meters of air.
    pub fn add_haze(&self, color: Vec3, distance_m: f32) -> Vec3 {
        let clear = libm::expf(-(distance_m - self.haze.near_m).max(0.0) / self.haze.distance_m);
        self.haze.color.lerp(color, clear)
    }

    /// The same for a ray that something turned `turned_m` meters from the eye, through the air behind that: haze up to
    /// there then makes of it what [`Self::add_haze`] makes of the whole way.
    pub fn add_haze_beyond(&self, color: Vec3, turned_m: f32, distance_m: f32) -> Vec3 {
        let hazy_m = |distance_m: f32| (distance_m - self.haze.near_m).max(0.0);
        let clear = libm::expf(-(hazy_m(distance_m) - hazy_m(turned_m)) / self.haze.distance_m);
        self.haze.color.lerp(color, clear)
    }
}

/// The shading of the ground: the analytical form of Swiss relief shading.
///
/// Of the light, 55 % comes from the sun and is subject to cast shadows, 20 % from four side lights 30° high (which
/// model slopes that lie along the sun's rays; after the multidirectional hillshade of Mark 1992), and 25 % is that of
/// the sun on generalized ground, which holds the large forms together (Leonowicz, Jenny and Hurni 2010). With `shade`
/// their sum where no shadow falls, `flat` that of level ground, `lost` what cast shadows take of it, and `c` the contrast,
/// which grows with elevation as in aerial perspective (Jenny and Patterson 2020), `r = c · (shade − flat)`, `s = c · lost` and
///
/// ```text
/// lit = albedo · b · mix(COOL, WARM, clamp(0.5 + 1.2 · (r − s), 0, 1)) · mix(CLOSED, 1, sky visibility)
/// b = soft(1 + gain · r − GAIN · s) · (1 + MOST · d / (MOST + |d|)),  MOST = MOST_DETAIL
/// d = detail · max(1 − sun visibility · max(n · to_sun, 0) / to_sun.z, 0) · (n − form) · to_sun
/// ```
///
/// `d` draws in the shade what the sun draws in the light: how much the normal `n` leans to the sun more than that of the generalized
/// ground, `form`. Without it, ribs and gullies end where the shade begins, which a hand that shades a relief lets go on.
///
/// Natural ground also returns in its shade the light of the sky and of the slopes opposite,
/// `fill · FILL · max(albedo + FILL_CHROMA · (albedo − gray), 0) · (1 − b)`, `gray` being as light as the albedo. Much of it has
/// met ground of the same color before, which deepens the tint: dark slopes keep their hues under the cool light. In its light it
/// is paler and warmer, `mix(albedo, gray · GLARE_COLOR, fill · GLARE · (b − 1) / (BRIGHTEST − 1))`: leaves and grass mirror the
/// sun besides.
///
/// `gain` is [`Self::GAIN`] in light and [`Self::shade_gain`] in shade, so that the darkest slopes of gentle ground are as
/// dark as those of mountains. Shadows need no such help: they are as dark on every ground. Ground that lies under symbols and
/// graphics has [`Self::BASE_GAIN`] in shade, so that they stand out.
/// `soft` bends what lies beyond [`Self::TOE`] and [`Self::SHOULDER`] toward [`Self::DARKEST`] and [`Self::BRIGHTEST`]
/// along hyperbolas that it reaches nowhere, so that forms still show in deep shade and on the brightest slopes.
/// Level ground in the open keeps its albedo, so that the tints of a legend are those of the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReliefShading {
    /// Unit vector from the ground toward the sun.
    pub to_sun: Vec3,
    /// Unit vectors toward the side lights: 90° and 45° counterclockwise of the sun, with it, and 45° clockwise of it.
    pub sides: [Vec3; 4],
    /// The change of brightness with shade on slopes darker than level ground, [`Self::BASE_GAIN`] or at least [`Self::GAIN`].
    pub shade_gain: f32,
    /// The share of [`Self::FILL`] that shade receives, 0..=1.
    pub fill: f32,
    /// How strongly forms show in the shade, 0 to [`Self::DETAIL`].
    pub detail: f32,
}

/// A place on the ground as relief shading sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReliefPoint {
    /// The upward unit normal.
    pub normal: Vec3,
    /// The upward unit normal of the generalized ground.
    pub form: Vec3,
    /// Share of the sun that reaches the place, 0..=1.
    pub sun_visibility: f32,
    /// Share of the sky that is seen, 0..=1; more on the crests of textured ground.
    pub sky_visibility: f32,
    /// The elevation as a share of the ground's range of heights; clamped to 0..=1.
    pub elevation: f32,
}

impl ReliefShading {
    /// The share of the light from the sun, from the side lights, and from the sun on generalized ground.
    pub const SHARES: [f32; 3] = [0.55, 0.20, 0.25];
    /// The shares of the side lights.
    pub const SIDE_SHARES: [f32; 4] = [0.2, 0.3, 0.3, 0.2];
    /// The change of brightness with light on slopes lighter than level ground, and with cast shadows: larger is harsher.
    pub const GAIN: f32 = 2.4;
    /// [`Self::shade_gain`] of a base map: more of it takes the contrast from dark lines and letters on shaded slopes, less
    /// loses the forms.
    pub const BASE_GAIN: f32 = 1.2;
    /// The brightness that the deepest shade tends to: a shadowed cliff keeps about 0.18.
    pub const DARKEST: f32 = 0.09;
    /// The brightness below which shade is softened.
    pub const TOE: f32 = 0.5;
    /// The brightness above which light is softened: pale tints would lose their color.
    pub const SHOULDER: f32 = 1.35;
    /// The brightness that the brightest slopes tend to.
    pub const BRIGHTEST: f32 = 1.9;
    /// How strongly forms show in the shade: about as strongly as in the light.
    pub const DETAIL: f32 = 1.8;
    /// The most by which they change its brightness.
    pub const MOST_DETAIL: f32 = 0.6;
    /// The color of the light on slopes toward the sun.
    pub const WARM: Vec3 = Vec3::new(1.06, 1.0, 0.90);
    /// The color of the light in shade.
    pub const COOL: Vec3 = Vec3::new(0.80, 0.90, 1.12);
    /// The light of the sky in the deepest shade of natural ground, which the sun does not outshine there.
    pub const FILL: Vec3 = Vec3::new(0.105, 0.117, 0.144);
    /// By how much this light deepens colors: 0 leaves them as they are, which the cool light makes gray.
    pub const FILL_CHROMA: f32 = 0.35;
    /// The share of [`Self::GLARE_COLOR`] in the color of the brightest natural ground: without it lit woods are lime.
    pub const GLARE: f32 = 0.6;
    /// The color of glare at luminance 1: straw, as sunlight on leaves, dry grass and stone.
    pub const GLARE_COLOR: Vec3 = Vec3::new(1.16, 0.975, 0.78);
    /// Brightness where no sky is seen.
    pub const CLOSED: f32 = 0.5;
    /// The contrast of the lowest ground; that of the highest quarter is 1.
    pub const LOW_CONTRAST: f32 = 0.75;

    /// The shading for a sun in direction `to_sun` (unit vector), with the same gain in shade as in light.
    pub fn new(to_sun: Vec3) -> Self {
        let level = to_sun.truncate().try_normalize().unwrap_or(Vec2::new(-1.0, 1.0) * FRAC_1_SQRT_2);
        let half = Vec2::splat(FRAC_1_SQRT_2);
        let side = |turn: Vec2| (turn.rotate(level) * SIDE_LEVEL).extend(SIDE_RISE);
        Self {
            to_sun,
            sides: [side(Vec2::Y), side(half), side(Vec2::X), side(half * Vec2::new(1.0, -1.0))],
            shade_gain: Self::GAIN,
            fill: 0.0,
            detail: Self::DETAIL,
        }
    }

    /// The light that level ground in the open receives, on the scale of the shade.
    #[inline(always)]
    pub fn flat(&self) -> f32 {
        let [main, sides, form] = Self::SHARES;
        (main + form) * self.to_sun.z.max(0.0) + sides * SIDE_RISE
    }

    /// A brightness bent toward the darkest and the brightest.
    #[inline(always)]
    pub fn soft(brightness: f32) -> f32 {
        let [toe, shoulder] = [Self::TOE - Self::DARKEST, Self::BRIGHTEST - Self::SHOULDER];
        // Both bends are computed, so that several pixels are lit by one vector.
        let dark = Self::DARKEST + toe * toe / (toe + Self::TOE - brightness);
        let bright = Self::BRIGHTEST - shoulder * shoulder / (shoulder + brightness - Self::SHOULDER);
        let not_bright = if brightness > Self::SHOULDER { bright } else { brightness };
        if brightness < Self::TOE { dark } else { not_bright }
    }

    /// The brightness that [`Self::soft`] bends to `shown`, which is at most [`Self::SHOULDER`]; minus infinity where it reaches
    /// nothing as dark.
    pub fn hard(shown: f32) -> f32 {
        let toe = Self::TOE - Self::DARKEST;
        if shown <= Self::DARKEST {
            f32::NEG_INFINITY
        } else if shown < Self::TOE {
            Self::TOE + toe - toe * toe / (shown - Self::DARKEST)
        } else {
            shown
        }
    }
}

/// The sine of the sun's altitude below which level ground counts as shade.
pub(crate) const LEAST_SINE: f32 = 0.1;

/// Cosine and sine of the side lights' altitude, 30°.
const SIDE_LEVEL: f32 = 0.866_025_4;
pub(crate) const SIDE_RISE: f32 = 0.5;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::luminance;

    const LEVEL: ReliefPoint = ReliefPoint {
        normal: Vec3::Z,
        form: Vec3::Z,
        sun_visibility: 1.0,
        sky_visibility: 1.0,
        elevation: 1.0,
    };

    fn shading() -> ReliefShading {
        ReliefShading::new(Lighting::default().to_sun)
    }

    #[test]
    fn level_ground_in_the_open_keeps_its_albedo() {
        let albedo = Vec3::new(0.2, 0.4, 0.6);
        for elevation in [-3.0, 0.0, 0.5, 2.0] {
            let shown = shading().shade(albedo, &ReliefPoint { elevation, ..LEVEL });
            assert!(shown.abs_diff_eq(albedo, 1e-6), "{elevation}: {shown}");
        }
    }

    #[test]
    fn slopes_toward_the_sun_are_bright_and_warm_and_slopes_away_dark_and_cool() {
        let slope = |toward: f32| {
            let normal = Vec3::new(-0.5 * toward, 0.5 * toward, 1.0).normalize();
            shading().shade(Vec3::ONE, &ReliefPoint { normal, form: normal, ..LEVEL })
        };
        let (lit, dark) = (slope(1.0), slope(-1.0));
        assert!(lit.y > 1.2 && lit.x > lit.z, "{lit}");
        assert!(dark.y < 0.4 && dark.x < dark.z, "{dark}");
    }

    #[test]
    fn filled_shade_is_lighter_and_keeps_its_tint_and_level_ground_keeps_its_albedo() {
        let (plain, natural) = (shading(), ReliefShading { fill: 1.0, ..shading() });
        let albedo = Vec3::new(0.3, 0.5, 0.25);
        assert!(natural.shade(albedo, &LEVEL).abs_diff_eq(albedo, 1e-6));
        let shadow = ReliefPoint { sun_visibility: 0.0, ..LEVEL };
        let [dark, filled] = [plain, natural].map(|shading| shading.shade(albedo, &shadow));
        let chroma = |color: Vec3| (color.max_element() - color.min_element()) / color.max_element();
        assert!(luminance(filled) > 1.3 * luminance(dark), "{filled} {dark}");
        assert!(chroma(filled) > 0.9 * chroma(dark), "{filled} {dark}");
        let lit = ReliefPoint { normal: Vec3::new(-0.3, 0.3, 0.9).normalize(), ..LEVEL };
        let lit = natural.shade(albedo, &lit);
        assert!(filled.z / filled.x > 1.2 * lit.z / lit.x, "the shade is cool: {filled} {lit}");
    }

    #[test]
    fn bright_natural_ground_is_paler_and_as_light() {
        let natural = ReliefShading { fill: 1.0, ..shading() };
        let lit = ReliefPoint { normal: Vec3::new(-0.4, 0.4, 0.8).normalize(), ..LEVEL };
        let [plain, paler] =
            [shading(), natural].map(|shading| shading.shade(Vec3::new(0.3, 0.5, 0.2), &lit));
        let chroma = |color: Vec3| (color.max_element() - color.min_element()) / color.max_element();
        assert!(chroma(paler) < 0.95 * chroma(plain), "{paler} {plain}");
        assert!((luminance(paler) / luminance(plain) - 1.0).abs() < 0.02, "{paler} {plain}");
    }

    #[test]
    fn shade_is_deeper_on_high_ground_and_where_little_sky_is_seen() {
        let green = |point: ReliefPoint| shading().shade(Vec3::ONE, &point).y;
        let shadow = ReliefPoint { sun_visibility: 0.0, ..LEVEL };
        assert!(green(shadow) < green(ReliefPoint { elevation: 0.0, ..shadow }));
        assert!(green(ReliefPoint { sky_visibility: 0.5, ..LEVEL }) < 0.8);
    }

    #[test]
    fn forms_show_in_the_shade_about_as_strongly_as_in_the_light() {
        let large = |toward: f32| Vec3::new(-toward, toward, 1.0).normalize();
        let contrast = |toward: f32, sun_visibility: f32| {
            let form = large(toward);
            let [toward_sun, away] = [0.1, -0.1].map(|more| {
                let normal = large(toward + more);
                shading().shade(Vec3::ONE, &ReliefPoint { normal, form, sun_visibility, ..LEVEL }).y
            });
            (toward_sun - away) / (0.5 * (toward_sun + away))
        };
        let light = contrast(0.2, 1.0);
        for shade in [contrast(-0.8, 1.0), contrast(-0.8, 0.0), contrast(0.1, 0.0)] {
            assert!((0.5..2.0).contains(&(shade / light)), "{shade} in the shade, {light} in the light");
        }
    }

    #[test]
    fn a_cast_shadow_on_level_ground_is_as_dark_under_every_gain_of_shade() {
        let shadow = ReliefPoint { sun_visibility: 0.0, ..LEVEL };
        let deeper = ReliefShading { shade_gain: 5.0, ..shading() };
        let (plain, deep) = (shading().shade(Vec3::ONE, &shadow), deeper.shade(Vec3::ONE, &shadow));
        assert!(plain.abs_diff_eq(deep, 1e-5) && plain.y < 0.5, "{plain} {deep}");
    }

    #[test]
    fn brightness_rises_without_a_step_and_never_stops() {
        let shown: Vec<f32> = (-100..=200).map(|step| ReliefShading::soft(step as f32 * 0.01)).collect();
        assert!(shown.windows(2).all(|pair| pair[1] - pair[0] > 2e-4 && pair[1] - pair[0] < 0.011));
        assert!(shown[0] > ReliefShading::DARKEST && shown[300] < ReliefShading::BRIGHTEST);
        assert_eq!(ReliefShading::soft(1.0), 1.0);
        for brightness in [-3.0, 0.0, 0.4, 0.5, 0.8, 1.3] {
            let back = ReliefShading::hard(ReliefShading::soft(brightness));
            assert!((back - brightness).abs() < 1e-4, "{brightness}: {back}");
        }
        assert_eq!(ReliefShading::hard(ReliefShading::DARKEST), f32::NEG_INFINITY);
    }

    #[test]
    fn side_lights_are_unit_vectors_around_the_sun() {
        for to_sun in [Lighting::default().to_sun, Vec3::Z, Vec3::new(0.6, 0.0, 0.8)] {
            let shading = ReliefShading::new(to_sun);
            assert!(shading.sides.iter().all(|side| side.is_normalized()), "{to_sun}");
            assert!(shading.sides[2].truncate().perp_dot(to_sun.truncate()).abs() < 1e-6, "{to_sun}");
        }
    }

    #[test]
    fn haze_begins_at_its_near_distance() {
        let haze = Haze { near_m: 100.0, distance_m: 50.0, ..Lighting::default().haze };
        let lighting = Lighting { haze, ..Lighting::default() };
        assert_eq!(lighting.add_haze(Vec3::ONE, 99.0), Vec3::ONE);
        let share = (Vec3::ONE - lighting.add_haze(Vec3::ONE, 150.0)) / (Vec3::ONE - haze.color);
        assert!(share.abs_diff_eq(Vec3::splat(0.632), 1e-3), "{share}");
        for turned_m in [10.0, 120.0] {
            let turned = lighting.add_haze(lighting.add_haze_beyond(Vec3::ONE, turned_m, 170.0), turned_m);
            assert!(turned.abs_diff_eq(lighting.add_haze(Vec3::ONE, 170.0), 1e-5), "{turned}");
        }
    }
}
