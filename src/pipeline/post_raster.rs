//! Rasters of what was computed for the posts of a lattice: bytes, with one of them for no data.

use rayon::prelude::*;

use crate::dem::raster::{Raster, Samples, north_up_nodes};
use crate::geom::crs::Crs;
use crate::terrain::hillshade::{self, HillshadeOptions, hillshade};
use crate::terrain::lattice::{Lattice, Post};

/// A byte for each post of a lattice, and which byte means no data.
pub struct PostBytes<F> {
    /// What they are: the raster's driver.
    pub name: &'static str,
    /// The byte of a post, by its index row by row from the south-west; NaN for no data.
    pub value: F,
    /// The byte for no data in a file.
    pub nodata: f64,
}

impl<F: Fn(usize) -> f32 + Sync> PostBytes<F> {
    /// The raster of the bytes, north up, its samples at the posts.
    pub fn raster(self, lattice: &Lattice, crs: &Crs) -> Raster {
        let (columns, rows) = (lattice.columns(), lattice.rows());
        let north_west = lattice.map_position(Post { column: 0, row: rows - 1 });
        let place = north_up_nodes(north_west, lattice.cell());
        let width = columns as usize;
        let mut values = vec![0.0; width * rows as usize];
        values.par_chunks_mut(width).rev().enumerate().for_each(|(row, values)| {
            values.iter_mut().enumerate().for_each(|(at, value)| *value = (self.value)(row * width + at));
        });
        Raster {
            driver: self.name,
            data_type: "Byte",
            crs: (*crs != Crs::local()).then(|| crs.clone()),
            nodata: Some(self.nodata),
            ..Raster::new(columns, Samples::F32(values)).placed(place)
        }
    }
}

/// The gray of every post: 1 facing away from the sun, 255 facing it.
pub fn hillshade_raster(lattice: &Lattice, options: &HillshadeOptions, crs: &Crs) -> Raster {
    let grays = hillshade(lattice, options);
    let value = |index: usize| match grays[index] {
        hillshade::NO_DATA => f32::NAN,
        gray => f32::from(gray),
    };
    PostBytes { name: "hillshade", value, nodata: f64::from(hillshade::NO_DATA) }.raster(lattice, crs)
}
