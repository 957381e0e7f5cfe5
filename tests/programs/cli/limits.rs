//! `--limit`: each limit of the page may be set for a run, up and down, and refusals name it.

use flate2::Compression;
use flate2::write::GzEncoder;
use sandtable_base::archive;
use std::io::Write;

use crate::cli::attacks::sparse_tiff;
use crate::cli::{Ran, project, run, run_in};
use crate::common::scratch::Scratch;

const HILL: &str = "ncols 3\nnrows 3\nxllcorner 0\nyllcorner 0\ncellsize 1000\n1 2 3\n4 5 6\n7 8 9\n";

/// A scene on a hill with more tables.
fn scene(tables: &str) -> Scratch {
    let scratch = Scratch::new();
    scratch.write("hill.asc", HILL);
    scratch.write("s.toml", format!("[terrain]\ndem = \"hill.asc\"\ncrs = \"EPSG:32616\"\n{tables}"));
    scratch
}

fn with_limit(scratch: &Scratch, command: &[&str], limit: &str) -> Ran {
    run_in(scratch.folder(), &[command, &["--limit", limit]].concat())
}

/// The names of the page with their values; `None` for fixed ones.
fn page() -> Vec<(String, Option<String>)> {
    let text = std::fs::read_to_string(project("src/base/LIMITS.md")).expect("the page is there");
    let rows = text.lines().filter_map(|line| line.strip_prefix("| `"));
    rows.map(|row| {
        let (name, rest) = row.split_once("` | ").expect("a name in quotes");
        let most = rest.split(" |").next().expect("a value");
        let value = most.split(' ').next().expect("a number").replace(',', "");
        (name.to_owned(), (!most.ends_with(", fixed")).then_some(value))
    })
    .collect()
}

#[test]
fn every_name_on_the_page_is_a_limit_and_fixed_ones_stay() {
    let page = page();
    assert!(page.len() > 40, "the page's rows are not found");
    let mut all = vec!["schema".to_owned()];
    for (name, value) in &page {
        match value {
            Some(value) => all.extend(["--limit".to_owned(), format!("{name}={value}")]),
            None => {
                let said = run(&["schema", "--limit", &format!("{name}=1000")]).failed(2);
                assert!(said.contains(&format!("the limit `{name}` is fixed")), "{said}");
            }
        }
    }
    assert!(all.len() > 80, "most can be set");
    assert_eq!(run(&all).ok(), run(&["schema"]).ok());
}

#[test]
fn a_wrong_name_or_value_is_wrong_usage_and_the_nearest_name_is_told() {
    for (limit, said) in [
        ("raster-sample=10", "did you mean `raster-samples`?"),
        ("elephants=10", "there are raster-samples, reduced-samples,"),
        ("raster-samples", "raster-samples=1G"),
        ("raster-samples=many", "k, M or G"),
        ("raster-samples=0", "it may be 1 to 1073741824"),
        ("raster-samples=9G", "it may be 1 to 1073741824"),
    ] {
        let found = run(&["schema", "--limit", limit]).failed(2);
        assert!(found.contains(said), "{limit}: {found}");
    }
    let twice = ["schema", "--limit", "scene-list=300", "--limit", "scene-list=400"];
    assert!(run(&twice).failed(2).contains("--limit scene-list is stated twice"));
    let astride = ["--limit", "scene-text=300", "schema", "--limit=scene-list=400"];
    assert!(run(&astride).failed(2).contains("after the command"), "none is lost");
    assert_eq!(run(&["--limit", "scene-text=300", "schema"]).code, 0);
}

