//! Cut and fill between two grounds: the difference at each post, and volumes as prisms on the cells.

use rayon::prelude::*;

use crate::arguments::AnalysisArguments;
use crate::error::AnalysisError;
use crate::land::Land;
use crate::outcome::{
    FeatureRole, Figure, Hatching, Outcome, OutcomeFeature, OutcomeRaster, OutcomeShape, PostValues,
    ValueClass,
};
use crate::ring::AreaRow;
use sandtable_geom::polygon::counter_clockwise;
use sandtable_terrain::lattice::Post;
use sandtable_terrain::stop_flag::StopFlag;

/// The ground above the other one in meters at each post, no data outside the area; and the volumes in cubic meters.
///
/// # Errors
/// An argument where there is no other ground, or where it has other posts; [`AnalysisError::Stopped`].
pub(crate) fn cut_fill(
    land: &Land,
    arguments: &AnalysisArguments,
    stop: &StopFlag,
) -> Result<Outcome, AnalysisError> {
    let ground = &*land.ground;
    let (columns, rows) = (ground.columns() as usize, ground.rows() as usize);
    let area = arguments.points("area");
    let values = differences(land, arguments, stop)?;
    // Each row has its sums, which add up in the order of rows: the same bits for any number of threads.
    let row_sums = |(row, values): (usize, &[f32])| {
        let mut sums = [0.0_f64; 2];
        for (column, &value) in values.iter().enumerate().filter(|(_, value)| !value.is_nan()) {
            let volume = f64::from(value) * shares(column, columns) * shares(row, rows);
            sums[usize::from(value > 0.0)] += volume.abs();
        }
        sums
    };
    let sums: Vec<[f64; 2]> = values.par_chunks(columns).enumerate().map(row_sums).collect();
    let volume = |side: usize| sums.iter().map(|sums| sums[side]).sum::<f64>() * ground.cell_m2();
    let (cut, fill) = (volume(0), volume(1));
    let figure = |name, value| Figure::new(name, value, "m³");
    let outline = (!area.is_empty()).then(|| OutcomeFeature {
        shape: OutcomeShape::Area(vec![counter_clockwise(area)]),
        name: String::new(),
        role: FeatureRole::Outline,
        properties: Vec::new(),
    });
    let raster = OutcomeRaster {
        name: "cut-fill",
        unit: "m",
        values: PostValues::Numbers(values),
        classes: classes(),
    };
    Ok(Outcome {
        raster: Some(raster),
        features: outline.into_iter().collect(),
        figures: vec![figure("cut", cut), figure("fill", fill), figure("net fill", fill - cut)],
        ..Outcome::default()
    })
}

/// The ground above the other one in meters at each post; NaN outside the area and without data.
///
/// # Errors
/// An argument where there is no other ground, or where it has other posts; [`AnalysisError::Stopped`].
pub(crate) fn differences(
    land: &Land,
    arguments: &AnalysisArguments,
    stop: &StopFlag,
) -> Result<Vec<f32>, AnalysisError> {
    let Some(other) = &land.other_ground else {
        return Err(AnalysisError::argument(
            "against",
            "names no ground; state an elevation file or `source`",
        ));
    };
    let ground = &*land.ground;
    let columns = ground.columns() as usize;
    if (other.columns(), other.rows()) != (ground.columns(), ground.rows()) {
        return Err(AnalysisError::argument(
            "against",
            "has other posts than the ground; sample it at the same ones",
        ));
    }
    let area = arguments.points("area");
    let mut values = vec![f32::NAN; ground.heights().len()];
    values.par_chunks_mut(columns).enumerate().for_each(|(row, values)| {
        if stop.is_stopped() {
            return;
        }
        let start = Post { column: 0, row: row as u32 };
        let inside = AreaRow::new(area, ground.map_position(start).y);
        for (column, value) in values.iter_mut().enumerate() {
            if inside.holds(ground.map_position(Post { column: column as u32, ..start }).x) {
                let index = row * columns + column;
                *value = difference(ground.heights()[index], other.heights()[index]);
            }
        }
    });
    if stop.is_stopped() {
        return Err(AnalysisError::Stopped);
    }
    Ok(values)
}

