//! Rectangles along a heading around posts: which posts one holds, and whether all of them are fit.

use glam::DVec2;

use sandtable_terrain::lattice::Lattice;

/// Rounding that puts a post on the border of a rectangle inside.
const SLACK: f64 = 1e-9;

/// How many posts of each row are unfit before each column.
pub(crate) struct RowCounts {
    /// `columns + 1` for each row.
    before: Vec<u32>,
    columns: usize,
    rows: usize,
}

impl RowCounts {
    /// The counts of posts that are not fit.
    pub fn new(is_fit: &[bool], columns: usize) -> Self {
        let mut before = Vec::with_capacity(is_fit.len() + is_fit.len() / columns);
        for row in is_fit.chunks_exact(columns) {
            let mut count = 0;
            before.push(count);
            before.extend(row.iter().map(|&is_fit| {
                count += u32::from(!is_fit);
                count
            }));
        }
        Self { before, columns, rows: is_fit.len() / columns }
    }

    /// Whether no post from `first` to `last` of a row is unfit.
    #[inline]
    fn are_fit(&self, row: usize, first: usize, last: usize) -> bool {
        let row = &self.before[row * (self.columns + 1)..][..=self.columns];
        row[last + 1] == row[first]
    }
}

/// The posts that a rectangle holds, relative to the post at its center.
#[derive(Clone, Debug)]
pub(crate) struct RectangleRows {
    heading_deg: f64,
    /// Row, first column, last column, row by row; rows without posts are left out.
    spans: Vec<[i64; 3]>,
    /// Posts near its long axis, around each of which a disk of [`RectangleRows::inner_m`] lies inside it.
    axis: Vec<[i64; 2]>,
    inner_m: f64,
    /// Half its diagonal, meters.
    outer_m: f64,
    /// How far it reaches, columns and rows.
    reach: [i64; 2],
}

impl RectangleRows {
    /// A rectangle of length and width `size`, its length along a heading in degrees clockwise from north.
    pub fn new(heading_deg: f64, size: DVec2, ground: &Lattice) -> Self {
        let cell = ground.cell();
        let heading = heading_deg.to_radians();
        let along = DVec2::new(libm::sin(heading), libm::cos(heading));
        let half = size / 2.0;
        let outer_m = half.length();
        let posts = DVec2::new(f64::from(ground.columns()), f64::from(ground.rows()));
        // What reaches beyond the land from any post need not be known further than that.
        let reach = (DVec2::splat(outer_m) / cell).floor().min(posts + 1.0);
        let limit = half * (1.0 + SLACK);
        let span = |row: i64| {
            let north = row as f64 * cell.y;
            // |x · along.x + north · along.y| ≤ half.x and |x · along.y − north · along.x| ≤ half.y
            let (low, high) = interval(along.x, -north * along.y, limit.x);
            let (low_across, high_across) = interval(along.y, north * along.x, limit.y);
            let first = (low.max(low_across) / cell.x).ceil().max(-reach.x - 1.0);
            let last = (high.min(high_across) / cell.x).floor().min(reach.x + 1.0);
            (first <= last).then_some([row, first as i64, last as i64])
        };
        let rows = reach.y as i64;
        let inner_m = half.y - cell.length() / 2.0;
        let straight = (half.x - half.y).max(0.0);
        let count = if inner_m > 0.0 { (2.0 * straight / half.y).ceil().min(4096.0) as i64 } else { -1 };
        let axis = (0..=count).map(|index| {
            let share = if count > 0 { 2.0 * index as f64 / count as f64 - 1.0 } else { 0.0 };
            let at = (along * straight * share / cell).round();
            [at.x as i64, at.y as i64]
        });
        Self {
            heading_deg,
            spans: (-rows..=rows).filter_map(span).collect(),
            axis: axis.collect(),
            inner_m,
            outer_m,
            reach: [reach.x as i64, rows],
        }
    }

    /// Its heading in degrees clockwise from north.
    pub fn heading_deg(&self) -> f64 {
        self.heading_deg
    }

    /// Whether the rectangle around a post lies on the land and holds no unfit post. `clear_m` is the distance of each post
    /// to the nearest unfit one.
    pub fn fits(&self, counts: &RowCounts, clear_m: &[f32], [column, row]: [usize; 2]) -> bool {
        let (columns, rows) = (counts.columns as i64, counts.rows as i64);
        let (column, row) = (column as i64, row as i64);
        let here = f64::from(clear_m[(row * columns + column) as usize]);
        let is_amid = column >= self.reach[0]
            && row >= self.reach[1]
            && column + self.reach[0] < columns
            && row + self.reach[1] < rows;
        // f32 distances are good to 1e-7.
        if is_amid && here > self.outer_m * (1.0 + 1e-6) {
            return true;
        }
        for &[east, north] in &self.axis {
            let (column, row) = (column + east, row + north);
            if column < 0 || row < 0 || column >= columns || row >= rows {
                return false;
            }
            if f64::from(clear_m[(row * columns + column) as usize]) < self.inner_m * (1.0 - 1e-6) {
                return false;
            }
        }
        self.spans.iter().all(|&[north, first, last]| {
            let (row, first, last) = (row + north, column + first, column + last);
            row >= 0
                && row < rows
                && first >= 0
                && last < columns
                && counts.are_fit(row as usize, first as usize, last as usize)
        })
    }

    /// The greatest value in the rectangle around a post; infinite where it reaches beyond the land.
    pub fn greatest(&self, values: &[f32], columns: usize, [column, row]: [usize; 2]) -> f32 {
        let (width, rows) = (columns as i64, (values.len() / columns) as i64);
        let mut greatest = f32::NEG_INFINITY;
        for &[north, first, last] in &self.spans {
            let (row, first, last) = (row as i64 + north, column as i64 + first, column as i64 + last);
            if row < 0 || row >= rows || first < 0 || last >= width {
                return f32::INFINITY;
            }
            let values = &values[(row * width + first) as usize..=(row * width + last) as usize];
            greatest = values.iter().fold(greatest, |greatest, &value| greatest.max(value));
        }
        greatest
    }
}

impl RectangleRows {
    /// The posts of the rectangle around a post that lie on land of so many columns and rows.
    pub fn posts(&self, [columns, rows]: [usize; 2], center: usize) -> impl Iterator<Item = usize> + use<'_> {
        let (column, row) = ((center % columns) as i64, (center / columns) as i64);
        let spans = self.spans.iter().map(move |&[north, first, last]| {
            (row + north, (column + first).max(0), (column + last).min(columns as i64 - 1))
        });
        let spans = spans.filter(move |&(row, ..)| (0..rows as i64).contains(&row));
        spans.flat_map(move |(row, first, last)| {
            (first..=last).map(move |column| (row * columns as i64 + column) as usize)
        })
    }
}

/// The x for which |x · factor − center| is at most `half`.
fn interval(factor: f64, center: f64, half: f64) -> (f64, f64) {
    if factor.abs() < 1e-12 {
        return if center.abs() <= half { (f64::NEG_INFINITY, f64::INFINITY) } else { (1.0, -1.0) };
    }
    let ends = [(center - half) / factor, (center + half) / factor];
    (ends[0].min(ends[1]), ends[0].max(ends[1]))
}
