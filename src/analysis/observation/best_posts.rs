//! The best posts: those that together see the most of a watched area, chosen one after the other.
//!
//! Each place that is tried has a viewshed over the watched posts of the ground, a bit a post. The next post chosen is the
//! place that sees most of what those before it do not (Nemhauser, Wolsey and Fisher 1978); of equal ones the first.

use glam::DVec2;
use rayon::prelude::*;

use crate::arguments::AnalysisArguments;
use crate::center_columns::CenterColumns;
use crate::error::AnalysisError;
use crate::land::Land;
use crate::measures::{area_km2, percent};
use crate::observation::lookout::{
    Lookout, LookoutView, check_looks, count_classes, curvature, posts_within, range_m,
};
use crate::observation::sight_land::SightLand;
use crate::outcome::{Figure, Outcome, OutcomeRaster, OutcomeTable, PostValues, PropertyValue, TableColumn};
use crate::place::height_under;
use crate::ring::AreaRow;
use sandtable_base::limits::memory::check_memory;
use sandtable_geom::rect::Rect;
use sandtable_terrain::lattice::{Lattice, Post};
use sandtable_terrain::post_rect::PostRect;
use sandtable_terrain::sight::line::SightEnd;
use sandtable_terrain::sight::viewshed::{PostVisibility, ViewshedOptions};
use sandtable_terrain::stop_flag::StopFlag;

/// Viewsheds of fewer posts of ground are computed side by side; larger ones share all threads one by one, so that not every
/// thread holds one.
const SIDE_BY_SIDE: f64 = 1e6;

/// Posts of the ground in a word of bits.
const WORD_BITS: usize = 64;

/// The watched posts of the ground: a rectangle, and which of its posts are watched and have data.
struct WatchedGround {
    rect: PostRect,
    /// A bit for each post of the rectangle, each row from a word of its own.
    bits: Vec<u64>,
    words_per_row: usize,
}

/// A post that was chosen.
struct ChosenPost {
    place: Lookout,
    /// Watched posts of the ground that it sees, and those that no post before it does.
    seen: usize,
    gained: usize,
    view: usize,
}

/// The best posts, and how many of them see each watched place.
///
/// # Errors
/// An `area` or a `watch` without ground, a `spacing` that asks for too many places, memory, and
/// [`AnalysisError::Stopped`].
pub(crate) fn best_posts(
    land: &Land,
    arguments: &AnalysisArguments,
    stop: &StopFlag,
) -> Result<Outcome, AnalysisError> {
    let ground = &*land.ground;
    let watched = WatchedGround::new(ground, arguments.points("watch"))?;
    let range_m = range_m(arguments);
    let rect = region_rect(ground, "area", arguments.points("area"))?;
    let reach_m = range_m.min(farthest_m(ground, rect, watched.rect));
    let steps = steps(ground, arguments.number("spacing"));
    let tried = (rect.width().div_ceil(steps[0])) as f64 * rect.height().div_ceil(steps[1]) as f64;
    check_looks("spacing", tried, posts_within(ground, reach_m))?;
    let bytes = tried * watched.bits.len() as f64 * 8.0 + ground.heights().len() as f64 * 8.0;
    check_memory(
        bytes as u64,
        "the viewsheds of all places tried",
        "state a larger `spacing` or a smaller `watch`",
    )?;
    let places = places(ground, arguments, rect, steps)?;
    let sight = SightLand::new(land);
    let view = |place: &Lookout| {
        let options = ViewshedOptions {
            target_above_m: arguments.number("target_height"),
            range_m: reach_m,
            curvature: curvature(arguments),
            ..ViewshedOptions::new(place.end)
        };
        Ok(watched.seen(&sight.look("area", &options, stop)?))
    };
    stop.stretch(0.0..0.95, places.len() * sight.look_units(arguments.number("target_height")));
    let views: Result<Vec<Vec<u64>>, AnalysisError> = if posts_within(ground, reach_m) < SIDE_BY_SIDE {
        places.par_iter().map(view).collect()
    } else {
        places.iter().map(view).collect()
    };
    let views = views?;
    let count = arguments.number("count").round().max(1.0) as usize;
    let chosen = choose(&places, &views, &watched, count);
    let mut outcome = outcome(land, &chosen, watched.count());
    outcome.raster = Some(OutcomeRaster {
        name: "posts in sight",
        unit: "",
        values: PostValues::Numbers(watched.counts(ground, chosen.iter().map(|post| &*views[post.view]))),
        classes: count_classes(chosen.len(), ["dead ground", "seen by"]),
    });
    outcome.figures.push(Figure::new("places tried", places.len() as f64, ""));
    if chosen.len() < count {
        let all = chosen.len();
        outcome
            .notes
            .push(format!("no place tried sees more than the first {all} of {count} posts together"));
    }
    Ok(outcome)
}

