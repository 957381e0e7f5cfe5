//! `scenes/README.md` lists every key as it is declared. `SANDTABLE_BLESS=1 cargo test --test scenes reference` writes it.

use std::fmt::Write;
use std::path::Path;

use sandtable_catalog::parameter::ParameterForm;
use sandtable_description::bounds::Bounds;
use sandtable_description::declaration::{KeyDeclaration, KeyKind, Presence};
use sandtable_description::document::Document;
use sandtable_description::phases::PHASES_KEY;
use sandtable_description::styles::STYLE_KEY;
use sandtable_description::words::{RampName, WordDeclaration, declarations};

const HEAD: &str = "# Scene files: keys and defaults

Each scene in this folder shows one feature, and says what in its first lines. This page lists every key that a scene file
may have. `sandtable schema` prints the same as a JSON Schema for editors; `sandtable check SCENE` finds what is wrong in a
scene file, and [FINDINGS.md](FINDINGS.md) lists what it finds.

A scene file is TOML in UTF-8. Lengths and heights are meters, angles degrees, compass directions clockwise from north,
points `[easting, northing]` or `[longitude, latitude]`, and file names relative to the file that they stand in, unless a
key says otherwise. A point may also be a text with a system of its own, WGS 84, whatever `crs` is: a grid reference, whose
square's middle is taken (`\"16S GF 500 180\"`), UTM (`\"16N 750050 4018050\"`), or latitude and longitude with their letters
(`\"36.277N 84.215W\"`). What can be read in two ways is an error that names both. A key of a value without a default is needed. An expression gives a value for each feature from its
properties, such as `\"lanes * 3.5 ?? 8\"`.
";

/// A heading and a table for `keys`, then for the tables among them. `dotted` is the name of their own table.
fn add_section(page: &mut String, title: &str, doc: &str, keys: &[&KeyDeclaration], dotted: &str) {
    let _ = writeln!(page, "\n## {title}\n\n{doc}\n");
    let _ =
        writeln!(page, "| key | type | unit | range | default | what it does |\n|---|---|---|---|---|---|");
    keys.iter().for_each(|key| page.push_str(&row(key)));
    let is_group = |key: &KeyDeclaration| matches!(key.kind, KeyKind::Group(_) | KeyKind::AnalysisArguments);
    for key in keys.iter().filter(|key| !is_group(key) && !key.inner().is_empty()) {
        let dotted = if dotted.is_empty() { key.name.to_owned() } else { format!("{dotted}.{}", key.name) };
        let (title, common): (_, &[&KeyDeclaration]) = match key.kind {
            KeyKind::Table(_) => (format!("`[{dotted}]`"), &[][..]),
            KeyKind::NamedTables(_) => (format!("`[{dotted}.NAME]`"), &[][..]),
            KeyKind::StyledTables(_) => (format!("`[[{dotted}]]`"), &[&STYLE_KEY, &PHASES_KEY][..]),
            _ => (format!("`[[{dotted}]]`"), &[][..]),
        };
        let inner: Vec<&KeyDeclaration> = key.inner().iter().chain(common.iter().copied()).collect();
        add_section(page, &title, key.doc(), &inner, &dotted);
    }
}

fn row(key: &KeyDeclaration) -> String {
    if let KeyKind::Group(keys) = key.kind {
        let names: Vec<String> = keys.iter().map(|key| format!("`{}`", key.name)).collect();
        let doc = key.doc();
        return format!("| {} | [source](#source-of-features) | | | | {doc} |\n", names.join(", "));
    }
    if matches!(key.kind, KeyKind::AnalysisArguments) {
        return key.inner().iter().map(row).collect();
    }
    let (kind, range) = kind_and_range(key.kind);
    let default = match key.presence {
        Presence::Default("{}" | "[]") | Presence::Required | Presence::Inline => String::new(),
        Presence::Default(value) => format!("`{value}`"),
        Presence::Otherwise(text) => text.to_owned(),
    };
    let words = match key.kind {
        KeyKind::Word(words) | KeyKind::FeatureWord(words) => {
            let meanings: Vec<String> =
                words().iter().map(|declared| format!(" `{}`: {}", declared.word, declared.doc)).collect();
            meanings.join(";") + "."
        }
        _ => String::new(),
    };
    let doc = format!("{}{words}", key.doc()).replace('|', "\\|");
    format!("| `{}` | {kind} | {} | {range} | {default} | {doc} |\n", key.name, key.unit)
}

