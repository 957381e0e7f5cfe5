//! Squares of one degree between whole meridians and parallels, in which tiles of elevation are cut.

use glam::DVec2;

use sandtable_raster::raster::Raster;

/// How far, in samples, the nodes of a raster may lie from those of the tile that is written.
const OFF_SAMPLES: f64 = 1e-3;

/// The south-west corner, in whole degrees, of the square on whose borders the outermost nodes of an axis-aligned raster
/// lie; `None` where they lie elsewhere.
pub(super) fn degree_corner(raster: &Raster) -> Option<DVec2> {
    let nodes = raster.node_extent();
    let (corner, off) = (nodes.min.round(), raster.spacing() * OFF_SAMPLES);
    let is_degree = (nodes.min - corner).abs().cmple(off).all()
        && (nodes.max - corner - DVec2::ONE).abs().cmple(off).all();
    is_degree.then_some(corner)
}

/// The size of a raster and the place of its nodes, for messages.
pub(super) fn nodes_in_words(raster: &Raster) -> String {
    let (size, nodes) = ((raster.width, raster.height), raster.node_extent());
    format!(
        "{} x {} samples from ({}, {}) to ({}, {})",
        size.0, size.1, nodes.min.x, nodes.min.y, nodes.max.x, nodes.max.y
    )
}
