//! From a request to a response: which address is which question, what is read of a request, and where it is answered.
//!
//! ```text
//! request ─► turnstile ─► text (query, body) ─► read ─► light? ─► answer ─► response
//!              │ 503        │ 414 413 415 408     │ 400    └ no ─► a thread of its own ─┘ 503 in the end
//! ```
//!
//! Answering a few points takes less than handing them to another thread would, so they are answered where they were
//! read. What takes longer must not hold up the threads that listen.

use std::sync::Arc;
use std::time::Instant;

use axum::Router;
use axum::body::{Body, Bytes};
use axum::extract::rejection::PathRejection;
use axum::extract::{Path, State};
use axum::http::header::{CONTENT_ENCODING, CONTENT_LENGTH, CONTENT_TYPE};
use axum::http::{HeaderMap, HeaderValue, Method, Request, Response, StatusCode, Uri};
use axum::routing::any;

use crate::app::output;
use crate::app::serve::health;
use crate::app::serve::heights::Heights;
use crate::app::serve::help;
use crate::app::serve::limits::{Permit, ServeLimits};
use crate::app::serve::los::Los;
use crate::app::serve::params::Params;
use crate::app::serve::profile::ProfileQuestion;
use crate::app::serve::question::{Log, QueryRequest, Question, Service, Weight};
use crate::app::serve::reply::{HttpError, Reply, quoted};
use crate::app::serve::viewshed::ViewshedQuestion;

/// A text longer than this is read on a thread of its own, because reading it takes longer than handing it there.
const LIGHT_BYTES: usize = 32 * 1024;

/// The methods of a question.
const ASKING: &str = "GET, HEAD, POST, OPTIONS";

/// The methods of a page.
const READING: &str = "GET, HEAD, OPTIONS";

/// The addresses.
pub fn router(service: Arc<Service>) -> Router {
    Router::new()
        .route("/", any(page_help))
        .route("/health", any(page_health))
        .route("/v1/los", any(los))
        .route("/v1/profile", any(profile))
        .route("/v1/viewshed", any(viewshed))
        .route("/v1/{dataset}", any(heights))
        .fallback(nothing)
        .with_state(service)
}

type Shared = State<Arc<Service>>;

async fn page_help(State(service): Shared, request: Request<Body>) -> Response<Body> {
    page(&service, &request, help::page)
}

async fn page_health(State(service): Shared, request: Request<Body>) -> Response<Body> {
    page(&service, &request, health::page)
}

async fn los(State(service): Shared, request: Request<Body>) -> Response<Body> {
    ask::<Los>(service, "", request).await
}

async fn profile(State(service): Shared, request: Request<Body>) -> Response<Body> {
    ask::<ProfileQuestion>(service, "", request).await
}

async fn viewshed(State(service): Shared, request: Request<Body>) -> Response<Body> {
    ask::<ViewshedQuestion>(service, "", request).await
}

async fn heights(
    State(service): Shared,
    dataset: Result<Path<String>, PathRejection>,
    request: Request<Body>,
) -> Response<Body> {
    match dataset {
        Ok(Path(dataset)) => ask::<Heights>(service, &dataset, request).await,
        Err(_) => nothing(State(service), request).await,
    }
}

async fn nothing(State(service): Shared, request: Request<Body>) -> Response<Body> {
    let line = LogLine::begin(&service, &request);
    let found = quoted(request.uri().path());
    let names = service.datasets.names();
    let reason = format!(
        "there is nothing at {found}; there are /, /health, /v1/los, /v1/profile, /v1/viewshed and /v1/DATASET, \
         where the datasets are {names}"
    );
    line.end(HttpError::unknown(reason).into_response())
}

fn page(service: &Service, request: &Request<Body>, write: fn(&Service) -> Reply) -> Response<Body> {
    let line = LogLine::begin(service, request);
    line.end(match *request.method() {
        Method::GET | Method::HEAD => write(service).into_response(),
        Method::OPTIONS => options(READING),
        _ => HttpError::method(READING).into_response(),
    })
}

