//! Compound coordinate reference systems by their EPSG codes: the horizontal system that each is made of.
//!
//! The registry numbers pairs of a horizontal system and a vertical datum, such as 7415: RD New and NAP heights. Models of
//! buildings state those. What lies in the plane is read in the horizontal system; heights are taken as they are.

/// A compound system and its horizontal one; as many in a row have consecutive codes.
struct CompoundRange {
    first: u32,
    count: u32,
    horizontal: u32,
}

const fn range(first: u32, count: u32, horizontal: u32) -> CompoundRange {
    CompoundRange { first, count, horizontal }
}

/// From the EPSG registry.
const COMPOUNDS: [CompoundRange; 24] = [
    range(5318, 1, 5316),   // Faroe TM and FVR09
    range(5498, 1, 4269),   // NAD83 and NAVD88
    range(5499, 1, 4152),   // NAD83(HARN) and NAVD88
    range(5500, 1, 4759),   // NAD83(NSRS2007) and NAVD88
    range(5554, 3, 25_831), // UTM zones 31 to 33 and DHHN92
    range(5698, 1, 2154),   // Lambert-93 and NGF-IGN69
    range(5699, 1, 2154),   // Lambert-93 and NGF-IGN78
    range(5845, 1, 3006),   // SWEREF99 TM and RH2000
    range(5846, 12, 3007),  // SWEREF99 12 00 to 23 15 and RH2000
    range(5942, 1, 4258),   // ETRS89 and NN2000
    range(5945, 26, 5105),  // NTM zones 5 to 30 and NN2000
    range(5971, 6, 25_831), // UTM zones 31 to 36 and NN2000
    range(6190, 1, 31_370), // Belgian Lambert 72 and Ostend
    range(6349, 1, 6318),   // NAD83(2011) and NAVD88
    range(6893, 1, 3857),   // Pseudo-Mercator and EGM2008
    range(7405, 1, 27_700), // British National Grid and ODN
    range(7409, 1, 4258),   // ETRS89 and EVRF2000
    range(7415, 1, 28_992), // RD New and NAP
    range(7416, 2, 25_832), // UTM zones 32 and 33 and DVR90
    range(7423, 1, 4258),   // ETRS89 and EVRF2007
    range(9289, 1, 4258),   // ETRS89 and LAT NL
    range(9518, 1, 4326),   // WGS 84 and EGM2008
    range(9707, 1, 4326),   // WGS 84 and EGM96
    range(9286, 1, 4258),   // ETRS89 and NAP
];

/// The EPSG code of the horizontal system of a compound one; `None` for a code that is no compound system known here.
pub fn horizontal_code(code: u32) -> Option<u32> {
    let holds = |range: &&CompoundRange| (range.first..range.first + range.count).contains(&code);
    COMPOUNDS.iter().find(holds).map(|range| range.horizontal + (code - range.first))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::crs::Crs;

    #[test]
    fn every_compound_system_has_a_horizontal_one_that_is_known() {
        for CompoundRange { first, count, .. } in &COMPOUNDS {
            for code in *first..first + count {
                let horizontal = horizontal_code(code).expect("in the table");
                assert!(Crs::from_epsg(horizontal).is_ok(), "EPSG:{code} lies on EPSG:{horizontal}");
                assert_eq!(Crs::from_epsg(code).expect("compound").epsg(), Some(horizontal));
            }
        }
        assert_eq!(horizontal_code(7415), Some(28_992));
        assert_eq!(horizontal_code(5973), Some(25_833));
        assert_eq!(horizontal_code(28_992), None);
    }
}
