//! Requests that mean harm, or are broken: the service refuses, stays as large as it was, and goes on.

use std::io::{BufReader, Read, Write};
use std::time::{Duration, Instant};

use crate::common::scratch::Scratch;
use crate::serve::client::{Server, read_answer};
use crate::serve::heights::folder;

fn server(more: &[&str]) -> (Scratch, Server) {
    let scratch = folder();
    let server = Server::start(scratch.folder(), &[&["grid.asc"], more].concat());
    (scratch, server)
}

#[track_caller]
fn still_answers(server: &Server) {
    assert_eq!(
        server.get("/v1/grid?locations=50.005,10.005&interpolation=nearest").ok()["results"][0]["elevation"],
        90.0
    );
}

#[test]
fn what_is_no_http_is_refused() {
    let (_scratch, server) = server(&[]);
    for bytes in [
        &b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03"[..],
        b"hello\r\n\r\n",
        b"GET /v1/grid HTTP/9.9\r\n\r\n",
        b"GET /\x01 HTTP/1.1\r\n\r\n",
        b"GET / HTTP/1.1\r\nhost a\r\n\r\n",
        b"POST /v1/grid HTTP/1.1\r\nhost: localhost\r\ncontent-length: -1\r\n\r\n",
        b"POST /v1/grid HTTP/1.1\r\nhost: localhost\r\ncontent-length: 5\r\ncontent-length: 6\r\n\r\nabcdef",
        b"POST /v1/grid HTTP/1.1\r\nhost: localhost\r\ntransfer-encoding: chunked\r\n\r\nzz\r\n",
    ] {
        let answer = server.raw(bytes);
        assert!((400..500).contains(&answer.status) || answer.status == 0, "{answer:?}");
    }
    let many = "GET / HTTP/1.1\r\n".to_owned() + &"a: b\r\n".repeat(10_000) + "\r\n";
    assert_eq!(server.raw(many.as_bytes()).status, 431);
    still_answers(&server);
}

#[test]
fn a_polyline_of_a_megabyte_and_a_list_that_never_ends_are_refused() {
    let (_scratch, server) = server(&[]);
    let form = "application/x-www-form-urlencoded";
    let long = "locations=".to_owned() + &"?".repeat(1_000_000);
    let reason = server.post("/v1/grid", form, &long).refused(400);
    assert!(reason.contains("10000"), "{reason}");
    let bars = "locations=1,1".to_owned() + &"|".repeat(1_000_000) + "1,1";
    server.post("/v1/grid", form, &bars).refused(400);
    let pairs = "a=b&".repeat(300_000);
    server.post("/v1/grid", form, &pairs).refused(400);
    let nested = "{\"locations\":".to_owned() + &"[".repeat(1_000_000);
    server.post("/v1/grid", "application/json", &nested).refused(400);
    let wide = "{\"locations\":[".to_owned() + &"\"1,1\",".repeat(200_000) + "\"1,1\"]}";
    let refused = server.post("/v1/grid", "application/json", &wide).refused(400);
    assert!(refused.contains("200001 locations"), "{refused}");
    still_answers(&server);
}

#[test]
#[ignore = "slow: waits for a time limit"]
fn a_head_that_trickles_is_cut_off() {
    let (_scratch, server) = server(&[]);
    let mut stream = server.connect();
    let begun = Instant::now();
    // A byte a second for ever; the connection must end long before the head does.
    let mut cut = false;
    while begun.elapsed() < Duration::from_secs(20) && !cut {
        cut = stream.write_all(b"G").is_err();
        stream.set_read_timeout(Some(Duration::from_millis(300))).expect("a timeout");
        cut |= matches!(stream.read(&mut [0; 64]), Ok(0));
    }
    assert!(cut && begun.elapsed() < Duration::from_secs(15), "{:?}", begun.elapsed());
    still_answers(&server);
}

#[test]
fn a_body_that_does_not_come_is_not_waited_for() {
    let (_scratch, server) = server(&["--timeout", "1"]);
    let begun = Instant::now();
    let answer =
        server.raw(b"POST /v1/grid HTTP/1.1\r\nhost: localhost\r\ncontent-length: 100\r\n\r\nlocations=");
    answer.refused(408);
    assert!(begun.elapsed() < Duration::from_secs(10));
    still_answers(&server);
}

