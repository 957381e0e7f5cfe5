//! The parameters of a system from the proj string that describes it: the way back from
//! [`Definition::proj_text`], for those who must say it in another language (GeoTIFF keys, well-known text).

use crate::geom::projection::{Datum, Definition, Ellipsoid, MapProjection};

/// The definition that a proj string states, on an `ellipsoid` and a prime meridian that were worked out already;
/// `None` where its projection, or a word of it, is none that a definition can express.
pub(crate) fn definition(text: &str, ellipsoid: Ellipsoid, prime_meridian_deg: f64) -> Option<Definition> {
    let words = ProjWords(text);
    let base = Definition {
        prime_meridian_deg,
        ..Definition::geographic(String::new(), Some(ellipsoid), datum(&words))
    };
    if ["+alpha=", "+gamma=", "+axis=", "+zone_width="].iter().any(|key| words.text(key).is_some()) {
        return None;
    }
    let number = |key: &str| words.number(key);
    let scale = number("+k_0=").or(number("+k=")).unwrap_or(1.0);
    let latitude_deg = number("+lat_0=").unwrap_or(0.0);
    let projected = Definition {
        latitude_deg,
        longitude_deg: number("+lon_0=").unwrap_or(0.0),
        scale,
        false_easting_m: number("+x_0=").unwrap_or(0.0),
        false_northing_m: number("+y_0=").unwrap_or(0.0),
        ..base.clone()
    };
    let (first, second) = (number("+lat_1="), number("+lat_2="));
    match words.text("+proj=")? {
        "longlat" | "latlong" | "latlon" | "lonlat" => Some(base),
        "utm" => Some(Definition {
            method: MapProjection::TransverseMercator,
            longitude_deg: number("+zone=")? * 6.0 - 183.0,
            scale: 0.9996,
            false_easting_m: 5e5,
            false_northing_m: if text.split_whitespace().any(|word| word == "+south") { 1e7 } else { 0.0 },
            ..base
        }),
        "tmerc" | "etmerc" => Some(Definition { method: MapProjection::TransverseMercator, ..projected }),
        "merc" => Some(Definition {
            method: MapProjection::Mercator,
            parallel_1_deg: number("+lat_ts="),
            ..projected
        }),
        "lcc" if second.is_none_or(|second| Some(second) == first) && first == Some(latitude_deg) => {
            Some(Definition { method: MapProjection::LambertConic1, ..projected })
        }
        "lcc" if scale == 1.0 => Some(Definition {
            method: MapProjection::LambertConic2,
            parallel_1_deg: first,
            parallel_2_deg: second.or(first),
            ..projected
        }),
        "aea" => Some(Definition {
            method: MapProjection::Albers,
            parallel_1_deg: first,
            parallel_2_deg: second.or(first),
            ..projected
        }),
        "laea" => Some(Definition { method: MapProjection::LambertAzimuthal, ..projected }),
        "stere" if latitude_deg.abs() == 90.0 => Some(Definition {
            method: MapProjection::PolarStereographic,
            parallel_1_deg: number("+lat_ts=").filter(|at| at.abs() < 90.0),
            ..projected
        }),
        _ => None,
    }
}

/// By the names that are EPSG's datums, or by a stated shift.
fn datum(words: &ProjWords) -> Datum {
    if let Some(shift) = words.text("+towgs84=") {
        return Datum::ToWgs84(shift.split(',').filter_map(|word| word.trim().parse().ok()).collect());
    }
    match words.text("+datum=").map(str::to_ascii_lowercase).as_deref() {
        Some("wgs84") => Datum::OfEpsg(4326),
        Some("nad83") => Datum::OfEpsg(4269),
        Some("nad27") => Datum::OfEpsg(4267),
        Some("osgb36") => Datum::OfEpsg(4277),
        _ => Datum::Unstated,
    }
}

/// The words of a proj string.
struct ProjWords<'a>(&'a str);

impl<'a> ProjWords<'a> {
    fn text(&self, key: &str) -> Option<&'a str> {
        self.0.split_whitespace().find_map(|word| word.strip_prefix(key))
    }

    fn number(&self, key: &str) -> Option<f64> {
        self.text(key)?.parse().ok()
    }
}

#[cfg(test)]
mod tests {
    use crate::geom::crs::Crs;
    use glam::DVec2;

    #[test]
    fn what_a_definition_says_is_where_its_proj_string_was() {
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
