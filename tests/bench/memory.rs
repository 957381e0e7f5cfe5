//! `cargo bench --bench memory`: how much memory pictures take, step by step.
//!
//! Sections, chosen by name: `cameras` writes what `new` makes of a tile of elevation and an extract of OpenStreetMap,
//! one picture a camera, where the data is at hand; `ground` draws one picture of the largest ground, 4097² posts;
//! `picture` draws one of 4097² pixels. Each step's worst moment is that of the whole process, with what earlier steps left:
//! run one section at a time to compare its peak with another version's.

#[path = "common/fields.rs"]
#[allow(dead_code, reason = "shared by several benchmarks")]
mod fields;
#[path = "common/rounds.rs"]
#[allow(dead_code, reason = "each benchmark uses its own part")]
mod rounds;
#[path = "demo/steps.rs"]
mod steps;
#[path = "../common/mod.rs"]
mod tests_common;

use std::path::{Path, PathBuf};

use glam::{DAffine2, DMat2, DVec2};
use sandtable_dem::dem_format::DemFormat;
use sandtable_files::raster_file;
use sandtable_new::{self as new_scene, NewSceneOptions};
use sandtable_raster::raster::{Raster, Samples};
use sandtable_render::RenderBackend;
use sandtable_scene::planned_pictures::{ElevationNeed, NearGround, PlannedCameras, PlannedPictures};
use sandtable_scene::scene_file::open_scene_for;
use sandtable_sheet::picture::{PictureSize, compose_view, draw_view};
use sandtable_sheet::sheet_file::sheet_png;

use crate::steps::{Step, Steps};
use crate::tests_common::data::data;

/// Posts, or pixels, along a side of the largest ground and of the large picture.
const LARGE: u32 = 4097;

const SCREEN: PictureSize = PictureSize { width: 1920, height: 1080 };

fn main() {
    rounds::sections(&[("cameras", cameras), ("ground", ground), ("picture", picture)]);
}

/// A folder for the scenes of this benchmark.
fn folder(name: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("sandtable-memory-{}-{name}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder for the scene");
    folder
}

fn cameras() {
    for (dem, vectors) in [
        ("monaco/N43E007.hgt.zip", "monaco/monaco.osm.gz"),
        ("porto_alegre_br/poa_elevation.tif", "porto_alegre_br/poa_osm.pbf"),
    ] {
        let found = [dem, vectors].map(|file| data(&format!("scenes/{file}")));
        let [Some(dem), Some(vectors)] = found else { continue };
        let allowed = vec![dem.parent().expect("in a folder").to_path_buf()];
        println!("\n{} and {}, every camera, 1920×1080", name(&dem), name(&vectors));
        let steps = Steps::default();
        let folder = folder("cameras");
        let options = NewSceneOptions {
            folder: folder.join("scene"),
            dem: vec![dem],
            vectors: vec![vectors],
            ..NewSceneOptions::default()
        };
        let written = new_scene::write(&options, &|step| steps.begin(step)).expect("sound data");
        draw_all(&written.path, &allowed, SCREEN, &steps);
        print_steps(&steps.finish());
        std::fs::remove_dir_all(&folder).expect("removable");
    }
}

fn ground() {
    let folder = folder("ground");
    write_ground(&folder.join("ground.tif"));
    let path = folder.join("scene.toml");
    std::fs::write(&path, "[terrain]\ndem = \"ground.tif\"\n[[camera]]\nname = \"overview\"\n")
        .expect("writable");
    println!("\nground of {LARGE}² posts, one picture, 1920×1080");
    let steps = Steps::default();
    draw_all(&path, &[], SCREEN, &steps);
    print_steps(&steps.finish());
    std::fs::remove_dir_all(&folder).expect("removable");
}

fn picture() {
    let path = Path::new(env!("SANDTABLE_ROOT")).join("scenes/jacksboro.toml");
    println!("\nscenes/jacksboro.toml, first camera, {LARGE}×{LARGE}");
    let steps = Steps::default();
    let size = PictureSize { width: LARGE, height: LARGE };
    draw(&path, &[], size, PlannedCameras::First, &steps);
    print_steps(&steps.finish());
}

fn draw_all(path: &Path, allowed: &[PathBuf], size: PictureSize, steps: &Steps) {
    draw(path, allowed, size, PlannedCameras::All, steps);
}

/// Reads a scene and makes a PNG for each camera, as `render` does.
fn draw(path: &Path, allowed: &[PathBuf], size: PictureSize, cameras: PlannedCameras, steps: &Steps) {
    let is_first = matches!(cameras, PlannedCameras::First);
    let near = NearGround::Nested;
    let pictures = PlannedPictures { cameras, size: Some((size.width, size.height)), near };
    let progress = |step| steps.begin(step);
    let need = ElevationNeed::Pictures(&pictures);
    let scene = open_scene_for(path, allowed, None, need, &progress).expect("a sound scene");
    for view in scene.cameras.iter().take(if is_first { 1 } else { usize::MAX }) {
        let drawn = draw_view(&scene, view, size, RenderBackend::Cpu, &progress).expect("a sound camera");
        let composed = compose_view(&scene, drawn, &progress);
        drop(composed.drawn);
        steps.begin("encoding");
        let png = sheet_png(composed.sheet, None, (None, "a picture"));
        assert!(!png.is_empty());
    }
}

/// Writes a fractal of the largest size, posts 10 m apart, made without the whole of it in f64 at once.
fn write_ground(path: &Path) {
    let side = LARGE as usize;
    let mut heights = fields::fractal(side);
    // The first row of a raster is the northernmost.
    for row in 0..side / 2 {
        let (south, north) = heights.split_at_mut((side - 1 - row) * side);
        south[row * side..][..side].swap_with_slice(&mut north[..side]);
    }
    let cell = DVec2::splat(10.0);
    let map_from_grid = DAffine2 {
        matrix2: DMat2::from_diagonal(DVec2::new(cell.x, -cell.y)),
        translation: DVec2::new(-0.5, f64::from(LARGE) - 0.5) * cell,
    };
    let raster = Raster { map_from_grid, georeferenced: true, ..Raster::new(LARGE, Samples::F32(heights)) };
    let format = DemFormat::to_write("tif").expect("GeoTIFF is written");
    raster_file::write(&raster, format, path, &[]).expect("writable");
}

fn name(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

fn print_steps(steps: &[Step]) {
    println!("{:<28}{:>10}{:>16}", "step", "time", "peak memory");
    for step in steps {
        let peak = step.peak_mib.map_or("not measured".into(), |peak| format!("{peak:.0} MiB"));
        println!("{:<28}{:>8.2} s{peak:>16}", step.name, step.seconds);
    }
    let peak = steps.iter().filter_map(|step| step.peak_mib).fold(0.0, f64::max);
    println!("{:<28}{:>10}{:>12.0} MiB", "all", "", peak);
    println!("Memory: {}.", steps::memory_method());
}
