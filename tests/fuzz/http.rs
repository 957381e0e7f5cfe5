//! The service over HTTP: requests of any bytes, and requests whose address, words and body are chosen by them.

use std::io::{ErrorKind, Read, Write};
use std::net::{Ipv4Addr, Shutdown, SocketAddr, TcpStream};
use std::path::Path;
use std::sync::OnceLock;
use std::time::Duration;

use sandtable_query::dataset::DatasetOptions;
use sandtable_query::service::{NamedFile, RequestLog, ServiceLimits, ServiceOptions};

/// Longer than the service lets a request or an answer take.
const PATIENCE: Duration = Duration::from_secs(20);

/// Starts of requests: what follows is a query.
const ADDRESSES: [&str; 9] = [
    "/v1/hill?locations=",
    "/v1/hill?",
    "/v1/profile?",
    "/v1/los?",
    "/v1/viewshed?",
    "/v1/",
    "/api/v1/lookup?",
    "/v1/analyze/slope?extent=",
    "/v1/analyze/viewsheds?format=json&posts=",
];

/// Forms in which a body may come.
const FORMS: [&str; 4] = [
    "application/json",
    "application/x-www-form-urlencoded",
    "multipart/form-data; boundary=b",
    "text/plain",
];

/// The address at which the service listens, once it does.
static ADDRESS: OnceLock<SocketAddr> = OnceLock::new();

fn options(dataset: &str) -> ServiceOptions {
    ServiceOptions {
        datasets: vec![NamedFile::parse(dataset).expect("a name")],
        dataset: DatasetOptions::default(),
        listen: SocketAddr::from((Ipv4Addr::LOCALHOST, 0)),
        hosts: Vec::new(),
        prefix: Default::default(),
        limits: ServiceLimits { timeout_s: 10, max_posts: 1000, ..ServiceLimits::default() },
        log: RequestLog::Off,
        write_line: |line| {
            if let Some((_, rest)) = line.split_once("http://") {
                let address = rest.split(": ").next().expect("an address before the names");
                ADDRESS.get_or_init(|| address.parse().expect("an address"));
            }
        },
    }
}

/// A service of the raster `hill`, which answers until the program ends.
fn service(hill: &Path) -> SocketAddr {
    static STARTED: OnceLock<()> = OnceLock::new();
    STARTED.get_or_init(|| {
        let hill = format!("hill={}", hill.display());
        std::thread::spawn(move || sandtable_serve::run(&options(&hill)).expect("a service that starts"));
    });
    *ADDRESS.wait()
}

/// The request that `bytes` choose, and whether the client has more to say after it.
fn request(bytes: &[u8]) -> Option<(Vec<u8>, bool)> {
    let (&choice, rest) = bytes.split_first()?;
    let (address, choice) = (usize::from(choice) % 10, usize::from(choice) / 10);
    let Some(address) = ADDRESSES.get(address) else { return Some((rest.to_vec(), false)) };
    // An address ends at the first space or line.
    let is_word = |byte: &u8| byte.is_ascii_graphic();
    let head = "Host: localhost\r\nConnection: close\r\n";
    let written = if choice % 2 == 0 {
        let words: Vec<u8> = rest.iter().copied().filter(is_word).collect();
        [b"GET ", address.as_bytes(), &words, b" HTTP/1.1\r\n", head.as_bytes(), b"\r\n"].concat()
    } else {
        let (form, length) = (FORMS[choice / 2 % FORMS.len()], rest.len());
        let address = address.split('?').next().expect("an address");
        let head = format!(
            "POST {address} HTTP/1.1\r\n{head}Content-Type: {form}\r\nContent-Length: {length}\r\n\r\n"
        );
        [head.as_bytes(), rest].concat()
    };
    Some((written, true))
}

/// Sends the request that `bytes` choose to a service of the raster `hill`.
///
/// # Panics
/// The service does not answer, fails, or answers what is no HTTP or, to a request that is, no JSON.
pub fn ask(hill: &Path, bytes: &[u8]) {
    let Some((request, is_whole)) = request(bytes) else { return };
    let mut stream = TcpStream::connect(service(hill)).expect("a service that listens");
    stream.set_read_timeout(Some(PATIENCE)).expect("a limit of time");
    // The service may answer and close before it has read everything.
    let _ = stream.write_all(&request);
    if !is_whole {
        let _ = stream.shutdown(Shutdown::Write);
    }
    let mut answer = Vec::new();
    match stream.read_to_end(&mut answer) {
        Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => {
            panic!("no end of the answer to {:?}", String::from_utf8_lossy(&request))
        }
        // What the service did not read makes the system reset the connection.
        _ => {}
    }
    let text = String::from_utf8_lossy(&answer);
    let Some(rest) = text.strip_prefix("HTTP/1.1 ").or_else(|| text.strip_prefix("HTTP/1.0 ")) else {
        assert!(
            !is_whole && answer.is_empty(),
            "no HTTP: {text:?} to {:?}",
            String::from_utf8_lossy(&request)
        );
        return;
    };
    assert!(!rest.starts_with("500"), "{text} to {:?}", String::from_utf8_lossy(&request));
    if is_whole
        && let Some((head, body)) = rest.split_once("\r\n\r\n")
        && head.contains("content-type: application/json")
    {
        let parsed: Result<serde_json::Value, _> = serde_json::from_str(body);
        assert!(parsed.is_ok(), "no JSON: {text} to {:?}", String::from_utf8_lossy(&request));
    }
}
