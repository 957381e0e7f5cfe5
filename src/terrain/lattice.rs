//! The ground as one lattice of posts.
//!
//! Posts stand at equal distances east and north of an f64 origin, the south-west post; heights are f32 meters,
//! NaN where there is no data. Between posts the ground is the plane of the finest bintree triangles: the
//! diagonal of the cell north-east of post (column, row) joins the two corners whose coordinates are both even
//! or both odd, as longest-edge bisection leaves it:
//!
//! ```text
//! row 2  o───────o───────o
//!        │ ╲     │     ╱ │      posts with both coordinates odd or both even
//!        │   ╲   │   ╱   │      are joined by the diagonals
//! row 1  o───────o───────o
//!        │     ╱ │ ╲     │
//!        │   ╱   │   ╲   │
//! row 0  o───────o───────o
//!        0       1       2  column
//! ```

use glam::{DVec2, Vec2};

use crate::dem::raster::Raster;
use crate::geom::rect::Rect;

/// Posts of a regular grid with their heights.
#[derive(Clone, Debug)]
pub struct Lattice {
    origin: DVec2,
    cell: DVec2,
    columns: u32,
    rows: u32,
    first: Post,
    doublings: u32,
    heights: Vec<f32>,
    pinned: Vec<bool>,
    pin_slack_m: f32,
}

/// No height may lie further from 0 than this many meters: as far as a scene file's elevations go, and little
/// enough that an f32 still tells one meter from the next.
pub const HIGHEST_M: f32 = 1e7;

/// Ground may be drawn this many meters off a pinned post: rounding of f32 heights, invisible in a picture.
const PIN_SLACK_M: f32 = 1e-3;

/// Why a raster cannot become the ground.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LatticeError {
    /// The raster is a single row or column.
    #[error("the elevation model has {0}×{1} samples, at least 2×2 are needed to make a surface")]
    TooSmall(u32, u32),
    /// The raster's rows do not run east with north up.
    #[error("the elevation model's grid is rotated or upside down; it must be warped north-up first")]
    NotNorthUp,
    /// All samples are no-data.
    #[error("the elevation model holds no data at all")]
    Empty,
    /// A height that no ground has: mostly a no-data value that the file does not name as one.
    #[error(
        "the elevation model holds a height of {height:e} m, beyond ±{HIGHEST_M} m; if that stands for no data, the file must say so (its no-data value)"
    )]
    TooHigh {
        /// In meters; may be infinite.
        height: f32,
    },
}

/// A post by column and row, counted from the south-west.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Post {
    /// Eastward.
    pub column: u32,
    /// Northward.
    pub row: u32,
}

impl Lattice {
    /// The lattice of a north-up raster in meters.
    ///
    /// # Errors
    /// See [`LatticeError`].
    pub fn from_raster(raster: &Raster) -> Result<Self, LatticeError> {
        let (columns, rows) = (raster.width, raster.height);
        if columns < 2 || rows < 2 {
            return Err(LatticeError::TooSmall(columns, rows));
        }
        let (origin, cell) = Self::frame(raster)?;
        let heights: Vec<f32> = (0..rows)
            .rev()
            .flat_map(|row| (0..columns).map(move |column| (column, row)))
            .map(|(column, row)| raster.at(column, row) as f32)
            .collect();
        Self::new(origin, cell, columns, heights)
    }

    /// The origin and the cell of the lattice of a north-up raster in meters, whose samples are not looked at.
    ///
    /// # Errors
    /// [`LatticeError::TooSmall`] and [`LatticeError::NotNorthUp`].
    pub fn frame(raster: &Raster) -> Result<(DVec2, DVec2), LatticeError> {
        if raster.width < 2 || raster.height < 2 {
            return Err(LatticeError::TooSmall(raster.width, raster.height));
        }
        let matrix = raster.map_from_grid.matrix2;
        if matrix.x_axis.x <= 0.0
            || matrix.y_axis.y >= 0.0
            || matrix.x_axis.y != 0.0
            || matrix.y_axis.x != 0.0
        {
            return Err(LatticeError::NotNorthUp);
        }
        let origin = raster.map_from_grid.transform_point2(DVec2::new(0.5, f64::from(raster.height) - 0.5));
        Ok((origin, DVec2::new(matrix.x_axis.x, -matrix.y_axis.y)))
    }

