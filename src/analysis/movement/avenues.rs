//! Avenues of approach: the best routes that differ from one line to another; and the narrowest places on them.
//!
//! After each route, the ground within a distance of it becomes slower by a factor, and the next is found. Times and widths
//! that are reported are those of the ground as it is.

use glam::DVec2;

use crate::apart::first_apart;
use crate::arguments::AnalysisArguments;
use crate::error::AnalysisError;
use crate::land::Land;
use crate::line_posts::along_line;
use crate::measures::post_grid;
use crate::movement::corridors::{FreeGround, echelon};
use crate::movement::route::{RouteMeasures, way_line};
use crate::movement::travel::{TravelGround, travel_ground};
use crate::movement::way::WayPoint;
use crate::outcome::{
    FeatureRole, Figure, Outcome, OutcomeFeature, OutcomeShape, OutcomeTable, PropertyValue, TableColumn,
};
use sandtable_geom::distance_field::distances_m;
use sandtable_terrain::stop_flag::StopFlag;

/// A route does not differ where more than this share of the posts nearest to it lie near earlier ones.
const MOST_SHARED: f64 = 0.8;

/// Avenues with the free width at each of their posts.
struct AvenueSet {
    avenues: Vec<Avenue>,
    notes: Vec<String>,
}

struct Avenue {
    way: Vec<WayPoint>,
    /// Of the points of the way.
    positions: Vec<DVec2>,
    line: Vec<DVec2>,
    measures: RouteMeasures,
    /// The free width at the post nearest to each point of the way, meters, 0 on ground that is not free; infinite where nothing limits it.
    widths_m: Vec<f64>,
    /// The share of its posts that lie near earlier avenues.
    shared: f64,
}

impl Avenue {
    fn narrowest_m(&self) -> f64 {
        self.widths_m.iter().copied().fold(f64::INFINITY, f64::min)
    }
}

/// The posts of a line on which the vehicle can be.
fn open_posts(
    ground: &TravelGround<'_>,
    key: &'static str,
    line: &[DVec2],
) -> Result<Vec<usize>, AnalysisError> {
    let mut posts = Vec::new();
    along_line(ground.lattice(), line, 0.0, |index| posts.push(index));
    posts.retain(|&index| ground.is_open(index));
    posts.sort_unstable();
    posts.dedup();
    match posts.is_empty() {
        true => Err(AnalysisError::argument(
            key,
            "has no post on which the vehicle can be; move it onto ground that is passable",
        )),
        false => Ok(posts),
    }
}

fn find_avenues(
    land: &Land,
    arguments: &AnalysisArguments,
    stop: &StopFlag,
) -> Result<AvenueSet, AnalysisError> {
    let (mut ground, codes, mut notes) = travel_ground(land, arguments)?;
    let starts = open_posts(&ground, "from_line", arguments.points("from_line"))?;
    let ends = open_posts(&ground, "to_line", arguments.points("to_line"))?;
    let free = FreeGround::new(&land.ground, &codes, arguments)?;
    let count = arguments.number("count") as usize;
    let (apart_m, penalty) = (arguments.number("apart_m"), arguments.number("penalty") as f32);
    let grid = post_grid(&land.ground);
    let mut is_near = vec![false; codes.len()];
    let mut avenues: Vec<Avenue> = Vec::new();
    for _ in 0..count {
        let Some(way) = ground.quickest_way(&starts, &ends, stop)? else {
            return Err(AnalysisError::argument(
                "to_line",
                "is not reached from `from_line`: water, slopes or walls lie between",
            ));
        };
        let mut posts: Vec<usize> = way.iter().map(|&point| ground.nearest_post(point)).collect();
        let widths_m = posts.iter().map(|&index| free.width_at_m(index)).collect();
        posts.dedup();
        let near = posts.iter().filter(|&&index| is_near[index]).count();
        let shared = near as f64 / posts.len() as f64;
        if shared > MOST_SHARED {
            notes.push(format!(
                "there are {} avenues that differ; a further one shares more than {} % with these",
                avenues.len(),
                MOST_SHARED * 100.0
            ));
            break;
        }
        let mut is_off = vec![true; codes.len()];
        posts.iter().for_each(|&index| is_off[index] = false);
        let from_way_m = distances_m(&is_off, grid);
        drop(is_off);
        let mut slowed = Vec::new();
        for (index, distance_m) in from_way_m.into_iter().enumerate() {
            if distance_m <= apart_m && !is_near[index] {
                is_near[index] = true;
                slowed.push(index);
            }
        }
        let positions = way.iter().map(|&point| ground.position(point)).collect();
        let (line, measures) = (way_line(&ground, &way), RouteMeasures::default());
        avenues.push(Avenue { way, positions, line, measures, widths_m, shared });
        ground.slow_down(slowed, penalty);
    }
    ground.undo_slowing();
    for avenue in &mut avenues {
        avenue.measures = RouteMeasures::of(&ground, &avenue.way);
    }
    Ok(AvenueSet { avenues, notes })
}

