//! Lowers posts until the ground rises along no centerline.
//!
//! Between two crossings a centerline runs through one triangle, and the ground rises along it by a sum over the
//! triangle's posts: `Σ share · height`, where a share is what the post gains from where the line comes in to where it
//! leaves. Posts behind have shares below 0, posts ahead above, and together they are 0.
//!
//! A stretch that rises is mended by lowering the posts ahead, from the highest down, to where the sum is 0: that is never
//! below the mean of the posts behind, so nothing is dug deeper than what it mends. Stretches that share those posts are
//! then looked at again. A stretch that has been mended often lies in a loop of lines that chase each other down, such as
//! both sides of a meander's neck that is narrower than a cell; there the posts ahead are lowered to the lowest behind.
//! Those heights are all there already, and there are finitely many of them: so it ends.
//!
//! Posts under a lake are not lowered. Where one of them lies ahead of lower ground, the posts behind are raised to the
//! lake, and are from then on part of it: its backwater.
//!
//! No post is moved further than its channels may cut. A stretch that still rises when nothing more may be moved climbs:
//! it is given up, and all is carved anew without it, so that nothing is dug for its sake.

use crate::channel::bed::ChannelBed;
use crate::channel::course::{ChannelCourse, CourseStation};
use glam::DVec2;
use sandtable_terrain::cell_triangle::Diagonal;
use sandtable_terrain::lattice::Lattice;

/// What a stretch may rise by rounding, in meters: a thousand of them come to a thousandth of a millimeter.
const ROUNDING_M: f64 = 1e-9;

/// How much further than needed a stretch is mended, in meters, so that rounding does not have it mended again.
const SPARE_M: f64 = 1e-8;

/// Stretches in which no post gains more than this are rounding where a line passes a post: in cells of 30 m, 0.3 mm.
const LEAST_SHARE: f64 = 1e-5;

/// How often a stretch is mended as little as needed.
const GENTLE_MENDS: u8 = 24;

/// How often all is carved anew without what climbs. What rises after the last of them is left, dug for or not.
const ROUNDS: usize = 6;

/// A stretch of centerline within one triangle.
#[derive(Clone, Copy, Debug)]
pub(super) struct CenterlinePiece {
    /// Where the lattice stores the triangle's posts.
    pub posts: [u32; 3],
    /// What each gains from the stretch's start to its end.
    pub shares: [f64; 3],
    /// The channel it is of.
    pub channel: u32,
    /// Where along the channel it starts and ends, in meters from the line's start.
    pub stations_m: [f64; 2],
    /// The water's level at its end, where that lies above the ground: in a pit that is to be filled, or before a lake.
    /// Minus infinity elsewhere.
    pub filled_m: f64,
}

/// All stretches of `courses` over ground, those of the course with the highest source first, each downstream.
pub(super) fn pieces(lattice: &Lattice, courses: &[ChannelCourse<'_>]) -> Vec<CenterlinePiece> {
    let source = |course: &ChannelCourse<'_>| {
        let mut levels = course.stations.iter().map(|station| station.level_m);
        levels.find(|level| !level.is_nan()).unwrap_or(f64::NEG_INFINITY)
    };
    let mut order: Vec<usize> = (0..courses.len()).collect();
    order.sort_by(|&a, &b| source(&courses[b]).total_cmp(&source(&courses[a])));
    let of_course = |index: usize| {
        let pairs = courses[index].pairs();
        pairs.filter_map(move |[from, to]| CenterlinePiece::between(lattice, index as u32, [&from, &to]))
    };
    order.into_iter().flat_map(of_course).collect()
}

impl CenterlinePiece {
    /// The stretch between two stations in a row; `None` where it has no ground or no length.
    fn between(lattice: &Lattice, channel: u32, [from, to]: [&CourseStation; 2]) -> Option<Self> {
        let middle = (from.grid + to.grid) * 0.5;
        let (cell, part) = lattice.cell_at_grid(middle)?;
        let (low, first) = (cell.grid(), lattice.index(cell));
        let north = first + lattice.columns() as usize;
        let corners = [first, first + 1, north, north + 1];
        let (used, weigh) = triangle(Diagonal::of_cell(cell), part);
        let (start, end) = (weigh(from.grid - low), weigh(to.grid - low));
        let shares = std::array::from_fn(|at| end[at] - start[at]);
        let posts = used.map(|corner| corners[corner]);
        let grounded = posts.iter().all(|&post| !lattice.heights()[post].is_nan());
        let moves = shares.iter().any(|share: &f64| share.abs() > LEAST_SHARE);
        let filled_m = if to.level_m > to.raw_m { to.level_m } else { f64::NEG_INFINITY };
        let stations_m = [from.station_m, to.station_m];
        let posts = posts.map(|post| post as u32);
        (grounded && moves).then_some(Self { posts, shares, channel, stations_m, filled_m })
    }
}

