//! Decodes one unpacked row of a TIFF block to elevations: undoes the predictor, takes one band, turns no data to NaN.
//!
//! Two passes over a row, both short enough to stay in the processor's nearest memory: bytes to words of a sample's
//! width, then words to elevations. The first is a chain of sums, the second a loop without a branch. Samples that are stored as
//! they are take one.
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
use sandtable_raster::nodata_span::NoDataSpan;
use sandtable_raster::raster::SampleFloat;
use sandtable_raster::sample_type::SampleType;

#[derive(Clone, Copy, Debug)]
pub(crate) struct RowDecoder {
    sample: SampleType,
    predictor: Predictor,
    order: ByteOrder,
    /// Bands side by side.
    bands: usize,
    /// The one that is decoded, from 0.
    band: usize,
    nodata: NoDataSpan,
}

impl RowDecoder {
    /// For the first band of an image whose no-data value is `nodata`.
    pub fn new(storage: &Storage, nodata: Option<f64>) -> Result<Self, DemErrorKind> {
        let sample = storage.elevation_type()?;
        let Storage { predictor, order, bands_per_block, .. } = *storage;
        let (bands, nodata) = (bands_per_block.into(), sample.nodata_span(nodata));
        Ok(Self { sample, predictor, order, bands, band: 0, nodata })
    }

    /// For another band of the same image, all of whose values are data; `band` counts from 0.
    pub fn of_band(self, band: u16) -> Self {
        // Where bands lie in blocks of their own, each is the first of its block.
        Self { band: usize::from(band).min(self.bands - 1), nodata: NoDataSpan::NONE, ..self }
    }

