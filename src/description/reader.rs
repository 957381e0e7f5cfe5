//! Reads the keys of one table and reports unknown and missing ones.
//!
//! Hand-written on spanned TOML values: a derived deserializer stops at the first error, loses the span of a value
//! inside a flattened struct, and cannot suggest the nearest key.

use std::ops::Range;
use std::sync::Arc;

use toml::Spanned;
use toml::de::{DeString, DeTable, DeValue};

use crate::declaration::{KeyDeclaration, Presence};
use crate::decode_context::DecodeContext;
use crate::finding_code::FindingCode;
use crate::key::{Group, Key, Styling, filled_text, text_list};
use crate::phases::PHASES_KEY;
use crate::source_text::SourceText;
use crate::stated::Stated;
use crate::styles::STYLE_KEY;
use crate::table::{DefaultedField, Field, Table};
use crate::table_name::TableName;
use crate::unused::UnusedDefinitions;
use crate::value::{KeyValue, type_name};
use sandtable_base::limits::SCENE_TABLES;
use sandtable_base::message::suggest::{listed, nearest, quoted};

type TableEntry<'r> = (&'r Spanned<DeString<'r>>, &'r Spanned<DeValue<'r>>);

/// One table while it is read.
pub(super) struct TableReader<'r, 't> {
    context: &'r mut DecodeContext<'t>,
    table: &'r DeTable<'r>,
    keys: &'static [KeyDeclaration],
    styling: Styling,
    /// Keys that the table takes where it does not state them.
    style: Option<&'r DeTable<'r>>,
    name: TableName,
    span: Range<usize>,
    missing: Vec<&'static str>,
}

impl<'r, 't> TableReader<'r, 't> {
    /// Reads the tables of a whole scene file.
    pub fn read_root<T: Table>(context: &'r mut DecodeContext<'t>, table: &'r DeTable<'r>) -> Option<T> {
        TableReader::read(context, table, (TableName::default(), 0..0), Styling::Plain)
    }

    fn read<T: Table<N>, const N: usize>(
        context: &'r mut DecodeContext<'t>,
        table: &'r DeTable<'r>,
        (name, span): (TableName, Range<usize>),
        styling: Styling,
    ) -> Option<T> {
        let (keys, missing) = (T::KEYS, Vec::new());
        let mut reader = TableReader { context, table, keys, styling, style: None, name, span, missing };
        if styling == Styling::Styled {
            reader.take_style();
        }
        let value = T::read(&mut reader);
        let is_there = reader.is_in_phase();
        reader.finish();
        value.filter(|_| is_there)
    }

    /// Whether the table is there in the phase that the scene is read for.
    fn is_in_phase(&mut self) -> bool {
        if self.styling == Styling::Plain {
            return true;
        }
        let stated = self.stated(&PHASES_KEY, &text_list());
        let DecodeContext { phases, report, .. } = &mut *self.context;
        stated.is_none_or(|stated| phases.hold(&stated, report))
    }

    /// The phase that the scene is read for.
    pub fn phase(&mut self) -> Option<String> {
        self.context.phases.chosen()
    }

    /// The definitions that no table uses; those of the whole scene once all its tables are read.
    pub fn unused(&mut self) -> UnusedDefinitions {
        let DecodeContext { report, styles, phases, unused_includes, .. } = &mut *self.context;
        let source = report.source();
        let is_own = |name: &Stated<String>| {
            name.span().is_some_and(|span| source.name_at(span.start) == source.name())
        };
        UnusedDefinitions {
            styles: styles.unused().into_iter().filter(is_own).collect(),
            phases: phases.unused(),
            includes: std::mem::take(unused_includes),
        }
    }

    pub fn source(&mut self) -> Arc<SourceText> {
        Arc::clone(self.context.report.source())
    }

    pub fn error(&mut self, span: Range<usize>, message: impl Into<String>, help: impl Into<String>) {
        self.context.report.error(span, message.into(), help);
    }

