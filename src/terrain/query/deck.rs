//! Decks: surfaces that one can stand on above the ground, such as bridges.
//!
//! A deck is triangles in world space. Over each of them lies a rectangle of a coarse grid of buckets; a bucket names
//! the triangles that may lie over its area, so that a point is tested against a few of them:
//!
//! ```text
//!  ┌────┬────┬────┐
//!  │ 0  │ 0 1│  1 │      starts    0  1  3  4 …
//!  ├────┼────┼────┤      triangles 0 │0 1│1 │…
//!  │    │    │    │
//!  └────┴────┴────┘
//! ```

use glam::DVec2;

use crate::geom::rect::Rect;
use crate::terrain::triangle_surface::{SurfaceTriangle, facet_contains, plane_z};

/// Buckets per triangle: about one triangle a bucket where they lie side by side.
const BUCKETS_PER_TRIANGLE: f64 = 1.0;

/// How many buckets may name a triangle on average. Where large triangles lie over each other more would, and buckets are
/// made larger until they do not: memory stays within a few words a triangle, whatever the triangles are.
const MOST_NAMED: usize = 16;

/// The most buckets along a side, whatever the number of triangles.
const MOST_BUCKETS: f64 = 1024.0;

/// Triangles over the ground; Z is the height in meters, without exaggeration.
#[derive(Clone, Debug)]
pub struct Deck {
    facets: Vec<SurfaceTriangle>,
    bounds: Rect,
    columns: usize,
    rows: usize,
    /// For each bucket, row by row from the south-west, where its triangles begin in `members`; one more at the end.
    starts: Vec<u32>,
    members: Vec<u32>,
}

/// Why triangles make no deck.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum DeckError {
    /// A coordinate is not finite.
    #[error("triangle {0} of the deck has a coordinate that is not a finite number")]
    NotFinite(usize),
    /// More triangles than can be numbered.
    #[error("a deck of {0} triangles is too large; give at most {max}", max = u32::MAX)]
    TooMany(usize),
}

impl Deck {
    /// A deck of triangles in world space, in any order and either way round. They may overlap; upright ones, which have
    /// no area in plan, are left out.
    ///
    /// # Errors
    /// See [`DeckError`].
    pub fn new(triangles: &[SurfaceTriangle]) -> Result<Self, DeckError> {
        if u32::try_from(triangles.len()).is_err() {
            return Err(DeckError::TooMany(triangles.len()));
        }
        if let Some(index) = triangles.iter().position(|facet| !facet.iter().all(|corner| corner.is_finite()))
        {
            return Err(DeckError::NotFinite(index));
        }
        let facets: Vec<SurfaceTriangle> = triangles.iter().copied().filter_map(counter_clockwise).collect();
        let bounds = Rect::around(facets.iter().flatten().map(|corner| corner.truncate().as_dvec2()));
        let mut deck = Self { facets, bounds, columns: 0, rows: 0, starts: vec![0], members: Vec::new() };
        if !deck.facets.is_empty() {
            deck.fill_buckets();
        }
        Ok(deck)
    }

    /// The height of the highest triangle over a world position, in meters; `None` where there is none.
    pub fn height_m(&self, at: DVec2) -> Option<f64> {
        if !self.bounds.contains(at) {
            return None;
        }
        let (column, row) = self.bucket(at);
        let bucket = row * self.columns + column;
        let members = &self.members[self.starts[bucket] as usize..self.starts[bucket + 1] as usize];
        let over = members.iter().map(|&member| &self.facets[member as usize]);
        let heights = over.filter(|facet| facet_contains(facet, at)).map(|facet| plane_z(facet, at));
        heights.reduce(f64::max)
    }

    /// The triangles, counter-clockwise seen from above.
    pub fn facets(&self) -> &[SurfaceTriangle] {
        &self.facets
    }

    /// The smallest world rectangle around the deck; empty where it has no triangle.
    pub fn bounds(&self) -> Rect {
        self.bounds
    }

    /// Whether every triangle is named by every bucket that holds a corner or the middle of it.
    pub fn check(&self) -> Result<(), String> {
        for (index, facet) in self.facets.iter().enumerate() {
            let corners = facet.map(|corner| corner.truncate().as_dvec2());
            let middle = (corners[0] + corners[1] + corners[2]) / 3.0;
            for at in corners.into_iter().chain([middle]) {
                let (column, row) = self.bucket(at);
                let bucket = row * self.columns + column;
                let span = self.starts[bucket] as usize..self.starts[bucket + 1] as usize;
                if !self.members[span].contains(&(index as u32)) {
                    return Err(format!("triangle {index} is not in the bucket ({column}, {row}) at {at}"));
                }
            }
        }
        Ok(())
    }

