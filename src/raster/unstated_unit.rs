//! Elevations that are read as meters although their coordinates are in feet.
//!
//! State models of the United States and others are in feet both ways, and most of their files state the unit of coordinates
//! alone. GDAL takes their elevations for meters as well; nothing is guessed here, but it is said.

use std::ops::Range;

use crate::raster::Raster;
use sandtable_geom::length_unit::{FOOT_M, US_SURVEY_FOOT_M};

/// What the units are in meters that are called a foot: the international one, that of US surveys, and older ones.
pub const FEET_M: Range<f64> = 0.3047..0.3049;

/// How many times too high feet are that are read as meters.
const TOO_HIGH: &str = "3.28 times too high";

/// The name of the foot in which the coordinates of a raster are; `None` where they are in another unit, or in degrees.
pub fn foot_of_coordinates(raster: &Raster) -> Option<String> {
    let crs = raster.crs.as_ref().filter(|crs| !crs.is_geographic())?;
    let unit_m = crs.meters_per_unit();
    let is = |foot_m: f64| (unit_m - foot_m).abs() < 1e-9;
    FEET_M.contains(&unit_m).then(|| match unit_m {
        _ if is(FOOT_M) => "feet".to_owned(),
        _ if is(US_SURVEY_FOOT_M) => "US survey feet".to_owned(),
        _ => format!("feet of {unit_m} m"),
    })
}

/// A sentence on elevations that are read as meters only because nothing states their unit, while their coordinates are in
/// feet; `None` of others.
pub fn note(raster: &Raster) -> Option<String> {
    let foot = foot_of_coordinates(raster).filter(|_| !raster.states_z_unit && raster.meters_per_z == 1.0)?;
    Some(format!(
        "coordinates are in {foot}, and nothing states the unit of elevations: they are read as meters, and are {TOO_HIGH} if \
         they are in feet as well"
    ))
}

/// How a user has them read in their unit.
pub const REMEDY: &str =
    "say `vertical_unit = \"ft\"` or \"us-ft\" under [terrain], or \"m\" if they are meters";

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raster::Samples;
    use sandtable_geom::crs::Crs;

    fn raster(epsg: u32) -> Raster {
        Raster { crs: Crs::from_epsg(epsg).ok(), ..Raster::new(1, Samples::F32(vec![300.0])) }
    }

    #[test]
    fn only_feet_without_a_unit_of_elevations_are_noted() {
        let survey = note(&raster(2272)).expect("noted");
        assert!(survey.starts_with("coordinates are in US survey feet, and"), "{survey}");
        assert!(note(&raster(2222)).expect("Arizona").starts_with("coordinates are in feet, and"));
        for quiet in [
            raster(32616),
            raster(4326),
            raster(0),
            Raster { states_z_unit: true, ..raster(2272) },
            Raster { states_z_unit: true, meters_per_z: 0.3048, ..raster(2272) },
        ] {
            assert_eq!(note(&quiet), None, "{:?}", quiet.crs);
        }
    }
}
