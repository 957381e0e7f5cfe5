//! Symbol identification codes of 15 letters, as MIL-STD-2525C wrote them, read as the 20 digits of 2525D.
//!
//! ```text
//!  S F G P UCI--- -D *****
//!  │ │ │ │ │      │  └ 13-15: country, order of battle: not read
//!  │ │ │ │ │      └ 11-12: headquarters and the like with the echelon, or mobility
//!  │ │ │ │ └ 5-10: function
//!  └─┴─┴─┴ 1: coding scheme; 2: standard identity; 3: battle dimension; 4: status
//! ```

use crate::code::{CodePlaces, SymbolCode, SymbolCodeError};
use crate::fields::{
    CodedField, SymbolAmplifier, SymbolContext, SymbolIdentity, SymbolRole, SymbolSet, SymbolStatus,
    SymbolVersion,
};
use crate::letter_functions::{self, FUNCTIONS, LetterFunction};

/// Identities with their contexts.
const IDENTITIES: [(u8, SymbolContext, SymbolIdentity, &str); 14] = [
    (b'P', SymbolContext::Reality, SymbolIdentity::Pending, "pending"),
    (b'U', SymbolContext::Reality, SymbolIdentity::Unknown, "unknown"),
    (b'A', SymbolContext::Reality, SymbolIdentity::AssumedFriend, "assumed friend"),
    (b'F', SymbolContext::Reality, SymbolIdentity::Friend, "friend"),
    (b'N', SymbolContext::Reality, SymbolIdentity::Neutral, "neutral"),
    (b'S', SymbolContext::Reality, SymbolIdentity::Suspect, "suspect"),
    (b'H', SymbolContext::Reality, SymbolIdentity::Hostile, "hostile"),
    (b'G', SymbolContext::Exercise, SymbolIdentity::Pending, "exercise pending"),
    (b'W', SymbolContext::Exercise, SymbolIdentity::Unknown, "exercise unknown"),
    (b'M', SymbolContext::Exercise, SymbolIdentity::AssumedFriend, "exercise assumed friend"),
    (b'D', SymbolContext::Exercise, SymbolIdentity::Friend, "exercise friend"),
    (b'L', SymbolContext::Exercise, SymbolIdentity::Neutral, "exercise neutral"),
    (b'J', SymbolContext::Exercise, SymbolIdentity::Suspect, "joker"),
    (b'K', SymbolContext::Exercise, SymbolIdentity::Hostile, "faker"),
];

const STATUSES: [(u8, SymbolStatus, &str); 6] = [
    (b'P', SymbolStatus::Present, "present"),
    (b'A', SymbolStatus::Planned, "anticipated, planned"),
    (b'C', SymbolStatus::FullyCapable, "fully capable"),
    (b'D', SymbolStatus::Damaged, "damaged"),
    (b'X', SymbolStatus::Destroyed, "destroyed"),
    (b'F', SymbolStatus::FullToCapacity, "full to capacity"),
];

/// Coding scheme, dimension and beginning of the function: the set of the functions that [`FUNCTIONS`] lacks. The first
/// that fits counts.
const SETS: [(&[u8], SymbolSet); 16] = [
    (b"SP", SymbolSet::Space),
    (b"SAW", SymbolSet::AirMissile),
    (b"SA", SymbolSet::Air),
    (b"SGE", SymbolSet::LandEquipment),
    (b"SGI", SymbolSet::LandInstallation),
    (b"SG", SymbolSet::LandUnit),
    (b"SS", SymbolSet::SeaSurface),
    (b"SU", SymbolSet::Subsurface),
    (b"SF", SymbolSet::LandUnit),
    (b"SZ", SymbolSet::Unknown),
    (b"SX", SymbolSet::Unknown),
    (b"G", SymbolSet::ControlMeasure),
    (b"EF", SymbolSet::LandInstallation),
    (b"EI", SymbolSet::Activity),
    (b"EN", SymbolSet::Activity),
    (b"O", SymbolSet::Activity),
];

/// Letters that go with echelon letters, and their role.
const ROLES: [(u8, SymbolRole); 9] = [
    (b'-', SymbolRole::None),
    (b'A', SymbolRole::Headquarters),
    (b'B', SymbolRole::TaskForceHeadquarters),
    (b'C', SymbolRole::DummyHeadquarters),
    (b'D', SymbolRole::DummyTaskForceHeadquarters),
    (b'E', SymbolRole::TaskForce),
    (b'F', SymbolRole::Dummy),
    (b'G', SymbolRole::DummyTaskForce),
    (b'H', SymbolRole::None),
];

/// The second letter of a mobility, `MO` to `MY`, with its number in 2525D.
const MOBILITIES: [(u8, u8); 11] = [
    (b'O', 31),
    (b'P', 32),
    (b'Q', 33),
    (b'R', 34),
    (b'S', 35),
    (b'T', 36),
    (b'U', 41),
    (b'V', 42),
    (b'W', 37),
    (b'X', 51),
    (b'Y', 52),
];

