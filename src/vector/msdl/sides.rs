//! The sides of a scenario, and what each is to the first.

use std::collections::BTreeMap;

use crate::xml::XmlElement;

/// A side or a force of one.
struct ForceSide {
    name: String,
    /// The side that it is of; itself for a side.
    allegiance: Option<String>,
    /// Handles of others, with what they are to it.
    relations: Vec<(String, String)>,
}

/// The sides of a scenario by their handles.
#[derive(Default)]
pub(super) struct ForceSides {
    sides: BTreeMap<String, ForceSide>,
    /// The handle of the first: it is friendly to itself.
    first: Option<String>,
}

impl ForceSides {
    /// Adds a `ForceSide`.
    pub fn add(&mut self, element: &XmlElement<'_>) {
        let text = |element: &XmlElement<'_>, name: &str| {
            element.children_named(name).next().map(XmlElement::text).filter(|text| !text.is_empty())
        };
        let Some(handle) = text(element, "ObjectHandle") else { return };
        let associations =
            element.children_named("Associations").flat_map(|list| list.children_named("Association"));
        let relations = associations
            .filter_map(|other| Some((text(other, "AffiliateHandle")?, text(other, "Relationship")?)))
            .collect();
        let side = ForceSide {
            name: text(element, "ForceSideName").unwrap_or_default(),
            allegiance: text(element, "AllegianceHandle").filter(|side| *side != handle),
            relations,
        };
        self.first.get_or_insert_with(|| handle.clone());
        self.sides.insert(handle, side);
    }

    /// The name of a side.
    pub fn name(&self, handle: &str) -> Option<&str> {
        self.sides.get(handle).map(|side| side.name.as_str()).filter(|name| !name.is_empty())
    }

    /// The letter of what a side is to the first; `None` where nothing says so.
    pub fn affiliation(&self, handle: &str) -> Option<char> {
        let first = self.first.as_deref()?;
        // A force is what its side is; the chain ends, whatever a file says.
        let mut current = handle;
        for _ in 0..=self.sides.len() {
            if current == first {
                return Some('F');
            }
            let stated = |of: &str, to: &str| {
                let relations = &self.sides.get(of)?.relations;
                relations.iter().find(|(other, _)| other == to).and_then(|(_, word)| letter(word))
            };
            if let Some(letter) = stated(first, current).or_else(|| stated(current, first)) {
                return Some(letter);
            }
            current = self.sides.get(current)?.allegiance.as_deref()?;
        }
        None
    }
}

/// The letter of a relationship: `HO`, `NE`, `FR`, `SU`, `UN`, or the words they stand for.
fn letter(word: &str) -> Option<char> {
    let word = word.trim().to_ascii_uppercase();
    let known = [
        ("HO", 'H'),
        ("FA", 'H'),
        ("NE", 'N'),
        ("FR", 'F'),
        ("CO", 'F'),
        ("AL", 'F'),
        ("AS", 'A'),
        ("AF", 'A'),
        ("SU", 'S'),
        ("JO", 'S'),
        ("UN", 'U'),
        ("PE", 'P'),
    ];
    known.iter().find(|(start, _)| word.starts_with(start)).map(|(_, letter)| *letter)
}
