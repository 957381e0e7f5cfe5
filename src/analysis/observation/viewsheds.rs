//! Viewsheds of many posts: how many see each place, which one sees it first, and what none of them sees.

use crate::arguments::AnalysisArguments;
use crate::error::AnalysisError;
use crate::land::Land;
use crate::measures::{area_km2, percent};
use crate::observation::lookout::{
    DEAD_TINT, Lookout, check_windows, count_classes, curvature, range_m, shares,
};
use crate::observation::sight_land::SightLand;
use crate::outcome::{
    Figure, Hatching, Outcome, OutcomeRaster, OutcomeTable, PostValues, PropertyValue, TableColumn,
    ValueClass,
};
use crate::sight_parts::{SightKind, SightValues, windows};
use crate::tally::FigureTally;
use rayon::prelude::*;
use sandtable_base::limits::memory::check_memory;
use sandtable_terrain::lattice::Lattice;
use sandtable_terrain::post_rect::PostRect;
use sandtable_terrain::sight::line::SightEnd;
use sandtable_terrain::sight::viewshed::{PostVisibility, ViewshedOptions};
use sandtable_terrain::stop_flag::StopFlag;

/// A value, the visibility, and what stands at each post, with what a viewshed needs while it is computed.
const BYTES_PER_POST: u64 = 16;

/// What the values of viewsheds are.
#[derive(Clone, Copy, PartialEq)]
enum ViewshedShow {
    Count,
    First,
    Dead,
}

/// What posts see together, a value a post; no data where there is no ground and beyond the range of all.
pub(crate) const SIGHT: SightKind = SightKind { values, summary };

/// The values of `posts`. The tally has the posts that each lookout sees, and of how many; then those that any sees, and of how
/// many.
///
/// # Errors
/// `posts` off the ground or too many, memory, and [`AnalysisError::Stopped`].
fn values(
    land: &Land,
    arguments: &AnalysisArguments,
    posts: PostRect,
    stop: &StopFlag,
) -> Result<SightValues, AnalysisError> {
    let ground = &*land.ground;
    let show = match arguments.word("show").as_str() {
        "first" => ViewshedShow::First,
        "dead" => ViewshedShow::Dead,
        _ => ViewshedShow::Count,
    };
    let places = arguments.points("posts");
    let windows = windows(ground, arguments, posts);
    check_windows("posts", windows.iter().map(|(_, window)| window))?;
    let count = posts.width() * posts.height();
    check_memory(count as u64 * BYTES_PER_POST, "the viewsheds", "state a smaller `extent`")?;
    let mut values = vec![f32::NAN; count];
    let mut tally = vec![0; 2 * places.len()];
    let sight = SightLand::new(land).cleared_around(places.iter().copied());
    stop.stretch(0.0..1.0, windows.len() * sight.look_units(arguments.number("target_height")));
    for (index, window) in windows {
        let end = SightEnd { at: places[index], above_m: arguments.number("observer_height") };
        let options = ViewshedOptions {
            target_above_m: arguments.number("target_height"),
            range_m: range_m(arguments),
            curvature: curvature(arguments),
            ..ViewshedOptions::new(end)
        };
        let view = sight.look_at("posts", (&options, window), stop)?;
        let number = (index + 1) as f32;
        view.merge_into(&mut values, posts, |value, post| {
            *value = merged(show, number, *value, post);
        });
        let (seen, of) = view.seen_of();
        (tally[2 * index], tally[2 * index + 1]) = (seen as u64, of as u64);
    }
    let seen = values
        .par_iter()
        .filter(|&&value| if show == ViewshedShow::Dead { value == 0.0 } else { value > 0.0 });
    tally.extend(
        [seen.count(), values.par_iter().filter(|value| !value.is_nan()).count()].map(|posts| posts as u64),
    );
    Ok(SightValues { raster: raster(show, values, places.len()), tally: FigureTally::new(tally) })
}

