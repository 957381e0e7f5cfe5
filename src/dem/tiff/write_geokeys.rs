//! Writing GeoTIFF keys (OGC 19-008r4) for a coordinate system, a vertical datum and the unit of heights.
//!
//! A system with an EPSG code is that code. Any other is written twice: by the parameters of its projection, where
//! there are keys for them, for other programs; and as a proj string in the citation, which [`super::geokeys`] prefers,
//! so that the very same system comes back.

use crate::tiff::geokey_codes as key;
use crate::tiff::geokeys::GeoKeyValue;
use sandtable_geom::crs::Crs;
use sandtable_geom::length_unit::code_of_length;
use sandtable_geom::projection::{Datum, Definition, MapProjection};
use sandtable_raster::georef::crs_on_earth;
use sandtable_raster::raster::Raster;
use sandtable_raster::unstated_unit;
use sandtable_raster::vertical;

/// The contents of the three tags of keys; the last two may be empty.
#[derive(Clone, Debug, Default)]
pub(crate) struct GeoKeyTags {
    /// GeoKeyDirectory.
    pub directory: Vec<u16>,
    /// GeoDoubleParams.
    pub doubles: Vec<f64>,
    /// GeoAsciiParams.
    pub text: String,
}

impl GeoKeyTags {
    pub fn new(raster: &Raster) -> Self {
        let mut keys = GeoKeyList::default();
        keys.code(key::RASTER_TYPE, 1);
        if let Some(crs) = crs_on_earth(raster) {
            keys.system(crs);
        }
        if let Some(name) = &raster.vertical_datum {
            match vertical::code(name) {
                Some(code) => keys.code(key::VERTICAL_TYPE, code),
                None => {
                    keys.code(key::VERTICAL_TYPE, key::USER_DEFINED);
                    keys.text(key::VERTICAL_CITATION, name);
                }
            }
            // What is taken for meters because nothing states its unit does not become a statement.
            let unit = code_of_length(raster.meters_per_z).filter(|_| unstated_unit::note(raster).is_none());
            if let Some(unit) = unit {
                keys.code(key::VERTICAL_UNITS, unit);
            }
        }
        keys.into_tags()
    }
}

#[derive(Default)]
struct GeoKeyList(Vec<(u16, GeoKeyValue)>);

impl GeoKeyList {
    fn code(&mut self, key: u16, code: u16) {
        self.0.push((key, GeoKeyValue::Code(code)));
    }

    fn number(&mut self, key: u16, number: f64) {
        self.0.push((key, GeoKeyValue::Numbers(vec![number])));
    }

    fn text(&mut self, key: u16, text: &str) {
        // The bar ends a text.
        self.0.push((key, GeoKeyValue::Text(text.replace(['|', '\0'], " "))));
    }

    fn system(&mut self, crs: &Crs) {
        let (model, type_key) =
            if crs.is_geographic() { (2, key::GEOGRAPHIC_TYPE) } else { (1, key::PROJECTED_TYPE) };
        self.code(key::MODEL_TYPE, model);
        if let Some((code, unit)) = epsg_and_unit(crs) {
            self.code(type_key, code);
            if let Some(meters) = unit {
                self.linear_unit(meters);
            }
            return;
        }
        self.text(key::CITATION, crs.proj_text());
        match crs.definition() {
            Some(definition) => self.parameters(&definition),
            None => self.code(type_key, key::USER_DEFINED),
        }
    }

    fn parameters(&mut self, definition: &Definition) {
        self.geographic_system(definition);
        let Some(keys) = key::PROJECTIONS.iter().find(|keys| keys.method == definition.method) else {
            return;
        };
        let [latitude, longitude, easting, northing] = keys.origin;
        self.code(key::PROJECTED_TYPE, key::USER_DEFINED);
        self.code(key::PROJECTION, key::USER_DEFINED);
        self.code(key::TRANSFORMATION, keys.code);
        self.linear_unit(definition.meters_per_unit);
        let is_polar = definition.method == MapProjection::PolarStereographic;
        let true_scale = definition.parallel_1_deg.filter(|_| is_polar);
        self.number(latitude, true_scale.unwrap_or(definition.latitude_deg));
        self.number(longitude, definition.longitude_deg);
        for (key, parallel) in
            [(key::PARALLEL_1, definition.parallel_1_deg), (key::PARALLEL_2, definition.parallel_2_deg)]
        {
            if let Some(parallel) = parallel.filter(|_| !is_polar) {
                self.number(key, parallel);
            }
        }
        self.number(key::SCALE, definition.scale);
        self.number(easting, definition.false_easting_m / definition.meters_per_unit);
        self.number(northing, definition.false_northing_m / definition.meters_per_unit);
    }

    /// The geographic system that a projection starts from.
    fn geographic_system(&mut self, definition: &Definition) {
        if let Datum::OfEpsg(code) = definition.datum
            && let Ok(code) = u16::try_from(code)
        {
            self.code(key::GEOGRAPHIC_TYPE, code);
            return;
        }
        self.code(key::GEOGRAPHIC_TYPE, key::USER_DEFINED);
        self.code(key::GEODETIC_DATUM, key::USER_DEFINED);
        self.code(key::ANGULAR_UNITS, 9102);
        self.code(key::ELLIPSOID, key::USER_DEFINED);
        if let Some(ellipsoid) = definition.ellipsoid {
            self.number(key::SEMI_MAJOR, ellipsoid.major_m);
            self.number(key::INVERSE_FLATTENING, ellipsoid.inverse_flattening);
        }
        self.number(key::PRIME_MERIDIAN, definition.prime_meridian_deg);
        if let Datum::ToWgs84(numbers) = &definition.datum {
            self.0.push((key::TO_WGS84, GeoKeyValue::Numbers(numbers.clone())));
        }
    }

    fn linear_unit(&mut self, meters: f64) {
        match code_of_length(meters) {
            Some(code) => self.code(key::LINEAR_UNITS, code),
            None => {
                self.code(key::LINEAR_UNITS, key::USER_DEFINED);
                self.number(key::LINEAR_UNIT_SIZE, meters);
            }
        }
    }

    fn into_tags(mut self) -> GeoKeyTags {
        self.0.sort_by_key(|(key, _)| *key);
        let mut tags = GeoKeyTags { directory: vec![1, 1, 0, self.0.len() as u16], ..GeoKeyTags::default() };
        for (key, value) in self.0 {
            let entry = match value {
                GeoKeyValue::Code(code) => [key, 0, 1, code],
                GeoKeyValue::Numbers(numbers) => {
                    let at = tags.doubles.len() as u16;
                    tags.doubles.extend(&numbers);
                    [key, key::IN_DOUBLES, numbers.len() as u16, at]
                }
                GeoKeyValue::Text(text) => {
                    let at = tags.text.len() as u16;
                    tags.text += &text;
                    tags.text.push('|');
                    [key, key::IN_TEXT, text.len() as u16 + 1, at]
                }
            };
            tags.directory.extend(entry);
        }
        tags
    }
}

/// The EPSG code of a system, and meters in the unit of its coordinates where that is not the code's own.
fn epsg_and_unit(crs: &Crs) -> Option<(u16, Option<f64>)> {
    if let Some(code) = crs.epsg() {
        return Some((u16::try_from(code).ok()?, None));
    }
    let (code, unit) = crs.name().strip_prefix("EPSG:")?.split_once(" +to_meter=")?;
    Some((code.parse().ok()?, Some(unit.parse().ok()?)))
}
