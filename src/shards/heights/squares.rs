//! The squares of a raster, and the shards that their points go to.

use glam::DVec2;

use sandtable_geom::morton;
use sandtable_geom::rect::Rect;
use sandtable_raster::windows::RasterWindow;

/// The side of a square in samples: as large as the tiles of most files.
const SQUARE: u32 = 256;
/// Samples around a point that interpolations may need.
pub const HALO: u32 = 3;

/// The squares of a raster, and how many points lie in each.
pub struct PointSquares {
    size: (u32, u32),
    across: u32,
    counts: Vec<u64>,
}

/// Where the points of a square go: to one shard, or, where these are too many for one, to some in turn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct SquareRoute {
    first: u32,
    /// Points for each shard but the last.
    each: u64,
    seen: u64,
}

/// The shards of points, by their squares.
pub struct PointRoutes {
    size: (u32, u32),
    across: u32,
    routes: Vec<SquareRoute>,
}

/// A shard of points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PointShard {
    /// Its points.
    pub count: u64,
    /// The squares that they lie in.
    pub window: RasterWindow,
}

/// The square of a position in the grid of a raster; of one beyond it the nearest.
fn square((width, height): (u32, u32), across: u32, grid: DVec2) -> usize {
    let last = DVec2::new(f64::from(width - 1), f64::from(height - 1));
    // What is no number becomes 0.
    let sample = grid.clamp(DVec2::ZERO, last).as_uvec2() / SQUARE;
    sample.y as usize * across as usize + sample.x as usize
}

impl PointSquares {
    /// The squares of a raster with so many samples per row and rows, without points.
    pub fn new(size: (u32, u32)) -> Self {
        let (across, down) = (size.0.div_ceil(SQUARE), size.1.div_ceil(SQUARE));
        Self { size, across, counts: vec![0; across as usize * down as usize] }
    }

    /// Counts a point at a position in the raster's grid.
    pub fn add(&mut self, grid: DVec2) {
        self.counts[square(self.size, self.across, grid)] += 1;
    }

    /// Parts the points into shards of about `each`, of neighboring squares, and none of more than half as many again.
    pub fn part(self, each: u64) -> (PointRoutes, Vec<PointShard>) {
        let (size, across) = (self.size, self.across);
        let used: Vec<usize> = (0..self.counts.len()).filter(|&index| self.counts[index] > 0).collect();
        let window = |index: usize| {
            let (column, row) = (index as u32 % across * SQUARE, index as u32 / across * SQUARE);
            let (width, height) = (SQUARE.min(size.0 - column), SQUARE.min(size.1 - row));
            RasterWindow { column, row, width, height }
        };
        let mut routes = vec![SquareRoute::default(); self.counts.len()];
        let mut shards: Vec<PointShard> = Vec::new();
        for index in along_curve(&used, across) {
            let count = self.counts[index];
            // As many as come nearest to `each`.
            let (parts, window) = (count.saturating_add(each / 2) / each, window(index));
            if parts > 1 {
                let share = count.div_ceil(parts);
                let parts = count.div_ceil(share);
                routes[index] = SquareRoute { first: shards.len() as u32, each: share, seen: 0 };
                let rest = |part: u64| share.min(count - part * share);
                shards.extend((0..parts).map(|part| PointShard { count: rest(part), window }));
                continue;
            }
            match shards.last_mut() {
                Some(last) if last.count + count <= each => {
                    *last = PointShard { count: last.count + count, window: joined(last.window, window) };
                }
                _ => shards.push(PointShard { count, window }),
            }
            routes[index] = SquareRoute { first: shards.len() as u32 - 1, each: u64::MAX, seen: 0 };
        }
        (PointRoutes { size, across, routes }, shards)
    }
}

/// Squares in the order in which neighbors lie near each other.
fn along_curve(squares: &[usize], across: u32) -> Vec<usize> {
    let across = across as usize;
    let corner = |&index: &usize| DVec2::new((index % across) as f64, (index / across) as f64);
    let rects: Vec<Rect> = squares.iter().map(corner).map(|min| Rect { min, max: min + 1.0 }).collect();
    let mut order = vec![0; squares.len()];
    for (&square, rank) in squares.iter().zip(morton::ranks(&rects)) {
        order[rank as usize] = square;
    }
    order
}

/// The smallest window that holds both.
fn joined(a: RasterWindow, b: RasterWindow) -> RasterWindow {
    let (column, row) = (a.column.min(b.column), a.row.min(b.row));
    let (right, bottom) =
        ((a.column + a.width).max(b.column + b.width), (a.row + a.height).max(b.row + b.height));
    RasterWindow { column, row, width: right - column, height: bottom - row }
}

impl PointRoutes {
    /// The shard of the next point, which lies at a position in the raster's grid. Points come in the order in which they
    /// were counted.
    pub fn shard(&mut self, grid: DVec2) -> u32 {
        let route = &mut self.routes[square(self.size, self.across, grid)];
        let part = route.seen.checked_div(route.each).unwrap_or(0);
        route.seen += 1;
        route.first + part as u32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Points that lie unevenly, some beyond the raster and one nowhere.
    fn points() -> Vec<DVec2> {
        let spread =
            (0..5000).map(|index| DVec2::new(f64::from(index * 37 % 1100) - 20.0, f64::from(index % 900)));
        let dense = (0..3000).map(|index| DVec2::new(300.0 + f64::from(index % 7), 300.0));
        spread.chain(dense).chain([DVec2::NAN]).collect()
    }

    #[test]
    fn every_shard_gets_as_many_points_as_were_counted_for_it() {
        let points = points();
        for each in [1, 2, 3, 13, 30, 100, 700, 100_000] {
            let mut squares = PointSquares::new((1000, 800));
            points.iter().for_each(|&point| squares.add(point));
            let (mut routes, shards) = squares.part(each);
            let mut counts = vec![0; shards.len()];
            points.iter().for_each(|&point| counts[routes.shard(point) as usize] += 1);
            assert_eq!(counts, shards.iter().map(|shard| shard.count).collect::<Vec<u64>>(), "{each}");
            assert!(
                counts.iter().all(|&count| count > 0 && count <= each + each.div_ceil(2)),
                "{each}: {counts:?}"
            );
        }
    }

    #[test]
    fn a_shard_reads_the_squares_that_its_points_lie_in() {
        let points = points();
        let mut squares = PointSquares::new((1000, 800));
        points.iter().for_each(|&point| squares.add(point));
        let (mut routes, shards) = squares.part(900);
        for &point in points.iter().filter(|point| point.is_finite()) {
            let RasterWindow { column, row, width, height } = shards[routes.shard(point) as usize].window;
            let at = point.clamp(DVec2::ZERO, DVec2::new(999.0, 799.0)).as_uvec2();
            assert!(
                (column..column + width).contains(&at.x) && (row..row + height).contains(&at.y),
                "{point}"
            );
        }
    }
}
