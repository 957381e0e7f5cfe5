//! The corners of what lies on the ground, as small as they can be, and each once.
//!
//! Features are cut to the ground's triangles one by one, so that neighboring pieces have corners of their own at the same
//! places. Corners that are equal in all bits become one, which halves what is sent and what is shaded.

use std::sync::LazyLock;

use bytemuck::{Pod, Zeroable, bytes_of};

use crate::merged_vertex::MaterialRow;
use sandtable_draw::color::linear_from_srgb;
use sandtable_draw::list::DrawVertex;

/// A corner in world space: `Draped` in the shader.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct DrapedVertex {
    position: [f32; 3],
    uv: [f32; 2],
    /// Linear, of 65,535: the shader takes no power of it.
    color: [u16; 4],
    /// Of 127.
    normal: [i8; 4],
    material: MaterialRow,
}

/// Triangles of draped features, with each corner once.
#[derive(Debug, Default)]
pub struct DrapedMesh {
    pub vertices: Vec<DrapedVertex>,
    pub indices: Vec<u32>,
    /// The vertices by their hash, each in the first free slot from there on; the length is a power of two, more than
    /// the vertices.
    slots: Vec<u32>,
}

/// A slot without a vertex.
const FREE: u32 = u32::MAX;

impl DrapedVertex {
    pub fn new(corner: &DrawVertex, material: MaterialRow) -> Self {
        let [red, green, blue, alpha] = corner.color.0;
        let linear = |value: u8| LINEAR[usize::from(value)];
        let color = [linear(red), linear(green), linear(blue), u16::from(alpha) * 257];
        let [x, y, z] = corner.normal.map(|part| libm::roundf(part * 127.0) as i8);
        Self { position: corner.position, uv: corner.uv, color, normal: [x, y, z, 0], material }
    }

    /// Its place among `slots`, a power of two.
    fn slot(&self, slots: usize) -> usize {
        // Neighbors differ in the low bits of their places; the golden ratio spreads these over the high ones.
        const SPREAD: u64 = 0x9e37_79b9_7f4a_7c15;
        let mixed =
            |hash: u64, part: f32| (hash ^ u64::from(part.to_bits())).wrapping_mul(SPREAD).rotate_left(29);
        let hash = self.position.into_iter().fold(u64::from(self.material.0), mixed);
        (hash >> 7) as usize & (slots - 1)
    }
}

/// Encoded values as linear ones of 65,535.
static LINEAR: LazyLock<[u16; 256]> = LazyLock::new(|| {
    std::array::from_fn(|value| libm::roundf(linear_from_srgb(value as u8) * 65_535.0) as u16)
});

impl DrapedMesh {
    /// No triangles yet, of at most so many corners.
    pub fn with_corners(most: usize) -> Self {
        let slots = vec![FREE; (most * 2).next_power_of_two().max(2)];
        Self { vertices: Vec::with_capacity(most), indices: Vec::with_capacity(most), slots }
    }

    /// Adds a corner of a triangle.
    pub fn add(&mut self, corner: &DrawVertex, material: MaterialRow) {
        let vertex = DrapedVertex::new(corner, material);
        let mut slot = vertex.slot(self.slots.len());
        let index = loop {
            match self.slots[slot] {
                FREE => {
                    self.slots[slot] = self.vertices.len() as u32;
                    self.vertices.push(vertex);
                    break self.slots[slot];
                }
                held if bytes_of(&self.vertices[held as usize]) == bytes_of(&vertex) => break held,
                _ => slot = (slot + 1) & (self.slots.len() - 1),
            }
        };
        self.indices.push(index);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sandtable_draw::color::Srgba;
    use sandtable_draw::list::MaterialId;

    fn corner(x: f32, y: f32) -> DrawVertex {
        DrawVertex { position: [x, y, 9.0], normal: [0.0, 0.0, 1.0], uv: [x * 0.5, y], color: Srgba::WHITE }
    }

    #[test]
    fn corners_that_neighbors_share_are_one_and_triangles_stay() {
        let material = MaterialRow::from(MaterialId(4));
        let mut mesh = DrapedMesh::with_corners(6 * 900);
        let mut corners = Vec::new();
        for (x, y) in (0..30u8).flat_map(|y| (0..30u8).map(move |x| (f32::from(x), f32::from(y)))) {
            let [sw, se, ne, nw] =
                [corner(x, y), corner(x + 1.0, y), corner(x + 1.0, y + 1.0), corner(x, y + 1.0)];
            corners.extend([sw, se, ne, sw, ne, nw]);
        }
        corners.iter().for_each(|corner| mesh.add(corner, material));
        assert_eq!(mesh.vertices.len(), 31 * 31);
        let added: Vec<[f32; 3]> = corners.iter().map(|corner| corner.position).collect();
        let held: Vec<[f32; 3]> =
            mesh.indices.iter().map(|&index| mesh.vertices[index as usize].position).collect();
        assert_eq!(held, added);
    }

    #[test]
    fn corners_of_other_materials_or_colors_are_others() {
        let mut mesh = DrapedMesh::with_corners(4);
        mesh.add(&corner(0.0, 0.0), MaterialRow::from(MaterialId(0)));
        mesh.add(&corner(0.0, 0.0), MaterialRow::from(MaterialId(1)));
        let faded = DrawVertex { color: Srgba([255, 255, 255, 40]), ..corner(0.0, 0.0) };
        mesh.add(&faded, MaterialRow::from(MaterialId(1)));
        mesh.add(&corner(0.0, 0.0), MaterialRow::from(MaterialId(1)));
        assert_eq!(mesh.indices, [0, 1, 2, 1]);
        assert_eq!(mesh.vertices[2].color, [65_535, 65_535, 65_535, 40 * 257]);
    }
}
