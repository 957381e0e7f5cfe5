//! The macro that declares tables of the scene file: struct, decoder and list of keys of each, from one block.
//!
//! To add a key to a table, add its documentation and one line to the block:
//!
//! ```text
//! /// Width of the carriageway.                                        ◄── the schema and the reference page show it
//! width: DefaultedValue<f64> = feature_number(Above(0.0, 1e4), "m"), default 6;
//!   │      │                     │                                   └── or: required / otherwise "what holds then"
//!   │      │                     └── type, range and unit: a function of `key`
//!   │      └── T, or Stated<T> where messages point at the value; in Option where it follows `otherwise`
//!   └── the key; `field as "key"` where they differ
//! ```
//!
//! `, unless ["other"]` may follow: a table that states `other` does not take this key from its style. `inline` in
//! place of `default` puts the keys of a whole group into the table. Checks of several keys together follow the keys,
//! in `check(reader) { … }`, where every key is an `Option` named as its field: `None` where the key is required and
//! missing.

use crate::declaration::KeyDeclaration;
use crate::feature_value::{DefaultedValue, FeatureValue, FromScalar};
use crate::reader::TableReader;
use crate::stated::Stated;

/// A table, or a group of keys in one. `N` is the least number of points, where it holds points.
pub(super) trait Table<const N: usize = 0>: Sized {
    /// Its keys, in the order of declaration.
    const KEYS: &'static [KeyDeclaration];

    /// Reads the table and reports its errors; `None` where a required key is missing or wrong.
    fn read(reader: &mut TableReader<'_, '_>) -> Option<Self>;
}

/// A field for a value that the scene file states: the value, with or without its place.
pub(super) trait Field<V> {
    fn from_stated(stated: Stated<V>) -> Self;
}

impl<V> Field<V> for V {
    fn from_stated(stated: Stated<V>) -> Self {
        stated.into_value()
    }
}

impl<V> Field<V> for Stated<V> {
    fn from_stated(stated: Stated<V>) -> Self {
        stated
    }
}

/// A field for a value or, where the scene file does not state it, its default.
pub(super) trait DefaultedField<V> {
    fn from_stated_or(stated: Option<Stated<V>>, default: V) -> Self;
}

impl<V> DefaultedField<V> for V {
    fn from_stated_or(stated: Option<Stated<V>>, default: V) -> Self {
        stated.map_or(default, Stated::into_value)
    }
}

impl<V> DefaultedField<V> for Stated<V> {
    fn from_stated_or(stated: Option<Stated<V>>, default: V) -> Self {
        stated.unwrap_or_else(|| Self::unstated(default))
    }
}

impl<T: FromScalar> DefaultedField<FeatureValue<T>> for DefaultedValue<T> {
    fn from_stated_or(stated: Option<Stated<FeatureValue<T>>>, default: FeatureValue<T>) -> Self {
        match default {
            FeatureValue::Fixed(default) => Self::new(stated, default),
            FeatureValue::Computed { key, .. } => panic!("the declared default of {key} is a value"),
        }
    }
}

/// Declares tables; see the head of this file.
macro_rules! table {
    ($(
        $(#[$attribute:meta])*
        struct $table:ident $([const $least:ident: usize])? {
            $(with $extra:ident: $extra_type:ty = $extra_value:expr, $extra_doc:literal;)*
            $(
                $(#[doc = $doc:literal])+
                $field:ident $(as $name:literal)?: $type:ty = $key:expr, $presence:ident $($otherwise:expr)?
                    $(, unless [$($rival:literal),+])?;
            )+
        }
        $(check($check_reader:ident) $check:block)?
    )+) => {$(
        $(#[$attribute])*
        #[derive(Clone, Debug)]
        pub struct $table {
            $(
                #[doc = $extra_doc]
                pub $extra: $extra_type,
            )*
            $(
                $(#[doc = $doc])+
                #[doc = concat!("\n\n`", stringify!($key), "`, ", stringify!($presence $($otherwise)?), ".")]
                pub $field: $type,
            )+
        }

        impl $(<const $least: usize>)? Table $(<$least>)? for $table {
            const KEYS: &'static [KeyDeclaration] = &[$(
                KeyDeclaration {
                    name: table!(@name $field $($name)?),
                    doc: concat!($($doc),+),
                    kind: $key.kind,
                    unit: $key.unit,
                    presence: table!(@presence $presence $($otherwise)?),
                    rivals: &[$($($rival),+)?],
                },
            )+];

            fn read(reader: &mut TableReader<'_, '_>) -> Option<Self> {
                let mut declarations = <Self as Table $(<$least>)?>::KEYS.iter();
                $(let $field: Option<$type> = reader.$presence(declarations.next()?, $key);)+
                $({
                    let $check_reader = &mut *reader;
                    $check
                })?
                Some(Self { $($extra: ($extra_value)(reader),)* $($field: $field?),+ })
            }
        }
    )+};
    (@name $field:ident) => { stringify!($field) };
    (@name $field:ident $name:literal) => { $name };
    (@presence required) => { Presence::Required };
    (@presence inline) => { Presence::Inline };
    (@presence default $value:expr) => { Presence::Default(stringify!($value)) };
    (@presence otherwise $text:literal) => { Presence::Otherwise($text) };
}
