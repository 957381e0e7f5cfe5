//! Coasts: the ground follows coastlines and the outlines of seas and lands, so that the sea ends where they run and not where
//! cells do.
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
//! Polygons need no nearest place: what lies in one is land or sea, and what lies in none is the other where no line says more.

use std::collections::{BTreeMap, VecDeque};

use glam::DVec2;

use crate::coast_polygons::{CoastRings, MOST_CROSSED, PostPlace, post_places};
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

/// What tells the sea from the land, in world coordinates.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Coasts {
    /// Lines with the land on their left. Lines that share an end are one line; closed ones have their first point last.
    pub lines: Vec<Vec<DVec2>>,
    /// Polygons that the sea fills.
    pub seas: Vec<CoastRings>,
    /// Polygons of land, which hold where they lie on those of the sea.
    pub lands: Vec<CoastRings>,
}

/// Coasts that the ground cannot follow.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum CoastError {
    /// The ground on the right is the higher one.
    #[error(
        "the ground on the right of the coast lies {0:.0} m higher than that on its left, on the mean: a coastline has the land \
         on its left"
    )]
    LandOnTheRight(f64),
    /// The ground in the polygons is higher than that of the land, or lower than that of the sea.
    #[error(
        "the ground of the sea that the polygons tell lies {0:.0} m higher than that of the land, on the mean"
    )]
    SeaIsHigher(f64),
    /// There is too much of them.
    #[error(
        "the coast is more than {MOST_STEPS} cells of the ground long; take fewer lines, or a smaller extent"
    )]
    TooLong,
    /// There are too many edges of polygons.
    #[error(
        "the edges of the coast's polygons cross rows of the ground more than {MOST_CROSSED} times; take fewer polygons, or a smaller \
         extent"
    )]
    TooManyEdges,
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

/// Makes the ground follow coasts. Posts without data get the level where they lie in the sea.
///
/// Time and memory grow with the number of posts, and with the length of the lines and outlines on the ground.
///
/// # Errors
/// Sea and land are the wrong way round, or there are too many lines or outlines. The ground is as it was.
pub fn follow(
    lattice: &mut Lattice,
    coasts: &Coasts,
    sea: SeaGround<'_>,
) -> Result<CoastChanges, CoastError> {
    let mut sides = sides_beside(lattice, &coasts.lines)?;
    if let Some(sides) = &mut sides {
        spread(lattice, sides);
    }
    let polygons = [(CoastSide::Sea, &coasts.seas), (CoastSide::Land, &coasts.lands)];
    let has_polygons = polygons.iter().any(|(_, polygons)| !polygons.is_empty());
    if has_polygons {
        sides = sides_in_polygons(lattice, sides, polygons)?;
    }
    let Some(sides) = sides else { return Ok(CoastChanges::default()) };
    if let Some(above_m) = sea_above_land_m(lattice, &sides) {
        let error = if has_polygons { CoastError::SeaIsHigher } else { CoastError::LandOnTheRight };
        return Err(error(above_m));
    }
    Ok(shape(lattice, &sides, sea))
}

