//! The shift between two systems' datums, in words: what a transform does to positions beyond the projection.
//!
//! A shift goes by way of WGS 84 and by the numbers that the systems' definitions state (PROJ's `+towgs84`, position
//! vector): three translations in meters, or those with three rotations in arc seconds and a scale in parts per
//! million. It is only as good as those: some meters for old national datums. Grids of shifts are not used; a datum
//! that needs one is refused before there is a shift to put into words.

use std::fmt;

/// What `+datum=` stands for in PROJ, where that is not WGS 84 itself.
const NAMED: [(&str, &str); 15] = [
    ("ggrs87", "-199.87,74.79,246.62"),
    ("potsdam", "598.1,73.7,418.2,0.202,0.045,-2.455,6.7"),
    ("carthage", "-263,6,431"),
    ("hermannskogel", "577.326,90.129,463.919,5.137,1.474,5.297,2.4232"),
    ("ire65", "482.53,-130.596,564.557,-1.042,-0.214,-0.631,8.15"),
    ("nzgd49", "59.47,-5.04,187.44,0.47,-0.1,1.024,-4.5993"),
    ("osgb36", "446.448,-125.157,542.06,0.1502,0.247,0.8421,-20.4894"),
    ("ch1903", "674.374,15.056,405.346"),
    ("osni52", "482.53,-130.596,564.557,-1.042,-0.214,-0.631,8.15"),
    ("rassadiran", "-133.63,-157.5,-158.62"),
    ("s_jtsk", "589,76,480"),
    ("beduaram", "-106,-87,188"),
    ("gunung_segara", "-403,684,41"),
    ("rnb72", "106.869,-52.2978,103.724,-0.33657,0.456955,-1.84218,1"),
    ("nad83", "0,0,0"),
];

/// How positions move from one datum to another.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum DatumShift {
    /// Both systems stand on one datum.
    NotNeeded,
    /// Both datums are taken to coincide with WGS 84, as PROJ takes them; they do to within two meters or so.
    Coincident,
    /// By these numbers to WGS 84 and from it; `None` for a side that coincides with it.
    ByWgs84 {
        /// From the source's datum to WGS 84.
        to_wgs84: Option<String>,
        /// From the target's datum to WGS 84, applied the other way round.
        from_wgs84: Option<String>,
    },
}

impl fmt::Display for DatumShift {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::NotNeeded => f.write_str("none needed"),
            Self::Coincident => f.write_str("none; both datums are taken to coincide with WGS 84"),
            Self::ByWgs84 { to_wgs84, from_wgs84 } => {
                let there = to_wgs84.as_ref().map(|numbers| format!("towgs84 {numbers}"));
                let back = from_wgs84.as_ref().map(|numbers| format!("towgs84 {numbers} reversed"));
                f.write_str(&[there, back].into_iter().flatten().collect::<Vec<_>>().join(", then "))
            }
        }
    }
}

impl DatumShift {
    /// Between the datums of two proj strings, both tied to WGS 84.
    pub(crate) fn between(from: &str, to: &str) -> Self {
        let (ours, theirs) = (numbers(from), numbers(to));
        let is_wgs84 = ours.as_deref() == Some("");
        match (ours.filter(|numbers| !is_zero(numbers)), theirs.clone().filter(|numbers| !is_zero(numbers))) {
            (None, None) if is_wgs84 && theirs.as_deref() == Some("") => Self::NotNeeded,
            (None, None) => Self::Coincident,
            (there, back) if there == back => Self::NotNeeded,
            (to_wgs84, from_wgs84) => Self::ByWgs84 { to_wgs84, from_wgs84 },
        }
    }
}

/// The numbers of a proj string's shift; empty for WGS 84 itself, `None` where none are stated.
fn numbers(text: &str) -> Option<String> {
    let value = |key: &str| text.split_whitespace().find_map(|word| word.strip_prefix(key));
    if let Some(stated) = value("+towgs84=") {
        return Some(trimmed(stated));
    }
    let name = value("+datum=")?.to_ascii_lowercase();
    if name == "wgs84" {
        return Some(String::new());
    }
    NAMED.iter().find(|(known, _)| *known == name).map(|(_, numbers)| (*numbers).to_owned())
}

/// Seven numbers of which the last four are 0 are three.
fn trimmed(stated: &str) -> String {
    let words: Vec<&str> = stated.split(',').collect();
    let zero = |word: &&str| word.trim().parse() == Ok(0.0);
    let kept = if words.len() == 7 && words[3..].iter().all(zero) { &words[..3] } else { &words[..] };
    kept.join(",")
}

fn is_zero(numbers: &str) -> bool {
    numbers.split(',').all(|word| word.is_empty() || word.trim().parse() == Ok(0.0))
}

#[cfg(test)]
mod tests {
    use crate::geom::crs::Crs;

    fn shift(from: &str, to: &str) -> String {
        let [from, to] = [from, to].map(|text| Crs::parse(text).expect("known"));
        from.datum_shift_to(&to).map_or_else(|error| error.to_string(), |shift| shift.to_string())
    }

    #[test]
    fn one_datum_needs_no_shift_and_modern_ones_are_taken_to_coincide() {
        assert_eq!(shift("EPSG:4326", "EPSG:32612"), "none needed");
        assert_eq!(shift("EPSG:26711", "EPSG:4267"), "none needed");
        assert_eq!(shift("EPSG:27700", "EPSG:27700"), "none needed");
        assert!(shift("EPSG:4269", "EPSG:32612").contains("taken to coincide"));
    }

    #[test]
    fn numbers_are_told_in_the_direction_that_they_are_used() {
        let old = "+proj=utm +zone=31 +ellps=intl +towgs84=-87,-98,-121,0,0,0,0";
        assert_eq!(shift(old, "EPSG:4326"), "towgs84 -87,-98,-121");
        assert_eq!(shift("EPSG:4326", old), "towgs84 -87,-98,-121 reversed");
        let other = "+proj=longlat +ellps=bessel +towgs84=1,2,3";
        assert_eq!(shift(old, other), "towgs84 -87,-98,-121, then towgs84 1,2,3 reversed");
        assert!(shift("EPSG:26711", "EPSG:4326").contains("grid file"));
    }
}
