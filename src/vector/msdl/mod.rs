//! Scenarios of the Military Scenario Definition Language 1.0 (SISO-STD-007-2008) and of its NETN variant: units, equipment,
//! installations and tactical graphics with codes of MIL-STD-2525, on WGS 84.
//!
//! A code's letter of affiliation is what the thing's side is to the first side of the file, as its associations say. A thing
//! without a place of its own is where the unit above it is, and a note says of how many that holds. Layers are `units`,
//! `equipment`, `installations` and `graphics`.

mod place;
mod sides;

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec3;

use crate::builder::{FeatureParts, LayerBuilder};
use crate::error::VectorError;
use crate::feature::{Properties, VectorLayer};
use crate::hints::VectorHints;
use crate::moment::Moment;
use crate::overlay_schema::{
    ADDITIONAL_INFORMATION, ALTITUDE, BEGIN, COMBAT_EFFECTIVENESS, DIRECTION, DTG, EVALUATION_RATING,
    HIGHER_FORMATION, ID, IFF, LAYER, LOCATION, NAME, PARENT, QUANTITY, REINFORCED, SIDC, SIDE,
    SPECIAL_HEADQUARTERS, SPEED, STAFF_COMMENTS, TYPE, UNIQUE_DESIGNATION, bare_code, set,
};
use crate::tally::RecordTally;
use crate::xml::{self, DecodedXml, XmlElement, XmlReader};
use sandtable_geom::crs::Crs;

use sides::ForceSides;

const FORMAT: &str = "MSDL scenario";
const LAYERS: [&str; 4] = ["units", "equipment", "installations", "graphics"];
/// The position of the echelon in a code of letters.
const ECHELON_LETTER: usize = 11;

/// Reads all things of a scenario, or those of the layer that is asked for.
///
/// # Errors
/// [`VectorError`], also where nothing is sound.
pub(super) fn read(bytes: &[u8], hints: &VectorHints) -> Result<VectorLayer, VectorError> {
    let DecodedXml { text, fault } = xml::decode(bytes, FORMAT)?;
    let wanted = hints.layer.map(|_| hints.choose_layer(&LAYERS)).transpose()?;
    let mut reader = MsdlReader {
        xml: XmlReader::new(&text, FORMAT),
        sides: ForceSides::default(),
        things: Vec::new(),
        begin: None,
    };
    reader.xml.root()?;
    reader.read_parts()?;
    reader.xml.finish()?;
    let MsdlReader { sides, things, begin, .. } = reader;
    let mut builder = LayerBuilder::new(hints.crs.cloned().unwrap_or_else(Crs::wgs84));
    let wanted = wanted.map(|index| LAYERS[index]);
    Placing { sides: &sides, things: &things, by_handle: by_handle(&things), begin }
        .add(wanted, &mut builder);
    fault.into_iter().for_each(|fault| builder.fault(fault));
    builder.finish()
}

/// A unit, a piece of equipment, an installation or a graphic, as the file has it.
struct MsdlThing {
    layer: &'static str,
    handle: String,
    line: String,
    code: Option<String>,
    properties: Properties,
    /// Its places, or why there are none.
    places: Result<Vec<DVec3>, String>,
    /// The handle of the unit above it.
    superior: Option<String>,
    /// The handle of its side.
    side: Option<String>,
}

struct MsdlReader<'a> {
    xml: XmlReader<'a>,
    sides: ForceSides,
    things: Vec<MsdlThing>,
    begin: Option<Moment>,
}

impl MsdlReader<'_> {
    /// Reads the children of the open element: the parts of a scenario, and the lists in them.
    fn read_parts(&mut self) -> Result<(), VectorError> {
        while let Some(child) = self.xml.next_child()? {
            let layer = match child.name() {
                "Unit" => LAYERS[0],
                "EquipmentItem" => LAYERS[1],
                "Installation" => LAYERS[2],
                "TacticalGraphic" | "MOOTWGraphic" | "Overlay" => LAYERS[3],
                "ForceSide" => {
                    let side = self.xml.read(child)?;
                    self.sides.add(&side);
                    continue;
                }
                "ScenarioTime" => {
                    self.begin = Moment::parse(&self.xml.read(child)?.text());
                    continue;
                }
                "ForceSides" | "Organizations" | "Units" | "Equipment" | "Installations"
                | "TacticalGraphics" | "MOOTWGraphics" | "Environment" => {
                    self.read_parts()?;
                    continue;
                }
                // NETN's `Deployment` repeats handles of units; the rest says nothing of places.
                _ => {
                    self.xml.skip()?;
                    continue;
                }
            };
            let element = self.xml.read(child)?;
            if element.name() != "Overlay" {
                let line = self.xml.line_of(&element);
                self.things.push(thing(layer, &element, line));
            }
        }
        Ok(())
    }
}

