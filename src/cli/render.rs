//! `sandtable render`: a scene file to an annotated PNG.

use std::path::{Path, PathBuf};

use clap::Args;

use crate::annotate::report::AnnotationReport;
use crate::cli::check::contents;
use crate::cli::error::CliError;
use crate::cli::options::SceneArguments;
use crate::cli::output::{print_lines, row, warn};
use crate::cli::progress::StepTimer;
use crate::cli::values::{choice, picture_size};
use crate::message::suggest::{nearest, quoted};
use crate::pipeline::files::{self, WriteFileCause, WriteFileError};
use crate::pipeline::picture::{PictureSize, RenderedView, render_view};
use crate::pipeline::scene_file::open_scene;
use crate::render::RenderBackend;
use crate::scene::{SceneModel, SceneView};

/// The longest text of a label in the summary, in characters.
const LONGEST_LABEL: usize = 60;

#[derive(Debug, Args)]
pub struct RenderArguments {
    #[command(flatten)]
    pub scene: SceneArguments,
    /// Write the picture to this file [default: the scene's name with .png, in the current folder]
    #[arg(short, long, value_name = "OUT.png")]
    pub output: Option<PathBuf>,
    /// Size of the picture in pixels
    #[arg(long, value_name = "WxH", default_value = "1920x1080", value_parser = picture_size)]
    pub size: PictureSize,
    /// The camera of the scene to look through [default: its first]
    #[arg(long, value_name = "NAME")]
    pub camera: Option<String>,
    /// What draws: the processor, the same on every machine, or a graphics adapter
    #[arg(long, default_value = "cpu", value_parser = choice::<RenderBackend>())]
    pub backend: RenderBackend,
    /// How many threads to use [default: one per core]; the picture is the same for any number
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
}

pub fn run(arguments: &RenderArguments) -> Result<(), CliError> {
    let pool =
        rayon::ThreadPoolBuilder::new().num_threads(arguments.threads.map_or(0, usize::from)).build()?;
    let scene_file = &arguments.scene.scene;
    let path = arguments.output.clone().unwrap_or_else(|| default_output(scene_file));
    files::check_picture_output(&path, &[scene_file])
        .map_err(|error| named_by_option(error, "this is the scene file itself"))?;
    let steps = StepTimer::default();
    let rendered = pool.install(|| render(arguments, &path, &steps))?;
    let times = steps.finish();
    let mut lines = vec![path.display().to_string()];
    lines.extend(contents(&rendered.scene));
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
    view: RenderedView,
}

fn render(arguments: &RenderArguments, path: &Path, steps: &StepTimer) -> Result<RenderedScene, CliError> {
    let progress = |step| steps.begin(step);
    let scene = open_scene(&arguments.scene.scene, &arguments.scene.access.allow, &progress)?;
    let camera = find_camera(&scene, arguments.camera.as_deref())?.clone();
    files::check_output(path, &scene.files)
        .map_err(|error| named_by_option(error, "the scene is made of this file"))?;
    let view = render_view(&scene, &camera, arguments.size, arguments.backend, &progress)?;
    progress("writing the picture");
    files::write_picture(path, &view.pixels)?;
    Ok(RenderedScene { scene, camera: camera.name, view })
}

/// The error with `reason` and the option to change, where the picture would replace an input.
fn named_by_option(error: WriteFileError, reason: &str) -> CliError {
    match error.cause {
        WriteFileCause::Input => CliError::input(format!("{error}: {reason}; name another with -o")),
        _ => error.into(),
    }
}

fn find_camera<'a>(scene: &'a SceneModel, name: Option<&str>) -> Result<&'a SceneView, CliError> {
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

/// A label on one line, cut where it is long.
fn shortened_label(label: &str) -> String {
    let line = label.replace('\n', " ");
    match line.char_indices().nth(LONGEST_LABEL) {
        Some((end, _)) => format!("{}…", &line[..end]),
        None => line,
    }
}
