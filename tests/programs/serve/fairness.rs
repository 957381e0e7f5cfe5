//! Clients that take all they can get: others are served as if they were not there.

use std::io::{Read, Write};
use std::net::{SocketAddr, TcpStream};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread::sleep;
use std::time::{Duration, Instant};

use tokio::net::TcpSocket;
use tokio::runtime::{Builder, Runtime};

use crate::common::scratch::Scratch;
use crate::serve::client::{Answer, Server, read_answer};
use crate::serve::heights::folder;

/// Connects from addresses of this machine, each of which is a client.
struct Clients {
    runtime: Runtime,
}

impl Clients {
    fn new() -> Self {
        Self { runtime: Builder::new_current_thread().enable_io().build().expect("a runtime") }
    }

    /// A connection of the client `last`, which takes few bytes before it reads any.
    fn connect(&self, server: &Server, last: u8) -> TcpStream {
        let from = SocketAddr::from(([127, 0, 1, last], 0));
        let connect = async {
            let socket = TcpSocket::new_v4()?;
            socket.set_recv_buffer_size(4096)?;
            socket.bind(from)?;
            socket.connect(server.address).await?.into_std()
        };
        let stream = self.runtime.block_on(connect).expect("it listens");
        stream.set_nonblocking(false).expect("a socket");
        stream.set_read_timeout(Some(Duration::from_secs(60))).expect("a timeout");
        stream
    }

    fn ask(&self, server: &Server, last: u8, request: &str) -> Answer {
        ask(self.connect(server, last), request)
    }
}

fn ask(mut stream: TcpStream, request: &str) -> Answer {
    let _ = stream.write_all(request.as_bytes());
    read_answer(&mut std::io::BufReader::new(stream), true)
}

fn get(path: &str) -> String {
    format!("GET {path} HTTP/1.1\r\nhost: localhost\r\n\r\n")
}

/// The request of a client that wants little.
fn modest() -> String {
    get("/v1/grid?locations=50.005,10.005&interpolation=nearest")
}

/// A request for as many heights as there may be, a megabyte of them.
fn greedy() -> String {
    let body = format!("locations={}", vec!["50.0123456789,10.0123456789"; 10_000].join("|"));
    format!("POST /v1/grid HTTP/1.1\r\nhost: localhost\r\ncontent-length: {}\r\n\r\n{body}", body.len())
}

#[test]
fn connections_that_a_few_clients_hold_are_taken_back_for_others() {
    let scratch = folder();
    let server = Server::start(scratch.folder(), &["grid.asc", "--max-connections", "64"]);
    let clients = Clients::new();
    let begins =
        ["", "GET /v1/gr", "POST /v1/grid HTTP/1.1\r\nhost: localhost\r\ncontent-length: 100\r\n\r\nl"];
    let held: Vec<TcpStream> = (0..96)
        .map(|index: u8| {
            let mut stream = clients.connect(&server, 1 + index % 3);
            let _ = stream.write_all(begins[usize::from(index / 3) % 3].as_bytes());
            stream
        })
        .collect();
    sleep(Duration::from_millis(300));
    for _ in 0..20 {
        let answer = clients.ask(&server, 9, &modest());
        assert_eq!(answer.ok()["results"][0]["elevation"], 90.0);
    }
    // Those who hold as much as anybody keep it.
    let mut kept = 0;
    for stream in held {
        stream.set_read_timeout(Some(Duration::from_millis(1))).expect("a timeout");
        let mut byte = [0];
        let end = (&stream).read(&mut byte);
        kept += usize::from(end.is_err_and(|error| {
            matches!(error.kind(), std::io::ErrorKind::WouldBlock | std::io::ErrorKind::TimedOut)
        }));
    }
    assert!((50..=64).contains(&kept), "{kept}");
}

