//! Checks of a scene: what is wrong with it, or looks wrong, besides the errors that keep it from being built.
//!
//! ```text
//! document, assets, scene ─► LintContext ─► CHECKS, one after the other ─► FindingSink ─► findings by place
//! ```
//!
//! A check is a function in a file of its subject, and a row of `CHECKS`. It computes what no picture needs, so it runs
//! only where a scene is checked; what building finds out anyway is in [`SceneModel::findings`].

mod cameras;
mod coarse_positions;
mod context;
mod definitions;
mod elevation;
mod feet;
mod flights;
mod ground_line;
mod heights;
mod imagery;
mod junctions;
mod label_sight;
mod labels;
mod lakes;
mod line_shapes;
mod models;
pub mod opened;
mod rivers;
mod road_crossings;
mod road_profiles;
pub mod sink;
mod standing;
mod systems;
mod terrain;
mod tolerance;
mod unseen;
mod voids;
mod worst;

use crate::context::LintContext;
use crate::sink::FindingSink;
use sandtable_description::document::Document;
use sandtable_description::finding::Finding;
use sandtable_scene::assets::Assets;
use sandtable_scene::scene_model::SceneModel;
use sandtable_scene::sources::Sources;
use sandtable_scene::world_frame::WorldFrame;

/// A check of one subject.
type LintCheck = fn(&LintContext<'_>, &mut FindingSink);

/// All checks, each with what it is about.
const CHECKS: &[(&str, LintCheck)] = &[
    ("definitions", definitions::check),
    ("coarse positions", coarse_positions::check),
    ("elevation", elevation::check),
    ("feet", feet::check),
    ("heights", heights::check),
    ("imagery", imagery::check),
    ("systems", systems::check),
    ("terrain", terrain::check),
    ("voids", voids::check),
    ("road profiles", road_profiles::check),
    ("road crossings", road_crossings::check),
    ("rivers", rivers::check),
    ("lakes", lakes::check),
    ("line shapes", line_shapes::check),
    ("junctions", junctions::check),
    ("models", models::check),
    ("cameras", cameras::check),
    ("flights", flights::check),
    ("views", unseen::check),
    ("tolerance", tolerance::check),
    ("labels", labels::check),
];

/// The findings about `scene`, which was built of `document` and `assets`, in the order of output: those of building it, and
/// those of every check.
pub fn lint(document: &Document, assets: &Assets, scene: &SceneModel) -> Vec<Finding> {
    let frame = WorldFrame::new(document, &scene.crs, &scene.stated_crs, scene.lattice.map_extent());
    let sources = Sources::new(&frame, assets);
    let context = LintContext { document, scene, sources: &sources };
    let mut sink = FindingSink::default();
    scene.findings.iter().cloned().for_each(|finding| sink.add(finding));
    for (_, check) in CHECKS {
        check(&context, &mut sink);
    }
    sink.into_findings()
}
