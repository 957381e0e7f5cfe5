//! The units of a LandXML file: `Metric` or `Imperial`, with a linear unit and, of metric ones, one of elevations.

use crate::xml::XmlElement;
use sandtable_geom::length_unit::length_of_land_xml;

/// What the numbers of a file are in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct LandUnits {
    /// Meters per unit of northings, eastings, lengths and stations.
    pub linear_m: f64,
    /// Meters per unit of elevations.
    pub elevation_m: f64,
    /// Whether stations are written in hundreds of feet, `12+34`, and not in kilometers, `1+234`.
    pub is_imperial: bool,
}

impl Default for LandUnits {
    fn default() -> Self {
        Self { linear_m: 1.0, elevation_m: 1.0, is_imperial: false }
    }
}

impl LandUnits {
    /// The units of the element `Units`, with its content; `None` where a unit is unknown.
    pub fn of(units: &XmlElement<'_>) -> Option<Self> {
        let Some(stated) = units.children().next() else { return Some(Self::default()) };
        let is_imperial = stated.name() == "Imperial";
        let default = if is_imperial { "foot" } else { "meter" };
        let linear_m = length_of_land_xml(&stated.attribute("linearUnit").unwrap_or(default.into()))?;
        let elevation_m = match stated.attribute("elevationUnit") {
            // Written beside survey feet by programs that mean these.
            Some(unit) if is_foot(&unit) && is_imperial => linear_m,
            Some(unit) => length_of_land_xml(&unit)?,
            None => linear_m,
        };
        Some(Self { linear_m, elevation_m, is_imperial })
    }
}

fn is_foot(unit: &str) -> bool {
    matches!(unit, "foot" | "feet")
}
