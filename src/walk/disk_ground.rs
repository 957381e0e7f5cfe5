//! Exact answers about terrain on disk: the part of it that a question needs is read, and is queried like any lattice.

use std::sync::Arc;

use glam::{DVec2, DVec3};

use sandtable_base::limits::QUERIED_SAMPLES;
use sandtable_geom::rect::Rect;
use sandtable_raster::windows::Windows;
use sandtable_roam::block::BlockFault;
use sandtable_roam::paging::region::read_part;
use sandtable_terrain::lattice::{Lattice, LatticeError, Post};
use sandtable_terrain::post_rect::PostRect;
use sandtable_terrain::sight::ground::SightGround;
use sandtable_terrain::sight::ray::{Ray, RayHit};

/// Posts on each side of where a ray is expected to meet the ground that are read first; then four times and sixteen times
/// as many.
const AROUND: f64 = 64.0;

/// Why terrain on disk has no answer.
#[derive(Debug, thiserror::Error)]
pub enum DiskGroundError {
    /// More than is read for one question.
    #[error(
        "{0} posts lie around this, more than the {QUERIED_SAMPLES} that are read of a file at once; take a shorter line or a smaller outline, or {QUERIED_SAMPLES:#}"
    )]
    TooLarge(u64),
    /// There is no ground.
    #[error("this lies beside the terrain")]
    Outside,
    /// It cannot be read.
    #[error(transparent)]
    Read(#[from] BlockFault),
}

/// Terrain on disk.
pub struct DiskGround<W> {
    windows: W,
    origin: DVec2,
    cell: DVec2,
}

impl<W: Windows> DiskGround<W> {
    /// The terrain of a raster with north up, in meters.
    ///
    /// # Errors
    /// See [`Lattice::frame`].
    pub fn new(windows: W) -> Result<Self, LatticeError> {
        let (origin, cell) = Lattice::frame(windows.metadata())?;
        Ok(Self { windows, origin, cell })
    }

    /// The part of the terrain over a rectangle of map coordinates, with the posts around it.
    ///
    /// # Errors
    /// See [`DiskGroundError`].
    pub fn part(&mut self, rect: &Rect) -> Result<Lattice, DiskGroundError> {
        let (columns, rows) = self.windows.size();
        let far = DVec2::new(f64::from(columns - 1), f64::from(rows - 1));
        let [low, high] = [rect.min, rect.max].map(|at| (at - self.origin) / self.cell);
        if !(low.cmple(far).all() && high.cmpge(DVec2::ZERO).all()) {
            return Err(DiskGroundError::Outside);
        }
        // An even first post keeps the diagonals of the terrain's cells.
        let even = |post: Post| Post { column: post.column & !1, row: post.row & !1 };
        let first = even(Post::at_grid((low.floor() - 2.0).clamp(DVec2::ZERO, far - 1.0)));
        let last = Post::at_grid((high.ceil() + 2.0).clamp(DVec2::ONE, far));
        let count = u64::from(last.column - first.column + 1) * u64::from(last.row - first.row + 1);
        if count > QUERIED_SAMPLES.get() {
            return Err(DiskGroundError::TooLarge(count));
        }
        let rect = PostRect { first, last };
        Ok(read_part(&mut self.windows, (self.origin, self.cell), rect)?)
    }

