//! Small lands for tests.

use std::sync::Arc;

use glam::DVec2;

use crate::land::Land;
use sandtable_geom::crs::Crs;
use sandtable_terrain::lattice::Lattice;

/// Level ground of so many posts, `cell_m` apart, its south-west post at the origin.
pub(crate) fn flat(columns: u32, rows: u32, cell_m: f64) -> Land {
    shaped(columns, rows, cell_m, |_, _| 0.0)
}

/// Ground of a form given by column and row.
pub(crate) fn shaped(columns: u32, rows: u32, cell_m: f64, height: impl Fn(u32, u32) -> f32) -> Land {
    let heights = (0..rows).flat_map(|row| (0..columns).map(move |column| (column, row)));
    let heights = heights.map(|(column, row)| height(column, row)).collect();
    let ground = Lattice::new(DVec2::ZERO, DVec2::splat(cell_m), columns, heights).expect("sound");
    Land::bare(Arc::new(ground), Crs::local())
}
