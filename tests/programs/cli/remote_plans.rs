//! Plans and new scenes of elevation by its address: the results of the file on disk, until its server has another.

use std::fs;

use crate::cli::project;
use crate::cli::remote_servers::TestServer;
use crate::common::data::data;

const ADDRESS: &str = "s3://terrain/dem/terrain.tif";

/// What a run prints that must have succeeded; beside it, it notes what was fetched.
#[track_caller]
fn done(server: &TestServer, words: &[&str]) -> String {
    let ran = server.run("blocks", words);
    assert_eq!(ran.code, 0, "{ran:?}");
    ran.out
}

#[test]
fn shards_of_an_address_are_done_until_its_server_has_another_version() {
    let Some(mut server) = TestServer::s3() else { return };
    let (dem, points) = (project("assets/jacksboro/dem.tif"), project("assets/jacksboro/points.csv"));
    server.put(dem.as_ref(), "dem/terrain.tif");
    let run = |words: &[&str]| done(&server, words);
    let query = ["--points", &points, "--crs", "EPSG:4326"];
    run(&[&["plan", "heights", ADDRESS, "-o", "plan"], &query[..]].concat());
    let plan = fs::read_to_string(server.scratch.at("plan/plan.json")).expect("written");
    let plan: serde_json::Value = serde_json::from_str(&plan).expect("JSON");
    let input = &plan["inputs"][0];
    assert_eq!((&input["path"], &input["check"]), (&ADDRESS.into(), &"version".into()));
    assert_eq!(input["bytes"], fs::metadata(&dem).expect("there").len());
    assert!(input["version"].as_str().is_some_and(|version| version.len() > 8), "{input}");
    assert_eq!(run(&["work", "plan", "--shard", "0"]), "0 done\n");
    run(&["gather", "plan"]);
    let gathered = fs::read_to_string(server.scratch.at("plan/heights.csv")).expect("gathered");
    assert_eq!(gathered, run(&[&["height", &dem], &query[..]].concat()));

    run(&["plan", "tiles", ADDRESS, "--max-zoom", "6", "-o", "tiles"]);
    assert!(run(&["work", "tiles", "--shards", "0..1"]).ends_with(" done\n"));

    fs::remove_file(server.scratch.at("plan/shards/000000.json")).expect("a record");
    server.put(project("assets/jacksboro/valley.asc").as_ref(), "dem/terrain.tif");
    let stale = server.run("blocks", &["work", "plan", "--shard", "0"]).failed(1);
    assert!(stale.contains(ADDRESS) && stale.contains("stale") && stale.contains("planned with"), "{stale}");
    assert!(!server.scratch.at("plan/shards/000000.json").exists());
}

#[test]
fn a_new_scene_names_the_address_of_its_elevation() {
    let Some(mut server) = TestServer::s3() else { return };
    server.put(project("assets/jacksboro/dem.tif").as_ref(), "dem/terrain.tif");
    let said = done(&server, &["new", "made", "--dem", ADDRESS]);
    assert!(said.contains(&format!("--allow-remote {}", server.host)), "{said}");
    let scene = fs::read_to_string(server.scratch.at("made/scene.toml")).expect("written");
    assert!(scene.contains(&format!("dem = \"{ADDRESS}\"")), "{scene}");
    done(&server, &["check", "made/scene.toml"]);
}

#[test]
fn a_new_scene_surveys_vector_files_by_address_as_those_on_disk() {
    let Some(mut server) = TestServer::s3() else { return };
    for file in ["jacksboro/dem.tif", "jacksboro/roads.geojson", "jacksboro/lake.geojson"] {
        server.put(project(&format!("assets/{file}")).as_ref(), file);
    }
    let tables = |folder: &str, from: &str| {
        let name = |file: &str| format!("{from}{file}");
        let [dem, roads, lakes] =
            ["jacksboro/dem.tif", "jacksboro/roads.geojson", "jacksboro/lake.geojson"].map(name);
        let said = done(&server, &["new", folder, "--dem", &dem, "--vectors", &roads, &lakes]);
        let scene = fs::read_to_string(server.scratch.at(folder).join("scene.toml")).expect("written");
        // The same but for the places of files.
        (
            said,
            scene.lines().filter(|line| !line.contains("jacksboro/")).map(str::to_owned).collect::<Vec<_>>(),
        )
    };
    let (said, there) = tables("there", "s3://terrain/");
    assert!(said.contains(&format!("--allow-remote {}", server.host)), "{said}");
    let (_, here) = tables("here", &format!("{}/", project("assets")));
    assert!(
        here.iter().any(|line| line.contains("[[road]]"))
            && here.iter().any(|line| line.contains("[[lake]]"))
    );
    assert_eq!(there, here);
    done(&server, &["check", "there/scene.toml"]);
    let gone = ["new", "gone", "--dem", "s3://terrain/jacksboro/dem.tif", "--vectors", "s3://terrain/no.shp"];
    let gone = server.run("blocks", &gone).failed(1);
    assert!(gone.contains("s3://terrain/no.shp") && !server.scratch.at("gone").exists(), "{gone}");
}

#[test]
fn a_new_scene_finds_the_tables_of_a_shapefile_on_a_server() {
    let Some(mut server) = TestServer::s3() else { return };
    let folder = std::path::Path::new(env!("SANDTABLE_ROOT")).join("../shared/data/scenes/swellendam_za");
    for file in ["rivers.shp", "rivers.dbf", "rivers.prj", "rivers.cpg", "dem_srtm_utm33s_i16.tif"] {
        let Some(path) = data(&format!("scenes/swellendam_za/{file}")) else { return };
        server.put(&path, file);
    }
    let rivers = |name: &str, from: &str| {
        let [dem, rivers] = ["dem_srtm_utm33s_i16.tif", "rivers.shp"].map(|file| format!("{from}{file}"));
        done(&server, &["new", name, "--title", "Rivers", "--dem", &dem, "--vectors", &rivers]);
        let scene = fs::read_to_string(server.scratch.at(name).join("scene.toml")).expect("written");
        scene
            .lines()
            .filter(|line| !line.contains("rivers.shp") && !line.contains("dem_srtm"))
            .collect::<String>()
    };
    let there = rivers("there", "s3://terrain/");
    assert!(there.contains("[[river]]"), "{there}");
    assert_eq!(there, rivers("here", &format!("{}/", folder.display())));
}
