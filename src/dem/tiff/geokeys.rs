//! Reading GeoTIFF keys (OGC 19-008r4): the coordinate system, the vertical unit, and whether samples are
//! points or areas.

use crate::tiff::geokey_codes as key;
use sandtable_geom::crs::Crs;
use sandtable_geom::length_unit::{FOOT_M, US_SURVEY_FOOT_M, length_of_code};
use sandtable_geom::projection::{Datum, Definition, Ellipsoid, MapProjection};
use sandtable_raster::error::DemErrorKind;
use sandtable_raster::vertical;

/// EPSG's vertical systems in US survey feet: NGVD29, NAVD88, mean sea level.
const IN_US_SURVEY_FEET: [u16; 3] = [5702, 6360, 8052];
/// Those in feet: NAVD88, mean sea level, and of the Cayman Islands.
const IN_FEET: [u16; 5] = [8228, 8050, 6130, 6131, 6132];
/// The vertical datums and ellipsoids of GeoTIFF 1.0.
const DATUMS: std::ops::RangeInclusive<u16> = 5001..=5106;

/// The value of a key.
#[derive(Clone, Debug)]
pub(super) enum GeoKeyValue {
    Code(u16),
    Numbers(Vec<f64>),
    Text(String),
}

#[derive(Clone, Debug)]
pub(crate) struct GeoKeys(Vec<(u16, GeoKeyValue)>);

impl GeoKeys {
    /// Keys from a directory and the doubles and the text it points into; keys that point outside are left out.
    pub fn new(directory: &[u16], doubles: &[f64], text: &str) -> Self {
        let entries = directory.get(4..).unwrap_or_default().chunks_exact(4);
        let entries = entries.take(directory.get(3).copied().unwrap_or(0).into());
        let value = |entry: &[u16]| {
            let (place, at) = (entry[1], usize::from(entry[3]));
            let range = at..at + usize::from(entry[2]);
            match place {
                0 => Some(GeoKeyValue::Code(entry[3])),
                key::IN_DOUBLES => doubles.get(range).map(|numbers| GeoKeyValue::Numbers(numbers.to_vec())),
                key::IN_TEXT => {
                    let trimmed = text.get(range)?.trim_end_matches(['|', '\0', ' ']);
                    Some(GeoKeyValue::Text(trimmed.to_owned()))
                }
                _ => None,
            }
        };
        Self(entries.filter_map(|entry| Some((entry[0], value(entry)?))).collect())
    }

    /// Whether stated positions are those of samples' centers.
    pub fn is_point(&self) -> bool {
        self.code(key::RASTER_TYPE) == Some(2)
    }

    /// Meters in the unit of the elevations; `None` where not stated.
    pub fn meters_per_z(&self) -> Result<Option<f64>, DemErrorKind> {
        match (self.real_code(key::VERTICAL_UNITS), self.code(key::VERTICAL_TYPE)) {
            (Some(unit), _) => length(unit).map(Some),
            (_, Some(system)) if IN_US_SURVEY_FEET.contains(&system) => Ok(Some(US_SURVEY_FOOT_M)),
            (_, Some(system)) if IN_FEET.contains(&system) => Ok(Some(FOOT_M)),
            _ => Ok(None),
        }
    }

    /// Whether the elevations are those of a vertical system in meters: EPSG's others are; the numbers of GeoTIFF 1.0 are of
    /// datums alone.
    pub fn names_system_in_meters(&self) -> bool {
        let is_in_meters = |code: u16| {
            ![&IN_US_SURVEY_FEET[..], &IN_FEET].concat().contains(&code) && !DATUMS.contains(&code)
        };
        self.real_code(key::VERTICAL_TYPE).is_some_and(is_in_meters)
    }

    /// The vertical datum by the code of the system or of the datum, else by the citation; `None` where not stated.
    pub fn vertical_datum(&self) -> Option<String> {
        let cited = || self.text(key::VERTICAL_CITATION).filter(|words| !words.is_empty()).map(str::to_owned);
        let code = self.real_code(key::VERTICAL_TYPE).or_else(|| self.real_code(key::VERTICAL_DATUM));
        code.map(vertical::name).or_else(cited)
    }

