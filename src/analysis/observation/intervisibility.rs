//! Which posts see each other, as a graph: its links, and the groups of posts that links connect.

use rayon::prelude::*;

use crate::arguments::AnalysisArguments;
use crate::error::AnalysisError;
use crate::land::Land;
use crate::observation::lookout::{Lookout, curvature, range_m};
use crate::observation::sight_land::SightLand;
use crate::outcome::{
    FeatureRole, Figure, Outcome, OutcomeFeature, OutcomeShape, OutcomeTable, PropertyValue, TableColumn,
};
use sandtable_base::disjoint_sets::root;
use sandtable_geom::azimuth::azimuth_deg;
use sandtable_terrain::sight::Curvature;
use sandtable_terrain::sight::ground::SightGround;
use sandtable_terrain::sight::rise::Raised;
use sandtable_terrain::stop_flag::StopFlag;

/// The most posts of a graph: half a million pairs, some seconds and some 200 MB of features.
const MOST_POSTS: usize = 1000;

/// A pair of posts within range of each other, by their places in the list.
struct PostPair {
    from: usize,
    to: usize,
    distance_m: f64,
    /// The least height of the line over the ground between, meters: negative where the ground blocks it, and both must
    /// rise by so much; infinite where no edge of the ground lies between.
    clearance_m: f64,
}

impl PostPair {
    fn is_seen(&self) -> bool {
        self.clearance_m >= 0.0
    }
}

/// The links between posts within range, in the order of the posts, and the groups that links in sight connect.
///
/// # Errors
/// `posts` off the ground or too many, and [`AnalysisError::Stopped`].
pub(crate) fn intervisibility(
    land: &Land,
    arguments: &AnalysisArguments,
    stop: &StopFlag,
) -> Result<Outcome, AnalysisError> {
    let posts = arguments.points("posts").len();
    if posts > MOST_POSTS {
        let problem = format!("has {posts} posts; the graph of at most {MOST_POSTS} is drawn");
        return Err(AnalysisError::argument("posts", problem));
    }
    let lookouts = Lookout::all(land, arguments, "posts", arguments.number("height"))?;
    let pairs = pairs(land, &lookouts, range_m(arguments), curvature(arguments), stop)?;
    let groups = groups(lookouts.len(), pairs.iter().filter(|pair| pair.is_seen()));
    let seen = pairs.iter().filter(|pair| pair.is_seen()).count();
    let mut links = vec![0_i64; lookouts.len()];
    for pair in pairs.iter().filter(|pair| pair.is_seen()) {
        links[pair.from] += 1;
        links[pair.to] += 1;
    }
    let post = |(index, lookout): (usize, &Lookout)| {
        let links = ("links", PropertyValue::Whole(links[index]));
        lookout.feature(vec![links, ("group", PropertyValue::Whole(groups[index] as i64))])
    };
    let lines = pairs.iter().map(|pair| link(&lookouts, pair));
    let figure = |name: &str, value: usize| Figure::new(name, value as f64, "");
    Ok(Outcome {
        features: lines.chain(lookouts.iter().enumerate().map(post)).collect(),
        tables: vec![table(&lookouts, &pairs)],
        figures: vec![
            figure("pairs in sight", seen),
            figure("pairs within range", pairs.len()),
            figure("groups", groups.iter().copied().max().unwrap_or(0)),
        ],
        ..Outcome::default()
    })
}

/// The pairs of posts within range.
fn pairs(
    land: &Land,
    lookouts: &[Lookout],
    range_m: f64,
    curvature: Curvature,
    stop: &StopFlag,
) -> Result<Vec<PostPair>, AnalysisError> {
    let sight = SightLand::new(land).cleared_around(lookouts.iter().map(|lookout| lookout.end.at));
    let ground = SightGround::new(sight.tops().clone());
    let pair = |from: usize, to: usize| {
        let ends = [lookouts[from].end, lookouts[to].end];
        let distance_m = ends[0].at.distance(ends[1].at);
        if distance_m > range_m || stop.is_stopped() {
            return None;
        }
        // Both ends have ground, so there is an answer; `None` in it is nothing to clear.
        let rise = ground.required_rise(ends[0], ends[1], curvature, Raised::Both).ok()?;
        let clearance_m = rise.map_or(f64::INFINITY, |rise| 0.0 - rise.rise_m);
        Some(PostPair { from, to, distance_m, clearance_m })
    };
    let from = (0..lookouts.len()).into_par_iter();
    let pairs = from.flat_map_iter(|from| (from + 1..lookouts.len()).filter_map(move |to| pair(from, to)));
    let pairs = pairs.collect();
    if stop.is_stopped() { Err(AnalysisError::Stopped) } else { Ok(pairs) }
}

