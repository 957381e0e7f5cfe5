//! The API of the service: every address with its parameters, as a table.
//!
//! The queries refuse what is not in it, and the page at `/` and the OpenAPI document are made of it.

use crate::api::ApiNeed::{Optional, Required};
use crate::api::ApiValue::{Count, Number, Text, Words};
use crate::{health, ready};
use sandtable_base::message::choice::Choice;
use sandtable_geom::position::notation::PositionForm;
use sandtable_query::service::{PathPrefix, ServiceLimits};
use sandtable_raster::height_datum::HeightDatum;
use sandtable_terrain::query::Interpolation;

/// An address of the service.
#[derive(Debug)]
pub struct ApiAddress {
    pub path: &'static str,
    pub methods: ApiMethods,
    pub summary: &'static str,
    /// Its media type where it is answered.
    pub answer: &'static str,
    pub parameters: &'static [ApiParameter],
}

/// The methods of an address, besides `HEAD` and `OPTIONS`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ApiMethods {
    Get,
    GetOrPost,
}

/// A parameter.
#[derive(Debug)]
pub struct ApiParameter {
    pub name: &'static str,
    pub value: ApiValue,
    pub need: ApiNeed,
    pub text: &'static str,
}

/// The need for a parameter: required or optional.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ApiNeed {
    Required,
    /// What has effect without it, in words or as a value.
    Optional(&'static str),
}

/// The values of a parameter.
#[derive(Clone, Copy)]
pub enum ApiValue {
    /// A text of this form.
    Text(&'static str),
    /// A number from the first to the second.
    Number(f64, f64),
    /// A whole number from 2 to the most points of one request.
    Count,
    /// One of these words.
    Words(fn() -> Vec<&'static str>),
}

impl std::fmt::Debug for ApiValue {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        out.write_str(&self.form(&ServiceLimits::default()))
    }
}

impl ApiValue {
    /// The written form of the value.
    pub fn form(&self, limits: &ServiceLimits) -> String {
        match self {
            Self::Text(form) => (*form).to_owned(),
            Self::Number(least, most) if *most >= 1e9 => format!("a number from {least} on"),
            Self::Number(least, most) => format!("a number from {least} to {most}"),
            Self::Count => format!("a number from 2 to {}", limits.max_points),
            Self::Words(words) => words().join("|"),
        }
    }
}

impl ApiAddress {
    /// The names of all parameters.
    pub fn names(&self) -> Vec<&'static str> {
        self.parameters.iter().map(|parameter| parameter.name).collect()
    }
}

fn choices<T: Choice>() -> Vec<&'static str> {
    T::CHOICES.iter().map(|choice| choice.word).collect()
}

const fn parameter(name: &'static str, value: ApiValue, need: ApiNeed, text: &'static str) -> ApiParameter {
    ApiParameter { name, value, need, text }
}

const DATASET: ApiParameter =
    parameter("dataset", Text("NAME"), Optional("the only one"), "the name of a dataset");

const CRS: ApiParameter = parameter(
    "crs",
    Text("EPSG:N|native"),
    Optional("latitude,longitude of WGS 84"),
    "positions of two numbers are x,y of that system, or of the dataset's own; other positions, such as 16SGF500180, \
     16N 750050 4018050 or 36.277N 84.215W, are on WGS 84 and may take the place of any two numbers",
);

const POSITIONS: ApiParameter = parameter(
    "positions",
    Words(|| PositionForm::WORDS.map(|(_, word, _)| word).to_vec()),
    Optional("numbers alone"),
    "every location of the answer has its position on WGS 84 in this form, too: a grid reference without and with spaces, \
     UTM, decimal degrees, with minutes, with seconds",
);

const OBSERVER_HEIGHT: ApiParameter =
    parameter("observer_height", Number(0.0, 100_000.0), Optional("2"), "meters of the eye above the ground");

const TARGET_HEIGHT: ApiParameter = parameter(
    "target_height",
    Number(0.0, 100_000.0),
    Optional("0"),
    "meters of the target above the ground",
);

const REFRACTION: ApiParameter = parameter(
    "refraction",
    Number(-1.0, 1.0),
    Optional("0.142857"),
    "how far air bends sight around the Earth",
);

const EARTH: ApiParameter =
    parameter("earth", Words(|| vec!["round", "flat"]), Optional("round"), "the Earth's shape");

