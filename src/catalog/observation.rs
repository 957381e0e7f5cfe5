//! Kinds of the family observation.

use crate::kind::AnalysisKind;

/// The kinds.
pub(crate) const KINDS: &[AnalysisKind] = &[];
