//! Positions as people write them: every form, what is refused, and the way back.

use super::*;
use crate::mgrs::tests::places;
use crate::position::notation::{PositionForm, spaced};

fn lonlat(text: &str) -> DVec2 {
    let position = Position::parse(text).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(position.numbers(), None, "{text}");
    position.in_system(wgs84()).expect("on Earth")
}

fn fault(text: &str) -> String {
    Position::parse(text).expect_err(text).to_string()
}

/// Meters between two longitudes and latitudes that are near to each other.
fn apart_m(a: DVec2, b: DVec2) -> f64 {
    let across = (a.x - b.x + 540.0).rem_euclid(360.0) - 180.0;
    DVec2::new(across * a.y.to_radians().cos(), a.y - b.y).length() * 111_200.0
}

#[test]
fn two_numbers_are_those_of_the_system() {
    for text in ["750000,4018000", " 750000 , 4018000", "750000 4018000", "7.5e5,4018000.0"] {
        let position = Position::parse(text).expect("numbers");
        assert_eq!(position.numbers(), Some(DVec2::new(750_000.0, 4_018_000.0)), "{text}");
        assert_eq!(position.in_system(&Crs::local()), Ok(DVec2::new(750_000.0, 4_018_000.0)));
    }
    assert_eq!(Position::parse("-84.2,36.3").expect("numbers").numbers(), Some(DVec2::new(-84.2, 36.3)));
}

#[test]
fn a_grid_reference_is_the_middle_of_its_square_however_it_is_spaced() {
    let zone = Crs::from_epsg(32616).expect("a zone");
    for (text, at, side_m) in [
        ("16SGF5000018000", [750_000.5, 4_018_000.5], 1.0),
        ("16S GF 50000 18000", [750_000.5, 4_018_000.5], 1.0),
        ("16 S GF 5000018000", [750_000.5, 4_018_000.5], 1.0),
        ("16sgf 500 180", [750_050.0, 4_018_050.0], 100.0),
        ("MGRS 16SGF5018", [750_500.0, 4_018_500.0], 1000.0),
        ("USNG: 16S GF 5 1", [755_000.0, 4_015_000.0], 10_000.0),
        ("16SGF", [750_000.0, 4_050_000.0], 100_000.0),
    ] {
        let position = Position::parse(text).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(position.in_system(&zone), Ok(DVec2::from(at)), "{text}");
        assert_eq!(position.side_m(), Some(side_m), "{text}");
    }
    let polar = Position::parse("ZAH 1234 5678").expect("a cap");
    let cap = Crs::from_epsg(32661).expect("UPS");
    assert_eq!(polar.in_system(&cap), Ok(DVec2::new(2_012_345.0, 2_056_785.0)), "{polar:?}");
    let single_digit = Position::parse("4QFJ12345678").expect("Hawaii");
    assert_eq!(single_digit, Position::parse("04Q FJ 1234 5678").expect("Hawaii"));
}

#[test]
fn utm_is_read_by_band_and_by_hemisphere() {
    let north = Crs::from_epsg(32633).expect("a zone");
    let at = DVec2::new(500_000.0, 5_200_000.0);
    for text in [
        "33N 500000 5200000",
        "33T 500000 5200000",
        "33 T 500000 5200000",
        "UTM 33N 500000 5200000",
        "utm zone 33 north 500000 5200000",
        "33N 500000,5200000",
        "33N 500000mE 5200000mN",
        "33N 500000 m E 5200000 m N",
        "33N E 500000 N 5200000",
        "33N N 5200000 E 500000",
        "500000 5200000 33N",
    ] {
        let position = Position::parse(text).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(position.in_system(&north), Ok(at), "{text}");
    }
    let south = Crs::from_epsg(32734).expect("a zone");
    for text in ["34S 500000 6200000", "34H 500000 6200000", "34 south 500000 6200000"] {
        let position = Position::parse(text).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(position.in_system(&south), Ok(DVec2::new(500_000.0, 6_200_000.0)), "{text}");
    }
    let cap = Crs::from_epsg(32661).expect("UPS");
    for text in ["Z 2100000 1900000", "UPS north 2100000 1900000", "ups n 2100000 1900000"] {
        let position = Position::parse(text).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(position.in_system(&cap), Ok(DVec2::new(2_100_000.0, 1_900_000.0)), "{text}");
    }
}

