//! Files that a scene file includes: found, laid end to end, and their tables made one.
//!
//! ```toml
//! include = ["common/roads.toml", "common/trees.toml"]
//! ```
//!
//! What an included file says comes before what the including file says:
//!
//! - repeated tables (`[[road]]` …) come before the including file's own;
//! - of tables that there is one of (`[terrain]`, `[style.light]`, `[styles.lane]` …) each key is taken that the
//!   including file does not state itself, and of keys outside tables too; of several included files the later wins.
//!
//! A file that is included more than once counts once, where it is first named. File names in an included file are
//! relative to that file, as in every other: a folder of styles and models can be moved as a whole.
//!
//! Reading goes twice over a file with an `include`: once to find what it names, while texts are still being gathered;
//! and once to read it, when all texts lie where they stay and tables can borrow from them.

use std::collections::BTreeSet;
use std::ops::Range;

use toml::Spanned;
use toml::de::{DeArray, DeTable, DeValue};

use crate::description::source_text::SourceText;
use crate::description::suggest::quoted;

/// How deep files may include files.
const MAX_DEPTH: usize = 8;
/// How many files may be included: more than anybody can keep in mind.
const MAX_FILES: usize = 64;

/// Gives the bytes of a file that is named relative to the scene file, or says why it cannot be had.
pub type Load<'a> = &'a dyn Fn(&str) -> Result<Vec<u8>, String>;

/// What is wrong with an include: where, what and what to do.
pub(super) type Refused = (Range<usize>, String, String);

/// Texts that belong together.
pub(super) struct IncludedTexts {
    /// All texts, that of the scene file first.
    pub source: SourceText,
    /// What could not be included.
    pub refused: Vec<Refused>,
    /// For each file those that it includes, as places in the list of files.
    pub includes: Vec<Vec<usize>>,
}

/// The file `name` with `text`, and all that it includes.
pub(super) fn gather(name: &str, text: &str, load: Load<'_>, max_bytes: usize) -> IncludedTexts {
    let gathered = IncludedTexts {
        source: SourceText::alone(name, text),
        refused: Vec::new(),
        includes: vec![Vec::new()],
    };
    let shown_folder = name.rfind('/').map_or("", |slash| &name[..=slash]).to_owned();
    let mut gathering =
        Gathering { gathered, load, max_bytes, shown_folder, paths: Vec::new(), seen: BTreeSet::new() };
    gathering.follow((0, 0, text));
    gathering.gathered
}

struct Gathering<'a> {
    gathered: IncludedTexts,
    load: Load<'a>,
    max_bytes: usize,
    /// The scene file's folder as messages show it.
    shown_folder: String,
    /// The files that are being read, each included by the one before.
    paths: Vec<String>,
    seen: BTreeSet<String>,
}

impl Gathering<'_> {
    /// Appends what the file with this place in the list, whose text starts here, includes.
    fn follow(&mut self, (file, start, text): (usize, usize, &str)) {
        for named in includes_of(text) {
            let span = named.span().start + start..named.span().end + start;
            match self.include(named.get_ref(), start) {
                Ok(Some((path, text))) => {
                    let included = self.append(&path, &text);
                    self.gathered.includes[file].push(included.0);
                    self.paths.push(path);
                    self.follow((included.0, included.1, &text));
                    self.paths.pop();
                }
                Ok(None) => {}
                Err((message, help)) => self.gathered.refused.push((span, message, help)),
            }
        }
    }

    /// The path and the text of a file to include; `None` where it is there already.
    fn include(&mut self, named: &str, from: usize) -> Result<Option<(String, String)>, (String, String)> {
        let path = joined(self.gathered.source.folder_at(from), named);
        let known_name = self.gathered.source.name().rsplit(['/', '\\']).next().unwrap_or_default();
        if path == known_name || self.paths.contains(&path) {
            let message = format!("'{}' includes itself by this", quoted(&path));
            return Err((message, "take what both need into a third file".into()));
        }
        if self.paths.len() >= MAX_DEPTH || self.seen.len() >= MAX_FILES {
            let message = format!("files may include files {MAX_DEPTH} deep, {MAX_FILES} in all");
            return Err((message, "name what is needed in the scene file itself".into()));
        }
        if !self.seen.insert(path.clone()) {
            return Ok(None);
        }
        let wrong =
            |reason: String| (format!("'{}' cannot be included: {reason}", quoted(named)), HELP.into());
        let bytes = (self.load)(&path).map_err(wrong)?;
        if self.gathered.source.text().len() + bytes.len() > self.max_bytes {
            return Err(wrong(format!("with it the scene has more than {} bytes", self.max_bytes)));
        }
        let text = String::from_utf8(bytes).map_err(|error| {
            let before = &error.as_bytes()[..error.utf8_error().valid_up_to()];
            let line = before.iter().filter(|&&byte| byte == b'\n').count() + 1;
            wrong(format!("its line {line} is not UTF-8 text"))
        })?;
        Ok(Some((path, text)))
    }

    /// Lays a file behind the others; returns its place in the list and where its text starts.
    fn append(&mut self, path: &str, text: &str) -> (usize, usize) {
        let folder = path.rfind('/').map_or("", |slash| &path[..=slash]);
        let shown =
            if path.starts_with('/') { path.to_owned() } else { format!("{}{path}", self.shown_folder) };
        let start = self.gathered.source.append(shown, folder.to_owned(), text);
        self.gathered.includes.push(Vec::new());
        (self.gathered.includes.len() - 1, start)
    }
}

