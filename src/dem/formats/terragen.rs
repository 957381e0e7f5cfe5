//! Terragen terrain (`.ter`): Planetside, *Terragen .TER file format*.
//!
//! ```text
//! "TERRAGENTERRAIN "
//! "SIZE" n − 1 of the shorter side i16, pad      "XPTS" columns i16, pad      "YPTS" rows i16, pad
//! "SCAL" meters per unit, x y z f32              "CRAD" f32, "CRVM" u32: the planet, ignored
//! "ALTW" scale i16, base i16, heights i16…: meters = z meters · (base + height · scale / 65536)
//! ```
//!
//! All little-endian. The last row is the northern one and becomes the first. The format states no place on Earth: as
//! in GDAL, the outer corner of that first row is at (0, 0), and **y counts from there on, southward**.

use glam::{DAffine2, DMat2, DVec2, DVec3};

use crate::dem_file::DemFile;
use crate::dem_format::{DemFormat, Recognition, any_size};
use crate::formats::sample_layout::{NoData, SampleLayout};
use sandtable_base::bytes::{ByteFields, ByteOrder, bytes_at};
use sandtable_raster::error::DemErrorKind;
use sandtable_raster::raster::Raster;
use sandtable_raster::sample_type::SampleType;

pub(super) static FORMAT: DemFormat = DemFormat {
    name: "Terragen terrain",
    extensions: &["ter"],
    shared_extensions: &[],
    recognition: Recognition::Content { matches: |bytes| bytes.starts_with(START), start: "TERRAGENTERRAIN" },
    reader: read,
    windows: None,
    most_bytes: any_size,
    writer: None,
    windows_writer: None,
};

const START: &[u8] = b"TERRAGENTERRAIN ";

/// Meters between heights where the file does not state them.
const DEFAULT_SCALE: f64 = 30.0;

fn read(file: &DemFile) -> Result<Raster, DemErrorKind> {
    let Chunks { columns, rows, scale, heights_at } = Chunks::read(file.bytes)?;
    let short = |at: usize| f64::from(ByteFields::little_endian(file.bytes).i16(at).unwrap_or_default());
    let (height_scale, base) = (short(heights_at), short(heights_at + 2));
    let start = heights_at as u64 + 4;
    let layout = SampleLayout::dense((columns, rows), SampleType::I16, ByteOrder::Little, start).south_up();
    let raster = layout.read(FORMAT.name, file.bytes, NoData::Value(None))?;
    let axes = DMat2::from_diagonal(DVec2::new(scale.x, scale.y));
    Ok(Raster {
        driver: "Terragen",
        states_z_unit: true,
        samples: raster.samples.scaled(scale.z * height_scale / 65_536.0, scale.z * base),
        map_from_grid: DAffine2::from_mat2(axes),
        georeferenced: true,
        crs: file.crs()?,
        ..raster
    })
}

struct Chunks {
    columns: u64,
    rows: u64,
    scale: DVec3,
    /// Where the content of `ALTW` starts.
    heights_at: usize,
}

impl Chunks {
    /// Reads the chunks up to the heights, which come last.
    fn read(bytes: &[u8]) -> Result<Self, DemErrorKind> {
        let cut = || FORMAT.broken("it ends before its heights");
        let fields = ByteFields::little_endian(bytes);
        let (mut side, mut columns, mut rows) = (None, None, None);
        let mut scale = DVec3::splat(DEFAULT_SCALE);
        let mut at = START.len();
        loop {
            let name: [u8; 4] = bytes_at(bytes, at).ok_or_else(cut)?;
            let content = at + 4;
            let count = || fields.u16(content).map(u64::from).ok_or_else(cut);
            at = content + 4;
            match &name {
                b"SIZE" => side = Some(count()? + 1),
                b"XPTS" => columns = Some(count()?),
                b"YPTS" => rows = Some(count()?),
                b"CRAD" | b"CRVM" => {}
                b"SCAL" => {
                    scale = scale_at(fields, content)?;
                    at = content + 12;
                }
                b"ALTW" => {
                    let size = columns.or(side).zip(rows.or(side));
                    let missing = || FORMAT.broken("it does not state how many heights it has");
                    let (columns, rows) = size.ok_or_else(missing)?;
                    return Ok(Self { columns, rows, scale, heights_at: content });
                }
                b"EOF " => return Err(FORMAT.broken("it has no heights")),
                other => {
                    let (name, at) = (String::from_utf8_lossy(other), content - 4);
                    return Err(FORMAT.broken(format!("the chunk '{name}' at byte {at} is not known")));
                }
            }
        }
    }
}

fn scale_at(fields: ByteFields, at: usize) -> Result<DVec3, DemErrorKind> {
    let scale = DVec3::from([0, 4, 8].map(|offset| fields.f32(at + offset).map_or(f64::NAN, f64::from)));
    if scale.is_finite() && scale.min_element() > 0.0 {
        return Ok(scale);
    }
    Err(FORMAT.broken(format!("its scale is {scale}, not of positive meters")))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hints::DemHints;
    use crate::read::read;

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