/// A width for tables: as far as is known, `open` where no restricted ground limits it.
fn width_value(width_m: f64) -> PropertyValue {
    match width_m.is_finite() {
        true => PropertyValue::Number(width_m),
        false => PropertyValue::Text("open".to_owned()),
    }
}

fn avenue_feature(rank: usize, avenue: &Avenue) -> OutcomeFeature {
    let narrowest_m = avenue.narrowest_m();
    OutcomeFeature {
        shape: OutcomeShape::Line(avenue.line.clone()),
        name: (rank + 1).to_string(),
        role: FeatureRole::Corridor,
        properties: vec![
            ("rank", PropertyValue::Whole(rank as i64 + 1)),
            ("length_km", PropertyValue::Number(avenue.measures.length_m / 1000.0)),
            ("time_min", PropertyValue::Number(avenue.measures.seconds / 60.0)),
            ("width_m", width_value(narrowest_m)),
            ("echelon", PropertyValue::Text(echelon(narrowest_m).to_owned())),
        ],
    }
}

/// The best routes that differ between two lines.
///
/// # Errors
/// `vehicle`, `from_line`, `to_line`, and memory.
pub(crate) fn avenues(
    land: &Land,
    arguments: &AnalysisArguments,
    stop: &StopFlag,
) -> Result<Outcome, AnalysisError> {
    let set = find_avenues(land, arguments, stop)?;
    let row = |(rank, avenue): (usize, &Avenue)| {
        vec![
            PropertyValue::Whole(rank as i64 + 1),
            PropertyValue::Number(avenue.measures.length_m / 1000.0),
            PropertyValue::Number(avenue.measures.climb_m),
            PropertyValue::Number(avenue.measures.seconds / 60.0),
            width_value(avenue.narrowest_m()),
            PropertyValue::Text(echelon(avenue.narrowest_m()).to_owned()),
            PropertyValue::Number(avenue.shared * 100.0),
        ]
    };
    let column = TableColumn::new;
    let columns = vec![
        TableColumn::of_marks("avenue"),
        column("distance", "km", 2),
        column("climb", "m", 0),
        column("time", "min", 0),
        column("narrowest", "m", 0),
        column("echelon", "", 0),
        column("shared", "%", 0),
    ];
    let rows = set.avenues.iter().enumerate().map(row).collect();
    Ok(Outcome {
        features: set.avenues.iter().enumerate().map(|(rank, avenue)| avenue_feature(rank, avenue)).collect(),
        tables: vec![OutcomeTable { title: "Avenues of approach".to_owned(), columns, rows }],
        figures: vec![Figure::new("avenues", set.avenues.len() as f64, "")],
        notes: set.notes,
        ..Outcome::default()
    })
}

/// A narrow place on an avenue.
#[derive(Clone, Copy)]
struct ChokePoint {
    at: DVec2,
    width_m: f64,
    avenue: usize,
    station_m: f64,
}

/// The narrowest places on the best routes between two lines.
///
/// # Errors
/// As [`avenues`].
pub(crate) fn chokes(
    land: &Land,
    arguments: &AnalysisArguments,
    stop: &StopFlag,
) -> Result<Outcome, AnalysisError> {
    let set = find_avenues(land, arguments, stop)?;
    let mut places: Vec<ChokePoint> = Vec::new();
    for (rank, avenue) in set.avenues.iter().enumerate() {
        places.extend(narrow_places(rank, avenue));
    }
    // A stable sort: ties stay by avenue and station.
    places.sort_by(|one, other| one.width_m.total_cmp(&other.width_m));
    let (most, apart_m) = (arguments.number("most") as usize, arguments.number("apart_m"));
    let kept = first_apart(&places, most, apart_m, |place| place.at);
    let feature = |(index, place): (usize, &ChokePoint)| OutcomeFeature {
        shape: OutcomeShape::Point(place.at),
        name: format!("{} m", place.width_m.round()),
        role: FeatureRole::Place,
        properties: vec![
            ("rank", PropertyValue::Whole(index as i64 + 1)),
            ("width_m", PropertyValue::Number(place.width_m)),
            ("avenue", PropertyValue::Whole(place.avenue as i64 + 1)),
        ],
    };
    let row = |(index, place): (usize, &ChokePoint)| {
        vec![
            PropertyValue::Whole(index as i64 + 1),
            PropertyValue::Number(place.width_m),
            PropertyValue::Whole(place.avenue as i64 + 1),
            PropertyValue::Number(place.station_m / 1000.0),
        ]
    };
    let column = TableColumn::new;
    let columns = vec![
        column("choke point", "", 0),
        column("width", "m", 0),
        TableColumn::of_marks("avenue"),
        column("from start", "km", 2),
    ];
    let mut features: Vec<OutcomeFeature> =
        set.avenues.iter().enumerate().map(|(rank, avenue)| avenue_feature(rank, avenue)).collect();
    features.extend(kept.iter().enumerate().map(feature));
    let rows = kept.iter().enumerate().map(row).collect();
    Ok(Outcome {
        features,
        tables: vec![OutcomeTable { title: "Choke points".to_owned(), columns, rows }],
        figures: vec![Figure::new("choke points", kept.len() as f64, "")],
        notes: set.notes,
        ..Outcome::default()
    })
}

