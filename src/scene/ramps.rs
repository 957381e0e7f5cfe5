//! The named ramps: colors of the ground by height, whose lightness rises with it all the way, so that tint never works
//! against shade.
//!
//! `atlas` means land cover: green where trees grow, near white where snow lies all year. A model that reaches neither
//! the tree line nor the snow line of its latitude shows only the tints between. Its tints are those of the place's climate,
//! after the cross-blended hypsometric tints of Patterson and Jenny (2011): lowlands are green where it rains, olive where
//! it rains in one season, the color of sand in deserts, gray green in the tundra, and fresher beside a sea. The other ramps mean nothing but height
//! and span the model's range. `viridis` and `cividis` are perceptually uniform: equal steps of height differ equally to
//! the eye, to one that tells no red from green too (Smith and van der Walt 2015; Nuñez, Anderton and Renslow 2018).

use crate::climate::Climate;
use crate::land_cover::TRANSITION_M;
use sandtable_description::words::RampName;
use sandtable_draw::color::Srgba;
use sandtable_draw::ground::ColorRamp;

/// Where the tints of an atlas stand, of all its tints.
const ATLAS_PARTS: [f32; 7] = [0.0, 0.18, 0.38, 0.56, 0.74, 0.90, 1.0];
/// The tints of an atlas from the green of lowlands to the white of snow, L* 61 to 94, in middle latitudes.
const HUMID: [[u8; 3]; 7] = [
    [122, 156, 116],
    [154, 180, 128],
    [192, 200, 146],
    [216, 208, 162],
    [226, 212, 180],
    [234, 225, 206],
    [243, 239, 231],
];
/// The same in the tropics.
const TROPICAL: [[u8; 3]; 7] = [
    [104, 152, 104],
    [134, 174, 106],
    [176, 196, 116],
    [212, 204, 140],
    [224, 208, 164],
    [234, 224, 202],
    [243, 239, 231],
];
/// The same beside a sea, whose air is moist and whose plains are low.
const COASTAL: [[u8; 3]; 7] = [
    [126, 164, 134],
    [158, 186, 142],
    [194, 206, 158],
    [216, 212, 170],
    [226, 215, 184],
    [234, 225, 207],
    [243, 239, 231],
];
/// The same where it rains in one season: steppe, chaparral, the Mediterranean.
const SEMIARID: [[u8; 3]; 7] = [
    [174, 174, 128],
    [192, 187, 140],
    [208, 198, 154],
    [219, 205, 166],
    [227, 212, 182],
    [235, 225, 206],
    [243, 239, 231],
];
/// The same in deserts.
const ARID: [[u8; 3]; 7] = [
    [194, 146, 110],
    [211, 165, 121],
    [222, 182, 138],
    [227, 196, 157],
    [231, 210, 180],
    [237, 225, 207],
    [243, 239, 231],
];
/// The same beyond the polar circles.
const POLAR: [[u8; 3]; 7] = [
    [138, 152, 134],
    [160, 170, 150],
    [186, 190, 172],
    [206, 207, 194],
    [219, 221, 215],
    [231, 234, 235],
    [242, 245, 248],
];
/// The dryness of a place whose tints are those of [`SEMIARID`], and where those of [`HUMID`] end and those of [`ARID`] begin.
const DRY_TINTS: [f64; 3] = [0.16, 0.5, 0.85];
/// The share of the tints of [`COASTAL`] beside a sea.
const COASTAL_SHARE: f32 = 0.7;
/// Where the atlas' tints are those of open ground above trees, and where those of snow begin.
const OPEN: f32 = 0.38;
const SNOW: f32 = 0.9;
/// The least share of the range of heights below the snow line: a model of an ice cap alone still shows its height.
const LEAST_BELOW_SNOW: f64 = 0.4;

/// The tints of a desert, L* 46 to 92: red rock, ochre, sand, pale heights.
const DESERT: [(f32, [u8; 3]); 5] = [
    (0.0, [156, 96, 72]),
    (0.25, [184, 124, 86]),
    (0.5, [210, 158, 110]),
    (0.78, [226, 196, 148]),
    (1.0, [242, 228, 202]),
];

/// Neutral tints for overlays.
const GRAY: [(f32, [u8; 3]); 2] = [(0.0, [168, 168, 168]), (1.0, [236, 236, 236])];

/// Stops of a ramp that a formula gives: enough that straight lines between them are the formula to a step of 8 bits.
const FORMULA_STOPS: u8 = 32;
/// The part of a scientific ramp that is left out at its dark end, where shade could not be seen.
const DARK_PART: f64 = 0.25;

/// The properties of the ground that its colors depend on, besides the ramp.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TintedGround {
    /// The lowest and the highest ground in meters that is not the bed of a sea.
    pub range_m: (f32, f32),
    /// Its climate.
    pub climate: Climate,
    /// Whether a sea lies at its foot.
    pub has_sea: bool,
}

