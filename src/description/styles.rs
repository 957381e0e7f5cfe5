//! Named styles: keys that many tables share, written once.
//!
//! ```toml
//! [styles.lane]
//! width = 3.5
//! surface = "gravel"
//!
//! [[road]]
//! style = "lane"
//! file = "lanes.geojson"
//! surface = "asphalt"      # what a table states itself counts
//! ```
//!
//! A style may hold any key of the tables that name it, and is judged where it is used: a key that the table does not
//! know is an error at the style's key. Of two keys that exclude each other, such as `width` and `widths`, the table's
//! own counts, and the style's is passed over. A style names no other style.

use std::cell::Cell;
use std::collections::BTreeMap;
use std::ops::Range;

use toml::Spanned;
use toml::de::DeTable;

use crate::description::reader::TableReader;
use crate::description::suggest::{quoted, remedy};

/// How many bytes of scene file all styles together may stand for, each counted as often as it is used: without a
/// limit a long list in a style of ten thousand tables would fill the memory.
const MAX_BYTES: usize = 16 << 20;

/// Keys each of which makes the others say nothing.
const RIVALS: [(&str, &[&str]); 8] = [
    ("points", &["file", "layer", "where", "widths"]),
    ("file", &["points", "widths"]),
    ("width", &["widths"]),
    ("widths", &["width"]),
    ("level", &["level_rule"]),
    ("level_rule", &["level"]),
    ("at", &["instances"]),
    ("instances", &["at", "crs"]),
];

/// A style's keys and how many bytes of scene file they take.
struct NamedStyle<'i> {
    keys: DeTable<'i>,
    bytes: usize,
}

/// All styles of a scene, by name.
pub(super) struct Styles<'i> {
    styles: BTreeMap<String, NamedStyle<'i>>,
    /// How many bytes may still be used.
    left: Cell<usize>,
}

impl<'i> Styles<'i> {
    /// Those that the scene file holds.
    pub fn read_all(reader: &mut TableReader<'_, 'i>) -> Self {
        let mut styles = BTreeMap::new();
        for (name, keys) in reader.named_tables("styles") {
            if let Some((key, _)) = keys.get_key_value("style") {
                let message = "a style cannot take keys of another one";
                reader.error(key.span(), message, "state the keys themselves");
                continue;
            }
            let bytes = keys.values().map(|value| value.span().len()).sum();
            styles.insert(name.into_inner(), NamedStyle { keys, bytes });
        }
        Self { styles, left: Cell::new(MAX_BYTES) }
    }

    /// All tables `[[key]]`, each with the keys of the style that it names.
    pub fn read<T>(
        &self,
        reader: &mut TableReader<'_, 'i>,
        key: &'static str,
        decode: impl Fn(&mut TableReader<'_, 'i>) -> Option<T>,
    ) -> Vec<T> {
        reader.tables(key, |reader| {
            if let Some(name) = reader.get("style", |item| item.filled_text()) {
                self.put_on(reader, &name);
            }
            decode(reader)
        })
    }

    fn put_on(&self, reader: &mut TableReader<'_, 'i>, name: &Spanned<String>) {
        let Some(style) = self.styles.get(name.get_ref()) else {
            let (message, help) = self.unknown(name.get_ref());
            return reader.error(name.span(), message, help);
        };
        match self.left.get().checked_sub(style.bytes) {
            Some(left) => self.left.set(left),
            None => return too_much(reader, name.span()),
        }
        let excluded = |stated: &DeTable<'i>, key: &str| {
            RIVALS.iter().any(|(own, others)| stated.contains_key(*own) && others.contains(&key))
        };
        reader.add_keys(&style.keys, excluded);
    }

    fn unknown(&self, name: &str) -> (String, String) {
        let names: Vec<&str> = self.styles.keys().map(String::as_str).take(20).collect();
        let help = match names[..] {
            [] => format!("add a table [styles.{}]", quoted(name)),
            _ => remedy(name, &names, "the styles are").replace(" or ", " and "),
        };
        (format!("there is no style \"{}\"", quoted(name)), help)
    }
}

fn too_much(reader: &mut TableReader<'_, '_>, place: Range<usize>) {
    let message = format!("styles stand for more than {MAX_BYTES} bytes in all");
    reader.error(place, message, "put long lists of points in a vector file, and name it once with `file`");
}
