//! Why a text is not a position.

use crate::mgrs::GridFault;
use crate::position::POSITION_FORMS;
use crate::position::degrees::DegreeAxis;

/// A text that is not a position.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("'{text}' {fault}")]
pub struct PositionError {
    /// The text, shortened.
    text: String,
    /// What is wrong with it; begins with a verb.
    #[source]
    fault: PositionFault,
}

impl PositionError {
    pub(super) fn new(text: &str, fault: PositionFault) -> Self {
        /// The characters of a long text that a message shows.
        const SHOWN: usize = 60;
        let trimmed = text.trim();
        let mut shown: String =
            trimmed.chars().take(SHOWN).map(|c| if c.is_control() { ' ' } else { c }).collect();
        if trimmed.chars().nth(SHOWN).is_some() {
            shown.push('…');
        }
        Self { text: shown, fault }
    }

    /// The error with the forms that are accepted, or with the remedy of its own that it has.
    pub fn with_forms(&self) -> String {
        self.help().map_or_else(|| self.to_string(), |forms| format!("{self}; {forms}"))
    }

    /// The forms that are accepted, as a sentence; `None` where the error has a remedy of its own.
    pub fn help(&self) -> Option<&'static str> {
        (!matches!(self.fault, PositionFault::Ambiguous { .. })).then_some(POSITION_FORMS)
    }

    /// Whether the text is in none of the forms.
    pub fn is_unlike_any(&self) -> bool {
        self.fault == PositionFault::Form
    }

    /// What is wrong.
    pub fn fault(&self) -> &PositionFault {
        &self.fault
    }
}

/// The fault of a text that is not a position. Messages follow the text.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PositionFault {
    /// It is in none of the forms.
    #[error("is not a position")]
    Form,
    /// It is longer than any position.
    #[error("is longer than any position")]
    TooLong,
    /// It is a grid reference that names no square.
    #[error("is not a grid reference: {0}")]
    Grid(GridFault),
    /// It is a zone of the grid without a square.
    #[error(
        "is a zone of the grid, six degrees wide, or half of latitude and longitude; add the letters of the square and digits, \
         as in 16S GF 50 18, or the other half"
    )]
    ZoneAlone,
    /// It is a grid reference without its zone.
    #[error(
        "has no zone before the letters of the square, as in 16S GF 50 18; without it the square lies in many places"
    )]
    NoZone,
    /// Its zone of UTM has no letter or word.
    #[error("has no letter of a band or hemisphere after the zone, as in 16N 750000 4018000")]
    NoHemisphere,
    /// Its zone of UTM is out of range.
    #[error("names zone {0}; UTM has zones 1 to 60")]
    ZoneNumber(f64),
    /// The letter after its zone is none.
    #[error(
        "has '{0}' after the zone; bands have letters from C to X but I and O, hemispheres N and S or north and south"
    )]
    Band(String),
    /// An easting is out of range.
    #[error(
        "has an easting of {0}; in UTM it is from 100000 to 900000 m, by the poles from 800000 to 3200000 m"
    )]
    Easting(f64),
    /// A northing is out of range.
    #[error("has a northing of {0}, which lies in no such zone")]
    Northing(f64),
    /// The place lies in another band than it says.
    #[error("lies in band {found}, not in {stated}")]
    OtherBand {
        /// The letter of the text.
        stated: char,
        /// The letter of the place.
        found: char,
    },
    /// One of latitude and longitude has no letter.
    #[error("has no letter N or S at the latitude, or no E or W at the longitude")]
    NoLetter,
    /// Both angles have letters of the same axis.
    #[error("has two {0}s")]
    SameAxis(DegreeAxis),
    /// An angle has a letter of the other axis.
    #[error("is not a {0}")]
    OtherAxis(DegreeAxis),
    /// Minutes or seconds are 60 or more.
    #[error("has {0} minutes or seconds; they are less than 60")]
    Sixty(f64),
    /// Degrees or minutes have decimals, and smaller units follow.
    #[error("has decimals before minutes or seconds")]
    Decimals,
    /// An angle is out of range.
    #[error("has a {axis} of {found}°; it goes to {}°", .axis.limit_deg())]
    Range {
        /// Which of the two.
        axis: DegreeAxis,
        /// Its degrees.
        found: f64,
    },
    /// It can be read in two ways, which are two places.
    #[error("can be read as {first}, or as {second}; {remedy}")]
    Ambiguous {
        /// One reading.
        first: String,
        /// The other.
        second: String,
        /// What is to be written instead.
        remedy: String,
    },
}
