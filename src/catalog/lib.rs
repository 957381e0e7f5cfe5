//! The kinds of terrain analysis, as data: what each computes, its parameters, its source and its limits.
//!
//! The scene file, the command line, the HTTP service, the Python package and the window read this one list, so that a
//! kind has the same parameters, ranges and defaults everywhere. It computes nothing: `sandtable-analysis` does.
//!
//! ```
//! use sandtable_catalog::kind;
//!
//! let slope = kind("slope").expect("a kind");
//! assert_eq!(slope.parameter("unit").map(|parameter| parameter.default_text()), Some("percent"));
//! ```

mod earth;
pub mod kind;
mod landing;
mod movement;
mod observation;
pub mod parameter;
mod surface;
mod water;

use crate::kind::AnalysisKind;

/// The kinds of each family, in the order in which people read them.
const FAMILIES: [&[AnalysisKind]; 6] =
    [surface::KINDS, movement::KINDS, observation::KINDS, landing::KINDS, water::KINDS, earth::KINDS];

/// All kinds, family by family.
pub fn kinds() -> impl Iterator<Item = &'static AnalysisKind> {
    FAMILIES.into_iter().flatten()
}

/// The kind of this name; `None` where there is none.
pub fn kind(name: &str) -> Option<&'static AnalysisKind> {
    kinds().find(|kind| kind.name == name)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kind::{AnalysisReach, AnalysisYield};
    use crate::parameter::{ParameterDefault, ParameterForm};
    use std::collections::BTreeSet;

    #[test]
    fn names_of_kinds_and_of_the_parameters_of_a_kind_are_unique() {
        let mut names = BTreeSet::new();
        for kind in kinds() {
            assert!(names.insert(kind.name), "{} is there twice", kind.name);
            let mut parameters = BTreeSet::new();
            for parameter in kind.all_parameters() {
                assert!(
                    parameters.insert(parameter.name),
                    "{} of {} is there twice",
                    parameter.name,
                    kind.name
                );
            }
        }
    }

    #[test]
    fn every_kind_states_its_source_and_what_it_does_not_know() {
        for kind in kinds() {
            assert!(!kind.source.is_empty() && !kind.limits.is_empty(), "{}", kind.name);
            assert!(kind.summary.ends_with('.'), "{}: a sentence", kind.name);
        }
    }

    #[test]
    fn what_can_be_parted_gives_a_raster_and_no_features_but_its_places() {
        // Other features of two parts would meet at their border.
        for kind in kinds() {
            let (places, range) = match kind.reach {
                AnalysisReach::Whole => continue,
                AnalysisReach::Between { places, range } | AnalysisReach::Around { places, range } => {
                    (places, range)
                }
                _ => {
                    assert_eq!(kind.yields, AnalysisYield::Raster, "{}", kind.name);
                    continue;
                }
            };
            let form = |name: &str| kind.parameter(name).map(|parameter| parameter.form);
            assert!(matches!(form(places), Some(ParameterForm::Points { .. })), "{}", kind.name);
            assert!(matches!(form(range), Some(ParameterForm::Number { .. })), "{}", kind.name);
        }
    }

    #[test]
    fn every_default_is_a_value_of_its_parameter() {
        for parameter in kinds().flat_map(|kind| kind.parameters) {
            if let ParameterDefault::Value(text) = parameter.default {
                let is_one = match parameter.form {
                    ParameterForm::Number { least, greatest }
                    | ParameterForm::Numbers { least, greatest } => {
                        let within = |text: &str| {
                            text.trim().parse::<f64>().is_ok_and(|value| (least..=greatest).contains(&value))
                        };
                        text.split(',').all(within)
                    }
                    ParameterForm::Word(words) => words.contains(&text),
                    _ => !text.is_empty(),
                };
                assert!(is_one, "{} of {}", text, parameter.name);
            }
        }
    }
}
