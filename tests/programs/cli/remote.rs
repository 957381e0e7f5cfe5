//! Elevation by address, as the program reads it: without the feature `cloud` one sentence, with it the answers of the file on
//! disk, from `moto`'s server.

use crate::cli::run;

#[test]
#[cfg(not(feature = "cloud"))]
fn a_program_without_the_feature_says_how_it_is_built() {
    let questions: [&[&str]; 2] =
        [&["height", "s3://b/a.tif", "--at", "1,2"], &["dem", "info", "HTTPS://example.org/a.tif"]];
    for arguments in questions {
        let error = run(arguments).failed(1);
        assert!(error.contains("--features cloud"), "{error}");
    }
}

#[test]
fn a_scene_file_has_no_address_and_no_output_has_one() {
    let dem = crate::cli::project("assets/jacksboro/dem.tif");
    let error = run(&["check", "https://example.org/scene.toml"]).failed(1);
    assert!(error.contains("elevation and what a scene names are read by address"), "{error}");
    let error = run(&["dem", "convert", &dem, "-o", "s3://bucket/out.tif"]).failed(1);
    assert!(error.contains("results are written to files"), "{error}");
    let error = run(&["height", "--allow-remote", "https://a.org", &dem, "--at", "1,2"]).failed(2);
    assert!(error.contains("is no host"), "{error}");
}

#[cfg(feature = "cloud")]
mod with_moto {
    use std::ffi::OsString;
    use std::path::PathBuf;

    use crate::cli::remote_servers::TestServer;
    use crate::cli::{program, project, ran};
    use crate::common::data::data;
    use crate::common::scratch::Scratch;

    /// Samples along a side of the raster: 64 tiles.
    const SIDE: u32 = 2048;

    /// Terrain that packs as real terrain does: hills, and a noise of decimeters.
    fn write_terrain(scratch: &Scratch) -> PathBuf {
        let mut bytes = Vec::new();
        let mut state = 7u32;
        for row in 0..SIDE {
            for column in 0..SIDE {
                state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                let (x, y) = (f64::from(column), f64::from(row));
                let noise = f64::from(state >> 24) / 256.0;
                let z = 800.0
                    + 300.0 * (x * 0.006).sin() * (y * 0.004).cos()
                    + 40.0 * (x * 0.05 + y * 0.03).sin()
                    + noise;
                bytes.extend((z as f32).to_le_bytes());
            }
        }
        let plain = scratch.write("terrain.flt", bytes);
        let header =
            format!("ncols {SIDE}\nnrows {SIDE}\nxllcorner 0\nyllcorner 0\ncellsize 1\nbyteorder LSBFIRST\n");
        scratch.write("terrain.hdr", header);
        let tif = plain.with_extension("tif");
        let words = ["dem", "convert"].map(OsString::from);
        let arguments: Vec<OsString> =
            words.into_iter().chain([plain.into(), "-o".into(), tif.clone().into()]).collect();
        let ran = ran(program(scratch.folder(), &arguments).output().expect("the program starts"));
        assert_eq!(ran.code, 0, "{ran:?}");
        tif
    }

    /// Bytes of the header and of the tiles that meet a window of columns and rows, by the tags of a little-endian TIFF.
    fn needed_bytes(tiff: &[u8], columns: std::ops::Range<u32>, rows: std::ops::Range<u32>) -> u64 {
        let short = |at: usize| u16::from_le_bytes(tiff[at..at + 2].try_into().expect("2 bytes"));
        let long = |at: usize| u32::from_le_bytes(tiff[at..at + 4].try_into().expect("4 bytes"));
        let directory = long(4) as usize;
        let fields = (0..usize::from(short(directory))).map(|index| directory + 2 + 12 * index);
        let list = |tag: u16| {
            let field = fields.clone().find(|at| short(*at) == tag).expect("the tag is there");
            let (count, place) = (long(field + 4) as usize, long(field + 8) as usize);
            assert_eq!(short(field + 2), 4, "longs");
            (0..count).map(|index| long(place + 4 * index)).collect::<Vec<u32>>()
        };
        let (starts, lengths) = (list(324), list(325));
        let header = u64::from(*starts.iter().min().expect("tiles"));
        let across = SIDE / 256;
        let tiles = (rows.start / 256..rows.end.div_ceil(256)).flat_map(|row| {
            (columns.start / 256..columns.end.div_ceil(256)).map(move |column| row * across + column)
        });
        header + tiles.map(|tile| u64::from(lengths[tile as usize])).sum::<u64>()
    }

