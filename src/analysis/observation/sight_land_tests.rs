//! Woods and houses in the way of sight, by hand and by definition.

use super::*;
use crate::arguments::ArgumentValue;
use crate::observation::test_hills::{at, land, ripples};
use crate::outcome::{FeatureRole, Outcome, PropertyValue};
use crate::test_land::{on_pool, random, run_kind, values_of};
use sandtable_terrain::sight::ground::SightGround;

fn points(places: &[(f64, f64)]) -> ArgumentValue {
    ArgumentValue::Points(places.iter().map(|&(column, row)| at(column, row)).collect())
}

/// Level land with a wood of 15 m at columns 8 to 14, all posts 10 m apart.
fn with_wood() -> Land {
    let mut land = land(25, |_, _| 50.0);
    let standing = |index: u32| if (8..=14).contains(&(index % 25)) { 15.0 } else { 0.0 };
    land.obstacles_m = Some((0..25 * 25).map(standing).collect());
    land
}

fn viewshed_row(land: &Land, column: f64, target_m: f64) -> Vec<f32> {
    let arguments =
        [("posts", points(&[(column, 12.0)])), ("target_height", ArgumentValue::Number(target_m))];
    let outcome = run_kind("viewsheds", land, arguments).expect("sound");
    values_of(outcome.raster.as_ref().expect("a raster"))[12 * 25..][..25].to_vec()
}

#[test]
fn a_wood_shows_its_edge_and_hides_its_depth_and_the_ground_behind() {
    let row = viewshed_row(&with_wood(), 2.0, 0.0);
    let seen = |column: usize| row[column] == 1.0;
    assert!((0..8).all(seen), "open ground before it: {row:?}");
    assert!((8..=10).all(seen), "30 m of the wood: {row:?}");
    assert!(!(11..25).any(seen), "its depth and what is behind: {row:?}");
    let open = viewshed_row(&land(25, |_, _| 50.0), 2.0, 0.0);
    assert!(open.iter().all(|&value| value == 1.0), "nothing is hidden where nothing stands");
}

#[test]
fn a_post_sees_out_of_the_edge_of_a_wood_and_not_out_of_its_depth() {
    let at_edge = viewshed_row(&with_wood(), 9.0, 0.0);
    assert!(at_edge[..8].iter().all(|&value| value == 1.0), "out to the west: {at_edge:?}");
    assert!(at_edge[15..].iter().all(|&value| value == 0.0), "30 m to the east stand trees: {at_edge:?}");
    let mut wide = with_wood();
    wide.obstacles_m = Some((0..25 * 25).map(|index| if index % 25 > 2 { 15.0 } else { 0.0 }).collect());
    let deep = viewshed_row(&wide, 15.0, 0.0);
    let seen = |column: usize| deep[column] == 1.0;
    assert!((12..=18).all(seen) && !(0..12).any(seen) && !(19..25).any(seen), "30 m around: {deep:?}");
}

#[test]
fn a_target_above_the_treetops_is_seen_over_them() {
    // 100 m behind the trees, a line from 1.7 m over 15 m at 60 m passes.
    let row = viewshed_row(&with_wood(), 2.0, 80.0);
    assert!(row.iter().all(|&value| value == 1.0), "{row:?}");
    // Over the nearest trees it passes, and strikes the nearer ones.
    let low = viewshed_row(&with_wood(), 2.0, 16.0);
    assert_eq!((low[8], low[14], low[24]), (1.0, 0.0, 0.0), "{low:?}");
}

/// Hills with a post in five under something of up to 24 m.
fn covered() -> Land {
    let mut land = land(20, ripples);
    let mut bits = random(7);
    let mut standing = |_| if bits().is_multiple_of(5) { (bits() % 1000) as f32 * 0.024 } else { 0.0 };
    land.obstacles_m = Some((0..400).map(&mut standing).collect());
    land
}

#[test]
fn viewsheds_are_the_lines_of_sight_to_the_targets_of_every_post() {
    let land = covered();
    let mut counts = [0; 3];
    for (eye, above_m) in [((3.0, 4.0), 0.0), ((13.3, 9.7), 1.5), ((6.2, 15.9), 12.0), ((3.0, 4.0), 30.0)] {
        let eye = SightEnd { at: at(eye.0, eye.1), above_m: 3.0 };
        let options = ViewshedOptions { target_above_m: above_m, ..ViewshedOptions::new(eye) };
        let view = SightLand::new(&land).look("posts", &options, &StopFlag::default()).expect("ground");
        let sight = SightLand::new(&land).cleared_around([eye.at]);
        let tops = SightGround::new(sight.tops().clone());
        for post in land.ground.posts().filter(|&post| !land.ground.height(post).is_nan()) {
            let place = land.ground.map_position(post);
            let mut targets = sight.target(place, above_m);
            let is_clear = |target| tops.line_of_sight(eye, target, options.curvature) == Sight::Clear;
            let expected = targets.any(is_clear);
            let found = view.view.posts[land.ground.index(post)] == PostVisibility::Visible;
            assert_eq!(found, expected, "{post:?} from {eye:?} at {above_m}");
            let standing_m = f64::from(sight.standing_m(post));
            counts[usize::from(standing_m > 0.0) + usize::from(standing_m > above_m)] += usize::from(found);
        }
    }
    assert!(counts.iter().all(|&seen| seen > 10), "open, above tops, at edges: {counts:?}");
}

