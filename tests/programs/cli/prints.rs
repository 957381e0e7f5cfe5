//! `export` to print: a scene in, closed solids in millimeters out.

use std::collections::HashMap;
use std::path::Path;
use std::process::Command;

use glam::Vec3;
use sandtable_mesh::check::check_solid;
use sandtable_mesh::sink::{MeshSink, VertexId};
use sandtable_mesh::trimesh::TriMesh;

use crate::cli::{project, run_in};
use crate::common::scratch::Scratch;
use crate::common::skip::skipped;

/// The triangles of a binary STL file, with one vertex at each place.
fn read_stl(path: &Path) -> TriMesh {
    let bytes = std::fs::read(path).expect("written");
    let number = |at: usize| f32::from_le_bytes(bytes[at..at + 4].try_into().expect("four bytes"));
    let mut mesh = TriMesh::default();
    let mut ids: HashMap<[u32; 3], VertexId> = HashMap::new();
    for triangle in 0..(bytes.len() - 84) / 50 {
        let corners = [1, 2, 3].map(|corner| {
            let first = 84 + 50 * triangle + 12 * corner;
            let at = Vec3::new(number(first), number(first + 4), number(first + 8));
            *ids.entry(at.to_array().map(f32::to_bits)).or_insert_with(|| mesh.vertex(at))
        });
        mesh.triangle(corners);
    }
    mesh
}

fn size(mesh: &TriMesh) -> Vec3 {
    let min = mesh.positions.iter().fold(Vec3::INFINITY, |min, at| min.min(*at));
    mesh.positions.iter().fold(Vec3::NEG_INFINITY, |max, at| max.max(*at)) - min
}

/// What an independent library says of mesh files: nothing where each holds only closed solids with their normals outward.
/// `SANDTABLE_TRIMESH` names a Python that has `trimesh`.
fn assert_printable(files: &[&Path]) {
    let Some(python) = std::env::var_os("SANDTABLE_TRIMESH") else {
        skipped("no independent mesh library: SANDTABLE_TRIMESH is not set");
        assert!(
            std::env::var_os("SANDTABLE_REQUIRE_VALIDATOR").is_none(),
            "SANDTABLE_REQUIRE_VALIDATOR is set"
        );
        return;
    };
    let script = concat!(env!("SANDTABLE_ROOT"), "tests/tools/check_solids.py");
    let ran = Command::new(python).arg(script).args(files).output().expect("Python runs");
    assert!(
        ran.status.success(),
        "{}{}",
        String::from_utf8_lossy(&ran.stdout),
        String::from_utf8_lossy(&ran.stderr)
    );
}

#[test]
fn a_scene_is_printed_as_one_solid_on_a_base() {
    let scratch = Scratch::new();
    for (scene, least_mm) in [("scenes/buildings.toml", 5.3), ("scenes/jacksboro.toml", 5.0)] {
        for name in ["model.stl", "model.3mf"] {
            run_in(scratch.folder(), &["export", &project(scene), "-o", name, "--side", "60"]).ok();
        }
        let solid = read_stl(&scratch.at("model.stl"));
        let volume_mm3 = check_solid(&solid).unwrap_or_else(|flaw| panic!("{scene}: {flaw}"));
        let size = size(&solid);
        assert!((59.5..60.0).contains(&size.truncate().max_element()), "{scene}: {size}");
        let base_mm3 = f64::from(size.x * size.y) * least_mm;
        assert!(
            volume_mm3 > base_mm3 && volume_mm3 < f64::from(size.x * size.y * size.z),
            "{scene}: {volume_mm3}"
        );
        assert_printable(&[&scratch.at("model.stl"), &scratch.at("model.3mf")]);
    }
}