    /// As [`Self::error`], with a code of its own.
    pub fn coded(
        &mut self,
        code: FindingCode,
        span: Range<usize>,
        message: impl Into<String>,
        help: impl Into<String>,
    ) {
        self.context.report.coded(code, span, message.into(), help);
    }

    /// The span of a key; `None` where the key is absent.
    pub fn key_span(&self, key: &str) -> Option<Range<usize>> {
        Some(self.entry(key)?.0.span())
    }

    /// The span of a key's value; `None` where the key is absent.
    pub fn value_span(&self, key: &str) -> Option<Range<usize>> {
        Some(self.entry(key)?.1.span())
    }

    /// Reports an error where both `key` and `other` are stated.
    pub fn exclude(&mut self, key: &str, other: &str) {
        if let (Some(span), Some(_)) = (self.key_span(key), self.key_span(other)) {
            let message = format!("{} has both `{other}` and `{key}`", self.name.title());
            self.error(span, message, "keep one of them");
        }
    }

    /// Reports an error at each of `keys` that is stated. `reason` completes "has no effect".
    pub fn without_effect(&mut self, keys: &[&str], reason: &str, help: &str) {
        for key in keys {
            if let Some(span) = self.key_span(key) {
                let message = format!("`{key}` has no effect {reason}");
                self.coded(FindingCode::NoEffect, span, message, help);
            }
        }
    }

    /// Reports a table with neither `key` nor `other`, unless an unknown key is near one of them.
    pub fn need_either(&mut self, key: &str, other: &str, help: &str) {
        let misspelled = |unknown: TableEntry<'_>| nearest(unknown.0.get_ref(), [key, other]).is_some();
        let is_there = self.key_span(key).or(self.key_span(other)).is_some();
        if !is_there && !self.unknown().into_iter().any(misspelled) {
            let message = format!("{} has neither `{key}` nor `{other}`", self.name.title());
            self.coded(FindingCode::MissingKey, self.span.clone(), message, help);
        }
    }

    /// Reports an error where the text of `key` is not an expression.
    pub fn need_expression(&mut self, key: &str) {
        if let Some((name, value)) = self.entry(key) {
            let key_span = name.span();
            // The error is all that counts: what uses the text parses it again.
            let _ = KeyValue { context: self.context, table: &self.name, key, key_span, value }.expression();
        }
    }

