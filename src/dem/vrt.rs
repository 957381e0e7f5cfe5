//! GDAL's virtual rasters (`.vrt`): a list of files that are tiles of one raster, as `gdalbuildvrt` writes it.
//!
//! ```text
//! VRTDataset rasterXSize rasterYSize ── GeoTransform
//!  └─ VRTRasterBand band=1 ── NoDataValue
//!      └─ SimpleSource, ComplexSource … ── SourceFilename, SourceBand, SrcRect, DstRect, NODATA
//! ```
//!
//! The tiles are joined as those of a folder are, each cropped and brought to the samples of the virtual raster as it states
//! (`vrt_source`), and what they join to is put into the frame that the virtual raster states (`vrt_frame`). One that averages,
//! warps or computes is refused: its samples are another program's to make.
//!
//! Source: GDAL, "VRT -- GDAL Virtual Format".

use std::path::{Path, PathBuf};

use glam::DAffine2;
use quick_xml::XmlVersion;
use quick_xml::events::{BytesStart, Event};
use quick_xml::reader::Reader;

use crate::formats::text::number;
use crate::vrt_fault::{PLACE, broken, shortened, unsupported};
use crate::vrt_frame::VrtFrame;
use crate::vrt_source::{VrtRect, VrtSource};
use sandtable_base::limits::VRT_BYTES;
use sandtable_raster::error::DemErrorKind;
use sandtable_raster::georef::affine;
use sandtable_raster::raster::Raster;
use sandtable_raster::windows::Windows;

/// The tiles that a virtual raster names.
#[derive(Clone, Debug, PartialEq)]
pub struct VrtTiles {
    /// The tiles in order of precedence: where tiles overlap, the first one counts; GDAL draws them in the order of the
    /// file, so this is the reverse. GDAL draws them in the order of the file, one over the other, so this is the reverse.
    pub sources: Vec<VrtSource>,
    frame: VrtFrame,
}

/// Whether a file is a virtual raster, by its name.
pub fn is_vrt(name: &str) -> bool {
    name.rsplit_once('.').is_some_and(|(_, extension)| extension.eq_ignore_ascii_case("vrt"))
}

impl VrtTiles {
    /// Reads the content of a virtual raster.
    ///
    /// # Errors
    /// It is not one, is larger than [`VRT_BYTES`], names no files, or makes its samples in another way than by joining them.
    pub fn read(bytes: &[u8]) -> Result<Self, DemErrorKind> {
        if bytes.len() as u64 > VRT_BYTES.get() {
            return Err(broken(format!("it has more than {VRT_BYTES} bytes; {VRT_BYTES:#}")));
        }
        let text = std::str::from_utf8(bytes).map_err(|error| broken(error.to_string()))?;
        let mut reader = VrtReader::default();
        let mut xml = Reader::from_str(text);
        xml.config_mut().expand_empty_elements = true;
        loop {
            match xml.read_event().map_err(|error| broken(error.to_string()))? {
                Event::Start(start) => reader.open(&start)?,
                Event::End(_) => reader.close()?,
                Event::Text(part) => reader.text.push_str(&part.xml10_content()),
                Event::CData(part) => reader.text.push_str(&part.xml10_content()),
                Event::GeneralRef(name) => reader.add_reference(&name)?,
                Event::Eof => break,
                _ => {}
            }
        }
        reader.finish()
    }

    /// The places of the files of the virtual raster at `path`.
    pub fn paths(&self, path: &Path) -> Vec<PathBuf> {
        self.sources.iter().map(|source| path.with_file_name(&source.file)).collect()
    }

    /// Replaces the nodata values of the virtual raster by the one that the user states, if any.
    pub fn state_nodata(&mut self, nodata: Option<f64>) {
        if nodata.is_some() {
            self.sources.iter_mut().for_each(|source| (source.nodata, source.also_nodata) = (nodata, None));
        }
    }

    /// Checks that the files are named relative to the virtual raster: one on a server names no file of this machine.
    ///
    /// # Errors
    /// A file is named otherwise.
    pub fn check_beside(&self) -> Result<(), DemErrorKind> {
        let elsewhere = |file: &&String| file.starts_with('/') || file.split('/').any(|part| part == "..");
        match self.sources.iter().map(|source| &source.file).find(elsewhere) {
            Some(file) => {
                Err(unsupported(format!("a file that does not lie beside it ('{}')", shortened(file))))
            }
            None => Ok(()),
        }
    }

