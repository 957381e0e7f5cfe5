//! Masking heights: how high above the ground a target must rise to be seen by radars.
//!
//! Where a viewshed shows the ground itself, the height is 0; elsewhere it is the rise of the target that clears the line of
//! sight over the triangles of the ground, to a centimeter or a ten-thousandth.

use glam::DVec2;
use rayon::prelude::*;

use crate::arguments::AnalysisArguments;
use crate::error::AnalysisError;
use crate::land::Land;
use crate::measures::percent;
use crate::observation::lookout::{LookWindow, Lookout, check_windows, curvature, range_m};
use crate::observation::sight_land::SightLand;
use crate::outcome::{
    Figure, Hatching, Outcome, OutcomeRaster, OutcomeTable, PostValues, PropertyValue, TableColumn,
    ValueClass,
};
use crate::sight_parts::{SightKind, SightValues, windows};
use crate::tally::FigureTally;
use sandtable_base::limits::memory::check_memory;
use sandtable_terrain::lattice::Lattice;
use sandtable_terrain::post_rect::PostRect;
use sandtable_terrain::sight::Curvature;
use sandtable_terrain::sight::line::SightEnd;
use sandtable_terrain::sight::viewshed::{SWEEP_UNITS, ViewshedOptions};
use sandtable_terrain::stop_flag::StopFlag;

/// A value, the rise of each post and what stands there, and the rise as the sweep stores it.
const BYTES_PER_POST: u64 = 20;

/// Heights above the ground at which the hidden share is a figure, meters.
const LEVELS_M: [f32; 4] = [0.0, 50.0, 100.0, 300.0];

/// The height above the ground, meters, from which a target at each post is seen; no data beyond the range of all radars.
pub(crate) const SIGHT: SightKind = SightKind { values, summary };

/// What looks for targets.
struct MaskingWatch<'a> {
    sight: SightLand,
    ground: &'a Lattice,
    radars: &'a [DVec2],
    height_m: f64,
    curvature: Curvature,
    range_m: f64,
    /// Whether the nearest radar's sight alone counts.
    is_nearest_alone: bool,
    /// The posts whose values are found.
    posts: PostRect,
}

/// The values of `posts`. The tally has the posts that each radar sees, and of how many; then for each level those that are
/// hidden up to it, and of how many.
///
/// # Errors
/// `radars` off the ground or too many, memory, and [`AnalysisError::Stopped`].
fn values(
    land: &Land,
    arguments: &AnalysisArguments,
    posts: PostRect,
    stop: &StopFlag,
) -> Result<SightValues, AnalysisError> {
    let ground = &*land.ground;
    let radars = arguments.points("radars");
    let windows = windows(ground, arguments, posts);
    check_windows("radars", windows.iter().map(|(_, window)| window))?;
    let count = posts.width() * posts.height();
    check_memory(count as u64 * BYTES_PER_POST, "the masking heights", "state a smaller `extent`")?;
    let watch = MaskingWatch {
        sight: SightLand::new(land).cleared_around(radars.iter().copied()),
        ground,
        radars,
        height_m: arguments.number("radar_height"),
        curvature: curvature(arguments),
        range_m: range_m(arguments),
        is_nearest_alone: arguments.word("seen_by") == "nearest",
        posts,
    };
    let mut values = vec![f32::NAN; count];
    let mut tally = vec![0; 2 * radars.len()];
    stop.stretch(0.0..1.0, windows.len() * SWEEP_UNITS);
    for (index, window) in windows {
        let (seen, known) = watch.merge((index, window), &mut values, stop)?;
        (tally[2 * index], tally[2 * index + 1]) = (seen as u64, known as u64);
    }
    let known = values.par_iter().filter(|value| !value.is_nan()).count() as u64;
    let hidden = |level_m: f32| values.par_iter().filter(|&&value| value > level_m).count() as u64;
    tally.extend(LEVELS_M.into_iter().flat_map(|level_m| [hidden(level_m), known]));
    let raster = OutcomeRaster {
        name: "masking height",
        unit: "m",
        values: PostValues::Numbers(values),
        classes: classes(),
    };
    Ok(SightValues { raster, tally: FigureTally::new(tally) })
}

