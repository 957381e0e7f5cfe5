//! `/v1/DATASET`: heights at locations, compatible with the Open Topo Data API.
//!
//! All documented parameters of that API are supported: `locations` as `lat,lng|lat,lng` or as an encoded polyline,
//! `interpolation`, `samples` along the path of the locations, `nodata_value`, `format=json|geojson`, and several
//! datasets `a,b`, of which the first with a height is used. Unknown parameters are ignored, as in that API.
//! Extensions:
//!
//! | | |
//! |---|---|
//! | `status` per result | `Ok`, `NoData` (a hole in the model) or `Outside` (beyond its edge) |
//! | `surface` | `source` (as read), `ground` (after earthworks), `scene` (decks on top); the default is the source of a file and the ground of a scene |
//! | `interpolation` | also `planar` and `distance-weighted`; `cubic` is Keys' of 1981 with a = −1/2, as in [`sandtable_terrain::query`] |
//! | `above` | heights above the WGS 84 `ellipsoid` or the `egm96` geoid, where the dataset says what it counts from |
//! | `vertical_datum` per result | what the height is counted from, where that is known |
//! | `crs` | coordinates in another system; see [`coordinates`](crate::coordinates) |
//! | `positions` | each position also as text, such as a grid reference: `position` of a location, of the properties in GeoJSON |

use std::io;

use axum::http::header::CONTENT_TYPE;
use axum::response::{IntoResponse, Response};
use glam::DVec2;
use serde::Serialize;
use serde_json::Serializer;
use serde_json::ser::Formatter;

use crate::coordinates::{Coordinates, Location};
use crate::datasets::ServedDataset;
use crate::parameters::Parameters;
use crate::query::{Query, QueryWeight};
use crate::reply::{HttpError, JsonArray, OK, quoted};
use crate::samples::along_path;
use crate::service::Service;
use sandtable_base::message::chain::error_text;
use sandtable_query::heights_above::bring_heights;
use sandtable_raster::answer::Answer;
use sandtable_raster::height_datum::HeightDatum;
use sandtable_terrain::query::{Interpolation, Surface};
use sandtable_terrain::stop_flag::StopFlag;

/// The most points that the request's own thread queries, in some tens of microseconds. Moving a query to another
/// thread takes two context switches, about as long.
const LIGHT_POINTS: usize = 1000;

/// The approximate size of a result in JSON.
const RESULT_BYTES: usize = 176;

pub struct HeightsQuery {
    datasets: Vec<usize>,
    coordinates: Coordinates,
    positions: Vec<DVec2>,
    /// The default surface of each dataset where `None`.
    surface: Option<Surface>,
    interpolation: Interpolation,
    /// What heights are brought to; what each dataset counts from where `None`.
    above: Option<HeightDatum>,
    missing: MissingHeight,
    format: HeightsFormat,
}

/// The elevation of a result that has none.
#[derive(Clone, Copy, Debug, PartialEq)]
enum MissingHeight {
    Null,
    /// `NaN`, which JavaScript and Python read although JSON does not have it.
    Nan,
    Number(f64),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum HeightsFormat {
    Json,
    /// RFC 7946.
    GeoJson,
}

impl Query for HeightsQuery {
    fn read(service: &Service, datasets: &str, parameters: &Parameters) -> Result<Self, HttpError> {
        let datasets = service.datasets.find_all(datasets)?;
        let most = service.limits.max_points as usize;
        let surface = parameters.choice("surface")?;
        let interpolation = interpolation(parameters)?;
        let above = parameters.choice("above")?;
        let formats = [("json", HeightsFormat::Json), ("geojson", HeightsFormat::GeoJson)];
        let format = parameters.word("format", formats)?.unwrap_or(HeightsFormat::Json);
        let missing = missing(parameters)?;
        let coordinates = coordinates(service, parameters, &datasets)?;
        if format == HeightsFormat::GeoJson && coordinates.crs != service.wgs84 {
            return Err(HttpError::wrong(
                "format=geojson holds WGS 84 only (RFC 7946); leave crs out, or ask for format=json",
            ));
        }
        let text = parameters.required("locations", "46.2,-122.19|46.21,-122.2")?;
        let vertices = coordinates.positions(text, most)?;
        let positions = match parameters.get("samples") {
            None => vertices,
            Some(count) => samples(&coordinates, &vertices, count, most)?,
        };
        Ok(Self { datasets, coordinates, positions, surface, interpolation, above, missing, format })
    }

    fn weight(&self, service: &Service) -> QueryWeight {
        let is_made = self.datasets.iter().map(|&index| service.datasets.at(index)).all(|served| {
            let is_prepared =
                self.surface_of(served) == Surface::Source || served.dataset.prepared_ground().is_some();
            is_prepared && !served.dataset.reads_windows()
        });
        if is_made
            && self.above.is_none()
            && self.coordinates.form.is_none()
            && self.positions.len() <= LIGHT_POINTS
        {
            QueryWeight::Light
        } else {
            QueryWeight::Heavy
        }
    }