/// The posts of the ground in the rectangle around a ring; all where there is no ring.
fn region_rect(ground: &Lattice, key: &'static str, ring: &[DVec2]) -> Result<PostRect, AnalysisError> {
    if ring.is_empty() {
        return Ok(PostRect::all(ground));
    }
    let Rect { min, max } = Rect::around(ring.iter().copied());
    let rect = PostRect::between(ground, ground.grid_from_map(min), ground.grid_from_map(max));
    rect.ok_or_else(|| {
        AnalysisError::argument(key, "holds no post of the ground; draw it larger, and on the land")
    })
}

/// The greatest distance between posts of two rectangles in meters, and a cell more.
fn farthest_m(ground: &Lattice, one: PostRect, other: PostRect) -> f64 {
    let reach = (one.last.grid() - other.first.grid()).max(other.last.grid() - one.first.grid());
    ((reach + 1.0) * ground.cell()).length()
}

/// The distance of places that are tried, in posts east and north.
fn steps(ground: &Lattice, spacing_m: f64) -> [usize; 2] {
    let cell = ground.cell();
    [cell.x, cell.y].map(|cell_m| (spacing_m / cell_m).round().clamp(1.0, 1e9) as usize)
}

/// The places that are tried: posts of the ground in steps, within the area, with data.
fn places(
    ground: &Lattice,
    arguments: &AnalysisArguments,
    rect: PostRect,
    steps: [usize; 2],
) -> Result<Vec<Lookout>, AnalysisError> {
    let area = arguments.points("area");
    let above_m = arguments.number("observer_height");
    // The rest of the last step is shared between both sides.
    let first =
        [rect.width(), rect.height()].into_iter().zip(steps).map(|(posts, step)| (posts - 1) % step / 2);
    let first: Vec<usize> = first.collect();
    let rows = (first[1]..rect.height()).step_by(steps[1]);
    let west = first[0];
    let of_row = |row: usize| {
        let inside = AreaRow::new(area, ground.map_position(rect.first.offset(0, row as u32)).y);
        (west..rect.width()).step_by(steps[0]).filter_map(move |column| {
            let at = ground.map_position(rect.first.offset(column as u32, row as u32));
            let ground_m = inside.holds(at.x).then(|| height_under(ground, "area", at).ok()).flatten()?;
            Some(Lookout { number: 0, end: SightEnd { at, above_m }, ground_m })
        })
    };
    let places: Vec<Lookout> = rows.flat_map(of_row).collect();
    if places.is_empty() {
        let problem =
            "leaves no place with ground in the area to try; state a smaller one, or draw `area` larger";
        return Err(AnalysisError::argument("spacing", problem));
    }
    Ok(places)
}

