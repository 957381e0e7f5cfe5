//! The quickest route through places, with a march table.

use glam::DVec2;

use crate::arguments::AnalysisArguments;
use crate::error::AnalysisError;
use crate::land::Land;
use crate::movement::travel::{TravelGround, travel_ground};
use crate::movement::way::WayPoint;
use crate::outcome::{
    FeatureRole, Figure, Outcome, OutcomeFeature, OutcomeShape, OutcomeTable, PropertyValue, TableColumn,
};
use sandtable_geom::simplify::simplified;
use sandtable_terrain::stop_flag::StopFlag;

/// How far a line may leave the points of its way, in cells: less than anybody sees.
const STRAIGHT_CELLS: f64 = 0.01;

/// What a way is: lengths in meters, on the map; climb and descent between its points.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct RouteMeasures {
    /// Its length on the map, meters.
    pub length_m: f64,
    /// The sum of its rises, meters.
    pub climb_m: f64,
    /// The sum of its falls, meters.
    pub descent_m: f64,
    /// The time it takes, seconds.
    pub seconds: f64,
}

impl RouteMeasures {
    /// Of points that follow each other.
    pub fn of(ground: &TravelGround<'_>, way: &[WayPoint]) -> Self {
        let mut measures = Self { seconds: ground.seconds_along(way), ..Self::default() };
        for ends in way.windows(2) {
            let [from, to] = [ends[0], ends[1]];
            measures.length_m += ground.position(from).distance(ground.position(to));
            let rise = f64::from(ground.height_at_m(to)) - f64::from(ground.height_at_m(from));
            measures.climb_m += rise.max(0.0);
            measures.descent_m += (-rise).max(0.0);
        }
        measures
    }
}

/// The positions of a way where its direction changes, its ends included.
pub(crate) fn way_line(ground: &TravelGround<'_>, way: &[WayPoint]) -> Vec<DVec2> {
    let positions: Vec<DVec2> = way.iter().map(|&point| ground.position(point)).collect();
    let slack_m = ground.lattice().cell().min_element() * STRAIGHT_CELLS;
    let off_m = |first: usize, last: usize, at: usize| {
        let [along, beside] = [last, at].map(|other| positions[other] - positions[first]);
        let share = (beside.dot(along) / along.length_squared()).clamp(0.0, 1.0);
        (beside - along * share).length()
    };
    let kept = simplified(positions.len(), slack_m, off_m);
    let mut line: Vec<DVec2> = kept.into_iter().map(|at| positions[at]).collect();
    if line.len() == 1 {
        line.push(line[0]);
    }
    line
}

