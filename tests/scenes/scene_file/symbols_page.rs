//! `scenes/SYMBOLS.md` lists the military symbols that are drawn, and those that are not.
//! `SANDTABLE_BLESS=1 cargo test --test scenes symbols_page` writes it.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::Path;

use sandtable_base::message::numbers::counted;
use sandtable_symbology::entities::entity::SymbolEntity;
use sandtable_symbology::entities::{SETS, changed as changed_entities, entities};
use sandtable_symbology::fields::{
    CodedField, SymbolAmplifier, SymbolContext, SymbolIdentity, SymbolRole, SymbolSet, SymbolStatus,
    SymbolVersion,
};
use sandtable_symbology::modifiers::{common, modifiers};
use sandtable_symbology::texts::{TEXT_FIELDS, TextPlace};

/// The entities of MIL-STD-2525D in the sets that have drawings.
const STANDARD: &str = include_str!("../../symbology/standard.txt");

const HEAD: &str = "# Military symbols: what is drawn

The key `sidc` of `[[symbol]]` is a symbol code: 20 or 30 digits as MIL-STD-2525D, MIL-STD-2525E and APP-6D write them, or
15 letters as MIL-STD-2525C did. The digits are, in this order: version (2), context (1), standard identity (1), symbol set
(2), status (1), headquarters, task force, dummy (1), echelon or mobility (2), entity (6), sector 1 modifier (2), sector 2
modifier (2); of a code of 30 digits, common modifiers (2), frame shape (1), 4 that are not read, and country (3, by the numbers
of ISO 3166-1).
So `10031000161211020000` is a friendly armored infantry battalion.

An entity or a modifier that is not drawn leaves the frame, and a note that names it. Of codes of 15 letters all functions
are known but those of the weather. `tests/pictures/symbols.rs` holds the drawings to those of npm milsymbol 3.0.4: boxes
within 2 of 200 units, anchors within 1, and dark pixels at 128 pixels, blurred by 2, overlapping by 0.8 at least.

`sandtable symbol 10031000161211020000 -o infantry.svg --fields unique_designation=1-12` draws one symbol.
";

/// The sets with the entities and modifiers of signals intelligence in space.
const OTHER_SIGNALS: [SymbolSet; 4] =
    [SymbolSet::SignalsAir, SymbolSet::SignalsLand, SymbolSet::SignalsSurface, SymbolSet::SignalsSubsurface];

fn page() -> String {
    let mut page = HEAD.to_owned();
    add_field::<SymbolVersion>(&mut page, 2);
    add_field::<SymbolContext>(&mut page, 1);
    add_field::<SymbolIdentity>(&mut page, 1);
    add_field::<SymbolSet>(&mut page, 2);
    add_field::<SymbolStatus>(&mut page, 1);
    add_field::<SymbolRole>(&mut page, 1);
    add_field::<SymbolAmplifier>(&mut page, 2);
    add_texts(&mut page);
    for set in SETS.into_iter().filter(|set| !OTHER_SIGNALS.contains(set)) {
        add_set(&mut page, set);
    }
    add_common(&mut page);
    add_missing(&mut page);
    page.push('\n');
    page
}

/// A table of the values of a field.
fn add_field<T: CodedField>(page: &mut String, digits: usize) {
    let _ = writeln!(page, "\n## {}\n\n| code | meaning |\n|---|---|", capitalized(T::FIELD));
    for row in T::VALUES {
        let _ = writeln!(page, "| {:0digits$} | {} |", row.number, row.name);
    }
}

fn add_texts(page: &mut String) {
    page.push_str("\n## Text round the frame\n\n| field | key | place |\n|---|---|---|\n");
    for row in &TEXT_FIELDS {
        let place = match row.place {
            TextPlace::Above => "over the frame".to_owned(),
            TextPlace::Inside => "in the frame".to_owned(),
            TextPlace::Left(row) => format!("left, row {}", row + 1),
            TextPlace::Right(row) => format!("right, row {}", row + 1),
            TextPlace::Below => "below the frame".to_owned(),
            TextPlace::Bar => "the bar over the symbol".to_owned(),
        };
        let _ = writeln!(page, "| {} | `{}` | {place} |", row.letter, row.key);
    }
    page.push_str(
        "| Q | `direction` | an arrow from the place |\n\nThe places are those of units. What flies or swims has T, P, V, X, Z, G and H on the right, as \
         the standard has them.\n",
    );
}

