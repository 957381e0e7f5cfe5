//! Models that float, and models that are buried: the gap between each corner of the foot and the ground under it.

use crate::context::LintContext;
use crate::models::standing::StandingModel;
use crate::sink::FindingSink;
use crate::worst::WorstOfTables;
use sandtable_description::finding_code::FindingCode;
use sandtable_description::words::{Clamp, Footing};
use sandtable_terrain::triangle_surface::TriangleSurface;

/// A corner that floats higher shows a gap under the model, meters: a step.
const FLOATS_M: f64 = 0.5;

/// And higher than this share of the model's height: a crack under a tower is not seen.
const FLOATS_SHARE: f64 = 0.05;

/// A corner in the ground deeper than this share of the model's height hides doors and windows.
const BURIED_SHARE: f64 = 1.0 / 3.0;

/// And deeper than this, meters: low models such as slabs are meant to be in the ground.
const BURIED_M: f64 = 0.5;

/// The corners of a foot, in the order of gaps.
const CORNERS: [&str; 4] = ["front left", "front right", "back right", "back left"];

/// Finds floating and buried models among `standing`.
pub fn check(context: &LintContext<'_>, standing: &[StandingModel<'_>], sink: &mut FindingSink) {
    let scene = context.scene;
    let finest = scene.scale.ground(&scene.lattice);
    let [mut floating, mut buried] = std::array::from_fn(|_| WorstOfTables::default());
    for model in standing {
        let z = |corner: usize| {
            let at = model.base[corner];
            Some(f64::from(at.z) - finest.displayed_z(at.truncate().as_dvec2())?)
        };
        let [Some(a), Some(b), Some(c), Some(d)] = [0, 1, 2, 3].map(z) else { continue };
        let gaps = [a, b, c, d];
        let (lowest, highest) = (gaps.into_iter().fold(a, f64::min), gaps.into_iter().fold(a, f64::max));
        let (span, height_m) = (context.origin(model.placement.feature), f64::from(model.size_m().z));
        let what = |verb: &str, most_m: f64| {
            let name = context.name(model.placement.feature);
            format!("{name} {verb} by up to {most_m:.2} m at {}: {}", model.place(scene), corners(gaps))
        };
        if highest > FLOATS_M.max(FLOATS_SHARE * height_m)
            && is_on_ground(model)
            && model.placement.standing.footing == Footing::None
        {
            floating.add(span, highest, || what("floats", highest));
        } else if -lowest > deepest_m(model, height_m) {
            buried.add(span, -lowest, || what(&format!("is {height_m:.1} m high and buried"), -lowest));
        }
    }
    let help = "say `anchor = \"lowest\"`, or give it a `footing`: \"plinth\" fills the gap, \"pad\" levels the ground";
    floating.report(context, FindingCode::ModelFloats, help, sink);
    let help = "say `anchor = \"highest\"` with `footing = \"plinth\"`, or `footing = \"pad\"`, or place it where the ground is \
                more level";
    buried.report(context, FindingCode::ModelBuried, help, sink);
}

/// Whether nothing is stated that would lift it off the ground.
fn is_on_ground(model: &StandingModel<'_>) -> bool {
    match model.placement.clamp {
        Clamp::Ground => true,
        Clamp::Relative => model.placement.height == 0.0,
        Clamp::Absolute => false,
    }
}

/// How deep a corner may be in the ground, in meters. What states its height or its depth means it, unless all of the model
/// is in the ground: a bridge stands on its banks.
fn deepest_m(model: &StandingModel<'_>, height_m: f64) -> f64 {
    let is_stated = !is_on_ground(model) || model.placement.standing.sink_m > 0.0;
    if is_stated { height_m } else { BURIED_M.max(BURIED_SHARE * height_m) }
}

fn corners(gaps: [f64; 4]) -> String {
    let each: Vec<String> =
        CORNERS.iter().zip(gaps).map(|(corner, gap)| format!("{corner} {gap:+.2} m")).collect();
    each.join(", ")
}