    /// Decodes a row's first samples, as many as `out` holds. `row` is a whole row of a block.
    pub fn decode<T: SampleFloat>(&self, row: &[u8], words: &mut RowWords, out: &mut [T]) {
        let (low, high) = self.nodata.ends::<T>();
        let known = |value: f64| {
            let narrow = T::from_f64(value);
            if (narrow >= low) & (narrow <= high) | !value.is_finite() { T::NODATA } else { narrow }
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
        if self.predictor == Predictor::Plain && self.bands == 1 {
            let samples = out.iter_mut().zip(row.chunks_exact(size_of::<W>()));
            match self.order {
                ByteOrder::Little => {
                    samples.for_each(|(out, bytes)| *out = value(W::from_bytes(bytes, ByteOrder::Little)));
                }
                ByteOrder::Big => {
                    samples.for_each(|(out, bytes)| *out = value(W::from_bytes(bytes, ByteOrder::Big)));
                }
            }
            return;
        }
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
    /// Undoes the floating-point predictor: the sample of `band` of every `bands` samples of a row of them.
    fn sum_planes(row: &[u8], bands: usize, band: usize, words: &mut [Self]);
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

            fn sum_planes(row: &[u8], bands: usize, band: usize, words: &mut [Self]) {
                let plane = row.len() / $bytes;
                let planes: [&[u8]; $bytes] = std::array::from_fn(|at| &row[at * plane..(at + 1) * plane]);
                let mut sums = [0u8; $bytes];
                let mut before = 0u8;
                for (start, plane) in sums.iter_mut().zip(planes) {
                    *start = before;
                    before = before.wrapping_add(sum(plane, bands, band));
                }
                if bands == 1 {
                    // Of one length, so that none is tested at every sample.
                    let count = plane.min(words.len());
                    let (words, planes) = (&mut words[..count], planes.map(|plane| &plane[..count]));
                    for (at, word) in words.iter_mut().enumerate() {
                        for (sum, plane) in sums.iter_mut().zip(planes) {
                            *sum = sum.wrapping_add(plane[at]);
                        }
                        *word = Self::from_be_bytes(sums);
                    }
                    return;
                }
                for (word, at) in words.iter_mut().zip((band..plane).step_by(bands)) {
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

/// The sum of every `bands`th byte from number `band` on.
fn sum(plane: &[u8], bands: usize, band: usize) -> u8 {
    if bands == 1 {
        return plane.iter().fold(0u8, |sum, byte| sum.wrapping_add(*byte));
    }
    plane.iter().skip(band).step_by(bands).fold(0u8, |sum, byte| sum.wrapping_add(*byte))
}

/// One band's words of a row.
fn words_of<'a, W: SampleWord>(rows: &RowDecoder, row: &[u8], words: &'a mut Vec<W>) -> &'a [W] {
    let bytes = size_of::<W>();
    words.resize(row.len() / (bytes * rows.bands), W::default());
    let at = bytes * rows.band;
    let word_of = |pixel: &[u8]| W::from_bytes(&pixel[at..at + bytes], rows.order);
    let samples = row.chunks_exact(bytes * rows.bands);
    match rows.predictor {
        Predictor::FloatBytes => W::sum_planes(row, rows.bands, rows.band, words),
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
        RowDecoder { sample, predictor, order, bands, band: 0, nodata: NoDataSpan::NONE }
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
        let stated = |value: f64| RowDecoder { nodata: SampleType::F32.nodata_span(Some(value)), ..plain };
        stated(-9999.0).decode(&row, &mut RowWords::default(), &mut out);
        assert!(out[0] == 7.0 && out[1].is_nan() && out[2].is_nan() && out[3] == 8.0);
        stated(-9999.1).decode(&row, &mut RowWords::default(), &mut out);
        assert_eq!(out[1], -9999.0);
    }

    #[test]
    fn a_value_for_no_data_with_six_digits_is_met_by_samples_with_all_of_theirs() {
        let mut out = [0f32; 2];
        let row = [f32::MIN, -3.0].map(f32::to_le_bytes).concat();
        let plain = rows(SampleType::F32, Predictor::Plain, ByteOrder::Little, 1);
        let stated = RowDecoder { nodata: SampleType::F32.nodata_span(Some(-3.40282e38)), ..plain };
        stated.decode(&row, &mut RowWords::default(), &mut out);
        assert!(out[0].is_nan() && out[1] == -3.0);
        // In 16 bits -9999 is -10000.
        let row =
            [half::f16::from_f32(-9999.0), half::f16::from_f32(-3.0)].map(half::f16::to_le_bytes).concat();
        let plain = rows(SampleType::F16, Predictor::Plain, ByteOrder::Little, 1);
        let stated = RowDecoder { nodata: SampleType::F16.nodata_span(Some(-9999.0)), ..plain };
        stated.decode(&row, &mut RowWords::default(), &mut out);
        assert!(out[0].is_nan() && out[1] == -3.0);
    }

    #[test]
    fn another_band_of_a_row_is_decoded_alike() {
        let mut out = [0f32; 2];
        let row = [5u8, 0, 9, 0, 0xfe, 0xff, 1, 0];
        for (predictor, first, second) in
            [(Predictor::Plain, [5.0, -2.0], [9.0, 1.0]), (Predictor::Differences, [5.0, 3.0], [9.0, 10.0])]
        {
            let decoder = rows(SampleType::I16, predictor, ByteOrder::Little, 2);
            decoder.decode(&row, &mut RowWords::default(), &mut out);
            assert_eq!(out, first);
            decoder.of_band(1).decode(&row, &mut RowWords::default(), &mut out);
            assert_eq!(out, second);
        }
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
            for band in 0..bands {
                let word = |at: usize| {
                    u64::from_be_bytes(std::array::from_fn(|byte| chained[byte * plane + at * bands + band]))
                };
                let wanted: Vec<u64> = (0..bytes.len()).map(word).collect();
                let mut words = vec![0u64; bytes.len()];
                u64::sum_planes(&row, bands, band, &mut words);
                prop_assert_eq!(words, wanted);
            }
        }
    }
}
