//! The types of values that a key may be declared to have; [`crate::table_key`] has those that are tables.
//!
//! To add a type: a variant of [`KeyKind`], a line here, the method of [`KeyValue`] that reads it, and its shape in the
//! schema ([`crate::schema`]).

use std::collections::BTreeMap;
use std::marker::PhantomData;

use crate::analyses::kind_words;
use crate::bounds::Bounds;
use crate::color::{Color, RampChoice};
use crate::declaration::KeyKind;
use crate::expression::Expression;
use crate::feature_value::{FeatureValue, FeatureWord};
use crate::selection::Selection;
use crate::stated::Stated;
use crate::value::KeyValue;
use crate::words::declarations;
use sandtable_base::message::choice::Choice;
use sandtable_catalog::kind::AnalysisKind;
use sandtable_geom::crs::Crs;
use sandtable_geom::position::Position;

/// The type of a key: its declaration, and the function that reads a value of type `V`.
pub(super) struct Key<V, A = ()> {
    pub kind: KeyKind,
    pub unit: &'static str,
    pub arguments: A,
    pub read: fn(KeyValue<'_, '_>, A) -> Option<V>,
}

/// Declares types as `name<W>(arguments; unit) -> V = kind`; the method of [`KeyValue`] of the same name reads a value.
macro_rules! keys {
    ($(
        $(#[doc = $doc:literal])+
        $name:ident $(<$word:ident: $bound:ident>)? ($($argument:ident: $type:ty),* $(; $unit:ident)?)
            -> $value:ty = $kind:expr;
    )+) => {$(
        $(#[doc = $doc])+
        pub(super) const fn $name $(<$word: $bound>)? (
            $($argument: $type,)* $($unit: &'static str)?
        ) -> Key<$value, ($($type,)*)> {
            Key {
                kind: $kind,
                unit: keys!(@unit $($unit)?),
                arguments: ($($argument,)*),
                read: |value, ($($argument,)*)| value.$name($($argument),*),
            }
        }
    )+};
    (@unit) => { "" };
    (@unit $unit:ident) => { $unit };
}

keys! {
    /// A number within `range`.
    number(range: Bounds; unit) -> f64 = KeyKind::Number(range);
    /// A whole number from `least` to `most`.
    integer(least: u32, most: u32) -> u32 = KeyKind::Integer(least, most);
    /// A number within `range`, or an expression that gives one for each feature.
    feature_number(range: Bounds; unit) -> FeatureValue<f64> = KeyKind::FeatureNumber(range);
    /// Two numbers within `range`, the second not less than the first.
    number_range(range: Bounds; unit) -> [f64; 2] = KeyKind::NumberRange(range);
    /// Two directions within `range`, in any order.
    directions(range: Bounds; unit) -> [f64; 2] = KeyKind::NumberRange(range);
    /// A list of numbers within `range`, at most as many as points.
    numbers(range: Bounds; unit) -> Vec<f64> = KeyKind::Numbers(range);
    /// `true` or `false`.
    switch() -> bool = KeyKind::Switch;
    /// Text of bounded length, possibly empty.
    text() -> String = KeyKind::Text;
    /// Text that is not empty.
    filled_text() -> String = KeyKind::FilledText;
    /// Text that is not empty, or a list of such texts.
    text_list() -> Vec<String> = KeyKind::TextList;
    /// The name of a file, relative to the scene file.
    file() -> String = KeyKind::FilledText;
    /// The names of one or more files, relative to the scene file; names among `built_in` are not file names.
    files(built_in: &'static [&'static str]) -> Vec<String> = KeyKind::TextList;
    /// The names of files under names that the user chooses.
    named_files() -> BTreeMap<String, String> = KeyKind::TextTable;
    /// Texts under names that the user chooses.
    named_texts() -> BTreeMap<String, String> = KeyKind::TextTable;
    /// Any coordinate reference system.
    crs() -> Crs = KeyKind::FilledText;
    /// A coordinate reference system in meters: heights, widths and distances of a scene are.
    metric_crs() -> Crs = KeyKind::FilledText;
    /// An expression over a feature's properties.
    expression() -> Expression = KeyKind::Expression;
    /// One of the words of `W`.
    word<W: Choice>() -> W = KeyKind::Word(declarations::<W>);
    /// One of the words of `W`, or an expression that gives one for each feature.
    feature_word<W: FeatureWord>() -> FeatureValue<W> = KeyKind::FeatureWord(declarations::<W>);
    /// `#rgb`, `#rrggbb` or `#rrggbbaa`.
    color() -> Color = KeyKind::Color;
    /// A coordinate pair, or a position in words.
    point() -> Position = KeyKind::Point;
    /// At least `least` positions; the last one of a ring, of `least` 3, is not counted where it repeats the
    /// first.
    points(least: usize) -> Vec<Position> = KeyKind::Points(least);
    /// As `points`, each position with its place in the scene file.
    places(least: usize) -> Vec<Stated<Position>> = KeyKind::Points(least);
    /// The name of a color ramp, or its stops from low to high.
    ramp() -> RampChoice = KeyKind::Ramp;
    /// Which features of a file are meant: a table of properties and their values, or an expression.
    selection() -> Selection = KeyKind::Selection;
    /// A kind of analysis of the catalog.
    analysis_kind() -> &'static AnalysisKind = KeyKind::Word(kind_words);
    /// Tables of keys under names that the user chooses; gives the names.
    styles() -> Vec<String> = KeyKind::Styles;
}

/// Several keys in the table that they are declared in.
pub(super) struct Group<T, const N: usize> {
    pub kind: KeyKind,
    pub unit: &'static str,
    pub of: PhantomData<T>,
}

/// Whether tables may name a style.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Styling {
    Plain,
    Styled,
}
