//! The page at `/`: a map of relief on which a person clicks heights, profiles, lines of sight and viewsheds.
//!
//! ```text
//! /            page.html: the elements, with the prefix of all paths as its base
//! /page.css    the style
//! /page.js     the scripts, one after the other: service, map, tools, charts, main
//! ```
//!
//! The page is a client like any other: it asks the addresses that `/help` lists, and shows what they answer. It is written by
//! hand, and loads nothing from anywhere else, which its `Content-Security-Policy` makes certain: no text from a file that is
//! served can become a script of it.

use axum::http::header::{
    ACCEPT, CONTENT_SECURITY_POLICY, CONTENT_TYPE, REFERRER_POLICY, X_CONTENT_TYPE_OPTIONS, X_FRAME_OPTIONS,
};
use axum::http::{HeaderMap, HeaderName};
use axum::response::{IntoResponse, Response};

use crate::service::Service;

/// The path of the style.
pub const STYLE_PATH: &str = "/page.css";

/// The path of the scripts.
pub const SCRIPT_PATH: &str = "/page.js";

const PAGE: &str = include_str!("page/page.html");

const STYLE: &str = include_str!("page/page.css");

const SCRIPT: &str = concat!(
    "'use strict';\n",
    include_str!("page/service.js"),
    include_str!("page/map.js"),
    include_str!("page/charts.js"),
    include_str!("page/tools.js"),
    include_str!("page/main.js"),
);

/// The mark in the page for the base of its links.
const BASE: &str = "{{base}}";

/// What the page may do: use this service alone, and be part of no other page.
const POLICY: &str = "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; img-src data:; \
                      base-uri 'self'; form-action 'none'; frame-ancestors 'none'";

/// Whether a request is that of a browser for a page to show.
pub fn is_wanted(headers: &HeaderMap) -> bool {
    let stated = headers.get_all(ACCEPT).iter().filter_map(|value| value.to_str().ok());
    stated.flat_map(|value| value.split(',')).any(|kind| {
        let name = kind.split(';').next().unwrap_or_default();
        name.trim().eq_ignore_ascii_case("text/html")
    })
}

pub fn page(service: &Service) -> Response {
    // A prefix has no character that HTML reads as its own.
    secured("text/html; charset=utf-8", PAGE.replace(BASE, &service.prefix.before("/")))
}

pub fn style(_: &Service) -> Response {
    secured("text/css; charset=utf-8", STYLE.to_owned())
}

pub fn script(_: &Service) -> Response {
    secured("text/javascript; charset=utf-8", SCRIPT.to_owned())
}

fn secured(media_type: &'static str, text: String) -> Response {
    let headers: [(HeaderName, &'static str); 5] = [
        (CONTENT_TYPE, media_type),
        (CONTENT_SECURITY_POLICY, POLICY),
        (X_CONTENT_TYPE_OPTIONS, "nosniff"),
        (X_FRAME_OPTIONS, "DENY"),
        (REFERRER_POLICY, "no-referrer"),
    ];
    (headers, text).into_response()
}

#[cfg(test)]
mod tests {
    use super::*;
    use axum::http::HeaderValue;

    #[test]
    fn browsers_want_a_page_and_other_programs_a_list() {
        let wanted = |accept: &str| {
            let value = HeaderValue::from_str(accept).expect("a header");
            is_wanted(&HeaderMap::from_iter([(ACCEPT, value)]))
        };
        assert!(wanted("text/html,application/xhtml+xml,application/xml;q=0.9,*/*;q=0.8"));
        assert!(wanted("TEXT/HTML ; q=0.5"));
        for program in ["*/*", "", "text/plain", "application/json", "text/htmlx"] {
            assert!(!wanted(program), "{program}");
        }
        assert!(!is_wanted(&HeaderMap::new()));
    }

    #[test]
    fn the_page_has_no_script_of_its_own_and_names_no_other_host() {
        let attributes = ["onclick=", "onload=", "style=", "javascript:", "<style"];
        for word in attributes {
            assert!(!PAGE.contains(word), "{word} is not allowed by the policy");
        }
        assert_eq!(PAGE.matches("<script").count(), 1);
        for text in [PAGE, STYLE, SCRIPT] {
            assert!(!text.contains("://") && !text.contains("innerHTML") && !text.contains("eval("));
        }
        assert_eq!(PAGE.matches(BASE).count(), 1);
    }
}