#[test]
fn a_letter_that_is_a_band_and_a_hemisphere_is_refused_with_both_readings() {
    let error = fault("16S 755447 4024162");
    assert!(error.contains("zone 16, band S (36.33N 84.15W)"), "{error}");
    assert!(error.contains("zone 16 on the southern hemisphere (53."), "{error}");
    assert!(error.contains("write 16 north 755447 4024162 or 16 south 755447 4024162"), "{error}");
    let [north, south] = ["16 north", "16 south"].map(|zone| lonlat(&format!("{zone} 755447 4024162")));
    assert!((north.y - 36.33).abs() < 0.01 && (south.y + 53.9).abs() < 0.2, "{north} {south}");
}

#[test]
fn degrees_are_read_with_letters_before_and_behind_in_both_orders() {
    let place = DVec2::new(-(84.0 + 12.0 / 60.0 + 54.0 / 3600.0), 36.0 + 16.0 / 60.0 + 37.2 / 3600.0);
    for text in [
        "36.277N 84.215W",
        "36.277 N, 84.215 W",
        "N36.277 W84.215",
        "N 36.277, W 84.215",
        "84.215W 36.277N",
        "W84.215 N36.277",
        "36.277° N 84.215° W",
        "36.277°N,84.215°W",
        "36,277N 84,215W",
        "36,277° N; 84,215° W",
        "36.277 north 84.215 west",
        "N 36.277 84.215 W",
        "36°16'37.2\"N 84°12'54\"W",
        "36°16′37.2″ N, 84°12′54″ W",
        "36° 16' 37.2'' N 84° 12' 54'' W",
        "36 16 37.2 N 84 12 54 W",
        "N 36 16 37.2 W 84 12 54",
        "W 84 12 54 N 36 16 37.2",
        "36-16-37.2N 084-12-54W",
        "36:16:37.2N 84:12:54W",
        "36 16.62 N 84 12.9 W",
        "36°16.62'N 84°12.9'W",
        "361637.2N 0841254W",
        "3616.62N 08412.9W",
        "lat 36.277 lon -84.215",
        "lon=-84.215, lat=36.277",
        "Latitude: 36°16'37.2\"N Longitude: 84°12'54\"W",
    ] {
        assert!(apart_m(lonlat(text), place) < 1e-3, "{text}: {}", lonlat(text));
    }
    assert_eq!(lonlat("33.5S 20.25E"), DVec2::new(20.25, -33.5));
    assert_eq!(lonlat("33N 15E"), DVec2::new(15.0, 33.0));
    assert_eq!(lonlat("33 N 15 30 E"), DVec2::new(15.5, 33.0));
    // Only one order can hold.
    assert_eq!(lonlat("36.5°, 116.25°"), DVec2::new(116.25, 36.5));
    assert_eq!(lonlat("116.25° 36.5°"), DVec2::new(116.25, 36.5));
}

#[test]
fn what_can_be_read_in_two_ways_is_refused_with_both_readings() {
    for (text, first, second) in [
        ("36.277°, -84.215°", "36.277N 84.215W", "84.215S 36.277E"),
        ("36°30'0\" 84°0'0\"", "36.5N 84E", "84N 36.5E"),
        ("-36.5S 84W", "36.5S", "36.5N"),
        ("-36.5N 84W", "36.5N", "36.5S"),
        ("48N 16O", "48N 16E", "48N 16W"),
        ("0036N 084W", "36 degrees of latitude", "0.6 degrees of latitude"),
        ("00036W 36N", "36 degrees of longitude", "0.6 degrees of longitude"),
    ] {
        let error = fault(text);
        assert!(error.contains(&format!("can be read as {first}")), "{error}");
        assert!(error.contains(&format!("or as {second}")), "{error}");
    }
}