#[test]
fn land_where_nothing_stands_has_the_bits_of_bare_land() {
    let bare = land(20, ripples);
    let mut cleared = bare.clone();
    cleared.obstacles_m = Some(vec![0.0; 400]);
    let run = |land: &Land| {
        let outcome = run_kind("viewsheds", land, [("posts", points(&[(3.0, 4.0), (13.3, 9.7)]))]);
        let raster = outcome.expect("sound").raster.expect("a raster");
        values_of(&raster).iter().map(|value| value.to_bits()).collect::<Vec<_>>()
    };
    assert_eq!(run(&bare), run(&cleared));
    assert!(Arc::ptr_eq(SightLand::new(&cleared).tops(), &cleared.ground), "nothing is copied");
}

fn seen_links(outcome: &Outcome) -> Vec<bool> {
    let seen = |feature: &crate::outcome::OutcomeFeature| {
        let truth = |(name, value): &(&str, PropertyValue)| {
            (*name == "seen").then(|| *value == PropertyValue::Truth(true))
        };
        (feature.role == FeatureRole::Link).then(|| feature.properties.iter().find_map(truth)).flatten()
    };
    outcome.features.iter().filter_map(seen).collect()
}

#[test]
fn a_wood_parts_posts_hides_a_route_and_masks_what_flies_below_its_tops() {
    let land = with_wood();
    let posts = points(&[(2.0, 12.0), (22.0, 12.0), (5.0, 3.0)]);
    let outcome = run_kind("intervisibility", &land, [("posts", posts.clone())]).expect("sound");
    assert_eq!(seen_links(&outcome), [false, true, false], "1-2, 1-3, 2-3");
    let route = points(&[(3.0, 12.0), (24.0, 12.0)]);
    let watch = points(&[(2.0, 12.0)]);
    let exposure = run_kind("exposure", &land, [("route", route), ("posts", watch.clone())]).expect("sound");
    assert_eq!(seen_links(&exposure), [true, false]);
    let seen_m = exposure.features.iter().find_map(|feature| {
        feature.properties.iter().find(|(name, _)| *name == "length_m").map(|(_, length)| length.clone())
    });
    let Some(PropertyValue::Number(seen_m)) = seen_m else { panic!("a length") };
    // From column 3 to half a post beyond column 10.
    assert!((seen_m - 75.0).abs() < 0.1, "{seen_m}");
    let masking = run_kind("masking", &land, [("radars", watch)]).expect("sound");
    let heights = values_of(masking.raster.as_ref().expect("a raster"));
    let row = &heights[12 * 25..][..25];
    assert_eq!((row[5], row[8]), (0.0, 15.0), "{row:?}");
    assert!(row[14] > 15.0 && row[24] > 15.0, "{row:?}");
}

#[test]
fn best_posts_and_fire_have_woods_in_the_way_and_any_number_of_threads_the_same() {
    let land = covered();
    let run = |kind: &str, key: &'static str, threads: usize| {
        let more = match kind {
            "best-posts" => ("spacing", ArgumentValue::Number(40.0)),
            _ => ("max_range", ArgumentValue::Number(150.0)),
        };
        let places = points(&[(3.0, 4.0), (13.3, 9.7), (16.0, 12.0)]);
        let outcome = on_pool(threads, || run_kind(kind, &land, [(key, places), more])).expect("sound");
        format!("{outcome:?}")
    };
    for (kind, key) in [("best-posts", "watch"), ("fields-of-fire", "weapons")] {
        assert_eq!(run(kind, key, 1), run(kind, key, 4), "{kind}");
        let mut bare = land.clone();
        bare.obstacles_m = None;
        let more = ("max_range", ArgumentValue::Number(150.0));
        if kind == "fields-of-fire" {
            let weapons = points(&[(3.0, 4.0), (13.3, 9.7), (16.0, 12.0)]);
            let hit = |land: &Land| {
                let outcome = run_kind(kind, land, [(key, weapons.clone()), more.clone()]).expect("sound");
                outcome.figures.iter().find(|figure| figure.unit == "km²").map(|figure| figure.value)
            };
            assert!(hit(&land) < hit(&bare), "{:?} {:?}", hit(&land), hit(&bare));
        }
    }
}
