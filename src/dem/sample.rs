//! x
use crate::dem::raster::Raster;
use glam::DVec2;
/// x
pub enum Sampled {
    /// x
    Ok(f64),
    /// x
    NoData,
    /// x
    Outside,
}
/// x
pub fn nearest(_: &Raster, _: DVec2) -> Sampled {
    Sampled::Outside
}
/// x
pub fn bilinear(_: &Raster, _: DVec2) -> Sampled {
    Sampled::Outside
}
