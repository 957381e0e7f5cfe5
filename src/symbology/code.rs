//! Symbol identification codes: 20 or 30 digits as MIL-STD-2525D and E and APP-6D write them, or 15 letters as
//! MIL-STD-2525C did.
//!
//! ```text
//!  10 0 3 10 0 0 16 121100 00 00 · 0000000000
//!  │  │ │ │  │ │ │  │      │  │    └ 21-30, E: common-modifier flags, frame shape, country
//!  │  │ │ │  │ │ │  │      └──┴ 17-20: sector 1 and sector 2 modifier
//!  │  │ │ │  │ │ │  └ 11-16: entity, type, subtype
//!  │  │ │ │  │ └─┴ 8: headquarters, task force, dummy; 9-10: echelon or mobility
//!  │  │ │ └──┴ 5-6: symbol set; 7: status
//!  └──┴─┴ 1-2: version; 3: context; 4: standard identity
//! ```

use std::fmt;

use thiserror::Error;

use crate::fields::{
    CodedField, SymbolAmplifier, SymbolContext, SymbolIdentity, SymbolRole, SymbolSet, SymbolStatus,
    SymbolVersion,
};
use crate::letter_code;
use sandtable_base::message::suggest::quoted;

/// A symbol identification code, read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct SymbolCode {
    /// The edition of the standard.
    pub version: SymbolVersion,
    /// Reality, exercise or simulation.
    pub context: SymbolContext,
    /// The threat.
    pub identity: SymbolIdentity,
    /// The dimension, or kind of thing.
    pub set: SymbolSet,
    /// Whether it is there, and its condition.
    pub status: SymbolStatus,
    /// Headquarters, task force, feint or dummy.
    pub role: SymbolRole,
    /// Echelon or mobility.
    pub amplifier: SymbolAmplifier,
    /// Entity, type and subtype: six digits, such as 121100 for infantry.
    pub entity: u32,
    /// Sector 1 and sector 2 modifiers; 0 for none. Those above 99 are the common modifiers of 2525E.
    pub modifiers: [u16; 2],
    /// Digit 23 of a code of 30 digits: 0 for the set's own frame, 1 space, 2 air, 3 land unit, 4 equipment or sea surface,
    /// 5 installation, 6 dismounted individual, 7 subsurface, 8 activity, 9 cyberspace.
    pub frame_shape: u8,
    /// Digits 28 to 30 of a code of 30 digits: the number of the country; 0 for none.
    pub country: u16,
    /// The function of a code of 15 letters that the table of letter codes lacks: the entity is unknown.
    pub unknown_function: Option<[u8; 6]>,
}

/// A code that is none.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum SymbolCodeError {
    /// Neither 20 nor 30 digits nor 15 letters.
    #[error(
        "'{}' has {} characters: a symbol code has 20 or 30 digits, or 15 letters (2525C)",
        quoted(code),
        code.chars().count()
    )]
    Length {
        /// The text.
        code: String,
    },
    /// Something other than a digit among digits.
    #[error("character {place} of the symbol code is '{}', where a digit must stand", found.escape_debug())]
    NotADigit {
        /// From 1.
        place: usize,
        /// What stands there.
        found: char,
    },
    /// A value that the standard does not have.
    #[error("{places} of the symbol code, the {field}, is '{}': use {allowed}", quoted(found))]
    Field {
        /// Such as `digits 5-6`.
        places: CodePlaces,
        /// The field's name.
        field: &'static str,
        /// What stands there.
        found: String,
        /// The values with their names.
        allowed: String,
    },
}

/// The place of a field in a code.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CodePlaces {
    /// The first character, from 1.
    pub first: usize,
    /// How many characters.
    pub count: usize,
    /// What the code is written in: `digit` or `letter`.
    pub unit: &'static str,
}

impl fmt::Display for CodePlaces {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { first, count, unit } = self;
        match count {
            1 => write!(f, "{unit} {first}"),
            _ => write!(f, "{unit}s {first}-{}", first + count - 1),
        }
    }
}

/// The longest text that is looked at; a code with a space between all its digits is shorter.
const LONGEST: usize = 64;

impl SymbolCode {
    /// Reads a code. Spaces between its digits are skipped.
    ///
    /// # Errors
    /// The text is no code; the message names the field, its place and what it may be.
    pub fn parse(text: &str) -> Result<Self, SymbolCodeError> {
        let code: String = text.chars().filter(|letter| *letter != ' ').take(LONGEST).collect();
        match code.chars().count() {
            20 | 30 => Self::from_digits(&code),
            15 if code.is_ascii() => letter_code::parse(&code),
            _ => Err(SymbolCodeError::Length { code: text.to_owned() }),
        }
    }

