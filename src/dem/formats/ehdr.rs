//! ESRI's plain grids: `.bil`, `.bip`, `.bsq` and `.flt` with an `.hdr` of `KEY value` lines beside them, GTOPO30
//! tiles (`.dem`) among them.
//!
//! Specification: Esri, *Extendable Image Formats* ("BIL, BIP, and BSQ raster files", ArcGIS Desktop help), and
//! *Float to Raster* for `.flt`. Where it leaves a default to the machine, GDAL's is taken: most significant byte
//! first; 16 bits are signed where the no-data value is negative.

use glam::DVec2;

use crate::dem::error::DemErrorKind;
use crate::dem::formats::plain::{ByteOrder, Number, SampleLayout};
use crate::dem::georef::{self, RasterPlace};
use crate::dem::raster::{Raster, north_up};
use crate::dem::read::DemFile;

const FORMAT: &str = "ESRI binary grid";

/// The extensions that say so.
pub(crate) const EXTENSIONS: [&str; 4] = ["bil", "bip", "bsq", "flt"];

/// Headers are a few hundred bytes; more lines than this are not looked at.
const MOST_LINES: usize = 1000;

/// Whether `header` is the text of such a header: it states rows and columns.
pub(crate) fn is_header(header: &[u8]) -> bool {
    let header = EhdrHeader::new(header);
    header.get("nrows").is_some() && header.get("ncols").is_some()
}

/// Reads the first band as `header`, the file beside it, says.
pub(crate) fn read(source: &DemFile, header: &[u8]) -> Result<Raster, DemErrorKind> {
    let header = EhdrHeader::new(header);
    let number = header.number_kind(&source.extension())?;
    let nodata = header.nodata()?;
    let layout = header.layout(number)?;
    let (width, height, samples) = layout.read(FORMAT, source.bytes, nodata)?;
    let place = match header.place(height)? {
        Some(place) => place,
        None => georef::beside(source, height, &["blw", "bpw", "bqw", "flw", "wld"])?,
    };
    Ok(Raster {
        driver: "EHdr",
        data_type: number.gdal_name(),
        width,
        height,
        samples,
        meters_per_z: 1.0,
        map_from_grid: place.map_from_grid,
        georeferenced: place.stated,
        crs: source.crs_beside()?,
        nodata,
        vertical_datum: None,
    })
}

/// The pairs of the header, keys in lower case.
struct EhdrHeader(Vec<(String, String)>);

impl EhdrHeader {
    fn new(bytes: &[u8]) -> Self {
        let text = String::from_utf8_lossy(bytes);
        let pair = |line: &str| {
            let mut words = line.split_ascii_whitespace();
            Some((words.next()?.to_ascii_lowercase(), words.next()?.to_owned()))
        };
        Self(text.lines().take(MOST_LINES).filter_map(pair).collect())
    }

    fn get(&self, key: &str) -> Option<&str> {
        self.0.iter().find(|(known, _)| known == key).map(|(_, value)| value.as_str())
    }

    fn float(&self, key: &str) -> Result<Option<f64>, DemErrorKind> {
        let Some(text) = self.get(key) else { return Ok(None) };
        match text.parse::<f64>() {
            Ok(value) if value.is_finite() => Ok(Some(value)),
            _ => Err(DemErrorKind::broken(FORMAT, format!("{key} in its header is '{text}', not a number"))),
        }
    }

    fn whole(&self, key: &str) -> Result<Option<u64>, DemErrorKind> {
        let Some(text) = self.get(key) else { return Ok(None) };
        let wrong =
            || DemErrorKind::broken(FORMAT, format!("{key} in its header is '{text}', not a whole number"));
        text.parse().map(Some).map_err(|_| wrong())
    }

    fn nodata(&self) -> Result<Option<f64>, DemErrorKind> {
        Ok(self.float("nodata")?.or(self.float("nodata_value")?))
    }

