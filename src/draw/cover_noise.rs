//! The noise that natural cover and the ground's finest forms are made of: octaves of value noise in the world.
//!
//! Each octave is three tenths as wide as the one before, turned against it and bent by it, so that no lattice shows; one hash of a
//! lattice point gives two values, of which the first also has its rise. An octave fades before its waves are a few pixels
//! wide: from afar borders and patches of kilometers show, near by those of meters. A pixel that looks along the ground is
//! long and narrow; its mean width counts, so that the ground before the eye does not turn to paint.
//!
//! Forms on slopes are gullies down the fall line: waves across it around each point of the lattice, blended into each other (the
//! idea of Lagae et al. 2009, "Procedural noise using sparse Gabor convolution"). Ridges of value noise alone look like worms.
//! Each octave's fall line is that of the ground with the forms of wider octaves in it, so that gullies branch.
//!
//! The octaves of a pixel follow one from the other, so that a processor waits for each. Those of eight pixels are computed
//! together, as vectors, in a third of the time: loops over pixels have no branch.

use glam::{UVec2, Vec2};

use crate::floor::floor_each;
use crate::lanes::{LANES, in_lanes, mix, of_each, smooth, unit};
use crate::lowbias::lowbias32;

/// The wavelength of the first octave, meters, and the factor from one to the next.
pub(crate) const FIRST_M: f32 = 3000.0;
pub(crate) const FINER: f32 = 0.3;
/// The number of octaves; the last is about as wide as a crown of a tree.
pub(crate) const OCTAVES: u32 = 6;
/// The first octave of [`CoverNoise::fine`].
pub(crate) const FIRST_FINE: u32 = 3;
/// The share of each octave in a sum of all: four that are seen well together span about -1 to 1.
pub(crate) const SHARE: f32 = 0.42;
/// The share of each of the fine octaves of borders and forms, as a part of that of the one before: as strong as the wide ones, the
/// narrowest that show would cover all ground with worms.
pub(crate) const FAINTER: f32 = 0.7;
/// A wave shows in full where it is this many pixels wide, and not at all where it is half as wide.
pub(crate) const WAVE_PX: f32 = 6.0;
/// Cosine and sine of the turn from one octave to the next.
pub(crate) const TURN: Vec2 = Vec2::new(0.8, 0.6);
/// Forms are made of octaves up to this many cells of the map wide: what is wider the map shows itself.
pub(crate) const FORM_CELLS: f32 = 4.0;
/// How far an octave's lattice is bent by the values of the one before, in its cells: straight, it shows as a maze on rock.
pub(crate) const BENT: f32 = 0.6;
/// How sharp the crests of forms are: the noise below which they are round.
pub(crate) const CREST: f32 = 0.35;

/// From and to which rise forms are gullies along the fall line; on gentler ground they have no direction.
pub(crate) const GULLY_RISE: [f32; 2] = [0.06, 0.4];
/// Waves of gullies in a cell of an octave's lattice, and their height.
pub(crate) const GULLIES: f32 = 0.5;
pub(crate) const GULLY_HEIGHT: f32 = 0.6;
/// The greatest share of gullies in forms: the rest keeps them from being combed.
pub(crate) const MOST_GULLIES: f32 = 0.8;
/// By how much the forms of an octave turn the fall line of the next, as a part of the ground's own rise: gullies run into wider
/// ones from both sides, as branches do.
pub(crate) const BRANCHED: f32 = 1.2;

/// The mean distance of the noise from its ridges, with [`CREST`].
pub(crate) const MEAN_AWAY: f32 = 0.49;

/// The noise at a place; sums are about -1 to 1.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CoverNoise {
    /// Moves borders between covers.
    pub uneven: f32,
    /// Patches within a cover, a hectometer wide and more.
    pub patch: f32,
    /// The same, narrower: clumps and crowns of trees, stones.
    pub fine: f32,
    /// Rise eastward and northward of ridged forms too small for the map's cells, of unit strength.
    pub form: Vec2,
    /// How high these forms stand: positive on their ridges, negative between.
    pub ridge: f32,
    /// The place itself, world X and Y.
    pub at: Vec2,
    /// The greatest width of the pixel in plan, meters.
    pub longest_m: f32,
}

/// A pixel, as its noise depends on it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NoisePixel {
    /// World X and Y.
    pub at: Vec2,
    /// Its mean width in plan, meters.
    pub mean_m: f32,
    /// Its greatest width in plan, meters.
    pub longest_m: f32,
    /// The rise of the map eastward and northward, true to scale.
    pub rise: Vec2,
}

