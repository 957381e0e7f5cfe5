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
    (b"GM", SymbolSet::ControlMeasure),
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
    let known = FUNCTIONS.iter().find(|row| row.letters.as_slice() == key.as_slice());
    let (set, entity, modifiers) = match known {
        Some(row) => (SymbolSet::from_number(row.set), row.entity, row.modifiers),
        None => (SETS.iter().find(|(start, _)| key.starts_with(start)).map(|row| row.1), 0, [0, 0]),
    };
    let schemes = [
        (b'S', "warfighting"),
        (b'G', "tactical graphics, dimension M"),
        (b'O', "stability"),
        (b'E', "emergency"),
    ];
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
        unknown_function: (known.is_none() && unknown != [b'-'; 6]).then_some(unknown),
    })
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

/// A function of 2525C and what it is in 2525D.
struct LetterFunction {
    /// Coding scheme, battle dimension and the six letters of the function.
    letters: [u8; 8],
    set: u8,
    entity: u32,
    modifiers: [u16; 2],
}

const fn row(letters: &[u8; 8], set: u8, entity: u32, modifiers: [u16; 2]) -> LetterFunction {
    LetterFunction { letters: *letters, set, entity, modifiers }
}

/// The functions whose entity and modifiers are drawn, by MIL-STD-2525D, appendix A, table of conversions.
const FUNCTIONS: &[LetterFunction] = &[
    row(b"EFLF----", 20, 121305, [0, 0]),
    row(b"EFLJ----", 20, 121307, [0, 0]),
    row(b"EFMB----", 20, 121402, [0, 0]),
    row(b"ENBC----", 40, 170202, [0, 0]),
    row(b"OOD-----", 40, 120100, [0, 0]),
    row(b"OOM-----", 40, 130500, [0, 0]),
    row(b"OOP-----", 40, 130100, [0, 0]),
    row(b"OVE-----", 40, 110600, [0, 0]),
    row(b"SAC-----", 1, 120000, [0, 0]),
    row(b"SACF----", 1, 120100, [0, 0]),
    row(b"SACH----", 1, 120200, [0, 0]),
    row(b"SAM-----", 1, 110000, [0, 0]),
    row(b"SAMF----", 1, 110100, [0, 0]),
    row(b"SAMFA---", 1, 110102, [0, 0]),
    row(b"SAMFB---", 1, 110103, [0, 0]),
    row(b"SAMFC---", 1, 110107, [0, 0]),
    row(b"SAMFF---", 1, 110104, [0, 0]),
    row(b"SAMFK---", 1, 110109, [0, 0]),
    row(b"SAMFQ---", 1, 110300, [0, 0]),
    row(b"SAMFR---", 1, 110111, [0, 0]),
    row(b"SAMH----", 1, 110200, [0, 0]),
    row(b"SF------", 10, 121800, [0, 0]),
    row(b"SFGC----", 10, 110200, [0, 0]),
    row(b"SFGS----", 10, 121700, [0, 0]),
    row(b"SGESR---", 15, 220300, [0, 0]),
    row(b"SGEVAA--", 15, 120103, [0, 0]),
    row(b"SGEVAI--", 15, 120101, [0, 0]),
    row(b"SGEVAT--", 15, 120200, [0, 0]),
    row(b"SGEVEA--", 15, 130900, [0, 0]),
    row(b"SGEVEB--", 15, 130100, [0, 0]),
    row(b"SGEVU---", 15, 140100, [0, 0]),
    row(b"SGEWA---", 15, 110500, [0, 0]),
    row(b"SGEWG---", 15, 110600, [0, 0]),
    row(b"SGEWH---", 15, 110900, [0, 0]),
    row(b"SGEWMA--", 15, 111100, [0, 0]),
    row(b"SGEWMAT-", 15, 111100, [0, 0]),
    row(b"SGEWMS--", 15, 111300, [0, 0]),
    row(b"SGEWMT--", 15, 111200, [0, 0]),
    row(b"SGEWO---", 15, 111400, [0, 0]),
    row(b"SGEWX---", 15, 111600, [0, 0]),
    row(b"SGEXM---", 15, 210100, [0, 0]),
    row(b"SGIB----", 20, 120802, [0, 0]),
    row(b"SGIBA---", 20, 121301, [0, 0]),
    row(b"SGIBN---", 20, 121309, [0, 0]),
    row(b"SGIXH---", 20, 120702, [0, 0]),
    row(b"SGUCA---", 10, 120500, [0, 0]),
    row(b"SGUCAA--", 10, 120400, [0, 0]),
    row(b"SGUCAAD-", 10, 120400, [0, 0]),
    row(b"SGUCAAL-", 10, 120400, [0, 19]),
    row(b"SGUCAAM-", 10, 120400, [0, 1]),
    row(b"SGUCAAU-", 10, 120400, [0, 27]),
    row(b"SGUCAT--", 10, 120500, [0, 0]),
    row(b"SGUCATA-", 10, 120500, [0, 1]),
    row(b"SGUCATH-", 10, 120500, [0, 15]),
    row(b"SGUCATL-", 10, 120500, [0, 19]),
    row(b"SGUCATM-", 10, 120500, [0, 24]),
    row(b"SGUCAW--", 10, 120500, [0, 51]),
    row(b"SGUCD---", 10, 130100, [0, 0]),
    row(b"SGUCDM--", 10, 130102, [0, 0]),
    row(b"SGUCDMH-", 10, 130102, [0, 15]),
    row(b"SGUCDML-", 10, 130102, [0, 19]),
    row(b"SGUCDMM-", 10, 130102, [0, 24]),
    row(b"SGUCE---", 10, 140700, [0, 0]),
    row(b"SGUCECA-", 10, 140700, [0, 1]),
    row(b"SGUCECT-", 10, 140701, [0, 0]),
    row(b"SGUCF---", 10, 130300, [0, 0]),
    row(b"SGUCFHA-", 10, 130300, [0, 1]),
    row(b"SGUCFHE-", 10, 130301, [0, 0]),
    row(b"SGUCFHH-", 10, 130300, [0, 15]),
    row(b"SGUCFHL-", 10, 130300, [0, 19]),
    row(b"SGUCFHM-", 10, 130300, [0, 24]),
    row(b"SGUCFHO-", 10, 130300, [0, 27]),
    row(b"SGUCFM--", 10, 130800, [0, 0]),
    row(b"SGUCFR--", 10, 130300, [41, 0]),
    row(b"SGUCFRM-", 10, 130300, [41, 0]),
    row(b"SGUCFRMR", 10, 130301, [41, 51]),
    row(b"SGUCFRMS", 10, 130301, [41, 0]),
    row(b"SGUCFTCM", 10, 130302, [0, 0]),
    row(b"SGUCI---", 10, 121100, [0, 0]),
    row(b"SGUCIA--", 10, 121100, [0, 1]),
    row(b"SGUCII--", 10, 121105, [0, 0]),
    row(b"SGUCIL--", 10, 121100, [0, 19]),
    row(b"SGUCIM--", 10, 121104, [0, 0]),
    row(b"SGUCIO--", 10, 121100, [0, 27]),
    row(b"SGUCIZ--", 10, 121102, [0, 0]),
    row(b"SGUCM---", 10, 130700, [0, 0]),
    row(b"SGUCR---", 10, 121300, [0, 0]),
    row(b"SGUCRA--", 10, 121300, [0, 1]),
    row(b"SGUCRL--", 10, 121300, [0, 19]),
    row(b"SGUCRO--", 10, 121300, [0, 27]),
    row(b"SGUCRRL-", 10, 120501, [0, 19]),
    row(b"SGUCRVA-", 10, 120501, [0, 0]),
    row(b"SGUCRVG-", 10, 121300, [0, 0]),
    row(b"SGUCS---", 10, 141700, [0, 0]),
    row(b"SGUCSA--", 10, 120600, [54, 0]),
    row(b"SGUCSG--", 10, 141700, [0, 0]),
    row(b"SGUCV---", 10, 120600, [0, 0]),
    row(b"SGUCVC--", 10, 120700, [0, 0]),
    row(b"SGUCVF--", 10, 120800, [0, 0]),
    row(b"SGUCVFA-", 10, 120800, [3, 0]),
    row(b"SGUCVRA-", 10, 120600, [3, 0]),
    row(b"SGUCVU--", 10, 121900, [0, 0]),
    row(b"SGUSM---", 10, 161300, [0, 0]),
    row(b"SGUSMC--", 10, 161300, [0, 0]),
    row(b"SGUSMM--", 10, 161400, [0, 0]),
    row(b"SGUSMMC-", 10, 161400, [0, 0]),
    row(b"SGUSMMT-", 10, 161400, [0, 0]),
    row(b"SGUSMT--", 10, 161300, [0, 0]),
    row(b"SGUST---", 10, 163600, [0, 0]),
    row(b"SGUSTC--", 10, 163600, [0, 0]),
    row(b"SGUSTT--", 10, 163600, [0, 0]),
    row(b"SGUSX---", 10, 161100, [0, 0]),
    row(b"SGUSXC--", 10, 161100, [0, 0]),
    row(b"SGUSXH--", 10, 161100, [0, 15]),
    row(b"SGUSXHC-", 10, 161100, [0, 15]),
    row(b"SGUSXHT-", 10, 161100, [0, 15]),
    row(b"SGUSXT--", 10, 161100, [0, 0]),
    row(b"SGUUA---", 10, 140100, [0, 0]),
    row(b"SGUUE---", 10, 140800, [0, 0]),
    row(b"SGUULM--", 10, 141200, [0, 0]),
    row(b"SGUUM---", 10, 151000, [0, 0]),
    row(b"SGUUMR--", 10, 151000, [0, 0]),
    row(b"SGUUMSE-", 10, 150500, [0, 0]),
    row(b"SGUUMSEC", 10, 150500, [0, 0]),
    row(b"SGUUMSET", 10, 150500, [0, 0]),
    row(b"SGUUS---", 10, 111000, [0, 0]),
    row(b"SSCA----", 30, 120300, [0, 0]),
    row(b"SSCLCC--", 30, 120202, [0, 0]),
    row(b"SSCLCV--", 30, 120100, [0, 0]),
    row(b"SSCLDD--", 30, 120203, [0, 0]),
    row(b"SSCLFF--", 30, 120204, [0, 0]),
    row(b"SSCM----", 30, 120400, [0, 0]),
    row(b"SSCP----", 30, 120500, [0, 0]),
    row(b"SSXM----", 30, 140100, [0, 0]),
];

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
