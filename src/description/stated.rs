//! A value of the scene file with its place.

use std::ops::{Deref, Range};

/// A value and the bytes of the scene file that state it, for messages about it. Read it by dereferencing.
#[derive(Clone, Debug, PartialEq)]
pub struct Stated<T> {
    value: T,
    span: Option<Range<usize>>,
}

impl<T> Stated<T> {
    /// `value`, stated by the bytes `span`.
    pub fn new(value: T, span: Range<usize>) -> Self {
        Self { value, span: Some(span) }
    }

    /// `value`, which the scene file does not state: a default.
    pub fn unstated(value: T) -> Self {
        Self { value, span: None }
    }

    /// The value where the scene file states it; `None` for a default.
    pub fn stated(&self) -> Option<&T> {
        self.span.is_some().then_some(&self.value)
    }

    /// The bytes that state the value; `None` for a default.
    pub fn span(&self) -> Option<Range<usize>> {
        self.span.clone()
    }

    /// The value without its place.
    pub fn into_value(self) -> T {
        self.value
    }
}

impl<T> Deref for Stated<T> {
    type Target = T;

    fn deref(&self) -> &T {
        &self.value
    }
}
