//! Checks of a scene: what is wrong with it, or looks wrong, besides the errors that keep it from being built.
//!
//! ```text
//! document, assets, scene ─► LintContext ─► CHECKS, one after the other ─► FindingSink ─► findings by place
//! ```
//!
//! A check is a function in a file of its subject, and a row of [`CHECKS`]. It computes what no picture needs, so it runs
//! only where a scene is checked; what building finds out anyway is in [`SceneModel::findings`].

pub mod cause_code;
mod context;
mod definitions;
pub mod sink;

use crate::description::document::Document;
use crate::description::finding::Finding;
use crate::pipeline::lint::context::LintContext;
use crate::pipeline::lint::sink::FindingSink;
use crate::scene::SceneModel;
use crate::scene::assets::Assets;

/// A check of one subject.
type LintCheck = fn(&LintContext<'_>, &mut FindingSink);

/// All checks, each with what it is about.
const CHECKS: &[(&str, LintCheck)] = &[("definitions", definitions::check)];

/// The findings about `scene`, which was built of `document` and `assets`, in the order of output: those of building it, and
/// those of every check.
pub fn lint(document: &Document, assets: &Assets, scene: &SceneModel) -> Vec<Finding> {
    let context = LintContext { document, assets, scene };
    let mut sink = FindingSink::default();
    scene.findings.iter().cloned().for_each(|finding| sink.add(finding));
    for (_, check) in CHECKS {
        check(&context, &mut sink);
    }
    sink.into_findings()
}