    fn number_kind(&self, extension: &str) -> Result<Number, DemErrorKind> {
        let is_flt = extension == "flt";
        let bits = self.whole("nbits")?.unwrap_or(if is_flt { 32 } else { 8 });
        let kind = self.get("pixeltype").map(str::to_ascii_uppercase);
        let negative = self.nodata()?.is_some_and(|value| value < 0.0);
        let letter = match kind.as_deref().and_then(|kind| kind.chars().next()) {
            Some(letter) => letter,
            None if is_flt => 'F',
            None if bits == 16 && negative => 'S',
            None => 'U',
        };
        match (letter, bits) {
            ('S', 8) => Ok(Number::I8),
            ('U', 8) => Ok(Number::U8),
            ('S', 16) => Ok(Number::I16),
            ('U', 16) => Ok(Number::U16),
            ('S', 32) => Ok(Number::I32),
            ('U', 32) => Ok(Number::U32),
            ('F', 32) => Ok(Number::F32),
            ('F', 64) => Ok(Number::F64),
            (_, bits) => Err(DemErrorKind::Unsupported {
                format: FORMAT,
                what: format!("{bits}-bit samples of type {}", kind.as_deref().unwrap_or("UNSIGNEDINT")),
                remedy: "convert it, for example with: gdal_translate FILE out.tif",
            }),
        }
    }

    fn order(&self) -> ByteOrder {
        match self.get("byteorder").and_then(|order| order.chars().next()) {
            Some('I' | 'i' | 'L' | 'l') => ByteOrder::Little,
            _ => ByteOrder::Big,
        }
    }

    fn layout(&self, number: Number) -> Result<SampleLayout, DemErrorKind> {
        let size = |key: &'static str| {
            let missing = || DemErrorKind::broken(FORMAT, format!("its header does not state {key}"));
            self.whole(key)?.ok_or_else(missing)
        };
        let (width, height) = (size("ncols")?, size("nrows")?);
        let bands = self.whole("nbands")?.unwrap_or(1);
        let row = width.saturating_mul(number.bytes());
        let total = self.whole("totalrowbytes")?;
        let order = self.get("layout").unwrap_or("BIL").to_ascii_uppercase();
        let (sample_step, row_step) = match order.as_str() {
            "BIL" => {
                let band = self.whole("bandrowbytes")?.unwrap_or(row);
                (number.bytes(), total.unwrap_or(band.saturating_mul(bands)))
            }
            "BIP" => (number.bytes().saturating_mul(bands), total.unwrap_or(row.saturating_mul(bands))),
            "BSQ" => (number.bytes(), total.unwrap_or(row)),
            other => {
                let reason = format!("LAYOUT in its header is '{other}'; BIL, BIP and BSQ exist");
                return Err(DemErrorKind::broken(FORMAT, reason));
            }
        };
        let start = self.whole("skipbytes")?.unwrap_or(0);
        Ok(SampleLayout { width, height, number, order: self.order(), start, sample_step, row_step })
    }

    /// The place by the center of the first sample, or by the south-west corner or sample; `None` where neither
    /// is stated.
    fn place(&self, height: u32) -> Result<Option<RasterPlace>, DemErrorKind> {
        let square = self.float("cellsize")?;
        let cell = DVec2::new(
            self.float("xdim")?.or(square).unwrap_or(1.0),
            self.float("ydim")?.or(square).unwrap_or(1.0),
        );
        if cell.min_element() <= 0.0 {
            return Err(DemErrorKind::Georeference {
                reason: format!("its cells are {} by {}", cell.x, cell.y),
                remedy: "correct XDIM and YDIM, or cellsize, in its .hdr",
            });
        }
        let both = |x: &str, y: &str| -> Result<Option<DVec2>, DemErrorKind> {
            Ok(self.float(x)?.zip(self.float(y)?).map(DVec2::from))
        };
        let reach = DVec2::new(0.0, f64::from(height) * cell.y);
        let corner = if let Some(first) = both("ulxmap", "ulymap")? {
            first + DVec2::new(-0.5, 0.5) * cell
        } else if let Some(corner) = both("xllcorner", "yllcorner")? {
            corner + reach
        } else if let Some(center) = both("xllcenter", "yllcenter")? {
            center - cell * 0.5 + reach
        } else {
            return Ok(None);
        };
        Ok(Some(RasterPlace { map_from_grid: north_up(corner, cell), stated: true }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dem::read::{DemHints, read};

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