    /// The coordinate system; `None` where the keys state none.
    pub fn crs(&self) -> Result<Option<Crs>, DemErrorKind> {
        let projected = self.code(key::PROJECTED_TYPE).is_some() || self.code(key::TRANSFORMATION).is_some();
        match self.code(key::MODEL_TYPE) {
            Some(1) => self.projected().map(Some),
            Some(2) => self.geographic().map(Some),
            None | Some(0 | key::USER_DEFINED) if projected => self.projected().map(Some),
            None | Some(0 | key::USER_DEFINED) if self.code(key::GEOGRAPHIC_TYPE).is_some() => {
                self.geographic().map(Some)
            }
            None | Some(0 | key::USER_DEFINED) => Ok(None),
            Some(3) => Err(unusable("geocentric coordinates do not lie on a map")),
            Some(other) => Err(unusable(&format!("model type {other} does not exist"))),
        }
    }

    /// The system whose proj string is the citation: this program writes systems without a code so.
    fn cited(&self) -> Option<Crs> {
        Crs::parse(self.text(key::CITATION).filter(|words| words.starts_with("+proj="))?).ok()
    }

    fn geographic(&self) -> Result<Crs, DemErrorKind> {
        self.check_degrees()?;
        Ok(match (self.real_code(key::GEOGRAPHIC_TYPE), self.cited()) {
            (Some(code), _) => Crs::from_epsg(code.into())?,
            (None, Some(crs)) => crs,
            (None, None) => Crs::from_definition(&self.base())?,
        })
    }

    fn projected(&self) -> Result<Crs, DemErrorKind> {
        let unit = self.linear_unit()?;
        if let Some(code) = self.real_code(key::PROJECTED_TYPE) {
            return Ok(match unit {
                Some(meters) => Crs::from_epsg_in(code.into(), meters)?,
                None => Crs::from_epsg(code.into())?,
            });
        }
        if let Some(crs) = self.cited() {
            return Ok(crs);
        }
        self.check_degrees()?;
        let definition = match self.code(key::PROJECTION) {
            Some(code @ (16001..=16060 | 16101..=16160)) => self.utm(code, unit.unwrap_or(1.0)),
            _ => self.by_parameters(unit.unwrap_or(1.0))?,
        };
        Ok(Crs::from_definition(&definition)?)
    }

    /// EPSG's conversions 16001 to 16060 are the UTM zones north, 16101 to 16160 those south.
    fn utm(&self, code: u16, meters_per_unit: f64) -> Definition {
        let zone = i64::from(code % 100);
        self.base().in_utm(if code > 16100 { -zone } else { zone }, meters_per_unit)
    }

    fn by_parameters(&self, meters_per_unit: f64) -> Result<Definition, DemErrorKind> {
        let code = self.code(key::TRANSFORMATION);
        let code = code.ok_or_else(|| unusable("it is user-defined without a coordinate transformation"))?;
        let method = key::PROJECTIONS.iter().find(|keys| keys.code == code).map(|keys| keys.method);
        let method =
            method.ok_or_else(|| unusable(&format!("coordinate transformation {code} is not read")))?;
        let at = |keys: &[u16]| keys.iter().find_map(|&key| self.number(key));
        let latitude = at(&key::LATITUDES);
        let is_polar = method == MapProjection::PolarStereographic;
        Ok(Definition {
            method,
            latitude_deg: latitude.unwrap_or(0.0),
            longitude_deg: at(&key::LONGITUDES).unwrap_or(0.0),
            // A pole's "origin" away from the pole is its parallel of true scale.
            parallel_1_deg: self
                .number(key::PARALLEL_1)
                .or(latitude.filter(|lat| is_polar && lat.abs() < 90.0)),
            parallel_2_deg: self.number(key::PARALLEL_2),
            scale: at(&key::SCALES).unwrap_or(1.0),
            false_easting_m: at(&key::EASTINGS).unwrap_or(0.0) * meters_per_unit,
            false_northing_m: at(&key::NORTHINGS).unwrap_or(0.0) * meters_per_unit,
            meters_per_unit,
            ..self.base()
        })
    }