/// The ramp called `name` over the heights of `ground`.
pub fn named(name: RampName, ground: &TintedGround) -> ColorRamp {
    match name {
        RampName::Atlas => atlas(ground),
        RampName::Desert => stretched(stops(&DESERT), ground.range_m),
        RampName::Gray => stretched(stops(&GRAY), ground.range_m),
        RampName::Viridis => stretched(formula(colorous::VIRIDIS), ground.range_m),
        RampName::Cividis => stretched(formula(colorous::CIVIDIS), ground.range_m),
    }
}

/// The ramp of an atlas: the default.
pub fn atlas(ground: &TintedGround) -> ColorRamp {
    let tints = ColorRamp::new(tints(ground)).expect("the parts rise");
    let (low, high) = (f64::from(ground.range_m.0), f64::from(ground.range_m.1));
    let lines = ground.climate.lines();
    let above =
        |line_m: f64, height_m: f64| ((height_m - line_m) / TRANSITION_M + 0.5).clamp(0.0, 1.0) as f32;
    let first = OPEN * above(lines.tree_m, low);
    let span = high - low;
    let below_snow = if span > 0.0 { ((lines.snow_m - low) / span).max(LEAST_BELOW_SNOW) } else { 1.0 };
    // Heights and tints as parts of theirs, from which the rest follows by straight lines.
    let anchors = match below_snow < 1.0 {
        true => vec![(0.0, first), (below_snow as f32, SNOW), (1.0, 1.0)],
        false => vec![(0.0, first), (1.0, SNOW)],
    };
    let mut parts = Vec::new();
    for pair in anchors.windows(2) {
        let ((from, from_tint), (to, to_tint)) = (pair[0], pair[1]);
        let height = |tint: f32| from + (to - from) * (tint - from_tint) / (to_tint - from_tint);
        let inner = ATLAS_PARTS.into_iter().filter(|&tint| from_tint < tint && tint < to_tint);
        let mut stop =
            |height: f32, tint: f32| parts.push((height, Srgba::from_linear(tints.linear_at(tint))));
        stop(from, from_tint);
        inner.for_each(|tint| stop(height(tint), tint));
    }
    let (end, tint) = anchors[anchors.len() - 1];
    parts.push((end, Srgba::from_linear(tints.linear_at(tint))));
    stretched(parts, ground.range_m)
}

/// The tints of an atlas in the climate of a ground.
fn tints(TintedGround { climate, has_sea, .. }: &TintedGround) -> Vec<(f32, Srgba)> {
    let [humid, semiarid, arid] = DRY_TINTS;
    let share = |from: f64, to: f64| ((climate.dryness - from) / (to - from)).clamp(0.0, 1.0) as f32;
    let tint = |index: usize| {
        let [wet, tropics, steppe, desert, tundra, coast] = [HUMID, TROPICAL, SEMIARID, ARID, POLAR, COASTAL]
            .map(|table| Srgba::opaque(table[index][0], table[index][1], table[index][2]).linear());
        let moist = wet.lerp(tropics, climate.tropical as f32);
        let beside = if *has_sea { COASTAL_SHARE } else { 0.0 };
        let seasonal = moist.lerp(steppe, share(humid, semiarid)).lerp(coast, beside);
        let dry = seasonal.lerp(desert, share(semiarid, arid));
        Srgba::from_linear(dry.lerp(tundra, climate.polar as f32))
    };
    ATLAS_PARTS.into_iter().enumerate().map(|(index, part)| (part, tint(index))).collect()
}

fn stops(table: &[(f32, [u8; 3])]) -> Vec<(f32, Srgba)> {
    table.iter().map(|&(part, [r, g, b])| (part, Srgba::opaque(r, g, b))).collect()
}

fn formula(gradient: colorous::Gradient) -> Vec<(f32, Srgba)> {
    let stop = |number: u8| {
        let part = f64::from(number) / f64::from(FORMULA_STOPS - 1);
        let color = gradient.eval_continuous(DARK_PART + (1.0 - DARK_PART) * part);
        (part as f32, Srgba::opaque(color.r, color.g, color.b))
    };
    (0..FORMULA_STOPS).map(stop).collect()
}

