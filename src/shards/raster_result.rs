//! Results of shards that are rasters: GeoTIFF files.

use crate::error::ShardError;
use crate::plan::ShardPlan;
use crate::record::result_path;
use crate::shard::Shard;
use sandtable_dem::dem_format::DemFormat;
use sandtable_dem::write;
use sandtable_dem::written::WriteError;
use sandtable_files::error::FileError;
use sandtable_files::raster_file::WriteRasterError;
use sandtable_raster::raster::Raster;

/// Their extension.
pub const EXTENSION: &str = "tif";

/// The bytes of a shard's raster.
///
/// # Errors
/// The raster cannot be written.
pub fn bytes(plan: &ShardPlan, shard: &Shard, raster: &Raster) -> Result<Vec<u8>, ShardError> {
    let format = DemFormat::to_write(EXTENSION).expect("GeoTIFF is written");
    let written = write::write(raster, format, "").map_err(|error| {
        WriteRasterError::from(FileError::<WriteError>::new(&result_path(plan, shard.id, EXTENSION), error))
    })?;
    Ok(written.bytes)
}
