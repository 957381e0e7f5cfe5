//! `/health`: the state of the service and its datasets.

use axum::Json;
use axum::response::{IntoResponse, Response};
use serde::Serialize;

use crate::datasets::{DatasetFacts, ServedDataset};
use crate::reply::OK;
use crate::service::Service;
use sandtable_base::message::chain::error_text;

/// Its path.
pub const PATH: &str = "/health";

#[derive(Serialize)]
struct Health<'a> {
    status: &'static str,
    version: &'static str,
    datasets: Vec<DatasetHealth<'a>>,
}

#[derive(Serialize)]
struct DatasetHealth<'a> {
    #[serde(flatten)]
    facts: DatasetFacts<'a>,
    /// Whether the ground in meters is `ready`, `awaited`, or why there is none.
    ground: String,
}

pub fn page(service: &Service) -> Response {
    let datasets = service.datasets.all().iter().map(dataset_health).collect();
    Json(Health { status: OK, version: env!("CARGO_PKG_VERSION"), datasets }).into_response()
}

fn dataset_health(served: &ServedDataset) -> DatasetHealth<'_> {
    DatasetHealth {
        facts: served.facts(),
        ground: match served.dataset.prepared_ground() {
            None => "awaited".into(),
            Some(Ok(())) => "ready".into(),
            Some(Err(error)) => format!("none: {}", error_text(&error)),
        },
    }
}
