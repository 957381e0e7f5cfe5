//! ESRI binary grids: `.bil`, `.bip`, `.bsq` and `.flt` with an `.hdr` of `KEY value` lines beside them, GTOPO30
//! tiles (`.dem`) among them.
//!
//! Specification: Esri, *Extendable Image Formats* ("BIL, BIP, and BSQ raster files", ArcGIS Desktop help), and
//! *Float to Raster* for `.flt`. Where it leaves a default to the machine, GDAL's is taken: most significant byte
//! first; 16 bits are signed where the no-data value is negative.

use glam::{DAffine2, DVec2};

use crate::dem_file::DemFile;
use crate::dem_format::{DemFormat, FormatWriter, Recognition, any_size};
use crate::formats::ehdr_write::write;
use crate::formats::header::{HeaderFields, StatedNoData};
use crate::formats::plain_raster::{self, PlainRaster};
use crate::formats::sample_layout::{FileSize, NoData, SampleLayout};
use sandtable_base::bytes::ByteOrder;
use sandtable_raster::error::DemErrorKind;
use sandtable_raster::file_bands::FileBands;
use sandtable_raster::raster::{Raster, north_up, north_up_nodes};
use sandtable_raster::sample_type::{NumberKind, SampleType};

pub(super) static FORMAT: DemFormat = DemFormat {
    name: "ESRI binary grid",
    extensions: &["bil", "flt"],
    shared_extensions: &["bip", "bsq"],
    recognition: Recognition::HeaderFile { matches: is_header },
    reader: |file| plain_raster::read(file, plain),
    windows: Some(|file, content, _| plain_raster::windows(file, content, plain)),
    most_bytes: any_size,
    writer: Some(FormatWriter { extensions: &["flt", "bil"], write }),
    windows_writer: None,
};

/// The most lines of a header that are read; headers are a few hundred bytes.
const MOST_LINES: usize = 1000;

fn is_header(header: &[u8]) -> bool {
    let header = HeaderFields::from_lines(FORMAT.name, header, MOST_LINES);
    header.get("nrows").is_some() && header.get("ncols").is_some()
}

/// The first band.
fn plain(file: &DemFile, size: FileSize) -> Result<PlainRaster, DemErrorKind> {
    let header = file.header().ok_or(DemErrorKind::NoHeader(FORMAT.name))?;
    let header = HeaderFields::from_lines(FORMAT.name, &header, MOST_LINES);
    let StatedNoData { value: nodata, note } = header.nodata(&["nodata", "nodata_value"]);
    let sample = sample_type(&header, nodata, &file.extension())?;
    let layout = layout(&header, sample)?;
    let raster = layout.header(FORMAT.name, size)?;
    let place = place(&header, raster.height)?;
    let raster = file.placed(raster, place, &["blw", "bpw", "bqw", "flw", "wld"])?;
    let bands = FileBands { count: header.whole("nbands")?.unwrap_or(1), mask: None };
    let mut raster = Raster { driver: "EHdr", crs: file.crs()?, nodata, ..raster }.with_bands(bands);
    raster.notes.extend(note);
    Ok(PlainRaster::new(raster, layout, NoData::Value(nodata)))
}

fn sample_type(
    header: &HeaderFields,
    nodata: Option<f64>,
    extension: &str,
) -> Result<SampleType, DemErrorKind> {
    let is_flt = extension == "flt";
    let bits = header.whole("nbits")?.unwrap_or(if is_flt { 32 } else { 8 });
    let stated = header.get("pixeltype").unwrap_or_default().to_ascii_uppercase();
    let kind = match stated.chars().next() {
        Some('S') => Some(NumberKind::Signed),
        Some('U') => Some(NumberKind::Unsigned),
        Some('F') => Some(NumberKind::Float),
        Some(_) => None,
        None if is_flt => Some(NumberKind::Float),
        None if bits == 16 && nodata.is_some_and(|value| value < 0.0) => Some(NumberKind::Signed),
        None => Some(NumberKind::Unsigned),
    };
    kind.and_then(|kind| SampleType::new(kind, bits)).ok_or_else(|| {
        let what =
            format!("{bits}-bit samples of type {}", if stated.is_empty() { "UNSIGNEDINT" } else { &stated });
        FORMAT.unsupported(what, "convert it, for example with: gdal_translate FILE out.tif")
    })
}

fn layout(header: &HeaderFields, sample: SampleType) -> Result<SampleLayout, DemErrorKind> {
    let size = (header.required("ncols")?, header.required("nrows")?);
    let bands = header.whole("nbands")?.unwrap_or(1);
    let order = match header.get("byteorder").and_then(|order| order.chars().next()) {
        Some('I' | 'i' | 'L' | 'l') => ByteOrder::Little,
        _ => ByteOrder::Big,
    };
    let start = header.whole("skipbytes")?.unwrap_or(0);
    let dense = SampleLayout::dense(size, sample, order, start);
    let total = header.whole("totalrowbytes")?;
    let interleaved = match header.get("layout").unwrap_or("BIL").to_ascii_uppercase().as_str() {
        "BIL" => {
            let row_step = header.whole("bandrowbytes")?.unwrap_or(dense.row_step).saturating_mul(bands);
            SampleLayout { row_step, ..dense }
        }
        "BIP" => dense.by_pixel(bands),
        "BSQ" => dense,
        other => {
            return Err(header.broken(format!("LAYOUT in its header is '{other}'; BIL, BIP and BSQ exist")));
        }
    };
    Ok(SampleLayout { row_step: total.unwrap_or(interleaved.row_step), ..interleaved })
}