    /// The ellipsoid and its datum.
    fn base(&self) -> Definition {
        let by_datum = self.real_code(key::GEODETIC_DATUM).and_then(|code| code.checked_sub(2000));
        let major = self.number(key::SEMI_MAJOR);
        let inverse = self.number(key::INVERSE_FLATTENING).or_else(|| {
            let (major, minor) = (major?, self.number(key::SEMI_MINOR)?);
            Some(if major == minor { 0.0 } else { major / (major - minor) })
        });
        let ellipsoid =
            major.zip(inverse).map(|(major_m, inverse_flattening)| Ellipsoid { major_m, inverse_flattening });
        let datum = match (self.real_code(key::GEOGRAPHIC_TYPE).or(by_datum), self.numbers(key::TO_WGS84)) {
            (Some(code), _) => Datum::OfEpsg(code.into()),
            (None, Some(shift)) => Datum::ToWgs84(shift.to_vec()),
            (None, None) => Datum::Unstated,
        };
        let prime_meridian_deg = self.number(key::PRIME_MERIDIAN).unwrap_or(0.0);
        Definition {
            prime_meridian_deg,
            ..Definition::geographic("a user-defined system".into(), ellipsoid, datum)
        }
    }

    fn check_degrees(&self) -> Result<(), DemErrorKind> {
        let is_degree = |size: f64| (size - 1f64.to_radians()).abs() < 1e-9;
        match self.code(key::ANGULAR_UNITS) {
            None | Some(0 | 9102) => Ok(()),
            Some(key::USER_DEFINED) if self.number(key::ANGULAR_UNIT_SIZE).is_some_and(is_degree) => Ok(()),
            Some(other) => Err(unusable(&format!("angular unit {other} is not the degree"))),
        }
    }

    fn linear_unit(&self) -> Result<Option<f64>, DemErrorKind> {
        match self.code(key::LINEAR_UNITS) {
            None | Some(0) => Ok(None),
            Some(key::USER_DEFINED) => Ok(self.number(key::LINEAR_UNIT_SIZE)),
            Some(code) => length(code).map(Some),
        }
    }

    /// The code of a key that is neither 0 nor "user-defined".
    fn real_code(&self, key: u16) -> Option<u16> {
        self.code(key).filter(|&code| code != key::USER_DEFINED && code != 0)
    }

    fn code(&self, key: u16) -> Option<u16> {
        self.values(key)
            .find_map(|value| if let GeoKeyValue::Code(code) = value { Some(*code) } else { None })
    }

    fn text(&self, key: u16) -> Option<&str> {
        self.values(key)
            .find_map(|value| if let GeoKeyValue::Text(text) = value { Some(&text[..]) } else { None })
    }

    fn numbers(&self, key: u16) -> Option<&[f64]> {
        self.values(key)
            .find_map(|value| if let GeoKeyValue::Numbers(all) = value { Some(&all[..]) } else { None })
    }

    fn number(&self, key: u16) -> Option<f64> {
        self.numbers(key)?.first().copied()
    }

    fn values(&self, key: u16) -> impl Iterator<Item = &GeoKeyValue> {
        self.0.iter().filter(move |(known, _)| *known == key).map(|(_, value)| value)
    }
}

/// Meters in EPSG's unit of length.
fn length(code: u16) -> Result<f64, DemErrorKind> {
    length_of_code(code).ok_or_else(|| unusable(&format!("unit of length {code} is not read")))
}

