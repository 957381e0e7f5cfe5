//! `sandtable check`: load and validate, draw nothing.

use crate::app::arguments::CheckOptions;
use crate::app::failure::CliError;
use crate::app::progress::StepTimer;
use crate::app::{load, output};
use crate::scene::views::whole_meters;
use crate::scene::{FeatureKind, Scene};

/// Loads the scene and prints what is in it.
///
/// # Errors
/// Whatever is wrong with the scene.
pub fn run(options: &CheckOptions) -> Result<(), CliError> {
    let steps = StepTimer::default();
    let scene = load::scene(&options.scene, &options.access, &|step| steps.begin(step))?;
    steps.finish();
    let mut lines = vec![format!("{} is sound", options.scene.display())];
    lines.extend(contents(&scene));
    output::print(&output::text_of(&lines))
}

/// What a scene holds, and what there is to say about it, in lines.
pub fn contents(scene: &Scene) -> Vec<String> {
    let lattice = &scene.terrain.lattice;
    let (low, high) = scene.terrain.height_range();
    let size = lattice.extent().size() / 1000.0;
    let ground = format!(
        "  ground    {}×{} posts, {:.2}×{:.2} km, {} to {} m, {}",
        lattice.columns(),
        lattice.rows(),
        size.x,
        size.y,
        whole_meters(low),
        whole_meters(high),
        scene.crs.name()
    );
    let mut parts: Vec<String> = scene.census().into_iter().map(count_of).collect();
    let labels = scene.labels.len();
    parts.push(format!("{labels} label{}", if labels == 1 { "" } else { "s" }));
    let cameras: Vec<&str> = scene.cameras.iter().map(|view| view.name.as_str()).collect();
    let mut lines = vec![
        ground,
        format!("  features  {}", parts.join(", ")),
        format!("  cameras   {}", cameras.join(", ")),
    ];
    lines.extend(scene.notes.iter().take(MOST_NOTES).map(|note| format!("  note      {note}")));
    if let Some(more) = scene.notes.len().checked_sub(MOST_NOTES).filter(|&more| more > 0) {
        lines.push(format!("  note      … and {more} more; `sandtable report` prints all"));
    }
    lines
}

/// As many as fit on a screen beside the rest.
const MOST_NOTES: usize = 20;

fn count_of((kind, count): (FeatureKind, usize)) -> String {
    format!("{count} {}", kind.noun(count))
}
