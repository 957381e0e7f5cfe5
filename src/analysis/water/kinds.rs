//! The kinds `fill` and `flow`: depressions, and where water flows.

use rayon::prelude::*;

use crate::arguments::AnalysisArguments;
use crate::error::AnalysisError;
use crate::land::Land;
use crate::measures::area_km2;
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
    let filled_m = water.filled(stop)?;
    // Breaches are told too: as depths below 0.
    let heights = land.ground.heights();
    let changed = || filled_m.iter().zip(heights).map(|(filled, height)| filled - height);
    let of = |sign: f32| {
        let part = changed().map(|depth| depth * sign).filter(|depth| *depth > 0.0);
        part.fold((0, 0.0), |(posts, sum), depth| (posts + 1, sum + f64::from(depth)))
    };
    let (filled, cut) = (of(1.0), of(-1.0));
    let mut figures = vec![
        Figure::new("area of depressions", area_km2(&land.ground, filled.0), "km²"),
        Figure::new("volume of depressions", filled.1 * land.ground.cell_m2(), "m³"),
    ];
    if cut.0 > 0 {
        figures.push(Figure::new("area of cuts", area_km2(&land.ground, cut.0), "km²"));
        figures.push(Figure::new("volume of cuts", cut.1 * land.ground.cell_m2(), "m³"));
    }
    let notes = water.notes;
    let raster = match arguments.word("show").as_str() {
        "filled" => numbers("filled", "m", filled_m, Vec::new()),
        _ => numbers("depth", "m", changed().collect(), ValueClass::of_rows(DEPTHS)),
    };
    Ok(Outcome { raster: Some(raster), figures, notes, ..Outcome::default() })
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
    let area = |(index, posts): (usize, f64)| match drainage.has_data(index) {
        true => (posts * cell_m2) as f32,
        false => f32::NAN,
    };
    let shows_direction = arguments.word("show") == "direction";
    let raster = match arguments.word("method").as_str() {
        "dinf" => {
            let flow = InfiniteFlow::new(&land.ground, &drainage);
            if shows_direction {
                let degrees = |index: usize| flow.split(index).map_or(f32::NAN, |split| split.degrees);
                let posts = (0..drainage.codes.len()).into_par_iter().with_min_len(1 << 12);
                numbers("direction", "°", posts.map(degrees).collect(), Vec::new())
            } else {
                let amounts = flow.accumulation(stop)?.into_iter();
                numbers("drained area", "m²", amounts.enumerate().map(area).collect(), Vec::new())
            }
        }
        _ if shows_direction => {
            let values = PostValues::Codes(drainage.codes);
            OutcomeRaster { name: "direction", unit: "", values, classes: Vec::new() }
        }
        _ => {
            let counts = drainage.accumulation().into_iter().map(f64::from);
            numbers("drained area", "m²", counts.enumerate().map(area).collect(), Vec::new())
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