    /// The text of a key; `None` where it is absent or no text.
    pub fn word(&self, key: &str) -> Option<&'r str> {
        self.entry(key)?.1.get_ref().as_str()
    }

    /// Reads a key with `read`: `None` where it is absent, and `Some(None)` where its value is wrong.
    pub fn read_with<V>(
        &mut self,
        key: &str,
        read: impl FnOnce(KeyValue<'_, '_>) -> Option<V>,
    ) -> Option<Option<Stated<V>>> {
        let (name, value) = self.entry(key)?;
        let stated = KeyValue { context: self.context, table: &self.name, key, key_span: name.span(), value };
        Some(read(stated).map(|read| Stated::new(read, value.span())))
    }

    /// Notes that a key is missing.
    pub fn lacks(&mut self, key: &'static str) {
        self.missing.push(key);
    }

    /// Reads a required key; `None` where it is missing or its value is wrong.
    pub fn required<V, A: Copy, F: Field<V>>(
        &mut self,
        declared: &'static KeyDeclaration,
        key: Key<V, A>,
    ) -> Option<F> {
        if self.entry(declared.name).is_none() {
            self.missing.push(declared.name);
        }
        self.stated(declared, &key).map(F::from_stated)
    }

    /// Reads a key that may be absent; never `None`.
    pub fn otherwise<V, A: Copy, F: Field<V>>(
        &mut self,
        declared: &'static KeyDeclaration,
        key: Key<V, A>,
    ) -> Option<Option<F>> {
        Some(self.stated(declared, &key).map(F::from_stated))
    }

    /// Reads a key with a default; never `None`.
    pub fn default<V, A: Copy, F: DefaultedField<V>>(
        &mut self,
        declared: &'static KeyDeclaration,
        key: Key<V, A>,
    ) -> Option<F> {
        let Presence::Default(text) = declared.presence else { return None };
        let stated = self.stated(declared, &key);
        let value = DeValue::parse(text).expect("a declared default is a TOML value");
        let default = self.decode(declared.name, (0..0, &value), &key);
        Some(F::from_stated_or(stated, default.expect("a declared default has the type of its key")))
    }

    pub fn inline<T: Table<N>, const N: usize>(
        &mut self,
        _: &'static KeyDeclaration,
        _: Group<T, N>,
    ) -> Option<T> {
        T::read(self)
    }

    fn stated<V, A: Copy>(&mut self, declared: &KeyDeclaration, key: &Key<V, A>) -> Option<Stated<V>> {
        let (name, value) = self.entry(declared.name)?;
        let read = self.decode(declared.name, (name.span(), value), key)?;
        Some(Stated::new(read, value.span()))
    }

    fn decode<V, A: Copy>(
        &mut self,
        name: &str,
        (key_span, value): (Range<usize>, &Spanned<DeValue<'_>>),
        key: &Key<V, A>,
    ) -> Option<V> {
        let value = KeyValue { context: self.context, table: &self.name, key: name, key_span, value };
        (key.read)(value, key.arguments)
    }

    /// A key of the table or of its style.
    fn entry(&self, key: &str) -> Option<TableEntry<'r>> {
        self.table.get_key_value(key).or_else(|| {
            self.style.filter(|_| !self.is_rivaled(key)).and_then(|style| style.get_key_value(key))
        })
    }

    /// Whether the table states a key in place of `key`.
    fn is_rivaled(&self, key: &str) -> bool {
        let declared = KeyDeclaration::flattened(self.keys).find(|declared| declared.name == key);
        declared.is_some_and(|key| key.rivals.iter().any(|rival| self.table.contains_key(*rival)))
    }

    fn take_style(&mut self) {
        if let Some(name) = self.stated(&STYLE_KEY, &filled_text()) {
            let DecodeContext { styles, report, .. } = &mut *self.context;
            self.style = styles.take(&name, report);
        }
    }

    fn known(&self) -> Vec<&'static str> {
        let common = [STYLE_KEY.name, PHASES_KEY.name];
        let common = common.into_iter().filter(|_| self.styling == Styling::Styled);
        common.chain(KeyDeclaration::flattened(self.keys).map(|key| key.name)).collect()
    }

    /// The keys of the table and of its style that are not declared.
    fn unknown(&self) -> Vec<TableEntry<'r>> {
        let known = self.known();
        let style = self.style.into_iter().flatten();
        let style = style.filter(|(key, _)| !self.table.contains_key(key.get_ref().as_ref()));
        let all = self.table.iter().chain(style);
        all.filter(|(key, _)| !known.contains(&key.get_ref().as_ref())).collect()
    }

    /// Reports unknown keys, and missing ones unless an unknown key is near them.
    fn finish(mut self) {
        let (known, mut misspelled) = (self.known(), Vec::new());
        for (key, _) in self.unknown() {
            if self.context.report.is_full() {
                // Only counted, so it needs no message.
                self.error(key.span(), "", "");
                continue;
            }
            let meant = nearest(key.get_ref(), known.iter().copied());
            misspelled.extend(meant);
            let message = format!("unknown key `{}` in {}", quoted(key.get_ref()), self.name.title());
            let help = self.help_for_unknown(key.get_ref(), meant);
            self.coded(FindingCode::UnknownKey, key.span(), message, help);
        }
        for key in std::mem::take(&mut self.missing) {
            if !misspelled.contains(&key) {
                self.report_missing(key);
            }
        }
    }

    fn help_for_unknown(&self, key: &str, meant: Option<&str>) -> String {
        let at_the_top = self.context.scene_keys.iter().filter(|top| top.inner().is_empty());
        match meant {
            Some(meant) => format!("did you mean `{meant}`?"),
            None if !self.name.is_root() && at_the_top.clone().any(|top| top.name == key) => {
                format!("`{key}` belongs to the whole scene: write it at the top, before the first [table]")
            }
            None => {
                format!("{} knows {}", self.name.title(), listed(&self.known()).replace(" or ", " and "))
            }
        }
    }

    fn report_missing(&mut self, key: &str) {
        let title = self.name.title();
        let (message, help) = if self.name.is_root() {
            (
                format!("{title} has no [{key}] table"),
                format!("add a line [{key}] and the keys it needs below it"),
            )
        } else {
            (format!("{title} needs the key `{key}`"), format!("add a line `{key} = ...` below it"))
        };
        self.coded(FindingCode::MissingKey, self.span.clone(), message, help);
    }
}

