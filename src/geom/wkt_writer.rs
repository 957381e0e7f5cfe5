//! Writes systems as well-known text, version 1 (OGC 01-009), for `.prj` files: in OGC's spelling, which GDAL, QGIS and
//! Esri's programs read alike.

use crate::crs::Crs;
use crate::length_unit::{FOOT_M, US_SURVEY_FOOT_M};
use crate::proj_string::ProjString;
use crate::projection::{Datum, Definition, Ellipsoid, MapProjection};
use crate::wkt_registered::{registered_axes, registered_projection};

/// The WKT of a system; `None` for [`Crs::local`], for a projection that [`Definition`] cannot express in a system without
/// an EPSG code, and for one that has no name in WKT 1.
///
/// A system with an EPSG code has it at the root, for readers that look it up.
pub fn write(crs: &Crs) -> Option<String> {
    match crs.definition() {
        Some(definition) if definition.method == MapProjection::Geographic => {
            let authority = crs.epsg().map_or_else(String::new, authority);
            Some(format!("{}{authority}]", geographic(&definition, &quoted(crs.name()))))
        }
        Some(definition) => Some(projected(crs, &definition, projection(&definition)?)),
        None => {
            crs.epsg()?;
            let text = ProjString(crs.proj_text());
            let projection = registered_projection(text)?;
            let definition = Definition {
                false_easting_m: text.number("x_0").unwrap_or(0.0),
                false_northing_m: text.number("y_0").unwrap_or(0.0),
                ..crs.geodetic_definition()
            };
            Some(projected(crs, &definition, projection))
        }
    }
}

/// A PROJCS; of the definition its datum, unit and false origin.
fn projected(crs: &Crs, definition: &Definition, (method, parameters): WktProjection) -> String {
    let (base, base_authority) = match definition.datum {
        Datum::OfEpsg(code) => (quoted(geographic_name(code)), authority(code)),
        _ => ("unnamed".into(), String::new()),
    };
    let base = geographic(definition, &base);
    let unit = definition.meters_per_unit;
    let origin = [
        ("false_easting", definition.false_easting_m / unit),
        ("false_northing", definition.false_northing_m / unit),
    ];
    let parameters: String = parameters
        .into_iter()
        .chain(origin)
        .map(|(parameter, value)| format!(",PARAMETER[\"{parameter}\",{value}]"))
        .collect();
    format!(
        "PROJCS[\"{}\",{base}{base_authority}],PROJECTION[\"{method}\"]{parameters},UNIT[\"{}\",{unit}]{}{}]",
        quoted(crs.name()),
        unit_name(unit),
        registered_axes(ProjString(crs.proj_text())),
        crs.epsg().map_or_else(String::new, authority),
    )
}

fn authority(code: u32) -> String {
    format!(",AUTHORITY[\"EPSG\",\"{code}\"]")
}

/// A GEOGCS without its authority and closing bracket.
fn geographic(definition: &Definition, name: &str) -> String {
    let wgs84 = Ellipsoid { major_m: 6_378_137.0, inverse_flattening: 298.257_223_563 };
    let Ellipsoid { major_m, inverse_flattening } = definition.ellipsoid.unwrap_or(wgs84);
    let (datum, shift) = match &definition.datum {
        Datum::OfEpsg(code) => (datum_name(*code), String::new()),
        Datum::ToWgs84(numbers) => ("unknown", to_wgs84(numbers)),
        Datum::Unstated => ("unknown", String::new()),
    };
    format!(
        "GEOGCS[\"{name}\",DATUM[\"{datum}\",SPHEROID[\"{}\",{major_m},{inverse_flattening}]{shift}],PRIMEM[\"{}\",{}],UNIT[\"degree\",0.0174532925199433]",
        spheroid_name(major_m, inverse_flattening),
        if definition.prime_meridian_deg == 0.0 { "Greenwich" } else { "unnamed" },
        definition.prime_meridian_deg,
    )
}