/// The radars with what they see, as features, a table and figures.
fn summary(
    _: &Lattice,
    arguments: &AnalysisArguments,
    heights_m: &[f64],
    tally: &FigureTally,
) -> Result<Outcome, AnalysisError> {
    let radars = Lookout::with_heights(arguments, "radars", arguments.number("radar_height"), heights_m);
    let part = |pair: &[u64]| percent(pair[0] as usize, pair[1] as usize);
    let shares: Vec<f64> = tally.counts().chunks_exact(2).map(part).collect();
    let (shares, hidden) = shares.split_at(radars.len().min(shares.len()));
    let hidden = LEVELS_M
        .iter()
        .zip(hidden)
        .map(|(level_m, &share)| Figure::new(format!("hidden at {level_m} m above the ground"), share, "%"));
    let share = |share: f64| PropertyValue::Number(share);
    let row = |(radar, &seen): (&Lookout, &f64)| {
        vec![
            PropertyValue::Whole(radar.number as i64),
            PropertyValue::Number(radar.ground_m),
            PropertyValue::Number(radar.ground_m + radar.end.above_m),
            share(seen),
        ]
    };
    let table = OutcomeTable {
        title: "Radars".into(),
        columns: vec![
            TableColumn::of_marks("radar"),
            TableColumn::new("ground", "m", 0),
            TableColumn::new("antenna", "m", 0),
            TableColumn::new("ground in sight", "%", 1),
        ],
        rows: radars.iter().zip(shares).map(row).collect(),
    };
    let feature =
        |(radar, &seen): (&Lookout, &f64)| radar.feature(vec![("ground_in_sight_percent", share(seen))]);
    Ok(Outcome {
        features: radars.iter().zip(shares).map(feature).collect(),
        tables: vec![table],
        figures: hidden.collect(),
        ..Outcome::default()
    })
}

impl MaskingWatch<'_> {
    /// Merges a radar's masking heights into the values; the number of posts that it sees, and of those that it could.
    fn merge(
        &self,
        (index, window): (usize, LookWindow),
        values: &mut [f32],
        stop: &StopFlag,
    ) -> Result<(usize, usize), AnalysisError> {
        let end = SightEnd { at: self.radars[index], above_m: self.height_m };
        let options =
            ViewshedOptions { range_m: self.range_m, curvature: self.curvature, ..ViewshedOptions::new(end) };
        let rises_m = self.sight.rises("radars", (&options, window), stop)?;
        let LookWindow { held, looked } = window;
        let (from, to) = (looked.counted_in(held).first, looked.counted_in(self.posts).first);
        let rows = values.par_chunks_mut(self.posts.width()).skip(to.row as usize).take(looked.height());
        let rows = rows.zip(rises_m.par_chunks(held.width()).skip(from.row as usize)).enumerate();
        let seen_of = rows.map(|(row, (values, rises_m))| {
            let values = &mut values[to.column as usize..][..looked.width()];
            let rises_m = &rises_m[from.column as usize..][..looked.width()];
            let (mut seen, mut known) = (0, 0);
            for ((column, value), &rise_m) in (0..).zip(values).zip(rises_m) {
                seen += usize::from(rise_m == 0.0);
                known += usize::from(!rise_m.is_nan());
                let counts = || {
                    let at = self.ground.map_position(looked.first.offset(column, row as u32));
                    !self.is_nearest_alone || self.nearest(at) == index
                };
                // No data gives way.
                if !rise_m.is_nan() && (value.is_nan() || rise_m < *value) && counts() {
                    *value = rise_m;
                }
            }
            (seen, known)
        });
        Ok(seen_of.reduce(|| (0, 0), |one, other| (one.0 + other.0, one.1 + other.1)))
    }

    /// The radar nearest to a place, of equal ones the first.
    fn nearest(&self, at: DVec2) -> usize {
        let distance = |&index: &usize| self.radars[index].distance_squared(at);
        (0..self.radars.len()).min_by(|one, other| distance(one).total_cmp(&distance(other))).unwrap_or(0)
    }
}

