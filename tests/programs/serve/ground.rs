//! `/v1/los`, `/v1/profile`, `/v1/viewshed`: questions about the ground in meters.

use std::ops::ControlFlow;
use std::path::Path;

use glam::DVec2;
use sandtable_query::dataset::{Dataset, DatasetOptions};
use sandtable_terrain::profile::profile;
use sandtable_terrain::sight::Curvature;
use sandtable_terrain::sight::line::SightEnd;
use sandtable_terrain::sight::viewshed::{PostVisibility, Sector, ViewshedOptions, viewshed};
use serde_json::json;

use crate::common::data::data;
use crate::common::scratch::Scratch;
use crate::serve::bits::all_ground;
use crate::serve::client::{Server, numbers};

/// 41 × 41 posts ten meters apart, level, with a wall 20 m high from south to north through the middle column.
fn walled() -> Scratch {
    let row =
        (0..41).map(|column| if column == 20 { "20" } else { "0" }).collect::<Vec<_>>().join(" ") + "\n";
    let scratch = Scratch::new();
    let text =
        format!("ncols 41\nnrows 41\nxllcorner 499995\nyllcorner 4999995\ncellsize 10\n{}", row.repeat(41));
    scratch.write("wall.asc", text);
    scratch.write("wall.prj", "EPSG:32632");
    scratch
}

#[test]
fn a_wall_blocks_the_sight_and_is_named() {
    let scratch = walled();
    let server = Server::start(scratch.folder(), &["wall.asc"]);
    let los = |more: &str| {
        server.get(&format!("/v1/los?from=500050,5000200&to=500350,5000200&crs=native&earth=flat{more}")).ok()
    };
    assert_eq!(
        los("&observer_height=5"),
        json!({
            "dataset": "wall", "sight": "Blocked", "visible": false, "distance_m": 300.0,
            "blocker": {"location": {"x": 500_200.0, "y": 5_000_200.0}, "distance_m": 150.0, "elevation": 20.0},
            "status": "OK",
        })
    );
    let clear = los("&observer_height=25&target_height=25");
    assert_eq!(
        (&clear["sight"], &clear["visible"], &clear["blocker"]),
        (&json!("Clear"), &json!(true), &json!(null))
    );
    let outside = server.get("/v1/los?from=500050,5000200&to=0,0&crs=native").ok();
    assert_eq!((&outside["sight"], &outside["visible"]), (&json!("Outside"), &json!(null)));
}

#[test]
fn a_profile_has_a_station_wherever_the_ground_bends() {
    let scratch = walled();
    let server = Server::start(scratch.folder(), &["wall.asc"]);
    let answer = server.get("/v1/profile?locations=500190,5000200|500210,5000200&crs=native");
    assert_eq!(answer.ok()["length_m"], 20.0);
    assert_eq!(numbers(&answer.body, "station_m"), [Some(0.0), Some(10.0), Some(20.0)]);
    assert_eq!(numbers(&answer.body, "elevation"), [Some(0.0), Some(20.0), Some(0.0)]);
    let off = server.get("/v1/profile?locations=500190,5000200|599990,5000200&crs=native").ok();
    assert_eq!(
        off["results"].as_array().and_then(|all| all.last()).map(|last| &last["status"]),
        Some(&json!("Outside"))
    );
}

#[test]
fn a_viewshed_tells_each_post_in_runs() {
    let scratch = walled();
    let server = Server::start(scratch.folder(), &["wall.asc"]);
    let path = "/v1/viewshed?observer=500100,5000200&observer_height=2&range=150&earth=flat&crs=native";
    let answer = server.get(path).ok();
    assert_eq!(
        (&answer["columns"], &answer["rows"], &answer["crs"]),
        (&json!(26), &json!(31), &json!("EPSG:32632"))
    );
    assert_eq!(answer["south_west"], json!({"x": 500_000.0, "y": 5_000_050.0}));
    let rows = answer["runs"].as_array().expect("rows");
    let middle = rows[15].as_str().expect("a row");
    assert_eq!(middle, "21v5h", "the wall, 100 m east of the observer, is seen; what is behind it is not");
    assert_eq!(rows[0].as_str(), Some("10b1v15b"), "only the post right south of the observer is in range");
    let counts = &answer["counts"];
    let total: u64 =
        ["visible", "hidden", "no_data", "beyond"].iter().filter_map(|name| counts[name].as_u64()).sum();
    assert_eq!(total, 26 * 31);
    assert_eq!(answer["visible_area_m2"].as_f64(), counts["visible"].as_f64().map(|count| count * 100.0));
    let summary = server.get(&format!("{path}&format=summary")).ok();
    assert_eq!((summary.get("runs"), &summary["counts"]), (None, counts));
    let north = server.get(&format!("{path}&sector=315,90")).ok();
    assert_eq!(north["runs"][0], "26b", "south lies out of the sector");
}

