//! `/analyses`: the kinds of terrain analysis. `/v1/analyze/KIND`: what one gives, with the bytes of the command `analyze`.
//!
//! Parameters are those of the kind. Positions are written as in other queries, latitude first or x,y by `crs`, with `|` or
//! `;` between. `format` says whether the raster, the features, the figures or a map are answered:
//!
//! ```text
//! {"arguments":{…},"figures":[{"name":"unrestricted","unit":"km²","value":81.2}, …],"kind":"obstacles",…,
//!  "dataset":"a","status":"OK"}
//! ```
//!
//! An argument that names another ground takes the name of a dataset: requests name no files.

use std::io::Cursor;

use axum::Json;
use axum::http::header::CONTENT_TYPE;
use axum::response::{IntoResponse, Response};
use serde::Serialize;
use serde_json::Value;

use crate::api::ANALYSIS_FORMATS;
use crate::coordinates::{AxisOrder, Coordinates};
use crate::parameters::Parameters;
use crate::query::{GroundQuery, Query, QueryWeight};
use crate::reply::{HttpError, OK, quoted};
use crate::service::Service;
use sandtable_analysis::error::AnalysisError;
use sandtable_analysis::outcome::Outcome;
use sandtable_base::message::chain::error_text;
use sandtable_base::message::suggest::remedy;
use sandtable_catalog::kind::{AnalysisKind, AnalysisYield};
use sandtable_catalog::parameter::{AnalysisParameter, ParameterForm};
use sandtable_catalog::{kind, kinds};
use sandtable_dem::dem_format::DemFormat;
use sandtable_export::features::FeatureFormat;
use sandtable_export::features::analysis_json::{catalog_json, outcome_json};
use sandtable_export::features::outcome::{OutcomeFrame, outcome_bytes, outcome_geojson};
use sandtable_files::png::encode_png;
use sandtable_query::analysis::{
    AnalyzeError, Analyzed, OtherGrounds, WrittenArgument, analyze_among, bare_land, ground_raster,
    needed_posts,
};
use sandtable_query::analysis_bands::OutcomeWindows;
use sandtable_query::dataset::Dataset;
use sandtable_scene::land::land_of;
use sandtable_sheet::analysis_map::analysis_map;
use sandtable_terrain::stop_flag::StopFlag;

/// The page of the kinds.
pub const PATH: &str = "/analyses";

/// What the name of a kind follows in its address.
pub const QUERY_PATH: &str = "/v1/analyze/";

/// The size of a post of a raster.
const POST_BYTES: usize = size_of::<f32>();

/// What `/analyses` answers.
#[derive(Serialize)]
struct AnalysisList {
    results: Value,
    status: &'static str,
}

pub fn page(_: &Service) -> Response {
    Json(AnalysisList { results: catalog_json(), status: OK }).into_response()
}

pub struct AnalysisQuery {
    kind: &'static AnalysisKind,
    arguments: Vec<WrittenArgument>,
    ground: GroundQuery,
    format: AnswerFormat,
}

/// What is answered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum AnswerFormat {
    GeoTiff,
    Features(FeatureFormat),
    Json,
    /// A map, as a picture.
    Map,
}

/// Figures, tables and notes.
#[derive(Serialize)]
struct AnalysisAnswer<'a> {
    #[serde(flatten)]
    outcome: Value,
    dataset: &'a str,
    status: &'static str,
}

impl Query for AnalysisQuery {
    fn read(service: &Service, name: &str, parameters: &Parameters) -> Result<Self, HttpError> {
        let kind = kind(name).ok_or_else(|| {
            let names: Vec<&str> = kinds().map(|kind| kind.name).collect();
            let help = remedy(name, &names, "there are");
            HttpError::unknown(format!("there is no analysis {}; {help}", quoted(name)))
        })?;
        let of_kind = kind.all_parameters().map(|parameter| parameter.name);
        let known: Vec<&str> = of_kind.chain(["dataset", "crs", "format"]).collect();
        let ground = GroundQuery::read(service, parameters, &known)?;
        let most = service.limits.max_points as usize;
        let argument = |parameter: &AnalysisParameter| {
            let text = parameters.get(parameter.name)?;
            let text = written(parameter, text, &ground.coordinates, most);
            Some(text.map(|text| WrittenArgument { name: parameter.name.to_owned(), text }))
        };
        let arguments = kind.all_parameters().filter_map(argument).collect::<Result<_, _>>()?;
        Ok(Self { kind, arguments, ground, format: format(kind, parameters)? })
    }

