//! Signs that a file has a no-data value that it does not declare: a value that is repeated and stands alone, and a margin
//! whose samples are all the same and end in a step.
//!
//! ```text
//! ┌──────────────┐   a margin reaches the border along a row or a column from nearly all of its samples, as a side does,
//! │▒▒▒▒▒/        │   and the corners that are left where a raster was turned. A river, which winds, does not: its steps
//! │▒▒▒/      /▒▒▒│   would have to be far higher
//! │▒/     /▒▒▒▒▒▒│
//! └──────────────┘
//! ```

use std::collections::BTreeMap;

use crate::nodata_span::NoDataSpan;
use crate::odd_values::{OddValues, written};
use crate::raster::Raster;

/// A side is a margin where this share of its samples is one value: at a corner another margin may begin.
const SAME_SHARE: f64 = 0.95;

/// A margin is no water that ends at a shore, but a hole, where the steps at its rim are this many times those between
/// samples elsewhere. Cliffs on a coast reach 4 or 5.
const STEP_RATIO: f64 = 8.0;

/// Lower steps are not a hole on any ground, in the vertical unit.
const LEAST_STEP: f64 = 5.0;

/// The same of a region that winds: it may be a river in a canyon.
const WINDING_STEP_RATIO: f64 = 15.0;
const LEAST_WINDING_STEP: f64 = 25.0;

/// The least share of all samples that a margin takes that is not a whole side.
const LEAST_MARGIN: f64 = 1e-3;

/// The least share of the border that it takes.
const LEAST_BORDER: f64 = 5e-3;

/// The share of a margin's samples that reach the border straight on.
const STRAIGHT_SHARE: f64 = 0.9;

/// The share of a margin's samples that have two of it beside them: equal samples here and there are none.
const CONNECTED_SHARE: f64 = 0.5;

/// The values on the border that are tried, the most frequent ones.
const MOST_TRIED: usize = 4;

/// The steps between samples that are compared are at most about this many.
const MOST_STEPS: usize = 100_000;

/// A value that may mean no data, and why.
#[derive(Clone, Debug, PartialEq)]
pub struct UndeclaredNodata {
    /// The value of the samples.
    pub value: f64,
    /// The evidence, as a sentence.
    pub evidence: String,
    /// What kind of evidence that is.
    pub sign: NodataSign,
}

/// A sign that a value means no data.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NodataSign {
    /// Many files use the value for that, or no ground has it.
    UsualValue,
    /// All samples along a side or in a corner have it, and end in a step.
    FlatMargin,
}

impl UndeclaredNodata {
    /// The value as TOML takes it: an integer of more than 64 bits is a float.
    pub fn written(&self) -> String {
        written(self.value)
    }
}

/// The values that may mean no data without being declared so.
pub fn undeclared_nodata(raster: &Raster) -> Vec<UndeclaredNodata> {
    let mut counts = OddValues::new(raster);
    counts.add(&raster.samples);
    let mut found = of_counts(&counts);
    for value in border_values(raster) {
        if found.iter().any(|known| NoDataSpan::around(known.value).contains(value)) {
            continue;
        }
        found.extend(flat_margin(raster, value));
    }
    found
}

/// The values that may mean no data by themselves.
pub(crate) fn of_counts(counts: &OddValues) -> Vec<UndeclaredNodata> {
    let found = counts.found().into_iter();
    let undeclared = found.map(|odd| UndeclaredNodata {
        value: odd.value,
        evidence: odd.evidence,
        sign: NodataSign::UsualValue,
    });
    undeclared.collect()
}

/// A side of the raster.
struct Side {
    /// In the order of the file's rows and columns, which is that of the map in nearly all files.
    name: &'static str,
    at: fn(&Raster, u32) -> (u32, u32),
    length: fn(&Raster) -> u32,
}

const SIDES: [Side; 4] = [
    Side { name: "upper", at: |_, step| (step, 0), length: |raster| raster.width },
    Side { name: "lower", at: |raster, step| (step, raster.height - 1), length: |raster| raster.width },
    Side { name: "left", at: |_, step| (0, step), length: |raster| raster.height },
    Side { name: "right", at: |raster, step| (raster.width - 1, step), length: |raster| raster.height },
];

