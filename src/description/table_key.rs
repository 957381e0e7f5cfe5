//! The types of keys whose values are tables, or several keys of the table itself.

use std::marker::PhantomData;

use crate::analyses::DescribedArguments;
use crate::declaration::KeyKind;
use crate::feature_source::FeatureSource;
use crate::key::{Group, Key, Styling};
use crate::stated::Stated;
use crate::table::Table;
use crate::value::KeyValue;

pub(super) const fn table<T: Table>() -> Key<T> {
    Key { kind: KeyKind::Table(T::KEYS), unit: "", arguments: (), read: |value, ()| value.table::<T, 0>() }
}

/// A table with the keys of a source of at least `LEAST` points.
pub(super) const fn source_table<const LEAST: usize>() -> Key<FeatureSource> {
    let kind = KeyKind::Table(<FeatureSource as Table<LEAST>>::KEYS);
    Key { kind, unit: "", arguments: (), read: |value, ()| value.table::<_, LEAST>() }
}

pub(super) const fn tables<T: Table>() -> Key<Vec<T>> {
    let read = |value: KeyValue<'_, '_>, ()| value.tables(Styling::Plain);
    Key { kind: KeyKind::Tables(T::KEYS), unit: "", arguments: (), read }
}

/// A list of tables, each of which may take keys from a style.
pub(super) const fn styled_tables<T: Table>() -> Key<Vec<T>> {
    let read = |value: KeyValue<'_, '_>, ()| value.tables(Styling::Styled);
    Key { kind: KeyKind::StyledTables(T::KEYS), unit: "", arguments: (), read }
}

/// Tables of keys under names that the user chooses.
pub(super) const fn named_tables<T: Table>() -> Key<Vec<(Stated<String>, T)>> {
    let read = |value: KeyValue<'_, '_>, ()| value.named_tables();
    Key { kind: KeyKind::NamedTables(T::KEYS), unit: "", arguments: (), read }
}

/// The parameters of the kind of analysis that the table names.
pub(super) const fn analysis_arguments() -> Group<DescribedArguments, 0> {
    Group { kind: KeyKind::AnalysisArguments, unit: "", of: PhantomData }
}

/// The keys of a source of at least `LEAST` points.
pub(super) const fn source<const LEAST: usize>() -> Group<FeatureSource, LEAST> {
    Group { kind: KeyKind::Group(<FeatureSource as Table<LEAST>>::KEYS), unit: "", of: PhantomData }
}
