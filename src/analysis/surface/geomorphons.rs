//! Landforms by what a post sees in eight directions (Jasiewicz and Stepinski 2013), as `r.geomorphon` classifies them.
//!
//! Along each direction the steepest rise and the steepest fall from the post are found, as tangents. A direction is
//! higher where the rise is steeper than the fall, lower where the fall is steeper, and level where both are within the
//! flatness or equal. The numbers of lower and higher directions give one of ten forms.
//!
//! Slopes along a direction are compared per step, not per meter: equal slopes then are equal to the last bit.
//!
//! `r.geomorphon` 8.2.1 never reads the southernmost row (its buffer of rows is not shifted for it), so that forms within the
//! radius of that row differ; without data in the row all forms are equal.
//!
//! Some posts of a row are done at once, in vectors: for each step of a direction the slopes to as many posts. Slopes are
//! multiplied with one over the step, which is faster than division and may be off in the last bit; where that could decide,
//! because rise and fall are as steep or one is as steep as the flatness, the post's direction is done again with divisions.

use rayon::prelude::*;

use crate::arguments::AnalysisArguments;
use crate::error::AnalysisError;
use crate::land::Land;
use crate::outcome::{Hatching, Outcome, OutcomeRaster, PostValues, ValueClass};
use sandtable_base::vectorized::vectorized;
use sandtable_terrain::lattice::Lattice;
use sandtable_terrain::neighbors::STEPS;
use sandtable_terrain::stop_flag::StopFlag;

/// The codes of forms: those of `r.geomorphon`.
#[rustfmt::skip]
mod form {
    pub(super) const FL: u8 = 1;
    pub(super) const PK: u8 = 2;
    pub(super) const RI: u8 = 3;
    pub(super) const SH: u8 = 4;
    pub(super) const SP: u8 = 5;
    pub(super) const SL: u8 = 6;
    pub(super) const HL: u8 = 7;
    pub(super) const FS: u8 = 8;
    pub(super) const VL: u8 = 9;
    pub(super) const PT: u8 = 10;
}

/// The form by the number of lower directions (row) and of higher ones (column); 0 where they would be more than eight.
const FORMS: [[u8; 9]; 9] = {
    use form::{FL, FS, HL, PK, PT, RI, SH, SL, SP, VL};
    [
        [FL, FL, FL, FS, FS, VL, VL, VL, PT],
        [FL, FL, FS, FS, FS, VL, VL, VL, 0],
        [FL, SH, SL, SL, HL, HL, VL, 0, 0],
        [SH, SH, SL, SL, SL, HL, 0, 0, 0],
        [SH, SH, SP, SL, SL, 0, 0, 0, 0],
        [RI, RI, SP, SP, 0, 0, 0, 0, 0],
        [RI, RI, RI, 0, 0, 0, 0, 0, 0],
        [RI, RI, 0, 0, 0, 0, 0, 0, 0],
        [PK, 0, 0, 0, 0, 0, 0, 0, 0],
    ]
};

/// The form at each post: codes 1 to 10. Posts as near to the border as `skip` have no data, nor have those without a
/// height. A direction whose first post has no data is level; other posts without data along it are passed over.
///
/// # Errors
/// [`AnalysisError::Argument`] where `radius` or `skip` is not whole, or `skip` leaves nothing of `radius`.
pub(crate) fn geomorphons(
    land: &Land,
    arguments: &AnalysisArguments,
    stop: &StopFlag,
) -> Result<Outcome, AnalysisError> {
    let (radius, skip) = (arguments.posts("radius")?, arguments.posts("skip")?);
    if skip + 1 >= radius {
        let problem = format!("is {skip}, which leaves nothing of a `radius` of {radius} posts; state less");
        return Err(AnalysisError::argument("skip", problem));
    }
    let flatness = libm::tan(arguments.number("flatness").to_radians());
    let is_magnitude = arguments.word("comparison") == "magnitude";
    let comparison = if is_magnitude { SightComparison::Magnitude } else { SightComparison::Signed };
    let sights = FormSights::new(&land.ground, radius, skip, flatness, comparison);
    let columns = sights.columns as usize;
    let mut codes = vec![PostValues::NO_CODE; land.ground.heights().len()];
    stop.stretch(0.0..1.0, land.ground.rows() as usize);
    codes.par_chunks_mut(columns).enumerate().for_each(|(row, codes)| {
        if !stop.is_stopped() {
            sights.classify(row as isize, codes);
            stop.did(1);
        }
    });
    if stop.is_stopped() {
        return Err(AnalysisError::Stopped);
    }
    let raster =
        OutcomeRaster { name: "landform", unit: "", values: PostValues::Codes(codes), classes: classes() };
    Ok(Outcome { raster: Some(raster), ..Outcome::default() })
}

