//! Rasters of values computed for the posts of a lattice: bytes, with one of them for no data.

use glam::DVec2;
use rayon::prelude::*;

use sandtable_geom::crs::Crs;
use sandtable_raster::error::DemErrorKind;
use sandtable_raster::raster::{Raster, Samples, north_up_nodes};
use sandtable_raster::windows::{ByteRows, RasterWindow, Windows};
use sandtable_terrain::hillshade::{self, HillshadeOptions, hillshade};
use sandtable_terrain::lattice::{Lattice, Post};
use sandtable_terrain::post_rect::PostRect;

/// A byte for each post of a lattice, and which byte means no data.
pub struct PostBytes<F> {
    /// What they are: the raster's driver.
    pub name: &'static str,
    /// Fills in the bytes of the posts from one on, by its index row by row from the south-west.
    pub fill: F,
    /// The byte for no data.
    pub nodata: u8,
}

impl<F: Fn(usize, &mut [u8]) + Sync> PostBytes<F> {
    /// The raster of the bytes, north up, its samples at the posts.
    pub fn raster(self, lattice: &Lattice, crs: &Crs) -> Raster {
        let windows = self.windows(lattice, crs);
        let samples = windows.values(RasterWindow::all(windows.size()));
        Raster { samples: Samples::F32(samples), ..windows.header }
    }

    /// The raster of the bytes, made window by window.
    pub fn windows(self, lattice: &Lattice, crs: &Crs) -> PostWindows<F> {
        let header = post_header(lattice, crs, (self.name, "Byte"), f64::from(self.nodata));
        PostWindows { header, fill: self.fill, nodata: self.nodata }
    }
}

/// The raster without samples, north up, of values at the posts of a lattice; `name` is its driver.
pub(crate) fn post_header(
    lattice: &Lattice,
    crs: &Crs,
    of: (&'static str, &'static str),
    nodata: f64,
) -> Raster {
    part_header((lattice, PostRect::all(lattice)), crs, of, nodata)
}

/// [`post_header`] of some posts of a lattice.
pub(crate) fn part_header(
    (lattice, posts): (&Lattice, PostRect),
    crs: &Crs,
    (name, data_type): (&'static str, &'static str),
    nodata: f64,
) -> Raster {
    let north_west = lattice.map_position(Post { column: posts.first.column, row: posts.last.row });
    let size = (posts.width() as u32, posts.height() as u32);
    node_header((north_west, lattice.cell()), size, crs, (name, data_type, nodata))
}

/// [`post_header`] of posts from the north-western one on, given by its map position, and their distances.
pub(crate) fn node_header(
    (north_west, cell): (DVec2, DVec2),
    (columns, rows): (u32, u32),
    crs: &Crs,
    (name, data_type, nodata): (&'static str, &'static str, f64),
) -> Raster {
    let header = Raster {
        driver: name,
        data_type,
        crs: (*crs != Crs::local()).then(|| crs.clone()),
        nodata: Some(nodata),
        ..Raster::without_place(columns, rows)
    };
    header.placed(north_up_nodes(north_west, cell))
}

/// A raster of [`PostBytes`] that is made window by window.
pub struct PostWindows<F> {
    header: Raster,
    fill: F,
    nodata: u8,
}

impl<F: Fn(usize, &mut [u8]) + Sync> PostWindows<F> {
    fn values(&self, window: RasterWindow) -> Vec<f32> {
        let width = window.width as usize;
        let value = |byte: u8| if byte == self.nodata { f32::NAN } else { f32::from(byte) };
        let mut values = vec![0.0; window.samples()];
        values.par_chunks_mut(width).enumerate().for_each(|(down, values)| {
            let mut bytes = vec![0; width];
            self.fill(window.column, window.row + down as u32, &mut bytes);
            values.iter_mut().zip(bytes).for_each(|(place, byte)| *place = value(byte));
        });
        values
    }
}

impl<F: Fn(usize, &mut [u8]) + Sync> ByteRows for PostWindows<F> {
    fn fill(&self, column: u32, row: u32, out: &mut [u8]) {
        // Rows of the raster run from the north, those of posts from the south.
        let row = (self.header.height - 1 - row) as usize;
        (self.fill)(row * self.header.width as usize + column as usize, out);
    }
}

impl<F: Fn(usize, &mut [u8]) + Sync> Windows for PostWindows<F> {
    fn metadata(&self) -> &Raster {
        &self.header
    }

    fn samples(&mut self, window: RasterWindow) -> Result<Samples, DemErrorKind> {
        window.assert_within(self.size());
        Ok(Samples::F32(self.values(window)))
    }

    fn bytes(&self) -> Option<&dyn ByteRows> {
        Some(self)
    }
}

/// The gray of every post: 1 facing away from the sun, 255 facing it.
pub fn hillshade_raster(lattice: &Lattice, options: &HillshadeOptions, crs: &Crs) -> Raster {
    let grays = hillshade(lattice, options);
    let fill = |first: usize, bytes: &mut [u8]| bytes.copy_from_slice(&grays[first..][..bytes.len()]);
    PostBytes { name: "hillshade", fill, nodata: hillshade::NO_DATA }.raster(lattice, crs)
}

#[cfg(test)]
mod tests {
    use super::*;
    use sandtable_dem::dem_format::DemFormat;
    use sandtable_dem::write::write;
    use std::io::Cursor;

    #[test]
    fn made_window_by_window_bytes_are_stored_as_all_at_once() {
        // More than a tile across, all zeros in one of them, and holes.
        let (columns, rows) = (300_u32, 530_u32);
        let heights = vec![0.0; (columns * rows) as usize];
        let lattice = Lattice::new(DVec2::ZERO, DVec2::splat(10.0), columns, heights).expect("a lattice");
        let value = |index: usize| match index % columns as usize {
            column if column < 280 && index < 80_000 => 0,
            column if column % 7 == 3 => 255,
            column => (column % 255) as u8,
        };
        let fill = |first: usize, bytes: &mut [u8]| {
            (first..).zip(bytes).for_each(|(index, place)| *place = value(index));
        };
        let bytes = || PostBytes { name: "test", fill, nodata: 255 };
        let format = DemFormat::to_write("tif").expect("a GeoTIFF");
        let wanted = write(&bytes().raster(&lattice, &Crs::local()), format, "").expect("any raster");
        let mut out = Cursor::new(Vec::new());
        let writer = format.windows_writer.expect("a GeoTIFF is written in windows");
        let written = writer(&mut bytes().windows(&lattice, &Crs::local()), &mut out).expect("memory");
        assert!(out.into_inner() == wanted.bytes);
        assert_eq!(written.stored, "byte");
        let holes = (0..(columns * rows) as usize).filter(|&index| value(index) == 255).count();
        assert_eq!(written.valid, u64::from(columns * rows) - holes as u64);
    }
}
