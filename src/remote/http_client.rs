//! The only HTTP client: every request of a store goes through it, including those for access tokens.
//!
//! It sends to hosts that are allowed and no others, redirections included; it reads no more of a reply than was asked for,
//! and waits no longer than [`RemoteTimes`] allow.

use std::future::Future;
use std::pin::Pin;
use std::sync::Once;

use object_store::ClientOptions;
use object_store::client::{
    ClientConfigKey, HttpClient, HttpConnector, HttpError, HttpRequest, HttpResponse, HttpService,
};
use reqwest::header::{CONTENT_LENGTH, CONTENT_RANGE, HeaderMap, HeaderValue, RANGE};
use reqwest::redirect::Policy;
use reqwest::{Client, Response, StatusCode, Url};

use crate::access::RemoteAccess;
use crate::error::RemoteError;
use crate::request_error::{fault, host_of, plain, request_error};
use crate::times::RemoteTimes;
use crate::traffic::Traffic;
use sandtable_base::message::chain::error_text;

/// The most redirections of a request: one to the bucket's own region, one to a host of its own.
const MOST_REDIRECTIONS: usize = 4;
/// The most bytes of a reply that is no part of a file: a token, or the text of an error.
const OTHER_REPLY_BYTES: u64 = 64 << 10;

/// Makes clients that send to allowed hosts alone.
#[derive(Clone, Debug)]
pub(crate) struct GuardedConnector {
    pub access: RemoteAccess,
    pub times: RemoteTimes,
}

/// A client that sends to allowed hosts alone.
#[derive(Debug)]
struct GuardedClient {
    client: Client,
    access: RemoteAccess,
    times: RemoteTimes,
    /// Whether the first address may be one without encryption.
    sends_plain: bool,
}

impl HttpConnector for GuardedConnector {
    fn connect(&self, options: &ClientOptions) -> object_store::Result<HttpClient> {
        // Without a provider a client panics.
        static PROVIDER: Once = Once::new();
        PROVIDER.call_once(|| drop(rustls::crypto::ring::default_provider().install_default()));
        let access = self.access.clone();
        let redirection = Policy::custom(move |attempt| {
            let was_plain = attempt.previous().last().is_some_and(|url| url.scheme() == "http");
            let fault = if attempt.previous().len() > MOST_REDIRECTIONS {
                Some(RemoteError::BrokenReply("it redirects again and again"))
            } else if attempt.url().scheme() == "http" && !was_plain {
                Some(RemoteError::Unencrypted(host_of(attempt.url())))
            } else {
                check_host(&access, attempt.url()).err()
            };
            match fault {
                Some(fault) => attempt.error(fault),
                None => attempt.follow(),
            }
        });
        let client = Client::builder()
            .redirect(redirection)
            .connect_timeout(self.times.connect)
            .read_timeout(self.times.silence)
            .user_agent(concat!("sandtable/", env!("CARGO_PKG_VERSION")))
            .build()
            .map_err(|error| RemoteError::NoEncryption(plain(&error_text(&error))))
            .map_err(|error| object_store::Error::Generic { store: "HTTP client", source: error.into() })?;
        let sends_plain = options.get_config_value(&ClientConfigKey::AllowHttp).as_deref() == Some("true");
        let (access, times) = (self.access.clone(), self.times);
        Ok(HttpClient::new(GuardedClient { client, access, times, sends_plain }))
    }
}

fn check_host(access: &RemoteAccess, url: &Url) -> Result<(), RemoteError> {
    let host = host_of(url);
    if access.allows(&host) { Ok(()) } else { Err(RemoteError::HostNotAllowed(host)) }
}

impl HttpService for GuardedClient {
    fn call<'life0, 'async_trait>(
        &'life0 self,
        request: HttpRequest,
    ) -> Pin<Box<dyn Future<Output = Result<HttpResponse, HttpError>> + Send + 'async_trait>>
    where
        'life0: 'async_trait,
        Self: 'async_trait,
    {
        Box::pin(self.send(request))
    }
}