/// Reads 15 ASCII characters.
///
/// # Errors
/// Letters that the standard does not have, with their place.
pub(super) fn parse(code: &str) -> Result<SymbolCode, SymbolCodeError> {
    let letters: Vec<u8> =
        code.to_ascii_uppercase().bytes().map(|l| if l == b'*' { b'-' } else { l }).collect();
    let [scheme, identity, dimension, status, function @ .., first, second, _, _, _] = letters.as_slice()
    else {
        return Err(SymbolCodeError::Length { code: code.to_owned() });
    };
    let (_, context, identity, _) = IDENTITIES
        .iter()
        .find(|row| row.0 == *identity)
        .ok_or_else(|| error(code, 2, 1, "standard identity", IDENTITIES.iter().map(|row| (row.0, row.3))))?;
    let (_, status, _) = STATUSES
        .iter()
        .find(|row| row.0 == *status)
        .ok_or_else(|| error(code, 4, 1, "status", STATUSES.iter().map(|row| (row.0, row.2))))?;
    let key: Vec<u8> = [*scheme, *dimension].into_iter().chain(function.iter().copied()).collect();
    let known = letter_functions::find(&key);
    let (set, entity, modifiers) = match known {
        Some(row) => (SymbolSet::from_number(row.set), row.entity, row.modifiers),
        None => (SETS.iter().find(|(start, _)| key.starts_with(start)).map(|row| row.1), 0, [0, 0]),
    };
    let schemes =
        [(b'S', "warfighting"), (b'G', "tactical graphics"), (b'O', "stability"), (b'E', "emergency")];
    let set = set.ok_or_else(|| error(code, 1, 1, "coding scheme", schemes))?;
    let (role, amplifier) = role_and_amplifier(*first, *second).ok_or_else(|| SymbolCodeError::Field {
        places: CodePlaces { first: 11, count: 2, unit: "letter" },
        field: "symbol modifier",
        found: code.get(10..12).unwrap_or_default().to_owned(),
        allowed: "-, A to H and an echelon from A to N, a mobility from MO to MY, or a towed array, NS or NL"
            .to_owned(),
    })?;
    let mut unknown = [b'-'; 6];
    unknown.iter_mut().zip(function).for_each(|(to, from)| *to = *from);
    Ok(SymbolCode {
        version: SymbolVersion::D,
        context: *context,
        identity: *identity,
        set,
        status: *status,
        role,
        amplifier,
        entity,
        modifiers,
        frame_shape: 0,
        country: 0,
        unknown_function: (known.is_none() && unknown != [b'-'; 6]).then_some(unknown),
    })
}

/// The 15 letters of a code; `None` where 2525C has none for one of its fields.
pub(super) fn letters(code: &SymbolCode) -> Option<String> {
    let is_same = |row: &&LetterFunction| {
        (row.set, row.entity, row.modifiers) == (code.set.number(), code.entity, code.modifiers)
    };
    let function = match code.unknown_function {
        Some(_) => None,
        None => FUNCTIONS.iter().find(is_same),
    };
    let [scheme, dimension, function @ ..] = function?.letters;
    let identity =
        IDENTITIES.iter().find(|row| (row.1, row.2) == (code.context, code.identity)).map(|row| row.0)?;
    let status = STATUSES.iter().find(|row| row.1 == code.status)?.0;
    let (first, second) = role_and_amplifier_letters(code)?;
    let end: &[u8] = if scheme == b'G' { b"--X" } else { b"---" };
    let letters: Vec<u8> = [scheme, identity, dimension, status]
        .into_iter()
        .chain(function)
        .chain([first, second])
        .chain(end.iter().copied())
        .collect();
    String::from_utf8(letters).ok()
}

/// Letters 11 and 12.
fn role_and_amplifier_letters(code: &SymbolCode) -> Option<(u8, u8)> {
    let number = code.amplifier.number();
    let is_plain = code.role == SymbolRole::None;
    if code.set == SymbolSet::LandInstallation && number == 0 {
        return match code.role {
            SymbolRole::None => Some((b'H', b'-')),
            SymbolRole::Dummy => Some((b'H', b'B')),
            _ => None,
        };
    }
    let echelon = match number {
        0 => b'-',
        11..=18 => b'A' + number - 11,
        21..=26 => b'I' + number - 21,
        61 if is_plain => return Some((b'N', b'S')),
        62 if is_plain => return Some((b'N', b'L')),
        _ if is_plain => {
            let letter = MOBILITIES.iter().find(|row| row.1 == number)?.0;
            return Some((b'M', letter));
        }
        _ => return None,
    };
    Some((ROLES.iter().find(|row| row.1 == code.role)?.0, echelon))
}

