//! `plan tiles --encoding`: what a reader of terrain-RGB finds in the pictures.

use std::f64::consts::PI;
use std::fs;

use serde_json::{Value, json};

use crate::cli::{bytes_of, program, run_in};
use crate::common::scratch::Scratch;

/// Pixels along a side of a tile.
const SIDE: usize = 256;
/// Half a step of the heights of terrain-RGB, and of the digits that `height` prints.
const HALF_STEP: f64 = 0.0501;

fn planned(arguments: &[&str]) -> (Scratch, usize) {
    let scratch = Scratch::new();
    scratch.write("dem.tif", bytes_of("assets/jacksboro/dem.tif"));
    let count = plan(&scratch, "dem.tif", arguments);
    (scratch, count)
}

fn plan(scratch: &Scratch, file: &str, arguments: &[&str]) -> usize {
    let plan = [&["plan", "tiles", file, "--json", "-o", "plan"], arguments].concat();
    let json: Value = serde_json::from_str(&run_in(scratch.folder(), &plan).ok()).expect("an object");
    json["shards"].as_u64().expect("a number") as usize
}

fn on_one_thread(scratch: &Scratch, arguments: &[&str]) {
    let status =
        program(scratch.folder(), arguments).env("RAYON_NUM_THREADS", "1").output().map(|ran| ran.status);
    assert!(status.is_ok_and(|status| status.success()), "{arguments:?}");
}

/// Does all shards and gathers them.
fn made(scratch: &Scratch, count: usize) -> Value {
    run_in(scratch.folder(), &["work", "plan", "--shards", &format!("0..{count}")]).ok();
    assert_eq!(run_in(scratch.folder(), &["gather", "plan"]).ok(), "plan/tiles/tilejson.json\n");
    serde_json::from_slice(&fs::read(scratch.at("plan/tiles/tilejson.json")).expect("written")).expect("JSON")
}

/// The colors of a tile, row by row from the north-west.
fn colors(scratch: &Scratch, [level, x, y]: [u64; 3]) -> Option<Vec<[f64; 3]>> {
    let file = fs::File::open(scratch.at(&format!("plan/tiles/{level}/{x}/{y}.png"))).ok()?;
    let mut reader = png::Decoder::new(std::io::BufReader::new(file)).read_info().expect("a picture");
    let info = reader.info();
    assert_eq!((info.width, info.height), (SIDE as u32, SIDE as u32));
    assert_eq!((info.color_type, info.bit_depth), (png::ColorType::Rgb, png::BitDepth::Eight));
    let mut bytes = vec![0; SIDE * SIDE * 3];
    reader.next_frame(&mut bytes).expect("sound pixels");
    Some(bytes.chunks_exact(3).map(|color| [color[0], color[1], color[2]].map(f64::from)).collect())
}

/// The heights of a tile of terrain-RGB, by Mapbox's formula.
fn heights(scratch: &Scratch, tile: [u64; 3]) -> Option<Vec<f64>> {
    let height = |[red, green, blue]: [f64; 3]| -10_000.0 + (red * 65_536.0 + green * 256.0 + blue) * 0.1;
    colors(scratch, tile).map(|colors| colors.into_iter().map(height).collect())
}

/// All tiles of a level that are there.
fn tiles(scratch: &Scratch, level: u64) -> Vec<[u64; 3]> {
    let names = |path: &str| -> Vec<String> {
        let Ok(entries) = fs::read_dir(scratch.at(path)) else { return Vec::new() };
        entries.map(|entry| entry.expect("readable").file_name().into_string().expect("a name")).collect()
    };
    let mut tiles = Vec::new();
    for x in names(&format!("plan/tiles/{level}")) {
        for y in names(&format!("plan/tiles/{level}/{x}")) {
            let y = y.strip_suffix(".png").expect("a picture").parse().expect("a number");
            tiles.push([level, x.parse().expect("a number"), y]);
        }
    }
    tiles.sort_unstable();
    tiles
}

/// Longitude and latitude of a place in a tile, in shares of its side from the north-west: the formula of slippy maps.
fn place([level, x, y]: [u64; 3], [across, down]: [f64; 2]) -> [f64; 2] {
    let tiles = (1u64 << level) as f64;
    let northing = PI * (1.0 - 2.0 * (y as f64 + down) / tiles);
    [(x as f64 + across) / tiles * 360.0 - 180.0, northing.sinh().atan() * 180.0 / PI]
}

