//! `/api/v1/lookup`: heights at locations, compatible with the Open-Elevation API.
//!
//! A GET has `locations` as `lat,lng|lat,lng`, a POST a JSON object whose `locations` are objects of a `latitude` and a
//! `longitude`; either takes the other's form as well. Open-Elevation has no datasets: of all that are served and know
//! where they lie, the first with a height answers, between its samples by the default interpolation. Where none has one,
//! `elevation` is null and `error` says why. Other parameters are ignored, as in that API.

use axum::Json;
use axum::response::{IntoResponse, Response};
use serde::Serialize;

use crate::coordinates::{AxisOrder, Coordinates};
use crate::heights::{FoundHeight, HeightsQuery};
use crate::parameters::Parameters;
use crate::query::{Query, QueryWeight};
use crate::reply::HttpError;
use crate::service::Service;
use glam::DVec2;
use sandtable_query::dataset::check_datums;
use sandtable_raster::answer::Answer;
use sandtable_terrain::stop_flag::StopFlag;

pub struct LookupQuery(HeightsQuery);

#[derive(Serialize)]
struct LookupResults {
    results: Vec<LookupResult>,
}

#[derive(Serialize)]
struct LookupResult {
    latitude: f64,
    longitude: f64,
    elevation: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    error: Option<&'static str>,
}

impl Query for LookupQuery {
    fn read(service: &Service, _: &str, parameters: &Parameters) -> Result<Self, HttpError> {
        let coordinates = Coordinates { crs: service.wgs84.clone(), axes: AxisOrder::LatLng, form: None };
        let checks =
            service.datasets.all().iter().map(|served| check_datums(&coordinates.crs, &served.dataset.crs()));
        let checks: Vec<_> = checks.collect();
        let placed: Vec<usize> = (0..checks.len()).filter(|&index| checks[index].is_ok()).collect();
        if let (true, Some(Err(error))) = (placed.is_empty(), checks.first()) {
            return Err(HttpError::wrong(format!(
                "no dataset knows latitudes and longitudes: {error}; ask {} with crs=native",
                service.prefix.before("/v1/DATASET")
            )));
        }
        let text = parameters.required("locations", "46.2,-122.19|46.21,-122.2")?;
        let positions = coordinates.positions(text, service.limits.max_points as usize)?;
        Ok(Self(HeightsQuery::plain(placed, coordinates, positions)))
    }

    fn weight(&self, service: &Service) -> QueryWeight {
        self.0.weight(service)
    }

    fn most_bytes(&self, service: &Service) -> usize {
        self.0.most_bytes(service)
    }

    fn answer(self, service: &Service, _: &StopFlag) -> Result<Response, HttpError> {
        let heights = self.0.heights(service)?;
        let results = heights.iter().zip(self.0.positions());
        let results = results.map(|(found, &at)| LookupResult::new(found, at)).collect();
        Ok(Json(LookupResults { results }).into_response())
    }
}

impl LookupResult {
    fn new(found: &FoundHeight, at: DVec2) -> Self {
        let error = match found.answer {
            Answer::Height(_) => None,
            Answer::NoData => Some("no data here"),
            Answer::Outside => Some("outside the elevation that is served"),
        };
        Self { latitude: at.y, longitude: at.x, elevation: found.answer.height_m(), error }
    }
}
