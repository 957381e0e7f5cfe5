//! The vertical datums that heights can be converted to: the ellipsoid and the geoid, which differ by the geoid's
//! undulation.

use sandtable_base::message::choice::{Choice, ChoiceWord, word};

/// A datum of heights whose distance from the ellipsoid is known everywhere.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HeightDatum {
    /// The WGS 84 ellipsoid, from which satellite positioning counts.
    Ellipsoid,
    /// The EGM96 geoid, about mean sea level.
    Egm96,
}

impl Choice for HeightDatum {
    const CHOICES: &'static [ChoiceWord<Self>] = &[
        word(Self::Ellipsoid, "ellipsoid", "the WGS 84 ellipsoid"),
        word(Self::Egm96, "egm96", "the EGM96 geoid, about mean sea level"),
    ];
}

impl HeightDatum {
    /// Its name as rasters and messages have it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Ellipsoid => "WGS 84 ellipsoid",
            Self::Egm96 => "EGM96 geoid",
        }
    }

    /// The datum that a raster or a user calls `name`; `None` of others.
    pub fn from_name(name: &str) -> Option<Self> {
        let is =
            |datum: Self| name.eq_ignore_ascii_case(datum.name()) || name.eq_ignore_ascii_case(datum.word());
        [Self::Ellipsoid, Self::Egm96].into_iter().find(|&datum| is(datum))
    }

    /// The factor of the geoid's undulation that brings a height from this datum to `to`: above the ellipsoid, a height
    /// is that above the geoid and the undulation together.
    pub fn undulations_to(self, to: Self) -> f64 {
        match (self, to) {
            (Self::Egm96, Self::Ellipsoid) => 1.0,
            (Self::Ellipsoid, Self::Egm96) => -1.0,
            _ => 0.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn datums_are_known_by_name_and_by_word() {
        for &ChoiceWord { value, word, .. } in HeightDatum::CHOICES {
            assert_eq!(HeightDatum::from_name(value.name()), Some(value));
            assert_eq!(HeightDatum::from_name(&word.to_uppercase()), Some(value));
        }
        assert_eq!(HeightDatum::from_name("EGM2008 geoid"), None);
    }
}
