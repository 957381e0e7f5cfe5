//! Surfer grids (`.grd`): version 7 (`DSRB`), version 6 binary (`DSBB`) and text (`DSAA`).
//!
//! Specification: Golden Software, *Surfer 7 Grid File Format*, *Surfer 6 Grid File Format* and *ASCII Grid File
//! Format*.
//!
//! ```text
//! DSAA, DSBB   columns, rows (i16), x from to, y from to, z from to (f64), heights (f32)
//! DSRB         sections: name, bytes i32, content
//!   GRID       rows, columns i32, x, y of the south-west node, x size, y size, z from to, rotation, blank f64
//!   DATA       heights f64
//! ```
//!
//! Little-endian. Heights lie on nodes, rows run north. Values from the blank value (1.70141e38) on are no data.

use glam::DVec2;

use crate::dem_file::DemFile;
use crate::dem_format::{DemFormat, Recognition, any_size};
use crate::formats::sample_layout::{NoData, SampleLayout};
use crate::formats::text::{TextWords, is_missing, number};
use sandtable_base::bytes::{ByteFields, ByteOrder, bytes_at};
use sandtable_raster::error::DemErrorKind;
use sandtable_raster::limits::SizeClaim;
use sandtable_raster::raster::{Raster, Samples, north_up_nodes};
use sandtable_raster::sample_type::SampleType;

pub(super) static FORMAT: DemFormat = DemFormat {
    name: "Surfer grid",
    extensions: &["grd"],
    shared_extensions: &[],
    recognition: Recognition::Content {
        matches: |bytes| [b"DSAA", b"DSBB", b"DSRB"].iter().any(|start| bytes.starts_with(*start)),
        start: "DSAA, DSBB or DSRB",
    },
    reader: read,
    windows: None,
    most_bytes: any_size,
    writer: None,
    windows_writer: None,
};

/// The blank value of the versions whose files do not state it.
const BLANK: f64 = 1.70141e38;

/// The same as version 6 writes it: the nearest of 32 bits, which GDAL states as the no-data value.
const BLANK_STATED: f64 = 1.701_410_009_187_828e38;

fn read(file: &DemFile) -> Result<Raster, DemErrorKind> {
    let grid = match &file.bytes[..4] {
        b"DSAA" => text_grid(file.bytes)?,
        b"DSBB" => version_6(file.bytes)?,
        _ => version_7(file.bytes)?,
    };
    let SurferGrid { raster, first, cell } = grid;
    if !(first.is_finite() && cell.is_finite() && cell.min_element() > 0.0) {
        return Err(DemErrorKind::Georeference {
            reason: format!("its nodes start at {first} and are {} by {} apart", cell.x, cell.y),
            remedy: "save the grid again",
        });
    }
    let north_west = DVec2::new(first.x, first.y + cell.y * f64::from(raster.height - 1));
    Ok(Raster { crs: file.crs()?, ..raster.placed(north_up_nodes(north_west, cell)) })
}

struct SurferGrid {
    raster: Raster,
    /// The south-west node.
    first: DVec2,
    cell: DVec2,
}

impl SurferGrid {
    /// A grid of version 6 between its outermost nodes.
    fn between(driver: &'static str, raster: Raster, min: DVec2, max: DVec2) -> Self {
        let cell = (max - min) / (raster.grid_size() - 1.0);
        Self { raster: Raster { driver, nodata: Some(BLANK_STATED), ..raster }, first: min, cell }
    }
}

fn text_grid(bytes: &[u8]) -> Result<SurferGrid, DemErrorKind> {
    let mut words = TextWords::new(&bytes[4..]);
    let mut next = |what: &str| {
        let word = words.next().and_then(number);
        word.ok_or_else(|| FORMAT.broken(format!("{what} is missing or no number")))
    };
    let (columns, rows) = (next("the number of columns")?, next("the number of rows")?);
    let [x0, x1, y0, y1] = [next("x from")?, next("x to")?, next("y from")?, next("y to")?];
    for unused in ["z from", "z to"] {
        next(unused)?;
    }
    let whole = |value: f64| if value.fract() == 0.0 && value >= 0.0 { value as u64 } else { 0 };
    let size = SizeClaim::new(whole(columns), whole(rows), 2).check(words.rest().len() + 1)?;
    let count = size.x as usize * size.y as usize;
    let mut values = Vec::with_capacity(count);
    for word in words.take(count) {
        let wrong = || FORMAT.broken(format!("height {} of {count} is not a number", values.len() + 1));
        let value = if is_missing(word) { f64::NAN } else { number(word).ok_or_else(wrong)? };
        values.push(if value >= BLANK || !value.is_finite() { f32::NAN } else { value as f32 });
    }
    if values.len() < count {
        return Err(FORMAT.broken(format!("it ends after {} of {count} heights", values.len())));
    }
    let north_first = values.chunks(size.x as usize).rev().flatten().copied().collect();
    let raster = Raster::new(size.x, Samples::F32(north_first));
    Ok(SurferGrid::between("GSAG", raster, DVec2::new(x0, y0), DVec2::new(x1, y1)))
}

fn version_6(bytes: &[u8]) -> Result<SurferGrid, DemErrorKind> {
    const HEADER: usize = 56;
    let data = bytes.get(HEADER..).ok_or_else(|| FORMAT.broken("it ends inside its header"))?;
    let fields = ByteFields::little_endian(bytes);
    let count = |at: usize| u64::try_from(fields.i16(at).unwrap_or(0)).unwrap_or(0);
    let double = |at: usize| fields.f64(at).unwrap_or(f64::NAN);
    let layout = SampleLayout::dense((count(4), count(6)), SampleType::F32, ByteOrder::Little, 0).south_up();
    let raster = layout.read(FORMAT.name, data, NoData::From(BLANK))?;
    let (min, max) = (DVec2::new(double(8), double(24)), DVec2::new(double(16), double(32)));
    Ok(SurferGrid::between("GSBG", raster, min, max))
}

