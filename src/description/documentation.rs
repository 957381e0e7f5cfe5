//! What the tables' documentation says of each key, for people who write scene files.
//!
//! The structs of [`crate::description::document`] and [`crate::description::features`] are the reference of what a
//! scene file may say: each field's documentation begins with its key and ends with its default. Editors should show
//! just that. A second copy of these sentences would soon say something else, so this reads the first one, out of the
//! source text itself:
//!
//! ```text
//! /// `[[road]]`.                                            ◄── the table
//! pub struct Road {
//!     /// `width`: of the carriageway, in (0, 10 000]. Default 6.
//!     pub width: Option<Spanned<Quantity>>,
//! ```
//!
//! A field that stands for several keys (`points`, `file` …) says nothing of them singly; they are those of [`Source`],
//! and so are the keys that a table's own documentation does not have.
//!
//! [`Source`]: crate::description::features::Source

use std::collections::BTreeMap;

use serde_json::Value;

/// The source texts that document the keys.
const TEXTS: [&str; 2] = [include_str!("document.rs"), include_str!("features.rs")];
/// The struct whose keys stand in the tables of others.
const SHARED: &str = "Source";

/// Keys that are used up while a scene file is read, so that no struct has a field for them.
const USED_UP: [(&str, &str, &str); 3] = [
    (
        "",
        "include",
        "`include`: a scene file, or a list of them, whose tables come before this one's; what this one states counts. \
         Names are relative to the file that they stand in. Default: none.",
    ),
    (
        "",
        "styles",
        "`[styles.NAME]`: keys for the tables of features that name it with `style`. Default: none.",
    ),
    (
        SHARED,
        "style",
        "`style`: the keys of that `[styles.NAME]` are taken that this table does not state. Default: none.",
    ),
];

/// What is said of every key.
pub(super) struct Documentation {
    /// By table, as in `style.light`, and key.
    said: BTreeMap<(String, String), String>,
}

impl Documentation {
    /// All of it.
    pub fn read() -> Self {
        let mut documentation = Self { said: BTreeMap::new() };
        for (table, key, text) in USED_UP {
            documentation.add(table, text);
            debug_assert!(documentation.said.contains_key(&(table.into(), key.into())));
        }
        for text in TEXTS {
            documentation.read_text(text);
        }
        documentation
    }

    /// A sentence or more about a key, fit for a tooltip.
    pub fn of(&self, table: &str, key: &str) -> Option<&str> {
        let said = |table: &str| self.said.get(&(table.to_owned(), key.to_owned()));
        said(table).or_else(|| said(SHARED)).map(String::as_str)
    }

    fn read_text(&mut self, text: &str) {
        let (mut table, mut comment) = (None, String::new());
        for line in text.lines().map(str::trim) {
            if let Some(more) = line.strip_prefix("///") {
                comment.push_str(more);
                continue;
            }
            if let Some(name) = line.strip_prefix("pub struct ") {
                table = table_of(name.trim_end_matches([' ', '{']), comment.trim());
            } else if let Some(table) = &table
                && line.starts_with("pub ")
                && line.ends_with(',')
            {
                self.add(table, comment.trim());
            }
            if !line.starts_with("#[") {
                comment.clear();
            }
        }
    }

    /// Keeps what a comment says, unless it is about several keys.
    fn add(&mut self, table: &str, comment: &str) {
        let Some((key, rest)) = comment.strip_prefix('`').and_then(|rest| rest.split_once('`')) else {
            return;
        };
        if rest.starts_with(", `") || rest.starts_with(" and `") {
            return;
        }
        let rest = rest.trim_start_matches([':', '.', ',', ' ']);
        let key = key.trim_matches(['[', ']']).trim_end_matches(".NAME");
        let key = key.rsplit('.').next().unwrap_or(key);
        self.said.entry((table.to_owned(), key.to_owned())).or_insert_with(|| sentence(rest));
    }
}

/// The table that a struct is: as in `style.light`, empty for the whole file; `None` where it is none.
fn table_of(name: &str, comment: &str) -> Option<String> {
    match name {
        "Document" => Some(String::new()),
        SHARED => Some(SHARED.into()),
        _ => {
            let (table, _) = comment.strip_prefix("`[")?.split_once('`')?;
            Some(table.trim_matches(['[', ']']).to_owned())
        }
    }
}

/// The default that a text ends with, where it is a number, a word or a list.
pub(super) fn default_of(text: &str) -> Option<Value> {
    let (_, stated) = text.rsplit_once("Default ")?;
    let written = match stated.strip_prefix('`') {
        Some(quoted) => quoted.split_once('`')?.0,
        None => {
            let end = stated.find(|letter: char| !letter.is_ascii_digit() && !"-.".contains(letter));
            stated[..end.unwrap_or(stated.len())].trim_end_matches('.')
        }
    };
    serde_json::from_str(written).ok()
}

/// The text with a capital at its beginning.
fn sentence(text: &str) -> String {
    let mut letters = text.chars();
    letters
        .next()
        .map_or_else(String::new, |first| first.to_uppercase().collect::<String>() + letters.as_str())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fields_documentation_is_found_by_table_and_key() {
        let all = Documentation::read();
        let width = all.of("road", "width").expect("documented");
        assert!(width.starts_with("Of the carriageway") && width.ends_with("Default 6."), "{width}");
        assert!(all.of("road", "surface").expect("words").ends_with("Default `\"asphalt\"`."));
        assert!(all.of("road", "points").expect("shared").starts_with("Inline coordinates"));
        assert!(all.of("style", "contours").expect("a table").starts_with("Contour lines"));
        assert!(all.of("terrain", "dem").expect("needed").starts_with("Needed: the elevation file"));
        assert_eq!(all.of("road", "wheels"), None);
    }

    #[test]
    fn defaults_that_are_values_are_read_and_others_are_not() {
        assert_eq!(default_of("In (0, 10]. Default 6."), Some(Value::from(6)));
        assert_eq!(default_of("Meters. Default 1.5."), Some(Value::from(1.5)));
        assert_eq!(default_of("Default 315 (north-west)."), Some(Value::from(315)));
        assert_eq!(default_of("Default `\"asphalt\"`."), Some(Value::from("asphalt")));
        assert_eq!(default_of("Default `[0.8, 1.2]`."), Some(serde_json::json!([0.8, 1.2])));
        assert_eq!(default_of("Default: any."), None);
    }
}