fn kind_and_range(kind: KeyKind) -> (String, String) {
    let any = |kind: &str| (kind.to_owned(), String::new());
    match kind {
        KeyKind::Number(range) => ("number".into(), range.to_string()),
        KeyKind::Integer(least, most) => ("whole number".into(), format!("from {least} to {most}")),
        KeyKind::FeatureNumber(range) => ("number or expression".into(), range.to_string()),
        KeyKind::NumberRange(range) => ("two numbers, from and to".into(), range.to_string()),
        KeyKind::Numbers(range) => ("list of numbers".into(), range.to_string()),
        KeyKind::Switch => any("true or false"),
        KeyKind::Text | KeyKind::FilledText => any("text"),
        KeyKind::TextList => any("text or list of texts"),
        KeyKind::FilesOrTables(_) => any("text, table, or list of them"),
        KeyKind::TextTable | KeyKind::Styles => any("table with names of yours"),
        KeyKind::Expression => any("expression"),
        KeyKind::Word(words) => (listed(&words()), String::new()),
        KeyKind::FeatureWord(words) => (listed(&words()) + " or expression", String::new()),
        KeyKind::Color => any("color, `\"#rrggbb\"`"),
        KeyKind::Point => any("point"),
        KeyKind::Points(_) => any("list of points"),
        KeyKind::Ramp => (listed(&declarations::<RampName>()) + " or list of stops", String::new()),
        KeyKind::Selection => any("table or expression"),
        KeyKind::Table(_) => any("table"),
        KeyKind::Tables(_) | KeyKind::StyledTables(_) => any("list of tables"),
        KeyKind::NamedTables(_) => any("tables with names of yours"),
        KeyKind::Argument(forms) => {
            let (kinds, ranges): (Vec<String>, Vec<String>) = forms.iter().map(form_and_range).unzip();
            (
                kinds.join(" or "),
                ranges.into_iter().filter(|range| !range.is_empty()).collect::<Vec<_>>().join(" or "),
            )
        }
        KeyKind::Group(_) | KeyKind::AnalysisArguments => any(""),
    }
}

fn form_and_range(form: &ParameterForm) -> (String, String) {
    let any = |kind: &str| (kind.to_owned(), String::new());
    match *form {
        ParameterForm::Number { least, greatest } => {
            ("number".into(), Bounds::Within(least, greatest).to_string())
        }
        ParameterForm::Numbers { least, greatest } => {
            ("list of numbers that rise".into(), Bounds::Within(least, greatest).to_string())
        }
        ParameterForm::Word(words) => {
            any(&words.iter().map(|word| format!("`{word}`")).collect::<Vec<_>>().join(", "))
        }
        ParameterForm::Points { least: 2.. } => any("list of points"),
        ParameterForm::Points { .. } => any("point or list of points"),
        ParameterForm::Line => any("list of points, a line"),
        ParameterForm::Area => any("list of points, a ring"),
        ParameterForm::Extent => any("list of points: two corners, or a ring"),
        ParameterForm::Vehicle => any("name of a vehicle"),
        ParameterForm::Ground => any("file, `source`, or `phase:NAME`"),
    }
}

fn listed(words: &[WordDeclaration]) -> String {
    words.iter().map(|declared| format!("`{}`", declared.word)).collect::<Vec<_>>().join(", ")
}

fn page() -> String {
    let mut page = HEAD.to_owned();
    let keys: Vec<&KeyDeclaration> = Document::DECLARATIONS.iter().collect();
    add_section(&mut page, "Outside tables", "These keys stand before the first table.", &keys, "");
    let mut all = Document::DECLARATIONS.iter().flat_map(|key| key.inner());
    let source = all.find(|key| matches!(key.kind, KeyKind::Group(_))).expect("roads have a source");
    let doc = "Features come from inline points or from a file. The keys stand in the feature's own table.";
    let source: Vec<&KeyDeclaration> = source.inner().iter().collect();
    add_section(&mut page, "Source of features", doc, &source, "");
    page
}

#[test]
fn the_reference_page_lists_the_keys_as_they_are_declared() {
    let file = Path::new(env!("SANDTABLE_ROOT")).join("scenes/README.md");
    if std::env::var_os("SANDTABLE_BLESS").is_some() {
        std::fs::write(&file, page()).expect("writable");
    }
    let committed = std::fs::read_to_string(&file).expect("scenes/README.md");
    assert!(committed == page(), "scenes/README.md is outdated; write it with SANDTABLE_BLESS=1");
}
