//! Elevations that are read as meters although something states that they are feet.
//!
//! Nothing is guessed of the numbers alone: hills of 900 may be meters as well. Evidence is the vertical unit of the `.prj`
//! beside a file, the name of its vertical datum, and its own name. That coordinates are in feet is found when a scene is
//! built.

use std::path::Path;

use crate::context::LintContext;
use crate::sink::FindingSink;
use sandtable_base::message::suggest::quoted;
use sandtable_description::finding_code::FindingCode;
use sandtable_files::disk::file_stem;
use sandtable_raster::raster::Raster;
use sandtable_raster::unstated_unit::FEET_M;
use sandtable_raster::vertical::{name_of_wkt, unit_of_wkt};

/// Words for feet in the names of vertical datums.
const WORDS: [&str; 6] = ["ft", "feet", "foot", "ftus", "usft", "sft"];

/// Words for feet in names of files; `ft` only at their end, since it begins the names of forts.
const NAME_WORDS: [&str; 3] = ["feet", "ftus", "usft"];

/// Finds elevation files that are read as meters although something states that they are in feet.
pub fn check(context: &LintContext<'_>, sink: &mut FindingSink) {
    let terrain = &context.document.terrain;
    let snapshot = context.scene.heights.snapshot();
    let raster = snapshot.source();
    if raster.meters_per_z != 1.0 || terrain.height_scale.is_some() || terrain.vertical_unit.is_some() {
        return;
    }
    let is_found = |file: &str| {
        let named = format!("'{}'", quoted(file));
        let found = &context.scene.findings;
        found.iter().any(|found| found.code == FindingCode::HeightsInFeet && found.message.contains(&named))
    };
    for file in terrain.dem.iter().map(|tile| tile.file.as_str()).filter(|file| !is_found(file)) {
        let beside = ["prj", "PRJ"].into_iter().find_map(|extension| {
            let name = Path::new(file).with_extension(extension);
            Some(String::from_utf8_lossy(&context.sources.assets.read(name.to_str()?).ok()?).into_owned())
        });
        let Some(evidence) = evidence(file, beside.as_deref(), raster) else { continue };
        let message = format!(
            "the elevations of '{}' are read as meters, and {evidence}: they would be 3.28 times too high",
            quoted(file)
        );
        let help = "say `vertical_unit = \"ft\"` or \"us-ft\" under [terrain], or \"m\" if they are meters";
        let span = terrain.dem.span().unwrap_or_default();
        sink.add(context.finding(FindingCode::HeightsInFeet, span, message).with_help(help));
    }
}

/// What says that the heights of a file are feet; `beside` is the text of its `.prj`.
fn evidence(file: &str, beside: Option<&str>, raster: &Raster) -> Option<String> {
    if let Some(unit_m) = beside.and_then(unit_of_wkt) {
        let named = beside.and_then(name_of_wkt).unwrap_or_default();
        let message =
            format!("the vertical part of its .prj, '{}', has a unit of {unit_m} m", quoted(&named));
        return FEET_M.contains(&unit_m).then_some(message);
    }
    let datum =
        raster.vertical_datum.as_deref().filter(|datum| words(datum).any(|word| WORDS.contains(&&*word)));
    if let Some(datum) = datum {
        return Some(format!("its vertical datum is called '{}'", quoted(datum)));
    }
    let names: Vec<String> = words(&file_stem(Path::new(file))).collect();
    let is_named = names.iter().any(|word| NAME_WORDS.contains(&word.as_str()))
        || names.len() > 1 && names.last().is_some_and(|last| last == "ft");
    is_named.then(|| "its name says feet".to_owned())
}

/// The words of a text in lower case.
fn words(text: &str) -> impl Iterator<Item = String> + '_ {
    let parts = text.split(|character: char| !character.is_alphanumeric());
    parts.filter(|word| !word.is_empty()).map(str::to_lowercase)
}

#[cfg(test)]
mod tests {
    use super::*;
    use sandtable_raster::raster::Samples;

    #[test]
    fn names_and_datums_say_feet_where_a_word_of_theirs_does() {
        let found = |file: &str, datum: Option<&str>| {
            let vertical_datum = datum.map(str::to_owned);
            let raster = Raster { vertical_datum, ..Raster::new(1, Samples::F32(vec![300.0])) };
            evidence(file, None, &raster).is_some()
        };
        assert!(found("d/dem_feet.tif", None) && found("lidar-ft.asc", None));
        assert!(found("a.tif", Some("NAVD88 height (ftUS)")));
        for file in ["ft_worth.tif", "foothills.tif", "feet/a.tif", "ft.tif", "drift.asc", "ft_2.asc"] {
            assert!(!found(file, Some("NAVD88")), "{file}");
        }
    }
}
