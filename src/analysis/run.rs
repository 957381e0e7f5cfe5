//! Runs an analysis of any kind.

use crate::arguments::AnalysisArguments;
use crate::error::AnalysisError;
use crate::land::Land;
use crate::outcome::{Figure, Outcome, OutcomeRaster, PostValues};
use crate::tally::FigureTally;
use crate::{earth, landing, movement, observation, surface, water};
use sandtable_catalog::kind::AnalysisKind;
use sandtable_terrain::lattice::Lattice;
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
    outcome.notes.splice(0..0, lacking_note(land, kind));
    Ok(outcome)
}

/// What is said of the layers that a kind uses and the land lacks; `None` where it lacks none.
pub fn lacking_note(land: &Land, kind: &AnalysisKind) -> Option<String> {
    let lacking: Vec<&str> =
        kind.layers.iter().filter(|&&layer| !land.knows(layer)).map(|layer| layer.noun()).collect();
    (!lacking.is_empty()).then(|| format!("nothing is known of {}", lacking.join(", ")))
}

/// What the figures of a kind with a [reach](sandtable_catalog::kind::AnalysisReach) in posts are made of, from its raster: of a
/// part those of the part.
pub fn raster_tally(kind: &AnalysisKind, raster: &OutcomeRaster) -> FigureTally {
    match (kind.name, &raster.values) {
        ("obstacles", PostValues::Codes(codes)) => movement::obstacles::code_tally(codes),
        ("speed", PostValues::Numbers(values)) => movement::obstacles::speed_tally(values),
        _ => FigureTally::default(),
    }
}

