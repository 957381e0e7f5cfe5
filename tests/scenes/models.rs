//! Model files of others: each is read as an independent reader reads it, or refused for a reason.

use crate::common::data;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use glam::Vec3;
use sandtable_base::message::chain::error_text;
use sandtable_geom::aabb::Aabb;
use sandtable_model::error::{CompanionError, ModelError};
use sandtable_model::read::read;
use sandtable_model::{Companions, Model};
use serde_json::Value;

/// Files under `models/` that must be refused, with a word their error must have.
const REFUSED: [(&str, &str); 6] = [
    ("gltf/meshopt_pirate.glb", "meshopt"),
    ("obj/helix/line_continuation_empty_line.obj", "coordinates"),
    ("obj/tinyobj/invalid-relative-texture-index.obj", "are defined"),
    ("obj/tinyobj/invalid-relative-vertex-index.obj", "are defined"),
    ("obj/tinyobj/issue-140-zero-face-idx.obj", "are defined"),
    ("obj/tobj/invalid_index.obj", "are defined"),
];

/// Files whose bounds are not compared, and why.
const OTHER_BOUNDS: [&str; 3] = [
    // The oracle does not move vertices by their joints.
    "gltf/assimp_simple_skin/simple_skin.gltf",
    // Positions that are not finite are left out here.
    "obj/tinyobj/test-nan.obj",
    // The oracle adds 1e10 where exponents are odd.
    "obj/assimp/number_formats.obj",
];

/// Bounds of 3DS files whose nodes move their objects. The oracle's tool multiplies a node's transform with
/// its parent's in the wrong order when it takes the box; these boxes come from an independent script that
/// prints the oracle's boxes for all 38 files when it multiplies in that order too.
const MOVED_BY_NODES: [(&str, [f32; 3], [f32; 3]); 19] = [
    ("3ds/CameraRollAnim.3ds", [-24.7863, -24.7863, 0.0], [45.8689, 23.0769, 38.7464]),
    ("3ds/Cube.3DS", [-32.3431, -26.142, -27.5362], [32.3912, 32.7952, 30.4348]),
    ("3ds/RotatingCube.3DS", [-29.3447, -34.1813, -4.0862], [37.3219, 29.2585, 49.2083]),
    ("3ds/blitz_LodMesh/skull.3ds", [-0.2938, 1.6576, -0.4937], [0.2938, 2.385, 0.2967]),
    ("3ds/blitz_Media/asteroid.3ds", [-96.1192, -80.8559, -91.4908], [96.8315, 80.2958, 91.3673]),
    ("3ds/blitz_Media/claw.3DS", [-23.863, -139.462, 17.4005], [123.7967, -105.3573, 142.5536]),
    ("3ds/blitz_british-tadpole/btadpole.3ds", [-473.444, -807.9778, -0.0067], [473.444, 807.9778, 449.2881]),
    ("3ds/blitz_emerald_gate/my_stargate3.3ds", [-70.4007, -155.9488, 0.0], [5.8995, -145.3998, 78.877]),
    ("3ds/blitz_hearse/hearse.3ds", [-145.7434, -144.326, 0.2484], [145.7434, 654.326, 215.3972]),
    ("3ds/blitz_makbot/mak_robotic.3DS", [-11.7171, -9.9476, -0.6971], [9.0257, 13.2992, 47.5209]),
    ("3ds/blitz_orbit_nebula_source/rock.3DS", [-22.8236, -32.6822, -10.4832], [3.3518, -3.7573, 22.44]),
    ("3ds/blitz_rallycar/rallycar1.3ds", [-47.1189, -83.8484, -0.2287], [46.4514, 94.1771, 66.3613]),
    ("3ds/blitz_saucer/fsaucer1.3ds", [-19.8812, -20.9773, -0.0373], [19.8812, 22.7923, 7.1332]),
    ("3ds/blitz_wood-crate/wcrate1.3ds", [-20.1806, -20.1139, -20.2362], [20.3515, 20.4183, 20.296]),
    ("3ds/boat.3ds", [-1076.9227, -1704.5703, -556.4998], [965.7532, 3455.7978, 4107.0985]),
    ("3ds/cube_with_diffuse_texture.3DS", [-50.0, 32.6177, -30.5402], [0.0, 82.6177, 19.4598]),
    ("3ds/cubes_with_alpha.3DS", [-856.311, -55.1009, -268.1591], [98.8105, 1227.1409, 248.438]),
    ("3ds/teapot.3ds", [-62.9651, -25.1361, 0.0], [54.0575, 47.6831, 57.3451]),
    ("3ds/test1.3ds", [-10.3432, -0.1942, -10.1551], [9.8509, 10.2303, 10.2476]),
];

