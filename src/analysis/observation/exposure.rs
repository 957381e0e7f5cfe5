//! The exposure of a route: its stretches in sight of posts, with lengths and times.
//!
//! Places along the route are looked at from every post; where two neighbors differ in whether any post sees them, halving
//! finds the change between them.

use glam::DVec2;
use rayon::prelude::*;

use crate::arguments::AnalysisArguments;
use crate::error::AnalysisError;
use crate::land::Land;
use crate::observation::lookout::{Lookout, check_work, curvature, range_m};
use crate::observation::sight_land::SightLand;
use crate::outcome::{
    FeatureRole, Figure, Outcome, OutcomeFeature, OutcomeShape, OutcomeTable, PropertyValue, TableColumn,
};
use crate::place::height_under;
use sandtable_base::limits::memory::check_memory;
use sandtable_terrain::lattice::Lattice;
use sandtable_terrain::sight::Curvature;
use sandtable_terrain::sight::ground::SightGround;
use sandtable_terrain::sight::line::Sight;
use sandtable_terrain::stop_flag::StopFlag;

/// Lines of sight that an analysis may compute: some minutes on two cores.
const MOST_LINES: f64 = 2e7;

/// A place of the route, with what is known of it.
const BYTES_PER_PLACE: f64 = 64.0;

/// Halvings between two places that differ: to a millionth of their distance.
const HALVINGS: u32 = 20;

/// Whether a place of the route is in sight of any post.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum RouteSight {
    Seen,
    Hidden,
    /// There is no elevation.
    Unknown,
}

impl RouteSight {
    const fn noun(self) -> &'static str {
        match self {
            Self::Seen => "in sight",
            Self::Hidden => "hidden",
            Self::Unknown => "no elevation",
        }
    }
}

/// A place of the route that was looked at.
#[derive(Clone, Copy)]
struct RoutePlace {
    along_m: f64,
    at: DVec2,
    is_vertex: bool,
}

/// A part of the route that is alike.
struct RouteStretch {
    sight: RouteSight,
    from_m: f64,
    to_m: f64,
    line: Vec<DVec2>,
    /// Which posts see some place of it that was looked at, a bit for each post.
    posts: Vec<bool>,
}

/// What looks at the route.
struct RouteWatch<'a> {
    /// The ground below all that stands on it.
    ground: &'a Lattice,
    sight: SightLand,
    tops: SightGround,
    lookouts: &'a [Lookout],
    above_m: f64,
    range_m: f64,
    curvature: Curvature,
}

impl RouteWatch<'_> {
    fn line(&self, lookout: &Lookout, at: DVec2) -> RouteSight {
        if lookout.end.at.distance(at) > self.range_m {
            return RouteSight::Hidden;
        }
        let mut found = RouteSight::Hidden;
        for target in self.sight.target(at, self.above_m) {
            match self.tops.line_of_sight(lookout.end, target, self.curvature) {
                Sight::Clear => return RouteSight::Seen,
                Sight::Blocked(_) => {}
                Sight::NoGround(_) => found = RouteSight::Unknown,
            }
        }
        found
    }

    /// Whether any post sees a place.
    fn sight(&self, at: DVec2) -> RouteSight {
        if height_under(self.ground, "route", at).is_err() {
            return RouteSight::Unknown;
        }
        let is_seen = self.lookouts.iter().any(|lookout| self.line(lookout, at) == RouteSight::Seen);
        if is_seen { RouteSight::Seen } else { RouteSight::Hidden }
    }

    /// Where between two places that differ the sight of the first ends.
    fn change(&self, mut from: RoutePlace, mut to: RoutePlace, sight: RouteSight) -> RoutePlace {
        for _ in 0..HALVINGS {
            let along_m = 0.5 * (from.along_m + to.along_m);
            let middle = RoutePlace { along_m, at: from.at.lerp(to.at, 0.5), is_vertex: false };
            if self.sight(middle.at) == sight {
                from = middle;
            } else {
                to = middle;
            }
        }
        RoutePlace { is_vertex: false, ..to }
    }
}

