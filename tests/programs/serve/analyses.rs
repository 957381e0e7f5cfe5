//! `/analyses` and `/v1/analyze/KIND`: the bytes of the command `analyze`.

use std::fs;
use std::path::Path;
use std::process::Command;

use serde_json::Value;

use crate::common::scratch::Scratch;
use crate::serve::client::Server;

const ROOT: &str = env!("SANDTABLE_ROOT");

const DEM: &str = "assets/jacksboro/dem.tif";

/// A part of the model, in the system of its ground.
const EXTENT: &str = "745000,4015000,750000,4020000";

fn server() -> Server {
    Server::start(Path::new(ROOT), &[DEM, "scenes/road.toml", "--max-posts", "200000"])
}

/// The file that `analyze` writes.
fn written(arguments: &[&str], extension: &str) -> Vec<u8> {
    let scratch = Scratch::new();
    let out = scratch.folder().join(format!("analysis.{extension}"));
    let ran = Command::new(env!("CARGO_BIN_EXE_sandtable"))
        .current_dir(ROOT)
        .arg("analyze")
        .args(arguments)
        .arg("-o")
        .arg(&out)
        .output()
        .expect("the program starts");
    assert!(ran.status.success(), "{}", String::from_utf8_lossy(&ran.stderr));
    fs::read(out).expect("written")
}

#[test]
fn a_raster_has_the_bytes_of_the_command() {
    let server = server();
    let at = format!("dataset=dem&crs=EPSG:32616&extent={EXTENT}&unit=degrees");
    let answer = server.get(&format!("/v1/analyze/slope?{at}"));
    assert_eq!((answer.status, answer.header("content-type")), (200, "image/tiff"));
    let wanted =
        written(&["slope", DEM, "--crs", "EPSG:32616", "--extent", EXTENT, "--unit", "degrees"], "tif");
    assert!(answer.bytes == wanted, "{} bytes, {} wanted", answer.bytes.len(), wanted.len());
    let posted = server.post("/v1/analyze/slope", "application/x-www-form-urlencoded", &at);
    assert!(posted.bytes == wanted);
}

#[test]
fn features_of_a_scene_have_the_bytes_of_the_command() {
    let server = server();
    let answer = server.get("/v1/analyze/obstacles?dataset=road&format=geojson&vehicle=truck");
    assert_eq!(answer.header("content-type"), "application/geo+json");
    let wanted = written(&["obstacles", "scenes/road.toml", "--vehicle", "truck"], "geojson");
    assert!(answer.bytes == wanted, "{} bytes, {} wanted", answer.bytes.len(), wanted.len());
}

#[test]
fn a_map_has_the_bytes_of_the_command_and_a_tag() {
    let server = server();
    let map = |path: &str| {
        let answer = server.get(&format!("/v1/analyze/{path}&format=png"));
        assert_eq!((answer.status, answer.header("content-type")), (200, "image/png"), "{path}");
        assert!(!answer.header("etag").is_empty(), "{path}");
        answer.bytes
    };
    let found = map(&format!("slope?dataset=dem&crs=EPSG:32616&extent={EXTENT}&unit=degrees"));
    let slope = ["slope", DEM, "--crs", "EPSG:32616", "--extent", EXTENT, "--unit", "degrees"];
    assert!(found == written(&slope, "png"), "{} bytes", found.len());
    let found = map("obstacles?dataset=road&vehicle=truck");
    assert!(found == written(&["obstacles", "scenes/road.toml", "--vehicle", "truck"], "png"));
}

#[test]
fn maps_of_a_stated_size_or_too_much_land_are_refused_and_many_take_turns() {
    let server = Server::start(Path::new(ROOT), &[DEM, "--max-posts", "30000"]);
    let at = format!("crs=EPSG:32616&extent={EXTENT}&format=png");
    for size in ["size=1000000x1000000", "width=-1", "dpi=1e9", "size="] {
        let refused = server.get(&format!("/v1/analyze/slope?{at}&{size}")).refused(400);
        assert!(refused.contains("extent"), "{refused}");
    }
    let much = server.get("/v1/analyze/slope?format=png").refused(400);
    assert!(much.contains("30000 are the most"), "{much}");
    let picture = server.get("/v1/analyze/slope?format=jpeg").refused(400);
    assert!(picture.contains("png"), "{picture}");
    std::thread::scope(|scope| {
        let asked: Vec<_> =
            (0..4).map(|_| scope.spawn(|| server.get(&format!("/v1/analyze/slope?{at}")))).collect();
        let answers: Vec<_> = asked.into_iter().map(|thread| thread.join().expect("asked")).collect();
        assert!(answers.iter().all(|answer| answer.status == 200 && answer.bytes == answers[0].bytes));
    });
    assert_eq!(server.get("/health").status, 200);
}