impl GuardedClient {
    async fn send(&self, request: HttpRequest) -> Result<HttpResponse, HttpError> {
        let (parts, body) = request.into_parts();
        let url: Url = parts
            .uri
            .to_string()
            .parse()
            .map_err(|_| fault(RemoteError::Address("its host or path is none of a URL")))?;
        if url.scheme() != "https" && !self.sends_plain {
            return Err(fault(RemoteError::Unencrypted(host_of(&url))));
        }
        check_host(&self.access, &url).map_err(fault)?;
        let asked = asked_range(&parts.headers);
        let mut request = reqwest::Request::new(parts.method, url);
        *request.headers_mut() = parts.headers;
        if let Some(bytes) = body.as_bytes() {
            *request.body_mut() = Some(bytes.clone().into());
        }
        Traffic::count_request();
        let reply = self.client.execute(request).await.map_err(|error| request_error(error, &self.times))?;
        checked_reply(reply, asked, &self.times).await
    }
}

/// The first and last byte that a request asks for.
fn asked_range(headers: &HeaderMap) -> Option<(u64, u64)> {
    let (first, last) = headers.get(RANGE)?.to_str().ok()?.strip_prefix("bytes=")?.split_once('-')?;
    Some((first.parse().ok()?, last.parse().ok()?)).filter(|(first, last)| first <= last)
}

/// The reply with its body, which has no more bytes than were asked for.
async fn checked_reply(
    mut reply: Response,
    asked: Option<(u64, u64)>,
    times: &RemoteTimes,
) -> Result<HttpResponse, HttpError> {
    let (status, mut headers) = (reply.status(), reply.headers().clone());
    let most = match asked {
        Some(_) if status == StatusCode::OK => return Err(fault(RemoteError::NoRanges)),
        Some((first, last)) if status == StatusCode::PARTIAL_CONTENT => {
            check_content_range(&headers, first, last).map_err(fault)?;
            last - first + 1
        }
        _ => OTHER_REPLY_BYTES,
    };
    let mut bytes = Vec::new();
    while let Some(part) = reply.chunk().await.map_err(|error| request_error(error, times))? {
        Traffic::count_bytes(part.len());
        if bytes.len() as u64 + part.len() as u64 > most {
            return Err(fault(RemoteError::TooLong));
        }
        bytes.extend_from_slice(&part);
    }
    // Replies in chunks have none.
    headers.insert(CONTENT_LENGTH, HeaderValue::from(bytes.len()));
    let mut checked = HttpResponse::new(bytes.into());
    *checked.status_mut() = status;
    *checked.headers_mut() = headers;
    Ok(checked)
}

/// Checks that a reply is of the range that was asked for, or of its part before the end of the file.
fn check_content_range(headers: &HeaderMap, first: u64, last: u64) -> Result<(), RemoteError> {
    let broken = RemoteError::BrokenReply("its Content-Range is not the range that was asked for");
    let stated = headers.get(CONTENT_RANGE).and_then(|value| value.to_str().ok()).and_then(|value| {
        let (range, size) = value.trim().strip_prefix("bytes ")?.split_once('/')?;
        let (from, to) = range.split_once('-')?;
        Some((from.parse::<u64>().ok()?, to.parse::<u64>().ok()?, size.parse::<u64>().ok()?))
    });
    let Some((from, to, size)) = stated else { return Err(broken) };
    let is_asked = from == first && to < size && (to == last || (to < last && to + 1 == size));
    if is_asked { Ok(()) } else { Err(broken) }
}

#[cfg(test)]
mod tests {
    use std::io::{Read, Seek, SeekFrom, Write};
    use std::net::TcpListener;
    use std::sync::Arc;
    use std::sync::atomic::{AtomicUsize, Ordering};
    use std::thread;

    use super::*;
    use crate::address::{AllowedHost, RemoteAddress};
    use crate::file::RemoteFile;
    use crate::store::StoredFile;

    const FILE_BYTES: usize = 50_000;

