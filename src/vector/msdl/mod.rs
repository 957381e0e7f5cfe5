//! Scenarios of the Military Scenario Definition Language 1.0 (SISO-STD-007-2008) and of its NETN variant: units, equipment,
//! installations and tactical graphics with codes of MIL-STD-2525, on WGS 84.
//!
//! A code's letter of affiliation is what the thing's side is to the first side of the file, as its associations say. A thing
//! without a place of its own is where the unit above it is, and a note says of how many that holds. Layers are `units`,
//! `equipment`, `installations` and `graphics`. Something that does not move has no direction. Holdings, networks, formations and
//! heights above the ground are not read.

mod place;
mod sides;

use std::collections::BTreeMap;

use glam::DVec3;

use crate::builder::{FeatureParts, LayerBuilder};
use crate::error::{VectorError, shorten};
use crate::feature::{Properties, VectorLayer};
use crate::hints::VectorHints;
use crate::moment::Moment;
use crate::overlay_schema::{
    ADDITIONAL_INFORMATION, ALTITUDE, BEGIN, COMBAT_EFFECTIVENESS, DIRECTION, DTG, EVALUATION_RATING,
    HIGHER_FORMATION, ID, IFF, LAYER, LOCATION, NAME, PARENT, QUANTITY, REINFORCED, SIDE,
    SPECIAL_HEADQUARTERS, SPEED, STAFF_COMMENTS, TYPE, UNIQUE_DESIGNATION, bare_code, leaves_identity_open,
    reinforced_mark, set, set_code, shared_name, with_identity,
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
    let MsdlReader { mut sides, things, begin, .. } = reader;
    sides.relate();
    let mut builder = LayerBuilder::new(Crs::wgs84());
    if hints.crs.is_some_and(|crs| *crs != Crs::wgs84()) {
        builder.note("its places name their systems: `crs` has no effect on them");
    }
    let wanted = wanted.map(|index| LAYERS[index]);
    let links = UnitLinks::of(&things);
    Placing { sides: &sides, things: &things, links, begin }.add(wanted, &mut builder);
    fault.into_iter().for_each(|fault| builder.fault(fault));
    builder.finish()
}

