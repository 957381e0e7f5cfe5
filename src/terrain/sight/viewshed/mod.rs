//! Which posts can be seen from one point.
//!
//! The definition is one line of sight for each post (`Looking::sees`). What is run is a `sweep` outward through
//! wedges of the circle, which holds each post against the `horizon` of what lies before it and looks along the line
//! only where the two are too close to tell apart. Both give the same answer on every post.
//!
//! Other programs make this fast by giving up the answer: propagating one reference plane or one interpolated slope
//! from ring to ring (Wang, Robinson and White 2000; XDraw, Franklin 1994) misses every tenth visible post, and a
//! plane sweep over cells (Van Kreveld 1996) takes cells for flat. Here the ground is the triangles of the
//! [lattice](crate::terrain::lattice), as everywhere.

mod frame;
mod horizon;
mod near;
mod sector;
mod sweep;

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use glam::DVec2;
use rayon::prelude::*;

use crate::dem::answer::Answer;
use crate::terrain::lattice::{Lattice, Post};
use crate::terrain::query::{Interpolation, ground_height};
use crate::terrain::sight::Curvature;
use crate::terrain::sight::crossings::crossings;
use crate::terrain::sight::line::{SightEnd, SightLine};
use crate::terrain::sight::viewshed::frame::OctantFrame;
use crate::terrain::sight::viewshed::sweep::{Margins, SightLines, SweepScene, sweep};

/// What a viewshed is asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ViewshedOptions {
    /// Who looks.
    pub observer: SightEnd,
    /// Meters above the ground of what is looked for, at every post.
    pub target_above_m: f64,
    /// How far is looked, in meters along the ground; without limit where infinite.
    pub range_m: f64,
    /// The directions looked into.
    pub sector: Sector,
    /// The Earth's curvature and refraction.
    pub curvature: Curvature,
}

/// Directions, as azimuths clockwise from north in degrees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sector {
    /// Where it begins, 0..360.
    pub from_deg: f64,
    /// How far it turns clockwise from there, above 0 and up to 360.
    pub width_deg: f64,
}

/// What a viewshed says of a post.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum PostVisibility {
    /// Beyond the range or out of the sector.
    Beyond,
    /// There is no data.
    NoData,
    /// Terrain stands between.
    Hidden,
    /// In sight.
    Visible,
}

/// What can be seen, post by post.
#[derive(Clone, Debug, PartialEq)]
pub struct Viewshed {
    /// Posts per row.
    pub columns: u32,
    /// Rows.
    pub rows: u32,
    /// Row by row from the south-west, as [`Lattice::heights`].
    pub posts: Vec<PostVisibility>,
    /// How many posts were looked at along their own line: the rest were decided by the sweep. A measure of the work,
    /// no part of the answer.
    pub looked_at: usize,
}

/// How many posts there are of each kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
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

impl Viewshed {
    /// The number of posts of each kind.
    pub fn counts(&self) -> ViewshedCounts {
        let mut by_kind = [0; 4];
        for &seen in &self.posts {
            by_kind[seen as usize] += 1;
        }
        let [beyond, no_data, hidden, visible] = by_kind;
        ViewshedCounts { visible, hidden, no_data, beyond }
    }
}

