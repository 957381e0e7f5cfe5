//! `plan atlas`, and what becomes of its sheets.

use std::fs;

use image::RgbImage;
use serde_json::Value;

use crate::cli::{bytes_of, run_in};
use crate::common::scratch::Scratch;

/// A scene of the demo's ground alone, with a layout.
pub fn scene(layout: &str) -> Scratch {
    let scratch = Scratch::new();
    scratch.write("dem.tif", bytes_of("assets/jacksboro/dem.tif"));
    let text = format!(
        "title = \"Hills & <valleys>\"\n[terrain]\ndem = \"dem.tif\"\n[furniture]\nlayout = \"{layout}\"\n"
    );
    scratch.write("scene.toml", text);
    scratch
}

/// Plans an atlas and returns its shards.
pub fn planned(scratch: &Scratch, arguments: &[&str]) -> Vec<Value> {
    let plan = [&["plan", "atlas", "scene.toml", "-o", "plan"], arguments].concat();
    assert_eq!(run_in(scratch.folder(), &plan).code, 0);
    let lines = fs::read_to_string(scratch.at("plan/shards.jsonl")).expect("written");
    lines.lines().map(|line| serde_json::from_str(line).expect("a shard")).collect()
}

pub fn picture(scratch: &Scratch, id: usize) -> RgbImage {
    image::open(scratch.at(&format!("plan/shards/{id:06}.png"))).expect("a picture").to_rgb8()
}

/// The mean difference of two columns of pixels.
fn difference(a: (&RgbImage, u32), b: (&RgbImage, u32)) -> f64 {
    let rows = a.0.height();
    let row = |y: u32| -> u32 {
        let (a, b) = (a.0.get_pixel(a.1, y), b.0.get_pixel(b.1, y));
        a.0.iter().zip(b.0).map(|(&a, b)| u32::from(a.abs_diff(b))).sum()
    };
    f64::from((0..rows).map(row).sum::<u32>()) / f64::from(rows)
}

#[test]
fn sheets_meet_without_a_seam_and_any_worker_draws_the_same() {
    let scratch = scene("none");
    let shards = planned(&scratch, &["--scale", "120000", "--dpi", "60"]);
    let names: Vec<&str> = shards.iter().map(|shard| shard["name"].as_str().expect("a name")).collect();
    assert_eq!(names, ["A1", "B1"], "the landscape sheets lie one below the other");
    let upright = scene("none");
    let shards = planned(&upright, &["--scale", "100000", "--dpi", "60", "--portrait"]);
    let names: Vec<&str> = shards.iter().map(|shard| shard["name"].as_str().expect("a name")).collect();
    assert_eq!(names, ["A1", "A2", "B1", "B2"]);
    assert_eq!(shards[0]["neighbors"], serde_json::json!({ "east": 1, "south": 2 }));
    assert_eq!(shards[0]["window"][2], shards[1]["window"][0]);
    assert_eq!(run_in(upright.folder(), &["work", "plan", "--shards", "0..4"]).code, 0);
    let (west, east) = (picture(&upright, 2), picture(&upright, 3));
    assert_eq!((west.width(), west.height()), (496, 702));
    let last = west.width() - 1;
    let across = difference((&west, last), (&east, 0));
    let beside = difference((&west, last - 1), (&west, last)).max(difference((&east, 0), (&east, 1)));
    assert!(beside > 0.5, "the sheets show relief at their seam");
    assert!(across < 1.5 * beside, "{across} across the seam, {beside} beside it");
    let before = fs::read(upright.at("plan/shards/000003.png")).expect("written");
    fs::remove_file(upright.at("plan/shards/000003.json")).expect("written");
    assert_eq!(run_in(upright.folder(), &["work", "plan", "--shard", "3"]).code, 0);
    assert!(fs::read(upright.at("plan/shards/000003.png")).expect("written") == before);
}

