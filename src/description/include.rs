//! Reads the files that a scene file includes and merges their tables.
//!
//! ```toml
//! include = ["common/roads.toml", "common/trees.toml"]
//! ```
//!
//! - Repeated tables (`[[road]]` …) of an included file come before those of the including file.
//! - Keys of single tables (`[terrain]`, `[style.light]`, `[styles.lane]` …) and keys outside tables are defaults: a key of
//!   the including file replaces them, and so does a key of a file that is included later.
//!
//! A file that several files include is merged once, at its first mention. File names in an included file are relative
//! to that file, so that a folder of styles and models can be moved as a whole.
//!
//! A file with an `include` is parsed twice: first for the names of the files that it includes, then for its tables,
//! which borrow from the concatenated texts.

use std::collections::BTreeSet;
use std::error::Error;
use std::ops::Range;

use toml::Spanned;
use toml::de::{DeArray, DeTable, DeValue};

use crate::finding_code::FindingCode;
use crate::source_text::SourceText;
use sandtable_base::limits::INCLUDE_DEPTH;
use sandtable_base::limits::INCLUDED_FILES;
use sandtable_base::limits::SCENE_BYTES;
use sandtable_base::message::suggest::quoted;

/// Reads a file that is named relative to the scene file.
pub type LoadFile<'a> = &'a dyn Fn(&str) -> Result<Vec<u8>, Box<dyn Error + Send + Sync>>;

/// Why a file cannot be included.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages explain the variants")]
pub enum IncludeError {
    #[error("'{0}' includes itself")]
    Cycle(String),
    #[error("a scene may include {INCLUDED_FILES} files, nested {INCLUDE_DEPTH} deep, which is fixed")]
    TooMany,
    #[error("'{0}' cannot be included")]
    Unreadable(String, #[source] Box<dyn Error + Send + Sync>),
    /// With the file of this name the scene would have more than so many bytes.
    #[error("'{0}' cannot be included: with it the scene has more than {1} bytes")]
    TooLarge(String, usize),
    #[error("'{0}' cannot be included: its line {1} is not UTF-8 text")]
    NotText(String, usize),
}

impl IncludeError {
    /// The code of the error.
    pub fn code(&self) -> FindingCode {
        match self {
            Self::Unreadable(..) => FindingCode::MissingFile,
            Self::NotText(..) => FindingCode::WrongFormat,
            Self::Cycle(_) | Self::TooMany | Self::TooLarge(..) => FindingCode::WrongValue,
        }
    }

    /// The remedy.
    pub fn help(&self) -> String {
        match self {
            Self::Cycle(_) => "move the tables that both files need to a third one".to_owned(),
            Self::TooMany => {
                format!("write the tables in the scene file itself; for more files {INCLUDED_FILES:#}")
            }
            Self::TooLarge(..) => format!("put long lists of points in vector files, or {SCENE_BYTES:#}"),
            _ => "name an existing file, relative to the file that includes it".to_owned(),
        }
    }
}

/// The texts of a scene file and of all files that it includes.
pub(super) struct IncludedTexts {
    /// All texts, that of the scene file first.
    pub source: SourceText,
    /// The errors, each with the span of the file name.
    pub errors: Vec<(Range<usize>, IncludeError)>,
    /// For each file but the first, the place that names it.
    pub named: Vec<Range<usize>>,
    /// For each file, the indices of the files that it includes.
    pub includes: Vec<Vec<usize>>,
}

/// Reads all files that the scene file `name` with the text `text` includes.
pub(super) fn gather(name: &str, text: &str, load: LoadFile<'_>, max_bytes: usize) -> IncludedTexts {
    let gathered = IncludedTexts {
        source: SourceText::alone(name, text),
        errors: Vec::new(),
        named: Vec::new(),
        includes: vec![Vec::new()],
    };
    let shown_folder = folder_of(name).to_owned();
    let mut gathering =
        Gathering { gathered, load, max_bytes, shown_folder, open: Vec::new(), seen: BTreeSet::new() };
    gathering.follow(0, 0, text);
    gathering.gathered
}

struct Gathering<'a> {
    gathered: IncludedTexts,
    load: LoadFile<'a>,
    max_bytes: usize,
    /// The scene file's folder as messages show it.
    shown_folder: String,
    /// The files that are being read, each included by the one before.
    open: Vec<String>,
    seen: BTreeSet<String>,
}

