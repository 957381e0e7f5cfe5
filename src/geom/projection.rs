//! The parameters of a projected or geographic system, as WKT and GeoTIFF keys state them, and the proj
//! string that says the same.
//!
//! Only methods whose parameters map one to one are listed; a file that names another is refused by its
//! reader, with that name.

use crate::geom::crs::epsg_text;

/// A coordinate reference system by its parameters. Angles in degrees, lengths in meters.
#[derive(Clone, Debug, PartialEq)]
pub struct Definition {
    /// What the file calls it, for messages.
    pub name: String,
    /// How the ellipsoid is brought to the plane.
    pub method: MapProjection,
    /// Latitude of the origin; for [`MapProjection::PolarStereographic`] its sign says which pole.
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
    /// The figure of the Earth, where the datum is not an EPSG one.
    pub ellipsoid: Option<Ellipsoid>,
    /// How the figure lies in the Earth.
    pub datum: Datum,
    /// Longitude of the prime meridian east of Greenwich.
    pub prime_meridian_deg: f64,
    /// The length of the unit that coordinates are written in; 1 for a geographic system.
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

/// How an ellipsoid lies in the Earth.
#[derive(Clone, Debug, PartialEq)]
pub enum Datum {
    /// As that of the geographic system with this EPSG code, ellipsoid and prime meridian included.
    OfEpsg(u32),
    /// By three or seven parameters: meters, arc seconds, parts per million (position vector).
    ToWgs84(Vec<f64>),
    /// The file does not say.
    Unstated,
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

