//! The time to reach each post from one or many places.

use crate::arguments::AnalysisArguments;
use crate::error::AnalysisError;
use crate::land::Land;
use crate::measures::area_km2;
use crate::movement::search::TravelGoal;
use crate::movement::travel::travel_ground;
use crate::outcome::{
    FeatureRole, Figure, Hatching, Outcome, OutcomeFeature, OutcomeRaster, OutcomeShape, PostValues,
    ValueClass,
};
use sandtable_terrain::stop_flag::StopFlag;

/// Tints of isochrones, from near to far; they repeat.
const TINTS: [[u8; 4]; 6] = [
    [26, 150, 65, 110],
    [166, 217, 106, 100],
    [255, 255, 191, 90],
    [253, 174, 97, 100],
    [215, 48, 39, 110],
    [120, 30, 100, 110],
];

/// The most isochrones.
const MOST_CLASSES: usize = 64;

/// Minutes to each post; no data where it is not reached in time.
///
/// # Errors
/// `vehicle`, `from`, `classes_min`, and memory.
pub(crate) fn time(
    land: &Land,
    arguments: &AnalysisArguments,
    stop: &StopFlag,
) -> Result<Outcome, AnalysisError> {
    let limits = arguments.rising_numbers("classes_min", MOST_CLASSES)?;
    let (ground, _, notes) = travel_ground(land, arguments)?;
    let places = arguments.points("from");
    let starts = places
        .iter()
        .map(|&at| ground.post_near("from", at))
        .collect::<Result<Vec<usize>, AnalysisError>>()?;
    let most_s = arguments.number("max_min") as f32 * 60.0;
    stop.stretch(0.2..0.95, land.ground.heights().len());
    let mut values = ground.times(&starts, TravelGoal::within(most_s), stop);
    stop.stretch(0.95..1.0, 1);
    let mut reached = 0usize;
    let mut latest = 0.0f32;
    for value in &mut values {
        if value.is_finite() {
            *value /= 60.0;
            reached += 1;
            latest = latest.max(*value);
        } else {
            *value = f32::NAN;
        }
    }
    let place = |(index, &at): (usize, &glam::DVec2)| OutcomeFeature {
        shape: OutcomeShape::Point(at),
        name: if places.len() > 1 { (index + 1).to_string() } else { String::new() },
        role: FeatureRole::Place,
        properties: Vec::new(),
    };
    Ok(Outcome {
        features: places.iter().enumerate().map(place).collect(),
        raster: Some(OutcomeRaster {
            name: "time",
            unit: "min",
            values: PostValues::Numbers(values),
            classes: classes(&limits),
        }),
        figures: vec![
            Figure::new("reached", area_km2(&land.ground, reached), "km²"),
            Figure::new("latest arrival", f64::from(latest), "min"),
        ],
        notes,
        ..Outcome::default()
    })
}

/// The classes up to each limit, and one beyond the last.
fn classes(limits: &[f64]) -> Vec<ValueClass> {
    let limits: Vec<f64> = limits.iter().copied().filter(|&limit| limit > 0.0).collect();
    let hatchings = [Hatching::None, Hatching::Dots, Hatching::Single, Hatching::Crossed];
    (0..=limits.len())
        .map(|index| {
            let from = if index == 0 { 0.0 } else { limits[index - 1] as f32 };
            let label = match (index, limits.get(index)) {
                (0, Some(to)) => format!("up to {to} min"),
                (0, None) => "reached".to_owned(),
                (_, Some(to)) => format!("{}–{to} min", limits[index - 1]),
                (_, None) => format!("over {} min", limits[index - 1]),
            };
            ValueClass::new(from, label, TINTS[index % TINTS.len()], hatchings[index % hatchings.len()])
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arguments::ArgumentValue;
    use crate::land::{RoadClass, RoadLine};
    use crate::run::run;
    use crate::test_land::{flat, flood};
    use glam::DVec2;

    fn minutes(land: &Land, max_min: f64, from: &[DVec2]) -> Result<Vec<f32>, AnalysisError> {
        let kind = sandtable_catalog::kind("time").expect("a kind");
        let arguments = AnalysisArguments::new(kind)
            .with("vehicle", ArgumentValue::Word("truck".to_owned()))
            .with("from", ArgumentValue::Points(from.to_vec()))
            .with("max_min", ArgumentValue::Number(max_min));
        let found = run(land, &arguments, &StopFlag::default())?.raster.expect("a raster").values;
        Ok((0..found.len()).map(|index| found.value(index)).collect())
    }

    #[test]
    fn a_truck_takes_four_minutes_a_kilometer_in_the_open_and_is_stopped_by_the_limit() {
        // 15 km/h; on a main road 70 km/h.
        let mut land = flat(21, 3, 100.0);
        let found = minutes(&land, 5.0, &[DVec2::ZERO]).expect("sound");
        assert!((found[10] - 4.0).abs() < 1e-4 && (found[12] - 4.8).abs() < 1e-4 && found[13].is_nan());
        let line = vec![DVec2::ZERO, DVec2::new(2000.0, 0.0)];
        land.roads =
            Some(vec![RoadLine { name: String::new(), line, surface: RoadClass::Main, width_m: 7.0 }]);
        let found = minutes(&land, 50.0, &[DVec2::ZERO]).expect("sound");
        assert!((found[20] - 2.0 / 70.0 * 60.0).abs() < 1e-4, "{}", found[20]);
    }

    #[test]
    fn water_blocks_the_way_and_places_in_it_or_beyond_the_ground_are_errors() {
        let mut land = flat(5, 5, 100.0);
        flood(&mut land, 2, 3.0);
        let found = minutes(&land, 1e4, &[DVec2::ZERO]).expect("sound");
        assert!(found[1].is_finite() && found[2].is_nan() && found[3].is_nan() && found[24].is_nan());
        for at in [DVec2::new(200.0, 0.0), DVec2::new(900.0, 0.0), DVec2::NAN] {
            let error = minutes(&land, 1e4, &[DVec2::ZERO, at]).expect_err("no place");
            assert_eq!(error.key(), Some("from"), "{error}");
        }
    }
}
