//! The kind `flood`: ground below a level of water, all of it or what water can reach from a source (bathtub).

use super::kinds::numbers;
use super::outlines::outline_features;
use super::prepared::WaterGround;
use crate::arguments::AnalysisArguments;
use crate::error::AnalysisError;
use crate::land::Land;
use crate::line_posts::along_line;
use crate::measures::area_km2;
use crate::outcome::{Figure, Hatching, Outcome, PropertyValue, ValueClass};
use crate::place::post_under;
use sandtable_terrain::lattice::Lattice;
use sandtable_terrain::neighbors::neighbors;
use sandtable_terrain::stop_flag::StopFlag;

/// Depths from which water is classed, meters, with their tints.
pub(super) const DEPTHS: [(f32, &str, [u8; 4], Hatching); 5] = [
    (0.0, "dry", [0, 0, 0, 0], Hatching::None),
    (f32::MIN_POSITIVE, "up to 0.5 m", [170, 210, 245, 110], Hatching::Dots),
    (0.5, "0.5 to 1 m", [110, 170, 230, 120], Hatching::Level),
    (1.0, "1 to 2 m", [60, 120, 205, 135], Hatching::Level),
    (2.0, "2 m or more", [20, 60, 150, 150], Hatching::Crossed),
];

/// Which posts water can reach one from another.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum FloodRule {
    /// Those beside, and those at corners.
    Corners,
    /// Those beside alone.
    Sides,
}

/// The ground below a level, and how deep it lies.
///
/// # Errors
/// [`AnalysisError::Argument`] and [`AnalysisError::Place`] of sources; [`AnalysisError::Memory`] and
/// [`AnalysisError::Stopped`].
pub(crate) fn flood(
    land: &Land,
    arguments: &AnalysisArguments,
    stop: &StopFlag,
) -> Result<Outcome, AnalysisError> {
    let ground = &*land.ground;
    let water = WaterGround::of(land, arguments, stop)?;
    let level = arguments.number("level_m") as f32;
    let heights = &water.heights;
    let is_wet = match sources(ground, arguments)? {
        None => heights.iter().map(|&height| height < level).collect(),
        Some(sources) => {
            let wet: Vec<usize> = sources.into_iter().filter(|&index| heights[index] < level).collect();
            if wet.is_empty() {
                let problem = format!("{level} is not above the ground at any source; state a higher one");
                return Err(AnalysisError::argument("level_m", problem));
            }
            let rule =
                if arguments.word("connect") == "sides" { FloodRule::Sides } else { FloodRule::Corners };
            spread(ground, wet, rule, |index| heights[index] < level, stop)?
        }
    };
    let depth = |index: usize| match heights[index] {
        height if height.is_nan() => f32::NAN,
        height if is_wet[index] => level - height,
        _ => 0.0,
    };
    let depths: Vec<f32> = (0..heights.len()).map(depth).collect();
    let area = area_km2(ground, is_wet.iter().filter(|&&is_wet| is_wet).count());
    let volume_m3 = volume_m3(ground, &depths);
    let deepest = deepest_m(&depths);
    let property = ("level_m", PropertyValue::Number(f64::from(level)));
    Ok(Outcome {
        features: outline_features(ground, property, |index| is_wet[index]),
        raster: Some(numbers("depth", "m", depths, ValueClass::of_rows(DEPTHS))),
        figures: vec![
            Figure::new("flooded area", area, "km²"),
            Figure::new("volume of water", volume_m3, "m³"),
            Figure::new("greatest depth", deepest, "m"),
        ],
        notes: water.notes,
        ..Outcome::default()
    })
}

/// The volume of water of these depths in m³.
pub(super) fn volume_m3(ground: &Lattice, depths: &[f32]) -> f64 {
    let sum: f64 = depths.iter().copied().filter(|depth| *depth > 0.0).map(f64::from).sum();
    sum * ground.cell_m2()
}

/// The greatest of these depths in meters; 0 where all is dry.
pub(super) fn deepest_m(depths: &[f32]) -> f64 {
    f64::from(depths.iter().copied().filter(|depth| *depth > 0.0).fold(0.0, f32::max))
}

/// The posts of sources; `None` where none is stated.
fn sources(ground: &Lattice, arguments: &AnalysisArguments) -> Result<Option<Vec<usize>>, AnalysisError> {
    let (points, line) = (arguments.points("from"), arguments.points("from_line"));
    if points.is_empty() && line.is_empty() {
        return Ok(None);
    }
    let mut posts = Vec::new();
    for &at in points {
        posts.push(post_under(ground, "from", at)?);
    }
    if !line.is_empty() {
        let before = posts.len();
        along_line(ground, line, 0.0, |index| posts.push(index));
        if posts.len() == before {
            return Err(AnalysisError::argument("from_line", "lies off the land"));
        }
    }
    Ok(Some(posts))
}