impl NoisePixel {
    /// A pixel so wide that it shows no noise.
    pub const WIDE: Self =
        Self { at: Vec2::ZERO, mean_m: f32::INFINITY, longest_m: f32::INFINITY, rise: Vec2::ZERO };
}

impl CoverNoise {
    /// The noise at a pixel so wide that it shows none.
    pub fn none() -> Self {
        Self { longest_m: f32::INFINITY, ..Self::default() }
    }

    /// The noise at a pixel of a map of cells `cell_m` meters wide.
    pub fn new(pixel: &NoisePixel, cell_m: f32) -> Self {
        let [noise] = Self::together(&[*pixel], cell_m);
        noise
    }

    /// [`Self::new`] of each of `pixels`, in less time.
    pub fn of_each(pixels: &[NoisePixel], cell_m: f32) -> Vec<Self> {
        in_lanes(
            pixels,
            NoisePixel::WIDE,
            #[inline(always)]
            |pixels: &[NoisePixel; LANES]| Self::together(pixels, cell_m),
        )
    }

    #[inline(always)]
    fn together<const N: usize>(pixels: &[NoisePixel; N], cell_m: f32) -> [Self; N] {
        let mut lanes = NoiseLanes::new(pixels, cell_m);
        for (index, octave) in OCTAVE_TABLE.iter().enumerate() {
            if !lanes.add(octave, index >= FIRST_FINE as usize) {
                break;
            }
        }
        std::array::from_fn(|lane| lanes.noise(lane, &pixels[lane]))
    }
}

/// The sums of octaves at several pixels.
struct NoiseLanes<const N: usize> {
    at: [[f32; N]; 2],
    /// A wave's part that shows is its length times this, less 1.
    per_pixel: [f32; N],
    cell_m: f32,
    /// The rise of the map, its length, and the share of gullies in forms.
    rise: [[f32; N]; 2],
    steep: [f32; N],
    gullies: [f32; N],
    /// The two values of the octave before.
    wider: [[f32; N]; 2],
    uneven: [f32; N],
    patch: [f32; N],
    fine: [f32; N],
    form: [[f32; N]; 2],
    ridge: [f32; N],
}

impl<const N: usize> NoiseLanes<N> {
    #[inline(always)]
    fn new(pixels: &[NoisePixel; N], cell_m: f32) -> Self {
        let none = [0.0; N];
        let steep =
            of_each(pixels, |pixel| (pixel.rise.x * pixel.rise.x + pixel.rise.y * pixel.rise.y).sqrt());
        let gullies = of_each(&steep, |steep| {
            MOST_GULLIES * smooth(unit((steep - GULLY_RISE[0]) / (GULLY_RISE[1] - GULLY_RISE[0])))
        });
        Self {
            rise: [of_each(pixels, |pixel| pixel.rise.x), of_each(pixels, |pixel| pixel.rise.y)],
            steep,
            gullies,
            at: [of_each(pixels, |pixel| pixel.at.x), of_each(pixels, |pixel| pixel.at.y)],
            per_pixel: of_each(pixels, |pixel| 2.0 / (WAVE_PX * pixel.mean_m)),
            cell_m,
            wider: [none; 2],
            uneven: none,
            patch: none,
            fine: none,
            form: [none; 2],
            ridge: none,
        }
    }