#[test]
fn colors_are_the_heights_at_pixels_and_coarse_ones_their_means() {
    let (scratch, count) = planned(&["--encoding", "terrain-rgb"]);
    let json = made(&scratch, count);
    assert_eq!(json["tilejson"], "3.0.0");
    assert_eq!(
        (&json["encoding"], &json["scheme"], &json["tileSize"]),
        (&json!("mapbox"), &json!("xyz"), &json!(256))
    );
    assert_eq!((&json["minzoom"], &json["maxzoom"]), (&json!(0), &json!(11)));
    assert_eq!(json["tiles"], json!(["{z}/{x}/{y}.png"]));
    let bounds: Vec<f64> =
        json["bounds"].as_array().expect("four").iter().filter_map(Value::as_f64).collect();
    let [west, south, east, north] = bounds[..] else { panic!("{bounds:?}") };
    assert!((west + 84.41375).abs() < 1e-9 && (north - 36.44625).abs() < 1e-9, "{bounds:?}");

    // At the finest level there are those tiles that meet the elevation.
    let finest = tiles(&scratch, 11);
    let meets = |&tile: &[u64; 3]| {
        let ([left, top], [right, bottom]) = (place(tile, [0.0, 0.0]), place(tile, [1.0, 1.0]));
        left < east && right > west && bottom < north && top > south
    };
    let [first, last] = [finest[0], finest[finest.len() - 1]];
    let around: Vec<[u64; 3]> = (first[1] - 1..=last[1] + 1)
        .flat_map(|x| (first[2].min(last[2]) - 3..=first[2].max(last[2]) + 3).map(move |y| [11, x, y]))
        .filter(meets)
        .collect();
    assert_eq!(finest, around);
    let (mut points, mut expected) = (String::new(), Vec::new());
    for &tile in &finest {
        let heights = heights(&scratch, tile).expect("it is there");
        for pixel in (0..SIDE * SIDE).step_by(211) {
            let share = |at: usize| (at as f64 + 0.5) / SIDE as f64;
            let [lon, lat] = place(tile, [share(pixel % SIDE), share(pixel / SIDE)]);
            points += &format!("{lon},{lat}\n");
            expected.push(heights[pixel]);
        }
    }
    scratch.write("pixels.csv", &points);
    let query =
        ["height", "dem.tif", "--crs", "EPSG:4326", "--interpolation", "bilinear", "--points", "pixels.csv"];
    let answers = run_in(scratch.folder(), &query).ok();
    let (mut found, mut outside) = (0, 0);
    for (line, expected) in answers.lines().skip(1).zip(&expected) {
        match line.split(',').nth(2).expect("a height") {
            "" => {
                assert!(expected.abs() < 1e-9, "{line}: {expected}");
                outside += 1;
            }
            height => {
                let height: f64 = height.parse().expect("a number");
                assert!((height - expected).abs() < HALF_STEP, "{line}: {expected}");
                found += 1;
            }
        }
    }
    assert!(found > 500 && outside > 100 && found + outside == expected.len(), "{found} {outside}");

    // The elevation is nowhere at 0, which is the height of pixels without.
    let (mut means, mut parts) = (0, 0);
    for level in 0..11 {
        let coarse = tiles(&scratch, level);
        assert!(!coarse.is_empty(), "{level}");
        for tile in coarse {
            let own = heights(&scratch, tile).expect("it is there");
            let children = [0, 1, 2, 3].map(|child| {
                heights(&scratch, [level + 1, 2 * tile[1] + child % 2, 2 * tile[2] + child / 2])
            });
            for (pixel, height) in own.iter().enumerate() {
                let (column, row) = (pixel % SIDE * 2, pixel / SIDE * 2);
                let child = children[row / SIDE * 2 + column / SIDE].as_ref();
                let at = |child: &Vec<f64>, across: usize, down: usize| {
                    child[(row % SIDE + down) * SIDE + column % SIDE + across]
                };
                let four =
                    child.map(|child| [at(child, 0, 0), at(child, 1, 0), at(child, 0, 1), at(child, 1, 1)]);
                let valid: Vec<f64> =
                    four.into_iter().flatten().filter(|height| height.abs() > 1e-9).collect();
                let mean =
                    if valid.is_empty() { 0.0 } else { valid.iter().sum::<f64>() / valid.len() as f64 };
                assert!((height - mean).abs() < 2.0 * HALF_STEP, "{tile:?} {pixel}: {height} of {valid:?}");
                means += usize::from(valid.len() == 4);
                parts += usize::from((1..4).contains(&valid.len()));
            }
        }
    }
    assert!(means > 1000 && parts > 50, "{means} {parts}");
}

