//! One unpacked row of a TIFF block to elevations: the predictor undone, the first band taken, no-data made NaN.
//!
//! Two passes over a row, both short enough to stay in the processor's nearest memory: bytes to words of a sample's
//! width, then words to elevations. The first is a chain of sums, the second a loop without a branch.
//!
//! The floating-point predictor sums *all* bytes of a row in one chain, most significant bytes first:
//!
//! ```text
//! row:   a₀ a₁ a₂ … │ b₀ b₁ b₂ … │ c₀ c₁ c₂ … │ d₀ d₁ d₂ …      sample i = aᵢ bᵢ cᵢ dᵢ, big-endian
//! chain: ──────────►│───────────►│───────────►│──────────►
//! ```
//!
//! A chain over all of them takes one step a byte, each waiting for the one before. But where each quarter's chain
//! starts is the plain sum of the quarters before it, which takes no chain: so four shorter chains run side by side,
//! and give samples as they go.

use tiff::tags::ByteOrder;

use crate::dem::tiff::storage::{Predictor, SampleKind, Storage};

/// How rows of an image become elevations, where it is stored in one of the common ways.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RowDecoder {
    bits: u16,
    kind: SampleKind,
    predictor: Predictor,
    order: ByteOrder,
    bands: usize,
    hole: f64,
}

impl RowDecoder {
    /// Of an image whose no-data value is `nodata`; `None` where its samples or its predictor are uncommon.
    pub fn of(storage: &Storage, nodata: Option<f64>) -> Option<Self> {
        let Storage { bits, kind, predictor, order, bands_per_block, .. } = *storage;
        let common = match (kind, predictor) {
            (SampleKind::Other, _) | (_, Predictor::Other) => false,
            (SampleKind::Float, _) => matches!(bits, 32 | 64),
            (_, Predictor::FloatBytes) => false,
            (SampleKind::Unsigned | SampleKind::Signed, _) => matches!(bits, 8 | 16 | 32 | 64),
        };
        let rows = Self {
            bits,
            kind,
            predictor,
            order,
            bands: bands_per_block.into(),
            hole: storage.comparable(nodata),
        };
        common.then_some(rows)
    }
}

/// An elevation in the precision that keeps a file's samples.
pub(crate) trait Elevation: Copy + Default + Send + Sync {
    /// No data.
    const NONE: Self;

    /// From 64 bits.
    fn of(value: f64) -> Self;

    /// The elevations of a row's first samples, as many as `out` holds. `row` holds whole rows of a block.
    fn fill(rows: &RowDecoder, row: &[u8], words: &mut RowWords, out: &mut [Self]);
}

/// Room for the words of one row.
#[derive(Debug, Default)]
pub(crate) struct RowWords {
    of_8: Vec<u8>,
    of_16: Vec<u16>,
    of_32: Vec<u32>,
    of_64: Vec<u64>,
}

impl Elevation for f32 {
    const NONE: Self = Self::NAN;

    fn of(value: f64) -> Self {
        value as Self
    }

    fn fill(rows: &RowDecoder, row: &[u8], words: &mut RowWords, out: &mut [Self]) {
        // What is kept in 32 bits holds no more: the value to compare with is exact, or equals none.
        let hole = if f64::from(rows.hole as Self) == rows.hole { rows.hole as Self } else { Self::NAN };
        let known = |value: Self| if value == hole || !value.is_finite() { Self::NAN } else { value };
        match (rows.bits, rows.kind) {
            (8, SampleKind::Signed) => {
                convert(words_of(rows, row, &mut words.of_8), out, |w| known((w as i8).into()))
            }
            (8, _) => convert(words_of(rows, row, &mut words.of_8), out, |w| known(w.into())),
            (16, SampleKind::Signed) => {
                convert(words_of(rows, row, &mut words.of_16), out, |w| known((w as i16).into()))
            }
            (16, _) => convert(words_of(rows, row, &mut words.of_16), out, |w| known(w.into())),
            _ => convert(words_of(rows, row, &mut words.of_32), out, |w| known(Self::from_bits(w))),
        }
    }
}

impl Elevation for f64 {
    const NONE: Self = Self::NAN;

    fn of(value: f64) -> Self {
        value
    }

    fn fill(rows: &RowDecoder, row: &[u8], words: &mut RowWords, out: &mut [Self]) {
        let hole = rows.hole;
        let known = |value: Self| if value == hole || !value.is_finite() { Self::NAN } else { value };
        match (rows.bits, rows.kind) {
            (32, SampleKind::Signed) => {
                convert(words_of(rows, row, &mut words.of_32), out, |w| known((w as i32).into()))
            }
            (32, _) => convert(words_of(rows, row, &mut words.of_32), out, |w| known(w.into())),
            (_, SampleKind::Signed) => {
                convert(words_of(rows, row, &mut words.of_64), out, |w| known(w as i64 as Self))
            }
            (_, SampleKind::Unsigned) => {
                convert(words_of(rows, row, &mut words.of_64), out, |w| known(w as Self))
            }
            _ => convert(words_of(rows, row, &mut words.of_64), out, |w| known(Self::from_bits(w))),
        }
    }
}

fn convert<W: Copy, E>(words: &[W], out: &mut [E], elevation: impl Fn(W) -> E) {
    for (out, &word) in out.iter_mut().zip(words) {
        *out = elevation(word);
    }
}

/// The bits of a sample as one number.
trait SampleWord: Copy + Default {
    fn of(bytes: &[u8], order: ByteOrder) -> Self;
    fn plus(self, other: Self) -> Self;
    /// Undoes the floating-point predictor: the first of every `bands` samples of a row of them.
    fn sum_planes(row: &[u8], bands: usize, words: &mut [Self]);
}

