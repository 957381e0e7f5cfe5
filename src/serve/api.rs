//! The API of the service: every address with its parameters, as a table.
//!
//! The queries refuse what is not in it, and the page at `/` and the OpenAPI document are made of it. The addresses of analyses
//! follow from their catalog.

use std::borrow::Cow;
use std::sync::LazyLock;

use crate::api::ApiNeed::{Optional, Required};
use crate::api::ApiValue::{Count, Listed, Number, Text, Words};
use crate::{analyses, health, help, ready};
use sandtable_base::message::choice::Choice;
use sandtable_catalog::kind::{AnalysisKind, AnalysisYield};
use sandtable_catalog::kinds;
use sandtable_catalog::parameter::{AnalysisParameter, ParameterDefault, ParameterForm};
use sandtable_geom::position::notation::PositionForm;
use sandtable_query::service::{PathPrefix, ServiceLimits};
use sandtable_raster::height_datum::HeightDatum;
use sandtable_terrain::query::Interpolation;

/// An address of the service.
#[derive(Debug)]
pub struct ApiAddress {
    pub path: Cow<'static, str>,
    pub methods: ApiMethods,
    pub summary: &'static str,
    /// Its media type where it is answered.
    pub answer: &'static str,
    pub parameters: Cow<'static, [ApiParameter]>,
}

/// The methods of an address, besides `HEAD` and `OPTIONS`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ApiMethods {
    Get,
    GetOrPost,
}

/// A parameter.
#[derive(Clone, Debug)]
pub struct ApiParameter {
    pub name: &'static str,
    pub value: ApiValue,
    pub need: ApiNeed,
    pub text: Cow<'static, str>,
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
    /// One of these words, of an analysis.
    Listed(&'static [&'static str]),
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
            Self::Listed(words) => words.join("|"),
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
    ApiParameter { name, value, need, text: Cow::Borrowed(text) }
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
    path: Cow::Borrowed("/v1/DATASET"),
    methods: ApiMethods::GetOrPost,
    summary: "heights, as in the Open Topo Data API; of several datasets a,b the first that has one",
    answer: "application/json",
    parameters: Cow::Borrowed(&[
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
    ]),
};

pub const LOOKUP: ApiAddress = ApiAddress {
    path: Cow::Borrowed("/api/v1/lookup"),
    methods: ApiMethods::GetOrPost,
    summary: "heights, as in the Open-Elevation API; of all datasets the first that has one",
    answer: "application/json",
    parameters: Cow::Borrowed(&[parameter(
        "locations",
        Text("LAT,LNG|LAT,LNG"),
        Required,
        "the positions; in JSON also [{\"latitude\": LAT, \"longitude\": LNG}]",
    )]),
};

pub const LOS: ApiAddress = ApiAddress {
    path: Cow::Borrowed("/v1/los"),
    methods: ApiMethods::GetOrPost,
    summary: "whether one point can be seen from another",
    answer: "application/json",
    parameters: Cow::Borrowed(&[
        DATASET,
        parameter("from", Text("LAT,LNG"), Required, "the observer"),
        parameter("to", Text("LAT,LNG"), Required, "the target"),
        OBSERVER_HEIGHT,
        TARGET_HEIGHT,
        REFRACTION,
        EARTH,
        CRS,
        POSITIONS,
    ]),
};

pub const PROFILE: ApiAddress = ApiAddress {
    path: Cow::Borrowed("/v1/profile"),
    methods: ApiMethods::GetOrPost,
    summary: "the ground along a line, at every place where it bends",
    answer: "application/json",
    parameters: Cow::Borrowed(&[
        DATASET,
        parameter(
            "locations",
            Text("LAT,LNG|LAT,LNG"),
            Required,
            "the line's vertices; or an encoded polyline",
        ),
        CRS,
        POSITIONS,
    ]),
};

pub const VIEWSHED: ApiAddress = ApiAddress {
    path: Cow::Borrowed("/v1/viewshed"),
    methods: ApiMethods::GetOrPost,
    summary: "what can be seen from a point",
    answer: "application/json",
    parameters: Cow::Borrowed(&[
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
    ]),
};

pub const TILES: ApiAddress = ApiAddress {
    path: Cow::Borrowed("/v1/tiles/DATASET/{z}/{x}/{y}.png"),
    methods: ApiMethods::GetOrPost,
    summary: "shaded relief in tiles of 256 pixels in Web Mercator, as web maps and QGIS show them; z up to 22",
    answer: "image/png",
    parameters: Cow::Borrowed(&[]),
};