/// The quickest route from `from` through `via` to `to`.
///
/// # Errors
/// `vehicle`, places, a place that is not reached, and memory.
pub(crate) fn route(
    land: &Land,
    arguments: &AnalysisArguments,
    stop: &StopFlag,
) -> Result<Outcome, AnalysisError> {
    let (ground, _, notes) = travel_ground(land, arguments)?;
    let mut places: Vec<(&'static str, DVec2)> = Vec::new();
    places.extend(arguments.points("from").first().map(|&at| ("from", at)));
    places.extend(arguments.points("via").iter().map(|&at| ("via", at)));
    places.extend(arguments.points("to").first().map(|&at| ("to", at)));
    let posts = places
        .iter()
        .map(|&(key, at)| ground.post_near(key, at))
        .collect::<Result<Vec<usize>, AnalysisError>>()?;
    let mut way: Vec<WayPoint> = posts.first().map(|&post| ground.point_at(post)).into_iter().collect();
    let start_min = arguments.number("start_h") * 60.0;
    let (mut rows, mut total) = (Vec::new(), RouteMeasures::default());
    for (leg, ends) in posts.windows(2).enumerate() {
        let Some(part) = ground.quickest_way(&ends[..1], &ends[1..], stop)? else {
            let (key, at) = places[leg + 1];
            let problem = "no way leads there: water, slopes or walls surround it or the place before it";
            return Err(AnalysisError::Place { key, at, problem });
        };
        let measures = RouteMeasures::of(&ground, &part);
        total.length_m += measures.length_m;
        total.climb_m += measures.climb_m;
        total.descent_m += measures.descent_m;
        total.seconds += measures.seconds;
        // By the numbers of the way-points on the picture.
        let label = format!("{} – {}", leg + 1, leg + 2);
        rows.push(leg_row(label, &measures, start_min + total.seconds / 60.0));
        way.extend(part.into_iter().skip(1));
    }
    rows.push(leg_row("all".to_owned(), &total, start_min + total.seconds / 60.0));
    let mut features = vec![OutcomeFeature {
        shape: OutcomeShape::Line(way_line(&ground, &way)),
        name: String::new(),
        role: FeatureRole::Route,
        properties: vec![
            ("length_km", PropertyValue::Number(total.length_m / 1000.0)),
            ("time_min", PropertyValue::Number(total.seconds / 60.0)),
        ],
    }];
    features.extend(places.iter().enumerate().map(|(index, &(_, at))| OutcomeFeature {
        shape: OutcomeShape::Point(at),
        name: (index + 1).to_string(),
        role: FeatureRole::Place,
        properties: Vec::new(),
    }));
    Ok(Outcome {
        features,
        tables: vec![OutcomeTable { title: "March table".to_owned(), columns: leg_columns(), rows }],
        figures: vec![
            Figure::new("length", total.length_m / 1000.0, "km"),
            Figure::new("time", total.seconds / 60.0, "min"),
        ],
        notes,
        ..Outcome::default()
    })
}

fn leg_columns() -> Vec<TableColumn> {
    let column = TableColumn::new;
    vec![
        column("leg", "", 0),
        column("distance", "km", 2),
        column("climb", "m", 0),
        column("descent", "m", 0),
        column("time", "min", 0),
        column("arrival", "h", 0),
    ]
}

fn leg_row(label: String, measures: &RouteMeasures, arrival_min: f64) -> Vec<PropertyValue> {
    vec![
        PropertyValue::Text(label),
        PropertyValue::Number(measures.length_m / 1000.0),
        PropertyValue::Number(measures.climb_m),
        PropertyValue::Number(measures.descent_m),
        PropertyValue::Number(measures.seconds / 60.0),
        PropertyValue::Text(clock(arrival_min)),
    ]
}

/// `7:05`; hours go on beyond 24.
fn clock(minutes: f64) -> String {
    let whole = minutes.round().clamp(0.0, 1e12) as u64;
    format!("{}:{:02}", whole / 60, whole % 60)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arguments::ArgumentValue;
    use crate::land::{Crossing, CrossingKind, Step};
    use crate::run::run;
    use crate::test_land::{flat, flood, shaped};

    fn found(land: &Land, places: [&[DVec2]; 3]) -> Result<Outcome, AnalysisError> {
        let kind = sandtable_catalog::kind("route").expect("a kind");
        let mut arguments = AnalysisArguments::new(kind)
            .with("vehicle", ArgumentValue::Word("foot".to_owned()))
            .with("start_h", ArgumentValue::Number(6.5));
        for (key, points) in ["from", "via", "to"].into_iter().zip(places) {
            arguments = arguments.with(key, ArgumentValue::Points(points.to_vec()));
        }
        run(land, &arguments, &StopFlag::default())
    }

    #[test]
    fn a_route_goes_over_the_bridge_and_its_table_adds_up() {
        let mut land = flat(9, 9, 100.0);
        flood(&mut land, 4, 3.0);
        let line = vec![DVec2::new(300.0, 700.0), DVec2::new(500.0, 700.0)];
        let (name, load_t) = (String::new(), None);
        land.crossings = vec![Crossing { name, kind: CrossingKind::Bridge, line, width_m: 5.0, load_t }];
        let from = DVec2::new(0.0, 700.0);
        let via = DVec2::new(200.0, 700.0);
        let to = DVec2::new(800.0, 700.0);
        let outcome = found(&land, [&[from], &[via], &[to]]).expect("sound");
        assert_eq!(outcome.features[0].shape, OutcomeShape::Line(vec![from, to]));
        let rows = &outcome.tables[0].rows;
        assert_eq!(rows.len(), 3);
        // 800 m at Tobler's 5.037 km/h are 9.53 minutes.
        assert!((outcome.figures[1].value - 9.531).abs() < 0.01, "{:?}", outcome.figures);
        assert_eq!(rows[2][5], PropertyValue::Text("6:40".to_owned()));
        assert_eq!(
            (&rows[0][0], &rows[0][1]),
            (&PropertyValue::Text("1 – 2".to_owned()), &PropertyValue::Number(0.2))
        );
    }

    #[test]
    fn climb_and_descent_are_sums_along_the_way() {
        let land = shaped(5, 3, 100.0, |column, _| [0.0, 10.0, 5.0, 20.0, 20.0][column as usize]);
        let outcome =
            found(&land, [&[DVec2::new(0.0, 100.0)], &[], &[DVec2::new(400.0, 100.0)]]).expect("sound");
        let row = &outcome.tables[0].rows[0];
        assert_eq!((&row[2], &row[3]), (&PropertyValue::Number(25.0), &PropertyValue::Number(5.0)));
    }

    #[test]
    fn a_target_behind_a_wall_is_an_error_that_names_it() {
        let mut land = flat(9, 9, 100.0);
        let line = vec![DVec2::new(400.0, -100.0), DVec2::new(400.0, 1000.0)];
        land.steps = vec![Step { line, height_m: 4.0 }];
        let error = found(&land, [&[DVec2::ZERO], &[], &[DVec2::new(800.0, 800.0)]]).expect_err("no way");
        assert_eq!(error.key(), Some("to"), "{error}");
        let same = found(&land, [&[DVec2::ZERO], &[], &[DVec2::ZERO]]).expect("no way to go");
        assert_eq!(same.figures[1].value, 0.0);
    }
}