/// Looks from the observer to every post: [`PostVisibility::Visible`] exactly where the line of sight to a target on that post
/// is clear, as [`line_of_sight`](crate::terrain::sight::line::line_of_sight) has it. Targets stand on the posts
/// themselves: their columns and rows are whole numbers, whatever rounding their map coordinates suffer.
///
/// Costs some 15 ns a post on one thread where most is hidden and up to 200 where most is seen, spread over all threads;
/// the answer is the same for any number of them. Ground that is one plane seen along itself is all ties, and costs a
/// line for each post.
///
/// # Errors
/// What the ground answers at the observer, where it has no height there.
pub fn viewshed(lattice: &Lattice, options: &ViewshedOptions) -> Result<Viewshed, Answer> {
    let looking = Looking::new(lattice, options)?;
    let visible: Vec<AtomicBool> = lattice.heights().par_iter().map(|_| AtomicBool::new(false)).collect();
    let exact = |post: Post| looking.reaches(post) && looking.sees(post);
    let sure = |post: Post| !looking.may_meet_a_diagonal_at(post);
    let scene = looking.scene();
    let wedges = wedges(OctantFrame::all(lattice, looking.eye), &options.sector);
    let looked_at = AtomicUsize::new(0);
    wedges.par_iter().with_max_len(1).for_each(|(frame, rays)| {
        looked_at.fetch_add(
            sweep(&scene, frame, *rays, SightLines { exact: &exact, sure: &sure }, &visible),
            Ordering::Relaxed,
        );
    });
    for post in looking.own_posts() {
        visible[lattice.index(post)].store(exact(post), Ordering::Relaxed);
    }
    let posts = looking.posts(|index, _| visible[index].load(Ordering::Relaxed));
    let (columns, rows) = (lattice.columns(), lattice.rows());
    Ok(Viewshed { columns, rows, posts, looked_at: looked_at.into_inner() })
}

/// [`viewshed`] by its definition, a line for each post: what it is held against.
///
/// # Errors
/// As for [`viewshed`].
pub fn viewshed_by_lines(lattice: &Lattice, options: &ViewshedOptions) -> Result<Viewshed, Answer> {
    let looking = Looking::new(lattice, options)?;
    let posts = looking.posts(|_, post| looking.sees(post));
    Ok(Viewshed { columns: lattice.columns(), rows: lattice.rows(), looked_at: posts.len(), posts })
}

/// Parts of an eighth of the circle that are swept apart: enough for threads to share the work evenly, and few enough
/// that what they do twice along their borders does not count. A power of two.
const PARTS: usize = 4;

/// The wedges that a sector touches.
fn wedges(frames: impl Iterator<Item = OctantFrame>, sector: &Sector) -> Vec<(OctantFrame, (f64, f64))> {
    let parts = (0..PARTS).map(|part| (part as f64 / PARTS as f64, (part + 1) as f64 / PARTS as f64));
    let all = frames.flat_map(|frame| parts.clone().map(move |rays| (frame, rays)));
    all.filter(|(frame, rays)| sector.may_touch(frame.directions(*rays))).collect()
}

/// An observer on a lattice.
struct Looking<'a> {
    lattice: &'a Lattice,
    options: &'a ViewshedOptions,
    /// Grid position of the observer.
    eye: DVec2,
    /// Height of the eye in meters.
    eye_m: f64,
}

impl<'a> Looking<'a> {
    fn new(lattice: &'a Lattice, options: &'a ViewshedOptions) -> Result<Self, Answer> {
        let at = options.observer.at;
        let ground = ground_height(lattice, Interpolation::Planar, at);
        let Answer::Height(ground_m) = ground else { return Err(ground) };
        let eye = lattice.grid_at(at - lattice.origin());
        Ok(Self { lattice, options, eye, eye_m: ground_m + options.observer.above_m })
    }

    /// Whether the line of sight to the target on a post is clear: the definition.
    fn sees(&self, post: Post) -> bool {
        let target_m = f64::from(self.lattice.height(post)) + self.options.target_above_m;
        let length_m = self.options.observer.at.distance(self.lattice.map_position(post));
        let line = SightLine::new(self.eye_m, target_m, length_m, self.options.curvature);
        let to = DVec2::new(f64::from(post.column), f64::from(post.row));
        crossings(self.lattice, self.eye, to, |crossing| {
            if line.is_below(crossing.height_m, crossing.part) {
                return ControlFlow::Break(());
            }
            ControlFlow::Continue(())
        })
        .is_continue()
    }

