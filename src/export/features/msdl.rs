//! Symbols and graphics as a scenario of the Military Scenario Definition Language 1.0 (SISO-STD-007-2008): a side for each identity,
//! units, equipment and tactical graphics with codes of letters.

use glam::DVec3;

use super::nvg::left_out;
use super::xml_text::XmlText;
use super::{ExportFeature, ExportLayer, ExportShape, ExportedFeatures, FeatureExportError, MadeFile};
use sandtable_base::message::numbers::trimmed;
use sandtable_scene::scene_model::SceneModel;
use sandtable_symbology::code::SymbolCode;
use sandtable_symbology::fields::{SymbolIdentity, SymbolSet};
use sandtable_vector::overlay_schema as schema;

const HELD: [&str; 4] = ["symbols", "graphic_points", "graphic_lines", "graphic_areas"];

/// The sides, with what each is to the first.
const SIDES: [(&str, &str); 4] =
    [("Friendly", "FR"), ("Hostile", "HO"), ("Neutral", "NE"), ("Unknown", "UN")];

/// The texts of `UnitSymbolModifiers` by property.
const MODIFIERS: [(&str, &str); 10] = [
    ("AdditionalInfo", schema::ADDITIONAL_INFORMATION),
    ("CombatEffectiveness", schema::COMBAT_EFFECTIVENESS),
    ("EvaluationRating", schema::EVALUATION_RATING),
    ("HigherFormation", schema::HIGHER_FORMATION),
    ("IFF", schema::IFF),
    ("Quantity", schema::QUANTITY),
    ("ReinforcedReduced", schema::REINFORCED),
    ("SpecialC2HQ", schema::SPECIAL_HEADQUARTERS),
    ("StaffComments", schema::STAFF_COMMENTS),
    ("UniqueDesignation", schema::UNIQUE_DESIGNATION),
];

/// A thing with its code in letters.
struct Coded<'a> {
    feature: &'a ExportFeature,
    letters: String,
    side: usize,
    is_equipment: bool,
}

/// The file.
///
/// # Errors
/// [`FeatureExportError::Empty`].
pub(super) fn file(
    layers: &[ExportLayer],
    title: &str,
    scene: &SceneModel,
) -> Result<MadeFile, FeatureExportError> {
    let (held, left): (Vec<&ExportLayer>, Vec<&ExportLayer>) =
        layers.iter().partition(|layer| HELD.contains(&layer.name));
    let (mut things, mut graphics, mut codeless) = (Vec::new(), Vec::new(), 0usize);
    for layer in &held {
        for feature in &layer.features {
            match coded(feature, scene) {
                Some(coded) if layer.name == "symbols" => things.push(coded),
                Some(coded) => graphics.push(coded),
                None => codeless += 1,
            }
        }
    }
    if things.is_empty() && graphics.is_empty() {
        return Err(FeatureExportError::Empty("an .msdl"));
    }
    let mut notes = left_out(&left, "MSDL");
    if codeless > 0 {
        let what = if codeless == 1 { "symbol or graphic" } else { "symbols or graphics" };
        notes.push(format!("left out: {codeless} {what} without a code of 15 letters (MIL-STD-2525C), which MSDL writes; an .nvg has them"));
    }
    let told =
        ExportedFeatures { layers: vec![("symbols", things.len()), ("graphics", graphics.len())], notes };
    Ok(MadeFile { bytes: scenario(&things, &graphics, title).into_bytes(), told })
}

fn coded<'a>(feature: &'a ExportFeature, scene: &SceneModel) -> Option<Coded<'a>> {
    let code = match feature.symbol {
        Some(index) => scene.military.get(index)?.code,
        None => SymbolCode::parse(feature.properties.get(schema::SIDC)?.as_str()?).ok()?,
    };
    let side = match code.identity {
        SymbolIdentity::Friend | SymbolIdentity::AssumedFriend => 0,
        SymbolIdentity::Hostile | SymbolIdentity::Suspect => 1,
        SymbolIdentity::Neutral => 2,
        _ => 3,
    };
    let is_equipment = !matches!(code.set, SymbolSet::LandUnit);
    Some(Coded { feature, letters: code.letters()?, side, is_equipment })
}

/// A handle as the schema has it: a UUID, of a kind and a number.
fn handle(kind: u16, number: usize) -> String {
    format!("00000000-0000-4000-8{:03x}-{number:012x}", kind & 0xfff)
}

