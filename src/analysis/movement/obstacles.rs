//! The modified combined obstacle overlay (FM 34-130, ATP 2-01.3) and the speed of a vehicle at each post.

use rayon::prelude::*;

use crate::arguments::AnalysisArguments;
use crate::error::AnalysisError;
use crate::land::Land;
use crate::measures::{area_km2, percent};
use crate::movement::going::{Going, RESTRICTED, SEVERELY_RESTRICTED, UNRESTRICTED};
use crate::movement::grade::GradeTable;
use crate::movement::vehicle::Vehicle;
use crate::outcome::{Figure, Hatching, Outcome, OutcomeRaster, PostValues, ValueClass};
use crate::tally::FigureTally;
use sandtable_terrain::lattice::Lattice;
use sandtable_terrain::stop_flag::StopFlag;

/// Parts of a km/h in which speeds are added up: a millionth, so that a billion posts at a thousand km/h have a sum.
const SPEED_PARTS: f64 = 1e6;

/// The names and looks of the codes.
const OVERLAY: [(u8, &str, [u8; 4], Hatching); 3] = [
    (UNRESTRICTED, "unrestricted", [0, 0, 0, 0], Hatching::None),
    (RESTRICTED, "restricted", [250, 180, 60, 90], Hatching::Single),
    (SEVERELY_RESTRICTED, "severely restricted", [200, 40, 30, 110], Hatching::Crossed),
];

/// The code of each post, with the area of each code.
///
/// # Errors
/// `vehicle`, and memory.
pub(crate) fn obstacles(
    land: &Land,
    arguments: &AnalysisArguments,
    _stop: &StopFlag,
) -> Result<Outcome, AnalysisError> {
    let vehicle = Vehicle::named(land, &arguments.word("vehicle"))?;
    let going = Going::new(land, &vehicle)?;
    let tally = code_tally(&going.codes);
    let figures = code_figures(&tally, &land.ground);
    let raster = OutcomeRaster {
        name: "obstacles",
        unit: "",
        values: PostValues::Codes(going.codes),
        classes: ValueClass::of_rows(
            OVERLAY.map(|(code, label, tint, hatching)| (f32::from(code), label, tint, hatching)),
        ),
    };
    Ok(Outcome { raster: Some(raster), figures, tally, notes: going.notes, ..Outcome::default() })
}

/// The posts of each code.
pub(crate) fn code_tally(codes: &[u8]) -> FigureTally {
    let count = |code: u8| codes.par_iter().filter(|&&found| found == code).count() as u64;
    FigureTally::new(OVERLAY.map(|(code, ..)| count(code)).into())
}

/// The area of each code, and its share of the posts that have one.
pub(crate) fn code_figures(tally: &FigureTally, ground: &Lattice) -> Vec<Figure> {
    let known = tally.counts().iter().sum::<u64>() as usize;
    let mut figures = Vec::new();
    for ((_, label, ..), &posts) in OVERLAY.iter().zip(tally.counts()) {
        let posts = posts as usize;
        figures.push(Figure::new(*label, area_km2(ground, posts), "km²"));
        figures.push(Figure::new(format!("share of {label}"), percent(posts, known), "%"));
    }
    figures
}

/// The speed at each post straight up its slope, km/h; 0 where the vehicle cannot go. Roads are not slowed by the slope
/// across which they were cut, see [`GradeTable::on_way`].
///
/// # Errors
/// `vehicle`, and memory.
pub(crate) fn speed(
    land: &Land,
    arguments: &AnalysisArguments,
    _stop: &StopFlag,
) -> Result<Outcome, AnalysisError> {
    let vehicle = Vehicle::named(land, &arguments.word("vehicle"))?;
    let Going { codes, speed_kmh: mut values, is_way, closed, notes } = Going::new(land, &vehicle)?;
    let ground = closed.as_ref().unwrap_or(&land.ground);
    let grades = GradeTable::new(&vehicle, arguments.word("method") == "langmuir");
    let columns = land.ground.columns() as usize;
    values.par_chunks_mut(columns).enumerate().for_each(|(row, values)| {
        let slopes = ground.slopes_of_row(row as u32);
        for ((column, value), slopes) in values.iter_mut().enumerate().zip(slopes) {
            let index = row * columns + column;
            if codes[index] != PostValues::NO_CODE && !is_way[index] {
                *value /= grades.open(slopes.length());
            }
        }
    });
    let tally = speed_tally(&values);
    let figures = speed_figures(&tally);
    let raster = OutcomeRaster {
        name: "speed",
        unit: "km/h",
        values: PostValues::Numbers(values),
        classes: speed_classes(),
    };
    Ok(Outcome { raster: Some(raster), figures, tally, notes, ..Outcome::default() })
}

