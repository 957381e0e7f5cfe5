//! Letters before the numbers of marks, where several analyses of a scene number theirs alike: on one picture and in the tables
//! beside it `A1` is one place and `B1` another.
//!
//! ```text
//!  Best posts   1 2 3 4        A1 A2 A3 A4
//!  Patrol       1 2        ─►  B1 B2
//!  Landing      LZ 1           LZ 1          no other analysis has it
//! ```

use std::collections::{BTreeMap, BTreeSet};

use crate::analyses::SceneAnalysis;
use sandtable_analysis::outcome::{FeatureRole, Outcome, OutcomeFeature, PropertyValue};

/// Puts letters before the numbers of the marks of analyses that share some of their names: in the order of the analyses, of
/// features, tables, figures and classes alike.
pub(super) fn add_letters(analyses: &mut [SceneAnalysis]) {
    let mut owners: BTreeMap<String, usize> = BTreeMap::new();
    let names: Vec<BTreeSet<String>> = analyses.iter().map(mark_names).collect();
    for name in names.iter().flatten() {
        *owners.entry(name.clone()).or_default() += 1;
    }
    let share = |names: &BTreeSet<String>| names.iter().any(|name| owners[name] > 1);
    let sharing = analyses.iter_mut().zip(&names).filter(|(_, names)| share(names));
    for (index, (analysis, names)) in sharing.enumerate() {
        letter_marks(&mut analysis.outcome, names, &letters(index));
    }
}

/// The names of the numbered marks that pictures show of an analysis.
fn mark_names(analysis: &SceneAnalysis) -> BTreeSet<String> {
    let marks = analysis.shown_features().iter().filter(|feature| is_mark(feature));
    marks.map(|feature| feature.name.clone()).collect()
}

fn is_mark(feature: &OutcomeFeature) -> bool {
    matches!(feature.role, FeatureRole::Post | FeatureRole::Site | FeatureRole::Corridor)
        && feature.name.ends_with(|end: char| end.is_ascii_digit())
}

fn letter_marks(outcome: &mut Outcome, names: &BTreeSet<String>, letters: &str) {
    for feature in outcome.features.iter_mut().filter(|feature| is_mark(feature)) {
        feature.name = lettered(&feature.name, letters);
    }
    let mut nouns = BTreeSet::new();
    for table in &mut outcome.tables {
        for (index, column) in table.columns.iter().enumerate().filter(|(_, column)| column.is_of_marks) {
            nouns.insert(column.name);
            for cell in table.rows.iter_mut().filter_map(|row| row.get_mut(index)) {
                let text = cell.written(0);
                if names.contains(&text) {
                    *cell = PropertyValue::Text(lettered(&text, letters));
                }
            }
        }
    }
    // `seen from post 1`, and a class `post 1`.
    let is_of_mark = |text: &str| {
        let Some((before, number)) = text.rsplit_once(' ') else { return false };
        names.contains(number) && nouns.iter().any(|noun| before.ends_with(noun))
    };
    let figures = outcome.figures.iter_mut().map(|figure| &mut figure.name);
    let classes =
        outcome.raster.iter_mut().flat_map(|raster| &mut raster.classes).map(|class| &mut class.label);
    for text in figures.chain(classes).filter(|text| is_of_mark(text)) {
        *text = lettered(text, letters);
    }
}

/// A name with letters before the number at its end.
fn lettered(name: &str, letters: &str) -> String {
    let (before, number) = name.split_at(name.trim_end_matches(|end: char| end.is_ascii_digit()).len());
    format!("{before}{letters}{number}")
}

/// A to Z, then AA to AZ, and so on.
fn letters(index: usize) -> String {
    let last = char::from(b'A' + (index % 26) as u8);
    match index / 26 {
        0 => last.to_string(),
        before => letters(before - 1) + &last.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn letters_go_on_after_z() {
        let found = [0, 1, 25, 26, 27, 51, 52, 701, 702].map(letters);
        assert_eq!(found, ["A", "B", "Z", "AA", "AB", "AZ", "BA", "ZZ", "AAA"]);
    }

    #[test]
    fn a_letter_is_put_before_the_number_at_the_end() {
        let found = ["1", "12", "LZ 3", "seen from post 4"].map(|name| lettered(name, "B"));
        assert_eq!(found, ["B1", "B12", "LZ B3", "seen from post B4"]);
    }
}
