//! Counts of the values that mean no data in many files, and of those that no ground has.
//!
//! A value that stands for missing data is repeated and stands alone: many samples have it exactly, and few lie near it.
//! Heights are the other way round, so that −9999 in a trench of the sea or 9999 on a mountain in feet is none.

use std::collections::BTreeMap;

use rayon::prelude::*;

use crate::nodata_span::NoDataSpan;
use crate::raster::{Raster, SampleFloat, Samples};
use sandtable_base::vectorized::vectorized;

/// Values that mean no data in many files.
pub(crate) const USUAL: [f64; 25] = [
    -9999.0,
    -32768.0,
    -32767.0,
    -99_999.0,
    -999.0,
    -9_999_999.0,
    -1e10,
    -3.402_823_466_385_288_6e38,
    -10_000.0,
    -9999.9,
    -9999.99,
    -999.9,
    -999.99,
    -2_147_483_648.0,
    9999.0,
    9999.9,
    32767.0,
    32768.0,
    65535.0,
    99_999.0,
    9_999_999.0,
    2_147_483_647.0,
    4_294_967_295.0,
    1.701_41e38,
    3.402_823_466_385_288_6e38,
];

/// Nearly all heights lie between these, and no usual value lies near them.
const PLAIN: (f64, f64) = (-899.0, 9499.0);

/// The depth of the deepest sea and the height of the highest mountain, meters, and some more.
const GROUND_M: (f64, f64) = (-11_500.0, 9500.0);

/// Samples count as near a value up to this distance, or up to [`NEAR_SHARE`] of it, whichever is more.
const NEAR: f64 = 100.0;
const NEAR_SHARE: f64 = 0.05;

/// Fewer samples of a usual value than this share are left to the eye: a single spike is another fault.
const LEAST_SHARE: f64 = 1e-4;

/// A usual value is one of height where more than one in so many of its samples have others near.
const USUAL_ALONE: u64 = 4;

/// The same of a value that no ground has, but that is not usual.
const FAR_ALONE: u64 = 50;

/// Fewer samples of a value that is not usual are left to the eye.
const LEAST_FAR: u64 = 9;

/// More values than these that no ground has are heights in another unit.
const MOST_FAR: usize = 1024;

/// Samples whose range is looked at first: nearly all are plain together.
const PLAIN_TOGETHER: usize = 64;

/// Samples that a thread counts together.
const TOGETHER: usize = 1 << 16;

/// Counts of the odd values among the samples of a raster.
#[derive(Clone)]
pub(crate) struct OddValues {
    spans: [NoDataSpan; USUAL.len()],
    /// Where values may be near usual ones or count as one: apart and rising.
    near_usual: Vec<NearUsual>,
    usual: [ValueCount; USUAL.len()],
    /// Values beyond all ground, by their bits in the order of numbers; none where they are too many.
    far: Option<BTreeMap<u64, u64>>,
    /// The least and the greatest height of ground, in the vertical unit.
    ground: (f64, f64),
    /// Samples, with and without data.
    samples: u64,
    /// The lowest and the highest of the other heights.
    low: f64,
    high: f64,
}

/// Values that may be near some usual ones.
#[derive(Clone)]
struct NearUsual {
    low: f64,
    high: f64,
    /// The places of the usual ones, rising.
    usual: Vec<usize>,
}

#[derive(Clone, Copy, Default)]
struct ValueCount {
    equal: u64,
    near: u64,
}

/// A value that is repeated and stands alone.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct OddValue {
    pub value: f64,
    pub count: u64,
    pub evidence: String,
}

impl OddValues {
    /// None yet of the samples of `raster`.
    pub fn new(raster: &Raster) -> Self {
        let unit_m = if raster.meters_per_z > 0.0 { raster.meters_per_z } else { 1.0 };
        Self {
            spans: USUAL.map(NoDataSpan::around),
            near_usual: near_usual(),
            usual: [ValueCount::default(); USUAL.len()],
            far: Some(BTreeMap::new()),
            ground: (GROUND_M.0 / unit_m, GROUND_M.1 / unit_m),
            samples: 0,
            low: f64::INFINITY,
            high: f64::NEG_INFINITY,
        }
    }

