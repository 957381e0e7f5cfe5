//! Land of four posts, without data or without form, and parameters at both ends of their ranges: an outcome, or an error that
//! names the key.

use glam::DVec2;

use crate::arguments::{AnalysisArguments, ArgumentValue};
use crate::land::{Crossing, CrossingKind, Land};
use crate::run::run;
use crate::test_land::{bare, noise};
use sandtable_catalog::kind::{AnalysisFamily, AnalysisKind};
use sandtable_catalog::parameter::{AnalysisParameter, ParameterForm};
use sandtable_terrain::stop_flag::StopFlag;

/// Odd lands, all with a bridge and a culvert across them.
fn lands() -> Vec<Land> {
    let land = |columns: u32, heights: Vec<f32>| {
        let mut land = bare((DVec2::ZERO, DVec2::splat(10.0)), columns, heights);
        let line = vec![DVec2::new(5.0, -5.0), DVec2::new(15.0, 45.0)];
        let crossing =
            |kind| Crossing { name: String::new(), kind, line: line.clone(), width_m: 4.0, load_t: None };
        land.crossings = [CrossingKind::Bridge, CrossingKind::Culvert].map(crossing).to_vec();
        land
    };
    let mut one = vec![f32::NAN; 25];
    one[12] = 3.0;
    vec![
        land(2, vec![1.0, 2.0, 3.0, 4.0]),
        land(2, vec![f32::NAN; 4]),
        land(5, vec![f32::NAN; 25]),
        land(5, one),
        land(30, vec![7.0; 900]),
        land(2, noise(200, 3, 9, false)),
        land(40, noise(1600, 5, 4, true)),
        land(40, noise(1600, 6, 60_000, true)),
    ]
}

/// Values of a parameter: ends of its range, and odd places.
fn values(parameter: &AnalysisParameter) -> Vec<ArgumentValue> {
    let at = |x: f64, y: f64| DVec2::new(x, y);
    match parameter.form {
        ParameterForm::Number { least, greatest } => {
            [least, 3.0_f64.clamp(least, greatest), greatest].map(ArgumentValue::Number).into()
        }
        ParameterForm::Numbers { least, greatest } => {
            vec![ArgumentValue::Numbers(vec![least, greatest]), ArgumentValue::Numbers(vec![least])]
        }
        ParameterForm::Word(words) => words.iter().map(|word| ArgumentValue::Word((*word).into())).collect(),
        _ => [
            vec![at(5.0, 5.0), at(15.0, 25.0)],
            vec![at(20.0, 20.0), at(20.0, 20.0)],
            vec![at(-1e9, 3.0), at(1e9, 4.0)],
            vec![at(f64::NAN, 3.0), at(4.0, f64::INFINITY)],
            vec![at(100.0, 100.0), at(150.0, 130.0), at(90.0, 210.0)],
        ]
        .map(ArgumentValue::Points)
        .into(),
    }
}

/// The arguments of a kind of which each parameter has its value of a number, in turn where it has fewer.
fn arguments(kind: &'static AnalysisKind, number: usize) -> AnalysisArguments {
    let with = |arguments: AnalysisArguments, (at, parameter): (usize, &AnalysisParameter)| {
        let mut values = values(parameter);
        let value = values.swap_remove((number + at * (number / 5)) % values.len());
        arguments.with(parameter.name, value)
    };
    kind.parameters.iter().enumerate().fold(AnalysisArguments::new(kind), with)
}

#[test]
fn odd_land_and_extreme_parameters_give_an_outcome_or_name_a_key() {
    let kinds = sandtable_catalog::kinds().filter(|kind| kind.family == AnalysisFamily::Water);
    let (mut outcomes, mut errors) = (0, 0);
    for kind in kinds {
        for land in lands() {
            for number in 0..20 {
                match run(&land, &arguments(kind, number), &StopFlag::default()) {
                    Ok(outcome) => {
                        outcomes += 1;
                        let figures = outcome.figures.iter().map(|figure| figure.value);
                        assert!(figures.clone().all(f64::is_finite), "{}: {:?}", kind.name, outcome.figures);
                    }
                    Err(error) => {
                        errors += 1;
                        assert!(error.key().is_some(), "{}: {error}", kind.name);
                    }
                }
            }
        }
    }
    assert!(outcomes > 400 && errors > 50, "{outcomes} outcomes, {errors} errors");
}
