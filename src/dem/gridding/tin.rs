//! The Delaunay triangulation of the sites as flat lists: the methods read triangles by the hundred thousand, so corners are
//! copied once.

use glam::DVec3;
use spade::Triangulation;

use crate::gridding::breaklines::{self, Crossings};
use crate::gridding::error::GridError;
use crate::gridding::sites::Sites;
use crate::gridding::web::{Constrained, TinVertex, delaunay, load};

pub(super) struct Tin {
    /// Position (from the sites' origin) and height of every vertex.
    pub vertices: Vec<DVec3>,
    /// The corners of every triangle, counter-clockwise.
    pub triangles: Vec<[u32; 3]>,
}

impl Tin {
    /// The triangulation of the sites in which the breaklines, whose vertices are among the sites, are edges.
    pub fn new(sites: &Sites, lines: &[Vec<DVec3>]) -> Result<(Self, Crossings), GridError> {
        if lines.is_empty() {
            return Ok((Self::from_web(&delaunay(sites)?), Crossings::default()));
        }
        let mut constrained: Constrained = load(sites)?;
        let crossings = breaklines::constrain(&mut constrained, sites, lines);
        Ok((Self::from_web(&constrained), crossings))
    }

    /// The triangles of a triangulation of `spade`.
    pub fn from_web<T: Triangulation<Vertex = TinVertex>>(web: &T) -> Self {
        let vertices = web.vertices().map(|vertex| vertex.data().at.extend(vertex.data().z)).collect();
        let triangles =
            web.inner_faces().map(|face| face.vertices().map(|vertex| vertex.fix().index() as u32));
        Self { vertices, triangles: triangles.collect() }
    }

    pub fn corners(&self, triangle: usize) -> [DVec3; 3] {
        self.triangles[triangle].map(|vertex| self.vertices[vertex as usize])
    }
}
