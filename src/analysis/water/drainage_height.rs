//! The kind `drainage-height`: the height of each post above the stream that it drains to (Nobre et al. 2011).

use super::kinds::numbers;
use super::prepared::WaterGround;
use super::streams::StreamNet;
use crate::arguments::AnalysisArguments;
use crate::error::AnalysisError;
use crate::land::{Land, WaterKind};
use crate::measures::{area_km2, percent};
use crate::outcome::{Figure, Hatching, Outcome, ValueClass};
use crate::water::drainage::Drainage;
use sandtable_terrain::stop_flag::StopFlag;

/// Heights above the nearest drainage, with classes.
///
/// # Errors
/// [`AnalysisError::Argument`] where the land has no water and is asked for it; [`AnalysisError::Memory`] and
/// [`AnalysisError::Stopped`].
pub(crate) fn drainage_height(
    land: &Land,
    arguments: &AnalysisArguments,
    stop: &StopFlag,
) -> Result<Outcome, AnalysisError> {
    let ground = &*land.ground;
    let mut water = WaterGround::of(land, arguments, stop)?;
    let drainage = water.drained(stop)?;
    let downstream = drainage.downstream();
    let mut is_bed = vec![false; drainage.codes.len()];
    let word = arguments.word("drainage");
    if word != "water" {
        let net = StreamNet::new(&drainage, &downstream, ground, arguments.number("area_m2"));
        net.order.iter().for_each(|&index| is_bed[index as usize] = true);
    }
    match &land.water {
        Some(posts) if word != "streams" => {
            is_bed.iter_mut().zip(posts).for_each(|(is_bed, post)| *is_bed |= post.kind != WaterKind::None);
        }
        None if word == "water" => {
            let problem = "is `water`, but the land knows no rivers, lakes or sea; state `streams`";
            return Err(AnalysisError::argument("drainage", problem));
        }
        _ => {}
    }
    let heights = above_bed(&drainage, &downstream, &is_bed);
    let breaks = arguments.numbers("classes");
    let known = heights.iter().filter(|height| !height.is_nan()).count();
    let with_data = (0..heights.len()).filter(|&index| drainage.has_data(index)).count();
    let mut figures: Vec<Figure> = breaks
        .iter()
        .map(|&below| {
            let posts = heights.iter().filter(|&&height| f64::from(height) < below).count();
            Figure::new(format!("area below {below} m"), area_km2(ground, posts), "km²")
        })
        .collect();
    figures.push(Figure::new("land that drains to no stream", percent(with_data - known, with_data), "%"));
    if known == 0 {
        water.notes.push("no stream drains as much; state a smaller `area_m2`".into());
    }
    let raster = numbers("height above drainage", "m", heights, classes(&breaks));
    Ok(Outcome { raster: Some(raster), figures, notes: water.notes, ..Outcome::default() })
}

/// The height of each post of drained ground above the bed that it drains to; NaN where it comes to none.
pub(super) fn above_bed(drainage: &Drainage, downstream: &[u32], is_bed: &[bool]) -> Vec<f32> {
    // The level of the bed first, then the height above it.
    let bed = |(&filled, &is_bed): (&f32, &bool)| if is_bed { filled } else { f32::NAN };
    let mut heights: Vec<f32> = drainage.filled_m.iter().zip(is_bed).map(bed).collect();
    drainage.pass_up(downstream, &mut heights, |_, level| level.is_nan());
    for (height, &filled) in heights.iter_mut().zip(&drainage.filled_m) {
        *height = (filled - *height).max(if height.is_nan() { f32::NAN } else { 0.0 });
    }
    heights
}

/// Classes between breaks: the lowest is nearest to the water.
fn classes(breaks: &[f64]) -> Vec<ValueClass> {
    let count = breaks.len().max(1) as f64;
    let class = |at: usize| {
        let from = if at == 0 { 0.0 } else { breaks[at - 1] };
        let label = match breaks.get(at) {
            Some(to) => format!("{from} to {to} m"),
            None => format!("{from} m or more"),
        };
        let share = at as f64 / count;
        let mix = |low: f64, high: f64| (low + (high - low) * share) as u8;
        let tint = [mix(30.0, 200.0), mix(90.0, 210.0), mix(190.0, 170.0), mix(150.0, 0.0)];
        let hatching = match at {
            0 => Hatching::Level,
            1 => Hatching::Dots,
            _ => Hatching::None,
        };
        ValueClass::new(from as f32, label, tint, hatching)
    };
    (0..=breaks.len()).map(class).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arguments::ArgumentValue;
    use crate::land::WaterPost;
    use crate::test_land::{run_kind, shaped, values_of};

    /// A valley that falls to the south by 1 m a row, with sides of 3 m a column.
    fn valley() -> Land {
        shaped(9, 12, 10.0, |column, row| row as f32 + 3.0 * (column as f32 - 4.0).abs())
    }

    #[test]
    fn the_sides_of_a_valley_lie_above_the_bed_that_they_drain_to() {
        let arguments = [("area_m2", ArgumentValue::Number(1500.0))];
        let outcome = run_kind("drainage-height", &valley(), arguments).expect("heights");
        let heights = values_of(outcome.raster.as_ref().expect("a raster"));
        // Column 6 of row 5, at 11 m, drains twice to the west, where the bed lies at 5 m.
        assert_eq!(heights[5 * 9 + 6], 6.0);
        assert_eq!(heights[5 * 9 + 4], 0.0);
        // The border drains along itself to the bed.
        assert_eq!(heights[3], 3.0);
    }

    #[test]
    fn classes_lie_between_the_breaks_and_count_their_land() {
        let arguments =
            [("area_m2", ArgumentValue::Number(1500.0)), ("classes", ArgumentValue::Numbers(vec![1.0, 9.0]))];
        let outcome = run_kind("drainage-height", &valley(), arguments).expect("heights");
        let raster = outcome.raster.expect("a raster");
        let labels: Vec<&str> = raster.classes.iter().map(|class| class.label.as_str()).collect();
        assert_eq!(labels, ["0 to 1 m", "1 to 9 m", "9 m or more"]);
        let below = values_of(&raster).iter().filter(|&&height| height < 9.0).count();
        assert!((outcome.figures[1].value - below as f64 * 1e-4).abs() < 1e-12);
    }

    #[test]
    fn the_water_of_a_scene_is_drainage_where_that_is_asked_for() {
        let mut land = valley();
        let water = |land: &Land| {
            let arguments = [("drainage", ArgumentValue::Word("water".into()))];
            run_kind("drainage-height", land, arguments)
        };
        assert_eq!(water(&land).expect_err("no water").key(), Some("drainage"));
        let mut posts = vec![WaterPost::default(); 9 * 12];
        posts[2 * 9 + 4].kind = WaterKind::Lake;
        land.water = Some(posts);
        let heights = values_of(&water(&land).expect("heights").raster.expect("a raster"));
        assert_eq!((heights[2 * 9 + 4], heights[7 * 9 + 4]), (0.0, 5.0));
        assert!(heights[9 + 4].is_nan(), "below the lake");
    }
}
