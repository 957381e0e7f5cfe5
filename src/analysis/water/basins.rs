//! The kind `basins`: the land that drains through each of several outlets.

use glam::DVec2;

use super::outlines::{grown, outlines};
use super::prepared::WaterGround;
use super::streams::least_posts;
use crate::arguments::AnalysisArguments;
use crate::error::AnalysisError;
use crate::land::Land;
use crate::measures::area_km2;
use crate::outcome::{
    FeatureRole, Figure, Hatching, Outcome, OutcomeFeature, OutcomeRaster, OutcomeShape, OutcomeTable,
    PostValues, PropertyValue, TableColumn, ValueClass,
};
use crate::place::post_under;
use crate::water::drainage::Drainage;
use sandtable_terrain::lattice::Lattice;
use sandtable_terrain::post_rect::PostRect;
use sandtable_terrain::stop_flag::StopFlag;

/// The most basins: a code of a raster is a byte.
const MOST_BASINS: usize = 250;

/// The most basins with a class each; the legend of more is no help.
const MOST_CLASSES: usize = 12;

/// Tints of basins, in turn.
const TINTS: [[u8; 4]; 6] = [
    [90, 150, 210, 90],
    [220, 150, 70, 90],
    [110, 180, 110, 90],
    [190, 110, 170, 90],
    [210, 200, 90, 90],
    [130, 130, 140, 90],
];

/// Hatchings of basins, in turn; neighbors with the same one are told apart by their outlines.
const HATCHINGS: [Hatching; 4] = [Hatching::Single, Hatching::Dots, Hatching::Level, Hatching::None];

/// The columns of the table.
const COLUMNS: [TableColumn; 5] = [
    TableColumn::of_marks("basin"),
    TableColumn::new("area", "km²", 3),
    TableColumn::new("with basins above", "km²", 3),
    TableColumn::new("outlet", "m", 1),
    TableColumn::new("highest", "m", 1),
];

/// What is known of a basin.
struct Basin {
    outlet: usize,
    posts: usize,
    rect: Option<PostRect>,
    highest_m: f32,
}

/// The basins of pour points, or of the places where much water leaves the land.
///
/// # Errors
/// [`AnalysisError::Argument`] and [`AnalysisError::Place`] of pour points; [`AnalysisError::Memory`] and
/// [`AnalysisError::Stopped`].
pub(crate) fn basins(
    land: &Land,
    arguments: &AnalysisArguments,
    stop: &StopFlag,
) -> Result<Outcome, AnalysisError> {
    let ground = &*land.ground;
    let mut water = WaterGround::of(land, arguments, stop)?;
    let drainage = water.drained(stop)?;
    let counts = drainage.accumulation();
    let outlets = match arguments.points("pour_points") {
        [] => {
            let least = least_posts(ground, arguments.number("area_m2"));
            let (outlets, left_out) = mouths(&drainage, &counts, least);
            if left_out > 0 {
                water.notes.push(format!("{left_out} more basins are left out; state a larger `area_m2`"));
            }
            outlets
        }
        points => poured(ground, points, &counts, arguments.number("snap_m"))?,
    };
    if outlets.is_empty() {
        water.notes.push("no outlet drains as much; state a smaller `area_m2`".into());
    }
    let codes = codes(&drainage, &outlets);
    let mut basins: Vec<Basin> = outlets
        .iter()
        .map(|&outlet| Basin { outlet, posts: 0, rect: None, highest_m: f32::NEG_INFINITY })
        .collect();
    for (index, &code) in codes.iter().enumerate() {
        if let Some(basin) = usize::from(code).checked_sub(1).and_then(|at| basins.get_mut(at)) {
            basin.posts += 1;
            basin.rect = Some(grown(basin.rect, ground.post_at(index)));
            basin.highest_m = basin.highest_m.max(ground.heights()[index]);
        }
    }
    let mut features = Vec::new();
    let mut rows = Vec::new();
    for (at, basin) in basins.iter().enumerate() {
        let number = at + 1;
        let (own, whole) = (area_km2(ground, basin.posts), area_km2(ground, counts[basin.outlet] as usize));
        let properties = vec![
            ("basin", PropertyValue::Whole(number as i64)),
            ("area_km2", PropertyValue::Number(own)),
            ("with_basins_above_km2", PropertyValue::Number(whole)),
        ];
        let shapes =
            basin.rect.map(|rect| outlines(ground, rect, |index| usize::from(codes[index]) == number));
        let feature = |shape, role| OutcomeFeature {
            shape,
            name: number.to_string(),
            role,
            properties: properties.clone(),
        };
        features.extend(shapes.into_iter().flatten().map(|shape| feature(shape, FeatureRole::Outline)));
        let outlet = OutcomeShape::Point(ground.map_position(ground.post_at(basin.outlet)));
        features.push(feature(outlet, FeatureRole::Place));
        rows.push(vec![
            PropertyValue::Whole(number as i64),
            PropertyValue::Number(own),
            PropertyValue::Number(whole),
            PropertyValue::Number(f64::from(ground.heights()[basin.outlet])),
            PropertyValue::Number(f64::from(basin.highest_m)),
        ]);
    }
    let covered = basins.iter().map(|basin| basin.posts).sum();
    let class = |number: usize| {
        let tint = TINTS[(number - 1) % TINTS.len()];
        let hatching = HATCHINGS[(number - 1) % HATCHINGS.len()];
        ValueClass::new(number as f32, format!("basin {number}"), tint, hatching)
    };
    let classes = match basins.len() {
        count @ 1..=MOST_CLASSES => std::iter::once(ValueClass::new(0.0, "none", [0; 4], Hatching::None))
            .chain((1..=count).map(class))
            .collect(),
        _ => Vec::new(),
    };
    Ok(Outcome {
        raster: Some(OutcomeRaster { name: "basin", unit: "", values: PostValues::Codes(codes), classes }),
        features,
        tables: vec![OutcomeTable { title: "Basins".into(), columns: COLUMNS.into(), rows }],
        figures: vec![
            Figure::new("basins", basins.len() as f64, ""),
            Figure::new("area of basins", area_km2(ground, covered), "km²"),
        ],
        notes: water.notes,
        ..Outcome::default()
    })
}

