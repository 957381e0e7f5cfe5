//! The text of the pages: one for each kind, one for each family, and the lines of the book's table of contents.

use std::collections::BTreeSet;
use std::fmt::Write;

use sandtable_analysis::movement::vehicle::{BUILT_IN_NAMES, Vehicle};
use sandtable_analysis::outcome::{Hatching, Outcome, OutcomeRaster, OutcomeShape, with_unit};
use sandtable_catalog::kind::{AnalysisFamily, AnalysisKind, AnalysisReach};
use sandtable_catalog::kinds;
use sandtable_catalog::parameter::{AnalysisParameter, ParameterDefault, ParameterForm};
use sandtable_picture::analysis_look::feature_noun;

use crate::analysis_pages::examples::Example;

/// A command is broken into lines no longer than this.
const WIDTH: usize = 100;

/// Figures that a page names; of more, such as one for each peak, it says that there are more.
const MOST_FIGURES: usize = 8;

/// The name of a family's page, its title, and what its kinds answer.
pub fn family_texts(family: AnalysisFamily) -> [&'static str; 3] {
    match family {
        AnalysisFamily::Surface => [
            "surface",
            "The form of the ground",
            "How steep the ground is, how it bends, and where its ridges, valleys and summits are.",
        ],
        AnalysisFamily::Movement => [
            "movement",
            "Movement",
            "Where a vehicle or people on foot can go, how fast, on which way, and where that way is narrow.",
        ],
        AnalysisFamily::Observation => [
            "observation",
            "Observation and fire",
            "What posts see, radars cover and weapons hit, and where a route is in sight.",
        ],
        AnalysisFamily::Landing => [
            "landing-and-sites",
            "Landing and sites",
            "Where helicopters land, parachutists are dropped, and camps or guns stand.",
        ],
        AnalysisFamily::Water => ["water", "Water", "Where water stands, runs and rises."],
        AnalysisFamily::Earth => ["earth", "Earth", "How much earth is moved, from where and to where."],
    }
}

/// The kinds of a family.
fn kinds_of(family: AnalysisFamily) -> impl Iterator<Item = &'static AnalysisKind> {
    kinds().filter(move |kind| kind.family == family)
}

/// The lines of the table of contents below the overview.
pub fn contents() -> String {
    AnalysisFamily::ALL.into_iter().fold(String::new(), |mut lines, family| {
        let [name, title, _] = family_texts(family);
        let _ = writeln!(lines, "  - [{title}](analysis/{name}.md)");
        for kind in kinds_of(family) {
            let _ = writeln!(lines, "    - [{}](analysis/{}.md)", kind.title, kind.name);
        }
        lines
    })
}

/// The page of a family: its kinds with their pictures.
pub fn family_page(family: AnalysisFamily) -> String {
    let [_, title, about] = family_texts(family);
    let mut page = format!("# {title}\n\n{about}\n\n| | |\n|---|---|\n");
    for kind in kinds_of(family) {
        let AnalysisKind { name, title, summary, .. } = kind;
        let _ = writeln!(
            page,
            "| [![{title}]({name}.png)]({name}.md) | **[{title}]({name}.md)** (`{name}`): {summary} |"
        );
    }
    if family == AnalysisFamily::Movement {
        page.push_str(&vehicles());
    }
    page
}

/// The built-in vehicles.
fn vehicles() -> String {
    let mut text = "\n## Vehicles\n\nThe argument `vehicle` names one of these, or one of the scene's own. The numbers are \
                    this program's defaults, not a manual's. Slopes have two limits: up to the first a vehicle goes freely, \
                    up to the second slowly. Road speeds are those on a path, a track, a road, a main road and a motorway.\n\n\
                    | vehicle | up, % | down, % | across, % | open ground, km/h | roads, km/h | ford, m | gap, m | step, m | \
                    width, m | stems, m |\n|---|---|---|---|---|---|---|---|---|---|---|\n"
        .to_owned();
    for name in BUILT_IN_NAMES {
        let vehicle = Vehicle::built_in(name).expect("it is built in");
        let slopes = [vehicle.slope_up_percent, vehicle.slope_down_percent, vehicle.slope_across_percent];
        let slopes = slopes.map(|[free, greatest]| format!("{free}, {greatest}")).join(" | ");
        let roads = vehicle.road_speed_kmh.map(short).join(", ");
        let Vehicle { ford_m, gap_m, step_m, width_m, stem_m, .. } = vehicle;
        let _ = writeln!(
            text,
            "| `{name}` | {slopes} | {} | {roads} | {ford_m} | {gap_m} | {step_m} | {width_m} | {stem_m} |",
            short(vehicle.speed_kmh)
        );
    }
    text.push_str(
        "\nA scene states its own, with what differs from one that is built in; the keys are in [the reference of scene \
         files](../../../scenes/README.md#vehiclename):\n\n```toml\n[vehicle.tank]\nlike = \"tracked\"\nslope_up_percent = [30, 45]\n\
         ford_m = 1.2\n```\n",
    );
    text
}

