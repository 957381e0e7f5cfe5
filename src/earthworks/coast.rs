//! Coasts: the ground follows coastlines, so that the sea ends where they run and not where cells do.
//!
//! ```text
//!   land  land  land  land          ╲ of posts within a cell of the line the side of the nearest place on it counts;
//!     ·     ·     ·    ╲·            ╲ all others are on the side of the nearest of these
//!   ─────────────╲    sea ╲
//!     ·     ·     ╲──·─────╲──►     land lies on the left (OpenStreetMap, `natural=coastline`)
//! ```
//!
//! Posts of the sea get its level. Posts of the land that would be drawn as sea, or lie beside it, rise above it by the
//! least that serves. Ground to which an open end of a line is nearest stays as it is: nobody said on which side it lies.

use std::collections::{BTreeMap, VecDeque};

use glam::DVec2;

use sandtable_geom::polyline::{VertexKey, vertex_key};
use sandtable_geom::segment;
use sandtable_terrain::lattice::{Lattice, Post};
use sandtable_terrain::neighbors;
use sandtable_terrain::volumes::Volumes;

/// How far above the sea land lies at least, in meters: what heights of whole meters tell from it, and no more.
pub const LEAST_LAND_M: f32 = 0.5;

/// How far from a line the side of a post is measured, in cells; between posts nearer than one, no way of single steps
/// passes a line unseen.
const BAND_CELLS: i64 = 2;

/// The most steps of a cell's length along all lines on the ground.
const MOST_STEPS: u64 = 50_000_000;

/// By how much the sea may lie higher than the land, on the mean, in meters: land behind dikes lies a little below it.
const NOISE_M: f64 = 5.0;

/// What the sea is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeaGround<'a> {
    /// Elevation of the water in meters.
    pub level_m: f32,
    /// Whether the ground below it holds the depths of the sea, which stay.
    pub holds_depths: bool,
    /// Whether each post would be drawn as sea without the coast, as
    /// [`WaterCover::is_water`](sandtable_terrain::water_cover::WaterCover::is_water) has them; empty where none would.
    pub is_water: &'a [bool],
}

/// What following a coast took.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CoastChanges {
    /// Earth moved.
    pub volumes: Volumes,
    /// Posts of the sea, and those of the land that were raised.
    pub sea_posts: usize,
    /// See [`Self::sea_posts`].
    pub raised_posts: usize,
    /// The height of the highest ground that is sea now above its level, in meters.
    pub highest_cut_m: f64,
}

/// Coastlines that the ground cannot follow.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum CoastError {
    /// The ground on the right is the higher one.
    #[error(
        "the ground on the right of the coast lies {0:.0} m higher than that on its left, on the mean: a coastline has the land \
         on its left"
    )]
    LandOnTheRight(f64),
    /// There is too much of them.
    #[error(
        "the coast is more than {MOST_STEPS} cells of the ground long; take fewer lines, or a smaller extent"
    )]
    TooLong,
}

/// Where a post lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum CoastSide {
    Untold,
    Land,
    Sea,
    /// Beside an open end.
    Neither,
}

/// Makes the ground follow coastlines in world coordinates, with the land on their left. Lines that share an end are one line;
/// closed ones have their first point last. Posts without data get the level where they lie in the sea.
///
/// Time and memory grow with the number of posts, and with the length of the lines on the ground.
///
/// # Errors
/// The lines run the wrong way, or are too long. The ground is as it was.
pub fn follow(
    lattice: &mut Lattice,
    lines: &[Vec<DVec2>],
    sea: SeaGround<'_>,
) -> Result<CoastChanges, CoastError> {
    let Some(mut sides) = sides_beside(lattice, lines)? else { return Ok(CoastChanges::default()) };
    spread(lattice, &mut sides);
    check_direction(lattice, &sides)?;
    Ok(shape(lattice, &sides, sea))
}

