//! What tables say of landing zones, by hand.

use super::*;
use crate::arguments::ArgumentValue;
use crate::land::LandCover;
use crate::outcome::GRID_REFERENCE;
use crate::test_land::{flat, paint, run_kind};
use sandtable_geom::crs::Crs;

/// A meadow of 21 by 21 posts 10 m apart amid woods of 31 by 31.
fn clearing() -> Land {
    let mut land = flat(31, 31, 10.0);
    let is_open = |index: u32| (5..26).contains(&index);
    paint(&mut land, |column, row| match is_open(column) && is_open(row) {
        true => LandCover::Open,
        false => LandCover::Wood,
    });
    land
}

fn value<'a>(feature: &'a OutcomeFeature, name: &str) -> Option<&'a PropertyValue> {
    feature.properties.iter().find(|(known, _)| *known == name).map(|(_, value)| value)
}

fn zone(land: &Land, arguments: &[(&'static str, f64)]) -> (OutcomeFeature, OutcomeTable) {
    let numbers = arguments.iter().map(|&(name, number)| (name, ArgumentValue::Number(number)));
    let outcome = run_kind("landing-zones", land, numbers).expect("sound");
    (outcome.features[0].clone(), outcome.tables[0].clone())
}

#[test]
fn a_zone_says_its_place_size_points_surface_and_axis() {
    let mut land = clearing();
    land.crs = Crs::from_epsg(32616).expect("known");
    let (feature, table) = zone(&land, &[("count", 1.0)]);
    let names: Vec<&str> = table.columns.iter().map(|column| column.name).collect();
    let of_axis = ["slope", "surface", "in from", "out to", "ratio"];
    assert_eq!(
        names,
        [&["zone", GRID_REFERENCE, "height", "size", "across", "points", "class"][..], &of_axis].concat()
    );
    let cells = table.written_rows().next().expect("a zone");
    // Disks of 50 m hold 25 m of meadow on each side of their centers, so that 16 by 16 posts are suited, and four by four
    // points would fit in rows; by steps from a corner as many do.
    assert_eq!(cells[3..], ["3", "50", "16", "suited", "0.0", "open ground", "0", "180", "free"]);
    assert_eq!(value(&feature, "surface"), Some(&PropertyValue::Text("open ground".into())));
    assert_eq!(value(&feature, "approach_ratio"), None, "nothing rises");
}

#[test]
fn the_ratio_reached_is_that_of_the_worst_obstacle_of_the_best_axis() {
    let mut land = clearing();
    // A mast of 6.45 m, 70 m to the east of column 15, in all rows; one of half its height as far to the west.
    let height = |index: usize| match index % 31 {
        22 => 6.45,
        8 => 3.45,
        _ => 0.0,
    };
    land.obstacles_m = Some((0..31 * 31).map(height).collect());
    let search = |headings: u8| {
        let disk = DiskRows::new(25.0, DVec2::splat(10.0), 31);
        let tops: Vec<f32> = land.obstacles_m.clone().expect("a layer");
        let tops = disk.maxima(&tops, 31, f32::NEG_INFINITY);
        let (codes, headings) = (vec![2; 31 * 31], vec![headings; 31 * 31]);
        let search = SiteSearch {
            land: &land,
            codes: &codes,
            headings: &headings,
            approach: ApproachGround { tops: &tops, length_m: 90.0 },
            disk: &disk,
            size: "3".into(),
            diameter_m: 50.0,
        };
        search.axis(15 * 31 + 15)
    };
    // Eastward the mast enters the disk that lies 50 m away: 50 m for 6 m; westward 50 m for 3 m, and from there it comes.
    let east_west = search(0b100 | 0b100_0000).expect("an axis");
    assert_eq!((east_west.from_deg, east_west.to_deg), (270.0, 90.0));
    assert!((east_west.to_ratio - 50.0 / 6.0).abs() < 1e-4, "{}", east_west.to_ratio);
    assert!((east_west.from_ratio - 50.0 / 3.0).abs() < 1e-4, "{}", east_west.from_ratio);
    assert_eq!(east_west.ratio_value(), PropertyValue::Whole(8), "rounded down");
    let any = search(0b1111_1111).expect("an axis");
    assert_eq!((any.from_deg, any.ratio_value()), (0.0, PropertyValue::Text("free".into())));
    assert!(search(0b1).is_none(), "no way out");
}

#[test]
fn points_are_those_of_the_ground_that_hangs_together_up_to_twenty() {
    let mut land = flat(61, 21, 10.0);
    paint(&mut land, |column, _| if column == 20 { LandCover::Wood } else { LandCover::Open });
    let small = [("count", 2.0), ("separation_m", 150.0)];
    let numbers = small.map(|(name, number)| (name, ArgumentValue::Number(number)));
    let outcome = run_kind("landing-zones", &land, numbers).expect("sound");
    let counts: Vec<&PropertyValue> =
        outcome.features.iter().filter_map(|feature| value(feature, "points")).collect();
    assert_eq!(counts, [&PropertyValue::Whole(16), &PropertyValue::Whole(20)]);
    let points =
        outcome.tables[0].columns.iter().position(|column| column.name == "points").expect("a column");
    assert_eq!(outcome.tables[0].rows[1][points], PropertyValue::Text("20+".into()));
}
