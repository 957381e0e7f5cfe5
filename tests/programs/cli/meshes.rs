//! `mesh`: an elevation file in, a mesh with a bound out.

use std::path::Path;

use glam::Vec3;
use sandtable_dem::hints::DemHints;
use sandtable_dem::read::read;
use sandtable_mesh::check;
use sandtable_mesh::sink::{MeshSink, VertexId};
use sandtable_mesh::trimesh::TriMesh;
use sandtable_model::Companions;
use sandtable_model::error::CompanionError;
use sandtable_raster::warp::to_metric;
use sandtable_roam::bound::measure;
use sandtable_terrain::lattice::Lattice;
use serde_json::Value;

use crate::cli::{Ran, project, run_in};
use crate::common::data::data;
use crate::common::scratch::Scratch;

/// 40 × 30 posts of rolling ground, 10 m apart, with a hole of 3 × 2.
fn grid() -> String {
    let mut text =
        "ncols 40\nnrows 30\nxllcenter 500000\nyllcenter 4000000\ncellsize 10\nNODATA_value -9999\n"
            .to_owned();
    for row in (0..30).rev() {
        for column in 0..40 {
            let hole = (20..23).contains(&column) && (10..12).contains(&row);
            let height = 100.0 + 30.0 * libm::sin(column as f64 * 0.3) + 20.0 * libm::cos(row as f64 * 0.4);
            text += &if hole { "-9999 ".to_owned() } else { format!("{height:.3} ") };
        }
        text += "\n";
    }
    text
}

/// A model that needs no other file.
struct Alone;

impl Companions for Alone {
    fn load(&self, name: &str) -> Result<Vec<u8>, CompanionError> {
        panic!("{name} is asked for")
    }
}

fn mesh(scratch: &Scratch, max_error: &str, out: &str) -> Ran {
    run_in(scratch.folder(), &["mesh", "grid.asc", "--max-error", max_error, "-o", out])
}

fn with_grid() -> Scratch {
    let scratch = Scratch::new();
    scratch.write("grid.asc", grid());
    scratch
}

/// The number that follows a word of the printed summary.
fn told(out: &str, word: &str) -> f64 {
    let rest = out.split_once(word).unwrap_or_else(|| panic!("{word} in\n{out}")).1;
    rest.split_whitespace().next().expect("a number").parse().expect("a number")
}

fn lattice_of(path: &Path) -> Lattice {
    let bytes = std::fs::read(path).expect("readable");
    let raster = read(&path.to_string_lossy(), &bytes, &DemHints::default()).expect("an elevation file");
    Lattice::from_raster(&to_metric(&raster, None).expect("metric")).expect("ground")
}

/// The mesh in an OBJ file, read line by line.
fn obj(path: &Path) -> TriMesh {
    let text = std::fs::read_to_string(path).expect("readable");
    let mut mesh = TriMesh::default();
    for line in text.lines() {
        let words: Vec<&str> = line.split(' ').collect();
        match words[0] {
            "v" => {
                let [x, y, z] = [1, 2, 3].map(|word| words[word].parse().expect("a coordinate"));
                mesh.vertex(Vec3::new(x, y, z));
            }
            "f" => mesh
                .triangle([1, 2, 3].map(|word| VertexId(words[word].parse::<u32>().expect("an index") - 1))),
            _ => {}
        }
    }
    mesh
}

