//! Viewsheds: the posts that can be seen from one point.
//!
//! The definition is one line of sight for each post (`Observer::sees`). The implementation is a `sweep` outward through
//! wedges of the circle, which compares each post with the `horizon` of the ground before it and computes the line of
//! sight only where the two are too close to decide. Both give the same answer on every post.
//!
//! Other programs are fast at the price of the answer: propagating one reference plane or one interpolated slope from ring
//! to ring (Wang, Robinson and White 2000; XDraw, Franklin 1994) misses every tenth visible post, and a plane sweep over
//! cells (Van Kreveld 1996) takes cells for flat. Here the ground is the triangles of the
//! [lattice](crate::lattice), as everywhere.
//!
//! Where a lattice holds only some of its posts, these are the posts that are looked at; they must reach as far as the range,
//! or to the lattice's border.

mod bucket;
mod frame;
mod horizon;
mod near;
mod ring;
pub mod rises;
mod sector;
mod step;
mod sweep;

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use glam::DVec2;
use rayon::prelude::*;

use crate::lattice::{Lattice, Post};
use crate::query::{Interpolation, ground_height};
use crate::sight::Curvature;
use crate::sight::crossings::crossings;
use crate::sight::line::{SightEnd, SightLine};
use crate::sight::viewshed::frame::OctantFrame;
use crate::sight::viewshed::sweep::{Margins, PostTests, SweepAnswer, SweepScene, sweep};
use crate::stop_flag::StopFlag;
use sandtable_raster::answer::Answer;

/// The parameters of a viewshed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ViewshedOptions {
    /// The observer.
    pub observer: SightEnd,
    /// Height of the target above the ground at every post, meters.
    pub target_above_m: f64,
    /// Posts farther away than this many meters in plan are not considered; infinite for all.
    pub range_m: f64,
    /// Posts in other directions are not considered.
    pub sector: Sector,
    /// The Earth's curvature and refraction.
    pub curvature: Curvature,
}

impl ViewshedOptions {
    /// Targets on the ground in all directions at any distance, on the curved Earth with the usual refraction.
    pub fn new(observer: SightEnd) -> Self {
        Self {
            observer,
            target_above_m: 0.0,
            range_m: f64::INFINITY,
            sector: Sector::ALL,
            curvature: Curvature::default(),
        }
    }
}

/// Directions, as azimuths clockwise from north in degrees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sector {
    /// Where it begins, 0..360.
    pub from_deg: f64,
    /// How far it turns clockwise from there, above 0 and up to 360.
    pub width_deg: f64,
}

/// The visibility of a post.
#[derive(Clone, Copy, Debug, PartialEq, Eq, bytemuck::Zeroable)]
#[repr(u8)]
pub enum PostVisibility {
    /// Beyond the range or out of the sector.
    Beyond = 0,
    /// There is no data.
    NoData,
    /// Terrain blocks the line of sight.
    Hidden,
    /// In sight.
    Visible,
}

/// The visibility of all posts that the lattice holds.
#[derive(Clone, Debug, PartialEq)]
pub struct Viewshed {
    /// Held posts per row.
    pub columns: u32,
    /// Rows of held posts.
    pub rows: u32,
    /// Row by row from the south-west, as [`Lattice::held_heights`].
    pub posts: Vec<PostVisibility>,
    /// The number of posts decided by a line of sight rather than by the sweep: a measure of the work, not part of the
    /// answer.
    pub lines: usize,
}

/// The number of posts of each kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
pub struct ViewshedCounts {
    /// In sight.
    pub visible: usize,
    /// Behind terrain.
    pub hidden: usize,
    /// Without data.
    pub no_data: usize,
    /// Beyond the range or out of the sector.
    pub beyond: usize,
}

/// Posts that a thread looks at together: some microseconds.
const LOOKED_AT_TOGETHER: usize = 1 << 16;

