//! The declaration of a key: name, documentation, type, unit, range and default.
//!
//! The macro `table!` makes these declarations. The decoder, the JSON schema, the reference
//! page `scenes/README.md` and the messages read them.

use std::iter;

use crate::analyses::argument_keys;
use crate::bounds::Bounds;
use crate::words::WordDeclaration;
use sandtable_catalog::parameter::ParameterForm;

/// One key of a table.
#[derive(Clone, Copy, Debug)]
pub struct KeyDeclaration {
    /// The key as a scene file writes it.
    pub name: &'static str,
    /// One sentence or a few: what the value means.
    pub doc: &'static str,
    /// The type of the value and its range.
    pub kind: KeyKind,
    /// The unit of a number, such as `m`; empty where it has none.
    pub unit: &'static str,
    /// Whether the key may be absent, and its default.
    pub presence: Presence,
    /// Alternatives to this key: a table that states one of them does not take this one from its style.
    pub rivals: &'static [&'static str],
}

/// Whether a table may lack a key.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Presence {
    /// The key must be present.
    Required,
    /// The default, written as in a scene file.
    Default(&'static str),
    /// The default in words.
    Otherwise(&'static str),
    /// The declaration is of several keys in the same table ([`KeyKind::Group`]).
    Inline,
}

/// The type of a value, with its range.
#[derive(Clone, Copy, Debug)]
pub enum KeyKind {
    /// A number.
    Number(Bounds),
    /// A whole number from the first to the second.
    Integer(u32, u32),
    /// A number, or an expression that gives one for each feature.
    FeatureNumber(Bounds),
    /// `true` or `false`.
    Switch,
    /// Text, possibly empty.
    Text,
    /// Text that is not empty.
    FilledText,
    /// Text that is not empty, or a list of such texts.
    TextList,
    /// The name of a file, a table of one with other keys, or a list of them.
    FilesOrTables(&'static [KeyDeclaration]),
    /// A table of texts under names that the user chooses.
    TextTable,
    /// An expression over a feature's properties.
    Expression,
    /// One of some words.
    Word(fn() -> Vec<WordDeclaration>),
    /// One of some words, or an expression that gives one for each feature.
    FeatureWord(fn() -> Vec<WordDeclaration>),
    /// A color.
    Color,
    /// A coordinate pair.
    Point,
    /// A list of at least this many coordinate pairs.
    Points(usize),
    /// Two numbers, from and to.
    NumberRange(Bounds),
    /// A list of numbers.
    Numbers(Bounds),
    /// The name of a color ramp ([`RampName`](crate::words::RampName)), or a list of its stops.
    Ramp,
    /// A table of properties with the values wanted of each, or an expression.
    Selection,
    /// A table.
    Table(&'static [KeyDeclaration]),
    /// A list of tables.
    Tables(&'static [KeyDeclaration]),
    /// A list of tables, each of which may take keys from a style.
    StyledTables(&'static [KeyDeclaration]),
    /// Tables of keys under names that the user chooses.
    Styles,
    /// Several keys in the same table.
    Group(&'static [KeyDeclaration]),
    /// Tables of these keys under names that the user chooses.
    NamedTables(&'static [KeyDeclaration]),
    /// The parameters of all kinds of analysis, several keys in the same table.
    AnalysisArguments,
    /// An argument of an analysis, in one of these forms by the analysis' kind.
    Argument(&'static [ParameterForm]),
}

impl KeyDeclaration {
    /// The keys of the table or group that the declaration is of; empty for a value.
    pub fn inner(&self) -> &'static [Self] {
        match self.kind {
            KeyKind::Table(keys)
            | KeyKind::Tables(keys)
            | KeyKind::StyledTables(keys)
            | KeyKind::NamedTables(keys)
            | KeyKind::Group(keys) => keys,
            KeyKind::AnalysisArguments => argument_keys(),
            _ => &[],
        }
    }

    /// The keys of a table, those of its groups one by one.
    pub fn flattened(keys: &'static [Self]) -> Box<dyn Iterator<Item = &'static Self>> {
        Box::new(keys.iter().flat_map(|key| match key.kind {
            KeyKind::Group(inner) => Self::flattened(inner),
            KeyKind::AnalysisArguments => Self::flattened(argument_keys()),
            _ => Box::new(iter::once(key)),
        }))
    }

    /// The documentation as one line.
    pub fn doc(&self) -> &'static str {
        self.doc.trim_ascii()
    }
}
