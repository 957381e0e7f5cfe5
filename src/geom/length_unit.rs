//! Units of length, and the names and EPSG numbers that files state them by.

/// Meters in an international foot.
pub const FOOT_M: f64 = 0.3048;

/// Meters in a US survey foot.
pub const US_SURVEY_FOOT_M: f64 = 1200.0 / 3937.0;

/// EPSG's number (0 for none), meters, and the names in GDAL: the first is written, all are read.
const LENGTHS: [(u16, f64, &[&str]); 6] = [
    (9001, 1.0, &["m", "", "metre", "meter", "metres", "meters"]),
    (9002, FOOT_M, &["ft", "foot", "feet", "international foot", "international feet"]),
    (9003, US_SURVEY_FOOT_M, &["US survey foot", "us-ft", "ftus", "sft", "us survey feet", "foot_us"]),
    (9036, 1000.0, &["km", "kilometre", "kilometer"]),
    (0, 0.01, &["cm", "centimetre", "centimeter", "centimetres", "centimeters"]),
    (0, 0.1, &["dm", "decimetre", "decimeter", "decimetres", "decimeters"]),
];

/// Meters in the unit with an EPSG number.
pub fn length_of_code(code: u16) -> Option<f64> {
    LENGTHS.iter().find(|(known, ..)| code != 0 && *known == code).map(|(_, meters, _)| *meters)
}

/// EPSG's number of the unit of `meters`; `None` where it has none.
pub fn code_of_length(meters: f64) -> Option<u16> {
    let known = LENGTHS.iter().find(|(_, known, _)| (meters - known).abs() < 1e-12);
    known.map(|(code, ..)| *code).filter(|code| *code != 0)
}

/// Meters in a unit by its name, in any case.
pub fn length_of_name(name: &str) -> Option<f64> {
    let is_named = |names: &[&str]| names.iter().any(|known| known.eq_ignore_ascii_case(name));
    LENGTHS.iter().find(|(.., names)| is_named(names)).map(|(_, meters, _)| *meters)
}

/// Meters in a unit by its name in LandXML (its types `metLinear`, `impLinear` and `elevationType`).
pub fn length_of_land_xml(name: &str) -> Option<f64> {
    Some(match name {
        "millimeter" => 0.001,
        "centimeter" => 0.01,
        "meter" => 1.0,
        "kilometer" => 1000.0,
        "inch" => 0.0254,
        "foot" | "feet" => FOOT_M,
        "USSurveyFoot" => US_SURVEY_FOOT_M,
        "mile" | "miles" => 1609.344,
        _ => return None,
    })
}

/// GDAL's name of a unit of `meters`: a meter or a foot.
pub fn name_of_length(meters: f64) -> Option<&'static str> {
    let code = code_of_length(meters).filter(|code| *code != 9036)?;
    LENGTHS.iter().find(|(known, ..)| *known == code).map(|(.., names)| names[0])
}
