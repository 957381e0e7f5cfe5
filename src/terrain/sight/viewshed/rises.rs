//! The rise of a target on each post that lets the observer see it, by the same sweep as the viewshed.
//!
//! With `v` of the horizon on a post's ray and `v` of the post, the target must rise by `x · (horizon − v)`: the row
//! `target` of the table in [`rise`](crate::sight::rise), divided by the distance. The horizon holds every crossing of the
//! line but that with the diagonal of the last cell, and its error, times `x`, is that of the rise. Where the error is
//! large, or nothing but a line of sight decides, all crossings of that line are visited.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicU32, Ordering};

use rayon::prelude::*;

use crate::lattice::{Lattice, Post};
use crate::sight::crossings::crossings;
use crate::sight::line::SightLine;
use crate::sight::viewshed::sweep::{NEAR, NEAREST, Sweep, SweepAnswer};
use crate::sight::viewshed::{Observer, ViewshedOptions};
use crate::stop_flag::StopFlag;
use sandtable_raster::answer::Answer;

/// The error that rises may have, meters: a finger's breadth, far below that of any elevation model. Smaller, more posts cost
/// a line each.
pub const RISE_ERROR_M: f64 = 0.01;

/// The error that rises may have, as a share of them, where that is more: the Earth's curve over the cells next to the
/// observer bends the ray by so much.
pub const RISE_ERROR_SHARE: f64 = 1e-4;

/// The rises of targets on all posts that the lattice holds.
#[derive(Clone, Debug, PartialEq)]
pub struct RequiredRises {
    /// Meters, row by row from the south-west, as [`Lattice::held_heights`]: 0 where the target is in sight, NaN without data and
    /// beyond the range and the sector.
    pub rises_m: Vec<f32>,
    /// The number of posts decided by a line of sight rather than by the sweep.
    pub lines: usize,
}

/// The rise of the target on every post that lets the observer see it; `None` where `stop` was set before the end. It says that
/// it did [`SWEEP_UNITS`](super::SWEEP_UNITS), part by part.
///
/// It is above 0 exactly where [`viewshed`](crate::sight::viewshed::viewshed) hides the target, and differs from
/// [`required_rise`](crate::sight::rise::required_rise) by no more than [`RISE_ERROR_M`] or [`RISE_ERROR_SHARE`], whichever is
/// more. Costs some 40 ns a post on one thread, spread over all threads; the answer is the same for any number of them.
///
/// # Errors
/// The ground's answer at the observer, where it has no height there.
pub fn required_rises(
    lattice: &Lattice,
    options: &ViewshedOptions,
    stop: &StopFlag,
) -> Result<Option<RequiredRises>, Answer> {
    let observer = Observer::new(lattice, options)?;
    let nothing = f32::NAN.to_bits();
    let rises: Vec<AtomicU32> =
        (0..lattice.held_heights().len()).into_par_iter().map(|_| AtomicU32::new(nothing)).collect();
    let rise_up_to = |post: Post, part: f64| observer.rise_up_to(post, part);
    let found = RiseTests { rise_up_to: &rise_up_to, rises: &rises };
    let lines = observer.sweep_all(SweepAnswer::Rises(found), stop);
    for post in observer.own_posts().filter(|&post| !lattice.height(post).is_nan()) {
        store(&rises[lattice.index(post)], observer.rise_up_to(post, 1.0));
    }
    if stop.is_stopped() {
        return Ok(None);
    }
    let columns = lattice.held().width();
    let mut rises_m = vec![f32::NAN; rises.len()];
    let rows = rises_m.par_chunks_mut(columns).zip(rises.par_chunks(columns)).enumerate();
    let is_everywhere = observer.looks_everywhere();
    let first = lattice.held().first;
    rows.for_each(|(row, (rises_m, rises))| {
        for (column, (rise_m, rise)) in rises_m.iter_mut().zip(rises).enumerate() {
            if is_everywhere || observer.reaches(first.offset(column as u32, row as u32)) {
                *rise_m = f32::from_bits(rise.load(Ordering::Relaxed));
            }
        }
    });
    Ok(Some(RequiredRises { rises_m, lines }))
}

/// [`required_rises`] by its definition, a line for each post: the reference for tests.
///
/// # Errors
/// As for [`required_rises`].
pub fn required_rises_by_lines(
    lattice: &Lattice,
    options: &ViewshedOptions,
) -> Result<RequiredRises, Answer> {
    let observer = Observer::new(lattice, options)?;
    let rise = |post: Post| match observer.reaches(post) && !lattice.height(post).is_nan() {
        true => stored(observer.rise_up_to(post, 1.0)),
        false => f32::NAN,
    };
    let held = lattice.held();
    let rises_m: Vec<f32> = held.posts().map(rise).collect();
    Ok(RequiredRises { lines: rises_m.len(), rises_m })
}

