//! Kinds of the family landing.

use crate::kind::AnalysisKind;

/// The kinds.
pub(crate) const KINDS: &[AnalysisKind] = &[];