/// The stretches of a route in sight of any post, and hidden from all.
///
/// # Errors
/// `route` off the land or without length, `posts` off the ground, too many places, and [`AnalysisError::Stopped`].
pub(crate) fn exposure(
    land: &Land,
    arguments: &AnalysisArguments,
    stop: &StopFlag,
) -> Result<Outcome, AnalysisError> {
    let ground = &*land.ground;
    let route = arguments.points("route");
    let extent = ground.map_extent();
    if let Some(&at) = route.iter().find(|&&at| !extent.contains(at)) {
        return Err(AnalysisError::Place { key: "route", at, problem: "lies off the land" });
    }
    let length_m: f64 = route.windows(2).map(|pair| pair[0].distance(pair[1])).sum();
    if length_m <= 0.0 {
        return Err(AnalysisError::argument("route", "has no length; state two places that differ"));
    }
    let step_m = arguments.number_if("step").unwrap_or(0.5 * ground.cell().min_element());
    let posts = arguments.points("posts").len();
    let expected = length_m / step_m + route.len() as f64;
    check_work("step", posts as f64, expected, MOST_LINES)?;
    check_memory((expected * BYTES_PER_PLACE) as u64, "the places of the route", "state a larger `step`")?;
    let lookouts = Lookout::all(land, arguments, "posts", arguments.number("observer_height"))?;
    let sight = SightLand::new(land).cleared_around(lookouts.iter().map(|lookout| lookout.end.at));
    let watch = RouteWatch {
        ground,
        tops: SightGround::new(sight.tops().clone()),
        sight,
        lookouts: &lookouts,
        above_m: arguments.number("target_height"),
        range_m: range_m(arguments),
        curvature: curvature(arguments),
    };
    let places = places(route, step_m);
    // A row of answers for each place, a post after the other.
    let seen: Vec<bool> = places
        .par_iter()
        .flat_map_iter(|place| {
            let see = |lookout| !stop.is_stopped() && watch.line(lookout, place.at) == RouteSight::Seen;
            lookouts.iter().map(see)
        })
        .collect();
    if stop.is_stopped() {
        return Err(AnalysisError::Stopped);
    }
    let stretches = stretches(&watch, &places, &seen);
    Ok(outcome(&lookouts, &stretches, &seen, (length_m, arguments.number("speed") / 3.6)))
}

/// The vertices of the route and equal steps between them, none longer than `step_m`.
fn places(route: &[DVec2], step_m: f64) -> Vec<RoutePlace> {
    let mut places = Vec::new();
    let mut start_m = 0.0;
    for pair in route.windows(2) {
        let length_m = pair[0].distance(pair[1]);
        if length_m <= 0.0 {
            continue;
        }
        let steps = (length_m / step_m).ceil().max(1.0);
        places.extend((0..steps as u64).map(|step| {
            let part = step as f64 / steps;
            let at = pair[0].lerp(pair[1], part);
            RoutePlace { along_m: start_m + length_m * part, at, is_vertex: step == 0 }
        }));
        start_m += length_m;
    }
    places.extend(route.last().map(|&at| RoutePlace { along_m: start_m, at, is_vertex: true }));
    places
}

fn stretches(watch: &RouteWatch<'_>, places: &[RoutePlace], seen: &[bool]) -> Vec<RouteStretch> {
    let posts = watch.lookouts.len();
    let rows = seen.chunks(posts);
    let sights: Vec<RouteSight> = places
        .par_iter()
        .zip(rows.collect::<Vec<_>>())
        .map(|(place, row)| match row.contains(&true) {
            true => RouteSight::Seen,
            false if height_under(watch.ground, "route", place.at).is_err() => RouteSight::Unknown,
            false => RouteSight::Hidden,
        })
        .collect();
    let begin = |place: RoutePlace, sight| RouteStretch {
        sight,
        from_m: place.along_m,
        to_m: place.along_m,
        line: vec![place.at],
        posts: vec![false; posts],
    };
    let mut stretches: Vec<RouteStretch> = Vec::new();
    let mut stretch = begin(places[0], sights[0]);
    for (index, &place) in places.iter().enumerate() {
        if sights[index] != stretch.sight {
            let change = watch.change(places[index - 1], place, stretch.sight);
            stretch.to_m = change.along_m;
            stretch.line.push(change.at);
            stretches.push(std::mem::replace(&mut stretch, begin(change, sights[index])));
        }
        if place.is_vertex && place.along_m > stretch.from_m {
            stretch.line.push(place.at);
        }
        stretch.to_m = place.along_m;
        let row = &seen[index * posts..][..posts];
        stretch.posts.iter_mut().zip(row).for_each(|(any, &seen)| *any |= seen);
    }
    if stretch.to_m > stretch.from_m {
        stretches.push(stretch);
    }
    stretches
}

