//! Vertical datums by EPSG's numbers.
//!
//! The names are carried along and printed, never computed with; that two of them differ is for the user to see.

/// EPSG's vertical systems that elevation is met in, and the numbers of GeoTIFF 1.0 (5101 to 5106).
///
/// Where several numbers have one name, the first is written.
const NAMES: [(u16, &str); 36] = [
    (5703, "NAVD88"),
    (6360, "NAVD88"),
    (8228, "NAVD88"),
    (5103, "NAVD88"),
    (7968, "NGVD29"),
    (5702, "NGVD29"),
    (5102, "NGVD29"),
    (5773, "EGM96 geoid"),
    (3855, "EGM2008 geoid"),
    (5798, "EGM84 geoid"),
    (5714, "mean sea level"),
    (5701, "Ordnance Datum Newlyn"),
    (5101, "Ordnance Datum Newlyn"),
    (5709, "NAP"),
    (5710, "Ostend"),
    (5783, "DHHN92"),
    (7837, "DHHN2016"),
    (5720, "NGF-IGN69"),
    (5728, "LN02"),
    (5778, "GHA"),
    (5621, "EVRF2007"),
    (5730, "EVRF2000"),
    (5613, "RH2000"),
    (5941, "NN2000"),
    (3900, "N2000"),
    (5799, "DVR90"),
    (5782, "Alicante"),
    (5780, "Cascais"),
    (5705, "Baltic 1977"),
    (5105, "Baltic 1977"),
    (5711, "AHD"),
    (7839, "NZVD2016"),
    (5713, "CGVD28"),
    (6647, "CGVD2013"),
    (6695, "JGD2011"),
    (5104, "Yellow Sea"),
];

/// The name of a number; `EPSG:n` where it has none here.
pub(crate) fn name(code: u16) -> String {
    NAMES
        .iter()
        .find(|(known, _)| *known == code)
        .map_or_else(|| format!("EPSG:{code}"), |(_, name)| (*name).into())
}

/// The number with this [`name`].
pub(crate) fn code(name: &str) -> Option<u16> {
    let known = NAMES.iter().find(|(_, known)| *known == name).map(|(code, _)| *code);
    known.or_else(|| name.strip_prefix("EPSG:")?.parse().ok())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_lead_back_to_a_number_that_has_them() {
        for (number, _) in NAMES {
            assert_eq!(name(code(&name(number)).expect("a name of the table")), name(number));
        }
        assert_eq!((name(5703), name(9999)), ("NAVD88".into(), "EPSG:9999".into()));
        assert_eq!((code("EPSG:9999"), code("somewhere")), (Some(9999), None));
    }
}