    /// The joined tiles in the frame that the virtual raster states; without data where no tile is.
    ///
    /// # Errors
    /// They reach beyond it or lie between its samples, or it is larger than a raster.
    pub fn filled(&self, joined: Raster) -> Result<Raster, DemErrorKind> {
        self.frame.filled(joined)
    }

    /// [`VrtTiles::filled`] of tiles that are read in windows.
    ///
    /// # Errors
    /// The same.
    pub fn filled_windows(
        &self,
        joined: Box<dyn Windows + Send>,
    ) -> Result<Box<dyn Windows + Send>, DemErrorKind> {
        self.frame.filled_windows(joined)
    }
}

/// What is read so far, and where the reader stands.
#[derive(Default)]
struct VrtReader {
    /// The names of the open elements.
    path: Vec<String>,
    /// The text since the last tag.
    text: String,
    size: (u32, u32),
    map_from_grid: Option<DAffine2>,
    sources: Vec<VrtSource>,
    /// Of the band.
    nodata: Option<f64>,
    bands: usize,
    is_relative: bool,
    /// The source that is being read.
    source: SourceReader,
    /// Whether the bands after the first are being read.
    is_later_band: bool,
}

/// A source as far as it is read.
#[derive(Default)]
struct SourceReader {
    source: VrtSource,
    from: Option<VrtRect>,
    to: Option<VrtRect>,
    resampling: Option<String>,
}

impl VrtReader {
    fn open(&mut self, start: &BytesStart<'_>) -> Result<(), DemErrorKind> {
        self.text.clear();
        let name = start.local_name().into_inner().to_owned();
        if self.path.is_empty() && name != "VRTDataset" {
            return Err(broken(format!("its first element is {}", shortened(&name))));
        }
        if self.path.len() >= 16 {
            return Err(broken("its elements lie more than 16 deep".to_owned()));
        }
        match name.as_str() {
            "VRTDataset" | "VRTRasterBand" => self.open_raster(&name, start)?,
            "SourceFilename" => self.is_relative = attribute(start, "relativeToVRT").as_deref() == Some("1"),
            "SimpleSource" | "ComplexSource" => {
                let resampling = attribute(start, "resampling");
                self.source = SourceReader { resampling, ..SourceReader::default() };
            }
            "SrcRect" => self.source.from = Some(rect(start)?),
            "DstRect" => self.source.to = Some(rect(start)?),
            "KernelFilteredSource"
            | "NoDataFromMaskSource"
            | "AveragedSource"
            | "ArraySource"
            | "ScaleRatio"
            | "ScaleOffset"
            | "Exponent"
            | "LUT"
            | "MaskBand"
            | "PixelFunctionType"
            | "GDALWarpOptions"
            | "PansharpeningOptions"
            | "Step"
                if !self.is_later_band =>
            {
                return Err(unsupported(format!("{name}, which computes samples")));
            }
            _ => {}
        }
        self.path.push(name);
        Ok(())
    }

    fn open_raster(&mut self, name: &str, start: &BytesStart<'_>) -> Result<(), DemErrorKind> {
        if let Some(class) = attribute(start, "subClass").filter(|_| !self.is_later_band) {
            return Err(unsupported(format!("a {}, which computes samples", shortened(&class))));
        }
        if name == "VRTRasterBand" {
            self.bands += 1;
            self.is_later_band = self.bands > 1;
            return Ok(());
        }
        let side = |name: &str| attribute(start, name)?.trim().parse::<u32>().ok().filter(|side| *side > 0);
        let size = (side("rasterXSize"), side("rasterYSize"));
        let (Some(width), Some(height)) = size else {
            return Err(broken("it states no rasterXSize and rasterYSize".to_owned()));
        };
        self.size = (width, height);
        Ok(())
    }

    fn close(&mut self) -> Result<(), DemErrorKind> {
        let text = std::mem::take(&mut self.text);
        let text = text.trim();
        match self.path.pop().unwrap_or_default().as_str() {
            "GeoTransform" if self.path.len() == 1 => {
                let numbers: Option<Vec<f64>> =
                    text.split(',').map(|part| part.trim().parse().ok()).collect();
                let numbers: Option<[f64; 6]> = numbers.and_then(|numbers| numbers.try_into().ok());
                let numbers = numbers.filter(|numbers| numbers.iter().all(|number| number.is_finite()));
                let numbers =
                    numbers.ok_or_else(|| broken("its GeoTransform is not six numbers".to_owned()))?;
                self.map_from_grid = Some(affine(numbers));
            }
            "SourceFilename" if !self.is_later_band && self.is_in_source() => {
                let file = text.replace('\\', "/");
                if file.is_empty() {
                    return Err(broken("a SourceFilename is empty".to_owned()));
                }
                if file.starts_with("/vsi") || file.contains("://") {
                    return Err(unsupported(format!("'{}', which is no file", shortened(&file))));
                }
                if !self.is_relative && !file.starts_with('/') {
                    return Err(unsupported(format!(
                        "'{}' relative to the folder that a program runs in",
                        shortened(&file)
                    )));
                }
                self.source.source.file = file;
            }
            "SimpleSource" | "ComplexSource" if !self.is_later_band => self.take_source()?,
            "SourceBand" if !self.is_later_band && text != "1" => {
                return Err(unsupported(format!("band '{}' of a tile", shortened(text))));
            }
            "NoDataValue" if !self.is_later_band => self.nodata = no_data(text)?,
            "NODATA" if !self.is_later_band => self.source.source.nodata = no_data(text)?,
            _ => {}
        }
        Ok(())
    }

