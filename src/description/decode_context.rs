//! The state that the readers of all tables of a scene file share: errors found so far, styles, phases.

use crate::declaration::KeyDeclaration;
use crate::diagnostic::DiagnosticSink;
use crate::phases::Phases;
use crate::styles::Styles;
use crate::unused::UnusedInclude;

/// The state that the readers of all tables share.
pub(super) struct DecodeContext<'t> {
    pub report: DiagnosticSink,
    pub styles: Styles<'t>,
    pub phases: Phases<'t>,
    /// The included files without effect.
    pub unused_includes: Vec<UnusedInclude>,
    /// The keys of the whole scene, for messages about one that a table states in its place.
    pub scene_keys: &'static [KeyDeclaration],
}
