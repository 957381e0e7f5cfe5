//! Shaded relief in plan: the tint of the height times the light of the cartographer's sun.

use glam::Vec3;
use rayon::prelude::*;

use sandtable_draw::color::Srgba;
use sandtable_draw::ground::ColorRamp;
use sandtable_draw::pixels::Pixels;
use sandtable_terrain::hillshade::{HillshadeOptions, NO_DATA, hillshade};
use sandtable_terrain::lattice::Lattice;

/// The vertical exaggeration of the shading alone: true heights leave most ground too flat to read.
pub const RELIEF: f32 = 2.0;
/// The share of light in full shade.
const AMBIENT: f32 = 0.32;
/// The gray of level ground in the standard light; there the tint is shown unchanged.
const LEVEL: f32 = 180.6;
/// Tints between which no other is taken.
const STEPS: usize = 512;

/// The color of every post in linear light, in the order of [`Lattice::heights`]; `None` without data.
///
/// `relief` is the vertical exaggeration of the shading; `paint` changes the tint of the post with an index before it is
/// shaded. Spread over all threads; the same for any number of them.
pub fn shaded(
    lattice: &Lattice,
    ramp: &ColorRamp,
    relief: f32,
    paint: impl Fn(usize, Vec3) -> Vec3 + Sync,
) -> Vec<Option<Vec3>> {
    let table = ramp.table(STEPS);
    let (low, high) = ramp.height_range();
    let grays = hillshade(&lattice.stretched(relief), &HillshadeOptions::default());
    let color = |(index, (&height, &gray)): (usize, (&f32, &u8))| {
        if height.is_nan() || gray == NO_DATA {
            return None;
        }
        let step = (height - low) / (high - low) * (STEPS - 1) as f32;
        let light = AMBIENT + (1.0 - AMBIENT) * f32::from(gray) / LEVEL;
        Some(paint(index, table[(step as usize).min(STEPS - 1)]) * light)
    };
    lattice.heights().par_iter().zip(&grays).enumerate().map(color).collect()
}

/// The posts of a lattice but those of its border as pixels, north up; transparent without data.
///
/// # Panics
/// Where the lattice has fewer than three columns or rows.
pub fn relief_picture(lattice: &Lattice, ramp: &ColorRamp, relief: f32) -> Pixels {
    let colors = shaded(lattice, ramp, relief, |_, tint| tint);
    let (columns, rows) = (lattice.columns(), lattice.rows());
    Pixels::from_fn(columns - 2, rows - 2, |x, y| {
        let index = (rows - 2 - y) as usize * columns as usize + x as usize + 1;
        colors[index].map_or(Srgba([0; 4]), Srgba::from_linear)
    })
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;

    #[test]
    fn north_is_up_and_what_has_no_data_is_transparent() {
        // It rises to the north-east, but for a hole in the south-west of the inner posts.
        let mut heights: Vec<f32> = (0..30u8).map(|index| f32::from(index % 6 + index / 6)).collect();
        heights[7] = f32::NAN;
        let lattice = Lattice::new(DVec2::ZERO, DVec2::splat(1000.0), 6, heights).expect("sound");
        let ramp = ColorRamp::new(vec![(0.0, Srgba::opaque(0, 0, 0)), (9.0, Srgba::opaque(255, 255, 255))]);
        let picture = relief_picture(&lattice, &ramp.expect("rising"), RELIEF);
        assert_eq!((picture.width(), picture.height()), (4, 3));
        assert_eq!(picture.at(0, 2), Srgba([0; 4]));
        let bright = |x: u32, y: u32| picture.at(x, y).0[0];
        assert!(bright(3, 0) > bright(2, 0) && bright(3, 0) > bright(3, 1) && bright(1, 2) > 0);
    }
}
