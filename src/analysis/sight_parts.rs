//! Kinds of sight in parts: the values of some posts, from the ground between them and the places that look at them.
//!
//! ```text
//!  the land                          one part
//!  ┌─────┬─────┬─────┐               its posts: values, and a tally of what each place sees of them
//!  │     │     │     │               its ground: that of all lines of sight from places in range to its posts
//!  ├─────┼─────┼─────┤
//!  │     │ o   │part │               all tallies ──► figures, tables, features: those of the whole
//!  └─────┴─────┴─────┘
//! ```
//!
//! A line of sight is the same on any ground that holds it, so that the values of a part have the bits of the whole; a part
//! that lies beyond the range of all places needs no ground at all.

use glam::DVec2;

use crate::arguments::AnalysisArguments;
use crate::error::AnalysisError;
use crate::land::Land;
use crate::observation::lookout::LookWindow;
use crate::observation::{fields_of_fire, masking, viewsheds};
use crate::outcome::{Outcome, OutcomeRaster};
use crate::place::height_under;
use crate::tally::FigureTally;
use sandtable_catalog::kind::AnalysisReach;
use sandtable_terrain::lattice::Lattice;
use sandtable_terrain::post_rect::PostRect;
use sandtable_terrain::stop_flag::StopFlag;

/// What a kind of sight computes.
pub(crate) struct SightKind {
    /// The values of posts of ground that holds what they need.
    pub values: fn(&Land, &AnalysisArguments, PostRect, &StopFlag) -> Result<SightValues, AnalysisError>,
    /// The rest, from the heights of the ground under the places, and the tally of all posts of ground like this one.
    pub summary: fn(&Lattice, &AnalysisArguments, &[f64], &FigureTally) -> Result<Outcome, AnalysisError>,
}

/// What a kind of sight gives of some posts.
pub struct SightValues {
    /// The values.
    pub raster: OutcomeRaster,
    /// What places see of the posts.
    pub tally: FigureTally,
}

/// The parameters of a kind of sight.
#[derive(Clone, Copy)]
struct SightKeys {
    places: &'static str,
    range: &'static str,
    /// Whether all ground within the range decides, instead of that between.
    needs_all: bool,
}

/// Whether the kind of these arguments is one of sight, whose values depend on the ground between places and posts.
pub fn is_of_sight(arguments: &AnalysisArguments) -> bool {
    keys(arguments).is_some()
}

/// The positions of the places that look, in map coordinates of the land; none for other kinds.
pub fn sight_places(arguments: &AnalysisArguments) -> &[DVec2] {
    keys(arguments).map_or(&[], |keys| arguments.points(keys.places))
}

/// The height of the ground under a place that looks, meters.
///
/// # Errors
/// [`AnalysisError::Place`] where there is none.
pub fn place_height(
    ground: &Lattice,
    arguments: &AnalysisArguments,
    at: DVec2,
) -> Result<f64, AnalysisError> {
    height_under(ground, keys(arguments).map_or("", |keys| keys.places), at)
}

/// The posts whose heights the values of `posts` need, all among `land` and both counted in `ground`; `None` where no place sees
/// so far.
pub fn needed_for_sight(
    ground: &Lattice,
    arguments: &AnalysisArguments,
    (land, posts): (PostRect, PostRect),
) -> Option<PostRect> {
    let needed =
        |&at: &DVec2| window(ground, arguments, at, posts)?.held.grown((1, 1), ground).intersection(land);
    let windows = sight_places(arguments).iter().filter_map(needed);
    windows.reduce(|all, window| all.with(window.first).with(window.last))
}

/// About how many posts are looked at for the values of `posts`.
pub fn sight_work(ground: &Lattice, arguments: &AnalysisArguments, posts: PostRect) -> f64 {
    let windows = sight_places(arguments).iter().filter_map(|&at| window(ground, arguments, at, posts));
    windows.map(|window| window.posts()).sum()
}