    /// A server that answers each request by what `reply` makes of its number, first and last byte; returns its host, and the
    /// count of requests.
    fn serve(reply: impl Fn(usize, usize, usize) -> Vec<u8> + Send + 'static) -> (String, Arc<AtomicUsize>) {
        let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
        let host = listener.local_addr().expect("bound").to_string();
        let count = Arc::new(AtomicUsize::new(0));
        let counted = Arc::clone(&count);
        thread::spawn(move || {
            for stream in listener.incoming() {
                let Ok(mut stream) = stream else { return };
                let (mut head, mut part) = (Vec::new(), [0; 1024]);
                while !head.windows(4).any(|end| end == b"\r\n\r\n") {
                    match stream.read(&mut part) {
                        Ok(count) if count > 0 => head.extend_from_slice(&part[..count]),
                        _ => break,
                    }
                }
                let head = String::from_utf8_lossy(&head).to_ascii_lowercase();
                let range = head.split("range: bytes=").nth(1).and_then(|rest| rest.split("\r\n").next());
                let (first, last) = range.and_then(|range| range.split_once('-')).unwrap_or(("0", "0"));
                let number = |text: &str| text.trim().parse().unwrap_or(0);
                let index = counted.fetch_add(1, Ordering::SeqCst);
                let _ = stream.write_all(&reply(index, number(first), number(last)));
            }
        });
        (host, count)
    }

    fn byte(at: usize) -> u8 {
        (at % 251) as u8
    }

    fn part(first: usize, last: usize, e_tag: &str) -> Vec<u8> {
        let last = last.min(FILE_BYTES - 1);
        let mut reply = format!(
            "HTTP/1.1 206 Partial\r\ncontent-range: bytes {first}-{last}/{FILE_BYTES}\r\ncontent-length: {}\r\n\
             etag: \"{e_tag}\"\r\nconnection: close\r\n\r\n",
            last + 1 - first
        )
        .into_bytes();
        reply.extend((first..=last).map(byte));
        reply
    }

    fn status(line: &str) -> Vec<u8> {
        format!("HTTP/1.1 {line}\r\ncontent-length: 2\r\nconnection: close\r\n\r\nno").into_bytes()
    }

    fn allowing(hosts: &[&str]) -> RemoteAccess {
        let hosts = hosts.iter().map(|host| AllowedHost::parse(host).expect("a host")).collect();
        RemoteAccess { hosts, blocks: None }
    }

    fn read(host: &str, access: &RemoteAccess) -> Result<Vec<u8>, RemoteError> {
        let address = RemoteAddress::parse(&format!("http://{host}/dem.tif")).expect("an address")?;
        RemoteFile::open(
            StoredFile::at(&address, access, RemoteTimes::default())?,
            &address.to_string(),
            None,
        )?
        .read_whole(1 << 20)
    }

    fn read_from(host: &str) -> Result<Vec<u8>, RemoteError> {
        read(host, &allowing(&[host]))
    }

    #[test]
    fn ranges_of_a_server_make_the_file() {
        let (host, _) = serve(|_, first, last| part(first, last, "a"));
        assert_eq!(read_from(&host), Ok((0..FILE_BYTES).map(byte).collect()));
    }

    #[test]
    fn a_host_that_is_not_allowed_gets_no_request() {
        let (host, count) = serve(|_, first, last| part(first, last, "a"));
        let refused = Err(RemoteError::HostNotAllowed(host.clone()));
        assert_eq!(read(&host, &allowing(&[])), refused);
        assert_eq!(read(&host, &allowing(&["127.0.0.1", "example.org"])), refused);
        assert_eq!(count.load(Ordering::SeqCst), 0);
    }

    #[test]
    fn a_redirection_leads_to_allowed_hosts_alone() {
        let (other, count) = serve(|_, first, last| part(first, last, "a"));
        let to = other.clone();
        let (host, _) = serve(move |_, _, _| {
            format!("HTTP/1.1 302 Found\r\nlocation: http://{to}/dem.tif\r\ncontent-length: 0\r\nconnection: close\r\n\r\n")
                .into_bytes()
        });
        assert_eq!(read_from(&host), Err(RemoteError::HostNotAllowed(other.clone())));
        assert_eq!(count.load(Ordering::SeqCst), 0);
        let (host, _) = {
            let to = other.clone();
            serve(move |_, _, _| {
                format!("HTTP/1.1 302 Found\r\nlocation: http://{to}/dem.tif\r\ncontent-length: 0\r\nconnection: close\r\n\r\n")
                    .into_bytes()
            })
        };
        let read = read(&host, &allowing(&[&host, &other]));
        assert_eq!(read.map(|bytes| bytes.len()), Ok(FILE_BYTES));
    }

