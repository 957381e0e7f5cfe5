//! What a caller states about an elevation file, and access to the files beside it.

use crate::formats::height_encoding::HeightEncoding;
use crate::formats::raw_layout::RawLayout;
use sandtable_geom::crs::Crs;

/// Statements of a caller about elevation, which replace or complement those of the file.
#[derive(Clone, Debug, Default)]
pub struct DemOptions {
    /// Meters per gray value of a PNG, which is refused without it, or per value of a RAW file (default 1).
    pub height_scale: Option<f64>,
    /// Elevation in meters of value 0. Default 0.
    pub height_offset: Option<f64>,
    /// A value that means no data, besides the one that the file declares, in the file's vertical unit.
    pub nodata: Option<f64>,
    /// The encoding of heights in the colors of a PNG; a color PNG is refused without it.
    pub height_encoding: Option<HeightEncoding>,
    /// The layout of the file, which is RAW.
    pub raw: Option<RawLayout>,
    /// The vertical datum, in place of the file's.
    pub vertical_datum: Option<String>,
    /// Meters in the unit of elevations, in place of the file's. It has no effect on heights that `height_scale` or
    /// `height_encoding` bring to meters.
    pub vertical_unit: Option<f64>,
    /// The distance between samples of a file without georeference, whose south-west sample is then at (0, 0); and of tiles
    /// whose cells do not nest when they are joined.
    pub cell: Option<f64>,
    /// The coordinate system, in place of the file's.
    pub crs: Option<Crs>,
    /// The name of the surface that is read of a LandXML file. Default: the first.
    pub surface: Option<String>,
}

/// Options for reading one elevation file.
#[derive(Clone)]
pub struct DemHints<'a> {
    /// What is stated of it.
    pub options: DemOptions,
    /// Called with the system that the file states where the stated one takes its place.
    pub overridden: &'a dyn Fn(&Crs),
    /// The bytes of a companion by its name: the name given to [`read`](crate::read::read) with another extension, such as `.prj`; `None`
    /// where there is none.
    pub companions: &'a dyn Fn(&str) -> Option<Vec<u8>>,
}

impl Default for DemHints<'_> {
    fn default() -> Self {
        DemOptions::default().into()
    }
}

impl From<DemOptions> for DemHints<'_> {
    /// The hints for a file without companions.
    fn from(options: DemOptions) -> Self {
        Self { options, overridden: &|_| (), companions: &|_| None }
    }
}
