//! Landforms by what a post sees in eight directions (Jasiewicz and Stepinski 2013), as `r.geomorphon` classifies them.
//!
//! Along each direction the steepest rise and the steepest fall from the post are found, as tangents. A direction is
//! higher where the rise is steeper than the fall, lower where the fall is steeper, and level where both are within the
//! flatness or equal. The numbers of lower and higher directions give one of ten forms.
//!
//! A row is done at once: for each step of each direction, one pass over the row that the compiler can vectorize.

use rayon::prelude::*;

use crate::arguments::AnalysisArguments;
use crate::error::AnalysisError;
use crate::land::Land;
use crate::outcome::{ClassLook, Hatching, Outcome, OutcomeRaster, PostValues, ValueClass};
use sandtable_terrain::lattice::Lattice;
use sandtable_terrain::stop_flag::StopFlag;

/// The eight directions: columns east, rows north.
const DIRECTIONS: [(isize, isize); 8] =
    [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1)];

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
/// [`AnalysisError::Argument`] where `radius` or `skip` is not whole, or `skip` is not below `radius`.
pub(crate) fn geomorphons(
    land: &Land,
    arguments: &AnalysisArguments,
    stop: &StopFlag,
) -> Result<Outcome, AnalysisError> {
    let posts = |key: &'static str| {
        let number = arguments.number(key);
        let problem = || format!("is {number}; it must be a whole number of posts");
        if number.fract() == 0.0 { Ok(number as usize) } else { Err(AnalysisError::argument(key, problem())) }
    };
    let (radius, skip) = (posts("radius")?, posts("skip")?);
    if skip >= radius {
        let problem = format!("is {skip}, which leaves nothing of a `radius` of {radius} posts; state less");
        return Err(AnalysisError::argument("skip", problem));
    }
    let flatness = libm::tan(arguments.number("flatness").to_radians());
    let sights = FormSights::new(&land.ground, radius, skip, flatness);
    let columns = sights.columns as usize;
    let mut codes = vec![PostValues::NO_CODE; land.ground.heights().len()];
    codes.par_chunks_mut(columns).enumerate().for_each_init(
        || SightRow::new(columns),
        |sight, (row, codes)| {
            if !stop.is_stopped() {
                sights.classify(row as isize, sight, codes);
            }
        },
    );
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
    flatness: f64,
    /// For each direction, the distances of its steps in meters, from the step after `skip`.
    distances_m: [Vec<f64>; 8],
}

/// What a row of posts sees.
struct SightRow {
    rise: Vec<f64>,
    fall: Vec<f64>,
    lower: Vec<u8>,
    higher: Vec<u8>,
}

impl SightRow {
    fn new(columns: usize) -> Self {
        Self {
            rise: vec![0.0; columns],
            fall: vec![0.0; columns],
            lower: vec![0; columns],
            higher: vec![0; columns],
        }
    }
}

impl<'a> FormSights<'a> {
    fn new(ground: &'a Lattice, radius: usize, skip: usize, flatness: f64) -> Self {
        let cell = ground.cell();
        let search_m = radius as f64 * cell.x.max(cell.y);
        let distances_m = DIRECTIONS.map(|(east, north)| {
            let far = |step: usize| {
                let (east, north) = (east as f64 * step as f64 * cell.x, north as f64 * step as f64 * cell.y);
                (east * east + north * north).sqrt()
            };
            // Steps beyond the lattice see nothing.
            let most = ground.columns().max(ground.rows()) as usize;
            (skip + 1..=most).map(far).take_while(|&distance| distance < search_m).collect()
        });
        Self {
            heights: ground.heights(),
            columns: ground.columns() as isize,
            rows: ground.rows() as isize,
            skip: skip as isize,
            flatness,
            distances_m,
        }
    }

    /// The forms of a row.
    fn classify(&self, row: isize, sight: &mut SightRow, codes: &mut [u8]) {
        let margin = self.skip + 1;
        if row < margin || row + margin >= self.rows || self.columns <= 2 * margin {
            return;
        }
        sight.lower.fill(0);
        sight.higher.fill(0);
        for (direction, distances_m) in DIRECTIONS.iter().zip(&self.distances_m) {
            self.look(row, *direction, distances_m, sight);
        }
        let own = self.line(row);
        for column in margin as usize..(self.columns - margin) as usize {
            if !own[column].is_nan() {
                codes[column] = FORMS[usize::from(sight.lower[column])][usize::from(sight.higher[column])];
            }
        }
    }

    /// Looks along a direction from all posts of a row.
    fn look(&self, row: isize, (east, north): (isize, isize), distances_m: &[f64], sight: &mut SightRow) {
        sight.rise.fill(f64::NEG_INFINITY);
        sight.fall.fill(f64::INFINITY);
        let own = self.line(row);
        for (step, &distance_m) in (self.skip + 1..).zip(distances_m) {
            let other_row = row + north * step;
            if other_row < 0 || other_row >= self.rows || step >= self.columns && east != 0 {
                break;
            }
            let (from, others) = self.shifted(other_row, east * step);
            let count = others.len();
            let sights = sight.rise[from..][..count].iter_mut().zip(&mut sight.fall[from..][..count]);
            for ((rise, fall), (own, other)) in sights.zip(own[from..][..count].iter().zip(others)) {
                let tangent = (f64::from(*other) - f64::from(*own)) / distance_m;
                *rise = if tangent > *rise { tangent } else { *rise };
                *fall = if tangent < *fall { tangent } else { *fall };
            }
        }
        // A direction begins with the neighbor: without it there is no sight.
        let (from, neighbors) = self.shifted(row + north, east);
        for (column, neighbor) in (from..).zip(neighbors) {
            let (rise, fall) = (sight.rise[column].abs(), sight.fall[column].abs());
            let is_seen = !neighbor.is_nan() && (rise > self.flatness || fall > self.flatness);
            sight.higher[column] += u8::from(is_seen && rise > fall);
            sight.lower[column] += u8::from(is_seen && fall > rise);
        }
    }

    fn line(&self, row: isize) -> &'a [f32] {
        &self.heights[(row * self.columns) as usize..][..self.columns as usize]
    }

    /// The heights of a row `east` columns east of the posts from the column that is given first.
    fn shifted(&self, row: isize, east: isize) -> (usize, &'a [f32]) {
        let line = self.line(row);
        if east >= 0 {
            (0, &line[east as usize..])
        } else {
            (east.unsigned_abs(), &line[..(self.columns + east) as usize])
        }
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
    let class = |(from, (label, tint, hatching)): (u8, (&str, [u8; 4], Hatching))| ValueClass {
        from: f32::from(from),
        label: label.to_owned(),
        look: ClassLook { tint, hatching },
    };
    (1..).zip(rows).map(class).collect()
}
