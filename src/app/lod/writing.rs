//! From bits of vertices to the index list of a patch, as triangles or as strips.

use std::sync::Arc;

use crate::app::lod::method::IndexEmitter;
use crate::app::lod::prepared::PreparedGround;
use crate::roam::active::ActiveSet;
use crate::roam::emit::bintree::VertexBlock;
use crate::roam::emit::quadtree;
use crate::roam::emit::strips::{Strips, unstrip};
use crate::roam::emit::world::drawn_posts;
use crate::roam::graph::Vertex;
use crate::roam::shown::{LocalTriangle, PatchList, local};

/// Between two strips of a list stands the index that no vertex has: the primitive restart of graphics adapters.
const RESTART: u16 = u16::MAX;

/// The index list of a patch: one of the two is empty.
#[derive(Clone, Debug, Default)]
pub struct IndexList {
    triangles: Vec<LocalTriangle>,
    strips: Vec<u16>,
}

/// Writes lists one way.
pub struct Writer<'a> {
    terrain: &'a PreparedGround,
    lists: IndexEmitter,
    block: VertexBlock,
    strips: Strips,
}

impl<'a> Writer<'a> {
    /// In the way of `lists`.
    pub fn new(lists: IndexEmitter, terrain: &'a PreparedGround) -> Self {
        let block =
            VertexBlock::new(&terrain.layout).expect("patches of the default size have 16-bit indices");
        Self { terrain, lists, block, strips: Strips::default() }
    }

    /// Writes what is drawn of the patch with south-west corner `corner`; returns how many indices that takes.
    pub fn write(&mut self, active: &ActiveSet, corner: Vertex, list: &mut IndexList) -> usize {
        list.triangles.clear();
        list.strips.clear();
        match self.lists {
            IndexEmitter::Bintree => self.write_bintree(active, corner, &mut list.triangles),
            IndexEmitter::Quadtree => self.write_quadtree(active, corner, &mut list.triangles),
            IndexEmitter::Strips => self.write_strips(active, corner, &mut list.strips),
        }
        3 * list.triangles.len() + list.strips.len()
    }

    fn write_bintree(&self, active: &ActiveSet, corner: Vertex, list: &mut Vec<LocalTriangle>) {
        let (block, ground) = (self.block, self.terrain.ground());
        if self.terrain.is_whole(corner) {
            block.append(active, corner, |_| true, list);
            return;
        }
        let vertices = |indices: LocalTriangle| indices.map(|index| block.vertex(corner, index));
        block.append(active, corner, |indices| drawn_posts(ground, vertices(indices)).is_some(), list);
    }

    fn write_quadtree(&self, active: &ActiveSet, corner: Vertex, list: &mut Vec<LocalTriangle>) {
        let layout = &self.terrain.layout;
        quadtree::triangles(active, [corner], |corners| {
            if self.is_drawn(corner, corners) {
                list.push(corners.map(|vertex| local(layout, corner, vertex)));
            }
        });
    }

    fn write_strips(&mut self, active: &ActiveSet, corner: Vertex, list: &mut Vec<u16>) {
        let layout = &self.terrain.layout;
        let mut strips = std::mem::take(&mut self.strips);
        strips.clear();
        strips.add_patches(active, [corner], |corners| self.is_drawn(corner, corners));
        for strip in strips.iter() {
            if !list.is_empty() {
                list.push(RESTART);
            }
            list.extend(strip.iter().map(|&vertex| local(layout, corner, vertex)));
        }
        self.strips = strips;
    }

    fn is_drawn(&self, corner: Vertex, corners: [Vertex; 3]) -> bool {
        self.terrain.is_whole(corner) || drawn_posts(self.terrain.ground(), corners).is_some()
    }

    /// The triangles of a list.
    pub fn draw(&self, corner: Vertex, list: &IndexList) -> PatchList {
        let mut triangles = list.triangles.clone();
        for strip in list.strips.split(|&index| index == RESTART) {
            let vertices: Vec<Vertex> = strip.iter().map(|&index| self.block.vertex(corner, index)).collect();
            unstrip(&vertices, |corners| {
                triangles.push(corners.map(|vertex| local(&self.terrain.layout, corner, vertex)));
            });
        }
        PatchList::of_triangles(corner, Arc::new(triangles))
    }
}
