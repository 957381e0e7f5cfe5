//! `sandtable render`: a scene file to an annotated picture or sheet.

use std::mem;
use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::{Map, Value, json};

use crate::check::{contents, counted_findings};
use crate::error::CliError;
use crate::options::AccessArguments;
use crate::output::{print, print_summary, row, warn};
use crate::progress::{Series, StepTimer};
use crate::render_series::{RenderFailure, RenderedFile, RenderedPicture, RenderedScene, render};
use crate::threads;
use crate::values::{choice, picture_size};
use sandtable_annotate::report::{AnnotationReport, LabelMove, SymbolReport};
use sandtable_base::message::numbers::counted;
use sandtable_base::message::suggest::{nearest, quoted};
use sandtable_description::finding::{Finding, Severity};
use sandtable_files::disk::{self, WriteFileCause, WriteFileError};
use sandtable_render::OtherRenderer;
use sandtable_render::backend_name::BackendName;
use sandtable_scene::scene_model::SceneModel;
use sandtable_scene::scene_view::SceneView;
use sandtable_sheet::picture::PictureSize;
use sandtable_sheet::picture_statistics::Lightness;

/// The longest text of a label in the summary, in characters.
const LONGEST_LABEL: usize = 60;

#[derive(Debug, Args)]
pub struct RenderArguments {
    /// The scene files; with several, a bad one does not keep the others from being rendered
    #[arg(required = true, value_name = "SCENE")]
    pub scenes: Vec<PathBuf>,
    #[command(flatten)]
    pub access: AccessArguments,
    /// Write to this .png, .pdf or .svg file; several scenes to this folder [default: the scene's name]
    #[arg(short, long, value_name = "OUT")]
    pub output: Option<PathBuf>,
    /// Size of the picture in pixels [default: the camera's paper, 1920x1080, or in plan the shape of the ground]
    #[arg(long, value_name = "WxH", value_parser = picture_size)]
    pub size: Option<PictureSize>,
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
    /// The renderer: the processor, the same on every machine, or a graphics adapter
    #[arg(long, default_value = "cpu", value_parser = choice::<BackendName>())]
    pub backend: BackendName,
    /// How many threads to use [default: one per core]; the picture is the same for any number
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
    /// Write one sheet of small pictures, one for each camera, or for each phase with --all-phases
    #[arg(long, conflicts_with_all = ["buffers", "json", "sidecar"])]
    pub sheet: bool,
    /// Also write what each pixel shows into this folder: depth.tif, elevation.tif, normal.png, feature.tif, features.csv
    #[arg(long, value_name = "DIR")]
    pub buffers: Option<PathBuf>,
    /// Also describe the picture in OUT.json beside it: camera, hash and files of the scene, boxes of labels and features
    #[arg(long)]
    pub sidecar: bool,
    /// Print JSON: what the picture shows, how light its ground is, triangles, labels, notes and the time of each step
    #[arg(long)]
    pub json: bool,
}

impl RenderArguments {
    /// Renders one scene by its first camera, with everything else as it is by default.
    pub fn of_scene(scene: &Path, picture: &Path) -> Self {
        Self {
            scenes: vec![scene.to_owned()],
            access: AccessArguments { allow: Vec::new() },
            output: Some(picture.to_owned()),
            size: None,
            camera: None,
            all_cameras: false,
            phase: None,
            all_phases: false,
            backend: BackendName::Cpu,
            threads: None,
            sheet: false,
            buffers: None,
            sidecar: false,
            json: false,
        }
    }

    /// Whether every camera has a picture: on a sheet, unless it is one of phases.
    pub fn shows_all_cameras(&self) -> bool {
        self.all_cameras || (self.sheet && !self.all_phases && self.camera.is_none())
    }
}