    #[test]
    fn a_remote_file_gives_the_bits_of_the_file_on_disk() {
        let Some(mut store) = TestServer::s3() else { return };
        let tif = write_terrain(&store.scratch);
        let local = tif.to_str().expect("UTF-8").to_owned();
        store.put(&tif, "dem/terrain.tif");
        let remote = "s3://terrain/dem/terrain.tif";
        let tiff = std::fs::read(&tif).expect("readable");
        let web = format!("http://{}/terrain/dem/terrain.tif", store.host);

        // A height reads one tile, another program of the same words nothing but the first block.
        let (one, bytes) = store.fetched("a", &["height", remote, "--at", "1000.5,1000.5"]);
        let (local_one, _) = local_run(&store, &["height", &local, "--at", "1000.5,1000.5"]);
        assert_eq!(one, local_one);
        let needed = needed_bytes(&tiff, 999..1002, 1046..1049);
        assert_ratio("a height", bytes, needed);
        let (again, bytes) = store.fetched("a", &["height", remote, "--at", "1000.5,1000.5"]);
        assert_eq!(again, one);
        assert!(bytes <= 16 << 10, "the first block, and words of companions that are not there: {bytes}");
        assert_eq!(store.fetched("w", &["height", &web, "--at", "1000.5,1000.5"]).0, one);

        // A viewshed reads the square around its range.
        let viewshed = |file: &str, out: &str| -> Vec<String> {
            ["viewshed", file, "--at", "1000,1000", "--observer-height", "2", "--range", "300", "-o", out]
                .map(str::to_owned)
                .to_vec()
        };
        let (seen, there) = (store.scratch.at("there.tif"), store.scratch.at("here.tif"));
        let arguments = viewshed(remote, "there.tif");
        let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
        let (_, bytes) = store.fetched("b", &words);
        let arguments = viewshed(&local, "here.tif");
        let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
        local_run(&store, &words);
        assert_eq!(std::fs::read(seen).expect("written"), std::fs::read(there).expect("written"));
        assert_ratio("a viewshed", bytes, needed_bytes(&tiff, 700..1301, 748..1349));

        // All of it, row by row.
        let (info, bytes) = store.fetched("c", &["dem", "info", remote, "--json"]);
        assert_eq!(info, local_run(&store, &["dem", "info", &local, "--json"]).0);
        assert_ratio("dem info", bytes, tiff.len() as u64);

        // A scene with an extent reads that part of it.
        let scene = |dem: &str| {
            format!(
                "title = \"Part\"\n[terrain]\ndem = \"{dem}\"\nextent = [[900, 900], [1100, 1100]]\n\
                 [[camera]]\nname = \"top\"\n"
            )
        };
        store.scratch.write("far.toml", scene(remote));
        store.scratch.write("near.toml", scene("terrain.tif"));
        store.fetched("d", &["render", "far.toml", "--size", "160x90", "-o", "far.png"]);
        local_run(&store, &["render", "near.toml", "--size", "160x90", "-o", "near.png"]);
        let picture = |name: &str| std::fs::read(store.scratch.at(name)).expect("drawn");
        assert!(picture("far.png") == picture("near.png"), "the pictures differ");
    }

    #[test]
    fn real_files_on_a_server_are_those_on_disk() {
        let Some(mut store) = TestServer::s3() else { return };
        for path in ["dem/bigtujunga_utm11_i16_tiled.tif", "dem/eudem_laea_f32_deflate.tif", "dem/n43.dt0"] {
            let Some(file) = data(path) else { return };
            store.put(&file, path);
            let (remote, local) = (format!("s3://terrain/{path}"), file.to_str().expect("UTF-8"));
            let (there, bytes) = store.fetched("real", &["dem", "info", &remote, "--json"]);
            assert_eq!(there, local_run(&store, &["dem", "info", local, "--json"]).0, "{path}");
            let size = std::fs::metadata(&file).expect("there").len();
            assert!(bytes as f64 <= 1.3 * size as f64 + 16_384.0, "{path}: {bytes} bytes fetched of {size}");
            let mesh = |file: &str, out: &str| {
                let words = ["mesh", file, "--max-error", "20", "-o", out];
                store.command("real", &words).output().expect("the program starts").status.success()
            };
            assert!(mesh(&remote, "there.obj") && mesh(local, "here.obj"), "{path}");
            let (there, here) = (store.scratch.at("there.obj"), store.scratch.at("here.obj"));
            assert!(std::fs::read(there).ok() == std::fs::read(here).ok(), "{path}: the meshes differ");
        }
    }

