//! Observation and fire over the land.
//!
//! All kinds ask one definition of sight, `sandtable_terrain::sight`: the line between two points over the triangles of the
//! ground, with the Earth's curvature and refraction; `sight_land` has trees and buildings stand in its way.

mod best_posts;
mod exposure;
pub(crate) mod fields_of_fire;
mod intervisibility;
pub(crate) mod lookout;
pub(crate) mod masking;
pub(crate) mod sight_land;
#[cfg(test)]
pub(crate) mod test_hills;
pub(crate) mod viewsheds;

use crate::run::KindFunction;
use crate::sight_parts::run_sight;

/// The functions of the family's kinds.
pub(crate) const FUNCTIONS: &[(&str, KindFunction)] = &[
    ("viewsheds", run_sight),
    ("intervisibility", intervisibility::intervisibility),
    ("best-posts", best_posts::best_posts),
    ("fields-of-fire", run_sight),
    ("masking", run_sight),
    ("exposure", exposure::exposure),
];

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::DVec2;

    use super::test_hills::{ORIGIN, at, land};
    use crate::arguments::{AnalysisArguments, ArgumentValue};
    use crate::error::AnalysisError;
    use crate::land::Land;
    use crate::run::run;
    use sandtable_catalog::kind::{AnalysisFamily, AnalysisKind};
    use sandtable_catalog::parameter::ParameterForm;
    use sandtable_terrain::lattice::Lattice;
    use sandtable_terrain::stop_flag::StopFlag;

    fn family() -> impl Iterator<Item = &'static AnalysisKind> {
        sandtable_catalog::kinds().filter(|kind| kind.family == AnalysisFamily::Observation)
    }

    /// Arguments with points on three posts of the smallest land, and its required numbers.
    fn arguments(kind: &'static AnalysisKind) -> AnalysisArguments {
        let points = ArgumentValue::Points(vec![at(0.0, 0.0), at(1.0, 1.0), at(0.5, 1.0)]);
        let around = ArgumentValue::Points(vec![at(-1.0, -1.0), at(4.0, -1.0), at(-1.0, 4.0)]);
        kind.parameters.iter().fold(AnalysisArguments::new(kind), |arguments, parameter| {
            match parameter.form {
                ParameterForm::Area => arguments.with(parameter.name, around.clone()),
                ParameterForm::Points { .. } | ParameterForm::Line => {
                    arguments.with(parameter.name, points.clone())
                }
                ParameterForm::Number { .. } if parameter.name == "max_range" => {
                    arguments.with(parameter.name, ArgumentValue::Number(50.0))
                }
                _ => arguments,
            }
        })
    }

    #[test]
    fn extreme_numbers_give_a_value_for_each_post_or_an_error_that_names_a_key() {
        for land in [
            land(2, |_, _| 3.0),
            land(2, |column, _| column as f32 * 1e7),
            land(9, |column, row| if column * row % 5 == 4 { f32::NAN } else { (column * row) as f32 }),
        ] {
            for kind in family() {
                for parameter in kind.parameters {
                    let ParameterForm::Number { least, greatest } = parameter.form else { continue };
                    for number in [least, greatest] {
                        let arguments = arguments(kind).with(parameter.name, ArgumentValue::Number(number));
                        match run(&land, &arguments, &StopFlag::default()) {
                            Ok(outcome) => {
                                let posts = land.ground.heights().len();
                                assert!(outcome.raster.is_none_or(|raster| raster.values.len() == posts));
                                assert!(!outcome.features.is_empty(), "{} {}", kind.name, parameter.name);
                                let columns = |table: &crate::outcome::OutcomeTable| table.columns.len();
                                for table in &outcome.tables {
                                    assert!(table.rows.iter().all(|row| row.len() == columns(table)));
                                }
                            }
                            Err(error) => {
                                assert!(error.key().is_some(), "{} {}: {error}", kind.name, parameter.name)
                            }
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn land_without_any_data_is_an_error_that_names_a_key() {
        let frame = (ORIGIN, DVec2::splat(10.0));
        let first = sandtable_terrain::lattice::Post { column: 0, row: 0 };
        let lattice = Lattice::part(frame, first, 3, vec![f32::NAN; 9]).expect("a part may lie in the sea");
        let land = Land { ground: Arc::new(lattice), ..land(2, |_, _| 0.0) };
        for kind in family() {
            let outcome = run(&land, &arguments(kind), &StopFlag::default());
            assert!(outcome.is_err_and(|error| error.key().is_some()), "{}", kind.name);
        }
    }

    #[test]
    fn a_stopped_analysis_says_so() {
        let stop = StopFlag::default();
        stop.stop();
        for kind in family() {
            let outcome = run(&land(2, |_, _| 0.0), &arguments(kind), &stop);
            assert_eq!(outcome.err(), Some(AnalysisError::Stopped), "{}", kind.name);
        }
    }
}