/// The sights of the posts of a lattice.
struct FormSights<'a> {
    heights: &'a [f32],
    columns: isize,
    rows: isize,
    skip: isize,
    comparison: SightComparison,
    lines: [FormLineOfSight; 8],
    /// One over each number of steps.
    per_step: Vec<f64>,
}

/// How the steepest rise and the steepest fall along a direction are compared.
#[derive(Clone, Copy)]
enum SightComparison {
    /// Without their signs, as `r.geomorphon` does: a direction of one even slope has both equal, and is level.
    Magnitude,
    /// With them, as the paper does: what rises evenly is higher, what falls evenly is lower.
    Signed,
}

/// A direction in which posts look.
#[derive(Clone, Copy)]
struct FormLineOfSight {
    /// Columns of a step.
    east: isize,
    /// Rows of a step.
    north: isize,
    /// The number of steps after those that are skipped.
    steps: usize,
    /// The rise in meters per step that still is level.
    flat: f64,
}

/// Posts of a row that are done together.
const TOGETHER: usize = 16;

/// Slopes that differ by less than this share of the steeper may be equal: some roundings.
const ROUNDING: f64 = 1e-14;

/// The steepest rise and fall along a direction in meters per step, each positive where it is one.
type Steepest = (f64, f64);

impl<'a> FormSights<'a> {
    fn new(
        ground: &'a Lattice,
        radius: usize,
        skip: usize,
        flatness: f64,
        comparison: SightComparison,
    ) -> Self {
        let cell = ground.cell();
        let search_m = radius as f64 * cell.x.max(cell.y);
        // Steps beyond the lattice see nothing.
        let most = radius.min(ground.columns().max(ground.rows()) as usize);
        let lines = STEPS.map(|(east, north)| {
            let (east_m, north_m) = (east as f64 * cell.x, north as f64 * cell.y);
            let step_m = (east_m * east_m + north_m * north_m).sqrt();
            let steps = (skip + 1..most).take_while(|&step| step as f64 * step_m < search_m).count();
            FormLineOfSight { east: east as isize, north: north as isize, steps, flat: flatness * step_m }
        });
        Self {
            heights: ground.heights(),
            columns: ground.columns() as isize,
            rows: ground.rows() as isize,
            skip: skip as isize,
            comparison,
            lines,
            per_step: (0..=most).map(|step| 1.0 / step as f64).collect(),
        }
    }

    /// The forms of a row.
    fn classify(&self, row: isize, codes: &mut [u8]) {
        let margin = self.skip + 1;
        if row < margin || row + margin >= self.rows || self.columns <= 2 * margin {
            return;
        }
        let farthest = self.lines.iter().map(|line| self.skip + line.steps as isize).max().unwrap_or(0);
        let (first, end) = (margin.max(farthest), self.columns - margin.max(farthest));
        let together = TOGETHER as isize;
        let inner = first + (end - first).max(0) / together * together;
        vectorized(
            #[inline(always)]
            || {
                for column in (first..inner).step_by(TOGETHER) {
                    let codes = codes[column as usize..].first_chunk_mut().expect("within the row");
                    *codes = self.forms_together(row, column);
                }
            },
        );
        let ends = if inner > first { (first, inner) } else { (margin, margin) };
        for column in (margin..ends.0).chain(ends.1..self.columns - margin) {
            codes[column as usize] = self.form(row, column);
        }
    }