#[test]
fn a_lower_limit_refuses_by_name() {
    let square = "points = [[500, 500], [900, 500], [900, 900], [500, 900]]\n";
    let pentagram = "points = [[1500, 2400], [2000, 800], [700, 1800], [2300, 1800], [1000, 800]]\n";
    let road = "[[road]]\nwidth = 7\npoints = [[100, 1500], [2900, 1500]]\n";
    let check: &[&str] = &["check", "s.toml"];
    let hill: &[&str] = &["dem", "info", "hill.asc"];
    for (limit, command, tables) in [
        ("raster-samples=8", hill, String::new()),
        ("input-bytes=20", hill, String::new()),
        ("asset-bytes=20", check, road.to_owned()),
        ("scene-bytes=20", check, road.to_owned()),
        ("scene-tables=1", check, road.repeat(2)),
        ("scene-text=3", check, format!("{road}name = \"Main Street\"\n")),
        ("inline-points=1", check, road.to_owned()),
        ("expression-bytes=9", check, road.replace("7", "\"lanes * 3.25 ?? 6\"")),
        ("road-stations=1", check, format!("{road}profile = \"conform\"\n")),
        ("ring-crossings=2", check, format!("[[area]]\ncover = \"forest\"\n{pentagram}")),
        ("line-pieces=1", check, road.replace("[[road]]\nwidth = 7", "[[fence]]")),
        ("earthwork-steps=1", check, format!("[[earthwork]]\nkind = \"level\"\nlevel = 9\n{square}")),
        ("scene-list=1", check, format!("{road}[style]\nramp = [[0, \"#ffffff\"], [9, \"#000000\"]]\n")),
        (
            "profile-steps=3",
            &["profile", "hill.asc", "--line", "500,500", "2500,500", "--step", "1"],
            String::new(),
        ),
    ] {
        let scratch = scene(&tables);
        let name = limit.split('=').next().expect("a name");
        let refused = with_limit(&scratch, command, limit);
        let said = format!("{}{}", refused.out, refused.err);
        assert!(matches!(refused.code, 1 | 2), "{limit}: {refused:?}");
        assert!(said.contains(&format!("raise it with `--limit {name}=…`")), "{limit}: {said}");
        let passed = run_in(scratch.folder(), command);
        assert!(!passed.err.contains("--limit"), "{limit}: {passed:?}");
    }
}

#[test]
fn a_packed_file_is_unpacked_as_far_as_its_limit_says() {
    let scratch = Scratch::new();
    let mut packed = GzEncoder::new(Vec::new(), Compression::fast());
    packed.write_all(HILL.as_bytes()).expect("memory");
    scratch.write("hill.asc.gz", packed.finish().expect("memory"));
    let info: &[&str] = &["dem", "info", "hill.asc.gz"];
    let said = with_limit(&scratch, info, "unpacked-raster-bytes=50").failed(1);
    assert!(
        said.contains("more than 50 bytes") && said.contains("--limit unpacked-raster-bytes=…"),
        "{said}"
    );
    assert_eq!(with_limit(&scratch, info, "unpacked-raster-bytes=1k").code, 0);
}

#[test]
fn files_that_exceed_a_limit_of_their_format_name_it() {
    let scratch = Scratch::new();
    let points = |count: u32| (0..count).flat_map(move |y| (0..count).map(move |x| format!("{x} {y} 7\n")));
    scratch.write("grid.xyz", points(4).collect::<String>());
    scratch.write("large.tif", sparse_tiff(2048));
    let header = "ncols 2\nnrows 2\nnbits 16\nbyteorder I\nulxmap 0\nulymap 9\nxdim 1\nydim 1\n";
    scratch
        .write("a.zip", archive::zip(&[("a.bil", &[1; 8]), ("a.hdr", header.as_bytes())]).expect("memory"));
    for (limit, command) in [
        ("raster-samples=15", &["dem", "info", "grid.xyz"][..]),
        // Too large to be read whole, it is read in blocks.
        ("block-samples=1000", &["height", "large.tif", "--at", "10,10", "--limit", "raster-samples=2M"]),
        ("companion-bytes=20", &["dem", "info", "a.zip"]),
    ] {
        let name = limit.split('=').next().expect("a name");
        let said = with_limit(&scratch, command, limit).failed(1);
        assert!(said.contains(&format!("raise it with `--limit {name}=…`")), "{limit}: {said}");
        run_in(scratch.folder(), command).ok();
    }
}

#[test]
fn a_higher_limit_lets_pass_what_was_refused() {
    let long = format!(
        "[[road]]\nwidth = 7\nname = \"{}\"\npoints = [[100, 1500], [2900, 1500]]\n",
        "x".repeat(5000)
    );
    let scratch = scene(&long);
    let said = run_in(scratch.folder(), &["check", "s.toml"]).failed(1);
    assert!(said.contains("longer than 4096 characters") && said.contains("--limit scene-text=…"), "{said}");
    assert_eq!(with_limit(&scratch, &["check", "s.toml"], "scene-text=6k").code, 0);
    let [usual, raised] =
        [&["schema"][..], &["schema", "--limit", "scene-text=6k"]].map(|line| run(line).ok());
    let allows = |schema: &str| schema.contains("\"maxLength\": 6000");
    assert!(!allows(&usual) && allows(&raised), "editors accept what the program does");
}

