//! Overlays of a new scene: files of units and graphics, and the moments at which they differ, as phases.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::Path;

use serde_json::Value;

use crate::folder::SceneFolder;
use crate::survey::{SurveyError, read_whole};
use crate::text::quoted;
use crate::{FolderError, NewSceneError};
use sandtable_vector::feature::VectorLayer;
use sandtable_vector::moment::Moment;
use sandtable_vector::overlay_schema as schema;

/// More phases are not told apart on a sheet.
const MOST_PHASES: usize = 6;

/// An overlay as the scene file has it.
pub(super) struct OverlayDraft {
    /// The file as the scene file names it.
    pub file: String,
    /// What it holds, in words.
    pub holds: String,
    /// The moments at which something of it changes, with how much.
    pub changes: BTreeMap<Moment, usize>,
}

/// Surveys an overlay.
///
/// # Errors
/// The file cannot be read.
pub(super) fn survey(file: &Path, folder: &SceneFolder) -> Result<OverlayDraft, NewSceneError> {
    let name = folder.name_of(file).map_err(|error: FolderError| NewSceneError::from(error))?;
    let layer = read_whole(file).map_err(|error: SurveyError| NewSceneError::from(error))?;
    Ok(OverlayDraft { file: name, holds: holds(&layer), changes: changes(&layer) })
}

fn holds(layer: &VectorLayer) -> String {
    let has_code =
        |key: &&str, properties: &sandtable_vector::feature::Properties| properties.contains_key(*key);
    let with_code = layer
        .features
        .iter()
        .filter(|feature| schema::SIDC_SPELLINGS.iter().any(|key| has_code(key, &feature.properties)))
        .count();
    let others = layer.features.len() - with_code;
    match (with_code, others) {
        (coded, 0) => format!("{coded} with a symbol code"),
        (coded, others) => format!("{coded} with a symbol code, {others} without"),
    }
}

fn changes(layer: &VectorLayer) -> BTreeMap<Moment, usize> {
    let mut changes = BTreeMap::new();
    for feature in &layer.features {
        let begin = feature.properties.get(schema::BEGIN).and_then(Value::as_str).and_then(Moment::parse);
        begin.into_iter().for_each(|begin| *changes.entry(begin).or_insert(0) += 1);
    }
    changes
}

/// The moments of the phases: of those at which most changes, in order of time; none where nothing changes twice.
pub(super) fn phases(overlays: &[OverlayDraft]) -> Vec<Moment> {
    let mut all: BTreeMap<Moment, usize> = BTreeMap::new();
    for (moment, count) in overlays.iter().flat_map(|overlay| &overlay.changes) {
        *all.entry(*moment).or_insert(0) += count;
    }
    if all.len() < 2 {
        return Vec::new();
    }
    let last = all.last_key_value().map(|(moment, _)| *moment);
    let mut by_count: Vec<(Moment, usize)> = all.into_iter().collect();
    by_count.sort_by(|a, b| b.1.cmp(&a.1).then(a.0.cmp(&b.0)));
    let mut chosen: Vec<Moment> = by_count.iter().take(MOST_PHASES).map(|(moment, _)| *moment).collect();
    // The end of the story is told.
    if let Some(last) = last.filter(|last| !chosen.contains(last)) {
        chosen.pop();
        chosen.push(last);
    }
    chosen.sort();
    chosen
}

/// The phases and the overlays of a scene file.
pub(super) fn text(overlays: &[OverlayDraft]) -> String {
    let mut out = String::new();
    let moments = phases(overlays);
    let day_and_time = |moment: &Moment| moment.to_string().replace('T', " ").replace(":00Z", "Z");
    if !moments.is_empty() {
        out.push_str(
            "\n# The moments at which most changes. `--phase NAME` chooses one; without it the first is drawn.\n",
        );
    }
    for (number, moment) in moments.iter().enumerate() {
        let title = quoted(&day_and_time(moment));
        let _ = writeln!(out, "[[phase]]\nname = \"{}\"\ntitle = {title}\n", number + 1);
    }
    for overlay in overlays {
        let gap = if out.ends_with("\n\n") { "" } else { "\n" };
        let _ = writeln!(out, "{gap}# Units and graphics: {}.", overlay.holds);
        if moments.is_empty() || overlay.changes.is_empty() {
            let _ = writeln!(out, "[[overlay]]\nfile = {}", quoted(&overlay.file));
            continue;
        }
        for (number, moment) in moments.iter().enumerate() {
            let file = quoted(&overlay.file);
            let _ = writeln!(
                out,
                "[[overlay]]\nphases = [\"{}\"]\nfile = {file}\ntime = \"{moment}\"\n",
                number + 1
            );
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn overlay(changes: &[(&str, usize)]) -> OverlayDraft {
        let changes =
            changes.iter().map(|(text, count)| (Moment::parse(text).expect("a moment"), *count)).collect();
        OverlayDraft { file: "a.json".into(), holds: "3 with a symbol code".into(), changes }
    }

    #[test]
    fn phases_are_the_moments_at_which_most_changes_and_the_last() {
        let days: Vec<(String, usize)> =
            (1..=9).map(|day| (format!("1982-05-0{day}"), if day == 9 { 1 } else { day })).collect();
        let days: Vec<(&str, usize)> = days.iter().map(|(day, count)| (day.as_str(), *count)).collect();
        let chosen: Vec<String> =
            phases(&[overlay(&days)]).iter().map(|moment| moment.to_string()[..10].to_owned()).collect();
        assert_eq!(
            chosen,
            ["1982-05-04", "1982-05-05", "1982-05-06", "1982-05-07", "1982-05-08", "1982-05-09"]
        );
        assert!(phases(&[overlay(&[("1982-05-01", 3)])]).is_empty());
    }

    #[test]
    fn an_overlay_without_moments_is_one_table() {
        let text = text(&[overlay(&[])]);
        assert!(text.contains("[[overlay]]\nfile = \"a.json\"\n") && !text.contains("phase"), "{text}");
    }
}
