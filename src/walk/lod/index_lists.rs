//! Writes the index list of a patch from refined vertices, as triangles or as strips.

use std::sync::Arc;

use crate::lod::method::IndexEmitter;
use sandtable_roam::active::ActiveSet;
use sandtable_roam::emit::bintree::VertexBlock;
use sandtable_roam::emit::quadtree;
use sandtable_roam::emit::strips::{Strips, unstrip};
use sandtable_roam::emit::world::drawn_posts;
use sandtable_roam::graph::Vertex;
use sandtable_roam::measured_ground::MeasuredGround;
use sandtable_roam::shown::{LocalTriangle, PatchList, local};

/// The index between two strips of a list, which no vertex has: the primitive restart of graphics adapters.
const RESTART: u16 = u16::MAX;

/// The index list of a patch; one of the two is empty.
#[derive(Clone, Debug, Default)]
pub struct IndexList {
    triangles: Vec<LocalTriangle>,
    strips: Vec<u16>,
}

/// Writes index lists.
pub struct IndexWriter<'a> {
    ground: &'a MeasuredGround,
    emitter: IndexEmitter,
    block: VertexBlock,
    strips: Strips,
}

impl<'a> IndexWriter<'a> {
    /// Writes lists by `emitter`.
    pub fn new(emitter: IndexEmitter, ground: &'a MeasuredGround) -> Self {
        let block =
            VertexBlock::new(ground.layout()).expect("patches of the default size have 16-bit indices");
        Self { ground, emitter, block, strips: Strips::default() }
    }

    /// Writes what is drawn of the patch with south-west corner `corner`; returns the number of indices.
    pub fn write(&mut self, active: &ActiveSet, corner: Vertex, list: &mut IndexList) -> usize {
        list.triangles.clear();
        list.strips.clear();
        match self.emitter {
            IndexEmitter::Bintree => self.write_bintree(active, corner, &mut list.triangles),
            IndexEmitter::Quadtree => {
                let drawn = self.ground.drawn_in(corner);
                quadtree::triangles(active, [corner], |corners| list.triangles.extend(drawn(corners)));
            }
            IndexEmitter::Strips => self.write_strips(active, corner, &mut list.strips),
        }
        3 * list.triangles.len() + list.strips.len()
    }

    fn write_bintree(&self, active: &ActiveSet, corner: Vertex, list: &mut Vec<LocalTriangle>) {
        let (block, ground) = (self.block, self.ground.patched());
        if self.ground.is_whole(corner) {
            block.append(active, corner, |_| true, list);
            return;
        }
        let vertices = |indices: LocalTriangle| indices.map(|index| block.vertex(corner, index));
        block.append(active, corner, |indices| drawn_posts(ground, vertices(indices)).is_some(), list);
    }

    fn write_strips(&mut self, active: &ActiveSet, corner: Vertex, list: &mut Vec<u16>) {
        let drawn = self.ground.drawn_in(corner);
        self.strips.clear();
        self.strips.add_patches(active, [corner], |corners| drawn(corners).is_some());
        for strip in self.strips.iter() {
            if !list.is_empty() {
                list.push(RESTART);
            }
            list.extend(strip.iter().map(|&vertex| local(self.ground.layout(), corner, vertex)));
        }
    }

    /// The triangles of a list.
    pub fn triangles(&self, corner: Vertex, list: &IndexList) -> PatchList {
        let mut triangles = list.triangles.clone();
        for strip in list.strips.split(|&index| index == RESTART) {
            let vertices: Vec<Vertex> = strip.iter().map(|&index| self.block.vertex(corner, index)).collect();
            unstrip(&vertices, |corners| {
                triangles.push(corners.map(|vertex| local(self.ground.layout(), corner, vertex)));
            });
        }
        PatchList::of_triangles(corner, Arc::new(triangles))
    }
}