/// Stops at parts of a range of heights as stops at heights.
fn stretched(stops: Vec<(f32, Srgba)>, (low, high): (f32, f32)) -> ColorRamp {
    // Level ground far from 0 still needs stops that an f32 can tell apart.
    let span = (high - low).max(1.0).max(low.abs() * 1e-4);
    let stops = stops.into_iter().map(|(part, color)| (low + span * part, color)).collect();
    ColorRamp::new(stops).expect("the parts rise, and the span is wide enough for an f32 to tell them apart")
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec2;
    use sandtable_base::message::choice::Choice;
    use sandtable_draw::color::lightness;

    /// Ground in the east of North America, where it rains all year.
    fn ground(low: f32, high: f32, latitude: f64) -> TintedGround {
        at(low, high, -78.0, latitude)
    }

    fn at(low: f32, high: f32, longitude: f64, latitude: f64) -> TintedGround {
        TintedGround {
            range_m: (low, high),
            climate: Climate::at(Some(DVec2::new(longitude, latitude))),
            has_sea: false,
        }
    }

    fn lightness_of(ramp: &ColorRamp) -> Vec<f32> {
        ramp.table(256).into_iter().map(lightness).collect()
    }

    #[test]
    fn the_lightness_of_every_ramp_rises_with_height_on_any_ground() {
        for choice in RampName::CHOICES {
            for at in [(0.0, 1073.0, 36.0), (0.0, 8848.0, 28.0), (3900.0, 4100.0, 30.0), (0.0, 900.0, 78.0)] {
                let all = lightness_of(&named(choice.value, &ground(at.0, at.1, at.2)));
                // A step of 8 bits is 0.4 of lightness.
                assert!(all.windows(2).all(|pair| pair[1] > pair[0] - 0.05), "{}: {all:?}", choice.word);
                assert!(all[255] - all[0] > 5.0, "{}: {} to {}", choice.word, all[0], all[255]);
                assert!(all[0] > 25.0, "{}: shade shows on its darkest tint", choice.word);
            }
        }
    }

    #[test]
    fn lowlands_have_the_tints_of_their_climate_and_all_grow_lighter_with_height() {
        let ramp = |longitude: f64, latitude: f64| atlas(&at(0.0, 900.0, longitude, latitude));
        let lowest = |longitude: f64, latitude: f64| ramp(longitude, latitude).stops()[0].1;
        let (sahara, amazon, wales) = (lowest(10.0, 24.0), lowest(-65.0, -3.0), lowest(-4.0, 52.0));
        assert!(sahara.x > 1.3 * sahara.y && amazon.y > 1.8 * amazon.x, "{sahara} {amazon}");
        assert!(wales.y > 1.4 * wales.x && wales != amazon, "{wales}");
        let cape = lowest(20.4, -34.0);
        assert!((0.85..1.15).contains(&(cape.y / cape.x)), "olive: {cape}");
        for (longitude, latitude) in
            [(10.0, 24.0), (-65.0, -3.0), (20.4, -34.0), (-112.0, 37.3), (16.0, 78.0)]
        {
            let all = lightness_of(&ramp(longitude, latitude));
            assert!(all.windows(2).all(|pair| pair[1] > pair[0] - 0.05), "{longitude} {latitude}: {all:?}");
            assert!(all[0] > 50.0 && all[255] > all[0] + 15.0, "{longitude} {latitude}");
        }
    }

    #[test]
    fn ground_beside_a_sea_is_fresher_but_in_deserts_and_grows_lighter_with_height() {
        for (longitude, latitude) in [(-4.0, 52.0), (7.4, 43.7), (20.4, -34.0), (16.0, 78.0), (100.0, 8.0)] {
            let inland = at(0.0, 900.0, longitude, latitude);
            let coast = atlas(&TintedGround { has_sea: true, ..inland });
            let [beside, away] = [&coast, &atlas(&inland)].map(|ramp| ramp.stops()[0].1);
            assert!(beside.z / beside.x >= away.z / away.x, "{longitude} {latitude}: {beside} {away}");
            let all = lightness_of(&coast);
            assert!(all.windows(2).all(|pair| pair[1] > pair[0] - 0.05), "{longitude} {latitude}: {all:?}");
        }
        let desert = at(0.0, 900.0, 10.0, 24.0);
        let [coast, inland] = [true, false].map(|has_sea| atlas(&TintedGround { has_sea, ..desert }));
        assert!((coast.stops()[0].1 - inland.stops()[0].1).length() < 0.05);
    }

    #[test]
    fn scientific_ramps_change_lightness_evenly() {
        for name in [RampName::Viridis, RampName::Cividis] {
            let all = lightness_of(&named(name, &ground(0.0, 255.0, 45.0)));
            let mean = (all[255] - all[0]) / 255.0;
            for at in (16..240).step_by(16) {
                let rate = (all[at + 16] - all[at]) / 16.0 / mean;
                assert!((0.75..1.25).contains(&rate), "{name:?} at {at}: {rate}");
            }
        }
    }

    #[test]
    fn snow_lies_on_the_alps_and_not_on_tennessee() {
        let top = |ramp: ColorRamp, height: f32| lightness(ramp.linear_at(height));
        assert!(top(atlas(&ground(250.0, 1073.0, 36.3)), 1073.0) < 90.5);
        let alps = atlas(&ground(500.0, 4600.0, 46.0));
        assert!(top(alps.clone(), 4600.0) > 94.0 && top(alps, 2500.0) < 89.0);
        assert!(top(atlas(&ground(0.0, 1000.0, 78.0)), 1000.0) > 94.0, "Svalbard");
    }

    #[test]
    fn ground_above_the_tree_line_has_no_green_lowland() {
        let is_green = |ramp: ColorRamp| {
            let [red, green, _] = ramp.stops()[0].1.to_array();
            green > 1.3 * red
        };
        assert!(is_green(atlas(&ground(200.0, 900.0, 45.0))));
        assert!(!is_green(atlas(&ground(4500.0, 5200.0, 32.0))));
    }

    #[test]
    fn a_named_ramp_fits_any_ground_that_a_lattice_takes() {
        for height in [0.0, -0.3, 8848.0, 9.99e6, -1e7] {
            for choice in RampName::CHOICES {
                named(choice.value, &ground(height, height, 45.0));
            }
        }
    }
}