/// The outcome of a route of this length in meters and this speed in m/s.
fn outcome(
    lookouts: &[Lookout],
    stretches: &[RouteStretch],
    seen: &[bool],
    (length_m, speed): (f64, f64),
) -> Outcome {
    let minutes = |along_m: f64| along_m / speed / 60.0;
    let sum_m = |sight: RouteSight| -> f64 {
        stretches
            .iter()
            .filter(|stretch| stretch.sight == sight)
            .map(|stretch| stretch.to_m - stretch.from_m)
            .sum()
    };
    let line = |stretch: &RouteStretch| OutcomeFeature {
        shape: OutcomeShape::Line(stretch.line.clone()),
        name: String::new(),
        role: FeatureRole::Link,
        properties: vec![
            ("seen", PropertyValue::Truth(stretch.sight == RouteSight::Seen)),
            ("sight", PropertyValue::Text(stretch.sight.noun().into())),
            ("from_m", PropertyValue::Number(stretch.from_m)),
            ("length_m", PropertyValue::Number(stretch.to_m - stretch.from_m)),
            ("minutes", PropertyValue::Number(minutes(stretch.to_m - stretch.from_m))),
            ("posts", PropertyValue::Text(post_names(&stretch.posts))),
        ],
    };
    let places = seen.len() / lookouts.len();
    let post = |(index, lookout): (usize, &Lookout)| {
        let of_it = seen.iter().skip(index).step_by(lookouts.len()).filter(|&&seen| seen).count();
        let share = of_it as f64 / places as f64 * 100.0;
        lookout.feature(vec![("places_percent", PropertyValue::Number(share))])
    };
    let row = |stretch: &RouteStretch| {
        vec![
            PropertyValue::Number(stretch.from_m / 1000.0),
            PropertyValue::Number((stretch.to_m - stretch.from_m) / 1000.0),
            PropertyValue::Number(minutes(stretch.from_m)),
            PropertyValue::Number(minutes(stretch.to_m - stretch.from_m)),
            PropertyValue::Text(stretch.sight.noun().into()),
            PropertyValue::Text(post_names(&stretch.posts)),
        ]
    };
    let table = OutcomeTable {
        title: "Stretches".into(),
        columns: vec![
            TableColumn::new("from", "km", 2),
            TableColumn::new("length", "km", 2),
            TableColumn::new("after", "min", 1),
            TableColumn::new("for", "min", 1),
            TableColumn::new("sight", "", 0),
            TableColumn::new("posts", "", 0),
        ],
        rows: stretches.iter().map(row).collect(),
    };
    let seen_m = sum_m(RouteSight::Seen);
    let mut notes = Vec::new();
    let unknown_m = sum_m(RouteSight::Unknown);
    if unknown_m > 0.0 {
        notes.push(format!(
            "{unknown_m:.0} m of the route have no elevation: whether they are seen is unknown"
        ));
    }
    Outcome {
        features: stretches.iter().map(line).chain(lookouts.iter().enumerate().map(post)).collect(),
        tables: vec![table],
        figures: vec![
            Figure::new("in sight, share", seen_m / length_m * 100.0, "%"),
            Figure::new("in sight", seen_m / 1000.0, "km"),
            Figure::new("in sight, time", minutes(seen_m), "min"),
            Figure::new("length", length_m / 1000.0, "km"),
        ],
        notes,
        ..Outcome::default()
    }
}