/// The sides of the posts near the lines; `None` where no line comes near the ground.
fn sides_beside(lattice: &Lattice, lines: &[Vec<DVec2>]) -> Result<Option<Vec<CoastSide>>, CoastError> {
    let ends = LineEnds::of(lines);
    let cell = lattice.cell();
    let near = lattice.extent().grown(cell.max_element() * BAND_CELLS as f64);
    let mut nearest: Vec<f32> = Vec::new();
    let mut sides: Vec<CoastSide> = Vec::new();
    let mut steps = 0;
    for line in lines {
        for index in 1..line.len() {
            let (from, to) = (line[index - 1], line[index]);
            let Some((enter, leave)) = near.clip_line(from, to).filter(|_| from != to) else { continue };
            let length = ((leave - enter) / cell).abs().max_element().ceil().max(1.0) as u64;
            steps += length;
            if steps > MOST_STEPS {
                return Err(CoastError::TooLong);
            }
            if sides.is_empty() {
                nearest = vec![f32::INFINITY; lattice.heights().len()];
                sides = vec![CoastSide::Untold; lattice.heights().len()];
            }
            let corners = [ends.corner(line, index - 1), ends.corner(line, index)];
            for step in 0..=length {
                let at = enter.lerp(leave, step as f64 / length as f64);
                for post in posts_around(lattice, at) {
                    let place = lattice.position(post).as_dvec2();
                    let part = segment::nearest_part((from, to), place);
                    let distance = place.distance_squared(from.lerp(to, part)) as f32;
                    let index = lattice.index(post);
                    if distance < nearest[index] {
                        nearest[index] = distance;
                        sides[index] = side((from, to), corners, part, place);
                    }
                }
            }
        }
    }
    Ok(Some(sides).filter(|sides| !sides.is_empty()))
}

/// The posts at most [`BAND_CELLS`] cells from a place along either axis.
fn posts_around(lattice: &Lattice, at: DVec2) -> impl Iterator<Item = Post> + use<> {
    let middle = lattice.grid_at(at).round();
    let range = move |middle: f64, posts: u32| {
        let (low, high) = (middle as i64 - BAND_CELLS, middle as i64 + BAND_CELLS);
        low.max(0)..(high + 1).min(i64::from(posts))
    };
    let columns = range(middle.x, lattice.columns());
    range(middle.y, lattice.rows()).flat_map(move |row| {
        columns.clone().map(move |column| Post { column: column as u32, row: row as u32 })
    })
}

/// A place between two segments of a line.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Corner {
    /// Where the line ends; with more than two ends there, nobody can say which go on.
    Open,
    /// The direction halfway between the normals to the left of the two.
    Normal(DVec2),
}

/// The side of a place whose nearest place on a segment lies at `part` of it: at a corner the sides of both of its segments
/// differ, and the normal between them tells (Bærentzen and Aanæs 2005, in the plane).
fn side((from, to): (DVec2, DVec2), corners: [Corner; 2], part: f64, place: DVec2) -> CoastSide {
    let at_corner = match part {
        0.0 => Some((from, corners[0])),
        1.0 => Some((to, corners[1])),
        _ => None,
    };
    let to_the_left = match at_corner {
        Some((_, Corner::Open)) => return CoastSide::Neither,
        Some((corner, Corner::Normal(normal))) => (place - corner).dot(normal),
        None => (to - from).perp_dot(place - from),
    };
    // On the line itself, as a line on whole meters may have posts, is land.
    if to_the_left >= 0.0 { CoastSide::Land } else { CoastSide::Sea }
}

/// The lines that begin and end at each place.
struct LineEnds {
    /// The segment of a line that leaves each place, and of another that arrives there, while each is the only one.
    at: BTreeMap<VertexKey, [CoastEnds; 2]>,
}

/// How many lines begin, or end, at a place, and the direction of the last of them.
#[derive(Clone, Copy, Debug, Default)]
struct CoastEnds {
    lines: usize,
    along: DVec2,
}

impl LineEnds {
    fn of(lines: &[Vec<DVec2>]) -> Self {
        let mut at: BTreeMap<VertexKey, [CoastEnds; 2]> = BTreeMap::new();
        for line in lines {
            if let ([first, second, ..], [.., before, last]) = (&line[..], &line[..]) {
                for (place, which, along) in [(first, 0, *second - *first), (last, 1, *last - *before)] {
                    let meeting = &mut at.entry(vertex_key(*place)).or_default()[which];
                    *meeting = CoastEnds { lines: meeting.lines + 1, along };
                }
            }
        }
        Self { at }
    }

