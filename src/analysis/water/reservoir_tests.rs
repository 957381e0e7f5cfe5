//! On which side of a dam its reservoir is: level lakes, at four rotations, with the dam drawn either way.

#[cfg(test)]
mod tests {
    use std::path::Path;

    use glam::DVec2;

    use crate::arguments::ArgumentValue;
    use crate::error::AnalysisError;
    use crate::land::Land;
    use crate::outcome::{Outcome, OutcomeShape, PropertyValue};
    use crate::test_land::{bare, run_kind, shaped};
    use sandtable_dem::hints::DemHints;
    use sandtable_dem::read::read;

    /// Posts a side, 10 m apart.
    const SIDE: u32 = 61;

    /// Ground of a form given by meters east and north of its middle, turned so many quarters counter-clockwise.
    fn turned(quarters: u32, height_m: impl Fn(f64, f64) -> f64) -> Land {
        shaped(SIDE, SIDE, 10.0, |column, row| {
            let mut at = DVec2::new(f64::from(column), f64::from(row)) * 10.0 - DVec2::splat(300.0);
            for _ in 0..quarters {
                at = DVec2::new(at.y, -at.x);
            }
            height_m(at.x, at.y) as f32
        })
    }

    /// Positions by meters east and north of the middle, turned as the ground is.
    fn places(quarters: u32, points: &[[f64; 2]]) -> Vec<DVec2> {
        let turn = |&[x, y]: &[f64; 2]| {
            let at = (0..quarters).fold(DVec2::new(x, y), |at, _| at.perp());
            at + DVec2::splat(300.0)
        };
        points.iter().map(turn).collect()
    }

    /// A lake whose surface lies level at 50 m, 100 to 300 m north of the dam's valley, with shores of 70 m; south of it a valley
    /// falls away from 40 m. Where `spills`, its water leaves by a canal in the north.
    fn lake(x: f64, y: f64, spills: bool) -> f64 {
        let is_valley = x.abs() <= 80.0;
        match y {
            y if spills && x.abs() <= 10.0 && y > 0.0 => 50.0 - (y - 200.0).max(0.0) / 10.0,
            y if y > 250.0 || !is_valley => 70.0,
            y if y > 0.0 => 50.0,
            y => 40.0 + y / 20.0 + x.abs() / 10.0,
        }
    }

    fn broken(
        land: &Land,
        dam: Vec<DVec2>,
        level_m: f64,
        more: &[Option<(&str, ArgumentValue)>],
    ) -> Result<Outcome, AnalysisError> {
        let arguments = [("dam", ArgumentValue::Points(dam)), ("level_m", ArgumentValue::Number(level_m))];
        run_kind("dam-break", land, arguments.into_iter().chain(more.iter().flatten().cloned()))
    }

    /// Whether the outline of the reservoir holds a place; `None` where no outline is one.
    fn holds(outcome: &Outcome, at: DVec2) -> Option<bool> {
        let is_reservoir = |properties: &[(&str, PropertyValue)]| {
            properties.iter().any(|(_, value)| *value == PropertyValue::Text("reservoir".into()))
        };
        let outline = outcome.features.iter().find(|feature| is_reservoir(&feature.properties))?;
        let OutcomeShape::Area(rings) = &outline.shape else { return None };
        let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        rings.iter().flatten().for_each(|&corner| (low, high) = (low.min(corner), high.max(corner)));
        Some(at.cmpge(low).all() && at.cmple(high).all())
    }

    fn refusal(outcome: Result<Outcome, AnalysisError>) -> (Option<&'static str>, String) {
        let error = outcome.map(|outcome| outcome.figures).expect_err("refused");
        (error.key(), error.to_string())
    }

    /// Whether the reader is told that the water goes around the dam or off the land.
    fn is_leaking(outcome: &Outcome) -> bool {
        outcome.notes.iter().any(|note| note.contains("the water behind") || note.contains("around the dam"))
    }

    /// All turns, with the dam drawn both ways.
    fn in_every_way(dam: &[[f64; 2]], mut check: impl FnMut(u32, Vec<DVec2>)) {
        for quarters in 0..4 {
            let line = places(quarters, dam);
            check(quarters, line.iter().rev().copied().collect());
            check(quarters, line);
        }
    }

