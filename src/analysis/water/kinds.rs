//! The kinds `fill` and `flow`: depressions, and where water flows.

use rayon::prelude::*;

use crate::arguments::AnalysisArguments;
use crate::error::AnalysisError;
use crate::land::Land;
use crate::measures::posts_km2;
use crate::outcome::{Figure, Hatching, Outcome, OutcomeRaster, PostValues, ValueClass};
use crate::water::infinity::InfiniteFlow;
use crate::water::prepared::WaterGround;
use sandtable_terrain::stop_flag::StopFlag;

/// The depths from which depressions are classed, meters, with their tints; what was breached lies below 0.
const DEPTHS: [(f32, &str, [u8; 4], Hatching); 4] = [
    (f32::NEG_INFINITY, "cut through", [200, 90, 40, 130], Hatching::Dots),
    (0.0, "none", [0, 0, 0, 0], Hatching::None),
    (f32::MIN_POSITIVE, "up to 1 m", [140, 190, 240, 110], Hatching::Level),
    (1.0, "1 m or more", [30, 90, 190, 130], Hatching::Level),
];

/// The depressions of the ground: their depth, or the ground without them.
///
/// # Errors
/// [`AnalysisError::Memory`] and [`AnalysisError::Stopped`].
pub(crate) fn fill(
    land: &Land,
    arguments: &AnalysisArguments,
    stop: &StopFlag,
) -> Result<Outcome, AnalysisError> {
    let water = WaterGround::of(land, arguments, stop)?;
    let mut filled_m = water.filled(stop)?;
    // Breaches are told too: as depths below 0.
    let (heights, columns) = (land.ground.heights(), land.ground.columns() as usize);
    let rows: Vec<DepressionRow> = filled_m
        .par_chunks(columns)
        .zip(heights.par_chunks(columns))
        .map(|(filled, heights)| DepressionRow::of(filled, heights))
        .collect();
    let figures = depression_figures(&rows, land.ground.cell_m2());
    let notes = water.notes;
    let raster = match arguments.word("show").as_str() {
        "filled" => numbers("filled", "m", filled_m, Vec::new()),
        _ => {
            filled_m.par_iter_mut().zip(heights).for_each(|(filled, height)| *filled -= height);
            numbers("depth", "m", filled_m, ValueClass::of_rows(DEPTHS))
        }
    };
    Ok(Outcome { raster: Some(raster), figures, notes, ..Outcome::default() })
}

/// What is filled and cut of a row of posts: how many, and the sum of depths in meters.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct DepressionRow {
    filled: (usize, f64),
    cut: (usize, f64),
}

impl DepressionRow {
    /// Of heights before and after.
    pub fn of(filled: &[f32], heights: &[f32]) -> Self {
        let of = |sign: f32| {
            let changed = filled.iter().zip(heights).map(|(filled, height)| (filled - height) * sign);
            let part = changed.filter(|depth| *depth > 0.0);
            part.fold((0, 0.0), |(posts, sum), depth| (posts + 1, sum + f64::from(depth)))
        };
        Self { filled: of(1.0), cut: of(-1.0) }
    }
}

/// The figures of depressions, from all rows of the land in their order; a post has `cell_m2` of area.
pub(super) fn depression_figures(rows: &[DepressionRow], cell_m2: f64) -> Vec<Figure> {
    let sum = |of: fn(&DepressionRow) -> (usize, f64)| {
        rows.iter().map(of).fold((0, 0.0), |(posts, depths), row| (posts + row.0, depths + row.1))
    };
    let (filled, cut) = (sum(|row| row.filled), sum(|row| row.cut));
    let mut figures = vec![
        Figure::new("area of depressions", posts_km2(filled.0, cell_m2), "km²"),
        Figure::new("volume of depressions", filled.1 * cell_m2, "m³"),
    ];
    if cut.0 > 0 {
        figures.push(Figure::new("area of cuts", posts_km2(cut.0, cell_m2), "km²"));
        figures.push(Figure::new("volume of cuts", cut.1 * cell_m2, "m³"));
    }
    figures
}

