//! Channels: the ground cut so that water falls along every river of a network.
//!
//! ```text
//!  flow ──► which end of each line is the lower one
//!  course ► stations where the line crosses the finest triangles, with the ground across the water there
//!  levels ► the level at every station: it never rises downstream, through the whole network, and no bank drowns
//!  bed ───► the posts under the water and its banks, set to the level beside them
//!  carve ─► posts lowered until the ground along no line rises from one triangle to the next: exact on any cells
//! ```
//!
//! The first four make a bed as a river has one. The last makes sure: cells may be ten times as wide as the stream, and
//! then no level at a post says what the ground between the posts does. What it lowers it lowers as little as it can.
//!
//! Posts that are pinned already, under a lake, stay: a river that runs through a lake takes its level.

mod bed;
mod carve;
mod course;
pub mod flow;
mod levels;

use crate::geom::polyline::Polyline;
use crate::terrain::channel::bed::Bed;
use crate::terrain::channel::course::Course;
use crate::terrain::earthwork::Volumes;
use crate::terrain::lattice::Lattice;

/// A river to cut.
#[derive(Clone, Debug)]
pub struct Channel {
    /// The centreline in world coordinates, downstream.
    pub line: Polyline,
    /// The water's width at each vertex in metres, above 0.
    pub widths_m: Vec<f64>,
    /// How far beyond the bed the ground is blended, in metres, at least 0.
    pub bank_m: f64,
}

/// What cutting one channel came to.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Cut {
    /// The water's level in metres where the line first has ground, and where it last has; `None` where it has none.
    pub levels_m: Option<(f64, f64)>,
    /// How deep the ground was cut at most, in metres.
    pub deepest_m: f64,
    /// Earth moved. What two channels share counts for one of them.
    pub volumes: Volumes,
}

/// What cutting a network came to.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cuts {
    /// One for each channel.
    pub cuts: Vec<Cut>,
    /// How many triangles there are along which the water rises all the same: where it would have to flow from a lake to
    /// a higher one.
    pub rising: usize,
}

/// Why a network cannot be cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ChannelError {
    /// Beds of hundreds of millions of posts.
    #[error(
        "the beds of these rivers would cover more than {MOST_VISITS} posts, each counted once a cell along the river"
    )]
    TooWide,
}

/// The most posts that beds may cover, counted once for each triangle that a centreline crosses beside them: some
/// seconds' work.
pub const MOST_VISITS: usize = 200_000_000;

/// Cuts the ground so that it never rises along any of `channels`.
///
/// # Errors
/// See [`ChannelError`]; the ground is then as it was.
pub fn cut(lattice: &mut Lattice, channels: &[Channel]) -> Result<Cuts, ChannelError> {
    let mut courses: Vec<Course> = channels.iter().map(|channel| Course::of(lattice, channel)).collect();
    levels::settle(&mut courses, channels);
    let pieces = carve::pieces(lattice, &courses);
    let mut bed = Bed::shaped(lattice, &courses, &pieces)?;
    let rising = carve::carve(&mut bed, &pieces);
    let mut cuts: Vec<Cut> = courses.iter().map(levels::ends).collect();
    bed.dig(lattice, &mut cuts);
    Ok(Cuts { cuts, rising })
}

/// The most by which the ground rises along `line`, world coordinates downstream, above where it was lower before; 0
/// where it never rises. What this room promises of every channel, on the finest triangles; where a line leaves the ground
/// and comes back it begins anew.
pub fn check_rise(lattice: &Lattice, line: &Polyline) -> f64 {
    let map: Vec<_> = line.points().iter().map(|&at| at + lattice.origin()).collect();
    let stations = crate::terrain::profile::profile(lattice, &map);
    let (mut lowest_m, mut rise_m) = (f64::INFINITY, 0.0);
    for station in stations {
        match station.ground.height_m() {
            Some(height_m) => {
                lowest_m = height_m.min(lowest_m);
                rise_m = (height_m - lowest_m).max(rise_m);
            }
            None => lowest_m = f64::INFINITY,
        }
    }
    rise_m
}