/// The lookouts with what they see, as features, a table and figures.
fn summary(
    ground: &Lattice,
    arguments: &AnalysisArguments,
    heights_m: &[f64],
    tally: &FigureTally,
) -> Result<Outcome, AnalysisError> {
    let lookouts = Lookout::with_heights(arguments, "posts", arguments.number("observer_height"), heights_m);
    let (shares, (seen, all)) = shares(tally);
    let feature = |(lookout, &(seen, of)): (&Lookout, &(usize, usize))| {
        lookout.feature(vec![
            ("seen_km2", PropertyValue::Number(area_km2(ground, seen))),
            ("share_percent", PropertyValue::Number(percent(seen, of))),
        ])
    };
    let figure = |(lookout, &(seen, of)): (&Lookout, &(usize, usize))| {
        Figure::new(format!("seen from post {}", lookout.number), percent(seen, of), "%")
    };
    let hidden = all.saturating_sub(seen);
    let of_all = [
        Figure::new("seen from any post", percent(seen, all), "%"),
        Figure::new("dead ground", percent(hidden, all), "%"),
        Figure::new("dead ground, area", area_km2(ground, hidden), "km²"),
    ];
    Ok(Outcome {
        features: lookouts.iter().zip(&shares).map(feature).collect(),
        tables: vec![table(ground, &lookouts, &shares)],
        figures: lookouts.iter().zip(&shares).map(figure).chain(of_all).collect(),
        ..Outcome::default()
    })
}

/// A value after one more post looked at its place.
#[inline]
fn merged(show: ViewshedShow, number: f32, value: f32, post: PostVisibility) -> f32 {
    match (post, show) {
        (PostVisibility::Beyond | PostVisibility::NoData, _) => value,
        (PostVisibility::Hidden, ViewshedShow::Dead) if value.is_nan() => 1.0,
        (PostVisibility::Hidden, _) if value.is_nan() => 0.0,
        (PostVisibility::Hidden, _) => value,
        (PostVisibility::Visible, ViewshedShow::Dead) => 0.0,
        (PostVisibility::Visible, ViewshedShow::First) if value > 0.0 => value,
        (PostVisibility::Visible, ViewshedShow::First) => number,
        (PostVisibility::Visible, ViewshedShow::Count) => {
            if value.is_nan() {
                1.0
            } else {
                value + 1.0
            }
        }
    }
}

fn raster(show: ViewshedShow, values: Vec<f32>, lookouts: usize) -> OutcomeRaster {
    match show {
        ViewshedShow::Count => OutcomeRaster {
            name: "posts in sight",
            unit: "",
            values: PostValues::Numbers(values),
            classes: count_classes(lookouts, ["dead ground", "seen by"]),
        },
        ViewshedShow::First => OutcomeRaster {
            name: "first post in sight",
            unit: "",
            values: PostValues::Numbers(values),
            classes: first_classes(lookouts),
        },
        ViewshedShow::Dead => {
            let code = |value: &f32| if value.is_nan() { PostValues::NO_CODE } else { *value as u8 };
            let classes = ValueClass::of_rows([
                (0.0, "in sight", [0; 4], Hatching::None),
                (1.0, "dead ground", DEAD_TINT, Hatching::Single),
            ]);
            let values = PostValues::Codes(values.par_iter().map(code).collect());
            OutcomeRaster { name: "dead ground", unit: "", values, classes }
        }
    }
}

/// A class for each post; none, and thus a ramp, for more posts than tints can tell apart.
fn first_classes(lookouts: usize) -> Vec<ValueClass> {
    const TINTS: [[u8; 4]; 8] = [
        [31, 120, 180, 110],
        [51, 160, 44, 110],
        [255, 127, 0, 110],
        [106, 61, 154, 110],
        [227, 26, 28, 110],
        [166, 206, 227, 110],
        [178, 223, 138, 110],
        [253, 191, 111, 110],
    ];
    if lookouts > TINTS.len() {
        return Vec::new();
    }
    let none = ValueClass::new(0.0, "dead ground", DEAD_TINT, Hatching::Single);
    let first = TINTS.into_iter().take(lookouts).enumerate().map(|(index, tint)| {
        ValueClass::new((index + 1) as f32, format!("post {}", index + 1), tint, Hatching::None)
    });
    std::iter::once(none).chain(first).collect()
}

