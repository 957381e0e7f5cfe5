//! The parameters of a request: from its query and from a body that is a form, in parts or not, or a JSON object.
//!
//! A JSON object has the same names as a form. Its values are strings, numbers, lists of strings, which are joined with
//! `|`, or lists of objects of a latitude and a longitude, which become `lat,lng`. A later value replaces an earlier one, and a value of the body one of the query.

use std::collections::BTreeMap;
use std::fmt;
use std::ops::RangeInclusive;
use std::time::Duration;

use axum::Json;
use axum::body::{Body, Bytes, to_bytes};
use axum::extract::multipart::MultipartError;
use axum::extract::{Form, FromRequest, Multipart, Query, Request};
use axum::http::header::{CONTENT_ENCODING, CONTENT_LENGTH, CONTENT_TYPE};
use axum::http::{HeaderMap, HeaderValue, Method, StatusCode};
use percent_encoding::percent_decode;
use serde::de::{Deserialize, Deserializer, Error, MapAccess, Visitor};
use tokio::sync::SemaphorePermit;

use crate::answers::taking_from_slow;
use crate::clients::{Connection, HeldResource};
use crate::reply::{HttpError, quoted};
use crate::service::Service;
use sandtable_base::message::choice::Choice;

/// The most parameters: no query has as many.
const MOST: usize = 32;

/// The longest path and query of a request, in bytes. The HTTP library refuses 65,535 bytes without a reason; this
/// lower limit allows a reply with one.
const LONGEST_URL: usize = 60_000;

const FORM: &str = "application/x-www-form-urlencoded";

const JSON: &str = "application/json";

/// The media types of bodies.
pub const BODY_TYPES: [&str; 3] = [FORM, JSON, MULTIPART];

const MULTIPART: &str = "multipart/form-data";

/// How a body is written.
#[derive(Clone, Debug)]
enum BodyForm {
    Json,
    Form,
    /// In parts; the content type says what is between them.
    Multipart(HeaderValue),
}

/// Named values.
#[derive(Debug, Default)]
pub struct Parameters(BTreeMap<String, String>);

/// A value of a form or of a JSON object.
#[derive(serde::Deserialize)]
#[serde(
    untagged,
    expecting = "expected a string, a number, a list of strings such as [\"56,123\", \"57,124\"], or one of objects such as [{\"latitude\": 56, \"longitude\": 123}]"
)]
enum ParameterValue {
    Text(String),
    Number(serde_json::Number),
    List(Vec<String>),
    Positions(Vec<JsonPosition>),
    Null(()),
}

/// A position as the Open-Elevation API has it in a body: an object, never a list.
#[derive(serde::Deserialize)]
#[serde(try_from = "serde_json::Map<String, serde_json::Value>")]
struct JsonPosition {
    latitude: f64,
    longitude: f64,
}

impl TryFrom<serde_json::Map<String, serde_json::Value>> for JsonPosition {
    type Error = &'static str;

    fn try_from(object: serde_json::Map<String, serde_json::Value>) -> Result<Self, Self::Error> {
        let number = |key: &str| object.get(key)?.as_f64();
        let position = number("latitude").zip(number("longitude"));
        let (latitude, longitude) = position.ok_or("a position has the numbers latitude and longitude")?;
        Ok(Self { latitude, longitude })
    }
}

impl ParameterValue {
    fn text(self) -> Option<String> {
        match self {
            Self::Text(text) => Some(text),
            Self::Number(number) => Some(number.to_string()),
            Self::List(items) => Some(items.join("|")),
            Self::Positions(items) => {
                let pairs = items.iter().map(|at| format!("{},{}", at.latitude, at.longitude));
                Some(pairs.collect::<Vec<_>>().join("|"))
            }
            Self::Null(()) => None,
        }
    }
}

struct ParametersVisitor;

impl<'de> Visitor<'de> for ParametersVisitor {
    type Value = Parameters;

    fn expecting(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str("an object of parameters")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Parameters, A::Error> {
        let mut parameters = BTreeMap::new();
        while let Some((name, value)) = map.next_entry::<String, ParameterValue>()? {
            parameters.extend(value.text().map(|value| (name, value)));
            if parameters.len() > MOST {
                return Err(A::Error::custom(format!("there are more than {MOST} parameters")));
            }
        }
        Ok(Parameters(parameters))
    }
}

impl<'de> Deserialize<'de> for Parameters {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_map(ParametersVisitor)
    }
}