    fn fill_buckets(&mut self) {
        let size = self.bounds.size();
        let wanted = self.facets.len() as f64 * BUCKETS_PER_TRIANGLE;
        // As square as they can be; a deck without width gets one row of buckets.
        let side = (size.x * size.y / wanted).sqrt().max(size.max_element() / MOST_BUCKETS);
        let count = |length: f64| (length / side).ceil().clamp(1.0, MOST_BUCKETS) as usize;
        (self.columns, self.rows) = (count(size.x), count(size.y));
        while self.columns * self.rows > 1 && self.named() > MOST_NAMED * self.facets.len() {
            (self.columns, self.rows) = (self.columns.div_ceil(2), self.rows.div_ceil(2));
        }
        let mut pairs: Vec<(u32, u32)> = Vec::with_capacity(self.named());
        for (facet, index) in self.facets.iter().zip(0u32..) {
            let ((west, south), (east, north)) = self.buckets_under(facet);
            for row in south..=north {
                pairs.extend((west..=east).map(|column| ((row * self.columns + column) as u32, index)));
            }
        }
        pairs.sort_unstable();
        let buckets = (self.columns * self.rows) as u32;
        self.starts =
            (0..=buckets).map(|bucket| pairs.partition_point(|pair| pair.0 < bucket) as u32).collect();
        self.members = pairs.into_iter().map(|pair| pair.1).collect();
    }

    /// In how many buckets triangles are named, all together.
    fn named(&self) -> usize {
        let under = self.facets.iter().map(|facet| self.buckets_under(facet));
        under.map(|((west, south), (east, north))| (east - west + 1) * (north - south + 1)).sum()
    }

    /// The south-westernmost and the north-easternmost bucket that a triangle may lie over.
    fn buckets_under(&self, facet: &SurfaceTriangle) -> ((usize, usize), (usize, usize)) {
        let over = Rect::around(facet.map(|corner| corner.truncate().as_dvec2()));
        (self.bucket(over.min), self.bucket(over.max))
    }

    /// The column and row of the bucket that holds a position within the bounds.
    fn bucket(&self, at: DVec2) -> (usize, usize) {
        let size = self.bounds.size();
        let along = |offset: f64, length: f64, count: usize| {
            let part = if length > 0.0 { offset / length } else { 0.0 };
            ((part * count as f64) as usize).min(count - 1)
        };
        let offset = at - self.bounds.min;
        (along(offset.x, size.x, self.columns), along(offset.y, size.y, self.rows))
    }
}

fn counter_clockwise([a, b, c]: SurfaceTriangle) -> Option<SurfaceTriangle> {
    let [p, q, r] = [a, b, c].map(|corner| corner.truncate().as_dvec2());
    let area = (q - p).perp_dot(r - p);
    if area > 0.0 { Some([a, b, c]) } else { (area < 0.0).then_some([a, c, b]) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    fn slab(low: (f32, f32), high: (f32, f32), z: f32) -> [SurfaceTriangle; 2] {
        let at = |x: f32, y: f32| Vec3::new(x, y, z);
        let [a, b, c, d] = [at(low.0, low.1), at(high.0, low.1), at(high.0, high.1), at(low.0, high.1)];
        [[a, b, c], [a, d, c]]
    }

    #[test]
    fn the_highest_of_what_lies_over_a_point_counts() {
        let triangles = [slab((0.0, 0.0), (10.0, 4.0), 5.0), slab((2.0, 1.0), (4.0, 9.0), 7.0)].concat();
        let deck = Deck::new(&triangles).expect("sound");
        deck.check().expect("sound");
        assert_eq!(deck.height_m(DVec2::new(1.0, 1.0)), Some(5.0));
        assert_eq!(deck.height_m(DVec2::new(3.0, 2.0)), Some(7.0));
        assert_eq!(deck.height_m(DVec2::new(3.0, 8.0)), Some(7.0));
        assert_eq!(deck.height_m(DVec2::new(9.0, 8.0)), None);
        assert_eq!(deck.height_m(DVec2::new(10.0, 4.0)), Some(5.0), "the border belongs to it");
        assert_eq!(deck.height_m(DVec2::NAN), None);
    }

    #[test]
    fn every_triangle_of_a_long_strip_is_found() {
        let strip: Vec<SurfaceTriangle> = (0..300)
            .flat_map(|index| {
                let x = index as f32 * 3.0;
                slab((x, x * 0.7), (x + 3.0, x * 0.7 + 8.0), index as f32)
            })
            .collect();
        let deck = Deck::new(&strip).expect("sound");
        deck.check().expect("sound");
        for index in 0..300 {
            let x = f64::from(index) * 3.0;
            let height = deck.height_m(DVec2::new(x + 1.5, f64::from(x as f32 * 0.7) + 1.0));
            assert_eq!(height, Some(f64::from(index)));
        }
    }

    #[test]
    fn upright_triangles_and_none_at_all_make_an_empty_deck() {
        let upright = [Vec3::ZERO, Vec3::X, Vec3::new(0.5, 0.0, 9.0)];
        for triangles in [&[][..], &[upright]] {
            let deck = Deck::new(triangles).expect("sound");
            assert_eq!(deck.height_m(DVec2::new(0.5, 0.0)), None);
        }
        let wrong = [Vec3::ZERO, Vec3::X, Vec3::new(f32::NAN, 1.0, 0.0)];
        assert_eq!(Deck::new(&[wrong]).err(), Some(DeckError::NotFinite(0)));
    }
}
