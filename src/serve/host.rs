//! The `Host` of requests: a page of another site must not read this service through its visitor's browser.
//!
//! Such a page lets its own name resolve to this machine (*DNS rebinding*); the browser then takes the service for a part of
//! that site, and says so: the request's `Host` is the site's name. An address in numbers resolves to nothing else, so
//! every one is accepted, and of names `localhost` and those that the service was told are its own.

use std::net::{Ipv4Addr, Ipv6Addr};
use std::sync::Arc;

use axum::extract::{Request, State};
use axum::http::header::HOST;
use axum::http::uri::Authority;
use axum::http::{StatusCode, Version};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};

use crate::reply::{HttpError, quoted};
use crate::service::Service;

/// The name that every machine has for itself.
const LOCALHOST: &str = "localhost";

/// Refuses requests that are for another host.
pub async fn check(State(service): State<Arc<Service>>, request: Request, next: Next) -> Response {
    match check_host(&request, &service.hosts) {
        Ok(()) => next.run(request).await,
        Err(refusal) => refusal.into_response(),
    }
}

fn check_host<B>(request: &axum::http::Request<B>, names: &[String]) -> Result<(), HttpError> {
    let mut stated = request.headers().get_all(HOST).iter();
    let (host, is_more) = (stated.next(), stated.next().is_some());
    if is_more {
        return Err(HttpError::wrong("the request has several Host headers; send one").closing());
    }
    if let Some(authority) = request.uri().authority() {
        check_name(authority, names)?;
    }
    match host {
        // HTTP/1.0 had no Host, and no browser speaks it.
        None if request.version() < Version::HTTP_11 => Ok(()),
        None => Err(HttpError::wrong("the request has no Host header; HTTP/1.1 needs one")),
        Some(host) => {
            let found = String::from_utf8_lossy(host.as_bytes());
            let authority = found.parse::<Authority>();
            let authority = authority.ok().filter(is_host_and_port);
            let wrong = || {
                HttpError::wrong(format!("the Host header is {}; write NAME or NAME:PORT", quoted(&found)))
            };
            check_name(&authority.ok_or_else(wrong)?, names)
        }
    }
}

/// Whether an authority is a host with or without a port, and nothing before it.
fn is_host_and_port(authority: &Authority) -> bool {
    let text = authority.as_str();
    !text.contains('@') && (text == authority.host() || authority.port_u16().is_some())
}

fn check_name(authority: &Authority, names: &[String]) -> Result<(), HttpError> {
    let host = authority.host();
    let is_v6 =
        || host.strip_prefix('[').and_then(|host| host.strip_suffix(']')?.parse::<Ipv6Addr>().ok()).is_some();
    let is_address = host.parse::<Ipv4Addr>().is_ok() || is_v6();
    let name = host.strip_suffix('.').unwrap_or(host);
    let is_known = |known: &str| known.eq_ignore_ascii_case(name);
    if is_address || is_known(LOCALHOST) || names.iter().any(|known| is_known(known)) {
        return Ok(());
    }
    let reason = format!(
        "this is not {}; ask for {LOCALHOST} or an address in numbers, or start the service with --host {}",
        quoted(host),
        quoted(host).trim_matches('\'')
    );
    Err(HttpError::new(StatusCode::MISDIRECTED_REQUEST, reason).closing())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn status(uri: &str, hosts: &[&str]) -> u16 {
        let request = hosts
            .iter()
            .fold(axum::http::Request::builder().uri(uri), |request, host| request.header(HOST, *host));
        let request = request.body(()).expect("a request");
        check_host(&request, &["hills.lan".to_owned()])
            .map_or_else(|refusal| refusal.status().as_u16(), |()| 200)
    }

    #[test]
    fn only_names_and_addresses_of_the_service_are_answered() {
        for host in [
            "localhost",
            "LOCALHOST:80",
            "localhost.",
            "127.0.0.1:8080",
            "[::1]:8080",
            "192.168.1.4",
            "hills.lan:1",
        ] {
            assert_eq!(status("/", &[host]), 200, "{host}");
        }
        for host in [
            "evil.example",
            "localhost.evil.example",
            "127.0.0.1.evil.example",
            "hills.lan.evil",
            "2130706433",
        ] {
            assert_eq!(status("/", &[host]), 421, "{host}");
        }
        for hosts in
            [&[][..], &["localhost", "localhost"], &[""], &["a b"], &["localhost:x"], &["me@localhost"]]
        {
            assert_eq!(status("/", hosts), 400, "{hosts:?}");
        }
        assert_eq!(status("http://evil.example/", &["localhost"]), 421, "the address counts as well");
        assert_eq!(status("http://localhost/", &["localhost"]), 200);
    }
}
