//! What overlays state of a military symbol: its code, and its text fields by their letters.
//!
//! Codes of 15 letters are often templates, whose second letter leaves the standard identity open and whose fourth leaves
//! the status open. The identity comes from elsewhere in the file, or is told as missing.

use serde_json::Number;

use crate::error::shorten;
use crate::feature::Properties;

/// Letters and properties of text fields (MIL-STD-2525D, tables I and II; APP-6D, table 2-4).
const FIELDS: [(&str, &str); 26] = [
    ("B", "echelon"),
    ("C", "quantity"),
    ("F", "reinforced"),
    ("G", "staff_comments"),
    ("H", "additional_information"),
    ("H1", "additional_information_2"),
    ("J", "evaluation_rating"),
    ("K", "combat_effectiveness"),
    ("L", "signature_equipment"),
    ("M", "higher_formation"),
    ("N", "hostile"),
    ("P", "iff"),
    ("Q", "direction"),
    ("T", "unique_designation"),
    ("T1", "designation_2"),
    ("V", "type"),
    ("W", "dtg"),
    ("W1", "dtg_2"),
    ("X", "altitude"),
    ("X1", "altitude_2"),
    ("Y", "location"),
    ("Z", "speed"),
    ("AA", "special_headquarters"),
    ("AM", "distances"),
    ("AN", "azimuths"),
    ("AS", "country"),
];

/// A code as an overlay states it.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct StatedCode {
    /// 15 letters or 20 or 30 digits.
    pub text: String,
    /// Whether it leaves the standard identity open, so that the text has a substitute.
    pub is_template: bool,
}

/// The letter of a standard identity, outside of exercises.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Identity {
    Pending,
    Unknown,
    AssumedFriend,
    Friend,
    Neutral,
    Suspect,
    Hostile,
    Joker,
    Faker,
}

/// Returns the code of a text, without the scheme before it: `app6a:SFGPUCI--------` has one. What follows a code of 15
/// letters after a separator is left out.
///
/// In a template, an open identity becomes friend in a tactical graphic and unknown in a symbol, and an open status
/// becomes present. Maneuver graphics of APP-6A and MIL-STD-2525A, `G*C*M…`, become those of MIL-STD-2525C, `G*G*…`.
///
/// # Errors
/// A sentence where the text is no code.
pub(crate) fn code(text: &str) -> Result<StatedCode, String> {
    let unscoped = text.trim().rsplit_once(':').map_or(text.trim(), |(_, code)| code.trim());
    let code = unscoped.split([',', ';', '|', '/', ' ']).next().unwrap_or_default();
    let is_digits = matches!(code.len(), 20 | 30) && code.bytes().all(|digit| digit.is_ascii_digit());
    if is_digits {
        return Ok(StatedCode { text: code.to_owned(), is_template: false });
    }
    let is_letter = |letter: u8| letter.is_ascii_alphanumeric() || matches!(letter, b'-' | b'*' | b'_');
    if !code.bytes().all(is_letter) || !(10..=15).contains(&code.len()) {
        return Err(format!("'{}' is not a symbol code of 15 letters or of 20 or 30 digits", shorten(text.trim())));
    }
    // Many writers leave off the last letters, which are all dashes.
    let mut letters: Vec<u8> = code.to_ascii_uppercase().bytes().map(|l| if l == b'_' { b'-' } else { l }).collect();
    letters.resize(15, b'-');
    let is_open = |letter: u8| matches!(letter, b'-' | b'*');
    let is_graphic = letters[0] == b'G';
    // 2525C has no graphics of dimension C.
    if is_graphic && letters[2] == b'C' && letters[4] == b'M' {
        letters[2] = b'G';
        letters.copy_within(5..10, 4);
        letters[9] = b'-';
    }
    let is_template = is_open(letters[1]);
    // Weather has no identity: its second letter is its kind.
    if is_template && letters[0] != b'W' {
        letters[1] = if is_graphic { b'F' } else { b'U' };
    }
    if is_open(letters[3]) && letters[0] != b'W' {
        letters[3] = b'P';
    }
    let text = String::from_utf8_lossy(&letters).into_owned();
    Ok(StatedCode { text, is_template: is_template && letters[0] != b'W' })
}

/// Returns the code with another standard identity; a code of an exercise stays one.
pub(crate) fn with_identity(code: &str, identity: Identity) -> String {
    let mut code = code.as_bytes().to_vec();
    match code.len() {
        15 => {
            let is_exercise = matches!(code[1], b'G' | b'W' | b'M' | b'D' | b'L');
            code[1] = identity.letter(is_exercise);
        }
        20 | 30 => {
            if matches!(identity, Identity::Joker | Identity::Faker) {
                code[2] = b'1';
            }
            code[3] = identity.digit();
        }
        _ => {}
    }
    String::from_utf8_lossy(&code).into_owned()
}

impl Identity {
    fn letter(self, is_exercise: bool) -> u8 {
        let [real, exercise] = match self {
            Self::Pending => [b'P', b'G'],
            Self::Unknown => [b'U', b'W'],
            Self::AssumedFriend => [b'A', b'M'],
            Self::Friend => [b'F', b'D'],
            Self::Neutral => [b'N', b'L'],
            Self::Suspect => [b'S', b'J'],
            Self::Hostile => [b'H', b'K'],
            Self::Joker => [b'J'; 2],
            Self::Faker => [b'K'; 2],
        };
        if is_exercise { exercise } else { real }
    }

