//! Kinds of the family movement.

use crate::kind::AnalysisKind;

/// The kinds.
pub(crate) const KINDS: &[AnalysisKind] = &[];
