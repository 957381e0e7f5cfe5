//! The properties by which the readers of overlays and scenarios say what a feature is, whatever its format is.
//!
//! | format | what becomes a feature |
//! |---|---|
//! | ORBAT Mapper | units where they are, from state to state; features and control measures of its layers |
//! | MSDL | units, equipment, tactical graphics |
//! | NVG | points, lines, areas and their parts |
//! | MilX | symbols |
//! | Cursor on Target | events |
//! | KML | placemarks with a style or a time |
//! | GeoJSON | as it is: these are the names of simplestyle 1.1 where that has one |
//!
//! Values are texts, but those of widths and opacities, which are numbers.

use serde_json::Value;

use crate::feature::Properties;

/// A symbol code: 15 letters, or 20 or 30 digits.
pub const SIDC: &str = "sidc";
/// The names that files have for the property of a symbol code, the most usual first.
pub const SIDC_SPELLINGS: [&str; 12] = [
    SIDC,
    "SIDC",
    "Sidc",
    "symbolCode",
    "symbol_code",
    "symbolcode",
    "SymbolCode",
    "symbolID",
    "sic",
    "SIC",
    "app6",
    "milsym",
];
/// The word of a tactical graphic, where there is no code.
pub const KIND: &str = "kind";
/// Whose a feature without a code is: `friend`, `hostile`, `neutral` or `unknown`.
pub const IDENTITY: &str = "identity";
/// Whether a feature without a code is `present` or `planned`.
pub const STATUS: &str = "status";
/// What it is called.
pub const NAME: &str = "name";
/// What is said of it.
pub const DESCRIPTION: &str = "description";
/// What the file calls it; the states of one thing have it in common.
pub const ID: &str = "id";
/// The side that it belongs to.
pub const SIDE: &str = "side";
/// The name of the unit above it.
pub const PARENT: &str = "parent";
/// The layer, folder or group that holds it.
pub const LAYER: &str = "layer";
/// The moment from which it is there, or where it is then: ISO 8601.
pub const BEGIN: &str = "begin";
/// The moment until which it is there.
pub const END: &str = "end";
/// Field T.
pub const UNIQUE_DESIGNATION: &str = "unique_designation";
/// Field T1.
pub const DESIGNATION_2: &str = "designation_2";
/// Field M.
pub const HIGHER_FORMATION: &str = "higher_formation";
/// Field G.
pub const STAFF_COMMENTS: &str = "staff_comments";
/// Field H.
pub const ADDITIONAL_INFORMATION: &str = "additional_information";
/// Field C.
pub const QUANTITY: &str = "quantity";
/// Field F: `(+)`, `(-)` or `(±)`.
pub const REINFORCED: &str = "reinforced";
/// Field V.
pub const TYPE: &str = "type";
/// Field W.
pub const DTG: &str = "dtg";
/// Field W1.
pub const DTG_2: &str = "dtg_2";
/// Field X.
pub const ALTITUDE: &str = "altitude";
/// Field Y.
pub const LOCATION: &str = "location";
/// Field Z.
pub const SPEED: &str = "speed";
/// Field Q: degrees clockwise from north.
pub const DIRECTION: &str = "direction";
/// Field P.
pub const IFF: &str = "iff";
/// Field K.
pub const COMBAT_EFFECTIVENESS: &str = "combat_effectiveness";
/// Field J.
pub const EVALUATION_RATING: &str = "evaluation_rating";
/// Field AA.
pub const SPECIAL_HEADQUARTERS: &str = "special_headquarters";
/// Field AS.
pub const COUNTRY: &str = "country";
/// Field B.
pub const ECHELON: &str = "echelon";
/// Field N.
pub const HOSTILE: &str = "hostile";
/// Field AP.
pub const TARGET: &str = "target";
/// Field AM: distances in meters, separated by spaces.
pub const DISTANCES: &str = "distances";
/// Field AN: azimuths in degrees, separated by spaces.
pub const AZIMUTHS: &str = "azimuths";
/// The width of a corridor, or of the head of an axis, in meters.
pub const WIDTH: &str = "width";
/// A text on the map.
pub const LABEL: &str = "label";
/// The color of a line: `#rrggbb`.
pub const STROKE: &str = "stroke";
/// The width of a line in pixels of a picture 1080 pixels high.
pub const STROKE_WIDTH: &str = "stroke-width";
/// The opacity of a line, 0..=1.
pub const STROKE_OPACITY: &str = "stroke-opacity";
/// The lengths of dashes and gaps, separated by commas; a line with any is dashed.
pub const STROKE_DASHES: &str = "stroke-dasharray";
/// The color of an area: `#rrggbb`, or `none`.
pub const FILL: &str = "fill";
/// The opacity of an area, 0..=1.
pub const FILL_OPACITY: &str = "fill-opacity";
/// The color of a point: `#rrggbb`.
pub const MARKER_COLOR: &str = "marker-color";