fn version_7(bytes: &[u8]) -> Result<SurferGrid, DemErrorKind> {
    let cut = || FORMAT.broken("it ends before its heights");
    let fields = ByteFields::little_endian(bytes);
    let (mut at, mut grid_at) = (0usize, None);
    loop {
        let name: [u8; 4] = bytes_at(bytes, at).ok_or_else(cut)?;
        let length = fields.u32(at + 4).ok_or_else(cut)? as usize;
        let content = at + 8;
        match (&name, grid_at) {
            (b"GRID", _) => grid_at = Some(content),
            (b"DATA", Some(grid_at)) => {
                let end = content.saturating_add(length).min(bytes.len());
                return grid_7(fields, grid_at, &bytes[content..end]);
            }
            _ => {}
        }
        at = content.checked_add(length).ok_or_else(cut)?;
    }
}

/// The grid whose `GRID` section has its content at `at`.
fn grid_7(fields: ByteFields, at: usize, data: &[u8]) -> Result<SurferGrid, DemErrorKind> {
    let cut = || FORMAT.broken("it ends inside its GRID section");
    let count = |offset: usize| {
        fields.i32(at + offset).ok_or_else(cut).map(|count| u64::try_from(count).unwrap_or(0))
    };
    let double = |index: usize| fields.f64(at + 8 + 8 * index).ok_or_else(cut);
    let (rotation, blank) = (double(6)?, double(7)?);
    if rotation != 0.0 {
        let what = format!("a rotation of {rotation} degrees");
        return Err(FORMAT.unsupported(what, "save the grid without rotation"));
    }
    let size = (count(4)?, count(0)?);
    let layout = SampleLayout::dense(size, SampleType::F64, ByteOrder::Little, 0).south_up();
    let raster = layout.read(FORMAT.name, data, NoData::From(blank))?;
    Ok(SurferGrid {
        raster: Raster { driver: "GS7BG", nodata: Some(blank), ..raster },
        first: DVec2::new(double(0)?, double(1)?),
        cell: DVec2::new(double(2)?, double(3)?),
    })
}

#[cfg(test)]
mod tests {
    use crate::hints::DemHints;
    use crate::read::read;

    fn binary_6(heights: &[f32]) -> Vec<u8> {
        let mut bytes = b"DSBB\x02\0\x03\0".to_vec();
        for bound in [100.0f64, 110.0, 200.0, 220.0, 1.0, 6.0] {
            bytes.extend(bound.to_le_bytes());
        }
        bytes.extend(heights.iter().flat_map(|height| height.to_le_bytes()));
        bytes
    }

    fn binary_7(heights: &[f64]) -> Vec<u8> {
        let mut bytes = b"DSRB\x04\0\0\0\x01\0\0\0GRID\x48\0\0\0\x03\0\0\0\x02\0\0\0".to_vec();
        for value in [100.0f64, 200.0, 10.0, 10.0, 1.0, 6.0, 0.0, 1e38] {
            bytes.extend(value.to_le_bytes());
        }
        bytes.extend(b"DATA\x30\0\0\0");
        bytes.extend(heights.iter().flat_map(|height| height.to_le_bytes()));
        bytes
    }

    #[test]
    fn the_three_kinds_hold_the_same_grid() {
        let text = b"DSAA\n2 3\n100 110\n200 220\n1 6\n1 2\n3 1.70141e+038\n5 6\n".to_vec();
        let grids = [
            text,
            binary_6(&[1.0, 2.0, 3.0, 1.70141e38, 5.0, 6.0]),
            binary_7(&[1.0, 2.0, 3.0, 1.70141e38, 5.0, 6.0]),
        ];
        for bytes in grids {
            let raster = read("a.grd", &bytes, &DemHints::default()).expect("a grid");
            assert_eq!([raster.at(0, 0), raster.at(1, 0), raster.at(0, 2)], [5.0, 6.0, 1.0]);
            assert!(raster.at(1, 1).is_nan());
            assert_eq!(raster.geotransform(), [95.0, 10.0, 0.0, 225.0, 0.0, -10.0], "{}", raster.driver);
        }
    }

    #[test]
    fn grids_cut_or_changed_anywhere_are_errors_or_rasters() {
        let numbers = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0];
        for whole in [binary_6(&numbers.map(|value| value as f32)), binary_7(&numbers)] {
            for end in 4..whole.len() {
                assert!(read("a.grd", &whole[..end], &DemHints::default()).is_err(), "{end}");
            }
            for at in 0..whole.len() {
                for value in [0, 0x7f, 0x80, 0xff] {
                    let mut broken = whole.clone();
                    broken[at] = value;
                    if let Ok(raster) = read("a.grd", &broken, &DemHints::default()) {
                        assert_eq!(raster.samples.len(), raster.width as usize * raster.height as usize);
                    }
                }
            }
        }
        for text in ["DSAA", "DSAA 9 9 0 1 0 1 0 1 5", "DSAA 1 1 0 x", "DSAA 2 2 0 1 0 1 0 1 1 2 3 x"] {
            assert!(read("a.grd", text.as_bytes(), &DemHints::default()).is_err(), "{text}");
        }
    }
}
