//! The part of a ground with missing data by which a picture is framed, so that it is filled.
//!
//! A catchment or a coast is a strip aslant in the rectangle of its model: seen whole it leaves most of a picture empty, from
//! every direction. A view of its main part runs past the ends:
//!
//! ```text
//!   ┌──────────────────┐      ┌──────────────────┐
//!   │            ▟███▛ │      │       ▟██████████│
//!   │        ▟█████▛   │  ──► │   ▟██████████████│
//!   │    ▟█████▛       │      │ ▟████████████▛   │
//!   │  ▟███▛           │      │███████████▛      │
//!   └──────────────────┘      └──────────────────┘
//! ```

use glam::Vec3;

use crate::framing::fit::projected;
use crate::framing::fitted_view::{covered_share, fitted_aim, half_picture, lacks_data, silhouette_of};
use crate::paper_sheet::SCREEN_PX;
use crate::scene_model::SceneModel;
use crate::scene_view::FittedView;
use crate::views;
use sandtable_geom::rect::Rect;
use sandtable_terrain::lattice::{Lattice, Post};
use sandtable_view::axes::DirectionAxes;

/// The share of a screen's picture that is filled: two thirds; a picture of a narrower shape is filled less.
const FILLED: f64 = 0.66;

/// The share of the posts with data that is left out on each side, step by step; past the last, more would be cut off than
/// is worth a full picture.
const STEP: f64 = 0.01;
const STEPS: u32 = 15;

/// About as many posts along each side are looked at: some in each cell of a picture that shows a part of them.
const POSTS: u32 = 256;

/// The largest part of a ground with missing data, in world coordinates, that fills a fitted view; `None` where all of it does,
/// or no part.
pub fn main_part(scene: &SceneModel) -> Option<Rect> {
    if !lacks_data(&scene.lattice, None) {
        return None;
    }
    let points = silhouette_of(scene, None, POSTS);
    let is_filled = |shown: Option<Rect>| filled(scene, shown, &points) >= FILLED;
    if is_filled(None) {
        return None;
    }
    (1..=STEPS)
        .map(|step| trimmed(&scene.lattice, f64::from(step) * STEP))
        .find(|part| is_filled(Some(*part)))
}

/// The share of a screen's picture that `points` of all of the ground fill in a view fitted to `shown`.
fn filled(scene: &SceneModel, shown: Option<Rect>, points: &[Vec3]) -> f64 {
    let fov_y_rad = views::fov_y_rad(None);
    let view = FittedView { azimuth_rad: None, pitch_rad: None, shown };
    let (eye, target) = fitted_aim(scene, &view, fov_y_rad, SCREEN_PX);
    let toward = (target - eye).normalize_or_zero();
    let axes = DirectionAxes::new(libm::atan2f(toward.x, toward.y), libm::asinf(-toward.z));
    let seen: Vec<Vec3> =
        points.iter().copied().filter(|point| (*point - eye).dot(axes.forward) > 0.0).collect();
    let half = half_picture(fov_y_rad, SCREEN_PX);
    let within = projected(&seen, &axes, eye).filter(|at| at.abs().cmple(half).all());
    covered_share(within.map(|at| at.as_dvec2()), half)
}

/// The rectangle past each of whose sides `share` of the posts with data lie.
fn trimmed(lattice: &Lattice, share: f64) -> Rect {
    let (columns, rows) = (lattice.columns() as usize, lattice.rows() as usize);
    let mut counts = [vec![0_u64; columns], vec![0_u64; rows]];
    for (index, height) in lattice.heights().iter().enumerate() {
        if !height.is_nan() {
            counts[0][index % columns] += 1;
            counts[1][index / columns] += 1;
        }
    }
    let ends = counts.map(|counts| {
        let past = (counts.iter().sum::<u64>() as f64 * share) as u64;
        let first = |counts: &mut dyn Iterator<Item = &u64>| {
            let sums = counts.scan(0, |sum, count| {
                *sum += count;
                Some(*sum)
            });
            sums.take_while(|sum| *sum <= past).count()
        };
        let low = first(&mut counts.iter());
        let high = counts.len() - 1 - first(&mut counts.iter().rev()).min(counts.len() - 1);
        [low, high.max(low)]
    });
    let [[west, east], [south, north]] = ends;
    let at = |column: usize, row: usize| {
        lattice.position(Post { column: column as u32, row: row as u32 }).as_dvec2()
    };
    Rect {
        min: at(west.min(columns - 1), south.min(rows - 1)),
        max: at(east.min(columns - 1), north.min(rows - 1)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec2;

    #[test]
    fn the_ends_of_a_strip_are_trimmed_and_its_middle_is_kept() {
        let height = |index: u32| {
            let (column, row) = (index % 101, index / 101);
            if column.abs_diff(row) <= 10 { 5.0 } else { f32::NAN }
        };
        let heights = (0..101 * 101).map(height).collect();
        let strip = Lattice::new(DVec2::splat(700.0), DVec2::splat(10.0), 101, heights).expect("sound");
        assert_eq!(trimmed(&strip, 0.0), Rect { min: DVec2::ZERO, max: DVec2::splat(1000.0) });
        let part = trimmed(&strip, 0.1);
        assert_eq!(part.min + part.max, DVec2::splat(1000.0), "{part:?}");
        assert!((100.0..160.0).contains(&part.min.x) && part.min.x == part.min.y, "{part:?}");
    }
}
