//! The parameters of a projected or geographic system, as WKT and GeoTIFF keys state them, and the proj string of the
//! same system.
//!
//! Only methods whose parameters map one to one are listed; readers refuse any other by name.

use crate::crs::epsg_text;
use crate::proj_string::ProjString;

/// A coordinate reference system by its parameters. Angles in degrees, lengths in meters.
#[derive(Clone, Debug, PartialEq)]
pub struct Definition {
    /// Its name in the file, for messages.
    pub name: String,
    /// The map projection.
    pub method: MapProjection,
    /// Latitude of the origin; for [`MapProjection::PolarStereographic`] its sign selects the pole.
    pub latitude_deg: f64,
    /// Longitude of the origin, from the prime meridian.
    pub longitude_deg: f64,
    /// First standard parallel, or the latitude of true scale; not used by every method.
    pub parallel_1_deg: Option<f64>,
    /// Second standard parallel; not used by every method.
    pub parallel_2_deg: Option<f64>,
    /// Scale at the origin.
    pub scale: f64,
    /// Easting of the origin.
    pub false_easting_m: f64,
    /// Northing of the origin.
    pub false_northing_m: f64,
    /// The ellipsoid, where the datum is not an EPSG one.
    pub ellipsoid: Option<Ellipsoid>,
    /// The datum.
    pub datum: Datum,
    /// Longitude of the prime meridian east of Greenwich.
    pub prime_meridian_deg: f64,
    /// The length of the unit of coordinates; 1 for a geographic system.
    pub meters_per_unit: f64,
}

/// A map projection.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MapProjection {
    /// None: longitude and latitude in degrees.
    Geographic,
    /// Transverse Mercator.
    TransverseMercator,
    /// Mercator, with a scale at the equator or a parallel of true scale.
    Mercator,
    /// Lambert conformal conic with one standard parallel (the origin's) and a scale.
    LambertConic1,
    /// Lambert conformal conic with two standard parallels.
    LambertConic2,
    /// Albers equal-area conic.
    Albers,
    /// Lambert azimuthal equal-area.
    LambertAzimuthal,
    /// Polar stereographic, with a scale at the pole or a parallel of true scale.
    PolarStereographic,
}

/// An ellipsoid of revolution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ellipsoid {
    /// Semi-major axis in meters.
    pub major_m: f64,
    /// Inverse flattening; 0 for a sphere.
    pub inverse_flattening: f64,
}

/// The position of an ellipsoid in the Earth.
#[derive(Clone, Debug, PartialEq)]
pub enum Datum {
    /// That of the geographic system with this EPSG code, ellipsoid and prime meridian included.
    OfEpsg(u32),
    /// By three or seven parameters: meters, arc seconds, parts per million (position vector).
    ToWgs84(Vec<f64>),
    /// Not stated.
    Unstated,
}

/// Why parameters define no system.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum DefinitionError {
    /// A parameter that the method needs is not stated.
    #[error("{0} is missing")]
    Missing(&'static str),
    /// A parameter is NaN or infinite.
    #[error("the {parameter} is {value}")]
    NotFinite {
        /// Its name.
        parameter: &'static str,
        /// Its value.
        value: f64,
    },
    /// The datum's EPSG code is not in the table.
    #[error("EPSG:{0} is not in the table")]
    UnknownDatum(u32),
    /// A datum shift has neither three nor seven parameters, or one that is not finite.
    #[error("a datum shift of {0} parameters")]
    Shift(usize),
    /// The axes are not those of an ellipsoid.
    #[error("an ellipsoid of {} m and 1/{}", .0.major_m, .0.inverse_flattening)]
    Ellipsoid(Ellipsoid),
}

impl Definition {
    /// Longitude and latitude on an ellipsoid.
    pub fn geographic(name: String, ellipsoid: Option<Ellipsoid>, datum: Datum) -> Self {
        Self {
            name,
            method: MapProjection::Geographic,
            latitude_deg: 0.0,
            longitude_deg: 0.0,
            parallel_1_deg: None,
            parallel_2_deg: None,
            scale: 1.0,
            false_easting_m: 0.0,
            false_northing_m: 0.0,
            ellipsoid,
            datum,
            prime_meridian_deg: 0.0,
            meters_per_unit: 1.0,
        }
    }