#[test]
fn a_mesh_keeps_its_bound_at_every_post_and_says_so() {
    let scratch = with_grid();
    let mut before = usize::MAX;
    for bound in ["0", "0.5", "5", "1e300"] {
        let out = mesh(&scratch, bound, "out.obj").ok();
        let written = obj(&scratch.at("out.obj"));
        let lattice = lattice_of(&scratch.at("grid.asc"));
        let found = measure(&lattice, &written).expect("on posts");
        assert!(found.max_m <= bound.parse().expect("a number"), "asked {bound}: {found:?}");
        let above = told(&out, "maximum") - found.max_m;
        assert!((0.0..1.001e-4).contains(&above), "told a tenth of a millimeter rounded up: {out}");
        assert_eq!(told(&out, "triangles") as usize, written.triangles.len());
        assert_eq!(told(&out, "vertices") as usize, written.positions.len());
        assert_eq!((told(&out, ", over") as usize, found.left_out), (40 * 30 - 6, 0));
        // The hole and the cells around it.
        let cells = 39.0 * 29.0 - 4.0 * 3.0;
        let area = check::check(&written).expect("sound").plan_area_m2;
        assert!((area / 100.0 - cells).abs() <= 4.0, "{area} m²");
        assert!(written.triangles.len() <= before, "a larger error needs no more triangles");
        before = written.triangles.len();
    }
}

#[test]
fn all_four_formats_hold_the_same_mesh_and_name_its_origin() {
    let scratch = with_grid();
    let outs = ["a.obj", "a.ply", "a.STL", "a.glb"].map(|name| mesh(&scratch, "2", name).ok());
    let (vertices, triangles) = (told(&outs[0], "vertices") as usize, told(&outs[0], "triangles") as usize);
    let bytes = |name: &str| std::fs::read(scratch.at(name)).expect("written");
    for name in ["a.obj", "a.glb"] {
        let model = sandtable_model::read::read(name, &bytes(name), &Alone).expect("a model");
        let drawn: usize = model.parts.iter().map(|part| part.mesh.triangles.len()).sum();
        assert_eq!(drawn, triangles, "{name}");
    }
    let text = String::from_utf8(bytes("a.obj")).expect("UTF-8");
    let origin = "origin: X 0, Y 0 is easting 500000 northing 4000000 in local meters";
    assert!(text.contains(&format!("\n# {origin}")), "{text}");
    let ply = bytes("a.ply");
    let header = String::from_utf8_lossy(&ply[..ply.len().min(1000)]).into_owned();
    assert!(header.contains(&format!("\ncomment {origin}")), "{header}");
    assert_eq!((told(&header, "vertex") as usize, told(&header, "face") as usize), (vertices, triangles));
    let stl = bytes("a.STL");
    assert!(stl.starts_with(b"meters; origin E 500000 N 4000000"));
    assert_eq!(u32::from_le_bytes(stl[80..84].try_into().expect("four bytes")) as usize, triangles);
    assert_eq!(stl.len(), 84 + 50 * triangles);
    let glb = bytes("a.glb");
    let length = u32::from_le_bytes(glb[12..16].try_into().expect("four bytes")) as usize;
    let document: Value = serde_json::from_slice(&glb[20..20 + length]).expect("JSON");
    assert!(document["asset"]["extras"]["remarks"][2].as_str().expect("a remark").starts_with(origin));
    assert_eq!(scratch.names(), ["a.STL", "a.glb", "a.obj", "a.ply", "grid.asc"], "nothing else is left");
}

#[test]
fn an_imported_glb_stands_upright_and_looks_north() {
    let scratch = with_grid();
    mesh(&scratch, "2", "a.glb").ok();
    mesh(&scratch, "2", "a.obj").ok();
    let bytes = std::fs::read(scratch.at("a.glb")).expect("written");
    let model = sandtable_model::read::read("a.glb", &bytes, &Alone).expect("a model");
    let expected = obj(&scratch.at("a.obj"));
    let bounds = |points: &mut dyn Iterator<Item = Vec3>| {
        points.fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), at| (low.min(at), high.max(at)))
    };
    let found = bounds(
        &mut model
            .parts
            .iter()
            .flat_map(|part| part.mesh.vertices.iter().map(|vertex| Vec3::from(vertex.position))),
    );
    assert_eq!(
        found,
        bounds(&mut expected.positions.iter().copied()),
        "Z is up again after the reader's turn"
    );
}