    fn digit(self) -> u8 {
        match self {
            Self::Pending => b'0',
            Self::Unknown => b'1',
            Self::AssumedFriend => b'2',
            Self::Friend => b'3',
            Self::Neutral => b'4',
            Self::Suspect | Self::Joker => b'5',
            Self::Hostile | Self::Faker => b'6',
        }
    }
}

/// Adds a text property, unless the text is empty or only space.
pub(crate) fn put(properties: &mut Properties, name: &str, text: impl AsRef<str>) {
    let text = text.as_ref().trim();
    if !text.is_empty() {
        properties.insert(name.into(), text.into());
    }
}

/// Adds a number, unless it is not finite.
pub(crate) fn put_number(properties: &mut Properties, name: &str, number: f64) {
    if let Some(number) = Number::from_f64(number) {
        properties.insert(name.into(), number.into());
    }
}

/// Adds the field with the letter `letter`, such as `T` or `AA`; returns `false` where the standard has none or its value is
/// of another type.
pub(crate) fn put_field(properties: &mut Properties, letter: &str, text: &str) -> bool {
    let text = text.trim();
    if text.is_empty() {
        return true;
    }
    let letter = letter.trim().to_ascii_uppercase();
    let Some(&(_, name)) = FIELDS.iter().find(|field| field.0 == letter) else { return false };
    match name {
        "direction" => {
            let Some(degrees) = text.trim_end_matches('°').parse().ok().filter(|d: &f64| d.abs() <= 360.0) else {
                return false;
            };
            put_number(properties, name, degrees);
        }
        "reinforced" => put(properties, name, reinforced_mark(text)),
        _ => put(properties, name, text),
    }
    true
}

/// Returns the mark of field F for the words and letters that files have for it, else the text.
pub(crate) fn reinforced_mark(text: &str) -> &str {
    let word: String = text.chars().filter(|letter| letter.is_alphanumeric() || "+-±".contains(*letter)).collect();
    match word.to_ascii_uppercase().as_str() {
        "R" | "+" | "REINFORCED" => "(+)",
        "D" | "-" | "REDUCED" | "DETACHED" => "(-)",
        "RD" | "±" | "+-" | "REINFORCEDANDREDUCED" | "REINFORCEDREDUCED" | "REINFORCEDDETACHED" => "(±)",
        _ => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text_of(text: &str) -> String {
        code(text).expect(text).text
    }

    #[test]
    fn schemes_and_what_follows_a_code_are_taken_off() {
        assert_eq!(text_of("app6a:SFGPUCI---*****"), "SFGPUCI---*****");
        assert_eq!(text_of(" 2525b:sfgpuci---_____ "), "SFGPUCI--------");
        assert_eq!(text_of("SFGPUCIA---F--G;XO"), "SFGPUCIA---F--G");
        assert_eq!(text_of("urn:app6d:10031000141211000000"), "10031000141211000000");
        assert_eq!(text_of("SFGPUCI---"), "SFGPUCI--------");
        for wrong in ["", "SF", "SFGPUCI-----------", "1003100014121100000", "SFGPÜCI--------", "icon.png"] {
            assert!(code(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn templates_have_a_substitute_and_say_so() {
        let template = |text: &str| StatedCode { text: text.into(), is_template: true };
        assert_eq!(code("S-G-UCI----F--G"), Ok(template("SUGPUCI----F--G")));
        assert_eq!(code("G*M*OGB---****X"), Ok(template("GFMPOGB---****X")));
        assert!(!code("SHG-UCI----F--G").expect("a code").is_template);
        assert_eq!(text_of("SHG-UCI----F--G"), "SHGPUCI----F--G");
        let weather = code("WAS-WSTSS-P----").expect("a code");
        assert_eq!((weather.text.as_str(), weather.is_template), ("WAS-WSTSS-P----", false));
    }

    #[test]
    fn maneuver_graphics_of_app_6a_are_those_of_2525c() {
        assert_eq!(text_of("app6a:G*C*MALC--*****"), "GFGPALC---*****");
        assert_eq!(text_of("app6a:GHC*MGLP--****X"), "GHGPGLP---****X");
    }

    #[test]
    fn identities_replace_those_of_letters_and_digits() {
        assert_eq!(with_identity("SUGPUCI--------", Identity::Hostile), "SHGPUCI--------");
        assert_eq!(with_identity("SDGPUCI--------", Identity::Neutral), "SLGPUCI--------");
        assert_eq!(with_identity("10031000141211000000", Identity::Hostile), "10061000141211000000");
        assert_eq!(with_identity("10031000141211000000", Identity::Faker), "10161000141211000000");
    }

    #[test]
    fn fields_have_the_names_of_the_scene_files_keys() {
        let mut properties = Properties::new();
        for (letter, text) in [("T", " 2BN "), ("q", "175.4"), ("F", "RD"), ("AA", "SHAPE"), ("M", "")] {
            assert!(put_field(&mut properties, letter, text), "{letter}");
        }
        assert!(!put_field(&mut properties, "XO", "$000080FF") && !put_field(&mut properties, "Q", "north"));
        let expected = serde_json::json!({
            "unique_designation": "2BN", "direction": 175.4, "reinforced": "(±)", "special_headquarters": "SHAPE",
        });
        assert_eq!(serde_json::to_value(&properties).expect("texts"), expected);
    }
}
