//! Counts of observers over a rectangle of posts.

use sandtable_geom::crs::Crs;
use sandtable_raster::raster::{Raster, Samples, north_up_nodes};
use sandtable_terrain::lattice::{Lattice, Post};
use sandtable_terrain::post_rect::PostRect;
use sandtable_terrain::sight::viewshed::{PostVisibility, Viewshed};

/// The value of posts without a count, in files.
const NO_DATA: f64 = -1.0;

/// The number of observers that see each post of a rectangle.
pub struct SightCounts {
    /// The posts, counted in the whole ground.
    posts: PostRect,
    /// Row by row from the south-west; NaN where nobody looked or there is no elevation.
    counts: Vec<f32>,
}

impl SightCounts {
    /// Counts for `posts`, which no observer has looked at yet; the caller has checked how many posts these are.
    pub fn new(posts: PostRect) -> Self {
        Self { posts, counts: vec![f32::NAN; posts.width() * posts.height()] }
    }

    /// Adds the viewshed of one observer over the posts that `lattice` holds.
    pub fn add_viewshed(&mut self, lattice: &Lattice, viewshed: &Viewshed) {
        let held = lattice.held();
        let count = |post: &PostVisibility| match post {
            PostVisibility::Visible => 1.0,
            PostVisibility::Hidden => 0.0,
            PostVisibility::Beyond | PostVisibility::NoData => f32::NAN,
        };
        self.add(held, |index| count(&viewshed.posts[index]));
    }

    /// Adds counts of another rectangle, as a raster with north up.
    ///
    /// # Panics
    /// Where the raster has another size than the rectangle.
    pub fn add_raster(&mut self, posts: PostRect, raster: &Raster) {
        let (width, height) = (posts.width(), posts.height());
        assert_eq!((raster.width as usize, raster.height as usize), (width, height), "a sample a post");
        self.add(posts, |index| {
            let (column, row) = (index % width, height - 1 - index / width);
            raster.at(column as u32, row as u32) as f32
        });
    }

    fn add(&mut self, other: PostRect, count: impl Fn(usize) -> f32) {
        let (own, width) = (self.posts, self.posts.width());
        let Some(PostRect { first, last }) = own.intersection(other) else { return };
        for row in first.row..=last.row {
            let to = (row - own.first.row) as usize * width;
            let from = (row - other.first.row) as usize * other.width();
            for column in first.column..=last.column {
                let added = count(from + (column - other.first.column) as usize);
                let sum = &mut self.counts[to + (column - own.first.column) as usize];
                match (sum.is_nan(), added.is_nan()) {
                    (_, true) => {}
                    (true, false) => *sum = added,
                    (false, false) => *sum += added,
                }
            }
        }
    }

    /// The counts as a raster with north up, placed on the whole ground `lattice` in `crs`.
    pub fn raster(self, lattice: &Lattice, crs: &Crs) -> Raster {
        let width = self.posts.width();
        let rows = self.counts.chunks_exact(width).rev();
        let samples = Samples::F32(rows.flatten().copied().collect());
        let north_west = Post { column: self.posts.first.column, row: self.posts.last.row };
        let place = north_up_nodes(lattice.map_position(north_west), lattice.cell());
        Raster {
            driver: "viewsheds",
            crs: (*crs != Crs::local()).then(|| crs.clone()),
            nodata: Some(NO_DATA),
            ..Raster::new(width as u32, samples).placed(place)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rect(first: (u32, u32), last: (u32, u32)) -> PostRect {
        let post = |(column, row)| Post { column, row };
        PostRect { first: post(first), last: post(last) }
    }

    #[test]
    fn counts_are_added_where_rectangles_overlap() {
        let mut counts = SightCounts::new(rect((2, 2), (4, 3)));
        // Two rows of three posts that begin one column to the west; the second of the lower row has none.
        let others = [1.0, f32::NAN, 1.0, 0.0, 1.0, 1.0];
        counts.add(rect((1, 2), (3, 3)), |index| others[index]);
        counts.add(rect((1, 2), (3, 3)), |index| others[index]);
        counts.add(rect((7, 7), (8, 8)), |_| panic!("apart"));
        let found: Vec<Option<f32>> =
            counts.counts.iter().map(|&count| Some(count).filter(|count| !count.is_nan())).collect();
        assert_eq!(found, [None, Some(2.0), None, Some(2.0), Some(2.0), None]);
    }
}
