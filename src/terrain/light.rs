//! The light that reaches each post past other terrain: shares of the sun and of the sky.
//!
//! Both walk the lattice along lines, at a constant cost per post and direction. The sun's shadow is a sheet swept from
//! post to post away from the sun, sinking with its rays. The sky is measured in eight directions; the horizon in each is
//! the steepest line to a post behind, on the upper convex hull of the profile so far.

use glam::Vec3;
use rayon::prelude::*;

use crate::terrain::lattice::{Lattice, Post};

/// Shares of light per post, row by row from the south-west, each 0..=1.
#[derive(Clone, Debug)]
pub struct TerrainLight {
    /// Of the sun.
    pub sun: Vec<f32>,
    /// Of the sky.
    pub sky: Vec<f32>,
}

/// The height over which the sun emerges at the shadow's edge, as a share of the cell size: smaller shows the lattice as
/// stairs along the edge, larger washes shadows out.
const PENUMBRA_CELLS: f32 = 0.35;

/// The light on a displayed lattice for a sun in direction `to_sun` (unit vector).
pub fn light(lattice: &Lattice, to_sun: Vec3) -> TerrainLight {
    let (sun, sky) = rayon::join(|| sun_visibility(lattice, to_sun), || sky_visibility(lattice));
    TerrainLight { sun, sky }
}

/// Sweeps the shadow sheet row by row along the sun's main direction.
fn sun_visibility(lattice: &Lattice, to_sun: Vec3) -> Vec<f32> {
    let z = lattice.heights();
    let cell = lattice.cell().as_vec2();
    let steps = (to_sun.truncate() / cell).abs();
    let longest = steps.max_element();
    if longest < 1e-6 || to_sun.z <= 0.0 {
        return vec![1.0; z.len()];
    }
    let along_x = steps.x >= steps.y;
    let (columns, rows) = (lattice.columns() as usize, lattice.rows() as usize);
    let (lines, line_length) = if along_x { (columns, rows) } else { (rows, columns) };
    let index = |line: usize, at: usize| if along_x { at * columns + line } else { line * columns + at };
    let toward = if along_x { to_sun.x } else { to_sun.y };
    let aside = if along_x { to_sun.y / cell.y } else { to_sun.x / cell.x } / longest;
    let drop = to_sun.z / longest;
    let penumbra = PENUMBRA_CELLS * cell.max_element();

    let mut visible = vec![1.0; z.len()];
    let mut sheet = vec![f32::NEG_INFINITY; line_length];
    let mut before = sheet.clone();
    for step in 0..lines {
        let line = if toward > 0.0 { lines - 1 - step } else { step };
        std::mem::swap(&mut sheet, &mut before);
        for at in 0..line_length {
            let shadow = between(&before, at as f32 + aside) - drop;
            let here = z[index(line, at)];
            if !here.is_nan() {
                visible[index(line, at)] = ((here - shadow) / penumbra + 0.5).clamp(0.0, 1.0);
            }
            sheet[at] = here.max(shadow);
        }
    }
    visible
}

/// The value at a fractional position, linear between neighbors; −∞ beyond the ends, where nothing casts a shadow.
fn between(values: &[f32], at: f32) -> f32 {
    let low = at.floor();
    let (Some(&from), part) = (values.get(low as isize as usize), at - low) else {
        return f32::NEG_INFINITY;
    };
    match values.get(low as isize as usize + 1) {
        Some(&to) if part > 0.0 && from.is_finite() && to.is_finite() => from + (to - from) * part,
        Some(&to) if part > 0.5 => to,
        _ => from,
    }
}

const DIRECTIONS: [(i64, i64); 8] = [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1)];

/// The mean over eight directions of cos² of the horizon's angle: the share of a uniform sky's light that a
/// level surface receives.
fn sky_visibility(lattice: &Lattice) -> Vec<f32> {
    let by_direction: Vec<Vec<f32>> =
        DIRECTIONS.par_iter().map(|&direction| open_sky(lattice, direction)).collect();
    (0..lattice.heights().len())
        .into_par_iter()
        .map(|post| by_direction.iter().map(|open| open[post]).sum::<f32>() / DIRECTIONS.len() as f32)
        .collect()
}

