//! The sides of a scenario, and what each is to the first.

use std::collections::BTreeMap;

use crate::overlay_schema::shared_name;
use crate::xml::XmlElement;

/// A side or a force of one.
struct ForceSide {
    name: String,
    /// The side that it is of; none for a side.
    allegiance: Option<String>,
    /// Handles of others, with what they are to it.
    relations: BTreeMap<String, String>,
}

/// The sides of a scenario by their handles.
#[derive(Default)]
pub(super) struct ForceSides {
    sides: BTreeMap<String, ForceSide>,
    /// The handle of the first in the file.
    first: Option<String>,
    /// What each is to the viewer, once all are known.
    letters: BTreeMap<String, char>,
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
            name: shared_name(&text(element, "ForceSideName").unwrap_or_default()),
            allegiance: text(element, "AllegianceHandle").filter(|side| *side != handle),
            relations,
        };
        self.first.get_or_insert_with(|| handle.clone());
        self.sides.insert(handle, side);
    }

    /// Finds what each side is to the viewer: the side of the first force in the file.
    ///
    /// A force is what its side is, unless an association names it. Where the viewer's associations name neither, those of the
    /// other side do.
    pub fn relate(&mut self) {
        let Some(viewer) = self.first.as_deref().map(|first| self.chain(first)) else { return };
        // A file may run in a circle: the last of the chain counts.
        let Some(viewer) = viewer.last().map(|last| (*last).to_owned()) else { return };
        let stated = |of: &str, to: &str| letter(self.sides.get(of)?.relations.get(to)?);
        let mut letters: BTreeMap<String, char> = BTreeMap::new();
        for handle in self.sides.keys() {
            let mut pending = Vec::new();
            let mut found = None;
            for at in self.chain(handle) {
                found = letters.get(at).copied();
                if found.is_none() {
                    pending.push(at.to_owned());
                    let is_viewer = at == viewer || Some(at) == self.first.as_deref();
                    found = if is_viewer { Some('F') } else { None }
                        .or_else(|| stated(&viewer, at))
                        .or_else(|| stated(at, &viewer));
                }
                if found.is_some() {
                    break;
                }
            }
            if let Some(letter) = found {
                letters.extend(pending.into_iter().map(|at| (at, letter)));
            }
        }
        self.letters = letters;
    }

    /// A force, its side, and so on up; a few of them, whatever a file says.
    fn chain<'a>(&'a self, handle: &'a str) -> Vec<&'a str> {
        /// Forces of forces of a side; two is what scenarios have.
        const MOST_FORCES_UP: usize = 32;
        let up = |handle: &&'a str| self.sides.get(*handle)?.allegiance.as_deref();
        std::iter::successors(Some(handle), up).take(MOST_FORCES_UP).collect()
    }

    /// The name of a side.
    pub fn name(&self, handle: &str) -> Option<&str> {
        self.sides.get(handle).map(|side| side.name.as_str()).filter(|name| !name.is_empty())
    }

    /// The letter of what a side is to the viewer; `None` where nothing says so.
    pub fn affiliation(&self, handle: &str) -> Option<char> {
        self.letters.get(handle).copied()
    }
}

/// The letter of a relationship by its code in MSDL, which are those of JC3IEDM, or its word.
fn letter(word: &str) -> Option<char> {
    let word = word.trim().to_ascii_uppercase();
    let known = [
        ("HO", 'H'),
        // Assumed hostile: a suspect.
        ("AHO", 'S'),
        ("FAKER", 'K'),
        ("NEUTR", 'N'),
        ("NE", 'N'),
        ("ANT", 'N'),
        ("FR", 'F'),
        ("COOP", 'F'),
        ("ALL", 'F'),
        ("AFR", 'A'),
        ("ASSUMED", 'A'),
        ("SU", 'S'),
        ("JOKER", 'J'),
        ("UN", 'U'),
        ("IV", 'U'),
        ("AIV", 'U'),
        ("PE", 'P'),
    ];
    known.iter().find(|(start, _)| word.starts_with(start)).map(|(_, letter)| *letter)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_codes_of_relationships_have_their_letters() {
        let codes = [
            "HO", "AHO", "FAKER", "NEUTRL", "ANT", "FR", "AFR", "SUSPCT", "JOKER", "UNK", "IV", "AIV",
            "PENDNG",
        ];
        let letters: String = codes.iter().filter_map(|code| letter(code)).collect();
        assert_eq!(letters, "HSKNNFASJUUUP");
        assert_eq!(letter("other"), None);
    }
}
