//! What goes back: an answer, or a refusal that says why.
//!
//! Both are JSON whatever was asked, so that a client needs one way of reading: an answer ends with `"status":"OK"`, a
//! refusal is `{"status":"INVALID_REQUEST","error":"…"}` where the client can mend it, and `SERVER_ERROR` where not.

use axum::body::Body;
use axum::http::header::{ALLOW, CONNECTION, CONTENT_TYPE, RETRY_AFTER};
use axum::http::{HeaderValue, Response, StatusCode};

use crate::app::serve::json;

/// What a body is written in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BodyFormat {
    /// JSON.
    Json,
    /// GeoJSON (RFC 7946, 2016).
    GeoJson,
    /// Plain text for people.
    Text,
}

impl BodyFormat {
    fn content_type(self) -> HeaderValue {
        HeaderValue::from_static(match self {
            Self::Json => "application/json",
            Self::GeoJson => "application/geo+json",
            Self::Text => "text/plain; charset=utf-8",
        })
    }
}

/// An answer.
#[derive(Debug)]
pub struct Reply {
    /// What the body is written in.
    pub form: BodyFormat,
    /// The body.
    pub body: Vec<u8>,
}

impl Reply {
    /// The response that carries it.
    pub fn into_response(self) -> Response<Body> {
        let mut response = Response::new(Body::from(self.body));
        response.headers_mut().insert(CONTENT_TYPE, self.form.content_type());
        response
    }
}

/// Why there is no answer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct HttpError {
    status: StatusCode,
    reason: String,
    hint: Hint,
}

/// What else a refusal tells the client's program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Hint {
    None,
    /// Asking again may do better after so many seconds.
    RetryAfter(u16),
    /// The methods that are answered.
    Allow(&'static str),
    /// The rest of the request is not read: the connection ends.
    Close,
}

impl HttpError {
    /// The request is wrong: 400. `reason` says what was found and what to write instead.
    pub fn wrong(reason: impl Into<String>) -> Self {
        Self::with(StatusCode::BAD_REQUEST, reason)
    }

    /// There is nothing of that name: 404.
    pub fn unknown(reason: impl Into<String>) -> Self {
        Self::with(StatusCode::NOT_FOUND, reason)
    }

    /// The request has a status of its own.
    pub fn with(status: StatusCode, reason: impl Into<String>) -> Self {
        Self { status, reason: reason.into(), hint: Hint::None }
    }

    /// The service is busy, or the answer took too long: 503, and when to ask again.
    pub fn busy(retry_after_s: u16, reason: impl Into<String>) -> Self {
        let status = StatusCode::SERVICE_UNAVAILABLE;
        Self { status, reason: reason.into(), hint: Hint::RetryAfter(retry_after_s) }
    }

    /// The method is not answered here: 405, and those that are.
    pub fn method(allowed: &'static str) -> Self {
        let reason = format!("this address answers {allowed}");
        Self { status: StatusCode::METHOD_NOT_ALLOWED, reason, hint: Hint::Allow(allowed) }
    }

    /// What is left of the request is not read.
    pub fn closing(self) -> Self {
        Self { hint: Hint::Close, ..self }
    }

    /// The HTTP status.
    #[cfg(test)]
    pub fn status(&self) -> StatusCode {
        self.status
    }

    /// What is wrong, and what to do.
    pub fn reason(&self) -> &str {
        &self.reason
    }

    /// The response that carries it.
    pub fn into_response(self) -> Response<Body> {
        let status = if self.status.is_server_error() { "SERVER_ERROR" } else { "INVALID_REQUEST" };
        let mut body = Vec::with_capacity(self.reason.len() + 64);
        body.extend_from_slice(b"{\"status\":\"");
        body.extend_from_slice(status.as_bytes());
        body.extend_from_slice(b"\",\"error\":");
        json::string(&mut body, &self.reason);
        body.extend_from_slice(b"}");
        let mut response = Reply { form: BodyFormat::Json, body }.into_response();
        *response.status_mut() = self.status;
        let headers = response.headers_mut();
        match self.hint {
            Hint::None => None,
            Hint::RetryAfter(seconds) => headers.insert(RETRY_AFTER, HeaderValue::from(seconds)),
            Hint::Allow(methods) => headers.insert(ALLOW, HeaderValue::from_static(methods)),
            Hint::Close => headers.insert(CONNECTION, HeaderValue::from_static("close")),
        };
        response
    }
}

/// `text` for a message: at most 60 characters of it, and no control characters.
pub fn quoted(text: &str) -> String {
    /// Long enough to find the place by, short enough for a line.
    const LONGEST: usize = 60;
    let mut shown: String =
        text.chars().take(LONGEST).map(|c| if c.is_control() { '\u{fffd}' } else { c }).collect();
    if text.chars().nth(LONGEST).is_some() {
        shown.push('…');
    }
    format!("'{shown}'")
}
