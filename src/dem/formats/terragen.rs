//! Terragen terrain (`.ter`): Planetside, *Terragen .TER file format*.
//!
//! ```text
//! "TERRAGENTERRAIN "
//! "SIZE" n − 1 of the shorter side i16, pad      "XPTS" columns i16, pad      "YPTS" rows i16, pad
//! "SCAL" meters per unit, x y z f32              "CRAD" f32, "CRVM" u32: the planet, not looked at
//! "ALTW" scale i16, base i16, heights i16…: meters = z meters · (base + height · scale / 65536)
//! ```
//!
//! All little-endian. The last row is the northern one and becomes the first. Nothing says where on earth a terrain
//! lies: as GDAL has it, the outer corner of that first row is at (0, 0), and **y counts from there on, southward**.

use glam::{DAffine2, DMat2, DVec2};

use crate::dem::error::{DemErrorKind, bytes_at};
use crate::dem::formats::plain::{ByteOrder, Number, SampleLayout};
use crate::dem::raster::{Raster, Samples};
use crate::dem::read::DemFile;

const FORMAT: &str = "Terragen terrain";

const START: &[u8] = b"TERRAGENTERRAIN ";

/// Meters between heights where the file does not say.
const DEFAULT_SCALE: f64 = 30.0;

/// Whether the content starts as a terrain does.
pub(crate) fn recognizes(bytes: &[u8]) -> bool {
    bytes.starts_with(START)
}

/// Reads a terrain.
pub(crate) fn read(source: &DemFile) -> Result<Raster, DemErrorKind> {
    let bytes = source.bytes;
    let Chunks { columns, rows, scale, heights_at } = Chunks::read(bytes)?;
    let short = |at: usize| bytes_at(bytes, at).map(i16::from_le_bytes).unwrap_or_default();
    let (height_scale, base) = (f64::from(short(heights_at)), f64::from(short(heights_at + 2)));
    let layout = SampleLayout::dense((columns, rows), Number::I16, ByteOrder::Little, heights_at as u64 + 4);
    let (width, height, samples) = layout.read(FORMAT, bytes, None)?;
    Ok(Raster {
        driver: "Terragen",
        data_type: "Int16",
        width,
        height,
        samples: last_row_first(&samples, width as usize)
            .scaled(scale.z * height_scale / 65_536.0, scale.z * base),
        meters_per_z: 1.0,
        map_from_grid: DAffine2::from_mat2(DMat2::from_diagonal(DVec2::new(scale.x, scale.y))),
        georeferenced: true,
        crs: source.crs_beside()?,
        nodata: None,
        vertical_datum: None,
    })
}

fn last_row_first(samples: &Samples, width: usize) -> Samples {
    let last = samples.len() / width - 1;
    let turned = |index: usize| samples.get((last - index / width) * width + index % width) as f32;
    Samples::F32((0..samples.len()).map(turned).collect())
}

struct Chunks {
    columns: u64,
    rows: u64,
    scale: glam::DVec3,
    /// Where the content of `ALTW` starts.
    heights_at: usize,
}

impl Chunks {
    /// Walks the chunks up to the heights, which come last.
    fn read(bytes: &[u8]) -> Result<Self, DemErrorKind> {
        let cut = || DemErrorKind::broken(FORMAT, "it ends before its heights");
        let (mut side, mut columns, mut rows) = (None, None, None);
        let mut scale = glam::DVec3::splat(DEFAULT_SCALE);
        let mut at = START.len();
        loop {
            let name: [u8; 4] = bytes_at(bytes, at).ok_or_else(cut)?;
            let inside = at + 4;
            let count =
                || bytes_at(bytes, inside).map(|pair| u64::from(u16::from_le_bytes(pair))).ok_or_else(cut);
            at = inside + 4;
            match &name {
                b"SIZE" => side = Some(count()? + 1),
                b"XPTS" => columns = Some(count()?),
                b"YPTS" => rows = Some(count()?),
                b"CRAD" | b"CRVM" => {}
                b"SCAL" => {
                    scale = scale_at(bytes, inside)?;
                    at = inside + 12;
                }
                b"ALTW" => {
                    let missing = || DemErrorKind::broken(FORMAT, "it does not say how many heights it has");
                    let (columns, rows) = (columns.or(side), rows.or(side));
                    let (columns, rows) = columns.zip(rows).ok_or_else(missing)?;
                    return Ok(Self { columns, rows, scale, heights_at: inside });
                }
                b"EOF " => return Err(DemErrorKind::broken(FORMAT, "it has no heights")),
                other => {
                    let name = String::from_utf8_lossy(other).into_owned();
                    let reason = format!("the chunk '{name}' at byte {} is not known", inside - 4);
                    return Err(DemErrorKind::broken(FORMAT, reason));
                }
            }
        }
    }
}

fn scale_at(bytes: &[u8], at: usize) -> Result<glam::DVec3, DemErrorKind> {
    let part = |index: usize| {
        bytes_at(bytes, at + 4 * index).map_or(f64::NAN, |raw| f64::from(f32::from_le_bytes(raw)))
    };
    let scale = glam::DVec3::new(part(0), part(1), part(2));
    if scale.is_finite() && scale.min_element() > 0.0 {
        return Ok(scale);
    }
    Err(DemErrorKind::broken(FORMAT, format!("its scale is {scale}, not of positive meters")))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dem::read::{DemHints, read};

    fn terrain(heights: &[i16]) -> Vec<u8> {
        let mut bytes = START.to_vec();
        for (name, count) in [(b"SIZE", 1u16), (b"XPTS", 2), (b"YPTS", 3)] {
            bytes.extend(name);
            bytes.extend(count.to_le_bytes());
            bytes.extend([0, 0]);
        }
        bytes.extend(b"SCAL");
        for meters in [20.0f32, 30.0, 2.0] {
            bytes.extend(meters.to_le_bytes());
        }
        bytes.extend(b"ALTW");
        bytes.extend(16384i16.to_le_bytes());
        bytes.extend(5i16.to_le_bytes());
        bytes.extend(heights.iter().flat_map(|height| height.to_le_bytes()));
        bytes.extend(b"EOF ");
        bytes
    }

    #[test]
    fn heights_are_scaled_and_the_last_row_comes_first() {
        let raster = read("a.ter", &terrain(&[8, -8, 3, 4, 5, 6]), &DemHints::default()).expect("a terrain");
        assert_eq!((raster.width, raster.height), (2, 3));
        assert_eq!([raster.at(0, 2), raster.at(1, 2), raster.at(0, 0)], [14.0, 6.0, 12.5]);
        assert_eq!(raster.geotransform(), [0.0, 20.0, 0.0, 0.0, 0.0, 30.0]);
    }

    #[test]
    fn a_terrain_cut_or_changed_anywhere_is_an_error_or_a_raster() {
        let whole = terrain(&[1, 2, 3, 4, 5, 6]);
        for end in 0..whole.len() - 4 {
            assert!(read("a.ter", &whole[..end], &DemHints::default()).is_err(), "{end}");
        }
        for at in 0..whole.len() {
            for value in [0, 0x7f, 0x80, 0xff] {
                let mut broken = whole.clone();
                broken[at] = value;
                if let Ok(raster) = read("a.ter", &broken, &DemHints::default()) {
                    assert_eq!(raster.samples.len(), raster.width as usize * raster.height as usize);
                }
            }
        }
    }
}
