//! Berms along a line whose crest reaches a level, with the ditch that gives their earth.

use glam::DVec2;

use crate::arguments::AnalysisArguments;
use crate::error::AnalysisError;
use crate::land::Land;
use crate::outcome::{
    FeatureRole, Figure, Outcome, OutcomeFeature, OutcomeShape, OutcomeTable, PropertyValue, TableColumn,
};
use crate::place::height_under;
use sandtable_terrain::stop_flag::StopFlag;

/// The greatest number of stations.
const MOST_STATIONS: f64 = 100_000.0;

/// A row for each station: ground, berm height, ditch depth, and the volume of the berm so far; and the ground that berms
/// cover, from foot to foot.
///
/// # Errors
/// An argument where there would be too many stations, a place where a station has no ground.
pub(crate) fn berms(
    land: &Land,
    arguments: &AnalysisArguments,
    _stop: &StopFlag,
) -> Result<Outcome, AnalysisError> {
    let line = arguments.points("line");
    let number = |name: &str| arguments.number(name);
    let (level, crest, run) = (number("level_m"), number("crest_m"), number("side_run"));
    let (bottom, swell, step) = (number("ditch_m"), number("swell"), number("step_m"));
    let length: f64 = line.windows(2).map(|pair| pair[0].distance(pair[1])).sum();
    if length.is_nan() || length / step > MOST_STATIONS {
        return Err(AnalysisError::argument(
            "step_m",
            "gives more than 100000 stations; state a longer step",
        ));
    }
    let mut rows = Vec::new();
    let (mut volume, mut before) = (0.0, None);
    let mut berms = Vec::new();
    for (distance, at) in stations(line, step) {
        let ground = height_under(&land.ground, "line", at)?;
        let berm = (level - ground).max(0.0);
        let section = berm * (crest + run * berm);
        let dug = section / swell;
        // The root of depth · (bottom + run · depth) = dug, in the form that holds for a run of 0.
        let depth = 2.0 * dug / (bottom + libm::sqrt(bottom * bottom + 4.0 * run * dug));
        if let Some((last, last_section)) = before {
            volume += (distance - last) * (section + last_section) / 2.0;
        }
        before = Some((distance, section));
        berms.push(BermStation { at, height_m: berm, half_m: crest / 2.0 + run * berm });
        rows.push([distance, ground, berm, depth, volume].map(PropertyValue::Number).into());
    }
    let column = |name, decimals| TableColumn::new(name, "m", decimals);
    let columns = vec![
        column("station", 0),
        column("ground", 2),
        column("berm height", 2),
        column("ditch depth", 2),
        TableColumn::new("berm so far", "m³", 1),
    ];
    let figure = |name, value| Figure::new(name, value, "m³");
    Ok(Outcome {
        features: footprints(&berms),
        tables: vec![OutcomeTable { title: "Berm and ditch".to_owned(), columns, rows }],
        figures: vec![figure("berm", volume), figure("ditch", volume / swell)],
        ..Outcome::default()
    })
}

/// A berm at a station.
struct BermStation {
    at: DVec2,
    height_m: f64,
    /// Half of its width at its foot.
    half_m: f64,
}

/// The ground that berms cover, an area for each stretch of stations where the crest is above the ground.
fn footprints(stations: &[BermStation]) -> Vec<OutcomeFeature> {
    let stretches = stations.split(|station| station.height_m <= 0.0);
    stretches.filter(|stretch| stretch.len() > 1).map(footprint).collect()
}

fn footprint(stretch: &[BermStation]) -> OutcomeFeature {
    let last = stretch.len() - 1;
    let foot = |index: usize| {
        let along = stretch[(index + 1).min(last)].at - stretch[index.saturating_sub(1)].at;
        along.normalize_or_zero().perp() * stretch[index].half_m
    };
    let right = (0..=last).map(|index| stretch[index].at - foot(index));
    let left = (0..=last).rev().map(|index| stretch[index].at + foot(index));
    let length: f64 = stretch.windows(2).map(|pair| pair[0].at.distance(pair[1].at)).sum();
    let highest = stretch.iter().map(|station| station.height_m).fold(0.0, f64::max);
    OutcomeFeature {
        shape: OutcomeShape::Area(vec![right.chain(left).collect()]),
        name: format!("up to {highest:.1} m"),
        role: FeatureRole::Site,
        properties: vec![
            ("length_m", PropertyValue::Number(length)),
            ("highest_m", PropertyValue::Number(highest)),
        ],
    }
}

/// Positions each `step` meters along a line, and its end, with their distances from its beginning.
fn stations(line: &[DVec2], step: f64) -> Vec<(f64, DVec2)> {
    let (mut stations, mut done) = (Vec::new(), 0.0);
    for pair in line.windows(2) {
        let length = pair[0].distance(pair[1]);
        while stations.len() as f64 * step < done + length {
            let distance = stations.len() as f64 * step;
            stations.push((distance, pair[0].lerp(pair[1], (distance - done) / length)));
        }
        done += length;
    }
    stations.extend(line.last().map(|&end| (done, end)));
    stations
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arguments::ArgumentValue;
    use sandtable_geom::crs::Crs;
    use sandtable_terrain::lattice::Lattice;
    use std::sync::Arc;

    #[test]
    fn a_berm_of_two_meters_has_the_section_and_ditch_worked_out_by_hand() {
        let ground = Lattice::new(DVec2::new(100.0, 200.0), DVec2::new(10.0, 10.0), 3, vec![8.0; 9]);
        let ground = ground.expect("valid input");
        let land = Land::bare(Arc::new(ground), Crs::from_epsg(32733).expect("a known system"));
        let at = land.ground.origin();
        let arguments = AnalysisArguments::new(sandtable_catalog::kind("berms").expect("a kind"))
            .with("line", ArgumentValue::Points(vec![at, at + DVec2::new(20.0, 0.0)]))
            .with("level_m", ArgumentValue::Number(10.0))
            .with("crest_m", ArgumentValue::Number(1.0))
            .with("side_run", ArgumentValue::Number(1.0))
            .with("ditch_m", ArgumentValue::Number(1.0))
            .with("swell", ArgumentValue::Number(1.0));
        let outcome = berms(&land, &arguments, &StopFlag::default()).expect("valid input");
        // 2 · (1 + 2) = 6 m² of section; the ditch with the same sides is as deep: 20 m give 120 m³.
        let row = [20.0, 8.0, 2.0, 2.0, 120.0].map(PropertyValue::Number);
        assert_eq!(outcome.tables[0].rows.len(), 3);
        assert_eq!(outcome.tables[0].rows[2], row);
        // A crest of 1 m and two sides of 2 m.
        let foot = [[0.0, -2.5], [10.0, -2.5], [20.0, -2.5], [20.0, 2.5], [10.0, 2.5], [0.0, 2.5]];
        let foot = foot.map(|foot| at + DVec2::from(foot)).to_vec();
        let areas: Vec<&OutcomeShape> = outcome.features.iter().map(|feature| &feature.shape).collect();
        assert_eq!(areas, [&OutcomeShape::Area(vec![foot])]);
        let low = arguments.clone().with("level_m", ArgumentValue::Number(8.0));
        assert!(berms(&land, &low, &StopFlag::default()).expect("valid input").features.is_empty());
        let off = arguments.with("line", ArgumentValue::Points(vec![at, at - DVec2::new(20.0, 0.0)]));
        let error = berms(&land, &off, &StopFlag::default()).expect_err("off the land");
        assert_eq!(error.key(), Some("line"));
    }
}
