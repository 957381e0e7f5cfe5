//! The positions of a request and their coordinate system.
//!
//! Without `crs`, coordinates are WGS 84 latitude and longitude, latitude first, as in the Open Topo Data and Google
//! APIs. With `crs=EPSG:n` they are x,y of that system: easting and northing, or longitude and latitude. With
//! `crs=native` they are x,y of the dataset's own system, as in `sandtable height`. A position may also be a text that
//! states its own system, WGS 84: a grid reference, UTM, or latitude and longitude with their letters. With
//! `positions=FORM`, every location of the answer also has `position`, a text in that form, which is read back.

use glam::DVec2;
use serde::Serialize;

use crate::parameters::Parameters;
use crate::polyline;
use crate::reply::{HttpError, quoted};
use sandtable_geom::crs::Crs;
use sandtable_geom::position::Position;
use sandtable_geom::position::notation::PositionForm;
use sandtable_query::dataset::check_datums;

/// The coordinates of a request.
#[derive(Clone, Debug)]
pub struct Coordinates {
    pub crs: Crs,
    /// Their order and names.
    pub axes: AxisOrder,
    /// The form in which answers also write positions, on WGS 84; numbers alone where `None`.
    pub form: Option<PositionForm>,
}

/// The most bytes that a position in a form adds to a location of an answer, with its key.
pub const POSITION_BYTES: usize = 72;

/// The order and names of two coordinates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AxisOrder {
    /// Latitude, longitude; `lat` and `lng` in answers.
    LatLng,
    Xy,
}

/// A position in an answer.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Location {
    /// Degrees.
    LatLng {
        lat: f64,
        lng: f64,
        /// In the form of the request.
        #[serde(skip_serializing_if = "Option::is_none")]
        position: Option<String>,
    },
    /// Coordinates of a named system.
    Xy {
        /// Easting or longitude.
        x: f64,
        /// Northing or latitude.
        y: f64,
        /// In the form of the request.
        #[serde(skip_serializing_if = "Option::is_none")]
        position: Option<String>,
    },
}

impl Coordinates {
    /// Parses the parameters `crs` and `positions`, for a dataset in the system `native`.
    pub fn read(parameters: &Parameters, native: &Crs, wgs84: &Crs) -> Result<Self, HttpError> {
        let form = form(parameters, native)?;
        let coordinates = match parameters.get("crs") {
            None => Self { crs: wgs84.clone(), axes: AxisOrder::LatLng, form },
            Some("native") => return Ok(Self { crs: native.clone(), axes: AxisOrder::Xy, form }),
            Some(text) => {
                let crs = Crs::from_epsg(epsg(text)?);
                let crs = crs.map_err(|error| HttpError::wrong(format!("crs: {error}")))?;
                Self { crs, axes: AxisOrder::Xy, form }
            }
        };
        check_datums(&coordinates.crs, native).map_err(|error| {
            HttpError::wrong(format!(
                "crs: {error}; crs=native takes coordinates of the dataset's own system"
            ))
        })?;
        Ok(coordinates)
    }

    /// Parses a position: two numbers with a comma between, or a text that states its system. `what` is the parameter.
    pub fn position(&self, what: &str, text: &str) -> Result<DVec2, HttpError> {
        match self.pair(text) {
            Some(at) => Ok(at),
            None => self.in_words(what, text),
        }
    }

