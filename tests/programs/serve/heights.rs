//! `/v1/DATASET`: what the Open Topo Data API documents, and what is more.

use glam::DVec2;
use sandtable_geom::crs::Crs;
use sandtable_geom::geoid::Geoid;
use serde_json::{Value, json};

use crate::common::scratch::Scratch;
use crate::serve::client::Server;

/// Three rows of four samples a hundredth of a degree apart, the second of the second row a hole. Sample centers stand
/// at 10.005, 10.015, 10.025 and 10.035 east and 50.025, 50.015 and 50.005 north.
pub const GRID: &str = "ncols 4\nnrows 3\nxllcorner 10\nyllcorner 50\ncellsize 0.01\nNODATA_value -9999\n\
                        10 20 30 40\n50 -9999 70 80\n90 100 110 120\n";

/// Another model, around the first one's hole and east of it.
const BESIDE: &str = "ncols 8\nnrows 3\nxllcorner 10\nyllcorner 50\ncellsize 0.01\nNODATA_value -9999\n\
                      1 2 3 4 5 6 7 8\n1 2 3 4 5 6 7 8\n1 2 3 4 5 6 7 -9999\n";

pub fn folder() -> Scratch {
    let scratch = Scratch::new();
    scratch.write("grid.asc", GRID);
    scratch.write("grid.prj", "EPSG:4326");
    scratch.write("beside.asc", BESIDE);
    scratch.write("beside.prj", "EPSG:4326");
    scratch.write("plain.asc", "ncols 2\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 10\n1 2\n3 4\n");
    scratch
}

fn server() -> (Scratch, Server) {
    let scratch = folder();
    let server = Server::start(scratch.folder(), &["grid.asc", "other=beside.asc", "plain.asc"]);
    (scratch, server)
}

fn elevations(answer: &Value) -> Vec<Value> {
    answer["results"].as_array().expect("results").iter().map(|result| result["elevation"].clone()).collect()
}

#[test]
fn results_come_in_order_with_their_place_dataset_and_status() {
    let (_scratch, server) = server();
    let answer = server.get("/v1/grid?locations=50.005,10.005|50.015,10.015|60,10&interpolation=nearest");
    assert_eq!(answer.header("content-type"), "application/json");
    let place = |lat: f64, lng: f64| json!({"lat": lat, "lng": lng});
    let expected = json!({
        "results": [
            {"elevation": 90.0, "location": place(50.005, 10.005), "dataset": "grid", "status": "Ok"},
            {"elevation": null, "location": place(50.015, 10.015), "dataset": "grid", "status": "NoData"},
            {"elevation": null, "location": place(60.0, 10.0), "dataset": "grid", "status": "Outside"},
        ],
        "status": "OK",
    });
    assert_eq!(answer.ok(), expected);
}

#[test]
fn lookups_of_open_elevation_are_answered_in_its_form() {
    let (_scratch, server) = server();
    let got = server.get("/api/v1/lookup?locations=50.005,10.005|50.015,10.015|60,10");
    assert_eq!(got.header("content-type"), "application/json");
    let expected = json!({"results": [
        {"latitude": 50.005, "longitude": 10.005, "elevation": 90.0},
        // The first dataset has a hole here, the second a height.
        {"latitude": 50.015, "longitude": 10.015, "elevation": 2.0},
        {"latitude": 60.0, "longitude": 10.0, "elevation": null, "error": "outside the elevation that is served"},
    ]});
    assert_eq!(got.ok(), expected);
    let objects = r#"{"locations": [{"latitude": 50.005, "longitude": 10.005},
        {"latitude": 50.015, "longitude": 10.015}, {"longitude": 10, "latitude": 60}]}"#;
    let typed = "application/json";
    assert_eq!(server.post("/api/v1/lookup", typed, objects).body, got.body);
    let texts = r#"{"locations": ["50.005,10.005", "50.015,10.015", "60,10"]}"#;
    assert_eq!(server.post("/api/v1/lookup", typed, texts).body, got.body);
    let topo = server.get("/v1/grid,other?locations=50.005,10.005|50.015,10.015|60,10").ok();
    assert_eq!(elevations(&topo), elevations(&got.ok()), "both addresses return the same heights");
    let object = r#"{"locations": [{"latitude": 50.005, "longitude": 10.005}]}"#;
    assert_eq!(server.post("/v1/grid", typed, object).ok()["results"][0]["elevation"], 90.0);
}

