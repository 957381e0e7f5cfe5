//! Runs an analysis of any kind.

use crate::arguments::AnalysisArguments;
use crate::error::AnalysisError;
use crate::land::Land;
use crate::outcome::Outcome;
use crate::{earth, landing, movement, observation, surface, water};
use sandtable_terrain::stop_flag::StopFlag;

/// The function of a kind.
pub(crate) type KindFunction = fn(&Land, &AnalysisArguments, &StopFlag) -> Result<Outcome, AnalysisError>;

/// The functions of each family, by the names of their kinds.
const FAMILIES: [&[(&str, KindFunction)]; 6] = [
    surface::FUNCTIONS,
    movement::FUNCTIONS,
    observation::FUNCTIONS,
    landing::FUNCTIONS,
    water::FUNCTIONS,
    earth::FUNCTIONS,
];

/// Runs an analysis on the land. Its notes begin with the layers that its kind uses and the land lacks.
///
/// # Errors
/// See [`AnalysisError`].
pub fn run(land: &Land, arguments: &AnalysisArguments, stop: &StopFlag) -> Result<Outcome, AnalysisError> {
    let kind = arguments.kind();
    let function = function(kind.name).unwrap_or_else(|| panic!("{} has no function", kind.name));
    let mut outcome = function(land, arguments, stop)?;
    if stop.is_stopped() {
        return Err(AnalysisError::Stopped);
    }
    let lacking: Vec<&str> =
        kind.layers.iter().filter(|&&layer| !land.knows(layer)).map(|layer| layer.noun()).collect();
    if !lacking.is_empty() {
        outcome.notes.insert(0, format!("nothing is known of {}", lacking.join(", ")));
    }
    Ok(outcome)
}

fn function(name: &str) -> Option<KindFunction> {
    FAMILIES.into_iter().flatten().find(|&&(kind, _)| kind == name).map(|&(_, function)| function)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_kind_of_the_catalog_has_a_function_and_every_function_a_kind() {
        let kinds: Vec<&str> = sandtable_catalog::kinds().map(|kind| kind.name).collect();
        let functions: Vec<&str> = FAMILIES.into_iter().flatten().map(|&(name, _)| name).collect();
        assert!(kinds.iter().all(|name| functions.contains(name)), "{kinds:?}");
        assert!(functions.iter().all(|name| kinds.contains(name)), "{functions:?}");
    }
}