#[test]
fn the_index_shows_what_is_done_and_what_is_missing() {
    let scratch = scene("margin");
    let shards = planned(&scratch, &["--scale", "200000", "--dpi", "75"]);
    assert!((2..=6).contains(&shards.len()), "{shards:?}");
    let work = |range: &str| run_in(scratch.folder(), &["work", "plan", "--shards", range]).code;
    assert_eq!(work("0..1"), 0);
    let gathered = run_in(scratch.folder(), &["gather", "plan"]);
    assert_eq!((gathered.code, gathered.out.as_str()), (1, "plan/index.html\nplan/items.json\n"));
    let page = || fs::read_to_string(scratch.at("plan/index.html")).expect("written");
    assert!(page().contains("<h1>Hills &amp; &lt;valleys&gt;</h1>"));
    assert_eq!(page().matches("class=\"missing\"").count(), shards.len() - 1);
    assert!(page().contains("<a href=\"shards/000000.png\">"), "{}", page());
    assert_eq!(work(&format!("0..{}", shards.len())), 0);
    run_in(scratch.folder(), &["gather", "plan"]).ok();
    assert!(!page().contains("class=\"missing\"") && !page().contains("http"));
    let items: Value =
        serde_json::from_slice(&fs::read(scratch.at("plan/items.json")).expect("written")).expect("JSON");
    for (item, shard) in items["features"].as_array().expect("a list").iter().zip(&shards) {
        assert_eq!((&item["id"], &item["properties"]["sandtable:status"]), (&shard["name"], &"done".into()));
        let href = item["assets"]["sheet"]["href"].as_str().expect("a path");
        assert!(scratch.at("plan").join(href).exists());
        let bbox: Vec<f64> = serde_json::from_value(item["bbox"].clone()).expect("four numbers");
        assert!(bbox[0] > -85.0 && bbox[2] < -83.5 && bbox[1] > 35.8 && bbox[3] < 36.8, "{bbox:?}");
        assert_eq!(item["geometry"]["coordinates"][0].as_array().expect("a ring").len(), 5);
    }
}

#[test]
fn atlases_of_nothing_and_of_too_much_are_refused() {
    let scratch = scene("none");
    let plan =
        |scale: &str| run_in(scratch.folder(), &["plan", "atlas", "scene.toml", "--scale", scale, "-o", "p"]);
    let many = plan("10");
    assert!(many.code == 1 && many.err.contains("shards are more than the 1000000"), "{many:?}");
    assert_eq!(plan("0").code, 2);
    let shards = planned(&scratch, &["--scale", "400000"]);
    assert_eq!(shards.len(), 1);
    let plan = fs::read_to_string(scratch.at("plan/plan.json")).expect("written");
    scratch.write("plan/plan.json", plan.replace("400000.0", "0.5"));
    let message = run_in(scratch.folder(), &["work", "plan", "--shard", "0"]).failed(1);
    assert!(message.contains("`scale` is not 1 to 1e9"), "{message}");
}

#[test]
fn sheets_at_a_small_scale_are_made_of_as_many_samples_as_they_show() {
    let scratch = Scratch::new();
    let heights = (0..1100 * 1100u32).flat_map(|at| ((at % 1100 + at / 1100 * 2 % 777) as f32).to_le_bytes());
    scratch.write("dem.flt", heights.collect::<Vec<u8>>());
    let header =
        "ncols 1100\nnrows 1100\nxllcorner 700000\nyllcorner 4000000\ncellsize 30\nbyteorder LSBFIRST\n";
    scratch.write("dem.hdr", header);
    scratch.write("scene.toml", "[terrain]\ndem = \"dem.flt\"\ncrs = \"EPSG:32616\"\n");
    let posts = |limit: &[&str]| -> f64 {
        let shards = planned(&scratch, &[&["--scale", "1000000", "--dpi", "60"], limit].concat());
        shards.iter().map(|shard| shard["cost"].as_f64().expect("a number")).sum()
    };
    let (all, shown) = (posts(&[]), posts(&["--limit", "pictured-samples=100k"]));
    assert!(shown > 0.0 && all > 15.0 * shown, "{all} posts, of which sheets show {shown}");
}