    /// The parameters that a proj string states, on the geographic system `base`; `None` where its projection or one of
    /// its words has no counterpart here.
    pub(crate) fn from_proj(text: ProjString<'_>, base: Self) -> Option<Self> {
        use MapProjection::{
            Albers, LambertAzimuthal, LambertConic1, LambertConic2, Mercator, PolarStereographic,
            TransverseMercator,
        };
        if ["alpha", "gamma", "axis", "zone_width"].iter().any(|key| text.value(key).is_some()) {
            return None;
        }
        let number = |key: &str| text.number(key);
        let (first, second) = (number("lat_1"), number("lat_2"));
        let scale = number("k_0").or(number("k")).unwrap_or(1.0);
        let latitude_deg = number("lat_0").unwrap_or(0.0);
        let projected = |method, parallel_1_deg, parallel_2_deg| Self {
            method,
            latitude_deg,
            longitude_deg: number("lon_0").unwrap_or(0.0),
            parallel_1_deg,
            parallel_2_deg,
            scale,
            false_easting_m: number("x_0").unwrap_or(0.0),
            false_northing_m: number("y_0").unwrap_or(0.0),
            ..base.clone()
        };
        let has_one_parallel = second.is_none_or(|second| Some(second) == first);
        Some(match text.value("proj")? {
            "longlat" | "latlong" | "latlon" | "lonlat" => base,
            "utm" => Self {
                method: TransverseMercator,
                longitude_deg: number("zone")? * 6.0 - 183.0,
                scale: 0.9996,
                false_easting_m: 5e5,
                false_northing_m: if text.has_flag("south") { 1e7 } else { 0.0 },
                ..base
            },
            "tmerc" | "etmerc" => projected(TransverseMercator, None, None),
            "merc" => projected(Mercator, number("lat_ts"), None),
            "lcc" if has_one_parallel && first == Some(latitude_deg) => projected(LambertConic1, None, None),
            "lcc" if scale == 1.0 => projected(LambertConic2, first, second.or(first)),
            "aea" => projected(Albers, first, second.or(first)),
            "laea" => projected(LambertAzimuthal, None, None),
            "stere" if latitude_deg.abs() == 90.0 => {
                projected(PolarStereographic, number("lat_ts").filter(|at| at.abs() < 90.0), None)
            }
            _ => return None,
        })
    }

    /// The EPSG code of the same system, for the commonest systems: geographic ones on an EPSG datum, UTM on WGS 84,
    /// NAD83 and NAD27, and the British National Grid.
    pub fn epsg(&self) -> Option<u32> {
        let Datum::OfEpsg(base) = self.datum else { return None };
        match self.method {
            MapProjection::Geographic => Some(base),
            MapProjection::TransverseMercator if self.meters_per_unit == 1.0 => match base {
                4277 => self.is_at([49.0, -2.0, 0.999_601_271_7, 4e5, -1e5]).then_some(27700),
                _ => self.utm_code(base),
            },
            _ => None,
        }
    }

    /// UTM in a zone, negative in the south, on the geographic system with an EPSG code.
    pub fn utm(geographic: u32, zone: i64, meters_per_unit: f64) -> Self {
        let name = format!("UTM zone {zone} on EPSG:{geographic}");
        Self::geographic(name, None, Datum::OfEpsg(geographic)).in_utm(zone, meters_per_unit)
    }

    /// UTM in a zone, negative in the south, on this geographic system.
    pub fn in_utm(self, zone: i64, meters_per_unit: f64) -> Self {
        Self {
            method: MapProjection::TransverseMercator,
            longitude_deg: zone.unsigned_abs() as f64 * 6.0 - 183.0,
            scale: 0.9996,
            false_easting_m: 5e5,
            false_northing_m: if zone < 0 { 1e7 } else { 0.0 },
            meters_per_unit,
            ..self
        }
    }