#[test]
fn a_wrong_text_is_refused_with_what_is_wrong() {
    for (text, part) in [
        ("", "is not a position"),
        ("here", "'here' is not a position"),
        ("1", "is not a position"),
        ("1,2,3", "is not a position"),
        ("NaN,1", "is not a position"),
        ("1,inf", "is not a position"),
        ("16S", "is a zone of the grid"),
        ("GF5000018000", "has no zone"),
        ("16SGF500001800", "two equal halves"),
        ("16S GF 50000 1800", "two equal halves"),
        ("16S GF 500 00 180", "two equal halves"),
        ("16SIF50001800", "letters"),
        ("16SKF50001800", "does not lie in its zone"),
        ("16SGT50001800", "does not lie in its band"),
        ("61SGF50001800", "zone is not a number from 1 to 60"),
        ("16OGF50001800", "zone is not"),
        ("16SGF500018x", "is not a position"),
        ("61N 500000 5200000", "zone 61"),
        ("0N 500000 5200000", "zone 0"),
        ("33 500000 5200000", "has no letter of a band or hemisphere"),
        ("33Q5 500000 5200000", "is not a position"),
        ("33I 500000 5200000", "has 'I' after the zone"),
        ("33U 500000 5200000", "lies in band T, not in U"),
        ("33N 50000 5200000", "an easting of 50000"),
        ("33N 500000 9500000", "a northing of 9500000"),
        ("33S 500000 500000", "a northing of 500000"),
        ("33N 5200000 500000", "an easting of 5200000"),
        ("Y 2100000 1900000", "an easting of 2100000"),
        ("Z 2100000 190", "a northing of 190"),
        ("91N 5E", "a latitude of 91°; it goes to 90°"),
        ("5N 181W", "a longitude of 181°"),
        ("36°60'N 84°W", "has 60 minutes or seconds"),
        ("36°16'60\"N 84°W", "has 60 minutes or seconds"),
        ("36.5°16'N 84°W", "decimals before minutes"),
        ("36N 84S", "has two latitudes"),
        ("36E 84W", "has two longitudes"),
        ("36.3N 84.1", "no letter"),
        ("36N", "half of latitude and longitude"),
        ("36 16 37 84 12 54", "is not a position"),
        ("36N N84W", "is not a position"),
    ] {
        let error = fault(text);
        assert!(error.contains(part), "{text}: {error}");
    }
    let long = fault(&"9".repeat(10_000));
    assert!(long.contains("longer than any position") && long.len() < 200, "{long}");
}

#[test]
fn an_angle_by_itself_is_that_of_its_column() {
    use DegreeAxis::{Latitude, Longitude};
    for (text, axis, degrees) in [
        ("36.5", Latitude, 36.5),
        ("-84.25", Longitude, -84.25),
        ("84.25W", Longitude, -84.25),
        ("W 84°15'", Longitude, -84.25),
        ("36°30'N", Latitude, 36.5),
        ("36 30 0", Latitude, 36.5),
        ("36,5", Latitude, 36.5),
    ] {
        assert_eq!(parse_angle(text, axis), Ok(degrees), "{text}");
    }
    for (text, axis, part) in [
        ("36N", Longitude, "is not a longitude"),
        ("95", Latitude, "a latitude of 95°"),
        ("north", Latitude, "is not a position"),
        ("-5S", Latitude, "can be read as"),
    ] {
        let error = parse_angle(text, axis).expect_err(text).to_string();
        assert!(error.contains(part), "{text}: {error}");
    }
}

#[test]
fn every_form_comes_back_at_ten_thousand_places() {
    for place in places() {
        for (form, word, _) in PositionForm::WORDS {
            let text = form.write(wgs84(), place).expect("on Earth");
            let position = Position::parse(&text).unwrap_or_else(|error| panic!("{word}: {error}"));
            let back = position.in_system(wgs84()).expect("on Earth");
            let within_m = if position.side_m().is_some() { 0.72 } else { 0.03 };
            let off_m = apart_m(back, place);
            assert!(off_m <= within_m, "{word} {place}: {text} is {back}, {off_m} m off");
        }
    }
}