/// The place by the center of the first sample, or by the south-west corner or sample; `None` where neither is stated.
fn place(header: &HeaderFields, height: u32) -> Result<Option<DAffine2>, DemErrorKind> {
    let x = header.first_number(["xdim", "cellsize"])?.unwrap_or(1.0);
    let cell = DVec2::new(x, header.first_number(["ydim", "cellsize"])?.unwrap_or(1.0));
    if cell.min_element() <= 0.0 {
        return Err(DemErrorKind::Georeference {
            reason: format!("its cells are {} by {}", cell.x, cell.y),
            remedy: "correct XDIM and YDIM, or cellsize, in its .hdr",
        });
    }
    if let Some(first) = header.number("ulxmap")?.zip(header.number("ulymap")?) {
        return Ok(Some(north_up_nodes(DVec2::from(first), cell)));
    }
    let reach = DVec2::new(0.0, f64::from(height) * cell.y);
    Ok(header.south_west(cell)?.map(|corner| north_up(corner + reach, cell)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hints::DemHints;
    use crate::read::read;

    fn grid(name: &str, header: &str, bytes: &[u8]) -> Result<Raster, String> {
        let header = header.to_owned();
        let beside = move |name: &str| name.ends_with(".hdr").then(|| header.clone().into_bytes());
        let hints = DemHints { companions: &beside, ..DemHints::default() };
        read(name, bytes, &hints).map_err(|error| error.to_string())
    }

    #[test]
    fn a_gtopo30_tile_is_signed_and_most_significant_byte_first() {
        let header = "NROWS 1\nNCOLS 2\nNBITS 16\nNODATA -9999\nULXMAP 10\nULYMAP 50\nXDIM 2\nYDIM 2\n";
        let raster = grid("W020N90.DEM", header, &[0, 1, 0xd8, 0xf1]).expect("a tile");
        assert!(raster.at(0, 0) == 1.0 && raster.at(1, 0).is_nan());
        assert_eq!((raster.driver, raster.data_type), ("EHdr", "Int16"));
        assert_eq!(raster.geotransform(), [9.0, 2.0, 0.0, 51.0, 0.0, -2.0]);
    }

    #[test]
    fn a_float_grid_needs_no_bits_and_stands_on_its_corner() {
        let header = "ncols 1\nnrows 2\nxllcorner 10\nyllcorner 20\ncellsize 5\nbyteorder LSBFIRST\n";
        let bytes: Vec<u8> = [1.5f32, -2.0].iter().flat_map(|value| value.to_le_bytes()).collect();
        let raster = grid("a.flt", header, &bytes).expect("a grid");
        assert_eq!([raster.at(0, 0), raster.at(0, 1)], [1.5, -2.0]);
        assert_eq!(raster.geotransform(), [10.0, 5.0, 0.0, 30.0, 0.0, -5.0]);
    }

    #[test]
    fn the_first_of_several_bands_is_read_in_every_layout() {
        // Two bands of two rows of two: 1 2 3 4 and 5 6 7 8.
        for (layout, bytes) in [
            ("BIL", [1, 2, 5, 6, 3, 4, 7, 8]),
            ("BIP", [1, 5, 2, 6, 3, 7, 4, 8]),
            ("BSQ", [1, 2, 3, 4, 5, 6, 7, 8]),
        ] {
            let header = format!("NROWS 2\nNCOLS 2\nNBANDS 2\nNBITS 8\nLAYOUT {layout}\n");
            let raster = grid("a.bil", &header, &bytes).expect("a grid");
            assert_eq!(raster.samples.iter().collect::<Vec<_>>(), [1.0, 2.0, 3.0, 4.0], "{layout}");
            assert!(!raster.georeferenced);
        }
    }

    #[test]
    fn what_cannot_be_is_refused_with_the_key() {
        let refused = |header: &str| grid("a.bil", header, &[0; 8]).expect_err("refused");
        assert!(refused("NROWS x\nNCOLS 2\n").contains("nrows in its header is 'x'"));
        assert!(refused("NROWS 2\nNCOLS 2\nNBITS 4\n").contains("4-bit"));
        assert!(refused("NROWS 2\nNCOLS 2\nLAYOUT BOB\n").contains("'BOB'"));
        assert!(refused("NROWS 200\nNCOLS 2\n").contains("cannot be held"));
        assert!(refused("NROWS 2\nNCOLS 2\nSKIPBYTES 5\n").contains("beyond"));
        assert!(refused("NROWS 2\nNCOLS 2\nULXMAP 1\nULYMAP 1\nXDIM 0\n").contains("XDIM"));
        assert!(
            read("a.bil", &[0; 8], &DemHints::default()).expect_err("no header").to_string().contains(".hdr")
        );
    }
}