    /// Whether the last closed element was one of a source: an overview names files as well.
    fn is_in_source(&self) -> bool {
        self.path.last().is_some_and(|parent| matches!(parent.as_str(), "SimpleSource" | "ComplexSource"))
    }

    /// Takes the source that was read, unless all of it lies beyond the raster.
    fn take_source(&mut self) -> Result<(), DemErrorKind> {
        let SourceReader { mut source, from, to, resampling } = std::mem::take(&mut self.source);
        if source.file.is_empty() {
            return Err(broken("a source names no file".to_owned()));
        }
        let is_there = match from.zip(to) {
            Some((from, to)) => {
                let is_scaled = (from[2] - to[2]).abs() > PLACE || (from[3] - to[3]).abs() > PLACE;
                let other = resampling.filter(|word| !word.to_ascii_lowercase().starts_with("near"));
                if let Some(word) = other.filter(|_| is_scaled) {
                    return Err(unsupported(format!("a tile that is resampled ({})", shortened(&word))));
                }
                source.place(from, to, self.size)?
            }
            None => true,
        };
        self.sources.extend(is_there.then_some(source));
        Ok(())
    }

    fn add_reference(&mut self, name: &quick_xml::events::BytesRef<'_>) -> Result<(), DemErrorKind> {
        if let Ok(Some(character)) = name.resolve_char_ref() {
            self.text.push(character);
            return Ok(());
        }
        let known = quick_xml::escape::resolve_predefined_entity(name);
        self.text.push_str(known.ok_or_else(|| broken("it names an unknown entity".to_owned()))?);
        Ok(())
    }

    fn finish(self) -> Result<VrtTiles, DemErrorKind> {
        if self.size == (0, 0) {
            return Err(broken("it holds no VRTDataset".to_owned()));
        }
        if !self.path.is_empty() {
            return Err(broken("it ends within an element".to_owned()));
        }
        if self.sources.is_empty() {
            return Err(broken("it names no files".to_owned()));
        }
        let mut sources: Vec<VrtSource> = self.sources.into_iter().rev().collect();
        for source in &mut sources {
            source.also_nodata = self.nodata.filter(|all| source.nodata.is_some_and(|own| own != *all));
            source.nodata = source.nodata.or(self.nodata);
        }
        Ok(VrtTiles { sources, frame: VrtFrame { size: self.size, map_from_grid: self.map_from_grid } })
    }
}

/// A value that means no data; `None` of one that is not a number, which all samples that are none declare.
fn no_data(text: &str) -> Result<Option<f64>, DemErrorKind> {
    let value = number(text.trim().as_bytes());
    let value = value.ok_or_else(|| broken("its no-data value is no number".to_owned()))?;
    Ok(Some(value).filter(|value| !value.is_nan()))
}

fn attribute(start: &BytesStart<'_>, name: &str) -> Option<String> {
    let mut attributes = start.attributes();
    attributes.with_checks(false);
    let found = attributes.flatten().find(|attribute| attribute.key.into_inner() == name)?;
    Some(found.normalized_value(XmlVersion::Implicit1_0).ok()?.into_owned())
}