    fn weight(&self, _: &Service) -> QueryWeight {
        match self.format {
            AnswerFormat::Map => QueryWeight::Picture,
            _ => QueryWeight::Expensive,
        }
    }

    fn most_bytes(&self, service: &Service) -> usize {
        let source = self.ground.served(service).dataset.header();
        let posts = 2 * source.width as usize * source.height as usize;
        match self.format {
            AnswerFormat::Json => 0,
            // The sheet of a scene may be large: all that a client may have.
            AnswerFormat::Map => usize::MAX,
            _ => posts.min(service.limits.max_posts as usize) * POST_BYTES,
        }
    }

    fn answer(self, service: &Service, stop: &StopFlag) -> Result<Response, HttpError> {
        let served = self.ground.served(service);
        let analyzed = self.analyzed(service, stop)?;
        let Analyzed { ground, crs, outcome } = &analyzed;
        let bytes = match self.format {
            AnswerFormat::Json => {
                let outcome = outcome_json(self.kind, &self.arguments, outcome);
                return Ok(
                    Json(AnalysisAnswer { outcome, dataset: &served.name, status: OK }).into_response()
                );
            }
            AnswerFormat::GeoTiff => {
                let values = outcome.raster.as_ref();
                let values = values.unwrap_or_else(|| panic!("{} gives a raster", self.kind.name));
                // By the writer of the command, which computes a large raster while it is written.
                let writer = DemFormat::to_write("tif").and_then(|format| format.windows_writer);
                let writer = writer.expect("a GeoTIFF is written in windows");
                let (mut windows, mut out) =
                    (OutcomeWindows::new(values, ground, crs), Cursor::new(Vec::new()));
                let written = writer(&mut windows, &mut out);
                written.map_err(|error| HttpError::wrong(error_text(&error)))?;
                out.into_inner()
            }
            AnswerFormat::Map => self.map(service, &analyzed, stop)?,
            // Nothing found is an answer, too.
            AnswerFormat::Features(FeatureFormat::GeoJson) if is_empty(outcome) => {
                outcome_geojson(outcome, self.kind.title).into_bytes()
            }
            AnswerFormat::Features(format) => {
                let frame = OutcomeFrame { ground, crs };
                let bytes = outcome_bytes(outcome, frame, format, self.kind.title);
                bytes.map_err(|error| HttpError::wrong(error_text(&error)))?
            }
        };
        Ok(([(CONTENT_TYPE, self.format.media_type())], bytes).into_response())
    }
}

fn is_empty(outcome: &Outcome) -> bool {
    outcome.features.is_empty() && outcome.raster.as_ref().is_none_or(|raster| raster.classes.is_empty())
}

impl From<AnalyzeError> for HttpError {
    fn from(error: AnalyzeError) -> Self {
        match error {
            AnalyzeError::Analysis(AnalysisError::Stopped) => Self::stopped(),
            AnalyzeError::Analysis(AnalysisError::Memory(refused)) => Self::busy(10, refused.to_string()),
            error => Self::wrong(error_text(&error)),
        }
    }
}

impl AnalysisQuery {
    fn analyzed(&self, service: &Service, stop: &StopFlag) -> Result<Analyzed, HttpError> {
        let served = self.ground.served(service);
        let (analysis, crs) = ((self.kind, &self.arguments[..]), &self.ground.coordinates.crs);
        // The size of the land is known before it is read.
        let needed = needed_posts(&served.dataset, analysis, crs)?;
        let (posts, most) = (needed.width() as u64 * needed.height() as u64, service.limits.max_posts);
        if posts > u64::from(most) {
            return Err(HttpError::wrong(format!(
                "the analysis needs {posts} posts, {most} are the most of one request; state a smaller extent"
            )));
        }
        let scene = if self.kind.layers.is_empty() { None } else { served.scene()? };
        let of_scene = scene.map(|scene| Dataset::from_scene(&served.name, scene));
        let dataset = of_scene.as_ref().unwrap_or(&served.dataset);
        let land = match scene {
            Some(scene) => land_of(scene, self.kind.layers),
            None => bare_land(dataset, analysis, crs)?,
        };
        let find = |name: &str| service.datasets.named(name);
        Ok(analyze_among((dataset, OtherGrounds::Named(&find)), land, analysis, crs, stop)?)
    }
}