#[test]
fn one_connection_too_many_is_told_so() {
    let (_scratch, server) = server(&["--max-connections", "3"]);
    let held: Vec<_> = (0..3).map(|_| server.connect()).collect();
    // What waits in the system's queue is not held yet.
    let mut refused = None;
    for _ in 0..200 {
        let answer = server.raw(b"");
        if answer.status == 503 {
            refused = Some(answer);
            break;
        }
        std::thread::sleep(Duration::from_millis(10));
    }
    let refused = refused.expect("the fourth is refused");
    refused.refused(503);
    assert_eq!(refused.header("retry-after"), "1");
    drop(held);
    let deadline = Instant::now() + Duration::from_secs(5);
    while server.get("/health").status != 200 {
        assert!(Instant::now() < deadline, "the others have left");
    }
    still_answers(&server);
}

/// A request for as many heights as there may be.
fn long_request() -> String {
    let body = format!("locations={}", vec!["50.0123456789,10.0123456789"; 10_000].join("|"));
    format!("POST /v1/grid HTTP/1.1\r\nhost: localhost\r\ncontent-length: {}\r\n\r\n{body}", body.len())
}

#[test]
fn requests_beyond_those_at_once_are_told_to_come_back() {
    let (_scratch, server) = server(&["--max-requests", "1"]);
    let request = long_request();
    let ask = || server.raw(request.as_bytes());
    let refused = (0..50).find_map(|_| {
        let answers: Vec<_> = std::thread::scope(|scope| {
            let asking: Vec<_> = (0..8).map(|_| scope.spawn(ask)).collect();
            asking.into_iter().map(|asked| asked.join().expect("answered")).collect()
        });
        assert!(answers.iter().any(|answer| answer.status == 200), "one at a time is answered");
        answers.into_iter().find(|answer| answer.status != 200)
    });
    let refused = refused.expect("of eight at once one is refused");
    refused.refused(503);
    assert_eq!(refused.header("retry-after"), "1");
    still_answers(&server);
}

#[test]
fn clients_whose_bodies_do_not_come_keep_nobody_from_being_answered() {
    let (_scratch, server) = server(&[]);
    let begin = |length: u32| {
        let mut silent = server.connect();
        let head = format!("POST /v1/grid HTTP/1.1\r\nhost: localhost\r\ncontent-length: {length}\r\n\r\nl");
        silent.write_all(head.as_bytes()).expect("it reads");
        silent
    };
    let _held: Vec<_> = (0..300).map(|_| begin(100)).chain((0..64).map(|_| begin(200_000))).collect();
    // All of them have been read when one long body more is refused.
    let deadline = Instant::now() + Duration::from_secs(10);
    let refused = loop {
        let answer = server.raw(long_request().as_bytes());
        if answer.status == 503 {
            break answer.refused(503);
        }
        assert!(Instant::now() < deadline, "{answer:?}");
    };
    assert!(refused.contains("long bodies"), "{refused}");
    for _ in 0..20 {
        still_answers(&server);
    }
    let form = "application/x-www-form-urlencoded";
    server.post("/v1/grid", form, "locations=50.005,10.005").ok();
}

#[test]
#[ignore = "slow: thousands of requests"]
fn memory_stays_what_it_was_under_thousands_of_requests() {
    let (_scratch, server) = server(&[]);
    let request = long_request();
    let mut stream = server.connect();
    let mut ask = |count: usize| {
        let mut reader = BufReader::new(stream.try_clone().expect("a clone"));
        for _ in 0..count {
            stream.write_all(request.as_bytes()).expect("it reads");
            assert_eq!(read_answer(&mut reader, true).status, 200);
        }
    };
    ask(30);
    let before = server.resident_kib();
    ask(120);
    let after = server.resident_kib();
    assert!(after < before + 8 * 1024, "{before} KiB before, {after} KiB after");
}
