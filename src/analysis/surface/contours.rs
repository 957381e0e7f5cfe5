//! Contours: lines of equal height, and bands between them.
//!
//! Lines run straight through the cells of the lattice by marching squares; see [`sandtable_geom::isolines`].

use glam::DVec2;
use rayon::prelude::*;

use crate::arguments::AnalysisArguments;
use crate::error::AnalysisError;
use crate::land::Land;
use crate::outcome::{
    FeatureRole, Figure, Hatching, Outcome, OutcomeFeature, OutcomeRaster, OutcomeShape, PostValues,
    PropertyValue, ValueClass,
};
use sandtable_base::message::numbers::trimmed;
use sandtable_geom::isolines::{ValueGrid, isolines};
use sandtable_terrain::lattice::{Lattice, Post};
use sandtable_terrain::stop_flag::StopFlag;

/// The number of intervals from the lowest to the highest ground that a land without a stated interval has at most.
const INTERVALS: f64 = 20.0;

/// The most lines through all cells together: a line's way through a cell takes some 60 bytes until lines are linked.
const MOST_PASSAGES: u64 = 8_000_000;

/// The most bands: more are not told apart in a legend.
const MOST_BANDS: f64 = 250.0;

/// Lines of equal height at the multiples of the interval, higher ground on their right, in map coordinates.
///
/// # Errors
/// [`AnalysisError::Argument`] where the lines of `interval` would be too many.
pub(crate) fn contours(
    land: &Land,
    arguments: &AnalysisArguments,
    _stop: &StopFlag,
) -> Result<Outcome, AnalysisError> {
    let ground = &*land.ground;
    let interval = interval(ground, arguments);
    let passages = passages(ground, interval);
    if passages > MOST_PASSAGES {
        let problem = format!(
            "of {interval} m gives {passages} crossings of lines and cells, more than {MOST_PASSAGES}; state a larger one"
        );
        return Err(AnalysisError::argument("interval", problem));
    }
    let every = arguments.number("every").round().max(1.0) as i64;
    let grid = ValueGrid { columns: ground.columns() as usize, values: ground.heights() };
    let origin = ground.map_position(Post { column: 0, row: 0 });
    let lines = isolines(&grid, interval as f32, usize::MAX, |_, _| true);
    let features: Vec<OutcomeFeature> = lines
        .into_iter()
        .filter_map(|line| {
            let mut points: Vec<DVec2> = line.points.iter().map(|at| origin + *at * ground.cell()).collect();
            points.dedup();
            let height = line.level as f64 * interval;
            let is_numbered = line.level % every == 0;
            (points.len() > 1).then(|| OutcomeFeature {
                shape: OutcomeShape::Line(points),
                name: if is_numbered { trimmed(height, 2) } else { String::new() },
                role: FeatureRole::Isoline,
                properties: vec![
                    ("height_m", PropertyValue::Number(height)),
                    ("is_index", PropertyValue::Truth(is_numbered)),
                ],
            })
        })
        .collect();
    let figures = vec![Figure::new("interval", interval, "m")];
    Ok(Outcome { features, figures, ..Outcome::default() })
}

/// The lower bound in meters of the band of each post; NaN without data.
///
/// # Errors
/// [`AnalysisError::Argument`] where the bands of `interval` would be too many.
pub(crate) fn elevation_bands(
    land: &Land,
    arguments: &AnalysisArguments,
    _stop: &StopFlag,
) -> Result<Outcome, AnalysisError> {
    let ground = &*land.ground;
    let interval = interval(ground, arguments);
    let band = |height: f32| (f64::from(height) / interval).floor();
    let (low, high) = ground.height_range();
    let (first, last) = (band(low), band(high));
    let count = last - first + 1.0;
    if count > MOST_BANDS {
        let problem =
            format!("of {interval} m gives {count} bands, more than {MOST_BANDS}; state a larger one");
        return Err(AnalysisError::argument("interval", problem));
    }
    let values = ground.heights().par_iter().map(|&height| (band(height) * interval) as f32).collect();
    // A lattice without data has no bands: its range is empty.
    let bands = if count >= 1.0 { count as i64 } else { 0 };
    let classes = (0..bands).map(|index| band_class(first + index as f64, interval, index, bands)).collect();
    let raster =
        OutcomeRaster { name: "elevation band", unit: "m", values: PostValues::Numbers(values), classes };
    let figures = vec![Figure::new("interval", interval, "m")];
    Ok(Outcome { raster: Some(raster), figures, ..Outcome::default() })
}

/// The stated interval in meters, or a round one: 1, 2 or 5 times a power of ten.
fn interval(ground: &Lattice, arguments: &AnalysisArguments) -> f64 {
    arguments.number_if("interval").unwrap_or_else(|| {
        let (low, high) = ground.height_range();
        let least = (f64::from(high - low) / INTERVALS).clamp(0.01, 1e6);
        let decades = (-2..=7).map(|power| libm::exp10(f64::from(power)));
        let nice = decades.flat_map(|decade| [decade, 2.0 * decade, 5.0 * decade]);
        nice.into_iter().find(|&nice| nice >= least).unwrap_or(1e6)
    })
}

