//! The datum shift between two systems in words, for reports.
//!
//! A shift passes through WGS 84 by the parameters that the systems' definitions state (PROJ's `+towgs84`, position
//! vector): three translations in meters, or seven parameters with three rotations in arc seconds and a scale in parts
//! per million. Such a shift is good to some meters for old national datums. Shift grids are not read.

use std::fmt;

use crate::proj_string::ProjString;

/// The parameters of PROJ's named datums other than WGS 84; `proj4rs` keeps its own table private.
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

/// The way in which a transform moves positions from one datum to another.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum DatumShift {
    /// Both systems have the same datum.
    NotNeeded,
    /// Both datums are taken to coincide with WGS 84, as PROJ takes them; they do within about two meters.
    Coincident,
    /// By parameters to WGS 84 and from it; `None` for a datum that coincides with it.
    ByWgs84 {
        /// From the source's datum to WGS 84.
        to_wgs84: Option<String>,
        /// From the target's datum to WGS 84, applied in reverse.
        from_wgs84: Option<String>,
    },
}

impl fmt::Display for DatumShift {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::NotNeeded => f.write_str("none needed"),
            Self::Coincident => f.write_str("none; both datums are taken to coincide with WGS 84"),
            Self::ByWgs84 { to_wgs84, from_wgs84 } => {
                let to = to_wgs84.as_ref().map(|numbers| format!("towgs84 {numbers}"));
                let from = from_wgs84.as_ref().map(|numbers| format!("towgs84 {numbers} reversed"));
                f.write_str(&[to, from].into_iter().flatten().collect::<Vec<_>>().join(", then "))
            }
        }
    }
}

impl DatumShift {
    /// The meters that positions may be off after the shift; `None` where none is needed.
    ///
    /// Of transformations by seven parameters the EPSG registry states mostly 1 to 5 m, of those by three 5 to 25 m.
    pub fn accuracy_m(&self) -> Option<f64> {
        /// Modern datums lie within this of WGS 84, and drift apart as continents do.
        const COINCIDENT_M: f64 = 2.0;
        const SEVEN_PARAMETERS_M: f64 = 5.0;
        const THREE_PARAMETERS_M: f64 = 25.0;
        let of_parameters = |numbers: &String| match numbers.split(',').count() {
            7 => SEVEN_PARAMETERS_M,
            _ => THREE_PARAMETERS_M,
        };
        match self {
            Self::NotNeeded => None,
            Self::Coincident => Some(COINCIDENT_M),
            Self::ByWgs84 { to_wgs84, from_wgs84 } => {
                Some(to_wgs84.iter().chain(from_wgs84).map(of_parameters).sum())
            }
        }
    }

    /// Between the datums of two proj strings, both of which state their relation to WGS 84.
    pub(crate) fn between(from: ProjString<'_>, to: ProjString<'_>) -> Self {
        let (source, target) = (parameters(from), parameters(to));
        let both_wgs84 = [&source, &target].iter().all(|numbers| numbers.as_deref() == Some(""));
        let shifting = |numbers: Option<String>| numbers.filter(|numbers| !is_zero(numbers));
        match (shifting(source), shifting(target)) {
            (None, None) if both_wgs84 => Self::NotNeeded,
            (None, None) => Self::Coincident,
            (to_wgs84, from_wgs84) if to_wgs84 == from_wgs84 => Self::NotNeeded,
            (to_wgs84, from_wgs84) => Self::ByWgs84 { to_wgs84, from_wgs84 },
        }
    }
}

/// The shift parameters of a proj string; empty for WGS 84 itself, `None` where it states none.
fn parameters(text: ProjString<'_>) -> Option<String> {
    if let Some(stated) = text.value("towgs84") {
        return Some(shortest(stated));
    }
    let name = text.value("datum")?.to_ascii_lowercase();
    if name == "wgs84" {
        return Some(String::new());
    }
    NAMED.iter().find(|(known, _)| *known == name).map(|(_, numbers)| (*numbers).to_owned())
}

/// Three of seven parameters where the other four are 0.
fn shortest(stated: &str) -> String {
    let words: Vec<&str> = stated.split(',').collect();
    let is_short = words.len() == 7 && words[3..].iter().all(|word| is_zero(word));
    if is_short { words[..3].join(",") } else { stated.to_owned() }
}

fn is_zero(numbers: &str) -> bool {
    numbers.split(',').all(|word| word.is_empty() || word.trim().parse() == Ok(0.0))
}

#[cfg(test)]
mod tests {
    use crate::crs::Crs;

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
    fn a_shift_is_as_good_as_its_parameters() {
        let accuracy_m = |from: &str, to: &str| {
            let [from, to] = [from, to].map(|text| Crs::parse(text).expect("known"));
            from.datum_shift_to(&to).expect("a shift").accuracy_m()
        };
        assert_eq!(accuracy_m("EPSG:4326", "EPSG:32612"), None);
        assert_eq!(accuracy_m("EPSG:4269", "EPSG:32612"), Some(2.0));
        assert_eq!(accuracy_m("EPSG:27700", "EPSG:4326"), Some(5.0));
        assert_eq!(accuracy_m("EPSG:4326", "+proj=longlat +ellps=bessel +towgs84=1,2,3"), Some(25.0));
        let both = "+proj=longlat +ellps=intl +towgs84=-87,-98,-121";
        assert_eq!(accuracy_m("EPSG:27700", both), Some(30.0));
    }

    #[test]
    fn parameters_are_stated_in_the_direction_of_use() {
        let old = "+proj=utm +zone=31 +ellps=intl +towgs84=-87,-98,-121,0,0,0,0";
        assert_eq!(shift(old, "EPSG:4326"), "towgs84 -87,-98,-121");
        assert_eq!(shift("EPSG:4326", old), "towgs84 -87,-98,-121 reversed");
        let other = "+proj=longlat +ellps=bessel +towgs84=1,2,3";
        assert_eq!(shift(old, other), "towgs84 -87,-98,-121, then towgs84 1,2,3 reversed");
        assert!(shift("EPSG:26711", "EPSG:4326").contains("grid file"));
    }
}
