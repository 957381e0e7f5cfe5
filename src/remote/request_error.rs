//! Errors of requests: what they say to a user, and whether another try is worth it.

use std::error::Error;
use std::io;
use std::iter::successors;

use object_store::client::{HttpError, HttpErrorKind};
use reqwest::Url;
use rustls::CertificateError;

use crate::error::RemoteError;
use crate::times::RemoteTimes;
use sandtable_base::message::chain::error_text;

/// The error of a request that would end the same way again.
pub(crate) fn fault(error: RemoteError) -> HttpError {
    HttpError::new(HttpErrorKind::Unknown, error)
}

/// The error of a request, with its kind: what is worth another try.
pub(crate) fn request_error(error: reqwest::Error, times: &RemoteTimes) -> HttpError {
    if let Some(own) = cause(&error) {
        return fault(own);
    }
    if let Some(reason) = certificate_fault(&error) {
        let host = error.url().map(host_of).unwrap_or_default();
        return fault(RemoteError::Certificate { host, reason });
    }
    if error.is_timeout() {
        let longest = if error.is_connect() { times.connect } else { times.silence };
        return HttpError::new(HttpErrorKind::Timeout, RemoteError::Timeout(longest));
    }
    let kind = if error.is_connect() { HttpErrorKind::Connect } else { HttpErrorKind::Interrupted };
    // Others print no cause of theirs.
    HttpError::new(kind, io::Error::other(error_text(&error.without_url())))
}

/// The error of this module among the causes of another.
pub(crate) fn cause(error: &(dyn Error + 'static)) -> Option<RemoteError> {
    causes(error).find_map(|error| error.downcast_ref::<RemoteError>().cloned())
}

/// An error and its causes. One of the system has what it wraps as its cause, which the standard library leaves out.
fn causes<'a>(error: &'a (dyn Error + 'static)) -> impl Iterator<Item = &'a (dyn Error + 'static)> {
    successors(Some(error), |&error| {
        let wrapped = error.downcast_ref::<io::Error>().and_then(io::Error::get_ref);
        wrapped.map(|error| error as &(dyn Error + 'static)).or_else(|| error.source())
    })
}

/// Why the certificate of a server is refused, where that is the cause of an error.
fn certificate_fault(error: &(dyn Error + 'static)) -> Option<String> {
    causes(error).find_map(|error| match error.downcast_ref::<rustls::Error>()? {
        rustls::Error::InvalidCertificate(CertificateError::UnknownIssuer) => {
            Some("no authority that this system trusts has signed it".into())
        }
        rustls::Error::InvalidCertificate(fault) => Some(plain(&fault.to_string())),
        _ => None,
    })
}

/// The host of a URL, with its port where that is not the default.
pub(crate) fn host_of(url: &Url) -> String {
    let host = url.host_str().unwrap_or_default();
    url.port().map_or_else(|| host.to_owned(), |port| format!("{host}:{port}"))
}

/// What a server says, fit for a message: one line of at most 300 characters.
pub(crate) fn plain(text: &str) -> String {
    const LONGEST: usize = 300;
    let words = text.split_whitespace().collect::<Vec<_>>().join(" ");
    let mut out: String = words.chars().filter(|character| !character.is_control()).take(LONGEST).collect();
    if words.chars().nth(LONGEST).is_some() {
        out.push('…');
    }
    out
}