/// Seven numbers, as WKT 1 requires.
fn to_wgs84(numbers: &[f64]) -> String {
    let seven: Vec<String> = (0..7).map(|at| numbers.get(at).unwrap_or(&0.0).to_string()).collect();
    format!(",TOWGS84[{}]", seven.join(","))
}

/// A projection's name and its parameters other than the false origin.
pub(super) type WktProjection = (&'static str, Vec<(&'static str, f64)>);

/// The projection; `None` for a geographic system, or where a parallel is missing.
fn projection(definition: &Definition) -> Option<WktProjection> {
    let Definition { latitude_deg, longitude_deg, scale, parallel_1_deg, parallel_2_deg, .. } = *definition;
    let (latitude, meridian) = (("latitude_of_origin", latitude_deg), ("central_meridian", longitude_deg));
    let center = [("latitude_of_center", latitude_deg), ("longitude_of_center", longitude_deg)];
    let scale = ("scale_factor", scale);
    let parallels =
        || Some([("standard_parallel_1", parallel_1_deg?), ("standard_parallel_2", parallel_2_deg?)]);
    Some(match (definition.method, parallel_1_deg) {
        (MapProjection::Geographic, _) => return None,
        (MapProjection::TransverseMercator, _) => ("Transverse_Mercator", vec![latitude, meridian, scale]),
        (MapProjection::Mercator, Some(parallel)) => {
            ("Mercator_2SP", vec![("standard_parallel_1", parallel), meridian])
        }
        (MapProjection::Mercator, None) => ("Mercator_1SP", vec![meridian, scale]),
        (MapProjection::LambertConic1, _) => ("Lambert_Conformal_Conic_1SP", vec![latitude, meridian, scale]),
        (MapProjection::LambertConic2, _) => {
            ("Lambert_Conformal_Conic_2SP", [parallels()?, [latitude, meridian]].concat())
        }
        (MapProjection::Albers, _) => ("Albers_Conic_Equal_Area", [parallels()?, center].concat()),
        (MapProjection::LambertAzimuthal, _) => ("Lambert_Azimuthal_Equal_Area", center.to_vec()),
        // OGC's latitude of origin is the parallel of true scale here.
        (MapProjection::PolarStereographic, parallel) => (
            "Polar_Stereographic",
            vec![("latitude_of_origin", parallel.unwrap_or(latitude_deg)), meridian, scale],
        ),
    })
}

fn geographic_name(code: u32) -> &'static str {
    match code {
        4326 => "WGS 84",
        4269 => "NAD83",
        4267 => "NAD27",
        4277 => "OSGB36",
        _ => "unnamed",
    }
}

fn datum_name(code: u32) -> &'static str {
    match code {
        4326 => "WGS_1984",
        4269 => "North_American_Datum_1983",
        4267 => "North_American_Datum_1927",
        4277 => "OSGB_1936",
        _ => "unknown",
    }
}

fn spheroid_name(major_m: f64, inverse_flattening: f64) -> &'static str {
    match (major_m, (inverse_flattening * 1e6).round()) {
        (6_378_137.0, 298_257_224.0) => "WGS 84",
        (6_378_137.0, 298_257_222.0) => "GRS 1980",
        _ => "unnamed",
    }
}

fn unit_name(meters: f64) -> &'static str {
    match meters {
        1.0 => "metre",
        FOOT_M => "foot",
        feet if (feet - US_SURVEY_FOOT_M).abs() < 1e-9 => "US survey foot",
        _ => "unit",
    }
}

