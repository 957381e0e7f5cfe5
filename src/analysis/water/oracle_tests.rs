//! Filled ground, directions, drained areas, orders and heights above drainage of five real models, equal to those of RichDEM,
//! pysheds and pyflwdir to the last bit, and D-infinity but for ties.
//!
//! `oracle.tsv` has counts and CRCs that `tests/tools/analysis_water_oracle.py` makes; it says what each is.

#[cfg(test)]
pub(super) mod tests {
    use std::path::Path;

    use glam::DVec2;

    use crate::test_land::bare;
    use crate::water::drainage::{Drainage, drain};
    use crate::water::drainage_height::above_bed;
    use crate::water::infinity::InfiniteFlow;
    use crate::water::streams::StreamNet;
    use sandtable_dem::hints::DemHints;
    use sandtable_dem::read::read;
    use sandtable_terrain::lattice::Lattice;
    use sandtable_terrain::neighbors::neighbors;
    use sandtable_terrain::stop_flag::StopFlag;

    const TABLE: &str = include_str!("oracle.tsv");

    /// The CRC-32 of zip files.
    pub(in crate::water) fn crc(bytes: impl IntoIterator<Item = u8>) -> String {
        let mut crc = u32::MAX;
        for byte in bytes {
            crc ^= u32::from(byte);
            for _ in 0..8 {
                crc = if crc & 1 == 1 { crc >> 1 ^ 0xedb8_8320 } else { crc >> 1 };
            }
        }
        format!("{:08x}", !crc)
    }

    /// The CRC of heights, in which all NaN are one.
    fn crc_of_heights(heights: &[f32]) -> String {
        let bytes = |height: &f32| if height.is_nan() { f32::NAN } else { height + 0.0 }.to_le_bytes();
        crc(heights.iter().flat_map(bytes))
    }

    #[test]
    fn the_crc_is_that_of_zip_files() {
        assert_eq!(crc(*b"123456789"), "cbf43926");
    }

    fn models() -> &'static Path {
        Path::new(concat!(env!("SANDTABLE_ROOT"), "../shared/data/dem"))
    }

    /// Whether the real models are there; where they must be, a test that needs them fails.
    pub(in crate::water) fn has_models() -> bool {
        let has = models().exists() || std::env::var_os("SANDTABLE_REQUIRE_DATA").is_some();
        if !has {
            eprintln!("SKIPPED: no test data at {}", models().display());
        }
        has
    }

    /// The columns of a real model, and its heights row by row from the south-west.
    pub(in crate::water) fn model(name: &str) -> (u32, Vec<f32>) {
        let bytes = std::fs::read(models().join(name)).expect("a file");
        let raster = read(name, &bytes, &DemHints::default()).expect("elevation");
        let south_first =
            (0..raster.height).rev().flat_map(|row| (0..raster.width).map(move |column| (column, row)));
        (raster.width, south_first.map(|(column, row)| raster.at(column, row) as f32).collect())
    }

    #[test]
    fn real_ground_drains_as_with_richdem_pysheds_and_pyflwdir() {
        if !has_models() {
            return;
        }
        for line in TABLE.lines().skip(1) {
            let fields: Vec<&str> = line.split('\t').collect();
            let [
                name,
                columns,
                rows,
                cell_m,
                raw,
                raised,
                filled,
                _,
                _,
                _,
                directions,
                most,
                cells,
                ref more @ ..,
            ] = fields[..]
            else {
                panic!("{line}")
            };
            let (width, heights) = model(name);
            let height = heights.len() / width as usize;
            assert_eq!((width.to_string(), height.to_string()), (columns.into(), rows.into()), "{name}");
            assert_eq!(crc_of_heights(&heights), raw, "{name}: the elevations");
            let land =
                bare((DVec2::ZERO, DVec2::splat(cell_m.parse().expect("a number"))), width, heights.clone());
            let drainage = drain(&land.ground, &heights, &StopFlag::default()).expect("drained");
            let count =
                drainage.filled_m.iter().zip(&heights).filter(|(filled, height)| filled > height).count();
            assert_eq!(count.to_string(), raised, "{name}: posts that are raised");
            assert_eq!(crc_of_heights(&drainage.filled_m), filled, "{name}: filled");
            assert_eq!(crc(drainage.codes.iter().copied()), directions, "{name}: directions");
            let counts = drainage.accumulation();
            assert_eq!(counts.iter().max().map(u32::to_string).as_deref(), Some(most), "{name}: most");
            assert_eq!(
                crc(counts.iter().flat_map(|count| count.to_le_bytes())),
                cells,
                "{name}: drained posts"
            );
            derived(name, &land.ground, &drainage, more);
        }
    }

    /// Compares what follows from drained ground with the last columns of the table.
    fn derived(name: &str, ground: &Lattice, drainage: &Drainage, fields: &[&str]) {
        let [orders, hand, east, north] = fields else { panic!("{fields:?}") };
        let downstream = drainage.downstream();
        let net = StreamNet::new(drainage, &downstream, ground, 200.0 * ground.cell_m2());
        let by_post = net.orders(drainage);
        let of_order = |order: u8| {
            let is_one = |&&index: &&u32| by_post[index as usize].strahler() == order;
            net.order.iter().filter(is_one).count()
        };
        let found: Vec<String> =
            (1..).map(of_order).take_while(|&count| count > 0).map(|count| count.to_string()).collect();
        assert_eq!(found.join(","), *orders, "{name}: posts of streams by order");
        let mut is_bed = vec![false; drainage.codes.len()];
        net.order.iter().for_each(|&index| is_bed[index as usize] = true);
        let above = above_bed(drainage, &downstream, &is_bed);
        assert_eq!(crc_of_heights(&above), *hand, "{name}: heights above drainage");
        let flow = InfiniteFlow::new(ground, drainage);
        let (columns, rows) = (ground.columns() as usize, ground.rows() as usize);
        let level = &drainage.filled_m;
        let is_inner = |&index: &usize| {
            let around: Vec<f32> = neighbors(index, columns, rows).map(|(_, other)| level[other]).collect();
            let is_whole = around.len() == 8 && around.iter().all(|height| !height.is_nan());
            is_whole && around.iter().any(|&height| height < level[index])
        };
        let sum = (0..level.len()).filter(is_inner).fold(DVec2::ZERO, |sum, index| {
            let angle = flow.split(index).map_or(f32::NAN, |split| split.degrees);
            sum + DVec2::from_angle(f64::from(angle).to_radians())
        });
        let number = |text: &str| text.parse::<f64>().expect("a number");
        let wanted = DVec2::new(number(east), number(north));
        // Where two triangles fall alike, which whole meters make common, the last bit of a root decides: one post in 10,000
        // may differ, and one more.
        assert!(sum.distance(wanted) < 1e-4 * level.len() as f64 + 2.0, "{name}: {sum}, not {wanted}");
    }
}