/// cos² of the horizon's angle at every post, looking back against `direction`.
fn open_sky(lattice: &Lattice, direction: (i64, i64)) -> Vec<f32> {
    let z = lattice.heights();
    let mut open = vec![1.0; z.len()];
    let step =
        libm::hypot(lattice.cell().x * direction.0 as f64, lattice.cell().y * direction.1 as f64) as f32;
    let mut hull: Vec<(f32, f32)> = Vec::new();
    for start in line_starts(lattice, direction) {
        hull.clear();
        let (mut post, mut distance) = (Some(start), 0.0);
        while let Some(here) = post {
            let index = lattice.index(here);
            if z[index].is_finite() {
                open[index] = extend_hull(&mut hull, (distance, z[index]));
            }
            post = neighbor(lattice, here, direction);
            distance += step;
        }
    }
    open
}

/// Adds a profile point to the upper hull; returns cos² of the angle up to the horizon behind it.
fn extend_hull(hull: &mut Vec<(f32, f32)>, here: (f32, f32)) -> f32 {
    let rise_to = |behind: (f32, f32)| (behind.1 - here.1) / (here.0 - behind.0);
    while hull.len() >= 2 && rise_to(hull[hull.len() - 2]) >= rise_to(hull[hull.len() - 1]) {
        hull.pop();
    }
    let rise = hull.last().map_or(0.0, |&behind| rise_to(behind).max(0.0));
    hull.push(here);
    1.0 / (1.0 + rise * rise)
}

/// The posts from which lines in `direction` enter the lattice.
fn line_starts(lattice: &Lattice, direction: (i64, i64)) -> Vec<Post> {
    let back = (-direction.0, -direction.1);
    lattice.posts().filter(|&post| neighbor(lattice, post, back).is_none()).collect()
}

/// The next post in a direction; `None` beyond the lattice.
fn neighbor(lattice: &Lattice, post: Post, direction: (i64, i64)) -> Option<Post> {
    let column = u32::try_from(i64::from(post.column) + direction.0).ok()?;
    let row = u32::try_from(i64::from(post.row) + direction.1).ok()?;
    (column < lattice.columns() && row < lattice.rows()).then_some(Post { column, row })
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec2;

    /// A level plain with a wall of 100 m along column 20.
    fn wall() -> Lattice {
        let heights = (0..41 * 41).map(|index| if index % 41 == 20 { 100.0 } else { 0.0 }).collect();
        Lattice::new(DVec2::ZERO, DVec2::splat(10.0), 41, heights).expect("sound")
    }

    #[test]
    fn a_wall_casts_a_shadow_as_long_as_it_is_high_at_45_degrees() {
        let sun = Vec3::new(-1.0, 0.0, 1.0).normalize();
        let light = light(&wall(), sun);
        let row = 20 * 41;
        assert!(light.sun[row + 25] < 0.01, "50 m behind the wall");
        assert!(light.sun[row + 32] > 0.99, "120 m behind the wall");
        assert!(light.sun[row + 10] > 0.99, "before the wall");
    }

    #[test]
    fn posts_without_data_cast_no_shadow_and_are_fully_lit() {
        let heights = (0..41 * 41).map(|index| if index % 41 == 20 { f32::NAN } else { 3.0 }).collect();
        let holed = Lattice::new(DVec2::ZERO, DVec2::splat(10.0), 41, heights).expect("sound");
        let light = light(&holed, Vec3::new(-0.6, 0.1, 0.5).normalize());
        assert!(light.sun.iter().chain(&light.sky).all(|&share| share == 1.0));
    }

    #[test]
    fn the_foot_of_a_wall_sees_less_sky_than_the_open() {
        let light = light(&wall(), Vec3::Z);
        let row = 20 * 41;
        assert!(light.sky[row + 21] < 0.7);
        assert!(light.sky[row + 20] > 0.99, "the top sees all of it");
        assert!(light.sky[row] > light.sky[row + 19]);
    }
}
