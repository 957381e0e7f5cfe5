//! Dispatches requests: from address to query, and from query to thread.
//!
//! ```text
//! request ─► host ─► parameters (query, body) ─► permit ─► read ─► light? ─► answer ─► response
//!           │ 400 421  │ 414 413 415 408 400 503   │ 503    │ 400   └ no ─► turn, memory, another thread ─┘ 503 in the end
//! ```
//!
//! A request takes its permit when all of it is there: clients that send slowly keep nobody from being answered. Heavy and
//! expensive queries take turns, of which each client has its share (see [`clients`](crate::clients)), so that who
//! asks for much waits for himself and not others for him. Work whose client has left stops.
//!
//! A query of a few points takes less time than moving it to another thread, so the thread that parsed it executes it.
//! Longer work must not block the threads that listen.
//!
//! The limits are here and in [`parameters`](crate::parameters), not in layers of `tower-http`: its body limit
//! refuses in plain text where this API promises JSON; its body timeout counts from byte to byte, so that a client that
//! sends a byte in time occupies a request forever; its timeout cannot tell a late body (408) from a late answer (503),
//! and ends the wait but not the work.

use std::sync::Arc;
use std::time::{Duration, Instant};

use axum::Router;
use axum::extract::rejection::PathRejection;
use axum::extract::{ConnectInfo, Path, Request, State};
use axum::http::header::{ALLOW, VARY};
use axum::http::{HeaderMap, HeaderValue, Method, StatusCode, Uri};
use axum::middleware::{Next, from_fn_with_state};
use axum::response::{IntoResponse, Response};
use axum::routing::{MethodRouter, get};
use tokio::sync::{OwnedSemaphorePermit, Semaphore};

use crate::analyses::AnalysisQuery;
use crate::clients::Connection;
use crate::heights::HeightsQuery;
use crate::listener::RequestConnection;
use crate::lookup::LookupQuery;
use crate::los::LosQuery;
use crate::parameters::Parameters;
use crate::profile::ProfileQuery;
use crate::query::{Query, QueryWeight};
use crate::reply::{HttpError, quoted};
use crate::service::Service;
use crate::tiles::TileQuery;
use crate::viewshed::ViewshedQuery;
use crate::{analyses, answers, api, datasets, etag, health, help, host, map_page, openapi, ready};
use sandtable_query::service::RequestLog;
use sandtable_terrain::stop_flag::StopFlag;

/// Values longer than this are parsed on another thread, because parsing takes longer than the move.
const LIGHT_BYTES: usize = 32 * 1024;

/// The longest path in the log, in characters.
const LOGGED_PATH: usize = 200;

const QUERY_METHODS: &str = "GET, HEAD, POST, OPTIONS";

const PAGE_METHODS: &str = "GET, HEAD, OPTIONS";

type Shared = State<Arc<Service>>;

