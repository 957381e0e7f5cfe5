//! `sandtable render`: a scene file to an annotated PNG.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::{Map, Value, json};

use crate::annotate::report::{AnnotationReport, SymbolReport};
use crate::cli::check::contents;
use crate::cli::error::CliError;
use crate::cli::options::SceneArguments;
use crate::cli::output::{print, print_lines, row, warn};
use crate::cli::progress::StepTimer;
use crate::cli::values::{choice, picture_size};
use crate::draw::list::DrawList;
use crate::message::suggest::{nearest, quoted};
use crate::pipeline::files::{self, WriteFileCause, WriteFileError};
use crate::pipeline::picture::{PictureSize, annotate_view, draw_view};
use crate::pipeline::picture_buffers::PictureBuffers;
use crate::pipeline::picture_statistics::{Lightness, PictureStatistics};
use crate::pipeline::scene_file::{open_scene, open_scene_in_phase, phases};
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
    /// Write a picture for each camera, OUT-CAMERA.png
    #[arg(long, conflicts_with = "camera")]
    pub all_cameras: bool,
    /// The phase of the scene to show [default: its first]
    #[arg(long, value_name = "NAME")]
    pub phase: Option<String>,
    /// Write a picture for each phase, OUT-PHASE.png
    #[arg(long, conflicts_with = "phase")]
    pub all_phases: bool,
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
    files::check_picture_output(&path, &[scene_file])
        .map_err(|error| named_by_option(error, "this is the scene file itself"))?;
    let steps = StepTimer::default();
    let scenes = pool.install(|| render(arguments, &path, &steps))?;
    let times = steps.finish();
    let pictures = || scenes.iter().flat_map(|scene| &scene.pictures);
    if arguments.json {
        let all: Vec<Value> = scenes.iter().flat_map(|scene| scene.as_json(&times)).collect();
        return match &all[..] {
            [one] if !arguments.all_cameras && !arguments.all_phases => print(&format!("{one:#}\n")),
            all => print(&format!("{:#}\n", Value::from(all))),
        };
    }
    let mut lines: Vec<String> = scenes.iter().flat_map(RenderedScene::lines).collect();
    let times: Vec<String> = times.iter().map(|(step, seconds)| format!("{step} {seconds:.2} s")).collect();
    lines.push(row(9, "time", times.join(", ")));
    print_lines(&lines)?;
    for missing in pictures().flat_map(|picture| &picture.annotations.missing_glyphs) {
        warn(&format!("warning: the font lacks {} characters of '{}'", missing.count, missing.text));
    }
    Ok(())
}

/// A scene in one phase, and the pictures of it that were written.
struct RenderedScene {
    scene: SceneModel,
    pictures: Vec<RenderedPicture>,
}

/// A picture that was written, without its pixels.
struct RenderedPicture {
    path: PathBuf,
    camera: String,
    /// Triangles drawn of the ground and of each kind of feature.
    triangles: BTreeMap<&'static str, usize>,
    ground_triangles: usize,
    annotations: AnnotationReport,
    /// Measured where JSON is printed.
    statistics: Option<PictureStatistics>,
}

fn render(
    arguments: &RenderArguments,
    path: &Path,
    steps: &StepTimer,
) -> Result<Vec<RenderedScene>, CliError> {
    let progress = |step| steps.begin(step);
    let SceneArguments { scene: file, access } = &arguments.scene;
    if !arguments.all_phases {
        let scene = match &arguments.phase {
            Some(phase) => open_scene_in_phase(file, &access.allow, phase, &progress)?,
            None => open_scene(file, &access.allow, &progress)?,
        };
        return Ok(vec![render_scene(arguments, scene, path, &progress)?]);
    }
    let names = phases(file, &access.allow)?;
    if names.is_empty() {
        let message = "--all-phases has no effect: the scene has no [[phase]]; remove it";
        return Err(CliError::Usage(message.into()));
    }
    let paths = named_paths(path, &names);
    let phases = names.iter().zip(paths);
    let render = |(phase, path): (&String, PathBuf)| {
        let scene = open_scene_in_phase(file, &access.allow, phase, &progress)?;
        render_scene(arguments, scene, &path, &progress)
    };
    phases.map(render).collect()
}

