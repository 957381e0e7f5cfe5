//! Every scene in `scenes/`: sound in every structure on the way to a picture, the same bytes for any number of
//! threads, and the same picture as the one in `tests/golden`.
//!
//! A change that is meant to change pictures is blessed, after looking at them:
//! `SANDTABLE_BLESS=1 cargo test --test pictures gallery`.

use crate::common::golden;
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use sandtable_draw::list::{DepthLayer, DrawItem};
use sandtable_mesh::check;
use sandtable_mesh::trimesh::TriMesh;
use sandtable_picture::ViewDraw;
use sandtable_render::RenderBackend;
use sandtable_ribbon::drape::check_clearance;
use sandtable_scene::scene_file::open_scene;
use sandtable_scene::scene_model::SceneModel;
use sandtable_scene::scene_view::{SceneView, ViewAim};
use sandtable_sheet::picture::{PictureSize, RenderedView, render_view};

/// Small enough to be quick and to be kept, large enough for annotations.
const SIZE: PictureSize = PictureSize { width: 480, height: 270 };

/// The same of a panorama, whose shape is another.
const PANORAMA_SIZE: PictureSize = PictureSize { width: 960, height: 160 };

/// A golden picture has at most this many bytes, and all together.
const MOST_BYTES: u64 = 40_000;
const MOST_BYTES_TOGETHER: u64 = 1_700_000;

/// A scene of the gallery.
struct Exhibit {
    name: String,
    scene: SceneModel,
}

/// A view of a scene, rendered with one thread.
struct Shown {
    name: String,
    exhibit: &'static Exhibit,
    view: &'static SceneView,
    finished: RenderedView,
}

fn scene_files() -> Vec<PathBuf> {
    let folder = Path::new(env!("SANDTABLE_ROOT")).join("scenes");
    let entries =
        fs::read_dir(folder).expect("the scenes are there").map(|entry| entry.expect("readable").path());
    let mut files: Vec<PathBuf> =
        entries.filter(|path| path.extension().is_some_and(|extension| extension == "toml")).collect();
    files.sort();
    files
}

fn exhibits() -> &'static [Exhibit] {
    static EXHIBITS: LazyLock<Vec<Exhibit>> =
        LazyLock::new(|| scene_files().iter().map(|path| load(path)).collect());
    &EXHIBITS
}

fn load(path: &Path) -> Exhibit {
    let scene = open_scene(path, &[], &|_| {}).unwrap_or_else(|failure| panic!("{failure:?}"));
    Exhibit { name: path.file_stem().expect("named").to_string_lossy().into_owned(), scene }
}

/// Every camera of every scene.
fn shown() -> &'static [Shown] {
    static SHOWN: LazyLock<Vec<Shown>> = LazyLock::new(|| {
        let views = exhibits()
            .iter()
            .flat_map(|exhibit| exhibit.scene.cameras.iter().map(move |view| (exhibit, view)));
        views.map(|(exhibit, view)| show(exhibit, view)).collect()
    });
    &SHOWN
}

fn show(exhibit: &'static Exhibit, view: &'static SceneView) -> Shown {
    let name = format!("{}-{}", exhibit.name, view.name);
    Shown { name, exhibit, view, finished: render(&exhibit.scene, view, 1) }
}

fn is_panorama(view: &SceneView) -> bool {
    matches!(view.aim, ViewAim::Panorama(_))
}

fn render(scene: &SceneModel, view: &SceneView, threads: usize) -> RenderedView {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
    let size = if is_panorama(view) { PANORAMA_SIZE } else { SIZE };
    let finished = pool.install(|| render_view(scene, view, size, RenderBackend::Cpu, &|_| {}));
    finished.unwrap_or_else(|failure| panic!("{}: {failure:?}", view.name))
}

#[test]
fn every_scene_opens_with_a_comment_that_says_what_it_shows() {
    for path in scene_files() {
        let text = fs::read_to_string(&path).expect("readable");
        let first = text.lines().next().unwrap_or_default();
        let says = first.strip_prefix("# ").is_some_and(|comment| comment.len() > 20);
        assert!(says, "{} opens with {first:?}", path.display());
    }
}

#[test]
fn every_scene_s_errors_never_shrink_from_a_vertex_to_its_parents() {
    for Exhibit { scene, .. } in exhibits() {
        scene.ground().exact().check(scene.ground().layout());
    }
}