    /// Counts the next samples.
    pub fn add(&mut self, samples: &Samples) {
        match samples {
            Samples::F32(values) => self.add_values(values),
            Samples::F64(values) => self.add_values(values),
        }
    }

    fn add_values<T: SampleFloat>(&mut self, values: &[T]) {
        let none = Self {
            usual: [ValueCount::default(); USUAL.len()],
            far: self.far.as_ref().map(|_| BTreeMap::new()),
            samples: 0,
            ..self.clone()
        };
        let counted: Vec<Self> =
            values.par_chunks(TOGETHER).with_max_len(4).map(|few| none.clone().counted(few)).collect();
        counted.into_iter().for_each(|few| self.join(few));
    }

    fn counted<T: SampleFloat>(mut self, values: &[T]) -> Self {
        self.samples = values.len() as u64;
        for few in values.chunks(PLAIN_TOGETHER) {
            let range = vectorized(
                #[inline(always)]
                || range(few),
            );
            let range = range.map(|(low, high)| (low.into(), high.into()));
            if let Some((low, high)) = range.filter(|range| self.are_plain(*range)) {
                (self.low, self.high) = (self.low.min(low), self.high.max(high));
                continue;
            }
            for &value in few {
                let value: f64 = value.into();
                if value > PLAIN.0 && value < PLAIN.1 {
                    (self.low, self.high) = (self.low.min(value), self.high.max(value));
                } else if !value.is_nan() {
                    self.add_odd(value);
                }
            }
        }
        self
    }

    /// Whether all values from `low` to `high` are plain: of ground, and near no usual one.
    fn are_plain(&self, (low, high): (f64, f64)) -> bool {
        if low > PLAIN.0 && high < PLAIN.1 {
            return true;
        }
        let after = self.near_usual.partition_point(|near| near.high < low);
        let is_far = self.near_usual.get(after).is_none_or(|near| near.low > high);
        is_far && low > self.ground.0 && high < self.ground.1
    }

    fn add_odd(&mut self, value: f64) {
        let after = self.near_usual.partition_point(|near| near.high < value);
        if let Some(near) = self.near_usual.get(after).filter(|near| near.low <= value) {
            if let Some(&at) = near.usual.iter().find(|&&at| self.spans[at].contains(value)) {
                self.usual[at].equal += 1;
                return;
            }
            for &at in &near.usual {
                self.usual[at].near += u64::from((value - USUAL[at]).abs() <= reach(USUAL[at]));
            }
        }
        if value > self.ground.0 && value < self.ground.1 {
            (self.low, self.high) = (self.low.min(value), self.high.max(value));
        } else if let Some(far) = &mut self.far {
            *far.entry(ordered(value)).or_insert(0) += 1;
            if far.len() > MOST_FAR {
                self.far = None;
            }
        }
    }

    fn join(&mut self, later: Self) {
        for (all, later) in self.usual.iter_mut().zip(later.usual) {
            all.equal += later.equal;
            all.near += later.near;
        }
        self.far = self.far.take().zip(later.far).map(|(mut far, later)| {
            later.into_iter().for_each(|(value, count)| *far.entry(value).or_insert(0) += count);
            far
        });
        self.far = self.far.take().filter(|far| far.len() <= MOST_FAR);
        self.samples += later.samples;
        (self.low, self.high) = (self.low.min(later.low), self.high.max(later.high));
    }

    /// The values that are repeated and stand alone: usual ones in their order, then others from the lowest on.
    pub fn found(&self) -> Vec<OddValue> {
        let is_repeated = |count: u64| count > 0 && count as f64 >= self.samples as f64 * LEAST_SHARE;
        let usual = USUAL.iter().zip(&self.usual).filter(|(_, ValueCount { equal, near })| {
            is_repeated(*equal) && near.saturating_mul(USUAL_ALONE) <= *equal
        });
        let mut found: Vec<OddValue> = usual.map(|(&value, count)| self.odd(value, count.equal)).collect();
        for (&bits, &count) in self.far.iter().flatten() {
            if count < LEAST_FAR || !is_repeated(count) {
                continue;
            }
            let value = number(bits);
            let all_far = self.far.iter().flatten();
            let near = all_far
                .filter(|(other, _)| **other != bits && (number(**other) - value).abs() <= reach(value));
            if near.map(|(_, count)| count).sum::<u64>().saturating_mul(FAR_ALONE) <= count {
                found.push(self.odd(value, count));
            }
        }
        found
    }