/// The numbers of posts, separated by commas.
fn post_names(posts: &[bool]) -> String {
    let numbers = posts.iter().enumerate().filter(|&(_, &seen)| seen);
    numbers.map(|(index, _)| (index + 1).to_string()).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arguments::ArgumentValue;
    use crate::observation::test_hills::{at, land, ripples};
    use crate::test_land::{on_pool, run_kind};

    fn points(name: &'static str, places: &[(f64, f64)]) -> (&'static str, ArgumentValue) {
        (name, ArgumentValue::Points(places.iter().map(|&(column, row)| at(column, row)).collect()))
    }

    fn number(name: &'static str, value: f64) -> (&'static str, ArgumentValue) {
        (name, ArgumentValue::Number(value))
    }

    fn figure(outcome: &Outcome, name: &str) -> f64 {
        outcome.figures.iter().find(|figure| figure.name == name).expect("a figure").value
    }

    #[test]
    fn a_wall_hides_the_route_behind_it_up_to_where_the_line_over_its_top_comes_down() {
        // The eye is 20 m up at 0 m, the wall's top 10 m at 50 m: the line comes down to the ground at 100 m.
        let land = land(21, |column, _| if column == 5 { 10.0 } else { 0.0 });
        let arguments = vec![
            points("route", &[(0.0, 10.0), (20.0, 10.0)]),
            points("posts", &[(0.0, 10.0)]),
            number("observer_height", 20.0),
            number("target_height", 0.0),
            number("speed", 6.0),
        ];
        let outcome = run_kind("exposure", &land, arguments).expect("sound");
        let rows = &outcome.tables[0].rows;
        assert_eq!(rows.len(), 3, "{rows:?}");
        let PropertyValue::Number(hidden_km) = rows[1][1] else { panic!("a number") };
        assert!((hidden_km - 0.050).abs() < 1e-5, "{hidden_km}: from the wall at 50 m to 100 m");
        assert_eq!(rows[1][4], PropertyValue::Text("hidden".into()));
        assert!((figure(&outcome, "in sight, share") - 75.0).abs() < 0.01);
        assert!((figure(&outcome, "in sight, time") - 1.5).abs() < 1e-3, "150 m at 100 m a minute");
        assert_eq!(rows[0][5], PropertyValue::Text("1".into()));
    }

    #[test]
    fn stretches_cover_the_route_without_gaps_and_turn_with_it() {
        let land = land(20, ripples);
        let arguments = || {
            vec![
                points("route", &[(1.0, 1.0), (18.0, 3.0), (18.0, 3.0), (15.0, 12.0), (3.0, 18.0)]),
                points("posts", &[(4.0, 9.0), (12.0, 6.0)]),
                number("step", 1.0),
            ]
        };
        let run = || run_kind("exposure", &land, arguments()).expect("sound");
        let outcome = run();
        let mut end = at(1.0, 1.0);
        let mut length_m = 0.0;
        let lines: Vec<_> =
            outcome.features.iter().filter(|feature| feature.role == FeatureRole::Link).collect();
        for line in &lines {
            let OutcomeShape::Line(line) = &line.shape else { panic!("a line") };
            assert_eq!(line[0], end);
            end = *line.last().expect("two places");
            length_m += line.windows(2).map(|pair| pair[0].distance(pair[1])).sum::<f64>();
        }
        assert_eq!(end, at(3.0, 18.0));
        assert!((length_m - figure(&outcome, "length") * 1000.0).abs() < 1e-6);
        assert!(lines.len() > 4, "{}", lines.len());
        let text = |threads| on_pool(threads, || format!("{:?}", run()));
        assert_eq!(text(1), text(4));
    }

    #[test]
    fn a_route_over_a_hole_says_how_much_of_it_is_unknown() {
        let land = land(20, ripples);
        let arguments = vec![points("route", &[(2.0, 17.5), (18.0, 17.5)]), points("posts", &[(4.0, 9.0)])];
        let outcome = run_kind("exposure", &land, arguments).expect("sound");
        assert!(outcome.notes.iter().any(|note| note.contains("have no elevation")), "{:?}", outcome.notes);
    }

    #[test]
    fn routes_off_the_land_without_length_or_too_long_are_errors_that_name_the_key() {
        let land = land(20, ripples);
        let key = |route: &[(f64, f64)], more: Vec<(&'static str, ArgumentValue)>| {
            let mut arguments = vec![points("route", route), points("posts", &[(4.0, 9.0)])];
            arguments.extend(more);
            run_kind("exposure", &land, arguments).err().and_then(|error| error.key())
        };
        assert_eq!(key(&[(1.0, 1.0), (40.0, 1.0)], vec![]), Some("route"));
        assert_eq!(key(&[(1.0, 1.0), (1.0, 1.0)], vec![]), Some("route"));
        let there_and_back: Vec<(f64, f64)> =
            (0..60_000).map(|index| if index % 2 == 0 { (0.0, 1.0) } else { (19.0, 1.0) }).collect();
        assert_eq!(key(&there_and_back, vec![number("step", 0.1)]), Some("step"));
    }
}