#[test]
fn what_is_larger_than_the_bed_is_cut_into_pieces_that_join() {
    let scratch = Scratch::new();
    let scene = project("scenes/lake.toml");
    run_in(scratch.folder(), &["export", &scene, "-o", "lake.stl", "--side", "120", "--bed", "70"]).ok();
    assert_eq!(scratch.names(), ["lake-A1.stl", "lake-A2.stl", "lake-B1.stl", "lake-B2.stl"]);
    let pieces: Vec<TriMesh> = scratch.names().iter().map(|name| read_stl(&scratch.at(name))).collect();
    let mut sizes = Vec::new();
    for piece in &pieces {
        check_solid(piece).expect("closed");
        sizes.push(size(piece));
    }
    // The south-western piece has pegs to the east and to the north, the north-eastern only sockets.
    let pegs_mm = sizes[0].truncate() - sizes[3].truncate();
    assert!(pegs_mm.abs_diff_eq(glam::Vec2::splat(4.0), 0.5), "{sizes:?}");
    let paths: Vec<_> = scratch.names().iter().map(|name| scratch.at(name)).collect();
    assert_printable(&paths.iter().map(|path| path.as_path()).collect::<Vec<_>>());
}

#[test]
fn the_same_scene_gives_the_same_bytes_and_options_of_others_are_refused() {
    let scratch = Scratch::new();
    let scene = project("scenes/road.toml");
    for name in ["one.3mf", "two.3mf"] {
        run_in(scratch.folder(), &["export", &scene, "-o", name, "--side", "40"]).ok();
    }
    let [one, two] = ["one.3mf", "two.3mf"].map(|name| std::fs::read(scratch.at(name)).expect("written"));
    assert!(one == two);
    let refused = |arguments: &[&str]| {
        run_in(scratch.folder(), &[&["export", scene.as_str(), "-o"], arguments].concat()).failed(2)
    };
    let said = refused(&["a.glb", "--side", "100"]);
    assert!(said.contains("--side has no effect on a .glb or .obj"), "{said}");
    let said = refused(&["a.stl", "--max-error", "1"]);
    assert!(said.contains("--max-error has no effect on a model to print"), "{said}");
    let tall = "[terrain]\ndem = \"hill.asc\"\ncrs = \"EPSG:32616\"\nvertical_exaggeration = 1000\n";
    std::fs::write(scratch.at("tall.toml"), tall).expect("a file");
    let grid = "ncols 3\nnrows 3\nxllcorner 0\nyllcorner 0\ncellsize 10\n0 0 0 0 900 0 0 0 0\n";
    std::fs::write(scratch.at("hill.asc"), grid).expect("a file");
    let said = run_in(scratch.folder(), &["export", "tall.toml", "-o", "a.stl"]).failed(1);
    assert!(said.contains("mm high") && said.contains("vertical_exaggeration"), "{said}");
    for name in ["tall.toml", "hill.asc"] {
        std::fs::remove_file(scratch.at(name)).expect("there");
    }
    assert!(refused(&["a.stl", "--side", "5"]).contains("from 20 to 4000"));
    assert_eq!(scratch.names(), ["one.3mf", "two.3mf"]);
}

#[test]
fn what_is_only_drawn_on_a_picture_is_not_printed() {
    let scratch = Scratch::new();
    let text = std::fs::read_to_string(project("scenes/operation.toml")).expect("there");
    let mut bare = text.parse::<toml_edit::DocumentMut>().expect("TOML");
    for table in ["graphic", "symbol", "viewshed", "sight", "range"] {
        bare.remove(table);
    }
    assert!(bare.to_string().len() < text.len());
    let here = |text: &str| text.replace("../assets", &project("assets"));
    for (name, text) in [("whole", here(&text)), ("bare", here(&bare.to_string()))] {
        std::fs::write(scratch.at(&format!("{name}.toml")), text).expect("a file");
        let (scene, model) = (format!("{name}.toml"), format!("{name}.stl"));
        let assets = project("assets");
        run_in(scratch.folder(), &["export", &scene, "-o", &model, "--side", "60", "--allow", &assets]).ok();
    }
    let [whole, bare] =
        ["whole.stl", "bare.stl"].map(|name| std::fs::read(scratch.at(name)).expect("written"));
    // The remarks in the head name the scene.
    assert!(whole[80..] == bare[80..], "{} and {} bytes", whole.len(), bare.len());
}
