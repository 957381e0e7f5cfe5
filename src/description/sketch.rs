//! What the decoder asks for, written down while it asks.
//!
//! The scene file's schema is not written beside the decoder, where the two would drift apart, but by it: a reader can be
//! told to sketch ([`crate::description::reader::ObjReader::sketch_root`]). It then has no table to read; each key that is
//! asked for goes into a [`SchemaProbe`] with the [`KeyShape`] that its value must have, and the decoder runs as always.

use std::ops::RangeInclusive;

use crate::description::bounds::Bounds;

/// A table's keys, in the order in which they are asked for.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct SchemaProbe {
    pub keys: Vec<KeyProbe>,
}

/// One key.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct KeyProbe {
    pub name: &'static str,
    pub needed: Needed,
    pub part: KeyPart,
}

/// Whether a table can do without a key.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Needed {
    Yes,
    No,
}

/// What stands under a key.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum KeyPart {
    Value(KeyShape),
    /// A table.
    Table(SchemaProbe),
    /// Any number of tables.
    Tables(SchemaProbe),
    /// A table for each name that the user chooses.
    Named,
}

/// What a value must be.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum KeyShape {
    Number(Bounds),
    Whole(RangeInclusive<u32>),
    /// A number or an expression.
    Quantity(Bounds),
    Switch,
    /// Text; may be empty.
    Text,
    FilledText,
    /// Text or a list of up to so many.
    OneOrMoreTexts(usize),
    /// A table of up to so many texts.
    Texts(usize),
    Expression,
    /// One of these words.
    Word(Vec<&'static str>),
    /// One of these words or an expression.
    Choice(Vec<&'static str>),
    Color,
    Point,
    /// From the first number to the second of points.
    Points(usize, usize),
    /// Two numbers.
    Range(Bounds),
    /// Up to so many numbers.
    Numbers(Bounds, usize),
    /// One of these words, or up to so many heights with colors.
    Ramp(Vec<&'static str>, usize),
    /// A table of values or lists of up to so many, or an expression.
    Filter(usize),
}
