//! Sites against the definition post by post, and by hand.

use glam::DVec2;

use super::*;
use crate::arguments::ArgumentValue;
use crate::land::{RoadClass, RoadLine, Stand};
use crate::test_land::{flat, flood, on_pool, run_kind, shaped, values_of};

fn number(value: f64) -> ArgumentValue {
    ArgumentValue::Number(value)
}

fn word(text: &str) -> ArgumentValue {
    ArgumentValue::Word(text.to_owned())
}

fn codes<'a>(land: &Land, arguments: impl IntoIterator<Item = (&'a str, ArgumentValue)>) -> Vec<f32> {
    let outcome = run_kind("sites", land, arguments).expect("sound");
    values_of(&outcome.raster.expect("a raster"))
}

/// 21 × 21 posts 10 m apart; water in the west, a road in the north.
fn place() -> Land {
    let mut land = flat(21, 21, 10.0);
    flood(&mut land, 0, 1.0);
    let line = vec![DVec2::new(0.0, 200.0), DVec2::new(200.0, 200.0)];
    land.roads = Some(vec![RoadLine { name: String::new(), line, surface: RoadClass::Road, width_m: 5.0 }]);
    land
}

#[test]
fn distances_to_water_and_roads_count_from_the_center_and_dryness_from_every_part() {
    let found = codes(
        &place(),
        [
            ("size_m", number(40.0)),
            ("water_m", number(100.0)),
            ("dry_m", number(25.0)),
            ("road_m", number(120.0)),
        ],
    );
    for (index, &code) in found.iter().enumerate() {
        let (column, row) = ((index % 21) as f64 * 10.0, (index / 21) as f64 * 10.0);
        // The disk of 20 m lies within the land; its western post is 30 m from water, its northern one off the road.
        let fits = (20.0..=180.0).contains(&column) && (20.0..=170.0).contains(&row);
        let wanted = fits && (50.0..=100.0).contains(&column) && 200.0 - row <= 120.0;
        assert_eq!(code, if wanted { 2.0 } else { 0.0 }, "{column} {row}");
    }
}

#[test]
fn the_best_site_is_the_nearest_to_water_and_road_and_sites_lie_apart() {
    let arguments = [
        ("size_m", number(40.0)),
        ("water_m", number(100.0)),
        ("dry_m", number(25.0)),
        ("road_m", number(120.0)),
        ("separation_m", number(20.0)),
        ("count", number(2.0)),
    ];
    let outcome = run_kind("sites", &place(), arguments).expect("sound");
    let rows = &outcome.tables[0].rows;
    assert_eq!(rows.len(), 2);
    let numbers = |row: usize| [8, 9].map(|column: usize| rows[row][column].clone());
    assert_eq!(numbers(0), [PropertyValue::Number(50.0), PropertyValue::Number(30.0)]);
    // Slope, water and road leave 1, 1/2 and 3/4: 0.75 in the mean.
    assert_eq!(rows[0][5], PropertyValue::Number(0.75));
    let names: Vec<&str> = outcome.tables[0].columns.iter().map(|column| column.name).collect();
    let place = ["site", "east", "north", "height", "class", "score", "slope", "surface"];
    assert_eq!(names, [&place[..], &["to water", "to road"]].concat());
    let written = outcome.tables[0].written_rows().next().expect("a site");
    assert_eq!(written[..4], ["Site 1", "50", "170", "0"]);
    let center = |feature: &OutcomeFeature| match &feature.shape {
        OutcomeShape::Area(rings) => rings[0].iter().sum::<DVec2>() / 32.0,
        other => panic!("{other:?}"),
    };
    assert!(center(&outcome.features[0]).distance(DVec2::new(50.0, 170.0)) < 1e-6);
    assert!(center(&outcome.features[1]).distance(center(&outcome.features[0])) >= 59.999);
}

#[test]
fn slopes_make_sites_cautious_and_unsuited() {
    for (degrees, code) in [(2.9f64, 2.0), (3.1, 1.0), (6.9, 1.0), (7.1, 0.0)] {
        let rise = (degrees.to_radians().tan() * 10.0) as f32;
        let land = shaped(9, 9, 10.0, |column, _| column as f32 * rise);
        assert_eq!(codes(&land, [("size_m", number(40.0))])[40], code, "{degrees}");
    }
}

#[test]
fn covers_count_as_is_asked() {
    let mut land = flat(9, 9, 10.0);
    let rules = [
        (LandCover::Open, [2.0, 2.0, 0.0]),
        (LandCover::Wood, [1.0, 0.0, 2.0]),
        (LandCover::Scrub, [1.0, 1.0, 1.0]),
        (LandCover::BuiltUp, [1.0, 0.0, 1.0]),
        (LandCover::Wetland, [0.0, 0.0, 0.0]),
    ];
    for (cover, wanted) in rules {
        land.cover = Some(vec![cover; 81]);
        for (name, code) in ["any", "open", "concealed"].into_iter().zip(wanted) {
            assert_eq!(
                codes(&land, [("size_m", number(30.0)), ("cover", word(name))])[40],
                code,
                "{cover:?}"
            );
        }
    }
    land.cover = Some(vec![LandCover::Open; 81]);
    land.woods = Some(vec![Stand { spacing_m: 4.0, stem_m: 0.2 }; 81]);
    assert_eq!(codes(&land, [("size_m", number(30.0)), ("cover", word("concealed"))])[40], 2.0);
    land.woods = None;
    let mut tall = vec![0.0; 81];
    tall[41] = 2.0;
    land.obstacles_m = Some(tall);
    let found = codes(&land, [("size_m", number(20.0))]);
    assert_eq!((found[40], found[38]), (0.0, 2.0));
}

