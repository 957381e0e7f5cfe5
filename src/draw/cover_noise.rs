//! The noise that natural cover and the ground's finest forms are made of: octaves of value noise in the world.
//!
//! Each octave is three tenths as wide as the one before, turned against it and bent by it, so that no lattice shows; one hash of a
//! lattice point gives two values, of which the first also has its rise. An octave fades before its waves are a few pixels
//! wide: from afar borders and patches of kilometers show, near by those of meters. A pixel that looks along the ground is
//! long and narrow; its mean width counts, so that the ground before the eye does not turn to paint.
//!
//! Most of the time is that of hashes, and next to a pixel lies one in the same cells of the lattices: each thread keeps the
//! corners of the last cell of each octave.

use std::cell::Cell;

use glam::{UVec2, Vec2};

use crate::floor::floor_each;
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
/// A wave shows in full where it is this many pixels wide, and not at all where it is half as wide.
pub(crate) const WAVE_PX: f32 = 5.0;
/// Cosine and sine of the turn from one octave to the next.
pub(crate) const TURN: Vec2 = Vec2::new(0.8, 0.6);
/// Forms are made of octaves up to this many cells of the map wide: what is wider the map shows itself.
pub(crate) const FORM_CELLS: f32 = 4.0;
/// How far an octave's lattice is bent by the values of the one before, in its cells: straight, it shows as a maze on rock.
pub(crate) const BENT: f32 = 0.6;
/// How sharp the crests of forms are: the noise below which they are round.
pub(crate) const CREST: f32 = 0.35;

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

impl CoverNoise {
    /// The noise at world X and Y, over a pixel of a mean and a greatest width of `pixel_m` meters, on a map of cells `cell_m`
    /// meters wide.
    pub fn new(at: Vec2, [pixel_m, longest_m]: [f32; 2], cell_m: f32) -> Self {
        Self { at, longest_m, ..LAST_CELLS.with(|cells| Self::with_cells(at, pixel_m, cell_m, cells)) }
    }

    fn with_cells(
        at: Vec2,
        pixel_m: f32,
        cell_m: f32,
        cells: &[Cell<LatticeCell>; OCTAVES as usize],
    ) -> Self {
        let (mut sum, mut wider) = (Self::default(), Vec2::ZERO);
        let [per_pixel, per_cell] = [2.0 / (WAVE_PX * pixel_m), 1.0 / (0.75 * FORM_CELLS * cell_m)];
        for (index, (NoiseOctave { wave_m, turn }, cell)) in OCTAVE_TABLE.into_iter().zip(cells).enumerate() {
            let shown = (wave_m * per_pixel - 1.0).clamp(0.0, 1.0);
            if shown > 0.0 {
                let place = turn.rotate(at) * wave_m.recip() + BENT * wider;
                let (value, rise) = pair_near(place, cell);
                wider = value;
                sum.uneven += SHARE * shown * value.x;
                if index < FIRST_FINE as usize {
                    sum.patch += SHARE * shown * value.y;
                } else {
                    sum.fine += SHARE * shown * value.y;
                }
                let within = ((FORM_CELLS * cell_m - wave_m) * per_cell).clamp(0.0, 1.0);
                if within > 0.0 {
                    let away = (value.x * value.x + CREST * CREST).sqrt();
                    let crest = -value.x / away;
                    let back =
                        Vec2::new(turn.x * rise.x + turn.y * rise.y, turn.x * rise.y - turn.y * rise.x);
                    sum.form += back * (SHARE * shown * within * crest);
                    sum.ridge += SHARE * shown * within * 2.0 * (MEAN_AWAY - away);
                }
            }
        }
        sum
    }
}

/// An octave.
#[derive(Clone, Copy, Debug)]
struct NoiseOctave {
    wave_m: f32,
    /// Cosine and sine of its turn.
    turn: Vec2,
}

/// The octaves, the widest first.
const OCTAVE_TABLE: [NoiseOctave; OCTAVES as usize] = {
    let mut octaves = [NoiseOctave { wave_m: FIRST_M, turn: Vec2::X }; OCTAVES as usize];
    let mut index = 1;
    while index < octaves.len() {
        let NoiseOctave { wave_m, turn } = octaves[index - 1];
        let turn = Vec2::new(TURN.x * turn.x - TURN.y * turn.y, TURN.y * turn.x + TURN.x * turn.y);
        octaves[index] = NoiseOctave { wave_m: wave_m * FINER, turn };
        index += 1;
    }
    octaves
};

