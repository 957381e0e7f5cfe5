//! Real places for tests, from the test data beside the checkout, and tables of other programs about them.

#[cfg(test)]
use std::path::Path;

use crate::land::Land;
use sandtable_geom::crs::Crs;
use sandtable_terrain::lattice::Lattice;

/// The places of the tables in `tests/analysis`, which `tests/tools/analysis_movement_oracle.py` makes.
pub(crate) const PLACES: [(&str, &str); 3] = [
    ("redbutte", "scenes/redbutte_us/red_butte_dem.tif"),
    ("wake", "scenes/wake_nc_us/elev_ned_30m.tif"),
    ("taunton", "scenes/taunton_uk/dtm.tif"),
];

/// The bare land of an elevation file of the test data; `None`, with a loud line, where there is none.
pub(crate) fn place(file: &str) -> Option<Land> {
    let path = Path::new(env!("SANDTABLE_ROOT")).join("../shared/data").join(file);
    let Ok(bytes) = std::fs::read(&path) else {
        eprintln!("SKIPPED: no test data at {}", path.display());
        assert!(std::env::var_os("SANDTABLE_REQUIRE_DATA").is_none(), "SANDTABLE_REQUIRE_DATA is set");
        return None;
    };
    let raster = sandtable_dem::read::read(file, &bytes, &Default::default()).expect("a raster");
    let lattice = Lattice::from_raster(&raster).expect("a lattice");
    Some(Land::bare(std::sync::Arc::new(lattice), Crs::local()))
}

/// The rows of a table of `tests/analysis`, cell by cell, comments left out.
pub(crate) fn table(name: &str) -> Vec<Vec<String>> {
    let path = Path::new(env!("SANDTABLE_ROOT")).join("tests/analysis").join(name);
    let text = std::fs::read_to_string(path).expect("a table");
    let rows = text.lines().filter(|line| !line.starts_with('#'));
    rows.map(|line| line.split(',').map(str::to_owned).collect()).collect()
}
