//! The types of values that a key may be declared to have.
//!
//! To add a type: a variant of [`KeyKind`], a function here that names it and the method of [`KeyValue`] that reads it,
//! and its shape in the schema ([`crate::description::schema`]).

use std::collections::BTreeMap;
use std::marker::PhantomData;

use crate::description::bounds::Bounds;
use crate::description::color::{Color, RampChoice};
use crate::description::declaration::KeyKind;
use crate::description::expression::Expression;
use crate::description::feature_value::FeatureValue;
use crate::description::features::FeatureSource;
use crate::description::selection::Selection;
use crate::description::table::Table;
use crate::description::value::{KeyValue, MAX_LIST, MAX_POINTS};
use crate::description::words::{RampName, Word};
use crate::geom::crs::Crs;

/// The type of a key: what is declared of it, and how a value of type `V` is read.
pub(super) struct Key<V, A = ()> {
    pub kind: KeyKind,
    pub unit: &'static str,
    arguments: A,
    read: fn(KeyValue<'_, '_>, A) -> Option<V>,
}

impl<V> Key<V> {
    const fn plain(kind: KeyKind, read: fn(KeyValue<'_, '_>, ()) -> Option<V>) -> Self {
        Self::new(kind, "", (), read)
    }
}

impl<V, A: Copy> Key<V, A> {
    const fn new(
        kind: KeyKind,
        unit: &'static str,
        arguments: A,
        read: fn(KeyValue<'_, '_>, A) -> Option<V>,
    ) -> Self {
        Self { kind, unit, arguments, read }
    }

    /// The value, or `None` with an error noted.
    pub fn read(&self, value: KeyValue<'_, '_>) -> Option<V> {
        (self.read)(value, self.arguments)
    }
}

/// A number within `range`.
pub(super) const fn number(range: Bounds, unit: &'static str) -> Key<f64, Bounds> {
    Key::new(KeyKind::Number(range), unit, range, |value, range| value.number(range))
}

/// A whole number from `least` to `most`.
pub(super) const fn integer(least: u32, most: u32) -> Key<u32, (u32, u32)> {
    Key::new(KeyKind::Integer { least, most }, "", (least, most), |value, (least, most)| {
        value.integer(least, most)
    })
}

/// A number within `range`, or an expression that gives one for each feature.
pub(super) const fn feature_number(range: Bounds, unit: &'static str) -> Key<FeatureValue<f64>, Bounds> {
    Key::new(KeyKind::FeatureNumber(range), unit, range, |value, range| value.feature_number(range))
}

/// Two numbers within `range`, from and to.
pub(super) const fn number_range(range: Bounds, unit: &'static str) -> Key<[f64; 2], Bounds> {
    Key::new(KeyKind::NumberRange(range), unit, range, |value, range| value.number_range(range))
}

/// A list of numbers within `range`.
pub(super) const fn numbers(range: Bounds, unit: &'static str) -> Key<Vec<f64>, Bounds> {
    Key::new(KeyKind::Numbers { range, most: MAX_POINTS }, unit, range, |value, range| value.numbers(range))
}

/// `true` or `false`.
pub(super) const fn switch() -> Key<bool> {
    Key::plain(KeyKind::Switch, |value, ()| value.switch())
}

/// Text, possibly empty.
pub(super) const fn text() -> Key<String> {
    Key::plain(KeyKind::Text, |value, ()| value.text())
}

/// Text that is not empty.
pub(super) const fn filled_text() -> Key<String> {
    Key::plain(KeyKind::FilledText, |value, ()| value.filled_text())
}

/// Text that is not empty, or a list of such texts.
pub(super) const fn text_list() -> Key<Vec<String>> {
    Key::plain(KeyKind::TextList { most: MAX_LIST }, |value, ()| value.text_list())
}

/// The name of a file; it is read as seen from the scene file.
pub(super) const fn file() -> Key<String> {
    Key::plain(KeyKind::FilledText, |value, ()| value.file())
}