macro_rules! words {
    ($($word:ty: $bytes:literal),*) => {$(
        impl SampleWord for $word {
            fn of(bytes: &[u8], order: ByteOrder) -> Self {
                let bytes = bytes.try_into().unwrap_or_default();
                match order {
                    ByteOrder::LittleEndian => Self::from_le_bytes(bytes),
                    ByteOrder::BigEndian => Self::from_be_bytes(bytes),
                }
            }

            fn plus(self, other: Self) -> Self {
                self.wrapping_add(other)
            }

            fn sum_planes(row: &[u8], bands: usize, words: &mut [Self]) {
                let plane = row.len() / $bytes;
                let planes: [&[u8]; $bytes] = std::array::from_fn(|at| &row[at * plane..(at + 1) * plane]);
                let mut sums = [0u8; $bytes];
                let mut before = 0u8;
                for (start, plane) in sums.iter_mut().zip(planes) {
                    *start = before;
                    before = before.wrapping_add(sum(plane, bands));
                }
                if bands == 1 {
                    for (at, word) in words.iter_mut().enumerate().take(plane) {
                        for (sum, plane) in sums.iter_mut().zip(planes) {
                            *sum = sum.wrapping_add(plane[at]);
                        }
                        *word = Self::from_be_bytes(sums);
                    }
                    return;
                }
                for (word, at) in words.iter_mut().zip((0..plane).step_by(bands)) {
                    for (sum, plane) in sums.iter_mut().zip(planes) {
                        *sum = sum.wrapping_add(plane[at]);
                    }
                    *word = Self::from_be_bytes(sums);
                }
            }
        }
    )*};
}

words!(u8: 1, u16: 2, u32: 4, u64: 8);

/// The sum of every `bands`th byte.
fn sum(plane: &[u8], bands: usize) -> u8 {
    if bands == 1 {
        return plane.iter().fold(0u8, |sum, byte| sum.wrapping_add(*byte));
    }
    plane.iter().step_by(bands).fold(0u8, |sum, byte| sum.wrapping_add(*byte))
}

/// The first band's words of a row.
fn words_of<'a, W: SampleWord>(rows: &RowDecoder, row: &[u8], words: &'a mut Vec<W>) -> &'a [W] {
    let bytes = size_of::<W>();
    words.resize(row.len() / (bytes * rows.bands), W::default());
    let of = |sample: &[u8]| W::of(&sample[..bytes], rows.order);
    let samples = row.chunks_exact(bytes * rows.bands);
    match rows.predictor {
        Predictor::FloatBytes => W::sum_planes(row, rows.bands, words),
        Predictor::Differences => {
            let mut sum = W::default();
            for (word, sample) in words.iter_mut().zip(samples) {
                sum = sum.plus(of(sample));
                *word = sum;
            }
        }
        Predictor::Plain | Predictor::Other => {
            for (word, sample) in words.iter_mut().zip(samples) {
                *word = of(sample);
            }
        }
    }
    words
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn rows(bits: u16, kind: SampleKind, predictor: Predictor, order: ByteOrder, bands: usize) -> RowDecoder {
        RowDecoder { bits, kind, predictor, order, bands, hole: f64::NAN }
    }

    #[test]
    fn differences_are_summed_band_by_band_in_either_byte_order() {
        let mut out = [0f32; 3];
        let rows_of = |order| rows(16, SampleKind::Signed, Predictor::Differences, order, 2);
        let little = [5u8, 0, 9, 9, 0xff, 0xff, 9, 9, 0xfb, 0xff, 9, 9];
        f32::fill(&rows_of(ByteOrder::LittleEndian), &little, &mut RowWords::default(), &mut out);
        assert_eq!(out, [5.0, 4.0, -1.0]);
        let big: Vec<u8> = little.chunks_exact(2).flat_map(|pair| [pair[1], pair[0]]).collect();
        f32::fill(&rows_of(ByteOrder::BigEndian), &big, &mut RowWords::default(), &mut out);
        assert_eq!(out, [5.0, 4.0, -1.0]);
    }

    #[test]
    fn the_value_for_no_data_and_what_is_not_finite_become_nan() {
        let row = [7f32, -9999.0, f32::INFINITY, 8.0].map(f32::to_le_bytes).concat();
        let mut out = [0f32; 4];
        let plain = rows(32, SampleKind::Float, Predictor::Plain, ByteOrder::LittleEndian, 1);
        f32::fill(&RowDecoder { hole: -9999.0, ..plain }, &row, &mut RowWords::default(), &mut out);
        assert!(out[0] == 7.0 && out[1].is_nan() && out[2].is_nan() && out[3] == 8.0);
        // 0.1 is no float: no sample of 32 bits equals it.
        f32::fill(&RowDecoder { hole: 0.1, ..plain }, &row, &mut RowWords::default(), &mut out);
        assert_eq!(out[1], -9999.0);
    }

    proptest! {
        #[test]
        fn side_by_side_the_chains_give_what_one_chain_gives(
            bytes in proptest::collection::vec(any::<u8>(), 1..40),
            bands in 1usize..4,
        ) {
            let row: Vec<u8> = bytes.iter().copied().cycle().take(bytes.len() * 8 * bands).collect();
            let mut chained = row.clone();
            for at in bands..chained.len() {
                chained[at] = chained[at].wrapping_add(chained[at - bands]);
            }
            let plane = row.len() / 8;
            let wanted: Vec<u64> = (0..bytes.len())
                .map(|at| u64::from_be_bytes(std::array::from_fn(|byte| chained[byte * plane + at * bands])))
                .collect();
            let mut words = vec![0u64; bytes.len()];
            u64::sum_planes(&row, bands, &mut words);
            prop_assert_eq!(words, wanted);
        }
    }
}