/// The figures of a tally of posts that lie as those of `ground`.
pub fn tally_figures(kind: &AnalysisKind, tally: &FigureTally, ground: &Lattice) -> Vec<Figure> {
    match kind.name {
        "obstacles" => movement::obstacles::code_figures(tally, ground),
        "speed" => movement::obstacles::speed_figures(tally),
        _ => Vec::new(),
    }
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
    use sandtable_catalog::kind::AnalysisYield;
    use sandtable_catalog::parameter::{AnalysisParameter, ParameterDefault, ParameterForm};
    use sandtable_terrain::lattice::Post;
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
        let square = shaped(48, 40, 10.0, heights);
        let cell = DVec2::new(10.0, 14.0);
        let oblong = Lattice::new(DVec2::ZERO, cell, 48, square.ground.heights().to_vec()).expect("sound");
        let oblong = Land { ground: Arc::new(oblong), ..square.clone() };
        for whole in [square, oblong] {
            check_parts(&whole);
        }
    }

    fn check_parts(whole: &Land) {
        let (first, last) = (Post { column: 17, row: 12 }, Post { column: 27, row: 24 });
        let mut tried = 0;
        for (kind, arguments) in
            sandtable_catalog::kinds().flat_map(|kind| variants(kind).map(move |of| (kind, of)))
        {
            let Some(reach) = arguments.reach_posts(whole.ground.cell()) else { continue };
            tried += 1;
            let around = PostRect { first, last }.grown((reach, reach), &whole.ground);
            let part = whole.ground.holding_only(around).cut_to_held().expect("more than two posts a side");
            let values = |ground: Arc<Lattice>| {
                let land = Land { ground, ..whole.clone() };
                let outcome = run(&land, &arguments, &StopFlag::default()).expect(kind.name);
                let raster = outcome.raster.expect(kind.name);
                assert_eq!(raster_tally(kind, &raster), outcome.tally, "{}", kind.name);
                let figures = tally_figures(kind, &outcome.tally, &land.ground);
                assert_eq!(figures, outcome.figures, "{}", kind.name);
                raster.values
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
        assert!(tried >= 15, "{tried}");
    }

    /// The defaults of a kind, then each of its words alone, and its radius at 3 where it has one.
    fn variants(kind: &'static AnalysisKind) -> impl Iterator<Item = AnalysisArguments> {
        let of = |parameter: &'static AnalysisParameter| -> Vec<ArgumentValue> {
            match parameter.form {
                ParameterForm::Word(words) => {
                    words.iter().map(|&word| ArgumentValue::Word(word.to_owned())).collect()
                }
                _ if parameter.name == "radius" => vec![ArgumentValue::Number(3.0)],
                _ => Vec::new(),
            }
        };
        let stated = kind
            .parameters
            .iter()
            .flat_map(move |parameter| of(parameter).into_iter().map(move |value| (parameter.name, value)));
        // `tri` and the ranges of others allow no other radius than their own.
        let fits = move |(name, _): &(&str, ArgumentValue)| kind.name != "ruggedness" || *name != "radius";
        let with = move |(name, value)| AnalysisArguments::new(kind).with(name, value);
        let wide = (kind.name == "ruggedness").then(|| {
            let vrm = ArgumentValue::Word("vrm".to_owned());
            AnalysisArguments::new(kind).with("measure", vrm).with("radius", ArgumentValue::Number(3.0))
        });
        std::iter::once(AnalysisArguments::new(kind)).chain(stated.filter(fits).map(with)).chain(wide)
    }

    #[test]
    fn kinds_that_take_long_say_which_share_is_done() {
        let land = shaped(30, 30, 10.0, |column, row| ((column * 31 + row * 17) % 23) as f32 * 0.2);
        let places = ArgumentValue::Points(vec![DVec2::new(52.0, 61.0), DVec2::new(121.0, 133.0)]);
        for (name, key) in [
            ("time", "from"),
            ("viewsheds", "posts"),
            ("fields-of-fire", "weapons"),
            ("masking", "radars"),
            ("best-posts", ""),
            ("flow", ""),
            ("geomorphons", ""),
            ("peaks", ""),
        ] {
            let kind = sandtable_catalog::kind(name).expect(name);
            let mut arguments = AnalysisArguments::new(kind);
            if !key.is_empty() {
                arguments = arguments.with(key, places.clone());
            }
            if kind.parameter("max_range").is_some() {
                arguments = arguments.with("max_range", ArgumentValue::Number(100.0));
            }
            let stop = StopFlag::default();
            run(&land, &arguments, &stop).expect(name);
            assert!(
                stop.share().is_some_and(|share| (0.79..=1.0).contains(&share)),
                "{name}: {:?}",
                stop.share()
            );
        }
    }

    #[test]
    fn a_single_viewshed_says_part_by_part_which_share_is_done() {
        let land = shaped(30, 30, 10.0, |column, row| ((column * 31 + row * 17) % 23) as f32 * 0.2);
        let stands = (0..30 * 30).map(|index| if index % 7 == 0 { 1.0 } else { 0.0 }).collect();
        let wooded = Land { obstacles_m: Some(stands), ..land.clone() };
        for (name, key) in [("viewsheds", "posts"), ("fields-of-fire", "weapons"), ("masking", "radars")] {
            let kind = sandtable_catalog::kind(name).expect(name);
            let place = ArgumentValue::Points(vec![DVec2::new(152.0, 141.0)]);
            let mut arguments = AnalysisArguments::new(kind).with(key, place);
            if name == "fields-of-fire" {
                arguments = arguments.with("max_range", ArgumentValue::Number(100.0));
                arguments = arguments.with("arc", ArgumentValue::Number(90.0));
            } else if name == "viewsheds" {
                arguments = arguments.with("target_height", ArgumentValue::Number(2.0));
            }
            for land in [&land, &wooded] {
                let stop = StopFlag::default();
                run(land, &arguments, &stop).expect(name);
                assert_eq!(stop.share(), Some(1.0), "{name}");
            }
        }
    }

    #[test]
    fn kinds_give_rasters_and_features_as_the_catalog_says() {
        let ground = shaped(30, 30, 10.0, |column, row| ((column * 31 + row * 17) % 23) as f32 * 0.2);
        let rough = Land { other_ground: Some(ground.ground.clone()), ..ground };
        // It falls toward the west.
        let valley = shaped(30, 30, 10.0, |column, row| (row as f32 - 14.5).abs() + column as f32 * 0.1);
        let at = |x: f64, y: f64| DVec2::new(x, y);
        for kind in sandtable_catalog::kinds() {
            let land = if kind.name == "dam-break" { &valley } else { &rough };
            let argument = |arguments: AnalysisArguments, parameter: &AnalysisParameter| {
                let is_required = parameter.default == ParameterDefault::Required;
                let value = match parameter.form {
                    ParameterForm::Points { .. } if parameter.name == "to" => vec![at(250.0, 240.0)],
                    ParameterForm::Points { .. } if parameter.name == "reservoir" => return arguments,
                    ParameterForm::Points { .. } => vec![at(52.0, 61.0), at(121.0, 133.0)],
                    ParameterForm::Line if parameter.name == "to_line" => {
                        vec![at(250.0, 50.0), at(250.0, 240.0)]
                    }
                    ParameterForm::Line => vec![at(50.0, 50.0), at(50.0, 240.0)],
                    ParameterForm::Area => vec![at(30.0, 30.0), at(200.0, 30.0), at(200.0, 200.0)],
                    ParameterForm::Number { least, greatest } if is_required => {
                        let wanted: f64 = if kind.name == "dam-break" { 2.0 } else { 100.0 };
                        let value = ArgumentValue::Number(wanted.clamp(least, greatest));
                        return arguments.with(parameter.name, value);
                    }
                    _ => return arguments,
                };
                arguments.with(parameter.name, ArgumentValue::Points(value))
            };
            let arguments = kind.parameters.iter().fold(AnalysisArguments::new(kind), argument);
            let outcome = run(land, &arguments, &StopFlag::default()).expect(kind.name);
            let gives_raster = matches!(kind.yields, AnalysisYield::Raster | AnalysisYield::Both);
            assert_eq!(outcome.raster.is_some(), gives_raster, "{}", kind.name);
            if matches!(kind.yields, AnalysisYield::Raster | AnalysisYield::Table) {
                assert!(outcome.features.is_empty(), "{}", kind.name);
            }
            assert!(kind.yields != AnalysisYield::Table || !outcome.tables.is_empty(), "{}", kind.name);
        }
    }
}