    fn odd(&self, value: f64, count: u64) -> OddValue {
        let share = count as f64 / self.samples.max(1) as f64 * 100.0;
        let mut evidence = format!("{count} samples ({share:.1} %) are {}", written(value));
        if self.low <= self.high {
            evidence.push_str(&format!(
                "; the others are from {} to {}",
                tenths(self.low),
                tenths(self.high)
            ));
        }
        if value > self.ground.1 {
            evidence.push_str(", and no ground is so high");
        } else if value < self.ground.0 {
            evidence.push_str(", and no ground is so low");
        }
        OddValue { value, count, evidence }
    }
}

/// The value as TOML takes it, and the command line: an integer of more than 64 bits is a float.
pub fn written(value: f64) -> String {
    if value.abs() < 1e15 { value.to_string() } else { format!("{value:e}") }
}

fn tenths(value: f64) -> f64 {
    // Adding 0 makes 0 of -0.
    (value * 10.0).round() / 10.0 + 0.0
}

/// The least and the greatest of some values; `None` where one is NaN, or there is none.
#[inline(always)]
fn range<T: SampleFloat>(values: &[T]) -> Option<(T, T)> {
    /// Values that a processor compares at once.
    const LANES: usize = 8;
    #[expect(clippy::eq_op, reason = "a NaN is the value that is not itself")]
    if !values.iter().fold(true, |all, &value| all & (value == value)) {
        return None;
    }
    let (mut low, mut high) = ([*values.first()?; LANES], [*values.first()?; LANES]);
    let (groups, rest) = values.as_chunks::<LANES>();
    for group in groups.iter().map(|group| &group[..]).chain([rest]) {
        for ((low, high), &value) in low.iter_mut().zip(&mut high).zip(group) {
            *low = if value < *low { value } else { *low };
            *high = if value > *high { value } else { *high };
        }
    }
    let lesser = |a: T, b: T| if b < a { b } else { a };
    let greater = |a: T, b: T| if b > a { b } else { a };
    Some((low.into_iter().reduce(lesser)?, high.into_iter().reduce(greater)?))
}

/// [`OddValues::near_usual`].
fn near_usual() -> Vec<NearUsual> {
    /// More than is lost where the ends are rounded.
    const MORE: f64 = 1.0 + 1e-9;
    let around = |at: usize| {
        let (usual, reach) = (USUAL[at], reach(USUAL[at]) * MORE);
        // The span of a value that was written with few digits reaches farther.
        let (least, most) = NoDataSpan::around(usual).ends::<f64>();
        NearUsual { low: least.min(usual - reach), high: most.max(usual + reach), usual: vec![at] }
    };
    let mut all: Vec<NearUsual> = (0..USUAL.len()).map(around).collect();
    all.sort_by(|a, b| a.low.total_cmp(&b.low));
    let mut apart: Vec<NearUsual> = Vec::new();
    for next in all {
        match apart.last_mut() {
            Some(last) if next.low <= last.high => {
                last.high = last.high.max(next.high);
                last.usual.extend(next.usual);
                last.usual.sort_unstable();
            }
            _ => apart.push(next),
        }
    }
    apart
}

/// How far from a value samples count as near it.
fn reach(value: f64) -> f64 {
    (value.abs() * NEAR_SHARE).max(NEAR)
}

/// The bits of a number, in the order of numbers.
fn ordered(value: f64) -> u64 {
    let bits = value.to_bits();
    if value.is_sign_negative() { !bits } else { bits | (1 << 63) }
}