/// The places where an avenue is narrower than before and after; of a stretch of equal width, its middle.
fn narrow_places(rank: usize, avenue: &Avenue) -> Vec<ChokePoint> {
    let widths = &avenue.widths_m;
    let positions = &avenue.positions;
    let mut stations = vec![0.0];
    for (at, ends) in positions.windows(2).enumerate() {
        stations.push(stations[at] + ends[0].distance(ends[1]));
    }
    let mut places = Vec::new();
    let mut first = 0;
    while first < widths.len() {
        let mut last = first;
        while last + 1 < widths.len() && widths[last + 1] == widths[first] {
            last += 1;
        }
        let is_narrower = |other: Option<&f64>| other.is_none_or(|&other| other > widths[first]);
        let before = first.checked_sub(1).and_then(|at| widths.get(at));
        let after = widths.get(last + 1);
        let is_limited = before.is_some() || after.is_some();
        if widths[first].is_finite() && is_limited && is_narrower(before) && is_narrower(after) {
            let middle = (first + last) / 2;
            places.push(ChokePoint {
                at: positions[middle],
                width_m: widths[first],
                avenue: rank,
                station_m: stations[middle],
            });
        }
        first = last + 1;
    }
    places
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arguments::ArgumentValue;
    use crate::run::run;
    use crate::test_land::{flat, swamp};

    /// 31 × 21 posts, 100 m apart, with a swamp across: gaps of three posts at rows 4 to 6 and of one at row 15.
    fn two_gaps() -> Land {
        let mut land = flat(31, 21, 100.0);
        swamp(&mut land, |column, row| (14..=16).contains(&column) && !(4..=6).contains(&row) && row != 15);
        land
    }

    fn found(land: &Land, kind: &str, count: f64, to_column: f64) -> Result<Outcome, AnalysisError> {
        let line = |x: f64| ArgumentValue::Points(vec![DVec2::new(x, 0.0), DVec2::new(x, 2000.0)]);
        let arguments = AnalysisArguments::new(sandtable_catalog::kind(kind).expect("a kind"))
            .with("from_line", line(0.0))
            .with("to_line", line(to_column * 100.0))
            .with("apart_m", ArgumentValue::Number(300.0))
            .with("count", ArgumentValue::Number(count));
        run(land, &arguments, &StopFlag::default())
    }

    #[test]
    fn two_avenues_take_the_two_gaps_and_have_their_widths() {
        let outcome = found(&two_gaps(), "avenues", 2.0, 30.0).expect("sound");
        let rows = &outcome.tables[0].rows;
        let widths: Vec<&PropertyValue> = rows.iter().map(|row| &row[4]).collect();
        assert_eq!(rows.len(), 2);
        for width_m in [100.0, 300.0] {
            assert!(widths.contains(&&PropertyValue::Number(width_m)), "{widths:?}");
        }
        // 3 km at 30 km/h: penalties have no effect on what is reported.
        for row in rows {
            let PropertyValue::Number(minutes) = row[3] else { panic!("a number") };
            assert!((minutes - 6.0).abs() < 0.3, "{minutes}");
        }
    }

    #[test]
    fn choke_points_are_the_gaps_and_the_narrowest_is_first() {
        let outcome = found(&two_gaps(), "chokes", 2.0, 30.0).expect("sound");
        let places: Vec<DVec2> = outcome
            .features
            .iter()
            .filter_map(|feature| match feature.shape {
                OutcomeShape::Point(at) => Some(at),
                _ => None,
            })
            .collect();
        assert_eq!(places[0], DVec2::new(1500.0, 1500.0));
        assert!(
            (places[1].x - 1500.0).abs() <= 200.0 && (400.0..=600.0).contains(&places[1].y),
            "{places:?}"
        );
        assert_eq!(outcome.tables[0].rows[0][1], PropertyValue::Number(100.0));
    }

    #[test]
    fn a_line_in_the_swamp_or_behind_it_is_an_error_that_names_it() {
        let mut land = two_gaps();
        swamp(&mut land, |column, _| column == 15);
        for to_column in [15.0, 30.0] {
            let error = found(&land, "avenues", 1.0, to_column).expect_err("not reached");
            assert_eq!(error.key(), Some("to_line"), "{error}");
        }
    }

    #[test]
    fn routes_that_do_not_differ_are_left_out_with_a_note() {
        let mut land = flat(21, 3, 100.0);
        swamp(&mut land, |_, row| row != 1);
        let outcome = found(&land, "avenues", 4.0, 20.0).expect("sound");
        assert_eq!(outcome.tables[0].rows.len(), 1);
        assert!(
            outcome.notes.iter().any(|note| note.contains("1 avenues that differ")),
            "{:?}",
            outcome.notes
        );
    }
}
