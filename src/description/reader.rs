//! Takes the keys out of one TOML table, one by one; what is left over at the end was not known.
//!
//! Hand-written rather than derived: a derived deserializer stops at the first error, loses the place of a
//! value inside flattened structs, and cannot say which key was meant. Here reading never stops, and every
//! key that is asked for is thereby known, so that the list of valid keys cannot drift from the code.

use std::ops::Range;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use crate::description::diagnostic::DiagnosticSink;
use crate::description::item::{KeyValue, kind_of};
use crate::description::sketch::{KeyPart, KeyProbe, Needed, SchemaProbe};
use crate::description::source_text::SourceText;
use crate::description::suggest::{listed, nearest, quoted};

/// The most tables of one kind (`[[road]]`, `[[label]]` …) in a scene; far above what a picture can show.
const MAX_TABLES: usize = 10_000;
/// Keys that stand before the first table, and end up in the wrong one when written after it.
const TOP_KEYS: [&str; 5] = ["include", "title", "subtitle", "crs", "points_crs"];

/// One table while it is read.
pub(super) struct TableReader<'r, 'i> {
    report: &'r mut DiagnosticSink,
    table: DeTable<'i>,
    path: Path,
    span: Range<usize>,
    known: Vec<&'static str>,
    missing: Vec<&'static str>,
    /// What was asked for, where nothing is read.
    sketch: Option<SchemaProbe>,
}

/// What a table is called.
#[derive(Clone, Debug, Default, PartialEq)]
struct Path {
    dotted: String,
    repeated: bool,
}

impl Path {
    fn inside(&self, key: &str, repeated: bool) -> Self {
        let dot = if self.dotted.is_empty() { "" } else { "." };
        Self { dotted: format!("{}{dot}{key}", self.dotted), repeated }
    }

    /// `[style.light]`, `[[road]]` or `the scene file`.
    fn title(&self) -> String {
        match (self.dotted.as_str(), self.repeated) {
            ("", _) => "the scene file".into(),
            (dotted, true) => format!("[[{dotted}]]"),
            (dotted, false) => format!("[{dotted}]"),
        }
    }
}

impl<'r, 'i> TableReader<'r, 'i> {
    /// Reads the whole file's table with `decode`.
    pub fn read_root<T>(
        report: &'r mut DiagnosticSink,
        table: DeTable<'i>,
        decode: impl FnOnce(&mut TableReader<'_, 'i>) -> T,
    ) -> T {
        TableReader::read(report, table, Path::default(), 0..0, decode)
    }

    fn read<T>(
        report: &'r mut DiagnosticSink,
        table: DeTable<'i>,
        path: Path,
        span: Range<usize>,
        decode: impl FnOnce(&mut TableReader<'_, 'i>) -> T,
    ) -> T {
        let (known, missing) = (Vec::new(), Vec::new());
        let mut reader = TableReader { report, table, path, span, known, missing, sketch: None };
        let value = decode(&mut reader);
        reader.finish();
        value
    }

    /// What `decode` asks of the whole file's table. It is given nothing, and what it says is not listened to.
    pub fn sketch_root<T>(decode: impl FnOnce(&mut TableReader<'_, 'i>) -> T) -> SchemaProbe {
        let mut report = DiagnosticSink::new(SourceText::new("", ""));
        TableReader::sketch(&mut report, Path::default(), decode)
    }

    fn sketch<T>(
        report: &mut DiagnosticSink,
        path: Path,
        decode: impl FnOnce(&mut TableReader<'_, 'i>) -> T,
    ) -> SchemaProbe {
        let mut reader = TableReader {
            report,
            table: DeTable::new(),
            path,
            span: 0..0,
            known: Vec::new(),
            missing: Vec::new(),
            sketch: Some(SchemaProbe::default()),
        };
        decode(&mut reader);
        reader.sketch.unwrap_or_default()
    }

    /// Writes down a key.
    fn note(&mut self, name: &'static str, needed: Needed, part: KeyPart) {
        if let Some(sketch) = &mut self.sketch {
            sketch.keys.push(KeyProbe { name, needed, part });
        }
    }

