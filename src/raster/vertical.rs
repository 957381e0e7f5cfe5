//! Vertical datums by EPSG's numbers, and the vertical parts of compound systems in WKT.
//!
//! The names are carried along and printed; that two of them differ is for the user to see. Heights are brought only between
//! those of [`HeightDatum`](crate::height_datum::HeightDatum).

/// EPSG's numbers of vertical systems, and those of GeoTIFF 1.0 (5101 to 5106). A name's first number is written.
const NAMES: [(&str, &[u16]); 30] = [
    ("NAVD88", &[5703, 6360, 8228, 5103]),
    ("NGVD29", &[7968, 5702, 5102]),
    ("EGM96 geoid", &[5773]),
    ("WGS 84 ellipsoid", &[4979, 5030]),
    ("EGM2008 geoid", &[3855]),
    ("EGM84 geoid", &[5798]),
    ("mean sea level", &[5714]),
    ("Ordnance Datum Newlyn", &[5701, 5101]),
    ("NAP", &[5709]),
    ("Ostend", &[5710]),
    ("DHHN92", &[5783]),
    ("DHHN2016", &[7837]),
    ("NGF-IGN69", &[5720]),
    ("LN02", &[5728]),
    ("GHA", &[5778]),
    ("EVRF2007", &[5621]),
    ("EVRF2000", &[5730]),
    ("RH2000", &[5613]),
    ("NN2000", &[5941]),
    ("N2000", &[3900]),
    ("DVR90", &[5799]),
    ("Alicante", &[5782]),
    ("Cascais", &[5780]),
    ("Baltic 1977", &[5705, 5105]),
    ("AHD", &[5711]),
    ("NZVD2016", &[7839]),
    ("CGVD28", &[5713]),
    ("CGVD2013", &[6647]),
    ("JGD2011", &[6695]),
    ("Yellow Sea", &[5104]),
];

/// The name of a number; `EPSG:n` where it has none here.
pub fn name(code: u16) -> String {
    let known = NAMES.iter().find(|(_, codes)| codes.contains(&code));
    known.map_or_else(|| format!("EPSG:{code}"), |(name, _)| (*name).into())
}

/// The number with this [`name`].
pub fn code(name: &str) -> Option<u16> {
    let known = NAMES.iter().find(|(known, _)| *known == name).map(|(_, codes)| codes[0]);
    known.or_else(|| name.strip_prefix("EPSG:")?.parse().ok())
}

/// The vertical part of a compound system, from its keyword on.
fn part_of_wkt(wkt: &str) -> Option<&str> {
    let at = ["VERT_CS[", "VERTCS[", "VERTCRS["].iter().filter_map(|keyword| wkt.find(keyword)).min()?;
    wkt.get(at..)
}

/// Meters in the unit of the vertical part of a compound system in WKT; `None` without one.
pub fn unit_of_wkt(wkt: &str) -> Option<f64> {
    let part = part_of_wkt(wkt)?;
    let unit = &part[part.find("UNIT[")?..];
    let factor = unit.split(',').nth(1)?.split(']').next()?.trim();
    factor.parse().ok().filter(|factor: &f64| factor.is_finite() && *factor > 0.0)
}

/// The name of the vertical part of a compound system in WKT; `None` without one.
pub fn name_of_wkt(wkt: &str) -> Option<String> {
    part_of_wkt(wkt)?.split('"').nth(1).map(str::to_owned).filter(|name| !name.is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_vertical_part_gives_its_unit_and_name() {
        let wkt = "COMPD_CS[\"x\",PROJCS[\"y\",UNIT[\"metre\",1]],VERT_CS[\"NAVD88 height (ftUS)\",VERT_DATUM[\"n\",2005],UNIT[\"US survey foot\",0.304800609601219,AUTHORITY[\"EPSG\",\"9003\"]],AXIS[\"Up\",UP]]]";
        assert_eq!(unit_of_wkt(wkt), Some(0.304_800_609_601_219));
        assert_eq!(name_of_wkt(wkt).as_deref(), Some("NAVD88 height (ftUS)"));
        assert_eq!(unit_of_wkt("PROJCS[\"y\",UNIT[\"metre\",1]]"), None);
    }

    #[test]
    fn names_lead_back_to_a_number_that_has_them() {
        for &number in NAMES.iter().flat_map(|(_, codes)| *codes) {
            assert_eq!(name(code(&name(number)).expect("a name of the table")), name(number));
        }
        assert_eq!((name(5703), name(9999)), ("NAVD88".into(), "EPSG:9999".into()));
        assert_eq!((code("EPSG:9999"), code("somewhere")), (Some(9999), None));
    }
}