    #[test]
    fn replies_that_are_not_what_was_asked_for_are_errors() {
        let range = |line: &str, body: usize| {
            let mut reply = format!(
                "HTTP/1.1 206 Partial\r\ncontent-range: {line}\r\ncontent-length: {body}\r\nconnection: close\r\n\r\n"
            )
            .into_bytes();
            reply.extend(vec![0; body]);
            reply
        };
        let broken = |error: &RemoteError| matches!(error, RemoteError::BrokenReply(_));
        for line in [
            "bytes 1-8192/50000",
            "bytes 0-8192/50000",
            "bytes 0-99/50000",
            "bytes 0-18446744073709551615/18446744073709551615",
            "bytes 0-8191/*",
            "",
        ] {
            let reply = range(line, 8192);
            let (host, _) = serve(move |_, _, _| reply.clone());
            let error = read_from(&host).expect_err(line);
            assert!(broken(&error), "{line}: {error:?}");
        }
        // Fewer bytes than the range has, by its own statement.
        let (host, _) = serve(move |_, _, _| range("bytes 0-8191/50000", 9));
        let error = read_from(&host).expect_err("short");
        assert!(matches!(error, RemoteError::Length { asked: 8192, got: 9 }), "{error:?}");
    }

    #[test]
    fn a_body_without_end_is_read_no_further_than_was_asked_for() {
        let (host, _) = serve(|_, first, last| {
            let mut reply = format!(
                "HTTP/1.1 206 Partial\r\ncontent-range: bytes {first}-{last}/{FILE_BYTES}\r\nconnection: close\r\n\r\n"
            )
            .into_bytes();
            reply.extend(vec![0; 4 << 20]);
            reply
        });
        assert_eq!(read_from(&host), Err(RemoteError::TooLong));
    }

    #[test]
    fn a_server_without_ranges_is_told_by_its_first_answer() {
        let (host, count) = serve(|_, _, _| {
            let mut reply = b"HTTP/1.1 200 OK\r\nconnection: close\r\n\r\n".to_vec();
            reply.extend(vec![0; 4 << 20]);
            reply
        });
        assert_eq!(read_from(&host), Err(RemoteError::NoRanges));
        assert_eq!(count.load(Ordering::SeqCst), 1);
    }

    #[test]
    fn a_file_that_changes_between_two_requests_is_an_error() {
        let (host, _) = serve(|index, first, last| part(first, last, if index == 0 { "a" } else { "b" }));
        assert_eq!(read_from(&host), Err(RemoteError::Changed));
    }

    #[test]
    fn a_server_that_fails_is_not_tried_again_for_every_tile() {
        let (host, count) = serve(|index, first, last| match index {
            0 => part(first, last, "a"),
            _ => status("500 Broken"),
        });
        let address = RemoteAddress::parse(&format!("http://{host}/dem.tif")).expect("one").expect("sound");
        let place = StoredFile::at(&address, &allowing(&[&host]), RemoteTimes::default()).expect("allowed");
        let mut file = RemoteFile::open(place, &address.to_string(), None).expect("it answers once");
        for at in [10_000, 20_000, 40_000] {
            let read = file.seek(SeekFrom::Start(at)).and_then(|_| file.read(&mut [0; 100]));
            assert!(read.expect_err("it fails").to_string().contains("500"), "{at}");
        }
        // The first block, and one other with four more tries.
        assert_eq!(count.load(Ordering::SeqCst), 6);
    }

    #[test]
    fn what_fails_for_a_moment_is_tried_again_and_the_rest_is_not() {
        let (host, count) = serve(|index, first, last| match index {
            0 | 2 => status("503 Slow Down"),
            // It breaks off.
            3 => part(first, last, "a")[..200].to_vec(),
            _ => part(first, last, "a"),
        });
        assert_eq!(read_from(&host).map(|bytes| bytes.len()), Ok(FILE_BYTES));
        assert_eq!(count.load(Ordering::SeqCst), 5);
        for (line, expected) in
            [("404 Not Found", RemoteError::Missing), ("403 Forbidden", RemoteError::Denied(String::new()))]
        {
            let (host, count) = serve(move |_, _, _| status(line));
            let error = read_from(&host).expect_err(line);
            assert_eq!(std::mem::discriminant(&error), std::mem::discriminant(&expected), "{error:?}");
            assert_eq!(count.load(Ordering::SeqCst), 1, "{line}");
        }
    }
}