/// The group of each post, from 1 in the order of their first posts.
fn groups<'a>(posts: usize, links: impl Iterator<Item = &'a PostPair>) -> Vec<usize> {
    let mut parents: Vec<usize> = (0..posts).collect();
    for link in links {
        let roots = [link.from, link.to].map(|post| root(&mut parents, post));
        // The lesser one stays, so that a group's root is its first post.
        parents[roots[0].max(roots[1])] = roots[0].min(roots[1]);
    }
    let mut numbers = vec![0; posts];
    let mut last = 0;
    for post in 0..posts {
        let root = root(&mut parents, post);
        if root == post {
            last += 1;
            numbers[post] = last;
        }
        numbers[post] = numbers[root];
    }
    numbers
}

/// A clearance as a property: text where nothing lies between.
fn clearance(pair: &PostPair) -> PropertyValue {
    if pair.clearance_m.is_finite() {
        PropertyValue::Number(pair.clearance_m)
    } else {
        PropertyValue::Text("no ground between".into())
    }
}

fn link(lookouts: &[Lookout], pair: &PostPair) -> OutcomeFeature {
    let [from, to] = [pair.from, pair.to].map(|index| &lookouts[index]);
    OutcomeFeature {
        shape: OutcomeShape::Line(vec![from.end.at, to.end.at]),
        name: String::new(),
        role: FeatureRole::Link,
        properties: vec![
            ("from", PropertyValue::Whole(from.number as i64)),
            ("to", PropertyValue::Whole(to.number as i64)),
            ("seen", PropertyValue::Truth(pair.is_seen())),
            ("distance_m", PropertyValue::Number(pair.distance_m)),
            ("clearance_m", clearance(pair)),
        ],
    }
}

