//! The ground as one lattice of posts.
//!
//! Posts stand at equal distances east and north of an f64 origin, the south-west post; heights are f32 meters, NaN where
//! there is no data. Between posts the ground is the plane of the finest bintree triangles: the diagonal of the cell
//! north-east of post (column, row) joins the two corners whose coordinates are both even or both odd, as longest-edge
//! bisection leaves it:
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

use std::sync::Arc;

use glam::{DVec2, Vec2, Vec3};

use crate::height_scan;
use crate::post_rect::PostRect;
use crate::row_order::turned;
use sandtable_base::limits::memory::{MemoryRefused, check_memory};
use sandtable_geom::rect::Rect;
use sandtable_raster::raster::{Raster, Samples};

/// Posts of a regular grid with their heights.
///
/// Three kinds of positions occur: map coordinates; world positions, in meters from the origin; and grid positions, in
/// columns and rows of posts from the lattice's first.
#[derive(Clone, Debug)]
pub struct Lattice {
    origin: DVec2,
    cell: DVec2,
    columns: u32,
    rows: u32,
    first: Post,
    /// The posts whose heights are held: all but in a lattice of [`Lattice::held_part`].
    held: PostRect,
    doublings: u32,
    /// Shared with clones, and with the raster that they were read from, until one is set.
    heights: Arc<Vec<f32>>,
    /// Shared with clones, until one is pinned.
    pinned: Arc<Vec<bool>>,
    has_pins: bool,
    pin_slack_m: f32,
}

/// The greatest height above or below 0 in meters: the limit of a scene file's elevations, within which an f32 still
/// distinguishes one meter from the next.
pub const HIGHEST_M: f32 = 1e7;

