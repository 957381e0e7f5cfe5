//! The raster as read, in the memory of the ground made of it where both have the same heights.
//!
//! ```text
//! raster: rows from the north     ground: rows from the south
//!   0 1 2 3                         8 9 a b
//!   4 5 6 7     ── turned ──►       4 5 6 7      the rows change places in the one allocation, which both hold
//!   8 9 a b                         0 1 2 3      until the ground is shaped; a raster in their first order
//!                                                is made when samples are read
//! ```
//!
//! A picture reads no sample of the source once it has the ground, so a large model is held once.

use std::sync::{Arc, OnceLock};

use crate::lattice::{Lattice, LatticeError};
use crate::row_order::turn_rows;
use crate::terraces::are_whole;
use sandtable_raster::raster::{Raster, Samples};

/// The raster of a ground as it was read: its samples are held, or those of the ground before anything shaped it.
#[derive(Debug)]
pub struct SourceRaster {
    /// With or without samples.
    header: Arc<Raster>,
    /// All heights, row by row from the south, where they are the samples.
    turned: Option<Arc<Vec<f32>>>,
    raster: OnceLock<Arc<Raster>>,
}

impl From<Arc<Raster>> for SourceRaster {
    fn from(raster: Arc<Raster>) -> Self {
        Self { header: Arc::clone(&raster), turned: None, raster: OnceLock::from(raster) }
    }
}

impl SourceRaster {
    /// The lattice of a north-up raster in meters, and the raster: samples of 32 bits are held once for both.
    ///
    /// # Errors
    /// As [`Lattice::from_raster`].
    pub fn with_lattice(mut raster: Raster) -> Result<(Self, Lattice), LatticeError> {
        let (frame, columns) = (Lattice::frame(&raster)?, raster.width);
        let Samples::F32(heights) = &mut raster.samples else {
            let lattice = Lattice::from_raster(&raster)?;
            return Ok((Self::from(Arc::new(raster)), lattice));
        };
        let mut heights = std::mem::take(heights);
        Lattice::check_memory(raster.width, raster.height)?;
        let header = Arc::new(raster.without_samples());
        turn_rows(&mut heights, columns as usize);
        let lattice = Lattice::new(frame.0, frame.1, columns, heights)?;
        let turned = Some(lattice.shared_heights());
        Ok((Self { header, turned, raster: OnceLock::new() }, lattice))
    }

    /// The raster; its samples may be left out.
    pub fn header(&self) -> &Arc<Raster> {
        &self.header
    }

    /// The raster with its samples, which the first call may have to copy.
    pub fn raster(&self) -> &Arc<Raster> {
        self.raster.get_or_init(|| {
            let mut samples = self.turned.as_deref().cloned().unwrap_or_default();
            turn_rows(&mut samples, self.header.width as usize);
            Arc::new(Raster { samples: Samples::F32(samples), ..self.header.without_samples() })
        })
    }

    /// Whether all samples that are numbers are whole.
    pub fn holds_whole_numbers(&self) -> bool {
        match (&self.turned, &self.header.samples) {
            (Some(samples), _) => are_whole(samples),
            (None, Samples::F32(samples)) => are_whole(samples),
            (None, Samples::F64(samples)) => are_whole(samples),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lattice::Post;
    use glam::DVec2;
    use sandtable_raster::raster::north_up;

    fn raster(samples: Samples) -> Raster {
        Raster::new(3, samples).placed(north_up(DVec2::new(100.0, 900.0), DVec2::new(10.0, 20.0)))
    }

    #[test]
    fn a_raster_that_shares_its_samples_is_the_raster_that_was_read() {
        let heights = [1.0, 2.5, f32::NAN, 4.0, -5.0, 6.0, 7.0, 8.0, 9.0, 10.0, 11.0, 12.0];
        let bits = |samples: &Samples| samples.iter().map(f64::to_bits).collect::<Vec<_>>();
        for count in [6, 9, 12] {
            let narrow = Samples::F32(heights[..count].to_vec());
            let wide = Samples::F64(heights[..count].iter().map(|&height| height.into()).collect());
            for samples in [narrow, wide] {
                let read = raster(samples);
                let (source, lattice) = SourceRaster::with_lattice(read.clone()).expect("north up");
                let plain = Lattice::from_raster(&read).expect("north up");
                let same = |a: &Lattice, b: &Lattice| {
                    a.heights().iter().zip(b.heights()).all(|(a, b)| a.to_bits() == b.to_bits())
                };
                assert!(same(&lattice, &plain) && lattice.map_extent() == plain.map_extent());
                assert_eq!(bits(&source.raster().samples), bits(&read.samples));
                assert_eq!(source.raster().geotransform(), read.geotransform());
                assert_eq!(source.header().grid_size(), read.grid_size());
                assert!(!source.holds_whole_numbers());
            }
        }
    }

    #[test]
    fn ground_that_is_shaped_leaves_the_raster_as_it_was_read() {
        let read = raster(Samples::F32((0..9u8).map(f32::from).collect()));
        let (source, mut lattice) = SourceRaster::with_lattice(read.clone()).expect("north up");
        assert_eq!(
            lattice.heights().as_ptr(),
            lattice.clone().heights().as_ptr(),
            "a clone copies no height"
        );
        lattice.pin(Post { column: 1, row: 1 }, 77.0);
        lattice.heights_mut(Post { column: 0, row: 0 }, 2).fill(-3.0);
        assert_eq!(source.raster().samples, read.samples);
        assert!(source.holds_whole_numbers());
        assert_eq!(lattice.height(Post { column: 1, row: 1 }), 77.0);
    }

    #[test]
    fn a_raster_that_is_no_ground_is_refused() {
        let one = Raster::new(1, Samples::F32(vec![1.0, 2.0]));
        assert_eq!(SourceRaster::with_lattice(one).err(), Some(LatticeError::TooSmall(1, 2)));
        let empty = raster(Samples::F32(vec![f32::NAN; 6]));
        assert_eq!(SourceRaster::with_lattice(empty).err(), Some(LatticeError::Empty));
    }
}
