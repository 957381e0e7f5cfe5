//! Analyses that have no outcome.

use glam::DVec2;

use sandtable_base::limits::memory::MemoryRefused;

/// An analysis that has no outcome.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum AnalysisError {
    /// An argument does not fit the land or the other arguments.
    #[error("`{key}` {problem}")]
    Argument {
        /// The parameter's name.
        key: &'static str,
        /// What is wrong with it and what to do, the rest of a sentence after the key.
        problem: String,
    },
    /// A position has no ground.
    #[error("`{key}` {},{}: {problem}", at.x, at.y)]
    Place {
        /// The parameter's name.
        key: &'static str,
        /// Map coordinates.
        at: DVec2,
        /// Why it has none, or what is there.
        problem: &'static str,
    },
    /// There is not enough memory.
    #[error(transparent)]
    Memory(#[from] MemoryRefused),
    /// Its caller stopped it.
    #[error("the analysis was stopped")]
    Stopped,
}

impl AnalysisError {
    /// An argument that does not fit; `problem` is the rest of a sentence after the key.
    pub fn argument(key: &'static str, problem: impl Into<String>) -> Self {
        Self::Argument { key, problem: problem.into() }
    }

    /// The parameter that is at fault, where one is.
    pub fn key(&self) -> Option<&'static str> {
        match self {
            Self::Argument { key, .. } | Self::Place { key, .. } => Some(key),
            Self::Memory(_) | Self::Stopped => None,
        }
    }
}