    fn utm_code(&self, base: u32) -> Option<u32> {
        let zone = (self.longitude_deg + 183.0) / 6.0;
        if zone.fract() != 0.0 || !(1.0..=60.0).contains(&zone) {
            return None;
        }
        let zone = zone as i64;
        if self.is_at([0.0, self.longitude_deg, 0.9996, 5e5, 0.0]) {
            return utm_code(base, zone);
        }
        let is_south = self.is_at([0.0, self.longitude_deg, 0.9996, 5e5, 1e7]);
        is_south.then(|| utm_code(base, -zone)).flatten()
    }

    /// Whether latitude, longitude, scale, easting and northing are `wanted`, to the last digit that files keep.
    fn is_at(&self, wanted: [f64; 5]) -> bool {
        let own =
            [self.latitude_deg, self.longitude_deg, self.scale, self.false_easting_m, self.false_northing_m];
        own.iter().zip(wanted).all(|(a, b)| (a - b).abs() <= 1e-9 * b.abs().max(1.0))
    }

    /// The proj string of the same system.
    ///
    /// # Errors
    /// [`DefinitionError`] for a parameter that is missing or out of range.
    pub fn proj_text(&self) -> Result<String, DefinitionError> {
        let mut text = self.projection_text()?;
        text += &self.datum_text()?;
        if self.prime_meridian_deg != 0.0 && !matches!(self.datum, Datum::OfEpsg(_)) {
            text += &format!(" +pm={}", finite("prime meridian", self.prime_meridian_deg)?);
        }
        if self.method != MapProjection::Geographic {
            text += &format!(" +to_meter={}", finite("unit", self.meters_per_unit)?);
        }
        Ok(text)
    }

    fn projection_text(&self) -> Result<String, DefinitionError> {
        let lat = finite("latitude of origin", self.latitude_deg)?;
        let lon = finite("longitude of origin", self.longitude_deg)?;
        let k = finite("scale", self.scale)?;
        let parallel = |value: Option<f64>| {
            value
                .ok_or(DefinitionError::Missing("a standard parallel"))
                .and_then(|value| finite("standard parallel", value))
        };
        let (first, second) = (self.parallel_1_deg, self.parallel_2_deg);
        let pole = |latitude: f64| if latitude < 0.0 { -90 } else { 90 };
        let head = match (self.method, first) {
            (MapProjection::Geographic, _) => return Ok("+proj=longlat".into()),
            (MapProjection::TransverseMercator, _) => format!("+proj=tmerc +lat_0={lat} +k={k}"),
            (MapProjection::Mercator, Some(_)) => format!("+proj=merc +lat_ts={}", parallel(first)?),
            (MapProjection::Mercator, None) => format!("+proj=merc +k={k}"),
            (MapProjection::LambertConic1, _) => format!("+proj=lcc +lat_1={lat} +lat_0={lat} +k_0={k}"),
            (MapProjection::LambertConic2, _) => {
                let (first, second) = (parallel(first)?, parallel(second)?);
                format!("+proj=lcc +lat_1={first} +lat_2={second} +lat_0={lat} +k_0={k}")
            }
            (MapProjection::Albers, _) => {
                format!("+proj=aea +lat_1={} +lat_2={} +lat_0={lat}", parallel(first)?, parallel(second)?)
            }
            (MapProjection::LambertAzimuthal, _) => format!("+proj=laea +lat_0={lat}"),
            (MapProjection::PolarStereographic, Some(true_scale)) => {
                format!("+proj=stere +lat_0={} +lat_ts={}", pole(true_scale), parallel(first)?)
            }
            (MapProjection::PolarStereographic, None) => format!("+proj=stere +lat_0={} +k={k}", pole(lat)),
        };
        let east = finite("false easting", self.false_easting_m)?;
        let north = finite("false northing", self.false_northing_m)?;
        Ok(format!("{head} +lon_0={lon} +x_0={east} +y_0={north}"))
    }

