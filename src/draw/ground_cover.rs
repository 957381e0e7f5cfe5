//! Natural land cover, inferred: woods, meadow, scree, rock and snow by elevation, slope, aspect, hollows and climate, as
//! tints over the ramp's, with the texture of each.
//!
//! Trees grow where it is moist enough: it is moister on high ground, on shady slopes and in hollows. They leave level low
//! ground to fields, which lie in plots of grass, dry crops and soil, and end at the tree line; snow begins at the snow line; both
//! lie higher on slopes toward the equator. Scree lies up to its angle of repose, about 36°; what is steeper is rock, and holds no
//! snow. [`CoverNoise`] moves all borders, so that they look grown and not drawn.
//!
//! Each cover keeps the tint's luminance but for a factor that is at most 12 of lightness L*: relief and tint by height stay
//! readable. Near the eye crowns make woods rough, strata run through rock, and ridges too small for the model's cells shade
//! the ground: symbols of what such ground looks like, which change no height.

use glam::{Vec2, Vec3};

use crate::color::{Srgba, luminance};
use crate::cover_noise::CoverNoise;
use crate::field_plots::field_tone;
use crate::ground::GroundPost;
use crate::ground_grain::{WIDE_PX, noise};
use crate::lanes::{LANES, in_lanes, mix, of_each, smooth, unit};
use crate::shown::shown;

/// How far the noise moves the borders between covers, in meters of elevation and in rise.
pub(crate) const UNEVEN_M: f32 = 130.0;
pub(crate) const UNEVEN_RISE: f32 = 0.15;
/// How much higher shady ground counts than sunny ground where it is as steep as 45°, in meters.
pub(crate) const ASPECT_M: f32 = 150.0;
/// From and to which rise scree and rock take the place of what grows, in a moist climate.
pub(crate) const SCREE_RISE: [f32; 2] = [0.50, 0.66];
pub(crate) const ROCK_RISE: [f32; 2] = [0.78, 1.08];
/// The share of these in a desert, whose slopes are bare.
pub(crate) const DRY_RISE: f32 = 0.55;
/// How far below the tree line meadows begin and below the snow line they end, and half the width of the snow's border;
/// meters.
pub(crate) const MEADOW_M: [f32; 3] = [300.0, 500.0, 200.0];
/// What is added to the climate's moisture: for a meter of elevation, on a slope of 45° in the shade, in a hollow without
/// sky, and by the noise.
pub(crate) const MOISTER: [f32; 4] = [1.5e-4, 0.35, 0.5, 0.22];
/// From and to which moisture trees grow.
pub(crate) const WOODS_MOISTURE: [f32; 2] = [0.46, 0.72];
/// From and to which rise woods leave no fields, and the patches of the noise that are copses on level ground.
pub(crate) const WOODS_RISE: [f32; 2] = [0.04, 0.20];
pub(crate) const COPSES: [f32; 2] = [0.12, 0.36];
/// From and to which share of the tree line's elevation ground is left to fields no more: woods stand on level ground too, but
/// for clearings.
pub(crate) const WILD: [f32; 2] = [0.3, 0.55];
/// The share of level ground that woods take there where no copse stands.
pub(crate) const WILD_WOODS: f32 = 0.8;
/// The greatest share of meadows among fields.
pub(crate) const FIELD_MEADOW: f32 = 0.5;
/// From and to which moisture land is farmed, and from and to which rise no more; low and level ground alone is.
pub(crate) const FARMED_MOISTURE: [f32; 2] = [0.30, 0.48];
pub(crate) const FARMED_RISE: [f32; 2] = [0.08, 0.22];
/// By how much the tones of plots follow the patches of the noise: one valley has more grass, another more crops.
pub(crate) const FARMED_PATCHES: f32 = 0.8;
/// The greatest share of a cover over the tint.
pub(crate) const MOST: f32 = 0.85;
/// The share of a cover's own hue: the rest is the tint's, which tells heights through all covers, as in the cross-blended
/// hypsometric tints of Patterson and Jenny (2011). Outside deserts what grows has the second share at the tree
/// line: mountain woods and meadows are thinner.
pub(crate) const HUE: [f32; 2] = [0.58, 0.26];
/// The part of that change which meadows take: above the trees nothing else is green.
pub(crate) const MEADOW_CLIMB: f32 = 0.5;
/// From and to which share of the tree line's elevation it changes: woods of hills are whole.
pub(crate) const HUE_CLIMB: [f32; 2] = [0.56, 1.0];
/// From and to which moisture of the climate it changes with height: tints of a desert are all tan, and woods alone are green.
pub(crate) const HUE_MOISTURE: [f32; 2] = [0.18, 0.36];
/// By how much the light of a cover's patches, of crowns, of strata in rock differs from the mean at the most.
pub(crate) const PATCHES: f32 = 0.17;
pub(crate) const CROWNS: f32 = 0.50;
pub(crate) const STRATA: f32 = 0.24;
/// The same of grass and stones on open ground.
pub(crate) const TUFTS: f32 = 0.20;
/// From and to which noise shrubs stand on open ground, and the share of the color of woods that they have.
pub(crate) const SHRUBS: [f32; 2] = [0.16, 0.46];
pub(crate) const SHRUB_SHARE: f32 = 0.32;
/// Wavelengths of strata in meters of elevation.
pub(crate) const STRATA_M: [f32; 3] = [13.0, 47.0, 171.0];
/// The rise of forms too small for the cells: on level ground, and its part of the ground's own rise.
pub(crate) const FORM_LEVEL: f32 = 0.03;
pub(crate) const FORM_RISE: f32 = 0.6;
/// By how much their ridges are lighter and what lies between darker on ground as steep as 45°: shade alone shows none of
/// them.
pub(crate) const RIDGES: f32 = 0.4;