/// A name without the characters that would end it.
fn quoted(name: &str) -> String {
    name.replace(['"', '[', ']'], " ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec2;
    use std::collections::BTreeMap;

    #[test]
    fn a_system_with_a_code_is_read_back_as_that_code() {
        for code in [32612, 4326, 27700, 5070, 3031] {
            let crs = Crs::from_epsg(code).expect("known");
            let text = write(&crs).expect("a common projection");
            assert_eq!(Crs::parse(&text).expect("readable").epsg(), Some(code), "{text}");
        }
        assert_eq!(write(&Crs::local()), None);
    }

    /// What follows `key["` up to the next quotation mark.
    fn named<'a>(text: &'a str, key: &str) -> Option<&'a str> {
        let (_, rest) = text.split_once(&format!("{key}[\""))?;
        Some(&rest[..rest.find('"')?])
    }

    fn parameters(text: &str) -> BTreeMap<&str, f64> {
        let listed = text.split("PARAMETER[\"").skip(1).map(|part| {
            let (name, rest) = part.split_once("\",").expect("a value");
            (name, rest[..rest.find(']').expect("an end")].parse().expect("a number"))
        });
        listed.collect()
    }

    #[test]
    fn whatever_its_projection_a_system_with_a_code_has_well_known_text() {
        let (mut systems, mut without) = (0, Vec::new());
        for code in 2000..=32766 {
            let Ok(crs) = Crs::from_epsg(code) else { continue };
            let Some(text) = write(&crs) else {
                without.push(code);
                continue;
            };
            assert!(text.starts_with("PROJCS[") || text.starts_with("GEOGCS["), "{text}");
            systems += 1;
        }
        assert!(systems > 4000, "{systems}");
        // Guam's azimuthal projection, Michigan's zones in international feet, a zone of Oregon and Equal Earth.
        assert_eq!(without, [3993, 6200, 6201, 6202, 6966, 8857, 8858, 8859]);
    }

    #[test]
    fn rare_projections_are_written_as_the_registry_has_them() {
        let mut methods = BTreeMap::new();
        for code in 2000..=32766 {
            let Ok(crs) = Crs::from_epsg(code) else { continue };
            let registered = crs_definitions_wkt::from_code(code as u16).expect("in the table").wkt;
            if crs.definition().is_some() || registered.is_empty() {
                continue;
            }
            let text = write(&crs).expect("written");
            let method = named(&text, "PROJECTION").expect("projected").to_owned();
            assert_eq!(named(registered, "PROJECTION"), Some(method.as_str()), "{text}");
            // The table's proj string of Madagascar's grid is in degrees, its text in grads.
            if ![29700, 29702].contains(&code) {
                let (ours, theirs) = (parameters(&text), parameters(registered));
                assert!(ours.keys().eq(theirs.keys()), "{text}\n{registered}");
                for (name, value) in ours {
                    assert!((value - theirs[name]).abs() <= 1e-9 * value.abs().max(1.0), "{name}: {text}");
                }
            }
            assert_eq!(Crs::parse(&text).expect("readable").epsg(), Some(code));
            *methods.entry(method).or_insert(0) += 1;
        }
        assert!(methods.len() >= 9 && methods.values().sum::<i32>() > 90, "{methods:?}");
    }

    #[test]
    fn a_system_without_a_code_is_read_back_by_its_parameters() {
        for (text, at) in [
            (
                "+proj=lcc +lat_1=36.5 +lat_2=34.25 +lat_0=33.75 +lon_0=-79 +x_0=609601.22 +datum=NAD83 +to_meter=0.3048006096012192",
                (2e6, 5e5),
            ),
            (
                "+proj=tmerc +lat_0=10 +lon_0=20 +k=0.9999 +x_0=1000 +ellps=intl +towgs84=-87,-98,-121",
                (3e4, 2e4),
            ),
            ("+proj=stere +lat_0=-90 +lat_ts=-71 +lon_0=30 +datum=WGS84", (1e6, 2e6)),
            ("+proj=laea +lat_0=50 +lon_0=12 +ellps=GRS80 +towgs84=0,0,0", (1e5, 1e5)),
        ] {
            let crs = Crs::parse(text).expect("readable");
            let wkt = write(&crs).expect("a common projection");
            let again = Crs::parse(&wkt).unwrap_or_else(|error| panic!("{wkt}: {error}"));
            let at = DVec2::from(at);
            let degrees = |crs: &Crs| crs.transform(&Crs::wgs84(), at).expect("inside");
            assert!(degrees(&crs).distance(degrees(&again)) < 1e-9, "{wkt}");
        }
    }
}
