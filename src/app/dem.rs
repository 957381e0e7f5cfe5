//! `sandtable dem info`, and the reading of elevation files that all commands do: what is in one, or in a folder of
//! tiles.

use std::borrow::Cow;
use std::path::{Path, PathBuf};

use serde_json::json;

use crate::app::arguments::{DemInfoOptions, StatedHeights};
use crate::app::failure::CliError;
use crate::app::{files, output};
use crate::dem::mosaic::{Mosaic, MosaicError, Tiles};
use crate::dem::raster::Raster;
use crate::dem::read::{self, DemHints};
use crate::dem::stats::Stats;
use crate::dem::voids;
use crate::geom::crs::Crs;

/// What the caller says of the place of an elevation file that does not say it.
#[derive(Clone, Debug, Default)]
pub struct StatedPlace {
    /// Meters between its posts.
    pub cell: Option<f64>,
    /// Its coordinate system.
    pub crs: Option<Crs>,
}

/// Reads the elevation file at `path`, its sidecars beside it, or joins the tiles in the folder at `path`.
///
/// Tiles that contradict each other are complained of on standard error.
///
/// # Errors
/// It cannot be had or read, or the files in the folder are not tiles of one raster; the message names it.
pub fn read_raster(path: &Path, heights: StatedHeights) -> Result<Raster, CliError> {
    read_raster_placed(path, heights, &StatedPlace::default())
}

/// [`read_raster`] where the caller states the place.
///
/// # Errors
/// As [`read_raster`].
pub fn read_raster_placed(
    path: &Path,
    heights: StatedHeights,
    place: &StatedPlace,
) -> Result<Raster, CliError> {
    if !path.is_dir() {
        return read_file(path, heights, place);
    }
    let mosaic = read_folder(path, heights, place)?;
    if mosaic.differing > 0 {
        output::warn(&format!("warning: {}: {}", path.display(), mosaic.note()));
    }
    Ok(mosaic.raster)
}

fn read_file(path: &Path, heights: StatedHeights, place: &StatedPlace) -> Result<Raster, CliError> {
    let bytes = files::read(path)?;
    let beside = files::beside(path);
    let hints = DemHints {
        height_scale: heights.height_scale,
        height_offset: heights.height_offset,
        height_encoding: heights.height_encoding,
        raw: heights.raw,
        cell: place.cell,
        crs: place.crs.clone(),
        companions: &beside,
        ..DemHints::default()
    };
    read::read(&name_of(path), &bytes, &hints)
        .map_err(|error| CliError::input(format!("{}: {}", path.display(), error.kind)))
}

fn read_folder(folder: &Path, heights: StatedHeights, place: &StatedPlace) -> Result<Mosaic, CliError> {
    let wrong = |reason: String| CliError::input(format!("{}: {reason}", folder.display()));
    let mut paths = files::in_folder(folder)?;
    paths.retain(|path| read::is_tile_name(&name_of(path)));
    if paths.is_empty() {
        return Err(wrong("there is no elevation file in this folder".into()));
    }
    read_tiles(&paths, heights, place).map_err(|failure| match failure {
        TileError::Failure(failure) => failure,
        TileError::Mosaic(reason) => wrong(reason),
    })
}

/// Joins the elevation files at `paths`, tiles of one raster.
///
/// # Errors
/// One cannot be had or read, or they are not tiles of one raster.
pub fn read_mosaic(
    paths: &[PathBuf],
    heights: StatedHeights,
    place: &StatedPlace,
) -> Result<Mosaic, CliError> {
    read_tiles(paths, heights, place).map_err(|failure| match failure {
        TileError::Failure(failure) => failure,
        TileError::Mosaic(reason) => CliError::input(reason),
    })
}

/// Why tiles are not joined.
enum TileError {
    /// A file cannot be had or read.
    Failure(CliError),
    /// They are not tiles of one raster.
    Mosaic(String),
}

fn read_tiles(paths: &[PathBuf], heights: StatedHeights, place: &StatedPlace) -> Result<Mosaic, TileError> {
    let wrong = |error: MosaicError| TileError::Mosaic(error.to_string());
    let mut tiles = Tiles::default();
    for path in paths {
        let tile = read_file(path, heights, place).map_err(TileError::Failure)?;
        tiles.push(name_of(path), tile).map_err(wrong)?;
    }
    tiles.join().map_err(wrong)
}