    /// The point where a ray in world space meets the ground from above, near where it is expected to, and the ground there;
    /// `None` where it meets none.
    ///
    /// # Errors
    /// See [`DiskGroundError`].
    pub fn pick(
        &mut self,
        ray: Ray,
        expected: DVec3,
    ) -> Result<Option<(DVec3, Arc<Lattice>)>, DiskGroundError> {
        let middle = self.origin + expected.truncate();
        for times in [1.0, 4.0, 16.0] {
            let part = self.part(&Rect::around([middle]).grown(AROUND * times * self.cell.max_element()))?;
            let ground = SightGround::new(Arc::new(part));
            // A ray that comes from below has met the ground before it came to this part.
            let from_above = |hit: &RayHit| hit.normal.dot(ray.direction) < 0.0;
            if let Some(hit) = ground.pick(ray, f64::INFINITY).filter(from_above) {
                return Ok(Some((hit.at, Arc::clone(ground.lattice()))));
            }
        }
        Ok(None)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sandtable_raster::error::DemErrorKind;
    use sandtable_raster::raster::{Raster, Samples, north_up_nodes};
    use sandtable_raster::windows::RasterWindow;
    use sandtable_terrain::profile::profile;
    use sandtable_terrain::query::{Interpolation, ground_height};

    fn raster(side: u32) -> Raster {
        let samples = Samples::F32((0..side * side).map(|at| (at * 7919 % 10_007) as f32 * 0.02).collect());
        Raster::new(side, samples).placed(north_up_nodes(DVec2::new(5e5, 4e6), DVec2::splat(10.0)))
    }

    #[test]
    fn parts_answer_as_the_whole_terrain_does_to_the_last_bit() {
        let whole = Lattice::from_raster(&raster(301)).expect("sound");
        let mut disk = DiskGround::new(raster(301)).expect("sound");
        for step in 0..56u16 {
            let at = whole.origin() + DVec2::new(f64::from(step * 53), f64::from(step * 49)) + 0.7;
            let part = disk.part(&Rect::around([at])).expect("inside");
            assert!(part.columns() < 10, "no more is read than is needed");
            let of = |lattice: &Lattice| ground_height(lattice, Interpolation::Planar, at);
            assert_eq!(of(&part), of(&whole), "{at}");
        }
        let line = [whole.origin() + 55.0, whole.origin() + DVec2::new(2_000.0, 333.0)];
        let part = disk.part(&Rect::around(line)).expect("inside");
        let [own, all] = [&part, &whole].map(|lattice| profile(lattice, &line));
        assert_eq!(own.len(), all.len());
        for (own, all) in own.iter().zip(&all) {
            let [own, all] = [own, all].map(|station| station.ground.height_m().expect("ground"));
            assert!((own - all).abs() < 1e-6, "{own} and {all}");
        }
        let beside = whole.origin() - 1e5;
        assert!(matches!(disk.part(&Rect::around([beside])), Err(DiskGroundError::Outside)));
    }

    #[test]
    fn a_ray_meets_the_ground_of_the_file_wherever_it_was_expected_to() {
        let whole = SightGround::new(Arc::new(Lattice::from_raster(&raster(301)).expect("sound")));
        let mut disk = DiskGround::new(raster(301)).expect("sound");
        let ray = Ray { origin: DVec3::new(10.0, 1_000.0, 900.0), direction: DVec3::new(1.0, 0.1, -0.4) };
        let hit = whole.pick(ray, f64::INFINITY).expect("met").at;
        let (at, part) = disk.pick(ray, hit + DVec3::new(900.0, 0.0, 0.0)).expect("read").expect("met");
        assert!(at.distance(hit) < 1e-6, "{at} for {hit}");
        assert!(part.extent().contains(hit.truncate()), "the part of the ground that was met");
        let upward = Ray { direction: DVec3::Z, ..ray };
        assert!(disk.pick(upward, hit).expect("read").is_none());
    }

    #[test]
    fn more_than_is_read_at_once_is_refused_with_the_figure() {
        /// Terrain without samples.
        struct Large(Raster);
        impl Windows for Large {
            fn metadata(&self) -> &Raster {
                &self.0
            }

            fn samples(&mut self, _: RasterWindow) -> Result<Samples, DemErrorKind> {
                unreachable!("nothing is read of what is too large")
            }
        }
        let raster = Raster { width: 50_001, height: 50_001, ..raster(3).without_samples() };
        let mut disk = DiskGround::new(Large(raster)).expect("a frame");
        let (low, high) = (disk.origin, disk.origin + 5e5);
        let error = disk.part(&Rect::around([low, high])).expect_err("too large").to_string();
        assert!(error.contains("2500100001 posts") && error.contains("shorter line"), "{error}");
    }
}