impl Viewshed {
    /// The number of posts of each kind.
    pub fn counts(&self) -> ViewshedCounts {
        /// Posts of which a byte holds the number: many bytes are added up at once.
        const BYTE: usize = 128;
        // Kind by kind: a loop that counts all of them at once waits for its own sums.
        let count = |posts: &[PostVisibility], kind: PostVisibility| -> usize {
            let few = |few: &[PostVisibility]| few.iter().map(|&post| u8::from(post == kind)).sum::<u8>();
            posts.chunks(BYTE).map(|posts| usize::from(few(posts))).sum()
        };
        let counts = |posts: &[PostVisibility]| {
            let kinds = [PostVisibility::Visible, PostVisibility::Hidden, PostVisibility::NoData];
            kinds.map(|kind| count(posts, kind))
        };
        let all = self.posts.par_chunks(LOOKED_AT_TOGETHER).map(counts);
        let [visible, hidden, no_data] =
            all.reduce(|| [0; 3], |one, other| std::array::from_fn(|kind| one[kind] + other[kind]));
        ViewshedCounts { visible, hidden, no_data, beyond: self.posts.len() - visible - hidden - no_data }
    }
}

/// The viewshed of an observer: a post is [`PostVisibility::Visible`] exactly where the line of sight to a target on it is
/// clear, as [`line_of_sight`](crate::sight::line::line_of_sight) defines it. Targets stand on the posts
/// themselves: their columns and rows are whole numbers, whatever the rounding of their map coordinates.
///
/// Costs some 15 ns a post on one thread where most is hidden and up to 200 where most is visible, spread over all
/// threads; the answer is the same for any number of them. Ground that is one plane seen along itself is all ties, and
/// costs a line for each post.
///
/// # Errors
/// The ground's answer at the observer, where it has no height there.
pub fn viewshed(lattice: &Lattice, options: &ViewshedOptions) -> Result<Viewshed, Answer> {
    let never = StopFlag::default();
    Ok(viewshed_until(lattice, options, &never)?.expect("nothing stops it"))
}

/// [`viewshed`] as long as `stop` is not set; `None` where it was set before the end. It ends within a ring of posts on each
/// thread. It says that it did [`SWEEP_UNITS`], part by part.
///
/// # Errors
/// As for [`viewshed`].
pub fn viewshed_until(
    lattice: &Lattice,
    options: &ViewshedOptions,
    stop: &StopFlag,
) -> Result<Option<Viewshed>, Answer> {
    let observer = Observer::new(lattice, options)?;
    // Zeros come from the system as they are needed: behind a ridge, nothing is.
    let visible: Vec<AtomicBool> = bytemuck::zeroed_vec(lattice.held_heights().len());
    let lines = observer.sweep_all(SweepAnswer::Visible(&visible), stop);
    for post in observer.own_posts() {
        visible[lattice.index(post)]
            .store(!stop.is_stopped() && observer.reaches(post) && observer.sees(post), Ordering::Relaxed);
    }
    if stop.is_stopped() {
        return Ok(None);
    }
    let posts = match observer.looks_everywhere() {
        true => seen_posts(visible, lattice.held_heights()),
        false => observer.posts(|index, _| visible[index].load(Ordering::Relaxed)),
    };
    Ok(Some(Viewshed { lines, ..observer.viewshed(posts) }))
}

/// The visibility of posts that are all looked at, from whether they were found in sight, and their heights.
fn seen_posts(mut visible: Vec<AtomicBool>, heights: &[f32]) -> Vec<PostVisibility> {
    // Zeros come from the system as they are needed, in the task that overwrites them.
    let mut posts: Vec<PostVisibility> = bytemuck::zeroed_vec(heights.len());
    let parts = posts.par_chunks_mut(LOOKED_AT_TOGETHER).zip(visible.par_chunks_mut(LOOKED_AT_TOGETHER));
    parts.zip(heights.par_chunks(LOOKED_AT_TOGETHER)).for_each(|((posts, visible), heights)| {
        for ((post, is_visible), height) in posts.iter_mut().zip(visible).zip(heights) {
            let seen = if *is_visible.get_mut() { PostVisibility::Visible } else { PostVisibility::Hidden };
            *post = if height.is_nan() { PostVisibility::NoData } else { seen };
        }
    });
    posts
}

/// [`viewshed`] by its definition, a line for each post: the reference for tests.
///
/// # Errors
/// As for [`viewshed`].
pub fn viewshed_by_lines(lattice: &Lattice, options: &ViewshedOptions) -> Result<Viewshed, Answer> {
    let observer = Observer::new(lattice, options)?;
    let posts = observer.posts(|_, post| observer.sees(post));
    Ok(observer.viewshed(posts))
}

/// Parts of an octant that are swept apart, a power of two: enough for threads to share the work evenly, and few enough
/// that the double work along their borders is negligible.
const PARTS: usize = 8;