fn unusable(reason: &str) -> DemErrorKind {
    DemErrorKind::Georeference {
        reason: reason.into(),
        remedy: "state the right system as crs under [terrain]",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn keys(entries: &[[u16; 4]], doubles: &[f64]) -> GeoKeys {
        let mut directory = vec![1, 1, 0, entries.len() as u16];
        directory.extend(entries.iter().flatten());
        GeoKeys::new(&directory, doubles, "")
    }

    #[test]
    fn a_code_is_taken_and_its_unit_replaced() {
        let crs = keys(&[[1024, 0, 1, 1], [3072, 0, 1, 2853], [3076, 0, 1, 9003]], &[]).crs();
        assert_eq!(crs.expect("known").expect("stated").meters_per_unit(), US_SURVEY_FOOT_M);
        let crs = keys(&[[1024, 0, 1, 2], [2048, 0, 1, 4326]], &[]).crs();
        assert_eq!(crs.expect("known").expect("stated").epsg(), Some(4326));
        assert_eq!(keys(&[], &[]).crs().expect("nothing stated"), None);
    }

    #[test]
    fn parameters_of_a_conic_become_a_proj_string() {
        let entries = [
            [1024, 0, 1, 1],
            [2048, 0, 1, 4269],
            [3072, 0, 1, 32767],
            [3075, 0, 1, 8],
            [3076, 0, 1, 9001],
            [3078, 34736, 1, 2],
            [3079, 34736, 1, 3],
            [3084, 34736, 1, 1],
            [3085, 34736, 1, 0],
            [3086, 34736, 1, 4],
        ];
        let crs =
            keys(&entries, &[33.75, -79.0, 36.5, 34.25, 609_601.22]).crs().expect("read").expect("stated");
        assert_eq!(
            crs.name(),
            "+proj=lcc +lat_1=36.5 +lat_2=34.25 +lat_0=33.75 +k_0=1 +lon_0=-79 +x_0=609601.22 +y_0=0 +datum=NAD83 +to_meter=1"
        );
    }

    #[test]
    fn methods_and_units_that_are_not_read_are_refused_by_number() {
        let refused = keys(&[[1024, 0, 1, 1], [3072, 0, 1, 32767], [3075, 0, 1, 24]], &[]).crs();
        assert!(refused.expect_err("no such").to_string().contains("24"));
        assert!(keys(&[[4099, 0, 1, 9001]], &[]).meters_per_z().is_ok_and(|unit| unit == Some(1.0)));
        assert!(keys(&[[4099, 0, 1, 9099]], &[]).meters_per_z().is_err());
        assert!(keys(&[[3086, 34736, 9, 65535]], &[1.0]).crs().is_ok_and(|crs| crs.is_none()));
    }

    #[test]
    fn the_unit_of_elevations_comes_from_its_key_else_from_the_vertical_system() {
        let unit = |entries: &[[u16; 4]]| keys(entries, &[]).meters_per_z().expect("known");
        let system = |code: u16| unit(&[[4096, 0, 1, code]]);
        assert_eq!([6360, 5702].map(system), [Some(US_SURVEY_FOOT_M); 2]);
        assert_eq!([8228, 8050].map(system), [Some(FOOT_M); 2]);
        assert_eq!([5703, 5103, 5030, 32767, 0].map(system), [None; 5]);
        let in_meters = |code: u16| keys(&[[4096, 0, 1, code]], &[]).names_system_in_meters();
        assert!([5703, 3855].into_iter().all(in_meters));
        assert!(![6360, 5702, 8228, 5103, 5030, 32767, 0].into_iter().any(in_meters));
        assert_eq!(unit(&[[4096, 0, 1, 5702], [4099, 0, 1, 9001]]), Some(1.0));
    }

    #[test]
    fn the_vertical_datum_comes_from_a_code_or_from_the_citation() {
        let datum = |entries: &[[u16; 4]]| {
            let mut directory = vec![1, 1, 0, entries.len() as u16];
            directory.extend(entries.iter().flatten());
            GeoKeys::new(&directory, &[], "old name|the harbour's gauge|").vertical_datum()
        };
        assert_eq!(datum(&[[4096, 0, 1, 5703]]).as_deref(), Some("NAVD88"));
        assert_eq!(datum(&[[4098, 0, 1, 5103]]).as_deref(), Some("NAVD88"));
        assert_eq!(
            datum(&[[4096, 0, 1, 32767], [4097, 34737, 20, 9]]).as_deref(),
            Some("the harbour's gauge")
        );
        assert_eq!(datum(&[[4097, 34737, 99, 9]]), None);
    }
}