/// A ridge of 20 m along column 15 of 31, level elsewhere.
fn ridge() -> Land {
    shaped(31, 31, 10.0, |column, _| if column == 15 { 20.0 } else { 0.0 })
}

#[test]
fn a_site_hides_behind_the_ridge_from_a_post_and_no_further_than_the_sight_line() {
    let from = ArgumentValue::Points(vec![DVec2::new(20.0, 150.0)]);
    let arguments = [("size_m", number(10.0)), ("hidden_from", from), ("hidden_height", number(3.0))];
    let found = codes(&ridge(), arguments);
    // East of the ridge nothing below the line over its crest is seen; west of it all is.
    let code = |column: usize| found[15 * 31 + column];
    assert_eq!((code(5), code(10), code(20), code(28)), (0.0, 0.0, 2.0, 2.0));
}

#[test]
fn a_mask_toward_the_enemy_has_a_least_and_a_greatest_height() {
    let arguments = [
        ("size_m", number(10.0)),
        ("enemy_deg", ArgumentValue::Numbers(vec![270.0])),
        ("least_mask", number(8.2)),
        ("greatest_mask", number(20.5)),
    ];
    let outcome = run_kind("sites", &ridge(), arguments).expect("sound");
    let found = values_of(outcome.raster.as_ref().expect("a raster"));
    // 20 m over 130 m are 8.75°; over 60 m 18.4°; over 140 m 8.13°; over 50 m 21.8°. Slopes end two posts from the ridge.
    let row: Vec<usize> = (0..31).filter(|&column| found[15 * 31 + column] == 2.0).collect();
    assert_eq!(row, (21..=28).collect::<Vec<_>>());
    let mask = outcome.tables[0].columns.iter().position(|column| column.name == "mask").expect("a column");
    let PropertyValue::Number(mask) = outcome.tables[0].rows[0][mask] else { panic!("a number") };
    assert!((8.2..=20.5).contains(&mask), "{mask}");
}

#[test]
fn demands_out_of_order_or_on_unknown_layers_name_their_key() {
    let key = |arguments: &[(&str, ArgumentValue)]| {
        run_kind("sites", &flat(9, 9, 10.0), arguments.iter().cloned()).expect_err("at fault").key()
    };
    assert_eq!(key(&[("free_slope", number(9.0))]), Some("free_slope"));
    assert_eq!(key(&[("water_m", number(100.0))]), Some("water_m"));
    assert_eq!(key(&[("road_m", number(100.0))]), Some("road_m"));
    assert_eq!(key(&[("cover", word("concealed"))]), Some("cover"));
    assert_eq!(key(&[("least_mask", number(20.0))]), Some("least_mask"));
    let off = ArgumentValue::Points(vec![DVec2::splat(-500.0)]);
    assert_eq!(key(&[("hidden_from", off)]), Some("hidden_from"));
}

#[test]
fn sites_are_the_same_bits_with_one_thread_and_with_three() {
    let mut land = place();
    land.ground = shaped(21, 21, 10.0, |column, row| ((column * 31 + row * 17) % 23) as f32 * 0.05).ground;
    let arguments = || {
        [
            ("size_m", number(30.0)),
            ("enemy_deg", ArgumentValue::Numbers(vec![10.0, 200.0])),
            ("least_mask", number(0.0)),
            ("hidden_from", ArgumentValue::Points(vec![DVec2::new(100.0, 100.0)])),
            ("hidden_height", number(0.0)),
            ("observer_height", number(0.0)),
        ]
    };
    let text = |threads| on_pool(threads, || format!("{:?}", run_kind("sites", &land, arguments())));
    assert_eq!(text(1), text(3));
}

#[test]
fn numbers_at_both_ends_of_their_ranges_give_an_outcome_or_name_a_key() {
    use sandtable_catalog::parameter::ParameterForm;
    let lands = [
        flat(2, 2, 10.0),
        shaped(2, 2, 10.0, |column, _| if column == 0 { f32::NAN } else { 1.0 }),
        shaped(7, 5, 1e-3, |_, _| f32::NAN),
        shaped(9, 9, 1e4, |column, row| ((column * 31 + row * 17) % 7) as f32 * 1e6),
        place(),
    ];
    let kind = sandtable_catalog::kind("sites").expect("a kind");
    for land in &lands {
        for is_high in [false, true] {
            let arguments = kind.parameters.iter().filter_map(|parameter| match parameter.form {
                ParameterForm::Number { least, greatest } => {
                    Some((parameter.name, number(if is_high { greatest } else { least })))
                }
                ParameterForm::Numbers { least, greatest } => {
                    Some((parameter.name, ArgumentValue::Numbers(vec![least, greatest])))
                }
                _ => None,
            });
            for without in ["", "water_m"] {
                let arguments =
                    arguments.clone().filter(|(name, _)| without.is_empty() || !name.ends_with("_m"));
                match run_kind("sites", land, arguments) {
                    Ok(outcome) => assert!(outcome.raster.is_some()),
                    Err(error) => assert!(error.key().is_some(), "{error}"),
                }
            }
        }
    }
}