    /// The form of a post.
    fn form(&self, row: isize, column: isize) -> u8 {
        if self.height(row, column).is_nan() {
            return PostValues::NO_CODE;
        }
        let (mut lower, mut higher) = (0, 0);
        for line in &self.lines {
            let (is_higher, is_lower) = self.compared(self.steepest(row, column, line), line.flat);
            let is_seen = !self.height(row + line.north, column + line.east).is_nan();
            higher += usize::from(is_seen && is_higher);
            lower += usize::from(is_seen && is_lower);
        }
        FORMS[lower][higher]
    }

    /// Whether a direction is higher, and whether it is lower.
    #[inline(always)]
    fn compared(&self, (rise, fall): Steepest, flat: f64) -> (bool, bool) {
        let is_steep = (rise > flat) | (fall > flat);
        (is_steep & (rise > fall), is_steep & (fall > rise))
    }

    /// Rise and fall as they are compared, from the greatest and the least slope.
    #[inline(always)]
    fn signed(&self, greatest: f64, least: f64) -> Steepest {
        match self.comparison {
            SightComparison::Magnitude => (greatest.abs(), least.abs()),
            SightComparison::Signed => (greatest, -least),
        }
    }

    /// The steepest rise and fall of a post along a direction.
    fn steepest(&self, row: isize, column: isize, line: &FormLineOfSight) -> Steepest {
        let own = f64::from(self.height(row, column));
        let (mut greatest, mut least) = (f64::NEG_INFINITY, f64::INFINITY);
        for step in (self.skip + 1..).take(line.steps) {
            let (other_row, other_column) = (row + line.north * step, column + line.east * step);
            if !(0..self.rows).contains(&other_row) || !(0..self.columns).contains(&other_column) {
                break;
            }
            let slope = (f64::from(self.height(other_row, other_column)) - own) / step as f64;
            greatest = if slope > greatest { slope } else { greatest };
            least = if slope < least { slope } else { least };
        }
        self.signed(greatest, least)
    }

    /// The forms of posts from one on, which see no post beyond the first and the last column.
    #[inline(always)]
    fn forms_together(&self, row: isize, column: isize) -> [u8; TOGETHER] {
        let heights = self.some(row, column);
        let own = heights.map(f64::from);
        let (mut lower, mut higher) = ([0u8; TOGETHER], [0u8; TOGETHER]);
        for line in &self.lines {
            let &FormLineOfSight { east, north, flat, .. } = line;
            let rows = if north > 0 { self.rows - 1 - row } else { row };
            let most = if north == 0 { isize::MAX } else { rows };
            let last = (self.skip + line.steps as isize).min(most);
            let (mut greatest, mut least) = ([f64::NEG_INFINITY; TOGETHER], [f64::INFINITY; TOGETHER]);
            for step in self.skip + 1..=last {
                let others = self.some(row + north * step, column + east * step);
                let per_step = self.per_step[step as usize];
                for at in 0..TOGETHER {
                    let slope = (f64::from(others[at]) - own[at]) * per_step;
                    greatest[at] = if slope > greatest[at] { slope } else { greatest[at] };
                    least[at] = if slope < least[at] { slope } else { least[at] };
                }
            }
            // A direction begins with the neighbor: without it there is no sight.
            let neighbors = self.some(row + north, column + east);
            let mut in_doubt = [false; TOGETHER];
            for at in 0..TOGETHER {
                let (rise, fall) = self.signed(greatest[at], least[at]);
                let (is_higher, is_lower) = self.compared((rise, fall), flat);
                let is_seen = !neighbors[at].is_nan();
                higher[at] += u8::from(is_seen & is_higher);
                lower[at] += u8::from(is_seen & is_lower);
                let steeper = if rise > fall { rise } else { fall };
                let is_close = |a: f64, b: f64| (a - b).abs() <= ROUNDING * steeper;
                let is_tie = is_close(rise, fall) & (steeper > flat) | is_close(steeper, flat);
                in_doubt[at] = is_seen & is_tie;
            }
            if in_doubt.iter().fold(false, |any, &is| any | is) {
                for at in (0..TOGETHER).filter(|&at| in_doubt[at]) {
                    let near = self.compared(self.signed(greatest[at], least[at]), flat);
                    let (is_higher, is_lower) =
                        self.compared(self.steepest(row, column + at as isize, line), flat);
                    higher[at] = higher[at] - u8::from(near.0) + u8::from(is_higher);
                    lower[at] = lower[at] - u8::from(near.1) + u8::from(is_lower);
                }
            }
        }
        let mut forms = [PostValues::NO_CODE; TOGETHER];
        for at in 0..TOGETHER {
            if !heights[at].is_nan() {
                forms[at] = FORMS[usize::from(lower[at])][usize::from(higher[at])];
            }
        }
        forms
    }

