//! The kinds about water: depressions, flow and streams.

use crate::arguments::AnalysisArguments;
use crate::error::AnalysisError;
use crate::land::Land;
use crate::measures::area_km2;
use crate::outcome::{
    FeatureRole, Figure, Hatching, Outcome, OutcomeFeature, OutcomeRaster, OutcomeShape, PostValues,
    PropertyValue, ValueClass,
};
use crate::water::carve::{carved, cut_note};
use crate::water::drainage::{Drainage, drain};
use crate::water::fill::filled;
use sandtable_terrain::lattice::Lattice;
use sandtable_terrain::stop_flag::StopFlag;

/// The depths from which depressions are classed, meters, with their tints.
const DEPTHS: [(f32, &str, [u8; 4], Hatching); 3] = [
    (0.0, "none", [0, 0, 0, 0], Hatching::None),
    (f32::MIN_POSITIVE, "up to 1 m", [140, 190, 240, 110], Hatching::Level),
    (1.0, "1 m or more", [30, 90, 190, 130], Hatching::Level),
];

/// The depressions of the ground: their depth, or the ground with them filled.
///
/// # Errors
/// [`AnalysisError::Stopped`].
pub(crate) fn fill(
    land: &Land,
    arguments: &AnalysisArguments,
    stop: &StopFlag,
) -> Result<Outcome, AnalysisError> {
    let (heights, cuts) = carved(land);
    let filled_m = filled(&heights, land.ground.columns() as usize, stop)?;
    let deep = || filled_m.iter().zip(heights.iter()).map(|(filled, height)| filled - height);
    let posts = deep().filter(|depth| *depth > 0.0).count();
    let volume_m3 = deep().filter(|depth| *depth > 0.0).map(f64::from).sum::<f64>() * land.ground.cell_m2();
    let figures = vec![
        Figure::new("area of depressions", area_km2(&land.ground, posts), "km²"),
        Figure::new("volume of depressions", volume_m3, "m³"),
    ];
    let raster = match arguments.word("show").as_str() {
        "filled" => numbers("filled", "m", filled_m, Vec::new()),
        _ => numbers("depth", "m", deep().collect(), ValueClass::of_rows(DEPTHS)),
    };
    Ok(Outcome { raster: Some(raster), figures, notes: cut_note(cuts), ..Outcome::default() })
}

/// Where water flows: the area that drains through each post, or the direction in which it drains.
///
/// # Errors
/// [`AnalysisError::Stopped`].
pub(crate) fn flow(
    land: &Land,
    arguments: &AnalysisArguments,
    stop: &StopFlag,
) -> Result<Outcome, AnalysisError> {
    let (heights, cuts) = carved(land);
    let drainage = drain(&land.ground, &heights, stop)?;
    let raster = if arguments.word("show") == "direction" {
        OutcomeRaster {
            name: "direction",
            unit: "",
            values: PostValues::Codes(drainage.codes),
            classes: Vec::new(),
        }
    } else {
        let counts = drainage.accumulation();
        let area = |(count, height): (u32, &f32)| {
            if height.is_nan() { f32::NAN } else { (f64::from(count) * land.ground.cell_m2()) as f32 }
        };
        numbers("drained area", "m²", counts.into_iter().zip(heights.iter()).map(area).collect(), Vec::new())
    };
    Ok(Outcome { raster: Some(raster), notes: cut_note(cuts), ..Outcome::default() })
}

/// Streams: the ways of water that drain at least an area, from each source or confluence to the next, with Strahler's order.
///
/// # Errors
/// [`AnalysisError::Stopped`].
pub(crate) fn streams(
    land: &Land,
    arguments: &AnalysisArguments,
    stop: &StopFlag,
) -> Result<Outcome, AnalysisError> {
    let (heights, cuts) = carved(land);
    let drainage = drain(&land.ground, &heights, stop)?;
    let counts = drainage.accumulation();
    let least = (arguments.number("area_m2") / land.ground.cell_m2()).ceil().max(1.0);
    let is_stream = |index: u32| f64::from(counts[index as usize]) >= least;
    // By post: the number of streams that enter it, and Strahler's order with how many of them have it.
    let mut entering = vec![0_u8; counts.len()];
    let mut orders = vec![(0_u8, 0_u8); counts.len()];
    let order: Vec<u32> = drainage.downstream().into_iter().filter(|&index| is_stream(index)).collect();
    for &index in &order {
        let order = own_order(orders[index as usize]);
        let Some(to) = drainage.to(index as usize) else { continue };
        entering[to] += 1;
        let (highest, times) = &mut orders[to];
        match order.cmp(highest) {
            std::cmp::Ordering::Greater => (*highest, *times) = (order, 1),
            std::cmp::Ordering::Equal => *times += 1,
            std::cmp::Ordering::Less => {}
        }
    }
    let mut features = Vec::new();
    let mut total_km = 0.0;
    for &start in &order {
        if entering[start as usize] == 1 {
            continue;
        }
        let line = reach(start, &drainage, &entering, &land.ground);
        if line.len() < 2 {
            continue;
        }
        let length_m: f64 = line.windows(2).map(|pair| pair[0].distance(pair[1])).sum();
        total_km += length_m / 1000.0;
        features.push(OutcomeFeature {
            shape: OutcomeShape::Line(line),
            name: String::new(),
            role: FeatureRole::Stream,
            properties: vec![
                ("order", PropertyValue::Whole(i64::from(own_order(orders[start as usize])))),
                ("length_m", PropertyValue::Number(length_m)),
            ],
        });
    }
    Ok(Outcome {
        features,
        figures: vec![Figure::new("length of streams", total_km, "km")],
        notes: cut_note(cuts),
        ..Outcome::default()
    })
}

