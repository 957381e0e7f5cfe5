//! The origin of a feature.

use std::ops::Range;

/// The place in the scene file, and in the vector file, that made a feature.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct FeatureOrigin {
    /// The bytes of the scene file that state its points, or the name of the file that holds it.
    pub span: Range<usize>,
    /// Its number among the features of that file, from 1; `None` where the scene file states its points.
    pub number: Option<usize>,
}

impl FeatureOrigin {
    /// The origin of a feature that the scene file states at the bytes `span`.
    pub fn stated(span: Option<Range<usize>>) -> Self {
        Self { span: span.unwrap_or_default(), number: None }
    }
}
