//! `sandtable render`: a scene file to an annotated PNG.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::{Map, Value, json};

use crate::annotate::report::AnnotationReport;
use crate::cli::check::contents;
use crate::cli::error::CliError;
use crate::cli::options::SceneArguments;
use crate::cli::output::{print, print_lines, row, warn};
use crate::cli::progress::StepTimer;
use crate::cli::values::{choice, picture_size};
use crate::draw::list::DrawList;
use crate::message::suggest::{nearest, quoted};
use crate::pipeline::files::{self, WriteFileCause, WriteFileError};
use crate::pipeline::picture::{ComposedView, PictureSize, compose_view, draw_view};
use crate::pipeline::picture_buffers::PictureBuffers;
use crate::pipeline::picture_statistics::{Lightness, PictureStatistics};
use crate::pipeline::scene_file::open_scene;
use crate::pipeline::sheet_file::write_sheet;
use crate::render::RenderBackend;
use crate::scene::picture::ViewDraw;
use crate::scene::{SceneModel, SceneView};

/// The longest text of a label in the summary, in characters.
const LONGEST_LABEL: usize = 60;

#[derive(Debug, Args)]
pub struct RenderArguments {
    #[command(flatten)]
    pub scene: SceneArguments,
    /// Write the picture to this .png, .pdf or .svg file [default: the scene's name with .png, in the current folder]
    #[arg(short, long, value_name = "OUT")]
    pub output: Option<PathBuf>,
    /// Size of the picture in pixels [default: that of the camera's paper, or 1920x1080]
    #[arg(long, value_name = "WxH", value_parser = picture_size)]
    pub size: Option<PictureSize>,
    /// The camera of the scene to look through [default: its first]
    #[arg(long, value_name = "NAME")]
    pub camera: Option<String>,
    /// What draws: the processor, the same on every machine, or a graphics adapter
    #[arg(long, default_value = "cpu", value_parser = choice::<RenderBackend>())]
    pub backend: RenderBackend,
    /// How many threads to use [default: one per core]; the picture is the same for any number
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
    /// Also write what each pixel shows into this folder: depth.tif, elevation.tif, normal.png, feature.tif, features.csv
    #[arg(long, value_name = "DIR")]
    pub buffers: Option<PathBuf>,
    /// Print JSON: what the picture shows, how light its ground is, triangles, labels, notes and the time of each step
    #[arg(long)]
    pub json: bool,
}

pub fn run(arguments: &RenderArguments) -> Result<(), CliError> {
    let pool =
        rayon::ThreadPoolBuilder::new().num_threads(arguments.threads.map_or(0, usize::from)).build()?;
    let scene_file = &arguments.scene.scene;
    let path = arguments.output.clone().unwrap_or_else(|| default_output(scene_file));
    files::check_sheet_output(&path, &[scene_file])
        .map_err(|error| named_by_option(error, "this is the scene file itself"))?;
    let steps = StepTimer::default();
    let rendered = pool.install(|| render(arguments, &path, &steps))?;
    let times = steps.finish();
    if arguments.json {
        return print(&format!("{:#}\n", as_json(&path, &rendered, &times)));
    }
    let mut lines = vec![path.display().to_string()];
    lines.extend(contents(&rendered.scene));
    lines.extend(rendered.scene.inferred_notes().iter().map(|note| row(9, "note", note)));
    lines.extend(summary(&rendered));
    let times: Vec<String> = times.iter().map(|(step, seconds)| format!("{step} {seconds:.2} s")).collect();
    lines.push(row(9, "time", times.join(", ")));
    print_lines(&lines)?;
    for missing in &rendered.view.annotations.missing_glyphs {
        warn(&format!("warning: the font lacks {} characters of '{}'", missing.count, missing.text));
    }
    Ok(())
}

/// A scene and the picture of it that was written.
struct RenderedScene {
    scene: SceneModel,
    camera: String,
    view: WrittenView,
    /// Measured where JSON is printed.
    statistics: Option<PictureStatistics>,
}

/// What is told of a picture.
struct WrittenView {
    drawn: ViewDraw,
    annotations: AnnotationReport,
}

fn render(arguments: &RenderArguments, path: &Path, steps: &StepTimer) -> Result<RenderedScene, CliError> {
    let progress = |step| steps.begin(step);
    let scene = open_scene(&arguments.scene.scene, &arguments.scene.access.allow, &progress)?;
    let camera = find_camera(&scene, arguments.camera.as_deref())?.clone();
    files::check_output(path, &scene.files)
        .map_err(|error| named_by_option(error, "the scene is made of this file"))?;
    let size = arguments.size.unwrap_or_else(|| PictureSize::of(&camera));
    let drawn = draw_view(&scene, &camera, size, arguments.backend, &progress)?;
    let statistics = arguments.json.then(|| PictureStatistics::new(&drawn.picture));
    if let Some(folder) = &arguments.buffers {
        progress("writing buffers");
        files::make_folder(folder)?;
        PictureBuffers { scene: &scene, camera: &drawn.camera, rendering: &drawn.picture }.write(folder)?;
    }
    let ComposedView { sheet, drawn, annotations } = compose_view(&scene, drawn, &progress);
    progress("writing the picture");
    write_sheet(path, sheet, camera.dpi(), scene.title.as_deref())?;
    let view = WrittenView { drawn, annotations };
    Ok(RenderedScene { scene, camera: camera.name, view, statistics })
}