#[test]
fn references_are_read_as_an_independent_program_does_at_ten_thousand_places() {
    for (index, place) in places().enumerate() {
        let theirs = geoconvert::LatLon::create(place.y, place.x).expect("in range");
        let digits = (index % 6) as i32;
        let reference = theirs.to_mgrs(digits);
        let text = reference.to_string();
        let position = Position::parse(&text).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(position, Position::parse(&spaced(&text)).expect("with spaces"), "{text}");
        let expected = geoconvert::Mgrs::parse_str(&text).expect("its own").to_latlon();
        let expected = DVec2::new(expected.longitude(), expected.latitude());
        let ours = position.in_system(wgs84()).expect("on Earth");
        assert!(apart_m(ours, expected) < 1e-3, "{text}: {ours}, {expected}");
        assert_eq!(position.side_m(), Some(10f64.powi(5 - digits)));
        let utm = theirs.to_utmups();
        let zone = match (utm.zone(), utm.is_north()) {
            (0, true) => "UPS north".to_owned(),
            (0, false) => "UPS south".to_owned(),
            (zone, true) => format!("{zone} north"),
            (zone, false) => format!("{zone} south"),
        };
        let text = format!("{zone} {} {}", utm.easting(), utm.northing());
        assert!(apart_m(lonlat(&text), place) < 1e-3, "{text}: {place}");
    }
}

#[test]
fn norway_svalbard_and_the_edges_of_zones_are_written_in_their_zones() {
    let write = |form: PositionForm, x: f64, y: f64| form.write(wgs84(), DVec2::new(x, y)).expect("on Earth");
    for (x, y, start) in [
        (5.3, 60.4, "32V"),
        (2.999_999, 60.4, "31V"),
        (8.999_999, 78.0, "31X"),
        (9.0, 78.0, "33X"),
        (20.999_999, 78.0, "33X"),
        (21.0, 78.0, "35X"),
        (33.0, 78.0, "37X"),
        (6.0, 0.0, "32N"),
        (5.999_999, -0.000_001, "31M"),
        (-180.0, 10.0, "01P"),
        (179.999_999, 10.0, "60P"),
        (10.0, 84.0, "Z"),
        (10.0, 83.999_999, "33X"),
        (-10.0, 88.0, "Y"),
        (10.0, -80.0, "32C"),
        (10.0, -80.001, "B"),
    ] {
        let text = write(PositionForm::Mgrs, x, y);
        assert!(text.starts_with(start), "{x} {y}: {text}");
        assert!(apart_m(lonlat(&text), DVec2::new(x, y)) < 0.8, "{text}");
    }
    assert_eq!(write(PositionForm::Utm, -84.5, 36.0).split(' ').next(), Some("16N"));
    assert_eq!(write(PositionForm::Utm, 20.0, -34.0).split(' ').next(), Some("34S"));
    assert!(write(PositionForm::Utm, -59.0, -52.0).starts_with("21 south "), "the Falklands");
    let carried = write(PositionForm::Seconds, -0.999_999_999_9, 9.999_999_999_9);
    assert_eq!(carried, "10°00′00.000″N 1°00′00.000″W");
}

#[test]
fn coordinates_of_a_zone_keep_their_meter_in_a_reference() {
    let zone = Crs::from_epsg(32616).expect("a zone");
    let at = DVec2::new(750_000.0, 4_018_000.0);
    assert_eq!(PositionForm::Usng.write(&zone, at).expect("in it"), "16S GF 50000 18000");
    assert_eq!(PositionForm::Utm.write(&zone, at).expect("in it"), "16N 750000.00 4018000.00");
    let place = zone.transform(wgs84(), at).expect("in it");
    assert_eq!(PositionForm::Mgrs.write(wgs84(), place).expect("in it"), "16SGF5000018000");
    assert!(PositionForm::Mgrs.write(&Crs::local(), at).is_err());
}

proptest::proptest! {
    #[test]
    fn no_text_breaks_the_reader(text in "[-0-9NSEWnsewzZA-H ,.;°'\"′″+:/]{0,40}") {
        if let Ok(position) = Position::parse(&text)
            && let Ok(at) = position.in_system(wgs84())
        {
            proptest::prop_assert!(at.is_finite());
        }
    }

    #[test]
    fn no_characters_break_the_reader(text in ".{0,60}") {
        let _ = Position::parse(&text);
        let _ = parse_angle(&text, DegreeAxis::Latitude);
    }
}