#[test]
fn the_document_of_the_queries_lists_the_map_among_the_answers() {
    let document = server().get("/openapi.json").ok();
    let answers = &document["paths"]["/v1/analyze/slope"]["get"]["responses"]["200"]["content"];
    assert!(answers["image/png"].is_object() && answers["image/tiff"].is_object(), "{answers}");
}

#[test]
fn positions_are_latitude_first_or_texts_with_bars_between() {
    let server = server();
    let posts = ["36.3,-84.2|36.35,-84.15", "16SGE0000099999|36.35,-84.15"];
    let ask = |posts: &str| {
        server.get(&format!("/v1/analyze/intervisibility?dataset=dem&posts={posts}&format=json"))
    };
    let answer = ask(posts[0]).ok();
    assert_eq!(answer["arguments"]["posts"], "-84.2,36.3;-84.15,36.35");
    assert_eq!((&answer["dataset"], &answer["status"]), (&"dem".into(), &"OK".into()));
    assert!(answer["figures"].as_array().is_some_and(|figures| !figures.is_empty()));
    // That square is not on the model.
    let off = ask(posts[1]).refused(400);
    assert!(off.contains("posts"), "{off}");
    let wrong = ask("here|there").refused(400);
    assert!(wrong.contains("posts") && wrong.contains("latitude,longitude"), "{wrong}");
    let swapped = server.get("/v1/analyze/slope?dataset=dem&extent=36.2,-84.2,36.22,-84.18");
    assert_eq!(swapped.status, 200, "{swapped:?}");
}

#[test]
fn an_answer_without_features_is_a_collection_without_any() {
    let server = server();
    let extent = "750000,4018000,750300,4018300";
    let answer = server.get(&format!("/v1/analyze/peaks?dataset=dem&crs=EPSG:32616&extent={extent}")).ok();
    assert_eq!((&answer["type"], &answer["features"]), (&"FeatureCollection".into(), &Value::Array(vec![])));
}

#[test]
fn what_is_wrong_with_an_analysis_is_named_and_no_file_is_read() {
    let server = server();
    let refused = |path: &str, status: u16| server.get(&format!("/v1/analyze/{path}")).refused(status);
    let unknown = refused("slop?dataset=dem", 404);
    assert!(unknown.contains("slope"), "{unknown}");
    let misspelled = refused("slope?dataset=dem&units=degrees", 400);
    assert!(misspelled.contains("'units'") && misspelled.contains("extent"), "{misspelled}");
    let word = refused("slope?dataset=dem&unit=degree&crs=native", 400);
    assert!(word.contains("`unit`"), "{word}");
    let off = refused("slope?dataset=dem&extent=37,-84.2,37.1,-84.1", 400);
    assert!(off.contains("`extent`") && off.contains("off the land"), "{off}");
    let file = refused("cut-fill?dataset=road&against=assets/jacksboro/dem.tif&format=json", 400);
    assert!(file.contains("there is no dataset"), "{file}");
    let raster = refused("intervisibility?dataset=dem&posts=36.3,-84.2|36.35,-84.15&format=tif", 400);
    assert!(raster.contains("gives no raster"), "{raster}");
}

#[test]
fn a_land_of_too_many_posts_is_refused_with_a_remedy() {
    let server = Server::start(Path::new(ROOT), &[DEM, "--max-posts", "1000"]);
    let refused = server.get("/v1/analyze/slope").refused(400);
    assert!(refused.contains("146982 posts, 1000 are the most") && refused.contains("extent"), "{refused}");
    let little = server.get("/v1/analyze/slope?crs=EPSG:32616&extent=749000,4017000,750000,4018000");
    assert_eq!(little.status, 200, "{little:?}");
}

#[test]
fn the_catalog_lists_every_kind_with_its_parameters() {
    let server = server();
    let list = server.get("/analyses").ok();
    let kinds = list["results"].as_array().expect("a list");
    assert!(kinds.len() >= 20 && list["status"] == "OK");
    for kind in kinds {
        let parameters = kind["parameters"].as_array().expect("a list");
        assert!(parameters.iter().any(|parameter| parameter["name"] == "extent"), "{kind}");
        assert!(kind["source"].as_str().is_some_and(|source| !source.is_empty()), "{kind}");
    }
}
