//! Responses: answers, and refusals with a reason.
//!
//! Both are always JSON: an answer ends with `"status":"OK"`; a refusal is
//! `{"status":"INVALID_REQUEST","error":"…"}` where the request is wrong, else `{"status":"SERVER_ERROR",…}`.

use axum::Json;
use axum::http::header::{ALLOW, CONNECTION, RETRY_AFTER};
use axum::http::{HeaderValue, StatusCode};
use axum::response::{IntoResponse, Response};
use serde::{Serialize, Serializer};

use sandtable_base::message::chain::error_text;
use sandtable_query::dataset::QueryError;

pub const OK: &str = "OK";

/// A JSON array of the items of an iterator, which are serialized one by one.
pub struct JsonArray<I>(pub I);

impl<I: Iterator<Item: Serialize> + Clone> Serialize for JsonArray<I> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(self.0.clone())
    }
}

/// A refusal.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct HttpError {
    status: StatusCode,
    reason: String,
    hint: RefusalHint,
}

/// A header of a refusal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum RefusalHint {
    None,
    /// Try again after this number of seconds.
    RetryAfter(u16),
    /// The supported methods.
    Allow(&'static str),
    /// The rest of the request is not read: the connection ends.
    Close,
}

#[derive(Serialize)]
struct RefusalBody<'a> {
    status: &'static str,
    error: &'a str,
}

impl HttpError {
    pub fn new(status: StatusCode, reason: impl Into<String>) -> Self {
        Self { status, reason: reason.into(), hint: RefusalHint::None }
    }

    /// The request is wrong: 400. `reason` names the value that was found and the remedy.
    pub fn wrong(reason: impl Into<String>) -> Self {
        Self::new(StatusCode::BAD_REQUEST, reason)
    }

    /// There is no such address or dataset: 404.
    pub fn unknown(reason: impl Into<String>) -> Self {
        Self::new(StatusCode::NOT_FOUND, reason)
    }

    /// The service is busy, or the answer took too long: 503.
    pub fn busy(retry_after_s: u16, reason: impl Into<String>) -> Self {
        let hint = RefusalHint::RetryAfter(retry_after_s);
        Self { hint, ..Self::new(StatusCode::SERVICE_UNAVAILABLE, reason) }
    }

    /// The work was stopped, since nobody waits for the answer: 503.
    pub fn stopped() -> Self {
        Self::busy(1, "the client has left")
    }

    /// The method is not supported: 405.
    pub fn method(allowed: &'static str) -> Self {
        let reason = format!("this address answers {allowed}");
        Self { hint: RefusalHint::Allow(allowed), ..Self::new(StatusCode::METHOD_NOT_ALLOWED, reason) }
    }

    /// This refusal, and the rest of the request is not read.
    pub fn closing(self) -> Self {
        Self { hint: RefusalHint::Close, ..self }
    }

    #[cfg(test)]
    pub fn status(&self) -> StatusCode {
        self.status
    }

    #[cfg(test)]
    pub fn reason(&self) -> &str {
        &self.reason
    }
}

impl From<QueryError> for HttpError {
    fn from(error: QueryError) -> Self {
        Self::wrong(error_text(&error))
    }
}

impl IntoResponse for HttpError {
    fn into_response(self) -> Response {
        let status = if self.status.is_server_error() { "SERVER_ERROR" } else { "INVALID_REQUEST" };
        let body = Json(RefusalBody { status, error: &self.reason });
        let mut response = (self.status, body).into_response();
        let (name, value) = match self.hint {
            RefusalHint::None => return response,
            RefusalHint::RetryAfter(seconds) => (RETRY_AFTER, HeaderValue::from(seconds)),
            RefusalHint::Allow(methods) => (ALLOW, HeaderValue::from_static(methods)),
            RefusalHint::Close => (CONNECTION, HeaderValue::from_static("close")),
        };
        response.headers_mut().insert(name, value);
        response
    }
}

/// `text` for a message: at most 60 characters, without control characters.
pub fn quoted(text: &str) -> String {
    /// Long enough to recognize, short enough for a line.
    const LONGEST: usize = 60;
    let mut shown: String =
        text.chars().take(LONGEST).map(|c| if c.is_control() { '\u{fffd}' } else { c }).collect();
    if text.chars().nth(LONGEST).is_some() {
        shown.push('…');
    }
    format!("'{shown}'")
}

#[cfg(test)]
mod tests {
    fn written(value: f64) -> String {
        serde_json::to_string(&value).expect("JSON")
    }

    #[test]
    fn numbers_read_back_to_the_same_bits() {
        let mut bits = 1u64;
        for _ in 0..20_000 {
            bits = bits.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            let value = f64::from_bits(bits);
            if value.is_finite() {
                assert_eq!(written(value).parse::<f64>().map(f64::to_bits), Ok(value.to_bits()));
            }
        }
        assert_eq!((written(815.0), written(-0.1)), ("815.0".into(), "-0.1".into()));
        assert_eq!((written(f64::NAN), written(f64::INFINITY)), ("null".into(), "null".into()));
    }
}
