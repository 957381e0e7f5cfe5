//! Times against GRASS `r.walk` and `r.cost`, routes against scikit-image, on real ground.

use super::tests::everywhere;
use super::*;
use crate::test_land::shaped;
use crate::test_places::{PLACES, place, table};
use sandtable_terrain::stop_flag::StopFlag;

/// People on foot whom no slope stops, as `r.walk` has them.
fn walker() -> Vehicle {
    let steep = [199.0, 200.0];
    Vehicle {
        slope_up_percent: steep,
        slope_down_percent: steep,
        gap_m: 0.0,
        ..Vehicle::built_in("foot").expect("built in")
    }
}

/// Seconds a meter by bands of height, as the tables have them; NaN without data.
fn paces(land: &Land) -> Vec<f32> {
    let pace = |height: &f32| 1.0 + (height / 8.0).floor().rem_euclid(5.0) * 0.5;
    land.ground.heights().iter().map(pace).collect()
}

/// Level ground with these paces.
fn with_paces<'a>(level: &'a Land, paces: &[f32]) -> TravelGround<'a> {
    let going = Going {
        codes: Vec::new(),
        speed_kmh: paces.iter().map(|pace| 3.6 / pace).collect(),
        is_way: vec![false; paces.len()],
        closed: None,
        notes: Vec::new(),
    };
    TravelGround::new(level, going, &walker(), true).expect("memory")
}

fn level(land: &Land) -> Land {
    let ground = &land.ground;
    let level = shaped(ground.columns(), ground.rows(), ground.cell().x, |_, _| 0.0);
    assert!((ground.cell().x / ground.cell().y - 1.0).abs() < 1e-9, "square cells");
    level
}

/// The greatest relative difference between times and the rows of a tool; the rows are all there.
fn greatest_difference(times: &[f32], columns: usize, rows: &[Vec<String>], tool: &str) -> f64 {
    let mut greatest = 0.0_f64;
    let mut count = 0;
    for row in rows.iter().filter(|row| row[0] == tool) {
        let [column, line] = [1, 2].map(|cell: usize| row[cell].parse::<usize>().expect("a number"));
        let wanted: f64 = row[3].parse().expect("a number");
        let found = f64::from(times[line * columns + column]);
        let difference = if wanted == found { 0.0 } else { (found - wanted).abs() / wanted };
        greatest = greatest.max(difference);
        count += 1;
    }
    assert!(count >= 8, "{tool} has rows");
    greatest
}

fn start(land: &Land) -> usize {
    let (columns, rows) = (land.ground.columns(), land.ground.rows());
    (rows / 3 * columns + columns / 3) as usize
}

/// The times with sixteen neighbors and then with eight, as the columns of these tools have them.
fn check_times(ground: &mut TravelGround<'_>, name: &str, tools: [&str; 2], start: usize) {
    let rows = table(&format!("movement_{name}.csv"));
    ground.has_triangles = false;
    for (tool, count) in tools.into_iter().zip([16, 8]) {
        ground.steps.truncate(count);
        let times = everywhere(ground, &[start]);
        let greatest = greatest_difference(&times, ground.lattice().columns() as usize, &rows, tool);
        println!("{name} {tool} {greatest:.2e}");
        assert!(greatest < 0.005, "{name} {tool}: {greatest}");
    }
}

#[test]
fn times_on_foot_are_those_of_r_walk_on_three_places() {
    for (name, file) in PLACES {
        let Some(land) = place(file) else { return };
        let going = Going::new(&land, &walker()).expect("memory");
        let mut ground = TravelGround::new(&land, going, &walker(), true).expect("memory");
        check_times(&mut ground, name, ["walk16", "walk8"], start(&land));
    }
}

#[test]
fn times_over_level_ground_are_those_of_r_cost_on_three_places() {
    for (name, file) in PLACES {
        let Some(land) = place(file) else { return };
        let level = level(&land);
        let mut ground = with_paces(&level, &paces(&land));
        check_times(&mut ground, name, ["cost16", "cost8"], start(&land));
    }
}

#[test]
fn routes_cost_what_those_of_scikit_image_do_and_never_more() {
    for (name, file) in PLACES {
        let Some(land) = place(file) else { return };
        let rows = table(&format!("movement_{name}.csv"));
        let columns = land.ground.columns() as usize;
        let level = level(&land);
        let mut ground = with_paces(&level, &paces(&land));
        ground.has_triangles = false;
        let of_sixteen = everywhere(&ground, &[start(&land)]);
        ground.steps.truncate(8);
        for row in rows.iter().filter(|row| row[0] == "route") {
            let [column, line] = [1, 2].map(|cell: usize| row[cell].parse::<usize>().expect("a number"));
            let wanted: f64 = row[3].parse().expect("a number");
            let end = line * columns + column;
            let way =
                ground.quickest_way(&[start(&land)], &[end], &StopFlag::default()).expect("not stopped");
            let along = ground.seconds_along(&way.expect("a way"));
            assert!((along / wanted - 1.0).abs() < 1e-4, "{name} {row:?}: {along}");
            // With knight's moves, a route is at most as long, and at least as long as the straight bound of eight.
            let short = f64::from(of_sixteen[end]) / wanted;
            assert!((1.0 / 1.0824..=1.0001).contains(&short), "{name} {row:?}: {short}");
        }
    }
}

/// How much longer ways by steps take than those across triangles: on average, and at most.
#[test]
fn on_real_ground_steps_take_longer_than_triangles_by_what_the_catalog_says() {
    for (name, file) in PLACES {
        let Some(land) = place(file) else { return };
        for (vehicle, [bound, bound_most]) in [("foot", [1.025, 1.15]), ("tracked", [1.07, 3.0])] {
            let vehicle = Vehicle::built_in(vehicle).expect("built in");
            let mut ground = super::tests::travel(&land, &vehicle);
            let across = everywhere(&ground, &[start(&land)]);
            ground.has_triangles = false;
            let by_steps = everywhere(&ground, &[start(&land)]);
            let reached = |times: &[f32]| times.iter().filter(|time| time.is_finite()).count();
            // Some steep ground has a passable direction between those of steps.
            let only_across = reached(&across) - reached(&by_steps);
            assert!(only_across <= across.len() / 20, "{name} {only_across}");
            let far =
                across.iter().zip(&by_steps).filter(|(across, steps)| **across > 0.0 && steps.is_finite());
            let ratios: Vec<f64> = far.map(|(&across, &steps)| f64::from(steps / across)).collect();
            let mean = ratios.iter().sum::<f64>() / ratios.len() as f64;
            let (least, most) = ratios
                .iter()
                .fold((2.0_f64, 0.0_f64), |(least, most), &ratio| (least.min(ratio), most.max(ratio)));
            let is_within = mean > 1.001 && mean < bound && least >= 1.0 && most < bound_most;
            assert!(is_within, "{name} {}: {mean} {least} {most}", vehicle.name);
        }
    }
}
