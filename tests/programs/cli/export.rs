//! `export`: a scene in, a file that modeling programs open out.

use std::collections::BTreeSet;
use std::path::Path;

use glam::Vec3;
use sandtable_geom::aabb::Aabb;
use sandtable_model::error::CompanionError;
use sandtable_model::read;
use sandtable_model::{Companions, Model};

use crate::cli::{Ran, project, run_in};
use crate::common::scratch::Scratch;
use crate::common::validator::assert_valid;

/// The files beside a model.
struct Beside<'a>(&'a Path);

impl Companions for Beside<'_> {
    fn load(&self, name: &str) -> Result<Vec<u8>, CompanionError> {
        Ok(std::fs::read(self.0.join(name))?)
    }
}

fn export(scratch: &Scratch, scene: &str, out: &str) -> Ran {
    let scene = project(scene);
    run_in(scratch.folder(), &["export", &scene, "-o", out, "--max-error", "5"])
}

fn model(scratch: &Scratch, name: &str) -> Model {
    let bytes = std::fs::read(scratch.at(name)).expect("written");
    read::read(name, &bytes, &Beside(scratch.folder())).expect("our own reader reads it")
}

/// The number after a word of the summary.
fn told(out: &str, word: &str) -> usize {
    let line = out
        .lines()
        .find_map(|line| line.trim().strip_prefix(word))
        .unwrap_or_else(|| panic!("{word}: {out}"));
    line.trim().parse().expect("a number")
}

#[test]
#[ignore = "slow: exports every scene"]
fn every_scene_s_glb_passes_the_validator_and_holds_every_triangle() {
    let scratch = Scratch::new();
    let entries = std::fs::read_dir(project("scenes")).expect("scenes").flatten();
    let is_scene = |entry: &std::fs::DirEntry| entry.path().extension().is_some_and(|it| it == "toml");
    let mut scenes: Vec<_> = entries.filter(is_scene).collect();
    scenes.sort_by_key(|entry| entry.file_name());
    assert!(scenes.len() >= 8);
    for scene in scenes {
        let name = scene.file_name().to_string_lossy().into_owned();
        let out = export(&scratch, &format!("scenes/{name}"), "scene.glb").ok();
        assert_valid(&scratch.at("scene.glb"));
        let read = model(&scratch, "scene.glb");
        let (written, read) = (told(&out, "triangles"), read.triangle_count());
        assert_eq!(read, written, "{name}");
        assert!(read > 1000, "{name}");
    }
}

#[test]
fn a_glb_and_an_obj_hold_the_same_scene_true_to_scale() {
    let scratch = Scratch::new();
    export(&scratch, "scenes/models.toml", "scene.glb").ok();
    export(&scratch, "scenes/models.toml", "scene.obj").ok();
    let [glb, obj] = ["scene.glb", "scene.obj"].map(|name| model(&scratch, name));
    assert_eq!(obj.notes, Vec::<String>::new(), "every companion is there");
    let Aabb { min: low, max: high } = glb.bounds().expect("triangles");
    // OBJ files are taken for Y up, so what is Z up in them lies on its back.
    let Aabb { min: back, max: front } = obj.bounds().expect("triangles");
    let upright = |at: Vec3| Vec3::new(at.x, at.z, -at.y);
    let (a, b) = (upright(back), upright(front));
    assert!((low - a.min(b)).abs().max_element() < 0.01 && (high - a.max(b)).abs().max_element() < 0.01);
    assert!(low.x.abs() < 0.01 && low.y.abs() < 0.01, "from the south-west post on: {low}");
    assert!(glb.parts.iter().any(|part| glb.materials[part.material.0 as usize].texture.is_some()));
}

#[test]
fn ground_and_drapes_cover_every_place_once() {
    let scratch = Scratch::new();
    export(&scratch, "scenes/lake.toml", "scene.glb").ok();
    let model = model(&scratch, "scene.glb");
    let Aabb { min: low, max: high } = model.bounds().expect("triangles");
    let size = (high - low).truncate();
    let area = |name: &dyn Fn(&str) -> bool| -> f32 {
        let parts = model.parts.iter().filter(|part| name(&model.materials[part.material.0 as usize].name));
        let at = |part: &sandtable_model::ModelPart, index: usize| {
            Vec3::from(part.mesh.vertices[index].position).truncate()
        };
        parts
            .flat_map(|part| part.mesh.triangles.iter().map(move |ids| ids.map(|id| at(part, id.index()))))
            .map(|[a, b, c]| (b - a).perp_dot(c - a) / 2.0)
            .sum()
    };
    let names: BTreeSet<&str> = model.materials.iter().map(|material| material.name.as_str()).collect();
    assert!(names.contains("lake") && names.contains("ground"), "{names:?}");
    let whole = size.x * size.y;
    let water = ["river", "rapids", "falls", "bar", "lake"];
    let drapes = area(&|name| water.contains(&name));
    assert!(drapes > whole * 0.005, "{drapes} of {whole}");
    // Trees stand on it.
    let covered = area(&|name| name == "ground" || water.contains(&name));
    assert!((covered / whole - 1.0).abs() < 1e-4, "{covered} of {whole}");
}

#[test]
fn a_name_of_no_format_and_the_scene_s_own_name_are_refused() {
    let scratch = Scratch::new();
    let said = export(&scratch, "scenes/lake.toml", "scene.fbx").failed(2);
    assert!(
        said.contains(
            "scene.fbx: scenes are exported as .glb, .obj or .html, as .3mf or .stl to print, or as .gpkg"
        ),
        "{said}"
    );
    assert_eq!(scratch.names(), Vec::<String>::new());
}