/// The sides of all posts where polygons of the sea and of land lie on the ground, which lines give the sides `by_lines`;
/// as these are where none does.
fn sides_in_polygons(
    lattice: &Lattice,
    by_lines: Option<Vec<CoastSide>>,
    polygons: [(CoastSide, &Vec<CoastRings>); 2],
) -> Result<Option<Vec<CoastSide>>, CoastError> {
    let mut within: Vec<CoastSide> = Vec::new();
    let mut has = [false; 2];
    for ((side, polygons), has) in polygons.into_iter().zip(&mut has) {
        let places = if polygons.is_empty() { Vec::new() } else { post_places(lattice, polygons)? };
        // A border is land, as a line is.
        let is_within = |place: PostPlace| match side {
            CoastSide::Sea => place == PostPlace::Inside,
            _ => place != PostPlace::Outside,
        };
        if places.iter().any(|&place| is_within(place)) {
            *has = true;
            within.resize(places.len(), CoastSide::Untold);
            let inside = within.iter_mut().zip(places).filter(|(_, place)| is_within(*place));
            inside.for_each(|(within, _)| *within = side);
        }
    }
    let elsewhere = match has {
        [false, false] => return Ok(by_lines),
        [true, false] => CoastSide::Land,
        [false, true] => CoastSide::Sea,
        [true, true] => CoastSide::Neither,
    };
    let untold = within.iter_mut().enumerate().filter(|(_, side)| **side == CoastSide::Untold);
    untold.for_each(|(index, side)| *side = by_lines.as_ref().map_or(elsewhere, |sides| sides[index]));
    Ok(Some(within))
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

/// By how much the ground of the sea lies higher than that of the land, on the mean, in meters; `None` where that is no more
/// than noise.
fn sea_above_land_m(lattice: &Lattice, sides: &[CoastSide]) -> Option<f64> {
    let mean = |wanted: CoastSide| {
        let heights = sides
            .iter()
            .zip(lattice.heights())
            .filter(|(side, height)| **side == wanted && height.is_finite());
        let (sum, count) =
            heights.fold((0.0, 0u32), |(sum, count), (_, height)| (sum + f64::from(*height), count + 1));
        (count > 0).then(|| sum / f64::from(count))
    };
    let above_m = mean(CoastSide::Sea)? - mean(CoastSide::Land)?;
    (above_m > NOISE_M).then_some(above_m)
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

    fn lines(lines: &[Vec<DVec2>]) -> Coasts {
        Coasts { lines: lines.to_vec(), ..Coasts::default() }
    }

    /// The island as a polygon of land, or the sea around it with the island as a hole.
    fn polygons(is_sea: bool) -> Coasts {
        let island = island()[..90].to_vec();
        let far = [(-1e4, -1e4), (1e4, -1e4), (1e4, 1e4), (-1e4, 1e4)].map(DVec2::from).to_vec();
        let (seas, lands) =
            if is_sea { (vec![vec![far, island]], vec![]) } else { (vec![], vec![vec![island]]) };
        Coasts { seas, lands, ..Coasts::default() }
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
            let changes = follow(&mut lattice, &lines(&[coast]), SEA).expect("sound");
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
    fn a_coast_gives_the_same_ground_as_a_line_as_land_and_as_sea() {
        let mut by_line = level_ground(3.0);
        let changes = follow(&mut by_line, &lines(&[island()]), SEA).expect("sound");
        for is_sea in [false, true] {
            let mut by_polygon = level_ground(3.0);
            assert_eq!(follow(&mut by_polygon, &polygons(is_sea), SEA), Ok(changes));
            assert!(by_polygon.heights() == by_line.heights(), "{is_sea}");
        }
        let mut both = level_ground(3.0);
        let coasts = Coasts { lands: polygons(false).lands, ..polygons(true) };
        follow(&mut both, &coasts, SEA).expect("sound");
        assert!(both.heights() == by_line.heights());
    }

    #[test]
    fn polygons_off_the_ground_and_those_of_the_wrong_kind_change_nothing() {
        let off = [(2e4, 0.0), (3e4, 0.0), (3e4, 500.0)].map(DVec2::from).to_vec();
        let cone = |post: Post, lattice: &Lattice| if is_on_island(lattice, post) { 40.0 } else { 0.0 };
        let mut lattice = level_ground(0.0);
        for post in lattice.posts().collect::<Vec<_>>() {
            let height_m = cone(post, &lattice);
            lattice.heights_mut(post, post.column)[0] = height_m;
        }
        let before = lattice.clone();
        let lands = Coasts { lands: vec![vec![off]], ..Coasts::default() };
        assert_eq!(follow(&mut lattice, &lands, SEA), Ok(CoastChanges::default()));
        let island_as_sea = Coasts { seas: polygons(false).lands, ..Coasts::default() };
        assert_eq!(follow(&mut lattice, &island_as_sea, SEA), Err(CoastError::SeaIsHigher(40.0)));
        assert!(lattice.heights() == before.heights());
    }

    #[test]
    fn a_coast_in_pieces_is_one_line_in_any_order() {
        let coast = island();
        let mut whole = level_ground(3.0);
        follow(&mut whole, &lines(std::slice::from_ref(&coast)), SEA).expect("sound");
        let pieces = [&coast[60..], &coast[..21], &coast[20..41], &coast[40..61]].map(<[DVec2]>::to_vec);
        let mut parted = level_ground(3.0);
        follow(&mut parted, &lines(&pieces), SEA).expect("sound");
        assert!(whole.heights() == parted.heights());
    }

    #[test]
    fn land_beside_the_sea_rises_above_it_and_depths_stay() {
        let mut lattice = level_ground(-4.0);
        let sea = SeaGround { holds_depths: true, ..SEA };
        follow(&mut lattice, &lines(&[island()]), sea).expect("sound");
        for post in lattice.posts() {
            let on_island = is_on_island(&lattice, post);
            let height_m = lattice.height(post);
            assert!(height_m == -4.0 || (on_island && height_m == LEAST_LAND_M), "{post:?} at {height_m} m");
        }
        let middle = Post { column: 40, row: 30 };
        assert_eq!(lattice.height(middle), -4.0, "a polder behind a dike");
        let is_water = vec![true; lattice.heights().len()];
        follow(&mut lattice, &lines(&[island()]), SeaGround { is_water: &is_water, ..sea }).expect("sound");
        assert_eq!(lattice.height(middle), LEAST_LAND_M, "what would be drawn as sea");
    }

    #[test]
    fn the_ground_beside_an_open_end_stays_as_it_is() {
        let mut lattice = level_ground(3.0);
        // From the western border to the middle, with the land in the north.
        let coast = vec![DVec2::new(400.0, 200.0), DVec2::new(-100.0, 200.0)];
        let coast: Vec<DVec2> = coast.into_iter().rev().collect();
        follow(&mut lattice, &lines(&[coast]), SEA).expect("sound");
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
        assert_eq!(follow(&mut lattice, &lines(&[reversed]), SEA), Err(CoastError::LandOnTheRight(30.5)));
        assert!(lattice.heights() == slope().heights(), "it is as it was");
        follow(&mut lattice, &lines(&[coast]), SEA).expect("land in the north");
        let height = |row| lattice.height(Post { column: 40, row });
        assert_eq!((height(10), height(11)), (0.0, 11.0));
    }
}