fn name_of(path: &Path) -> Cow<'_, str> {
    path.file_name().map(|name| name.to_string_lossy()).unwrap_or_default()
}

/// `dem info`.
///
/// # Errors
/// The file cannot be had or read.
pub fn info(options: &DemInfoOptions) -> Result<(), CliError> {
    let (path, place) = (&options.info.file, StatedPlace::default());
    let about = if path.is_dir() {
        let mosaic = read_folder(path, options.heights, &place)?;
        let note = mosaic.note();
        About::of(mosaic.raster, Some(note))
    } else {
        About::of(read_file(path, options.heights, &place)?, None)
    };
    if options.info.json {
        output::print(&format!("{}\n", about.json()))
    } else {
        output::print(&output::text_of(&about.table()))
    }
}

/// What there is to tell of a raster.
struct About {
    raster: Raster,
    stats: Stats,
    /// Voids that other samples enclose, and samples in them.
    enclosed: (u64, u64),
    notes: Vec<String>,
}

impl About {
    fn of(raster: Raster, joined: Option<String>) -> Self {
        let notes = joined.into_iter().chain(reading(&raster).map(str::to_owned)).collect();
        Self { stats: Stats::new(&raster), enclosed: voids::count(&raster), notes, raster }
    }

    /// One JSON object; numbers that there are not (no valid sample, no such tag) are null.
    fn json(&self) -> serde_json::Value {
        let Self { raster, stats, enclosed: (voids, cells), notes } = self;
        json!({
            "driver": raster.driver,
            "width": raster.width,
            "height": raster.height,
            "type": raster.data_type,
            "crs": raster.crs.as_ref().map(|crs| crs.name()),
            "transform": raster.geotransform(),
            "georeferenced": raster.georeferenced,
            "nodata": nodata(raster.nodata),
            "vertical_datum": raster.vertical_datum,
            "meters_per_z": raster.meters_per_z,
            "valid": stats.valid,
            "enclosed_voids": voids,
            "enclosed_void_samples": cells,
            "min": stats.min,
            "max": stats.max,
            "mean": stats.mean,
            "std": stats.std,
            "notes": notes,
        })
    }

    fn table(&self) -> Vec<String> {
        let Self { raster, stats, enclosed: (voids, cells), notes } = self;
        let affine = raster.map_from_grid;
        let (east, south) = (affine.matrix2.x_axis, affine.matrix2.y_axis);
        let heights = match stats.valid {
            0 => "none".to_owned(),
            _ => format!("{} to {}, mean {}, deviation {}", stats.min, stats.max, stats.mean, stats.std),
        };
        let without = raster.samples.len() - stats.valid;
        let mut lines = vec![
            format!("  driver   {}", raster.driver),
            format!("  size     {} columns, {} rows", raster.width, raster.height),
            format!("  type     {}", raster.data_type),
            format!("  crs      {}", raster.crs.as_ref().map_or("none stated", |crs| crs.name())),
            format!(
                "  corner   ({}, {}), outer corner of the first sample",
                affine.translation.x, affine.translation.y
            ),
            format!("  sample   ({}, {}) a column, ({}, {}) a row", east.x, east.y, south.x, south.y),
            format!(
                "  nodata   {}",
                raster.nodata.map_or("none stated".to_owned(), |value| value.to_string())
            ),
            format!("  valid    {} of {} samples", stats.valid, raster.samples.len()),
            format!("  voids    {without} samples, {cells} of them enclosed, in {voids} voids"),
            format!("  heights  {heights}"),
            format!("  unit     {} m", raster.meters_per_z),
            format!("  datum    {}", raster.vertical_datum.as_deref().unwrap_or("none stated")),
        ];
        lines.extend(notes.iter().map(|note| format!("  note     {note}")));
        lines
    }
}

/// What to know of how a format was read, where readers differ.
fn reading(raster: &Raster) -> Option<&'static str> {
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

/// JSON has no NaN: a no-data value of NaN is the text `"nan"`.
fn nodata(value: Option<f64>) -> serde_json::Value {
    match value {
        Some(value) if value.is_nan() => json!("nan"),
        Some(value) => json!(value),
        None => serde_json::Value::Null,
    }
}