    #[inline(always)]
    fn height(&self, row: isize, column: isize) -> f32 {
        self.heights[(row * self.columns + column) as usize]
    }

    /// The heights of posts of a row from one on.
    #[inline(always)]
    fn some(&self, row: isize, column: isize) -> &'a [f32; TOGETHER] {
        let from = (row * self.columns + column) as usize;
        self.heights[from..].first_chunk().expect("within the row")
    }
}

/// The ten forms.
fn classes() -> Vec<ValueClass> {
    let rows = [
        ("flat", [220, 220, 220, 90], Hatching::None),
        ("peak", [56, 0, 0, 150], Hatching::Crossed),
        ("ridge", [200, 0, 0, 130], Hatching::Single),
        ("shoulder", [255, 80, 20, 120], Hatching::None),
        ("spur", [250, 210, 60, 120], Hatching::None),
        ("slope", [255, 255, 60, 90], Hatching::None),
        ("hollow", [180, 230, 20, 120], Hatching::None),
        ("footslope", [60, 250, 150, 110], Hatching::None),
        ("valley", [0, 0, 255, 110], Hatching::Level),
        ("pit", [0, 0, 56, 150], Hatching::Dots),
    ];
    let class = |(from, (label, tint, hatching)): (u8, (&str, [u8; 4], Hatching))| {
        ValueClass::new(f32::from(from), label, tint, hatching)
    };
    (1..).zip(rows).map(class).collect()
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::super::window::tests::{land, outcome, values};
    use super::*;

    /// The form of the middle of 21 × 21 posts with heights by columns east and rows north of it.
    fn middle(height: impl Fn(f32, f32) -> f32) -> f32 {
        let height = |index: i32| height((index % 21 - 10) as f32, (index / 21 - 10) as f32);
        let land = land(DVec2::splat(1.0), 21, (0..441).map(height).collect());
        values(&land, "geomorphons", &[], &[("radius", 8.0), ("flatness", 2.0)])[220]
    }

    #[test]
    fn plain_shapes_have_their_forms() {
        assert_eq!(middle(|_, _| 5.0), f32::from(form::FL));
        assert_eq!(middle(|x, y| -x.hypot(y)), f32::from(form::PK));
        assert_eq!(middle(|x, y| x.hypot(y)), f32::from(form::PT));
        assert_eq!(middle(|x, _| -x.abs()), f32::from(form::RI));
        assert_eq!(middle(|x, _| x.abs()), f32::from(form::VL));
        assert_eq!(middle(|x, _| x), f32::from(form::SL));
        assert_eq!(middle(|x, _| x.min(0.0)), f32::from(form::SH));
        assert_eq!(middle(|x, _| x.max(0.0)), f32::from(form::FS));
        assert_eq!(middle(|x, y| y - 0.5 * x.abs()), f32::from(form::SP));
        assert_eq!(middle(|x, y| y + 0.5 * x.abs()), f32::from(form::HL));
    }

    /// The form of a post by walking along each direction.
    fn walked(
        (heights, columns, is_first): (&[f32], i64, bool),
        post: i64,
        radius: i64,
        skip: i64,
        flatness_deg: f64,
    ) -> f32 {
        let rows = heights.len() as i64 / columns;
        let (column, row) = (post % columns, post / columns);
        let margin = skip + 1;
        let own = f64::from(heights[post as usize]);
        let is_border = column < margin || row < margin || column + margin >= columns || row + margin >= rows;
        if is_border || own.is_nan() {
            return f32::NAN;
        }
        let (mut lower, mut higher) = (0, 0);
        for (east, north) in STEPS {
            let far = ((east * east + north * north) as f64).sqrt();
            let (mut zenith, mut nadir) = (-90f64, 90f64);
            let mut step = skip + 1;
            while far * (step as f64) < radius as f64 {
                let (x, y) = (column + east * step, row + north * step);
                if x < 0 || y < 0 || x >= columns || y >= rows {
                    break;
                }
                let rise = f64::from(heights[(y * columns + x) as usize]) - own;
                let angle = (rise / (step as f64)).atan2(far).to_degrees();
                zenith = zenith.max(angle);
                nadir = nadir.min(angle);
                step += 1;
            }
            let neighbor = heights[((row + north) * columns + column + east) as usize];
            let (up, down) = if is_first { (zenith.abs(), nadir.abs()) } else { (zenith, -nadir) };
            if neighbor.is_nan() || zenith == -90.0 || up.max(down) <= flatness_deg {
                continue;
            }
            lower += usize::from(down > up);
            higher += usize::from(down < up);
        }
        f32::from(FORMS[lower][higher])
    }

    #[test]
    fn forms_are_those_of_a_walk_along_each_direction() {
        // Rough, of even slopes, in steps, so that rise and fall are often as steep; more columns than are done together.
        let kinds: [fn(u32) -> f32; 3] = [
            |index| (index * 7919 % 101) as f32 * 0.1,
            |index| (index % 83) as f32 * 0.3 - (index / 83) as f32 * 0.7,
            |index| ((index % 83) / 4 + index / 83 % 3) as f32,
        ];
        for kind in kinds {
            forms_are_walked(kind);
        }
    }

    fn forms_are_walked(height: fn(u32) -> f32) {
        let mut heights: Vec<f32> = (0..83 * 23u32).map(height).collect();
        (50..heights.len()).step_by(161).for_each(|index| heights[index] = f32::NAN);
        let land = land(DVec2::ONE, 83, heights.clone());
        for (radius, skip, flatness) in [(2, 0, 1.0), (7, 0, 5.0), (9, 2, 10.0), (60, 1, 0.0)] {
            let numbers = [("radius", f64::from(radius)), ("skip", f64::from(skip)), ("flatness", flatness)];
            for comparison in ["magnitude", "signed"] {
                let forms = values(&land, "geomorphons", &[("comparison", comparison)], &numbers);
                let ground = (&*heights, 83, comparison == "magnitude");
                for (post, &form) in forms.iter().enumerate() {
                    let wanted = walked(ground, post as i64, radius.into(), skip.into(), flatness);
                    let is_same = form == wanted || form.is_nan() && wanted.is_nan();
                    assert!(is_same, "{comparison} {numbers:?} {post}: {form} {wanted}");
                }
            }
        }
    }

    #[test]
    fn parameters_that_leave_nothing_to_see_or_are_not_whole_are_errors() {
        let land = land(DVec2::ONE, 9, vec![0.0; 81]);
        for (key, number) in [("skip", 19.0), ("skip", 0.5), ("radius", 2.5)] {
            let error = outcome(&land, "geomorphons", &[], &[(key, number)]);
            assert_eq!(error.err().and_then(|error| error.key()), Some(key));
        }
    }

    #[test]
    fn a_sight_longer_than_a_lattice_of_few_posts_ends_at_its_border() {
        for columns in [2, 3, 6] {
            let land = land(DVec2::ONE, columns, vec![1.0; 12]);
            let forms = values(&land, "geomorphons", &[], &[("radius", 500.0)]);
            assert!(forms.iter().all(|form| form.is_nan() || *form == 1.0));
        }
    }
}
