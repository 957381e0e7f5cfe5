//! MSDL scenarios that are read.

use super::*;
use crate::feature::Feature;
use crate::read;
use glam::DVec2;

fn scenario(organizations: &str) -> String {
    format!(
        "<MilitaryScenario xmlns='urn:sisostds:scenario:military:data:draft:msdl:1'><ForceSides>\
         <ForceSide><ObjectHandle>b</ObjectHandle><ForceSideName>Blue</ForceSideName><AllegianceHandle>b</AllegianceHandle>\
         <Associations><Association><AffiliateHandle>r</AffiliateHandle><Relationship>HO</Relationship></Association></Associations></ForceSide>\
         <ForceSide><ObjectHandle>r</ObjectHandle><ForceSideName>Red</ForceSideName><AllegianceHandle>r</AllegianceHandle></ForceSide>\
         <ForceSide><ObjectHandle>rr</ObjectHandle><ForceSideName>Red reserve</ForceSideName><AllegianceHandle>r</AllegianceHandle></ForceSide>\
         <ForceSide><ObjectHandle>x</ObjectHandle><ForceSideName>Others</ForceSideName></ForceSide></ForceSides>\
         <Organizations>{organizations}</Organizations></MilitaryScenario>"
    )
}

fn unit(handle: &str, code: &str, location: &str, relations: &str) -> String {
    format!(
        "<Unit><ObjectHandle>{handle}</ObjectHandle><SymbolIdentifier>{code}</SymbolIdentifier><Name>{handle}</Name>\
         <UnitSymbolModifiers><Echelon>BATTALION</Echelon><HigherFormation>3 BDE</HigherFormation><ReinforcedReduced>R</ReinforcedReduced></UnitSymbolModifiers>\
         <Disposition>{location}<DirectionOfMovement>175</DirectionOfMovement></Disposition><Relations>{relations}</Relations></Unit>"
    )
}

fn at(kind: &str, parts: &[(&str, &str)]) -> String {
    let parts: String = parts.iter().map(|(name, text)| format!("<{name}>{text}</{name}>")).collect();
    format!(
        "<Location><CoordinateChoice>{kind}</CoordinateChoice><CoordinateData><{kind}>{parts}</{kind}></CoordinateData></Location>"
    )
}

fn of_side(handle: &str) -> String {
    format!(
        "<ForceRelation><ForceRelationData><ForceSideHandle>{handle}</ForceSideHandle></ForceRelationData></ForceRelation>"
    )
}

fn under(handle: &str) -> String {
    format!(
        "<ForceRelation><ForceRelationData><CommandRelation><CommandingSuperiorHandle>{handle}</CommandingSuperiorHandle></CommandRelation></ForceRelationData></ForceRelation>"
    )
}

fn layer(organizations: &str) -> VectorLayer {
    read::read("a.xml", scenario(organizations).as_bytes(), &VectorHints::default()).expect("a scenario")
}

fn text<'a>(feature: &'a Feature, property: &str) -> &'a str {
    feature.properties.get(property).and_then(serde_json::Value::as_str).unwrap_or_default()
}

const GDC: [(&str, &str); 2] = [("Latitude", "58.5"), ("Longitude", "15.0")];

#[test]
fn units_have_the_affiliation_of_their_side_their_echelon_and_fields() {
    let body = ["b", "r", "rr", "x"]
        .map(|side| unit(side, "S-G-UCI-------G", &at("GDC", &GDC), &of_side(side)))
        .concat();
    let layer = layer(&format!("<Units>{body}</Units>"));
    let codes: Vec<&str> = layer.features.iter().map(|unit| text(unit, "sidc")).collect();
    assert_eq!(codes, ["SFGPUCI----F--G", "SHGPUCI----F--G", "SHGPUCI----F--G", "SUGPUCI----F--G"]);
    let first = &layer.features[0];
    let fields = [
        ("side", "Blue"),
        ("higher_formation", "3 BDE"),
        ("reinforced", "(+)"),
        ("direction", "175"),
        ("unique_designation", "b"),
    ];
    for (property, expected) in fields {
        assert_eq!(text(first, property), expected, "{property}");
    }
}

#[test]
fn places_in_all_four_systems_are_one() {
    let forms = [
        at("GDC", &GDC),
        at("GCC", &[("X", "3226874.7725"), ("Y", "864638.4894"), ("Z", "5415043.0189")]),
        at("UTM", &[("UTMGridZone", "33V"), ("UTMEasting", "500000"), ("UTMNorthing", "6484378.9")]),
        at(
            "MGRS",
            &[
                ("MGRSGridZone", "33V"),
                ("MGRSGridSquare", "WE"),
                ("MGRSEasting", "0"),
                ("MGRSNorthing", "84378"),
            ],
        ),
    ];
    let body: String = forms
        .iter()
        .enumerate()
        .map(|(n, form)| unit(&n.to_string(), "S-G-UCI-------G", form, &of_side("b")))
        .collect();
    let layer = layer(&format!("<Units>{body}</Units>"));
    assert_eq!(layer.features.len(), 4, "{:?}", layer.faults);
    for unit in &layer.features {
        let off = (unit.points()[0] - DVec2::new(15.0, 58.5)).abs();
        assert!(off.x < 2e-4 && off.y < 2e-4, "{}: {}", text(unit, "id"), unit.points()[0]);
    }
}

