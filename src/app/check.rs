//! `sandtable check`: load and validate, draw nothing.

use crate::app::arguments::CheckOptions;
use crate::app::failure::Failure;
use crate::app::load;
use crate::app::progress::Steps;
use crate::scene::kind::{FeatureKind, Scene};

/// Loads the scene, checks its invariants and prints what is in it.
///
/// # Errors
/// Whatever is wrong with the scene.
pub fn run(options: &CheckOptions) -> Result<(), Failure> {
    let steps = Steps::default();
    let scene = load::scene(&options.scene, &options.access, &|step| steps.begin(step))?;
    steps.begin("checking invariants");
    let terrain = &scene.terrain;
    terrain
        .errors
        .check(&terrain.layout)
        .map_err(|flaw| Failure::input(format!("internal check: {flaw}")))?;
    steps.finish();
    println!("{} is sound", options.scene.display());
    print_contents(&scene);
    Ok(())
}

/// Prints what a scene holds, and what there is to say about it.
pub fn print_contents(scene: &Scene) {
    let lattice = &scene.terrain.lattice;
    let (low, high) = lattice.height_range();
    let size = lattice.extent().size() / 1000.0;
    println!(
        "  ground    {}×{} posts, {:.2}×{:.2} km, {low:.0} to {high:.0} m, {}",
        lattice.columns(),
        lattice.rows(),
        size.x,
        size.y,
        scene.crs.name()
    );
    let mut parts: Vec<String> = scene.census().into_iter().map(count_of).collect();
    let labels = scene.labels.len();
    parts.push(format!("{labels} label{}", if labels == 1 { "" } else { "s" }));
    println!("  features  {}", parts.join(", "));
    let cameras: Vec<&str> = scene.cameras.iter().map(|view| view.name.as_str()).collect();
    println!("  cameras   {}", cameras.join(", "));
    for note in &scene.notes {
        println!("  note      {note}");
    }
}

fn count_of((kind, count): (FeatureKind, usize)) -> String {
    format!("{count} {}", kind.noun(count))
}
