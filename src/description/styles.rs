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
//! surface = "asphalt"      # a key of the table counts before that of its style
//! ```
//!
//! A style may hold any key of the tables that name it, and is checked where it is used: a key that the table does not
//! know is an error at the style's key. Of two keys that exclude each other, such as `width` and `widths`, the table's
//! own counts ([`KeyDeclaration::rivals`]). A style names no other style.

use std::collections::BTreeMap;
use std::ops::Range;

use toml::de::{DeTable, DeValue};

use crate::declaration::{KeyDeclaration, KeyKind, Presence};
use crate::diagnostic::DiagnosticSink;
use crate::finding_code::FindingCode;
use crate::stated::Stated;
use sandtable_base::limits::STYLE_BYTES;
use sandtable_base::message::suggest::{quoted, remedy};

/// The key `style` of every table that may name one.
pub const STYLE_KEY: KeyDeclaration = KeyDeclaration {
    name: "style",
    doc: "Name of a style: the keys of `[styles.NAME]` that this table does not state count as its own.",
    kind: KeyKind::FilledText,
    unit: "",
    presence: Presence::Otherwise("none"),
    rivals: &[],
};

/// A style with the place of its name, and whether a table has named it.
struct NamedStyle<'t> {
    keys: &'t DeTable<'t>,
    name_span: Range<usize>,
    is_used: bool,
}

/// All styles of a scene, by name.
pub(super) struct Styles<'t> {
    styles: BTreeMap<&'t str, NamedStyle<'t>>,
    /// How many more bytes may be used.
    bytes_left: usize,
}

impl<'t> Styles<'t> {
    /// The styles in the root table of a scene file; reports wrong ones and leaves them out.
    pub fn read(root: &'t DeTable<'t>, report: &mut DiagnosticSink) -> Self {
        let (mut styles, help) = (BTreeMap::new(), "start each with [styles.NAME]");
        let value = root.get("styles");
        if let Some(value) = value.filter(|value| !value.get_ref().is_table()) {
            report.error(value.span(), WRONG_STYLES, help);
        }
        for (name, keys) in value.and_then(|value| value.get_ref().as_table()).into_iter().flatten() {
            match keys.get_ref() {
                DeValue::Table(keys) => match keys.get_key_value(STYLE_KEY.name) {
                    Some((key, _)) => {
                        let message = "a style cannot take keys of another one";
                        report.error(key.span(), message, "state the keys themselves");
                    }
                    None => {
                        let style = NamedStyle { keys, name_span: name.span(), is_used: false };
                        styles.insert(name.get_ref().as_ref(), style);
                    }
                },
                _ => report.error(name.span(), WRONG_STYLES, help),
            }
        }
        Self { styles, bytes_left: STYLE_BYTES.count() }
    }

    /// The names of the styles that no table has named yet.
    pub fn unused(&self) -> Vec<Stated<String>> {
        let unused = self.styles.iter().filter(|(_, style)| !style.is_used);
        unused.map(|(name, style)| Stated::new((*name).to_owned(), style.name_span.clone())).collect()
    }

    /// The keys of a style. Reports an error and returns `None` where there is no such style, or styles add too many
    /// bytes.
    pub fn take(&mut self, name: &Stated<String>, report: &mut DiagnosticSink) -> Option<&'t DeTable<'t>> {
        let span = name.span().unwrap_or_default();
        let Some(style) = self.styles.get_mut(name.as_str()) else {
            let (message, help) = self.unknown(name);
            report.coded(FindingCode::UnknownName, span, message, help);
            return None;
        };
        style.is_used = true;
        let style = style.keys;
        let bytes: usize = style.values().map(|value| value.span().len()).sum();
        match self.bytes_left.checked_sub(bytes) {
            Some(left) => self.bytes_left = left,
            None => {
                let help = format!(
                    "put long lists of points in a vector file, and name it once with `file`, or {STYLE_BYTES:#}"
                );
                report.error(span, format!("styles add more than {STYLE_BYTES} bytes in all"), help);
                return None;
            }
        }
        Some(style)
    }

    fn unknown(&self, name: &str) -> (String, String) {
        let names: Vec<&str> = self.styles.keys().copied().take(20).collect();
        let help = match names[..] {
            [] => format!("add a table [styles.{}]", quoted(name)),
            _ => remedy(name, &names, "the styles are").replace(" or ", " and "),
        };
        (format!("there is no style \"{}\"", quoted(name)), help)
    }
}

const WRONG_STYLES: &str = "`styles` must hold tables";
