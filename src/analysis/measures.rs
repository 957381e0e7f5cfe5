//! Areas and shares of posts, and the grid on which distances between them are found.

use sandtable_geom::distance_field::RegionGrid;
use sandtable_terrain::lattice::Lattice;

/// A part of a whole in percent; 0 of nothing.
pub(crate) fn percent(part: usize, whole: usize) -> f64 {
    if whole == 0 { 0.0 } else { part as f64 / whole as f64 * 100.0 }
}

/// The posts as cells between which distances are found.
pub(crate) fn post_grid(ground: &Lattice) -> RegionGrid {
    RegionGrid { columns: ground.columns() as usize, step_m: ground.cell().to_array() }
}

/// So many posts as an area in km².
pub(crate) fn area_km2(ground: &Lattice, posts: usize) -> f64 {
    posts_km2(posts, ground.cell_m2())
}

/// So many posts, each of `cell_m2`, as an area in km².
pub(crate) fn posts_km2(posts: usize, cell_m2: f64) -> f64 {
    posts as f64 * cell_m2 / 1e6
}