fn rect(start: &BytesStart<'_>) -> Result<[f64; 4], DemErrorKind> {
    let mut numbers = [0.0; 4];
    for (number, name) in numbers.iter_mut().zip(["xOff", "yOff", "xSize", "ySize"]) {
        let value = attribute(start, name).and_then(|value| value.trim().parse::<f64>().ok());
        *number = value
            .filter(|value| value.is_finite())
            .ok_or_else(|| broken(format!("a rectangle states no {name}")))?;
    }
    Ok(numbers)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::small_raster::small;

    fn vrt(band: &str) -> Result<VrtTiles, DemErrorKind> {
        let text = format!(
            "<VRTDataset rasterXSize=\"4\" rasterYSize=\"2\">\n<GeoTransform> 1000, 10, 0, 2020, 0, -10</GeoTransform>\n\
             <VRTRasterBand dataType=\"Float32\" band=\"1\">{band}</VRTRasterBand></VRTDataset>"
        );
        VrtTiles::read(text.as_bytes())
    }

    fn source(name: &str, column: u32) -> String {
        format!(
            "<SimpleSource><SourceFilename relativeToVRT=\"1\">{name}</SourceFilename><SourceBand>1</SourceBand>\
             <SrcRect xOff=\"0\" yOff=\"0\" xSize=\"2\" ySize=\"2\"/><DstRect xOff=\"{column}\" yOff=\"0\" xSize=\"2\" ySize=\"2\"/>\
             </SimpleSource>"
        )
    }

    #[test]
    fn the_last_tile_of_the_file_counts_first() {
        let two = format!(
            "<NoDataValue>-9999</NoDataValue>{}{}",
            source("w/a&amp;b.tif", 0),
            source("e\\c.tif", 2)
        );
        let tiles = vrt(&two).expect("two tiles");
        let files: Vec<&str> = tiles.sources.iter().map(|source| source.file.as_str()).collect();
        assert_eq!(files, ["e/c.tif", "w/a&b.tif"]);
        assert!(tiles.sources.iter().all(|source| source.nodata == Some(-9999.0)));
        assert!(tiles.filled(small(4, 2, vec![0.0; 8])).is_ok());
        let error = tiles.filled(small(5, 2, vec![0.0; 10])).expect_err("another size").to_string();
        assert!(error.contains("VRT") && error.contains("4 x 2 samples of tiles that span 5 x 2"), "{error}");
        let mut moved = small(4, 2, vec![0.0; 8]);
        moved.map_from_grid.translation.x += 1.0;
        assert!(tiles.filled(moved).is_err());
    }

    #[test]
    fn tiles_have_their_own_values_for_no_data_and_later_bands_none() {
        let own = source("a.tif", 0).replace("</SimpleSource>", "<NODATA>-1</NODATA></SimpleSource>");
        let overview = "<Overview><SourceFilename relativeToVRT=\"1\">o.tif</SourceFilename></Overview>";
        let later = source("z.tif", 0).replace("<SourceBand>1", "<SourceBand>2");
        let band = format!(
            "<NoDataValue>-9999</NoDataValue>{own}{}{overview}</VRTRasterBand><VRTRasterBand band=\"2\">{later}",
            source("b.tif", 2)
        );
        let mut tiles = vrt(&band).expect("two tiles");
        let values = |tiles: &VrtTiles| {
            tiles.sources.iter().map(|source| (source.nodata, source.also_nodata)).collect::<Vec<_>>()
        };
        assert_eq!(values(&tiles), [(Some(-9999.0), None), (Some(-1.0), Some(-9999.0))]);
        tiles.state_nodata(Some(7.0));
        assert_eq!(values(&tiles), [(Some(7.0), None); 2]);
    }

    #[test]
    fn what_computes_samples_is_refused() {
        let scaled =
            source("a.tif", 0).replace("</SimpleSource>", "<ScaleRatio>2</ScaleRatio></SimpleSource>");
        let between = source("a.tif", 0).replacen("DstRect xOff=\"0\"", "DstRect xOff=\"0.5\"", 1);
        let coarse = source("a.tif", 0)
            .replacen("xSize=\"2\"", "xSize=\"4\"", 1)
            .replace("<SimpleSource>", "<SimpleSource resampling=\"bilinear\">");
        let remote = source("/vsicurl/https://example.org/a.tif", 0);
        let anywhere = source("a.tif", 0).replace("relativeToVRT=\"1\"", "relativeToVRT=\"0\"");
        let second = source("a.tif", 0).replace("<SourceBand>1", "<SourceBand>2");
        for band in [scaled, between, coarse, remote, anywhere, second] {
            let error = vrt(&band).expect_err(&band);
            assert!(matches!(error, DemErrorKind::Unsupported { .. }), "{band}: {error}");
        }
        for text in [
            "",
            "<a/>",
            "<VRTDataset/>",
            "<VRTDataset rasterXSize=\"4\" rasterYSize=\"2\">",
            "<VRTDataset rasterXSize=\"4\" rasterYSize=\"2\"/>",
        ] {
            let error = VrtTiles::read(text.as_bytes()).expect_err(text);
            assert!(matches!(error, DemErrorKind::Broken { .. }), "{text}: {error}");
        }
    }
}
