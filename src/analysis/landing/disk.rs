//! Disks around posts: the greatest value within each, by sliding maxima over the rows of the disk, and their outlines.

use glam::DVec2;
use rayon::prelude::*;

/// The rows of a disk: for each row from the center's, how many posts it reaches east and west.
#[derive(Clone, Debug)]
pub(crate) struct DiskRows {
    half_widths: Vec<usize>,
}

impl DiskRows {
    /// The posts within `radius_m` of a post; `cell` is the meters between posts, eastward and northward. No row reaches
    /// beyond `posts`, the size of the land.
    pub(crate) fn new(radius_m: f64, cell: DVec2, posts: usize) -> Self {
        let rows = ((radius_m / cell.y) as usize).min(posts);
        let half_width = |row: usize| {
            let north = row as f64 * cell.y;
            ((libm::sqrt((radius_m * radius_m - north * north).max(0.0)) / cell.x) as usize).min(posts)
        };
        Self { half_widths: (0..=rows).map(half_width).collect() }
    }

    /// The posts in the disk around a post of land of so many columns and rows, row by row from the south.
    pub(crate) fn posts(
        &self,
        [columns, rows]: [usize; 2],
        center: usize,
    ) -> impl Iterator<Item = usize> + use<'_> {
        let (column, row) = (center % columns, center / columns);
        let south =
            (1..self.half_widths.len()).rev().filter_map(move |away| Some((away, row.checked_sub(away)?)));
        let north = (0..self.half_widths.len()).map(move |away| (away, row + away));
        south.chain(north.filter(move |&(_, row)| row < rows)).flat_map(move |(away, row)| {
            let half = self.half_widths[away];
            let columns_of_row = column.saturating_sub(half)..=(column + half).min(columns - 1);
            columns_of_row.map(move |column| row * columns + column)
        })
    }

    /// The greatest of `values` in the disk around each post, where posts outside the land count as `outside`. The values
    /// are without NaN.
    pub(crate) fn maxima(&self, values: &[f32], columns: usize, outside: f32) -> Vec<f32> {
        let rows = values.len() / columns;
        let mut maxima = vec![outside; values.len()];
        maxima.par_chunks_mut(columns).enumerate().for_each_init(Vec::new, |queue, (row, maxima)| {
            maxima.fill(f32::NEG_INFINITY);
            for (away, &half) in self.half_widths.iter().enumerate() {
                let north = (row + away < rows).then_some(row + away);
                // The center's row is the only one so near.
                let south = (away > 0).then(|| row.checked_sub(away));
                for from in south.into_iter().chain([north]) {
                    match from {
                        Some(from) => {
                            let line = &values[from * columns..][..columns];
                            raise_by_window(maxima, line, half, outside, queue);
                        }
                        None => maxima.iter_mut().for_each(|value| *value = value.max(outside)),
                    }
                }
            }
        });
        maxima
    }
}

/// Raises each of `maxima` to the greatest of `line` within `half` posts of it.
fn raise_by_window(maxima: &mut [f32], line: &[f32], half: usize, outside: f32, queue: &mut Vec<u32>) {
    queue.clear();
    let (mut head, mut next) = (0, 0);
    for (index, value) in maxima.iter_mut().enumerate() {
        while next < line.len() && next <= index + half {
            while queue.len() > head && queue.last().is_some_and(|&last| line[last as usize] <= line[next]) {
                queue.pop();
            }
            queue.push(next as u32);
            next += 1;
        }
        while queue.get(head).is_some_and(|&first| (first as usize) + half < index) {
            head += 1;
        }
        if let Some(&first) = queue.get(head) {
            *value = value.max(line[first as usize]);
        }
        if index < half || index + half >= line.len() {
            *value = value.max(outside);
        }
    }
}

/// A ring of 32 corners around `center`, counter-clockwise.
pub(crate) fn circle(center: DVec2, radius_m: f64) -> Vec<DVec2> {
    let corner = |index: u32| {
        let angle = f64::from(index) * std::f64::consts::TAU / 32.0;
        center + DVec2::new(libm::cos(angle), libm::sin(angle)) * radius_m
    };
    (0..32).map(corner).collect()
}
