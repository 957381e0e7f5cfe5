//! Errors of reading a file by its address.

use std::time::Duration;

/// A file that cannot be read by its address. The message follows the address.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[allow(missing_docs, reason = "the messages explain the variants")]
pub enum RemoteError {
    #[error(
        "this program was built without reading by address; build it with `cargo build --features cloud`, or \
         fetch the file"
    )]
    NotBuilt,
    #[error("this address is not read: {0}")]
    Address(&'static str),
    #[error(
        "it is read from {0}, which this run may not read from; if you trust it, run again with --allow-remote {0}, in \
         Python with allow_remote=[\"{0}\"]"
    )]
    HostNotAllowed(String),
    #[error("the server redirects to {0}, which is not encrypted; name that address if you trust it")]
    Unencrypted(String),
    #[error("there is no such file")]
    Missing,
    #[error("the server refuses it: {0}; see the variables of credentials, such as AWS_ACCESS_KEY_ID")]
    Denied(String),
    #[error("it changed while it was read; run again")]
    Changed,
    #[error(
        "it has {bytes} bytes, more than the {most} that are read whole; fetch and cut it, or make a tiled GeoTIFF of it"
    )]
    TooLarge { bytes: u64, most: u64 },
    #[error("the server sends all of the file in place of the part that is asked for; fetch the file")]
    NoRanges,
    #[error("the server sends {got} bytes in place of {asked}")]
    Length { asked: u64, got: u64 },
    #[error("the server sends more bytes than were asked for")]
    TooLong,
    #[error("the server sends a broken reply: {0}")]
    BrokenReply(&'static str),
    #[error("the server did not answer within {} s", .0.as_secs_f64())]
    Timeout(Duration),
    #[error(
        "the certificate of {host} is not to be trusted: {reason}; whom to trust is a setting of the system, or a PEM file that \
         SSL_CERT_FILE names"
    )]
    Certificate { host: String, reason: String },
    #[error(
        "no connection can be encrypted: {0}; the certificates of authorities are those of the system, or of a PEM file that \
         SSL_CERT_FILE names"
    )]
    NoEncryption(String),
    #[error("it cannot be fetched: {0}")]
    Store(String),
}

impl RemoteError {
    /// Whether a companion of a file that gives this error is taken as not there. Stores that may not be listed refuse what is
    /// not there.
    pub fn is_absence(&self) -> bool {
        matches!(self, Self::Missing | Self::Denied(_))
    }
}