    /// A lattice from its heights, row by row from the south-west; all rows full.
    ///
    /// # Errors
    /// See [`LatticeError`].
    pub fn new(origin: DVec2, cell: DVec2, columns: u32, heights: Vec<f32>) -> Result<Self, LatticeError> {
        if !heights.is_empty() && heights.iter().all(|height| height.is_nan()) {
            return Err(LatticeError::Empty);
        }
        Self::part((origin, cell), Post { column: 0, row: 0 }, columns, heights)
    }

    /// A part of a larger lattice with this origin and cell, from the larger one's post `first` on. Posts are counted
    /// from the part's own south-west, and stand where they stand in the larger lattice, to the last bit.
    ///
    /// A part may hold no data at all; [`Lattice::height_range`] is then empty, the infinities the wrong way round.
    ///
    /// # Errors
    /// [`LatticeError::TooSmall`] and [`LatticeError::TooHigh`].
    pub fn part(
        (origin, cell): (DVec2, DVec2),
        first: Post,
        columns: u32,
        heights: Vec<f32>,
    ) -> Result<Self, LatticeError> {
        let rows = heights.len().checked_div(columns as usize).unwrap_or(0) as u32;
        if columns < 2 || rows < 2 || heights.len() != columns as usize * rows as usize {
            return Err(LatticeError::TooSmall(columns, rows));
        }
        if let Some(&height) = heights.iter().find(|height| height.abs() > HIGHEST_M) {
            return Err(LatticeError::TooHigh { height });
        }
        let pinned = vec![false; heights.len()];
        Ok(Self {
            origin,
            cell,
            columns,
            rows,
            first,
            doublings: 0,
            heights,
            pinned,
            pin_slack_m: PIN_SLACK_M,
        })
    }

    /// The lattice that a vertical exaggeration displays: every height times `factor`, which is above 0.
    pub fn exaggerated(&self, factor: f32) -> Self {
        let heights = self.heights.iter().map(|height| height * factor).collect();
        Self { heights, pinned: self.pinned.clone(), pin_slack_m: self.pin_slack_m * factor, ..*self }
    }

    /// Map coordinates of the south-west post: the origin of world space.
    pub fn origin(&self) -> DVec2 {
        self.origin
    }

    /// Meters between posts, eastward and northward.
    pub fn cell(&self) -> DVec2 {
        self.cell
    }

    /// Posts per row.
    pub fn columns(&self) -> u32 {
        self.columns
    }

    /// Rows of posts.
    pub fn rows(&self) -> u32 {
        self.rows
    }

    /// How often posts were doubled on the planes between those that were measured; see
    /// [`crate::terrain::densify`].
    pub fn doublings(&self) -> u32 {
        self.doublings
    }

    /// Notes that posts were doubled so many times.
    pub(in crate::terrain) fn resampled(&mut self, doublings: u32) {
        self.doublings = doublings;
    }

    /// All heights, row by row from the south-west.
    pub fn heights(&self) -> &[f32] {
        &self.heights
    }

    /// The rectangle of all posts in world space, the origin's post at (0, 0).
    pub fn extent(&self) -> Rect {
        let last = DVec2::new(f64::from(self.columns - 1), f64::from(self.rows - 1));
        Rect { min: self.skipped() * self.cell, max: (self.skipped() + last) * self.cell }
    }

    /// The post of the larger lattice that this one's first is; see [`Lattice::part`].
    pub fn first(&self) -> Post {
        self.first
    }

    /// How many posts of the larger lattice lie before this one's first, eastward and northward.
    fn skipped(&self) -> DVec2 {
        DVec2::new(f64::from(self.first.column), f64::from(self.first.row))
    }

    /// World X and Y of a post.
    #[inline]
    pub fn position(&self, post: Post) -> Vec2 {
        let (column, row) = (post.column + self.first.column, post.row + self.first.row);
        (DVec2::new(f64::from(column), f64::from(row)) * self.cell).as_vec2()
    }

    /// The height of a post in meters, NaN where there is no data.
    ///
    /// # Panics
    /// Where the post lies outside the lattice.
    #[inline]
    pub fn height(&self, post: Post) -> f32 {
        self.heights[self.index(post)]
    }

    /// Whether the post belongs to something whose true shape must show; see [`Lattice::pin`].
    pub fn is_pinned(&self, post: Post) -> bool {
        self.pinned[self.index(post)]
    }

    /// Which posts are pinned, in the order of [`Lattice::heights`].
    pub fn pinned(&self) -> &[bool] {
        &self.pinned
    }

