//! The places that a request asks about, and the coordinates they are given in.
//!
//! Without `crs`, coordinates are WGS 84 latitude and longitude, latitude first, as the Open Topo Data and Google APIs
//! have them. With `crs=EPSG:n` they are x,y of that system: easting and northing, or longitude and latitude. With
//! `crs=native` they are x,y of the dataset's own system, the one that `sandtable height` is asked in.

use glam::DVec2;

use crate::app::serve::params::Params;
use crate::app::serve::reply::{HttpError, quoted};
use crate::app::serve::{encoded, json};
use crate::geom::crs::{Crs, CrsError};

/// Which coordinates a request speaks in.
#[derive(Clone, Debug)]
pub struct Coordinates {
    /// Their system.
    pub crs: Crs,
    /// Their order and names.
    pub axes: AxisOrder,
}

/// The order and names of two coordinates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AxisOrder {
    /// Latitude, longitude; `lat` and `lng` in answers.
    LatLng,
    /// `x`, `y`.
    Xy,
}

impl Coordinates {
    /// What a request's `crs` says, for a dataset whose own system is `native`.
    ///
    /// # Errors
    /// There is no such system, or no way from it to the dataset's.
    pub fn read(params: &Params<'_>, native: &Crs, wgs84: &Crs) -> Result<Self, HttpError> {
        let wrong = |error: CrsError| HttpError::wrong(format!("crs: {error}"));
        let coordinates = match params.get("crs") {
            None => Self { crs: wgs84.clone(), axes: AxisOrder::LatLng },
            Some("native") => return Ok(Self { crs: native.clone(), axes: AxisOrder::Xy }),
            Some(text) => Self { crs: Crs::from_epsg(epsg(text)?).map_err(wrong)?, axes: AxisOrder::Xy },
        };
        // Whether there is a way between two datums does not hang on the place.
        match coordinates.crs.transform(native, DVec2::ZERO) {
            Err(error @ CrsError::Datum { .. }) => Err(HttpError::wrong(format!(
                "crs: {error}; crs=native takes coordinates of the dataset's own system"
            ))),
            _ => Ok(coordinates),
        }
    }

    /// The place that `text` names: two numbers with a comma between.
    ///
    /// # Errors
    /// It is something else, or no place on Earth; `what` names the parameter.
    pub fn place(&self, what: &str, text: &str) -> Result<DVec2, HttpError> {
        self.pair(text).ok_or_else(|| self.refuse(what, text))
    }

    /// The places that `text` names: pairs with `|` between, or an encoded polyline where the coordinates are latitude
    /// and longitude and there is no comma.
    ///
    /// # Errors
    /// A place is none, or there are more than `most`; both are found before memory is taken for them.
    pub fn places(&self, text: &str, most: usize) -> Result<Vec<DVec2>, HttpError> {
        if self.axes == AxisOrder::LatLng && !text.contains(',') {
            let places = encoded::decode(text, most)?;
            return match places.iter().position(|&place| !self.holds(place)) {
                None => Ok(places),
                Some(index) => {
                    let DVec2 { x, y } = places[index];
                    Err(self.refuse(&format!("location {}", index + 1), &format!("{y},{x}")))
                }
            };
        }
        let text = text.trim_matches('|');
        let count = text.bytes().filter(|&byte| byte == b'|').count() + 1;
        if count > most {
            return Err(HttpError::wrong(format!(
                "{count} locations, where {most} are the most of one request"
            )));
        }
        let mut places = Vec::with_capacity(count);
        for written in text.split('|') {
            let place = self.pair(written);
            places
                .push(place.ok_or_else(|| self.refuse(&format!("location {}", places.len() + 1), written))?);
        }
        Ok(places)
    }

    /// Appends a place as an object of its coordinates.
    pub fn write(&self, out: &mut Vec<u8>, place: DVec2) {
        let (first, second) = match self.axes {
            AxisOrder::LatLng => (("{\"lat\":", place.y), (",\"lng\":", place.x)),
            AxisOrder::Xy => (("{\"x\":", place.x), (",\"y\":", place.y)),
        };
        for (name, value) in [first, second] {
            json::raw(out, name);
            json::number(out, value);
        }
        json::raw(out, "}");
    }

    /// Brings a place to another system.
    ///
    /// # Errors
    /// It lies beyond what one of the systems covers; `what` names the parameter.
    pub fn bring(&self, what: &str, place: DVec2, to: &Crs) -> Result<DVec2, HttpError> {
        self.crs.transform(to, place).map_err(|error| HttpError::wrong(format!("{what}: {error}")))
    }