/// What each of a triangle's corners weighs at a place in the cell.
type Weigh = fn(DVec2) -> [f64; 3];

/// The corners of a cell's triangle that holds `part`, from south-west by rows, and their weights at a point in it.
fn triangle(diagonal: Diagonal, part: DVec2) -> ([usize; 3], Weigh) {
    match diagonal {
        Diagonal::Rising if part.x >= part.y => ([0, 1, 3], |at| [1.0 - at.x, at.x - at.y, at.y]),
        Diagonal::Rising => ([0, 2, 3], |at| [1.0 - at.y, at.y - at.x, at.x]),
        Diagonal::Falling if part.x + part.y <= 1.0 => ([0, 1, 2], |at| [1.0 - at.x - at.y, at.x, at.y]),
        Diagonal::Falling => ([1, 2, 3], |at| [1.0 - at.y, 1.0 - at.x, at.x + at.y - 1.0]),
    }
}

/// A stretch with its posts' places in the bed.
struct CarveStretch {
    places: [usize; 3],
    shares: [f64; 3],
}

impl CarveStretch {
    /// The posts that it moves away from.
    fn behind(&self) -> impl Iterator<Item = usize> + use<> {
        self.places.into_iter().zip(self.shares).filter(|(_, share)| *share < 0.0).map(|(place, _)| place)
    }
}

/// Lowers the bed's posts until no piece rises but those that climb: by how much, in meters, with the piece's index.
pub(super) fn carve(bed: &mut ChannelBed, pieces: &[CenterlinePiece]) -> Vec<(usize, f64)> {
    let stretch = |piece: &CenterlinePiece| CarveStretch {
        places: piece.posts.map(|post| bed.place(post)),
        shares: piece.shares,
    };
    let stretches: Vec<CarveStretch> = pieces.iter().map(stretch).collect();
    let touching = Touching::of(&stretches, bed.heights_m.len());
    let shaped = (bed.heights_m.clone(), bed.fixed.clone());
    let mut is_given_up = vec![false; stretches.len()];
    for round in 0..ROUNDS {
        relax(bed, &stretches, &touching, &is_given_up);
        let climbing = |&index: &usize| !is_given_up[index] && rise_m(bed, &stretches[index]) > ROUNDING_M;
        let climbing: Vec<usize> = (0..stretches.len()).filter(climbing).collect();
        if climbing.is_empty() || round + 1 == ROUNDS {
            break;
        }
        climbing.into_iter().for_each(|index| is_given_up[index] = true);
        bed.heights_m.clone_from(&shaped.0);
        bed.fixed.clone_from(&shaped.1);
    }
    let rises = stretches.iter().map(|stretch| rise_m(bed, stretch)).enumerate();
    rises.filter(|(_, rise_m)| *rise_m > ROUNDING_M).collect()
}

/// Mends every stretch that is not given up until none can be mended any more.
fn relax(bed: &mut ChannelBed, stretches: &[CarveStretch], touching: &Touching, is_given_up: &[bool]) {
    let mut waiting: Vec<bool> = is_given_up.iter().map(|given_up| !given_up).collect();
    let mut mends = vec![0u8; stretches.len()];
    let mut is_calm = false;
    while !is_calm {
        is_calm = true;
        for index in 0..stretches.len() {
            if !std::mem::take(&mut waiting[index]) {
                continue;
            }
            let moved = mend(bed, &stretches[index], mends[index]);
            if moved.is_empty() {
                continue;
            }
            is_calm = false;
            mends[index] = mends[index].saturating_add(1);
            for &other in moved.iter().flat_map(|&place| touching.stretches(place)) {
                waiting[other as usize] = !is_given_up[other as usize];
            }
        }
    }
}