    /// Parses positions with `|` between, or, for latitude and longitude, an encoded polyline, which has no comma.
    pub fn positions(&self, text: &str, most: usize) -> Result<Vec<DVec2>, HttpError> {
        if self.axes == AxisOrder::LatLng && !text.contains(',') && !is_in_words(text) {
            let positions = polyline::decode(text, most)?;
            return match positions.iter().position(|&at| !self.is_valid(at)) {
                None => Ok(positions),
                Some(index) => {
                    let DVec2 { x, y } = positions[index];
                    Err(self.refusal(&format!("location {}", index + 1), &format!("{y},{x}")))
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
        let mut positions = Vec::with_capacity(count);
        for pair in text.split('|') {
            let at = match self.pair(pair) {
                Some(at) => at,
                None => self.in_words(&format!("location {}", positions.len() + 1), pair)?,
            };
            positions.push(at);
        }
        Ok(positions)
    }

    /// A position as a location of an answer.
    pub fn location(&self, at: DVec2) -> Location {
        let (DVec2 { x, y }, position) = (at, self.written(&self.crs, at));
        match self.axes {
            AxisOrder::LatLng => Location::LatLng { lat: y, lng: x, position },
            AxisOrder::Xy => Location::Xy { x, y, position },
        }
    }

    /// A position in `crs` in the form of the request; `None` without one, and where it is no place on Earth.
    pub fn written(&self, crs: &Crs, at: DVec2) -> Option<String> {
        self.form.and_then(|form| form.write(crs, at).ok())
    }

    /// The most bytes that positions in the form of the request add to an answer of `count` locations.
    pub fn form_bytes(&self, count: usize) -> usize {
        if self.form.is_some() { count * POSITION_BYTES } else { 0 }
    }

    fn pair(&self, text: &str) -> Option<DVec2> {
        let (first, second) = text.split_once(',')?;
        let (first, second) = (first.trim().parse().ok()?, second.trim().parse().ok()?);
        let at = match self.axes {
            AxisOrder::LatLng => DVec2::new(second, first),
            AxisOrder::Xy => DVec2::new(first, second),
        };
        self.is_valid(at).then_some(at)
    }

    /// A position that states its system, in the system of the request.
    fn in_words(&self, what: &str, text: &str) -> Result<DVec2, HttpError> {
        let position = match Position::parse(text) {
            Ok(position) if position.numbers().is_none() => position,
            Err(error) if !error.is_unlike_any() => {
                return Err(HttpError::wrong(format!("{what} {}", error.with_forms())));
            }
            Ok(_) | Err(_) => return Err(self.refusal(what, text)),
        };
        let at = position.in_system(&self.crs);
        at.map_err(|error| HttpError::wrong(format!("{what}: {error}")))
    }

    fn is_valid(&self, at: DVec2) -> bool {
        match self.axes {
            AxisOrder::LatLng => (-90.0..=90.0).contains(&at.y) && (-180.0..=180.0).contains(&at.x),
            AxisOrder::Xy => at.is_finite(),
        }
    }

    fn refusal(&self, what: &str, text: &str) -> HttpError {
        let found = quoted(text);
        HttpError::wrong(match self.axes {
            AxisOrder::LatLng => format!(
                "{what} is {found}; write latitude,longitude in degrees, -90 to 90 and -180 to 180, as in 46.2,-122.19, or a \
                 grid reference, UTM, or both angles with their letters"
            ),
            AxisOrder::Xy => format!(
                "{what} is {found}; write x,y, two numbers with a comma between, or a grid reference, UTM, or latitude and \
                 longitude with their letters"
            ),
        })
    }
}

/// Whether the first of some positions is a text that states its system, or looks like one.
fn is_in_words(text: &str) -> bool {
    let first = text.trim_matches('|').split('|').next().unwrap_or_default();
    // An encoded polyline has no digits.
    first.bytes().any(|byte| byte.is_ascii_digit())
        && match Position::parse(first) {
            Ok(position) => position.numbers().is_none(),
            Err(error) => !error.is_unlike_any(),
        }
}

/// The form that `positions` names, which needs a dataset that lies somewhere on Earth.
fn form(parameters: &Parameters, native: &Crs) -> Result<Option<PositionForm>, HttpError> {
    let form = parameters.word("positions", PositionForm::WORDS.map(|(form, word, _)| (word, form)))?;
    if form.is_some() && *native == Crs::local() {
        return Err(HttpError::wrong(
            "positions: the dataset states no coordinate system, so that only its x and y are known",
        ));
    }
    Ok(form)
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
    use crate::parameters::tests::form;
    use proptest::prelude::*;

    fn lat_lng() -> Coordinates {
        Coordinates { crs: Crs::wgs84(), axes: AxisOrder::LatLng, form: None }
    }

    #[test]
    fn latitude_comes_first_unless_a_system_is_named() {
        let expected = Ok(vec![DVec2::new(172.5, -43.5), DVec2::new(1.98, 27.6)]);
        assert_eq!(lat_lng().positions("-43.5,172.5|27.6, 1.98|", 2), expected);
        let xy = Coordinates { axes: AxisOrder::Xy, ..lat_lng() };
        assert_eq!(xy.positions("172.5,-43.5|1.98,27.6", 2), expected);
        assert_eq!(lat_lng().positions("_p~iF~ps|U", 2), Ok(vec![DVec2::new(-120.2, 38.5)]));
    }

    #[test]
    fn a_position_in_words_states_its_own_system() {
        let crs = Crs::from_epsg(32616).expect("a zone");
        let zone = Coordinates { crs, axes: AxisOrder::Xy, form: None };
        let texts = "16SGF500180|16N 750050 4018050|750050,4018050";
        assert_eq!(zone.positions(texts, 9), Ok(vec![DVec2::new(750_050.0, 4_018_050.0); 3]));
        let expected = DVec2::new(-84.215, 36.277);
        for text in ["36.277N 84.215W", "36°16'37.2\"N, 84°12'54\"W", "84.215W,36.277N"] {
            let at = lat_lng().position("from", text).unwrap_or_else(|error| panic!("{error:?}"));
            assert!(at.distance(expected) < 1e-9, "{text}: {at}");
            assert_eq!(lat_lng().positions(text, 9), Ok(vec![at]));
        }
        for (wrong, part) in [
            ("16S 755447 4024162", "location 1 '16S 755447 4024162' can be read as zone 16, band S"),
            ("36N,84W|16SGF50018", "location 2 '16SGF50018' is not a grid reference"),
            ("36.2°,84.1°", "can be read as 36.2N 84.1E, or as 84.1N 36.2E"),
        ] {
            let refusal = lat_lng().positions(wrong, 9).expect_err(wrong);
            assert!(refusal.reason().contains(part), "{refusal:?}");
        }
        let native = Coordinates { crs: Crs::local(), axes: AxisOrder::Xy, form: None };
        let refusal = native.position("to", "16SGF500180").expect_err("no system");
        assert!(refusal.reason().contains("state no coordinate system"), "{refusal:?}");
    }

    #[test]
    fn answers_write_positions_in_the_form_of_the_request_and_read_them_back() {
        let crs = Crs::from_epsg(32616).expect("a zone");
        let read = |query: &str| {
            let read = Coordinates::read(&form(query), &crs, &Crs::wgs84());
            read.unwrap_or_else(|error| panic!("{query}: {error:?}"))
        };
        let at = DVec2::new(750_050.0, 4_018_050.0);
        for (_, word, _) in PositionForm::WORDS {
            let zone = read(&format!("crs=EPSG:32616&positions={word}"));
            let json = serde_json::to_value(zone.location(at)).expect("JSON");
            let written = json["position"].as_str().unwrap_or_else(|| panic!("{word}: {json}"));
            let again = zone.position("from", written).unwrap_or_else(|error| panic!("{word}: {error:?}"));
            assert!(again.distance(at) < 0.75, "{word}: {written} is {again}");
            assert!(written.len() + 14 <= POSITION_BYTES, "{written}");
        }
        let grid = read("positions=usng").location(DVec2::new(-84.215, 36.277));
        let json = serde_json::to_string(&grid).expect("JSON");
        assert_eq!(json, r#"{"lat":36.277,"lng":-84.215,"position":"16S GF 50154 18271"}"#);
        let beyond = read("positions=mgrs").location(DVec2::NAN);
        assert!(!serde_json::to_string(&beyond).expect("JSON").contains("position"));
        assert!(!serde_json::to_string(&read("").location(at)).expect("JSON").contains("position"));

        let wrong = Coordinates::read(&form("positions=osgb"), &crs, &Crs::wgs84()).expect_err("no form");
        assert!(wrong.reason().contains("there are mgrs, usng, utm, dd, dm, dms"), "{wrong:?}");
        let local = form("crs=native&positions=mgrs");
        let local = Coordinates::read(&local, &Crs::local(), &Crs::wgs84()).expect_err("no system");
        assert!(local.reason().contains("states no coordinate system"), "{local:?}");
    }

    #[test]
    fn what_is_no_position_is_refused_with_its_number() {
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
            let refusal = lat_lng().positions(wrong, 10).expect_err(wrong);
            assert!(refusal.reason().contains(&format!("location {number} ")), "{wrong}: {refusal:?}");
        }
        assert!(
            lat_lng().positions("1,2|3,4|5,6", 2).expect_err("too many").reason().contains("3 locations")
        );
        let beyond = lat_lng().positions("_fsia@???", 9).expect_err("latitude 173");
        assert!(beyond.reason().contains("location 1"), "{beyond:?}");
    }

    #[test]
    fn a_dataset_without_a_system_is_asked_in_its_own_coordinates_only() {
        let wgs84 = Crs::wgs84();
        let read = |query: &'static str| Coordinates::read(&form(query), &Crs::local(), &wgs84);
        assert!(read("").expect_err("no way").reason().contains("crs=native"));
        assert_eq!(read("crs=native").expect("sound").crs.name(), "local meters");
        for wrong in ["crs=EPSG:0", "crs=4326", "crs=%2Bproj=longlat", "crs=EPSG:99999999999"] {
            assert!(read(wrong).is_err_and(|refusal| refusal.status() == 400), "{wrong}");
        }
    }

    proptest! {
        #[test]
        fn positions_come_back_to_the_same_bits(lat in -90.0..=90.0f64, lng in -180.0..=180.0f64) {
            let positions = lat_lng().positions(&format!("{lat},{lng}"), 1).expect("sound");
            prop_assert_eq!(positions, vec![DVec2::new(lng, lat)]);
            let written = serde_json::to_value(lat_lng().location(DVec2::new(lng, lat))).expect("JSON");
            prop_assert_eq!((written["lat"].as_f64(), written["lng"].as_f64()), (Some(lat), Some(lng)));
        }

        #[test]
        fn no_text_breaks_the_reader(text in "[-0-9,|.eE infNa~_?@+]{0,60}") {
            if let Ok(positions) = lat_lng().positions(&text, 8) {
                prop_assert!(positions.len() <= 8 && positions.iter().all(|at| at.is_finite()));
            }
        }
    }
}