    fn pair(&self, text: &str) -> Option<DVec2> {
        let (first, second) = text.split_once(',')?;
        let (first, second) = (first.trim().parse().ok()?, second.trim().parse().ok()?);
        let place = match self.axes {
            AxisOrder::LatLng => DVec2::new(second, first),
            AxisOrder::Xy => DVec2::new(first, second),
        };
        self.holds(place).then_some(place)
    }

    fn holds(&self, place: DVec2) -> bool {
        match self.axes {
            AxisOrder::LatLng => (-90.0..=90.0).contains(&place.y) && (-180.0..=180.0).contains(&place.x),
            AxisOrder::Xy => place.is_finite(),
        }
    }

    fn refuse(&self, what: &str, text: &str) -> HttpError {
        let found = quoted(text);
        HttpError::wrong(match self.axes {
            AxisOrder::LatLng => format!(
                "{what} is {found}; write latitude,longitude in degrees, -90 to 90 and -180 to 180, as in 46.2,-122.19"
            ),
            AxisOrder::Xy => format!("{what} is {found}; write x,y, two numbers with a comma between"),
        })
    }
}

fn epsg(text: &str) -> Result<u32, HttpError> {
    let code = text.split_once(':').filter(|(authority, _)| authority.eq_ignore_ascii_case("epsg"));
    code.and_then(|(_, code)| code.parse().ok()).ok_or_else(|| {
        HttpError::wrong(format!("crs is {}; write EPSG:n, for example EPSG:32616, or native", quoted(text)))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn lat_lng() -> Coordinates {
        Coordinates { crs: Crs::wgs84(), axes: AxisOrder::LatLng }
    }

    #[test]
    fn latitude_comes_first_unless_a_system_is_named() {
        let expected = Ok(vec![DVec2::new(172.5, -43.5), DVec2::new(1.98, 27.6)]);
        assert_eq!(lat_lng().places("-43.5,172.5|27.6, 1.98|", 2), expected);
        let xy = Coordinates { axes: AxisOrder::Xy, ..lat_lng() };
        assert_eq!(xy.places("172.5,-43.5|1.98,27.6", 2), expected);
        assert_eq!(lat_lng().places("_p~iF~ps|U", 2), Ok(vec![DVec2::new(-120.2, 38.5)]));
    }

    #[test]
    fn what_is_no_place_is_refused_with_its_number() {
        for (wrong, number) in [
            ("1,2|91,0", 2),
            ("NaN,0", 1),
            ("0,inf", 1),
            ("1,2||3,4", 2),
            ("1,2|3", 2),
            ("1,2,3", 1),
            ("1e999,0|1,2", 1),
            (",", 1),
            ("0,180.0001", 1),
        ] {
            let refusal = lat_lng().places(wrong, 10).expect_err(wrong);
            assert!(refusal.reason().contains(&format!("location {number} ")), "{wrong}: {refusal:?}");
        }
        assert!(lat_lng().places("1,2|3,4|5,6", 2).expect_err("too many").reason().contains("3 locations"));
        let beyond = lat_lng().places("_fsia@???", 9).expect_err("latitude 173");
        assert!(beyond.reason().contains("location 1"), "{beyond:?}");
    }

    #[test]
    fn a_dataset_without_a_system_is_asked_in_its_own_coordinates_only() {
        let wgs84 = Crs::wgs84();
        let read = |query: &'static str| {
            let mut params = Params::default();
            params.add_form(query).expect("sound");
            Coordinates::read(&params, &Crs::local(), &wgs84)
        };
        assert!(read("").expect_err("no way").reason().contains("crs=native"));
        assert_eq!(read("crs=native").expect("sound").crs.name(), "local meters");
        for wrong in ["crs=EPSG:0", "crs=4326", "crs=%2Bproj=longlat", "crs=EPSG:99999999999"] {
            assert!(read(wrong).is_err_and(|refusal| refusal.status() == 400), "{wrong}");
        }
    }

    proptest! {
        #[test]
        fn places_come_back_to_the_same_bits(lat in -90.0..=90.0f64, lng in -180.0..=180.0f64) {
            let places = lat_lng().places(&format!("{lat},{lng}"), 1).expect("sound");
            prop_assert_eq!(places, vec![DVec2::new(lng, lat)]);
            let mut out = Vec::new();
            lat_lng().write(&mut out, DVec2::new(lng, lat));
            let read: serde_json::Value = serde_json::from_slice(&out).expect("JSON");
            prop_assert!(read["lat"].is_number() && read["lng"].is_number());
        }

        #[test]
        fn no_text_breaks_the_reader(text in "[-0-9,|.eE infNa~_?@+]{0,60}") {
            if let Ok(places) = lat_lng().places(&text, 8) {
                prop_assert!(places.len() <= 8 && places.iter().all(|place| place.is_finite()));
            }
        }
    }
}