/// Renders with `threads` threads.
pub fn run(arguments: &RenderArguments, threads: usize, gpu: Option<OtherRenderer>) -> Result<(), CliError> {
    let pool = threads::pool(threads)?;
    let backend = arguments.backend.renderer(gpu);
    let outputs = outputs(arguments)?;
    let is_batch = outputs.len() > 1;
    let (mut failures, mut values) = (Vec::new(), Vec::new());
    let is_series = is_batch || arguments.all_cameras || arguments.all_phases || arguments.sheet;
    let series = is_series.then(|| Series::begin("pictures"));
    for (number, (file, path)) in outputs.iter().enumerate() {
        let steps = series.as_ref().map_or_else(StepTimer::default, StepTimer::of_series);
        if let Some(series) = &series {
            let share = |files: usize| files as f64 / outputs.len() as f64;
            series.flag.part(share(number)..share(number + 1));
        }
        match pool.install(|| render(arguments, backend, file, path, &steps)) {
            Ok(RenderedFile { scenes, failures: missing }) => {
                let times = steps.finish();
                match arguments.json {
                    true => values.extend(scenes.iter().flat_map(|scene| scene.as_json(&times))),
                    false => print_summary(&summary(arguments, path, &scenes, &times))?,
                }
                failures.extend(missing);
                if number + 1 == outputs.len() {
                    // The process ends: the system takes all of its memory back at once.
                    mem::forget(scenes);
                }
            }
            Err(error) if is_batch => {
                failures.push(RenderFailure { name: file.display().to_string(), error });
            }
            Err(error) => return Err(error),
        }
    }
    if arguments.json {
        match &values[..] {
            [one] if !arguments.all_cameras && !arguments.all_phases && !is_batch => {
                print(&format!("{one:#}\n"))?
            }
            _ => print(&format!("{:#}\n", Value::from(values)))?,
        }
    }
    report(&failures)
}

/// The scene files, each with the file of its picture.
fn outputs(arguments: &RenderArguments) -> Result<Vec<(&Path, PathBuf)>, CliError> {
    if let [scene] = &arguments.scenes[..] {
        let path = arguments.output.clone().unwrap_or_else(|| default_output(scene));
        return Ok(vec![(scene, path)]);
    }
    let folder = arguments.output.as_deref().unwrap_or(Path::new(""));
    if folder.is_file() {
        return Err(CliError::usage(format!(
            "{} is a file; the pictures of several scenes are written to a folder",
            folder.display()
        )));
    }
    if arguments.output.is_some() {
        disk::make_folder(folder)?;
    }
    let mut outputs: Vec<(&Path, PathBuf)> = Vec::new();
    for scene in &arguments.scenes {
        let path = folder.join(default_output(scene));
        if let Some((other, _)) = outputs.iter().find(|(_, taken)| *taken == path) {
            return Err(CliError::usage(format!(
                "the pictures of {} and {} would both be {}; render them one by one, each with -o",
                other.display(),
                scene.display(),
                path.display()
            )));
        }
        outputs.push((scene, path));
    }
    Ok(outputs)
}

