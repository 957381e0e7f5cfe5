//! Dispatches requests: from address to query, and from query to thread.
//!
//! ```text
//! request ─► parameters (query, body) ─► permit ─► read ─► light? ─► answer ─► response
//!              │ 414 413 415 408 400 503    │ 503    │ 400   └ no ─► another thread ────┘ 503 in the end
//! ```
//!
//! A request takes its permit when all of it is there: clients that send slowly keep nobody from being answered.
//!
//! A query of a few points takes less time than moving it to another thread, so the thread that parsed it executes it.
//! Longer work must not block the threads that listen.
//!
//! The limits are here and in [`parameters`](crate::serve::parameters), not in layers of `tower-http`: its body limit
//! refuses in plain text where this API promises JSON; its body timeout counts from byte to byte, so that a client that
//! sends a byte in time occupies a request forever; its timeout cannot tell a late body (408) from a late answer (503),
//! and ends the wait but not the work that holds the permit.

use std::sync::Arc;
use std::time::{Duration, Instant};

use axum::Router;
use axum::extract::rejection::PathRejection;
use axum::extract::{FromRequest, Path, Request, State};
use axum::http::header::ALLOW;
use axum::http::{Method, StatusCode, Uri};
use axum::middleware::{Next, from_fn_with_state};
use axum::response::{IntoResponse, Response};
use axum::routing::{MethodRouter, get};
use tokio::sync::OwnedSemaphorePermit;

use crate::pipeline::service::RequestLog;
use crate::serve::health;
use crate::serve::heights::HeightsQuery;
use crate::serve::help;
use crate::serve::los::LosQuery;
use crate::serve::parameters::Parameters;
use crate::serve::profile::ProfileQuery;
use crate::serve::query::{Query, QueryWeight, Service};
use crate::serve::reply::{HttpError, quoted};
use crate::serve::viewshed::ViewshedQuery;

/// Values longer than this are parsed on another thread, because parsing takes longer than the move.
const LIGHT_BYTES: usize = 32 * 1024;

/// The longest path in the log, in characters.
const LOGGED_PATH: usize = 200;

const QUERY_METHODS: &str = "GET, HEAD, POST, OPTIONS";

const PAGE_METHODS: &str = "GET, HEAD, OPTIONS";

type Shared = State<Arc<Service>>;

pub fn router(service: Arc<Service>) -> Router {
    let router = Router::new()
        .route("/", page(help::page))
        .route("/health", page(health::page))
        .route("/v1/los", query::<LosQuery>())
        .route("/v1/profile", query::<ProfileQuery>())
        .route("/v1/viewshed", query::<ViewshedQuery>())
        .route(
            "/v1/{datasets}",
            get(heights).post(heights).fallback(async |method| other(&method, QUERY_METHODS)),
        )
        .fallback(async |State(service): Shared, uri: Uri| not_found(&service, &uri));
    let router = match service.log {
        RequestLog::On => router.layer(from_fn_with_state(Arc::clone(&service), log)),
        RequestLog::Off => router,
    };
    router.with_state(service)
}

fn page(write: fn(&Service) -> Response) -> MethodRouter<Arc<Service>> {
    get(async move |State(service): Shared| write(&service))
        .fallback(async |method| other(&method, PAGE_METHODS))
}

fn query<Q: Query>() -> MethodRouter<Arc<Service>> {
    async fn handle<Q: Query>(State(service): Shared, request: Request) -> Result<Response, HttpError> {
        answer::<Q>(&service, "", request).await
    }
    get(handle::<Q>).post(handle::<Q>).fallback(async |method| other(&method, QUERY_METHODS))
}

async fn heights(
    State(service): Shared,
    datasets: Result<Path<String>, PathRejection>,
    request: Request,
) -> Result<Response, HttpError> {
    match datasets {
        Ok(Path(datasets)) => answer::<HeightsQuery>(&service, &datasets, request).await,
        Err(_) => Err(not_found(&service, request.uri())),
    }
}

/// The response to `OPTIONS` and to unsupported methods.
fn other(method: &Method, allowed: &'static str) -> Response {
    match *method {
        Method::OPTIONS => (StatusCode::NO_CONTENT, [(ALLOW, allowed)]).into_response(),
        _ => HttpError::method(allowed).into_response(),
    }
}

fn not_found(service: &Service, uri: &Uri) -> HttpError {
    let (path, names) = (quoted(uri.path()), service.datasets.names());
    HttpError::unknown(format!(
        "there is nothing at {path}; there are /, /health, /v1/los, /v1/profile, /v1/viewshed and /v1/DATASET, \
         where the datasets are {names}"
    ))
}

/// Writes a line for a request: method, path, status, milliseconds.
async fn log(State(service): Shared, request: Request, next: Next) -> Response {
    let (method, start) = (request.method().clone(), Instant::now());
    let path: String = request.uri().path().chars().take(LOGGED_PATH).collect();
    let response = next.run(request).await;
    let (status, ms) = (response.status().as_u16(), start.elapsed().as_secs_f64() * 1e3);
    (service.write_line)(&format!("{method} {path} {status} {ms:.3} ms"));
    response
}

async fn answer<Q: Query>(
    service: &Arc<Service>,
    datasets: &str,
    request: Request,
) -> Result<Response, HttpError> {
    let parameters = Parameters::from_request(request, service).await?;
    let permit = Arc::clone(&service.requests).try_acquire_owned().map_err(|_| {
        let most = service.limits.max_requests;
        HttpError::busy(1, format!("{most} requests are being answered; try again"))
    })?;
    if parameters.len() > LIGHT_BYTES {
        let datasets = datasets.to_owned();
        let work = move |service: &Service| Q::read(service, &datasets, &parameters)?.answer(service);
        return on_another_thread(service, permit, work).await;
    }
    let query = Q::read(service, datasets, &parameters)?;
    match query.weight(service) {
        QueryWeight::Light => query.answer(service),
        QueryWeight::Heavy => on_another_thread(service, permit, move |service| query.answer(service)).await,
    }
}

/// Executes a query on a blocking thread, with a time limit. The request holds its permit until the work ends, or is
/// dropped before it begins.
async fn on_another_thread(
    service: &Arc<Service>,
    permit: OwnedSemaphorePermit,
    work: impl FnOnce(&Service) -> Result<Response, HttpError> + Send + 'static,
) -> Result<Response, HttpError> {
    let shared = Arc::clone(service);
    let mut task = tokio::task::spawn_blocking(move || {
        let answer = work(&shared);
        drop(permit);
        answer
    });
    let seconds = service.limits.timeout_s;
    match tokio::time::timeout(Duration::from_secs(seconds.into()), &mut task).await {
        Ok(Ok(answer)) => answer,
        Ok(Err(_)) => Err(HttpError::new(StatusCode::INTERNAL_SERVER_ERROR, "answering failed")),
        Err(_) => {
            task.abort();
            let reason = format!("no answer within {seconds} s; ask for less at a time, or later");
            Err(HttpError::busy(seconds, reason))
        }
    }
}