    const ACROSS: [[f64; 2]; 2] = [[-100.0, 0.0], [100.0, 0.0]];

    #[test]
    fn the_reservoir_of_a_level_lake_is_the_lake_however_the_dam_is_drawn() {
        in_every_way(&ACROSS, |quarters, dam| {
            let land = turned(quarters, |x, y| lake(x, y, false));
            let outcome = broken(&land, dam, 52.0, &[]).expect("floods");
            let [water, valley] = [[0.0, 150.0], [0.0, -150.0]].map(|at| places(quarters, &[at])[0]);
            assert_eq!([holds(&outcome, water), holds(&outcome, valley)], [Some(true), Some(false)]);
            // 17 columns and 25 rows of 100 m², 2 m deep.
            assert_eq!(outcome.figures[0].value, 17.0 * 25.0 * 100.0 * 2.0, "{quarters} quarters");
            assert!(!is_leaking(&outcome), "{:?}", outcome.notes);
        });
    }

    #[test]
    fn a_full_lake_is_on_its_side_by_its_surface() {
        let stated = [("volume_m3", 300_000.0), ("height_m", 12.0)];
        let stated = stated.map(|(name, value)| Some((name, ArgumentValue::Number(value))));
        in_every_way(&ACROSS, |quarters, dam| {
            let land = turned(quarters, |x, y| lake(x, y, false));
            let outcome = broken(&land, dam.clone(), 50.0, &stated).expect("floods");
            assert_eq!(outcome.figures[0].value, 300_000.0);
            // The flood runs down the valley.
            let way = outcome.features.iter().find_map(|feature| match &feature.shape {
                OutcomeShape::Line(line) => line.last().copied(),
                _ => None,
            });
            let mouth = places(quarters, &[[0.0, -300.0]])[0];
            assert!(way.expect("a way").distance(mouth) < 30.0, "{way:?} is not {mouth}");
            let (key, _) = refusal(broken(&land, dam, 50.0, &[]));
            assert_eq!(key, Some("level_m"), "nothing is below the level behind the dam");
        });
    }

    #[test]
    fn a_dam_inside_a_level_lake_holds_the_closed_half() {
        // The dam's line lies 100 m up the lake, on water that is level on both of its sides.
        in_every_way(&[[-100.0, 100.0], [100.0, 100.0]], |quarters, dam| {
            let land = turned(quarters, |x, y| lake(x, y, false));
            let outcome = broken(&land, dam, 52.0, &[]).expect("floods");
            assert_eq!(holds(&outcome, places(quarters, &[[0.0, 200.0]])[0]), Some(true));
            assert_eq!(holds(&outcome, places(quarters, &[[0.0, 50.0]])[0]), Some(false));
            // 15 of its rows lie beyond the dam.
            assert_eq!(outcome.figures[0].value, 17.0 * 15.0 * 100.0 * 2.0);
        });
    }

    #[test]
    fn a_lake_whose_water_leaves_elsewhere_is_refused_unless_a_point_tells_the_side() {
        in_every_way(&ACROSS, |quarters, dam| {
            let land = turned(quarters, |x, y| lake(x, y, true));
            let (key, message) = refusal(broken(&land, dam.clone(), 52.0, &[]));
            assert_eq!(key, Some("reservoir"));
            assert!(message.contains("leaves the land on both sides of the dam"), "{message}");
            let at = |place: [f64; 2]| Some(("reservoir", ArgumentValue::Points(places(quarters, &[place]))));
            let outcome = broken(&land, dam.clone(), 52.0, &[at([0.0, 150.0])]).expect("floods");
            assert_eq!(holds(&outcome, places(quarters, &[[50.0, 150.0]])[0]), Some(true));
            assert!(
                outcome.notes.iter().any(|note| note.contains("reaches the border")),
                "{:?}",
                outcome.notes
            );
            let off = [at([0.0, 0.0]), at([0.0, 9000.0])]
                .map(|at| refusal(broken(&land, dam.clone(), 52.0, &[at])).0);
            assert_eq!(off, [Some("reservoir"); 2], "on the dam, and off the land");
        });
    }

