//! Leveling: flat ground within a polygon, with the volumes moved.

use std::ops::Range;

use glam::DVec2;

use sandtable_geom::polygon;
use sandtable_geom::rect::Rect;
use sandtable_terrain::lattice::{Lattice, Post};
use sandtable_terrain::volumes::Volumes;

/// Levels the ground within a polygon to `level_m`, so that it is perfectly flat.
///
/// Every corner of every cell that the polygon touches is set to the level and pinned; posts without data get it too.
/// `rings` are the outer ring and its holes in world coordinates.
pub fn level(lattice: &mut Lattice, rings: &[Vec<DVec2>], level_m: f32) -> Volumes {
    let mut volumes = Volumes::default();
    for post in posts_touched(lattice, rings) {
        let rise_m = f64::from(level_m) - f64::from(lattice.height(post));
        volumes += Volumes::from_rise(rise_m, lattice.cell_m2());
        lattice.pin(post, level_m);
    }
    volumes
}

/// The corners of all cells that the polygon touches, in row order.
///
/// Costs one step for each row an edge crosses and each cell the polygon touches, whatever the lattice's size.
pub(crate) fn posts_touched(lattice: &Lattice, rings: &[Vec<DVec2>]) -> Vec<Post> {
    let to_grid = |point: DVec2| lattice.grid_at(point);
    let edges = || rings.iter().flat_map(|ring| polygon::edges(ring)).map(|(a, b)| (to_grid(a), to_grid(b)));
    let mut touched = Touched::new(lattice, Rect::around(rings.iter().flatten().copied().map(to_grid)));
    edges().for_each(|(from, to)| touched.mark_line(from, to));
    touched.mark_inside(edges());
    touched.posts()
}

/// Marks of posts in the window of cells that a polygon may touch.
struct Touched {
    columns: Range<usize>,
    rows: Range<usize>,
    /// One for each corner of the window's cells, row by row.
    marks: Vec<bool>,
}

impl Touched {
    /// No marks, in the cells of the lattice that `bounds`, in grid coordinates, meets.
    fn new(lattice: &Lattice, bounds: Rect) -> Self {
        let last = lattice.last_grid();
        let cell = |at: DVec2| at.clamp(DVec2::ZERO, last);
        let (low, high) = (cell(bounds.min.floor()), cell(bounds.max.floor() + 1.0));
        let (columns, rows) = (low.x as usize..high.x as usize, low.y as usize..high.y as usize);
        let marks = vec![false; (columns.len() + 1) * (rows.len() + 1)];
        Self { columns, rows, marks }
    }

    /// Marks the corners of the cells `first` to `last`, ends included, of a row of cells, as far as the window reaches.
    fn mark(&mut self, row: usize, first: f64, last: f64) {
        let first = first.max(self.columns.start as f64);
        let last = last.min(self.columns.end as f64 - 1.0);
        if first > last {
            return;
        }
        let stride = self.columns.len() + 1;
        let span = first as usize - self.columns.start..last as usize + 2 - self.columns.start;
        for line in [row - self.rows.start, row - self.rows.start + 1] {
            self.marks[line * stride + span.start..line * stride + span.end].fill(true);
        }
    }

    /// Marks the cells that a line in grid coordinates passes through, row by row of cells.
    fn mark_line(&mut self, from: DVec2, to: DVec2) {
        let (low, high) = if from.y <= to.y { (from, to) } else { (to, from) };
        let first_row = low.y.floor().max(self.rows.start as f64);
        let last_row = high.y.floor().min(self.rows.end as f64 - 1.0);
        if first_row > last_row {
            return;
        }
        for row in first_row as usize..=last_row as usize {
            let (enter, leave) = if high.y > low.y {
                (x_at(low, high, row as f64), x_at(low, high, row as f64 + 1.0))
            } else {
                (low.x, high.x)
            };
            self.mark(row, enter.min(leave).floor(), enter.max(leave).floor());
        }
    }

    /// Marks the cells whose middle lies inside by the even-odd rule over all edges, row by row.
    fn mark_inside(&mut self, edges: impl Iterator<Item = (DVec2, DVec2)>) {
        let rising = edges.map(|(from, to)| if from.y <= to.y { (from, to) } else { (to, from) });
        let mut waiting: Vec<(DVec2, DVec2)> = rising.collect();
        waiting.sort_by(|a, b| a.0.y.total_cmp(&b.0.y));
        let mut waiting = waiting.into_iter().peekable();
        let (mut crossed, mut crossings) = (Vec::new(), Vec::new());
        for row in self.rows.clone() {
            let y = row as f64 + 0.5;
            while let Some(edge) = waiting.next_if(|(low, _)| low.y <= y) {
                crossed.push(edge);
            }
            crossed.retain(|(_, high)| high.y > y);
            crossings.clear();
            crossings.extend(crossed.iter().map(|&(low, high)| x_at(low, high, y)));
            crossings.sort_by(f64::total_cmp);
            for pair in crossings.chunks_exact(2) {
                self.mark(row, (pair[0] - 0.5).ceil(), (pair[1] - 0.5).ceil() - 1.0);
            }
        }
    }