    /// Whether the line to a post may meet a diagonal that ends there a rounding before its end, where it stands as high
    /// as the target: then only the line itself can tell on which side rounding leaves it.
    fn may_meet_a_diagonal_at(&self, post: Post) -> bool {
        if self.eye.fract() == DVec2::ZERO || post.column % 2 != post.row % 2 {
            return false;
        }
        let to = DVec2::new(f64::from(post.column), f64::from(post.row));
        let along = to - self.eye;
        // as the crossings have it, for each of the four cells around
        let is_before = |corner: DVec2| {
            let start = self.eye - corner;
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
        offset.length() <= self.options.range_m && self.options.sector.holds(offset)
    }

    /// What is said of every post, where `sees` tells of those within reach that have data.
    fn posts(&self, sees: impl Fn(usize, Post) -> bool + Sync) -> Vec<PostVisibility> {
        let columns = self.lattice.columns();
        let is_everywhere = self.options.range_m.is_infinite() && self.options.sector.width_deg >= 360.0;
        let mut posts = vec![PostVisibility::Beyond; self.lattice.heights().len()];
        let rows =
            posts.par_chunks_mut(columns as usize).zip(self.lattice.heights().par_chunks(columns as usize));
        rows.enumerate().for_each(|(row, (posts, heights))| {
            for (column, (seen, height)) in posts.iter_mut().zip(heights).enumerate() {
                let post = Post { column: column as u32, row: row as u32 };
                if is_everywhere || self.reaches(post) {
                    *seen = match (height.is_nan(), row * columns as usize + column) {
                        (true, _) => PostVisibility::NoData,
                        (false, index) if sees(index, post) => PostVisibility::Visible,
                        _ => PostVisibility::Hidden,
                    };
                }
            }
        });
        posts
    }

    /// The posts around the observer: the one that it stands on belongs to no wedge.
    fn own_posts(&self) -> impl Iterator<Item = Post> {
        let (low, high) = (self.eye.floor().as_uvec2(), self.eye.ceil().as_uvec2());
        (low.y..=high.y).flat_map(move |row| (low.x..=high.x).map(move |column| Post { column, row }))
    }

    fn scene(&self) -> SweepScene<'a> {
        let drop_per_square_m = self.options.curvature.drop_per_square_m();
        SweepScene {
            lattice: self.lattice,
            eye_m: self.eye_m,
            target_m: self.options.target_above_m,
            drop_per_square_m,
            range_m: self.options.range_m,
            margins: self.margins(drop_per_square_m),
        }
    }

    /// How far the sweep's numbers may be from those of a line of sight.
    ///
    /// A line's crossings lie off the true ray by a few roundings of grid coordinates, and where an edge is met under
    /// the flattest angle that is trusted, 64 times as far along it, which is so much of the highest step that the
    /// lattice may hold; heights themselves suffer a few roundings of the largest number about. Both are taken
    /// generously: a millionth of a meter more makes nothing slower.
    fn margins(&self, drop_per_square_m: f64) -> Margins {
        const ROUNDINGS: f64 = 16.0;
        const ALONG_EDGES: f64 = 128.0;
        let (low, high) = self.lattice.height_range();
        let (low, high) = (f64::from(low), f64::from(high));
        let size = f64::from(self.lattice.columns().max(self.lattice.rows()));
        let cell = self.lattice.cell();
        let squared_cell = cell.length_squared();
        let sag = drop_per_square_m.abs() * squared_cell * size * size * 2.0;
        let largest = low.abs().max(high.abs()) + self.eye_m.abs() + self.options.target_above_m.abs() + sag;
        let across = ROUNDINGS * f64::EPSILON * size;
        Margins {
            height_m: ALONG_EDGES * across * (high - low) + ROUNDINGS * f64::EPSILON * largest,
            across,
            // a parabola over a cell stands off its chord by an eighth of its second derivative
            bend_m: 0.25 * drop_per_square_m.abs() * squared_cell,
        }
    }
}
