//! What may be said on the command line.

use std::path::PathBuf;
use std::str::FromStr;

use clap::{Args, Parser, Subcommand, ValueEnum};

use crate::app::convert::ConvertOptions;
use crate::app::export::ExportOptions;
use crate::app::grid::GridOptions;
use crate::app::height::HeightOptions;
use crate::app::lod::choice::Wanted;
use crate::app::lod::method::{CriterionKind, Emit, Refine};
use crate::app::lod::way::FlightPath;
use crate::app::los::LosOptions;
use crate::app::new::NewOptions;
use crate::app::profile::ProfileOptions;
use crate::app::report::ReportOptions;
use crate::app::serve::ServeOptions;
use crate::app::viewshed::ViewshedArguments;
use crate::dem::formats::height_encoding::HeightEncoding;
use crate::dem::formats::raw::RawLayout;
use crate::terrain::query::Interpolation;

/// Elevation models and what stands on them, made into scenes, and scenes into pictures.
#[derive(Debug, Parser)]
#[command(name = "sandtable", version, propagate_version = true)]
#[command(after_help = "Exit codes: 0 done, 1 the input is wrong, 2 wrong usage.")]
pub struct Arguments {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Render a scene file to an annotated PNG
    Render(RenderOptions),
    /// Load and validate a scene file without rendering it
    Check(CheckOptions),
    /// Write a first scene file for an elevation file and vector files
    New(NewOptions),
    /// Print the JSON Schema of scene files, with which editors complete and check them
    Schema,
    /// Look at elevation files
    Dem {
        /// What to do with the file.
        #[command(subcommand)]
        command: DemCommand,
    },
    /// Look at model files
    Model {
        /// What to do with the file.
        #[command(subcommand)]
        command: ModelCommand,
    },
    /// Ask an elevation file or a scene for heights at points
    Height(HeightOptions),
    /// The ground along a line, as a chart or a table
    Profile(ProfileOptions),
    /// Whether one point can be seen from another, and what stands between
    Los(LosOptions),
    /// What can be seen from a point, as a map or a raster
    Viewshed(ViewshedArguments),
    /// Answer questions about heights over HTTP
    Serve(ServeOptions),
    /// What building a scene found out about single features: earth moved, gaps left, levels taken
    Report(ReportOptions),
    /// Write a scene as a file that modeling programs open
    Export(ExportOptions),
    /// Turn an elevation file into a mesh that is nowhere off by more than a given height
    Mesh(MeshOptions),
    /// Fly over an elevation file and compare the methods of showing it
    Lod(LodOptions),
}

/// What can be done with an elevation file.
#[derive(Debug, Subcommand)]
pub enum DemCommand {
    /// Print format, size, coordinate system, no-data value and statistics
    Info(DemInfoOptions),
    /// Write elevation files in another format, coordinate system or cell size; several are joined
    Convert(ConvertOptions),
    /// Make a grid of scattered points
    Grid(GridOptions),
}

/// What can be done with a model file.
#[derive(Debug, Subcommand)]
pub enum ModelCommand {
    /// Print meshes, vertices, faces, materials and bounds (Z up, the file's units)
    Info(InfoOptions),
}

/// `render`.
#[derive(Debug, Args)]
pub struct RenderOptions {
    /// The scene file
    pub scene: PathBuf,
    /// Where the picture goes [default: the scene's name with .png, in the current folder]
    #[arg(short, long, value_name = "OUT.png")]
    pub output: Option<PathBuf>,
    /// Size of the picture in pixels
    #[arg(long, value_name = "WxH", default_value = "1920x1080")]
    pub size: PictureSize,
    /// Which of the scene's cameras to look through [default: its first]
    #[arg(long, value_name = "NAME")]
    pub camera: Option<String>,
    /// What draws: the processor, the same on every machine, or a graphics adapter
    #[arg(long, value_enum, default_value_t)]
    pub backend: Backend,
    /// How many threads to use [default: one per core]; the picture is the same for any number
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
    /// What may be read.
    #[command(flatten)]
    pub access: Access,
}

/// `check`.
#[derive(Debug, Args)]
pub struct CheckOptions {
    /// The scene file
    pub scene: PathBuf,
    /// What may be read.
    #[command(flatten)]
    pub access: Access,
}

/// Which files a scene may name.
#[derive(Debug, Args)]
pub struct Access {
    /// Also let the scene read files under DIR; without it, only under the parent of the scene's folder
    #[arg(long, value_name = "DIR")]
    pub allow: Vec<PathBuf>,
}

