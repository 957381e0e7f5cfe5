//! Kinds of the family water.

use crate::kind::AnalysisKind;

/// The kinds.
pub(crate) const KINDS: &[AnalysisKind] = &[];
