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
//! A chain over all of them takes one step a byte, each waiting for the one before. But each quarter's chain starts at
//! the plain sum of the quarters before it, which takes no chain: so four shorter chains run side by side and yield
//! samples as they go.

use crate::dem::bytes::ByteOrder;
use crate::dem::error::DemErrorKind;
use crate::dem::raster::SampleFloat;
use crate::dem::sample_type::SampleType;
use crate::dem::tiff::storage::{Predictor, Storage};

#[derive(Clone, Copy, Debug)]
pub(crate) struct RowDecoder {
    sample: SampleType,
    predictor: Predictor,
    order: ByteOrder,
    bands: usize,
    nodata: f64,
}

impl RowDecoder {
    /// For an image whose no-data value is `nodata`.
    pub fn new(storage: &Storage, nodata: Option<f64>) -> Result<Self, DemErrorKind> {
        let sample = storage.elevation_type()?;
        let Storage { predictor, order, bands_per_block, .. } = *storage;
        Ok(Self {
            sample,
            predictor,
            order,
            bands: bands_per_block.into(),
            nodata: sample.comparable(nodata),
        })
    }
}

pub(crate) trait Elevation: SampleFloat {
    /// Decodes a row's first samples, as many as `out` holds. `row` is a whole row of a block.
    fn decode(rows: &RowDecoder, row: &[u8], words: &mut RowWords, out: &mut [Self]);
}

/// The words of one row, reused.
#[derive(Debug, Default)]
pub(crate) struct RowWords {
    of_8: Vec<u8>,
    of_16: Vec<u16>,
    of_32: Vec<u32>,
    of_64: Vec<u64>,
}

impl Elevation for f32 {
    fn decode(rows: &RowDecoder, row: &[u8], words: &mut RowWords, out: &mut [Self]) {
        // No sample of 32 bits equals a value that 32 bits cannot hold.
        let nodata =
            if f64::from(rows.nodata as Self) == rows.nodata { rows.nodata as Self } else { Self::NAN };
        let known = |value: Self| if value == nodata || !value.is_finite() { Self::NAN } else { value };
        match rows.sample {
            SampleType::U8 => convert(words_of(rows, row, &mut words.of_8), out, |w| known(w.into())),
            SampleType::I8 => convert(words_of(rows, row, &mut words.of_8), out, |w| known((w as i8).into())),
            SampleType::U16 => convert(words_of(rows, row, &mut words.of_16), out, |w| known(w.into())),
            SampleType::I16 => {
                convert(words_of(rows, row, &mut words.of_16), out, |w| known((w as i16).into()));
            }
            SampleType::F16 => {
                let value = |w| known(half::f16::from_bits(w).to_f32());
                convert(words_of(rows, row, &mut words.of_16), out, value);
            }
            _ => convert(words_of(rows, row, &mut words.of_32), out, |w| known(Self::from_bits(w))),
        }
    }
}

impl Elevation for f64 {
    fn decode(rows: &RowDecoder, row: &[u8], words: &mut RowWords, out: &mut [Self]) {
        let known = |value: Self| if value == rows.nodata || !value.is_finite() { Self::NAN } else { value };
        match rows.sample {
            SampleType::U32 => convert(words_of(rows, row, &mut words.of_32), out, |w| known(w.into())),
            SampleType::I32 => {
                convert(words_of(rows, row, &mut words.of_32), out, |w| known((w as i32).into()));
            }
            SampleType::U64 => convert(words_of(rows, row, &mut words.of_64), out, |w| known(w as Self)),
            SampleType::I64 => {
                convert(words_of(rows, row, &mut words.of_64), out, |w| known(w as i64 as Self));
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
    fn from_bytes(bytes: &[u8], order: ByteOrder) -> Self;
    fn plus(self, other: Self) -> Self;
    /// Undoes the floating-point predictor: the first of every `bands` samples of a row of them.
    fn sum_planes(row: &[u8], bands: usize, words: &mut [Self]);
}

macro_rules! words {
    ($($word:ty: $bytes:literal),*) => {$(
        impl SampleWord for $word {
            fn from_bytes(bytes: &[u8], order: ByteOrder) -> Self {
                let bytes = bytes.try_into().unwrap_or_default();
                match order {
                    ByteOrder::Little => Self::from_le_bytes(bytes),
                    ByteOrder::Big => Self::from_be_bytes(bytes),
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
    let word_of = |sample: &[u8]| W::from_bytes(&sample[..bytes], rows.order);
    let samples = row.chunks_exact(bytes * rows.bands);
    match rows.predictor {
        Predictor::FloatBytes => W::sum_planes(row, rows.bands, words),
        Predictor::Differences => {
            let mut sum = W::default();
            for (word, sample) in words.iter_mut().zip(samples) {
                sum = sum.plus(word_of(sample));
                *word = sum;
            }
        }
        Predictor::Plain => {
            for (word, sample) in words.iter_mut().zip(samples) {
                *word = word_of(sample);
            }
        }
    }
    words
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn rows(sample: SampleType, predictor: Predictor, order: ByteOrder, bands: usize) -> RowDecoder {
        RowDecoder { sample, predictor, order, bands, nodata: f64::NAN }
    }

    #[test]
    fn differences_are_summed_band_by_band_in_either_byte_order() {
        let mut out = [0f32; 3];
        let rows_of = |order| rows(SampleType::I16, Predictor::Differences, order, 2);
        let little = [5u8, 0, 9, 9, 0xff, 0xff, 9, 9, 0xfb, 0xff, 9, 9];
        f32::decode(&rows_of(ByteOrder::Little), &little, &mut RowWords::default(), &mut out);
        assert_eq!(out, [5.0, 4.0, -1.0]);
        let big: Vec<u8> = little.chunks_exact(2).flat_map(|pair| [pair[1], pair[0]]).collect();
        f32::decode(&rows_of(ByteOrder::Big), &big, &mut RowWords::default(), &mut out);
        assert_eq!(out, [5.0, 4.0, -1.0]);
    }

    #[test]
    fn the_value_for_no_data_and_what_is_not_finite_become_nan() {
        let row = [7f32, -9999.0, f32::INFINITY, 8.0].map(f32::to_le_bytes).concat();
        let mut out = [0f32; 4];
        let plain = rows(SampleType::F32, Predictor::Plain, ByteOrder::Little, 1);
        f32::decode(&RowDecoder { nodata: -9999.0, ..plain }, &row, &mut RowWords::default(), &mut out);
        assert!(out[0] == 7.0 && out[1].is_nan() && out[2].is_nan() && out[3] == 8.0);
        // 0.1 is no float: no sample of 32 bits equals it.
        f32::decode(&RowDecoder { nodata: 0.1, ..plain }, &row, &mut RowWords::default(), &mut out);
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
