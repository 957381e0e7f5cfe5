//! Rasters of what was computed for the posts of a lattice: bytes, with one of them for no data.

use crate::dem::raster::{Raster, Samples, north_up_nodes};
use crate::geom::crs::Crs;
use crate::terrain::hillshade::{self, HillshadeOptions, hillshade};
use crate::terrain::lattice::{Lattice, Post};

/// A byte for each post of a lattice, and which byte means no data.
pub struct PostBytes {
    /// What they are: the raster's driver.
    pub name: &'static str,
    /// NaN for no data, row by row from the south-west.
    pub values: Vec<f32>,
    /// The byte for no data in a file.
    pub nodata: f64,
}

impl PostBytes {
    /// The raster of the bytes, north up, its samples at the posts.
    pub fn raster(self, lattice: &Lattice, crs: &Crs) -> Raster {
        let columns = lattice.columns();
        let north_west = lattice.map_position(Post { column: 0, row: lattice.rows() - 1 });
        let place = north_up_nodes(north_west, lattice.cell());
        let rows: Vec<&[f32]> = self.values.chunks_exact(columns as usize).rev().collect();
        Raster {
            driver: self.name,
            data_type: "Byte",
            crs: (*crs != Crs::local()).then(|| crs.clone()),
            nodata: Some(self.nodata),
            ..Raster::new(columns, Samples::F32(rows.concat())).placed(place)
        }
    }
}

/// The gray of every post: 1 facing away from the sun, 255 facing it.
pub fn hillshade_raster(lattice: &Lattice, options: &HillshadeOptions, crs: &Crs) -> Raster {
    let value = |gray: u8| if gray == hillshade::NO_DATA { f32::NAN } else { f32::from(gray) };
    let values = hillshade(lattice, options).into_iter().map(value).collect();
    PostBytes { name: "hillshade", values, nodata: f64::from(hillshade::NO_DATA) }.raster(lattice, crs)
}