impl AnalysisQuery {
    /// The bytes of the map that the command writes.
    fn map(&self, service: &Service, analyzed: &Analyzed, stop: &StopFlag) -> Result<Vec<u8>, HttpError> {
        let go_on = || if stop.is_stopped() { Err(HttpError::stopped()) } else { Ok(()) };
        go_on()?;
        let (served, Analyzed { ground, crs, outcome }) = (self.ground.served(service), analyzed);
        let stated = self.arguments.iter().map(|argument| (&*argument.name, &*argument.text));
        let map = served.map(served.map_texts(self.kind, stated), || ground_raster(ground, crs))?;
        go_on()?;
        let picture = analysis_map(map, self.kind, (ground, outcome), &|_| ());
        let picture = picture.map_err(|error| HttpError::wrong(error_text(&error)))?;
        go_on()?;
        Ok(encode_png(&picture.pixels))
    }
}

/// The format of a request; by default the raster of a kind that gives one alone, else its features or its table.
fn format(kind: &AnalysisKind, parameters: &Parameters) -> Result<AnswerFormat, HttpError> {
    const FORMATS: [AnswerFormat; 5] = [
        AnswerFormat::GeoTiff,
        AnswerFormat::Features(FeatureFormat::GeoJson),
        AnswerFormat::Features(FeatureFormat::GeoPackage),
        AnswerFormat::Json,
        AnswerFormat::Map,
    ];
    let stated = parameters.word("format", ANALYSIS_FORMATS.into_iter().zip(FORMATS))?;
    let gives_raster = matches!(kind.yields, AnalysisYield::Raster | AnalysisYield::Both);
    match (stated, kind.yields) {
        (Some(AnswerFormat::GeoTiff), _) if !gives_raster => Err(HttpError::wrong(format!(
            "{} gives no raster; ask for format=geojson or format=json",
            kind.name
        ))),
        (Some(AnswerFormat::Features(_)), AnalysisYield::Table) => {
            Err(HttpError::wrong(format!("{} gives no features; ask for format=json", kind.name)))
        }
        (Some(stated), _) => Ok(stated),
        (None, AnalysisYield::Raster) => Ok(AnswerFormat::GeoTiff),
        (None, AnalysisYield::Features | AnalysisYield::Both) => {
            Ok(AnswerFormat::Features(FeatureFormat::GeoJson))
        }
        (None, AnalysisYield::Table) => Ok(AnswerFormat::Json),
    }
}

impl AnswerFormat {
    fn media_type(self) -> &'static str {
        match self {
            Self::GeoTiff => "image/tiff",
            Self::Features(FeatureFormat::GeoPackage) => "application/geopackage+sqlite3",
            Self::Features(_) => "application/geo+json",
            Self::Json => "application/json",
            Self::Map => "image/png",
        }
    }
}

/// An argument as the command has it: positions with semicolons between, each x first.
fn written(
    parameter: &AnalysisParameter,
    text: &str,
    coordinates: &Coordinates,
    most: usize,
) -> Result<String, HttpError> {
    let name = parameter.name;
    if !parameter.form.is_positions() {
        return Ok(text.to_owned());
    }
    let positions: Vec<&str> =
        text.split(['|', ';']).map(str::trim).filter(|position| !position.is_empty()).collect();
    if positions.len() > most {
        let count = positions.len();
        return Err(HttpError::wrong(format!(
            "{name} has {count} positions, where {most} are the most of one request"
        )));
    }
    let numbers: Vec<&str> = text.split(',').map(str::trim).collect();
    if let (ParameterForm::Extent, [first, second, third, fourth]) = (parameter.form, &numbers[..]) {
        let corners = [format!("{first},{second}"), format!("{third},{fourth}")];
        let corners = corners.map(|corner| position(name, &corner, coordinates));
        let [first, last] = corners;
        return Ok(format!("{},{}", first?, last?));
    }
    let positions: Result<Vec<String>, HttpError> =
        positions.iter().map(|text| position(name, text, coordinates)).collect();
    Ok(positions?.join(";"))
}

/// A position with x first where it is two numbers.
fn position(name: &str, text: &str, coordinates: &Coordinates) -> Result<String, HttpError> {
    coordinates.position(name, text)?;
    let numbers = text.split_once(',').map(|(first, second)| (first.trim(), second.trim()));
    Ok(match numbers {
        Some((first, second)) if first.parse::<f64>().is_ok() && second.parse::<f64>().is_ok() => {
            match coordinates.axes {
                AxisOrder::LatLng => format!("{second},{first}"),
                AxisOrder::Xy => format!("{first},{second}"),
            }
        }
        _ => text.to_owned(),
    })
}