#[test]
fn fewer_levels_and_other_colors_are_of_the_same_heights() {
    let (all, count) = planned(&["--encoding", "terrain-rgb"]);
    made(&all, count);
    let (few, count) = planned(&["--encoding", "terrain-rgb", "--max-zoom", "7"]);
    assert_eq!(made(&few, count)["maxzoom"], 7);
    let (other, count) = planned(&["--encoding", "terrarium", "--max-zoom", "9"]);
    assert_eq!(made(&other, count)["encoding"], "terrarium");
    assert!(tiles(&few, 8).is_empty() && tiles(&other, 10).is_empty());
    for tile in (0..=9).flat_map(|level| tiles(&all, level)) {
        let [level, x, y] = tile;
        if level <= 7 {
            let bytes = |scratch: &Scratch| fs::read(scratch.at(&format!("plan/tiles/{level}/{x}/{y}.png")));
            assert!(bytes(&all).expect("there") == bytes(&few).expect("there"), "{tile:?}");
        }
        let terrarium = |[red, green, blue]: [f64; 3]| red * 256.0 + green + blue / 256.0 - 32_768.0;
        let others = colors(&other, tile).expect("there");
        for (height, other) in heights(&all, tile).expect("there").into_iter().zip(others) {
            assert!((height - terrarium(other)).abs() < 0.05 + 1.0 / 512.0 + 1e-6, "{tile:?}: {height}");
        }
    }
}

#[test]
fn shards_of_pictures_are_independent_and_done_once() {
    let (scratch, count) = planned(&["--encoding", "terrain-rgb", "--max-zoom", "13"]);
    let (other, _) = planned(&["--encoding", "terrain-rgb", "--max-zoom", "13"]);
    assert!(count >= 4, "{count}");
    for id in (0..count).rev() {
        on_one_thread(&other, &["work", "plan", "--shard", &id.to_string()]);
    }
    on_one_thread(&other, &["gather", "plan"]);
    made(&scratch, count);
    for level in 0..=13 {
        assert_eq!(tiles(&scratch, level), tiles(&other, level));
        for [_, x, y] in tiles(&scratch, level) {
            let read = |scratch: &Scratch| fs::read(scratch.at(&format!("plan/tiles/{level}/{x}/{y}.png")));
            assert!(read(&scratch).expect("there") == read(&other).expect("there"), "{level}/{x}/{y}");
        }
    }
    // A tile of a shard that is gone makes it stale, and only that; a coarse one is written again.
    let remove = |[level, x, y]: [u64; 3]| {
        fs::remove_file(scratch.at(&format!("plan/tiles/{level}/{x}/{y}.png"))).expect("it is there");
    };
    let [fine, coarse] = [13, 2].map(|level| tiles(&scratch, level)[0]);
    remove(fine);
    remove(coarse);
    assert!(run_in(scratch.folder(), &["gather", "plan"]).failed(1).contains("1 stale"));
    let work = ["work", "plan", "--shards", &format!("0..{count}")];
    let out = run_in(scratch.folder(), &work).ok();
    assert_eq!(out.lines().filter(|line| line.ends_with("done")).count(), 1, "{out}");
    run_in(scratch.folder(), &["gather", "plan"]).ok();
    assert!(tiles(&scratch, 13).contains(&fine) && tiles(&scratch, 2).contains(&coarse));
    let message = run_in(scratch.folder(), &["gather", "plan", "-o", "a.json"]).failed(1);
    assert!(message.contains("`tilejson.json`") && message.contains("leave out -o"), "{message}");
    // So do heights of a root that are gone, of which coarse tiles are made.
    fs::write(scratch.at("plan/shards/000001.means"), [0; 16]).expect("writable");
    assert!(run_in(scratch.folder(), &["gather", "plan"]).failed(1).contains("1 stale"));
}