    #[test]
    fn a_scene_whose_files_are_on_a_server_is_the_picture_of_those_on_disk() {
        let Some(mut store) = TestServer::s3() else { return };
        let assets = PathBuf::from(project("assets"));
        for folder in ["jacksboro", "models"] {
            for entry in std::fs::read_dir(assets.join(folder)).expect("a folder") {
                let path = entry.expect("an entry").path();
                let name = path.file_name().and_then(|name| name.to_str()).expect("UTF-8");
                store.put(&path, &format!("{folder}/{name}"));
            }
        }
        let here = std::fs::read_to_string(project("scenes/jacksboro.toml")).expect("readable");
        let there = here.replace("\"../assets/", "\"s3://terrain/");
        assert!(!there.contains("../"), "all of its files are on the server");
        store.scratch.write("far.toml", &there);
        let size = ["--size", "320x180", "-o"];
        store.fetched("a", &[&["render", "far.toml"], &size[..], &["far.png"]].concat());
        local_run(
            &store,
            &[&["render", &project("scenes/jacksboro.toml")], &size[..], &["near.png"]].concat(),
        );
        let picture = |name: &str| std::fs::read(store.scratch.at(name)).expect("drawn");
        assert!(picture("far.png") == picture("near.png"), "the pictures differ");

        // A file that is not there is an error of the scene.
        store.scratch.write("gone.toml", there.replace("roads.geojson", "paths.geojson"));
        let gone = store.run("a", &["check", "gone.toml"]);
        assert!(gone.code == 1 && gone.err.contains("s3://terrain/jacksboro/paths.geojson"), "{gone:?}");
        assert!(gone.err.contains("gone.toml:"), "{gone:?}");
    }

    #[test]
    fn a_shapefile_on_a_server_has_its_companions_there() {
        let Some(mut store) = TestServer::s3() else { return };
        for end in ["shp", "shx", "dbf", "prj", "cpg"] {
            let Some(file) = data(&format!("scenes/swellendam_za/rivers.{end}")) else { return };
            store.put(&file, &format!("rivers.{end}"));
        }
        let Some(dem) = data("scenes/swellendam_za/dem_srtm_utm33s_i16.tif") else { return };
        let Some(rivers) = data("scenes/swellendam_za/rivers.shp") else { return };
        let scene = |rivers: &str| {
            format!(
                "title = \"Rivers\"\n[terrain]\ndem = {dem:?}\n[[river]]\nfile = \"{rivers}\"\nwidth = 20\n\
                 [[camera]]\nname = \"top\"\n"
            )
        };
        store.scratch.write("far.toml", scene("s3://terrain/rivers.shp"));
        store.scratch.write("near.toml", scene(rivers.to_str().expect("UTF-8")));
        let folder = dem.parent().and_then(|folder| folder.to_str()).expect("UTF-8").to_owned();
        let (far, _) = store.fetched("a", &["report", "far.toml", "--json", "--allow", &folder]);
        let (near, _) = local_run(&store, &["report", "near.toml", "--json", "--allow", &folder]);
        // Notes of reading name the file.
        assert!(far.contains("'s3://terrain/rivers.shp'"), "{far}");
        assert_eq!(far, near.replace(rivers.to_str().expect("UTF-8"), "s3://terrain/rivers.shp"));
    }

    #[track_caller]
    fn assert_ratio(what: &str, fetched: u64, needed: u64) {
        let ratio = fetched as f64 / needed as f64;
        println!("{what}: {fetched} bytes fetched / {needed} needed = {ratio:.3}");
        assert!((0.9..=1.3).contains(&ratio), "{what}: {fetched} / {needed} = {ratio}");
    }

    #[track_caller]
    fn local_run(store: &TestServer, arguments: &[&str]) -> (String, String) {
        let ran = ran(program(store.scratch.folder(), arguments).output().expect("the program starts"));
        assert_eq!(ran.code, 0, "{ran:?}");
        (ran.out, ran.err)
    }

    #[test]
    fn an_address_is_refused_until_its_host_is_allowed() {
        let Some(store) = TestServer::s3() else { return };
        let mut command = program(store.scratch.folder(), &["height", "s3://terrain/a.tif", "--at", "1,2"]);
        command.env("AWS_ENDPOINT_URL", format!("http://{}", store.host)).env("AWS_ALLOW_HTTP", "true");
        let refused = ran(command.output().expect("the program starts")).failed(1);
        assert!(refused.contains(&format!("--allow-remote {}", store.host)), "{refused}");
        let web = format!("http://{}/terrain/a.tif", store.host);
        let refused = ran(program(store.scratch.folder(), &["height", &web, "--at", "1,2"])
            .output()
            .expect("it starts"));
        assert!(refused.failed(1).contains(&format!("--allow-remote {}", store.host)));
        let missing = store.run("a", &["height", "s3://terrain/none.tif", "--at", "1,2"]);
        assert!(
            missing.code == 1 && missing.err.contains("s3://terrain/none.tif: there is no such file"),
            "{missing:?}"
        );
    }
}