impl KeyValue<'_, '_> {
    pub fn table<T: Table<N>, const N: usize>(mut self) -> Option<T> {
        let name = self.table.inner(self.key, false);
        self.table_named(name, Styling::Plain)
    }

    /// A list of tables without the wrong ones.
    pub fn tables<T: Table>(mut self, styling: Styling) -> Option<Vec<T>> {
        let name = self.table.inner(self.key, true);
        let (key, title) = (self.key, name.title());
        match self.value.get_ref() {
            DeValue::Array(rows) if rows.len() > SCENE_TABLES.count() => {
                let message =
                    format!("{} {title} tables are more than the {SCENE_TABLES} allowed", rows.len());
                let help =
                    format!("put them in a GeoJSON file and name it once with `file`, or {SCENE_TABLES:#}");
                self.context.report.error(self.key_span, message, help);
                None
            }
            DeValue::Array(rows) => {
                let row = |row| self.element(row).table_named(name.clone(), styling);
                Some(rows.iter().filter_map(row).collect())
            }
            DeValue::Table(_) => {
                let help = format!("write {title} with double brackets: there may be several");
                self.wrong_as(
                    FindingCode::WrongType,
                    format!("`{key}` is a list of tables, not one table"),
                    help,
                )
            }
            _ => self.wrong_type("a list of tables", format!("start each with {title}")),
        }
    }

    /// Tables under names that the user chooses, without the wrong ones.
    pub fn named_tables<T: Table>(mut self) -> Option<Vec<(Stated<String>, T)>> {
        let name = self.table.inner(self.key, false);
        let DeValue::Table(tables) = self.value.get_ref() else {
            return self.wrong_type("tables with names", format!("start each with [{}.NAME]", name.dotted()));
        };
        if tables.len() > SCENE_TABLES.count() {
            let message = format!(
                "{} [{}] tables are more than the {SCENE_TABLES} allowed",
                tables.len(),
                name.dotted()
            );
            return self.wrong(message, format!("leave some out, or {SCENE_TABLES:#}"));
        }
        let read = |(key, value): (&Spanned<DeString<'_>>, _)| {
            let title = name.inner(&quoted(key.get_ref()), false);
            let table = self.element(value).table_named(title, Styling::Plain)?;
            Some((Stated::new(key.get_ref().to_string(), key.span()), table))
        };
        Some(tables.iter().filter_map(read).collect())
    }

    fn table_named<T: Table<N>, const N: usize>(&mut self, name: TableName, styling: Styling) -> Option<T> {
        let DeValue::Table(table) = self.value.get_ref() else {
            let found = type_name(self.value.get_ref());
            let message = format!("`{}` must be a table, but this is {found}", name.dotted());
            return self.wrong_as(FindingCode::WrongType, message, format!("start it with {}", name.title()));
        };
        TableReader::read(self.context, table, (name, self.value.span()), styling)
    }
}
