//! `sandtable viewshed`: what can be seen from a point, as a map, a raster or a few figures.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use clap::Args;
use glam::{DAffine2, DMat2, DVec2};

use crate::app::arguments::{Access, StatedHeights};
use crate::app::dataset::Dataset;
use crate::app::failure::CliError;
use crate::app::map::{SheetText, viewshed_map};
use crate::app::picture::png;
use crate::app::progress::StepTimer;
use crate::app::{files, output, rasters};
use crate::dem::formats::DemFormat;
use crate::dem::raster::{Raster, Samples};
use crate::geom::crs::Crs;
use crate::terrain::lattice::{Lattice, Post};
use crate::terrain::query::Answer;
use crate::terrain::sight::Curvature;
use crate::terrain::sight::line::SightEnd;
use crate::terrain::sight::viewshed::ViewshedOptions as Question;
use crate::terrain::sight::viewshed::{PostVisibility, Sector, Viewshed, ViewshedCounts, viewshed};

/// `viewshed`.
#[derive(Debug, Args)]
#[command(
    after_help = "A raster holds 1 where a target can be seen, 0 where it is hidden, and 255, its no-data value, beyond the \
                  range, out of the sector and where there is no elevation."
)]
pub struct ViewshedArguments {
    /// The elevation file or scene
    pub file: PathBuf,
    /// Where the observer stands, in the file's or scene's coordinates
    #[arg(long, value_name = "X,Y", allow_hyphen_values = true)]
    pub at: Pair,
    /// The coordinate system of the position, for instance EPSG:4326 [default: the file's or scene's]
    #[arg(long, value_name = "CRS")]
    pub crs: Option<String>,
    /// Meters of the eye above the ground
    #[arg(long, value_name = "METERS", default_value_t = 2.0, value_parser = meters)]
    pub observer_height: f64,
    /// Meters of what is looked for above the ground
    #[arg(long, value_name = "METERS", default_value_t = 0.0, value_parser = meters)]
    pub target_height: f64,
    /// How far to look, in meters [default: without limit]
    #[arg(long, value_name = "METERS", value_parser = meters_above_zero)]
    pub range: Option<f64>,
    /// Look only between two azimuths, in degrees clockwise from north
    #[arg(long, value_name = "FROM,TO", allow_hyphen_values = true)]
    pub sector: Option<Pair>,
    /// The refraction coefficient: the share of the Earth's curvature that the air takes back
    #[arg(long, value_name = "K", default_value_t = 1.0 / 7.0, value_parser = below_one)]
    pub refraction: f64,
    /// Take the Earth for flat and without air
    #[arg(long, conflicts_with = "refraction")]
    pub flat: bool,
    /// Where the answer goes: a map as .png, or a raster as .tif, .asc or .bt
    #[arg(short, long, value_name = "OUT")]
    pub output: Option<PathBuf>,
    /// Print one JSON object
    #[arg(long)]
    pub json: bool,
    /// What the gray values of a picture mean.
    #[command(flatten)]
    pub heights: StatedHeights,
    /// What may be read.
    #[command(flatten)]
    pub access: Access,
}

/// Two numbers with a comma between.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pair(pub f64, pub f64);

impl FromStr for Pair {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let number = |text: &str| text.trim().parse::<f64>().ok().filter(|number| number.is_finite());
        let pair =
            text.split_once(',').and_then(|(first, second)| Some(Self(number(first)?, number(second)?)));
        pair.ok_or_else(|| "write two numbers with a comma between".into())
    }
}

fn meters(text: &str) -> Result<f64, String> {
    let number = text.parse::<f64>().ok().filter(|meters| (0.0..=1e5).contains(meters));
    number.ok_or_else(|| "write meters as a number from 0 to 100000".into())
}

fn meters_above_zero(text: &str) -> Result<f64, String> {
    let number = text.parse::<f64>().ok().filter(|meters| meters.is_finite() && *meters > 0.0);
    number.ok_or_else(|| "write meters as a number above 0".into())
}

fn below_one(text: &str) -> Result<f64, String> {
    let number = text.parse::<f64>().ok().filter(|k| (-1.0..1.0).contains(k));
    number.ok_or_else(|| "write a number from -1 to below 1; 0.13 to 0.17 is usual".into())
}

