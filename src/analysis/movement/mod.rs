//! Movement across the land: what ground a vehicle can cross, how fast, and on which ways.

mod avenues;
mod corridors;
mod gaps;
mod going;
mod grade;
mod isochrones;
mod neighbors;
pub(crate) mod obstacles;
mod queue;
mod refine;
mod route;
mod search;
mod trace;
mod travel;
mod triangles;
pub mod vehicle;
mod way;

use crate::run::KindFunction;

/// The functions of the family's kinds.
pub(crate) const FUNCTIONS: &[(&str, KindFunction)] = &[
    ("obstacles", obstacles::obstacles),
    ("speed", obstacles::speed),
    ("time", isochrones::time),
    ("route", route::route),
    ("corridors", corridors::corridors),
    ("avenues", avenues::avenues),
    ("chokes", avenues::chokes),
];

#[cfg(test)]
mod tests {
    use crate::arguments::{AnalysisArguments, ArgumentValue};
    use crate::land::{Land, WaterKind, WaterPost};
    use crate::run::run;
    use crate::test_land::{on_pool, shaped};
    use glam::DVec2;
    use sandtable_catalog::kind::AnalysisFamily;
    use sandtable_catalog::parameter::ParameterForm;
    use sandtable_terrain::stop_flag::StopFlag;

    /// Arguments with each number at one end of its range.
    fn at_end(name: &str, is_high: bool, places: [DVec2; 2]) -> AnalysisArguments {
        let kind = sandtable_catalog::kind(name).expect("a kind");
        kind.parameters.iter().fold(AnalysisArguments::new(kind), |arguments, parameter| {
            let value = match parameter.form {
                ParameterForm::Number { least, greatest } => {
                    ArgumentValue::Number(if is_high { greatest } else { least })
                }
                ParameterForm::Numbers { least, greatest } => ArgumentValue::Numbers(vec![least, greatest]),
                ParameterForm::Word(words) => ArgumentValue::Word(words[usize::from(is_high)].to_owned()),
                ParameterForm::Vehicle => {
                    ArgumentValue::Word(if is_high { "foot" } else { "truck" }.to_owned())
                }
                _ if parameter.name.starts_with("to") => ArgumentValue::Points(vec![places[1]; 2]),
                _ => ArgumentValue::Points(vec![places[0]; 2]),
            };
            arguments.with(parameter.name, value)
        })
    }

    #[test]
    fn small_lands_and_extreme_arguments_give_an_outcome_or_name_a_key() {
        let nan = |keep: u32| move |column: u32, row: u32| if column + row >= keep { 5.0 } else { f32::NAN };
        let mut lands: Vec<Land> =
            vec![shaped(2, 2, 10.0, nan(0)), shaped(2, 2, 10.0, nan(2)), shaped(2, 9, 1e-3, nan(0))];
        lands.extend([
            shaped(9, 5, 1e4, |column, row| ((column * 31 + row * 17) % 7) as f32 * 1e6),
            shaped(7, 7, 30.0, nan(4)),
        ]);
        let mut wet = shaped(5, 5, 30.0, nan(0));
        wet.water = Some(vec![WaterPost { kind: WaterKind::Sea, depth_m: f32::NAN }; 25]);
        lands.push(wet);
        let kinds = || sandtable_catalog::kinds().filter(|kind| kind.family == AnalysisFamily::Movement);
        for land in &lands {
            let corner = land.ground.map_extent().max;
            for (kind, is_high) in kinds().flat_map(|kind| [(kind, false), (kind, true)]) {
                for to in [corner, DVec2::ZERO, DVec2::splat(f64::INFINITY)] {
                    let arguments = at_end(kind.name, is_high, [corner, to]);
                    match run(land, &arguments, &StopFlag::default()) {
                        Ok(outcome) => {
                            let posts = land.ground.heights().len();
                            assert!(outcome.raster.is_none_or(|raster| raster.values.len() == posts));
                        }
                        Err(error) => assert!(error.key().is_some(), "{}: {error}", kind.name),
                    }
                }
            }
        }
    }

    #[test]
    fn outcomes_are_the_same_bits_with_one_thread_and_with_three() {
        let land =
            shaped(40, 30, 25.0, |column, row| ((column * 31 + row * 17 + column * row) % 23) as f32 * 0.5);
        let [from, to] = [DVec2::new(50.0, 50.0), DVec2::new(900.0, 700.0)];
        for name in ["obstacles", "speed", "time", "route", "corridors", "avenues", "chokes"] {
            let arguments = at_end(name, true, [from, to]);
            let text = |threads: usize| {
                let outcome = || run(&land, &arguments, &StopFlag::default()).expect("sound");
                on_pool(threads, || format!("{:?}", outcome()))
            };
            assert_eq!(text(1), text(3), "{name}");
        }
    }
}