#[test]
fn every_view_s_ground_is_a_conforming_mesh() {
    for Shown { name, finished, .. } in shown() {
        let displayed = &finished.drawn.displayed;
        displayed.active().check();
        let mut mesh = TriMesh::default();
        displayed.emit(&mut mesh);
        assert_eq!(check::check(&mesh).err(), None, "{name}");
        assert_eq!(mesh.triangles.len(), finished.drawn.ground_triangles, "{name}");
        assert!(mesh.triangles.len() > 500, "{name}: {} triangles of ground", mesh.triangles.len());
    }
}

#[test]
fn every_view_s_draw_list_is_sound() {
    for Shown { name, finished, .. } in shown() {
        assert_eq!(finished.drawn.list.check(), Ok(()), "{name}");
    }
}

fn draped(shot: &ViewDraw) -> impl Iterator<Item = &DrawItem> {
    shot.list.items.iter().filter(|item| matches!(item.layer, DepthLayer::Draped(_)))
}

/// What rounding corners to f32 may come to: twice the step between numbers at the far end of the ground, which
/// is 8 mm at 32 km. A corner is moved aside by half a step each way, and up or down on slopes by as much.
fn clearance_m(scene: &SceneModel) -> f64 {
    scene.lattice.extent().size().max_element() * f64::from(f32::EPSILON) * 2.0
}

#[test]
fn every_road_river_and_lake_lies_on_the_displayed_ground() {
    // A panorama lowers all of its list by the Earth's curvature; tests/pictures/panorama.rs looks at it.
    for Shown { name, exhibit, finished, .. } in shown().iter().filter(|shown| !is_panorama(shown.view)) {
        let (shot, most_m) = (&finished.drawn, clearance_m(&exhibit.scene));
        for item in draped(shot) {
            let found_m = check_clearance(&shot.list.meshes[item.mesh.0 as usize], &*shot.displayed);
            assert!(found_m < most_m, "{name}: {:?} is {found_m} m off, not {most_m} m", item.feature);
        }
        let in_view = draped(shot).count() > 0;
        let lies = !exhibit.scene.ribbons.is_empty() || !exhibit.scene.graphics.is_empty();
        assert_eq!(in_view, lies, "{name}: ribbons or graphics in view");
    }
}

#[test]
fn one_thread_and_three_give_the_same_bytes() {
    for Shown { name, exhibit, view, finished } in shown() {
        let other = render(&exhibit.scene, view, 3);
        assert!(finished.pixels == other.pixels, "{name}");
        assert_eq!(finished.annotations, other.annotations, "{name}");
    }
}

#[test]
fn every_picture_is_the_golden_one() {
    let faults = shown().iter().map(|shown| golden::compare(&shown.name, &shown.finished.pixels));
    let mut faults: Vec<String> = faults.filter_map(Result::err).collect();
    faults.extend(left_over());
    let help = "Look at the .new.png and .diff.png beside the golden pictures. If they are as they should be:\n    \
                SANDTABLE_BLESS=1 cargo test --test pictures gallery";
    assert!(faults.is_empty(), "{}\n{help}", faults.join("\n"));
    let bytes = |path: &PathBuf| fs::metadata(path).expect("readable").len();
    let sizes: Vec<u64> = golden::files().iter().map(bytes).collect();
    assert!(sizes.iter().all(|&size| size <= MOST_BYTES), "{sizes:?}: none above {MOST_BYTES} is kept");
    assert!(sizes.iter().sum::<u64>() <= MOST_BYTES_TOGETHER, "{sizes:?}");
}

/// The golden pictures of no view; removed where pictures are blessed.
fn left_over() -> Vec<String> {
    let views: BTreeSet<&str> = shown().iter().map(|shown| shown.name.as_str()).collect();
    let name = |path: &PathBuf| path.file_stem().expect("named").to_string_lossy().into_owned();
    let mut left_over = golden::files();
    left_over.retain(|path| !views.contains(name(path).as_str()));
    if golden::is_blessing() {
        left_over.drain(..).for_each(|path| fs::remove_file(path).expect("removable"));
    }
    left_over.iter().map(|path| format!("{} is of no view", path.display())).collect()
}

#[test]
fn no_label_of_any_scene_covers_another_or_furniture() {
    for Shown { name, finished, .. } in shown() {
        let found = crate::overlaps::overlaps(&finished.annotations);
        assert!(found.is_empty(), "{name}: {found:?}");
    }
}
