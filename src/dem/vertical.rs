//! Vertical datums by EPSG's numbers: what heights of a raster are counted from.
//!
//! The words are carried along and printed, never computed with; that two of them differ is for the user to see.

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

/// The words for a number; `EPSG:n` where it has no name here.
pub(crate) fn words(code: u16) -> String {
    NAMES
        .iter()
        .find(|(known, _)| *known == code)
        .map_or_else(|| format!("EPSG:{code}"), |(_, name)| (*name).into())
}

/// The number that [`words`] gives these words for.
pub(crate) fn code(words: &str) -> Option<u16> {
    let named = NAMES.iter().find(|(_, name)| *name == words).map(|(code, _)| *code);
    named.or_else(|| words.strip_prefix("EPSG:")?.parse().ok())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_lead_back_to_a_number_that_has_them() {
        for (number, _) in NAMES {
            assert_eq!(words(code(&words(number)).expect("a name of the table")), words(number));
        }
        assert_eq!((words(5703), words(9999)), ("NAVD88".into(), "EPSG:9999".into()));
        assert_eq!((code("EPSG:9999"), code("somewhere")), (Some(9999), None));
    }
}
