//! `sandtable dem`: what is in an elevation file.

use std::path::Path;

use serde_json::json;

use crate::app::arguments::{DemInfoOptions, GreyHeights};
use crate::app::failure::Failure;
use crate::app::{files, output};
use crate::dem::raster::Raster;
use crate::dem::read::{self, Hints};
use crate::dem::stats::{self, Stats};
use crate::geom::crs::Crs;

/// What the caller says of the place of an elevation file that does not say it.
#[derive(Clone, Debug, Default)]
pub struct StatedPlace {
    /// Metres between its posts.
    pub cell: Option<f64>,
    /// Its coordinate system.
    pub crs: Option<Crs>,
}

/// Reads the elevation file at `path`, its sidecars beside it.
///
/// # Errors
/// It cannot be had or read; the message names it.
pub fn read_raster(path: &Path, heights: GreyHeights) -> Result<Raster, Failure> {
    read_raster_placed(path, heights, &StatedPlace::default())
}

/// [`read_raster`] where the caller states the place.
///
/// # Errors
/// As [`read_raster`].
pub fn read_raster_placed(path: &Path, heights: GreyHeights, place: &StatedPlace) -> Result<Raster, Failure> {
    let bytes = files::read(path)?;
    let beside = files::beside(path);
    let hints = Hints {
        png_height_scale: heights.height_scale,
        png_height_offset: heights.height_offset,
        height_encoding: heights.height_encoding,
        raw: heights.raw,
        cell: place.cell,
        crs: place.crs.clone(),
        companions: &beside,
        ..Hints::default()
    };
    let name = path.file_name().map(|name| name.to_string_lossy()).unwrap_or_default();
    read::read(&name, &bytes, &hints)
        .map_err(|error| Failure::input(format!("{}: {}", path.display(), error.fault)))
}

/// `dem info`.
///
/// # Errors
/// The file cannot be had or read.
pub fn info(options: &DemInfoOptions) -> Result<(), Failure> {
    let raster = read_raster(&options.info.file, options.heights)?;
    let stats = stats::of(&raster);
    if options.info.json {
        output::print(&format!("{}\n", describe(&raster, &stats)))
    } else {
        output::print(&table(&raster, &stats))
    }
}

/// One JSON object; numbers that there are not (no valid sample, no such tag) are null.
fn describe(raster: &Raster, stats: &Stats) -> serde_json::Value {
    json!({
        "driver": raster.driver,
        "width": raster.width,
        "height": raster.height,
        "crs": raster.crs.as_ref().map(|crs| crs.name()),
        "transform": raster.geotransform(),
        "nodata": nodata(raster.nodata),
        "valid": stats.valid,
        "min": stats.min,
        "max": stats.max,
        "mean": stats.mean,
        "std": stats.std,
    })
}

/// JSON has no NaN: a no-data value of NaN is the text `"nan"`.
fn nodata(value: Option<f64>) -> serde_json::Value {
    match value {
        Some(value) if value.is_nan() => json!("nan"),
        Some(value) => json!(value),
        None => serde_json::Value::Null,
    }
}

fn table(raster: &Raster, stats: &Stats) -> String {
    let affine = raster.map_from_grid;
    let (east, south) = (affine.matrix2.x_axis, affine.matrix2.y_axis);
    let heights = match stats.valid {
        0 => "none".to_owned(),
        _ => format!("{} to {}, mean {}, deviation {}", stats.min, stats.max, stats.mean, stats.std),
    };
    output::text_of(&[
        format!("  driver   {}", raster.driver),
        format!("  size     {} columns, {} rows", raster.width, raster.height),
        format!("  crs      {}", raster.crs.as_ref().map_or("none stated", |crs| crs.name())),
        format!(
            "  corner   ({}, {}), outer corner of the first sample",
            affine.translation.x, affine.translation.y
        ),
        format!("  sample   ({}, {}) a column, ({}, {}) a row", east.x, east.y, south.x, south.y),
        format!("  nodata   {}", raster.nodata.map_or("none stated".to_owned(), |value| value.to_string())),
        format!("  valid    {} of {} samples", stats.valid, raster.samples.len()),
        format!("  heights  {heights}"),
    ])
}