/// `model info`, and what `dem info` has in common with it.
#[derive(Debug, Args)]
pub struct InfoOptions {
    /// The file
    pub file: PathBuf,
    /// Print one JSON object
    #[arg(long)]
    pub json: bool,
}

/// `dem info`.
#[derive(Debug, Args)]
#[command(after_help = FOLDER_HELP)]
pub struct DemInfoOptions {
    /// The file and the form of the answer.
    #[command(flatten)]
    pub info: InfoOptions,
    /// What gray values mean.
    #[command(flatten)]
    pub heights: StatedHeights,
}

/// What the help of a command that reads elevation says of folders.
pub const FOLDER_HELP: &str = "\
Where an elevation file is wanted a folder may be named: the elevation files in it, sorted by name, are then tiles of
one raster and are joined. Of values that tiles share the first tile's is kept; gray or color pictures, tables and RAW
files in it are passed over.";

/// What an elevation file does not say of its heights: what gray values and colors mean in meters, and how samples
/// without a header are laid out.
#[derive(Clone, Copy, Debug, Default, Args)]
pub struct StatedHeights {
    /// Meters per gray value of a PNG, which needs it, or of a RAW file [default: 1]
    #[arg(long, value_name = "METERS", allow_negative_numbers = true)]
    pub height_scale: Option<f64>,
    /// Height in meters of value 0 of a gray PNG or a RAW file [default: 0]
    #[arg(long, value_name = "METERS", allow_negative_numbers = true)]
    pub height_offset: Option<f64>,
    /// What the colors of a PNG mean: terrain-rgb (Mapbox) or terrarium (Mapzen)
    #[arg(long, value_name = "ENCODING", conflicts_with_all = ["height_scale", "height_offset"])]
    pub height_encoding: Option<HeightEncoding>,
    /// That the file is RAW, and its layout: 1201x1201:i16be, then :skip=BYTES and :nodata=VALUE
    #[arg(long, value_name = "WxH:TYPE")]
    pub raw: Option<RawLayout>,
}

/// `mesh`.
#[derive(Debug, Args)]
#[command(
    after_help = "Coordinates are meters from the south-west post, X east, Y north, Z up; the file says where that is.\n\
                  An elevation file in degrees is brought to its UTM zone first. Ground without data is left out."
)]
pub struct MeshOptions {
    /// The elevation file
    pub file: PathBuf,
    /// The most that the mesh may be off, vertically, at any post of the elevation file
    #[arg(long, value_name = "METERS", allow_negative_numbers = true, value_parser = meters_from_zero)]
    pub max_error: f64,
    /// Where the mesh goes: .obj, .ply, .stl or .glb
    #[arg(short, long, value_name = "OUT")]
    pub output: PathBuf,
    /// The coordinate system of an elevation file that names none, for example EPSG:4326
    #[arg(long, value_name = "CRS")]
    pub crs: Option<String>,
    /// Meters between the posts of an elevation file that does not say
    #[arg(long, value_name = "METERS", allow_negative_numbers = true)]
    pub cell: Option<f64>,
    /// What gray values mean.
    #[command(flatten)]
    pub heights: StatedHeights,
}

/// `lod`.
#[derive(Debug, Args)]
#[command(after_help = LOD_HELP)]
pub struct LodOptions {
    /// The elevation file; one in degrees is brought to UTM
    pub file: PathBuf,
    /// Only methods that make their triangles this way
    #[arg(long, value_enum)]
    pub emit: Option<Emit>,
    /// Only methods with this criterion of when an error shows
    #[arg(long, value_enum)]
    pub criterion: Option<CriterionKind>,
    /// Only methods that refine this way
    #[arg(long, value_enum)]
    pub refine: Option<Refine>,
    /// How many pixels of a picture 1024 wide an error may show
    #[arg(long, value_name = "X", default_value = "1", value_parser = tolerance_px)]
    pub tolerance_px: f32,
    /// As fine as so many triangles allow, instead of a tolerance; only methods that refine by queues
    #[arg(long, value_name = "N", conflicts_with = "tolerance_px", value_parser = clap::value_parser!(u32).range(1..))]
    pub budget: Option<u32>,
    /// Which way to fly: circle, line (from the south-west to the north-east), or a file of stations
    #[arg(long, value_name = "circle|line|FILE", default_value = "circle")]
    pub flight: FlightPath,
    /// How many frames the flight has
    #[arg(long, value_name = "N", default_value_t = 240, value_parser = clap::value_parser!(u32).range(2..=100_000))]
    pub frames: u32,
    /// Print a JSON array with one object per method
    #[arg(long)]
    pub json: bool,
    /// What gray values mean.
    #[command(flatten)]
    pub heights: StatedHeights,
}

