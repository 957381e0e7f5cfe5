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
//! Little-endian. Heights stand on nodes, rows run north; what is as large as the blank value (1.70141e38) is no
//! data.

use glam::DVec2;

use crate::dem::error::{DemErrorKind, bytes_at, check_size};
use crate::dem::formats::ascii::{TextWords, number};
use crate::dem::raster::{Raster, Samples, north_up};
use crate::dem::read::DemFile;

const FORMAT: &str = "Surfer grid";

/// What is as large as this is blank, in the versions whose files do not say.
const BLANK: f64 = 1.70141e38;

/// The same as version 6 writes it: the nearest of 32 bits, what GDAL states as the no-data value.
const BLANK_STATED: f64 = 1.701_410_009_187_828e38;

/// Whether the content starts as one of the three does.
pub(crate) fn recognizes(bytes: &[u8]) -> bool {
    [b"DSAA", b"DSBB", b"DSRB"].iter().any(|start| bytes.starts_with(*start))
}

/// Reads a grid.
pub(crate) fn read(source: &DemFile) -> Result<Raster, DemErrorKind> {
    let grid = match &source.bytes[..4] {
        b"DSAA" => text(source.bytes)?,
        b"DSBB" => version_6(source.bytes)?,
        _ => version_7(source.bytes)?,
    };
    let Grid { driver, data_type, columns, rows, first, cell, samples, blank } = grid;
    if !(first.is_finite() && cell.is_finite() && cell.min_element() > 0.0) {
        return Err(DemErrorKind::Georeference {
            reason: format!("its nodes start at {first} and are {} by {} apart", cell.x, cell.y),
            remedy: "save the grid again",
        });
    }
    let north_west = DVec2::new(first.x, first.y + cell.y * f64::from(rows - 1));
    Ok(Raster {
        driver,
        data_type,
        width: columns,
        height: rows,
        samples,
        meters_per_z: 1.0,
        map_from_grid: north_up(north_west + DVec2::new(-0.5, 0.5) * cell, cell),
        georeferenced: true,
        crs: source.crs_beside()?,
        nodata: Some(blank),
        vertical_datum: None,
    })
}

struct Grid {
    driver: &'static str,
    data_type: &'static str,
    columns: u32,
    rows: u32,
    /// The south-west node.
    first: DVec2,
    cell: DVec2,
    samples: Samples,
    blank: f64,
}

/// Heights from the south, turned into rows from the north, blank ones as NaN.
fn turned<T: Copy>(columns: usize, rows: usize, value: impl Fn(usize) -> T) -> Vec<T> {
    (0..rows)
        .rev()
        .flat_map(|row| (0..columns).map(move |column| row * columns + column))
        .map(value)
        .collect()
}

fn narrow(value: f32) -> f32 {
    if f64::from(value) >= BLANK || !value.is_finite() { f32::NAN } else { value }
}

/// The distance between nodes, given the first and the last of a side.
fn between(low: f64, high: f64, nodes: u64) -> f64 {
    (high - low) / (nodes.saturating_sub(1)) as f64
}

fn text(bytes: &[u8]) -> Result<Grid, DemErrorKind> {
    let mut words = TextWords::new(&bytes[4..]);
    let mut head = |what: &str| {
        let word = words.next().and_then(number);
        word.ok_or_else(|| DemErrorKind::broken(FORMAT, format!("{what} is missing or no number")))
    };
    let (columns, rows) = (head("the number of columns")?, head("the number of rows")?);
    let [x0, x1, y0, y1] = [head("x from")?, head("x to")?, head("y from")?, head("y to")?];
    for unused in ["z from", "z to"] {
        head(unused)?;
    }
    let whole = |value: f64| if value.fract() == 0.0 && value >= 0.0 { value as u64 } else { 0 };
    let size = (whole(columns), whole(rows));
    let count = check_size(size, 2, (words.rest().len() + 1, 1))?;
    let mut values = Vec::with_capacity(count);
    for word in words.by_ref().take(count) {
        let value = number(word).ok_or_else(|| {
            DemErrorKind::broken(FORMAT, format!("height {} of {count} is not a number", values.len() + 1))
        })?;
        values.push(if value >= BLANK || !value.is_finite() { f32::NAN } else { value as f32 });
    }
    if values.len() < count {
        return Err(DemErrorKind::broken(
            FORMAT,
            format!("it ends after {} of {count} heights", values.len()),
        ));
    }
    let (columns, rows) = (size.0 as usize, size.1 as usize);
    Ok(Grid {
        driver: "GSAG",
        data_type: "Float32",
        columns: columns as u32,
        rows: rows as u32,
        first: DVec2::new(x0, y0),
        cell: DVec2::new(between(x0, x1, size.0), between(y0, y1, size.1)),
        samples: Samples::F32(turned(columns, rows, |index| values[index])),
        blank: BLANK_STATED,
    })
}