    /// The corner at a vertex of a line.
    fn corner(&self, line: &[DVec2], index: usize) -> Corner {
        let normal = |before: DVec2, after: DVec2| {
            Corner::Normal((before.normalize_or_zero() + after.normalize_or_zero()).perp())
        };
        if (1..line.len() - 1).contains(&index) {
            return normal(line[index] - line[index - 1], line[index + 1] - line[index]);
        }
        match self.at.get(&vertex_key(line[index])) {
            Some([leaving, arriving]) if leaving.lines == 1 && arriving.lines == 1 => {
                normal(arriving.along, leaving.along)
            }
            _ => Corner::Open,
        }
    }
}

/// # Errors
/// The ground on the right of the lines is higher than that on their left.
fn check_direction(lattice: &Lattice, sides: &[CoastSide]) -> Result<(), CoastError> {
    let mean = |wanted: CoastSide| {
        let heights = sides
            .iter()
            .zip(lattice.heights())
            .filter(|(side, height)| **side == wanted && height.is_finite());
        let (sum, count) =
            heights.fold((0.0, 0u32), |(sum, count), (_, height)| (sum + f64::from(*height), count + 1));
        (count > 0).then(|| sum / f64::from(count))
    };
    match (mean(CoastSide::Sea), mean(CoastSide::Land)) {
        (Some(sea_m), Some(land_m)) if sea_m > land_m + NOISE_M => {
            Err(CoastError::LandOnTheRight(sea_m - land_m))
        }
        _ => Ok(()),
    }
}

/// Gives every post without a side that of the nearest one with it, by steps east, north, west and south.
fn spread(lattice: &Lattice, sides: &mut [CoastSide]) {
    let mut queue: VecDeque<usize> =
        (0..sides.len()).filter(|&index| sides[index] != CoastSide::Untold).collect();
    let columns = lattice.columns() as usize;
    while let Some(index) = queue.pop_front() {
        for other in neighbors::sides(index, columns, sides.len()).into_iter().flatten() {
            if sides[other] == CoastSide::Untold {
                sides[other] = sides[index];
                queue.push_back(other);
            }
        }
    }
}

/// Moves the ground.
fn shape(lattice: &mut Lattice, sides: &[CoastSide], sea: SeaGround<'_>) -> CoastChanges {
    let mut changes = CoastChanges::default();
    let cell_m2 = lattice.cell_m2();
    let least_m = sea.level_m + LEAST_LAND_M;
    for index in 0..sides.len() {
        let post = lattice.post_at(index);
        let height_m = lattice.height(post);
        let new_m = match sides[index] {
            CoastSide::Sea => {
                changes.sea_posts += 1;
                let above_m = f64::from(height_m) - f64::from(sea.level_m);
                changes.highest_cut_m = changes.highest_cut_m.max(above_m);
                if sea.holds_depths && height_m < sea.level_m { height_m } else { sea.level_m }
            }
            CoastSide::Land if height_m < least_m => {
                let is_at_sea =
                    sea.is_water.get(index) == Some(&true) || is_beside_sea(lattice, sides, index);
                changes.raised_posts += usize::from(is_at_sea);
                if is_at_sea { least_m } else { height_m }
            }
            _ => height_m,
        };
        if new_m.to_bits() != height_m.to_bits() {
            changes.volumes += Volumes::from_rise(f64::from(new_m) - f64::from(height_m), cell_m2);
            lattice.heights_mut(post, post.column)[0] = new_m;
        }
    }
    changes
}

/// Whether one of the eight posts around a post lies in the sea.
fn is_beside_sea(lattice: &Lattice, sides: &[CoastSide], index: usize) -> bool {
    let around = neighbors::neighbors(index, lattice.columns() as usize, lattice.rows() as usize);
    around.map(|(_, other)| sides[other]).any(|side| side == CoastSide::Sea)
}

#[cfg(test)]
mod tests {
    use super::*;
    use sandtable_geom::polygon;

    const SEA: SeaGround<'static> = SeaGround { level_m: 0.0, holds_depths: false, is_water: &[] };

    fn level_ground(height_m: f32) -> Lattice {
        let (columns, rows) = (81, 61);
        Lattice::new(
            DVec2::new(500_000.0, 0.0),
            DVec2::new(10.0, 7.0),
            columns,
            vec![height_m; (columns * rows) as usize],
        )
        .expect("sound")
    }

