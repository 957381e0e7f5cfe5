//! Peaks by prominence and isolation, and passes.

use rayon::prelude::*;

use super::divide_tree::{DivideSummit, divide_passes, divide_summits, posts_around};
use crate::arguments::AnalysisArguments;
use crate::error::AnalysisError;
use crate::land::Land;
use crate::outcome::{FeatureRole, Outcome, OutcomeFeature, OutcomeShape, PropertyValue};
use sandtable_terrain::lattice::Lattice;
use sandtable_terrain::stop_flag::StopFlag;

/// The peaks, the most prominent first: points with `height_m`, `prominence_m`, whether that is a lower bound as no higher
/// ground is connected (`is_prominence_least`), and `isolation_m`, the distance of the nearest higher post, which the
/// highest peak lacks. Summits at the border or beside a post without data are left out, and counted in a note.
///
/// # Errors
/// [`AnalysisError::Memory`] and [`AnalysisError::Stopped`].
pub(crate) fn peaks(
    land: &Land,
    arguments: &AnalysisArguments,
    stop: &StopFlag,
) -> Result<Outcome, AnalysisError> {
    let ground = &*land.ground;
    let summits = divide_summits(ground, arguments.number("prominence") as f32, stop)?;
    let (inner, outer): (Vec<DivideSummit>, Vec<DivideSummit>) =
        summits.into_iter().partition(|summit| is_inside(ground, summit.post));
    stop.stretch(0.8..1.0, inner.len());
    let isolation = |summit: &DivideSummit| {
        let isolation_m = isolation_m(ground, summit.post, stop);
        stop.did(1);
        isolation_m
    };
    let isolations: Vec<Option<f64>> = inner.par_iter().map(isolation).collect();
    if stop.is_stopped() {
        return Err(AnalysisError::Stopped);
    }
    let least_m = arguments.number("isolation");
    let is_isolated = |isolation: &Option<f64>| isolation.is_none_or(|isolation| isolation >= least_m);
    let rows = inner.iter().zip(isolations).filter(|(_, isolation)| is_isolated(isolation));
    let features = rows.map(|(summit, isolation)| peak(ground, summit, isolation)).collect();
    Ok(Outcome { features, notes: left_out(outer.len(), "summit"), ..Outcome::default() })
}

/// The passes between summits, the deepest first: points with `height_m` and `depth_m`, how far the lower of the two
/// summits rises above the pass. Passes at the border or beside a post without data are left out, and counted in a note.
///
/// # Errors
/// [`AnalysisError::Memory`] and [`AnalysisError::Stopped`].
pub(crate) fn passes(
    land: &Land,
    arguments: &AnalysisArguments,
    stop: &StopFlag,
) -> Result<Outcome, AnalysisError> {
    let ground = &*land.ground;
    let summits = divide_summits(ground, arguments.number("depth") as f32, stop)?;
    let passes = divide_passes(&summits).into_iter();
    let (inner, outer): (Vec<_>, Vec<_>) = passes.partition(|&(pass, _)| is_inside(ground, pass));
    let feature = |(pass, depth_m): (usize, f32)| {
        let height_m = ground.heights()[pass];
        OutcomeFeature {
            shape: OutcomeShape::Point(ground.map_position(ground.post_at(pass))),
            name: format!("{height_m:.0}"),
            role: FeatureRole::Place,
            properties: vec![
                ("height_m", PropertyValue::Number(height_m.into())),
                ("depth_m", PropertyValue::Number(depth_m.into())),
            ],
        }
    };
    let features = inner.into_iter().map(feature).collect();
    Ok(Outcome { features, notes: left_out(outer.len(), "pass"), ..Outcome::default() })
}