/// The text of the first element of a name in another, however deep; `None` where it is empty or not there.
fn found(element: &XmlElement<'_>, name: &str) -> Option<String> {
    element.children().find_map(|child| match child.name() == name {
        true => Some(child.text()).filter(|text| !text.is_empty()),
        false => found(child, name),
    })
}

fn thing(layer: &'static str, element: &XmlElement<'_>, line: String) -> MsdlThing {
    let child = |name: &str| element.children_named(name).next();
    let own = |name: &str| child(name).map(XmlElement::text).filter(|text| !text.is_empty());
    let mut properties = Properties::new();
    set(&mut properties, LAYER, layer);
    own("ObjectHandle").into_iter().for_each(|handle| set(&mut properties, ID, handle));
    own("Name").into_iter().for_each(|name| set(&mut properties, NAME, name));
    let modifiers: Vec<&XmlElement<'_>> =
        element.children().filter(|child| child.name().ends_with("SymbolModifiers")).collect();
    let modifier = |name: &str| modifiers.iter().find_map(|modifiers| found(modifiers, name));
    let fields = [
        (UNIQUE_DESIGNATION, "UniqueDesignation"),
        (HIGHER_FORMATION, "HigherFormation"),
        (ADDITIONAL_INFORMATION, "AdditionalInfo"),
        (STAFF_COMMENTS, "StaffComments"),
        (COMBAT_EFFECTIVENESS, "CombatEffectiveness"),
        (EVALUATION_RATING, "EvaluationRating"),
        (QUANTITY, "Quantity"),
        (TYPE, "EquipmentType"),
        (IFF, "IFF"),
        (DTG, "DTG"),
        (ALTITUDE, "AltitudeDepth"),
        (LOCATION, "Location"),
        (SPECIAL_HEADQUARTERS, "SpecialC2HQ"),
    ];
    for (property, name) in fields {
        modifier(name).into_iter().for_each(|text| set(&mut properties, property, text));
    }
    if !properties.contains_key(UNIQUE_DESIGNATION) {
        own("Name").into_iter().for_each(|name| set(&mut properties, UNIQUE_DESIGNATION, name));
    }
    let reinforced =
        modifier("ReinforcedReduced").and_then(|word| match word.to_ascii_uppercase().as_str() {
            "R" | "REINFORCED" => Some("(+)"),
            "D" | "REDUCED" => Some("(-)"),
            "RD" | "REINFORCED_AND_REDUCED" | "REINFORCED_REDUCED" => Some("(±)"),
            _ => None,
        });
    reinforced.into_iter().for_each(|mark| set(&mut properties, REINFORCED, mark));
    let disposition = child("Disposition");
    let stated = |name: &str| disposition.and_then(|disposition| found(disposition, name));
    stated("DirectionOfMovement").into_iter().for_each(|text| set(&mut properties, DIRECTION, text));
    stated("Speed").into_iter().for_each(|text| set(&mut properties, SPEED, text));
    let relations = child("Relations");
    let related = |name: &str| relations.and_then(|relations| found(relations, name));
    let code = own("SymbolIdentifier").and_then(|text| bare_code(&text));
    let echelon = modifier("Echelon").and_then(|word| echelon_letter(&word));
    MsdlThing {
        layer,
        handle: own("ObjectHandle").unwrap_or_default(),
        line,
        code: code.map(|code| with_echelon(code, echelon)),
        properties,
        places: disposition.map_or(Ok(Vec::new()), |disposition| place::places(disposition)),
        superior: [
            "CommandingSuperiorHandle",
            "OrganicSuperiorHandle",
            "UnitOwnerHandle",
            "SupportedUnitHandle",
        ]
        .into_iter()
        .find_map(related),
        side: related("ForceSideHandle").or_else(|| related("OwnerHandle")),
    }
}

/// The letter of an echelon in codes of letters (MIL-STD-2525C, table A-II).
fn echelon_letter(word: &str) -> Option<char> {
    const ECHELONS: [(&str, char); 14] = [
        ("TEAM", 'A'),
        ("CREW", 'A'),
        ("SQUAD", 'B'),
        ("SECTION", 'C'),
        ("PLATOON", 'D'),
        ("COMPANY", 'E'),
        ("BATTALION", 'F'),
        ("REGIMENT", 'G'),
        ("BRIGADE", 'H'),
        ("DIVISION", 'I'),
        ("CORPS", 'J'),
        ("ARMYGROUP", 'L'),
        ("ARMY", 'K'),
        ("REGION", 'M'),
    ];
    let plain: String =
        word.chars().filter(char::is_ascii_alphabetic).collect::<String>().to_ascii_uppercase();
    ECHELONS.iter().find(|(name, _)| plain.starts_with(name)).map(|(_, letter)| *letter)
}

