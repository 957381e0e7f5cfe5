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
