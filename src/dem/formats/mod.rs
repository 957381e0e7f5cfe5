//! File formats of elevation, a file each.

pub mod ascii;
pub mod bt;
pub mod dted;
pub mod ehdr;
pub mod envi;
pub mod hgt;
pub mod plain;
pub mod png;
pub mod raw;
pub mod rgb_png;
pub mod surfer;
pub mod terragen;
pub mod usgs;
pub mod xyz;
