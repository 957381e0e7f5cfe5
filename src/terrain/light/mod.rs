//! The light that reaches each post past other terrain: shares of the sun and of the sky.
//!
//! Light is computed on reduced lattices of bounded size and read at the full one row by row, so that it is never held
//! for every post. A lattice of 4097 × 4097 posts takes a third of a second on one core and 100 MB at the
//! most, of which 50 MB stay until the light is dropped; larger ones take no more than reading their heights.

use glam::Vec3;

use crate::lattice::Lattice;
use crate::light::field::CoarseField;
use crate::light::sun::SunShadow;

mod field;
mod sky;
mod sun;
pub mod texture;

/// The light on a displayed lattice.
#[derive(Debug)]
pub struct TerrainLight<'a> {
    heights: CoarseField<'a>,
    /// `None` where nothing is in shadow.
    shadow: Option<SunShadow>,
    sky: CoarseField<'static>,
}

impl<'a> TerrainLight<'a> {
    /// The light on a displayed lattice for a sun in direction `to_sun` (unit vector), for pictures that show every
    /// 2^`level`-th post: skylight is no finer. Spread over all threads; the same for any number of them.
    pub fn new(lattice: &'a Lattice, to_sun: Vec3, level: u32) -> Self {
        let heights = CoarseField::of_heights(lattice);
        let (shadow, sky) =
            rayon::join(|| SunShadow::cast(&heights, to_sun), || sky::visibility(&heights, level));
        Self { heights, shadow, sky }
    }

    /// The shares of the sun that reach the posts of a row, each 0..=1; 1 where there is no data.
    ///
    /// # Panics
    /// Where the row lies outside the lattice.
    pub fn sun(&self, row: usize) -> Vec<f32> {
        let heights = self.heights.line(row);
        self.shadow
            .as_ref()
            .map_or_else(|| vec![1.0; heights.len()], |shadow| shadow.visibility(row, heights))
    }