pub fn router(service: Arc<Service>) -> Router {
    let at = |path: &str| service.prefix.before(path);
    let router = Router::new()
        .route(&at("/"), get(start).fallback(async |method| other(&method, PAGE_METHODS)))
        .route(&at(help::PATH), page(help::page))
        .route(&at(map_page::STYLE_PATH), page(map_page::style))
        .route(&at(map_page::SCRIPT_PATH), page(map_page::script))
        .route(&at("/datasets"), page(datasets::page))
        .route(&at("/openapi.json"), page(openapi::page))
        .route(&at(health::PATH), page(health::page))
        .route(&at(ready::PATH), page(ready::page))
        .route(&at(&api::LOOKUP.path), query::<LookupQuery>())
        .route(&at("/v1/los"), query::<LosQuery>())
        .route(&at("/v1/profile"), query::<ProfileQuery>())
        .route(&at("/v1/viewshed"), query::<ViewshedQuery>())
        .route(&at("/v1/{datasets}"), named::<HeightsQuery>())
        .route(&at(analyses::PATH), page(analyses::page))
        .route(&at("/v1/analyze/{kind}"), named::<AnalysisQuery>())
        .route(&at("/v1/tiles/{*tile}"), named::<TileQuery>())
        .fallback(async |State(service): Shared, uri: Uri| not_found(&service, &uri));
    let router = match service.prefix.as_str() {
        "" => router,
        prefix => router.route(prefix, get(start).fallback(async |method| other(&method, PAGE_METHODS))),
    };
    let router = router.layer(from_fn_with_state(Arc::clone(&service), etag::tag));
    let router = router.layer(from_fn_with_state(Arc::clone(&service), host::check));
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

/// `/`: the page of the map for browsers, the list of requests for other programs.
async fn start(State(service): Shared, headers: HeaderMap) -> Response {
    let mut response =
        if map_page::is_wanted(&headers) { map_page::page(&service) } else { help::page(&service) };
    response.headers_mut().insert(VARY, HeaderValue::from_static("accept"));
    response
}

fn query<Q: Query>() -> MethodRouter<Arc<Service>> {
    async fn handle<Q: Query>(
        State(service): Shared,
        ConnectInfo(RequestConnection(connection)): ConnectInfo<RequestConnection>,
        request: Request,
    ) -> Result<Response, HttpError> {
        answer::<Q>(&service, &connection, "", request).await
    }
    get(handle::<Q>).post(handle::<Q>).fallback(async |method| other(&method, QUERY_METHODS))
}

/// A query whose address ends with a name: of datasets, of a kind of analysis or of a tile.
fn named<Q: Query>() -> MethodRouter<Arc<Service>> {
    async fn handle<Q: Query>(
        State(service): Shared,
        ConnectInfo(RequestConnection(connection)): ConnectInfo<RequestConnection>,
        name: Result<Path<String>, PathRejection>,
        request: Request,
    ) -> Result<Response, HttpError> {
        match name {
            Ok(Path(name)) => answer::<Q>(&service, &connection, &name, request).await,
            Err(_) => Err(not_found(&service, request.uri())),
        }
    }
    get(handle::<Q>).post(handle::<Q>).fallback(async |method| other(&method, QUERY_METHODS))
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
        "there is nothing at {path}; there are {}, where the datasets are {names}",
        api::paths(&service.prefix).join(", ")
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

/// Lets the work on a request stop when its client has left or its time is over.
#[derive(Default)]
struct StopOnDrop(Arc<StopFlag>);

impl Drop for StopOnDrop {
    fn drop(&mut self) {
        self.0.stop();
    }
}

async fn answer<Q: Query>(
    service: &Arc<Service>,
    connection: &Arc<Connection>,
    name: &str,
    request: Request,
) -> Result<Response, HttpError> {
    let parameters = Parameters::receive(request, service, connection).await?;
    let _permit = connection.client.requests.try_acquire().map_err(|_| {
        let most = service.limits.max_requests;
        HttpError::busy(1, format!("{most} of your requests are being answered; try again"))
    })?;
    let stop = StopOnDrop::default();
    let work = work::<Q>(service, connection, name.to_owned(), parameters, &stop.0);
    let seconds = service.limits.timeout_s;
    tokio::time::timeout(Duration::from_secs(seconds.into()), work).await.unwrap_or_else(|_| {
        let reason = format!("no answer within {seconds} s; ask for less at a time, or later");
        Err(HttpError::busy(seconds, reason))
    })
}

async fn work<Q: Query>(
    service: &Arc<Service>,
    connection: &Arc<Connection>,
    name: String,
    parameters: Parameters,
    stop: &Arc<StopFlag>,
) -> Result<Response, HttpError> {
    let query = match parameters.len() > LIGHT_BYTES {
        true => on_another_thread(service, move |service| Q::read(service, &name, &parameters)).await?,
        false => Q::read(service, &name, &parameters)?,
    };
    let weight = query.weight(service);
    let (own, all) = match weight {
        QueryWeight::Light => return query.answer(service, stop),
        QueryWeight::Heavy => (&connection.client.heavy, &service.heavy),
        QueryWeight::Expensive | QueryWeight::Picture => (&connection.client.expensive, &service.expensive),
    };
    let own = acquire(own).await;
    let memory = service.answers.reserve(&service.clients, connection, query.most_bytes(service)).await;
    let picture = match weight {
        QueryWeight::Picture => Some(acquire(&service.pictures).await),
        _ => None,
    };
    let turn = (own, picture, acquire(all).await);
    let stop = Arc::clone(stop);
    let answer = on_another_thread(service, move |service| {
        let answer = query.answer(service, &stop);
        drop(turn);
        answer
    });
    Ok(answers::hold(answer.await?, memory).await)
}

async fn acquire(semaphore: &Arc<Semaphore>) -> OwnedSemaphorePermit {
    let permit = Arc::clone(semaphore).acquire_owned().await;
    permit.expect("no semaphore of the service is ever closed")
}

/// Works on a blocking thread.
async fn on_another_thread<T: Send + 'static>(
    service: &Arc<Service>,
    work: impl FnOnce(&Service) -> Result<T, HttpError> + Send + 'static,
) -> Result<T, HttpError> {
    let shared = Arc::clone(service);
    let done = tokio::task::spawn_blocking(move || work(&shared)).await;
    done.unwrap_or_else(|_| Err(HttpError::new(StatusCode::INTERNAL_SERVER_ERROR, "answering failed")))
}