/// Where the sweep stores rises, and what it falls back on.
#[derive(Clone, Copy)]
pub(super) struct RiseTests<'a> {
    /// The rise that clears the crossings of the line to a post in its first part, 0..=1; −∞ where there are none.
    rise_up_to: &'a (dyn Fn(Post, f64) -> f64 + Sync),
    /// The bits of an f32 for each post held.
    rises: &'a [AtomicU32],
}

/// Stores a rise of a post. Of two, as on the border of two octants, the lesser counts: so the order of threads does not
/// matter. Bits of numbers that are not negative are in their order, NaN after all.
fn store(place: &AtomicU32, rise_m: f64) {
    place.fetch_min(stored(rise_m).to_bits(), Ordering::Relaxed);
}

/// A rise as it is stored: one too small for an f32 still is above 0.
fn stored(rise_m: f64) -> f32 {
    if rise_m > 0.0 { (rise_m as f32).max(f32::MIN_POSITIVE) } else { 0.0 }
}

impl Observer<'_> {
    /// The rise of the target on a post that clears the line's crossings in its first `part`; −∞ where there are none.
    fn rise_up_to(&self, post: Post, part: f64) -> f64 {
        let target_m = f64::from(self.lattice.height(post)) + self.options.target_above_m;
        let length_m = self.options.observer.at.distance(self.lattice.map_position(post));
        let line = SightLine::new(self.eye_m, target_m, length_m, self.options.curvature);
        let mut rise_m = f64::NEG_INFINITY;
        let walk = crossings(self.lattice, self.grid, post.grid(), |crossing| {
            if crossing.part > part {
                return ControlFlow::Break(());
            }
            // The greater number; ground without data requires none.
            rise_m = rise_m.max((crossing.height_m - line.height_m(crossing.part)) / crossing.part);
            ControlFlow::Continue(())
        });
        let (ControlFlow::Break(()) | ControlFlow::Continue(())) = walk;
        rise_m
    }
}