#[test]
fn voids_are_at_zero_and_tiles_of_nothing_else_are_left_out() {
    let scratch = Scratch::new();
    // 480 columns from 7 to 7.4 degrees east, at 0.1 degrees south; nothing west of 7.2, and a void in the second row.
    let mut text =
        String::from("ncols 480\nnrows 8\nxllcorner 7\nyllcorner -0.1\ncellsize 0.00083333333333\n");
    text += "nodata_value -99\n";
    for row in 0..8 {
        let height = |column: usize| match column {
            ..240 => "-99".to_owned(),
            300..320 if (2..6).contains(&row) => "-99".to_owned(),
            _ => "-250".to_owned(),
        };
        text += &(0..480).map(height).collect::<Vec<_>>().join(" ");
        text.push('\n');
    }
    scratch.write("void.asc", &text);
    scratch.write("void.prj", "GEOGCS[\"WGS 84\",DATUM[\"WGS_1984\",SPHEROID[\"WGS 84\",6378137,298.257223563]],PRIMEM[\"Greenwich\",0],UNIT[\"degree\",0.0174532925199433]]");
    let count = plan(&scratch, "void.asc", &["--encoding", "terrain-rgb"]);
    made(&scratch, count);
    let finest = tiles(&scratch, 11);
    // Tiles are 0.176 degrees wide: the first begins at 7.03.
    assert_eq!(finest, [[11, 1064, 1024], [11, 1065, 1024], [11, 1066, 1024]]);
    for tile in (0..=11).flat_map(|level| tiles(&scratch, level)) {
        for height in heights(&scratch, tile).expect("there") {
            // Nothing lies between: no mean mixes elevation with what is none.
            assert!(height.abs() < 1e-9 || (height + 250.0).abs() < 1e-9, "{tile:?}: {height}");
        }
    }
    // The middle of the void, and of what is east of it.
    for (lon, wanted) in [(7.0 + 310.0 / 1200.0, 0.0), (7.0 + 400.0 / 1200.0, -250.0)] {
        let at = |degrees: f64| (degrees + 180.0) / 360.0 * 2048.0;
        let row = ((-0.1f64 + 4.0 / 1200.0) / -360.0 * 2048.0 * 256.0) as usize;
        let x = at(lon) as u64;
        let column = ((at(lon) - x as f64) * 256.0) as usize;
        let height = heights(&scratch, [11, x, 1024]).expect("there")[row * SIDE + column];
        assert!((height - wanted).abs() < 1e-9, "{lon}: {height}");
    }
}

#[test]
fn wrong_encodings_places_and_plans_of_pictures_are_refused() {
    let (scratch, _) = planned(&["--encoding", "terrain-rgb"]);
    let run = |arguments: &[&str]| run_in(scratch.folder(), arguments);
    let message = run(&["plan", "tiles", "dem.tif", "--encoding", "rgb", "-o", "plan"]).failed(2);
    assert!(message.contains("quantized-mesh") && message.contains("terrain-rgb"), "{message}");
    scratch.write("pole.asc", "ncols 2\nnrows 2\nxllcorner 10\nyllcorner 86\ncellsize 1\n1 2\n3 4\n");
    scratch.write("pole.prj", "GEOGCS[\"WGS 84\",DATUM[\"WGS_1984\",SPHEROID[\"WGS 84\",6378137,298.257223563]],PRIMEM[\"Greenwich\",0],UNIT[\"degree\",0.0174532925199433]]");
    let message = run(&["plan", "tiles", "pole.asc", "--encoding", "terrain-rgb", "-o", "pole"]).failed(1);
    assert!(message.contains("Web Mercator ends at 85.05"), "{message}");
    let message = run(&[
        "plan",
        "tiles",
        "dem.tif",
        "--encoding",
        "terrain-rgb",
        "--max-zoom",
        "22",
        "--limit",
        "plan-shards=100",
        "-o",
        "many",
    ])
    .failed(1);
    assert!(message.contains("shards"), "{message}");
    let text = fs::read_to_string(scratch.at("plan/plan.json")).expect("written");
    for (from, to, wanted) in [
        ("\"sampled_zoom\": 11", "\"sampled_zoom\": 99", "`sampled_zoom` is not `max_zoom` to 22"),
        ("\"sampled_zoom\": 11", "\"sampled_zoom\": 10", "`sampled_zoom` is not `max_zoom` to 22"),
        ("\"sampled_zoom\": 11", "\"sampled_zoom\": 14", "its `tile` is not one of the plan"),
        ("\"sampled_zoom\"", "\"sampled\"", "this is not a plan"),
        ("\"terrain-rgb\"", "\"terrain\"", "this is not a plan"),
    ] {
        assert!(text.contains(from), "{text}");
        scratch.write("plan/plan.json", text.replace(from, to));
        let message = run(&["work", "plan", "--shard", "0"]).failed(1);
        assert!(message.contains(wanted), "{to}: {message}");
    }
}