#[test]
#[ignore = "slow: waits for a time limit"]
fn answers_that_nobody_reads_take_a_bounded_amount_of_memory() {
    let scratch = folder();
    let server = Server::start(scratch.folder(), &["grid.asc"]);
    let clients = Clients::new();
    assert_eq!(clients.ask(&server, 9, &greedy()).status, 200);
    let before = server.resident_kib();
    let request = greedy();
    let held: Vec<TcpStream> = (0..200)
        .map(|index: u8| {
            let mut stream = clients.connect(&server, 1 + index % 8);
            let _ = stream.write_all(request.as_bytes());
            stream
        })
        .collect();
    let begun = Instant::now();
    let mut most = 0;
    while begun.elapsed() < Duration::from_secs(5) {
        let asked = Instant::now();
        assert_eq!(clients.ask(&server, 9, &modest()).status, 200);
        assert!(asked.elapsed() < Duration::from_secs(2), "{:?}", asked.elapsed());
        most = most.max(server.resident_kib());
        sleep(Duration::from_millis(50));
    }
    drop(held);
    // Without a bound these are 260 MB of answers.
    assert!(most < before + 120 * 1024, "{before} KiB before, {most} KiB at most");
    assert_eq!(clients.ask(&server, 9, &greedy()).status, 200);
}

/// A plain, of which a viewshed from the ground itself costs a line of sight for every post: seconds.
fn plain(posts: usize) -> Scratch {
    let scratch = Scratch::new();
    let row = "0 ".repeat(posts) + "\n";
    let head = format!("ncols {posts}\nnrows {posts}\nxllcorner 500000\nyllcorner 5000000\ncellsize 10\n");
    scratch.write("plain.asc", head + &row.repeat(posts));
    scratch
}

fn viewshed(range_m: u32) -> String {
    get(&format!(
        "/v1/viewshed?observer=502003,5002004&observer_height=0&earth=flat&crs=native&format=summary&range={range_m}"
    ))
}

/// Processor time of the service in hundredths of a second.
#[cfg(target_os = "linux")]
fn processor_time(server: &Server) -> u64 {
    let text = std::fs::read_to_string(format!("/proc/{}/stat", server.id())).expect("it runs");
    let fields: Vec<&str> = text.rsplit(')').next().expect("a name").split_whitespace().collect();
    fields[11].parse::<u64>().expect("user") + fields[12].parse::<u64>().expect("system")
}

#[cfg(target_os = "linux")]
#[test]
fn work_stops_when_the_client_leaves() {
    let scratch = plain(900);
    let server = Server::start(scratch.folder(), &["plain.asc", "--timeout", "600"]);
    let in_a_second = || {
        let before = processor_time(&server);
        sleep(Duration::from_secs(1));
        processor_time(&server) - before
    };
    let mut stream = server.connect();
    stream.write_all(viewshed(1_000_000).as_bytes()).expect("it reads");
    sleep(Duration::from_millis(700));
    assert!(in_a_second() >= 10, "it works");
    drop(stream);
    sleep(Duration::from_millis(700));
    assert!(in_a_second() <= 3, "it has stopped");
    // It has its turn again at once.
    assert_eq!(server.raw(viewshed(100).as_bytes()).status, 200);
}

#[test]
fn who_asks_for_much_waits_for_himself() {
    let scratch = plain(400);
    let server = Server::start(scratch.folder(), &["plain.asc", "--timeout", "600"]);
    let clients = Clients::new();
    let greedy: Vec<TcpStream> = (0..4).map(|_| clients.connect(&server, 1)).collect();
    let modest = clients.connect(&server, 9);
    let done = AtomicUsize::new(0);
    std::thread::scope(|scope| {
        let done = &done;
        for stream in greedy {
            scope.spawn(move || {
                assert_eq!(ask(stream, &viewshed(1_000_000)).status, 200);
                done.fetch_add(1, Ordering::SeqCst);
            });
        }
        sleep(Duration::from_millis(200));
        let before = done.load(Ordering::SeqCst);
        assert_eq!(ask(modest, &viewshed(100)).status, 200);
        let meanwhile = done.load(Ordering::SeqCst) - before;
        assert!(meanwhile <= 2, "{meanwhile} of another client came first");
    });
}

