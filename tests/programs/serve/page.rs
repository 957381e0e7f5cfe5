//! The page at `/` and its tiles: a browser clicks, and sees what the service answers.
//!
//! The browser is driven by `tests/tools/service_page_test.mjs`; without one the test that needs it says so and passes.

use std::path::Path;
use std::process::Command;

use serde_json::Value;

use crate::common::scratch::Scratch;
use crate::common::skip::skipped;
use crate::readme::pages::{blocks, text_of};
use crate::serve::client::{Answer, Server};
use crate::serve::heights::folder;

const ROOT: &str = env!("SANDTABLE_ROOT");

/// What browsers send.
const BROWSER: &str = "text/html,application/xhtml+xml,application/xml;q=0.9,*/*;q=0.8";

fn demo() -> Server {
    Server::start(Path::new(ROOT), &["assets/jacksboro/dem.tif"])
}

fn accepting(server: &Server, path: &str, accept: &str) -> Answer {
    server.raw(format!("GET {path} HTTP/1.1\r\nhost: localhost\r\naccept: {accept}\r\n\r\n").as_bytes())
}

/// What happened in the browser; `None` with a loud line where there is none.
fn in_browser(server: &Server, out: &Path) -> Option<Value> {
    if std::env::var_os("SANDTABLE_BROWSER").is_none() {
        skipped("no browser: SANDTABLE_BROWSER is not set");
        assert!(std::env::var_os("SANDTABLE_REQUIRE_BROWSER").is_none(), "SANDTABLE_REQUIRE_BROWSER is set");
        return None;
    }
    let script = Path::new(ROOT).join("tests/tools/service_page_test.mjs");
    let address = format!("http://{}/", server.address);
    let ran = Command::new("node").arg(script).arg(address).arg(out).output().expect("node runs");
    let said = String::from_utf8_lossy(&ran.stdout).into_owned();
    assert!(ran.status.success(), "{said}{}", String::from_utf8_lossy(&ran.stderr));
    Some(serde_json::from_str(&said).expect("one line of JSON"))
}

/// The place of a point of the page, as a request has it.
fn place(point: &Value) -> String {
    let text = point["Degrees"].as_str().expect("degrees");
    let degrees = text.split(", ").map(|part| {
        let (number, letter) = part.split_once("° ").expect("a letter");
        if "SW".contains(letter) { format!("-{number}") } else { number.to_owned() }
    });
    degrees.collect::<Vec<_>>().join(",")
}

/// The height of a point of the page, as it is shown, by the service; its grid reference and UTM must be those shown.
fn height(server: &Server, point: &Value) -> String {
    let at = place(point);
    for (form, name) in [("utm", "UTM"), ("mgrs", "MGRS")] {
        let answer = server.get(&format!("/v1/dem?locations={at}&positions={form}")).ok();
        assert_eq!(point[name], answer["results"][0]["location"]["position"], "{point}");
    }
    let answer = server.get(&format!("/v1/dem?locations={at}")).ok();
    format!("{:.2} m", answer["results"][0]["elevation"].as_f64().expect("a height"))
}

fn number(value: &Value) -> f64 {
    value.as_f64().expect("a number")
}