    /// How far drawn ground may be off a pinned post, meters: rounding of heights, which an exaggeration multiplies.
    pub fn pin_slack_m(&self) -> f32 {
        self.pin_slack_m
    }

    /// Sets a post's height and pins it: any drawn triangle that covers it must then be exact.
    pub fn pin(&mut self, post: Post, height: f32) {
        let index = self.index(post);
        self.heights[index] = height;
        self.pinned[index] = true;
    }

    /// The heights of the posts from `first` to column `last` of its row, to be set; whether they are pinned stays as
    /// it is.
    pub(crate) fn heights_mut(&mut self, first: Post, last: u32) -> &mut [f32] {
        let from = self.index(first);
        &mut self.heights[from..=from + (last - first.column) as usize]
    }

    /// Where a post is stored: its place in [`Lattice::heights`].
    ///
    /// # Panics
    /// Where the post lies outside the lattice.
    #[inline]
    pub fn index(&self, post: Post) -> usize {
        assert!(post.column < self.columns && post.row < self.rows, "{post:?} is outside the lattice");
        post.row as usize * self.columns as usize + post.column as usize
    }

    /// The lowest and highest height; finite, since a lattice holds some data.
    pub fn height_range(&self) -> (f32, f32) {
        let start = (f32::INFINITY, f32::NEG_INFINITY);
        self.heights.iter().fold(start, |(low, high), &height| (low.min(height), high.max(height)))
    }

    /// Map coordinates of a post.
    pub fn map_position(&self, post: Post) -> DVec2 {
        let grid = DVec2::new(f64::from(post.column), f64::from(post.row)) + self.skipped();
        self.origin + grid * self.cell
    }

    /// A world position in columns and rows of posts from the lattice's first; may lie outside.
    pub fn grid_at(&self, world: DVec2) -> DVec2 {
        world / self.cell - self.skipped()
    }

    /// The cell that holds a world position and the position within it, 0..=1 east and north; `None` outside.
    pub fn cell_at(&self, world: DVec2) -> Option<(Post, DVec2)> {
        let grid = self.grid_at(world);
        let last = DVec2::new(f64::from(self.columns - 1), f64::from(self.rows - 1));
        if !(grid.cmpge(DVec2::ZERO).all() && grid.cmple(last).all()) {
            return None;
        }
        let corner = grid.floor().min(last - 1.0);
        Some((Post { column: corner.x as u32, row: corner.y as u32 }, grid - corner))
    }

    /// The heights of a cell's corners: south-west, south-east, north-west, north-east.
    pub fn corner_heights(&self, cell: Post) -> [f32; 4] {
        let first = self.index(cell);
        let stride = self.columns as usize;
        [
            self.heights[first],
            self.heights[first + 1],
            self.heights[first + stride],
            self.heights[first + stride + 1],
        ]
    }

    /// The slopes at a post, rise per meter eastward and northward: Horn's weighting of the eight neighbors
    /// (Horn 1981, as `gdaldem` and most hillshades use); missing neighbors take the post's own height.
    /// Zero where the post has no data.
    ///
    /// Where posts were put in between those measured, the neighbors of a post that nothing was built on are as far away
    /// as measured ones are: nearer ones lie on the planes between, and would show the planes and not the land. What was
    /// built there does not count: the land is taken to go on as on the other side.
    pub fn slopes(&self, post: Post) -> Vec2 {
        let own = self.height(post);
        if own.is_nan() {
            return Vec2::ZERO;
        }
        let is_land = self.doublings > 0 && !self.is_pinned(post);
        let step = if is_land { 1 << self.doublings } else { 1 };
        let at = |east: i64, north: i64| -> f32 {
            let (there, opposite) = (
                self.beside(post, east * step, north * step),
                self.beside(post, -east * step, -north * step),
            );
            let height = match (is_land && self.is_pinned(there), self.is_pinned(opposite)) {
                (false, _) => self.height(there),
                (true, false) => 2.0 * own - self.height(opposite),
                (true, true) => own,
            };
            if height.is_nan() { own } else { height }
        };
        let east = (at(1, 1) + 2.0 * at(1, 0) + at(1, -1)) - (at(-1, 1) + 2.0 * at(-1, 0) + at(-1, -1));
        let north = (at(1, 1) + 2.0 * at(0, 1) + at(-1, 1)) - (at(1, -1) + 2.0 * at(0, -1) + at(-1, -1));
        let (low, high) = (self.beside(post, -step, -step), self.beside(post, step, step));
        let span = |low: u32, high: u32| 4.0 * (high - low) as f32;
        Vec2::new(
            east / (span(low.column, high.column) * self.cell.x as f32),
            north / (span(low.row, high.row) * self.cell.y as f32),
        )
    }