/// A post with its height, twice while the ground changes, its pin and its error for the level of detail.
const BYTES_PER_POST: u64 = 16;

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
    /// There is not enough memory for its posts.
    #[error(transparent)]
    Memory(#[from] MemoryRefused),
    /// All samples are no-data.
    #[error("the elevation model holds no data at all")]
    Empty,
    /// A height that no ground has: mostly a no-data value that the file does not declare.
    #[error(
        "the elevation model holds a height of {height:e} m, beyond ±{HIGHEST_M} m; if that is a no-data value, the file must declare it, or the scene state it as `nodata` under [terrain]"
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

impl Post {
    /// Its grid position.
    #[inline]
    pub fn grid(self) -> DVec2 {
        DVec2::new(f64::from(self.column), f64::from(self.row))
    }

    /// The post at a grid position, rounded down; coordinates below 0 and NaN count as 0.
    #[inline]
    pub fn at_grid(grid: DVec2) -> Self {
        Self { column: grid.x as u32, row: grid.y as u32 }
    }

    /// The post `columns` east and `rows` north of this one.
    #[inline]
    pub fn offset(self, columns: u32, rows: u32) -> Self {
        Self { column: self.column + columns, row: self.row + rows }
    }
}

impl Lattice {
    /// The lattice of a north-up raster in meters.
    ///
    /// # Errors
    /// See [`LatticeError`].
    pub fn from_raster(raster: &Raster) -> Result<Self, LatticeError> {
        let (origin, cell) = Self::frame(raster)?;
        Self::check_memory(raster.width, raster.height)?;
        let columns = raster.width;
        let heights = match &raster.samples {
            Samples::F32(values) => turned(values, columns as usize, |height| height),
            Samples::F64(values) => turned(values, columns as usize, |height| height as f32),
        };
        Self::new(origin, cell, columns, heights)
    }

    /// Checks that there is memory for so many posts, with what is computed for each.
    pub(crate) fn check_memory(columns: u32, rows: u32) -> Result<(), LatticeError> {
        let posts = u64::from(columns) * u64::from(rows);
        Ok(check_memory(posts * BYTES_PER_POST, "the ground", "name a smaller `extent`")?)
    }

    /// The origin and the cell of the lattice of a north-up raster in meters; samples are not read.
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

    /// A part of a larger lattice with this origin and cell, beginning at the larger one's post `first`. Posts are counted
    /// from the part's own south-west; their positions are those in the larger lattice, to the last bit.
    ///
    /// A part may hold no data at all; [`Lattice::height_range`] is then (∞, −∞).
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
        let last = Post { column: columns - 1, row: rows - 1 };
        let held = PostRect { first: Post { column: 0, row: 0 }, last };
        Self::holding((origin, cell), first, (columns, rows), held, heights)
    }

    /// A lattice of this origin, cell, and numbers of columns and rows, of which the heights of the posts `held` alone are
    /// in memory, row by row from the south-west. Grid positions are those of the whole, and so is every bit that follows
    /// from them: what is asked of the ground among the held posts is answered as on the whole lattice.
    ///
    /// All methods that read a post's height panic for other posts. A held part may hold no data at all.
    ///
    /// # Errors
    /// [`LatticeError::TooSmall`] and [`LatticeError::TooHigh`].
    ///
    /// # Panics
    /// Where `held` reaches beyond the lattice, or `heights` are not as many.
    pub fn held_part(
        frame: (DVec2, DVec2),
        (columns, rows): (u32, u32),
        held: PostRect,
        heights: Vec<f32>,
    ) -> Result<Self, LatticeError> {
        if columns < 2 || rows < 2 {
            return Err(LatticeError::TooSmall(columns, rows));
        }
        assert!(held.last.column < columns && held.last.row < rows, "{held:?} reaches beyond the lattice");
        assert_eq!(heights.len(), held.width() * held.height(), "a height for each post of {held:?}");
        Self::holding(frame, Post { column: 0, row: 0 }, (columns, rows), held, heights)
    }

    pub(crate) fn holding(
        (origin, cell): (DVec2, DVec2),
        first: Post,
        (columns, rows): (u32, u32),
        held: PostRect,
        heights: Vec<f32>,
    ) -> Result<Self, LatticeError> {
        if let Some(height) = height_scan::first_beyond(&heights, HIGHEST_M) {
            return Err(LatticeError::TooHigh { height });
        }
        let pinned = Arc::new(crate::returned_memory::returned_zeros(heights.len()));
        Ok(Self {
            origin,
            cell,
            columns,
            rows,
            first,
            held,
            doublings: 0,
            heights: Arc::new(heights),
            pinned,
            has_pins: false,
            pin_slack_m: PIN_SLACK_M,
        })
    }

    /// This lattice with the heights of the posts `held` alone in memory, as [`Lattice::held_part`] has them, and none pinned.
    ///
    /// # Panics
    /// Where one of them is not held here.
    pub fn holding_only(&self, held: PostRect) -> Self {
        let row = |row: u32| {
            let first = self.index(Post { column: held.first.column, row });
            &self.heights[first..=self.index(Post { column: held.last.column, row })]
        };
        let heights = (held.first.row..=held.last.row).map(row).collect::<Vec<_>>().concat();
        let pinned = vec![false; heights.len()].into();
        Self { held, pinned, has_pins: false, heights: Arc::new(heights), ..*self }
    }

    /// The lattice with every height times `factor`, which is above 0.
    pub fn stretched(&self, factor: f32) -> Self {
        let heights = Arc::new(self.heights.iter().map(|height| height * factor).collect());
        Self { heights, pinned: Arc::clone(&self.pinned), pin_slack_m: self.pin_slack_m * factor, ..*self }
    }

    /// The lattice with other heights, row by row from the south-west, one for each post.
    pub(crate) fn with_heights(&self, heights: Vec<f32>) -> Self {
        assert_eq!(heights.len(), self.heights.len(), "a height for each post");
        Self { heights: Arc::new(heights), pinned: Arc::clone(&self.pinned), ..*self }
    }

    /// The heights of a row, where posts without data take the nearest height of the row, or `otherwise` if it has none.
    pub fn filled_row(&self, row: u32, otherwise: f32) -> Vec<f32> {
        let mut heights =
            self.heights()[row as usize * self.columns as usize..][..self.columns as usize].to_vec();
        if heights.iter().any(|height| height.is_nan()) {
            spread(heights.iter_mut());
            spread(heights.iter_mut().rev());
            heights.iter_mut().filter(|height| height.is_nan()).for_each(|height| *height = otherwise);
        }
        heights
    }

    /// Map coordinates of the south-west post: the origin of world space.
    pub fn origin(&self) -> DVec2 {
        self.origin
    }

    /// Map coordinates of a point in world space.
    pub fn map_point(&self, at: Vec3) -> DVec2 {
        self.origin + at.truncate().as_dvec2()
    }

    /// Meters between posts, eastward and northward.
    pub fn cell(&self) -> DVec2 {
        self.cell
    }

    /// Meters between measured posts, eastward and northward: between them lie those put in by
    /// [`crate::densify`].
    pub fn measured_cell(&self) -> DVec2 {
        self.cell * f64::from(1u32 << self.doublings)
    }

    /// The area of a cell in square meters.
    pub fn cell_m2(&self) -> f64 {
        self.cell.x * self.cell.y
    }

    /// Posts per row.
    pub fn columns(&self) -> u32 {
        self.columns
    }

    /// Rows of posts.
    pub fn rows(&self) -> u32 {
        self.rows
    }

    /// The number of times that the spacing of the measured posts was halved; see [`crate::densify`].
    pub fn doublings(&self) -> u32 {
        self.doublings
    }

    /// This part of `whole` with as many doublings.
    pub fn with_doublings_of(self, whole: &Self) -> Self {
        Self { doublings: whole.doublings, ..self }
    }

    pub(crate) fn set_doublings(&mut self, doublings: u32) {
        self.doublings = doublings;
    }

    /// All heights, row by row from the south-west.
    ///
    /// # Panics
    /// Where only a part is held: [`Lattice::held_heights`] are that part's.
    #[inline]
    pub fn heights(&self) -> &[f32] {
        assert!(self.holds_all(), "of {}×{} posts {:?} are held", self.columns, self.rows, self.held);
        &self.heights
    }

    /// The heights as they are now, without a copy of them.
    pub(crate) fn shared_heights(&self) -> Arc<Vec<f32>> {
        Arc::clone(&self.heights)
    }

    /// The posts whose heights are held: all but in a lattice of [`Lattice::held_part`].
    pub fn held(&self) -> PostRect {
        self.held
    }

    /// The heights of the held posts, row by row from the south-west.
    pub fn held_heights(&self) -> &[f32] {
        &self.heights
    }

    /// Whether the heights of all posts are held.
    #[inline]
    pub fn holds_all(&self) -> bool {
        self.heights.len() == self.columns as usize * self.rows as usize
    }

    /// The rectangle of all posts in world space, the origin's post at (0, 0).
    pub fn extent(&self) -> Rect {
        let first = self.first.grid();
        Rect { min: first * self.cell, max: (first + self.last_grid()) * self.cell }
    }

    /// The first post's place in the larger lattice; see [`Lattice::part`].
    pub fn first(&self) -> Post {
        self.first
    }

    /// The grid position of the north-east post.
    #[inline]
    pub fn last_grid(&self) -> DVec2 {
        DVec2::new(f64::from(self.columns - 1), f64::from(self.rows - 1))
    }

    /// World X and Y of a post.
    #[inline]
    pub fn position(&self, post: Post) -> Vec2 {
        (post.offset(self.first.column, self.first.row).grid() * self.cell).as_vec2()
    }

    /// The height of a post in meters, NaN where there is no data.
    ///
    /// # Panics
    /// Where the post lies outside the lattice.
    #[inline]
    pub fn height(&self, post: Post) -> f32 {
        self.heights[self.index(post)]
    }

    /// Whether the post belongs to a feature that must show its true shape; see [`Lattice::pin`].
    pub fn is_pinned(&self, post: Post) -> bool {
        self.pinned[self.index(post)]
    }

    /// Which posts are pinned, in the order of [`Lattice::heights`].
    pub fn pinned(&self) -> &[bool] {
        &self.pinned
    }

    /// Whether any post is pinned: told without a look at each.
    pub fn has_pins(&self) -> bool {
        self.has_pins
    }

    /// The greatest difference of drawn ground from a pinned post, meters: rounding of heights, which
    /// [`Lattice::stretched`] multiplies.
    pub fn pin_slack_m(&self) -> f32 {
        self.pin_slack_m
    }

    /// Sets a post's height and pins it: any drawn triangle that covers it must then be exact.
    pub fn pin(&mut self, post: Post, height: f32) {
        let index = self.index(post);
        Arc::make_mut(&mut self.heights)[index] = height;
        Arc::make_mut(&mut self.pinned)[index] = true;
        self.has_pins = true;
    }

    /// The heights of the posts from `first` to column `last` of its row, to be set. Pins stay.
    pub fn heights_mut(&mut self, first: Post, last: u32) -> &mut [f32] {
        let from = self.index(first);
        &mut Arc::make_mut(&mut self.heights)[from..=from + (last - first.column) as usize]
    }

    /// A post's index in [`Lattice::held_heights`]: where all are held, in [`Lattice::heights`].
    ///
    /// # Panics
    /// Where the post lies outside the lattice, or is not held.
    #[inline]
    pub fn index(&self, post: Post) -> usize {
        let (column, row) =
            (post.column.wrapping_sub(self.held.first.column), post.row.wrapping_sub(self.held.first.row));
        let columns = self.held_columns();
        let is_held = column < columns && row <= self.held.last.row - self.held.first.row;
        assert!(is_held, "{post:?} is outside the lattice, or of what is held of it");
        row as usize * columns as usize + column as usize
    }

    /// Columns of held posts.
    #[inline]
    fn held_columns(&self) -> u32 {
        self.held.last.column - self.held.first.column + 1
    }

    /// The rectangle of all posts in map coordinates.
    pub fn map_extent(&self) -> Rect {
        let Rect { min, max } = self.extent();
        Rect { min: self.origin + min, max: self.origin + max }
    }

    /// The post of an [index](Self::index).
    pub fn post_at(&self, index: usize) -> Post {
        let columns = self.held_columns() as usize;
        self.held.first.offset((index % columns) as u32, (index / columns) as u32)
    }

    /// Map coordinates of a post.
    pub fn map_position(&self, post: Post) -> DVec2 {
        self.origin + (post.grid() + self.first.grid()) * self.cell
    }

    /// The grid position of a world position; may lie outside the lattice.
    pub fn grid_at(&self, world: DVec2) -> DVec2 {
        world / self.cell - self.first.grid()
    }

    /// The grid position of map coordinates; may lie outside the lattice.
    pub fn grid_from_map(&self, at: DVec2) -> DVec2 {
        self.grid_at(at - self.origin)
    }

    /// The cell that holds a world position and the position within it, 0..=1 east and north; `None` outside.
    pub fn cell_at(&self, world: DVec2) -> Option<(Post, DVec2)> {
        self.cell_at_grid(self.grid_at(world))
    }

    /// [`Self::cell_at`] of a grid position.
    pub fn cell_at_grid(&self, grid: DVec2) -> Option<(Post, DVec2)> {
        let last = self.last_grid();
        if !(grid.cmpge(DVec2::ZERO).all() && grid.cmple(last).all()) {
            return None;
        }
        let corner = grid.floor().min(last - 1.0);
        Some((Post::at_grid(corner), grid - corner))
    }

    /// The heights of a cell's corners: south-west, south-east, north-west, north-east.
    #[inline]
    pub fn corner_heights(&self, cell: Post) -> [f32; 4] {
        let stride = self.held_columns() as usize;
        let heights = &self.heights[self.index(cell)..][..stride + 2];
        [heights[0], heights[1], heights[stride], heights[stride + 1]]
    }

    /// All posts, row by row from the south-west.
    pub fn posts(&self) -> impl Iterator<Item = Post> + use<> {
        let (columns, rows) = (self.columns, self.rows);
        (0..rows).flat_map(move |row| (0..columns).map(move |column| Post { column, row }))
    }
}