/// The companions in a folder, letter case as on disk.
struct Folder(PathBuf);

impl Companions for Folder {
    fn load(&self, name: &str) -> Result<Vec<u8>, CompanionError> {
        Ok(std::fs::read(self.0.join(name))?)
    }
}

fn data() -> Option<PathBuf> {
    data::data("MODEL_ORACLE.json")?.parent().map(Path::to_path_buf)
}

fn files_below(folder: &Path, extensions: &[&str]) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(&folder).expect("the folder can be listed") {
            let path = entry.expect("the entry can be read").path();
            let extension =
                path.extension().map(|extension| extension.to_string_lossy().to_ascii_lowercase());
            if path.is_dir() {
                folders.push(path);
            } else if extension.is_some_and(|extension| extensions.contains(&extension.as_str())) {
                found.push(path);
            }
        }
    }
    found.sort();
    found
}

fn read_file(path: &Path) -> Result<Model, ModelError> {
    let bytes = std::fs::read(path).expect("the file can be read");
    let folder = Folder(path.parent().expect("files lie in folders").into());
    let started = Instant::now();
    let result = read(&path.to_string_lossy(), &bytes, &folder);
    let took = started.elapsed();
    assert!(took < Duration::from_secs(10), "{} took {took:?}", path.display());
    if let Ok(model) = &result {
        check(model, path);
    }
    result
}

/// What every model must keep, whatever its file says.
fn check(model: &Model, path: &Path) {
    for part in &model.parts {
        let material = model.materials.get(part.material.0 as usize).expect("the part's material is there");
        assert!(material.texture.is_none_or(|id| (id.0 as usize) < model.textures.len()));
        assert!(!part.mesh.triangles.is_empty(), "{}: a part without triangles", path.display());
        let count = part.mesh.vertices.len();
        assert!(part.mesh.triangles.iter().flatten().all(|id| id.index() < count));
        for vertex in &part.mesh.vertices {
            assert!(Vec3::from(vertex.position).is_finite(), "{}", path.display());
            assert!(
                (Vec3::from(vertex.normal).length() - 1.0).abs() < 1e-3,
                "{}: {vertex:?}",
                path.display()
            );
            assert!(vertex.uv.iter().all(|coordinate| coordinate.is_finite()));
        }
    }
}

fn vector(value: &Value) -> Option<Vec3> {
    let numbers: Vec<f32> =
        value.as_array()?.iter().filter_map(|number| Some(number.as_f64()? as f32)).collect();
    Some(Vec3::new(*numbers.first()?, *numbers.get(1)?, *numbers.get(2)?))
}

/// How many faces an independent count finds: chunks of a 3DS file, `f` lines of an OBJ file, triangles of
/// glTF primitives.
fn expected_faces(path: &Path, row: &Value) -> Option<u64> {
    let own = std::fs::read(format!("{}.oracle.json", path.display())).expect("every model has an oracle");
    let own: Value = serde_json::from_slice(&own).expect("the oracle is JSON");
    let lines = own["obj_lines"]["f"].as_u64();
    row["raw_faces"].as_u64().or(lines).or(row["faces"].as_u64())
}

#[test]
fn every_model_is_read_as_the_oracle_says_or_refused_for_a_reason() {
    let Some(data) = data() else { return };
    let oracle = std::fs::read(data.join("MODEL_ORACLE.json")).expect("the oracle is there");
    let oracle: Value = serde_json::from_slice(&oracle).expect("the oracle is JSON");
    let rows: BTreeMap<&str, &Value> = oracle["models"]
        .as_array()
        .expect("a list of models")
        .iter()
        .map(|row| (row["file"].as_str().expect("a file name").trim_start_matches("shared/models/"), row))
        .collect();
    let models = data.join("models");
    let mut wrong = Vec::new();
    let mut compared = 0;
    for path in files_below(&models, &["3ds", "obj", "gltf", "glb"]) {
        let name = path.strip_prefix(&models).expect("it lies below").to_string_lossy().replace('\\', "/");
        let refused = REFUSED.iter().find(|(file, _)| *file == name);
        match (read_file(&path), refused) {
            (Err(error), Some((_, word))) if error.to_string().contains(word) => {}
            (Err(error), _) => wrong.push(format!("{name}: {error}")),
            (Ok(_), Some(_)) => wrong.push(format!("{name} is read and should be refused")),
            (Ok(model), None) => {
                let Some(row) = rows.get(name.as_str()) else {
                    wrong.push(format!("{name} has no oracle"));
                    continue;
                };
                compared += 1;
                wrong.extend(differences(&name, &path, &model, row));
            }
        }
    }
    assert!(wrong.is_empty(), "{} of {compared}:\n{}", wrong.len(), wrong.join("\n"));
    assert!(compared > 120, "{compared} models compared");
}

