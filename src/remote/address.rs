//! Addresses of files: a scheme, a host or a bucket, and a path.

use std::fmt::{self, Display, Formatter};
use std::path::Path;

use crate::error::RemoteError;
use sandtable_base::message::suggest::quoted;

/// The longest address: keys of S3 have up to 1024 bytes.
const MOST_BYTES: usize = 4096;

/// The scheme of an address.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum AddressScheme {
    /// A web server without encryption.
    Http,
    /// A web server.
    Https,
    /// Amazon S3, and what speaks like it.
    S3,
    /// Google Cloud Storage.
    Gs,
    /// Azure Blob Storage.
    Az,
}

const SCHEMES: [(&str, AddressScheme); 5] = [
    ("http://", AddressScheme::Http),
    ("https://", AddressScheme::Https),
    ("s3://", AddressScheme::S3),
    ("gs://", AddressScheme::Gs),
    ("az://", AddressScheme::Az),
];

impl AddressScheme {
    /// The scheme with `://`.
    fn prefix(self) -> &'static str {
        SCHEMES.iter().find(|(_, scheme)| *scheme == self).map_or("", |(prefix, _)| prefix)
    }

    /// Whether the address names a host, rather than a bucket.
    pub fn is_web(self) -> bool {
        matches!(self, Self::Http | Self::Https)
    }
}

/// The address of a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RemoteAddress {
    /// How it is reached.
    pub scheme: AddressScheme,
    /// The host with its port, or the bucket or container.
    pub authority: String,
    /// The path after that and a `/`, as written.
    pub path: String,
}

/// Whether a name is an address, by its scheme.
pub fn is_address(name: &str) -> bool {
    split(name).is_some()
}

/// Whether a path is an address, by its scheme.
pub fn is_address_path(path: &Path) -> bool {
    path.to_str().is_some_and(is_address)
}

fn split(name: &str) -> Option<(AddressScheme, &str)> {
    SCHEMES.into_iter().find_map(|(prefix, scheme)| {
        let start = name.get(..prefix.len())?;
        start.eq_ignore_ascii_case(prefix).then_some((scheme, &name[prefix.len()..]))
    })
}

impl RemoteAddress {
    /// The address that `name` is; `None` where it is none.
    ///
    /// # Errors
    /// [`RemoteError::Address`]: it is none that can be read.
    pub fn parse(name: &str) -> Option<Result<Self, RemoteError>> {
        split(name).map(|(scheme, rest)| Self::of_parts(scheme, rest))
    }

    fn of_parts(scheme: AddressScheme, rest: &str) -> Result<Self, RemoteError> {
        let refused = |reason: &'static str| Err(RemoteError::Address(reason));
        let (authority, path) = rest.split_once('/').unwrap_or((rest, ""));
        let is_in_bucket_name = |byte: u8| byte.is_ascii_alphanumeric() || matches!(byte, b'.' | b'-' | b'_');
        let is_in_host = |byte: u8| is_in_bucket_name(byte) || matches!(byte, b':' | b'[' | b']');
        if rest.len() > MOST_BYTES {
            return refused("it is longer than 4096 bytes");
        }
        if rest.chars().any(|character| character.is_control() || character == '\\') {
            return refused("it contains a control character or \\");
        }
        if authority.contains('@') {
            return refused("it contains a user name or password; credentials come from the environment");
        }
        match scheme.is_web() {
            true if authority.is_empty() || !authority.bytes().all(is_in_host) => {
                return refused("it does not name a host, as in https://example.org/dem.tif");
            }
            false if authority.is_empty() || !authority.bytes().all(is_in_bucket_name) => {
                return refused("it does not name a bucket, as in s3://bucket/dem.tif");
            }
            true if path.contains(['?', '#']) => {
                return refused(
                    "addresses with ? or # are not read; signed ones are not needed with credentials",
                );
            }
            _ => {}
        }
        if path.split('/').any(|part| matches!(part, "" | "." | "..")) {
            return refused("its path is empty or has an empty part, . or ..");
        }
        let authority = if scheme.is_web() { authority.to_ascii_lowercase() } else { authority.to_owned() };
        Ok(Self { scheme, authority, path: path.to_owned() })
    }