    fn most_bytes(&self, _: &Service) -> usize {
        self.positions.len() * RESULT_BYTES + self.coordinates.form_bytes(self.positions.len())
    }

    fn answer(self, service: &Service, _: &StopFlag) -> Result<Response, HttpError> {
        let heights = self.heights(service)?;
        let results = heights.iter().zip(&self.positions);
        let dataset = |found: &FoundHeight| service.datasets.at(found.dataset).name.as_str();
        let datums: Vec<Option<String>> =
            self.datasets.iter().map(|&index| self.vertical_datum(service.datasets.at(index))).collect();
        let datum = |found: &FoundHeight| {
            let place = self.datasets.iter().position(|&index| index == found.dataset)?;
            datums[place].as_deref()
        };
        Ok(match self.format {
            HeightsFormat::Json => self.serialized(
                "application/json",
                &HeightResults {
                    results: JsonArray(results.map(|(found, &at)| HeightResult {
                        elevation: self.elevation(found.answer),
                        location: self.coordinates.location(at),
                        dataset: dataset(found),
                        vertical_datum: datum(found),
                        status: found.answer.status(),
                    })),
                    status: OK,
                },
            ),
            HeightsFormat::GeoJson => self.serialized(
                "application/geo+json",
                &FeatureCollection {
                    features: JsonArray(results.map(|(found, &at)| HeightFeature {
                        geometry: PointGeometry { coordinates: self.geojson_position(found.answer, at) },
                        properties: FeatureProperties {
                            status: found.answer.status(),
                            dataset: dataset(found),
                            vertical_datum: datum(found),
                            position: self.coordinates.written(&self.coordinates.crs, at),
                        },
                    })),
                },
            ),
        })
    }
}

fn interpolation(parameters: &Parameters) -> Result<Interpolation, HttpError> {
    Ok(parameters.choice("interpolation")?.unwrap_or_default())
}

fn missing(parameters: &Parameters) -> Result<MissingHeight, HttpError> {
    match parameters.get("nodata_value") {
        None | Some("null") => Ok(MissingHeight::Null),
        Some(nan) if nan.eq_ignore_ascii_case("nan") => Ok(MissingHeight::Nan),
        Some(text) => match text.trim().parse::<f64>() {
            Ok(value) if value.is_finite() => Ok(MissingHeight::Number(value)),
            _ => Err(HttpError::wrong(format!(
                "nodata_value is {}; write null, nan or a number such as -9999",
                quoted(text)
            ))),
        },
    }
}

/// The coordinates of the request, which must have a transform to every dataset.
fn coordinates(
    service: &Service,
    parameters: &Parameters,
    datasets: &[usize],
) -> Result<Coordinates, HttpError> {
    let read = |&index: &usize| {
        let native = service.datasets.at(index).dataset.crs();
        Coordinates::read(parameters, &native, &service.wgs84)
    };
    let all = datasets.iter().map(read).collect::<Result<Vec<_>, _>>()?;
    if all.iter().any(|coordinates| coordinates.crs != all[0].crs) {
        return Err(HttpError::wrong("crs=native needs datasets of one and the same system; write EPSG:n"));
    }
    all.into_iter().next().ok_or_else(|| HttpError::unknown("no dataset is named"))
}

fn samples(
    coordinates: &Coordinates,
    vertices: &[DVec2],
    count: &str,
    most: usize,
) -> Result<Vec<DVec2>, HttpError> {
    let parsed = count.trim().parse::<usize>().ok().filter(|count| (2..=most).contains(count));
    let count = parsed.ok_or_else(|| {
        HttpError::wrong(format!("samples is {}; write a number from 2 to {most}", quoted(count)))
    })?;
    if vertices.len() < 2 {
        return Err(HttpError::wrong("samples lie along a path, which needs two locations or more"));
    }
    Ok(along_path(coordinates.axes, vertices, count))
}

/// An answer, and the index of the dataset that gave it.
#[derive(Clone, Copy)]
pub struct FoundHeight {
    pub answer: Answer,
    dataset: usize,
}

/// Orders answers: a height above no data, no data above outside.
fn rank(answer: Answer) -> u8 {
    match answer {
        Answer::Outside => 0,
        Answer::NoData => 1,
        Answer::Height(_) => 2,
    }
}

impl HeightsQuery {
    /// The query for heights as the datasets have them, between samples by the default interpolation.
    pub fn plain(datasets: Vec<usize>, coordinates: Coordinates, positions: Vec<DVec2>) -> Self {
        Self {
            datasets,
            coordinates,
            positions,
            surface: None,
            interpolation: Interpolation::default(),
            above: None,
            missing: MissingHeight::Null,
            format: HeightsFormat::Json,
        }
    }