fn differences(name: &str, path: &Path, model: &Model, row: &Value) -> Vec<String> {
    let mut wrong = Vec::new();
    let faces = expected_faces(path, row);
    if faces.is_some_and(|faces| faces != model.census.faces as u64) {
        wrong.push(format!("{name}: {} faces, {faces:?} in the oracle", model.census.faces));
    }
    let vertices = row["raw_vertices"].as_u64();
    if vertices.is_some_and(|vertices| vertices != model.census.vertices as u64) {
        wrong.push(format!("{name}: {} vertices, {vertices:?} in the oracle", model.census.vertices));
    }
    let (Some(low), Some(high)) = (vector(&row["bbox_min"]), vector(&row["bbox_max"])) else { return wrong };
    if OTHER_BOUNDS.contains(&name) || low.x > high.x {
        return wrong;
    }
    let Some(Aabb { min, max }) = model.bounds() else { return wrong };
    let (low, high) = match MOVED_BY_NODES.iter().find(|(file, ..)| *file == name) {
        Some(&(_, low, high)) => (low.into(), high.into()),
        None => (Vec3::new(low.x, -high.z, low.y), Vec3::new(high.x, -low.z, high.y)),
    };
    let slack = (high - low).length() * 1e-4 + 1e-4;
    if !min.abs_diff_eq(low, slack) || !max.abs_diff_eq(high, slack) {
        wrong.push(format!("{name}: from {min} to {max}, the oracle says {low} to {high}"));
    }
    wrong
}

/// Hostile files that are drawn all the same, as far as they hold: what is wrong with them is elsewhere, or
/// single faces that are left out. All others are refused or hold nothing to draw.
const DRAWN: [&str; 8] = [
    "gltf_assimp/issue_3269/texcoord_crash.gltf",
    "gltf_validator/node/node_weights_invalid.gltf",
    "gltf_validator/node/node_weights_override.gltf",
    "gltf_validator/node/valid.gltf",
    "model_assimp_invalid/malformed2.obj",
    "mutants/test1_badmagic.3ds",
    "mutants/test1_fidx.3ds",
    "mutants/test1_nanvert.3ds",
];

#[test]
fn hostile_files_are_refused_or_read_without_harm() {
    let Some(data) = data() else { return };
    let broken = data.join("broken");
    let mut drawn = Vec::new();
    let mut refused = 0;
    for path in files_below(&broken, &["3ds", "obj", "gltf", "glb"]) {
        let name = path.strip_prefix(&broken).expect("it lies below").to_string_lossy().replace('\\', "/");
        let result = read_file(&path);
        if path.file_stem().is_some_and(|stem| stem == "valid") {
            assert!(result.is_ok(), "{name} is sound and refused: {result:?}");
        }
        match result {
            Ok(model) if model.parts.is_empty() => assert!(!model.notes.is_empty(), "{name}"),
            Ok(_) => drawn.push(name),
            Err(error) => {
                let message = error_text(&error);
                assert!(message.len() > 20, "{name}: {message}");
                refused += 1;
            }
        }
    }
    assert_eq!(drawn, DRAWN);
    assert!(refused > 50, "{refused}");
}

/// No companions at all.
struct Nothing;

impl Companions for Nothing {
    fn load(&self, name: &str) -> Result<Vec<u8>, CompanionError> {
        Err(format!("there is no {name}").into())
    }
}

#[test]
fn no_cut_or_changed_byte_of_a_sound_file_does_harm() {
    let Some(data) = data() else { return };
    for name in [
        "3ds/test1.3ds",
        "3ds/RotatingCube.3DS",
        "gltf/Box.glb",
        "gltf/assimp_BoxTextured-glTF-Embedded/BoxTextured.gltf",
        "gltf/assimp_simple_skin/quad_skin.glb",
        "obj/tobj/quad.obj",
    ] {
        let path = data.join("models").join(name);
        let bytes = std::fs::read(&path).expect("the file can be read");
        for end in (0..bytes.len()).step_by(bytes.len() / 300 + 1) {
            let _ = read(name, &bytes[..end], &Nothing);
        }
        // A linear congruential generator (Knuth's MMIX constants) chooses what to change.
        let mut state = 1u64;
        let mut random = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) as usize
        };
        for _ in 0..600 {
            let mut changed = bytes.clone();
            for _ in 0..1 + random() % 8 {
                let at = random() % changed.len();
                changed[at] = if random().is_multiple_of(4) { 0xFF } else { random() as u8 };
            }
            if let Ok(model) = read(name, &changed, &Nothing) {
                check(&model, &path);
            }
        }
    }
}