/// A number with one decimal at most.
fn short(number: f64) -> String {
    let text = format!("{number:.1}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// The page of a kind.
pub fn kind_page(kind: &'static AnalysisKind, example: &Example, outcome: &Outcome) -> String {
    let mut page = format!("# {}\n\n{}\n\n", kind.title, kind.summary);
    let _ = write!(page, "```sh\n{}\n```\n\n", command(kind, example));
    let _ = write!(page, "![{}]({}.png)\n\n{}\n\n", kind.title, kind.name, example.caption);
    let _ = write!(page, "In a scene file:\n\n```toml\n{}```\n\n", analysis_table(kind, example));
    page.push_str("## Parameters\n\n");
    page.push_str("| key | option | value | unit | default | what it says |\n|---|---|---|---|---|---|\n");
    page.extend(kind.all_parameters().map(parameter_row));
    page.push_str("\n## What it gives\n\n");
    page.push_str(given(outcome).trim_end());
    let _ = write!(page, "\n\n## What it knows\n\n{}\n\n", known(kind));
    let _ = write!(page, "Source: {}.\n\n", kind.source.trim_end_matches('.'));
    page.push_str("## What it does not know\n\n");
    for limit in kind.limits {
        let _ = writeln!(page, "- {limit}");
    }
    page
}

/// The command of an example.
fn command(kind: &AnalysisKind, example: &Example) -> String {
    let start = format!("cargo run -- analyze {} {}", kind.name, example.land.file());
    let options = example.arguments.iter().map(|(name, text)| {
        let is_plain = text.chars().all(|letter| letter.is_alphanumeric() || "-_.,:".contains(letter));
        let quote = if is_plain { "" } else { "\"" };
        format!("--{} {quote}{text}{quote}", name.replace('_', "-"))
    });
    let output = format!("-o {}.png", kind.name);
    let mut lines = vec![start];
    for option in options.chain([output]) {
        match lines.last_mut().filter(|line| line.len() + option.len() < WIDTH) {
            Some(line) => {
                line.push(' ');
                line.push_str(&option);
            }
            None => lines.push(format!("    {option}")),
        }
    }
    lines.join(" \\\n")
}

/// The table of an example in a scene file.
pub fn analysis_table(kind: &AnalysisKind, example: &Example) -> String {
    let mut table = format!("[[analysis]]\nkind = \"{}\"\n", kind.name);
    for (name, text) in example.arguments {
        let parameter = kind.all_parameters().find(|parameter| parameter.name == *name);
        let parameter = parameter.unwrap_or_else(|| panic!("{} has no `{name}`", kind.name));
        let _ = writeln!(table, "{name} = {}", scene_value(parameter, text));
    }
    table
}

/// An argument of the command line as the value of a key.
fn scene_value(parameter: &AnalysisParameter, text: &str) -> String {
    match parameter.form {
        ParameterForm::Number { .. } => text.to_owned(),
        ParameterForm::Numbers { .. } => format!("[{}]", text.replace(',', ", ")),
        ParameterForm::Word(_) | ParameterForm::Vehicle | ParameterForm::Ground => format!("\"{text}\""),
        ParameterForm::Points { .. } | ParameterForm::Line | ParameterForm::Area | ParameterForm::Extent => {
            let points: Vec<String> = text.split(';').map(|point| scene_position(point.trim())).collect();
            match &points[..] {
                [point] => point.clone(),
                points => format!("[{}]", points.join(", ")),
            }
        }
    }
}

/// A position as the value of a key: a list of two numbers, or a text.
fn scene_position(text: &str) -> String {
    match text.split_once(',') {
        Some((x, y)) => format!("[{x}, {y}]"),
        None => format!("\"{text}\""),
    }
}

fn parameter_row(parameter: &AnalysisParameter) -> String {
    let AnalysisParameter { name, unit, doc, .. } = parameter;
    let default = match parameter.default {
        ParameterDefault::Required => "needed".to_owned(),
        ParameterDefault::Value(text) => format!("`{text}`"),
        ParameterDefault::Otherwise(text) => text.to_owned(),
    };
    let option = name.replace('_', "-");
    format!(
        "| `{name}` | `--{option}` | {} | {unit} | {default} | {} |\n",
        values(parameter.form),
        doc.replace('|', "\\|")
    )
}

fn values(form: ParameterForm) -> String {
    let range = |least: f64, greatest: f64| format!("from {} to {}", bound(least), bound(greatest));
    match form {
        ParameterForm::Number { least, greatest } => format!("number {}", range(least, greatest)),
        ParameterForm::Numbers { least, greatest } => format!("rising numbers {}", range(least, greatest)),
        ParameterForm::Word(words) => {
            words.iter().map(|word| format!("`{word}`")).collect::<Vec<_>>().join(", ")
        }
        ParameterForm::Points { least: 1 } => "positions".to_owned(),
        ParameterForm::Points { least } => format!("positions, at least {least}"),
        ParameterForm::Line => "positions of a line".to_owned(),
        ParameterForm::Area => "positions around an area".to_owned(),
        ParameterForm::Extent => "two corners, or positions around an area".to_owned(),
        ParameterForm::Vehicle => "[vehicle](movement.md#vehicles)".to_owned(),
        ParameterForm::Ground => "elevation file or `source`".to_owned(),
    }
}

/// A bound of a range, a large one by its power of ten.
fn bound(number: f64) -> String {
    if number.abs() >= 1e7 { format!("{number:e}") } else { number.to_string() }
}

/// What the example gave.
fn given(outcome: &Outcome) -> String {
    let mut text = String::new();
    if let Some(raster) = &outcome.raster {
        text.push_str(&given_raster(raster));
    }
    let mut told = BTreeSet::new();
    for feature in &outcome.features {
        let shape = match &feature.shape {
            OutcomeShape::Point(_) => "points",
            OutcomeShape::Line(_) => "lines",
            OutcomeShape::Area(_) => "areas",
        };
        if told.insert((feature_noun(feature), shape)) {
            let names: Vec<String> = feature.properties.iter().map(|(name, _)| format!("`{name}`")).collect();
            let with = if names.is_empty() {
                String::new()
            } else {
                format!(" with the properties {}", names.join(", "))
            };
            let _ = writeln!(text, "- {shape} (*{}*){with}", feature_noun(feature));
        }
    }
    for table in &outcome.tables {
        let columns = table.columns.iter().map(|column| with_unit(column.name, column.unit));
        let _ = writeln!(text, "- a table, *{}*: {}", table.title, columns.collect::<Vec<_>>().join(", "));
    }
    let figures =
        outcome.figures.iter().take(MOST_FIGURES).map(|figure| with_unit(&figure.name, figure.unit));
    let figures: Vec<String> = figures.collect();
    if !figures.is_empty() {
        let more = if outcome.figures.len() > MOST_FIGURES { " and more" } else { "" };
        let _ = writeln!(text, "- figures: {}{more}", figures.join(", "));
    }
    text
}

fn given_raster(raster: &OutcomeRaster) -> String {
    let mut text = format!("- a raster, {}", with_unit(raster.name, raster.unit));
    if raster.classes.is_empty() {
        text.push_str("; a picture shows it by steps of round numbers\n");
        return text;
    }
    text.push_str(
        "; a picture shows it by classes:\n\n  | from | class | in black on white |\n  |---|---|---|\n",
    );
    for class in &raster.classes {
        let hatching = match class.look.hatching {
            Hatching::None => "",
            Hatching::Single => "hatched in one direction",
            Hatching::Crossed => "hatched in two directions",
            Hatching::Dots => "dotted",
            Hatching::Level => "level lines",
        };
        let from = match class.from {
            from if !from.is_finite() => String::new(),
            from if from > 0.0 && from < 1e-6 => "above 0".to_owned(),
            from => from.to_string(),
        };
        let _ = writeln!(text, "  | {from} | {} | {hatching} |", class.label);
    }
    text.push('\n');
    text
}

/// What of the land a kind uses, and what an extent does to it.
fn known(kind: &AnalysisKind) -> String {
    let layers: Vec<&str> = kind.layers.iter().map(|layer| layer.noun()).collect();
    let layers = match &layers[..] {
        [] => "It uses the ground alone: of a scene the ground after its earthworks.".to_owned(),
        layers => format!(
            "It uses the ground and, of a scene, these layers: {}. What the land lacks is told in a note.",
            layers.join("; ")
        ),
    };
    let part = match kind.reach {
        AnalysisReach::Posts(posts) => format!(
            "Values depend on the ground up to {posts} {} away: within an `extent` they are those of the whole land to the last bit.",
            if posts == 1 { "post" } else { "posts" }
        ),
        AnalysisReach::PostsBy(name) | AnalysisReach::MetersBy(name) => format!(
            "Values depend on the ground as far away as `{name}` says: within an `extent` they are those of the whole land to the \
             last bit."
        ),
        AnalysisReach::Between { places, range } => format!(
            "Values depend on the ground between `{places}` and the place, as far away as `{range}` says; the land ends at an \
             `extent`. `plan analysis` cuts it into shards."
        ),
        AnalysisReach::Around { places, range } => format!(
            "Values depend on the ground within the `{range}` of `{places}`; the land ends at an `extent`. `plan analysis` cuts it \
             into shards where `{range}` is stated."
        ),
        AnalysisReach::Whole => "All of the land has an effect: it ends at an `extent`.".to_owned(),
    };
    format!("{layers} {part}")
}