#[test]
fn wrong_lookups_are_refused_with_the_reason() {
    let (_scratch, server) = server();
    let json = "application/json";
    for (body, reason) in [
        (r#"{"locations": [{"latitude": 91, "longitude": 0}]}"#, "location 1 is '91,0'"),
        (r#"{"locations": [{"latitude": "50", "longitude": 10}]}"#, "longitude"),
        (r#"{"locations": [{"lat": 50, "lng": 10}]}"#, "longitude"),
        (r#"{"locations": []}"#, "'locations' is missing"),
        ("{}", "'locations' is missing"),
    ] {
        let refused = server.post("/api/v1/lookup", json, body).refused(400);
        assert!(refused.contains(reason), "{body}: {refused}");
    }
    let plain = folder();
    let local = Server::start(plain.folder(), &["plain.asc"]);
    assert!(local.get("/api/v1/lookup?locations=1,2").refused(400).contains("crs=native"));
}

#[test]
fn get_form_and_json_say_the_same() {
    let (_scratch, server) = server();
    let got = server.get("/v1/grid?locations=50.01,10.01%7C50.02,10.03&interpolation=bilinear").body;
    let form = "application/x-www-form-urlencoded";
    let typed = "application/json; charset=utf-8";
    let object = r#"{"locations": "50.01,10.01|50.02,10.03", "interpolation": "bilinear"}"#;
    let list = r#"{"locations": ["50.01,10.01", "50.02,10.03"]}"#;
    assert_eq!(server.post("/v1/grid", form, "locations=50.01%2C10.01|50.02,+10.03").body, got);
    assert_eq!(server.post("/v1/grid", typed, object).body, got);
    assert_eq!(server.post("/v1/grid", typed, list).body, got);
    assert_eq!(
        server.post("/v1/grid?interpolation=bilinear", typed, list).body,
        got,
        "a query goes with a body"
    );
    let untyped = format!(
        "POST /v1/grid HTTP/1.1\r\nhost: localhost\r\ncontent-length: {}\r\n\r\n{object}",
        object.len()
    );
    assert_eq!(server.raw(untyped.as_bytes()).body, got, "a body without a type is looked at");
    assert!(got.contains("\"status\":\"OK\""), "{got}");
}

#[test]
fn positions_of_answers_are_written_in_the_form_of_the_request_and_read_again() {
    let (_scratch, server) = server();
    let answer = server.get("/v1/grid?locations=50.006,10.006&positions=mgrs").ok();
    let position = answer["results"][0]["location"]["position"].as_str().expect("a position").to_owned();
    assert!(position.starts_with("32U") && position.len() == 15, "{position}");
    let geojson = server.get("/v1/grid?locations=50.006,10.006&positions=mgrs&format=geojson").ok();
    assert_eq!(geojson["features"][0]["properties"]["position"], position);
    let again = server.get(&format!("/v1/grid?locations={position}&positions=mgrs")).ok();
    assert_eq!(again["results"][0]["location"]["position"], position);
    let numbers = server.get("/v1/grid?locations=50.006,10.006").ok();
    assert_eq!(numbers["results"][0]["location"], json!({"lat": 50.006, "lng": 10.006}));
    for (asked, reason) in [
        ("/v1/grid?locations=50.006,10.006&positions=grid", "there are mgrs, usng"),
        ("/v1/plain?locations=1,2&crs=native&positions=mgrs", "states no coordinate system"),
    ] {
        let refused = server.get(asked).refused(400);
        assert!(refused.contains(reason), "{asked}: {refused}");
    }
}

#[test]
fn a_polyline_is_the_same_as_its_locations() {
    let (_scratch, server) = server();
    // The example of the Encoded Polyline Algorithm Format.
    let text = "_p~iF~ps|U_ulLnnqC_mqNvxq`@";
    let answer = server.get(&format!("/v1/grid?locations={}", text.replace('`', "%60").replace('|', "%7C")));
    let locations = "38.5,-120.2|40.7,-120.95|43.252,-126.453";
    assert_eq!(answer.body, server.get(&format!("/v1/grid?locations={locations}")).body);
    let object = serde_json::json!({"locations": text}).to_string();
    assert_eq!(server.post("/v1/grid", "application/json", &object).body, answer.body);
    assert_eq!(answer.ok()["results"].as_array().map(Vec::len), Some(3));
}

#[test]
fn heights_are_brought_to_the_ellipsoid() {
    let scratch = folder();
    let server = Server::start(scratch.folder(), &["grid.asc", "--vertical-datum", "egm96"]);
    let asked = |above: &str| server.get(&format!("/v1/grid?locations=50.005,10.005{above}"));
    let (plain, above) = (asked("").ok(), asked("&above=ellipsoid").ok());
    assert_eq!(plain["results"][0]["vertical_datum"], "EGM96 geoid");
    assert_eq!(above["results"][0]["vertical_datum"], "WGS 84 ellipsoid");
    let undulation = Geoid::default().undulations(&[DVec2::new(10.005, 50.005)], 16).expect("one place")[0];
    assert!((40.0..60.0).contains(&undulation), "{undulation}");
    assert_eq!(elevations(&above)[0], json!(90.0 + undulation));
    assert_eq!(asked("&above=sea").status, 400);
    let unstated = Server::start(scratch.folder(), &["grid.asc"]);
    let refused = unstated.get("/v1/grid?locations=50.005,10.005&above=ellipsoid");
    assert!(refused.status == 400 && refused.body.contains("grid: nothing states"), "{}", refused.body);
}

#[test]
fn every_interpolation_is_offered() {
    let (_scratch, server) = server();
    let height = |interpolation: &str| {
        let path = format!("/v1/grid?locations=50.0225,10.0275&interpolation={interpolation}");
        elevations(&server.get(&path).ok())[0].as_f64().expect("a height")
    };
    // In the cell of 30, 40, 70 and 80, a quarter from its west and three quarters from its south.
    assert!((height("bilinear") - 42.5).abs() < 1e-6);
    assert!((height("planar") - 42.5).abs() < 1e-6);
    assert_eq!(height("nearest"), 30.0);
    assert!((45.0..50.0).contains(&height("distance-weighted")));
    assert!((height("cubic") - 42.5).abs() < 1e-6, "a plane is kept");
    let default = server.get("/v1/grid?locations=50.0225,10.0275").body;
    assert_eq!(default, server.get("/v1/grid?locations=50.0225,10.0275&interpolation=bilinear").body);
}

#[test]
fn what_stands_for_no_height_can_be_chosen() {
    let (_scratch, server) = server();
    let body = |value: &str| server.get(&format!("/v1/grid?locations=60,10&nodata_value={value}")).body;
    assert!(body("null").contains("\"elevation\":null"));
    assert!(body("nan").contains("\"elevation\":NaN"));
    assert!(body("-9999").contains("\"elevation\":-9999.0"));
    assert!(body("-9999").contains("\"status\":\"Outside\""), "the status stays");
}

#[test]
fn samples_lie_at_equal_distances_along_the_path() {
    let (_scratch, server) = server();
    let answer =
        server.get("/v1/grid?locations=50.005,10.005|50.005,10.035&samples=4&interpolation=nearest").ok();
    assert_eq!(elevations(&answer), [90.0, 100.0, 110.0, 120.0].map(Value::from));
    let last = &answer["results"][3]["location"];
    assert_eq!((last["lat"].as_f64(), last["lng"].as_f64()), (Some(50.005), Some(10.035)));
    let bent = server.get("/v1/grid?locations=50.005,10.005|50.025,10.005|50.025,10.035&samples=100").ok();
    assert_eq!(bent["results"].as_array().map(Vec::len), Some(100));
}

#[test]
fn of_several_datasets_the_first_with_a_height_answers() {
    let (_scratch, server) = server();
    let path = "/v1/grid,other?locations=50.005,10.005|50.015,10.015|50.005,10.055|50.005,10.075|60,10&interpolation=nearest";
    let answer = server.get(path).ok();
    let results: Vec<_> = answer["results"]
        .as_array()
        .expect("results")
        .iter()
        .map(|result| (result["elevation"].as_f64(), result["dataset"].as_str(), result["status"].as_str()))
        .collect();
    assert_eq!(
        results,
        [
            (Some(90.0), Some("grid"), Some("Ok")),
            (Some(2.0), Some("other"), Some("Ok")),
            (Some(6.0), Some("other"), Some("Ok")),
            (None, Some("other"), Some("NoData")),
            (None, Some("grid"), Some("Outside")),
        ]
    );
}

#[test]
fn geojson_holds_points_with_their_heights_third() {
    let (_scratch, server) = server();
    let answer = server.get("/v1/grid?locations=50.005,10.005|60,10&format=geojson&interpolation=nearest");
    assert_eq!(answer.header("content-type"), "application/geo+json");
    let json = answer.ok();
    assert_eq!(json["type"], "FeatureCollection");
    assert_eq!(
        json["features"][0]["geometry"],
        json!({"type": "Point", "coordinates": [10.005, 50.005, 90.0]})
    );
    assert_eq!(json["features"][0]["properties"], json!({"status": "Ok", "dataset": "grid"}));
    assert_eq!(json["features"][1]["geometry"]["coordinates"], json!([10.0, 60.0]), "no height, no third");
    assert_eq!(json["features"][1]["properties"]["status"], "Outside");
    let read: geojson::GeoJson = answer.body.parse().expect("GeoJSON");
    assert!(
        matches!(read, geojson::GeoJson::FeatureCollection(collection) if collection.features.len() == 2)
    );
}

#[test]
fn other_coordinates_are_x_then_y() {
    let (_scratch, server) = server();
    let degrees = server.get("/v1/grid?locations=10.005,50.005&crs=EPSG:4326&interpolation=nearest").ok();
    assert_eq!(degrees["results"][0]["location"], json!({"x": 10.005, "y": 50.005}));
    assert_eq!(elevations(&degrees), [Value::from(90.0)]);
    let utm = Crs::from_epsg(32632).expect("a zone");
    let at = Crs::wgs84().transform(&utm, DVec2::new(10.005, 50.005)).expect("inside");
    let path = format!("/v1/grid?locations={},{}&crs=EPSG:32632&interpolation=nearest", at.x, at.y);
    let meters = server.get(&path).ok();
    assert_eq!(elevations(&meters), [Value::from(90.0)]);
    let own = server.get("/v1/plain?locations=5,15&crs=native&interpolation=nearest").ok();
    assert_eq!(elevations(&own), [Value::from(1.0)]);
}

#[test]
fn health_lists_the_datasets_and_the_page_at_the_root_explains() {
    let (_scratch, server) = server();
    let health = server.get("/health").ok();
    assert_eq!((&health["status"], &health["version"]), (&json!("OK"), &json!(env!("CARGO_PKG_VERSION"))));
    let names: Vec<_> =
        health["datasets"].as_array().expect("a list").iter().map(|one| one["name"].as_str()).collect();
    assert_eq!(names, [Some("grid"), Some("other"), Some("plain")]);
    let grid = &health["datasets"][0];
    assert_eq!((&grid["crs"], &grid["columns"], &grid["rows"]), (&json!("EPSG:4326"), &json!(4), &json!(3)));
    assert_eq!(
        (grid["extent"]["min_x"].as_f64(), grid["extent"]["max_x"].as_f64()),
        (Some(10.0), Some(10.04))
    );
    assert_eq!(health["datasets"][2]["crs"], Value::Null);
    let page = server.get("/");
    assert_eq!((page.status, page.header("content-type")), (200, "text/plain; charset=utf-8"));
    assert!(
        page.body.contains("Datasets: grid, other, plain") && page.body.contains("/v1/viewshed"),
        "{page:?}"
    );
}
