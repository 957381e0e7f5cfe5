//! Where posts lie to polygons: inside, outside or on the border of the area that they cover together.
//!
//! Polygons of a coast are often tiles of one shape, which share edges or overlap; such an edge is no coast. So a post is
//! looked at on four sides, above and below its row, left and right of itself, and only those of its sides that no polygon
//! covers make it a border:
//!
//! ```text
//!   inside │ inside     a shared edge: inside            inside │ outside     a coast: on the border
//!   ───────·───────                                      ───────·────────
//!   inside │ inside                                      inside │ outside
//! ```
//!
//! Winding numbers of all polygons are added up along rows, from where edges cross them: the time is that of the edges on the
//! ground, however many polygons cover a post.

use std::ops::Range;

use glam::DVec2;

use crate::coast::CoastError;
use sandtable_geom::polygon::{doubled_area, edges};
use sandtable_terrain::lattice::{Lattice, Post};

/// The rings of a polygon in world coordinates, the outer one first; each without its first point repeated.
pub type CoastRings = Vec<Vec<DVec2>>;

/// Where a post lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum PostPlace {
    Outside,
    Border,
    Inside,
}

/// As many posts are looked at at a time: 16 bytes each.
const BAND_POSTS: usize = 1 << 22;

/// The most rows that all edges cross.
pub(crate) const MOST_CROSSED: usize = 50_000_000;

/// The place of every post of a lattice to the polygons together. Rings may run either way round.
///
/// # Errors
/// Their edges cross more than [`MOST_CROSSED`] rows of the ground.
pub(crate) fn post_places(lattice: &Lattice, polygons: &[CoastRings]) -> Result<Vec<PostPlace>, CoastError> {
    let at = |column: u32, row: u32| lattice.position(Post { column, row }).as_dvec2();
    let xs: Vec<f64> = (0..lattice.columns()).map(|column| at(column, 0).x).collect();
    let ys: Vec<f64> = (0..lattice.rows()).map(|row| at(0, row).y).collect();
    let all_edges = || polygons.iter().flat_map(|rings| oriented_edges(rings));
    let mut crossed = 0;
    for (from, to) in all_edges() {
        crossed += rows_crossed(&ys, from.y.min(to.y), from.y.max(to.y)).len();
        if crossed > MOST_CROSSED {
            return Err(CoastError::TooManyEdges);
        }
    }
    let mut places = Vec::with_capacity(lattice.heights().len());
    for rows in ys.chunks((BAND_POSTS / xs.len()).max(1)) {
        let mut band = WindingBand::new(&xs, rows);
        all_edges().for_each(|(from, to)| band.add(from, to));
        band.write_places(&mut places);
    }
    Ok(places)
}

/// The rows from `low` to `high`, both among them.
fn rows_crossed(ys: &[f64], low: f64, high: f64) -> Range<usize> {
    let first = ys.partition_point(|&y| y < low);
    first..ys.partition_point(|&y| y <= high).max(first)
}

/// The edges of a polygon, with the outer ring counter-clockwise and the others clockwise.
fn oriented_edges(rings: &[Vec<DVec2>]) -> impl Iterator<Item = (DVec2, DVec2)> + '_ {
    rings.iter().enumerate().flat_map(|(index, ring)| {
        let is_reversed = (doubled_area(ring) < 0.0) == (index == 0);
        edges(ring).map(move |(from, to)| if is_reversed { (to, from) } else { (from, to) })
    })
}

/// The winding numbers beside the posts of some rows, as changes from west to east: of every row two numbers a post, those of
/// the places just left and just right of it.
struct WindingBand<'a> {
    xs: &'a [f64],
    ys: &'a [f64],
    above: Vec<i32>,
    below: Vec<i32>,
}

impl<'a> WindingBand<'a> {
    fn new(xs: &'a [f64], ys: &'a [f64]) -> Self {
        let changes = || vec![0; 2 * xs.len() * ys.len()];
        Self { xs, ys, above: changes(), below: changes() }
    }

    /// Adds an edge.
    fn add(&mut self, from: DVec2, to: DVec2) {
        let (low, high, winding) = if from.y <= to.y { (from, to, -1) } else { (to, from, 1) };
        if low.y == high.y {
            return;
        }
        for row in rows_crossed(self.ys, low.y, high.y) {
            let y = self.ys[row];
            let Some(slot) = self.first_slot_right(low, high, y) else { continue };
            let at = row * 2 * self.xs.len() + slot;
            if y < high.y {
                self.above[at] += winding;
            }
            if y > low.y {
                self.below[at] += winding;
            }
        }
    }

