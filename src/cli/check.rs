//! `sandtable check`: load and validate a scene, draw nothing.

use crate::cli::error::CliError;
use crate::cli::options::SceneArguments;
use crate::cli::output::{print_lines, row};
use crate::cli::progress::StepTimer;
use crate::pipeline::scene_file::open_scene;
use crate::scene::SceneModel;
use crate::scene::views::whole_meters;

/// The most notes that are printed: as many as fit on a screen beside the rest.
const MOST_NOTES: usize = 20;

pub fn run(arguments: &SceneArguments) -> Result<(), CliError> {
    let steps = StepTimer::default();
    let scene = open_scene(&arguments.scene, &arguments.access.allow, &|step| steps.begin(step))?;
    steps.finish();
    let mut lines = vec![format!("{} is sound", arguments.scene.display())];
    lines.extend(contents(&scene));
    print_lines(&lines)
}

/// The contents of a scene and its notes, in lines.
pub fn contents(scene: &SceneModel) -> Vec<String> {
    let lattice = &scene.lattice;
    let (low, high) = scene.height_range_m;
    let size = lattice.extent().size() / 1000.0;
    let ground = format!(
        "{}×{} posts, {:.2}×{:.2} km, {} to {} m, {}",
        lattice.columns(),
        lattice.rows(),
        size.x,
        size.y,
        whole_meters(low),
        whole_meters(high),
        scene.crs.name()
    );
    let census = scene.census().into_iter().map(|(kind, count)| format!("{count} {}", kind.noun(count)));
    let labels = scene.labels.len();
    let labels = format!("{labels} label{}", if labels == 1 { "" } else { "s" });
    let cameras: Vec<&str> = scene.cameras.iter().map(|view| view.name.as_str()).collect();
    let mut lines = vec![
        row(9, "ground", ground),
        row(9, "features", census.chain([labels]).collect::<Vec<_>>().join(", ")),
        row(9, "cameras", cameras.join(", ")),
    ];
    lines.extend(scene.notes.iter().take(MOST_NOTES).map(|note| row(9, "note", note)));
    if let Some(more @ 1..) = scene.notes.len().checked_sub(MOST_NOTES) {
        lines.push(row(9, "note", format!("… and {more} more; `sandtable report` prints all")));
    }
    lines
}