fn table(ground: &Lattice, lookouts: &[Lookout], shares: &[(usize, usize)]) -> OutcomeTable {
    let row = |(lookout, &(seen, of)): (&Lookout, &(usize, usize))| {
        vec![
            PropertyValue::Whole(lookout.number as i64),
            PropertyValue::Number(lookout.ground_m),
            PropertyValue::Number(area_km2(ground, seen)),
            PropertyValue::Number(percent(seen, of)),
        ]
    };
    OutcomeTable {
        title: "Posts".into(),
        columns: vec![
            TableColumn::of_marks("post"),
            TableColumn::new("ground", "m", 0),
            TableColumn::new("in sight", "km²", 2),
            TableColumn::new("share", "%", 1),
        ],
        rows: lookouts.iter().zip(shares).map(row).collect(),
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;
    use crate::arguments::ArgumentValue;
    use crate::observation::lookout::{check_looks, posts_within};
    use crate::observation::test_hills::{at, land, ripples};
    use crate::test_land::{on_pool, run_kind};
    use sandtable_terrain::sight::Curvature;
    use sandtable_terrain::sight::line::{Sight, line_of_sight};

    fn values(outcome: &Outcome) -> Vec<f32> {
        let values = &outcome.raster.as_ref().expect("a raster").values;
        (0..values.len()).map(|index| values.value(index)).collect()
    }

    fn two_posts() -> Vec<(&'static str, ArgumentValue)> {
        vec![
            ("posts", ArgumentValue::Points(vec![at(3.0, 4.0), at(13.3, 9.7)])),
            ("observer_height", ArgumentValue::Number(9.0)),
            ("range", ArgumentValue::Number(120.0)),
        ]
    }

    #[test]
    fn counts_firsts_and_dead_ground_are_those_of_single_lines_of_sight() {
        let land = land(20, ripples);
        let show = |word: &str| {
            let mut arguments = two_posts();
            arguments.push(("show", ArgumentValue::Word(word.into())));
            values(&run_kind("viewsheds", &land, arguments).expect("sound"))
        };
        let (count, first, dead) = (show("count"), show("first"), show("dead"));
        let mut kinds = [0; 4];
        for post in land.ground.posts() {
            let index = land.ground.index(post);
            let target = land.ground.map_position(post);
            let sees = [at(3.0, 4.0), at(13.3, 9.7)].map(|from| {
                let ends = [(from, 9.0), (target, 0.0)].map(|(at, above_m)| SightEnd { at, above_m });
                let sight = line_of_sight(&land.ground, ends[0], ends[1], Curvature::default());
                (from.distance(target) <= 120.0).then_some(sight == Sight::Clear)
            });
            let expected = match sees {
                _ if land.ground.height(post).is_nan() => [f32::NAN; 3],
                [None, None] => [f32::NAN; 3],
                [one, two] => {
                    let (one, two) = (one == Some(true), two == Some(true));
                    let count = f32::from(u8::from(one) + u8::from(two));
                    kinds[usize::from(one) + 2 * usize::from(two)] += 1;
                    [
                        count,
                        if one {
                            1.0
                        } else if two {
                            2.0
                        } else {
                            0.0
                        },
                        f32::from(u8::from(count == 0.0)),
                    ]
                }
            };
            for (value, expected) in [count[index], first[index], dead[index]].into_iter().zip(expected) {
                assert_eq!(value.to_bits(), expected.to_bits(), "{post:?}: {value} for {expected}");
            }
        }
        assert!(kinds.iter().all(|&posts| posts > 4), "{kinds:?}");
    }

    #[test]
    fn a_wall_leaves_half_of_the_land_dead_to_a_post_before_it() {
        let land = land(11, |column, _| if column == 5 { 100.0 } else { 0.0 });
        let outcome =
            run_kind("viewsheds", &land, vec![("posts", ArgumentValue::Points(vec![at(0.0, 5.0)]))])
                .expect("sound");
        let dead = outcome.figures.iter().find(|figure| figure.name == "dead ground").expect("a figure");
        assert_eq!(dead.value, 5.0 / 11.0 * 100.0, "5 columns of 11 lie behind it");
        let area = outcome.figures.iter().find(|figure| figure.unit == "km²").expect("a figure");
        assert_eq!(area.value, 55.0 * 100.0 / 1e6);
    }

    #[test]
    fn any_number_of_threads_gives_the_same_bits() {
        let land = land(20, ripples);
        let run =
            |threads| on_pool(threads, || values(&run_kind("viewsheds", &land, two_posts()).expect("sound")));
        let bits = |values: Vec<f32>| values.into_iter().map(f32::to_bits).collect::<Vec<_>>();
        assert_eq!(bits(run(1)), bits(run(5)));
    }

    #[test]
    fn posts_off_the_land_over_a_hole_or_too_many_are_errors_that_name_the_key() {
        let land = land(20, ripples);
        for place in [at(-1.0, 3.0), at(10.0, 17.5), DVec2::splat(f64::NAN)] {
            let error = run_kind("viewsheds", &land, vec![("posts", ArgumentValue::Points(vec![place]))]);
            assert_eq!(error.err().and_then(|error| error.key()), Some("posts"), "{place}");
        }
        let error = check_looks("posts", 601.0, posts_within(&land.ground, f64::INFINITY) * 41_667.0);
        let error = error.expect_err("1.0016e10 posts of ground");
        assert!(error.to_string().contains("`posts` asks for 601 looks over 16666800 places"), "{error}");
        assert_eq!(check_looks("posts", 599.0, 16_666_800.0), Ok(()));
    }
}
