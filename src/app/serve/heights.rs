//! `/v1/DATASET`: heights at locations, compatible with the Open Topo Data API.
//!
//! What that API documents is answered as it documents it: `locations` as `lat,lng|lat,lng` or as an encoded polyline,
//! `interpolation`, `samples` along the path of the locations, `nodata_value`, `format=json|geojson`, several datasets
//! `a,b` of which the first with a height answers. Parameters that it does not have are ignored, as it does. Beyond it:
//!
//! | | |
//! |---|---|
//! | `status` per result | `Ok`, `NoData` or `Outside`: a hole is not the edge of the model |
//! | `surface` | `source` (as read), `ground` (after earthworks, in meters), `scene` (decks on top); without it, of a file the source and of a scene the ground |
//! | `interpolation` | also `planar` and `distance-weighted`; `cubic` is refused |
//! | `crs` | coordinates in another system; see [`places`](crate::app::serve::places) |
//!
//! Heights come from [`Dataset::heights`](crate::app::dataset::Dataset::heights), as they do for every command.

use glam::DVec2;

use crate::app::failure::CliError;
use crate::app::serve::datasets::{GroundState, Served};
use crate::app::serve::places::Coordinates;
use crate::app::serve::question::{QueryRequest, Question, Service, Weight};
use crate::app::serve::reply::{BodyFormat, HttpError, Reply, quoted};
use crate::app::serve::{json, path};
use crate::terrain::query::{Answer, Interpolation, Surface};

/// Points that are answered on the thread that read the request: some tens of microseconds. More go to a thread that
/// may take its time, at the price of two switches between threads, about as long.
const LIGHT_POINTS: usize = 1000;

/// Bytes of a result in JSON, about: what the body is made room for.
const RESULT_BYTES: usize = 128;

/// Heights at locations.
pub struct Heights {
    datasets: Vec<usize>,
    coordinates: Coordinates,
    places: Vec<DVec2>,
    /// Each dataset's usual one where it is `None`.
    surface: Option<Surface>,
    interpolation: Interpolation,
    missing: Missing,
    form: BodyFormat,
}

/// What stands for a height where there is none.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Missing {
    Null,
    /// `NaN`, which JavaScript and Python read and JSON does not know.
    Nan,
    Number(f64),
}

impl Question for Heights {
    fn read(service: &Service, asked: &QueryRequest<'_>) -> Result<Self, HttpError> {
        let params = &asked.params;
        let datasets = service.datasets.find_all(asked.dataset)?;
        let most = service.limits.points();
        let surface = params.choice("surface", &SURFACES)?;
        let interpolation = interpolation(params.get("interpolation"))?;
        let form = params.choice("format", &FORMS)?.unwrap_or(BodyFormat::Json);
        let missing = missing(params.get("nodata_value"))?;
        let coordinates = coordinates(service, asked, &datasets)?;
        if form == BodyFormat::GeoJson && coordinates.crs != service.wgs84 {
            return Err(HttpError::wrong(
                "format=geojson holds WGS 84 only (RFC 7946); leave crs out, or ask for format=json",
            ));
        }
        let text = params.required("locations", "46.2,-122.19|46.21,-122.2")?;
        let vertices = coordinates.places(text, most)?;
        let places = match params.get("samples") {
            None => vertices,
            Some(count) => sampled(&coordinates, &vertices, count, most)?,
        };
        Ok(Self { datasets, coordinates, places, surface, interpolation, missing, form })
    }

    fn weight(&self, service: &Service) -> Weight {
        let ready = self.datasets.iter().map(|&index| service.datasets.at(index)).all(|served| {
            self.surface_of(served) == Surface::Source || served.ground() != GroundState::Awaited
        });
        if ready && self.places.len() <= LIGHT_POINTS { Weight::Light } else { Weight::Heavy }
    }

    fn answer(self, service: &Service) -> Result<Reply, HttpError> {
        let results = self.results(service)?;
        let mut body = Vec::with_capacity(64 + results.len() * RESULT_BYTES);
        match self.form {
            BodyFormat::GeoJson => self.write_geojson(service, &results, &mut body),
            _ => self.write_json(service, &results, &mut body),
        }
        Ok(Reply { form: self.form, body })
    }
}

