//! Files: read within limits, from disk or by address, and written whole or not at all.
//!
//! ```text
//!  path ─► disk, addressed ─► bytes, or a file to be read in parts
//!  values for a while ─► scratch_file
//!  content ─► part_file ─► output_files ─► one file, or several that appear together (set_record)
//! ```

pub mod addressed;
pub mod csv;
pub mod disk;
pub mod error;
pub mod fingerprint;
pub mod output_files;
pub mod part_file;
mod part_name;
pub mod png;
mod png_filter;
mod png_strips;
pub mod raster_file;
pub mod scratch_file;
mod set_record;
pub mod synced_file;
