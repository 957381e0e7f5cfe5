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
    use std::sync::Arc;

    use glam::DVec2;

    use super::*;
    use crate::arguments::ArgumentValue;
    use crate::test_land::shaped;
    use sandtable_catalog::kind::{AnalysisReach, AnalysisYield};
    use sandtable_catalog::parameter::{AnalysisParameter, ParameterDefault, ParameterForm};
    use sandtable_terrain::lattice::{Lattice, Post};
    use sandtable_terrain::post_rect::PostRect;

    #[test]
    fn every_kind_of_the_catalog_has_a_function_and_every_function_a_kind() {
        let kinds: Vec<&str> = sandtable_catalog::kinds().map(|kind| kind.name).collect();
        let functions: Vec<&str> = FAMILIES.into_iter().flatten().map(|&(name, _)| name).collect();
        assert!(kinds.iter().all(|name| functions.contains(name)), "{kinds:?}");
        assert!(functions.iter().all(|name| kinds.contains(name)), "{functions:?}");
    }

    #[test]
    fn on_a_part_with_its_reach_around_it_a_kind_gives_the_bits_of_the_whole() {
        let heights = |column: u32, row: u32| match (column, row) {
            (21, 13) => f32::NAN,
            _ => ((column * 31 + row * 17 + column * row) % 23) as f32 * 1.7,
        };
        let whole = shaped(48, 40, 10.0, heights);
        let (first, last) = (Post { column: 17, row: 12 }, Post { column: 27, row: 24 });
        let mut kinds = 0;
        for kind in sandtable_catalog::kinds() {
            let arguments = AnalysisArguments::new(kind);
            let reach = match kind.reach {
                AnalysisReach::Posts(posts) => posts,
                AnalysisReach::PostsBy(name) => arguments.number(name) as u32,
                AnalysisReach::MetersBy(_) | AnalysisReach::Whole => continue,
            };
            kinds += 1;
            let around = PostRect { first, last }.grown((reach, reach), &whole.ground);
            let part = whole.ground.holding_only(around).cut_to_held().expect("more than two posts a side");
            let values = |ground: Arc<Lattice>| {
                let land = Land { ground, ..whole.clone() };
                run(&land, &arguments, &StopFlag::default()).expect(kind.name).raster.expect(kind.name).values
            };
            let (of_whole, of_part) = (values(whole.ground.clone()), values(Arc::new(part.clone())));
            for post in (PostRect { first, last }).posts() {
                let in_part =
                    Post { column: post.column - around.first.column, row: post.row - around.first.row };
                let wanted = of_whole.value(whole.ground.index(post));
                let found = of_part.value(part.index(in_part));
                assert_eq!(found.to_bits(), wanted.to_bits(), "{} at {post:?}", kind.name);
            }
        }
        assert!(kinds >= 6, "{kinds} kinds");
    }

    #[test]
    fn kinds_give_rasters_and_features_as_the_catalog_says() {
        let ground = shaped(30, 30, 10.0, |column, row| ((column * 31 + row * 17) % 23) as f32 * 0.2);
        let land = Land { other_ground: Some(ground.ground.clone()), ..ground };
        let at = |x: f64, y: f64| DVec2::new(x, y);
        for kind in sandtable_catalog::kinds() {
            let argument = |arguments: AnalysisArguments, parameter: &AnalysisParameter| {
                let is_required = parameter.default == ParameterDefault::Required;
                let value = match parameter.form {
                    ParameterForm::Points { .. } if parameter.name == "to" => vec![at(250.0, 240.0)],
                    ParameterForm::Points { .. } => vec![at(52.0, 61.0), at(121.0, 133.0)],
                    ParameterForm::Line if parameter.name == "to_line" => {
                        vec![at(250.0, 50.0), at(250.0, 240.0)]
                    }
                    ParameterForm::Line => vec![at(50.0, 50.0), at(50.0, 240.0)],
                    ParameterForm::Area => vec![at(30.0, 30.0), at(200.0, 30.0), at(200.0, 200.0)],
                    ParameterForm::Number { least, greatest } if is_required => {
                        let value = ArgumentValue::Number(100.0_f64.clamp(least, greatest));
                        return arguments.with(parameter.name, value);
                    }
                    _ => return arguments,
                };
                arguments.with(parameter.name, ArgumentValue::Points(value))
            };
            let arguments = kind.parameters.iter().fold(AnalysisArguments::new(kind), argument);
            let outcome = run(&land, &arguments, &StopFlag::default()).expect(kind.name);
            let gives_raster = matches!(kind.yields, AnalysisYield::Raster | AnalysisYield::Both);
            assert_eq!(outcome.raster.is_some(), gives_raster, "{}", kind.name);
            if matches!(kind.yields, AnalysisYield::Raster | AnalysisYield::Table) {
                assert!(outcome.features.is_empty(), "{}", kind.name);
            }
            assert!(kind.yields != AnalysisYield::Table || !outcome.tables.is_empty(), "{}", kind.name);
        }
    }
}