/// The most bytes of a body that all clients may send at once, as many as hold a connection.
const SHORT_BODY: u64 = 32 * 1024;

/// The most longer bodies, or such of unstated length, that are received at once: each may take a megabyte of memory for
/// as long as its client likes to send.
pub const LONG_BODIES: usize = 64;

/// The number of these that one client may send.
pub const LONG_BODIES_OF_CLIENT: usize = LONG_BODIES / 2;

impl Parameters {
    /// Receives the parameters of a request that came over `connection`.
    pub async fn receive(
        request: Request,
        service: &Service,
        connection: &Connection,
    ) -> Result<Self, HttpError> {
        let length = request.uri().path_and_query().map_or(0, |whole| whole.as_str().len());
        if length > LONGEST_URL {
            let reason = format!(
                "the address is {length} bytes long, {LONGEST_URL} are the most; send the parameters in the body of a POST"
            );
            return Err(HttpError::new(StatusCode::URI_TOO_LONG, reason));
        }
        check_utf8(request.uri().query().unwrap_or_default().as_bytes())?;
        let query = Query::<Self>::try_from_uri(request.uri());
        let Query(mut parameters) = query.map_err(|rejection| HttpError::wrong(rejection.body_text()))?;
        if request.method() == Method::POST {
            let form = body_form(request.headers())?;
            let body = read_body(request, service, connection).await?;
            parameters.0.append(&mut Self::from_body(body, form).await?.0);
        }
        Ok(parameters)
    }
}

/// Refuses a form whose percent-encoded bytes are not UTF-8: the decoder would replace them silently.
fn check_utf8(form: &[u8]) -> Result<(), HttpError> {
    for parameter in form.split(|byte| *byte == b'&') {
        if percent_decode(parameter).decode_utf8().is_err() {
            let parameter = String::from_utf8_lossy(parameter);
            return Err(HttpError::wrong(format!(
                "{} is not UTF-8 text after its escapes are read",
                quoted(&parameter)
            )));
        }
    }
    Ok(())
}

impl Parameters {
    /// Parses a body. Without a content type it is JSON where it begins with a brace, else a form.
    async fn from_body(mut body: Bytes, form: Option<BodyForm>) -> Result<Self, HttpError> {
        let is_json = body.trim_ascii_start().starts_with(b"{");
        match form.unwrap_or(if is_json { BodyForm::Json } else { BodyForm::Form }) {
            BodyForm::Json => {
                let json = Json::<Self>::from_bytes(&body);
                return json
                    .map(|Json(parameters)| parameters)
                    .map_err(|rejection| HttpError::wrong(rejection.body_text()));
            }
            BodyForm::Multipart(content_type) => return Self::from_parts(body, content_type).await,
            BodyForm::Form => {}
        }
        body.truncate(body.trim_ascii_end().len());
        check_utf8(&body)?;
        let mut request = Request::new(Body::from(body));
        *request.method_mut() = Method::POST;
        request.headers_mut().insert(CONTENT_TYPE, HeaderValue::from_static(FORM));
        let form = Form::<Self>::from_request(request, &()).await;
        form.map(|Form(parameters)| parameters).map_err(|rejection| HttpError::wrong(rejection.body_text()))
    }

    /// Parses a form in parts (RFC 7578), each of which is a parameter.
    async fn from_parts(body: Bytes, content_type: HeaderValue) -> Result<Self, HttpError> {
        let mut request = Request::new(Body::from(body));
        request.headers_mut().insert(CONTENT_TYPE, content_type);
        let parts = Multipart::from_request(request, &()).await;
        let mut parts = parts.map_err(|rejection| HttpError::wrong(rejection.body_text()))?;
        let wrong = |error: MultipartError| HttpError::wrong(error.body_text());
        let mut parameters = BTreeMap::new();
        while let Some(part) = parts.next_field().await.map_err(wrong)? {
            let name = part.name().unwrap_or_default().to_owned();
            let bytes = part.bytes().await.map_err(wrong)?;
            let text = String::from_utf8(bytes.into());
            let not_text = |_| HttpError::wrong(format!("{} is not UTF-8 text", quoted(&name)));
            parameters.insert(name.clone(), text.map_err(not_text)?);
            if parameters.len() > MOST {
                return Err(HttpError::wrong(format!("there are more than {MOST} parameters")));
            }
        }
        Ok(Self(parameters))
    }