fn rise_m(bed: &ChannelBed, stretch: &CarveStretch) -> f64 {
    stretch.places.iter().zip(stretch.shares).map(|(&place, share)| share * bed.heights_m[place]).sum()
}

/// Lowers the posts ahead in a stretch that rises, raises those behind to a lake ahead, and returns those it has moved.
fn mend(bed: &mut ChannelBed, stretch: &CarveStretch, mends: u8) -> Vec<usize> {
    let excess_m = rise_m(bed, stretch);
    if excess_m <= ROUNDING_M {
        return Vec::new();
    }
    let mut moved = lower_ahead(bed, stretch, excess_m, mends);
    if rise_m(bed, stretch) > ROUNDING_M {
        moved.extend(raise_behind(bed, stretch));
    }
    moved
}

fn lower_ahead(bed: &mut ChannelBed, stretch: &CarveStretch, excess_m: f64, mends: u8) -> Vec<usize> {
    let lowest_behind_m = stretch.behind().map(|place| bed.heights_m[place]).fold(f64::INFINITY, f64::min);
    let posts = stretch.places.into_iter().zip(stretch.shares);
    let mut ahead: Vec<(usize, f64)> =
        posts.filter(|&(place, share)| share > 0.0 && bed.may_fall(place)).collect();
    ahead.sort_by(|a, b| bed.heights_m[b.0].total_cmp(&bed.heights_m[a.0]));
    let to_m = if mends < GENTLE_MENDS {
        gentle_m(bed, &ahead, excess_m + SPARE_M).max(lowest_behind_m)
    } else {
        lowest_behind_m
    };
    let lowered: Vec<usize> =
        ahead.into_iter().map(|(place, _)| place).filter(|&place| bed.heights_m[place] > to_m).collect();
    lowered.iter().for_each(|&place| bed.heights_m[place] = to_m.max(bed.floors_m[place]));
    lowered
}

/// Raises the posts behind a stretch to the lake that lies ahead, where one does, and makes them part of it.
fn raise_behind(bed: &mut ChannelBed, stretch: &CarveStretch) -> Vec<usize> {
    let fixed_ahead = stretch
        .places
        .into_iter()
        .zip(stretch.shares)
        .filter(|&(place, share)| share > 0.0 && bed.fixed[place]);
    let lake_m = fixed_ahead.map(|(place, _)| bed.heights_m[place]).fold(f64::NEG_INFINITY, f64::max);
    let lower = |&place: &usize| {
        !bed.fixed[place] && bed.heights_m[place] < lake_m && lake_m <= bed.ceilings_m[place]
    };
    let raised: Vec<usize> = stretch.behind().filter(lower).collect();
    for &place in &raised {
        (bed.heights_m[place], bed.fixed[place]) = (lake_m, true);
    }
    raised
}

/// The height to which the posts `ahead`, the highest first, are lowered for the stretch to rise by `excess_m` less.
fn gentle_m(bed: &ChannelBed, ahead: &[(usize, f64)], excess_m: f64) -> f64 {
    let (mut sum, mut shares, mut to_m) = (0.0, 0.0, f64::NEG_INFINITY);
    for (index, &(place, share)) in ahead.iter().enumerate() {
        sum += share * bed.heights_m[place];
        shares += share;
        to_m = (sum - excess_m) / shares;
        let next = ahead.get(index + 1).map(|&(next, _)| bed.heights_m[next]);
        if next.is_none_or(|next| to_m >= next) {
            break;
        }
    }
    to_m
}

/// Which stretches touch each post of a bed.
struct Touching {
    starts: Vec<u32>,
    stretches: Vec<u32>,
}

impl Touching {
    fn of(stretches: &[CarveStretch], posts: usize) -> Self {
        let mut starts = vec![0u32; posts + 1];
        for place in stretches.iter().flat_map(|stretch| stretch.places) {
            starts[place + 1] += 1;
        }
        for post in 0..posts {
            starts[post + 1] += starts[post];
        }
        let mut next = starts.clone();
        let mut sorted = vec![0; 3 * stretches.len()];
        for (index, stretch) in stretches.iter().enumerate() {
            for place in stretch.places {
                sorted[next[place] as usize] = index as u32;
                next[place] += 1;
            }
        }
        Self { starts, stretches: sorted }
    }

    fn stretches(&self, place: usize) -> &[u32] {
        &self.stretches[self.starts[place] as usize..self.starts[place + 1] as usize]
    }
}