/// What the answer is written as.
#[derive(Clone, Copy)]
enum ViewshedFormat {
    Map,
    Raster(&'static DemFormat),
}

/// Looks, writes the map or the raster, and prints how much can be seen.
///
/// # Errors
/// The file or the position cannot be had, or the answer not be written.
pub fn run(options: &ViewshedArguments) -> Result<(), CliError> {
    let form = options.output.as_deref().map(|path| form_of(path, &options.file)).transpose()?;
    let steps = StepTimer::default();
    steps.begin("reading the ground");
    let dataset = Dataset::open(&options.file, options.heights, &options.access)?;
    let epoch = dataset.service()?.snapshot();
    let lattice = epoch.lattice();
    let question = question(options, &dataset, epoch.crs())?;
    steps.begin("looking around");
    let seen = viewshed(lattice, &question).map_err(|answer| no_ground(options, answer))?;
    if let (Some(form), Some(path)) = (form, &options.output) {
        steps.begin("writing");
        write(
            form,
            path,
            &ViewshedOutput {
                options,
                lattice,
                crs: epoch.crs(),
                question: &question,
                seen: &seen,
                datum: epoch.source().vertical_datum.clone(),
            },
        )?;
    }
    steps.finish();
    let summary = ViewshedSummary::new(lattice, &seen);
    let text = if options.json { summary.json(options, &question) } else { summary.text(options) };
    output::print(&text)
}

fn form_of(path: &Path, input: &Path) -> Result<ViewshedFormat, CliError> {
    let is_map = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("png"));
    if is_map {
        files::check_file_place(path, input, "this is the elevation file itself; name another with -o")?;
        return Ok(ViewshedFormat::Map);
    }
    rasters::format_of(path, &[input.to_owned()]).map(ViewshedFormat::Raster)
}

fn question(options: &ViewshedArguments, dataset: &Dataset, ground: &Crs) -> Result<Question, CliError> {
    let from = match &options.crs {
        Some(text) => Crs::parse(text).map_err(|error| CliError::Usage(format!("--crs {text}: {error}")))?,
        None => dataset.crs(),
    };
    let Pair(x, y) = options.at;
    let at = from
        .transform(ground, DVec2::new(x, y))
        .map_err(|error| CliError::input(format!("--at {x},{y}: {error}")))?;
    let curvature = match options.flat {
        true => Curvature::FLAT,
        false => Curvature { refraction: options.refraction, ..Curvature::default() },
    };
    Ok(Question {
        observer: SightEnd { at, above_m: options.observer_height },
        target_above_m: options.target_height,
        range_m: options.range.unwrap_or(f64::INFINITY),
        sector: options.sector.map_or(Sector::ALL, |Pair(from, to)| Sector::between(from, to)),
        curvature,
    })
}

fn no_ground(options: &ViewshedArguments, answer: Answer) -> CliError {
    let Pair(x, y) = options.at;
    let why = match answer {
        Answer::NoData => "there is no elevation at the observer",
        _ => "the observer stands outside the elevation model",
    };
    CliError::input(format!("{}: --at {x},{y}: {why}; name a place on the ground", options.file.display()))
}

/// What is written.
struct ViewshedOutput<'a> {
    options: &'a ViewshedArguments,
    lattice: &'a Lattice,
    crs: &'a Crs,
    question: &'a Question,
    seen: &'a Viewshed,
    datum: Option<String>,
}

fn write(form: ViewshedFormat, path: &Path, shown: &ViewshedOutput<'_>) -> Result<(), CliError> {
    match form {
        ViewshedFormat::Raster(format) => {
            let raster = raster(shown.lattice, shown.seen, shown.crs);
            rasters::write(&raster, format, path, std::slice::from_ref(&shown.options.file)).map(|_| ())
        }
        ViewshedFormat::Map => {
            let map = viewshed_map(shown.lattice, shown.seen, shown.question, words(shown));
            files::write_whole(path, &png(&map)?)
        }
    }
}

