//! What is not answered is refused as JSON, with the status that HTTP has for it and a reason that helps.

use crate::common::scratch::Scratch;
use crate::serve::client::Server;
use crate::serve::heights::folder;

fn server(more: &[&str]) -> (Scratch, Server) {
    let scratch = folder();
    let server = Server::start(scratch.folder(), &[&["grid.asc", "plain.asc"], more].concat());
    (scratch, server)
}

const FORM: &str = "application/x-www-form-urlencoded";

#[test]
fn a_wrong_parameter_is_named_with_what_was_found() {
    let (_scratch, server) = server(&[]);
    for (query, words) in [
        ("", "'locations' is missing"),
        ("locations=", "'locations' is missing"),
        ("locations=91,10", "location 1 is '91,10'"),
        ("locations=50,10|50,181", "location 2 is '50,181'"),
        ("locations=nan,10", "location 1"),
        ("locations=50,inf", "location 1"),
        ("locations=50,10||50,10", "location 2"),
        ("locations=hello%20world", "encoded polyline"),
        ("locations=50,10&interpolation=spline", "interpolation is 'spline'"),
        ("locations=50,10&samples=1000000000", "samples is '1000000000'"),
        ("locations=50,10|50,11&samples=1", "samples is '1'"),
        ("locations=50,10|50,11&samples=-5", "samples is '-5'"),
        ("locations=50,10&samples=5", "two locations"),
        ("locations=50,10&nodata_value=none", "nodata_value is 'none'"),
        ("locations=50,10&nodata_value=inf", "nodata_value"),
        ("locations=50,10&format=xml", "format is 'xml'"),
        ("locations=50,10&surface=displayed", "surface is 'displayed'"),
        ("locations=50,10&crs=utm32", "crs is 'utm32'"),
        ("locations=50,10&crs=EPSG:1", "EPSG:1"),
        ("locations=50,10&crs=EPSG:32632&format=geojson", "geojson"),
        ("locations=%ff,10", "UTF-8"),
    ] {
        let reason = server.get(&format!("/v1/grid?{query}")).refused(400);
        assert!(reason.contains(words), "{query}: {reason}");
        let reason = server.post("/v1/grid", FORM, query).refused(400);
        assert!(reason.contains(words), "{query}: {reason}");
    }
    let nowhere = server.get("/v1/plain?locations=50,10").refused(400);
    assert!(nowhere.contains("crs=native"), "{nowhere}");
    let twice = server.get("/v1/grid,grid?locations=50,10").refused(400);
    assert!(twice.contains("named twice"), "{twice}");
}

#[test]
fn the_questions_about_the_ground_know_their_parameters() {
    let (_scratch, server) = server(&[]);
    for (path, words) in [
        ("/v1/los?from=50,10&to=50,10.01", "'dataset' is missing"),
        ("/v1/los?dataset=grid&from=50,10", "'to' is missing"),
        ("/v1/los?dataset=grid&from=50,10&to=50,10.01&observer_hight=3", "'observer_hight'"),
        ("/v1/los?dataset=grid&from=50,10&to=50,10.01&observer_height=-1", "observer_height is '-1'"),
        ("/v1/los?dataset=grid&from=50,10&to=50,10.01&earth=hollow", "earth is 'hollow'"),
        ("/v1/profile?dataset=grid&locations=50,10", "two locations"),
        ("/v1/viewshed?dataset=grid&observer=50", "observer is '50'"),
        ("/v1/viewshed?dataset=grid&observer=50.01,10.01&range=far", "range is 'far'"),
        ("/v1/viewshed?dataset=grid&observer=50.01,10.01&sector=0,0", "sector is '0,0'"),
    ] {
        let reason = server.get(path).refused(400);
        assert!(reason.contains(words), "{path}: {reason}");
    }
    let unknown = server.get("/v1/los?dataset=mars&from=50,10&to=50,10.01").refused(404);
    assert!(unknown.contains("'mars'") && unknown.contains("grid, plain"), "{unknown}");
}

#[test]
fn an_unknown_address_is_told_the_datasets() {
    let (_scratch, server) = server(&[]);
    for path in [
        "/v1/nothing?locations=50,10",
        "/v1/nothing",
        "/v2/grid",
        "/v1/",
        "/v1/grid/",
        "/..%2f..%2fetc/passwd",
        "/%ff",
    ] {
        let reason = server.get(path).refused(404);
        assert!(reason.contains("grid, plain"), "{path}: {reason}");
    }
}

