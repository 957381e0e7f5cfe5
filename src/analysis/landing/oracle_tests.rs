//! Landing zones against their definition in numpy, on real ground.

use crate::arguments::ArgumentValue;
use crate::test_land::{codes_of, run_kind};
use crate::test_places::{PLACES, place, table};

/// The CRC-32 of zlib.
fn crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(u32::MAX, |crc, &byte| {
        (0..8).fold(crc ^ u32::from(byte), |crc, _| (crc >> 1) ^ if crc & 1 == 1 { 0xEDB8_8320 } else { 0 })
    })
}

#[test]
fn landing_zones_are_those_of_the_definition_on_three_places() {
    let rows = table("landing_zones.csv");
    let mut count = 0;
    for (name, file) in PLACES {
        let Some(mut land) = place(file) else { return };
        let columns = land.ground.columns() as usize;
        let tree = |index: usize| {
            if (index % columns * 73 + index / columns * 151).is_multiple_of(997) { 4.0 } else { 0.0 }
        };
        land.obstacles_m = Some((0..land.ground.heights().len()).map(tree).collect());
        for row in rows.iter().filter(|row| row[0] == name) {
            let arguments = [
                ("size", ArgumentValue::Word(row[1].clone())),
                ("approach_m", ArgumentValue::Number(row[2].parse().expect("a number"))),
            ];
            let outcome = run_kind("landing-zones", &land, arguments).expect("sound");
            let codes = codes_of(outcome);
            let found = [0, 1, 2, 255].map(|code| codes.iter().filter(|&&found| found == code).count());
            let wanted = [3, 4, 5, 6].map(|cell: usize| row[cell].parse::<usize>().expect("a number"));
            assert_eq!(found, wanted, "{name}, size {}", row[1]);
            assert_eq!(crc32(&codes).to_string(), row[7], "{name}, size {}", row[1]);
            count += 1;
        }
    }
    assert_eq!(count, 9);
}