/// No plot is seen by a pixel less wide, meters.
pub(crate) const LEAST_PIXEL_M: f32 = 1e-3;

/// The covers of ground, and where they change.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GroundCover {
    /// The elevation of the tree line, meters.
    pub tree_m: f32,
    /// The elevation of the snow line, meters; above the tree line.
    pub snow_m: f32,
    /// The ratio of true slopes to drawn slopes; positive.
    pub true_rise: f32,
    /// 1 where the shady side is the north, −1 where it is the south.
    pub shady_north: f32,
    /// The climate's moisture at sea level: 0 in a desert, 1 where it rains all year.
    pub moisture: f32,
    /// Whether the ground is drawn with forms too small for its cells: not under a picture, which shows its own.
    pub has_forms: bool,
    /// The colors of woods, meadow, scree, rock, snow, crops and tilled soil.
    pub colors: [CoverColor; 7],
}

/// The color of a cover: a hue at the tint's own luminance, times a factor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CoverColor {
    /// Linear light of luminance 1.
    pub hue: Vec3,
    /// The factor on the tint's luminance.
    pub light: f32,
}

impl CoverColor {
    /// The hue of `color`, which is not black, at `light` times the luminance of the tint.
    pub fn new(color: Srgba, light: f32) -> Self {
        let linear = color.linear().max(Vec3::splat(1e-3));
        Self { hue: linear / luminance(linear), light }
    }

    /// The mean of two colors, weighted by `share` for `other`.
    pub fn lerp(&self, other: &Self, share: f32) -> Self {
        Self { hue: self.hue.lerp(other.hue, share), light: mix(self.light, other.light, share) }
    }
}

/// A pixel of land.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LandPixel {
    /// The color of the ramp in linear light.
    pub tint: Vec3,
    /// The map's values.
    pub post: GroundPost,
    /// The change of the elevation across the pixel, meters.
    pub change_m: f32,
    /// The noise of the place; read where the map has a cover.
    pub noise: CoverNoise,
}

impl GroundCover {
    /// The color of a covered pixel in linear light.
    pub fn over(&self, pixel: &LandPixel) -> Vec3 {
        let [color] = self.together(&[*pixel]);
        color
    }

    /// [`Self::over`] of each of `pixels`, in less time.
    pub fn over_each(&self, pixels: &[LandPixel]) -> Vec<Vec3> {
        let filler = LandPixel {
            tint: Vec3::ZERO,
            post: GroundPost::default(),
            change_m: f32::INFINITY,
            noise: CoverNoise::none(),
        };
        in_lanes(
            pixels,
            filler,
            #[inline(always)]
            |pixels: &[LandPixel; LANES]| self.together(pixels),
        )
    }