/// The values of `posts` of land that holds the ground of [`needed_for_sight`], to the bits of the whole.
///
/// # Errors
/// As of the kind on the whole land.
///
/// # Panics
/// Where the kind is none of sight.
pub fn sight_values(
    land: &Land,
    arguments: &AnalysisArguments,
    posts: PostRect,
    stop: &StopFlag,
) -> Result<SightValues, AnalysisError> {
    (sight_kind(arguments).values)(land, arguments, posts, stop)
}

/// What a kind of sight gives besides its raster: from the heights of the ground under its places, and the tally of all posts of
/// ground with cells like those of `ground`.
///
/// # Errors
/// Arguments that do not fit together.
///
/// # Panics
/// Where the kind is none of sight.
pub fn sight_summary(
    ground: &Lattice,
    arguments: &AnalysisArguments,
    heights_m: &[f64],
    tally: &FigureTally,
) -> Result<Outcome, AnalysisError> {
    let outcome = (sight_kind(arguments).summary)(ground, arguments, heights_m, tally)?;
    Ok(Outcome { tally: tally.clone(), ..outcome })
}

/// A kind of sight on all of the land.
///
/// # Errors
/// As of the kind.
///
/// # Panics
/// Where the kind is none of sight.
pub(crate) fn run_sight(
    land: &Land,
    arguments: &AnalysisArguments,
    stop: &StopFlag,
) -> Result<Outcome, AnalysisError> {
    let ground = &*land.ground;
    let places = sight_places(arguments).iter();
    let heights: Result<Vec<f64>, _> = places.map(|&at| place_height(ground, arguments, at)).collect();
    let heights = heights?;
    let SightValues { raster, tally } = sight_values(land, arguments, PostRect::all(ground), stop)?;
    let summary = sight_summary(ground, arguments, &heights, &tally)?;
    Ok(Outcome { raster: Some(raster), ..summary })
}

/// The windows of the places that see some of `posts`, with their indices.
pub(crate) fn windows(
    ground: &Lattice,
    arguments: &AnalysisArguments,
    posts: PostRect,
) -> Vec<(usize, LookWindow)> {
    let places = sight_places(arguments).iter().enumerate();
    places.filter_map(|(index, &at)| Some((index, window(ground, arguments, at, posts)?))).collect()
}

fn window(ground: &Lattice, arguments: &AnalysisArguments, at: DVec2, posts: PostRect) -> Option<LookWindow> {
    let SightKeys { range, needs_all, .. } = keys(arguments)?;
    let range_m = arguments.number_if(range).unwrap_or(f64::INFINITY);
    match needs_all {
        true => LookWindow::within(ground, at, range_m, posts),
        false => LookWindow::toward(ground, at, range_m, posts),
    }
}

fn keys(arguments: &AnalysisArguments) -> Option<SightKeys> {
    match arguments.kind().reach {
        AnalysisReach::Between { places, range } => Some(SightKeys { places, range, needs_all: false }),
        AnalysisReach::Around { places, range } => Some(SightKeys { places, range, needs_all: true }),
        _ => None,
    }
}

