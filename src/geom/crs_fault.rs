//! The faults of a coordinate reference system or of a coordinate in it.

use std::sync::Arc;

use crate::projection::DefinitionError;
use crate::wkt::WktError;

/// The fault of a system or a coordinate.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CrsFault {
    /// The EPSG code is unknown.
    #[error("no such code in the EPSG table")]
    NoSuchCode,
    /// The zone is not one of UTM.
    #[error("the zones of UTM are 1 to 60")]
    NoSuchZone,
    /// The EPSG code is not a number.
    #[error("the code is not a number")]
    CodeNotANumber,
    /// Something other than a unit follows the EPSG code.
    #[error("only +to_meter=number may follow the code")]
    AfterCode,
    /// The unit is not a positive length.
    #[error("the unit is not a positive length")]
    Unit,
    /// The text is too long to be a system.
    #[error("longer than any description of a system")]
    TooLong,
    /// The text is in none of the notations.
    #[error("no authority, no +proj and no WKT in it")]
    Notation,
    /// A proj string has a character beyond ASCII.
    #[error("a proj string is plain ASCII")]
    NotAscii,
    /// The system is geocentric.
    #[error("geocentric coordinates are not horizontal ones")]
    Geocentric,
    /// The system's unit or ellipsoid is not a positive length.
    #[error("its unit or its ellipsoid is not a positive length")]
    NotALength,
    /// A transform's result is not finite.
    #[error("the result is not finite")]
    NotFinite,
    /// The data state no system.
    #[error("the data state no coordinate system, so that positions in them are two numbers")]
    NoSystem,
    /// A transform's result is no longitude and latitude.
    #[error("there is no such place on Earth")]
    NoPlaceOnEarth,
    /// The projection library refuses it.
    #[error(transparent)]
    Proj(#[from] ProjError),
    /// The parameters define no system.
    #[error(transparent)]
    Definition(#[from] DefinitionError),
    /// The WKT is not read.
    #[error(transparent)]
    Wkt(#[from] WktError),
}

/// An error of the projection library; equal to one with the same message.
#[derive(Clone, Debug, thiserror::Error)]
#[error(transparent)]
pub struct ProjError(Arc<proj4rs::errors::Error>);

impl PartialEq for ProjError {
    fn eq(&self, other: &Self) -> bool {
        self.to_string() == other.to_string()
    }
}

impl From<proj4rs::errors::Error> for CrsFault {
    fn from(error: proj4rs::errors::Error) -> Self {
        Self::Proj(ProjError(Arc::new(error)))
    }
}
