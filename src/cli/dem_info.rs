//! `sandtable dem info`: metadata and statistics of an elevation file or a folder of tiles.

use std::path::PathBuf;

use clap::Args;
use serde_json::{Value, json};

use crate::error::CliError;
use crate::options::HeightArguments;
use crate::output::{print, print_lines, row};
use sandtable_base::limits::RASTER_SAMPLES;
use sandtable_base::message::numbers::counted;
use sandtable_files::error::FileError;
use sandtable_query::dem::{self, OpenedDem};
use sandtable_raster::error::DemErrorKind;
use sandtable_raster::odd_values::written;
use sandtable_raster::raster::Raster;
use sandtable_raster::stats::{RasterSurvey, Stats};
use sandtable_raster::undeclared::undeclared_nodata;
use sandtable_raster::unstated_unit;
use sandtable_raster::void_counts::VoidCounts;

#[derive(Debug, Args)]
#[command(after_help = "\
Where an elevation file is wanted a folder may be named: the elevation files in it, sorted by name, are then tiles of
one raster and are joined. Of values that tiles share the first tile's is kept. Gray or color pictures, tables and RAW
files in the folder are skipped.")]
pub struct DemInfoArguments {
    /// The file
    pub file: PathBuf,
    /// Print one JSON object
    #[arg(long)]
    pub json: bool,
    #[command(flatten)]
    pub heights: HeightArguments,
}

pub fn run(arguments: &DemInfoArguments) -> Result<(), CliError> {
    // What tiles share is known where all of them are joined.
    let most_kept = if arguments.file.is_dir() { RASTER_SAMPLES.get() } else { MOST_KEPT };
    let opened = dem::open_either(&arguments.file, &arguments.heights.dem_options(), most_kept)?;
    let info = match opened {
        OpenedDem::Kept(mosaic) => {
            let joined = arguments.file.is_dir().then(|| mosaic.note());
            let (stats, voids) = (Stats::new(&mosaic.raster), VoidCounts::of(&mosaic.raster));
            let undeclared = undeclared_nodata(&mosaic.raster);
            DemInfo::new(mosaic.raster, RasterSurvey { stats, voids, undeclared }, joined)
        }
        OpenedDem::Windows(mut windows) => {
            let measured = Stats::of_windows(&mut *windows);
            let surveyed = measured.map_err(FileError::<DemErrorKind>::at(&arguments.file))?;
            DemInfo::new(windows.metadata().without_samples(), surveyed, None)
        }
    };
    if arguments.json { print(&format!("{}\n", info.json())) } else { print_lines(&info.table()) }
}

/// The most samples of a file that is read whole: a larger one is read twice, for less memory.
const MOST_KEPT: u64 = 1 << 24;

/// A raster and its statistics.
struct DemInfo {
    raster: Raster,
    stats: Stats,
    /// Voids that other samples enclose.
    enclosed_voids: VoidCounts,
    notes: Vec<String>,
}

impl DemInfo {
    fn new(raster: Raster, surveyed: RasterSurvey, joined: Option<String>) -> Self {
        let RasterSurvey { stats, voids, undeclared } = surveyed;
        let of_format = format_note(&raster).map(str::to_owned);
        let undeclared = undeclared.iter().map(|found| {
            let (evidence, value) = (&found.evidence, found.written());
            format!("{evidence}: if that means no data, say --nodata {value}")
        });
        let of_reading = raster.notes.iter().cloned().chain(unstated_unit::note(&raster));
        let notes = joined.into_iter().chain(of_format).chain(of_reading).chain(undeclared).collect();
        Self { raster, stats, enclosed_voids: voids, notes }
    }

    /// One JSON object; a missing number is null.
    fn json(&self) -> Value {
        let Self { raster, stats, enclosed_voids: VoidCounts { voids, samples }, notes } = self;
        json!({
            "driver": raster.driver,
            "width": raster.width,
            "height": raster.height,
            "type": raster.data_type,
            "crs": raster.crs.as_ref().map(|crs| crs.name()),
            "transform": raster.geotransform(),
            "georeferenced": raster.georeferenced,
            "bands": raster.bands.count,
            "mask_band": raster.bands.mask,
            "nodata": json_nodata(raster.nodata),
            "vertical_datum": raster.vertical_datum,
            "meters_per_z": raster.meters_per_z,
            "valid": stats.valid,
            "enclosed_voids": voids,
            "enclosed_void_samples": samples,
            "min": stats.min,
            "max": stats.max,
            "mean": stats.mean,
            "std": stats.std,
            "notes": notes,
        })
    }

    fn table(&self) -> Vec<String> {
        let Self { raster, stats, enclosed_voids: VoidCounts { voids, samples }, notes } = self;
        let affine = raster.map_from_grid;
        let (east, south) = (affine.matrix2.x_axis, affine.matrix2.y_axis);
        let corner = affine.translation;
        let all = raster.width as usize * raster.height as usize;
        let heights = match stats.valid {
            0 => "none".to_owned(),
            _ => format!("{} to {}, mean {}, deviation {}", stats.min, stats.max, stats.mean, stats.std),
        };
        let rows = [
            ("driver", raster.driver.to_owned()),
            ("size", format!("{} columns, {} rows", raster.width, raster.height)),
            ("type", raster.data_type.to_owned()),
            ("bands", raster.bands.text()),
            ("crs", raster.crs.as_ref().map_or("none stated", |crs| crs.name()).to_owned()),
            ("corner", format!("({}, {}), outer corner of the first sample", corner.x, corner.y)),
            ("sample", format!("({}, {}) a column, ({}, {}) a row", east.x, east.y, south.x, south.y)),
            ("nodata", raster.nodata.map_or("none stated".to_owned(), written)),
            ("valid", format!("{} of {all} samples", stats.valid)),
            ("voids", {
                let (samples_s, voids_s) =
                    (counted(all - stats.valid, "sample", "samples"), counted(*voids, "void", "voids"));
                format!("{samples_s}, {samples} of them enclosed, in {voids_s}")
            }),
            ("heights", heights),
            ("unit", format!("{} m", raster.meters_per_z)),
            ("datum", raster.vertical_datum.as_deref().unwrap_or("none stated").to_owned()),
        ];
        let notes = notes.iter().map(|note| row(8, "note", note));
        rows.iter().map(|(name, value)| row(8, name, value)).chain(notes).collect()
    }
}

/// A remark about a format that readers interpret differently.
fn format_note(raster: &Raster) -> Option<&'static str> {
    match raster.driver {
        "BT" => Some(
            "the extents are those of the outermost nodes, as the Virtual Terrain Project has it; GDAL takes them \
             for the edges of cells, up to half a cell away",
        ),
        "Terragen" => {
            Some("the format states no place: as with GDAL, y counts southward from the northern edge")
        }
        _ => None,
    }
}

/// The no-data value; NaN, which JSON does not have, is the text `"nan"`.
fn json_nodata(value: Option<f64>) -> Value {
    match value {
        Some(value) if value.is_nan() => json!("nan"),
        value => json!(value),
    }
}