const SURFACES: [(&str, Surface); 3] =
    [("source", Surface::Source), ("ground", Surface::Ground), ("scene", Surface::Scene)];

const FORMS: [(&str, BodyFormat); 2] = [("json", BodyFormat::Json), ("geojson", BodyFormat::GeoJson)];

fn interpolation(text: Option<&str>) -> Result<Interpolation, HttpError> {
    Ok(match text {
        None => Interpolation::default(),
        Some("nearest") => Interpolation::Nearest,
        Some("bilinear") => Interpolation::Bilinear,
        Some("planar") => Interpolation::Planar,
        Some("distance-weighted") => Interpolation::DistanceWeighted4,
        Some("cubic") => {
            return Err(HttpError::wrong(
                "interpolation=cubic is not offered: it makes heights above and below all posts around; \
                 there are nearest, bilinear, planar and distance-weighted",
            ));
        }
        Some(other) => {
            return Err(HttpError::wrong(format!(
                "interpolation is {}; there are nearest, bilinear, planar and distance-weighted",
                quoted(other)
            )));
        }
    })
}

fn missing(text: Option<&str>) -> Result<Missing, HttpError> {
    match text {
        None | Some("null") => Ok(Missing::Null),
        Some(nan) if nan.eq_ignore_ascii_case("nan") => Ok(Missing::Nan),
        Some(text) => match text.trim().parse::<f64>() {
            Ok(value) if value.is_finite() => Ok(Missing::Number(value)),
            _ => Err(HttpError::wrong(format!(
                "nodata_value is {}; write null, nan or a number such as -9999",
                quoted(text)
            ))),
        },
    }
}

/// The coordinates of the request, for which there must be a way to every dataset.
fn coordinates(
    service: &Service,
    asked: &QueryRequest<'_>,
    datasets: &[usize],
) -> Result<Coordinates, HttpError> {
    let own = |index: usize| service.datasets.at(index).data.crs();
    let mut first = None;
    for &index in datasets {
        let coordinates = Coordinates::read(&asked.params, &own(index), &service.wgs84)?;
        let known = first.get_or_insert_with(|| coordinates.clone());
        if known.crs != coordinates.crs {
            return Err(HttpError::wrong(
                "crs=native needs datasets of one and the same system; write EPSG:n",
            ));
        }
    }
    first.ok_or_else(|| HttpError::unknown("no dataset is named"))
}

fn sampled(
    coordinates: &Coordinates,
    vertices: &[DVec2],
    count: &str,
    most: usize,
) -> Result<Vec<DVec2>, HttpError> {
    let wrong =
        |found: String| HttpError::wrong(format!("samples is {found}; write a number from 2 to {most}"));
    let parsed = count.trim().parse::<usize>().ok().filter(|count| (2..=most).contains(count));
    let count = parsed.ok_or_else(|| wrong(quoted(count)))?;
    if vertices.len() < 2 {
        return Err(HttpError::wrong("samples lie along a path, which needs two locations or more"));
    }
    Ok(path::samples(coordinates, vertices, count))
}

/// What was found at a place.
#[derive(Clone, Copy)]
struct FoundHeights {
    answer: Answer,
    /// The index of the dataset that said so.
    dataset: usize,
}

/// The more an answer says, the higher.
fn rank(answer: Answer) -> u8 {
    match answer {
        Answer::Outside => 0,
        Answer::NoData => 1,
        Answer::Height(_) => 2,
    }
}

impl Heights {
    fn surface_of(&self, served: &Served) -> Surface {
        self.surface.unwrap_or_else(|| served.data.usual_surface())
    }

