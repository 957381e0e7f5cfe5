//! Definitions of a scene file that no table uses.

use crate::stated::Stated;

/// Names of definitions that have no effect, each with its place.
#[derive(Clone, Debug, Default)]
pub struct UnusedDefinitions {
    /// Styles of the scene file itself that no table names; an included file may hold styles for many scenes.
    pub styles: Vec<Stated<String>>,
    /// Phases that no table names.
    pub phases: Vec<Stated<String>>,
    /// Included files without effect.
    pub includes: Vec<UnusedInclude>,
}

/// An included file without effect.
#[derive(Clone, Debug)]
pub struct UnusedInclude {
    /// Its name as it is stated.
    pub name: Stated<String>,
    /// Whether it states nothing; else all that it states is stated again by files that follow it.
    pub is_empty: bool,
}