impl Side {
    /// Whether nearly all samples along the side have a value.
    fn is_all(&self, raster: &Raster, value: f64) -> bool {
        let length = (self.length)(raster);
        let is_same = |step: &u32| {
            let (column, row) = (self.at)(raster, *step);
            raster.at(column, row) == value
        };
        length > 2 && (0..length).filter(is_same).count() as f64 >= f64::from(length) * SAME_SHARE
    }
}

/// The values that samples on the border share most often, and those of whole sides.
fn border_values(raster: &Raster) -> Vec<f64> {
    let (mut counts, mut all) = (BTreeMap::<u64, usize>::new(), 0usize);
    for value in raster.border().map(|at| raster.samples.get(at)) {
        all += 1;
        if !value.is_nan() {
            // -0 is 0.
            *counts.entry((value + 0.0).to_bits()).or_insert(0) += 1;
        }
    }
    let mut counts: Vec<(u64, usize)> = counts.into_iter().collect();
    counts.sort_by_key(|&(bits, count)| (usize::MAX - count, bits));
    let frequent = counts.into_iter().filter(|(_, count)| *count as f64 >= all as f64 * LEAST_BORDER);
    frequent.take(MOST_TRIED).map(|(bits, _)| f64::from_bits(bits)).collect()
}

/// The samples of a value that are connected to the border, if they are a margin without data.
fn flat_margin(raster: &Raster, value: f64) -> Option<UndeclaredNodata> {
    let margin = Margin::of(raster, value);
    let step = median(margin.steps);
    if step < LEAST_STEP {
        return None;
    }
    let usual = median(usual_steps(raster, value));
    let share = margin.count as f64 / raster.samples.len() as f64;
    let side = SIDES.iter().find(|side| side.is_all(raster, value));
    let is_margin = match side {
        Some(_) => step >= STEP_RATIO * usual,
        None => {
            let is_straight = || straight_share(raster, &margin.samples, margin.count) >= STRAIGHT_SHARE;
            let is_high = step >= LEAST_WINDING_STEP && step >= WINDING_STEP_RATIO * usual;
            let is_region = || connected_share(raster, &margin.samples, margin.count) >= CONNECTED_SHARE;
            share >= LEAST_MARGIN && step >= STEP_RATIO * usual && is_region() && (is_high || is_straight())
        }
    };
    let along = side.map_or_else(|| "border".to_owned(), |side| format!("{} side", side.name));
    is_margin.then(|| {
        let (count, share) = (margin.count, share * 100.0);
        let evidence =
            format!("along the {along} {count} samples ({share:.1} %) are all {value} and end in a step of about {step:.0}");
        UndeclaredNodata { value, evidence, sign: NodataSign::FlatMargin }
    })
}

/// The samples of one value that are connected to the border by such samples.
struct Margin {
    count: u64,
    /// Whether each sample of the raster belongs to it.
    samples: Vec<bool>,
    /// Heights at its rim above or below it.
    steps: Vec<f64>,
}

impl Margin {
    fn of(raster: &Raster, value: f64) -> Self {
        let (width, height) = (raster.width as usize, raster.height as usize);
        let mut margin = Self { count: 0, samples: vec![false; width * height], steps: Vec::new() };
        let mut open: Vec<usize> = raster.border().collect();
        open.sort_unstable();
        open.dedup();
        open.retain(|&at| raster.samples.get(at) == value);
        open.iter().for_each(|&at| margin.samples[at] = true);
        while let Some(at) = open.pop() {
            margin.count += 1;
            for next in raster.beside(at).into_iter().flatten() {
                let height = raster.samples.get(next);
                if height == value && !margin.samples[next] {
                    margin.samples[next] = true;
                    open.push(next);
                } else if height != value && !height.is_nan() {
                    margin.steps.push((height - value).abs());
                }
            }
        }
        margin
    }
}

/// The share of `count` samples that have two such samples beside them.
fn connected_share(raster: &Raster, samples: &[bool], count: u64) -> f64 {
    let is_within =
        |at: usize| raster.beside(at).into_iter().flatten().filter(|&at| samples[at]).count() >= 2;
    let connected = (0..samples.len()).filter(|&at| samples[at] && is_within(at)).count();
    connected as f64 / count.max(1) as f64
}