/// Sets a property to a text; an empty one sets nothing.
pub(crate) fn set(properties: &mut Properties, name: &str, text: impl Into<String>) {
    let text: String = text.into();
    let trimmed = text.trim();
    if !trimmed.is_empty() {
        let value = if trimmed.len() == text.len() { text } else { trimmed.to_owned() };
        properties.insert(name.to_owned(), Value::String(value));
    }
}

/// Sets a number that is one.
pub(crate) fn set_number(properties: &mut Properties, name: &str, number: Option<f64>) {
    let number = number.and_then(serde_json::Number::from_f64);
    number.into_iter().for_each(|number| drop(properties.insert(name.to_owned(), number.into())));
}

/// Sets the text field of letters such as `T1`, or of an option of milsymbol; returns whether the standard has it. Field F
/// becomes its mark.
pub(crate) fn set_field(properties: &mut Properties, letters: &str, text: &str) -> bool {
    let Some(property) = field_property(letters.trim()) else { return false };
    let known = properties.get(property).and_then(Value::as_str);
    match (property, known) {
        (REINFORCED, _) => set(properties, property, reinforced_mark(text)),
        // H and H1 are one text.
        (ADDITIONAL_INFORMATION, Some(known)) if known != text.trim() => {
            let both = format!("{known} {}", text.trim());
            set(properties, property, both);
        }
        _ => set(properties, property, text),
    }
    true
}

/// Sets the code of a text, by [`bare_code`]; returns `false` where it is none.
pub(crate) fn set_code(properties: &mut Properties, text: &str) -> bool {
    let code = bare_code(text);
    let is_code = code.is_some();
    code.into_iter().for_each(|code| set(properties, SIDC, code));
    is_code
}

/// Whether a text is a code of letters, such as `S-G-UCI----D---`, that leaves the standard identity open.
pub(crate) fn leaves_identity_open(text: &str) -> bool {
    let code = text.trim().rsplit(':').next().unwrap_or_default();
    !code.starts_with(['W', 'w'])
        && code.starts_with(|first: char| first.is_ascii_alphabetic())
        && code.get(1..).is_some_and(|rest| rest.starts_with(['-', '*', '_']))
}

/// A code with the standard identity of a letter of MIL-STD-2525C, where one is given.
pub(crate) fn with_identity(mut code: String, letter: Option<char>) -> String {
    let Some(letter) = letter else { return code };
    if code.len() == 15 {
        code.replace_range(1..2, letter.encode_utf8(&mut [0; 4]));
        return code;
    }
    let digit = match letter {
        'P' => "0",
        'A' => "2",
        'F' => "3",
        'N' => "4",
        'S' | 'J' => "5",
        'H' | 'K' => "6",
        _ => "1",
    };
    // Jokers and fakers are of exercises.
    if matches!(letter, 'J' | 'K') {
        code.replace_range(2..3, "1");
    }
    code.replace_range(3..4, digit);
    code
}

/// The mark of field F for the letters and words that files have for it; else the text.
pub(crate) fn reinforced_mark(text: &str) -> &str {
    let word = text.chars().filter(|letter| letter.is_alphanumeric() || "+-±".contains(*letter));
    match word.collect::<String>().to_ascii_uppercase().as_str() {
        "R" | "+" | "REINFORCED" => "(+)",
        "D" | "-" | "REDUCED" | "DETACHED" => "(-)",
        "RD" | "±" | "+-" | "REINFORCEDANDREDUCED" | "REINFORCEDREDUCED" | "REINFORCEDDETACHED" => "(±)",
        _ => text,
    }
}