    /// The host and port of a web address; the default port is left out.
    pub fn host(&self) -> Option<String> {
        let default = match self.scheme {
            AddressScheme::Http => ":80",
            AddressScheme::Https => ":443",
            _ => return None,
        };
        Some(self.authority.strip_suffix(default).unwrap_or(&self.authority).to_owned())
    }
}

impl Display for RemoteAddress {
    fn fmt(&self, out: &mut Formatter<'_>) -> fmt::Result {
        write!(out, "{}{}/{}", self.scheme.prefix(), self.authority, self.path)
    }
}

/// A host that may be read from: `HOST` at the default port of any scheme, or `HOST:PORT`.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct AllowedHost(String);

impl AllowedHost {
    /// The host of a name without scheme and path, in any case.
    ///
    /// # Errors
    /// A sentence: it is no host.
    pub fn parse(text: &str) -> Result<Self, String> {
        let is_in_host = |byte: u8| {
            byte.is_ascii_alphanumeric() || matches!(byte, b'.' | b'-' | b'_' | b':' | b'[' | b']')
        };
        if text.is_empty() || text.starts_with(':') || !text.bytes().all(is_in_host) {
            let text = quoted(text);
            return Err(format!(
                "'{text}' is no host; write HOST or HOST:PORT, as in s3.eu-west-1.amazonaws.com"
            ));
        }
        Ok(Self(text.to_ascii_lowercase()))
    }

    /// The host, with its port where one was named.
    pub fn name(&self) -> &str {
        &self.0
    }

    /// Whether this is `host`, which names its port where that is not the default.
    pub fn is(&self, host: &str) -> bool {
        self.0.eq_ignore_ascii_case(host)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parsed(name: &str) -> RemoteAddress {
        RemoteAddress::parse(name).expect("an address").expect("a sound one")
    }

    #[test]
    fn an_address_is_its_scheme_authority_and_path() {
        let address = parsed("S3://Bucket/a b/dem.tif");
        assert_eq!((address.scheme, address.authority.as_str()), (AddressScheme::S3, "Bucket"));
        assert_eq!(address.to_string(), "s3://Bucket/a b/dem.tif");
        assert_eq!(address.host(), None);
        assert_eq!(parsed("https://Example.org:443/x.tif").host().as_deref(), Some("example.org"));
        assert_eq!(parsed("http://[::1]:8080/x.tif").host().as_deref(), Some("[::1]:8080"));
        for name in ["dem.tif", "/a/s3://b/c", "s3:/a", "file:///a", "C:\\a", "ftp://a/b", "ß3://a"] {
            assert!(RemoteAddress::parse(name).is_none(), "{name}");
        }
    }

    #[test]
    fn an_address_that_leads_elsewhere_is_refused() {
        for name in [
            "s3://",
            "s3://bucket",
            "s3://bucket/",
            "s3:///a.tif",
            "s3://b/../a.tif",
            "s3://b/a//c.tif",
            "s3://evil.org#/a.tif",
            "https://user:secret@example.org/a.tif",
            "https://example.org/a.tif?token=1",
            "https://example.org/a\n.tif",
            "https:///a.tif",
        ] {
            assert!(RemoteAddress::parse(name).expect("an address").is_err(), "{name}");
        }
    }

    #[test]
    fn a_host_is_allowed_with_its_port_and_nothing_else() {
        let host = AllowedHost::parse("Example.org").expect("a host");
        assert!(host.is("example.org") && host.is("EXAMPLE.ORG"));
        assert!(!host.is("example.org:8080") && !host.is("evil-example.org") && !host.is("example.org.evil"));
        assert!(AllowedHost::parse("localhost:5000").expect("a host").is("localhost:5000"));
        for text in ["", "https://a.org", "a.org/b", "*", ":80", "a b"] {
            assert!(AllowedHost::parse(text).is_err(), "{text}");
        }
    }
}