/// Every address but those of analyses.
static ADDRESSES: [ApiAddress; 13] = [
    HEIGHTS,
    LOS,
    PROFILE,
    VIEWSHED,
    LOOKUP,
    TILES,
    page(analyses::PATH, "the kinds of terrain analysis: parameters, source and limits", "application/json"),
    page("/datasets", "the datasets with their systems, extents and cells", "application/json"),
    page(health::PATH, "version, and whether the datasets are ready", "application/json"),
    page(ready::PATH, "whether requests should be sent here: 200, or 503", "application/json"),
    page("/openapi.json", "this list as an OpenAPI document", "application/json"),
    page(help::PATH, "this list as text", "text/plain"),
    page("/", "a map to click for browsers, this list for other programs", "text/html"),
];

/// The addresses of the kinds of analysis.
static ANALYSES: LazyLock<Vec<ApiAddress>> = LazyLock::new(|| kinds().map(analysis).collect());

/// Every address.
pub fn addresses() -> impl Iterator<Item = &'static ApiAddress> {
    ADDRESSES.iter().chain(ANALYSES.iter())
}

/// The words of the parameter `format` of an analysis.
pub const ANALYSIS_FORMATS: [&str; 5] = ["tif", "geojson", "gpkg", "json", "png"];

/// Their media types.
pub const ANALYSIS_TYPES: [&str; 5] =
    ["image/tiff", "application/geo+json", "application/geopackage+sqlite3", "application/json", "image/png"];

const FORMAT: ApiParameter = parameter(
    "format",
    Words(|| ANALYSIS_FORMATS.to_vec()),
    Optional("tif of a raster, geojson of features, json of a table"),
    "the raster, the features or the areas of its classes; json holds figures, tables and notes; png is a map with a legend",
);

/// The address of a kind of analysis.
fn analysis(kind: &'static AnalysisKind) -> ApiAddress {
    let of_kind = kind.all_parameters().map(analysis_parameter);
    ApiAddress {
        path: format!("{}{}", analyses::QUERY_PATH, kind.name).into(),
        methods: ApiMethods::GetOrPost,
        summary: kind.summary.trim_end_matches('.'),
        answer: match kind.yields {
            AnalysisYield::Raster => "image/tiff",
            AnalysisYield::Features | AnalysisYield::Both => "application/geo+json",
            AnalysisYield::Table => "application/json",
        },
        parameters: [DATASET].into_iter().chain(of_kind).chain([FORMAT, CRS]).collect(),
    }
}

fn analysis_parameter(parameter: &'static AnalysisParameter) -> ApiParameter {
    let unit = if parameter.unit.is_empty() { String::new() } else { format!(", {}", parameter.unit) };
    ApiParameter {
        name: parameter.name,
        value: match parameter.form {
            ParameterForm::Number { least, greatest } => Number(least, greatest),
            ParameterForm::Numbers { .. } => Text("NUMBER,NUMBER"),
            ParameterForm::Word(words) => Listed(words),
            ParameterForm::Points { .. } | ParameterForm::Line | ParameterForm::Area => {
                Text("LAT,LNG|LAT,LNG")
            }
            ParameterForm::Vehicle => Text("VEHICLE"),
            ParameterForm::Ground => Text("DATASET|source"),
            ParameterForm::Extent => Text("LAT,LNG,LAT,LNG"),
        },
        need: match parameter.default {
            ParameterDefault::Required => Required,
            ParameterDefault::Value(text) | ParameterDefault::Otherwise(text) => Optional(text),
        },
        text: format!("{}{unit}", parameter.doc.trim_end_matches('.')).into(),
    }
}

const fn page(path: &'static str, summary: &'static str, answer: &'static str) -> ApiAddress {
    ApiAddress {
        path: Cow::Borrowed(path),
        methods: ApiMethods::Get,
        summary,
        answer,
        parameters: Cow::Borrowed(&[]),
    }
}

impl ApiAddress {
    /// The media types of its answers, that of the default one first.
    pub fn answers(&self) -> Vec<&'static str> {
        let formats = if self.path.starts_with(analyses::QUERY_PATH) { &ANALYSIS_TYPES[..] } else { &[] };
        let others = formats.iter().copied().filter(|&answer| answer != self.answer);
        std::iter::once(self.answer).chain(others).collect()
    }
}

/// The paths of all addresses below a prefix.
pub fn paths(prefix: &PathPrefix) -> Vec<String> {
    let any_kind = format!("{}KIND", analyses::QUERY_PATH);
    ADDRESSES
        .iter()
        .map(|address| &*address.path)
        .chain([&*any_kind])
        .map(|path| prefix.before(path))
        .collect()
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