    #[test]
    fn a_lake_without_an_outlet_holds_water_on_both_sides_and_is_refused() {
        in_every_way(&ACROSS, |quarters, dam| {
            let bowl = |x: f64, y: f64| if x.hypot(y) < 90.0 { 50.0 } else { 70.0 };
            let land = turned(quarters, bowl);
            let (key, message) = refusal(broken(&land, dam, 52.0, &[]));
            assert_eq!(key, Some("reservoir"));
            assert!(message.contains("holds water on both sides"), "{message}");
        });
    }

    #[test]
    fn a_basin_below_a_lake_that_spills_is_not_its_reservoir() {
        // The valley is dammed at its mouth too, so that it holds water, and the lake spills.
        let below = |x: f64, y: f64| if y < -250.0 { 70.0 } else { lake(x, y, true) };
        in_every_way(&ACROSS, |quarters, dam| {
            let (key, message) = refusal(broken(&turned(quarters, below), dam, 52.0, &[]));
            assert_eq!(key, Some("reservoir"));
            assert!(message.contains("below the other side"), "{message}");
        });
    }

    /// The land of Red Butte in Utah, whose reservoir lies level at 1634 m behind a dam with a crest of 1637 m; `None` where there
    /// is no test data.
    fn red_butte() -> Option<Land> {
        let folder = Path::new(concat!(env!("SANDTABLE_ROOT"), "../shared/data/scenes/redbutte_us"));
        if !folder.exists() && std::env::var_os("SANDTABLE_REQUIRE_DATA").is_none() {
            eprintln!("SKIPPED: no test data at {}", folder.display());
            return None;
        }
        let bytes = std::fs::read(folder.join("red_butte_dem.tif")).expect("a file");
        let raster = read("red_butte_dem.tif", &bytes, &DemHints::default()).expect("elevation");
        let (cell_m, north_west) = (26.477018215008, DVec2::new(430567.207732, 4519510.880425));
        let origin = north_west + DVec2::new(0.5, 0.5 - f64::from(raster.height)) * cell_m;
        let rows = (0..raster.height).rev();
        let heights = rows.flat_map(|row| (0..raster.width).map(move |column| (column, row)));
        let heights = heights.map(|(column, row)| raster.at(column, row) as f32).collect();
        Some(bare((origin, DVec2::splat(cell_m)), raster.width, heights))
    }

    #[test]
    fn red_butte_s_reservoir_is_behind_its_dam_and_no_dam_parts_its_lake() {
        let Some(land) = red_butte() else { return };
        let dam = vec![DVec2::new(431454.0, 4514441.0), DVec2::new(431587.0, 4514335.0)];
        let (lake, valley) = (DVec2::new(431700.0, 4514530.0), DVec2::new(431300.0, 4514300.0));
        let parting = vec![DVec2::new(431700.0, 4514660.0), DVec2::new(431700.0, 4514410.0)];
        let mut volumes = Vec::new();
        for is_reversed in [false, true] {
            let turned = |line: &[DVec2]| {
                let mut line = line.to_vec();
                if is_reversed {
                    line.reverse();
                }
                line
            };
            let outcome = broken(&land, turned(&dam), 1636.0, &[]).expect("floods");
            assert_eq!([holds(&outcome, lake), holds(&outcome, valley)], [Some(true), Some(false)]);
            // SciPy's `ndimage.label` joins 47 posts below 1636 m, the dam's among them, which hold 56,061 m³.
            assert!((55_000.0..56_061.3).contains(&outcome.figures[0].value), "{:?}", outcome.figures);
            assert!((5.0..30.0).contains(&outcome.figures[1].value), "{:?}", outcome.figures);
            assert!(!is_leaking(&outcome), "{:?}", outcome.notes);
            volumes.push(outcome.figures[0].value);
            // Across the lake, the real dam holds the other half too.
            let (key, message) = refusal(broken(&land, turned(&parting), 1636.0, &[]));
            assert_eq!(key, Some("reservoir"));
            assert!(message.contains("holds water on both sides"), "{message}");
        }
        assert_eq!(volumes[0], volumes[1]);
    }
}