/// The share of `count` samples from which a row or a column of such samples leads to the border.
fn straight_share(raster: &Raster, samples: &[bool], count: u64) -> f64 {
    let (width, height) = (raster.width as usize, raster.height as usize);
    let mut is_straight = vec![false; samples.len()];
    let mut follow = |line: Box<dyn Iterator<Item = usize>>| {
        // From the border inward, until the margin ends.
        line.take_while(|&at| samples[at]).for_each(|at| is_straight[at] = true);
    };
    for row in 0..height {
        let (first, last) = (row * width, (row + 1) * width);
        follow(Box::new(first..last));
        follow(Box::new((first..last).rev()));
    }
    for column in 0..width {
        follow(Box::new((column..samples.len()).step_by(width)));
        follow(Box::new((0..height).rev().map(move |row| row * width + column)));
    }
    is_straight.iter().filter(|is_straight| **is_straight).count() as f64 / count.max(1) as f64
}

/// Differences between neighbors in a row, neither of them `value`.
pub(crate) fn usual_steps(raster: &Raster, value: f64) -> Vec<f64> {
    let width = raster.width as usize;
    let every = raster.samples.len() / MOST_STEPS + 1;
    let inner = (0..raster.samples.len()).step_by(every).filter(|at| at % width + 1 < width);
    let pairs = inner.map(|at| (raster.samples.get(at), raster.samples.get(at + 1)));
    let ground = pairs.filter(|(a, b)| *a != value && *b != value);
    ground.map(|(a, b)| (a - b).abs()).filter(|step| !step.is_nan()).collect()
}