/// A unit, a piece of equipment, an installation or a graphic, as the file has it.
struct MsdlThing {
    layer: &'static str,
    handle: String,
    line: String,
    /// Its code, or what the file has instead; `None` where it has nothing.
    code: Option<Result<String, String>>,
    /// Whether its code leaves the side open.
    is_template: bool,
    properties: Properties,
    /// Its places, or why there are none.
    places: Result<Vec<DVec3>, String>,
    /// The handles of the units above it, the nearest relation first.
    superiors: Vec<String>,
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
    modifier("ReinforcedReduced")
        .into_iter()
        .for_each(|word| set(&mut properties, REINFORCED, reinforced_mark(&word)));
    let disposition = child("Disposition");
    let stated = |name: &str| disposition.and_then(|disposition| found(disposition, name));
    let speed = stated("Speed").filter(|text| text.parse() != Ok(0.0));
    if speed.is_some() || stated("Speed").is_none() {
        let direction = stated("DirectionOfMovement");
        direction.into_iter().for_each(|text| set(&mut properties, DIRECTION, text));
    }
    speed.into_iter().for_each(|text| set(&mut properties, SPEED, text));
    let relations = child("Relations");
    let related = |name: &str| relations.and_then(|relations| found(relations, name));
    let is_template = own("SymbolIdentifier").is_some_and(|text| leaves_identity_open(&text));
    let code = own("SymbolIdentifier").map(|text| bare_code(&text).ok_or(text));
    let echelon = modifier("Echelon").and_then(|word| echelon_letter(&word));
    MsdlThing {
        layer,
        handle: own("ObjectHandle").unwrap_or_default(),
        line,
        code: code.map(|code| code.map(|code| with_echelon(code, echelon))),
        is_template,
        properties,
        places: disposition.map_or(Ok(Vec::new()), |disposition| place::places(disposition)),
        superiors: [
            "CommandingSuperiorHandle",
            "OrganicSuperiorHandle",
            "UnitOwnerHandle",
            "SupportedUnitHandle",
        ]
        .into_iter()
        .filter_map(related)
        .collect(),
        side: ["ForceSideHandle", "ForceOwnerHandle", "OwnerHandle"]
            .into_iter()
            .find_map(related)
            .or_else(|| own("AffiliateHandle")),
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

/// For each thing the unit above it, and the nearest thing above, itself included, that has a place and that has a side.
struct UnitLinks {
    parents: Vec<Option<usize>>,
    placed: Vec<Option<usize>>,
    sided: Vec<Option<usize>>,
    /// Things whose handles of units above name none.
    lost: Vec<usize>,
}

impl UnitLinks {
    fn of(things: &[MsdlThing]) -> Self {
        let handles = things.iter().enumerate().filter(|(_, thing)| !thing.handle.is_empty());
        let by_handle: BTreeMap<&str, usize> =
            handles.map(|(index, thing)| (thing.handle.as_str(), index)).collect();
        let mut lost = Vec::new();
        let mut parents = Vec::with_capacity(things.len());
        for (index, thing) in things.iter().enumerate() {
            let parent = thing.superiors.iter().find_map(|handle| by_handle.get(handle.as_str()).copied());
            if parent.is_none() && !thing.superiors.is_empty() {
                lost.push(index);
            }
            parents.push(parent.filter(|parent| *parent != index));
        }
        let has_place = |index: usize| things[index].places.as_ref().is_ok_and(|places| !places.is_empty());
        let placed = nearest(&parents, has_place);
        let sided = nearest(&parents, |index| things[index].side.is_some());
        Self { parents, placed, sided, lost }
    }
}

/// For each of a forest of things the nearest above, itself included, of which `holds` is true; `None` where there is none, or
/// the parents run in a circle. Every thing is looked at a few times, however long a chain is.
fn nearest(parents: &[Option<usize>], holds: impl Fn(usize) -> bool) -> Vec<Option<usize>> {
    #[derive(Clone, Copy, PartialEq)]
    enum Visit {
        New,
        Open,
        Done,
    }
    let mut found: Vec<Option<usize>> = vec![None; parents.len()];
    let mut visits = vec![Visit::New; parents.len()];
    let mut path = Vec::new();
    for start in 0..parents.len() {
        let mut at = Some(start);
        let mut answer = None;
        while let Some(index) = at {
            match visits[index] {
                Visit::Done => answer = found[index],
                Visit::Open => {}
                Visit::New if holds(index) => {
                    (found[index], visits[index], answer) = (Some(index), Visit::Done, Some(index));
                }
                Visit::New => {
                    visits[index] = Visit::Open;
                    path.push(index);
                    at = parents[index];
                    continue;
                }
            }
            break;
        }
        for index in path.drain(..) {
            (found[index], visits[index]) = (answer, Visit::Done);
        }
    }
    found
}

/// Things with what the file says of others: sides, and units above.
struct Placing<'a> {
    sides: &'a ForceSides,
    things: &'a [MsdlThing],
    links: UnitLinks,
    begin: Option<Moment>,
}

impl Placing<'_> {
    fn add(&self, wanted: Option<&str>, builder: &mut LayerBuilder) {
        let [mut led, mut placeless, mut codeless, mut sideless, mut lost] =
            [const { RecordTally::new() }; 5];
        for (index, thing) in self.things.iter().enumerate() {
            if wanted.is_some_and(|wanted| wanted != thing.layer) {
                continue;
            }
            let name = thing.properties.get(NAME).and_then(serde_json::Value::as_str);
            let place = || match name {
                Some(name) => format!("'{}', {}", shorten(name), thing.line),
                None => thing.line.clone(),
            };
            if let Err(reason) = &thing.places {
                builder.add_broken(place(), VectorError::broken(FORMAT, place(), reason.clone()));
                continue;
            }
            let Some(at) = self.links.placed[index] else {
                placeless.add(place);
                continue;
            };
            if at != index {
                led.add(place);
            }
            let Ok(places) = &self.things[at].places else { continue };
            let properties = self.properties(index);
            match &thing.code {
                Some(Ok(_)) if thing.is_template => {
                    sideless.add_many(usize::from(self.affiliation(index).is_none()), place);
                }
                Some(Ok(_)) => {}
                _ => codeless.add(place),
            }
            if self.links.lost.binary_search(&index).is_ok() {
                lost.add(place);
            }
            let mut parts = FeatureParts::default();
            match places.len() {
                1 => parts.add_points(places.clone()),
                _ => parts.add_line(places.clone()),
            }
            builder.add_at(parts, properties, place);
        }
        let led =
            led.text("thing is where the unit above it is", "things are where the units above them are");
        led.into_iter().for_each(|note| builder.note(note));
        let faults = [
            placeless.text("thing is left out: neither it nor a unit above it has a place", "things are left out: neither they nor units above them have a place"),
            codeless.text("thing has no symbol code that can be read", "things have no symbol code that can be read"),
            sideless.text("thing is of no side that the file relates to its first: its symbol is that of an unknown", "things are of no side that the file relates to its first: their symbols are those of unknowns"),
            lost.text("thing is under a unit that the file does not have", "things are under units that the file does not have"),
        ];
        faults.into_iter().flatten().for_each(|fault| builder.fault(fault));
    }

    /// The letter of what the side of a thing is to the first.
    fn affiliation(&self, index: usize) -> Option<char> {
        let sided = &self.things[self.links.sided[index]?];
        self.sides.affiliation(sided.side.as_deref()?)
    }

    fn properties(&self, index: usize) -> Properties {
        let thing = &self.things[index];
        let mut properties = thing.properties.clone();
        let side = self.links.sided[index].and_then(|unit| self.things[unit].side.as_deref());
        if let Some(name) = side.and_then(|side| self.sides.name(side)) {
            set(&mut properties, SIDE, name);
        }
        let above =
            self.links.parents[index].and_then(|unit| self.things[unit].properties.get(NAME)?.as_str());
        above.into_iter().for_each(|name| set(&mut properties, PARENT, shared_name(name)));
        self.begin.into_iter().for_each(|begin| set(&mut properties, BEGIN, begin.to_string()));
        if let Some(Ok(code)) = &thing.code {
            set_code(&mut properties, &with_identity(code.clone(), self.affiliation(index)));
        }
        properties
    }
}

#[cfg(test)]
mod tests;