    fn datum_text(&self) -> Result<String, DefinitionError> {
        if let Datum::OfEpsg(code) = self.datum {
            let text = epsg_text(code).ok_or(DefinitionError::UnknownDatum(code))?;
            return Ok(format!(" {}", text.without(&["proj", "units", "no_defs", "type"])));
        }
        let ellipsoid = self.ellipsoid.ok_or(DefinitionError::Missing("the ellipsoid"))?;
        let mut text = ellipsoid.proj_text()?;
        if let Datum::ToWgs84(shift) = &self.datum {
            if ![3, 7].contains(&shift.len()) || shift.iter().any(|value| !value.is_finite()) {
                return Err(DefinitionError::Shift(shift.len()));
            }
            let listed: Vec<String> = shift.iter().map(f64::to_string).collect();
            text += &format!(" +towgs84={}", listed.join(","));
        }
        Ok(text)
    }
}

/// A series of EPSG codes of UTM zones.
struct UtmSeries {
    geographic: u32,
    is_south: bool,
    /// The code before that of zone 1, which need not be in the series.
    base: u32,
    first: u32,
    last: u32,
}

const fn utm_series(geographic: u32, is_south: bool, base: u32, [first, last]: [u32; 2]) -> UtmSeries {
    UtmSeries { geographic, is_south, base, first, last }
}

/// Codes behind the last zone of a series are other systems: those behind NAD27's and NAD83's are state plane zones.
const UTM_SERIES: [UtmSeries; 9] = [
    utm_series(4326, false, 32600, [1, 60]),
    utm_series(4326, true, 32700, [1, 60]),
    utm_series(4322, false, 32200, [1, 60]),
    utm_series(4322, true, 32300, [1, 60]),
    utm_series(4269, false, 26900, [1, 23]),
    utm_series(4269, false, 3313, [59, 60]),
    utm_series(4267, false, 26700, [1, 22]),
    utm_series(4267, false, 3311, [59, 60]),
    utm_series(4258, false, 25800, [28, 38]),
];

/// EPSG's code of a UTM zone, negative in the south, on a geographic system; `None` where EPSG has none.
///
/// ```
/// use sandtable_geom::projection::utm_code;
/// assert_eq!(utm_code(4267, 10), Some(26710));
/// assert_eq!(utm_code(4267, 48), None, "EPSG:26748 is a state plane zone of Arizona");
/// ```
pub fn utm_code(geographic: u32, zone: i64) -> Option<u32> {
    let number = u32::try_from(zone.unsigned_abs()).ok()?;
    let is_of = |series: &&UtmSeries| {
        series.geographic == geographic
            && series.is_south == (zone < 0)
            && (series.first..=series.last).contains(&number)
    };
    UTM_SERIES.iter().find(is_of).map(|series| series.base + number)
}

impl Ellipsoid {
    fn proj_text(self) -> Result<String, DefinitionError> {
        let major = finite("semi-major axis", self.major_m)?;
        let inverse = finite("inverse flattening", self.inverse_flattening)?;
        if major <= 0.0 || (inverse != 0.0 && inverse <= 1.0) {
            return Err(DefinitionError::Ellipsoid(self));
        }
        let minor = if inverse == 0.0 { major } else { major * (1.0 - 1.0 / inverse) };
        Ok(format!(" +a={major} +b={minor}"))
    }
}

impl Datum {
    /// By the names of EPSG's datums, or by a stated shift.
    pub(crate) fn from_proj(text: ProjString<'_>) -> Self {
        if let Some(shift) = text.value("towgs84") {
            return Self::ToWgs84(shift.split(',').filter_map(|word| word.trim().parse().ok()).collect());
        }
        match text.value("datum").map(str::to_ascii_lowercase).as_deref() {
            Some("wgs84") => Self::OfEpsg(4326),
            Some("nad83") => Self::OfEpsg(4269),
            Some("nad27") => Self::OfEpsg(4267),
            Some("osgb36") => Self::OfEpsg(4277),
            _ => Self::Unstated,
        }
    }
}