    /// The positions that it is about.
    pub fn positions(&self) -> &[DVec2] {
        &self.positions
    }

    fn surface_of(&self, served: &ServedDataset) -> Surface {
        self.surface.unwrap_or_else(|| served.dataset.default_surface())
    }

    /// For each position the height of the first dataset that has one; without any, `NoData` of the first dataset that
    /// covers the position; without any, `Outside` of the first dataset.
    pub fn heights(&self, service: &Service) -> Result<Vec<FoundHeight>, HttpError> {
        let first = self.datasets[0];
        let answers = self.answers(service, first, &self.positions)?;
        let mut heights: Vec<FoundHeight> =
            answers.into_iter().map(|answer| FoundHeight { answer, dataset: first }).collect();
        for &dataset in &self.datasets[1..] {
            let open: Vec<usize> =
                (0..heights.len()).filter(|&index| heights[index].answer.height_m().is_none()).collect();
            let positions: Vec<DVec2> = open.iter().map(|&index| self.positions[index]).collect();
            for (index, answer) in open.into_iter().zip(self.answers(service, dataset, &positions)?) {
                if rank(answer) > rank(heights[index].answer) {
                    heights[index] = FoundHeight { answer, dataset };
                }
            }
        }
        Ok(heights)
    }

    fn answers(&self, service: &Service, index: usize, at: &[DVec2]) -> Result<Vec<Answer>, HttpError> {
        let served = service.datasets.at(index);
        let surface = self.surface_of(served);
        if surface != Surface::Source {
            // Waits for the ground, and fails where it cannot be made.
            served.prepare_ground()?;
        }
        let crs = &self.coordinates.crs;
        let mut answers = served.dataset.heights(surface, self.interpolation, crs, at)?;
        if let Some(above) = self.above {
            let own = served.dataset.header().vertical_datum.clone();
            let brought = bring_heights(&mut answers, (own.as_deref(), above), (crs, at), &service.geoid);
            brought.map_err(|error| HttpError::wrong(format!("{}: {}", served.name, error_text(&error))))?;
        }
        Ok(answers)
    }

    /// What the heights of a dataset are counted from in the answer, where that is known.
    fn vertical_datum(&self, served: &ServedDataset) -> Option<String> {
        let brought = self.above.map(|above| above.name().to_owned());
        brought.or_else(|| served.dataset.header().vertical_datum.clone())
    }

    fn elevation(&self, answer: Answer) -> Option<f64> {
        answer.height_m().or(match self.missing {
            MissingHeight::Number(value) => Some(value),
            MissingHeight::Null | MissingHeight::Nan => None,
        })
    }

    /// A position without a height has two coordinates: GeoJSON has neither null nor NaN there.
    fn geojson_position(&self, answer: Answer, DVec2 { x, y }: DVec2) -> Vec<f64> {
        [x, y].into_iter().chain(self.elevation(answer)).collect()
    }

    fn serialized(&self, content_type: &'static str, body: &impl Serialize) -> Response {
        let mut bytes = Vec::with_capacity(64 + self.positions.len() * RESULT_BYTES);
        let nulls =
            HeightsFormatter { null: if self.missing == MissingHeight::Nan { b"NaN" } else { b"null" } };
        body.serialize(&mut Serializer::with_formatter(&mut bytes, nulls))
            .expect("memory takes every byte, and every key is a string");
        ([(CONTENT_TYPE, content_type)], bytes).into_response()
    }
}

/// Compact JSON with another word for null. Only elevations are ever null.
struct HeightsFormatter {
    null: &'static [u8],
}

impl Formatter for HeightsFormatter {
    fn write_null<W: io::Write + ?Sized>(&mut self, out: &mut W) -> io::Result<()> {
        out.write_all(self.null)
    }
}

#[derive(Serialize)]
struct HeightResults<R> {
    results: R,
    status: &'static str,
}

#[derive(Serialize)]
struct HeightResult<'a> {
    elevation: Option<f64>,
    location: Location,
    dataset: &'a str,
    #[serde(skip_serializing_if = "Option::is_none")]
    vertical_datum: Option<&'a str>,
    status: &'static str,
}

#[derive(Serialize)]
#[serde(tag = "type")]
struct FeatureCollection<F> {
    features: F,
}

#[derive(Serialize)]
#[serde(tag = "type", rename = "Feature")]
struct HeightFeature<'a> {
    geometry: PointGeometry,
    properties: FeatureProperties<'a>,
}

#[derive(Serialize)]
#[serde(tag = "type", rename = "Point")]
struct PointGeometry {
    coordinates: Vec<f64>,
}

#[derive(Serialize)]
struct FeatureProperties<'a> {
    status: &'static str,
    dataset: &'a str,
    #[serde(skip_serializing_if = "Option::is_none")]
    vertical_datum: Option<&'a str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    position: Option<String>,
}