pub const HEIGHTS: ApiAddress = ApiAddress {
    path: "/v1/DATASET",
    methods: ApiMethods::GetOrPost,
    summary: "heights, as in the Open Topo Data API; of several datasets a,b the first that has one",
    answer: "application/json",
    parameters: &[
        parameter("locations", Text("LAT,LNG|LAT,LNG"), Required, "the positions; or an encoded polyline"),
        parameter(
            "interpolation",
            Words(choices::<Interpolation>),
            Optional("bilinear"),
            "how the height between samples is found",
        ),
        parameter(
            "samples",
            Count,
            Optional("the positions themselves"),
            "as many places at equal distances along the path of the locations",
        ),
        parameter(
            "nodata_value",
            Text("null|nan|NUMBER"),
            Optional("null"),
            "the elevation where there is none",
        ),
        parameter("format", Words(|| vec!["json", "geojson"]), Optional("json"), "how the answer is written"),
        parameter(
            "surface",
            Words(|| vec!["source", "ground", "scene"]),
            Optional("source of a file, ground of a scene"),
            "as read; in meters, after earthworks; with decks on top",
        ),
        parameter(
            "above",
            Words(choices::<HeightDatum>),
            Optional("what the dataset counts from"),
            "heights above the WGS 84 ellipsoid or the EGM96 geoid",
        ),
        CRS,
        POSITIONS,
    ],
};

pub const LOOKUP: ApiAddress = ApiAddress {
    path: "/api/v1/lookup",
    methods: ApiMethods::GetOrPost,
    summary: "heights, as in the Open-Elevation API; of all datasets the first that has one",
    answer: "application/json",
    parameters: &[parameter(
        "locations",
        Text("LAT,LNG|LAT,LNG"),
        Required,
        "the positions; in JSON also [{\"latitude\": LAT, \"longitude\": LNG}]",
    )],
};

pub const LOS: ApiAddress = ApiAddress {
    path: "/v1/los",
    methods: ApiMethods::GetOrPost,
    summary: "whether one point can be seen from another",
    answer: "application/json",
    parameters: &[
        DATASET,
        parameter("from", Text("LAT,LNG"), Required, "the observer"),
        parameter("to", Text("LAT,LNG"), Required, "the target"),
        OBSERVER_HEIGHT,
        TARGET_HEIGHT,
        REFRACTION,
        EARTH,
        CRS,
        POSITIONS,
    ],
};

pub const PROFILE: ApiAddress = ApiAddress {
    path: "/v1/profile",
    methods: ApiMethods::GetOrPost,
    summary: "the ground along a line, at every place where it bends",
    answer: "application/json",
    parameters: &[
        DATASET,
        parameter(
            "locations",
            Text("LAT,LNG|LAT,LNG"),
            Required,
            "the line's vertices; or an encoded polyline",
        ),
        CRS,
        POSITIONS,
    ],
};

pub const VIEWSHED: ApiAddress = ApiAddress {
    path: "/v1/viewshed",
    methods: ApiMethods::GetOrPost,
    summary: "what can be seen from a point",
    answer: "application/json",
    parameters: &[
        DATASET,
        parameter("observer", Text("LAT,LNG"), Required, "the observer"),
        OBSERVER_HEIGHT,
        TARGET_HEIGHT,
        parameter(
            "range",
            Number(0.0, 1e9),
            Optional("all of the ground"),
            "meters within which posts are looked at",
        ),
        parameter(
            "sector",
            Text("FROM,WIDTH"),
            Optional("all around"),
            "degrees clockwise from north: where it begins, how far it turns",
        ),
        REFRACTION,
        EARTH,
        parameter(
            "format",
            Words(|| vec!["runs", "summary"]),
            Optional("runs"),
            "every post, or how many of each kind",
        ),
        CRS,
        POSITIONS,
    ],
};

/// Every address.
pub const ADDRESSES: [ApiAddress; 10] = [
    HEIGHTS,
    LOS,
    PROFILE,
    VIEWSHED,
    LOOKUP,
    page("/datasets", "the datasets with their systems, extents and cells", "application/json"),
    page(health::PATH, "version, and whether the datasets are ready", "application/json"),
    page(ready::PATH, "whether requests should be sent here: 200, or 503", "application/json"),
    page("/openapi.json", "this list as an OpenAPI document", "application/json"),
    page("/", "this list as text", "text/plain"),
];

const fn page(path: &'static str, summary: &'static str, answer: &'static str) -> ApiAddress {
    ApiAddress { path, methods: ApiMethods::Get, summary, answer, parameters: &[] }
}

/// The paths of all addresses below a prefix.
pub fn paths(prefix: &PathPrefix) -> Vec<String> {
    ADDRESSES.iter().map(|address| prefix.before(address.path)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use sandtable_terrain::query::Surface;

    #[test]
    fn the_surfaces_are_those_of_queries() {
        let ApiValue::Words(words) =
            HEIGHTS.parameters.iter().find(|parameter| parameter.name == "surface").expect("there").value
        else {
            panic!("surfaces are words");
        };
        let known = choices::<Surface>();
        assert!(words().iter().all(|word| known.contains(word)), "{known:?}");
    }
}
