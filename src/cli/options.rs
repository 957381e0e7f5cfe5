//! Options that commands share.

use std::path::PathBuf;

use clap::Args;

use crate::error::CliError;
use crate::output::warn;
use crate::values::{length_unit, picture_size};
use sandtable_dem::formats::height_encoding::HeightEncoding;
use sandtable_dem::formats::raw_layout::RawLayout;
use sandtable_dem::hints::DemOptions;
use sandtable_files::disk;
use sandtable_geom::crs::Crs;
use sandtable_query::dataset::{Dataset, DatasetOptions};
use sandtable_query::ground::QueriedGround;
use sandtable_query::positions::shift_note;
use sandtable_query::windowed_elevation::GroundReach;
use sandtable_raster::height_datum::HeightDatum;
use sandtable_scene::scene_file::is_scene_file;
use sandtable_scene::scene_model::SceneModel;
use sandtable_sheet::picture::PictureSize;

/// The scene file of a command, and the files it may read.
#[derive(Debug, Args)]
pub struct SceneArguments {
    /// The scene file
    pub scene: PathBuf,
    #[command(flatten)]
    pub access: AccessArguments,
}

/// The folders that a scene may read.
#[derive(Clone, Debug, Args)]
pub struct AccessArguments {
    /// Also let the scene read files under DIR; without it, only under the parent of its folder
    #[arg(long, value_name = "DIR")]
    pub allow: Vec<PathBuf>,
}

/// Heights of files that do not state their unit or layout.
#[derive(Clone, Debug, Default, Args)]
pub struct HeightArguments {
    /// Meters per gray value of a PNG, which needs it, or of a RAW file [default: 1]
    #[arg(long, value_name = "METERS", allow_negative_numbers = true)]
    pub height_scale: Option<f64>,
    /// Height in meters of value 0 of a gray PNG or a RAW file [default: 0]
    #[arg(long, value_name = "METERS", allow_negative_numbers = true)]
    pub height_offset: Option<f64>,
    /// A value that means no data, besides the one that the file declares
    #[arg(long, value_name = "VALUE", allow_negative_numbers = true)]
    pub nodata: Option<f64>,
    /// The encoding of heights in the colors of a PNG: terrain-rgb (Mapbox) or terrarium (Mapzen)
    #[arg(long, value_name = "ENCODING", conflicts_with_all = ["height_scale", "height_offset"])]
    pub height_encoding: Option<HeightEncoding>,
    /// The vertical datum of the heights: egm96, ellipsoid or a name [default: the file's]
    #[arg(long, value_name = "DATUM")]
    pub vertical_datum: Option<String>,
    /// The unit of the heights: m, ft or us-ft [default: the file's, or meters]
    #[arg(long, value_name = "UNIT", value_parser = length_unit, conflicts_with_all = ["height_scale", "height_encoding"])]
    pub vertical_unit: Option<f64>,
    /// The layout of a RAW file: 1201x1201:i16be, then :skip=BYTES and :nodata=VALUE
    #[arg(long, value_name = "WxH:TYPE")]
    pub raw: Option<RawLayout>,
}

/// The dataset that a command queries.
#[derive(Debug, Args)]
pub struct DatasetArguments {
    /// The elevation file or scene
    pub file: PathBuf,
    /// System of positions X,Y: EPSG:4326 for longitude,latitude [default: the file's or scene's]
    #[arg(long, value_name = "CRS", value_parser = Crs::parse)]
    pub crs: Option<Crs>,
    /// Print JSON
    #[arg(long)]
    pub json: bool,
    #[command(flatten)]
    pub heights: HeightArguments,
    #[command(flatten)]
    pub access: AccessArguments,
}

#[derive(Debug, Args)]
pub struct ChartArguments {
    /// Write a chart to this file
    #[arg(short, long, value_name = "OUT.png")]
    pub output: Option<PathBuf>,
    /// Size of the chart in pixels
    #[arg(long, value_name = "WxH", default_value = "1600x800", value_parser = picture_size)]
    pub size: PictureSize,
}

impl HeightArguments {
    pub fn dem_options(&self) -> DemOptions {
        DemOptions {
            height_scale: self.height_scale,
            height_offset: self.height_offset,
            nodata: self.nodata,
            height_encoding: self.height_encoding,
            raw: self.raw,
            vertical_datum: self.vertical_datum.as_deref().map(full_datum_name),
            vertical_unit: self.vertical_unit,
            ..DemOptions::default()
        }
    }
}

/// The name of the vertical datum that a user calls `stated`.
fn full_datum_name(stated: &str) -> String {
    HeightDatum::from_name(stated).map_or_else(|| stated.to_owned(), |datum| datum.name().to_owned())
}

impl DatasetArguments {
    /// The options for opening the dataset.
    pub fn options(&self) -> DatasetOptions {
        let (dem, allowed) = (self.heights.dem_options(), self.access.allow.clone());
        DatasetOptions { dem, allowed, ..DatasetOptions::default() }
    }

    /// Opens the dataset; prints its warning, and what reading its files left out or guessed.
    pub fn open(&self) -> Result<Dataset, CliError> {
        Ok(self.told(Dataset::open(&self.file, &self.options())?))
    }

    /// The dataset of the scene at the file, which is built; prints as [`Self::open`].
    pub fn of_scene(&self, scene: &SceneModel) -> Dataset {
        self.told(Dataset::from_scene(&self.file.display().to_string(), scene))
    }

    /// Whether the file is a scene.
    pub fn is_scene(&self) -> bool {
        is_scene_file(&self.file)
    }

    fn told(&self, dataset: Dataset) -> Dataset {
        dataset.warning().into_iter().for_each(|warning| warn(&format!("warning: {warning}")));
        dataset.reading_notes().iter().for_each(|note| warn(&format!("note: {note}")));
        dataset
    }

    /// The ground in meters of the dataset as far as a query reaches; prints its note.
    pub fn ground(&self, dataset: &Dataset, reach: &GroundReach) -> Result<QueriedGround, CliError> {
        self.note_ground(dataset)?;
        Ok(dataset.ground(reach)?)
    }

    /// Prints the note of the ground in meters, which a query needs.
    pub fn note_ground(&self, dataset: &Dataset) -> Result<(), CliError> {
        dataset.prepare_ground()?;
        dataset.ground_note().iter().for_each(|note| warn(&format!("note: {note}")));
        Ok(())
    }

    /// The coordinate system of positions; says how good its datum shift is where that is not exact.
    pub fn crs(&self, dataset: &Dataset) -> Crs {
        let own = dataset.crs();
        let Some(stated) = &self.crs else { return own };
        if let Some(note) = shift_note(stated, &own) {
            warn(&format!("note: {note}"));
        }
        stated.clone()
    }

    /// The title of a chart of the dataset.
    pub fn chart_title(&self, what: &str) -> String {
        format!("{what} · {}", disk::file_name(&self.file))
    }
}

impl ChartArguments {
    /// Checks that the chart could be written.
    pub fn check(&self, input: &PathBuf) -> Result<(), CliError> {
        match &self.output {
            Some(path) => Ok(disk::check_picture_output(path, std::slice::from_ref(input))?),
            None => Ok(()),
        }
    }
}