/// The units that a viewshed says that it [did](StopFlag::did): the parts of all octants.
pub const SWEEP_UNITS: usize = 8 * PARTS;

/// The wedges that a sector touches, the largest first.
fn wedges(frames: impl Iterator<Item = OctantFrame>, sector: &Sector) -> Vec<(OctantFrame, (f64, f64))> {
    let parts = (0..PARTS).map(|part| (part as f64 / PARTS as f64, (part + 1) as f64 / PARTS as f64));
    let all = frames.flat_map(|frame| parts.clone().map(move |rays| (frame, rays)));
    let mut wedges: Vec<_> = all.filter(|(frame, rays)| sector.may_touch(frame.directions(*rays))).collect();
    wedges.sort_by_cached_key(|(frame, (from, _))| std::cmp::Reverse(frame.rings_before(*from)));
    wedges
}

/// An observer on a lattice.
struct Observer<'a> {
    lattice: &'a Lattice,
    options: &'a ViewshedOptions,
    /// Grid position of the observer.
    grid: DVec2,
    /// Height of the eye in meters.
    eye_m: f64,
}

impl<'a> Observer<'a> {
    fn new(lattice: &'a Lattice, options: &'a ViewshedOptions) -> Result<Self, Answer> {
        let at = options.observer.at;
        let ground = ground_height(lattice, Interpolation::Planar, at);
        let Answer::Height(ground_m) = ground else { return Err(ground) };
        let grid = lattice.grid_from_map(at);
        Ok(Self { lattice, options, grid, eye_m: ground_m + options.observer.above_m })
    }

    /// Sweeps over all posts; the number of those that a line of sight decided.
    fn sweep_all(&self, answer: SweepAnswer<'_>, stop: &StopFlag) -> usize {
        let sees = |post: Post| !stop.is_stopped() && self.reaches(post) && self.sees(post);
        let is_clear_near = |post: Post, part: f64| self.is_clear_up_to(post, part);
        // Lines from a post meet no diagonal but at its ends.
        let is_on_post = self.grid.fract() == DVec2::ZERO;
        let is_clear_of_diagonals = |post: Post| is_on_post || !self.may_meet_a_diagonal_at(post);
        let tests = PostTests {
            sees: &sees,
            is_clear_near: &is_clear_near,
            is_clear_of_diagonals: &is_clear_of_diagonals,
        };
        let scene = self.scene(stop);
        let wedges = wedges(OctantFrame::all(self.lattice, self.grid), &self.options.sector);
        // What the sector leaves out is done.
        stop.did(SWEEP_UNITS - wedges.len());
        let lines = AtomicUsize::new(0);
        // One by one in their order, so that no thread begins a large one when the others are done.
        wedges.into_iter().par_bridge().for_each(|(frame, rays)| {
            lines.fetch_add(sweep(&scene, &frame, rays, tests, answer), Ordering::Relaxed);
            stop.did(1);
        });
        lines.into_inner()
    }

    /// Whether the line of sight to the target on a post is clear: the definition.
    fn sees(&self, post: Post) -> bool {
        self.is_clear_up_to(post, 1.0)
    }

    /// Whether nothing blocks a line of sight in its first `part`.
    fn is_clear_up_to(&self, post: Post, part: f64) -> bool {
        let target_m = f64::from(self.lattice.height(post)) + self.options.target_above_m;
        let length_m = self.options.observer.at.distance(self.lattice.map_position(post));
        let line = SightLine::new(self.eye_m, target_m, length_m, self.options.curvature);
        let walk = crossings(self.lattice, self.grid, post.grid(), |crossing| {
            if crossing.part > part {
                return ControlFlow::Break(true);
            }
            if line.is_below(crossing.height_m, crossing.part) {
                return ControlFlow::Break(false);
            }
            ControlFlow::Continue(())
        });
        walk.break_value().unwrap_or(true)
    }

    /// Whether rounding may leave a diagonal that ends at a post, where it is as high as the target, just before the end of
    /// the line to it: then only the line itself decides. Of an observer that stands on no post.
    fn may_meet_a_diagonal_at(&self, post: Post) -> bool {
        if post.column % 2 != post.row % 2 {
            return false;
        }
        let to = post.grid();
        let along = to - self.grid;
        // As `crossings` computes it, for each of the four cells around.
        let is_before = |corner: DVec2| {
            let start = self.grid - corner;
            let (rising, falling) = (start.x - start.y, start.x + start.y - 1.0);
            let is_rising = (corner.x == to.x) == (corner.y == to.y);
            let part = if is_rising { -rising / (along.x - along.y) } else { -falling / (along.x + along.y) };
            part < 1.0
        };
        [DVec2::ZERO, DVec2::X, DVec2::Y, DVec2::ONE].iter().any(|&back| is_before(to - back))
    }