    /// The first of a row's numbers that lies right of an edge: that to the right of a post where the edge runs through it.
    fn first_slot_right(&self, low: DVec2, high: DVec2, y: f64) -> Option<usize> {
        let to_the_left = |x: f64| (high - low).perp_dot(DVec2::new(x, y) - low);
        let about = low.x + (y - low.y) / (high.y - low.y) * (high.x - low.x);
        // The division rounds; the side of the posts next to it is exact as far as that of lines is.
        let mut column = self.xs.partition_point(|&x| x < about).saturating_sub(1);
        while column < self.xs.len() && to_the_left(self.xs[column]) > 0.0 {
            column += 1;
        }
        let x = self.xs.get(column)?;
        Some(2 * column + usize::from(to_the_left(*x) == 0.0))
    }

    /// Adds the places of the posts to `places`.
    fn write_places(&self, places: &mut Vec<PostPlace>) {
        let across = 2 * self.xs.len();
        for (above, below) in self.above.chunks_exact(across).zip(self.below.chunks_exact(across)) {
            let mut winding = [0; 2];
            for (above, below) in above.chunks_exact(2).zip(below.chunks_exact(2)) {
                let mut covered = 0;
                for side in 0..2 {
                    winding = [winding[0] + above[side], winding[1] + below[side]];
                    covered += winding.iter().filter(|&&winding| winding != 0).count();
                }
                places.push(match covered {
                    0 => PostPlace::Outside,
                    4 => PostPlace::Inside,
                    _ => PostPlace::Border,
                });
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sandtable_geom::polygon;

    fn ground() -> Lattice {
        Lattice::new(DVec2::ZERO, DVec2::splat(10.0), 21, vec![0.0; 21 * 15]).expect("sound")
    }

    fn places(polygons: &[CoastRings]) -> Vec<PostPlace> {
        post_places(&ground(), polygons).expect("few edges")
    }

    fn rectangle(west: f64, south: f64, east: f64, north: f64) -> Vec<DVec2> {
        [(west, south), (east, south), (east, north), (west, north)].map(DVec2::from).to_vec()
    }

    #[test]
    fn slanting_outlines_with_holes_hold_the_posts_that_lie_in_them() {
        let ring = |reach: f64, spikes: f64| -> Vec<DVec2> {
            let vertex = |index: i32| {
                let angle = f64::from(index) * std::f64::consts::TAU / 60.0;
                let reach = reach * (1.0 + 0.3 * libm::sin(angle * spikes));
                DVec2::new(101.3, 68.7) + DVec2::new(libm::cos(angle), libm::sin(angle)) * reach
            };
            (0..60).map(vertex).collect()
        };
        for reverses in [[false, false], [true, false], [false, true], [true, true]] {
            let mut rings = vec![ring(64.0, 5.0), ring(25.0, 3.0)];
            rings.iter_mut().zip(reverses).for_each(|(ring, reversed)| {
                if reversed {
                    ring.reverse();
                }
            });
            for (index, place) in places(std::slice::from_ref(&rings)).into_iter().enumerate() {
                let at = DVec2::new((index % 21) as f64, (index / 21) as f64) * 10.0;
                let inside = polygon::contains(rings.iter().map(Vec::as_slice), at);
                assert_eq!(place, if inside { PostPlace::Inside } else { PostPlace::Outside }, "{at}");
            }
        }
    }

    #[test]
    fn posts_on_an_outline_are_on_the_border_and_those_on_a_shared_edge_are_inside() {
        let whole = places(&[vec![rectangle(20.0, 30.0, 160.0, 90.0)]]);
        let at = |places: &[PostPlace], x: usize, y: usize| places[y / 10 * 21 + x / 10];
        for (x, y) in [(20, 30), (20, 60), (160, 90), (90, 30), (90, 90), (160, 40)] {
            assert_eq!(at(&whole, x, y), PostPlace::Border, "{x} {y}");
        }
        let tiles = [rectangle(20.0, 30.0, 80.0, 60.0), rectangle(80.0, 30.0, 160.0, 60.0)];
        let overlapping = [rectangle(20.0, 60.0, 110.0, 90.0), rectangle(100.0, 60.0, 160.0, 90.0)];
        let tiles = tiles.into_iter().chain(overlapping).map(|ring| vec![ring]);
        assert_eq!(places(&tiles.collect::<Vec<_>>()), whole);
    }

    #[test]
    fn outlines_far_beyond_the_ground_cover_all_of_it() {
        let around = places(&[vec![rectangle(-1e6, -1e6, 1e6, 1e6)]]);
        assert!(around.iter().all(|place| *place == PostPlace::Inside));
        assert!(places(&[vec![rectangle(300.0, 0.0, 400.0, 50.0)]]).iter().all(|p| *p == PostPlace::Outside));
        assert!(places(&[]).iter().all(|place| *place == PostPlace::Outside));
    }

    #[test]
    fn more_edges_than_can_be_followed_are_refused() {
        let tall = Lattice::new(DVec2::ZERO, DVec2::ONE, 2, vec![0.0; 2 * 5001]).expect("sound");
        let zigzag = (0..11_000).map(|index| DVec2::new(f64::from(index % 7), f64::from(index % 2) * 5e3));
        assert_eq!(post_places(&tall, &[vec![zigzag.collect()]]), Err(CoastError::TooManyEdges));
    }
}
