//! Hillshading: how directly the ground faces the sun, as a gray for each post.
//!
//! With the slopes `p` east and `q` north of [`Lattice::slopes`] (Horn 1981), the gray is
//! `1 + 254 · max(0, n · s)`, where `n` is the upward unit normal of the slopes and `s` the direction to the sun: what
//! `gdaldem hillshade` draws, equal to it within one gray level. 0 means no data.
//!
//! A neighbor without data or beyond the border takes the post's own height, so that every post with data has a gray;
//! `gdaldem` leaves a frame of one post and the posts around holes empty by default, and continues the slope with
//! `-compute_edges`.
//!
//! The loop over the inner posts of a row is written for the compiler to vectorize; posts beside the border or a hole are
//! computed one by one.

use rayon::prelude::*;

use crate::lattice::{Lattice, Post};

/// The direction of the sun.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HillshadeOptions {
    /// The sun's azimuth, degrees clockwise from north.
    pub azimuth_deg: f64,
    /// The sun's altitude above the horizon, degrees, 0..=90.
    pub altitude_deg: f64,
}

impl Default for HillshadeOptions {
    /// The cartographer's light: from the north-west, 45° high.
    fn default() -> Self {
        Self { azimuth_deg: 315.0, altitude_deg: 45.0 }
    }
}

/// The gray of posts without data.
pub const NO_DATA: u8 = 0;

/// The gray of every post, row by row from the south-west as [`Lattice::heights`]: 1 facing away from the sun, 255
/// facing it, [`NO_DATA`] without data. Spread over all threads; the same for any number of them.
pub fn hillshade(lattice: &Lattice, options: &HillshadeOptions) -> Vec<u8> {
    let sun = Sun::new(options);
    let columns = lattice.columns() as usize;
    let mut grays = vec![NO_DATA; lattice.heights().len()];
    grays.par_chunks_mut(columns).enumerate().for_each_init(
        || vec![f32::NAN; columns],
        |light, (row, grays)| shade_row(lattice, &sun, row, light, grays),
    );
    grays
}

/// The direction to the sun.
struct Sun {
    east: f32,
    north: f32,
    up: f32,
}

impl Sun {
    fn new(options: &HillshadeOptions) -> Self {
        let (azimuth, altitude) = (options.azimuth_deg.to_radians(), options.altitude_deg.to_radians());
        let level = libm::cos(altitude);
        Self {
            east: (level * libm::sin(azimuth)) as f32,
            north: (level * libm::cos(azimuth)) as f32,
            up: libm::sin(altitude) as f32,
        }
    }

    /// `254 · n · s` for slopes, negative where the ground faces away.
    fn light(&self, east: f32, north: f32) -> f32 {
        let facing = self.up - east * self.east - north * self.north;
        254.0 * facing / (1.0 + east * east + north * north).sqrt()
    }
}

/// 1..=255; NaN counts as facing away.
fn gray(light: f32) -> u8 {
    (1.5 + light.max(0.0)) as u8
}

fn shade_row(lattice: &Lattice, sun: &Sun, row: usize, light: &mut [f32], grays: &mut [u8]) {
    let columns = grays.len();
    let heights = lattice.heights();
    let own = &heights[row * columns..][..columns];
    let has_inside = row > 0 && row + 1 < lattice.rows() as usize && columns > 2;
    if has_inside {
        let (south, north) =
            (&heights[(row - 1) * columns..][..columns], &heights[(row + 1) * columns..][..columns]);
        let cell = lattice.cell();
        let (per_east, per_north) = (1.0 / (8.0 * cell.x as f32), 1.0 / (8.0 * cell.y as f32));
        let windows = south.windows(3).zip(own.windows(3)).zip(north.windows(3));
        for (((south, own), north), light) in windows.zip(&mut light[1..]) {
            let east = (north[2] - north[0]) + 2.0 * (own[2] - own[0]) + (south[2] - south[0]);
            let up = (north[0] - south[0]) + 2.0 * (north[1] - south[1]) + (north[2] - south[2]);
            *light = sun.light(east * per_east, up * per_north);
        }
        for (gray_out, light) in grays.iter_mut().zip(light.iter()) {
            *gray_out = gray(*light);
        }
    }
    for (column, gray_out) in grays.iter_mut().enumerate() {
        if own[column].is_nan() {
            *gray_out = NO_DATA;
        } else if !has_inside || column == 0 || column + 1 == columns || light[column].is_nan() {
            let post = Post { column: column as u32, row: row as u32 };
            let slopes = lattice.slopes(post);
            *gray_out = gray(sun.light(slopes.x, slopes.y));
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;

    fn plane(east: f32, north: f32) -> Lattice {
        let heights =
            (0..63).map(|index| (index % 9) as f32 * 10.0 * east + (index / 9) as f32 * 20.0 * north);
        Lattice::new(DVec2::ZERO, DVec2::new(10.0, 20.0), 9, heights.collect()).expect("sound")
    }

    #[test]
    fn a_plane_is_one_gray_and_brightest_where_it_faces_the_sun() {
        let options = HillshadeOptions::default();
        let gray = |east, north| {
            let grays = hillshade(&plane(east, north), &options);
            assert!(grays.iter().all(|&gray| gray == grays[0]), "{grays:?}");
            grays[0]
        };
        // sin 45° of 254, and one
        assert_eq!(gray(0.0, 0.0), 181);
        let facing = 0.5f32.sqrt();
        assert_eq!(gray(facing, -facing), 255, "rising south-east, it faces north-west");
        assert_eq!(gray(-3.0, 3.0), 1, "it faces away");
    }

    #[test]
    fn only_posts_without_data_are_without_a_gray() {
        let mut heights = vec![5.0; 63];
        (heights[0], heights[31]) = (f32::NAN, f32::NAN);
        let holed = Lattice::new(DVec2::ZERO, DVec2::ONE, 9, heights).expect("sound");
        let grays = hillshade(&holed, &HillshadeOptions::default());
        let empty: Vec<usize> = (0..63).filter(|&index| grays[index] == NO_DATA).collect();
        assert_eq!(empty, [0, 31]);
    }

    #[test]
    fn a_row_and_its_single_posts_agree() {
        let heights = (0..400).map(|index: u32| ((index * 7919) % 101) as f32).collect();
        let rough = Lattice::new(DVec2::ZERO, DVec2::new(30.0, 20.0), 20, heights).expect("sound");
        let sun = Sun::new(&HillshadeOptions::default());
        let grays = hillshade(&rough, &HillshadeOptions::default());
        for post in rough.posts() {
            let slopes = rough.slopes(post);
            let alone = gray(sun.light(slopes.x, slopes.y));
            assert!(alone.abs_diff(grays[rough.index(post)]) <= 1, "{post:?}");
        }
    }
}