/// Which methods an address answers.
fn options(allowed: &'static str) -> Response<Body> {
    let mut response = Response::new(Body::empty());
    *response.status_mut() = StatusCode::NO_CONTENT;
    response.headers_mut().insert(axum::http::header::ALLOW, HeaderValue::from_static(allowed));
    response
}

/// Reads a question and answers it.
async fn ask<Q: Question>(service: Arc<Service>, dataset: &str, request: Request<Body>) -> Response<Body> {
    let line = LogLine::begin(&service, &request);
    if request.method() == Method::OPTIONS {
        return line.end(options(ASKING));
    }
    let answered = answered::<Q>(&service, dataset, request).await;
    line.end(answered.map_or_else(HttpError::into_response, Reply::into_response))
}

async fn answered<Q: Question>(
    service: &Arc<Service>,
    dataset: &str,
    request: Request<Body>,
) -> Result<Reply, HttpError> {
    let place = service.requests.enter().ok_or_else(|| {
        HttpError::busy(1, format!("{} requests are being answered; ask again", service.limits.max_requests))
    })?;
    let text = RequestText::of(request, &service.limits).await?;
    if text.len() > LIGHT_BYTES {
        let dataset = dataset.to_owned();
        return aside(service, place, move |service| text.read::<Q>(service, &dataset)?.answer(service))
            .await;
    }
    let question = text.read::<Q>(service, dataset)?;
    match question.weight(service) {
        Weight::Light => question.answer(service),
        Weight::Heavy => aside(service, place, move |service| question.answer(service)).await,
    }
}

/// Answers on a thread that may take its time, and gives up waiting in the end. The request counts as being answered
/// until the work is done, or dropped because it had not begun.
async fn aside(
    service: &Arc<Service>,
    place: Permit,
    work: impl FnOnce(&Service) -> Result<Reply, HttpError> + Send + 'static,
) -> Result<Reply, HttpError> {
    let shared = Arc::clone(service);
    let mut task = tokio::task::spawn_blocking(move || {
        let answer = work(&shared);
        drop(place);
        answer
    });
    match tokio::time::timeout(service.limits.patience(), &mut task).await {
        Ok(Ok(answer)) => answer,
        Ok(Err(_)) => Err(HttpError::with(StatusCode::INTERNAL_SERVER_ERROR, "answering failed")),
        Err(_) => {
            task.abort();
            let seconds = service.limits.timeout;
            Err(HttpError::busy(
                seconds,
                format!("no answer within {seconds} s; ask for less at a time, or later"),
            ))
        }
    }
}

/// What a request says.
struct RequestText {
    uri: Uri,
    body: Bytes,
    notation: Notation,
}

/// How a body is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Notation {
    Form,
    Json,
}

impl RequestText {
    async fn of(request: Request<Body>, limits: &ServeLimits) -> Result<Self, HttpError> {
        let (head, body) = request.into_parts();
        let length = head.uri.path_and_query().map_or(0, |whole| whole.as_str().len());
        if length > ServeLimits::LONGEST_URL {
            return Err(HttpError::with(
                StatusCode::URI_TOO_LONG,
                format!(
                    "the address is {length} bytes long, {} are the most; send the parameters in the body of a POST",
                    ServeLimits::LONGEST_URL
                ),
            ));
        }
        match head.method {
            Method::GET | Method::HEAD => {
                Ok(Self { uri: head.uri, body: Bytes::new(), notation: Notation::Form })
            }
            Method::POST => {
                let declared = notation(&head.headers)?;
                let body = whole(body, &head.headers, limits).await?;
                let looks_json = body.trim_ascii_start().starts_with(b"{");
                let guessed = if looks_json { Notation::Json } else { Notation::Form };
                Ok(Self { uri: head.uri, body, notation: declared.unwrap_or(guessed) })
            }
            _ => Err(HttpError::method(ASKING)),
        }
    }