fn words(shown: &ViewshedOutput<'_>) -> SheetText {
    let options = shown.options;
    let name = options.file.file_stem().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    let share = ViewshedSummary::new(shown.lattice, shown.seen).share();
    let mut subtitle = format!("Eye {} m above ground", options.observer_height);
    if options.target_height > 0.0 {
        let _ = write!(subtitle, ", target {} m", options.target_height);
    }
    if let Some(range) = options.range {
        let _ = write!(subtitle, ", within {range} m");
    }
    if let Some(Pair(from, to)) = options.sector {
        let _ = write!(subtitle, ", azimuth {from}° to {to}°");
    }
    let _ = write!(subtitle, "; {:.1} % in sight", share * 100.0);
    subtitle.push_str(if options.flat { "; flat Earth" } else { "; curvature and refraction applied" });
    SheetText { title: format!("Viewshed · {name}"), subtitle, vertical_datum: shown.datum.clone() }
}

/// The value of what was not looked at, or has no data.
const NO_ANSWER: f64 = 255.0;

/// The answer as a raster: 1 in sight, 0 hidden, no data elsewhere.
fn raster(lattice: &Lattice, seen: &Viewshed, crs: &Crs) -> Raster {
    let value = |seen: &PostVisibility| match seen {
        PostVisibility::Visible => 1.0,
        PostVisibility::Hidden => 0.0,
        PostVisibility::Beyond | PostVisibility::NoData => f32::NAN,
    };
    let rows = seen.posts.chunks_exact(seen.columns as usize).rev();
    let cell = lattice.cell();
    let north_west = lattice.map_position(Post { column: 0, row: lattice.rows() - 1 });
    Raster {
        driver: "viewshed",
        data_type: "Byte",
        width: seen.columns,
        height: seen.rows,
        samples: Samples::F32(rows.flatten().map(value).collect()),
        meters_per_z: 1.0,
        map_from_grid: DAffine2 {
            matrix2: DMat2::from_diagonal(DVec2::new(cell.x, -cell.y)),
            translation: north_west + DVec2::new(-0.5, 0.5) * cell,
        },
        georeferenced: true,
        crs: (*crs != Crs::local()).then(|| crs.clone()),
        nodata: Some(NO_ANSWER),
        vertical_datum: None,
    }
}

/// How much can be seen.
struct ViewshedSummary {
    counts: ViewshedCounts,
    cell_m2: f64,
}

impl ViewshedSummary {
    fn new(lattice: &Lattice, seen: &Viewshed) -> Self {
        Self { counts: seen.counts(), cell_m2: lattice.cell().element_product() }
    }

    /// Of the posts that were looked at, the share in sight; 0 where there are none.
    fn share(&self) -> f64 {
        let looked = self.counts.visible + self.counts.hidden;
        if looked == 0 { 0.0 } else { self.counts.visible as f64 / looked as f64 }
    }

    fn visible_m2(&self) -> f64 {
        self.counts.visible as f64 * self.cell_m2
    }

    fn json(&self, options: &ViewshedArguments, question: &Question) -> String {
        let ViewshedCounts { visible, hidden, no_data, beyond } = self.counts;
        let range = options.range;
        let object = serde_json::json!({
            "observer": { "x": question.observer.at.x, "y": question.observer.at.y, "above_m": options.observer_height },
            "target_above_m": options.target_height,
            "range_m": range,
            "sector_deg": options.sector.map(|Pair(from, to)| [from, to]),
            "refraction": (!options.flat).then_some(options.refraction),
            "posts": { "visible": visible, "hidden": hidden, "no_data": no_data, "beyond": beyond },
            "visible_m2": self.visible_m2(),
            "visible_share": self.share(),
            "output": options.output.as_ref().map(|path| path.display().to_string()),
        });
        format!("{object:#}\n")
    }

    fn text(&self, options: &ViewshedArguments) -> String {
        let ViewshedCounts { visible, hidden, no_data, beyond } = self.counts;
        let mut lines = Vec::new();
        lines.extend(options.output.as_ref().map(|path| path.display().to_string()));
        lines.push(format!(
            "  in sight  {:.3} km², {:.2} % of what was looked at",
            self.visible_m2() / 1e6,
            self.share() * 100.0
        ));
        lines.push(format!(
            "  posts     {visible} visible, {hidden} hidden, {no_data} without data, {beyond} beyond"
        ));
        output::text_of(&lines)
    }
}