    /// A closed line counter-clockwise that winds in and out around the middle of the ground: an island.
    fn island() -> Vec<DVec2> {
        let vertex = |index: u32| {
            let angle = f64::from(index % 90) * std::f64::consts::TAU / 90.0;
            let reach = 150.0 * (1.0 + 0.3 * libm::sin(angle * 7.0));
            DVec2::new(401.0, 209.0) + DVec2::new(libm::cos(angle), libm::sin(angle)) * reach
        };
        (0..=90).map(vertex).collect()
    }

    fn is_on_island(lattice: &Lattice, post: Post) -> bool {
        polygon::contains([&island()[..90]], lattice.position(post).as_dvec2())
    }

    #[test]
    fn an_island_and_a_bay_end_where_their_coast_runs() {
        for bay in [false, true] {
            let mut lattice = level_ground(3.0);
            let mut coast = island();
            if bay {
                coast.reverse();
            }
            let changes = follow(&mut lattice, &[coast], SEA).expect("sound");
            let sea = |post: Post| is_on_island(&lattice, post) == bay;
            for post in lattice.posts() {
                assert_eq!(lattice.height(post) == 0.0, sea(post), "{post:?}");
            }
            assert_eq!(changes.sea_posts, lattice.posts().filter(|&post| sea(post)).count());
            assert_eq!(changes.volumes.cut_m3, changes.sea_posts as f64 * 3.0 * 70.0);
            assert_eq!((changes.volumes.fill_m3, changes.highest_cut_m), (0.0, 3.0));
        }
    }

    #[test]
    fn a_coast_in_pieces_is_one_line_in_any_order() {
        let coast = island();
        let mut whole = level_ground(3.0);
        follow(&mut whole, std::slice::from_ref(&coast), SEA).expect("sound");
        let pieces = [&coast[60..], &coast[..21], &coast[20..41], &coast[40..61]].map(<[DVec2]>::to_vec);
        let mut parted = level_ground(3.0);
        follow(&mut parted, &pieces, SEA).expect("sound");
        assert!(whole.heights() == parted.heights());
    }

    #[test]
    fn land_beside_the_sea_rises_above_it_and_depths_stay() {
        let mut lattice = level_ground(-4.0);
        let sea = SeaGround { holds_depths: true, ..SEA };
        follow(&mut lattice, &[island()], sea).expect("sound");
        for post in lattice.posts() {
            let on_island = is_on_island(&lattice, post);
            let height_m = lattice.height(post);
            assert!(height_m == -4.0 || (on_island && height_m == LEAST_LAND_M), "{post:?} at {height_m} m");
        }
        let middle = Post { column: 40, row: 30 };
        assert_eq!(lattice.height(middle), -4.0, "a polder behind a dike");
        let is_water = vec![true; lattice.heights().len()];
        follow(&mut lattice, &[island()], SeaGround { is_water: &is_water, ..sea }).expect("sound");
        assert_eq!(lattice.height(middle), LEAST_LAND_M, "what would be drawn as sea");
    }

    #[test]
    fn the_ground_beside_an_open_end_stays_as_it_is() {
        let mut lattice = level_ground(3.0);
        // From the western border to the middle, with the land in the north.
        let coast = vec![DVec2::new(400.0, 200.0), DVec2::new(-100.0, 200.0)];
        let coast: Vec<DVec2> = coast.into_iter().rev().collect();
        follow(&mut lattice, &[coast], SEA).expect("sound");
        let height = |column, row| lattice.height(Post { column, row });
        assert_eq!((height(10, 5), height(10, 50), height(70, 5)), (0.0, 3.0, 3.0));
    }

    #[test]
    fn a_coast_with_the_land_on_its_right_is_refused() {
        let columns = 81;
        let heights: Vec<f32> = (0..columns * 61).map(|index| (index / columns) as f32).collect();
        let slope =
            || Lattice::new(DVec2::ZERO, DVec2::splat(10.0), columns, heights.clone()).expect("sound");
        let coast = vec![DVec2::new(-50.0, 101.0), DVec2::new(900.0, 101.0)];
        let reversed = coast.iter().rev().copied().collect();
        let mut lattice = slope();
        assert_eq!(follow(&mut lattice, &[reversed], SEA), Err(CoastError::LandOnTheRight(30.5)));
        assert!(lattice.heights() == slope().heights(), "it is as it was");
        follow(&mut lattice, &[coast], SEA).expect("land in the north");
        let height = |row| lattice.height(Post { column: 40, row });
        assert_eq!((height(10), height(11)), (0.0, 11.0));
    }
}
