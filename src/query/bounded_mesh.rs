//! A mesh of the ground with a verified error bound.
//!
//! The bound is not taken on trust from the arithmetic that chose the triangles: the mesh is measured in f64 at every
//! post, and refined further where rounding broke the bound. With every post a vertex there is no error left, so the
//! refinement ends.
//!
//! What is kept of the mesh is a bit a vertex. Vertices and triangles are made from the bits whenever they are read, part by
//! part of the ground, so that neither all heights nor all triangles are in memory.

use std::convert::Infallible;
use std::io;
use std::ops::ControlFlow;
use std::sync::Arc;

use glam::Vec3;

use crate::ground::GroundError;
use sandtable_geom::aabb::Aabb;
use sandtable_mesh::sink::VertexId;
use sandtable_mesh::source::{MeshSize, MeshSource};
use sandtable_mesh::trimesh::TriMesh;
use sandtable_roam::active::ActiveSet;
use sandtable_roam::bound::Deviation;
use sandtable_roam::closure::least_closure_of_parts;
use sandtable_roam::emit::part::{NumberedTriangle, PartEmitter};
use sandtable_roam::layout::PatchLayout;
use sandtable_roam::part_bound::PartDistances;
use sandtable_roam::parts::{HeldGround, PartedGround};
use sandtable_terrain::lattice::{Lattice, Post};

/// The side of the largest patch in cells: flat ground needs fewer triangles in larger patches.
const LARGEST_PATCH: u32 = 4096;

/// The rounding error of f32 distances, as a share of the relief.
const ROUNDING: f64 = 1e-6;

/// A tolerance that no triangle keeps.
const KEEP_EVERY_POST: f64 = -1.0;

/// A mesh and its measured distance from the ground. Positions are in world space: meters from the south-west post, Z up.
pub struct BoundedMesh<G> {
    ground: G,
    active: ActiveSet,
    size: MeshSize,
    deviation: Deviation,
    /// Whether every post has data: triangles then follow from the bits alone.
    is_whole: bool,
    /// Why the ground could not be read again.
    fault: Option<MeshError>,
}

/// Ground that gives no mesh.
#[derive(Debug, thiserror::Error)]
pub enum MeshError {
    /// The ground has too many posts.
    #[error("{columns} x {rows} posts are more than one mesh can be made of; cut it into parts")]
    TooLarge {
        /// Posts per row.
        columns: u32,
        /// Rows.
        rows: u32,
    },
    /// No three posts of a cell have data.
    #[error("nowhere do three posts of one cell have data, so there is no triangle to write")]
    Empty,
    /// A triangle covers a post that has no data.
    #[error("a triangle of the mesh covers column {column}, row {row}, which has no data")]
    OverHole {
        /// Counted eastward.
        column: u32,
        /// Counted northward.
        row: u32,
    },
    /// The ground cannot be read.
    #[error(transparent)]
    Ground(#[from] Arc<GroundError>),
}

impl From<Infallible> for MeshError {
    fn from(never: Infallible) -> Self {
        match never {}
    }
}

impl BoundedMesh<HeldGround> {
    /// The mesh of `lattice` with the fewest triangles that is off by at most `max_error_m` at every post.
    ///
    /// # Errors
    /// See [`MeshError`].
    pub fn new(lattice: &Arc<Lattice>, max_error_m: f64) -> Result<Self, MeshError> {
        let layout = layout(lattice.columns(), lattice.rows())?;
        Self::of_parts(HeldGround::new(lattice, layout), lattice.height_range(), max_error_m)
    }