    #[inline(always)]
    fn together<const N: usize>(&self, pixels: &[LandPixel; N]) -> [Vec3; N] {
        let mut lanes = CoverLanes::new(pixels);
        lanes.share_out(self);
        // Nearly everywhere there are no fields, and no rock, whose layers would be noise for nothing.
        for (lane, LandPixel { post, change_m, noise, .. }) in pixels.iter().enumerate() {
            if lanes.farmed[lane] > 0.0 {
                let plot = field_tone(noise.at, noise.longest_m.max(LEAST_PIXEL_M));
                lanes.tone[lane] = (plot + FARMED_PATCHES * noise.patch).clamp(-1.0, 1.0);
            }
            if lanes.layered[lane] > 0.0 {
                lanes.texture[lane] +=
                    STRATA * lanes.layered[lane] * strata(post.height_m, *change_m, noise.uneven);
            }
        }
        let [red, green, blue] = [lanes.color(self, 0), lanes.color(self, 1), lanes.color(self, 2)];
        std::array::from_fn(|lane| Vec3::new(red[lane], green[lane], blue[lane]))
    }

    /// The rise eastward and northward of the drawn forms that are too small for the cells of the map, where it reads `post` and
    /// theirs is `small` in the [noise](CoverNoise::form) of the place. None under water.
    pub fn form(&self, post: &GroundPost, small: Vec2) -> Vec2 {
        if !self.has_forms {
            return Vec2::ZERO;
        }
        let rise = Vec2::new(post.slope_east, post.slope_north).length().min(1.0);
        let dry = (1.0 - 4.0 * post.water.max(0.0)).max(0.0);
        small * ((FORM_LEVEL / self.true_rise + FORM_RISE * rise) * dry)
    }
}

/// The covers of several pixels.
struct CoverLanes<const N: usize> {
    tint: [[f32; N]; 3],
    /// The luminance of the tint.
    own: [f32; N],
    height_m: [f32; N],
    slope_east: [f32; N],
    slope_north: [f32; N],
    sky_visibility: [f32; N],
    uneven: [f32; N],
    patch: [f32; N],
    fine: [f32; N],
    ridge: [f32; N],
    meadow: [f32; N],
    farmed: [f32; N],
    /// The tone of plots, from grass at -1 to soil at 1.
    tone: [f32; N],
    woods: [f32; N],
    /// The share of their own hue that woods have.
    wooded_hue: [f32; N],
    scree: [f32; N],
    rock: [f32; N],
    snow: [f32; N],
    shrubs: [f32; N],
    /// The share of rock and scree that shows its layers.
    layered: [f32; N],
    /// By how much the light differs from the mean.
    texture: [f32; N],
}

impl<const N: usize> CoverLanes<N> {
    #[inline(always)]
    fn new(pixels: &[LandPixel; N]) -> Self {
        let none = [0.0; N];
        Self {
            tint: [
                of_each(pixels, |at| at.tint.x),
                of_each(pixels, |at| at.tint.y),
                of_each(pixels, |at| at.tint.z),
            ],
            own: of_each(pixels, |at| luminance(at.tint)),
            height_m: of_each(pixels, |at| at.post.height_m),
            slope_east: of_each(pixels, |at| at.post.slope_east),
            slope_north: of_each(pixels, |at| at.post.slope_north),
            sky_visibility: of_each(pixels, |at| at.post.sky_visibility),
            uneven: of_each(pixels, |at| at.noise.uneven),
            patch: of_each(pixels, |at| at.noise.patch),
            fine: of_each(pixels, |at| at.noise.fine),
            ridge: of_each(pixels, |at| at.noise.ridge),
            meadow: none,
            farmed: none,
            tone: none,
            woods: none,
            wooded_hue: none,
            scree: none,
            rock: none,
            snow: none,
            shrubs: none,
            layered: none,
            texture: none,
        }
    }