/// A name that many features have in common, such as that of their layer, as long as a name may be: a long one would be
/// kept once for each.
pub(crate) fn shared_name(name: &str) -> String {
    const MOST_LETTERS: usize = 200;
    name.trim().chars().take(MOST_LETTERS).collect()
}

/// The fields of MIL-STD-2525D: letters, the names of their options in milsymbol, properties.
const FIELDS: [(&str, &str, &str); 26] = [
    ("T", "uniqueDesignation", UNIQUE_DESIGNATION),
    ("T1", "uniqueDesignation1", DESIGNATION_2),
    ("M", "higherFormation", HIGHER_FORMATION),
    ("G", "staffComments", STAFF_COMMENTS),
    ("H", "additionalInformation", ADDITIONAL_INFORMATION),
    ("H1", "additionalInformation1", ADDITIONAL_INFORMATION),
    ("C", "quantity", QUANTITY),
    ("F", "reinforcedReduced", REINFORCED),
    ("V", "type", TYPE),
    ("W", "dtg", DTG),
    ("W1", "dtg1", DTG_2),
    ("X", "altitudeDepth", ALTITUDE),
    ("Y", "location", LOCATION),
    ("Z", "speed", SPEED),
    ("Q", "direction", DIRECTION),
    ("P", "iffSif", IFF),
    ("K", "combatEffectiveness", COMBAT_EFFECTIVENESS),
    ("J", "evaluationRating", EVALUATION_RATING),
    ("AA", "specialHeadquarters", SPECIAL_HEADQUARTERS),
    ("AS", "country", COUNTRY),
    ("AC", "countryCode", COUNTRY),
    ("B", "echelon", ECHELON),
    ("N", "hostile", HOSTILE),
    ("AP", "targetNumber", TARGET),
    ("AM", "distance", DISTANCES),
    ("AN", "azimuth", AZIMUTHS),
];

/// The letters of the field that a property is, in MIL-STD-2525D; `None` where it is none.
pub fn field_letters(property: &str) -> Option<&'static str> {
    FIELDS.iter().find(|row| row.2 == property).map(|row| row.0)
}

/// The property of a text field: its letters in MIL-STD-2525D, such as `T1`, or its option in milsymbol, such as
/// `uniqueDesignation`; `None` where it is neither.
pub fn field_property(name: &str) -> Option<&'static str> {
    let found = FIELDS
        .iter()
        .find(|(letters, option, _)| letters.eq_ignore_ascii_case(name) || option.eq_ignore_ascii_case(name));
    found.map(|(.., property)| *property)
}

/// A symbol code without what programs write around it: a scheme such as `app6b:` or `2525d:`, options behind the code after
/// a comma, semicolon or bar, spaces. `None` where what remains is no code by its length and characters. What a code of letters
/// leaves open is settled.
pub fn bare_code(text: &str) -> Option<String> {
    let text = text.trim();
    let code = match text.rsplit_once(':') {
        Some((scheme, code)) if scheme.len() <= 40 => code,
        _ => text,
    };
    let code = code.split([',', ';', '|']).next().unwrap_or_default();
    let code: String = code.chars().filter(|letter| !letter.is_whitespace()).collect();
    let is_digits = code.bytes().all(|byte| byte.is_ascii_digit()) && matches!(code.len(), 20 | 30);
    let is_letters = matches!(code.len(), 10..=15)
        && code.bytes().all(|byte| byte.is_ascii_alphanumeric() || matches!(byte, b'-' | b'*' | b'_'))
        && code.starts_with(|first: char| first.is_ascii_alphabetic());
    match (is_digits, is_letters) {
        (true, _) => Some(code),
        (_, true) => Some(of_letters(&code)),
        _ => None,
    }
}