const HELP: &str = "name a file that is there, relative to the file that includes it";

/// The file names that a text includes; what else is in it, and whether it can be read at all, is told later.
fn includes_of(text: &str) -> Vec<Spanned<String>> {
    if !text.contains("include") {
        return Vec::new();
    }
    let Ok(table) = DeTable::parse(text) else { return Vec::new() };
    let name = |value: &Spanned<DeValue<'_>>| match value.get_ref() {
        DeValue::String(name) if !name.trim().is_empty() => {
            Some(Spanned::new(value.span(), name.to_string()))
        }
        _ => None,
    };
    match table.get_ref().get("include") {
        Some(one) => match one.get_ref() {
            DeValue::Array(list) => list.iter().filter_map(name).collect(),
            _ => name(one).into_iter().collect(),
        },
        None => Vec::new(),
    }
}

/// The file `name` as seen from where `folder` is seen from; `folder` is empty or ends in `/`.
pub(super) fn joined(folder: &str, name: &str) -> String {
    let name = name.replace('\\', "/");
    if name.starts_with('/') || name.contains(':') || folder.is_empty() && !name.contains("./") {
        return name;
    }
    let mut parts: Vec<&str> = Vec::new();
    for part in folder.split('/').chain(name.split('/')) {
        match part {
            "" | "." => {}
            ".." if parts.last().is_some_and(|last| *last != "..") => drop(parts.pop()),
            _ => parts.push(part),
        }
    }
    let root = if folder.starts_with('/') { "/" } else { "" };
    format!("{root}{}", parts.join("/"))
}

/// The tables of all files as one; `tables` in the order of the list of files.
pub(super) fn merged<'i>(tables: Vec<DeTable<'i>>, includes: &[Vec<usize>]) -> DeTable<'i> {
    let mut tables: Vec<Option<DeTable<'i>>> = tables.into_iter().map(Some).collect();
    merged_from(0, &mut tables, includes)
}

fn merged_from<'i>(file: usize, tables: &mut [Option<DeTable<'i>>], includes: &[Vec<usize>]) -> DeTable<'i> {
    let mut before = DeTable::new();
    for &included in &includes[file] {
        let mut table = merged_from(included, tables, includes);
        table.remove("include");
        lay_over(&mut before, table, ListMerge::Appended);
    }
    lay_over(&mut before, tables[file].take().unwrap_or_default(), ListMerge::Appended);
    before
}

/// What becomes of a list that both sides have.
#[derive(Clone, Copy)]
enum ListMerge {
    /// The upper one's entries come after the lower one's: repeated tables, which stand only at the top.
    Appended,
    /// The upper one is taken.
    Replaced,
}

fn lay_over<'i>(lower: &mut DeTable<'i>, upper: DeTable<'i>, lists: ListMerge) {
    for (key, value) in upper {
        let Some((lower_key, mut there)) = lower.remove_entry(key.get_ref().as_ref()) else {
            lower.insert(key, value);
            continue;
        };
        match (there.get_mut(), value.get_ref(), lists) {
            (DeValue::Array(there), DeValue::Array(_), ListMerge::Appended) => {
                if let DeValue::Array(more) = value.into_inner() {
                    *there = std::mem::replace(there, DeArray::new()).into_iter().chain(more).collect();
                }
            }
            (DeValue::Table(there), DeValue::Table(_), _) => {
                if let DeValue::Table(more) = value.into_inner() {
                    lay_over(there, more, ListMerge::Replaced);
                }
            }
            _ => there = value,
        }
        lower.insert(lower_key, there);
    }
}

/// The table with every place moved by `by` bytes.
pub(super) fn moved(table: DeTable<'_>, by: usize) -> DeTable<'_> {
    let place = |span: Range<usize>| span.start + by..span.end + by;
    table
        .into_iter()
        .map(|(key, value)| {
            let span = place(key.span());
            (Spanned::new(span, key.into_inner()), moved_value(value, by))
        })
        .collect()
}

fn moved_value(value: Spanned<DeValue<'_>>, by: usize) -> Spanned<DeValue<'_>> {
    let span = value.span().start + by..value.span().end + by;
    let value = match value.into_inner() {
        DeValue::Array(list) => {
            DeValue::Array(list.into_iter().map(|value| moved_value(value, by)).collect())
        }
        DeValue::Table(table) => DeValue::Table(moved(table, by)),
        other => other,
    };
    Spanned::new(span, value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_joined_to_the_folder_of_the_file_that_names_them() {
        for (folder, name, joined_name) in [
            ("", "a.toml", "a.toml"),
            ("", "./a.toml", "a.toml"),
            ("", "../a.toml", "../a.toml"),
            ("common/", "a.toml", "common/a.toml"),
            ("common/", "../a.toml", "a.toml"),
            ("../common/", "../../a.toml", "../../a.toml"),
            ("common/", "sub\\a.toml", "common/sub/a.toml"),
            ("common/", "/data/a.tif", "/data/a.tif"),
            ("/data/", "../a.tif", "/a.tif"),
            ("common/", "https://example.org/a.tif", "https://example.org/a.tif"),
        ] {
            assert_eq!(joined(folder, name), joined_name, "{folder} {name}");
        }
    }
}
