//! RAW: samples without a header, whose size and type the caller states.

use crate::dem_file::DemFile;
use crate::dem_format::{DemFormat, Recognition, any_size};
use crate::formats::plain_raster::{self, PlainRaster};
use crate::formats::sample_layout::{FileSize, NoData, SampleLayout};
use sandtable_raster::error::DemErrorKind;
use sandtable_raster::raster::Raster;

pub(crate) static FORMAT: DemFormat = DemFormat {
    name: "RAW with a stated size",
    extensions: &[],
    shared_extensions: &["raw", "r16"],
    recognition: Recognition::Statement,
    reader: |file| plain_raster::read(file, plain),
    windows: Some(|file, content, _| plain_raster::windows(file, content, plain)),
    most_bytes: any_size,
    writer: None,
    windows_writer: None,
};

/// Heights are the samples, times the stated scale plus the stated offset.
fn plain(file: &DemFile, size: FileSize) -> Result<PlainRaster, DemErrorKind> {
    let raw = file.hints.options.raw.ok_or(DemErrorKind::NoRawLayout)?;
    let (scale, offset) = (file.height_scale()?.unwrap_or(1.0), file.height_offset()?);
    let layout = SampleLayout::dense((raw.width.into(), raw.height.into()), raw.sample, raw.order, raw.skip);
    let raster = layout.header("RAW file", size)?;
    let raster = file.placed(raster, None, &["rww", "wld"])?;
    let raster = Raster { driver: "RAW", crs: file.crs()?, nodata: raw.nodata, ..raster };
    Ok(PlainRaster::new(raster, layout, NoData::Value(raw.nodata)).scaled(scale, offset))
}

#[cfg(test)]
mod tests {
    use crate::hints::{DemHints, DemOptions};
    use crate::read::read;

    #[test]
    fn samples_become_meters_by_a_stated_scale() {
        let hints = DemHints::from(DemOptions {
            raw: "2x1:u16le:skip=1".parse().ok(),
            height_scale: Some(0.5),
            height_offset: Some(-10.0),
            cell: Some(30.0),
            ..DemOptions::default()
        });
        let raster = read("a.r16", &[9, 2, 0, 0, 1], &hints).expect("as stated");
        assert_eq!([raster.at(0, 0), raster.at(1, 0)], [-9.0, 118.0]);
        assert_eq!(raster.spacing().x, 30.0);
        let short = read("a.r16", &[9, 2, 0, 0], &hints).expect_err("too short").to_string();
        assert!(short.contains("2 x 1"), "{short}");
    }
}