/// Sets heights that are NaN to the one before.
fn spread<'a>(row: impl Iterator<Item = &'a mut f32>) {
    let mut last = f32::NAN;
    for height in row {
        if height.is_nan() {
            *height = last;
        } else {
            last = *height;
        }
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// A plane of 4 × 3 posts 10 m and 5 m apart.
    pub(crate) fn plane() -> Lattice {
        let heights = (0..12).map(|index| (index % 4) as f32 * 2.0 - (index / 4) as f32).collect();
        Lattice::new(DVec2::new(500.0, 900.0), DVec2::new(10.0, 5.0), 4, heights).expect("sound")
    }

    #[test]
    fn a_stretched_lattice_has_the_same_posts_and_higher_heights() {
        let mut plain = plane();
        plain.pin(Post { column: 1, row: 2 }, 7.0);
        let steep = plain.stretched(3.0);
        for post in plain.posts() {
            assert_eq!(steep.height(post), plain.height(post) * 3.0);
            assert_eq!(steep.position(post), plain.position(post));
            assert_eq!(steep.is_pinned(post), plain.is_pinned(post));
        }
        assert_eq!(steep.pin_slack_m(), plain.pin_slack_m() * 3.0);
    }

    #[test]
    fn an_undeclared_no_data_value_is_not_taken_for_ground() {
        for height in [f32::MIN, f32::INFINITY, 1.1e7] {
            let lattice = Lattice::new(DVec2::ZERO, DVec2::ONE, 2, vec![1.0, f32::NAN, height, 2.0]);
            assert_eq!(lattice.err(), Some(LatticeError::TooHigh { height }));
        }
    }

    #[test]
    fn a_parts_posts_have_their_positions_in_the_larger_lattice() {
        let (cell, first) = (DVec2::new(0.1, 0.3), Post { column: 1, row: 1 });
        let whole = Lattice::new(DVec2::ZERO, cell, 4, (0..12u8).map(f32::from).collect()).expect("sound");
        let heights = vec![5.0, 6.0, 7.0, 9.0, 10.0, 11.0];
        let part = Lattice::part((DVec2::ZERO, cell), first, 3, heights).expect("sound");
        for post in part.posts() {
            let same = post.offset(1, 1);
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
    fn a_held_part_is_the_whole_lattice_where_it_is_held_and_panics_elsewhere() {
        let (frame, size) = ((DVec2::new(0.3, 0.7), DVec2::new(0.1, 0.3)), (6, 5));
        let whole =
            Lattice::new(frame.0, frame.1, size.0, (0..30u8).map(f32::from).collect()).expect("sound");
        let held = PostRect { first: Post { column: 1, row: 2 }, last: Post { column: 4, row: 4 } };
        let heights: Vec<f32> = held.posts().map(|post| whole.height(post)).collect();
        let part = Lattice::held_part(frame, size, held, heights).expect("sound");
        assert_eq!((part.columns(), part.rows(), part.map_extent()), (6, 5, whole.map_extent()));
        for post in held.posts() {
            assert_eq!(part.height(post), whole.height(post));
            assert_eq!(part.post_at(part.index(post)), post);
            assert_eq!(part.map_position(post), whole.map_position(post));
        }
        let cell = Post { column: 3, row: 3 };
        assert_eq!(part.corner_heights(cell), whole.corner_heights(cell));
        for beyond in [Post { column: 0, row: 2 }, Post { column: 5, row: 2 }, Post { column: 2, row: 1 }] {
            assert!(std::panic::catch_unwind(|| part.height(beyond)).is_err(), "{beyond:?}");
        }
        assert!(std::panic::catch_unwind(|| part.heights().len()).is_err());
        let only = whole.holding_only(held);
        assert_eq!((only.held_heights(), only.held()), (part.held_heights(), held));
        assert_eq!(only.corner_heights(cell), whole.corner_heights(cell));
    }

    #[test]
    fn the_lattice_ends_at_its_border_posts() {
        let lattice = plane();
        let (cell, part) = lattice.cell_at(DVec2::new(30.0, 10.0)).expect("the last post");
        assert_eq!((cell, part), (Post { column: 2, row: 1 }, DVec2::ONE));
        assert_eq!(lattice.cell_at(DVec2::new(30.1, 3.0)), None);
        assert_eq!(lattice.cell_at(DVec2::new(f64::NAN, 3.0)), None);
    }
}