fn add_set(page: &mut String, set: SymbolSet) {
    let (number, drawn) = (set.number(), entities(set));
    let title = match set {
        SymbolSet::SignalsSpace => "Signals intelligence (50 to 54)".to_owned(),
        _ => format!("{} ({number:02})", capitalized(set.name())),
    };
    let count = counted(drawn.len(), "entity", "entities");
    let _ = writeln!(page, "\n## {title}: {count}\n\n| entity | name |\n|---|---|");
    add_entities(page, drawn, 6);
    if !changed_entities(set).is_empty() {
        let _ = writeln!(page, "\n| entity in 2525E | name |\n|---|---|");
        add_entities(page, changed_entities(set), 6);
    }
    for sector in [1, 2] {
        let drawn = modifiers(set, sector);
        if !drawn.is_empty() {
            let _ = writeln!(page, "\n| sector {sector} modifier | name |\n|---|---|");
            add_entities(page, drawn, 2);
        }
    }
}

/// The common modifiers of 2525E.
fn add_common(page: &mut String) {
    page.push_str(
        "\n## Common modifiers of 2525E\n\nThe first digit is digit 21 of the code in sector 1, and digit 22 in sector 2.\n",
    );
    for sector in [1, 2] {
        let _ = writeln!(page, "\n| sector {sector} modifier | name |\n|---|---|");
        add_entities(page, common(sector), 3);
    }
}

fn add_entities(page: &mut String, rows: &[SymbolEntity], digits: usize) {
    for row in rows {
        let _ = writeln!(page, "| {:0digits$} | {} |", row.code, row.name);
    }
}

/// What other renderers draw, and the entities of the standard without a drawing.
fn add_missing(page: &mut String) {
    page.push_str(
        "\n## What is missing\n\nOf what milsymbol 3.0.4 draws by codes of digits in sets with frames, nothing. Control measures (25), the \
         atmosphere (45),\noceanography (46) and meteorology of space (47) have no frames: `[[graphic]]` draws those that are below. \
         Two fields of the\nstandard are not drawn: R2, the mobility of signals intelligence, and AG, the auxiliary equipment \
         indicator, but for towed\narrays.\n",
    );
    let mut missing: BTreeMap<u8, Vec<String>> = BTreeMap::new();
    for line in STANDARD.lines().filter(|line| !line.starts_with('#')) {
        let mut words = line.splitn(3, ' ');
        let mut word = || words.next().expect("set, code and name");
        let (set, code, name) = (word(), word(), word());
        let set = SymbolSet::from_number(set.parse().expect("a number")).expect("a set");
        let is_drawn = entities(set).iter().any(|row| Ok(row.code) == code.parse());
        if !is_drawn {
            missing.entry(set.number()).or_default().push(format!("{code} {name}"));
        }
    }
    for set in SETS {
        let Some(names) = missing.remove(&set.number()) else { continue };
        let _ = writeln!(
            page,
            "\n{} ({:02}), {} entities: {}.",
            capitalized(set.name()),
            set.number(),
            names.len(),
            names.join("; ")
        );
    }
}

fn capitalized(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
}

/// What follows on the page is of tactical graphics, written by their own test.
const GRAPHICS: &str = "<!-- graphics -->";

#[test]
fn the_page_of_symbols_is_up_to_date() {
    let file = Path::new(env!("SANDTABLE_ROOT")).join("scenes/SYMBOLS.md");
    let committed = std::fs::read_to_string(&file).expect("scenes/SYMBOLS.md");
    let start = committed.find(GRAPHICS).unwrap_or(committed.len());
    let (symbols, graphics) = committed.split_at(start);
    if std::env::var_os("SANDTABLE_BLESS").is_some() {
        std::fs::write(&file, page() + graphics).expect("scenes/SYMBOLS.md");
    } else {
        assert!(symbols == page(), "scenes/SYMBOLS.md is outdated; write it with SANDTABLE_BLESS=1");
    }
}