/// The number whose [`ordered`] bits these are.
fn number(bits: u64) -> f64 {
    f64::from_bits(if bits >> 63 == 1 { bits & !(1 << 63) } else { !bits })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(meters_per_z: f64, values: impl Iterator<Item = f64>) -> Vec<(f64, u64)> {
        let samples = Samples::F64(values.collect());
        let raster = Raster { meters_per_z, ..Raster::new(1, samples.clone()) };
        let mut counts = OddValues::new(&raster);
        // In two parts, as windows are.
        let half = samples.len() / 2;
        let part = |range: std::ops::Range<usize>| Samples::F64(range.map(|at| samples.get(at)).collect());
        counts.add(&part(0..half));
        counts.add(&part(half..samples.len()));
        counts.found().into_iter().map(|odd| (odd.value, odd.count)).collect()
    }

    /// Heights from `from` on, `step` apart, with `value` in every tenth place.
    fn mixed(value: f64, from: f64, step: f64) -> impl Iterator<Item = f64> {
        (0..5000).map(move |at| if at % 10 == 7 { value } else { from + step * f64::from(at) })
    }

    #[test]
    fn repeated_values_that_stand_alone_are_found_whatever_their_sign() {
        for value in USUAL.into_iter().chain([20_000.0, -12_345.0, 55_537.0, 1e6, 1e30, -1e38]) {
            assert_eq!(found(1.0, mixed(value, 100.0, 0.1)), [(value, 500)], "{value}");
        }
        let narrow = f64::from(-9999.9_f32);
        assert_eq!(found(1.0, mixed(narrow, 100.0, 0.1)), [(-9999.9, 500)]);
        assert_eq!(found(1.0, mixed(f64::from(f32::MIN), 100.0, 0.1)), [(f64::from(f32::MIN), 500)]);
    }

    #[test]
    fn near_a_usual_value_is_what_its_reach_says() {
        for (usual, sign) in USUAL.into_iter().flat_map(|usual| [(usual, -1.0), (usual, 1.0)]) {
            for share in [0.0, 1e-9, 0.5, 1.0 - 1e-12, 1.0, 1.0 + 1e-12, 1.01, 9.0, 11.0] {
                let value = usual + sign * share * reach(usual);
                let mut counts = OddValues::new(&Raster::new(1, Samples::F64(vec![value])));
                counts.add(&Samples::F64(vec![value]));
                let is_plain = value > PLAIN.0 && value < PLAIN.1;
                let is_usual = counts.spans.iter().any(|span| span.contains(value));
                assert_eq!(counts.usual.iter().map(|count| count.equal).sum::<u64>(), u64::from(is_usual));
                for (count, other) in counts.usual.iter().zip(USUAL) {
                    let is_near = (value - other).abs() <= reach(other) && !is_usual && !is_plain;
                    assert_eq!(count.near, u64::from(is_near), "{value} beside {other}");
                }
            }
        }
    }

    #[test]
    fn heights_are_not_found_where_ground_reaches_them() {
        // A trench of the sea, a mountain in feet, and heights in centimeters with a lake.
        assert!(found(1.0, mixed(-9999.0, -10_400.0, 0.2)).is_empty());
        assert!(found(0.3048, mixed(9999.0, 9600.0, 0.2)).is_empty());
        assert!(found(1.0, mixed(45_231.0, 44_000.0, 0.5)).is_empty());
        assert!(found(1.0, (0..5000).map(f64::from)).is_empty());
        // One sample that no ground has is a spike.
        assert!(found(1.0, (0..5000).map(|at| if at == 7 { 20_000.0 } else { 5.0 })).is_empty());
    }

    #[test]
    fn values_that_resampling_made_on_the_way_to_the_ground_do_not_hide_it() {
        let rim = (0..100).map(|at| -9999.0 + 100.0 * f64::from(at));
        assert_eq!(found(1.0, mixed(-9999.0, 100.0, 0.1).chain(rim)), [(-9999.0, 501)]);
    }

    #[test]
    fn evidence_says_what_the_other_heights_are() {
        let raster = Raster::new(1, Samples::F32(vec![100.0, 276.96, 65535.0, f32::NAN]));
        let mut counts = OddValues::new(&raster);
        counts.add(&raster.samples);
        let found = counts.found();
        assert_eq!(
            found[0].evidence,
            "1 samples (25.0 %) are 65535; the others are from 100 to 277, and no ground is so high"
        );
    }

    #[test]
    fn bits_in_the_order_of_numbers_come_back() {
        let values = [f64::MIN, -1.5, -0.0, 0.0, 2.5, 1e300];
        assert!(values.windows(2).all(|pair| ordered(pair[0]) < ordered(pair[1])));
        assert!(values.iter().all(|value| number(ordered(*value)).to_bits() == value.to_bits()));
    }
}