/// OBJ files that `tobj` 4.0.5 by itself, without the repairs of our reader, reads otherwise, and why.
const TOBJ_DIFFERS: [(&str, &str); 11] = [
    (
        "assets/models/firtree.obj",
        "of quads that name a corner twice, triangles without area are left out here",
    ),
    ("assimp/box_UTF16BE.obj", "it reads no UTF-16"),
    ("assimp/number_formats.obj", "it refuses odd exponents"),
    ("assimp/testline.obj", "it takes lines of more than two points for faces"),
    ("assimp/testmixed.obj", "it takes lines of more than two points for faces"),
    ("helix/line_continuation_empty_continuation.obj", "it reads no continued lines"),
    ("helix/line_continuation_multiple_breaks.obj", "it reads no continued lines"),
    ("helix/line_continuation_single.obj", "it reads no continued lines"),
    ("helix/suzanne.obj", "it refuses a usemtl without a name"),
    ("tinyobj/line-prim.obj", "it takes lines of more than two points for faces"),
    ("tinyobj/test-nan.obj", "it refuses positions that are not numbers"),
];

/// The triangles that the faces of a file give, and the distinct positions of their corners, sorted.
#[derive(Debug, PartialEq)]
struct ObjGeometry {
    triangles: usize,
    positions: Vec<[u32; 3]>,
}

impl ObjGeometry {
    fn new(triangles: usize, corners: impl Iterator<Item = Vec3>) -> Self {
        let mut positions: Vec<_> =
            corners.map(|corner| (corner + Vec3::ZERO).to_array().map(f32::to_bits)).collect();
        positions.sort_unstable();
        positions.dedup();
        Self { triangles, positions }
    }

    fn from_model(model: &Model) -> Self {
        let meshes = || model.parts.iter().map(|part| &part.mesh);
        let triangles = meshes().map(|mesh| mesh.triangles.len()).sum();
        let corners = meshes()
            .flat_map(|mesh| mesh.triangles.iter().flatten().map(|id| mesh.vertices[id.index()].position));
        Self::new(triangles, corners.map(Vec3::from))
    }

    fn from_tobj(bytes: &[u8]) -> Result<Self, tobj::LoadError> {
        let options =
            tobj::LoadOptions { ignore_points: true, ignore_lines: true, ..tobj::LoadOptions::default() };
        let no_materials = |_: &Path| Err(tobj::LoadError::OpenFileFailed);
        let (models, _) = tobj::load_obj_buf(&mut &*bytes, &options, no_materials)?;
        let meshes = || models.iter().map(|model| &model.mesh);
        let triangles = |mesh: &tobj::Mesh| match mesh.face_arities[..] {
            [] => mesh.indices.len() / 3,
            _ => mesh.face_arities.iter().map(|&corners| corners as usize - 2).sum(),
        };
        let corner = |mesh: &tobj::Mesh, index: u32| {
            let [x, y, z] = std::array::from_fn(|axis| mesh.positions[index as usize * 3 + axis]);
            Vec3::new(x, -z, y)
        };
        let corners = meshes().flat_map(|mesh| mesh.indices.iter().map(move |&index| corner(mesh, index)));
        Ok(Self::new(meshes().map(triangles).sum(), corners))
    }
}

#[test]
fn obj_files_have_the_triangles_and_positions_that_tobj_reads() {
    let Some(data) = data() else { return };
    let models = data.join("models/obj");
    let assets = Path::new(env!("SANDTABLE_ROOT")).join("assets");
    let mut wrong = Vec::new();
    let mut compared = 0;
    for path in [models, assets].iter().flat_map(|folder| files_below(folder, &["obj"])) {
        let name = path.to_string_lossy();
        let Ok(model) = read_file(&path) else { continue };
        let bytes = std::fs::read(&path).expect("the file can be read");
        let expected = ObjGeometry::from_tobj(&bytes);
        let is_same = expected.as_ref().is_ok_and(|expected| *expected == ObjGeometry::from_model(&model));
        let is_listed = TOBJ_DIFFERS.iter().any(|(file, _)| name.ends_with(file));
        compared += usize::from(is_same);
        if is_same == is_listed {
            let expected = expected.map(|geometry| (geometry.triangles, geometry.positions.len()));
            let own = ObjGeometry::from_model(&model);
            wrong.push(format!("{name}: {expected:?}, here {} and {}", own.triangles, own.positions.len()));
        }
    }
    assert!(wrong.is_empty(), "{} of {compared}:\n{}", wrong.len(), wrong.join("\n"));
    assert!(compared > 50, "{compared} files compared");
}