    /// The share of each cover, and its texture but for the layers of rock.
    #[inline(always)]
    fn share_out(&mut self, cover: &GroundCover) {
        let ridges = if cover.has_forms { RIDGES } else { 0.0 };
        let [higher, shadier, hollower, noisier] = MOISTER;
        let [below_trees, below_snow, half] = MEADOW_M;
        let [hue, high] = HUE;
        let thinner = (high - hue) * step(cover.moisture, HUE_MOISTURE);
        for lane in 0..N {
            let [uneven, patch, fine] = [self.uneven[lane], self.patch[lane], self.fine[lane]];
            let [east, north] = [self.slope_east[lane], self.slope_north[lane]];
            let shade = 1.0 - 2.0 * unit(0.5 + 0.5 * cover.true_rise * cover.shady_north * north);
            let height = self.height_m[lane] + UNEVEN_M * uneven + ASPECT_M * shade;
            let steep = cover.true_rise * (east * east + north * north).sqrt();
            let rise = steep + UNEVEN_RISE * uneven;
            let hollow = unit(1.0 - self.sky_visibility[lane]);
            let moist = cover.moisture
                + higher * self.height_m[lane]
                + shadier * shade
                + hollower * hollow
                + noisier * uneven;
            let above_trees = step(height, [cover.tree_m - below_trees, cover.tree_m]);
            let below_snow = 1.0 - step(height, [cover.snow_m - below_snow, cover.snow_m]);
            let green = step(moist, WOODS_MOISTURE);
            let wild = step(height, [WILD[0] * cover.tree_m, WILD[1] * cover.tree_m]);
            let sloping = step(rise, WOODS_RISE);
            let alone = if sloping > WILD_WOODS * wild { sloping } else { WILD_WOODS * wild };
            let woods = (1.0 - above_trees) * green * mix(step(patch + fine, COPSES), 1.0, alone);
            let fields = FIELD_MEADOW * green * (1.0 - wild) * unit(0.5 + patch);
            let bare = mix(DRY_RISE, 1.0, step(moist, [0.0, WOODS_MOISTURE[1]]));
            let grown = if above_trees > 1.0 - green { above_trees } else { 1.0 - green };
            let scree = grown * step(rise, [SCREE_RISE[0] * bare, SCREE_RISE[1] * bare]);
            let rock = step(rise, [ROCK_RISE[0] * bare, ROCK_RISE[1] * bare]);
            let snow = step(height, [cover.snow_m - half, cover.snow_m + half]) * (1.0 - rock);
            let farmed = step(moist, FARMED_MOISTURE)
                * (1.0 - step(rise, FARMED_RISE))
                * (1.0 - wild)
                * (1.0 - above_trees);
            let open = 1.0 - snow;
            let stony = scree * (1.0 - green);
            let layered = if rock > stony { rock } else { stony };
            let bushy = (1.0 - above_trees) * (1.0 - woods) * (1.0 - rock) * (1.0 - farmed) * open;
            let rough = mix(TUFTS, CROWNS, woods * (1.0 - rock) * open);
            self.meadow[lane] = mix(fields, below_snow, above_trees);
            self.farmed[lane] = farmed;
            self.woods[lane] = woods;
            let climb = step(height, [HUE_CLIMB[0] * cover.tree_m, HUE_CLIMB[1] * cover.tree_m]);
            self.wooded_hue[lane] = hue + thinner * climb;
            self.scree[lane] = scree;
            self.rock[lane] = rock;
            self.snow[lane] = snow;
            self.shrubs[lane] = bushy * step(fine + 0.5 * patch, SHRUBS);
            self.layered[lane] = layered * open;
            self.texture[lane] =
                (PATCHES * patch + rough * fine) * open + ridges * self.ridge[lane] * unit(steep);
        }
    }