/// The area of so many posts, each of `cell_m2`, in m²; NaN of none.
pub(super) fn drained_area(posts: f64, cell_m2: f64) -> f32 {
    if posts > 0.0 { (posts * cell_m2) as f32 } else { f32::NAN }
}

/// Where water flows: the area that drains through each post, or the direction in which it drains.
///
/// # Errors
/// [`AnalysisError::Memory`] and [`AnalysisError::Stopped`].
pub(crate) fn flow(
    land: &Land,
    arguments: &AnalysisArguments,
    stop: &StopFlag,
) -> Result<Outcome, AnalysisError> {
    let water = WaterGround::of(land, arguments, stop)?;
    let drainage = water.drained(stop)?;
    let cell_m2 = land.ground.cell_m2();
    let area = |posts: f64| drained_area(posts, cell_m2);
    let shows_direction = arguments.word("show") == "direction";
    let raster = match arguments.word("method").as_str() {
        "dinf" => {
            let flow = InfiniteFlow::new(&land.ground, &drainage);
            if shows_direction {
                let degrees = |index: usize| flow.split(index).map_or(f32::NAN, |split| split.degrees);
                let posts = (0..drainage.codes.len()).into_par_iter().with_min_len(1 << 12);
                numbers("direction", "°", posts.map(degrees).collect(), Vec::new())
            } else {
                let amounts = flow.accumulation(stop)?.into_par_iter().with_min_len(1 << 14);
                numbers("drained area", "m²", amounts.map(area).collect(), Vec::new())
            }
        }
        _ if shows_direction => {
            let values = PostValues::Codes(drainage.codes);
            OutcomeRaster { name: "direction", unit: "", values, classes: Vec::new() }
        }
        _ => {
            let counts = drainage.accumulation().into_par_iter().with_min_len(1 << 14);
            numbers("drained area", "m²", counts.map(|posts| area(posts.into())).collect(), Vec::new())
        }
    };
    Ok(Outcome { raster: Some(raster), notes: water.notes, ..Outcome::default() })
}

/// A raster of numbers.
pub(super) fn numbers(
    name: &'static str,
    unit: &'static str,
    values: Vec<f32>,
    classes: Vec<ValueClass>,
) -> OutcomeRaster {
    OutcomeRaster { name, unit, values: PostValues::Numbers(values), classes }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_land::{bare, values_of};
    use glam::DVec2;

    fn land(columns: u32, heights: &[f32]) -> Land {
        bare((DVec2::ZERO, DVec2::splat(10.0)), columns, heights.to_vec())
    }

    fn arguments(name: &str) -> AnalysisArguments {
        AnalysisArguments::new(sandtable_catalog::kind(name).expect("a kind"))
    }

    fn values(outcome: Outcome) -> Vec<f32> {
        values_of(&outcome.raster.expect("a raster"))
    }

    #[test]
    fn a_pit_is_filled_to_its_lowest_rim() {
        #[rustfmt::skip]
        let pit = land(5, &[
            9., 9., 9., 9., 9.,
            9., 5., 2., 5., 9.,
            9., 5., 5., 5., 6.,
            9., 9., 9., 9., 9.,
        ]);
        let outcome = fill(&pit, &arguments("fill"), &StopFlag::default()).expect("filled");
        assert!((outcome.figures[1].value - 900.0).abs() < 1e-9, "{:?}", outcome.figures);
        let depth = values(outcome);
        assert_eq!(&depth[5..10], [0., 1., 4., 1., 0.]);
        assert_eq!(&depth[10..15], [0., 1., 1., 1., 0.]);
    }

    #[test]
    fn all_water_of_a_valley_leaves_by_its_mouth() {
        // A trough that falls to the west.
        let heights: Vec<f32> = (0..25)
            .map(|index| {
                let (column, row) = (index % 5, index / 5_i32);
                (column + 10 * (row - 2).abs()) as f32
            })
            .collect();
        let area = values(flow(&land(5, &heights), &arguments("flow"), &StopFlag::default()).expect("flows"));
        assert_eq!(area[10], 2500.0);
        let area_in = |row: usize| area[row * 5];
        assert!(area_in(0) < 1000.0 && area_in(4) < 1000.0, "{area:?}");
    }
}