/// The posts with a speed above 0, and the sum of their speeds in [`SPEED_PARTS`].
pub(crate) fn speed_tally(values: &[f32]) -> FigureTally {
    let known = values.par_iter().filter(|&&speed| speed > 0.0);
    let one = |&speed: &f32| [1, (f64::from(speed) * SPEED_PARTS).round() as u64];
    let both = |sum: [u64; 2], other: [u64; 2]| [0, 1].map(|at: usize| sum[at].saturating_add(other[at]));
    FigureTally::new(known.map(one).reduce(|| [0; 2], both).into())
}

/// The mean of the speeds above 0.
pub(crate) fn speed_figures(tally: &FigureTally) -> Vec<Figure> {
    let mean = match *tally.counts() {
        [posts, sum] if posts > 0 => sum as f64 / SPEED_PARTS / posts as f64,
        _ => 0.0,
    };
    vec![Figure::new("mean speed where it can go", mean, "km/h")]
}

fn speed_classes() -> Vec<ValueClass> {
    let rows = [
        (0.0, "cannot go", [200, 40, 30, 110], Hatching::Crossed),
        (0.01, "under 2 km/h", [253, 141, 60, 110], Hatching::Single),
        (2.0, "2–5 km/h", [254, 204, 92, 100], Hatching::Dots),
        (5.0, "5–15 km/h", [255, 255, 178, 90], Hatching::None),
        (15.0, "15–30 km/h", [180, 220, 130, 90], Hatching::None),
        (30.0, "over 30 km/h", [60, 160, 80, 100], Hatching::None),
    ];
    ValueClass::of_rows(rows)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arguments::ArgumentValue;
    use crate::run::run;
    use crate::test_land::shaped;

    fn arguments(kind: &str, vehicle: &str) -> AnalysisArguments {
        let kind = sandtable_catalog::kind(kind).expect("a kind");
        AnalysisArguments::new(kind).with("vehicle", ArgumentValue::Word(vehicle.to_owned()))
    }

    #[test]
    fn the_overlay_states_the_area_and_the_share_of_each_code() {
        // Columns 0 to 3 are level, then it rises by 50 %: column 3 sees half of that.
        let land = shaped(8, 4, 100.0, |column, _| column.saturating_sub(3) as f32 * 50.0);
        let found = run(&land, &arguments("obstacles", "truck"), &StopFlag::default()).expect("sound");
        let Some(PostValues::Codes(codes)) = found.raster.map(|raster| raster.values) else {
            panic!("codes")
        };
        assert_eq!(codes[..8], [0, 0, 0, 1, 2, 2, 2, 2]);
        let figure =
            |name: &str| found.figures.iter().find(|figure| figure.name == name).map(|figure| figure.value);
        assert_eq!(figure("severely restricted"), Some(0.16));
        assert_eq!(figure("share of unrestricted"), Some(37.5));
        assert!(found.notes[0].starts_with("nothing is known of"), "{:?}", found.notes);
    }

    #[test]
    fn the_speed_on_foot_is_toblers() {
        let land = shaped(4, 4, 10.0, |column, _| column as f32);
        let found = run(&land, &arguments("speed", "foot"), &StopFlag::default()).expect("sound");
        let raster = found.raster.expect("a raster");
        let tobler = 6.0 * libm::exp(-3.5 * 0.15);
        assert!((f64::from(raster.values.value(5)) - tobler).abs() < 1e-4, "{}", raster.values.value(5));
    }
}