    /// The shares of the sky that are seen from the posts of a row, each 0..=1; 1 where there is no data.
    ///
    /// # Panics
    /// Where the row lies outside the lattice.
    pub fn sky(&self, row: usize) -> Vec<f32> {
        let heights = self.heights.line(row);
        let mut sky = self.sky.finer_row(row, self.sky.every, heights.len());
        for (sky, _) in sky.iter_mut().zip(heights).filter(|(_, height)| height.is_nan()) {
            *sky = 1.0;
        }
        sky
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec2;

    fn lattice([columns, rows]: [u32; 2], cell_m: f64, height: impl Fn(u32, u32) -> f32) -> Lattice {
        let heights = (0..columns * rows).map(|index| height(index % columns, index / columns)).collect();
        Lattice::new(DVec2::ZERO, DVec2::splat(cell_m), columns, heights).expect("sound")
    }

    /// A level plain with a wall of 100 m along column 20.
    fn wall() -> Lattice {
        lattice([41, 41], 10.0, |column, _| if column == 20 { 100.0 } else { 0.0 })
    }

    #[test]
    fn a_wall_casts_a_shadow_as_long_as_it_is_high_at_45_degrees() {
        let sun = Vec3::new(-1.0, 0.0, 1.0).normalize();
        let wall = wall();
        let sun = TerrainLight::new(&wall, sun, 0).sun(20);
        assert!(sun[25] < 0.01, "50 m behind the wall");
        assert!(sun[32] > 0.99, "120 m behind the wall");
        assert!(sun[10] > 0.99, "before the wall");
    }

    #[test]
    fn shadows_are_as_long_in_all_directions_and_on_reduced_lattices() {
        for size in [[301, 301], [2400, 301]] {
            let middle = DVec2::new(f64::from(size[0] / 2), f64::from(size[1] / 2));
            let post = |column: u32, row: u32| DVec2::new(f64::from(column), f64::from(row)) - middle;
            for (east, north) in
                [(1.0, 0.0), (0.6, 0.8), (-0.8, 0.6), (0.0, -1.0), (0.6, -0.8), (-0.96, -0.28)]
            {
                // A wall across the middle, from which the sun shines.
                let toward = DVec2::new(east, north);
                let ground = |column, row| if post(column, row).dot(toward).abs() < 2.0 { 50.0 } else { 0.0 };
                let lattice = lattice(size, 1.0, ground);
                let light = TerrainLight::new(&lattice, toward.as_vec2().extend(0.5).normalize(), 0);
                let share = |behind_m: f64| {
                    let at = middle - behind_m * toward;
                    light.sun(at.y.round() as usize)[at.x.round() as usize]
                };
                assert!(share(90.0) < 0.05, "{toward}: {}", share(90.0));
                assert!(share(110.0) > 0.95, "{toward}: {}", share(110.0));
                assert!(share(-9.0) == 1.0, "{toward}: {}", share(-9.0));
                let edge = share(100.0);
                assert!((0.1..0.9).contains(&edge), "the edge is soft: {edge}");
            }
        }
    }

    #[test]
    fn slopes_less_steep_than_the_sun_are_fully_lit_on_reduced_lattices() {
        for (east, north) in [(0.4, 0.0), (0.0, -0.4), (0.25, 0.3), (-0.3, 0.2)] {
            let slope = lattice([2300, 200], 1.0, |column, row| column as f32 * east + row as f32 * north);
            let away = glam::Vec2::new(-east, -north).normalize();
            let light = TerrainLight::new(&slope, (-away).extend(0.7).normalize(), 0);
            assert!((0..200).all(|row| light.sun(row).iter().all(|&share| share == 1.0)));
        }
    }

    #[test]
    fn level_ground_is_fully_lit_by_the_lowest_sun_and_by_none() {
        let level = lattice([41, 41], 10.0, |_, _| 300.1);
        for altitude in [-0.1, 0.0, 0.005, 0.02, 0.1, 0.3, 1.5, 5.0, 100.0] {
            let light = TerrainLight::new(&level, Vec3::new(0.8, -0.6, altitude).normalize(), 0);
            assert!((0..41).all(|row| light.sun(row).iter().all(|&share| share > 0.99)), "{altitude}");
        }
    }

    #[test]
    fn posts_without_data_cast_no_shadow_and_are_fully_lit() {
        for columns in [41, 2301] {
            let ground = |column, _| if column % 41 == 20 { f32::NAN } else { 3.0 };
            let holed = lattice([columns, 41], 10.0, ground);
            let light = TerrainLight::new(&holed, Vec3::new(-0.6, 0.1, 0.5).normalize(), 0);
            for row in 0..41 {
                assert!(light.sun(row).iter().chain(&light.sky(row)).all(|&share| share == 1.0), "{row}");
            }
        }
    }

    #[test]
    fn the_foot_of_a_wall_sees_less_sky_than_the_open() {
        let wall = wall();
        let sky = TerrainLight::new(&wall, Vec3::Z, 0).sky(20);
        assert!(sky[21] < 0.7);
        assert!(sky[20] > 0.99, "the top sees all of it");
        assert!(sky[0] > sky[19]);
    }

    #[test]
    fn the_sky_over_a_valley_is_the_same_on_reduced_lattices() {
        let valley = |posts_per_cell: u32| {
            let size = [600, 80].map(|cells| cells * posts_per_cell + 1);
            let cell_m = 4.0 / posts_per_cell as f32;
            let height = |column: u32, _| ((column as f32 * cell_m - 1200.0).abs() - 20.0).clamp(0.0, 100.0);
            let lattice = lattice(size, f64::from(cell_m), height);
            let sky = TerrainLight::new(&lattice, Vec3::Z, 0).sky(size[1] as usize / 2);
            [0, 270, 275, 280, 290, 300, 304, 400].map(|cell| sky[cell * posts_per_cell as usize])
        };
        let full = valley(1);
        assert!(full[5] < 0.8 && full[0] > 0.99, "{full:?}");
        for (full, reduced) in full.into_iter().zip(valley(4)) {
            assert!((full - reduced).abs() < 0.02, "{full} and {reduced}");
        }
    }

    /// Rough hills of more posts than the lattices of horizons have.
    fn hills() -> Lattice {
        lattice([1400, 900], 10.0, |column, row| {
            let (x, y) = (column as f32 * 0.05, row as f32 * 0.07);
            let grain = ((column * 7919 + row * 104_729) % 101) as f32;
            200.0 * libm::sinf(x) * libm::cosf(y) + 15.0 * libm::sinf(7.0 * x + 3.0 * y) + 0.003 * grain
        })
    }

    #[test]
    fn one_and_many_threads_light_the_ground_to_the_same_bits() {
        let hills = hills();
        let with = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
            pool.install(|| {
                let light = TerrainLight::new(&hills, Vec3::new(-0.6, 0.5, 0.4).normalize(), 1);
                let rows = (0..900).step_by(50);
                rows.flat_map(|row| light.sun(row).into_iter().chain(light.sky(row))).collect::<Vec<_>>()
            })
        };
        let one = with(1);
        assert!([2, 3, 16].iter().all(|&threads| with(threads) == one));
    }

    #[test]
    fn the_sky_of_a_picture_that_shows_fewer_posts_is_nearly_the_same() {
        let hills = hills();
        let [all, half] = [0, 1].map(|level| TerrainLight::new(&hills, Vec3::Z, level));
        let (mut sum, mut most, mut count) = (0.0f32, 0.0f32, 0);
        for (all, half) in (0..900).step_by(25).flat_map(|row| all.sky(row).into_iter().zip(half.sky(row))) {
            let off = (all - half).abs();
            (sum, most, count) = (sum + off, most.max(off), count + 1);
        }
        assert!(sum / (count as f32) < 0.015 && most < 0.2, "{} and {most}", sum / count as f32);
    }
}
