//! Basins, magnitudes, floods and breaches of five real models, beside pyflwdir, SciPy, and searches written again in Python.
//!
//! `network_oracle.tsv` has counts and CRCs that `tests/tools/analysis_network_oracle.py` makes; it says what each is. It prints
//! what share of posts `r.watershed` of GRASS drains as here, too: that one fills nothing and finds its way over flats and out of
//! depressions by a least-cost search (Ehlschlaeger 1989), so that the two cannot be equal even on filled ground: of the inner
//! posts of the five, in turn, 97.7, 98.8, 97.0, 88.0 and 98.8 % drain the same way.

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use crate::arguments::ArgumentValue;
    use crate::land::Land;
    use crate::test_land::{bare, run_kind, values_of};
    use crate::water::basins::{codes, mouths};
    use crate::water::breach::{BreachLimits, BreachSearch, breach, is_pit};
    use crate::water::drainage::{Drainage, drain};
    use crate::water::fill::filled;
    use crate::water::oracle_tests::tests::{crc, has_models, model};
    use crate::water::streams::StreamNet;
    use sandtable_terrain::stop_flag::StopFlag;

    const TABLE: &str = include_str!("network_oracle.tsv");

    /// The least number of posts that a stream drains.
    const LEAST: f64 = 200.0;

    fn crc_of_numbers(numbers: &[u32]) -> String {
        crc(numbers.iter().flat_map(|number| number.to_le_bytes()))
    }

    /// Calls `check` with each model, its land and its fields after the cell.
    fn on_each(check: impl Fn(&str, &Land, &[&str])) {
        if !has_models() {
            return;
        }
        for line in TABLE.lines().skip(1) {
            let fields: Vec<&str> = line.split('\t').collect();
            let [name, cell_m, ref more @ ..] = fields[..] else { panic!("{line}") };
            let (columns, heights) = model(name);
            let cell = DVec2::splat(cell_m.parse().expect("a number"));
            check(name, &bare((DVec2::ZERO, cell), columns, heights), more);
        }
    }

    fn drained(land: &Land) -> Drainage {
        drain(&land.ground, land.ground.heights(), &StopFlag::default()).expect("drained")
    }

    #[test]
    fn basins_of_real_ground_are_those_of_pyflwdir_but_for_their_numbers() {
        on_each(|name, land, fields| {
            let drainage = drained(land);
            // The outlet of each post, by following its way.
            let mut outlet: Vec<u32> = (0..drainage.codes.len() as u32).collect();
            let is_below = |index: usize, at: u32| at == index as u32;
            drainage.pass_up(&drainage.downstream(), &mut outlet, is_below);
            let mut number_of = std::collections::BTreeMap::new();
            let mut numbers = vec![0_u32; outlet.len()];
            for (index, number) in
                numbers.iter_mut().enumerate().filter(|(index, _)| drainage.has_data(*index))
            {
                let next = number_of.len() as u32 + 1;
                *number = *number_of.entry(outlet[index]).or_insert(next);
            }
            assert_eq!(crc_of_numbers(&numbers), fields[1], "{name}: basins");
            let counts = drainage.accumulation();
            let (outlets, left_out) = mouths(&drainage, &counts, LEAST);
            assert_eq!((outlets.len() + left_out).to_string(), fields[0], "{name}: outlets");
            let codes = codes(&drainage, &outlets);
            for (index, &code) in codes.iter().enumerate().filter(|(index, _)| drainage.has_data(*index)) {
                let known = outlets.iter().position(|&at| at == outlet[index] as usize);
                assert_eq!(usize::from(code), known.map_or(0, |at| at + 1), "{name}: post {index}");
            }
        });
    }

    #[test]
    fn magnitudes_of_real_streams_are_their_sources_counted_one_by_one() {
        on_each(|name, land, fields| {
            let drainage = drained(land);
            let net = StreamNet::new(
                &drainage,
                &drainage.downstream(),
                &land.ground,
                LEAST * land.ground.cell_m2(),
            );
            let orders = net.orders(&drainage);
            let mut magnitudes = vec![0_u32; orders.len()];
            net.order.iter().for_each(|&index| magnitudes[index as usize] = orders[index as usize].shreve());
            assert_eq!(crc_of_numbers(&magnitudes), fields[2], "{name}: magnitudes");
        });
    }

    #[test]
    fn a_flood_joins_the_posts_that_scipy_joins_by_sides_and_by_corners() {
        on_each(|name, land, fields| {
            let seed: usize = fields[4].parse().expect("a number");
            let from = land.ground.map_position(land.ground.post_at(seed));
            for (connect, count, mask) in [("sides", fields[5], fields[6]), ("corners", fields[7], fields[8])]
            {
                let arguments = [
                    ("level_m", ArgumentValue::Number(fields[3].parse().expect("a number"))),
                    ("from", ArgumentValue::Points(vec![from])),
                    ("connect", ArgumentValue::Word(connect.into())),
                ];
                let outcome = run_kind("flood", land, arguments).expect("floods");
                let depths = values_of(outcome.raster.as_ref().expect("a raster"));
                let wet: Vec<u8> = depths.iter().map(|&depth| u8::from(depth > 0.0)).collect();
                assert_eq!(
                    wet.iter().filter(|&&wet| wet == 1).count().to_string(),
                    count,
                    "{name}, {connect}"
                );
                assert_eq!(crc(wet), mask, "{name}, {connect}");
            }
        });
    }

    #[test]
    fn each_pit_of_real_ground_has_the_way_out_of_least_cost_and_breaches_drain_it() {
        on_each(|name, land, fields| {
            let ground = &*land.ground;
            let (columns, rows) = (ground.columns() as usize, ground.rows() as usize);
            let mut heights = ground.heights().to_vec();
            let pits: Vec<usize> =
                (0..heights.len()).filter(|&index| is_pit(&heights, index, columns, rows)).collect();
            assert_eq!(pits.len().to_string(), fields[9], "{name}: pits");
            let limits = BreachLimits { depth_m: 1e6, length_m: 1e9 };
            let mut search = BreachSearch::new(ground, limits.length_m).expect("memory");
            let mut cost = |&pit: &usize| {
                search.way_out(ground, &heights, pit, limits.depth_m).map_or(f64::NAN, |way| way.0)
            };
            let costs: f64 = pits.iter().map(&mut cost).sum();
            let wanted: f64 = fields[10].parse().expect("a number");
            assert!((costs / wanted - 1.0).abs() < 1e-6, "{name}: {costs} is not {wanted}");
            breach(ground, &mut heights, limits, &StopFlag::default()).expect("breached");
            let filled = filled(&heights, columns, &StopFlag::default()).expect("filled");
            let raised = filled.iter().zip(&heights).filter(|(filled, height)| filled > height).count();
            assert_eq!(raised, 0, "{name}: water stays");
        });
    }
}
