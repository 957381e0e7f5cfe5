//! `render` of several pictures, and `pick`.

use serde_json::Value;

use crate::cli::{project, run_in};
use crate::common::scratch::Scratch;

const SMALL: [&str; 2] = ["--size", "192x108"];

#[test]
fn each_camera_has_a_picture_and_each_is_that_of_the_camera_alone() {
    let scratch = Scratch::new();
    let scene = project("scenes/areas.toml");
    let all = [&["render", &scene, "--all-cameras", "-o", "all.png"], &SMALL[..]].concat();
    let out = run_in(scratch.folder(), &all).ok();
    assert_eq!(scratch.names(), ["all-south.png", "all-village.png"]);
    assert!(out.starts_with("all-") && out.contains("village: "), "{out}");
    let one = [&["render", &scene, "--camera", "south", "-o", "one.png"], &SMALL[..]].concat();
    run_in(scratch.folder(), &one).ok();
    let [of_all, alone] =
        ["all-south.png", "one.png"].map(|name| std::fs::read(scratch.at(name)).expect("there"));
    assert!(of_all == alone);
    let json = [&all[..], &["--json"]].concat();
    let json: Value = serde_json::from_str(&run_in(scratch.folder(), &json).ok()).expect("JSON");
    let cameras: Vec<&str> =
        json.as_array().expect("a list").iter().filter_map(|one| one["camera"].as_str()).collect();
    assert_eq!(cameras.len(), 2, "{cameras:?}");
}

#[test]
fn pictures_that_are_drawn_at_once_are_those_drawn_one_by_one() {
    let scene = project("scenes/jacksboro.toml");
    let drawn = |threads: &str| {
        let scratch = Scratch::new();
        let options = ["--all-cameras", "--sidecar", "--json", "--threads", threads, "-o", "all.png"];
        let out = run_in(scratch.folder(), &[&["render", &scene], &options[..], &SMALL[..]].concat()).ok();
        let mut all: Value = serde_json::from_str(&out).expect("JSON");
        all.as_array_mut().expect("a list").iter_mut().for_each(|one| one["seconds"] = Value::Null);
        let names = scratch.names();
        let files = names.iter().map(|name| std::fs::read(scratch.at(name)).expect("there"));
        let files: Vec<Vec<u8>> = files.collect();
        (names, files, all)
    };
    let one = drawn("1");
    assert_eq!(one.0.len(), 10, "{:?}", one.0);
    for threads in ["2", "5"] {
        assert!(drawn(threads) == one, "{threads} threads");
    }
}

#[test]
fn each_phase_has_a_picture_with_what_is_there_then() {
    let scratch = Scratch::new();
    let scene = project("scenes/phases.toml");
    let all = [&["render", &scene, "--all-phases", "-o", "day.png"], &SMALL[..]].concat();
    run_in(scratch.folder(), &all).ok();
    assert_eq!(scratch.names(), ["day-dusk.png", "day-morning.png", "day-noon.png"]);
    let bytes = |name: &str| std::fs::read(scratch.at(name)).expect("there");
    let render = |more: &[&str]| {
        let arguments = [&["render", scene.as_str(), "-o", "one.png"], more, &SMALL[..]].concat();
        run_in(scratch.folder(), &arguments)
    };
    render(&[]).ok();
    assert!(bytes("one.png") == bytes("day-morning.png"), "the first phase, where none is named");
    let out = render(&["--phase", "dusk"]).ok();
    assert!(bytes("one.png") == bytes("day-dusk.png") && bytes("one.png") != bytes("day-morning.png"));
    assert!(out.contains("4 models"), "{out}");
    let said = render(&["--phase", "dust"]).failed(1);
    assert!(said.contains("the scene has no phase 'dust'") && said.contains("did you mean `dusk`"), "{said}");
    let said = run_in(scratch.folder(), &["render", &project("scenes/road.toml"), "--all-phases"]).failed(2);
    assert!(said.contains("the scene has no [[phase]]"), "{said}");
}

#[test]
fn pick_says_what_a_pixel_shows() {
    let scratch = Scratch::new();
    let scene = project("scenes/lake.toml");
    let pick =
        |more: &[&str]| run_in(scratch.folder(), &[&["pick", scene.as_str()], more, &SMALL[..]].concat());
    let out = pick(&["--pixel", "96,60", "0,0"]).ok();
    for wanted in ["96,60", "shows", "EPSG:32616", "elevation", " m"] {
        assert!(out.contains(wanted), "{wanted} in\n{out}");
    }
    let json: Value = serde_json::from_str(&pick(&["--pixel", "96,60", "--json"]).ok()).expect("JSON");
    let at: Vec<f64> = json[0]["at"].as_array().expect("a place").iter().filter_map(Value::as_f64).collect();
    let height = ["height", &scene, "--at", &format!("{},{}", at[0], at[1]), "--json"];
    let height: Value = serde_json::from_str(&run_in(scratch.folder(), &height).ok()).expect("JSON");
    let found = height.pointer("/0/height").and_then(Value::as_f64);
    let elevation = json[0]["elevation_m"].as_f64().expect("an elevation");
    assert!((found.unwrap_or_else(|| panic!("{height}")) - elevation).abs() < 20.0, "{height} {json}");
    assert!(pick(&["--pixel", "192,0"]).failed(2).contains("is not on a picture of 192x108"));
    assert!(pick(&["--pixel", "a,b"]).failed(2).contains("960,540"));
}