#[test]
fn degrees_are_brought_to_a_utm_zone_and_the_user_is_told() {
    let scratch = Scratch::new();
    let ran = run_in(
        scratch.folder(),
        &["mesh", &project("assets/jacksboro/dem.tif"), "--max-error", "20", "-o", "a.ply"],
    );
    assert_eq!(ran.code, 0, "{ran:?}");
    assert!(ran.err.contains("brought from EPSG:4326 to EPSG:32616"), "{}", ran.err);
    assert!(told(&ran.out, "maximum") <= 20.0 && ran.out.contains("in EPSG:32616"), "{}", ran.out);
}

#[test]
fn wrong_wishes_are_refused_with_what_to_do() {
    let scratch = with_grid();
    let refused = |arguments: &[&str], code: i32| {
        run_in(scratch.folder(), &[&["mesh"][..], arguments].concat()).failed(code)
    };
    for error in ["-1", "NaN", "inf", "much"] {
        let reason = refused(&["grid.asc", "--max-error", error, "-o", "a.obj"], 2);
        assert!(reason.contains("--max-error") && reason.contains("from 0 on"), "{reason}");
    }
    for name in ["a.dae", "a", "obj"] {
        let reason = refused(&["grid.asc", "--max-error", "1", "-o", name], 2);
        assert!(reason.contains(name) && reason.contains(".obj, .ply, .stl or .glb"), "{reason}");
    }
    let reason = refused(&["grid.asc", "--max-error", "1", "-o", "nowhere/a.obj"], 1);
    assert!(reason.contains("no such folder"), "{reason}");
    let reason = refused(&["none.asc", "--max-error", "1", "-o", "a.obj"], 1);
    assert!(reason.contains("none.asc"), "{reason}");
    scratch.write(
        "hole.asc",
        "ncols 2\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 10\nNODATA_value 0\n1 0\n0 2\n",
    );
    let reason = refused(&["hole.asc", "--max-error", "1", "-o", "a.obj"], 1);
    assert!(reason.contains("hole.asc") && reason.contains("no triangle"), "{reason}");
    scratch.write("lon.asc", "ncols 2\nnrows 2\nxllcorner 8\nyllcorner 47\ncellsize 0.001\n1 2\n3 4\n");
    let reason = refused(&["lon.asc", "--max-error", "1", "-o", "a.obj"], 1);
    assert!(reason.contains("--crs EPSG:4326"), "{reason}");
    let told = run_in(
        scratch.folder(),
        &["mesh", "lon.asc", "--crs", "EPSG:4326", "--max-error", "1", "-o", "a.obj"],
    );
    assert!(told.code == 0 && told.err.contains("EPSG:32632"), "{told:?}");
    assert_eq!(scratch.names(), ["a.obj", "grid.asc", "hole.asc", "lon.asc"], "nothing half-written is left");
}

#[test]
#[ignore = "slow: meshes several real models"]
fn real_ground_keeps_the_bound() {
    let files = [
        ("scenes/crater_lake_bt/crater.bt", ["2", "20"]),
        ("dem/west_bijou_gully.asc", ["0.25", "2"]),
        ("dem/bigtujunga_utm11_i16_tiled.tif", ["5", "50"]),
        ("dem/zion_srtm_u16_deflate.tif", ["5", "30"]),
    ];
    for (file, bounds) in files {
        let Some(path) = data(file) else {
            return;
        };
        let scratch = Scratch::new();
        let lattice = lattice_of(&path);
        for bound in bounds {
            let dem = path.to_string_lossy();
            let ran = run_in(scratch.folder(), &["mesh", &dem, "--max-error", bound, "-o", "a.obj"]);
            assert_eq!(ran.code, 0, "{ran:?}");
            let written = obj(&scratch.at("a.obj"));
            let found = measure(&lattice, &written).expect("on posts");
            assert!(found.max_m <= bound.parse().expect("a number"), "{file}, asked {bound}: {found:?}");
            let extent = lattice.extent();
            let whole = extent.max - extent.min;
            let area = check::check(&written).expect("sound").plan_area_m2;
            assert!(area <= whole.x * whole.y * (1.0 + 1e-6) && area > 0.0, "{file}: {area}");
        }
    }
}
