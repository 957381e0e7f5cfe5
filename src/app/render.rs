//! `sandtable render`: a scene file to an annotated PNG.

use std::path::{Path, PathBuf};

use crate::app::arguments::RenderOptions;
use crate::app::check::contents;
use crate::app::failure::CliError;
use crate::app::picture::{Finished, picture_of, png};
use crate::app::progress::StepTimer;
use crate::app::{files, load, output};
use crate::message::suggest::{nearest, quoted};
use crate::scene::{Scene, View};

/// Renders the scene and prints where the picture is, what is in it, and how long each step took.
///
/// # Errors
/// Whatever is wrong with the scene; `--backend gpu` without its feature or an adapter; the picture cannot be written.
pub fn run(options: &RenderOptions) -> Result<(), CliError> {
    let threads = options.threads.map_or(0, usize::from);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().map_err(CliError::input)?;
    let place = options.output.clone().unwrap_or_else(|| default_output(&options.scene));
    files::check_place(&place, &options.scene)?;
    let steps = StepTimer::default();
    let done = pool.scope(|_| render(options, &place, &steps))?;
    let times = steps.finish();
    let mut lines = vec![format!("{}", place.display())];
    lines.extend(contents(&done.scene));
    lines.extend(picture(&done));
    let times: Vec<String> = times.iter().map(|(step, seconds)| format!("{step} {seconds:.2} s")).collect();
    lines.push(format!("  time      {}", times.join(", ")));
    output::print(&output::text_of(&lines))?;
    for missing in &done.finished.report.missing_glyphs {
        output::warn(&format!("warning: the font lacks {} characters of '{}'", missing.count, missing.text));
    }
    Ok(())
}

/// A rendered scene, written.
struct RenderOutcome {
    scene: Scene,
    view: String,
    finished: Finished,
}

fn render(options: &RenderOptions, place: &Path, steps: &StepTimer) -> Result<RenderOutcome, CliError> {
    let step = |step| steps.begin(step);
    let scene = load::scene(&options.scene, &options.access, &step)?;
    let view = find_view(&scene, options.camera.as_deref())?.clone();
    files::check_no_input(place, &scene.files)?;
    let finished = picture_of(&scene, &view, options.size, options.backend, &step)?;
    step("writing the picture");
    files::write_whole(place, &png(&finished.pixels)?)?;
    Ok(RenderOutcome { scene, view: view.name, finished })
}

fn find_view<'a>(scene: &'a Scene, name: Option<&str>) -> Result<&'a View, CliError> {
    scene.view(name).ok_or_else(|| {
        let names: Vec<&str> = scene.cameras.iter().map(|view| view.name.as_str()).collect();
        let wanted = name.unwrap_or_default();
        let meant = nearest(wanted, names.iter().copied());
        let meant = meant.map(|name| format!("; did you mean '{name}'?")).unwrap_or_default();
        let (wanted, names) = (quoted(wanted), names.join(", "));
        CliError::Usage(format!("the scene has no camera '{wanted}'; it has {names}{meant}"))
    })
}

/// The scene's name with `.png`, in the current folder.
fn default_output(scene: &Path) -> PathBuf {
    PathBuf::from(scene.file_stem().unwrap_or("scene".as_ref())).with_extension("png")
}

/// What the picture shows, and which labels it does not, in lines.
fn picture(done: &RenderOutcome) -> Vec<String> {
    let report = &done.finished.report;
    let (all, ground) = (done.finished.shot.list.triangle_count(), done.finished.shot.ground_triangles);
    let mut lines = vec![format!("  camera    {}: {all} triangles, {ground} of them ground", done.view)];
    let left_out = [
        ("hidden", &report.hidden),
        ("outside the picture", &report.outside),
        ("without room", &report.crowded_out),
        ("shortened", &report.shortened),
    ];
    for (why, labels) in left_out.iter().filter(|(_, labels)| !labels.is_empty()) {
        let names: Vec<String> = labels.iter().map(|label| shortened(label)).collect();
        lines.push(format!("  labels    {why}: {}", names.join(", ")));
    }
    lines
}

/// A label on one line, cut where it is longer than a name.
fn shortened(label: &str) -> String {
    const LONGEST: usize = 60;
    let line = label.replace('\n', " ");
    match line.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{}…", &line[..end]),
        None => line,
    }
}