fn classes() -> Vec<ValueClass> {
    let rows = [
        (0.0, "up to 10 m", [0, 0, 0, 0], Hatching::None),
        (10.0, "10–30 m", [255, 255, 178, 90], Hatching::None),
        (30.0, "30–100 m", [254, 204, 92, 110], Hatching::Dots),
        (100.0, "100–300 m", [253, 141, 60, 120], Hatching::Single),
        (300.0, "over 300 m", [189, 0, 38, 130], Hatching::Crossed),
    ];
    ValueClass::of_rows(rows)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arguments::ArgumentValue;
    use crate::observation::test_hills::{at, land, ripples};
    use crate::test_land::{on_pool, run_kind};
    use sandtable_terrain::lattice::Post;
    use sandtable_terrain::sight::line::{Sight, line_of_sight};

    const CURVATURE: Curvature = Curvature { radius_m: 6_371_008.8, refraction: 0.25 };

    fn arguments(places: &[(f64, f64)], height_m: f64, seen_by: &str) -> Vec<(&'static str, ArgumentValue)> {
        let radars = places.iter().map(|&(column, row)| at(column, row)).collect();
        vec![
            ("radars", ArgumentValue::Points(radars)),
            ("radar_height", ArgumentValue::Number(height_m)),
            ("range", ArgumentValue::Number(140.0)),
            ("seen_by", ArgumentValue::Word(seen_by.into())),
        ]
    }

    fn value(land: &Land, outcome: &Outcome, (column, row): (u32, u32)) -> f32 {
        let raster = outcome.raster.as_ref().expect("a raster");
        raster.values.value(land.ground.index(Post { column, row }))
    }

    #[test]
    fn behind_a_wall_the_masking_height_is_that_of_the_line_over_its_top() {
        let land = land(21, |column, _| if column == 5 { 10.0 } else { 0.0 });
        let outcome = run_kind("masking", &land, arguments(&[(0.0, 10.0)], 20.0, "any")).expect("sound");
        for (column, expected) in [(2, 0.0), (5, 0.0), (7, 6.0), (9, 2.0), (12, 0.0)] {
            let height_m = value(&land, &outcome, (column, 10));
            assert!((height_m - expected).abs() < 1e-3, "{column}: {height_m}");
        }
        assert!(value(&land, &outcome, (15, 10)).is_nan(), "beyond the range");
    }

    #[test]
    fn a_target_is_seen_just_above_the_masking_height_and_hidden_just_below() {
        let land = land(20, ripples);
        let places = [(2.0, 3.0), (15.4, 12.2)];
        let [any, nearest] = ["any", "nearest"]
            .map(|seen_by| run_kind("masking", &land, arguments(&places, 2.0, seen_by)).expect("sound"));
        let radars = places.map(|(column, row)| SightEnd { at: at(column, row), above_m: 2.0 });
        let is_seen = |radar: SightEnd, post: Post, above_m: f64| {
            let target = SightEnd { at: land.ground.map_position(post), above_m };
            radar.at.distance(target.at) <= 140.0
                && line_of_sight(&land.ground, radar, target, CURVATURE) == Sight::Clear
        };
        let mut hidden = 0;
        for post in land.ground.posts().filter(|&post| !land.ground.height(post).is_nan()) {
            let at = land.ground.map_position(post);
            let near = usize::from(radars[1].at.distance(at) < radars[0].at.distance(at));
            for (outcome, radars) in [(&any, &radars[..]), (&nearest, &radars[near..=near])] {
                let height_m = f64::from(value(&land, outcome, (post.column, post.row)));
                if height_m.is_nan() {
                    assert!(radars.iter().all(|radar| radar.at.distance(at) > 140.0), "{post:?}");
                    continue;
                }
                let seen = |above_m| radars.iter().any(|&radar| is_seen(radar, post, above_m));
                assert!(seen(height_m + 1e-2), "{post:?}: {height_m}");
                hidden += usize::from(height_m > 0.0);
                let is_hidden_below = height_m <= 1e-2 || !seen(height_m - 1e-2);
                assert!(is_hidden_below && (height_m == 0.0) == seen(0.0), "{post:?}: {height_m}");
            }
        }
        assert!(hidden > 200, "{hidden}");
    }

    #[test]
    fn any_number_of_threads_gives_the_same_bits_and_no_post_with_ground_is_left_out() {
        let land = land(20, ripples);
        let mut arguments = arguments(&[(2.0, 3.0), (15.4, 12.2)], 2.0, "any");
        arguments.retain(|(name, _)| *name != "range");
        let run = || run_kind("masking", &land, arguments.clone()).expect("sound");
        let text = |threads| on_pool(threads, || format!("{:?}", run()));
        assert_eq!(text(1), text(4));
        let outcome = run();
        for post in land.ground.posts() {
            let height_m = value(&land, &outcome, (post.column, post.row));
            assert_eq!(height_m.is_nan(), land.ground.height(post).is_nan(), "{post:?}");
        }
    }

    #[test]
    fn radars_off_the_land_are_an_error_that_names_the_key() {
        let land = land(20, ripples);
        let error = run_kind("masking", &land, arguments(&[(2.0, 3.0), (10.0, 17.0)], 2.0, "any"));
        assert_eq!(error.err().and_then(|error| error.key()), Some("radars"));
    }
}
