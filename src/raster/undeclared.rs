//! Signs that a file has a no-data value that it does not declare: a usual one on many samples, and a side whose samples
//! are all the same and end in a step.

use crate::raster::Raster;

/// Values that mean no data in many files and are no height of any ground.
const USUAL: [f64; 8] =
    [-9999.0, -32768.0, -32767.0, -99999.0, -999.0, -9999999.0, -1e10, -3.402_823_466_385_288_6e38];

/// Fewer samples of a usual value than this share are left to the eye: a single spike is another fault.
const LEAST_SHARE: f64 = 1e-4;

/// A side is a margin where this share of its samples is one value: at a corner another margin may begin.
const SAME_SHARE: f64 = 0.95;

/// A margin is no water that ends at a shore, but a hole, where the steps at its rim are this many times those between
/// samples elsewhere. Cliffs on a coast reach 4 or 5.
const STEP_RATIO: f64 = 8.0;

/// Lower steps are not a hole on any ground, in the vertical unit.
const LEAST_STEP: f64 = 5.0;

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
    /// Many files use the value for that.
    UsualValue,
    /// All samples along a side have it, and end in a step.
    FlatMargin,
}

impl UndeclaredNodata {
    /// The value as TOML takes it: an integer of more than 64 bits is a float.
    pub fn written(&self) -> String {
        if self.value.abs() < 1e15 { self.value.to_string() } else { format!("{:e}", self.value) }
    }
}

/// The values that may mean no data without being declared so.
pub fn undeclared_nodata(raster: &Raster) -> Vec<UndeclaredNodata> {
    let all = raster.samples.len() as f64;
    let mut counts = [0u64; USUAL.len()];
    for value in raster.samples.valid().filter(|value| *value <= -999.0) {
        // A 32-bit sample holds the nearest 32-bit value.
        if let Some(at) = USUAL.iter().position(|&usual| value == usual || value as f32 == usual as f32) {
            counts[at] += 1;
        }
    }
    let many = USUAL.iter().zip(counts).filter(|(_, count)| *count > 0 && *count as f64 >= all * LEAST_SHARE);
    let mut found: Vec<UndeclaredNodata> = many
        .map(|(&value, count)| {
            let evidence = format!("{count} samples ({:.1} %) are {value}", count as f64 / all * 100.0);
            UndeclaredNodata { value, evidence, sign: NodataSign::UsualValue }
        })
        .collect();
    for side in SIDES {
        let Some(value) = margin_value(raster, &side) else { continue };
        if found.iter().any(|known| known.value == value) {
            continue;
        }
        let margin = Margin::of(raster, value);
        let step = median(margin.steps);
        if step >= LEAST_STEP && step >= STEP_RATIO * median(usual_steps(raster, value)) {
            let share = margin.count as f64 / all * 100.0;
            let evidence = format!(
                "along the {} side {} samples ({share:.1} %) are all {value} and end in a step of about {step:.0}",
                side.name, margin.count
            );
            found.push(UndeclaredNodata { value, evidence, sign: NodataSign::FlatMargin });
        }
    }
    found
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

/// The value of nearly all samples along a side; `None` where they differ or have no data.
fn margin_value(raster: &Raster, side: &Side) -> Option<f64> {
    let length = (side.length)(raster);
    let value_at = |step: u32| {
        let (column, row) = (side.at)(raster, step);
        raster.at(column, row)
    };
    let middle = value_at(length / 2);
    let same = (0..length).filter(|&step| value_at(step) == middle).count();
    (length > 2 && same as f64 >= f64::from(length) * SAME_SHARE).then_some(middle)
}

/// The samples of one value that are connected to the border by such samples.
struct Margin {
    count: u64,
    /// Heights at its rim above or below it.
    steps: Vec<f64>,
}

impl Margin {
    fn of(raster: &Raster, value: f64) -> Self {
        let (width, height) = (raster.width as usize, raster.height as usize);
        let mut seen = vec![false; width * height];
        let mut margin = Self { count: 0, steps: Vec::new() };
        let mut open: Vec<usize> = raster.border().collect();
        open.sort_unstable();
        open.dedup();
        open.retain(|&at| raster.samples.get(at) == value);
        open.iter().for_each(|&at| seen[at] = true);
        while let Some(at) = open.pop() {
            margin.count += 1;
            for next in raster.beside(at).into_iter().flatten() {
                let height = raster.samples.get(next);
                if height == value && !seen[next] {
                    seen[next] = true;
                    open.push(next);
                } else if height != value && !height.is_nan() {
                    margin.steps.push((height - value).abs());
                }
            }
        }
        margin
    }
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
}