/// The posts by which at least so many posts drain off the land, the most first, and how many of them are left out.
pub(super) fn mouths(drainage: &Drainage, counts: &[u32], least: f64) -> (Vec<usize>, usize) {
    let mut mouths: Vec<usize> = (0..counts.len())
        .filter(|&index| f64::from(counts[index]) >= least && drainage.to(index).is_none())
        .collect();
    mouths.sort_by_key(|&index| (std::cmp::Reverse(counts[index]), index));
    let left_out = mouths.len().saturating_sub(MOST_BASINS);
    mouths.truncate(MOST_BASINS);
    (mouths, left_out)
}

/// The posts of pour points, each moved to the post within `snap_m` that drains most.
fn poured(
    ground: &Lattice,
    points: &[DVec2],
    counts: &[u32],
    snap_m: f64,
) -> Result<Vec<usize>, AnalysisError> {
    let key = "pour_points";
    if points.len() > MOST_BASINS {
        let problem = format!("has {} points; state at most {MOST_BASINS}", points.len());
        return Err(AnalysisError::argument(key, problem));
    }
    let mut outlets = Vec::with_capacity(points.len());
    for &at in points {
        let outlet = snapped(ground, (post_under(ground, key, at)?, at), counts, snap_m);
        if outlets.contains(&outlet) {
            return Err(AnalysisError::Place { key, at, problem: "another point has the same post" });
        }
        outlets.push(outlet);
    }
    Ok(outlets)
}

/// The post within `snap_m` of a place that drains most, the nearest of several; at least the post itself.
fn snapped(ground: &Lattice, (post, at): (usize, DVec2), counts: &[u32], snap_m: f64) -> usize {
    let grid = ground.grid_from_map(at);
    let reach = DVec2::splat(snap_m) / ground.cell();
    let near = PostRect::between(ground, grid - reach, grid + reach);
    let mut best = (counts[post], f64::NEG_INFINITY, post);
    for post in near.into_iter().flat_map(PostRect::posts) {
        let index = ground.index(post);
        let off = ((post.grid() - grid) * ground.cell()).length_squared();
        if off <= snap_m * snap_m && (counts[index], -off) > (best.0, best.1) {
            best = (counts[index], -off, index);
        }
    }
    best.2
}