/// The posts that water reaches from others over posts for which `is_open` holds.
///
/// # Errors
/// [`AnalysisError::Stopped`].
pub(super) fn spread(
    ground: &Lattice,
    sources: Vec<usize>,
    rule: FloodRule,
    is_open: impl Fn(usize) -> bool,
    stop: &StopFlag,
) -> Result<Vec<bool>, AnalysisError> {
    let (columns, rows) = (ground.columns() as usize, ground.rows() as usize);
    let mut is_wet = vec![false; ground.heights().len()];
    let mut ready: Vec<u32> = Vec::new();
    for index in sources.into_iter().filter(|&index| is_open(index)) {
        if !std::mem::replace(&mut is_wet[index], true) {
            ready.push(index as u32);
        }
    }
    let mut told = 0_usize;
    while let Some(index) = ready.pop() {
        told += 1;
        if told.is_multiple_of(1 << 16) && stop.is_stopped() {
            return Err(AnalysisError::Stopped);
        }
        for (step, other) in neighbors(index as usize, columns, rows) {
            let is_near = rule == FloodRule::Corners || step % 2 == 0;
            if is_near && !is_wet[other] && is_open(other) {
                is_wet[other] = true;
                ready.push(other as u32);
            }
        }
    }
    Ok(is_wet)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arguments::ArgumentValue;
    use crate::land::{Crossing, CrossingKind};
    use crate::outcome::OutcomeShape;
    use crate::test_land::{bare, run_kind, values_of};
    use glam::DVec2;

    /// Two hollows, 2 m deep, with a wall of 5 m between them that has a gap at a corner alone.
    fn hollows() -> Land {
        #[rustfmt::skip]
        let heights = vec![
            5., 5., 5., 5., 5., 5., 5.,
            5., 1., 1., 5., 1., 1., 5.,
            5., 1., 1., 5., 1., 1., 5.,
            5., 5., 1., 5., 1., 1., 5.,
            5., 5., 5., 1., 5., 5., 5.,
            5., 5., 5., 5., 5., 5., 5.,
        ];
        bare((DVec2::ZERO, DVec2::splat(10.0)), 7, heights)
    }

    fn flooded(land: &Land, level_m: f64, more: Vec<(&str, ArgumentValue)>) -> Outcome {
        let mut arguments = vec![("level_m", ArgumentValue::Number(level_m))];
        arguments.extend(more);
        run_kind("flood", land, arguments).expect("flooded")
    }

    #[test]
    fn all_ground_below_the_level_is_wet_where_no_source_is_stated() {
        let outcome = flooded(&hollows(), 3.0, Vec::new());
        let figures: Vec<f64> = outcome.figures.iter().map(|figure| figure.value).collect();
        // Twelve posts of 100 m², 2 m deep.
        assert!((figures[0] - 0.0012).abs() < 1e-12 && figures[1] == 2400.0 && figures[2] == 2.0);
        let holes = outcome.features.iter().all(|feature| match &feature.shape {
            OutcomeShape::Area(rings) => rings.len() == 1,
            _ => false,
        });
        assert!(holes && outcome.features.len() == 3, "{:?}", outcome.features);
    }

    #[test]
    fn water_from_a_source_passes_corners_by_the_rule_of_eight_alone() {
        let from = || ("from", ArgumentValue::Points(vec![DVec2::new(11.0, 12.0)]));
        let connect = |word: &str| ("connect", ArgumentValue::Word(word.into()));
        let wet = |arguments| {
            let depths = values_of(&flooded(&hollows(), 3.0, arguments).raster.expect("a raster"));
            depths.iter().filter(|&&depth| depth > 0.0).count()
        };
        assert_eq!(wet(vec![from(), connect("sides")]), 5);
        assert_eq!(wet(vec![from(), connect("corners")]), 12);
        let line = ArgumentValue::Points(vec![DVec2::new(40.0, 5.0), DVec2::new(40.0, 500.0)]);
        assert_eq!(wet(vec![("from_line", line), connect("sides")]), 6);
    }

    #[test]
    fn a_culvert_floods_the_other_side_of_a_bank() {
        let mut land = hollows();
        let line = vec![DVec2::new(30.0, 5.0), DVec2::new(30.0, 25.0)];
        let kind = CrossingKind::InferredCulvert;
        land.crossings = vec![Crossing { name: String::new(), kind, line, width_m: 4.0, load_t: None }];
        let arguments = vec![
            ("from", ArgumentValue::Points(vec![DVec2::new(10.0, 10.0)])),
            ("connect", ArgumentValue::Word("sides".into())),
        ];
        let depths = values_of(&flooded(&land, 3.0, arguments).raster.expect("a raster"));
        assert!(depths[7 + 4] == 2.0 && depths[7 + 3] == 2.0, "{depths:?}");
    }

    #[test]
    fn a_level_below_its_sources_and_sources_off_the_land_are_refused() {
        let key = |level_m: f64, name: &'static str, points: Vec<DVec2>| {
            let arguments =
                [("level_m", ArgumentValue::Number(level_m)), (name, ArgumentValue::Points(points))];
            run_kind("flood", &hollows(), arguments).expect_err("refused").key()
        };
        assert_eq!(key(0.5, "from", vec![DVec2::new(10.0, 10.0)]), Some("level_m"));
        assert_eq!(key(3.0, "from", vec![DVec2::new(-90.0, 10.0)]), Some("from"));
        assert_eq!(key(3.0, "from_line", vec![DVec2::splat(-90.0), DVec2::splat(-50.0)]), Some("from_line"));
    }
}
