//! Nested lists of numbers: how CityJSON states boundaries, and which surface has which semantics, material and texture.
//!
//! Each kind of geometry nests its surfaces in as many lists as it has levels, and the lists beside the boundaries nest
//! the same way:
//!
//! ```text
//!  MultiSolid [ Solid [ shell [ surface [ ring [ vertex, ...] ] ] ] ]
//!  MultiSurface                        [ surface [ ring [ vertex, ...] ] ]
//! ```

use std::fmt;

use serde::de::{Deserialize, Deserializer, SeqAccess, Visitor};

/// A number, `null` or a list of such.
#[derive(Debug, PartialEq)]
pub(super) enum Nested {
    Null,
    Index(usize),
    List(Vec<Nested>),
}

impl Nested {
    /// The items of a list; none of a number.
    pub fn items(&self) -> &[Nested] {
        if let Self::List(items) = self { items } else { &[] }
    }

    /// The number; `None` of a list and of `null`.
    pub fn index(&self) -> Option<usize> {
        if let Self::Index(index) = self { Some(*index) } else { None }
    }

    /// The item at `index` of a list; a number holds for all that is nested below it.
    pub fn at(&self, index: usize) -> Option<&Nested> {
        match self {
            Self::Null => None,
            Self::Index(_) => Some(self),
            Self::List(items) => items.get(index),
        }
    }
}

impl<'de> Deserialize<'de> for Nested {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(NestedVisitor)
    }
}

struct NestedVisitor;

impl<'de> Visitor<'de> for NestedVisitor {
    type Value = Nested;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("a whole number of at least 0, null, or a list of such")
    }

    fn visit_unit<E>(self) -> Result<Nested, E> {
        Ok(Nested::Null)
    }

    fn visit_u64<E: serde::de::Error>(self, value: u64) -> Result<Nested, E> {
        usize::try_from(value).map(Nested::Index).map_err(E::custom)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut items: A) -> Result<Nested, A::Error> {
        let mut list = Vec::new();
        while let Some(item) = items.next_element()? {
            list.push(item);
        }
        Ok(Nested::List(list))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_nest_and_a_number_holds_for_all_below_it() {
        let nested: Nested = serde_json::from_str("[[0, null], 7]").expect("nested");
        let semantics = |shell: usize, surface: usize| {
            nested.at(shell).and_then(|shell| shell.at(surface)).and_then(Nested::index)
        };
        assert_eq!(semantics(0, 0), Some(0));
        assert_eq!(semantics(0, 1), None);
        assert_eq!(semantics(0, 2), None);
        assert_eq!(semantics(1, 9), Some(7));
        assert!(serde_json::from_str::<Nested>("[-1]").is_err());
        assert!(serde_json::from_str::<Nested>("[1.5]").is_err());
    }
}