/// A height above another; 0 where they differ by no more than heights are rounded.
fn difference(height: f32, other: f32) -> f32 {
    let difference = height - other;
    if difference.abs() <= 4.0 * f32::EPSILON * height.abs() { 0.0 } else { difference }
}

/// The share of a cell that belongs to a post along a row or column of so many: half of it at the border.
pub(crate) fn shares(index: usize, count: usize) -> f64 {
    if index == 0 || index + 1 == count { 0.5 } else { 1.0 }
}

fn classes() -> Vec<ValueClass> {
    let rows = [
        (-2e7, "cut", [200, 60, 40, 120], Hatching::Single),
        (-0.05, "unchanged", [0, 0, 0, 0], Hatching::None),
        (0.05, "fill", [50, 90, 200, 120], Hatching::Dots),
    ];
    ValueClass::of_rows(rows)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arguments::ArgumentValue;
    use glam::DVec2;
    use sandtable_geom::crs::Crs;
    use sandtable_terrain::lattice::Lattice;
    use std::sync::Arc;

    fn lattice(heights: [f32; 9]) -> Arc<Lattice> {
        Arc::new(Lattice::new(DVec2::ZERO, DVec2::new(10.0, 5.0), 3, heights.to_vec()).expect("valid input"))
    }

    fn arguments() -> AnalysisArguments {
        AnalysisArguments::new(sandtable_catalog::kind("cut-fill").expect("a kind"))
    }

    fn land() -> Land {
        let mut land = Land::bare(
            lattice([2., 2., 2., 2., 5., 0., 2., 2., f32::NAN]),
            Crs::from_epsg(32733).expect("a known system"),
        );
        land.other_ground = Some(lattice([2.; 9]));
        land
    }

    #[test]
    fn what_rounding_alone_tells_apart_is_neither_cut_nor_filled() {
        assert_eq!(difference(250.0_f32.next_up(), 250.0).to_bits(), 0.0_f32.to_bits());
        assert_eq!(difference(250.001, 250.0), 250.001 - 250.0);
        assert!(difference(f32::NAN, 1.0).is_nan());
    }

    #[test]
    fn volumes_are_those_of_prisms_by_hand() {
        // The middle post has a whole cell of 50 m² under 3 m; the eastern one half a cell under −2 m.
        let outcome = cut_fill(&land(), &arguments(), &StopFlag::default()).expect("valid input");
        let volumes: Vec<f64> = outcome.figures.iter().map(|figure| figure.value).collect();
        assert_eq!(volumes, [50.0, 150.0, 100.0]);
    }

    #[test]
    fn an_area_limits_volumes_and_raster() {
        let mut ring = Vec::new();
        for (column, row) in [(0, 0), (2, 0), (2, 2), (0, 2)] {
            ring.push(land().ground.map_position(Post { column, row }) * 0.98 + DVec2::new(0.1, 0.05));
        }
        ring[1].x -= 5.0;
        ring[2].x -= 5.0;
        let arguments = arguments().with("area", ArgumentValue::Points(ring));
        let outcome = cut_fill(&land(), &arguments, &StopFlag::default()).expect("valid input");
        let volumes: Vec<f64> = outcome.figures.iter().map(|figure| figure.value).collect();
        assert_eq!(volumes, [0.0, 150.0, 150.0]);
        assert!(outcome.raster.expect("a raster").values.value(5).is_nan());
    }

    #[test]
    fn a_land_without_another_ground_names_the_key() {
        let mut land = land();
        land.other_ground = None;
        let error = cut_fill(&land, &arguments(), &StopFlag::default()).expect_err("no other ground");
        assert_eq!(error.key(), Some("against"));
    }
}