    /// Adds an octave; false where no pixel shows it, nor any narrower one.
    #[inline(always)]
    fn add(&mut self, &NoiseOctave { wave_m, turn, faint }: &NoiseOctave, is_fine: bool) -> bool {
        let share = of_each(&self.per_pixel, |per_pixel| SHARE * unit(wave_m * per_pixel - 1.0));
        if share.iter().all(|&share| share <= 0.0) {
            return false;
        }
        let along = turn * wave_m.recip();
        let [mut place_x, mut place_y, mut first, mut second, mut rise_x, mut rise_y] = [[0.0; N]; 6];
        for lane in 0..N {
            let [x, y] = [self.at[0][lane], self.at[1][lane]];
            place_x[lane] = along.x * x - along.y * y + BENT * self.wider[0][lane];
            place_y[lane] = along.y * x + along.x * y + BENT * self.wider[1][lane];
            ([first[lane], second[lane]], [rise_x[lane], rise_y[lane]]) =
                pair_in_cell(&CellPlace::of([place_x[lane], place_y[lane]]));
        }
        self.wider = [first, second];
        let patches = if is_fine { &mut self.fine } else { &mut self.patch };
        for lane in 0..N {
            self.uneven[lane] += share[lane] * faint * first[lane];
            patches[lane] += share[lane] * second[lane];
        }
        let widest_m = FORM_CELLS * self.cell_m;
        let within = unit((widest_m - wave_m) / (0.75 * widest_m));
        if within > 0.0 {
            for lane in 0..N {
                let [east, north] = self.level(lane);
                let level = [turn.x * east - turn.y * north, turn.y * east + turn.x * north];
                let (gully, gully_rise) = gullies(&CellPlace::of([place_x[lane], place_y[lane]]), level);
                let part = self.gullies[lane];
                let value = mix(first[lane], gully, part);
                let (x, y) = (mix(rise_x[lane], gully_rise[0], part), mix(rise_y[lane], gully_rise[1], part));
                let share = share[lane] * faint * within;
                let away = (value * value + CREST * CREST).sqrt();
                let crest = share * -value / away;
                self.form[0][lane] += crest * (turn.x * x + turn.y * y);
                self.form[1][lane] += crest * (turn.x * y - turn.y * x);
                self.ridge[lane] += share * 2.0 * (MEAN_AWAY - away);
            }
        }
        true
    }

    /// The direction along the contour of the ground with the forms of wider octaves, of length 1 where it rises.
    #[inline(always)]
    fn level(&self, lane: usize) -> [f32; 2] {
        let branched = BRANCHED * self.steep[lane];
        let [east, north] = [0, 1].map(
            #[inline(always)]
            |axis: usize| self.rise[axis][lane] + branched * self.form[axis][lane],
        );
        let steep = (east * east + north * north).sqrt();
        let scale = 1.0 / if steep > 1e-6 { steep } else { 1e-6 };
        [-north * scale, east * scale]
    }

    #[inline(always)]
    fn noise(&self, lane: usize, pixel: &NoisePixel) -> CoverNoise {
        CoverNoise {
            uneven: self.uneven[lane],
            patch: self.patch[lane],
            fine: self.fine[lane],
            form: Vec2::new(self.form[0][lane], self.form[1][lane]),
            ridge: self.ridge[lane],
            at: pixel.at,
            longest_m: pixel.longest_m,
        }
    }
}

/// An octave.
#[derive(Clone, Copy, Debug)]
struct NoiseOctave {
    wave_m: f32,
    /// Cosine and sine of its turn.
    turn: Vec2,
    /// The factor on its share in borders and forms; see [`FAINTER`].
    faint: f32,
}

/// The octaves, the widest first.
const OCTAVE_TABLE: [NoiseOctave; OCTAVES as usize] = {
    let mut octaves = [NoiseOctave { wave_m: FIRST_M, turn: Vec2::X, faint: 1.0 }; OCTAVES as usize];
    let mut index = 1;
    while index < octaves.len() {
        let NoiseOctave { wave_m, turn, faint } = octaves[index - 1];
        let turn = Vec2::new(TURN.x * turn.x - TURN.y * turn.y, TURN.y * turn.x + TURN.x * turn.y);
        let faint = if index >= FIRST_FINE as usize { faint * FAINTER } else { faint };
        octaves[index] = NoiseOctave { wave_m: wave_m * FINER, turn, faint };
        index += 1;
    }
    octaves
};

/// Two value noises, -1..=1, and the rise of the first.
pub(crate) fn pair(at: Vec2) -> (Vec2, Vec2) {
    let corner = floor_each(at);
    let part = at - corner;
    let corner = corner.as_ivec2().as_uvec2();
    let (values, rise) = pair_in_cell(&CellPlace { corner: corner.to_array(), part: part.to_array() });
    (values.into(), rise.into())
}

/// A place in a cell of a lattice.
struct CellPlace {
    /// The south-western corner.
    corner: [u32; 2],
    /// Where in the cell it is, 0..=1.
    part: [f32; 2],
}

impl CellPlace {
    /// A place within ±2²² cells, further than an octave's lattice reaches on Earth, compiled to vectors.
    #[inline(always)]
    fn of(at: [f32; 2]) -> Self {
        let [(x, east), (y, north)] = [0, 1].map(
            #[inline(always)]
            |axis| {
                let value: f32 = at[axis];
                let nearest = rounded(value);
                let corner = if nearest > value { nearest - 1.0 } else { nearest };
                (unit(value - corner), (corner + UNIT).to_bits().wrapping_sub(UNIT.to_bits()))
            },
        );
        Self { corner: [east, north], part: [x, y] }
    }

