//! Which classification a raster holds, by its values and the size of its cells.
//!
//! While a raster is read, each value has a number of one byte, whatever the classification is:
//!
//! ```text
//!   0            no data: 0, 128, 255, -128, CORINE's 990, 995 and 999, and what the file states
//!   1 … 100      the value itself: ESA WorldCover, or CORINE's numbers from 1 on
//!   101 … 144    CORINE's codes 111 … 523 by their number
//! ```

use super::{corine, world_cover};
use sandtable_description::words::Cover;
use sandtable_raster::class_grid::NO_CLASS;

/// A class of land cover.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LandClass {
    /// Its number in the classification.
    pub code: u16,
    /// Its name there.
    pub name: &'static str,
    /// What it is drawn with; `None` of water, which lies level: lakes, rivers and coasts draw it.
    pub cover: Option<Cover>,
}

/// The classification of a raster.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ClassLegend {
    /// ESA WorldCover: 10, 20, … 100.
    WorldCover,
    /// CORINE Land Cover by codes of three digits.
    Corine,
    /// CORINE Land Cover by numbers from 1 to 44.
    CorineNumbers,
}

/// Values are no classes that are known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UnknownClass(pub f64);

/// The number that CORINE's rasters have where nothing is known.
const CORINE_NODATA: u8 = 48;

/// What CORINE's first code has in the byte that stands for it.
const FIRST_CODE: u8 = 101;

/// Cells of CORINE's numbers are larger, in meters: they are 100 m and 250 m. Elevation in bytes has such values, too, and the first
/// tens are classes of both classifications.
const LEAST_CORINE_M: f64 = 40.0;

/// The byte of a value; `None` of one that no classification has.
pub fn byte_of(value: f64) -> Option<u8> {
    const NODATA: [f64; 7] = [0.0, 128.0, 255.0, -128.0, 990.0, 995.0, 999.0];
    if value.is_nan() || NODATA.contains(&value) {
        return Some(NO_CLASS);
    }
    let is_whole = value.fract() == 0.0;
    match value as i32 {
        small @ 1..=100 if is_whole => Some(small as u8),
        code @ 111..=523 if is_whole => {
            let index = corine::CLASSES.binary_search_by_key(&(code as u16), |class| class.code).ok()?;
            Some(FIRST_CODE + index as u8)
        }
        _ => None,
    }
}

/// The value that a byte stands for.
fn value_of(byte: u8) -> f64 {
    match byte.checked_sub(FIRST_CODE) {
        Some(index) => corine::CLASSES.get(usize::from(index)).map_or(f64::NAN, |class| class.code.into()),
        None => byte.into(),
    }
}

impl ClassLegend {
    /// The classification of a raster that holds these bytes, [`NO_CLASS`] apart, in cells of `cell_m` meters a side; WorldCover of
    /// one that holds none.
    ///
    /// # Errors
    /// [`UnknownClass`] with the first value that no classification has together with the others.
    pub fn of(bytes: &[u8], cell_m: f64) -> Result<Self, UnknownClass> {
        let all = [Self::WorldCover, Self::Corine, Self::CorineNumbers];
        let numbers_fit = cell_m >= LEAST_CORINE_M;
        let holds = |legend: &Self| bytes.iter().all(|byte| legend.holds(*byte));
        let fits = |legend: &&Self| **legend != Self::CorineNumbers || numbers_fit;
        let mut fitting = all.iter().filter(fits).filter(|legend| holds(legend));
        // Of tens alone the size of cells decides.
        let found = if numbers_fit { fitting.next_back() } else { fitting.next() };
        let likeliest = all
            .iter()
            .filter(fits)
            .max_by_key(|legend| bytes.iter().filter(|byte| legend.holds(**byte)).count());
        let stranger = bytes.iter().find(|byte| likeliest.is_none_or(|legend| !legend.holds(**byte)));
        found.copied().ok_or(UnknownClass(stranger.map_or(f64::NAN, |byte| value_of(*byte))))
    }

    fn holds(self, byte: u8) -> bool {
        self.class(byte).is_some() || self == Self::CorineNumbers && byte == CORINE_NODATA
    }

    /// The class of a byte; `None` where the classification has none.
    pub fn class(self, byte: u8) -> Option<&'static LandClass> {
        let corine = |index: u8| corine::CLASSES.get(usize::from(index));
        match self {
            Self::WorldCover => world_cover::CLASSES.iter().find(|class| class.code == u16::from(byte)),
            Self::Corine => byte.checked_sub(FIRST_CODE).and_then(corine),
            Self::CorineNumbers => byte.checked_sub(1).and_then(corine),
        }
    }

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::WorldCover => "ESA WorldCover",
            Self::Corine | Self::CorineNumbers => "CORINE Land Cover",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn legend(values: &[f64], cell_m: f64) -> Result<ClassLegend, UnknownClass> {
        let bytes: Result<Vec<u8>, _> =
            values.iter().map(|value| byte_of(*value).ok_or(UnknownClass(*value))).collect();
        ClassLegend::of(&bytes?.into_iter().filter(|byte| *byte != NO_CLASS).collect::<Vec<_>>(), cell_m)
    }

    #[test]
    fn values_tell_the_classification_and_of_tens_the_size_of_cells() {
        use ClassLegend::{Corine, CorineNumbers, WorldCover};
        assert_eq!(legend(&[10.0, 80.0, 95.0, 0.0, f64::NAN], 8.0), Ok(WorldCover));
        assert_eq!(legend(&[10.0, 50.0, 95.0], 100.0), Ok(WorldCover));
        assert_eq!(legend(&[111.0, 523.0, 999.0, 324.0], 100.0), Ok(Corine));
        assert_eq!(legend(&[1.0, 44.0, 48.0, 128.0, -128.0, 255.0], 100.0), Ok(CorineNumbers));
        assert_eq!(legend(&[10.0, 40.0], 9.0), Ok(WorldCover));
        assert_eq!(legend(&[10.0, 40.0], 100.0), Ok(CorineNumbers));
        assert_eq!(legend(&[], 100.0), Ok(CorineNumbers));
    }

    #[test]
    fn other_values_are_named() {
        assert_eq!(legend(&[10.0, 417.0], 9.0), Err(UnknownClass(417.0)));
        assert_eq!(legend(&[10.0, 30.0, 41.0], 9.0), Err(UnknownClass(41.0)));
        assert_eq!(legend(&[10.5], 9.0), Err(UnknownClass(10.5)));
        assert_eq!(legend(&[111.0, 112.0, 99.0], 100.0), Err(UnknownClass(99.0)));
        assert_eq!(legend(&[12.0, 13.0], 2.0), Err(UnknownClass(12.0)), "elevation in bytes");
        assert!(legend(&[f64::INFINITY], 9.0).is_err() && legend(&[-1e300], 9.0).is_err());
    }

    #[test]
    fn every_class_has_a_byte_of_its_own_and_water_no_cover() {
        for (legend, classes) in [
            (ClassLegend::Corine, &corine::CLASSES[..]),
            (ClassLegend::WorldCover, &world_cover::CLASSES[..]),
        ] {
            assert!(classes.is_sorted_by_key(|class| class.code));
            for class in classes {
                let byte = byte_of(class.code.into()).expect("a class");
                assert_eq!(legend.class(byte), Some(class));
                assert_eq!(class.cover.is_none(), matches!(class.code, 80 | 511..), "{class:?}");
            }
        }
        assert_eq!(ClassLegend::CorineNumbers.class(44).map(|class| class.code), Some(523));
    }
}