/// The names of one or more files; a name among `built_in` stays as it is.
pub(super) const fn files(built_in: &'static [&'static str]) -> Key<Vec<String>, &'static [&'static str]> {
    Key::new(KeyKind::TextList { most: MAX_LIST }, "", built_in, |value, built_in| value.files(built_in))
}

/// The names of files under names that the user chooses.
pub(super) const fn named_files() -> Key<BTreeMap<String, String>> {
    Key::plain(KeyKind::TextTable { most: MAX_LIST }, |value, ()| value.named_files())
}

/// Any coordinate reference system.
pub(super) const fn crs() -> Key<Crs> {
    Key::plain(KeyKind::FilledText, |value, ()| value.crs())
}

/// A coordinate reference system in meters.
pub(super) const fn metric_crs() -> Key<Crs> {
    Key::plain(KeyKind::FilledText, |value, ()| value.metric_crs())
}

/// An expression over a feature's properties.
pub(super) const fn expression() -> Key<Expression> {
    Key::plain(KeyKind::Expression, |value, ()| value.expression())
}

/// One of the words of `W`.
pub(super) const fn word<W: Word>() -> Key<W> {
    Key::plain(KeyKind::Word(W::DECLARATIONS), |value, ()| value.word())
}

/// One of the words of `W`, or an expression that gives one for each feature.
pub(super) const fn feature_word<W: Word>() -> Key<FeatureValue<W>> {
    Key::plain(KeyKind::FeatureWord(W::DECLARATIONS), |value, ()| value.feature_word())
}

/// A color.
pub(super) const fn color() -> Key<Color> {
    Key::plain(KeyKind::Color, |value, ()| value.color())
}

/// A coordinate pair.
pub(super) const fn point() -> Key<[f64; 2]> {
    Key::plain(KeyKind::Point, |value, ()| value.point())
}

/// At least `least` coordinate pairs.
pub(super) const fn points(least: usize) -> Key<Vec<[f64; 2]>, usize> {
    Key::new(KeyKind::Points { least, most: MAX_POINTS }, "", least, |value, least| value.points(least))
}

/// The name of a color ramp, or its stops.
pub(super) const fn ramp() -> Key<RampChoice> {
    Key::plain(KeyKind::Ramp { words: RampName::DECLARATIONS, most: MAX_LIST }, |value, ()| value.ramp())
}

/// Which features of a file are meant.
pub(super) const fn selection() -> Key<Selection> {
    Key::plain(KeyKind::Selection { most: MAX_LIST }, |value, ()| value.selection())
}

/// A table.
pub(super) const fn table<T: Table>() -> Key<T> {
    Key::plain(KeyKind::Table(T::KEYS), |value, ()| value.table::<T, 0>())
}

/// A table with the keys of a source of at least `LEAST` points.
pub(super) const fn source_table<const LEAST: usize>() -> Key<FeatureSource> {
    Key::plain(KeyKind::Table(<FeatureSource as Table<LEAST>>::KEYS), |value, ()| value.table::<_, LEAST>())
}

/// A list of tables.
pub(super) const fn tables<T: Table>() -> Key<Vec<T>> {
    Key::plain(KeyKind::Tables(T::KEYS), |value, ()| value.tables(Styling::Plain))
}

/// A list of tables, each of which may take keys from a style.
pub(super) const fn styled_tables<T: Table>() -> Key<Vec<T>> {
    Key::plain(KeyKind::StyledTables(T::KEYS), |value, ()| value.tables(Styling::Styled))
}

/// Tables of keys under names that the user chooses; gives the names.
pub(super) const fn styles() -> Key<Vec<String>> {
    Key::plain(KeyKind::Styles, |value, ()| value.style_names())
}

/// Several keys in the table that they are declared in.
pub(super) struct Group<T, const N: usize> {
    pub kind: KeyKind,
    pub unit: &'static str,
    of: PhantomData<T>,
}

/// The keys of a source of at least `LEAST` points.
pub(super) const fn source<const LEAST: usize>() -> Group<FeatureSource, LEAST> {
    Group { kind: KeyKind::Group(<FeatureSource as Table<LEAST>>::KEYS), unit: "", of: PhantomData }
}

/// Whether tables may name a style.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Styling {
    Plain,
    Styled,
}