impl WatchedGround {
    /// The posts of the ground with data within a ring, or all without one.
    fn new(ground: &Lattice, ring: &[DVec2]) -> Result<Self, AnalysisError> {
        let rect = region_rect(ground, "watch", ring)?;
        let words_per_row = rect.width().div_ceil(WORD_BITS);
        let mut bits = vec![0; words_per_row * rect.height()];
        bits.par_chunks_mut(words_per_row).enumerate().for_each(|(row, words)| {
            let inside = AreaRow::new(ring, ground.map_position(rect.first.offset(0, row as u32)).y);
            for column in 0..rect.width() {
                let post = rect.first.offset(column as u32, row as u32);
                let is_watched = !ground.height(post).is_nan() && inside.holds(ground.map_position(post).x);
                words[column / WORD_BITS] |= u64::from(is_watched) << (column % WORD_BITS);
            }
        });
        let watched = Self { rect, bits, words_per_row };
        if watched.count() == 0 {
            return Err(AnalysisError::argument(
                "watch",
                "holds no ground with data; draw it larger, and on the land",
            ));
        }
        Ok(watched)
    }

    /// The number of watched posts of the ground.
    fn count(&self) -> usize {
        count(self.bits.par_iter().copied())
    }

    /// Which of the watched posts a view sees.
    fn seen(&self, look: &LookoutView) -> Vec<u64> {
        let mut seen = vec![0; self.bits.len()];
        let held = look.window.held;
        let from = self.rect.first.column.max(held.first.column);
        let to = self.rect.last.column.min(held.last.column);
        let rows = (self.rect.first.row..)
            .zip(seen.chunks_mut(self.words_per_row).zip(self.bits.chunks(self.words_per_row)));
        for (row, (words, watched)) in rows {
            if from > to || !(held.first.row..=held.last.row).contains(&row) {
                continue;
            }
            let posts = &look.view.posts[held.index(Post { column: from, row })..][..=(to - from) as usize];
            for (bit, &post) in ((from - self.rect.first.column) as usize..).zip(posts) {
                words[bit / WORD_BITS] |= u64::from(post == PostVisibility::Visible) << (bit % WORD_BITS);
            }
            words.iter_mut().zip(watched).for_each(|(seen, watched)| *seen &= watched);
        }
        seen
    }

    /// The number of views that see each post of the ground; no data where it is not watched.
    fn counts<'a>(&self, ground: &Lattice, views: impl Iterator<Item = &'a [u64]>) -> Vec<f32> {
        let views: Vec<&[u64]> = views.collect();
        let columns = ground.columns() as usize;
        let mut values = vec![f32::NAN; ground.heights().len()];
        let rows = values.par_chunks_mut(columns).skip(self.rect.first.row as usize).take(self.rect.height());
        rows.enumerate().for_each(|(row, values)| {
            let values = &mut values[self.rect.first.column as usize..][..self.rect.width()];
            for (column, value) in values.iter_mut().enumerate() {
                let word = row * self.words_per_row + column / WORD_BITS;
                let is_set = |bits: &[u64]| bits[word] >> (column % WORD_BITS) & 1 == 1;
                if is_set(&self.bits) {
                    *value = views.iter().filter(|view| is_set(view)).count() as f32;
                }
            }
        });
        values
    }
}

fn count(words: impl ParallelIterator<Item = u64>) -> usize {
    words.map(|word| word.count_ones() as usize).sum()
}

/// Chooses up to `count` places, each as the one that sees most beside those before it, as long as one sees more.
fn choose(places: &[Lookout], views: &[Vec<u64>], watched: &WatchedGround, count: usize) -> Vec<ChosenPost> {
    let mut chosen: Vec<ChosenPost> = Vec::new();
    let mut left = watched.bits.clone();
    while chosen.len() < count {
        let gain = |view: &Vec<u64>| -> usize {
            view.iter().zip(&left).map(|(seen, left)| (seen & left).count_ones() as usize).sum()
        };
        let gains = views.par_iter().enumerate().map(|(index, view)| (gain(view), std::cmp::Reverse(index)));
        let Some((gained, std::cmp::Reverse(view))) = gains.max() else { break };
        if gained == 0 {
            break;
        }
        left.iter_mut().zip(&views[view]).for_each(|(left, seen)| *left &= !seen);
        let seen = self::count(views[view].par_iter().copied());
        let place = Lookout { number: chosen.len() + 1, ..places[view].clone() };
        chosen.push(ChosenPost { place, seen, gained, view });
    }
    chosen
}