    /// The marked posts, row by row.
    fn posts(&self) -> Vec<Post> {
        let stride = self.columns.len() + 1;
        let post = |index: usize| Post {
            column: (self.columns.start + index % stride) as u32,
            row: (self.rows.start + index / stride) as u32,
        };
        let marked = self.marks.iter().enumerate().filter(|(_, mark)| **mark);
        marked.map(|(index, _)| post(index)).collect()
    }
}

/// The x at which a line that rises from `low` to `high` reaches `y`, or of its nearest end.
fn x_at(low: DVec2, high: DVec2, y: f64) -> f64 {
    low.x + (high.x - low.x) * ((y - low.y) / (high.y - low.y)).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn slope() -> Lattice {
        let heights = (0..121).map(|index| (index % 11) as f32).collect();
        Lattice::new(DVec2::ZERO, DVec2::splat(10.0), 11, heights).expect("sound")
    }

    #[test]
    fn all_of_the_polygon_lies_on_level_cells() {
        let mut lattice = slope();
        let ring = vec![DVec2::new(32.0, 32.0), DVec2::new(58.0, 41.0), DVec2::new(44.0, 67.0)];
        level(&mut lattice, std::slice::from_ref(&ring), 5.0);
        for step in 0..200 {
            let (from, to) = polygon::edges(&ring).nth(step % 3).expect("three edges");
            let at = from.lerp(to, f64::from(step as u32 / 3) / 66.0).lerp(DVec2::new(44.0, 45.0), 0.001);
            let (cell, _) = lattice.cell_at(at).expect("inside");
            assert_eq!(lattice.corner_heights(cell), [5.0; 4], "at {at}");
        }
        assert_eq!(lattice.height(Post { column: 9, row: 9 }), 9.0);
    }

    #[test]
    fn volumes_count_the_earth_moved() {
        let mut lattice = slope();
        let cell = vec![DVec2::new(31.0, 31.0), DVec2::new(39.0, 31.0), DVec2::new(35.0, 39.0)];
        let volumes = level(&mut lattice, &[cell], 3.0);
        assert_eq!(volumes, Volumes { cut_m3: 200.0, fill_m3: 0.0 });
    }

    /// A ring with `count` vertices that winds in and out around `center`.
    fn wavy(center: DVec2, radius: f64, count: u32) -> Vec<DVec2> {
        let vertex = |index: u32| {
            let angle = f64::from(index) * std::f64::consts::TAU / f64::from(count);
            let reach = radius * (1.0 + 0.3 * libm::sin(angle * 9.0));
            center + DVec2::new(libm::cos(angle), libm::sin(angle)) * reach
        };
        (0..count).map(vertex).collect()
    }

    #[test]
    fn touched_are_the_posts_of_cells_that_lie_inside_or_on_the_shore() {
        let lattice =
            Lattice::new(DVec2::ZERO, DVec2::new(10.0, 7.0), 41, vec![0.0; 41 * 61]).expect("sound");
        for center in [DVec2::new(200.0, 210.0), DVec2::new(385.0, 20.0), DVec2::new(-30.0, 400.0)] {
            let rings = [wavy(center, 120.0, 90), wavy(center, 41.0, 30)];
            let is_touched = |cell: &Post| {
                let min = lattice.position(*cell).as_dvec2();
                let area = Rect { min, max: min + lattice.cell() };
                polygon::contains(rings.iter().map(Vec::as_slice), area.center())
                    || rings
                        .iter()
                        .flat_map(|ring| polygon::edges(ring))
                        .any(|(from, to)| area.clip_line(from, to).is_some())
            };
            let cells = lattice.posts().filter(|post| post.column < 40 && post.row < 60).filter(is_touched);
            let corners = |cell: Post| {
                [(0, 0), (1, 0), (0, 1), (1, 1)]
                    .map(|(east, north)| Post { column: cell.column + east, row: cell.row + north })
            };
            let mut expected: Vec<Post> = cells.flat_map(corners).collect();
            expected.sort_by_key(|post| (post.row, post.column));
            expected.dedup();
            assert!(expected.len() > 100);
            assert!(posts_touched(&lattice, &rings) == expected, "round {center}");
        }
    }

    #[test]
    fn a_long_shore_over_wide_ground_is_leveled() {
        let side = 1201;
        let heights = vec![1.0; (side * side) as usize];
        let mut lattice = Lattice::new(DVec2::ZERO, DVec2::splat(10.0), side, heights).expect("sound");
        let shore = wavy(DVec2::splat(6000.0), 4500.0, 20_000);
        let area = polygon::doubled_area(&shore) / 2.0;
        let volumes = level(&mut lattice, &[shore], 2.0);
        assert!(volumes.fill_m3 > area && volumes.fill_m3 < area * 1.05, "{volumes:?} over {area} m²");
    }

    #[test]
    fn a_polygon_outside_the_ground_changes_nothing() {
        let mut lattice = slope();
        let ring = vec![DVec2::new(-90.0, -90.0), DVec2::new(-50.0, -90.0), DVec2::new(-60.0, -40.0)];
        assert_eq!(level(&mut lattice, &[ring], 3.0), Volumes::default());
    }
}
