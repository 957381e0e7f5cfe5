//! The shapes that a table takes of the features of a file, unplaced.

use std::collections::BTreeMap;

use crate::attributes::Attributes;
use crate::sources::Sourced;

/// The shapes of some features of a file, in its order.
pub(super) struct PickedShapes<T> {
    /// The shapes, each with the properties of its feature.
    pub shapes: Vec<Sourced<T>>,
    /// How many features match and have another shape, by kind.
    pub of_other_shape: BTreeMap<&'static str, usize>,
}

impl<T> Default for PickedShapes<T> {
    fn default() -> Self {
        Self { shapes: Vec::new(), of_other_shape: BTreeMap::new() }
    }
}

impl<T> PickedShapes<T> {
    /// Adds the shapes of a feature whose geometry is of a kind.
    pub fn add(&mut self, attributes: &Attributes, kind: &'static str, shapes: Vec<T>) {
        if shapes.is_empty() {
            *self.of_other_shape.entry(kind).or_default() += 1;
        }
        let sourced = |shape| Sourced { attributes: attributes.clone(), shape, crossings: 0 };
        self.shapes.extend(shapes.into_iter().map(sourced));
    }

    /// Adds those of the features that follow.
    pub fn append(&mut self, next: Self) {
        self.shapes.extend(next.shapes);
        for (kind, count) in next.of_other_shape {
            *self.of_other_shape.entry(kind).or_default() += count;
        }
    }
}
