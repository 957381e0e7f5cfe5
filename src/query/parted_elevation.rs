//! The ground of elevation that stays on disk, part by part: for a mesh of all of it.

use std::sync::Arc;

use glam::U64Vec2;

use crate::bounded_mesh::{self, MeshError};
use crate::ground::GroundError;
use crate::windowed_elevation::WindowedElevation;
use sandtable_base::limits::RASTER_SAMPLES;
use sandtable_base::limits::memory::check_memory;
use sandtable_geom::crs::Crs;
use sandtable_raster::error::DemErrorKind;
use sandtable_raster::raster::Raster;
use sandtable_raster::windows::WINDOW_CACHE_BYTES;
use sandtable_roam::parts::{PartPlan, PartedGround};
use sandtable_terrain::lattice::{Lattice, LatticeError, Post};
use sandtable_terrain::post_rect::PostRect;

/// Vertices of a part, unless one patch has more: 64 MiB of heights.
const PART_VERTICES: usize = 1 << 24;

/// The memory that a post of a part takes: its height, its pin, and the number of its vertex.
const BYTES_PER_POST: usize = 9;

/// What is held beside a part and the bits of the vertices: samples of the file, and the distances of some rows.
const BYTES_BESIDE: usize = WINDOW_CACHE_BYTES + (32 << 20);

/// The ground of elevation on disk, of which one part is held.
pub struct PartedElevation {
    elevation: WindowedElevation,
    /// The ground with the height of one post.
    frame: Lattice,
    crs: Crs,
    plan: PartPlan,
    range: (f32, f32),
    held: Option<(usize, Arc<Lattice>)>,
}

impl PartedElevation {
    /// Reads all of the elevation once, part by part, for the range of its heights.
    ///
    /// # Errors
    /// The elevation has no ground, cannot be read, has more samples than one file may have, or there is not the memory for a
    /// part.
    pub fn new(elevation: WindowedElevation) -> Result<Self, MeshError> {
        Self::with_parts(elevation, PART_VERTICES)
    }

    /// [`PartedElevation::new`] with parts of at most so many vertices, but at least one patch.
    fn with_parts(elevation: WindowedElevation, vertices: usize) -> Result<Self, MeshError> {
        // What is too large is not looked at.
        checked(elevation.header(), vertices)?;
        let ground = elevation.plan()?.header().without_samples();
        let (frame, crs) = (frame(&ground).map_err(Arc::new)?, elevation.ground_crs()?);
        let plan = checked(&ground, vertices)?;
        let mut parted =
            Self { elevation, frame, crs, plan, range: (f32::INFINITY, f32::NEG_INFINITY), held: None };
        for part in 0..plan.count() {
            let (low, high) = parted.part(part)?.height_range();
            parted.range = (parted.range.0.min(low), parted.range.1.max(high));
        }
        match parted.range.0 <= parted.range.1 {
            true => Ok(parted),
            false => Err(Arc::new(GroundError::from(LatticeError::Empty)).into()),
        }
    }

    /// The raster without its samples.
    pub fn header(&self) -> &Arc<Raster> {
        self.elevation.header()
    }

    /// The ground, of which next to no heights are held.
    pub fn frame(&self) -> &Lattice {
        &self.frame
    }

    /// The system of the ground.
    pub fn crs(&self) -> &Crs {
        &self.crs
    }

    /// The lowest and the highest height, meters.
    pub fn height_range(&self) -> (f32, f32) {
        self.range
    }
}

impl PartedGround for PartedElevation {
    type Error = Arc<GroundError>;

    fn plan(&self) -> PartPlan {
        self.plan
    }

    fn part(&mut self, part: usize) -> Result<Arc<Lattice>, Arc<GroundError>> {
        if let Some((_, lattice)) = self.held.as_ref().filter(|(held, _)| *held == part) {
            return Ok(Arc::clone(lattice));
        }
        // Not both are held.
        self.held = None;
        let lattice = Arc::new(self.elevation.ground_part(self.plan.posts(part))?);
        self.held = Some((part, Arc::clone(&lattice)));
        Ok(lattice)
    }
}

/// The ground with the height of its south-west post alone, which has none.
fn frame(ground: &Raster) -> Result<Lattice, GroundError> {
    let (frame, first) = (Lattice::frame(ground)?, Post { column: 0, row: 0 });
    let held = PostRect { first, last: first };
    Ok(Lattice::held_part(frame, (ground.width, ground.height), held, vec![f32::NAN])?)
}