fn sight_kind(arguments: &AnalysisArguments) -> &'static SightKind {
    match arguments.kind().name {
        "viewsheds" => &viewsheds::SIGHT,
        "fields-of-fire" => &fields_of_fire::SIGHT,
        "masking" => &masking::SIGHT,
        name => panic!("{name} is no kind of sight"),
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::arguments::ArgumentValue;
    use crate::observation::test_hills::{at, land, ripples};
    use sandtable_catalog::kinds;
    use sandtable_terrain::lattice::Post;

    const SIZE: u32 = 40;

    /// Three places of each kind of sight, one of them off every post, with these ranges in meters; `None` for no range.
    fn of_kinds(range_m: Option<f64>) -> impl Iterator<Item = AnalysisArguments> {
        let places = ArgumentValue::Points(vec![at(3.0, 4.0), at(30.3, 9.7), at(17.5, 33.2)]);
        kinds().filter_map(move |kind| {
            let keys = keys(&AnalysisArguments::new(kind))?;
            let arguments = AnalysisArguments::new(kind).with(keys.places, places.clone());
            match range_m {
                Some(range_m) => Some(arguments.with(keys.range, ArgumentValue::Number(range_m))),
                None => (!keys.needs_all && keys.range == "range").then_some(arguments),
            }
        })
    }

    /// Runs a kind in tiles on ground that holds what each needs, and compares everything with the whole.
    fn check(land: &Land, arguments: &AnalysisArguments, tile: u32) {
        let stop = StopFlag::default();
        let name = arguments.kind().name;
        let whole = crate::run::run(land, arguments, &stop).expect(name);
        let all = PostRect::all(&land.ground);
        let (mut tallies, mut empty) = (Vec::new(), 0);
        for first in (0..SIZE)
            .step_by(tile as usize)
            .flat_map(|row| (0..SIZE).step_by(tile as usize).map(move |column| Post { column, row }))
        {
            let last = Post { column: first.column + tile - 1, row: first.row + tile - 1 };
            let posts = PostRect {
                first,
                last: Post { column: last.column.min(SIZE - 1), row: last.row.min(SIZE - 1) },
            };
            let needed = needed_for_sight(&land.ground, arguments, (all, posts));
            empty += usize::from(needed.is_none());
            // What stands on the ground is known of all of the land.
            let part_land = match &land.obstacles_m {
                Some(_) => land.clone(),
                None => Land {
                    ground: Arc::new(land.ground.holding_only(needed.unwrap_or(posts))),
                    ..land.clone()
                },
            };
            let part = sight_values(&part_land, arguments, posts, &stop).expect(name);
            let raster = whole.raster.as_ref().expect(name);
            for post in posts.posts() {
                let (found, wanted) = (
                    part.raster.values.value(posts.index(post)),
                    raster.values.value(land.ground.index(post)),
                );
                assert_eq!(found.to_bits(), wanted.to_bits(), "{name} at {post:?}");
            }
            tallies.push(part.tally);
        }
        let range = keys(arguments).and_then(|keys| arguments.number_if(keys.range));
        let are_some_out_of_range = tile < 10 && range.is_some_and(|range_m| range_m < 200.0);
        assert_eq!(empty > 0, are_some_out_of_range, "{name}: {empty} parts");
        let tally =
            tallies.into_iter().reduce(|sum: FigureTally, tally| sum.plus(&tally).expect("of one kind"));
        let tally = tally.expect("parts");
        assert_eq!(tally, whole.tally, "{name}");
        let heights: Result<Vec<f64>, _> =
            sight_places(arguments).iter().map(|&at| place_height(&land.ground, arguments, at)).collect();
        let summary = sight_summary(&land.ground, arguments, &heights.expect(name), &tally).expect(name);
        assert_eq!(summary.figures, whole.figures, "{name}");
        assert_eq!(format!("{:?}", summary.tables), format!("{:?}", whole.tables), "{name}");
        assert_eq!(format!("{:?}", summary.features), format!("{:?}", whole.features), "{name}");
    }

    #[test]
    fn parts_have_the_bits_of_the_whole_and_their_tallies_its_figures() {
        let mut tried = 0;
        for arguments in of_kinds(Some(130.0)).chain(of_kinds(Some(2000.0))).chain(of_kinds(None)) {
            for tile in [7, 20] {
                let bare = land(SIZE, ripples);
                let stands = |index: u32| if index % 11 < 3 { (index % 7) as f32 } else { 0.0 };
                let wooded =
                    Land { obstacles_m: Some((0..SIZE * SIZE).map(stands).collect()), ..bare.clone() };
                check(&bare, &arguments, tile);
                check(&wooded, &arguments, tile);
                tried += 1;
            }
        }
        assert_eq!(tried, 14);
    }
}