fn outcome(land: &Land, chosen: &[ChosenPost], watched: usize) -> Outcome {
    let centers = CenterColumns::new(land, chosen.iter().map(|post| post.place.end.at).collect());
    let together: Vec<usize> = chosen
        .iter()
        .scan(0, |sum, post| {
            *sum += post.gained;
            Some(*sum)
        })
        .collect();
    let feature = |(post, &together): (&ChosenPost, &usize)| {
        post.place.feature(vec![
            ("share_percent", PropertyValue::Number(percent(post.seen, watched))),
            ("gained_percent", PropertyValue::Number(percent(post.gained, watched))),
            ("together_percent", PropertyValue::Number(percent(together, watched))),
        ])
    };
    let row = |(index, (post, &together)): (usize, (&ChosenPost, &usize))| {
        let mut row = vec![PropertyValue::Whole(post.place.number as i64)];
        row.extend(centers.cells(index));
        row.extend([
            PropertyValue::Number(percent(post.seen, watched)),
            PropertyValue::Number(percent(post.gained, watched)),
            PropertyValue::Number(percent(together, watched)),
        ]);
        row
    };
    let mut columns = vec![TableColumn::of_marks("post")];
    columns.extend(centers.columns());
    columns.extend(["sees", "adds", "together"].map(|name| TableColumn::new(name, "%", 1)));
    let table = OutcomeTable {
        title: "Best posts".into(),
        columns,
        rows: chosen.iter().zip(&together).enumerate().map(row).collect(),
    };
    let last = together.last().copied().unwrap_or(0);
    Outcome {
        features: chosen.iter().zip(&together).map(feature).collect(),
        tables: vec![table],
        figures: vec![
            Figure::new("seen together", percent(last, watched), "%"),
            Figure::new("watched", area_km2(&land.ground, watched), "km²"),
        ],
        ..Outcome::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arguments::ArgumentValue;
    use crate::observation::test_hills::{at, land, ripples};
    use crate::test_land::{on_pool, run_kind};
    use sandtable_terrain::sight::Curvature;
    use sandtable_terrain::sight::line::{Sight, line_of_sight};

    fn ring(low: f64, high: f64) -> ArgumentValue {
        ArgumentValue::Points(vec![at(low, low), at(high, low), at(high, high), at(low, high)])
    }

    fn number(name: &'static str, value: f64) -> (&'static str, ArgumentValue) {
        (name, ArgumentValue::Number(value))
    }

    /// Which of the watched places each place tried sees, by a line of sight each.
    fn sets(land: &Land, tried: &[Post], watched: &[Post]) -> Vec<Vec<bool>> {
        let end = |post: Post, above_m| SightEnd { at: land.ground.map_position(post), above_m };
        let sees = |from: Post, to: Post| {
            let ends = [end(from, 1.7), end(to, 0.0)];
            ends[0].at.distance(ends[1].at) <= 150.0
                && line_of_sight(&land.ground, ends[0], ends[1], Curvature::default()) == Sight::Clear
        };
        tried.iter().map(|&from| watched.iter().map(|&to| sees(from, to)).collect()).collect()
    }

    fn union(sets: &[&Vec<bool>]) -> usize {
        (0..sets[0].len()).filter(|&index| sets.iter().any(|set| set[index])).count()
    }

    #[test]
    fn the_greedy_choice_is_that_of_all_lines_of_sight() {
        let land = land(20, ripples);
        let arguments = || {
            let areas = vec![("area", ring(0.5, 8.5)), ("watch", ring(3.5, 18.5))];
            let numbers = [number("count", 2.0), number("spacing", 20.0), number("range", 150.0)];
            areas.into_iter().chain(numbers).collect::<Vec<_>>()
        };
        let run = || run_kind("best-posts", &land, arguments()).expect("sound");
        let outcome = run();
        // Posts 1 to 8 in steps of two, the rest of a step shared: 1, 3, 5, 7.
        let tried: Vec<Post> =
            (0..16).map(|index| Post { column: 1 + index % 4 * 2, row: 1 + index / 4 * 2 }).collect();
        let is_watched = |post: &Post| post.column.min(post.row) >= 4 && post.column.max(post.row) <= 18;
        let watched: Vec<Post> = land
            .ground
            .posts()
            .filter(|post| is_watched(post) && !land.ground.height(*post).is_nan())
            .collect();
        let sets = sets(&land, &tried, &watched);
        let best = |others: &[usize]| {
            let gain = |index: usize| {
                union(&others.iter().copied().chain([index]).map(|index| &sets[index]).collect::<Vec<_>>())
            };
            (0..16).max_by_key(|&index| (gain(index), std::cmp::Reverse(index))).expect("places")
        };
        let first = best(&[]);
        let second = best(&[first]);
        let together = union(&[&sets[first], &sets[second]]);
        for (row, chosen) in outcome.tables[0].rows.iter().zip([first, second]) {
            let at = land.ground.map_position(tried[chosen]);
            assert_eq!(row[1..3], [PropertyValue::Number(at.x), PropertyValue::Number(at.y)]);
        }
        assert_eq!(outcome.figures[0].value, percent(together, watched.len()));
        let pairs = (0..16).flat_map(|one| (0..one).map(move |other| (one, other)));
        let best_pair = pairs.map(|(one, other)| union(&[&sets[one], &sets[other]])).max().expect("pairs");
        assert!(
            together as f64 >= 0.632 * best_pair as f64 && together < watched.len(),
            "{together} of {best_pair}"
        );
        let values = &outcome.raster.as_ref().expect("a raster").values;
        for post in land.ground.posts() {
            let place = watched.iter().position(|&watched| watched == post);
            let expected = place
                .map(|place| [first, second].iter().filter(|&&chosen| sets[chosen][place]).count() as f32);
            let value = values.value(land.ground.index(post));
            assert_eq!(value.to_bits(), expected.unwrap_or(f32::NAN).to_bits(), "{post:?}");
        }
        let text = |threads| on_pool(threads, || format!("{:?}", run()));
        assert_eq!(text(1), text(4));
    }

    #[test]
    fn one_post_on_level_ground_sees_all_and_the_first_of_equal_places_is_chosen() {
        let land = land(70, |_, _| 0.0);
        let outcome = run_kind("best-posts", &land, vec![number("spacing", 300.0)]).expect("sound");
        assert_eq!(outcome.tables[0].rows.len(), 1);
        assert_eq!(outcome.figures[0].value, 100.0);
        // 69 steps of 10 m leave 9 beside two of 30: the first place is 4 in.
        assert_eq!(outcome.features[0].shape, crate::outcome::OutcomeShape::Point(at(4.0, 4.0)));
        assert!(outcome.notes[1].contains("first 1 of 3 posts"), "{:?}", outcome.notes);
    }

    #[test]
    fn areas_without_ground_and_too_many_places_are_errors_that_name_the_key() {
        let land = land(20, ripples);
        let key = |arguments| run_kind("best-posts", &land, arguments).err().and_then(|error| error.key());
        assert_eq!(key(vec![("area", ring(30.0, 40.0))]), Some("area"));
        assert_eq!(key(vec![("watch", ring(30.0, 31.0))]), Some("watch"));
        let in_hole =
            ArgumentValue::Points(vec![at(9.5, 16.5), at(10.5, 16.5), at(10.5, 17.5), at(9.5, 17.5)]);
        assert_eq!(key(vec![("watch", in_hole.clone())]), Some("watch"));
        assert_eq!(key(vec![("area", in_hole)]), Some("spacing"));
        let wide = crate::observation::test_hills::land(400, |_, _| 0.0);
        let error = run_kind("best-posts", &wide, vec![number("spacing", 1.0)]).expect_err("160 000 places");
        assert_eq!(error.key(), Some("spacing"), "{error}");
    }
}