fn scenario(things: &[Coded<'_>], graphics: &[Coded<'_>], title: &str) -> String {
    let mut xml = XmlText::new();
    xml.open(
        "MilitaryScenario",
        &[
            ("xmlns", "urn:sisostds:scenario:military:data:draft:msdl:1"),
            ("xmlns:modelID", "http://www.sisostds.org/schemas/modelID"),
        ],
    );
    xml.open("ScenarioID", &[]);
    xml.element("modelID:name", title).element("modelID:type", "BOM").element("modelID:version", "1.0");
    xml.element("modelID:modificationDate", "2000-01-01")
        .element("modelID:securityClassification", "Unclassified");
    xml.element("modelID:description", title);
    xml.open("modelID:poc", &[])
        .element("modelID:pocType", "Sponsor")
        .element("modelID:pocName", "-")
        .close()
        .close();
    xml.open("Options", &[]).element("MSDLVersion", "1.0");
    xml.open("ScenarioDataStandards", &[]).open("SymbologyDataStandard", &[]);
    xml.element("StandardName", "MILSTD_2525C").element("MajorVersion", "C").element("MinorVersion", "0");
    xml.close().close().close();
    xml.element("Environment", "");
    sides(&mut xml);
    xml.open("Organizations", &[]).open("Units", &[]);
    for (number, unit) in things.iter().enumerate().filter(|(_, thing)| !thing.is_equipment) {
        thing(&mut xml, ("Unit", "UnitSymbolModifiers"), unit, number);
    }
    xml.close().open("Equipment", &[]);
    for (number, item) in things.iter().enumerate().filter(|(_, thing)| thing.is_equipment) {
        thing(&mut xml, ("EquipmentItem", "EquipmentSymbolModifiers"), item, number);
    }
    xml.close().close();
    xml.open("TacticalGraphics", &[]);
    for (number, drawn) in graphics.iter().enumerate() {
        graphic(&mut xml, drawn, number);
    }
    xml.finish()
}

fn sides(xml: &mut XmlText) {
    xml.open("ForceSides", &[]);
    for (number, (name, _)) in SIDES.iter().enumerate() {
        xml.open("ForceSide", &[]).element("ObjectHandle", &handle(1, number)).element("ForceSideName", name);
        xml.element("AllegianceHandle", &handle(1, number));
        if number == 0 {
            xml.open("Associations", &[]);
            for (other, (_, relation)) in SIDES.iter().enumerate().skip(1) {
                xml.open("Association", &[]).element("AffiliateHandle", &handle(1, other));
                xml.element("Relationship", relation).close();
            }
            xml.close();
        }
        xml.close();
    }
    xml.close();
}

fn thing(xml: &mut XmlText, (element, modifiers): (&str, &str), coded: &Coded<'_>, number: usize) {
    let feature = coded.feature;
    xml.open(element, &[])
        .element("ObjectHandle", &handle(2, number))
        .element("SymbolIdentifier", &coded.letters);
    xml.element("Name", &feature.text(schema::NAME));
    xml.open(modifiers, &[]);
    for (name, property) in MODIFIERS {
        let stated = feature.text(property);
        let stated = match (property, stated.as_str()) {
            (schema::REINFORCED, "(+)") => "R".to_owned(),
            (schema::REINFORCED, "(-)" | "(\u{2212})") => "D".to_owned(),
            (schema::REINFORCED, "(±)") => "RD".to_owned(),
            _ => stated,
        };
        if !stated.is_empty() {
            xml.element(name, &stated);
        }
    }
    let kind = feature.text(schema::TYPE);
    if coded.is_equipment && !kind.is_empty() {
        xml.element("EquipmentType", &kind);
    }
    xml.close();
    xml.open("Disposition", &[]);
    if let ExportShape::Point(at) = &feature.shape {
        location(xml, at);
    }
    let direction = feature.text(schema::DIRECTION);
    if !direction.is_empty() {
        xml.element("DirectionOfMovement", &direction);
    }
    xml.close();
    relation(xml, coded.side);
    xml.close();
}

fn relation(xml: &mut XmlText, side: usize) {
    xml.open("Relations", &[]).open("ForceRelation", &[]).element("ForceRelationChoice", "FORCE_SIDE");
    xml.open("ForceRelationData", &[]).element("ForceSideHandle", &handle(1, side));
    xml.close().close().close();
}

fn location(xml: &mut XmlText, at: &DVec3) {
    xml.open("Location", &[]).element("CoordinateChoice", "GDC").open("CoordinateData", &[]).open("GDC", &[]);
    xml.element("Latitude", &trimmed(at.y, 9))
        .element("Longitude", &trimmed(at.x, 9))
        .element("ElevationAGL", "0");
    xml.close().close().close();
}

fn graphic(xml: &mut XmlText, coded: &Coded<'_>, number: usize) {
    let feature = coded.feature;
    xml.open("TacticalGraphic", &[])
        .element("ObjectHandle", &handle(3, number))
        .element("SymbolIdentifier", &coded.letters);
    xml.element("Name", &feature.text(schema::UNIQUE_DESIGNATION));
    xml.open("TacticalGraphicSymbolModifiers", &[]);
    let designation = feature.text(schema::UNIQUE_DESIGNATION);
    if !designation.is_empty() {
        xml.element("UniqueDesignation", &designation);
    }
    xml.close();
    xml.open("Disposition", &[]).open("AnchorPoints", &[]);
    let points: Vec<&DVec3> = match &feature.shape {
        ExportShape::Point(at) => vec![at],
        ExportShape::Line(line) => line.iter().collect(),
        ExportShape::Polygon(rings) => rings.iter().take(1).flatten().collect(),
    };
    for at in points {
        xml.open("AnchorPoint", &[]);
        location(xml, at);
        xml.close();
    }
    xml.close().close();
    relation(xml, coded.side);
    xml.close();
}