impl Gathering<'_> {
    /// Reads the files that `text` includes, the text of `file`, which begins at byte `start`.
    fn follow(&mut self, file: usize, start: usize, text: &str) {
        for named in includes_of(text) {
            match self.include(named.get_ref(), start) {
                Ok(Some((path, text))) => {
                    self.gathered.named.push(named.span().start + start..named.span().end + start);
                    let start = self.append(&path, &text);
                    let included = self.gathered.includes.len() - 1;
                    self.gathered.includes[file].push(included);
                    self.open.push(path);
                    self.follow(included, start, &text);
                    self.open.pop();
                }
                Ok(None) => {}
                Err(error) => {
                    let span = named.span().start + start..named.span().end + start;
                    self.gathered.errors.push((span, error));
                }
            }
        }
    }

    /// The path and the text of an included file; `None` where it is included already.
    fn include(&mut self, named: &str, from: usize) -> Result<Option<(String, String)>, IncludeError> {
        let source = &self.gathered.source;
        let path = joined(source.folder_at(from), named);
        let own_name = source.name().rsplit(['/', '\\']).next().unwrap_or_default();
        if path == own_name || self.open.contains(&path) {
            return Err(IncludeError::Cycle(quoted(&path)));
        }
        if self.open.len() >= INCLUDE_DEPTH.count() || self.seen.len() >= INCLUDED_FILES.count() {
            return Err(IncludeError::TooMany);
        }
        if !self.seen.insert(path.clone()) {
            return Ok(None);
        }
        let name = quoted(named);
        let bytes = (self.load)(&path).map_err(|error| IncludeError::Unreadable(name.clone(), error))?;
        if source.text().len() + bytes.len() > self.max_bytes {
            return Err(IncludeError::TooLarge(name, self.max_bytes));
        }
        let text = String::from_utf8(bytes).map_err(|error| {
            let before = &error.as_bytes()[..error.utf8_error().valid_up_to()];
            IncludeError::NotText(name, before.iter().filter(|&&byte| byte == b'\n').count() + 1)
        })?;
        Ok(Some((path, text)))
    }

    /// Appends a file to the list and returns the first byte of its text.
    fn append(&mut self, path: &str, text: &str) -> usize {
        let shown = if path.starts_with('/') { "" } else { &self.shown_folder };
        self.gathered.includes.push(Vec::new());
        self.gathered.source.append(format!("{shown}{path}"), folder_of(path).to_owned(), text)
    }
}

/// The folder of a path, empty or with a `/` at its end.
fn folder_of(path: &str) -> &str {
    path.rfind('/').map_or("", |slash| &path[..=slash])
}

/// The file names under `include`; [`parse`](crate::parse) reports syntax errors later.
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
    match table.get_ref().get("include").map(|named| (named, named.get_ref())) {
        Some((_, DeValue::Array(list))) => list.iter().filter_map(name).collect(),
        Some((one, _)) => name(one).into_iter().collect(),
        None => Vec::new(),
    }
}

/// The path of the file `name` in `folder`, relative to the same place as `folder`, which is empty or ends in `/`.
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

/// Merges the table of a file with the tables of the files that it includes; takes each out of `tables`.
pub(super) fn merged<'i>(file: usize, tables: &mut [DeTable<'i>], includes: &[Vec<usize>]) -> DeTable<'i> {
    let mut before = DeTable::new();
    for &included in &includes[file] {
        let mut table = merged(included, tables, includes);
        table.remove("include");
        lay_over(&mut before, table, ListMerge::Append);
    }
    lay_over(&mut before, std::mem::take(&mut tables[file]), ListMerge::Append);
    before
}

/// For each file, whether a value of its text is left in `root`, which is merged of all; `starts` holds the first bytes of
/// the texts.
pub(super) fn files_with_values(root: &DeTable<'_>, starts: &[usize]) -> Vec<bool> {
    let mut has_value = vec![false; starts.len()];
    root.values().for_each(|value| mark_file(value, starts, &mut has_value));
    has_value
}

fn mark_file(value: &Spanned<DeValue<'_>>, starts: &[usize], has_value: &mut [bool]) {
    match value.get_ref() {
        DeValue::Table(table) => table.values().for_each(|value| mark_file(value, starts, has_value)),
        DeValue::Array(list) if !list.is_empty() => {
            list.iter().for_each(|value| mark_file(value, starts, has_value));
        }
        _ => {
            let file = starts.partition_point(|&start| start <= value.span().start).saturating_sub(1);
            has_value[file] = true;
        }
    }
}

/// How two lists under one key are merged.
#[derive(Clone, Copy)]
enum ListMerge {
    /// The upper list follows the lower one: repeated tables, which occur only at the top level.
    Append,
    /// The upper list replaces the lower one.
    Replace,
}

fn lay_over<'i>(lower: &mut DeTable<'i>, upper: DeTable<'i>, lists: ListMerge) {
    for (key, value) in upper {
        let Some((lower_key, mut merged)) = lower.remove_entry(key.get_ref().as_ref()) else {
            lower.insert(key, value);
            continue;
        };
        let span = value.span();
        match (merged.get_mut(), value.into_inner(), lists) {
            (DeValue::Array(list), DeValue::Array(more), ListMerge::Append) => {
                *list = std::mem::replace(list, DeArray::new()).into_iter().chain(more).collect();
            }
            (DeValue::Table(table), DeValue::Table(more), _) => lay_over(table, more, ListMerge::Replace),
            (_, value, _) => merged = Spanned::new(span, value),
        }
        lower.insert(lower_key, merged);
    }
}

/// The table with every span moved by `by` bytes.
pub(super) fn moved(table: DeTable<'_>, by: usize) -> DeTable<'_> {
    let entry = |(key, value): (Spanned<_>, _)| {
        (Spanned::new(key.span().start + by..key.span().end + by, key.into_inner()), moved_value(value, by))
    };
    table.into_iter().map(entry).collect()
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