fn table(lookouts: &[Lookout], pairs: &[PostPair]) -> OutcomeTable {
    let row = |pair: &PostPair| {
        let [from, to] = [pair.from, pair.to].map(|index| &lookouts[index]);
        let azimuth_deg = azimuth_deg(to.end.at - from.end.at);
        vec![
            PropertyValue::Whole(from.number as i64),
            PropertyValue::Whole(to.number as i64),
            PropertyValue::Number(pair.distance_m / 1000.0),
            PropertyValue::Number(azimuth_deg),
            PropertyValue::Truth(pair.is_seen()),
            clearance(pair),
        ]
    };
    OutcomeTable {
        title: "Links".into(),
        columns: vec![
            TableColumn::of_marks("from"),
            TableColumn::of_marks("to"),
            TableColumn::new("distance", "km", 2),
            TableColumn::new("direction", "°", 0),
            TableColumn::new("in sight", "", 0),
            TableColumn::new("clearance", "m", 1),
        ],
        rows: pairs.iter().map(row).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arguments::ArgumentValue;
    use crate::observation::test_hills::{at, land, ripples};
    use crate::test_land::{on_pool, run_kind};
    use sandtable_terrain::sight::line::{Sight, line_of_sight};

    fn property<'a>(feature: &'a OutcomeFeature, name: &str) -> &'a PropertyValue {
        &feature.properties.iter().find(|(property, _)| *property == name).expect(name).1
    }

    fn points(places: &[(f64, f64)]) -> (&'static str, ArgumentValue) {
        ("posts", ArgumentValue::Points(places.iter().map(|&(column, row)| at(column, row)).collect()))
    }

    #[test]
    fn a_wall_parts_four_posts_into_two_groups() {
        let land = land(11, |column, _| if column == 5 { 100.0 } else { 0.0 });
        let posts = points(&[(1.0, 1.0), (9.0, 1.0), (2.0, 6.0), (8.0, 8.0)]);
        let outcome = run_kind("intervisibility", &land, vec![posts]).expect("sound");
        let links = outcome.features.iter().filter(|feature| feature.role == FeatureRole::Link);
        let seen: Vec<bool> =
            links.map(|link| *property(link, "seen") == PropertyValue::Truth(true)).collect();
        assert_eq!(seen, [false, true, false, false, true, false], "1-2, 1-3, 1-4, 2-3, 2-4, 3-4");
        let posts = outcome.features.iter().filter(|feature| feature.role == FeatureRole::Post);
        let groups: Vec<_> = posts.map(|post| property(post, "group").clone()).collect();
        assert_eq!(groups, [1, 2, 1, 2].map(PropertyValue::Whole));
        assert_eq!(outcome.figures.iter().map(|figure| figure.value).collect::<Vec<_>>(), [2.0, 6.0, 2.0]);
        let PropertyValue::Number(clearance) = outcome.tables[0].rows[0][5] else { panic!("a number") };
        // The wall's top stands 100 m over the level line, whose eyes are 1.7 m up; the Earth adds tenths of a millimeter.
        assert!((clearance + 98.3).abs() < 1e-3, "{clearance}");
        assert_eq!(outcome.tables[0].rows[0][3], PropertyValue::Number(90.0));
    }

    #[test]
    fn links_are_in_sight_where_the_line_of_sight_is_clear_and_only_within_range() {
        let land = land(20, ripples);
        let places: Vec<(f64, f64)> = (0..12)
            .map(|index| (f64::from(index * 7 % 20) * 0.93, f64::from(index * 5 % 15) + 0.3))
            .collect();
        let range = ("range", ArgumentValue::Number(110.0));
        let height = ("height", ArgumentValue::Number(3.0));
        let run = || run_kind("intervisibility", &land, vec![points(&places), range.clone(), height.clone()]);
        let outcome = run().expect("sound");
        let mut counts = [0; 2];
        for link in outcome.features.iter().filter(|feature| feature.role == FeatureRole::Link) {
            let OutcomeShape::Line(ends) = &link.shape else { panic!("a line") };
            assert!(ends[0].distance(ends[1]) <= 110.0);
            let ends =
                [ends[0], ends[1]].map(|at| sandtable_terrain::sight::line::SightEnd { at, above_m: 3.0 });
            let sight = line_of_sight(&land.ground, ends[0], ends[1], Curvature::default());
            assert_eq!(*property(link, "seen"), PropertyValue::Truth(sight == Sight::Clear), "{link:?}");
            counts[usize::from(sight == Sight::Clear)] += 1;
        }
        let near = (0..12).flat_map(|from| (from + 1..12).map(move |to| (from, to)));
        let places = &places;
        let near = near.filter(|&(from, to)| {
            let [from, to] = [places[from], places[to]].map(|(column, row)| at(column, row));
            from.distance(to) <= 110.0
        });
        assert_eq!(counts[0] + counts[1], near.count(), "a link for each pair within range");
        assert!(counts[0] > 5 && counts[1] > 5, "{counts:?}");
        let text = |threads| on_pool(threads, || format!("{:?}", run().expect("sound")));
        assert_eq!(text(1), text(4));
    }

    #[test]
    fn more_posts_than_a_graph_can_show_are_an_error_that_names_the_key() {
        let land = land(11, |_, _| 0.0);
        let posts = points(&vec![(1.0, 1.0); 1001]);
        let error = run_kind("intervisibility", &land, vec![posts]).expect_err("too many");
        assert_eq!(error.to_string(), "`posts` has 1001 posts; the graph of at most 1000 is drawn");
        let here = points(&[(1.0, 1.0), (1.0, 1.0)]);
        let outcome = run_kind("intervisibility", &land, vec![here]).expect("two posts at one place");
        assert_eq!(outcome.figures[0].value, 1.0, "they see each other");
    }
}