pub(in crate::app) fn meters_from_zero(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(meters) if meters.is_finite() && meters >= 0.0 => Ok(meters),
        _ => Err("write meters as a number from 0 on".into()),
    }
}

/// What `lod --help` ends with.
const LOD_HELP: &str = "\
Flights: the eye of a circle or a line is 30 cells above the ground's mean height along the way and looks 8° down;
a circle goes one cell a frame round the middle of the south-western 513 posts. A file has a station a line,
x,y,z,tx,ty,tz: the eye and what it looks at, meters from the south-west post, x east, y north, z the elevation;
frames are spread over it at equal distances.

Methods: without --emit, --criterion, --refine and --budget a selection is compared; with any of them all methods that
go with what is asked for, with the bintree's triangles where --emit is not given. geomipmap and full have no
criterion and no refiner; deferred goes with spheres, constrained and bounding, and with bintree; a budget goes with
queues, and is exceeded only where the two root triangles of each patch in view are more.

Columns, over all frames but the first: triangles and vertices named by the index lists (means); changed: triangles
not shown in the frame before (mean); milliseconds to bring triangles and lists up to date; upload: bytes of 16-bit
index lists sent a frame (median): of the patches that changed or came into view, or of all that are shown where a
method does not know which stayed the same; full sends nothing after the first frame;
mean, RMS and maximum meters between what is shown and the elevation model, and the most that is on the picture in
pixels, at every post in the picture, hidden ones among them, in eight frames.";

impl LodOptions {
    /// Which methods are asked for.
    pub fn wanted(&self) -> Wanted {
        Wanted { emit: self.emit, rule: self.criterion, refine: self.refine, budget: self.budget }
    }
}

/// A tolerance in pixels, above 0 and at most 1000.
fn tolerance_px(text: &str) -> Result<f32, String> {
    match text.parse::<f32>() {
        Ok(value) if value > 0.0 && value <= 1000.0 => Ok(value),
        Ok(_) => Err("it must be above 0 and at most 1000".into()),
        Err(_) => Err("write a number such as 1.5".into()),
    }
}

/// What draws.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Backend {
    /// The processor.
    #[default]
    Cpu,
    /// A graphics adapter; needs the Cargo feature `gpu`.
    Gpu,
}

/// An interpolation by its name on the command line.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum InterpolationChoice {
    /// On the finest triangles
    Planar,
    /// Between four posts, as GDAL does
    #[default]
    Bilinear,
    /// The nearest post's
    Nearest,
    /// The four posts around, weighted by nearness
    DistanceWeighted,
}

impl From<InterpolationChoice> for Interpolation {
    fn from(choice: InterpolationChoice) -> Self {
        match choice {
            InterpolationChoice::Planar => Self::Planar,
            InterpolationChoice::Bilinear => Self::Bilinear,
            InterpolationChoice::Nearest => Self::Nearest,
            InterpolationChoice::DistanceWeighted => Self::DistanceWeighted4,
        }
    }
}

/// A picture's size.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PictureSize {
    /// Pixels across, 16 to 16384.
    pub width: u32,
    /// Pixels down, 16 to 16384.
    pub height: u32,
}

impl FromStr for PictureSize {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let sides = text.split_once(['x', 'X', '×']);
        let parsed = sides.and_then(|(width, height)| Some((width.parse().ok()?, height.parse().ok()?)));
        match parsed {
            Some((width, height)) if (16..=16384).contains(&width) && (16..=16384).contains(&height) => {
                Ok(Self { width, height })
            }
            Some(_) => Err("each side must lie between 16 and 16384 pixels".into()),
            None => Err("write width and height as in 1920x1080".into()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_arguments_are_sound() {
        use clap::CommandFactory;
        Arguments::command().debug_assert();
    }

    #[test]
    fn an_error_is_a_finite_number_from_zero_on() {
        assert_eq!(meters_from_zero("2.5"), Ok(2.5));
        for wrong in ["-1", "NaN", "inf", "1e999", "five", ""] {
            assert!(meters_from_zero(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn sizes_are_two_numbers_within_range() {
        assert_eq!("640x480".parse(), Ok(PictureSize { width: 640, height: 480 }));
        for wrong in ["640", "640x", "0x0", "99999x10", "-4x20", "axb"] {
            assert!(wrong.parse::<PictureSize>().is_err(), "{wrong}");
        }
    }
}