#[test]
fn a_person_clicks_heights_profiles_sight_and_viewsheds_and_sees_the_answers() {
    let (server, scratch) = (demo(), Scratch::new());
    let Some(told) = in_browser(&server, scratch.folder()) else { return };
    assert_eq!(told["complaints"], Value::Array(Vec::new()), "{told:#}");
    let own = format!("http://{}/", server.address);
    let requests: Vec<&str> =
        told["requests"].as_array().expect("a list").iter().filter_map(Value::as_str).collect();
    assert!(requests.iter().all(|url| url.starts_with(&own) || url.starts_with("data:")), "{requests:#?}");
    assert_eq!(told["title"], "dem – sandtable");
    assert!(told["tiles"].as_u64() > Some(4), "{told:#}");
    assert_eq!(told["ground"][3], 255, "tiles are drawn: {told:#}");

    let clicked = &told["height"];
    assert_eq!(clicked["verdict"], height(&server, &clicked["points"][0]), "{clicked:#}");
    let near = place(&clicked["points"][0]);
    assert!(near.starts_with("36.3") || near.starts_with("36.299"), "{near}");

    let profile = &told["profile"];
    let points = profile["points"].as_array().expect("three points");
    let line: Vec<String> = points.iter().map(place).collect();
    assert_eq!(line.len(), 3, "{profile:#}");
    let answer = server.get(&format!("/v1/profile?dataset=dem&locations={}", line.join("|"))).ok();
    assert_eq!(profile["verdict"], format!("{:.2} km", number(&answer["length_m"]) / 1000.0));
    let results = answer["results"].as_array().expect("stations");
    let heights = results.iter().map(|station| number(&station["elevation"]));
    let highest = heights.clone().fold(f64::NEG_INFINITY, f64::max);
    assert_eq!(profile["facts"]["Highest"], format!("{highest:.2} m"));
    let lowest = heights.fold(f64::INFINITY, f64::min);
    assert_eq!(profile["facts"]["Lowest"], format!("{lowest:.2} m"));
    assert_eq!(profile["facts"]["Breaks of the ground"], results.len().to_string());
    assert!(profile["chart"].as_str().is_some_and(|label| label.contains("km")), "{profile:#}");
    assert!(told["hovered"].as_str().is_some_and(|text| text.contains("m high")), "{told:#}");
    for (point, at) in points.iter().zip(&line) {
        assert_eq!(point["Height"], height(&server, point), "{at}");
    }

    let sight = &told["sight"];
    let [from, to] = [0, 1].map(|index| place(&sight["points"][index]));
    let answer = server.get(&format!("/v1/los?dataset=dem&from={from}&to={to}&observer_height=10")).ok();
    assert_eq!((&sight["verdict"], &answer["visible"]), (&"Hidden".into(), &false.into()), "{sight:#}");
    let blocker = number(&answer["blocker"]["elevation"]);
    assert_eq!(sight["facts"]["Hidden by"], format!("ground {blocker:.2} m high"));

    let eye = |shown: &Value, range_m: u32| {
        let at = place(&shown["points"][0]);
        let path = format!("/v1/viewshed?dataset=dem&observer={at}&observer_height=10&range={range_m}");
        let answer = server.get(&format!("{path}&format=summary")).ok();
        assert_eq!(shown["verdict"], format!("{:.2} km² in sight", number(&answer["visible_area_m2"]) / 1e6));
        let counts = &answer["counts"];
        let posts = format!("{} in sight, {} hidden", counts["visible"], counts["hidden"]);
        assert_eq!(shown["facts"]["Posts"], posts);
    };
    eye(&told["words"], 5000);
    eye(&told["viewshed"], 8000);
    assert_eq!(told["words"]["points"][0]["MGRS"], "16SGF5000018000", "a place in words is that place");

    let refusal = told["refusal"].as_str().expect("a sentence");
    assert!(refusal.ends_with('.') && refusal.starts_with(char::is_uppercase), "{refusal}");
    assert!(refusal.contains("16S"), "{refusal}");
    assert!(told["nonsense"].as_str().is_some_and(|text| text.contains("nowhere<img")), "{told:#}");
    assert_eq!(told["wrong"], "Write a number from 0 on for “Range”.");

    for key in ["key", "second_key"] {
        assert_eq!(told[key]["verdict"], height(&server, &told[key]["points"][0]), "{told:#}");
    }
    assert_ne!(told["key"]["points"], told["second_key"]["points"]);
    assert_eq!(
        (&told["cleared"]["verdict"], &told["cleared"]["points"]),
        (&"".into(), &Value::Array(vec![]))
    );
    assert_eq!((&told["moves"]["drag"], &told["moves"]["wheel"]), (&true.into(), &true.into()));
    assert_eq!(told["afterMoves"]["points"], Value::Array(Vec::new()), "dragging chooses nothing");
    assert_eq!(told["outside"]["verdict"], "This lies outside the elevation", "{told:#}");
    assert_eq!(told["phone"]["verdict"], height(&server, &told["phone"]["points"][0]));
    assert_eq!(told["overflow"], 0, "nothing is wider than the phone");
}

#[test]
fn the_python_client_of_the_book_prints_what_the_book_says() {
    if Command::new("python3").arg("--version").output().is_err() {
        skipped("no Python: python3 is not on the path");
        return;
    }
    let page = text_of("src/book/heights.md");
    let client = blocks(&page, "python").into_iter().next().expect("a client");
    assert!(client.lines().filter(|line| !line.is_empty()).count() <= 10, "{client}");
    let server = demo();
    let address = format!("http://{}", server.address);
    assert_eq!(client.matches("http://127.0.0.1:8080").count(), 1, "{client}");
    let client = client.replace("http://127.0.0.1:8080", &address);
    let ran = Command::new("python3").args(["-c", &client]).output().expect("python3 runs");
    let said = String::from_utf8_lossy(&ran.stdout).into_owned();
    assert!(ran.status.success(), "{said}{}", String::from_utf8_lossy(&ran.stderr));
    assert!(said.lines().count() == 3 && blocks(&page, "text").contains(&&*said), "the book prints:\n{said}");
}