#[test]
fn a_request_for_another_host_is_refused() {
    let scratch = folder();
    let server = Server::start(scratch.folder(), &["grid.asc", "--host", "hills.lan"]);
    let with = |head: &str| server.raw(format!("GET /health HTTP/1.1\r\n{head}\r\n").as_bytes());
    let port = server.address.port();
    for host in ["localhost", "127.0.0.1", "[::1]", "hills.lan", &format!("localhost:{port}")] {
        assert_eq!(with(&format!("host: {host}\r\n")).status, 200, "{host}");
    }
    let refused = with("host: evil.example\r\n").refused(421);
    assert!(refused.contains("'evil.example'") && refused.contains("--host evil.example"), "{refused}");
    with("").refused(400);
    with("host: localhost\r\nhost: localhost\r\n").refused(400);
    with("host: a b\r\n").refused(400);
    let absolute = b"GET http://evil.example/health HTTP/1.1\r\nhost: localhost\r\n\r\n";
    server.raw(absolute).refused(421);
    assert_eq!(server.raw(b"GET /health HTTP/1.0\r\n\r\n").status, 200);
}

#[test]
fn a_form_in_parts_holds_the_same_parameters() {
    let scratch = folder();
    let server = Server::start(scratch.folder(), &["grid.asc"]);
    let part = |name: &str, value: &str| {
        format!("--cut\r\ncontent-disposition: form-data; name=\"{name}\"\r\n\r\n{value}\r\n")
    };
    let ask = |parts: &str| {
        server.post("/v1/grid", "multipart/form-data; boundary=cut", &format!("{parts}--cut--\r\n"))
    };
    let answer = ask(&(part("locations", "50.005,10.005") + &part("interpolation", "nearest")));
    assert_eq!(answer.ok()["results"][0]["elevation"], 90.0);
    assert!(ask("").refused(400).contains("'locations' is missing"));
    let many: String = (0..100).map(|index| part(&format!("p{index}"), "1")).collect();
    assert!(ask(&many).refused(400).contains("32 parameters"));
    let cut_short = server.post("/v1/grid", "multipart/form-data; boundary=cut", "--cut\r\ncontent-dispo");
    cut_short.refused(400);
}

#[test]
fn the_document_of_the_service_lists_what_it_answers() {
    let scratch = folder();
    let server = Server::start(scratch.folder(), &["grid.asc", "plain.asc"]);
    let document = server.get("/openapi.json").ok();
    assert_eq!(document["openapi"], "3.1.0");
    let page = server.get("/").body;
    let paths = document["paths"].as_object().expect("paths");
    let analyses = sandtable_catalog::kinds().count();
    assert_eq!(paths.len(), 13 + analyses, "{:?}", paths.keys());
    for (path, item) in paths {
        let address = path.replace("{dataset}", "grid").replace("{z}/{x}/{y}", "0/0/0");
        assert_ne!(server.get(&address).status, 404, "{path}");
        assert!(page.contains(&path.replace("{dataset}", "DATASET")), "{path}:\n{page}");
        for parameter in item["get"]["parameters"].as_array().expect("a list") {
            let name = parameter["name"].as_str().expect("a name");
            assert!(page.contains(name), "{name}:\n{page}");
            // What is listed is known; what is not is refused where parameters are.
            if parameter["in"] == "query" && path != "/v1/{dataset}" {
                let asked = server.get(&format!("{address}?dataset=grid&{name}=,")).body;
                assert!(!asked.contains("there is no parameter"), "{path} {name}: {asked}");
            }
        }
        let is_query = path.starts_with("/v1/") || path.starts_with("/api/");
        assert_eq!(item.get("post").is_some(), is_query, "{path}");
    }
    let list = server.get("/datasets").ok();
    assert_eq!(list["results"][0]["name"], "grid");
    assert_eq!((&list["status"], list["results"].as_array().map(Vec::len)), (&"OK".into(), Some(2)));
}