fn peak(ground: &Lattice, summit: &DivideSummit, isolation_m: Option<f64>) -> OutcomeFeature {
    let height_m = ground.heights()[summit.post];
    let mut properties = vec![
        ("height_m", PropertyValue::Number(height_m.into())),
        ("prominence_m", PropertyValue::Number(summit.prominence_m.into())),
        ("is_prominence_least", PropertyValue::Truth(summit.pass.is_none())),
    ];
    properties.extend(isolation_m.map(|isolation_m| ("isolation_m", PropertyValue::Number(isolation_m))));
    OutcomeFeature {
        shape: OutcomeShape::Point(ground.map_position(ground.post_at(summit.post))),
        name: format!("{height_m:.0}"),
        role: FeatureRole::Place,
        properties,
    }
}

/// Whether a post has eight neighbors with data.
pub(super) fn is_inside(ground: &Lattice, post: usize) -> bool {
    posts_around(ground, post).filter(|&other| !ground.heights()[other].is_nan()).count() == 8
}

/// A note of how many were left out; none for none.
pub(super) fn left_out(count: usize, noun: &str) -> Vec<String> {
    let text = |(verb, plural): (&str, &str)| {
        format!("{count} {noun}{plural} at the border or beside posts without data {verb} left out")
    };
    match count {
        0 => Vec::new(),
        1 => vec![text(("is", ""))],
        _ => vec![text(("are", if noun == "pass" { "es" } else { "s" }))],
    }
}