fn version_6(bytes: &[u8]) -> Result<Grid, DemErrorKind> {
    const HEADER: usize = 56;
    let cut = || DemErrorKind::broken(FORMAT, "it ends inside its header");
    let data = bytes.get(HEADER..).ok_or_else(cut)?;
    let count =
        |at: usize| bytes_at(bytes, at).map_or(0, |raw| u64::try_from(i16::from_le_bytes(raw)).unwrap_or(0));
    let double = |at: usize| bytes_at(bytes, at).map_or(f64::NAN, f64::from_le_bytes);
    let size = (count(4), count(6));
    check_size(size, 4, (data.len(), 1))?;
    let (columns, rows) = (size.0 as usize, size.1 as usize);
    let height = |index: usize| narrow(bytes_at(data, 4 * index).map_or(f32::NAN, f32::from_le_bytes));
    Ok(Grid {
        driver: "GSBG",
        data_type: "Float32",
        columns: columns as u32,
        rows: rows as u32,
        first: DVec2::new(double(8), double(24)),
        cell: DVec2::new(between(double(8), double(16), size.0), between(double(24), double(32), size.1)),
        samples: Samples::F32(turned(columns, rows, height)),
        blank: BLANK_STATED,
    })
}

/// What the `GRID` section states.
struct Section7 {
    size: (u64, u64),
    first: DVec2,
    cell: DVec2,
    blank: f64,
}

fn version_7(bytes: &[u8]) -> Result<Grid, DemErrorKind> {
    let cut = || DemErrorKind::broken(FORMAT, "it ends before its heights");
    let mut at = 0usize;
    let mut grid = None;
    loop {
        let name: [u8; 4] = bytes_at(bytes, at).ok_or_else(cut)?;
        let length = u32::from_le_bytes(bytes_at(bytes, at + 4).ok_or_else(cut)?) as usize;
        let inside = at + 8;
        match (&name, &grid) {
            (b"GRID", _) => grid = Some(section_7(bytes, inside)?),
            (b"DATA", Some(grid)) => {
                let end = inside.saturating_add(length).min(bytes.len());
                return heights_7(grid, &bytes[inside..end]);
            }
            _ => {}
        }
        at = inside.checked_add(length).ok_or_else(cut)?;
    }
}

fn section_7(bytes: &[u8], at: usize) -> Result<Section7, DemErrorKind> {
    let cut = || DemErrorKind::broken(FORMAT, "it ends inside its GRID section");
    let count = |offset: usize| bytes_at(bytes, at + offset).map(i32::from_le_bytes).ok_or_else(cut);
    let double = |index: usize| bytes_at(bytes, at + 8 + 8 * index).map(f64::from_le_bytes).ok_or_else(cut);
    let whole = |value: i32| u64::try_from(value).unwrap_or(0);
    if double(6)? != 0.0 {
        return Err(DemErrorKind::Unsupported {
            format: FORMAT,
            what: format!("a rotation of {} degrees", double(6)?),
            remedy: "save the grid without rotation",
        });
    }
    Ok(Section7 {
        size: (whole(count(4)?), whole(count(0)?)),
        first: DVec2::new(double(0)?, double(1)?),
        cell: DVec2::new(double(2)?, double(3)?),
        blank: double(7)?,
    })
}

fn heights_7(grid: &Section7, data: &[u8]) -> Result<Grid, DemErrorKind> {
    check_size(grid.size, 8, (data.len(), 1))?;
    let (columns, rows) = (grid.size.0 as usize, grid.size.1 as usize);
    let height = |index: usize| {
        let value = bytes_at(data, 8 * index).map_or(f64::NAN, f64::from_le_bytes);
        if value >= grid.blank || !value.is_finite() { f64::NAN } else { value }
    };
    Ok(Grid {
        driver: "GS7BG",
        data_type: "Float64",
        columns: columns as u32,
        rows: rows as u32,
        first: grid.first,
        cell: grid.cell,
        samples: Samples::F64(turned(columns, rows, height)),
        blank: grid.blank,
    })
}

#[cfg(test)]
mod tests {
    use crate::dem::read::{DemHints, read};

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
