//! The units of a LandXML file: `Metric` or `Imperial`, with a linear unit and, of metric ones, one of elevations.

use crate::xml::XmlElement;

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
        let linear_m = meters(&stated.attribute("linearUnit").unwrap_or(default.into()))?;
        let elevation_m = match stated.attribute("elevationUnit") {
            // Written beside survey feet by programs that mean these.
            Some(unit) if is_foot(&unit) && is_imperial => linear_m,
            Some(unit) => meters(&unit)?,
            None => linear_m,
        };
        Some(Self { linear_m, elevation_m, is_imperial })
    }
}

fn is_foot(unit: &str) -> bool {
    matches!(unit, "foot" | "feet")
}

/// Meters per unit, by the names of the schema.
fn meters(unit: &str) -> Option<f64> {
    Some(match unit {
        "millimeter" => 0.001,
        "centimeter" => 0.01,
        "meter" => 1.0,
        "kilometer" => 1000.0,
        "inch" => 0.0254,
        "foot" | "feet" => 0.3048,
        "USSurveyFoot" => 1200.0 / 3937.0,
        "mile" | "miles" => 1609.344,
        _ => return None,
    })
}