/// The middle of the values; 0 where there is none.
pub(crate) fn median(mut values: Vec<f64>) -> f64 {
    values.sort_unstable_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::odd_values::USUAL;

    #[test]
    fn a_value_is_written_as_a_number_of_a_scene_file() {
        for value in USUAL.into_iter().chain([0.0, -0.5]) {
            let written =
                UndeclaredNodata { value, evidence: String::new(), sign: NodataSign::UsualValue }.written();
            let table: toml::Table = format!("nodata = {written}").parse().expect("TOML");
            let read = table["nodata"].as_float().or(table["nodata"].as_integer().map(|whole| whole as f64));
            assert_eq!(read, Some(value), "{written}");
        }
        let zero = UndeclaredNodata { value: 0.0, evidence: String::new(), sign: NodataSign::UsualValue };
        assert_eq!(zero.written(), "0");
    }
    use crate::raster::tests::small;

    /// Hills around `base` on 60 by 60 samples, but `value` in the first `columns` columns.
    fn hills(base: f32, columns: u32, value: f32) -> Raster {
        let height = |at: u32| {
            let (column, row) = (at % 60, at / 60);
            let hill = 30.0 * libm::sinf(column as f32 * 0.2) * libm::cosf(row as f32 * 0.15);
            if column < columns { value } else { base + hill }
        };
        small(60, 60, (0..3600).map(height).collect())
    }

    fn found(raster: &Raster) -> Vec<f64> {
        undeclared_nodata(raster).iter().map(|found| found.value).collect()
    }

    #[test]
    fn a_usual_no_data_value_on_many_samples_is_found() {
        assert_eq!(found(&hills(200.0, 3, -9999.0)), [-9999.0]);
        let mut raster = hills(200.0, 0, 0.0);
        raster.samples.set(1800, -32768.0);
        assert_eq!(found(&raster), [-32768.0]);
        assert!(undeclared_nodata(&raster)[0].evidence.starts_with("1 samples (0.0 %) are -32768"));
    }

    #[test]
    fn a_flat_margin_is_found_where_it_ends_in_a_step_and_not_where_it_is_the_sea() {
        let margin = undeclared_nodata(&hills(300.0, 9, 0.0));
        assert_eq!(margin.len(), 1);
        let wanted = "along the left side 540 samples (15.0 %) are all 0 and end in a step of about ";
        assert!(margin[0].evidence.starts_with(wanted), "{}", margin[0].evidence);
        // A coast: the ground rises from the sea.
        let coast = |at: u32| ((at % 60) as f32 - 20.0).max(0.0) * 4.0;
        assert!(found(&small(60, 60, (0..3600).map(coast).collect())).is_empty());
        assert!(found(&hills(300.0, 0, 0.0)).is_empty());
        assert!(found(&small(9, 9, vec![7.0; 81])).is_empty(), "level ground");
    }

    /// Hills around 300 on 90 by 70 samples, with `value` where `is_beyond` says of column and row.
    fn cut(value: f32, is_beyond: impl Fn(f32, f32) -> bool) -> Raster {
        let height = |at: u32| {
            let (column, row) = ((at % 90) as f32, (at / 90) as f32);
            let hill = 30.0 * libm::sinf(column * 0.2) * libm::cosf(row * 0.15);
            if is_beyond(column, row) { value } else { 300.0 + hill }
        };
        small(90, 70, (0..6300).map(height).collect())
    }

    #[test]
    fn bands_and_slanting_corners_of_any_value_are_found() {
        // A quad that was turned, one that was turned a little, a corner alone, bands across and aslant.
        let turned = |column: f32, row: f32| {
            let (x, y) = (column - 45.0, row - 35.0);
            let at = (0.9 * x - 0.44 * y, 0.44 * x + 0.9 * y);
            at.0.abs() > 34.0 || at.1.abs() > 26.0
        };
        let sliver = |column: f32, row: f32| column < row * 0.05 || row > 66.0 - column * 0.04;
        let corner = |column: f32, row: f32| column + row < 12.0;
        let band = |_: f32, row: f32| (30.0..34.0).contains(&row);
        let aslant = |column: f32, row: f32| (column - row * 0.5 - 20.0).abs() < 5.0;
        let shapes: [&dyn Fn(f32, f32) -> bool; 5] = [&turned, &sliver, &corner, &band, &aslant];
        for (shape, is_beyond) in shapes.iter().enumerate() {
            for value in [0.0, 255.0, 5000.0, 65535.0, 32767.0, 9999.0, -10_000.0, -9999.9, -9999.0] {
                assert_eq!(found(&cut(value, is_beyond)).len(), 1, "{shape}: {value}");
            }
        }
        let signs: Vec<NodataSign> = [0.0, 9999.0]
            .iter()
            .flat_map(|&value| undeclared_nodata(&cut(value, corner)))
            .map(|it| it.sign)
            .collect();
        assert_eq!(signs, [NodataSign::FlatMargin, NodataSign::UsualValue]);
        let found = undeclared_nodata(&cut(0.0, corner));
        let wanted = "along the border 78 samples (1.2 %) are all 0";
        assert!(found[0].evidence.starts_with(wanted), "{found:?}");
    }

    #[test]
    fn water_at_the_border_is_no_margin() {
        // A lake with low banks, a river in a valley that it cut, and level ground of whole meters.
        let lake = |column: f32, row: f32| libm::hypotf(column - 90.0, row - 35.0) < 20.0;
        let surface =
            |column: f32, row: f32| 270.0 + 0.8 * (libm::hypotf(column - 90.0, row - 35.0) - 20.0).max(0.0);
        let lake_land = |at: u32| {
            let (column, row) = ((at % 90) as f32, (at / 90) as f32);
            if lake(column, row) { 270.0 } else { surface(column, row) }
        };
        assert!(found(&small(90, 70, (0..6300).map(lake_land).collect())).is_empty());
        let river = |at: u32| {
            let (column, row) = ((at % 90) as f32, (at / 90) as f32);
            let off = (row - 35.0 - 12.0 * libm::sinf(column * 0.15)).abs();
            if off < 2.0 { 250.0 } else { 250.0 + (off * 4.0).min(40.0) + libm::sinf(column * 0.3) }
        };
        assert!(found(&small(90, 70, (0..6300).map(river).collect())).is_empty());
        // Equal heights here and there along a border that slopes steeply away from it.
        let spots = |at: u32| {
            let (column, row) = (at % 90, at / 90);
            if row == 0 && column % 6 == 0 { 300.0 } else { 300.0 + 40.0 * row as f32 + 0.3 * column as f32 }
        };
        assert!(found(&small(90, 70, (0..6300).map(spots).collect())).is_empty());
        let steps = |at: u32| (300.0 + 0.1 * (at % 90) as f32 + 0.05 * (at / 90) as f32).floor();
        assert!(found(&small(90, 70, (0..6300).map(steps).collect())).is_empty());
    }
}