    /// The red, green or blue of all covers laid one over the other.
    #[inline(always)]
    fn color(&self, cover: &GroundCover, channel: usize) -> [f32; N] {
        let [woods, meadow, scree, rock, snow, crops, soil] = cover.colors.map(
            #[inline(always)]
            |color| ChannelColor { hue: color.hue[channel], light: color.light },
        );
        let mut made = [0.0; N];
        for (lane, made) in made.iter_mut().enumerate() {
            let (tint, own) = (self.tint[channel][lane], self.own[lane]);
            let laid = |color: f32, cover: ChannelColor, hue_share: f32, share: f32| {
                mix(color, mix(tint, cover.hue * own, hue_share) * cover.light, MOST * share)
            };
            let tone = self.tone[lane];
            let (grassy, bare) = (unit(-tone), unit(tone));
            let plots = ChannelColor {
                hue: crops.hue + (meadow.hue - crops.hue) * grassy + (soil.hue - crops.hue) * bare,
                light: crops.light
                    + (meadow.light - crops.light) * grassy
                    + (soil.light - crops.light) * bare,
            };
            let (hue, wooded) = (HUE[0], self.wooded_hue[lane]);
            let mut color = laid(tint, meadow, mix(hue, wooded, MEADOW_CLIMB), self.meadow[lane]);
            color = laid(color, plots, hue, self.farmed[lane]);
            color = laid(color, woods, wooded, self.woods[lane]);
            color = laid(color, scree, hue, self.scree[lane]);
            color = laid(color, rock, hue, self.rock[lane]);
            // Snow hides the ground that heights color.
            color = laid(color, snow, 1.0, self.snow[lane]);
            color = mix(color, woods.hue * own * woods.light, SHRUB_SHARE * self.shrubs[lane]);
            let light = 1.0 + self.texture[lane];
            *made = color * if light > 0.3 { light } else { 0.3 };
        }
        made
    }
}

/// One channel of a [`CoverColor`].
#[derive(Clone, Copy)]
struct ChannelColor {
    hue: f32,
    light: f32,
}

/// Layers of rock at a height that changes by `change_m` across a pixel, -1..=1; `uneven` bends them.
fn strata(height_m: f32, change_m: f32, uneven: f32) -> f32 {
    let mut sum = 0.0;
    for wave_m in STRATA_M {
        let shown = shown(wave_m, WIDE_PX, change_m.max(1e-6));
        if shown > 0.0 {
            sum += shown * noise(Vec2::new(height_m / wave_m + 2.0 * uneven, 0.5));
        }
    }
    sum
}