/// A cell of a lattice: its south-western corner, and the values at it, the south-eastern, the north-western and the
/// north-eastern.
#[derive(Clone, Copy, Debug)]
struct LatticeCell {
    corner: Vec2,
    values: [Vec2; 4],
}

impl LatticeCell {
    /// A cell that no place lies in.
    const NONE: Self = Self { corner: Vec2::NAN, values: [Vec2::ZERO; 4] };

    fn new(corner: Vec2) -> Self {
        let at = corner.as_ivec2().as_uvec2();
        let value =
            |east: u32, north: u32| values(UVec2::new(at.x.wrapping_add(east), at.y.wrapping_add(north)));
        Self { corner, values: [value(0, 0), value(1, 0), value(0, 1), value(1, 1)] }
    }

    /// The noises at a place in it.
    fn pair(&self, at: Vec2) -> (Vec2, Vec2) {
        let part = at - self.corner;
        let smooth = part * part * (Vec2::splat(3.0) - 2.0 * part);
        let steep = 6.0 * part * (Vec2::ONE - part);
        let [sw, se, nw, ne] = self.values;
        let (south, north) = (sw + (se - sw) * smooth.x, nw + (ne - nw) * smooth.x);
        let east = (se.x - sw.x) + ((ne.x - nw.x) - (se.x - sw.x)) * smooth.y;
        (south + (north - south) * smooth.y, Vec2::new(east * steep.x, (north.x - south.x) * steep.y))
    }
}

thread_local! {
    /// The last cell of each octave that the thread looked at.
    static LAST_CELLS: [Cell<LatticeCell>; OCTAVES as usize] =
        const { [const { Cell::new(LatticeCell::NONE) }; OCTAVES as usize] };
}

/// Two value noises, -1..=1, and the rise of the first.
pub(crate) fn pair(at: Vec2) -> (Vec2, Vec2) {
    LatticeCell::new(floor_each(at)).pair(at)
}

/// The same where `last` is the cell of the place before.
fn pair_near(at: Vec2, last: &Cell<LatticeCell>) -> (Vec2, Vec2) {
    let corner = floor_each(at);
    if last.get().corner != corner {
        last.set(LatticeCell::new(corner));
    }
    last.get().pair(at)
}

/// Two numbers from -1 to 1 for a lattice point.
///
/// A weighted sum of the coordinates, mixed: it takes half the products of the hash of the grain.
pub(crate) fn values(at: UVec2) -> Vec2 {
    let bits = lowbias32(at.x.wrapping_mul(0x8da6_b343).wrapping_add(at.y.wrapping_mul(0xd816_3841)));
    // 16 bits are exact in an f32.
    Vec2::new((bits & 0xffff) as f32, (bits >> 16) as f32) / 32_768.0 - 1.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_cells_that_a_thread_keeps_change_nothing() {
        let fresh = |at: Vec2| {
            let cells = [const { Cell::new(LatticeCell::NONE) }; OCTAVES as usize];
            CoverNoise { at, longest_m: 1.0, ..CoverNoise::with_cells(at, 1.0, 30.0, &cells) }
        };
        for at in places().flat_map(|at| [at, at + Vec2::new(0.7, 0.0), -at]) {
            assert_eq!(CoverNoise::new(at, [1.0; 2], 30.0), fresh(at), "{at}");
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
    fn the_two_values_have_no_mean_and_nothing_in_common() {
        let all: Vec<Vec2> = places().map(|at| pair(at / 3.3).0).collect();
        let mean = all.iter().sum::<Vec2>() / all.len() as f32;
        let common = all.iter().map(|value| value.x * value.y).sum::<f32>() / all.len() as f32;
        assert!(mean.abs().max_element() < 0.03 && common.abs() < 0.03, "{mean} {common}");
    }

    #[test]
    fn pixels_see_waves_wider_than_themselves_alone_and_forms_below_the_cells() {
        for at in places() {
            let far = CoverNoise::new(at, [2000.0; 2], 30.0);
            assert_eq!(far, CoverNoise { at, longest_m: 2000.0, ..CoverNoise::default() });
            let overview = CoverNoise::new(at, [60.0; 2], 30.0);
            assert_eq!((overview.form, overview.ridge, overview.fine), (Vec2::ZERO, 0.0, 0.0));
        }
        let sum = |pixel_m: f32| {
            places().map(|at| CoverNoise::new(at, [pixel_m; 2], 30.0).form.length()).sum::<f32>()
        };
        assert!(sum(1.0) > 1.2 * sum(10.0) && sum(10.0) > 0.0);
    }
}