    fn len(&self) -> usize {
        self.uri.query().map_or(0, str::len) + self.body.len()
    }

    fn read<Q: Question>(&self, service: &Service, dataset: &str) -> Result<Q, HttpError> {
        let mut params = Params::default();
        params.add_form(self.uri.query().unwrap_or_default())?;
        match self.notation {
            Notation::Json => params.add_json(&self.body)?,
            Notation::Form => {
                let text = std::str::from_utf8(&self.body)
                    .map_err(|error| HttpError::wrong(format!("the body is not UTF-8 text: {error}")))?;
                params.add_form(text.trim_end())?;
            }
        }
        Q::read(service, &QueryRequest { dataset, params })
    }
}

/// How the headers say that the body is written; `None` where they do not.
fn notation(headers: &HeaderMap) -> Result<Option<Notation>, HttpError> {
    let unknown = |what: &str, found: &HeaderValue, remedy: &str| {
        let found = quoted(&String::from_utf8_lossy(found.as_bytes()));
        HttpError::with(StatusCode::UNSUPPORTED_MEDIA_TYPE, format!("the {what} is {found}; {remedy}"))
            .closing()
    };
    if let Some(coding) = headers.get(CONTENT_ENCODING).filter(|coding| *coding != "identity") {
        return Err(unknown("content encoding", coding, "send the body as it is"));
    }
    let Some(found) = headers.get(CONTENT_TYPE) else {
        return Ok(None);
    };
    let named = found.to_str().unwrap_or_default().split(';').next().unwrap_or_default().trim();
    if named.eq_ignore_ascii_case("application/json") {
        Ok(Some(Notation::Json))
    } else if named.eq_ignore_ascii_case("application/x-www-form-urlencoded") {
        Ok(Some(Notation::Form))
    } else {
        Err(unknown("content type", found, "send application/json or application/x-www-form-urlencoded"))
    }
}

/// The whole body, which must arrive in time and not be longer than may be.
async fn whole(body: Body, headers: &HeaderMap, limits: &ServeLimits) -> Result<Bytes, HttpError> {
    let most = limits.longest_body();
    let too_long = || {
        let reason = format!("the body is longer than {most} bytes, the most of one request; ask in parts");
        HttpError::with(StatusCode::PAYLOAD_TOO_LARGE, reason).closing()
    };
    let stated = headers.get(CONTENT_LENGTH).and_then(|length| length.to_str().ok()?.parse::<u64>().ok());
    if stated.is_some_and(|length| length > most as u64) {
        return Err(too_long());
    }
    match tokio::time::timeout(limits.patience(), axum::body::to_bytes(body, most)).await {
        Ok(Ok(bytes)) => Ok(bytes),
        // Either it went on beyond the limit, or the client left and hears nothing any more.
        Ok(Err(_)) => Err(too_long()),
        Err(_) => {
            let reason = format!("the body did not arrive within {} s", limits.timeout);
            Err(HttpError::with(StatusCode::REQUEST_TIMEOUT, reason).closing())
        }
    }
}

/// The line of the log that tells of a request.
struct LogLine(Option<(Method, String, Instant)>);

impl LogLine {
    fn begin(service: &Service, request: &Request<Body>) -> Self {
        let tell = service.log == Log::Requests;
        Self(tell.then(|| (request.method().clone(), request.uri().path().to_owned(), Instant::now())))
    }

    /// Writes it: method, path, status, milliseconds.
    fn end(self, response: Response<Body>) -> Response<Body> {
        if let Some((method, path, begun)) = self.0 {
            let milliseconds = begun.elapsed().as_secs_f64() * 1e3;
            let status = response.status().as_u16();
            let path: String = path.chars().take(200).collect();
            output::warn(&format!("{method} {path} {status} {milliseconds:.3} ms"));
        }
        response
    }
}