/// The basin of each post, from 1; 0 where it drains through no outlet.
pub(super) fn codes(drainage: &Drainage, outlets: &[usize]) -> Vec<u8> {
    let mut codes = vec![0_u8; drainage.codes.len()];
    for (at, &outlet) in outlets.iter().enumerate() {
        codes[outlet] = at as u8 + 1;
    }
    drainage.pass_up(&drainage.downstream(), &mut codes, |_, code| code == 0);
    for (index, code) in codes.iter_mut().enumerate().filter(|(index, _)| !drainage.has_data(*index)) {
        debug_assert_eq!(*code, 0, "post {index} has no data");
        *code = PostValues::NO_CODE;
    }
    codes
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arguments::ArgumentValue;
    use crate::test_land::{bare, noise, run_kind, shaped, values_of};

    /// Two valleys that fall to the south in columns 3 and 11, with a ridge in column 7.
    fn valleys() -> Land {
        shaped(15, 12, 10.0, |column, row| {
            let across = column.abs_diff(3).min(column.abs_diff(11));
            (row + 10 * across) as f32
        })
    }

    #[test]
    fn two_valleys_are_two_basins_with_the_ridge_between_them() {
        let arguments = [("area_m2", ArgumentValue::Number(4000.0))];
        let outcome = run_kind("basins", &valleys(), arguments).expect("basins");
        let codes = values_of(outcome.raster.as_ref().expect("a raster"));
        assert_eq!(outcome.tables[0].rows.len(), 2, "{codes:?}");
        // The ridge falls alike to both sides, and the east comes first.
        assert_eq!((codes[6 * 15 + 3], codes[6 * 15 + 11]), (2.0, 1.0));
        let of = |number: f32| codes.iter().filter(|&&code| code == number).count();
        assert_eq!((of(1.0), of(2.0)), (8 * 12, 7 * 12));
        let areas = outcome.features.iter().filter(|feature| matches!(feature.shape, OutcomeShape::Area(_)));
        assert_eq!(areas.count(), 2);
    }

    #[test]
    fn a_basin_above_another_is_told_apart_from_it() {
        let points = vec![DVec2::new(30.0, 0.0), DVec2::new(30.0, 60.0)];
        let arguments = [("pour_points", ArgumentValue::Points(points))];
        let outcome = run_kind("basins", &valleys(), arguments).expect("basins");
        let number = |row: usize, column: usize| match outcome.tables[0].rows[row][column] {
            PropertyValue::Number(number) => number,
            _ => f64::NAN,
        };
        // What drains through the lower one is its own and what is above it.
        assert!((number(0, 2) - number(0, 1) - number(1, 2)).abs() < 1e-12);
        assert!(number(1, 1) > 0.0 && (number(1, 1) - number(1, 2)).abs() < 1e-12);
    }

    #[test]
    fn a_point_beside_the_bed_snaps_to_it() {
        let run = |snap_m: f64| {
            let arguments = [
                ("pour_points", ArgumentValue::Points(vec![DVec2::new(44.0, 51.0)])),
                ("snap_m", ArgumentValue::Number(snap_m)),
            ];
            run_kind("basins", &valleys(), arguments).expect("basins").figures[1].value
        };
        assert!(run(15.0) > 4.0 * run(0.0), "{} and {}", run(15.0), run(0.0));
    }

    #[test]
    fn points_off_the_land_in_holes_and_on_one_another_are_refused() {
        let land = bare((DVec2::ZERO, DVec2::splat(10.0)), 20, noise(400, 6, 30, true));
        let hole = land.ground.heights().iter().position(|height| height.is_nan()).expect("a hole");
        let hole = land.ground.map_position(land.ground.post_at(hole));
        let (off, sound) = (DVec2::new(-100.0, 0.0), DVec2::new(0.0, 0.0));
        for points in [vec![off], vec![hole], vec![sound, sound], vec![DVec2::NAN], vec![sound; 300]] {
            let arguments = [("pour_points", ArgumentValue::Points(points))];
            let error = run_kind("basins", &land, arguments).expect_err("refused");
            assert_eq!(error.key(), Some("pour_points"));
        }
    }
}