fn render_scene(
    arguments: &RenderArguments,
    scene: SceneModel,
    path: &Path,
    progress: &dyn Fn(&'static str),
) -> Result<RenderedScene, CliError> {
    let views: Vec<&SceneView> = match arguments.all_cameras {
        true => scene.cameras.iter().collect(),
        false => vec![find_camera(&scene, arguments.camera.as_deref())?],
    };
    let names: Vec<String> = views.iter().map(|view| view.name.clone()).collect();
    let paths = if arguments.all_cameras { named_paths(path, &names) } else { vec![path.to_owned()] };
    for path in &paths {
        files::check_output(path, &scene.files)
            .map_err(|error| named_by_option(error, "the scene is made of this file"))?;
    }
    let mut pictures = Vec::new();
    for (view, path) in views.into_iter().zip(paths) {
        pictures.push(render_picture(arguments, &scene, view, path, progress)?);
    }
    Ok(RenderedScene { scene, pictures })
}

fn render_picture(
    arguments: &RenderArguments,
    scene: &SceneModel,
    camera: &SceneView,
    path: PathBuf,
    progress: &dyn Fn(&'static str),
) -> Result<RenderedPicture, CliError> {
    let drawn = draw_view(scene, camera, arguments.size, arguments.backend, progress)?;
    let statistics = arguments.json.then(|| PictureStatistics::new(&drawn.picture));
    if let Some(folder) = &arguments.buffers {
        progress("writing buffers");
        // The buffers of several pictures lie in folders named as the pictures are.
        let is_one = !arguments.all_cameras && !arguments.all_phases;
        let folder = if is_one { folder.clone() } else { folder.join(files::file_stem(&path)) };
        files::make_folder(&folder)?;
        PictureBuffers { scene, camera: &drawn.camera, rendering: &drawn.picture }.write(&folder)?;
    }
    let view = annotate_view(scene, drawn, progress);
    progress("writing the picture");
    files::write_picture(&path, &view.pixels)?;
    Ok(RenderedPicture {
        path,
        camera: camera.name.clone(),
        triangles: triangles(scene, &view.drawn.list),
        ground_triangles: view.drawn.ground_triangles,
        annotations: view.annotations,
        statistics,
    })
}

/// A path for each of `names`: `path` with the name behind its own. Characters that are trouble in file names become
/// hyphens; what then has the name of an earlier one gets its number.
fn named_paths(path: &Path, names: &[String]) -> Vec<PathBuf> {
    let is_plain = |letter: char| letter.is_alphanumeric() || ['_', '.'].contains(&letter);
    let plain = |name: &String| name.replace(|letter| !is_plain(letter), "-");
    let mut taken = BTreeSet::new();
    let named = |(number, name): (usize, &String)| {
        let mut name = plain(name);
        if !taken.insert(name.clone()) {
            name = format!("{name}-{number}");
            taken.insert(name.clone());
        }
        let stem = files::file_stem(path);
        path.with_file_name(format!("{stem}-{name}.png"))
    };
    (1..).zip(names).map(named).collect()
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

impl RenderedScene {
    /// What the pictures show, in lines.
    fn lines(&self) -> Vec<String> {
        let paths = self.pictures.iter().map(|picture| picture.path.display().to_string());
        let notes = self.scene.inferred_notes();
        let notes = notes.iter().map(|note| row(9, "note", note));
        let summaries = self.pictures.iter().flat_map(RenderedPicture::summary);
        paths.chain(contents(&self.scene)).chain(notes).chain(summaries).collect()
    }

    /// Each picture as an object with a member for each fact.
    fn as_json(&self, times: &[(&'static str, f64)]) -> Vec<Value> {
        let inferred = self.scene.inferred_notes();
        let notes: Vec<&String> = self.scene.notes.iter().chain(&inferred).collect();
        let seconds: Map<String, Value> =
            times.iter().map(|&(step, time)| (step.into(), time.into())).collect();
        let object = |picture: &RenderedPicture| {
            let RenderedPicture { path, camera, triangles, annotations, statistics, .. } = picture;
            let lightness = statistics.and_then(|statistics| statistics.ground_lightness);
            let AnnotationReport { hidden, outside, crowded_out, shortened, symbols, .. } = annotations;
            json!({
                "picture": path.display().to_string(),
                "camera": camera,
                "phase": self.scene.phase,
                "filled_fraction": statistics.map(|statistics| statistics.filled),
                "ground_fraction": statistics.map(|statistics| statistics.ground),
                "ground_lightness": lightness.map(|Lightness { mean, sd, p2, p98 }| {
                    json!({"mean": mean, "sd": sd, "p2": p2, "p98": p98})
                }),
                "triangles": triangles,
                "labels": {
                    "hidden": hidden, "outside": outside, "without_room": crowded_out, "shortened": shortened
                },
                "symbols": {
                    "placed": symbols.placed, "hidden": symbols.hidden, "outside": symbols.outside,
                    "without_room": symbols.crowded_out
                },
                "notes": notes,
                "seconds": seconds,
            })
        };
        self.pictures.iter().map(object).collect()
    }
}

impl RenderedPicture {
    /// The camera, and the labels that were not placed or were shortened, in lines.
    fn summary(&self) -> Vec<String> {
        let all: usize = self.triangles.values().sum();
        let ground = self.ground_triangles;
        let camera = format!("{}: {all} triangles, {ground} of them ground", self.camera);
        let AnnotationReport { hidden, outside, crowded_out, shortened, .. } = &self.annotations;
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
        std::iter::once(row(9, "camera", camera)).chain(labels).chain(self.symbols()).collect()
    }
}

impl RenderedPicture {
    /// The military symbols that are not drawn, or not where they can be seen, in lines.
    fn symbols(&self) -> impl Iterator<Item = String> {
        let SymbolReport { hidden, outside, crowded_out, .. } = &self.annotations.symbols;
        let reasons = [
            ("over hidden places (dashed staffs)", hidden),
            ("outside the picture", outside),
            ("without room", crowded_out),
        ];
        reasons.into_iter().filter(|(_, symbols)| !symbols.is_empty()).map(|(why, symbols)| {
            let names: Vec<String> = symbols.iter().map(|name| shortened_label(name)).collect();
            row(9, "symbols", format!("{why}: {}", names.join(", ")))
        })
    }
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