/// Strahler's order of a post that streams of a highest order enter so many times.
fn own_order((highest, times): (u8, u8)) -> u8 {
    match (highest, times) {
        (0, _) => 1,
        (_, 1) => highest,
        _ => highest + 1,
    }
}

/// The positions from a source or confluence down to the next confluence, or to the edge of the land.
fn reach(start: u32, drainage: &Drainage, entering: &[u8], ground: &Lattice) -> Vec<glam::DVec2> {
    let place = |index: usize| ground.map_position(ground.post_at(index));
    let mut line = vec![place(start as usize)];
    let mut at = drainage.to(start as usize);
    while let Some(index) = at {
        line.push(place(index));
        if entering[index] != 1 {
            break;
        }
        at = drainage.to(index);
    }
    line
}

fn numbers(
    name: &'static str,
    unit: &'static str,
    values: Vec<f32>,
    classes: Vec<ValueClass>,
) -> OutcomeRaster {
    OutcomeRaster { name, unit, values: PostValues::Numbers(values), classes }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arguments::ArgumentValue;
    use crate::test_land::{bare, values_of};
    use glam::DVec2;

    fn land(columns: u32, heights: &[f32]) -> Land {
        bare((DVec2::ZERO, DVec2::splat(10.0)), columns, heights.to_vec())
    }

    fn arguments(name: &str) -> AnalysisArguments {
        AnalysisArguments::new(sandtable_catalog::kind(name).expect("a kind"))
    }

    fn values(outcome: Outcome) -> Vec<f32> {
        values_of(&outcome.raster.expect("a raster"))
    }

    #[test]
    fn a_pit_is_filled_to_its_lowest_rim() {
        #[rustfmt::skip]
        let pit = land(5, &[
            9., 9., 9., 9., 9.,
            9., 5., 2., 5., 9.,
            9., 5., 5., 5., 6.,
            9., 9., 9., 9., 9.,
        ]);
        let outcome = fill(&pit, &arguments("fill"), &StopFlag::default()).expect("filled");
        assert!((outcome.figures[1].value - 900.0).abs() < 1e-9, "{:?}", outcome.figures);
        let depth = values(outcome);
        assert_eq!(&depth[5..10], [0., 1., 4., 1., 0.]);
        assert_eq!(&depth[10..15], [0., 1., 1., 1., 0.]);
    }

    #[test]
    fn all_water_of_a_valley_leaves_by_its_mouth() {
        // A trough that falls to the west.
        let heights: Vec<f32> = (0..25)
            .map(|index| {
                let (column, row) = (index % 5, index / 5_i32);
                (column + 10 * (row - 2).abs()) as f32
            })
            .collect();
        let area = values(flow(&land(5, &heights), &arguments("flow"), &StopFlag::default()).expect("flows"));
        assert_eq!(area[10], 2500.0);
        let area_in = |row: usize| area[row * 5];
        assert!(area_in(0) < 1000.0 && area_in(4) < 1000.0, "{area:?}");
    }

    #[test]
    fn two_brooks_of_the_first_order_make_one_of_the_second() {
        // Two gutters from the north meet in one to the south.
        #[rustfmt::skip]
        let gutters = land(7, &[
            90., 90., 90., 1., 90., 90., 90.,
            90., 90., 90., 2., 90., 90., 90.,
            90., 90., 3., 80., 3., 90., 90.,
            90., 4., 80., 80., 80., 4., 90.,
            90., 5., 80., 80., 80., 5., 90.,
        ]);
        let arguments = arguments("streams").with("area_m2", ArgumentValue::Number(200.0));
        let outcome = streams(&gutters, &arguments, &StopFlag::default()).expect("streams");
        let order = |feature: &OutcomeFeature| match feature.properties[0].1 {
            PropertyValue::Whole(order) => order,
            _ => 0,
        };
        let mut orders: Vec<i64> = outcome.features.iter().map(order).collect();
        orders.sort_unstable();
        assert_eq!(orders.last(), Some(&2), "{:?}", outcome.features);
        assert!(orders.iter().filter(|&&order| order == 1).count() >= 2, "{orders:?}");
    }
}