fn finite(parameter: &'static str, value: f64) -> Result<f64, DefinitionError> {
    if value.is_finite() { Ok(value) } else { Err(DefinitionError::NotFinite { parameter, value }) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::crs::Crs;
    use glam::DVec2;

    fn utm(base: u32) -> Definition {
        Definition {
            method: MapProjection::TransverseMercator,
            longitude_deg: -111.0,
            scale: 0.9996,
            false_easting_m: 5e5,
            ..Definition::geographic("test".into(), None, Datum::OfEpsg(base))
        }
    }

    #[test]
    fn utm_by_its_parameters_has_its_epsg_code() {
        assert_eq!(utm(4326).epsg(), Some(32612));
        assert_eq!(utm(4269).epsg(), Some(26912));
        assert_eq!(Definition { longitude_deg: -111.5, ..utm(4326) }.epsg(), None);
        assert_eq!(Definition { false_northing_m: 1e7, ..utm(4326) }.epsg(), Some(32712));
    }

    #[test]
    fn every_code_of_a_utm_zone_is_that_zone_and_others_have_none() {
        for geographic in [4326, 4322, 4269, 4267, 4258, 4277] {
            for zone in (-60..=60).filter(|zone| *zone != 0) {
                let code = utm_code(geographic, zone);
                assert_eq!(Definition::utm(geographic, zone, 1.0).epsg(), code, "{geographic} {zone}");
                let Some(code) = code else { continue };
                let text = epsg_text(code).expect("in the table");
                assert_eq!(text.value("proj"), Some("utm"), "EPSG:{code}");
                assert_eq!(text.number("zone"), Some(zone.abs() as f64), "EPSG:{code}");
                assert_eq!(text.has_flag("south"), zone < 0, "EPSG:{code}");
                let datum = |text: ProjString<'_>| text.only(&["datum", "ellps", "towgs84"]);
                let own = epsg_text(geographic).expect("in the table");
                assert_eq!(datum(text), datum(own), "EPSG:{code}");
            }
            assert_eq!((utm_code(geographic, 0), utm_code(geographic, 61)), (None, None));
        }
        let found: Vec<Option<u32>> =
            [(4267, 23), (4267, 48), (4267, 60), (4269, 59), (4267, -10), (4258, 27)]
                .map(|(geographic, zone)| utm_code(geographic, zone))
                .to_vec();
        assert_eq!(found, [None, None, Some(3371), Some(3372), None, None]);
    }

    #[test]
    fn a_parameter_that_is_not_a_number_is_named() {
        let text = |definition: &Definition| definition.proj_text().map_err(|error| error.to_string());
        let broken = Definition { scale: f64::NAN, ..utm(4326) };
        assert_eq!(text(&broken), Err("the scale is NaN".to_owned()));
        let conic = Definition { method: MapProjection::Albers, ..utm(4326) };
        assert_eq!(text(&conic), Err("a standard parallel is missing".to_owned()));
    }

    #[test]
    fn a_definition_transforms_as_the_proj_string_that_it_came_from() {
        // UTM, a conic in feet, Albers, azimuthal, Mercator, both poles, a national grid by seven parameters.
        for code in [32612, 32733, 2225, 5070, 3035, 3395, 3031, 3413, 27700, 31370, 2154, 4326] {
            let crs = Crs::from_epsg(code).expect("known");
            let definition = crs.definition().expect("a common projection");
            let again = Crs::parse(&definition.proj_text().expect("complete")).expect("readable");
            let wgs84 = Crs::wgs84();
            let (x, y) = match code {
                3031 => (1e6, -1e6),
                3413 => (-5e5, -5e5),
                4326 => (12.0, 47.0),
                2225 => (6e6, 2e6),
                _ => (4e5, 3e5),
            };
            let at = DVec2::new(x, y);
            let (one, other) =
                (crs.transform(&wgs84, at).expect("inside"), again.transform(&wgs84, at).expect("inside"));
            assert!(one.distance(other) < 1e-9, "EPSG:{code}: {one} and {other}, {}", again.name());
        }
    }
}