/// A code of letters that states no echelon, with one.
fn with_echelon(mut code: String, echelon: Option<char>) -> String {
    let is_open = code.len() == 15 && matches!(code.as_bytes()[ECHELON_LETTER], b'-' | b'*');
    if let Some(letter) = echelon.filter(|_| is_open) {
        code.replace_range(ECHELON_LETTER..=ECHELON_LETTER, letter.encode_utf8(&mut [0; 4]));
    }
    code
}

fn by_handle(things: &[MsdlThing]) -> BTreeMap<&str, usize> {
    let handles = things.iter().enumerate().filter(|(_, thing)| !thing.handle.is_empty());
    handles.map(|(index, thing)| (thing.handle.as_str(), index)).collect()
}

/// Things with what the file says of others: sides, and units above.
struct Placing<'a> {
    sides: &'a ForceSides,
    things: &'a [MsdlThing],
    by_handle: BTreeMap<&'a str, usize>,
    begin: Option<Moment>,
}

impl<'a> Placing<'a> {
    fn add(&self, wanted: Option<&str>, builder: &mut LayerBuilder) {
        let [mut led, mut placeless] = [const { RecordTally::new() }; 2];
        for thing in self.things.iter().filter(|thing| wanted.is_none_or(|wanted| wanted == thing.layer)) {
            let name = thing.properties.get(NAME).and_then(serde_json::Value::as_str);
            let place = || match name {
                Some(name) => format!("'{name}', {}", thing.line),
                None => thing.line.clone(),
            };
            let places = match &thing.places {
                Ok(places) => places,
                Err(reason) => {
                    builder.add_broken(place(), VectorError::broken(FORMAT, place(), reason.clone()));
                    continue;
                }
            };
            let above =
                || self.above(thing).find_map(|unit| unit.places.as_ref().ok().filter(|all| !all.is_empty()));
            let places = match (places.is_empty(), above()) {
                (false, _) => places,
                (true, Some(above)) => {
                    led.add(place);
                    above
                }
                (true, None) => {
                    placeless.add(place);
                    continue;
                }
            };
            let mut parts = FeatureParts::default();
            match places.len() {
                1 => parts.add_points(places.clone()),
                _ => parts.add_line(places.clone()),
            }
            builder.add_at(parts, self.properties(thing), place);
        }
        let led =
            led.text("thing is where the unit above it is", "things are where the units above them are");
        led.into_iter().for_each(|note| builder.note(note));
        builder.note_omitted(&placeless, "thing without a place", "things without a place");
    }

    /// The units above a thing, the nearest first.
    fn above(&self, thing: &'a MsdlThing) -> impl Iterator<Item = &'a MsdlThing> {
        let mut seen = BTreeSet::new();
        std::iter::successors(Some(thing), move |thing| {
            let index = *self.by_handle.get(thing.superior.as_deref()?)?;
            seen.insert(index).then(|| &self.things[index])
        })
        .skip(1)
    }

    fn properties(&self, thing: &'a MsdlThing) -> Properties {
        let mut properties = thing.properties.clone();
        let side = std::iter::once(thing).chain(self.above(thing)).find_map(|unit| unit.side.as_deref());
        if let Some(name) = side.and_then(|side| self.sides.name(side)) {
            set(&mut properties, SIDE, name);
        }
        let above = self.above(thing).next().and_then(|unit| unit.properties.get(NAME)?.as_str());
        above.into_iter().for_each(|name| set(&mut properties, PARENT, name));
        self.begin.into_iter().for_each(|begin| set(&mut properties, BEGIN, begin.to_string()));
        if let Some(code) = &thing.code {
            let affiliation = side.and_then(|side| self.sides.affiliation(side));
            set(&mut properties, SIDC, with_affiliation(code, affiliation));
        }
        properties
    }
}

/// A code of letters with its affiliation, or of digits with its identity. Without one, a code that leaves it open is of an unknown
/// side.
fn with_affiliation(code: &str, affiliation: Option<char>) -> String {
    let mut code = code.to_owned();
    if code.len() == 15 {
        let is_open = matches!(code.as_bytes()[1], b'-' | b'*');
        if let Some(letter) = affiliation.or(is_open.then_some('U')) {
            code.replace_range(1..2, letter.encode_utf8(&mut [0; 4]));
        }
    } else if let Some(letter) = affiliation {
        let digit = match letter {
            'F' => "3",
            'A' => "2",
            'N' => "4",
            'S' => "5",
            'H' => "6",
            _ => "1",
        };
        code.replace_range(3..4, digit);
    }
    code
}

#[cfg(test)]
mod tests;