    /// Two numbers from 0 to 2¹⁶ of each corner: south-west, south-east, north-west, north-east.
    #[inline(always)]
    fn halves(&self) -> [[f32; 2]; 4] {
        let [east, north] = self.corner;
        let sw = east.wrapping_mul(FACTORS[0]).wrapping_add(north.wrapping_mul(FACTORS[1]));
        let nw = sw.wrapping_add(FACTORS[1]);
        [halves(sw), halves(sw.wrapping_add(FACTORS[0])), halves(nw), halves(nw.wrapping_add(FACTORS[0]))]
    }

    /// The shares of the corners east and north, and their rise.
    #[inline(always)]
    fn smooth(&self) -> ([f32; 2], [f32; 2]) {
        let [x, y] = self.part;
        ([smooth(x), smooth(y)], [6.0 * x * (1.0 - x), 6.0 * y * (1.0 - y)])
    }
}

/// Its last bit is 1, so that a sum with it is rounded to a whole number: a conversion of vectors takes more.
const UNIT: f32 = 12_582_912.0;

/// The whole number nearest to one within ±2²².
#[inline(always)]
fn rounded(value: f32) -> f32 {
    (value + UNIT) - UNIT
}

/// [`pair`] at a place in a cell.
#[inline(always)]
fn pair_in_cell(at: &CellPlace) -> ([f32; 2], [f32; 2]) {
    let [sw, se, nw, ne] = at.halves();
    let ([u, v], [steep_x, steep_y]) = at.smooth();
    let (south, north) = (mix(sw[0], se[0], u), mix(nw[0], ne[0], u));
    let second = mix(mix(sw[1], se[1], u), mix(nw[1], ne[1], u), v);
    let rise_x = mix(se[0] - sw[0], ne[0] - nw[0], v) * PER_HALF * steep_x;
    let rise_y = (north - south) * PER_HALF * steep_y;
    ([mix(south, north, v) * PER_HALF - 1.0, second * PER_HALF - 1.0], [rise_x, rise_y])
}

/// Waves of gullies that run across the direction `level`, of length 1 at the most, and their rise: each corner of the cell has
/// waves of its own phase, which blend into each other, so that gullies fork and join.
#[inline(always)]
fn gullies(at: &CellPlace, level: [f32; 2]) -> (f32, [f32; 2]) {
    let [x, y] = at.part;
    let corners = at.halves();
    let (mut waves, mut slopes) = ([0.0; 4], [0.0; 4]);
    for (index, (east, north)) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)].into_iter().enumerate() {
        let along = (x - east) * level[0] + (y - north) * level[1];
        (waves[index], slopes[index]) = wave(GULLIES * along + corners[index][0] * (0.5 * PER_HALF));
    }
    let ([u, v], [steep_x, steep_y]) = at.smooth();
    let [sw, se, nw, ne] = waves;
    let (south, north) = (mix(sw, se, u), mix(nw, ne, u));
    let slope = GULLIES * mix(mix(slopes[0], slopes[1], u), mix(slopes[2], slopes[3], u), v);
    let rise_x = mix(se - sw, ne - nw, v) * steep_x + slope * level[0];
    let rise_y = (north - south) * steep_y + slope * level[1];
    (GULLY_HEIGHT * mix(south, north, v), [GULLY_HEIGHT * rise_x, GULLY_HEIGHT * rise_y])
}

/// About the cosine of so many turns from -1 to 2^20, and its rise per turn.
#[inline(always)]
fn wave(turns: f32) -> (f32, f32) {
    let past = turns - rounded(turns);
    let part = 2.0 * past.abs();
    let rise = -24.0 * (part * (1.0 - part));
    (1.0 - 2.0 * smooth(part), if past < 0.0 { -rise } else { rise })
}

/// Two numbers from -1 to 1 for a lattice point.
///
/// A weighted sum of the coordinates, mixed: it takes half the products of the hash of the grain.
pub(crate) fn values(at: UVec2) -> Vec2 {
    let sum = at.x.wrapping_mul(FACTORS[0]).wrapping_add(at.y.wrapping_mul(FACTORS[1]));
    Vec2::from(halves(sum)) * PER_HALF - 1.0
}

/// The weights of a lattice point's coordinates in the number that is hashed.
const FACTORS: [u32; 2] = [0x8da6_b343, 0xd816_3841];

/// The factor on [`halves`] that makes them numbers from 0 to 2.
const PER_HALF: f32 = 1.0 / 32_768.0;