/// A code of 15 letters as MIL-STD-2525C has it: templates leave the identity and the status open, and APP-6A has command and
/// general maneuver in a category of its own. An open identity is that of a friend in a graphic, and unknown in a symbol.
fn of_letters(code: &str) -> String {
    let padded = format!("{code:-<15}").to_ascii_uppercase().replace(['_', '*'], "-");
    let (scheme, category) = (&padded[..1], &padded[2..3]);
    // The letters of weather are all of its kind.
    if scheme == "W" {
        return padded;
    }
    let open_identity = if scheme == "G" { "F" } else { "U" };
    let identity = if padded[1..].starts_with('-') { open_identity } else { &padded[1..2] };
    let status = if padded[3..].starts_with('-') { "P" } else { &padded[3..4] };
    let (function, rest) = padded[4..].split_at(6);
    match function.strip_prefix('M').filter(|_| scheme == "G" && category == "C") {
        Some(function) => format!("{scheme}{identity}G{status}{function:-<6}{rest}"),
        None => format!("{scheme}{identity}{category}{status}{function}{rest}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_are_known_by_their_letters_and_by_the_options_of_milsymbol() {
        assert_eq!(field_property("t1"), Some(DESIGNATION_2));
        assert_eq!(field_property("higherFormation"), Some(HIGHER_FORMATION));
        assert_eq!(field_property("fillColor"), None);
    }

    #[test]
    fn a_code_is_found_within_what_is_written_around_it() {
        assert_eq!(bare_code("app6a:SFGPUCI----D---").as_deref(), Some("SFGPUCI----D---"));
        assert_eq!(bare_code("2525d:10031000161211000000").as_deref(), Some("10031000161211000000"));
        assert_eq!(bare_code(" 1003 1000161211 000000").as_deref(), Some("10031000161211000000"));
        assert_eq!(bare_code("sfgpuci---").as_deref(), Some("SFGPUCI--------"));
        assert_eq!(bare_code("SFGPUCIA---F--G;XO").as_deref(), Some("SFGPUCIA---F--G"));
        assert_eq!(bare_code("S*G*UCI---*****").as_deref(), Some("SUGPUCI--------"));
        assert_eq!(bare_code("app6a:GHC*MGLP--*****").as_deref(), Some("GHGPGLP--------"));
        for other in ["", "infantry", "1003100016121100000", "http://a.b/c", "SFGPUCI---------"] {
            assert_eq!(bare_code(other), None, "{other}");
        }
    }

    #[test]
    fn open_letters_of_a_code_are_settled() {
        for (text, expected) in [
            ("S-G-UCI----F--G", "SUGPUCI----F--G"),
            ("SHG*UCI---*****", "SHGPUCI--------"),
            ("app6a:G*C*MALC--*****", "GFGPALC--------"),
            ("GHC*MGLP--****X", "GHGPGLP-------X"),
            ("WAS-WSTSS-P----", "WAS-WSTSS-P----"),
        ] {
            assert_eq!(bare_code(text).as_deref(), Some(expected), "{text}");
        }
        assert!(leaves_identity_open("app6a:G*C*MALC--*****") && leaves_identity_open("S-G-U----------"));
        assert!(!leaves_identity_open("SFG-U----------") && !leaves_identity_open("10031000161211000000"));
        assert!(!set_code(&mut Properties::new(), "icon.png"));
    }

    #[test]
    fn identities_replace_those_of_letters_and_digits() {
        let code = |code: &str, letter| with_identity(code.to_owned(), Some(letter));
        assert_eq!(code("SUGPUCI--------", 'H'), "SHGPUCI--------");
        assert_eq!(code("10031000141211000000", 'N'), "10041000141211000000");
        assert_eq!(code("10031000141211000000", 'K'), "10161000141211000000");
    }

    #[test]
    fn the_second_text_of_field_h_follows_the_first() {
        let mut properties = Properties::new();
        assert!(set_field(&mut properties, "H", "dug in") && set_field(&mut properties, "h1", " since noon"));
        assert_eq!(properties[ADDITIONAL_INFORMATION], "dug in since noon");
        assert!(!set_field(&mut properties, "XO", "$80FF"));
    }

    #[test]
    fn field_f_becomes_its_mark() {
        for (text, mark) in
            [("R", "(+)"), ("reduced", "(-)"), ("REINFORCED_AND_REDUCED", "(±)"), ("(+)", "(+)")]
        {
            assert_eq!(reinforced_mark(text), mark, "{text}");
        }
    }
}