    fn from_digits(code: &str) -> Result<Self, SymbolCodeError> {
        if let Some((index, found)) = code.chars().enumerate().find(|(_, digit)| !digit.is_ascii_digit()) {
            return Err(SymbolCodeError::NotADigit { place: index + 1, found });
        }
        let number = |first: usize, count: usize| -> u32 {
            code.bytes().skip(first - 1).take(count).fold(0, |sum, digit| sum * 10 + u32::from(digit - b'0'))
        };
        // The common modifiers of 2525E have a third digit, 1, in places 21 and 22.
        let extended = |flag: usize, first: usize| {
            let common = if code.len() == 30 { number(flag, 1) * 100 } else { 0 };
            (common + number(first, 2)) as u16
        };
        Ok(Self {
            version: field(code, 1, 2)?,
            context: field(code, 3, 1)?,
            identity: field(code, 4, 1)?,
            set: field(code, 5, 2)?,
            status: field(code, 7, 1)?,
            role: field(code, 8, 1)?,
            amplifier: field(code, 9, 2)?,
            entity: number(11, 6),
            modifiers: [extended(21, 17), extended(22, 19)],
            frame_shape: if code.len() == 30 { number(23, 1) as u8 } else { 0 },
            country: if code.len() == 30 { number(28, 3) as u16 } else { 0 },
            unknown_function: None,
        })
    }

    /// The code as 20 digits; common modifiers of 2525E lose their third digit.
    pub fn digits(&self) -> String {
        format!(
            "{:02}{}{}{:02}{}{}{:02}{:06}{:02}{:02}",
            self.version.number(),
            self.context.number(),
            self.identity.number(),
            self.set.number(),
            self.status.number(),
            self.role.number(),
            self.amplifier.number(),
            self.entity,
            self.modifiers[0] % 100,
            self.modifiers[1] % 100
        )
    }

    /// The code as 15 letters of MIL-STD-2525C; `None` where 2525C has no such entity, modifier, context, or echelon.
    pub fn letters(&self) -> Option<String> {
        letter_code::letters(self)
    }

    /// The code of the kind alone, without the fields that distinguish single symbols of it.
    pub fn kind(&self) -> Self {
        Self {
            context: SymbolContext::Reality,
            status: SymbolStatus::Present,
            role: SymbolRole::None,
            amplifier: SymbolAmplifier::None,
            modifiers: [0; 2],
            country: 0,
            unknown_function: None,
            ..*self
        }
    }

    /// The frame that digit 23 states, 0 for that of the set: only editions with the changes of 2525E have the digit.
    pub fn stated_frame(&self) -> u8 {
        if self.version.has_changes_of_e() { self.frame_shape } else { 0 }
    }

    /// Whether it is a joker or faker: a friend who plays a suspect or an enemy in an exercise.
    pub fn is_joker_or_faker(&self) -> bool {
        let enemy = matches!(self.identity, SymbolIdentity::Suspect | SymbolIdentity::Hostile);
        enemy && self.context == SymbolContext::Exercise
    }
}

fn field<T: CodedField>(code: &str, first: usize, count: usize) -> Result<T, SymbolCodeError> {
    let found = code.get(first - 1..first - 1 + count).unwrap_or_default();
    found.parse().ok().and_then(T::from_number).ok_or_else(|| SymbolCodeError::Field {
        places: CodePlaces { first, count, unit: "digit" },
        field: T::FIELD,
        found: found.to_owned(),
        allowed: allowed::<T>(count),
    })
}

fn allowed<T: CodedField>(digits: usize) -> String {
    let values = T::VALUES.iter().map(|row| format!("{:0digits$} ({})", row.number, row.name));
    values.collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_code_of_twenty_digits_gives_every_field_and_is_written_back() {
        let code = SymbolCode::parse("10 0 3 10 1 6 18 121102 03 77").expect("valid");
        assert_eq!(
            (code.version, code.identity, code.set),
            (SymbolVersion::D, SymbolIdentity::Friend, SymbolSet::LandUnit)
        );
        assert_eq!((code.status, code.amplifier), (SymbolStatus::Planned, SymbolAmplifier::Brigade));
        assert!(code.role.is_headquarters() && code.role.is_task_force() && !code.role.is_dummy());
        assert_eq!((code.entity, code.modifiers), (121_102, [3, 77]));
        assert_eq!(code.digits(), "10031016181211020377");
    }

    #[test]
    fn a_code_of_thirty_digits_gives_frame_shape_and_common_modifiers() {
        let code = SymbolCode::parse("130310001612110001041020000000").expect("valid");
        assert_eq!((code.version, code.modifiers, code.frame_shape), (SymbolVersion::E, [101, 4], 2));
        assert_eq!((code.stated_frame(), code.country), (2, 0));
        let code = SymbolCode::parse("100310001612110001041020000276").expect("valid");
        assert_eq!((code.stated_frame(), code.country, code.kind().country), (0, 276, 0));
    }

    #[test]
    fn a_wrong_field_is_named_with_its_place_and_what_it_may_be() {
        let message = |code: &str| SymbolCode::parse(code).expect_err("no code").to_string();
        let set = message("10039900161211000000");
        assert!(
            set.starts_with("digits 5-6 of the symbol code, the symbol set, is '99': use 00 (unknown)"),
            "{set}"
        );
        let identity = message("10091000161211000000");
        assert!(
            identity.starts_with("digit 4 of the symbol code, the standard identity, is '9'"),
            "{identity}"
        );
        assert!(identity.contains("6 (hostile"), "{identity}");
        let letter = message("1003100O161211000000");
        assert_eq!(letter, "character 8 of the symbol code is 'O', where a digit must stand");
        assert!(message("1003").contains("has 4 characters: a symbol code has 20 or 30 digits"));
        assert!(message(&"é".repeat(20)).starts_with("character 1"));
        assert!(message(&"1".repeat(100_000)).len() < 300);
    }
}
