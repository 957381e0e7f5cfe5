//! GeoTIFF keys (OGC 19-008r4) for a coordinate system, a vertical datum and the unit of heights.
//!
//! A system with an EPSG code is that code. Any other is written twice: by the parameters of its projection, where
//! there are keys for them, for other programs; and as a proj string in the citation, which [`crate::dem::tiff::geokeys`]
//! takes before the parameters, so that it comes back as the very system that it was.

use crate::dem::raster::Raster;
use crate::dem::vertical;
use crate::geom::crs::Crs;
use crate::geom::projection::{Datum, Definition, MapProjection};

const USER_DEFINED: u16 = 32767;

/// Where the doubles and the text of keys are kept: other tags of the file.
const IN_DOUBLES: u16 = 34736;
const IN_TEXT: u16 = 34737;

/// The contents of the three tags of keys; the last two may be empty.
#[derive(Clone, Debug, Default)]
pub(crate) struct KeyTags {
    /// GeoKeyDirectory.
    pub directory: Vec<u16>,
    /// GeoDoubleParams.
    pub doubles: Vec<f64>,
    /// GeoAsciiParams.
    pub text: String,
}

/// The keys of a raster.
pub(crate) fn of(raster: &Raster) -> KeyTags {
    let mut keys = Keys::default();
    keys.code(1025, 1);
    if let Some(crs) = raster.crs.as_ref().filter(|crs| !crs.proj_text().is_empty()) {
        keys.system(crs);
    }
    if let Some(words) = &raster.vertical_datum {
        match vertical::code(words) {
            Some(code) => keys.code(4096, code),
            None => {
                keys.code(4096, USER_DEFINED);
                keys.words(4097, words);
            }
        }
        if let Some(unit) = length_code(raster.meters_per_z) {
            keys.code(4099, unit);
        }
    }
    keys.tags()
}

/// EPSG's number of a unit of length.
pub(crate) fn length_code(meters: f64) -> Option<u16> {
    match meters {
        1.0 => Some(9001),
        0.3048 => Some(9002),
        feet if (feet - 1200.0 / 3937.0).abs() < 1e-12 => Some(9003),
        1000.0 => Some(9036),
        _ => None,
    }
}

/// What a key says.
enum GeoKeyValue {
    Code(u16),
    Numbers(Vec<f64>),
    Words(String),
}

#[derive(Default)]
struct Keys(Vec<(u16, GeoKeyValue)>);

impl Keys {
    fn code(&mut self, key: u16, code: u16) {
        self.0.push((key, GeoKeyValue::Code(code)));
    }

    fn number(&mut self, key: u16, number: f64) {
        self.0.push((key, GeoKeyValue::Numbers(vec![number])));
    }

    fn words(&mut self, key: u16, words: &str) {
        // The bar ends a text.
        self.0.push((key, GeoKeyValue::Words(words.replace(['|', '\0'], " "))));
    }

    fn system(&mut self, crs: &Crs) {
        let (model, type_key) = if crs.is_geographic() { (2, 2048) } else { (1, 3072) };
        self.code(1024, model);
        if let Some((code, unit)) = epsg(crs) {
            self.code(type_key, code);
            if let Some(meters) = unit {
                self.linear_unit(meters);
            }
            return;
        }
        self.words(1026, crs.proj_text());
        match crs.definition() {
            Some(definition) => self.parameters(&definition),
            None => self.code(type_key, USER_DEFINED),
        }
    }

    fn parameters(&mut self, definition: &Definition) {
        self.base(definition);
        let Some((method, [latitude, longitude, easting, northing])) = method(definition.method) else {
            return;
        };
        self.code(3072, USER_DEFINED);
        self.code(3074, USER_DEFINED);
        self.code(3075, method);
        self.linear_unit(definition.meters_per_unit);
        let polar = definition.method == MapProjection::PolarStereographic;
        let true_scale = definition.parallel_1_deg.filter(|_| polar);
        self.number(latitude, true_scale.unwrap_or(definition.latitude_deg));
        self.number(longitude, definition.longitude_deg);
        for (key, parallel) in [(3078, definition.parallel_1_deg), (3079, definition.parallel_2_deg)] {
            if let Some(parallel) = parallel.filter(|_| !polar) {
                self.number(key, parallel);
            }
        }
        self.number(3092, definition.scale);
        self.number(easting, definition.false_easting_m / definition.meters_per_unit);
        self.number(northing, definition.false_northing_m / definition.meters_per_unit);
    }

    /// The geographic system that a projection starts from.
    fn base(&mut self, definition: &Definition) {
        if let Datum::OfEpsg(code) = definition.datum
            && let Ok(code) = u16::try_from(code)
        {
            self.code(2048, code);
            return;
        }
        self.code(2048, USER_DEFINED);
        self.code(2050, USER_DEFINED);
        self.code(2054, 9102);
        self.code(2056, USER_DEFINED);
        if let Some(ellipsoid) = definition.ellipsoid {
            self.number(2057, ellipsoid.major_m);
            self.number(2059, ellipsoid.inverse_flattening);
        }
        self.number(2061, definition.prime_meridian_deg);
        if let Datum::ToWgs84(numbers) = &definition.datum {
            self.0.push((2062, GeoKeyValue::Numbers(numbers.clone())));
        }
    }

    fn linear_unit(&mut self, meters: f64) {
        match length_code(meters) {
            Some(code) => self.code(3076, code),
            None => {
                self.code(3076, USER_DEFINED);
                self.number(3077, meters);
            }
        }
    }

    fn tags(mut self) -> KeyTags {
        self.0.sort_by_key(|(key, _)| *key);
        let mut tags = KeyTags { directory: vec![1, 1, 0, self.0.len() as u16], ..KeyTags::default() };
        for (key, value) in self.0 {
            let entry = match value {
                GeoKeyValue::Code(code) => [key, 0, 1, code],
                GeoKeyValue::Numbers(numbers) => {
                    let at = tags.doubles.len() as u16;
                    tags.doubles.extend(&numbers);
                    [key, IN_DOUBLES, numbers.len() as u16, at]
                }
                GeoKeyValue::Words(words) => {
                    let at = tags.text.len() as u16;
                    tags.text += &words;
                    tags.text.push('|');
                    [key, IN_TEXT, words.len() as u16 + 1, at]
                }
            };
            tags.directory.extend(entry);
        }
        tags
    }
}

/// The code of a system, and the unit that its coordinates are in where that is not the code's own.
fn epsg(crs: &Crs) -> Option<(u16, Option<f64>)> {
    if let Some(code) = crs.epsg() {
        return Some((u16::try_from(code).ok()?, None));
    }
    let (code, unit) = crs.name().strip_prefix("EPSG:")?.split_once(" +to_meter=")?;
    Some((code.parse().ok()?, Some(unit.parse().ok()?)))
}

/// A projection's code, and its keys for latitude, longitude, easting and northing.
fn method(method: MapProjection) -> Option<(u16, [u16; 4])> {
    const NATURAL: [u16; 4] = [3081, 3080, 3082, 3083];
    Some(match method {
        MapProjection::Geographic => return None,
        MapProjection::TransverseMercator => (1, NATURAL),
        MapProjection::Mercator => (7, NATURAL),
        MapProjection::LambertConic2 => (8, [3085, 3084, 3086, 3087]),
        MapProjection::LambertConic1 => (9, NATURAL),
        MapProjection::LambertAzimuthal => (10, [3089, 3088, 3082, 3083]),
        MapProjection::Albers => (11, NATURAL),
        MapProjection::PolarStereographic => (15, [3081, 3095, 3082, 3083]),
    })
}