    /// Writes down a key with a value, where nothing is read.
    fn note_value<T>(
        &mut self,
        (key, needed): (&'static str, Needed),
        decode: impl FnOnce(KeyValue<'_, 'i>) -> Option<T>,
    ) {
        let nothing = Spanned::new(0..0, DeValue::Boolean(false));
        let mut shape = None;
        decode(KeyValue { report: self.report, key, value: &nothing, asked: Some(&mut shape) });
        let shape = shape.expect("every way to read a value begins by writing down what it asks for");
        self.note(key, needed, KeyPart::Value(shape));
    }

    /// The table's header or, for an inline table, all of it.
    pub fn span(&self) -> Range<usize> {
        self.span.clone()
    }

    /// `[style.light]`, `[[road]]` or `the scene file`.
    pub fn title(&self) -> String {
        self.path.title()
    }

    /// Notes an error.
    pub fn error(&mut self, span: Range<usize>, message: impl Into<String>, help: impl Into<String>) {
        self.report.error(span, message, Some(help.into()));
    }

    /// Where `key` stands, whatever its value; `None` where it is absent. To be asked before its value.
    pub fn has(&self, key: &str) -> Option<Range<usize>> {
        self.table.get_key_value(key).map(|(key, _)| key.span())
    }

    /// Notes an error about the table, unless a key that is none looks like one of `keys` misspelled.
    pub fn error_if_unexplained(&mut self, keys: &[&'static str], message: String, help: &str) {
        let explains = |unknown: &str| nearest(unknown, keys.iter().copied()).is_some();
        let asked_for = |key: &str| self.known.contains(&key);
        if !self.table.keys().any(|key| !asked_for(key.get_ref()) && explains(key.get_ref())) {
            self.error(self.span(), message, help);
        }
    }

    /// The value of `key` as `decode` understands it; `None` where the key is absent or its value wrong.
    pub fn get<T>(
        &mut self,
        key: &'static str,
        decode: impl FnOnce(KeyValue<'_, 'i>) -> Option<T>,
    ) -> Option<Spanned<T>> {
        if self.sketch.is_some() {
            self.note_value((key, Needed::No), decode);
            return None;
        }
        let (_, value) = self.take(key)?;
        self.decode(key, &value, decode)
    }

    /// As [`Self::get`], but the key must be there.
    pub fn require<T>(
        &mut self,
        key: &'static str,
        decode: impl FnOnce(KeyValue<'_, 'i>) -> Option<T>,
    ) -> Option<Spanned<T>> {
        if self.sketch.is_some() {
            self.note_value((key, Needed::Yes), decode);
            return None;
        }
        let Some((_, value)) = self.take(key) else {
            self.missing.push(key);
            return None;
        };
        self.decode(key, &value, decode)
    }

    /// The table `key`, `None` where it is absent.
    pub fn table<T>(
        &mut self,
        key: &'static str,
        decode: impl FnOnce(&mut TableReader<'_, 'i>) -> T,
    ) -> Option<T> {
        self.one_table((key, Needed::No), decode)
    }

    /// As [`Self::table`], but the table must be there.
    pub fn require_table<T>(
        &mut self,
        key: &'static str,
        decode: impl FnOnce(&mut TableReader<'_, 'i>) -> T,
    ) -> Option<T> {
        if !self.table.contains_key(key) {
            self.missing.push(key);
        }
        self.one_table((key, Needed::Yes), decode)
    }

    fn one_table<T>(
        &mut self,
        (key, needed): (&'static str, Needed),
        decode: impl FnOnce(&mut TableReader<'_, 'i>) -> T,
    ) -> Option<T> {
        let path = self.path.inside(key, false);
        if self.sketch.is_some() {
            let sketch = TableReader::sketch(self.report, path, decode);
            self.note(key, needed, KeyPart::Table(sketch));
            return None;
        }
        let (_, value) = self.take(key)?;
        self.nested(value, path, decode)
    }

    /// The tables of `key`, each under a name of the user's, with the place of their names; those that are none are left
    /// out.
    pub fn named_tables(&mut self, key: &'static str) -> Vec<(Spanned<String>, DeTable<'i>)> {
        self.note(key, Needed::No, KeyPart::Named);
        let path = self.path.inside(key, false);
        let Some((_, value)) = self.take(key) else { return Vec::new() };
        let wrong = format!("`{key}` must hold tables");
        let DeValue::Table(tables) = value.get_ref() else {
            self.error(value.span(), wrong, format!("start each with [{}.NAME]", path.dotted));
            return Vec::new();
        };
        let mut named = Vec::new();
        for (name, table) in tables {
            match table.get_ref() {
                DeValue::Table(table) => {
                    named.push((Spanned::new(name.span(), name.get_ref().to_string()), table.clone()));
                }
                _ => self.error(name.span(), &wrong, format!("start each with [{}.NAME]", path.dotted)),
            }
        }
        named
    }

    /// Adds keys, each unless it is there or `unless` says so.
    pub fn add_keys(&mut self, keys: &DeTable<'i>, unless: impl Fn(&DeTable<'i>, &str) -> bool) {
        let stated: DeTable<'i> = keys
            .iter()
            .filter(|(key, _)| {
                !self.table.contains_key(key.get_ref().as_ref()) && !unless(&self.table, key.get_ref())
            })
            .map(|(key, value)| (key.clone(), value.clone()))
            .collect();
        self.table.extend(stated);
    }

    /// All tables `[[key]]`; those that are wrong are left out.
    pub fn tables<T>(
        &mut self,
        key: &'static str,
        decode: impl Fn(&mut TableReader<'_, 'i>) -> Option<T>,
    ) -> Vec<T> {
        let path = self.path.inside(key, true);
        if self.sketch.is_some() {
            let sketch = TableReader::sketch(self.report, path, &decode);
            self.note(key, Needed::No, KeyPart::Tables(sketch));
            return Vec::new();
        }
        let Some((name, value)) = self.take(key) else { return Vec::new() };
        let span = value.span();
        match value.into_inner() {
            DeValue::Array(rows) if rows.len() > MAX_TABLES => {
                let message =
                    format!("{} {} tables are more than the {MAX_TABLES} allowed", rows.len(), path.title());
                self.error(name.span(), message, "put them in a GeoJSON file and name it once with `file`");
                Vec::new()
            }
            DeValue::Array(rows) => {
                rows.into_iter().filter_map(|row| self.nested(row, path.clone(), &decode).flatten()).collect()
            }
            DeValue::Table(_) => {
                let help = format!("write {} with double brackets: there may be several", path.title());
                self.error(span, format!("`{key}` is a list of tables, not one table"), help);
                Vec::new()
            }
            other => {
                let message = format!("`{key}` must be a list of tables, but this is {}", kind_of(&other));
                self.error(span, message, format!("start each with {}", path.title()));
                Vec::new()
            }
        }
    }

    fn take(
        &mut self,
        key: &'static str,
    ) -> Option<(Spanned<std::borrow::Cow<'i, str>>, Spanned<DeValue<'i>>)> {
        self.known.push(key);
        self.table.remove_entry(key)
    }

    fn decode<T>(
        &mut self,
        key: &str,
        value: &Spanned<DeValue<'i>>,
        decode: impl FnOnce(KeyValue<'_, 'i>) -> Option<T>,
    ) -> Option<Spanned<T>> {
        decode(KeyValue { report: self.report, key, value, asked: None })
            .map(|decoded| Spanned::new(value.span(), decoded))
    }

    fn nested<T>(
        &mut self,
        value: Spanned<DeValue<'i>>,
        path: Path,
        decode: impl FnOnce(&mut TableReader<'_, 'i>) -> T,
    ) -> Option<T> {
        let span = value.span();
        match value.into_inner() {
            DeValue::Table(table) => Some(TableReader::read(self.report, table, path, span, decode)),
            other => {
                let message = format!("`{}` must be a table, but this is {}", path.dotted, kind_of(&other));
                self.error(span, message, format!("start it with {}", path.title()));
                None
            }
        }
    }

    /// Reports the keys that nobody asked for, and the keys that were needed and are not there unless a
    /// misspelled one explains it.
    fn finish(mut self) {
        let mut explained = Vec::new();
        for (key, _) in std::mem::take(&mut self.table) {
            if self.report.is_full() {
                self.error(key.span(), "", "");
                continue;
            }
            let meant = nearest(key.get_ref(), self.known.iter().copied());
            explained.extend(meant);
            let message = format!("unknown key `{}` in {}", quoted(key.get_ref()), self.title());
            let help = self.help_for_unknown(key.get_ref(), meant);
            self.error(key.span(), message, help);
        }
        for key in std::mem::take(&mut self.missing) {
            if !explained.contains(&key) {
                self.report_missing(key);
            }
        }
    }

    fn help_for_unknown(&self, key: &str, meant: Option<&str>) -> String {
        match meant {
            Some(meant) => format!("did you mean `{meant}`?"),
            None if !self.path.dotted.is_empty() && TOP_KEYS.contains(&key) => {
                format!("`{key}` belongs to the whole scene: write it at the top, before the first [table]")
            }
            None => format!("{} knows {}", self.title(), listed(&self.known).replace(" or ", " and ")),
        }
    }

    fn report_missing(&mut self, key: &str) {
        if self.path.dotted.is_empty() {
            let message = format!("{} has no [{key}] table", self.title());
            self.error(self.span(), message, format!("add a line [{key}] and the keys it needs below it"));
        } else {
            let message = format!("{} needs the key `{key}`", self.title());
            self.error(self.span(), message, format!("add a line `{key} = ...` below it"));
        }
    }
}
