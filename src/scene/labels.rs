//! The labels of a document, set on the ground.

use glam::Vec3;

use crate::attributes::Attributes;
use crate::builder::SceneBuilder;
use crate::exact_ground::ExactGround;
use crate::feature_labels;
use crate::label_course::LabelCourse;
use crate::scene_label::{SceneLabel, whole_meters};
use crate::sources::Sources;
use sandtable_description::diagnostic::Diagnostic;
use sandtable_description::document::LabelTable;
use sandtable_description::stated::Stated;
use sandtable_geom::position::Position;

/// The document's labels, `{height}` filled in; those of files with findings on the features without a label. `collected` keeps
/// an error where a label with `at` lies off the ground, or a file cannot be read or holds no feature that matches.
pub(super) fn labels(
    sources: &Sources<'_>,
    exact: &ExactGround<'_>,
    collected: &mut SceneBuilder,
) -> Vec<SceneLabel> {
    let SceneBuilder { findings, errors, .. } = collected;
    let mut labels = Vec::new();
    for table in &sources.frame.document.labels {
        match &table.at {
            Some(at) => labels.extend(errors.keep(label(table, at, exact))),
            None => {
                let named = feature_labels::labels(table, sources, exact, findings);
                labels.extend(errors.keep(named).into_iter().flatten());
            }
        }
    }
    labels
}

fn label(
    table: &LabelTable,
    at: &Stated<Position>,
    exact: &ExactGround<'_>,
) -> Result<SceneLabel, Diagnostic> {
    let (frame, lattice) = (exact.frame, exact.lattice);
    let world = frame.point(at, table.crs.as_ref())?;
    let ground = frame.on_ground(lattice, at, world)?;
    let text = match table.text.contains("{height}") {
        true => table.text.replace("{height}", &whole_meters(exact.elevation_m(world, ground.z)?)),
        false => table.text.to_string(),
    };
    Ok(SceneLabel {
        text,
        stated: table.text.span().unwrap_or_default(),
        ground,
        anchor: ground + Vec3::Z * table.height as f32,
        course: LabelCourse::Place,
        kind: table.kind,
        rank: feature_labels::rank(table, &Attributes::default()),
        size: feature_labels::type_size(table, &Attributes::default()),
        shield: None,
    })
}
