//! Overlays and scenarios of other people, against what other readers make of them.

use sandtable_symbology::code::SymbolCode;
use sandtable_vector::feature::{Feature, VectorLayer};
use sandtable_vector::hints::VectorHints;
use sandtable_vector::read::read;

use crate::common::data::data;

fn layer(path: &str, wanted: Option<&str>) -> Option<VectorLayer> {
    let file = data(path)?;
    let bytes = std::fs::read(&file).expect("readable");
    let hints = VectorHints { layer: wanted, ..VectorHints::default() };
    Some(read(&file.to_string_lossy(), &bytes, &hints).unwrap_or_else(|error| panic!("{path}: {error}")))
}

fn text<'a>(feature: &'a Feature, property: &str) -> &'a str {
    feature.properties.get(property).and_then(|value| value.as_str()).unwrap_or_default()
}

/// A unit or a piece of equipment as `@orbat-mapper/msdllib` 0.4.0 has it: name, code with its status stated, longitude, latitude.
/// The library gives equipment no side: the letter of affiliation here is that of the organization that holds it, else of the unit
/// that it is organic to.
type Known = (&'static str, &'static str, f64, f64);

const FIRST: Known = ("1th", "SFGPUCI----F--G", 15.037_536_621_093_752, 58.544_051_668_111_53);
const SECOND: Known = ("2nd", "SFGPUCI----F--G", 15.039_854_049_682_619, 58.543_922_896_245_405);
const THIRD: Known = ("3th", "SFGPUCI----F--G", 15.039_854_049_682_619, 58.543_922_896_245_405);
const HOSTILE_FIRST: Known = ("1th", "SHGPUCI----F--G", 15.040_111_541_748_049, 58.541_834_486_453_8);
const HOSTILE_SECOND: Known = ("2nd", "SHGPUCI----F--G", 15.044_896_602_630_617, 58.541_207_379_330_466);
const TANK: Known = ("111", "SFGPEVAT------G", 15.040_084, 58.538_208);
/// In geocentric coordinates; organic to a friendly unit, held by the hostile side.
const CARRIER: Known =
    ("2nd SQD IFV/3/1/1/A", "SHGP----------G", 47.303_492_839_517_716, 40.254_191_425_915_096);

fn holds(path: &str, expected: &[Known], left_out: usize) {
    let Some(found) = layer(path, None) else { return };
    let names: Vec<&str> = found.features.iter().map(|unit| text(unit, "name")).collect();
    assert_eq!(names, expected.iter().map(|known| known.0).collect::<Vec<_>>(), "{path}");
    for (unit, (name, code, longitude, latitude)) in found.features.iter().zip(expected) {
        assert_eq!(text(unit, "sidc"), *code, "{path}: {name}");
        SymbolCode::parse(code).unwrap_or_else(|error| panic!("{path}: {name}: {error}"));
        let at = unit.points()[0];
        assert!((at.x - longitude).abs() < 1e-9 && (at.y - latitude).abs() < 1e-9, "{path}: {name}: {at}");
    }
    let told = format!("{left_out} things are left out: neither they nor units above them have a place");
    let faults = found.faults.join("\n");
    assert_eq!(faults.contains(&told), left_out > 0, "{path}: {faults}");
}

#[test]
fn scenarios_of_msdl_hold_the_units_that_msdllib_finds_with_their_places_and_sides() {
    let test = ("TEST TEST", "SUGP----------G", CARRIER.2, CARRIER.3);
    holds(
        "military/msdl/SimpleScenario.xml",
        &[FIRST, SECOND, HOSTILE_FIRST, HOSTILE_SECOND, TANK, CARRIER, test],
        2,
    );
    holds(
        "military/msdl/SimpleScenarioNETN.xml",
        &[FIRST, SECOND, HOSTILE_FIRST, HOSTILE_SECOND, TANK, CARRIER],
        2,
    );
    let (second, third) = (("112", TANK.1, TANK.2, TANK.3), ("113", TANK.1, TANK.2, TANK.3));
    holds(
        "military/msdl/TestScenario2.xml",
        &[FIRST, SECOND, THIRD, HOSTILE_SECOND, TANK, second, third, CARRIER],
        2,
    );
    for empty in ["military/msdl/minimal.xml", "military/msdl/ForceSideMinimal.xml"] {
        holds(empty, &[], 0);
    }
}

#[test]
fn units_of_msdl_have_their_side_superior_fields_and_time() {
    let Some(units) = layer("military/msdl/SimpleScenario.xml", Some("units")) else { return };
    let unit = &units.features[2];
    let expected = [
        ("side", "Army"),
        ("parent", "HQ2"),
        ("combat_effectiveness", "GREEN"),
        ("direction", "175.37999"),
        ("speed", "4"),
        ("begin", "2025-07-09T11:11:00Z"),
        ("unique_designation", "1th"),
    ];
    for (property, value) in expected {
        assert_eq!(text(unit, property), value, "{property}");
    }
    let Some(equipment) = layer("military/msdl/SimpleScenario.xml", Some("equipment")) else { return };
    let tank = &equipment.features[0];
    assert_eq!([text(tank, "quantity"), text(tank, "type"), text(tank, "parent")], ["1", "M1A1", "1th"]);
    let faults = equipment.faults.join("\n");
    assert!(faults.contains("1 thing is under a unit that the file does not have ('TEST TEST'"), "{faults}");
}