impl Sweep<'_> {
    /// Finds the rises of the ring's posts.
    pub(super) fn find_rises(&mut self, found: RiseTests<'_>) {
        let posts = 0..self.ring.heights.len();
        self.ring.see(posts.clone());
        for index in posts {
            let (u, v) = (self.ring.u[index], self.ring.v[index] + self.scene.target_m / self.ring.x);
            if v.is_nan() || !self.is_inside(u) {
                continue;
            }
            let post = self.frame.post(self.ring.number, self.ring.first + index as i64);
            let known = if self.ring.x <= NEAR { None } else { self.known_rise(index, (u, v), post, found) };
            let rise_m = known.unwrap_or_else(|| {
                self.lines += 1;
                (found.rise_up_to)(post, 1.0)
            });
            store(&found.rises[self.scene.lattice.index(post)], rise_m);
        }
    }

    /// The rise of the target on a post, given by its index on the ring and as it is seen; `None` where only the line of sight
    /// decides.
    fn known_rise(&self, index: usize, (u, v): (f64, f64), post: Post, found: RiseTests<'_>) -> Option<f64> {
        let x = self.ring.x;
        let j = self.ring.first + index as i64;
        let (mut level, mut error) = if self.horizon.is_front(u) {
            (self.before.between(j - 1, u), self.before.edge_error)
        } else {
            self.horizon.level(u, self.scene.margins.across / x)?
        };
        let diagonal = self.far_diagonal(index, u);
        if diagonal > level {
            (level, error) = (diagonal, error.max(self.ring.error));
        } else if diagonal + self.ring.error > level - error {
            error = error.max(self.ring.error);
        }
        let mut rise_m = x * (level - v);
        let error_m = x * (error + self.ring.error);
        if level - error < self.near {
            // Of the ground next to the observer a bound is known alone.
            rise_m = rise_m.max((found.rise_up_to)(post, 2.0 * NEAREST / x));
        }
        if rise_m + error_m < 0.0 && (self.tests.is_clear_of_diagonals)(post) {
            return Some(0.0);
        }
        (rise_m > error_m && error_m <= RISE_ERROR_M.max(RISE_ERROR_SHARE * rise_m)).then_some(rise_m)
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;
    use crate::sight::Curvature;
    use crate::sight::line::SightEnd;
    use crate::sight::rise::{Raised, required_rise};
    use crate::sight::viewshed::{PostVisibility, Sector, viewshed};

    /// Hills that are 40 m high over 90 × 70 posts, with holes.
    fn hills(cell: DVec2) -> Lattice {
        let height = |index: u32| {
            let (x, y) = (f64::from(index % 90), f64::from(index / 90));
            if (index % 90).abs_diff(61) < 2 && (index / 90).abs_diff(20) < 3 || index == 4000 {
                return f32::NAN;
            }
            let rough = f64::from(index.wrapping_mul(2_654_435_761) >> 24) * 0.02;
            (20.0 * libm::sin(x * 0.21) * libm::cos(y * 0.17) + 9.0 * libm::sin(x * 0.53 + y * 0.41) + rough)
                as f32
        };
        Lattice::new(DVec2::new(5e5, 4e6), cell, 90, (0..90 * 70).map(height).collect()).expect("sound")
    }

    fn options(lattice: &Lattice, (column, row): (f64, f64), above_m: f64) -> ViewshedOptions {
        let at = lattice.origin() + DVec2::new(column, row) * lattice.cell();
        ViewshedOptions::new(SightEnd { at, above_m })
    }

    fn found(lattice: &Lattice, options: &ViewshedOptions) -> RequiredRises {
        required_rises(lattice, options, &StopFlag::default()).expect("ground").expect("not stopped")
    }

    #[test]
    fn rises_are_those_of_single_lines_and_above_zero_where_the_viewshed_hides() {
        for cell in [DVec2::splat(25.0), DVec2::new(10.0, 30.0)] {
            let lattice = hills(cell);
            for (at, above_m) in
                [((40.0, 33.0), 2.0), ((12.3, 50.7), 0.0), ((89.0, 0.0), 30.0), ((0.5, 69.0), 5.0)]
            {
                for curvature in [Curvature::default(), Curvature { radius_m: 2e5, refraction: 0.25 }] {
                    let options =
                        ViewshedOptions { curvature, target_above_m: 1.0, ..options(&lattice, at, above_m) };
                    let (rises, view) =
                        (found(&lattice, &options), viewshed(&lattice, &options).expect("ground"));
                    let mut hidden = 0;
                    for (post, &rise_m) in lattice.posts().zip(&rises.rises_m) {
                        let visibility = view.posts[lattice.index(post)];
                        assert_eq!(rise_m.is_nan(), visibility == PostVisibility::NoData, "{post:?}");
                        if rise_m.is_nan() {
                            continue;
                        }
                        assert_eq!(rise_m > 0.0, visibility == PostVisibility::Hidden, "{post:?}: {rise_m}");
                        let target = SightEnd { at: lattice.map_position(post), above_m: 1.0 };
                        let wanted =
                            required_rise(&lattice, options.observer, target, curvature, Raised::Target);
                        let Ok(wanted) = wanted else { continue };
                        let wanted = wanted.map_or(0.0, |rise| rise.rise_m.max(0.0));
                        hidden += usize::from(wanted > 0.0);
                        let slack = RISE_ERROR_M.max(RISE_ERROR_SHARE * wanted);
                        assert!((f64::from(rise_m) - wanted).abs() <= slack, "{post:?}: {rise_m} {wanted}");
                    }
                    assert!(hidden > 1000, "{hidden}");
                    // The strong curve of a small Earth takes more lines.
                    let is_usual = curvature == Curvature::default();
                    assert!(!is_usual || rises.lines < 1000, "{} lines of 6300 posts, {at:?}", rises.lines);
                }
            }
        }
    }

    #[test]
    fn behind_a_wall_the_rise_is_that_of_the_line_over_its_top() {
        let heights = (0..81 * 81u32).map(|index| if index % 81 == 20 { 10.0 } else { 0.0 }).collect();
        let lattice = Lattice::new(DVec2::ZERO, DVec2::splat(10.0), 81, heights).expect("sound");
        let options = ViewshedOptions { curvature: Curvature::FLAT, ..options(&lattice, (0.0, 40.0), 5.0) };
        let rises = found(&lattice, &options).rises_m;
        // From 5 m over 10 m at 200 m: the line rises by 1 in 40.
        for (column, row) in [(30, 40), (60, 40), (80, 40), (60, 7), (80, 80), (45, 52)] {
            let wanted = 5.0 + f64::from(column) * 10.0 / 40.0;
            let rise_m = f64::from(rises[row * 81 + column as usize]);
            assert!((rise_m - wanted).abs() < 1e-4, "{column} {row}: {rise_m} {wanted}");
        }
        assert_eq!(rises[40 * 81 + 20], 0.0, "the wall's face is in sight");
    }

    #[test]
    fn beyond_the_range_and_the_sector_there_is_no_rise() {
        let lattice = hills(DVec2::splat(10.0));
        let sector = Sector::between(30.0, 140.0);
        let options = ViewshedOptions { range_m: 300.0, sector, ..options(&lattice, (40.0, 33.0), 2.0) };
        let (rises, view) = (found(&lattice, &options), viewshed(&lattice, &options).expect("ground"));
        for (rise_m, &visibility) in rises.rises_m.iter().zip(&view.posts) {
            let is_known = matches!(visibility, PostVisibility::Visible | PostVisibility::Hidden);
            assert_eq!(!rise_m.is_nan(), is_known);
            assert_eq!(*rise_m > 0.0, visibility == PostVisibility::Hidden);
        }
    }

    #[test]
    fn any_number_of_threads_gives_the_same_bits() {
        let lattice = hills(DVec2::splat(25.0));
        let options = options(&lattice, (40.0, 33.0), 2.0);
        let bits = |threads: usize| -> Vec<u32> {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
            pool.install(|| found(&lattice, &options)).rises_m.into_iter().map(f32::to_bits).collect()
        };
        assert_eq!(bits(1), bits(5));
    }
}