/// The role and the amplifier of letters 11 and 12.
fn role_and_amplifier(first: u8, second: u8) -> Option<(SymbolRole, SymbolAmplifier)> {
    let amplifier = |number| SymbolAmplifier::from_number(number);
    match (first, second) {
        (b'M', b'-') => Some((SymbolRole::None, SymbolAmplifier::None)),
        (b'M', letter) => {
            let row = MOBILITIES.iter().find(|row| row.0 == letter)?;
            Some((SymbolRole::None, amplifier(row.1)?))
        }
        (b'N', b'S') => Some((SymbolRole::None, SymbolAmplifier::ShortTowedArray)),
        (b'N', b'L') => Some((SymbolRole::None, SymbolAmplifier::LongTowedArray)),
        // A feint or dummy installation.
        (b'H', b'B') => Some((SymbolRole::Dummy, SymbolAmplifier::None)),
        _ => {
            let role = ROLES.iter().find(|row| row.0 == first)?.1;
            let number = match second {
                b'-' => 0,
                b'A'..=b'H' => 11 + second - b'A',
                b'I'..=b'N' => 21 + second - b'I',
                _ => return None,
            };
            Some((role, amplifier(number)?))
        }
    }
}

fn error(
    code: &str,
    place: usize,
    count: usize,
    field: &'static str,
    allowed: impl IntoIterator<Item = (u8, &'static str)>,
) -> SymbolCodeError {
    let allowed = allowed.into_iter().map(|(letter, name)| format!("{} ({name})", char::from(letter)));
    SymbolCodeError::Field {
        places: CodePlaces { first: place, count, unit: "letter" },
        field,
        found: code.get(place - 1..place - 1 + count).unwrap_or_default().to_owned(),
        allowed: allowed.collect::<Vec<_>>().join(", "),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_of_letters_become_those_of_digits() {
        for (letters, digits) in [
            ("SFGPUCI----D---", "10031000141211000000"),
            ("SHGPUCA---AH***", "10061002181205000000"),
            ("SNGAEVAT--MQ---", "10041510331202000000"),
            ("SJGPUCIZ--GF---", "10151005161211020000"),
            ("SFAPMFF--------", "10030100001101040000"),
            ("SUGPUCIL--NL---", "10011000621211000019"),
            ("SFGPIXH---HB---", "10032001001207020000"),
        ] {
            let code = SymbolCode::parse(letters).expect(letters);
            assert_eq!((code.digits().as_str(), code.unknown_function), (digits, None), "{letters}");
        }
    }

    #[test]
    fn a_function_that_the_table_lacks_keeps_its_set_and_its_name() {
        let code = SymbolCode::parse("SFGPEZZZ--MO---").expect("a frame");
        assert_eq!((code.set, code.entity), (SymbolSet::LandEquipment, 0));
        assert_eq!(code.unknown_function, Some(*b"EZZZ--"));
    }

    #[test]
    fn every_function_comes_back_as_letters_that_mean_the_same() {
        for (row, identity) in FUNCTIONS.iter().zip(IDENTITIES.iter().cycle()) {
            let [scheme, dimension, function @ ..] = row.letters;
            let letters: Vec<u8> =
                [scheme, identity.0, dimension, b'P'].into_iter().chain(function).collect();
            let letters = String::from_utf8(letters).expect("letters") + "-----";
            let code = SymbolCode::parse(&letters).expect(&letters);
            let back = code.letters().expect(&letters);
            assert_eq!(SymbolCode::parse(&back), Ok(code), "{letters} {back}");
        }
    }

    #[test]
    fn roles_echelons_and_mobilities_come_back_as_letters() {
        for letters in
            ["SFGPUCI----D---", "SHGPUCA---AH---", "SNGAEVAT--MQ---", "SJGPUCIZ--GF---", "SFGPIB----HB---"]
        {
            let back = SymbolCode::parse(letters).expect(letters).letters();
            assert_eq!(back.as_deref(), Some(letters));
        }
        // 2525C has no simulation and no headquarters of equipment that moves.
        assert_eq!(SymbolCode::parse("10231000151211000000").expect("a code").letters(), None);
        assert_eq!(SymbolCode::parse("10031502331202000000").expect("a code").letters(), None);
    }

    #[test]
    fn wrong_letters_are_named_with_their_place() {
        let message = |code: &str| SymbolCode::parse(code).expect_err("no code").to_string();
        assert!(
            message("SQGPUCI--------")
                .starts_with("letter 2 of the symbol code, the standard identity, is 'Q'")
        );
        assert!(message("SFGQUCI--------").starts_with("letter 4"));
        assert!(message("SFGPUCI---ZZ---").starts_with("letters 11-12"));
        assert!(message("XFGPUCI--------").contains("coding scheme"));
    }
}