#[test]
fn methods_that_are_not_answered_are_told_which_are() {
    let (_scratch, server) = server(&[]);
    let ask = |method: &str, path: &str| {
        server.raw(
            format!("{method} {path} HTTP/1.1\r\nhost: localhost\r\ncontent-length: 0\r\n\r\n").as_bytes(),
        )
    };
    for path in ["/v1/grid?locations=50,10", "/v1/los", "/v1/profile", "/v1/viewshed"] {
        for method in ["PUT", "DELETE", "PATCH", "BREW"] {
            let answer = ask(method, path);
            answer.refused(405);
            assert_eq!(answer.header("allow"), "GET, HEAD, POST, OPTIONS");
        }
        let options = ask("OPTIONS", path);
        assert_eq!((options.status, options.header("allow")), (204, "GET, HEAD, POST, OPTIONS"));
        assert_eq!(options.header("access-control-allow-origin"), "", "no other site's pages may ask");
    }
    for path in ["/", "/health"] {
        assert_eq!(ask("POST", path).header("allow"), "GET, HEAD, OPTIONS");
        ask("POST", path).refused(405);
    }
    let head = ask("HEAD", "/v1/grid?locations=50.01,10.01");
    let get = server.get("/v1/grid?locations=50.01,10.01");
    assert_eq!((head.status, head.header("content-length")), (200, get.header("content-length")));
}

#[test]
fn a_body_of_another_kind_or_too_long_is_refused() {
    let (_scratch, server) = server(&["--max-points", "10"]);
    server.post("/v1/grid", "text/csv", "50,10").refused(415);
    server.post("/v1/grid", "multipart/form-data; boundary=a", "").refused(400);
    server.post("/v1/grid", "multipart/form-data", "--a--").refused(400);
    server.post("/v1/grid", "multipart/mixed; boundary=a", "--a--").refused(415);
    let zipped = "POST /v1/grid HTTP/1.1\r\nhost: localhost\r\ncontent-type: application/json\r\ncontent-encoding: gzip\r\n\
                  content-length: 2\r\n\r\n{}";
    server.raw(zipped.as_bytes()).refused(415);
    for wrong in ["", "[]", "{\"locations\":", "{\"locations\":[[50,10]]}", "{\"locations\":true}", "null"] {
        server.post("/v1/grid", "application/json", wrong).refused(400);
    }
    server.post("/v1/grid", FORM, &"x".repeat(200_000)).refused(413);
    let stated = "POST /v1/grid HTTP/1.1\r\nhost: localhost\r\ncontent-length: 99999999999\r\n\r\n";
    let reason = server.raw(stated.as_bytes()).refused(413);
    assert!(reason.contains("bytes"), "{reason}");
    let chunk = "8000\r\n".to_owned() + &"x".repeat(0x8000) + "\r\n";
    let chunked = "POST /v1/grid HTTP/1.1\r\nhost: localhost\r\ntransfer-encoding: chunked\r\n\r\n"
        .to_owned()
        + &chunk.repeat(8);
    server.raw(chunked.as_bytes()).refused(413);
}

#[test]
fn an_address_too_long_is_refused_and_a_body_is_suggested() {
    let (_scratch, server) = server(&[]);
    let path = format!("/v1/grid?locations={}50,10", "50.012345,10.012345|".repeat(3100));
    let reason = server.get(&path).refused(414);
    assert!(reason.contains("POST"), "{reason}");
    let fits = format!("/v1/grid?locations={}50,10", "50.012345,10.012345|".repeat(2900));
    assert_eq!(server.get(&fits).status, 200);
}

#[test]
fn more_points_than_may_be_asked_are_refused_and_as_many_are_answered() {
    let (_scratch, server) = server(&["--max-points", "10"]);
    let ask =
        |count: usize| server.get(&format!("/v1/grid?locations={}", vec!["50.01,10.01"; count].join("|")));
    assert_eq!(ask(10).ok()["results"].as_array().map(Vec::len), Some(10));
    let reason = ask(11).refused(400);
    assert!(reason.contains("11 locations") && reason.contains("10"), "{reason}");
    let path = "/v1/grid?locations=50.005,10.005|50.025,10.035&samples=";
    assert_eq!(server.get(&format!("{path}10")).status, 200);
    server.get(&format!("{path}11")).refused(400);
}