/// The distance in meters of the nearest post that is higher; `None` where none is.
///
/// Squares of posts around the summit are read, each wider than the last, until the next can hold nothing nearer.
fn isolation_m(ground: &Lattice, post: usize, stop: &StopFlag) -> Option<f64> {
    let (columns, rows) = (i64::from(ground.columns()), i64::from(ground.rows()));
    let (column, row) = (post as i64 % columns, post as i64 / columns);
    let (cell, heights) = (ground.cell(), ground.heights());
    let own = heights[post];
    let mut nearest = f64::INFINITY;
    for radius in 1..columns.max(rows) {
        if radius as f64 * cell.x.min(cell.y) >= nearest || stop.is_stopped() {
            break;
        }
        let mut look = |x: i64, y: i64| {
            if heights[(y * columns + x) as usize] > own {
                let (east, north) = ((x - column) as f64 * cell.x, (y - row) as f64 * cell.y);
                nearest = nearest.min((east * east + north * north).sqrt());
            }
        };
        let (west, east) = ((column - radius).max(0), (column + radius).min(columns - 1));
        for y in [row - radius, row + radius] {
            if (0..rows).contains(&y) {
                (west..=east).for_each(|x| look(x, y));
            }
        }
        let (south, north) = ((row - radius + 1).max(0), (row + radius - 1).min(rows - 1));
        for x in [column - radius, column + radius] {
            if (0..columns).contains(&x) {
                (south..=north).for_each(|y| look(x, y));
            }
        }
    }
    nearest.is_finite().then_some(nearest)
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::super::window::tests::{land, outcome};
    use super::*;

    /// Cones of slope 1 over 65 × 65 posts a meter apart: column, row, height.
    fn cones(hills: &[(f32, f32, f32)]) -> Land {
        let height = |index: u16| {
            let (x, y) = (f32::from(index % 65), f32::from(index / 65));
            hills.iter().map(|&(east, north, top)| top - (x - east).hypot(y - north)).fold(0.0, f32::max)
        };
        land(DVec2::ONE, 65, (0..65 * 65).map(height).collect())
    }

    fn numbers(feature: &OutcomeFeature) -> Vec<f64> {
        let number = |value: &PropertyValue| match value {
            PropertyValue::Number(number) => Some(*number),
            _ => None,
        };
        feature.properties.iter().filter_map(|(_, value)| number(value)).collect()
    }

    #[test]
    fn two_hills_have_their_prominence_their_isolation_and_the_pass_between_them() {
        let land = cones(&[(20.0, 32.0, 30.0), (44.0, 32.0, 22.0)]);
        let peaks = outcome(&land, "peaks", &[], &[("prominence", 1.0)]).expect("peaks").features;
        assert_eq!(peaks.len(), 2);
        assert_eq!(peaks[0].shape, OutcomeShape::Point(DVec2::new(1020.0, 2032.0)));
        assert_eq!(numbers(&peaks[0]), [30.0, 30.0]);
        // The pass is 16 from the higher summit, at 14; ground above 22 begins nearer than 8 to it: 17 away.
        assert_eq!(numbers(&peaks[1]), [22.0, 8.0, 17.0]);
        let passes = outcome(&land, "passes", &[], &[("depth", 1.0)]).expect("passes").features;
        assert_eq!(passes.len(), 1);
        assert_eq!(passes[0].shape, OutcomeShape::Point(DVec2::new(1036.0, 2032.0)));
        assert_eq!(numbers(&passes[0]), [14.0, 8.0]);
    }

    #[test]
    fn peaks_below_a_limit_are_left_out() {
        let land = cones(&[(20.0, 32.0, 30.0), (44.0, 32.0, 22.0)]);
        let count =
            |numbers: &[(&str, f64)]| outcome(&land, "peaks", &[], numbers).expect("peaks").features.len();
        assert_eq!(count(&[("prominence", 8.0)]), 2);
        assert_eq!(count(&[("prominence", 8.1)]), 1);
        assert_eq!(count(&[("prominence", 1.0), ("isolation", 17.5)]), 1);
    }

    #[test]
    fn summits_at_the_border_are_counted_and_level_ground_has_none() {
        let at_border =
            outcome(&cones(&[(0.0, 10.0, 20.0)]), "peaks", &[], &[("prominence", 1.0)]).expect("peaks");
        assert!(at_border.features.is_empty());
        assert_eq!(at_border.notes, ["1 summit at the border or beside posts without data is left out"]);
        for heights in [vec![3.0; 81], vec![f32::NAN; 81]] {
            let level = outcome(&land(DVec2::ONE, 9, heights), "peaks", &[], &[]).expect("peaks");
            assert!(level.features.is_empty() && level.notes.is_empty());
        }
    }

    #[test]
    fn prominence_and_isolation_are_those_of_brute_force_on_rough_ground() {
        let heights: Vec<f32> = (0..23 * 19u32).map(|index| (index * 7919 % 433) as f32).collect();
        let land = land(DVec2::new(3.0, 2.0), 23, heights.clone());
        let ground = &*land.ground;
        let summits = divide_summits(ground, 0.0, &StopFlag::default()).expect("not stopped");
        let tops = (0..heights.len())
            .filter(|&at| posts_around(ground, at).all(|other| heights[other] < heights[at]));
        assert_eq!(tops.clone().count(), summits.len());
        for top in tops {
            let summit = summits.iter().find(|summit| summit.post == top).expect("it is a summit");
            // The lowest level from which a flood of what is not below it still reaches higher ground.
            let reaches = |level: f32| {
                let mut is_seen = vec![false; heights.len()];
                let mut stack = vec![top];
                while let Some(at) = stack.pop() {
                    if heights[at] > heights[top] {
                        return true;
                    }
                    if !std::mem::replace(&mut is_seen[at], true) {
                        stack.extend(posts_around(ground, at).filter(|&other| heights[other] >= level));
                    }
                }
                false
            };
            let pass = heights.iter().copied().filter(|&level| level < heights[top] && reaches(level));
            let pass = pass.fold(f32::NEG_INFINITY, f32::max);
            assert_eq!(summit.pass.map_or(f32::NEG_INFINITY, |pass| heights[pass]), pass);
            let place = |at: usize| ground.map_position(ground.post_at(at));
            let higher = (0..heights.len()).filter(|&at| heights[at] > heights[top]);
            let nearest = higher.map(|at| place(at).distance(place(top))).fold(f64::INFINITY, f64::min);
            let isolation = isolation_m(ground, top, &StopFlag::default()).unwrap_or(f64::INFINITY);
            assert!(isolation == nearest || (isolation - nearest).abs() < 1e-9);
        }
    }
}