#[test]
fn a_viewshed_of_a_small_range_says_of_its_posts_what_a_larger_one_does() {
    let scratch = walled();
    let server = Server::start(scratch.folder(), &["wall.asc"]);
    let letters = |range: u32| {
        let path = format!("/v1/viewshed?observer=500153,5000207&earth=flat&crs=native&range={range}");
        let answer = server.get(&path).ok();
        let corner = ["x", "y"].map(|axis| answer["south_west"][axis].as_f64().expect("a number"));
        let rows = answer["runs"].as_array().expect("rows").clone();
        let row = |row: &serde_json::Value| {
            let posts = runs(row.as_str().expect("a row"));
            posts.flat_map(|(length, letter)| vec![letter; length as usize]).collect::<Vec<char>>()
        };
        (corner, rows.iter().map(row).collect::<Vec<_>>())
    };
    let (small, large) = (letters(70), letters(190));
    let beside = [0, 1].map(|axis| ((small.0[axis] - large.0[axis]) / 10.0).round() as usize);
    let mut seen = [0, 0];
    for (row, posts) in small.1.iter().enumerate() {
        for (column, &post) in posts.iter().enumerate().filter(|(_, post)| **post != 'b') {
            assert_eq!(post, large.1[row + beside[1]][column + beside[0]], "{column} {row}");
            seen[usize::from(post == 'h')] += 1;
        }
    }
    assert!(seen.iter().all(|&posts| posts > 10), "some are seen, and some hidden: {seen:?}");
}

#[test]
fn a_viewshed_too_large_is_refused_with_the_range_that_is_not() {
    let scratch = walled();
    let server = Server::start(scratch.folder(), &["wall.asc", "--max-posts", "100"]);
    let whole = "/v1/viewshed?observer=500100,5000200&crs=native";
    let refused = server.get(whole).refused(400);
    assert!(refused.contains("1681 posts") && refused.contains("range=35 "), "{refused}");
    assert_eq!(server.get(&format!("{whole}&range=35")).status, 200);
    let outside = server.get("/v1/viewshed?observer=0,0&crs=native&range=10").refused(400);
    assert!(outside.contains("Outside"), "{outside}");
}

#[test]
fn on_a_real_model_profile_and_viewshed_are_the_librarys() {
    let Some(file) = data("dem/bigtujunga_utm11_i16_tiled.tif") else { return };
    let dataset = Dataset::open(&file, &DatasetOptions::default()).expect("sound");
    let ground = all_ground(&dataset);
    let lattice = &ground.lattice;
    let server = Server::start(Path::new("."), &[&format!("dem={}", file.display())]);

    let line = [DVec2::new(380_000.0, 3_805_000.0), DVec2::new(398_000.0, 3_796_500.0)];
    let stations = profile(lattice, &line);
    let [a, b] = line;
    let path = format!("/v1/profile?locations={},{}|{},{}&crs=native", a.x, a.y, b.x, b.y);
    let answer = server.get(&path);
    let bits = |values: Vec<Option<f64>>| {
        values.into_iter().map(|value| value.map(f64::to_bits)).collect::<Vec<_>>()
    };
    let expected = stations.iter().map(|station| station.ground.height_m()).collect();
    assert_eq!(bits(numbers(&answer.body, "elevation")), bits(expected));
    let expected = stations.iter().map(|station| Some(station.station_m)).collect();
    assert_eq!(bits(numbers(&answer.body, "station_m")), bits(expected));
    assert!(stations.len() > 1000, "{}", stations.len());

    let options = ViewshedOptions {
        observer: SightEnd { at: a, above_m: 10.0 },
        target_above_m: 1.5,
        range_m: 2500.0,
        sector: Sector::ALL,
        curvature: Curvature::default(),
    };
    let seen = viewshed(lattice, &options).expect("ground");
    let count = |which: PostVisibility| seen.posts.iter().filter(|&&post| post == which).count() as u64;
    let path = format!(
        "/v1/viewshed?observer={},{}&crs=native&observer_height=10&target_height=1.5&range=2500",
        a.x, a.y
    );
    let answer = server.get(&path).ok();
    assert_eq!(answer["counts"]["visible"].as_u64(), Some(count(PostVisibility::Visible)));
    assert_eq!(answer["counts"]["hidden"].as_u64(), Some(count(PostVisibility::Hidden)));
    let answer: String =
        answer["runs"].as_array().expect("rows").iter().filter_map(|row| row.as_str()).collect();
    let visible: u64 = runs(&answer).filter(|&(_, letter)| letter == 'v').map(|(length, _)| length).sum();
    assert_eq!(visible, count(PostVisibility::Visible), "the runs tell the same as the counts");
    assert!(visible > 100);
}

/// The lengths and letters of runs.
fn runs(text: &str) -> impl Iterator<Item = (u64, char)> + '_ {
    let mut length = 0;
    let found = move |c: char| match c.to_digit(10) {
        Some(digit) => {
            length = length * 10 + u64::from(digit);
            ControlFlow::Continue(())
        }
        None => ControlFlow::Break((std::mem::take(&mut length), c)),
    };
    text.chars().map(found).filter_map(ControlFlow::break_value)
}