    /// Whether a post lies within the range and the sector.
    fn reaches(&self, post: Post) -> bool {
        let offset = self.lattice.map_position(post) - self.options.observer.at;
        offset.length() <= self.options.range_m && self.options.sector.contains(offset)
    }

    /// The viewshed of these held posts, each decided by a line.
    fn viewshed(&self, posts: Vec<PostVisibility>) -> Viewshed {
        let held = self.lattice.held();
        Viewshed { columns: held.width() as u32, rows: held.height() as u32, lines: posts.len(), posts }
    }

    /// Whether all posts lie within the range and the sector.
    fn looks_everywhere(&self) -> bool {
        self.options.range_m.is_infinite() && self.options.sector.width_deg >= 360.0
    }

    /// The visibility of every held post, by `sees` for those within reach that have data.
    fn posts(&self, sees: impl Fn(usize, Post) -> bool + Sync) -> Vec<PostVisibility> {
        let (heights, held) = (self.lattice.held_heights(), self.lattice.held());
        let columns = held.width();
        let is_everywhere = self.looks_everywhere();
        let mut posts = vec![PostVisibility::Beyond; heights.len()];
        posts.par_chunks_mut(columns).enumerate().for_each(|(row, posts)| {
            for (column, visibility) in posts.iter_mut().enumerate() {
                let (post, index) = (held.first.offset(column as u32, row as u32), row * columns + column);
                if is_everywhere || self.reaches(post) {
                    *visibility = if heights[index].is_nan() {
                        PostVisibility::NoData
                    } else if sees(index, post) {
                        PostVisibility::Visible
                    } else {
                        PostVisibility::Hidden
                    };
                }
            }
        });
        posts
    }

    /// The posts around the observer: the one that it stands on belongs to no wedge.
    fn own_posts(&self) -> impl Iterator<Item = Post> {
        let (low, high) = (self.grid.floor().as_uvec2(), self.grid.ceil().as_uvec2());
        (low.y..=high.y).flat_map(move |row| (low.x..=high.x).map(move |column| Post { column, row }))
    }

    fn scene<'s>(&self, stop: &'s StopFlag) -> SweepScene<'s>
    where
        'a: 's,
    {
        let drop_per_square_m = self.options.curvature.drop_per_square_m();
        SweepScene {
            lattice: self.lattice,
            eye_m: self.eye_m,
            target_m: self.options.target_above_m,
            drop_per_square_m,
            range_m: self.options.range_m,
            margins: self.margins(drop_per_square_m),
            stop,
        }
    }

    /// How far the sweep's numbers may differ from those of a line of sight.
    ///
    /// A line's crossings lie off the true ray by a few roundings of grid coordinates, and by 64 times as much along an
    /// edge met at the flattest angle that is trusted; that share of the highest step that the lattice may hold is the
    /// error of a height, beside a few roundings of the largest number. Both are taken generously: a millionth of a meter
    /// more makes nothing slower.
    fn margins(&self, drop_per_square_m: f64) -> Margins {
        const ROUNDINGS: f64 = 16.0;
        const ALONG_EDGES: f64 = 128.0;
        let (low, high) = self.lattice.height_range();
        let (low, high) = (f64::from(low), f64::from(high));
        let size = f64::from(self.lattice.columns().max(self.lattice.rows()));
        let squared_cell = self.lattice.cell().length_squared();
        let sag = drop_per_square_m.abs() * squared_cell * size * size * 2.0;
        let largest = low.abs().max(high.abs()) + self.eye_m.abs() + self.options.target_above_m.abs() + sag;
        let across = ROUNDINGS * f64::EPSILON * size;
        Margins {
            height_m: ALONG_EDGES * across * (high - low) + ROUNDINGS * f64::EPSILON * largest,
            across,
            // A parabola over a cell is off its chord by an eighth of its second derivative.
            bend_m: 0.25 * drop_per_square_m.abs() * squared_cell,
        }
    }
}
