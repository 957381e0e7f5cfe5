//! Decodes one unpacked row of a TIFF block to elevations: undoes the predictor, takes the first band, turns no data to
//! NaN.
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

use crate::tiff::storage::{Predictor, Storage};
use sandtable_base::bytes::ByteOrder;
use sandtable_raster::error::DemErrorKind;
use sandtable_raster::raster::SampleFloat;
use sandtable_raster::sample_type::SampleType;

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

    /// Decodes a row's first samples, as many as `out` holds. `row` is a whole row of a block.
    pub fn decode<T: SampleFloat>(&self, row: &[u8], words: &mut RowWords, out: &mut [T]) {
        // No sample equals a value that its type cannot hold.
        let nodata = T::from_f64(self.nodata);
        let nodata = if nodata.into() == self.nodata { nodata } else { T::NODATA };
        let known = |value: f64| {
            let narrow = T::from_f64(value);
            if narrow == nodata || !value.is_finite() { T::NODATA } else { narrow }
        };
        match self.sample {
            SampleType::U8 => self.convert(row, &mut words.bits_8, out, |w| known(w.into())),
            SampleType::I8 => self.convert(row, &mut words.bits_8, out, |w| known((w as i8).into())),
            SampleType::U16 => self.convert(row, &mut words.bits_16, out, |w| known(w.into())),
            SampleType::I16 => self.convert(row, &mut words.bits_16, out, |w| known((w as i16).into())),
            SampleType::F16 => {
                self.convert(row, &mut words.bits_16, out, |w| known(half::f16::from_bits(w).to_f64()));
            }
            SampleType::U32 => self.convert(row, &mut words.bits_32, out, |w| known(w.into())),
            SampleType::I32 => self.convert(row, &mut words.bits_32, out, |w| known((w as i32).into())),
            SampleType::F32 => {
                self.convert(row, &mut words.bits_32, out, |w| known(f32::from_bits(w).into()));
            }
            SampleType::U64 => self.convert(row, &mut words.bits_64, out, |w| known(w as f64)),
            SampleType::I64 => self.convert(row, &mut words.bits_64, out, |w| known(w as i64 as f64)),
            SampleType::F64 => self.convert(row, &mut words.bits_64, out, |w| known(f64::from_bits(w))),
        }
    }

    fn convert<W: SampleWord, T>(
        &self,
        row: &[u8],
        words: &mut Vec<W>,
        out: &mut [T],
        value: impl Fn(W) -> T,
    ) {
        for (out, &word) in out.iter_mut().zip(words_of(self, row, words)) {
            *out = value(word);
        }
    }
}

/// The words of one row, reused.
#[derive(Debug, Default)]
pub(crate) struct RowWords {
    bits_8: Vec<u8>,
    bits_16: Vec<u16>,
    bits_32: Vec<u32>,
    bits_64: Vec<u64>,
}

/// The bits of a sample as one number.
trait SampleWord: Copy + Default {
    fn from_bytes(bytes: &[u8], order: ByteOrder) -> Self;
    fn plus(self, other: Self) -> Self;
    /// Undoes the floating-point predictor: the first of every `bands` samples of a row of them.
    fn sum_planes(row: &[u8], bands: usize, words: &mut [Self]);
}

macro_rules! words {
    ($($word:ident: $bytes:literal),*) => {$(
        impl SampleWord for $word {
            fn from_bytes(bytes: &[u8], order: ByteOrder) -> Self {
                order.$word(bytes.try_into().unwrap_or_default())
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
        rows_of(ByteOrder::Little).decode(&little, &mut RowWords::default(), &mut out);
        assert_eq!(out, [5.0, 4.0, -1.0]);
        let big: Vec<u8> = little.chunks_exact(2).flat_map(|pair| [pair[1], pair[0]]).collect();
        rows_of(ByteOrder::Big).decode(&big, &mut RowWords::default(), &mut out);
        assert_eq!(out, [5.0, 4.0, -1.0]);
    }

    #[test]
    fn the_value_for_no_data_and_what_is_not_finite_become_nan() {
        let row = [7f32, -9999.0, f32::INFINITY, 8.0].map(f32::to_le_bytes).concat();
        let mut out = [0f32; 4];
        let plain = rows(SampleType::F32, Predictor::Plain, ByteOrder::Little, 1);
        RowDecoder { nodata: -9999.0, ..plain }.decode(&row, &mut RowWords::default(), &mut out);
        assert!(out[0] == 7.0 && out[1].is_nan() && out[2].is_nan() && out[3] == 8.0);
        // 0.1 is no float: no sample of 32 bits equals it.
        RowDecoder { nodata: 0.1, ..plain }.decode(&row, &mut RowWords::default(), &mut out);
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
