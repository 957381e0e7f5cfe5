//! Labels that the picture of the first camera does not show, or not as they are stated.
//!
//! Only placing them tells, so they are placed, on a picture of which only is known what hides their places.

use std::collections::{BTreeMap, BTreeSet};

use crate::context::LintContext;
use crate::label_sight::{LabelSight, label_sight};
use crate::sink::FindingSink;
use sandtable_annotate::paint::compose_sheet;
use sandtable_annotate::report::AnnotationReport;
use sandtable_base::message::suggest::quoted;
use sandtable_description::finding_code::FindingCode;
use sandtable_draw::list::FeatureId;
use sandtable_picture::nested_ground::NestedHeights;
use sandtable_scene::scene_model::SceneModel;
use sandtable_scene::scene_view::{SceneView, ViewAim};
use sandtable_sheet::labels::{AnnotatedGround, annotations};
use sandtable_sheet::picture::{PictureSize, framed_camera};

/// The most texts that a message quotes.
const MOST_QUOTED: usize = 3;

/// The most characters of a text that a message quotes.
const MOST_CHARACTERS: usize = 40;

/// Finds labels that are not drawn, and those that cannot be read, on the picture of the first camera.
pub fn check(context: &LintContext<'_>, sink: &mut FindingSink) {
    let scene = context.scene;
    let is_picture = |view: &&SceneView| !matches!(view.aim, ViewAim::Panorama(_));
    // A panorama leaves out what is not in sight: that is no mistake of the scene.
    let first = scene.cameras.first().filter(is_picture);
    let Some(view) = first.filter(|_| !context.document.labels.is_empty()) else { return };
    // A camera without a picture is another finding.
    let Some((report, standing_before)) = placed(scene, view) else { return };
    let dropped = DroppedLabels { context, view };
    let is_covered = |text: &&String| standing_before.contains_key(*text);
    let (covered, hidden): (Vec<&String>, Vec<&String>) = report.hidden.iter().partition(is_covered);
    dropped.report(&covered, &|texts| by_standing(context, &standing_before, texts), sink);
    for (texts, why) in [
        (hidden, "the ground hides their places"),
        (report.outside.iter().collect(), "their places are outside the picture, or too close to its border"),
        (behind(scene, &report), "their places are behind the eye"),
        (
            report.crowded_out.iter().collect(),
            "no position near their places is free beside more important ones",
        ),
    ] {
        dropped.report(&texts, &|_| why.to_owned(), sink);
    }
    let missing = report.missing_glyphs.iter().map(|missing| missing.text.as_str());
    for (texts, why, help) in [
        (
            by_table(scene, report.shortened.iter().map(String::as_str)),
            "cut short with an ellipsis: too long for the picture",
            "say it in fewer words",
        ),
        (
            by_table(scene, missing),
            "drawn with boxes in place of letters that no font of the scene has",
            "state a `font` that has them",
        ),
    ] {
        for ((start, end), texts) in texts {
            let message = format!("on the picture of camera '{}' {} {why}", view.name, are(&texts));
            sink.add(context.finding(FindingCode::LabelIllegible, start..end, message).with_help(help));
        }
    }
}

/// Labels that a view does not show.
struct DroppedLabels<'a> {
    context: &'a LintContext<'a>,
    view: &'a SceneView,
}

impl DroppedLabels<'_> {
    /// Adds the findings about labels with these texts, one a table; `why` says why those of a table are not shown.
    fn report(&self, texts: &[&String], why: &dyn Fn(&[&str]) -> String, sink: &mut FindingSink) {
        let scene = self.context.scene;
        for ((start, end), dropped) in by_table(scene, texts.iter().map(|text| text.as_str())) {
            let span = start..end;
            let count = scene.labels.iter().filter(|label| label.stated == span).count();
            let message = format!(
                "camera '{}' shows {} of the {count} labels of this table not, {}: {}",
                self.view.name,
                dropped.len(),
                listed(&dropped),
                why(&dropped)
            );
            sink.add(self.context.finding(FindingCode::LabelDropped, span, message));
        }
    }
}

/// What stands before the places of labels with these texts.
fn by_standing(
    context: &LintContext<'_>,
    standing_before: &BTreeMap<String, FeatureId>,
    texts: &[&str],
) -> String {
    let standing: BTreeSet<FeatureId> =
        texts.iter().filter_map(|text| standing_before.get(*text)).copied().collect();
    let hide = if standing.len() == 1 { "hides" } else { "hide" };
    let mut names: Vec<String> =
        standing.iter().take(MOST_QUOTED).map(|&feature| context.name(feature)).collect();
    if let Some(more @ 1..) = standing.len().checked_sub(MOST_QUOTED) {
        names.push(format!("{more} more"));
    }
    format!("{} {hide} their places", names.join(", "))
}

/// What becomes of the labels of a view, and what hides them; `None` where it has no picture.
fn placed(scene: &SceneModel, view: &SceneView) -> Option<(AnnotationReport, BTreeMap<String, FeatureId>)> {
    let (camera, frame) = framed_camera(scene, view, PictureSize::of(scene, view)).ok()?;
    let LabelSight { picture, behind } = label_sight(scene, &camera);
    let shown = AnnotatedGround { graphics: &[], nested: &NestedHeights::default(), list: None };
    let annotations = annotations(scene, &camera, &picture, frame.as_ref(), &shown);
    let report = compose_sheet(picture.pixels, &annotations).1;
    Some((report, behind))
}

/// The labels of which nothing becomes, since their places have no place on the picture.
fn behind<'a>(scene: &'a SceneModel, report: &AnnotationReport) -> Vec<&'a String> {
    let known = [&report.placed, &report.hidden, &report.outside, &report.crowded_out];
    let known: BTreeSet<&String> = known.into_iter().flatten().collect();
    let texts = scene.labels.iter().map(|label| &label.text);
    texts.filter(|text| !known.contains(text) && !text.trim().is_empty()).collect()
}

/// Texts by the place of the table that states them, in the order of the file; spot heights are stated by none.
fn by_table<'a>(
    scene: &SceneModel,
    texts: impl Iterator<Item = &'a str>,
) -> BTreeMap<(usize, usize), Vec<&'a str>> {
    let mut tables: BTreeMap<(usize, usize), Vec<&str>> = BTreeMap::new();
    for text in texts {
        let label = scene.labels.iter().find(|label| label.text == text && label.stated != (0..0));
        if let Some(label) = label {
            tables.entry((label.stated.start, label.stated.end)).or_default().push(text);
        }
    }
    tables
}

fn listed(texts: &[&str]) -> String {
    let short =
        |text: &&str| format!("'{}'", quoted(&text.chars().take(MOST_CHARACTERS).collect::<String>()));
    let mut list: Vec<String> = texts.iter().take(MOST_QUOTED).map(short).collect();
    if let Some(more @ 1..) = texts.len().checked_sub(MOST_QUOTED) {
        list.push(format!("and {more} more"));
    }
    list.join(", ")
}

fn are(texts: &[&str]) -> String {
    format!("{} {}", listed(texts), if texts.len() == 1 { "is" } else { "are" })
}