    /// For each place the first dataset's height; where none has one, the first dataset that holds the place; where
    /// none does, the first.
    fn results(&self, service: &Service) -> Result<Vec<FoundHeights>, HttpError> {
        let mut answers = vec![Answer::Outside; self.places.len()];
        let first = self.datasets[0];
        self.ask(service, first, &self.places, &mut answers)?;
        let mut results: Vec<FoundHeights> =
            answers.into_iter().map(|answer| FoundHeights { answer, dataset: first }).collect();
        for &next in &self.datasets[1..] {
            let open: Vec<usize> =
                (0..results.len()).filter(|&index| results[index].answer.height_m().is_none()).collect();
            let places: Vec<DVec2> = open.iter().map(|&index| self.places[index]).collect();
            let mut answers = vec![Answer::Outside; open.len()];
            self.ask(service, next, &places, &mut answers)?;
            for (index, answer) in open.into_iter().zip(answers) {
                if rank(answer) > rank(results[index].answer) {
                    results[index] = FoundHeights { answer, dataset: next };
                }
            }
        }
        Ok(results)
    }

    fn ask(
        &self,
        service: &Service,
        index: usize,
        places: &[DVec2],
        answers: &mut [Answer],
    ) -> Result<(), HttpError> {
        let served = service.datasets.at(index);
        let surface = self.surface_of(served);
        if surface != Surface::Source {
            // Waits for the ground, and says why there is none.
            served.epoch()?;
        }
        served
            .data
            .heights(surface, self.interpolation, &self.coordinates.crs, places, answers)
            .map_err(|(CliError::Input(reason) | CliError::Usage(reason))| HttpError::wrong(reason))
    }

    fn write_json(&self, service: &Service, results: &[FoundHeights], out: &mut Vec<u8>) {
        json::raw(out, "{\"results\":[");
        for (index, (&FoundHeights { answer, dataset }, &place)) in
            results.iter().zip(&self.places).enumerate()
        {
            json::raw(out, if index == 0 { "{\"elevation\":" } else { ",{\"elevation\":" });
            match (answer.height_m(), self.missing) {
                (Some(height), _) => json::number(out, height),
                (None, Missing::Null) => json::raw(out, "null"),
                (None, Missing::Nan) => json::raw(out, "NaN"),
                (None, Missing::Number(value)) => json::number(out, value),
            }
            json::raw(out, ",\"location\":");
            self.coordinates.write(out, place);
            self.write_origin(service, answer, dataset, out);
            json::raw(out, "}");
        }
        json::raw(out, "],\"status\":\"OK\"}");
    }

    /// A position has no third coordinate where there is no height and no number is given to stand for it: GeoJSON
    /// knows neither null nor NaN there.
    fn write_geojson(&self, service: &Service, results: &[FoundHeights], out: &mut Vec<u8>) {
        json::raw(out, "{\"type\":\"FeatureCollection\",\"features\":[");
        for (index, (&FoundHeights { answer, dataset }, &place)) in
            results.iter().zip(&self.places).enumerate()
        {
            let comma = if index == 0 { "" } else { "," };
            json::raw(out, comma);
            json::raw(out, "{\"type\":\"Feature\",\"geometry\":{\"type\":\"Point\",\"coordinates\":[");
            json::number(out, place.x);
            json::raw(out, ",");
            json::number(out, place.y);
            let stands_for = match self.missing {
                Missing::Number(value) => Some(value),
                Missing::Null | Missing::Nan => None,
            };
            if let Some(height) = answer.height_m().or(stands_for) {
                json::raw(out, ",");
                json::number(out, height);
            }
            json::raw(out, "]},\"properties\":{\"status\":\"");
            json::raw(out, answer.status());
            json::raw(out, "\",\"dataset\":");
            out.extend_from_slice(&service.datasets.at(dataset).name_json);
            json::raw(out, "}}");
        }
        json::raw(out, "]}");
    }

    fn write_origin(&self, service: &Service, answer: Answer, dataset: usize, out: &mut Vec<u8>) {
        json::raw(out, ",\"dataset\":");
        out.extend_from_slice(&service.datasets.at(dataset).name_json);
        json::raw(out, ",\"status\":\"");
        json::raw(out, answer.status());
        json::raw(out, "\"");
    }
}
