//! `/health`: the state of the service and its datasets.

use axum::Json;
use axum::response::{IntoResponse, Response};
use serde::Serialize;

use crate::message::chain::error_text;
use crate::serve::datasets::ServedDataset;
use crate::serve::query::Service;
use crate::serve::reply::OK;

#[derive(Serialize)]
struct Health<'a> {
    status: &'static str,
    version: &'static str,
    datasets: Vec<DatasetHealth<'a>>,
}

#[derive(Serialize)]
struct DatasetHealth<'a> {
    name: &'a str,
    crs: Option<String>,
    /// Of the raster as read, out to its outer edges, in `crs`.
    extent: HealthExtent,
    columns: u32,
    rows: u32,
    /// Whether the ground in meters is `ready`, `awaited`, or why there is none.
    ground: String,
}

#[derive(Serialize)]
struct HealthExtent {
    min_x: f64,
    min_y: f64,
    max_x: f64,
    max_y: f64,
}

pub fn page(service: &Service) -> Response {
    let datasets = service.datasets.all().iter().map(dataset_health).collect();
    Json(Health { status: OK, version: env!("CARGO_PKG_VERSION"), datasets }).into_response()
}

fn dataset_health(served: &ServedDataset) -> DatasetHealth<'_> {
    let source = served.dataset.source();
    let extent = source.extent();
    DatasetHealth {
        name: &served.name,
        crs: source.crs.as_ref().map(|crs| crs.name().to_owned()),
        extent: HealthExtent {
            min_x: extent.min.x,
            min_y: extent.min.y,
            max_x: extent.max.x,
            max_y: extent.max.y,
        },
        columns: source.width,
        rows: source.height,
        ground: match served.dataset.service_if_made() {
            None => "awaited".into(),
            Some(Ok(_)) => "ready".into(),
            Some(Err(error)) => format!("none: {}", error_text(&error)),
        },
    }
}
