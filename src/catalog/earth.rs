//! Kinds of the family earth.

use crate::kind::AnalysisKind;

/// The kinds.
pub(crate) const KINDS: &[AnalysisKind] = &[];