    /// The mesh in memory.
    pub fn to_mesh(&self) -> TriMesh {
        let mut mesh = TriMesh::default();
        let lattice = self.ground.lattice();
        let mut emitter = PartEmitter::new(&self.active, self.ground.plan());
        let _: ControlFlow<Infallible> = emitter.emit(
            0,
            |post| has_data(lattice, post),
            |triangle| {
                mesh.positions.extend(triangle.first_posts().map(|post| position(lattice, post)));
                mesh.triangles.push(triangle.ids);
                ControlFlow::Continue(())
            },
        );
        mesh
    }
}

impl<G: PartedGround> BoundedMesh<G>
where
    MeshError: From<G::Error>,
{
    /// The mesh of ground whose heights are from `low` to `high` meters, with the fewest triangles that is off by at most
    /// `max_error_m` at every post.
    ///
    /// # Errors
    /// See [`MeshError`].
    pub fn of_parts(ground: G, (low, high): (f32, f32), max_error_m: f64) -> Result<Self, MeshError> {
        let slack_m = (f64::from(high) - f64::from(low)) * ROUNDING;
        let reduced = |slack_m: f64| (max_error_m - slack_m).max(0.0);
        let mut bounded = Self::with_tolerance(ground, reduced(slack_m))?;
        for tolerance_m in [reduced(16.0 * slack_m), KEEP_EVERY_POST] {
            if bounded.deviation.max_m > max_error_m {
                bounded = Self::with_tolerance(bounded.ground, tolerance_m)?;
            }
        }
        if bounded.size.triangles == 0 { Err(MeshError::Empty) } else { Ok(bounded) }
    }

    fn with_tolerance(mut ground: G, tolerance_m: f64) -> Result<Self, MeshError> {
        let plan = ground.plan();
        let active = least_closure_of_parts(&mut ground, tolerance_m.min(f64::from(f32::MAX)) as f32)?;
        let (mut emitter, mut distances) =
            (PartEmitter::new(&active, plan), PartDistances::new(&active, plan));
        let mut size = MeshSize::default();
        let (mut min, mut max) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        for part in 0..plan.count() {
            let lattice = ground.part(part)?;
            let _: ControlFlow<Infallible> = emitter.emit(
                part,
                |post| has_data(&lattice, post),
                |triangle| {
                    for at in triangle.first_posts().map(|post| position(&lattice, post)) {
                        (min, max) = (min.min(at), max.max(at));
                        size.vertices += 1;
                    }
                    size.triangles += 1;
                    ControlFlow::Continue(())
                },
            );
            distances.add(part, &lattice);
        }
        if size.triangles > 0 {
            size.bounds = Aabb { min, max };
        }
        let deviation =
            distances.deviation().map_err(|Post { column, row }| MeshError::OverHole { column, row })?;
        let posts = plan.layout().posts();
        let is_whole = (deviation.measured + deviation.left_out) as u64 == posts;
        Ok(Self { ground, active, size, deviation, is_whole, fault: None })
    }

    /// Vertical distances at the posts.
    pub fn deviation(&self) -> &Deviation {
        &self.deviation
    }

    /// Why the ground could not be read again, where that ended a pass over the mesh.
    pub fn take_fault(&mut self) -> Option<MeshError> {
        self.fault.take()
    }

    /// Calls `each` with all triangles and the ground under them.
    fn each_on_ground(
        &mut self,
        mut each: impl FnMut(&Lattice, &NumberedTriangle) -> io::Result<()>,
    ) -> io::Result<()> {
        let plan = self.ground.plan();
        let mut emitter = PartEmitter::new(&self.active, plan);
        for part in 0..plan.count() {
            let lattice = self.ground.part(part).map_err(|error| {
                self.fault = Some(error.into());
                io::Error::other("the ground cannot be read again")
            })?;
            emit(&mut emitter, part, |post| has_data(&lattice, post), |triangle| each(&lattice, triangle))?;
        }
        Ok(())
    }
}

impl<G: PartedGround> MeshSource for BoundedMesh<G>
where
    MeshError: From<G::Error>,
{
    fn size(&self) -> MeshSize {
        self.size
    }

    fn each_vertex(&mut self, each: &mut dyn FnMut(Vec3) -> io::Result<()>) -> io::Result<()> {
        self.each_on_ground(|lattice, triangle| {
            triangle.first_posts().try_for_each(|post| each(position(lattice, post)))
        })
    }

    fn each_triangle(&mut self, each: &mut dyn FnMut([VertexId; 3]) -> io::Result<()>) -> io::Result<()> {
        if !self.is_whole {
            return self.each_on_ground(|_, triangle| each(triangle.ids));
        }
        let plan = self.ground.plan();
        let mut emitter = PartEmitter::new(&self.active, plan);
        (0..plan.count())
            .try_for_each(|part| emit(&mut emitter, part, |_| true, |triangle| each(triangle.ids)))
    }

    fn each_facet(&mut self, each: &mut dyn FnMut([Vec3; 3]) -> io::Result<()>) -> io::Result<()> {
        self.each_on_ground(|lattice, triangle| each(triangle.posts.map(|post| position(lattice, post))))
    }
}

/// Calls `each` with the triangles of the next part.
fn emit(
    emitter: &mut PartEmitter<'_>,
    part: usize,
    has_data: impl Fn(Post) -> bool,
    mut each: impl FnMut(&NumberedTriangle) -> io::Result<()>,
) -> io::Result<()> {
    let emitted = emitter.emit(part, has_data, |triangle| match each(triangle) {
        Ok(()) => ControlFlow::Continue(()),
        Err(error) => ControlFlow::Break(error),
    });
    match emitted {
        ControlFlow::Continue(()) => Ok(()),
        ControlFlow::Break(error) => Err(error),
    }
}

fn has_data(lattice: &Lattice, post: Post) -> bool {
    !lattice.height(post).is_nan()
}

/// The world position of a post with data, meters.
fn position(lattice: &Lattice, post: Post) -> Vec3 {
    lattice.position(post).extend(lattice.height(post))
}

/// One patch over everything, or as few as possible.
///
/// # Errors
/// [`MeshError::TooLarge`].
pub fn layout(columns: u32, rows: u32) -> Result<PatchLayout, MeshError> {
    let whole = (columns.max(rows) - 1).next_power_of_two().clamp(2, LARGEST_PATCH);
    // Most vertices of such a patch over a long and narrow terrain would lie beyond its border.
    let narrow = 2 * (columns.min(rows) - 1).next_power_of_two().max(2);
    let largest = whole.min(narrow).ilog2();
    let layout = (1..=largest).rev().find_map(|log| PatchLayout::new(columns, rows, 1 << log));
    layout.ok_or(MeshError::TooLarge { columns, rows })
}