/// Two numbers from 0 to 2¹⁶ of a lattice point's weighted sum of coordinates, exact in an f32.
#[inline(always)]
fn halves(sum: u32) -> [f32; 2] {
    let bits = lowbias32(sum);
    // Vectors of signed numbers are converted faster.
    [(bits & 0xffff) as i32 as f32, (bits >> 16) as i32 as f32]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_together_have_the_noise_that_each_has_alone() {
        let pixels: Vec<NoisePixel> = places()
            .zip([0.4, 3.0, 25.0, 90.0, 700.0, 5000.0, f32::NAN].into_iter().cycle())
            .map(|(at, mean_m)| NoisePixel { at, mean_m, longest_m: 2.0 * mean_m, rise: at / 9000.0 })
            .collect();
        let alone = pixels.iter().map(|pixel| CoverNoise::new(pixel, 30.0));
        let bits = |noise: CoverNoise| {
            let CoverNoise { uneven, patch, fine, form, ridge, .. } = noise;
            [uneven, patch, fine, form.x, form.y, ridge].map(f32::to_bits)
        };
        assert!(alone.map(bits).eq(CoverNoise::of_each(&pixels, 30.0).into_iter().map(bits)));
    }

    #[test]
    fn the_lattice_within_reach_is_that_of_all_places() {
        for at in places().flat_map(|at| [at / 7.3, at * 40.0, -at, at.floor()]) {
            let (values, rise) = pair_in_cell(&CellPlace::of(at.to_array()));
            assert_eq!((Vec2::from(values), Vec2::from(rise)), pair(at), "{at}");
        }
    }

    fn places() -> impl Iterator<Item = Vec2> {
        (0..4000).map(|index| Vec2::new((index % 80) as f32 * 91.3 - 4000.0, (index / 80) as f32 * 77.9))
    }

    #[test]
    fn the_rise_is_the_change_of_the_first_value() {
        let step = 1e-3;
        for at in places().map(|at| at / 211.0) {
            let (value, rise) = pair(at);
            for (axis, part) in [(Vec2::X, rise.x), (Vec2::Y, rise.y)] {
                let change = (pair(at + axis * step).0.x - value.x) / step;
                assert!((change - part).abs() < 0.02, "{at}: {change} {part}");
            }
        }
    }

    #[test]
    fn gullies_run_down_the_fall_line_and_their_rise_is_their_change() {
        let level = Vec2::new(0.6, -0.8);
        let gully = |at: Vec2| gullies(&CellPlace::of(at.to_array()), level.to_array());
        let (mut along, mut across) = (0.0, 0.0);
        for at in places().map(|at| at / 211.0) {
            let (value, rise) = gully(at);
            for (axis, part) in [(Vec2::X, rise[0]), (Vec2::Y, rise[1])] {
                let change = (gully(at + axis * 1e-3).0 - value) / 1e-3;
                assert!((change - part).abs() < 0.03, "{at}: {change} {part}");
            }
            across += Vec2::from(rise).dot(level).abs();
            along += Vec2::from(rise).perp_dot(level).abs();
        }
        assert!(across > 1.5 * along, "{across} {along}");
    }

    #[test]
    fn the_two_values_have_no_mean_and_nothing_in_common() {
        let all: Vec<Vec2> = places().map(|at| pair(at / 3.3).0).collect();
        let mean = all.iter().sum::<Vec2>() / all.len() as f32;
        let common = all.iter().map(|value| value.x * value.y).sum::<f32>() / all.len() as f32;
        assert!(mean.abs().max_element() < 0.03 && common.abs() < 0.03, "{mean} {common}");
    }

    #[test]
    fn pixels_see_waves_wider_than_themselves_alone_and_forms_below_the_cells() {
        let noise = |at: Vec2, wide_m: f32| {
            CoverNoise::new(&NoisePixel { at, mean_m: wide_m, longest_m: wide_m, rise: Vec2::ZERO }, 30.0)
        };
        for at in places() {
            let far = noise(at, 2000.0);
            assert_eq!(far, CoverNoise { at, longest_m: 2000.0, ..CoverNoise::default() });
            let overview = noise(at, 60.0);
            assert_eq!((overview.form, overview.ridge, overview.fine), (Vec2::ZERO, 0.0, 0.0));
        }
        let sum = |pixel_m: f32| places().map(|at| noise(at, pixel_m).form.length()).sum::<f32>();
        assert!(sum(1.0) > 1.2 * sum(10.0) && sum(10.0) > 0.0);
    }
}
