//! Model files of others: each is read as an independent reader reads it, or refused for a reason.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use glam::Vec3;
use sandtable::model::error::ModelError;
use sandtable::model::kind::{Companions, Model};
use sandtable::model::read::read;
use serde_json::Value;

/// Files under `models/` that must be refused, with a word their error must have.
const REFUSED: [(&str, &str); 6] = [
    ("gltf/meshopt_pirate.glb", "meshopt"),
    ("obj/helix/line_continuation_empty_line.obj", "coordinates"),
    ("obj/tinyobj/invalid-relative-texture-index.obj", "defined so far"),
    ("obj/tinyobj/invalid-relative-vertex-index.obj", "defined so far"),
    ("obj/tinyobj/issue-140-zero-face-idx.obj", "defined so far"),
    ("obj/tobj/invalid_index.obj", "defined so far"),
];

/// Files whose bounds are not compared, and why.
const OTHER_BOUNDS: [&str; 2] = [
    // Positions that are not finite are left out here.
    "obj/tinyobj/test-nan.obj",
    // The oracle adds 1e10 where exponents are odd.
    "obj/assimp/number_formats.obj",
];

/// The companions in a folder, letter case as on disk.
struct Folder(PathBuf);

impl Companions for Folder {
    fn load(&self, name: &str) -> Result<Vec<u8>, String> {
        std::fs::read(self.0.join(name)).map_err(|error| error.to_string())
    }
}

fn data() -> Option<PathBuf> {
    let folder = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../shared/data"));
    if folder.is_dir() {
        return Some(folder.into());
    }
    assert!(std::env::var_os("SANDTABLE_REQUIRE_DATA").is_none(), "{} is required", folder.display());
    eprintln!("SKIPPED: no test data at {}", folder.display());
    None
}

fn files_below(folder: &Path, extensions: &[&str]) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(&folder).expect("the folder can be listed") {
            let path = entry.expect("the entry can be read").path();
            let extension = path.extension().map(|extension| extension.to_string_lossy().to_ascii_lowercase());
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
            assert!((Vec3::from(vertex.normal).length() - 1.0).abs() < 1e-3, "{}: {vertex:?}", path.display());
            assert!(vertex.uv.iter().all(|coordinate| coordinate.is_finite()));
        }
    }
}

fn vector(value: &Value) -> Option<Vec3> {
    let numbers: Vec<f32> = value.as_array()?.iter().filter_map(|number| Some(number.as_f64()? as f32)).collect();
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
    let Some((min, max)) = model.bounds() else { return wrong };
    let (low, high) = (Vec3::new(low.x, -high.z, low.y), Vec3::new(high.x, -low.z, high.y));
    let slack = (high - low).length() * 1e-4 + 1e-4;
    if !min.abs_diff_eq(low, slack) || !max.abs_diff_eq(high, slack) {
        wrong.push(format!("{name}: from {min} to {max}, the oracle says {low} to {high}"));
    }
    wrong
}