#[test]
fn browsers_get_the_page_and_other_programs_the_list() {
    let scratch = folder();
    let server = Server::start(scratch.folder(), &["grid.asc", "--prefix", "/terrain"]);
    for root in ["/terrain", "/terrain/"] {
        let page = accepting(&server, root, BROWSER);
        assert_eq!((page.status, page.header("content-type")), (200, "text/html; charset=utf-8"));
        assert!(page.body.contains("<base href=\"/terrain/\">"), "{}", page.body);
        let list = server.get(root);
        assert!(list.header("content-type").starts_with("text/plain"), "{list:?}");
        assert_eq!(list.body, server.get("/terrain/help").body);
        assert_eq!((page.header("vary"), list.header("vary")), ("accept", "accept"));
    }
    for (path, kind) in [("page.css", "text/css"), ("page.js", "text/javascript")] {
        let part = server.get(&format!("/terrain/{path}"));
        assert_eq!((part.status, part.header("content-type")), (200, &*format!("{kind}; charset=utf-8")));
        assert_eq!(server.get(&format!("/{path}")).status, 404);
    }
    let page = accepting(&server, "/terrain/", BROWSER);
    let policy = page.header("content-security-policy");
    for part in ["default-src 'none'", "script-src 'self'", "frame-ancestors 'none'", "base-uri 'self'"] {
        assert!(policy.contains(part), "{policy}");
    }
    assert!(!policy.contains("unsafe") && !policy.contains('*'), "{policy}");
    assert_eq!((page.header("x-content-type-options"), page.header("x-frame-options")), ("nosniff", "DENY"));
    let foreign = b"GET /terrain/ HTTP/1.1\r\nhost: evil.example\r\naccept: text/html\r\n\r\n";
    server.raw(foreign).refused(421);
    assert_eq!(server.post("/terrain/", "text/plain", "").status, 405);
}

#[test]
fn tiles_show_the_ground_and_what_lies_beyond_is_transparent() {
    let server = demo();
    let tile = |path: &str| {
        let answer = server.get(&format!("/v1/tiles/dem/{path}.png"));
        assert_eq!((answer.status, answer.header("content-type")), (200, "image/png"), "{path}");
        image::load_from_memory(&answer.bytes).expect("a picture").into_rgba8()
    };
    let bounds = &server.get("/datasets").ok()["results"][0]["bounds"];
    let (lat, lng) = (36.3f64, -84.2f64);
    assert!(number(&bounds["south"]) < lat && lat < number(&bounds["north"]), "{bounds}");
    assert!(number(&bounds["west"]) < lng && lng < number(&bounds["east"]), "{bounds}");
    let at = |z: u32| {
        let count = f64::from(1u32 << z);
        let y = (1.0 - lat.to_radians().tan().asinh() / std::f64::consts::PI) / 2.0;
        (((lng + 180.0) / 360.0 * count) as u32, (y * count) as u32)
    };
    // From pixels of many samples to many pixels of a sample.
    for z in [8, 11, 12, 14, 18, 22] {
        let (x, y) = at(z);
        let picture = tile(&format!("{z}/{x}/{y}"));
        assert_eq!(picture.dimensions(), (256, 256));
        let filled = picture.pixels().filter(|pixel| pixel.0[3] == 255).count();
        assert!(filled > if z < 12 { 1000 } else { 60_000 }, "{z}: {filled}");
    }
    // A level is the one above it, four times as large.
    let (x, y) = (at(12).0, at(12).1);
    let mean = |picture: &image::RgbaImage, left: u32, top: u32, side: u32| {
        let part = image::imageops::crop_imm(picture, left, top, side, side).to_image();
        let values = part.pixels().map(|pixel| f64::from(pixel.0[1]));
        values.sum::<f64>() / f64::from(side * side)
    };
    let (coarse, fine) = (tile(&format!("12/{x}/{y}")), tile(&format!("13/{}/{}", 2 * x, 2 * y)));
    let (coarse, fine) = (mean(&coarse, 0, 0, 128), mean(&fine, 0, 0, 256));
    assert!((coarse - fine).abs() < 8.0, "{coarse} {fine}");
    let empty = tile("9/0/0");
    assert!(empty.pixels().all(|pixel| pixel.0[3] == 0));
    let path = format!("/v1/tiles/dem/12/{x}/{y}.png");
    assert!(!server.get(&path).header("etag").is_empty());
    assert_eq!(server.get(&path).bytes, server.get(&path).bytes);
}

#[test]
fn tiles_that_are_none_and_datasets_without_a_place_are_refused() {
    let scratch = folder();
    let server = Server::start(scratch.folder(), &["grid.asc", "plain.asc"]);
    for wrong in
        ["grid/0/0/0", "grid/0/1/0.png", "grid/23/0/0.png", "grid/0/0/0.png/..", "none/0/0/0.png", "grid"]
    {
        server.get(&format!("/v1/tiles/{wrong}")).refused(404);
    }
    let long = "9".repeat(3000);
    server.get(&format!("/v1/tiles/grid/{long}/{long}/{long}.png")).refused(404);
    assert_eq!(server.get("/v1/tiles/grid/%FF/0/0.png").status, 404);
    let reason = server.get("/v1/tiles/plain/0/0/0.png").refused(400);
    assert!(reason.contains("'plain' has no map") && reason.contains("coordinate system"), "{reason}");
    let list = server.get("/datasets").ok();
    assert!(
        list["results"][0]["bounds"]["west"].is_number() && list["results"][1]["bounds"].is_null(),
        "{list}"
    );
    assert_eq!(server.get("/v1/tiles/grid/0/0/0.png").status, 200);
}