    /// The number of bytes of all values.
    pub fn len(&self) -> usize {
        self.0.values().map(String::len).sum()
    }

    pub fn get(&self, name: &str) -> Option<&str> {
        self.0.get(name).map(String::as_str)
    }

    /// The value of a required parameter.
    pub fn required(&self, name: &str, example: &str) -> Result<&str, HttpError> {
        self.get(name)
            .filter(|value| !value.is_empty())
            .ok_or_else(|| HttpError::wrong(format!("'{name}' is missing; write it as in {name}={example}")))
    }

    /// A finite number in `range`; `default` where the parameter is missing.
    pub fn number(&self, name: &str, range: RangeInclusive<f64>, default: f64) -> Result<f64, HttpError> {
        let Some(text) = self.get(name) else { return Ok(default) };
        text.trim().parse().ok().filter(|value| range.contains(value)).ok_or_else(|| {
            let (found, least, most) = (quoted(text), range.start(), range.end());
            HttpError::wrong(format!("{name} is {found}; write a number from {least} to {most}"))
        })
    }

    /// The value of a [`Choice`]; `None` where the parameter is missing.
    pub fn choice<T: Choice>(&self, name: &str) -> Result<Option<T>, HttpError> {
        self.word(name, T::CHOICES.iter().map(|choice| (choice.word, choice.value)))
    }

    /// The value that a word names; `None` where the parameter is missing.
    pub fn word<T>(
        &self,
        name: &str,
        words: impl IntoIterator<Item = (&'static str, T)>,
    ) -> Result<Option<T>, HttpError> {
        let Some(text) = self.get(name) else { return Ok(None) };
        let mut known = Vec::new();
        for (word, value) in words {
            if word == text {
                return Ok(Some(value));
            }
            known.push(word);
        }
        Err(HttpError::wrong(format!("{name} is {}; there are {}", quoted(text), known.join(", "))))
    }

    /// Refuses parameters that are not in `known`, which are probably misspelled.
    pub fn allow_only(&self, known: &[&str]) -> Result<(), HttpError> {
        match self.0.keys().find(|name| !known.contains(&name.as_str())) {
            None => Ok(()),
            Some(name) => {
                let known = known.join(", ");
                Err(HttpError::wrong(format!("there is no parameter {}; there are {known}", quoted(name))))
            }
        }
    }
}

/// How the headers say that a body is written; `None` where they do not.
fn body_form(headers: &HeaderMap) -> Result<Option<BodyForm>, HttpError> {
    let refused = |what: &str, found: &HeaderValue, remedy: &str| {
        let found = quoted(&String::from_utf8_lossy(found.as_bytes()));
        HttpError::new(StatusCode::UNSUPPORTED_MEDIA_TYPE, format!("the {what} is {found}; {remedy}"))
            .closing()
    };
    if let Some(coding) = headers.get(CONTENT_ENCODING).filter(|coding| *coding != "identity") {
        return Err(refused("content encoding", coding, "send the body as it is"));
    }
    let Some(found) = headers.get(CONTENT_TYPE) else { return Ok(None) };
    let named = found.to_str().unwrap_or_default().split(';').next().unwrap_or_default().trim();
    match named.to_ascii_lowercase().as_str() {
        JSON => Ok(Some(BodyForm::Json)),
        FORM => Ok(Some(BodyForm::Form)),
        MULTIPART => Ok(Some(BodyForm::Multipart(found.clone()))),
        _ => Err(refused("content type", found, &format!("send {JSON}, {FORM} or {MULTIPART}"))),
    }
}

/// A long body that is being received.
struct LongBody<'a> {
    _own: SemaphorePermit<'a>,
    _all: SemaphorePermit<'a>,
    connection: &'a Connection,
}

impl<'a> LongBody<'a> {
    /// Waits until another long body may be received; refused where the client sends its share already.
    async fn begin(service: &'a Service, connection: &'a Connection) -> Result<Self, HttpError> {
        let busy = |_| {
            let reason = format!("{LONG_BODIES_OF_CLIENT} of your long bodies are being received; try again");
            HttpError::busy(1, reason).closing()
        };
        let own = connection.client.long_bodies.try_acquire().map_err(busy)?;
        let all = taking_from_slow(&service.clients, HeldResource::Body, service.long_bodies.acquire());
        let all = all.await.expect("no semaphore of the service is ever closed");
        connection.hold(Some(HeldResource::Body));
        Ok(Self { _own: own, _all: all, connection })
    }
}