#[test]
fn pictures_reduce_elevation_that_is_too_large_and_heights_do_not() {
    let scratch = Scratch::new();
    let row =
        |row: u32| (0..700).map(|column| (column * 7 + row * 3).to_string()).collect::<Vec<_>>().join(" ");
    let rows: Vec<String> = (0..600).map(row).collect();
    let head = "ncols 700\nnrows 600\nxllcorner 500000\nyllcorner 4000000\ncellsize 30\n";
    scratch.write("hill.asc", head.to_owned() + &rows.join("\n"));
    run_in(scratch.folder(), &["dem", "convert", "hill.asc", "hill.tif", "--source-crs", "EPSG:32616"]).ok();
    scratch.write("s.toml", "[terrain]\ndem = \"hill.tif\"\n");
    let limits = ["--limit", "raster-samples=100k", "--limit", "reduced-samples=50k"];
    let checked = run_in(scratch.folder(), &[&["check", "s.toml", "--json"][..], &limits].concat()).ok();
    assert!(
        checked.contains("elevation-reduced") && checked.contains("each height is that of 4 x 4 of them"),
        "{checked}"
    );
    // Of what a picture shows, no more is read than it can show, and that is as good.
    let picture = |scene: &str, size: &str, more: &[&str]| {
        scratch.write("s.toml", format!("[terrain]\ndem = \"hill.tif\"\n{scene}"));
        let command = [&["render", "s.toml", "--json", "--size", size][..], more].concat();
        let told: serde_json::Value =
            serde_json::from_str(&run_in(scratch.folder(), &command).ok()).expect("JSON");
        let number = |of: &str| told.pointer(of).and_then(|value| value.as_f64()).expect("a number");
        let is_reduced = told["notes"].to_string().contains("the picture shows 2 x 2 within a pixel");
        (is_reduced, number("/ground_lightness/mean"), number("/ground_fraction"))
    };
    let few = ["--limit", "pictured-samples=100k"];
    let [whole, reduced] = [picture("", "128x72", &[]), picture("", "128x72", &few)];
    assert!(!whole.0 && reduced.0, "{whole:?} {reduced:?}");
    assert!((whole.1 - reduced.1).abs() < 0.5 && (whole.2 - reduced.2).abs() < 0.01, "{whole:?} {reduced:?}");
    assert!(!picture("", "640x360", &few).0, "a larger picture shows all samples");
    let label = "[[label]]\nat = [510000, 4009000]\ntext = \"{height} m\"\n";
    assert!(picture(label, "128x72", &few).0, "heights that are printed are read apart from the picture");
    let near = "[[camera]]\nname = \"near\"\neye = [509000, 4008000]\nlook_at = [510000, 4009000]\n";
    assert!(!picture(near, "128x72", &few).0, "a camera near the ground sees samples");
    let high = near.replace("look_at", "eye_elevation = 200000\nlook_at");
    assert!(picture(&high, "128x72", &few).0, "from 200 km above, no ground is near");
    let part = "[[camera]]\nname = \"part\"\nshows = [[508000, 4008000], [509000, 4009000]]\n";
    assert!(!picture(part, "128x72", &few).0, "a kilometer of it fills the picture");
    let plan = "[[camera]]\nname = \"plan\"\nprojection = \"plan\"\nscale = 900000\n";
    assert!(picture(plan, "128x72", &few).0, "a pixel of a plan at 1 : 900,000 is 238 m wide");
    assert!(picture(&format!("{plan}{near}"), "128x72", &few).0);
    assert!(!picture(&format!("{plan}{near}"), "128x72", &[&few[..], &["--camera", "near"]].concat()).0);
    scratch.write("s.toml", "[terrain]\ndem = \"hill.tif\"\n");
    let refused =
        run_in(scratch.folder(), &[&["height", "s.toml", "--at", "500100,4000100"][..], &limits].concat());
    let said = refused.failed(1);
    assert!(said.contains("raster-samples"), "{said}");
    scratch
        .write("s.toml", "[terrain]\ndem = \"hill.tif\"\nextent = [[500300, 4000300], [500900, 4000900]]\n");
    let checked = run_in(scratch.folder(), &[&["check", "s.toml", "--json"][..], &limits].concat());
    assert!(!checked.ok().contains("elevation-reduced"), "an extent is taken in full");
}