    /// The EPSG code of the same system, for the systems met most often: geographic ones on an EPSG datum,
    /// UTM on WGS 84, NAD83 and NAD27, and the British National Grid.
    pub fn epsg_twin(&self) -> Option<u32> {
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

    fn utm_code(&self, base: u32) -> Option<u32> {
        let zone = (self.longitude_deg + 183.0) / 6.0;
        if zone.fract() != 0.0 || !(1.0..=60.0).contains(&zone) {
            return None;
        }
        let north = self.is_at([0.0, self.longitude_deg, 0.9996, 5e5, 0.0]);
        let south = self.is_at([0.0, self.longitude_deg, 0.9996, 5e5, 1e7]);
        let series = match (base, north, south) {
            (4326, true, _) => 32600,
            (4326, _, true) => 32700,
            (4269, true, _) => 26900,
            (4267, true, _) => 26700,
            _ => return None,
        };
        let code = series + zone as u32;
        epsg_text(code).is_some().then_some(code)
    }

    /// Whether the parameters are latitude, longitude, scale, easting and northing to the last digit a file
    /// would keep.
    fn is_at(&self, wanted: [f64; 5]) -> bool {
        let own =
            [self.latitude_deg, self.longitude_deg, self.scale, self.false_easting_m, self.false_northing_m];
        own.iter().zip(wanted).all(|(a, b)| (a - b).abs() <= 1e-9 * b.abs().max(1.0))
    }

    /// The proj string that says the same.
    ///
    /// # Errors
    /// A phrase that names the parameter that is missing or not finite.
    pub fn proj_text(&self) -> Result<String, String> {
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

    fn projection_text(&self) -> Result<String, String> {
        let lat = finite("latitude of origin", self.latitude_deg)?;
        let lon = finite("longitude of origin", self.longitude_deg)?;
        let k = finite("scale", self.scale)?;
        let parallel = |value: Option<f64>| match value {
            Some(value) => finite("standard parallel", value),
            None => Err("a standard parallel is missing".to_owned()),
        };
        let (first, second) = (self.parallel_1_deg, self.parallel_2_deg);
        let head = match self.method {
            MapProjection::Geographic => return Ok("+proj=longlat".into()),
            MapProjection::TransverseMercator => format!("+proj=tmerc +lat_0={lat} +k={k}"),
            MapProjection::Mercator => match first {
                Some(_) => format!("+proj=merc +lat_ts={}", parallel(first)?),
                None => format!("+proj=merc +k={k}"),
            },
            MapProjection::LambertConic1 => format!("+proj=lcc +lat_1={lat} +lat_0={lat} +k_0={k}"),
            MapProjection::LambertConic2 => {
                let (first, second) = (parallel(first)?, parallel(second)?);
                format!("+proj=lcc +lat_1={first} +lat_2={second} +lat_0={lat} +k_0={k}")
            }
            MapProjection::Albers => {
                format!("+proj=aea +lat_1={} +lat_2={} +lat_0={lat}", parallel(first)?, parallel(second)?)
            }
            MapProjection::LambertAzimuthal => format!("+proj=laea +lat_0={lat}"),
            MapProjection::PolarStereographic => match first {
                Some(true_scale) => {
                    let pole = if true_scale < 0.0 { -90 } else { 90 };
                    format!("+proj=stere +lat_0={pole} +lat_ts={}", parallel(first)?)
                }
                None => format!("+proj=stere +lat_0={} +k={k}", if lat < 0.0 { -90 } else { 90 }),
            },
        };
        let east = finite("false easting", self.false_easting_m)?;
        let north = finite("false northing", self.false_northing_m)?;
        Ok(format!("{head} +lon_0={lon} +x_0={east} +y_0={north}"))
    }

    fn datum_text(&self) -> Result<String, String> {
        if let Datum::OfEpsg(code) = self.datum {
            let text = epsg_text(code).ok_or_else(|| format!("EPSG:{code} is not in the table"))?;
            let kept = text.split_whitespace().filter(|word| {
                !["+proj=", "+units=", "+no_defs", "+type="].iter().any(|prefix| word.starts_with(prefix))
            });
            return Ok(kept.map(|word| format!(" {word}")).collect());
        }
        let ellipsoid = self.ellipsoid.ok_or("no ellipsoid is stated")?;
        let mut text = ellipsoid.proj_text()?;
        if let Datum::ToWgs84(shift) = &self.datum {
            if ![3, 7].contains(&shift.len()) || shift.iter().any(|value| !value.is_finite()) {
                return Err(format!("a datum shift of {} parameters", shift.len()));
            }
            let listed: Vec<String> = shift.iter().map(f64::to_string).collect();
            text += &format!(" +towgs84={}", listed.join(","));
        }
        Ok(text)
    }
}

impl Ellipsoid {
    fn proj_text(&self) -> Result<String, String> {
        let major = finite("semi-major axis", self.major_m)?;
        let inverse = finite("inverse flattening", self.inverse_flattening)?;
        if major <= 0.0 || (inverse != 0.0 && inverse <= 1.0) {
            return Err(format!("an ellipsoid of {major} m and 1/{inverse}"));
        }
        let minor = if inverse == 0.0 { major } else { major * (1.0 - 1.0 / inverse) };
        Ok(format!(" +a={major} +b={minor}"))
    }
}

fn finite(what: &str, value: f64) -> Result<f64, String> {
    if value.is_finite() { Ok(value) } else { Err(format!("the {what} is {value}")) }
}

#[cfg(test)]
mod tests {
    use super::*;

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
    fn utm_by_its_parameters_is_known_by_its_code() {
        assert_eq!(utm(4326).epsg_twin(), Some(32612));
        assert_eq!(utm(4269).epsg_twin(), Some(26912));
        assert_eq!(Definition { longitude_deg: -111.5, ..utm(4326) }.epsg_twin(), None);
        assert_eq!(Definition { false_northing_m: 1e7, ..utm(4326) }.epsg_twin(), Some(32712));
    }

    #[test]
    fn a_parameter_that_is_not_a_number_is_named() {
        let broken = Definition { scale: f64::NAN, ..utm(4326) };
        assert_eq!(broken.proj_text(), Err("the scale is NaN".into()));
        let conic = Definition { method: MapProjection::Albers, ..utm(4326) };
        assert_eq!(conic.proj_text(), Err("a standard parallel is missing".into()));
    }
}
