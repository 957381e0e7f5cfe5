//! How the program starts, tells, and ends.

use std::io::{BufReader, Read, Write};
use std::time::{Duration, Instant};

use crate::serve::client::{Server, read_answer};
use crate::serve::heights::folder;

#[test]
fn it_says_where_it_listens_and_nothing_more() {
    let scratch = folder();
    let server = Server::start(scratch.folder(), &["grid.asc", "plain.asc"]);
    assert!(server.address.ip().is_loopback() && server.address.port() != 0);
    assert_eq!(server.greeting, format!("listening at http://{}: grid, plain\n", server.address));
    assert_eq!(server.get("/v1/grid?locations=50,10").status, 200);
    server.signal("TERM");
    assert_eq!(server.ended(), (0, String::new()));
}

#[test]
fn asked_to_it_tells_each_request_in_a_line() {
    let scratch = folder();
    let server = Server::start(scratch.folder(), &["grid.asc", "--log"]);
    server.get("/v1/grid?locations=50,10");
    server.get("/nothing");
    server.signal("INT");
    let (code, log) = server.ended();
    assert_eq!(code, 0);
    let lines: Vec<&str> = log.lines().collect();
    assert!(lines[0].starts_with("GET /v1/grid 200 ") && lines[0].ends_with(" ms"), "{log}");
    assert!(lines[1].starts_with("GET /nothing 404 ") && lines.len() == 2, "{log}");
}

#[test]
fn one_connection_answers_many_requests_in_order() {
    let scratch = folder();
    let server = Server::start(scratch.folder(), &["grid.asc"]);
    let stream = server.connect();
    let mut reader = BufReader::new(stream.try_clone().expect("a clone"));
    let ask = |column: usize| {
        format!(
            "GET /v1/grid?locations=50.005,10.0{column}5&interpolation=nearest HTTP/1.1\r\nhost: localhost\r\n\r\n"
        )
    };
    // Both at once, then one after the other.
    (&stream).write_all((ask(0) + &ask(1)).as_bytes()).expect("it reads");
    let heights: Vec<_> =
        (0..2).map(|_| read_answer(&mut reader, true).ok()["results"][0]["elevation"].as_f64()).collect();
    assert_eq!(heights, [Some(90.0), Some(100.0)]);
    for column in 0..4 {
        (&stream).write_all(ask(column).as_bytes()).expect("it reads");
        let height = read_answer(&mut reader, true).ok()["results"][0]["elevation"].as_f64();
        assert_eq!(height, Some(90.0 + 10.0 * column as f64));
    }
}

#[test]
fn asked_to_end_it_answers_what_it_has_begun_and_takes_nothing_more() {
    let scratch = folder();
    let server = Server::start(scratch.folder(), &["grid.asc"]);
    let mut half = server.connect();
    half.write_all(b"POST /v1/grid HTTP/1.1\r\nhost: localhost\r\ncontent-length: 23\r\n\r\nlocations=")
        .expect("it reads");
    // An answer on a later connection shows that the earlier one was taken.
    assert_eq!(server.get("/health").status, 200);
    server.signal("TERM");
    std::thread::sleep(Duration::from_millis(300));
    half.write_all(b"50.005,10.005").expect("it reads");
    let answer = read_answer(&mut BufReader::new(&half), true);
    assert_eq!((answer.status, answer.header("connection")), (200, "close"), "{answer:?}");
    assert!(std::net::TcpStream::connect(server.address).is_err(), "nobody listens any more");
    assert_eq!(server.ended().0, 0);
}

#[test]
fn it_does_not_wait_for_ever_for_the_last_answers() {
    let scratch = folder();
    let server = Server::start(scratch.folder(), &["grid.asc", "--grace", "1"]);
    let mut half = server.connect();
    half.write_all(b"POST /v1/grid HTTP/1.1\r\nhost: localhost\r\ncontent-length: 23\r\n\r\nlocations=")
        .expect("it reads");
    assert_eq!(server.get("/health").status, 200);
    let begun = Instant::now();
    server.signal("TERM");
    assert_eq!(server.ended().0, 0);
    let took = begun.elapsed();
    assert!(took > Duration::from_millis(800) && took < Duration::from_secs(8), "{took:?}");
    assert!(matches!(half.read(&mut [0; 8]), Ok(0) | Err(_)));
}