/// The lines about the pictures of a scene file; prints its errors, and warns of letters that its font lacks.
fn summary(
    arguments: &RenderArguments,
    path: &Path,
    scenes: &[RenderedScene],
    times: &[(&'static str, f64)],
) -> Vec<String> {
    let mut errors: Vec<String> =
        scenes.iter().flat_map(RenderedScene::errors).map(ToString::to_string).collect();
    // Phases of one scene have most of them in common.
    errors.dedup();
    errors.iter().for_each(|error| warn(error));
    for missing in scenes
        .iter()
        .flat_map(|scene| &scene.pictures)
        .flat_map(|picture| &picture.annotations.missing_glyphs)
    {
        warn(&format!(
            "warning: the font lacks {} of '{}'",
            counted(missing.count, "character", "characters"),
            missing.text
        ));
    }
    let mut lines: Vec<String> = arguments.sheet.then(|| path.display().to_string()).into_iter().collect();
    lines.extend(scenes.iter().flat_map(RenderedScene::lines));
    let times: Vec<String> = times.iter().map(|(step, seconds)| format!("{step} {seconds:.2} s")).collect();
    lines.push(row(9, "time", times.join(", ")));
    lines
}

/// Says what was not rendered, where anything was not.
fn report(failures: &[RenderFailure]) -> Result<(), CliError> {
    if failures.is_empty() {
        return Ok(());
    }
    for failure in failures {
        let _ = failure.error.report();
    }
    let names: Vec<&str> = failures.iter().map(|failure| failure.name.as_str()).collect();
    Err(CliError::input(format!("not rendered: {}; the rest is written", names.join(", "))))
}

/// The error with `reason` and the option to change, where the picture would replace an input.
pub fn named_by_option(error: WriteFileError, reason: &str) -> CliError {
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
        let paths =
            self.pictures.iter().filter_map(|picture| picture.path()).map(|path| path.display().to_string());
        let notes = self.scene.inferred_notes();
        let notes = notes.iter().map(|note| row(9, "note", note));
        let summaries = self.pictures.iter().flat_map(RenderedPicture::summary);
        let warnings = self.warnings();
        let warnings = (warnings > 0).then(|| {
            row(
                9,
                "findings",
                format!(
                    "{} while building; `sandtable check` shows them, and looks for more",
                    counted_findings(warnings, Severity::Warning)
                ),
            )
        });
        paths.chain(contents(&self.scene)).chain(notes).chain(warnings).chain(summaries).collect()
    }

    /// What makes the pictures wrong.
    fn errors(&self) -> impl Iterator<Item = &Finding> {
        self.scene.findings.iter().filter(|finding| finding.severity() == Severity::Error)
    }

    /// How many warnings building the scene gave.
    fn warnings(&self) -> usize {
        self.scene.findings.iter().filter(|finding| finding.severity() == Severity::Warning).count()
    }

    /// Each picture as an object with a member for each fact.
    fn as_json(&self, times: &[(&'static str, f64)]) -> Vec<Value> {
        let inferred = self.scene.inferred_notes();
        let notes: Vec<&str> =
            self.scene.notes().into_iter().chain(inferred.iter().map(String::as_str)).collect();
        let seconds: Map<String, Value> =
            times.iter().map(|&(step, time)| (step.into(), time.into())).collect();
        let object = |picture: &RenderedPicture| {
            let RenderedPicture { camera, triangles, annotations, statistics, .. } = picture;
            let lightness = statistics.and_then(|statistics| statistics.ground_lightness);
            let AnnotationReport { hidden, outside, crowded_out, shortened, symbols, .. } = annotations;
            let [led, off_line] = moved(annotations);
            json!({
                "picture": picture.path().map(|path| path.display().to_string()),
                "camera": camera,
                "phase": self.scene.phase,
                "filled_fraction": statistics.map(|statistics| statistics.filled),
                "ground_fraction": statistics.map(|statistics| statistics.ground),
                "ground_lightness": lightness.map(|Lightness { mean, sd, p2, p98 }| {
                    json!({"mean": mean, "sd": sd, "p2": p2, "p98": p98})
                }),
                "triangles": triangles,
                "labels": {
                    "hidden": hidden, "outside": outside, "without_room": crowded_out, "shortened": shortened,
                    "led": led, "off_line": off_line
                },
                "symbols": {
                    "placed": symbols.placed, "hidden": symbols.hidden, "outside": symbols.outside,
                    "without_room": symbols.crowded_out, "without_text": symbols.without_text,
                    "reduced": symbols.reduced, "listed": symbols.listed, "counted": symbols.counted
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
        let [led, off_line] = moved(&self.annotations);
        let labels = [
            ("hidden", hidden),
            ("outside the picture", outside),
            ("without room", crowded_out),
            ("led by a line", &led),
            ("at a place, not along their line", &off_line),
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
        let SymbolReport { hidden, without_text, outside, reduced, listed, counted, crowded_out, .. } =
            &self.annotations.symbols;
        let reasons = [
            ("over hidden places (dashed staffs)", hidden),
            ("without their text", without_text),
            ("smaller, for want of room", reduced),
            ("as numbers of a list, for want of room", listed),
            ("counted at their place, for want of room", counted),
            ("outside the picture", outside),
            ("without room", crowded_out),
        ];
        reasons.into_iter().filter(|(_, symbols)| !symbols.is_empty()).map(|(why, symbols)| {
            let names: Vec<String> = symbols.iter().map(|name| shortened_label(name)).collect();
            row(9, "symbols", format!("{why}: {}", names.join(", ")))
        })
    }
}

/// The labels drawn at the end of a leader line for want of room, and those not drawn along their line.
fn moved(report: &AnnotationReport) -> [Vec<String>; 2] {
    [LabelMove::Led, LabelMove::OffLine].map(|to| {
        report.moved.iter().filter(|moved| moved.to == to).map(|moved| moved.text.clone()).collect()
    })
}

/// A label on one line, cut where it is long.
fn shortened_label(label: &str) -> String {
    let line = label.replace('\n', " ");
    match line.char_indices().nth(LONGEST_LABEL) {
        Some((end, _)) => format!("{}…", &line[..end]),
        None => line,
    }
}