#[test]
fn the_sample_of_nvg_has_nine_elements_with_their_shapes_on_the_ground() {
    let Some(sample) = layer("military/nvg/sample.xml", None) else { return };
    let found: Vec<(&str, &str, usize)> = sample
        .features
        .iter()
        .map(|element| (text(element, "name"), element.geometry.kind(), element.geometry.vertices().count()))
        .collect();
    let expected = [
        ("Styled Arrow", "polygons", 9),
        ("Blue Corridor", "polygons", 6),
        ("yellow Corridor", "polygons", 6),
        ("black corridor", "lines", 3),
        ("red Corridor", "polygons", 6),
        ("green Corridor", "polygons", 6),
        ("Enemy line", "lines", 3),
        ("Styled circle", "polygons", 128 + 4),
        ("Styled arcband", "polygons", 38),
    ];
    assert_eq!(found, expected);
    assert!(sample.faults.is_empty(), "{:?}", sample.faults);
    let [arrow, blue, .., circle, band] = &sample.features[..] else { panic!("nine") };
    assert_eq!((arrow.properties["stroke-width"].as_f64(), text(arrow, "fill")), (Some(5.0), "none"));
    assert_eq!((text(blue, "stroke"), blue.properties["width"].as_f64()), ("#0000ff", Some(5000.0)));
    assert_eq!((text(circle, "fill"), text(circle, "stroke-dasharray")), ("#66ff66", "15"));
    assert_eq!(band.properties["fill-opacity"].as_f64(), Some(0.4));
    let code = SymbolCode::parse(text(&sample.features[3], "sidc")).expect("an air corridor");
    assert_eq!(code.entity, 170_100);
}

#[test]
fn layers_of_milx_hold_their_graphics_with_codes_fields_and_colors() {
    let counts = ["Friend", "Hostile"].map(|name| layer("military/milx/overlay.milxly", Some(name)));
    let [Some(friend), Some(hostile)] = counts else { return };
    assert_eq!((friend.features.len(), hostile.features.len()), (6, 3));
    assert!(friend.faults.is_empty() && hostile.faults.is_empty());
    for unit in friend.features.iter().chain(&hostile.features) {
        let code = text(unit, "sidc");
        SymbolCode::parse(code).unwrap_or_else(|error| panic!("{code}: {error}"));
    }
    let company = &friend.features[1];
    let fields = ["sidc", "higher_formation", "marker-color", "layer"].map(|key| text(company, key));
    assert_eq!(fields, ["SFGPUCIA---D--G", "3", "#ff8000", "Friend"]);
    let at = company.points()[0];
    assert!((at.x + 58.929_023_566).abs() < 1e-8 && (at.y + 51.647_640_183).abs() < 1e-8, "{at}");
    assert_eq!(text(&hostile.features[0], "unique_designation"), "2BN");
}

/// The distinct things of a layer, and how many of its features have a code that is drawn without a note.
fn drawn_whole(layer: &VectorLayer) -> (usize, usize, usize) {
    let ids: std::collections::BTreeSet<&str> = layer.features.iter().map(|unit| text(unit, "id")).collect();
    let codes: Vec<&str> =
        layer.features.iter().map(|unit| text(unit, "sidc")).filter(|code| !code.is_empty()).collect();
    let is_whole = |code: &&&str| {
        let code = SymbolCode::parse(code).unwrap_or_else(|error| panic!("{code}: {error}"));
        sandtable_symbology::symbol::MilitarySymbol::new(&code).is_some_and(|symbol| symbol.notes.is_empty())
    };
    (ids.len(), codes.len(), codes.iter().filter(is_whole).count())
}

#[test]
fn scenarios_of_orbat_mapper_hold_every_unit_with_a_place_and_draw_it_whole() {
    // Of 139 units 53 have a place in some state, and 22 are below one of them.
    let Some(falklands) = layer("military/orbat/falkland82.json", Some("units")) else { return };
    let (units, states, whole) = drawn_whole(&falklands);
    assert_eq!((units, states, whole), (75, 154, 154));
    let notes = falklands.notes.join("\n");
    for told in ["22 units are where the units above them are", "left out: 64 units without a place"] {
        assert!(notes.contains(told), "{notes}");
    }
    let Some(narvik) = layer("military/orbat/narvik40.json", Some("units")) else { return };
    let (units, states, whole) = drawn_whole(&narvik);
    assert_eq!((units, states, whole), (10, 24, 24));
    // 12 states of 9 items that are shown.
    let Some(measures) = layer("military/orbat/controlMeasureScenario.json", None) else { return };
    assert_eq!(measures.features.len(), 12);
}