#[test]
fn things_without_a_place_are_with_the_unit_above_them_also_where_a_file_runs_in_a_circle() {
    let body = unit("a", "S-G-UCI-------G", &at("GDC", &GDC), &of_side("r"))
        + &unit("b", "S-G-UCI-------G", "", &under("a"))
        + &unit("c", "S-G-UCI-------G", "", &under("d"))
        + &unit("d", "S-G-UCI-------G", "", &under("c"));
    let layer = layer(&format!("<Units>{body}</Units>"));
    assert_eq!(layer.features.len(), 2);
    assert_eq!([text(&layer.features[1], "parent"), text(&layer.features[1], "side")], ["a", "Red"]);
    assert_eq!(text(&layer.features[1], "sidc"), "SHGPUCI----F--G");
    assert!(layer.notes.join("\n").contains("1 thing is where the unit above it is"), "{:?}", layer.notes);
    assert!(layer.faults.join("\n").contains("2 things are left out: neither they"), "{:?}", layer.faults);
}

#[test]
fn layers_are_chosen_by_name_and_odd_places_are_told() {
    let body = unit("a", "S-G-UCI-------G", &at("GDC", &[("Latitude", "95"), ("Longitude", "15")]), "")
        + &unit(
            "b",
            "S-G-UCI-------G",
            &at("UTM", &[("UTMGridZone", "99V"), ("UTMEasting", "1"), ("UTMNorthing", "1")]),
            "",
        )
        + &unit("c", "S-G-UCI-------G", &at("GDC", &GDC), "");
    let text = scenario(&format!(
        "<Units>{body}</Units><Equipment><EquipmentItem><Name>T</Name><Disposition>{}</Disposition></EquipmentItem></Equipment>",
        at("GDC", &GDC)
    ));
    let of = |layer| {
        read::read("a.xml", text.as_bytes(), &VectorHints { layer: Some(layer), ..VectorHints::default() })
    };
    let units = of("units").expect("units");
    assert_eq!(units.features.len(), 1);
    assert!(
        units.faults[0].contains("(15, 95) is no longitude") && units.faults[0].contains("'99V' is no zone"),
        "{:?}",
        units.faults
    );
    assert_eq!(of("equipment").expect("equipment").features.len(), 1);
    assert!(of("unit").expect_err("no layer").to_string().contains("did you mean 'units'?"));
}

#[test]
fn what_a_file_leaves_open_is_told() {
    let location = at("GDC", &GDC);
    let body = unit("a", "S-G-UCI-------G", &location, "")
        + &unit("b", "infantry", &location, &of_side("b"))
        + &unit("c", "SNG-UCI-------G", &location, &under("nobody"));
    let layer = layer(&format!("<Units>{body}</Units>"));
    let codes: Vec<&str> = layer.features.iter().map(|unit| text(unit, "sidc")).collect();
    assert_eq!(codes, ["SUGPUCI----F--G", "", "SNGPUCI----F--G"]);
    let faults = layer.faults.join("\n");
    for part in ["1 thing has no symbol code", "1 thing is of no side", "1 thing is under a unit"] {
        assert!(faults.contains(part), "{part}: {faults}");
    }
}

#[test]
fn a_chain_of_units_as_long_as_a_file_takes_no_longer_than_it_has_units() {
    const COUNT: usize = 50_000;
    let parents: Vec<Option<usize>> =
        (0..COUNT).map(|index| (index + 1 < COUNT).then_some(index + 1)).collect();
    assert!(nearest(&parents, |index| index == COUNT - 1).iter().all(|found| *found == Some(COUNT - 1)));
    let circle: Vec<Option<usize>> = (0..COUNT).map(|index| Some((index + 1) % COUNT)).collect();
    assert!(nearest(&circle, |_| false).iter().all(Option::is_none));
    assert_eq!(nearest(&[Some(1), Some(0), Some(0)], |index| index == 1), [Some(1); 3]);
}

#[test]
fn equipment_is_of_the_side_of_its_owner_and_what_stands_still_has_no_direction() {
    let item = |name: &str, relations: &str| {
        format!(
            "<EquipmentItem><Name>{name}</Name><SymbolIdentifier>S-G-EVAT------G</SymbolIdentifier><EquipmentSymbolModifiers>\
             <Quantity>4</Quantity><EquipmentType>M1A1</EquipmentType></EquipmentSymbolModifiers><Disposition>{}\
             <DirectionOfMovement>90</DirectionOfMovement><Speed>0.0</Speed></Disposition><Relations>{relations}</Relations></EquipmentItem>",
            at("GDC", &GDC)
        )
    };
    let owner = "<HoldingOrganization><OwnerChoice>FORCE_SIDE</OwnerChoice><OwnerData><ForceOwnerHandle> r </ForceOwnerHandle></OwnerData></HoldingOrganization>";
    let layer = layer(&format!("<Equipment>{}</Equipment>", item("tank", owner)));
    let tank = &layer.features[0];
    assert_eq!(
        ["sidc", "quantity", "type", "direction"].map(|key| text(tank, key)),
        ["SHGPEVAT------G", "4", "M1A1", ""]
    );
}

#[test]
fn grid_references_are_as_precise_as_they_say() {
    let reference = |precision: &str, easting: &str, northing: &str| {
        let parts = [
            ("MGRSGridZone", "11S"),
            ("MGRSGridSquare", "NV"),
            ("MGRSPrecision", precision),
            ("MGRSEasting", easting),
            ("MGRSNorthing", northing),
        ];
        layer(&format!("<Units>{}</Units>", unit("a", "S-G-U---------G", &at("MGRS", &parts), ""))).features
            [0]
        .points()[0]
    };
    let exact = reference("5", "31919", "10790");
    assert!((reference("3", "319", "107") - exact).abs().max_element() < 1e-3);
    assert!((reference("5", "31919.9", "10790") - exact).abs().max_element() < 1e-9);
    assert!((reference("5", "919", "790") - reference("5", "00919", "00790")).abs().max_element() < 1e-12);
}
