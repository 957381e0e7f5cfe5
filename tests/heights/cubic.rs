//! Cubic heights of a raster against those of GDAL, `gdalwarp -r cubic`, at positions between its samples.

use glam::DVec2;
use sandtable_dem::hints::DemHints;
use sandtable_dem::read::read;
use sandtable_raster::answer::Answer;
use sandtable_terrain::query::Interpolation;
use sandtable_terrain::query::source::raster_height;

/// Meters: the numbers of both are right to some 1e-13 of a height of 600 m, and positions to 1e-14 degrees, a hundred
/// millionth of a cell of which heights differ by a few tens of meters.
const ROUNDING_M: f64 = 1e-8;

#[test]
fn cubic_heights_of_a_raster_are_gdal_s() {
    let bytes = std::fs::read(concat!(env!("SANDTABLE_ROOT"), "assets/jacksboro/dem.tif"));
    let raster =
        read("dem.tif", &bytes.expect("a file of the project"), &DemHints::default()).expect("sound");
    let mut count = 0;
    for line in include_str!("cubic.txt").lines().filter(|line| !line.starts_with('#')) {
        let numbers: Vec<f64> = line.split(' ').map(|word| word.parse().expect("a number")).collect();
        let [x, y, height_m] = numbers[..] else { panic!("{line}") };
        let at = DVec2::new(x, y);
        let Answer::Height(found_m) = raster_height(&raster, Interpolation::Cubic, at) else {
            panic!("{line}")
        };
        assert!((found_m - height_m).abs() < ROUNDING_M, "{line}: {found_m}");
        // The others are other heights there.
        let Answer::Height(bilinear_m) = raster_height(&raster, Interpolation::Bilinear, at) else {
            panic!("{line}")
        };
        count += usize::from((bilinear_m - height_m).abs() > 0.1);
    }
    assert!(count > 60, "{count} of 120 differ from bilinear");
}