impl Drop for LongBody<'_> {
    fn drop(&mut self) {
        self.connection.hold(None);
    }
}

/// The whole body, within the limits of size and time.
async fn read_body(request: Request, service: &Service, connection: &Connection) -> Result<Bytes, HttpError> {
    let limits = &service.limits;
    // 128 bytes a point hold both coordinates at full precision with the quotes and escapes of any notation.
    let most = limits.max_points as usize * 128 + 65_536;
    let too_long = || {
        let reason = format!("the body is longer than {most} bytes, the most of one request; ask in parts");
        HttpError::new(StatusCode::PAYLOAD_TOO_LARGE, reason).closing()
    };
    let stated = request.headers().get(CONTENT_LENGTH).and_then(|length| length.to_str().ok()?.parse().ok());
    if stated.is_some_and(|length: u64| length > most as u64) {
        return Err(too_long());
    }
    let receive = async {
        let _permits = match stated {
            Some(..=SHORT_BODY) => None,
            _ => Some(LongBody::begin(service, connection).await?),
        };
        Ok::<_, HttpError>(to_bytes(request.into_body(), most).await)
    };
    let timeout = Duration::from_secs(limits.timeout_s.into());
    match tokio::time::timeout(timeout, receive).await {
        // Either the body exceeds the limit, or the client has left and reads no answer.
        Ok(Ok(body)) => body.map_err(|_| too_long()),
        Ok(Err(refusal)) => Err(refusal),
        Err(_) => {
            let reason = format!("the body did not arrive within {} s", limits.timeout_s);
            Err(HttpError::new(StatusCode::REQUEST_TIMEOUT, reason).closing())
        }
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use proptest::prelude::*;

    fn read(body: &[u8], is_json: bool) -> Result<Parameters, HttpError> {
        let runtime = tokio::runtime::Builder::new_current_thread().build().expect("a thread");
        let form = if is_json { BodyForm::Json } else { BodyForm::Form };
        runtime.block_on(Parameters::from_body(Bytes::copy_from_slice(body), Some(form)))
    }

    pub fn form(text: &str) -> Parameters {
        read(text.as_bytes(), false).expect("sound")
    }

    #[test]
    fn escapes_are_read_and_later_values_replace_earlier_ones() {
        let parameters = form("locations=1%2C2%7C3,4&&a+b=c%20d&broken=100%&empty");
        assert_eq!(parameters.get("locations"), Some("1,2|3,4"));
        assert_eq!(parameters.get("a b"), Some("c d"));
        assert_eq!((parameters.get("broken"), parameters.get("empty")), (Some("100%"), Some("")));
        assert_eq!(form("a=1&a=2").get("a"), Some("2"));
    }

    #[test]
    fn json_holds_the_same_as_a_form() {
        let body = br#"{"locations": ["1,2", "3,4"], "samples": 7, "nodata_value": -9999.5, "format": null}"#;
        let parameters = read(body, true).expect("sound");
        assert_eq!(parameters.get("locations"), Some("1,2|3,4"));
        assert_eq!((parameters.get("samples"), parameters.get("nodata_value")), (Some("7"), Some("-9999.5")));
        assert_eq!(parameters.get("format"), None);
        for wrong in ["", "[]", "{", "{\"a\":true}", "{\"a\":{}}", "{\"a\":[1]}", "{\"a\":[[]]}", "{} {}"] {
            let refused = read(wrong.as_bytes(), true);
            assert!(refused.is_err_and(|refusal| refusal.status() == 400), "{wrong}");
        }
    }

    #[test]
    fn the_number_of_parameters_is_limited() {
        let many: String = (0..100).map(|index| format!("p{index}=1&")).collect();
        assert!(read(many.as_bytes(), false).is_err());
    }

    proptest! {
        #[test]
        fn no_body_breaks_the_readers(bytes in proptest::collection::vec(any::<u8>(), 0..200)) {
            let _ = read(&bytes, false);
            let _ = read(&bytes, true);
        }

        #[test]
        fn whatever_is_escaped_comes_back(text in "\\PC{0,40}") {
            let escaped: String = text.bytes().map(|byte| format!("%{byte:02x}")).collect();
            let parameters = form(&format!("a={escaped}"));
            prop_assert_eq!(parameters.get("a"), Some(text.as_str()));
        }
    }
}