/// How a raster is divided that may be ground in parts of at most so many vertices.
fn checked(raster: &Raster, vertices: usize) -> Result<PartPlan, MeshError> {
    let size = U64Vec2::new(raster.width.into(), raster.height.into());
    if size.x * size.y > RASTER_SAMPLES.get() {
        let error = DemErrorKind::TooLarge { size, most: &RASTER_SAMPLES };
        return Err(Arc::new(GroundError::from(error)).into());
    }
    if raster.width < 2 || raster.height < 2 {
        let error = LatticeError::TooSmall(raster.width, raster.height);
        return Err(Arc::new(GroundError::from(error)).into());
    }
    let layout = bounded_mesh::layout(raster.width, raster.height)?;
    let plan = PartPlan::of_vertices(layout, vertices);
    let bytes = plan.most_posts() * BYTES_PER_POST + layout.vertex_count() / 8 + BYTES_BESIDE;
    let checked = check_memory(bytes as u64, "the raster", "cut or coarsen it");
    checked.map_err(|error| Arc::new(GroundError::from(LatticeError::from(error))))?;
    Ok(plan)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bounded_mesh::BoundedMesh;
    use crate::ground::MetricGround;
    use glam::DVec2;
    use sandtable_mesh::write::remarks::Remarks;
    use sandtable_mesh::write::{self, MeshFormat};
    use sandtable_raster::raster::{Samples, north_up_nodes};

    /// Ground of 700 × 40 posts, in patches of 128, with holes or without.
    fn raster(hole: u32) -> Raster {
        let height = |at: u32| {
            let (column, row) = ((at % 700) as f32, (at / 700) as f32);
            let is_hole = (hole..hole + 90).contains(&(at % 700)) && (10..17).contains(&(at / 700));
            let rough = (at.wrapping_mul(7919) % 101) as f32 * 0.02;
            if is_hole {
                f32::NAN
            } else {
                300.0 + 20.0 * libm::sinf(column * 0.02) + row * row * 0.01 + rough
            }
        };
        Raster::new(700, Samples::F32((0..700 * 40).map(height).collect()))
            .placed(north_up_nodes(DVec2::new(500_000.0, 4_000_000.0), DVec2::splat(10.0)))
    }

    #[test]
    fn a_mesh_of_parts_has_the_bytes_of_that_of_the_whole() {
        for (hole, max_error_m) in [(90, 0.5), (90, 0.0), (1000, 3.0)] {
            let raster = raster(hole);
            let lattice = MetricGround::from_raster(&raster).expect("metric").lattice;
            let whole = BoundedMesh::new(&Arc::new(lattice), max_error_m).expect("a mesh");
            let parted = PartedElevation::with_parts(WindowedElevation::new(Box::new(raster)), 1);
            let parted = parted.expect("a ground");
            assert_eq!(parted.plan().count(), 6);
            let range = parted.height_range();
            let mut parted = BoundedMesh::of_parts(parted, range, max_error_m).expect("a mesh");
            let (found, expected) = (parted.deviation(), whole.deviation());
            assert_eq!((found.max_m, found.worst), (expected.max_m, expected.worst));
            assert_eq!((found.measured, found.left_out), (expected.measured, expected.left_out));
            let mesh = whole.to_mesh();
            for format in [MeshFormat::Obj, MeshFormat::Ply, MeshFormat::Stl, MeshFormat::Glb] {
                let (mut of_parts, mut of_whole) = (Vec::new(), Vec::new());
                write::write(format, &mut parted, &Remarks::default(), &mut of_parts).expect("memory");
                write::write(format, &mut &mesh, &Remarks::default(), &mut of_whole).expect("memory");
                assert!(of_parts == of_whole, "{format:?} of {} triangles", mesh.triangles.len());
            }
        }
    }

    #[test]
    fn elevation_without_data_or_too_small_has_no_parts() {
        let none = Raster::new(4, Samples::F32(vec![f32::NAN; 16]));
        let line = Raster::new(4, Samples::F32(vec![1.0; 4]));
        for (raster, reason) in [(none, "holds no data"), (line, "4×1 samples")] {
            let raster = raster.placed(north_up_nodes(DVec2::splat(500_000.0), DVec2::ONE));
            let refused =
                PartedElevation::new(WindowedElevation::new(Box::new(raster))).err().expect("refused");
            assert!(refused.to_string().contains(reason), "{refused}");
        }
    }
}
