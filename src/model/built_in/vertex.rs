//! A vertex with a color and no texture.

use glam::Vec3;

use sandtable_draw::color::Srgba;
use sandtable_draw::list::DrawVertex;

/// A vertex without texture coordinates.
pub(super) fn colored_vertex(position: Vec3, normal: Vec3, color: Srgba) -> DrawVertex {
    DrawVertex { position: position.to_array(), normal: normal.to_array(), uv: [0.0; 2], color }
}
