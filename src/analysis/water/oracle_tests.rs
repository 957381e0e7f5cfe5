//! Filled ground, directions and drained areas of five real models, equal to RichDEM's, pysheds' and pyflwdir's to the last bit.
//!
//! `oracle.tsv` has counts and CRCs that `tests/tools/analysis_water_oracle.py` makes; it says what each is.

#[cfg(test)]
mod tests {
    use std::path::Path;

    use glam::DVec2;

    use crate::test_land::bare;
    use crate::water::drainage::drain;
    use sandtable_dem::hints::DemHints;
    use sandtable_dem::read::read;
    use sandtable_terrain::stop_flag::StopFlag;

    const TABLE: &str = include_str!("oracle.tsv");

    /// The CRC-32 of zip files.
    fn crc(bytes: impl IntoIterator<Item = u8>) -> String {
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

    #[test]
    fn real_ground_drains_as_with_richdem_pysheds_and_pyflwdir() {
        let folder = Path::new(concat!(env!("SANDTABLE_ROOT"), "../shared/data/dem"));
        let is_required = std::env::var_os("SANDTABLE_REQUIRE_DATA").is_some();
        if !folder.exists() && !is_required {
            eprintln!("SKIPPED: no test data at {}", folder.display());
            return;
        }
        for line in TABLE.lines().skip(1) {
            let fields: Vec<&str> = line.split('\t').collect();
            let [name, columns, rows, cell_m, raw, raised, filled, _, _, _, directions, most, cells] =
                fields[..]
            else {
                panic!("{line}")
            };
            let bytes = std::fs::read(folder.join(name)).expect("a file");
            let raster = read(name, &bytes, &DemHints::default()).expect("elevation");
            assert_eq!(
                (raster.width.to_string(), raster.height.to_string()),
                (columns.into(), rows.into()),
                "{name}"
            );
            let south_first =
                (0..raster.height).rev().flat_map(|row| (0..raster.width).map(move |column| (column, row)));
            let heights: Vec<f32> = south_first.map(|(column, row)| raster.at(column, row) as f32).collect();
            assert_eq!(crc_of_heights(&heights), raw, "{name}: the elevations");
            let land = bare(
                (DVec2::ZERO, DVec2::splat(cell_m.parse().expect("a number"))),
                raster.width,
                heights.clone(),
            );
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
        }
    }
}