#[test]
fn behind_a_prefix_every_address_and_every_link_lies_below_it() {
    let scratch = folder();
    let server = Server::start(scratch.folder(), &["grid.asc", "--prefix", "/terrain/v2"]);
    assert_eq!(server.greeting, format!("listening at http://{}/terrain/v2: grid\n", server.address));
    let plain = Server::start(scratch.folder(), &["grid.asc"]);
    for path in ["/v1/grid?locations=50,10", "/v1/los?from=50.001,10.001&to=50.004,10.004", "/datasets"] {
        assert_eq!(server.get(&format!("/terrain/v2{path}")).body, plain.get(path).body, "{path}");
        let refused = server.get(path).refused(404);
        assert!(refused.contains("/terrain/v2/v1/DATASET, /terrain/v2/v1/los"), "{refused}");
    }
    let api = server.get("/terrain/v2/openapi.json").ok();
    assert_eq!(api["servers"], serde_json::json!([{"url": "/terrain/v2"}]));
    assert!(api["paths"]["/v1/los"].is_object(), "paths are below the server's");
    for root in ["/terrain/v2", "/terrain/v2/"] {
        let page = server.get(root);
        assert_eq!(page.status, 200, "{root}");
        assert!(
            page.body.contains("GET /terrain/v2/health")
                && page.body.contains("Example: /terrain/v2/v1/grid?")
        );
        assert!(!page.body.contains(" /v1/"), "{}", page.body);
    }
    assert_eq!(server.get("/terrain").status, 404);
}

#[test]
fn it_is_ready_once_each_dataset_has_answered() {
    let scratch = folder();
    let server = Server::start(scratch.folder(), &["grid.asc", "plain.asc"]);
    let begun = Instant::now();
    loop {
        let answer = server.get("/ready");
        if answer.status == 200 {
            assert_eq!(answer.ok()["status"], "OK");
            break;
        }
        let reason = answer.refused(503);
        assert!(reason.contains("being prepared") && answer.header("retry-after") == "1", "{answer:?}");
        assert!(begun.elapsed() < Duration::from_secs(60), "it is never ready");
    }
    // A request is half received when the signal comes: its connection still answers.
    let half = server.connect();
    (&half).write_all(b"GET /ready HTTP/1.1\r\nhost: localhost\r\n").expect("it reads");
    assert_eq!(server.get("/health").status, 200);
    server.signal("TERM");
    std::thread::sleep(Duration::from_millis(300));
    (&half).write_all(b"\r\n").expect("it reads");
    let answer = read_answer(&mut BufReader::new(&half), true);
    assert!(answer.refused(503).contains("ends"), "{answer:?}");
    assert_eq!(server.ended().0, 0);
}

#[test]
fn equal_answers_have_equal_tags_on_every_machine_and_are_sent_once() {
    let scratch = folder();
    let (one, other) = (
        Server::start(scratch.folder(), &["grid.asc"]),
        Server::start(scratch.folder(), &["grid.asc", "--prefix", "/b", "--max-points", "500"]),
    );
    let heights = "/v1/grid?locations=50.002,10.003|50.001,10.001";
    let tag = one.get(heights).header("etag").to_owned();
    assert!(tag.len() == 34 && tag.starts_with('"') && tag.ends_with('"'), "{tag}");
    assert_eq!(other.get(&format!("/b{heights}")).header("etag"), tag);
    assert_ne!(one.get("/v1/grid?locations=50.002,10.003|50.001,10.002").header("etag"), tag);
    let ask = |method: &str, path: &str, known: &str| {
        one.raw(
            format!("{method} {path} HTTP/1.1\r\nhost: localhost\r\nif-none-match: {known}\r\n\r\n")
                .as_bytes(),
        )
    };
    for known in [&tag, &format!("\"x\", W/{tag}"), "*"] {
        let answer = ask("GET", heights, known);
        assert_eq!((answer.status, answer.body.as_str(), answer.header("etag")), (304, "", &*tag), "{known}");
    }
    assert_eq!(ask("GET", heights, "\"x\"").body, one.get(heights).body);
    let head = ask("HEAD", heights, "\"x\"");
    assert_eq!((head.status, head.header("etag")), (200, &*tag), "{head:?}");
    assert_eq!(ask("GET", "/v1/grid?locations=50", "*").status, 400, "a refusal is never known");
    for state in ["/health", "/ready"] {
        assert_eq!(one.get(state).header("etag"), "", "{state} is that of one machine");
    }
    let posted = one.post("/v1/grid", "application/json", "{\"locations\": \"50.002,10.003\"}");
    assert_eq!((posted.status, posted.header("etag")), (200, ""));
}