#[test]
fn buffers_lie_in_the_folder_that_is_named() {
    let scratch = Scratch::new();
    let scene = project("scenes/lake.toml");
    let render = [&["render", &scene, "-o", "lake.png", "--buffers", "out/buffers"], &SMALL[..]].concat();
    run_in(scratch.folder(), &render).ok();
    for name in ["depth.tif", "elevation.tif", "feature.tif", "features.csv", "normal.png"] {
        assert!(scratch.at("out/buffers").join(name).is_file(), "{name}");
    }
}

#[test]
fn a_sheet_has_a_picture_for_each_camera_or_phase() {
    let scratch = Scratch::new();
    let small = |picture: image::RgbImage, [left, top]: [u32; 2]| {
        image::imageops::crop_imm(&picture, left, top, 300, 150).to_image().into_raw()
    };
    let sheet = |scene: &str, more: &[&str]| {
        let arguments =
            [&["render", scene, "--sheet", "-o", "sheet.png", "--size", "960x540"], more].concat();
        let out = run_in(scratch.folder(), &arguments).ok();
        assert!(out.starts_with("sheet.png\n"), "{out}");
        let picture = image::open(scratch.at("sheet.png")).expect("a picture").into_rgb8();
        assert_eq!((picture.width(), picture.height()), (960, 540));
        picture
    };
    let cameras = sheet(&project("scenes/areas.toml"), &[]);
    let [left, right] = [[60, 150], [560, 150]].map(|at| small(cameras.clone(), at));
    assert!(left != right);
    let phases = sheet(&project("scenes/phases.toml"), &["--all-phases"]);
    assert_eq!(scratch.names(), ["sheet.png"], "no picture of its own for any");
    let [first, second] = [[130, 70], [530, 70]].map(|at| small(phases.clone(), at));
    assert!(first != second);
    let scene = project("scenes/areas.toml");
    let said = run_in(scratch.folder(), &["render", &scene, "--sheet", "--size", "24x24"]).failed(2);
    assert!(said.contains("state a larger --size"), "{said}");
}

#[test]
fn a_sidecar_says_where_everything_is_and_of_what_the_picture_is() {
    let scratch = Scratch::new();
    let scene = project("scenes/labels.toml");
    let render = ["render", &scene, "-o", "west.png", "--sidecar", "--size", "480x270"];
    run_in(scratch.folder(), &render).ok();
    assert_eq!(scratch.names(), ["west.json", "west.png"]);
    let text = std::fs::read_to_string(scratch.at("west.json")).expect("written");
    let sidecar: Value = serde_json::from_str(&text).expect("JSON");
    assert_eq!(sidecar["scene"]["sha256"].as_str().map(str::len), Some(64));
    assert_eq!(sidecar["camera"]["projection"]["kind"], "perspective");
    let labels = sidecar["labels"].as_array().expect("a list");
    let placed: Vec<&Value> = labels.iter().filter(|label| label["state"] == "placed").collect();
    assert!(placed.len() > 3 && placed.len() <= labels.len(), "{labels:?}");
    for label in placed {
        let boxes = label["boxes"].as_array().expect("a list");
        assert!(!boxes.is_empty(), "{label}");
        for corners in boxes {
            let corners: Vec<f64> =
                corners.as_array().expect("four").iter().filter_map(Value::as_f64).collect();
            let [left, top, right, bottom] = corners[..] else { panic!("{label}") };
            assert!(0.0 <= left && left < right && right <= 480.0, "{label}");
            assert!(0.0 <= top && top < bottom && bottom <= 270.0, "{label}");
        }
    }
    let features = sidecar["features"].as_array().expect("a list");
    let share = |name: &str| {
        let feature = features.iter().find(|feature| feature["name"] == name);
        feature.unwrap_or_else(|| panic!("{name}: {features:?}"))["share"].as_f64().expect("a share")
    };
    assert!(share("ground") > 0.3 && share("lake Cove Lake") > 0.001);
    let shares: f64 = features.iter().filter_map(|feature| feature["share"].as_f64()).sum();
    assert!(shares <= 1.0 + 1e-9, "{shares}");
    // The same scene has the same sidecar; the picture itself says what it is.
    run_in(scratch.folder(), &render).ok();
    assert_eq!(std::fs::read_to_string(scratch.at("west.json")).expect("written"), text);
    let file = std::io::BufReader::new(std::fs::File::open(scratch.at("west.png")).expect("written"));
    let reader = png::Decoder::new(file).read_info().expect("a picture");
    let texts = &reader.info().utf8_text;
    let keys: Vec<&str> = texts.iter().map(|text| text.keyword.as_str()).collect();
    assert_eq!(keys, ["Software", "Title", "Description"]);
}