/// How many lines cross cells, each counted in each cell.
fn passages(ground: &Lattice, interval: f64) -> u64 {
    let columns = ground.columns() as usize;
    let heights = ground.heights();
    let per_row = |row: usize| -> u64 {
        let (south, north) =
            (&heights[row * columns..][..columns], &heights[(row + 1) * columns..][..columns]);
        let cells = south.windows(2).zip(north.windows(2));
        let crossings = cells.map(|(south, north)| {
            let corners = [south[0], south[1], north[0], north[1]].map(f64::from);
            if corners.iter().any(|height| height.is_nan()) {
                return 0;
            }
            let [low, high] = corners
                .iter()
                .fold([f64::MAX, f64::MIN], |[low, high], &height| [low.min(height), high.max(height)]);
            // At least 0, and a sum of them cannot overflow: heights are within 10,000 km, intervals at least 1 cm.
            ((high / interval).floor() - (low / interval).floor()) as u64
        });
        crossings.sum()
    };
    (0..ground.rows() as usize - 1).into_par_iter().map(per_row).sum()
}

/// A band's class: from green over yellow and brown to white.
fn band_class(band: f64, interval: f64, index: i64, bands: i64) -> ValueClass {
    const RAMP: [[f64; 3]; 5] = [
        [110.0, 165.0, 110.0],
        [205.0, 210.0, 140.0],
        [225.0, 180.0, 110.0],
        [165.0, 115.0, 80.0],
        [245.0, 245.0, 245.0],
    ];
    let at = index as f64 / (bands - 1).max(1) as f64 * 4.0;
    let from = (at.floor() as usize).min(3);
    let part = at - from as f64;
    let channel = |channel: usize| {
        (RAMP[from][channel] + (RAMP[from + 1][channel] - RAMP[from][channel]) * part).round() as u8
    };
    let (low, high) = (band * interval, (band + 1.0) * interval);
    let label = format!("{}–{} m", trimmed(low, 2), trimmed(high, 2));
    ValueClass::new(low as f32, label, [channel(0), channel(1), channel(2), 130], Hatching::None)
}

#[cfg(test)]
mod tests {
    use super::super::window::tests::{land, outcome, values};
    use super::*;

    /// A cone of slope 1 with its summit at 20.5 m over 21 × 21 posts 2 m apart.
    fn cone() -> Land {
        let height = |index: i32| 20.5 - 2.0 * ((index % 21 - 10) as f32).hypot((index / 21 - 10) as f32);
        land(DVec2::splat(2.0), 21, (0..441).map(height).collect())
    }

    #[test]
    fn contours_of_a_cone_are_rings_with_higher_ground_on_their_right() {
        let lines = outcome(&cone(), "contours", &[], &[("interval", 5.0), ("every", 2.0)]).expect("lines");
        let rings: Vec<&OutcomeFeature> = lines
            .features
            .iter()
            .filter(
                |line| matches!(&line.shape, OutcomeShape::Line(points) if points.first() == points.last()),
            )
            .collect();
        assert_eq!(rings.iter().map(|ring| &*ring.name).collect::<Vec<_>>(), ["", "10", "", "20"]);
        for (ring, height) in rings.into_iter().zip([5.0, 10.0, 15.0, 20.0]) {
            let OutcomeShape::Line(points) = &ring.shape else { panic!("a line") };
            let middle = DVec2::new(1020.0, 2020.0);
            for pair in points.windows(2) {
                assert!((pair[0].distance(middle) - (20.5 - height)).abs() < 0.6);
                assert!((pair[1] - pair[0]).perp_dot(middle - pair[0]) < 0.0, "the summit is on the right");
            }
        }
    }

    #[test]
    fn a_land_without_a_stated_interval_has_a_round_one() {
        let lines = outcome(&cone(), "contours", &[], &[]).expect("lines");
        // 20.5 m down to −7.8 m: 28.3 / 20.
        assert_eq!(lines.figures[0].value, 2.0);
    }

    #[test]
    fn bands_begin_at_multiples_of_the_interval_also_below_zero() {
        let mut heights = vec![-12.0, -10.0, -0.5, 0.0, 9.9, 10.0];
        heights[1] = f32::NAN;
        let land = land(DVec2::ONE, 2, heights);
        let bands = values(&land, "elevation-bands", &[], &[("interval", 10.0)]);
        assert!(bands[1].is_nan());
        assert_eq!([bands[0], bands[2], bands[3], bands[4], bands[5]], [-20.0, -10.0, 0.0, 0.0, 10.0]);
        let classes = outcome(&land, "elevation-bands", &[], &[("interval", 10.0)]).expect("bands").raster;
        let classes = classes.expect("a raster").classes;
        let labels: Vec<&str> = classes.iter().map(|class| &*class.label).collect();
        assert_eq!(labels, ["-20–-10 m", "-10–0 m", "0–10 m", "10–20 m"]);
    }

    #[test]
    fn intervals_that_give_too_much_are_errors_and_land_without_data_gives_nothing() {
        let steep = land(DVec2::ONE, 2, vec![0.0, 1e6, 0.0, 1e6]);
        for kind in ["contours", "elevation-bands"] {
            let error = outcome(&steep, kind, &[], &[("interval", 0.01)]).expect_err("too many");
            assert_eq!(error.key(), Some("interval"));
            let empty = outcome(&land(DVec2::ONE, 2, vec![f32::NAN; 4]), kind, &[], &[]).expect("nothing");
            assert!(empty.features.is_empty());
            assert!(empty.raster.is_none_or(|raster| raster.classes.is_empty()));
        }
    }
}