/// The error with `reason` and the option to change, where the picture would replace an input.
fn named_by_option(error: WriteFileError, reason: &str) -> CliError {
    match error.cause {
        WriteFileCause::Input => CliError::input(format!("{error}: {reason}; name another with -o")),
        _ => error.into(),
    }
}

/// The camera called `name`, or the first where no name is given.
pub fn find_camera<'a>(scene: &'a SceneModel, name: Option<&str>) -> Result<&'a SceneView, CliError> {
    scene.view(name).ok_or_else(|| {
        let names: Vec<&str> = scene.cameras.iter().map(|view| view.name.as_str()).collect();
        let name = name.unwrap_or_default();
        let meant = nearest(name, names.iter().copied());
        let meant = meant.map(|name| format!("; did you mean '{name}'?")).unwrap_or_default();
        CliError::Usage(format!(
            "the scene has no camera '{}'; it has {}{meant}",
            quoted(name),
            names.join(", ")
        ))
    })
}

/// The scene's name with `.png`, in the current folder.
fn default_output(scene: &Path) -> PathBuf {
    PathBuf::from(scene.file_stem().unwrap_or("scene".as_ref())).with_extension("png")
}

/// The camera, and the labels that were not placed or were shortened, in lines.
fn summary(rendered: &RenderedScene) -> Vec<String> {
    let drawn = &rendered.view.drawn;
    let (all, ground) = (drawn.list.triangle_count(), drawn.ground_triangles);
    let camera = format!("{}: {all} triangles, {ground} of them ground", rendered.camera);
    let AnnotationReport { hidden, outside, crowded_out, shortened, .. } = &rendered.view.annotations;
    let labels = [
        ("hidden", hidden),
        ("outside the picture", outside),
        ("without room", crowded_out),
        ("shortened", shortened),
    ];
    let labels = labels.into_iter().filter(|(_, labels)| !labels.is_empty()).map(|(why, labels)| {
        let names: Vec<String> = labels.iter().map(|label| shortened_label(label)).collect();
        row(9, "labels", format!("{why}: {}", names.join(", ")))
    });
    std::iter::once(row(9, "camera", camera)).chain(labels).collect()
}

/// The rendered scene as an object with a member for each fact.
fn as_json(path: &Path, rendered: &RenderedScene, times: &[(&'static str, f64)]) -> Value {
    let RenderedScene { scene, camera, view, statistics } = rendered;
    let lightness = statistics.and_then(|statistics| statistics.ground_lightness);
    let AnnotationReport { hidden, outside, crowded_out, shortened, .. } = &view.annotations;
    let notes: Vec<String> = scene.notes.iter().cloned().chain(scene.inferred_notes()).collect();
    let seconds: Map<String, Value> = times.iter().map(|&(step, time)| (step.into(), time.into())).collect();
    json!({
        "picture": path.display().to_string(),
        "camera": camera,
        "filled_fraction": statistics.map(|statistics| statistics.filled),
        "ground_fraction": statistics.map(|statistics| statistics.ground),
        "ground_lightness": lightness.map(|Lightness { mean, sd, p2, p98 }| {
            json!({"mean": mean, "sd": sd, "p2": p2, "p98": p98})
        }),
        "triangles": triangles(scene, &view.drawn.list),
        "labels": {
            "hidden": hidden, "outside": outside, "without_room": crowded_out, "shortened": shortened
        },
        "notes": notes,
        "seconds": seconds,
    })
}

/// The number of triangles drawn of the ground and of each kind of feature.
fn triangles(scene: &SceneModel, list: &DrawList) -> BTreeMap<&'static str, usize> {
    let mut counts = BTreeMap::new();
    for item in &list.items {
        let feature = item.feature.index().and_then(|index| scene.features.get(index));
        *counts.entry(feature.map_or("ground", |feature| feature.kind.noun(2))).or_default() +=
            item.triangles.len();
    }
    counts
}

/// A label on one line, cut where it is long.
fn shortened_label(label: &str) -> String {
    let line = label.replace('\n', " ");
    match line.char_indices().nth(LONGEST_LABEL) {
        Some((end, _)) => format!("{}…", &line[..end]),
        None => line,
    }
}