    /// The post so many columns east and rows north, or the last one that way.
    fn beside(&self, post: Post, east: i64, north: i64) -> Post {
        let column = (i64::from(post.column) + east).clamp(0, i64::from(self.columns) - 1);
        let row = (i64::from(post.row) + north).clamp(0, i64::from(self.rows) - 1);
        Post { column: column as u32, row: row as u32 }
    }

    /// All posts, row by row from the south-west.
    pub fn posts(&self) -> impl Iterator<Item = Post> + use<> {
        let (columns, rows) = (self.columns, self.rows);
        (0..rows).flat_map(move |row| (0..columns).map(move |column| Post { column, row }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plane() -> Lattice {
        let heights = (0..12).map(|index| (index % 4) as f32 * 2.0 - (index / 4) as f32).collect();
        Lattice::new(DVec2::new(500.0, 900.0), DVec2::new(10.0, 5.0), 4, heights).expect("sound")
    }

    #[test]
    fn slopes_of_a_plane_are_exact_inside_and_at_the_border() {
        let lattice = plane();
        for post in lattice.posts() {
            assert!((lattice.slopes(post) - Vec2::new(0.2, -0.2)).length() < 1e-6, "{post:?}");
        }
    }

    #[test]
    fn an_exaggerated_lattice_has_the_same_posts_and_higher_heights() {
        let mut plain = plane();
        plain.pin(Post { column: 1, row: 2 }, 7.0);
        let steep = plain.exaggerated(3.0);
        for post in plain.posts() {
            assert_eq!(steep.height(post), plain.height(post) * 3.0);
            assert_eq!(steep.position(post), plain.position(post));
            assert_eq!(steep.is_pinned(post), plain.is_pinned(post));
        }
        assert_eq!(steep.pin_slack_m(), plain.pin_slack_m() * 3.0);
    }

    #[test]
    fn a_no_data_value_that_nobody_named_is_not_taken_for_ground() {
        for height in [f32::MIN, f32::INFINITY, 1.1e7] {
            let lattice = Lattice::new(DVec2::ZERO, DVec2::ONE, 2, vec![1.0, f32::NAN, height, 2.0]);
            assert_eq!(lattice.err(), Some(LatticeError::TooHigh { height }));
        }
    }

    #[test]
    fn a_part_s_posts_stand_where_they_stand_in_the_whole() {
        let (cell, first) = (DVec2::new(0.1, 0.3), Post { column: 1, row: 1 });
        let whole = Lattice::new(DVec2::ZERO, cell, 4, (0..12u8).map(f32::from).collect()).expect("sound");
        let heights = vec![5.0, 6.0, 7.0, 9.0, 10.0, 11.0];
        let part = Lattice::part((DVec2::ZERO, cell), first, 3, heights).expect("sound");
        for post in part.posts() {
            let same = Post { column: post.column + 1, row: post.row + 1 };
            assert_eq!(part.position(post), whole.position(same));
            assert_eq!(part.height(post), whole.height(same));
        }
        assert_eq!(part.extent().max, whole.extent().max);
        assert_eq!(part.cell_at(DVec2::new(0.25, 0.45)).expect("inside").0, Post { column: 1, row: 0 });
        assert_eq!(part.cell_at(DVec2::new(0.05, 0.45)), None);
        let heights = vec![f32::NAN; 6];
        assert!(Lattice::part((DVec2::ZERO, cell), first, 3, heights).is_ok(), "a part may lie in the sea");
    }

    #[test]
    fn the_border_belongs_to_the_lattice_and_beyond_it_nothing() {
        let lattice = plane();
        let (cell, part) = lattice.cell_at(DVec2::new(30.0, 10.0)).expect("the last post");
        assert_eq!((cell, part), (Post { column: 2, row: 1 }, DVec2::ONE));
        assert_eq!(lattice.cell_at(DVec2::new(30.1, 3.0)), None);
        assert_eq!(lattice.cell_at(DVec2::new(f64::NAN, 3.0)), None);
    }
}