#[inline(always)]
fn step(value: f32, [from, to]: [f32; 2]) -> f32 {
    smooth(unit((value - from) / (to - from)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::lightness;

    const TINT: Vec3 = Vec3::new(0.62, 0.60, 0.45);

    fn alps() -> GroundCover {
        let color = |red, green, blue, light| CoverColor::new(Srgba::opaque(red, green, blue), light);
        GroundCover {
            tree_m: 2100.0,
            snow_m: 2900.0,
            true_rise: 1.0,
            shady_north: 1.0,
            moisture: 0.9,
            has_forms: true,
            colors: [
                color(88, 116, 76, 0.64),
                color(168, 178, 118, 0.97),
                color(176, 170, 160, 0.97),
                color(150, 145, 142, 0.8),
                color(240, 244, 250, 1.2),
                color(226, 202, 128, 1.08),
                color(186, 150, 112, 0.88),
            ],
        }
    }

    fn seen(cover: &GroundCover, post: GroundPost, noise: CoverNoise) -> Vec3 {
        cover.over(&LandPixel { tint: TINT, post, change_m: 1e3, noise })
    }

    fn post(height_m: f32, slope_north: f32) -> GroundPost {
        GroundPost { height_m, slope_north, sky_visibility: 1.0, ..GroundPost::default() }
    }

    #[test]
    fn no_cover_changes_lightness_by_more_than_12_from_afar() {
        for height in (0..4500).step_by(50) {
            for rise in -15..15 {
                for uneven in [-1.0, 0.0, 1.0] {
                    let noise = CoverNoise { uneven, ..CoverNoise::default() };
                    let shown = seen(&alps(), post(height as f32, rise as f32 * 0.1), noise);
                    let change = lightness(shown) - lightness(TINT);
                    assert!(change.abs() <= 12.0, "{height} m, rise {rise}: {change}");
                }
            }
        }
    }

    #[test]
    fn woods_lie_under_meadows_under_snow_and_walls_are_rock() {
        let noise = CoverNoise { patch: -0.6, ..CoverNoise::default() };
        let seen = |height: f32, rise: f32| seen(&alps(), post(height, rise), noise);
        assert!(seen(1000.0, 0.3).y > 1.15 * seen(1000.0, 0.3).x, "woods on slopes");
        assert!(lightness(seen(500.0, 0.0)) > lightness(seen(500.0, 0.3)) + 4.0, "fields in valleys");
        assert!(lightness(seen(1300.0, 0.0)) < lightness(seen(500.0, 0.0)) - 3.0, "woods on plateaus");
        assert!(seen(2250.0, 0.1).y / seen(2250.0, 0.1).x > 1.05 * TINT.y / TINT.x, "green");
        assert!(seen(3500.0, 0.1).z > 0.95 * seen(3500.0, 0.1).x, "snow is cool");
        assert!(lightness(seen(1000.0, 1.5)) < lightness(TINT) - 3.0, "rock is dark");
        assert_eq!(seen(3500.0, 1.5), seen(4500.0, 1.5), "and holds no snow");
        assert!(seen(2900.0, -0.4).z > seen(2900.0, 0.4).z, "shady slopes keep snow longer");
    }

    #[test]
    fn heights_show_through_woods_of_all_climates_but_deserts() {
        let [desert, steppe] = [0.18, 0.36].map(|moisture| GroundCover { moisture, ..alps() });
        let green = |cover: &GroundCover, height: f32| {
            let shown = seen(cover, post(height, -0.3), CoverNoise::default());
            shown.y / shown.x
        };
        assert!(green(&alps(), 100.0) > green(&alps(), 1850.0) + 0.08);
        // Where the noise is moist, trees stand in both.
        let wooded = |cover: &GroundCover| {
            let shown = seen(cover, post(1650.0, -0.3), CoverNoise { uneven: 1.0, ..CoverNoise::default() });
            shown.y / shown.x
        };
        assert!(wooded(&desert) > wooded(&steppe) + 0.05, "{} {}", wooded(&desert), wooded(&steppe));
    }

    #[test]
    fn deserts_have_trees_on_high_and_shady_ground_alone() {
        let desert = GroundCover { moisture: 0.15, tree_m: 3500.0, snow_m: 4500.0, ..alps() };
        let green = |height: f32, rise: f32| {
            let shown = seen(&desert, post(height, rise), CoverNoise::default());
            shown.y / shown.x
        };
        assert!((green(300.0, 0.2) - TINT.y / TINT.x).abs() < 0.02, "{}", green(300.0, 0.2));
        assert!(green(3000.0, -0.3) > 1.15 * green(300.0, -0.3));
        assert!(green(2200.0, -0.3) > 1.05 * green(2200.0, 0.3));
    }

    #[test]
    fn forms_grow_with_slope_and_there_are_none_under_water_or_a_picture() {
        let rise = |post: &GroundPost| alps().form(post, Vec2::X).x;
        assert!(rise(&post(0.0, 0.5)) > 3.0 * rise(&post(0.0, 0.0)));
        assert_eq!(rise(&GroundPost { water: 0.6, ..post(0.0, 0.5) }), 0.0);
        assert_eq!(GroundCover { has_forms: false, ..alps() }.form(&post(0.0, 0.5), Vec2::X), Vec2::ZERO);
    }

    #[test]
    fn pixels_together_have_the_colors_that_each_has_alone() {
        let pixels: Vec<LandPixel> = (0..997)
            .map(|index| {
                let [a, b, c, d] = [7, 11, 13, 17].map(|every| (index % every) as f32 / every as f32);
                let noise = CoverNoise {
                    uneven: a - 0.5,
                    patch: 1.4 * b - 0.7,
                    fine: 1.4 * c - 0.7,
                    ridge: d - 0.5,
                    at: Vec2::new(31.0 * index as f32, 900.0 * a),
                    longest_m: 3.0,
                    ..CoverNoise::default()
                };
                let post = GroundPost { slope_east: 2.0 * c - 1.0, ..post(3000.0 * d, 1.8 * a - 0.6) };
                LandPixel { tint: TINT * (0.5 + b), post, change_m: 3.0 * b, noise }
            })
            .collect();
        let bits = |color: Vec3| color.to_array().map(f32::to_bits);
        let alone = pixels.iter().map(|pixel| bits(alps().over(pixel)));
        assert!(alone.eq(alps().over_each(&pixels).into_iter().map(bits)));
    }

    #[test]
    fn strata_follow_heights_and_fade_from_afar() {
        assert!(strata(500.0, 0.5, 0.0) != strata(506.0, 0.5, 0.0));
        assert_eq!(strata(500.0, 50.0, 0.0), 0.0);
    }
}
