//! `ETag` and `If-None-Match` (RFC 9110): a client, or a cache before the service, that has an answer is not sent it again.
//!
//! The tag is a hash of the answer's bytes. Answers are functions of the files that are served, of the version of the program and of
//! the request, with the same bits on every machine; so are their tags, without a word between the machines. A tag of the
//! request and the files would save computing the answer again, but needs a hash of all files before the first request.

use std::sync::Arc;

use axum::body::{Body, Bytes, to_bytes};
use axum::extract::{Request, State};
use axum::http::header::{CONTENT_LENGTH, CONTENT_TYPE, ETAG, IF_NONE_MATCH};
use axum::http::{HeaderMap, HeaderValue, Method, StatusCode};
use axum::middleware::Next;
use axum::response::Response;

use crate::service::Service;
use crate::{health, ready};
use sandtable_files::fingerprint::content_hash;

/// Answers longer than this are hashed on another thread: a millisecond.
const LIGHT_BYTES: usize = 256 * 1024;

/// Digits of a tag: 128 bits.
const DIGITS: usize = 32;

/// Tags the answer to a request, and leaves its body out where the client has it already.
pub async fn tag(State(service): State<Arc<Service>>, request: Request, next: Next) -> Response {
    let is_read = matches!(*request.method(), Method::GET | Method::HEAD);
    let path = request.uri().path().strip_prefix(service.prefix.as_str());
    // The state of this one machine is no answer of all.
    let is_state = path.is_some_and(|path| [health::PATH, ready::PATH].contains(&path));
    let known: Vec<HeaderValue> = request.headers().get_all(IF_NONE_MATCH).iter().cloned().collect();
    let response = next.run(request).await;
    if !is_read || is_state || response.status() != StatusCode::OK {
        return response;
    }
    let (mut parts, body) = response.into_parts();
    // A body that is made of memory, as all here, is neither copied nor waited for, and does not fail.
    let bytes = to_bytes(body, usize::MAX).await.unwrap_or_default();
    let Some(tag) = tag_of(bytes.clone()).await else {
        return Response::from_parts(parts, Body::from(bytes));
    };
    let is_known = known.iter().any(|stated| matches(stated.as_bytes(), tag.as_bytes()));
    parts.headers.insert(ETAG, tag);
    if !is_known {
        return Response::from_parts(parts, Body::from(bytes));
    }
    without_content(&mut parts.headers);
    parts.status = StatusCode::NOT_MODIFIED;
    Response::from_parts(parts, Body::empty())
}

fn without_content(headers: &mut HeaderMap) {
    headers.remove(CONTENT_LENGTH);
    headers.remove(CONTENT_TYPE);
}

async fn tag_of(bytes: Bytes) -> Option<HeaderValue> {
    let hash = match bytes.len() > LIGHT_BYTES {
        true => tokio::task::spawn_blocking(move || content_hash(&bytes)).await.ok()?,
        false => content_hash(&bytes),
    };
    HeaderValue::from_str(&format!("\"{}\"", &hash[..DIGITS])).ok()
}

/// Whether a list of tags, or `*`, holds a tag; a cache may have made it weak.
fn matches(list: &[u8], tag: &[u8]) -> bool {
    list.split(|&byte| byte == b',').map(<[u8]>::trim_ascii).any(|stated| {
        let stated = stated.strip_prefix(b"W/").unwrap_or(stated);
        stated == b"*" || stated == tag
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tag_is_found_in_lists_strong_or_weak() {
        for list in ["\"ab\"", "\"x\", \"ab\"", "W/\"ab\"", " * ", "\"x\",W/\"ab\",\"y\""] {
            assert!(matches(list.as_bytes(), b"\"ab\""), "{list}");
        }
        for list in ["", "ab", "\"abc\"", "\"x\" \"ab\"", "w/\"ab\""] {
            assert!(!matches(list.as_bytes(), b"\"ab\""), "{list}");
        }
    }
}
