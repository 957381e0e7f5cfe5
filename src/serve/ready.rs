//! `/ready`: whether requests should be sent here, for a proxy that has several services to choose from.
//!
//! ```text
//! started ─► datasets open ─► their ground made, a height of each answered ─► ready ─► a signal ─► ending
//!           503                                                              200                503
//! ```

use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};

use axum::Json;
use axum::response::{IntoResponse, Response};
use serde::Serialize;

use crate::datasets::ServedDataset;
use crate::reply::{HttpError, OK};
use crate::service::Service;
use sandtable_base::message::chain::error_text;
use sandtable_query::dataset::QueryError;
use sandtable_terrain::query::{Interpolation, Surface};

/// Its path.
pub const PATH: &str = "/ready";

/// Seconds until a proxy should ask again.
const ASK_AGAIN_S: u16 = 1;

/// The readiness of the service.
#[derive(Debug, Default)]
pub struct Readiness {
    /// Whether each dataset has answered a height, or why one cannot.
    tried: OnceLock<Result<(), String>>,
    is_ending: AtomicBool,
}

impl Readiness {
    /// Asks each dataset for a height.
    pub fn try_all(&self, datasets: &[ServedDataset]) {
        let tried = datasets.iter().try_for_each(|served| {
            first_height(served).map_err(|error| format!("{}: {}", served.name, error_text(&error)))
        });
        let _ = self.tried.set(tried);
    }

    /// States that the service ends.
    pub fn end(&self) {
        self.is_ending.store(true, Ordering::Relaxed);
    }
}

/// The height in the middle of a dataset, which may hold none there.
fn first_height(served: &ServedDataset) -> Result<(), QueryError> {
    let (dataset, header) = (&served.dataset, served.dataset.header());
    let crs = header.crs.clone().unwrap_or_else(|| dataset.crs());
    dataset.heights(Surface::Source, Interpolation::Nearest, &crs, &[header.center()]).map(drop)
}

#[derive(Serialize)]
struct Ready {
    status: &'static str,
}

pub fn page(service: &Service) -> Response {
    let readiness = &service.readiness;
    let refusal = match readiness.tried.get() {
        _ if readiness.is_ending.load(Ordering::Relaxed) => "the service ends; ask another",
        None => "the datasets are being prepared; ask again",
        Some(Err(reason)) => reason,
        Some(Ok(())) => return Json(Ready { status: OK }).into_response(),
    };
    HttpError::busy(ASK_AGAIN_S, refusal).into_response()
}
