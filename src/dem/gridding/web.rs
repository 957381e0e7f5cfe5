//! The Delaunay triangulation of the sites as `spade` holds it: a web of half-edges.
//!
//! `spade` triangulates with exact predicates, which stay right on grids of survey points (all on circles with their
//! neighbors).

use glam::DVec2;
use spade::handles::FixedVertexHandle;
use spade::{ConstrainedDelaunayTriangulation, DelaunayTriangulation, HasPosition, Point2, Triangulation};

use crate::gridding::error::GridError;
use crate::gridding::sites::Sites;

/// In place of a triangle's neighbor: outside of the hull.
pub(super) const OUTSIDE: u32 = u32::MAX;

/// A site as `spade` holds it.
#[derive(Clone, Copy, Debug)]
pub(super) struct TinVertex {
    /// From the sites' origin.
    pub at: DVec2,
    pub z: f64,
    /// The index of its site; `None` for a vertex where breaklines cross.
    pub site: Option<u32>,
}

impl HasPosition for TinVertex {
    type Scalar = f64;

    fn position(&self) -> Point2<f64> {
        Point2::new(self.at.x, self.at.y)
    }
}

/// A triangulation in which breaklines are edges.
pub(super) type Constrained = ConstrainedDelaunayTriangulation<TinVertex>;

/// For each triangle of [`Tin::from_web`](crate::gridding::tin::Tin::from_web), the triangle beyond each side from corner i to i + 1, or [`OUTSIDE`].
pub(super) fn neighbors(web: &DelaunayTriangulation<TinVertex>) -> Vec<[u32; 3]> {
    // Face 0 is the outside of the hull; the inner faces follow.
    let beyond = |index: usize| index.checked_sub(1).map_or(OUTSIDE, |index| index as u32);
    web.inner_faces()
        .map(|face| face.adjacent_edges().map(|edge| beyond(edge.rev().face().fix().index())))
        .collect()
}

/// The triangulation of the sites, without breaklines.
pub(super) fn delaunay(sites: &Sites) -> Result<DelaunayTriangulation<TinVertex>, GridError> {
    load(sites)
}

/// The triangulation of the sites.
pub(super) fn load<T: Triangulation<Vertex = TinVertex>>(sites: &Sites) -> Result<T, GridError> {
    let vertices = sites.at.iter().zip(&sites.z).enumerate();
    let vertices: Vec<TinVertex> =
        vertices.map(|(index, (&at, &z))| TinVertex { at, z, site: Some(index as u32) }).collect();
    let unplaceable = |_| {
        // Offsets from a whole number are far below spade's limit, and zero or far above its smallest number, unless
        // the points themselves are that close to zero.
        let is_tiny = |at: &DVec2| at.abs().cmplt(DVec2::splat(1e-60)).any() && *at != DVec2::ZERO;
        let index = sites.at.iter().position(is_tiny).unwrap_or(0);
        GridError::Unplaceable((sites.at[index] + sites.origin).extend(sites.z[index]))
    };
    let web = T::bulk_load(vertices).map_err(unplaceable)?;
    if web.num_inner_faces() == 0 {
        return Err(GridError::Collinear(sites.len()));
    }
    Ok(web)
}

/// The vertex of every site; `spade` loads them in another order.
pub(super) fn vertex_of_site(web: &Constrained, sites: &Sites) -> Vec<FixedVertexHandle> {
    let mut vertices = vec![FixedVertexHandle::from_index(0); sites.len()];
    for vertex in web.vertices() {
        if let Some(site) = vertex.data().site {
            vertices[site as usize] = vertex.fix();
        }
    }
    vertices
}
