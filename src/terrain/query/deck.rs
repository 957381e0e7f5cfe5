//! Decks: surfaces above the ground that one can stand on, such as bridges.

use glam::DVec2;

use crate::triangle_surface::{SurfaceTriangle, facet_contains, plan, plane_z};
use sandtable_geom::polygon;
use sandtable_geom::rect::Rect;
use sandtable_geom::rect_tree::RectTree;

/// Triangles over the ground; Z is the height in meters.
#[derive(Clone, Debug)]
pub struct Deck {
    facets: Vec<SurfaceTriangle>,
    bounds: Rect,
    /// The facets' plan rectangles.
    tree: RectTree,
}

/// Why triangles make no deck.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum DeckError {
    /// A coordinate is not finite.
    #[error("triangle {0} of the deck has a coordinate that is not a finite number")]
    NotFinite(usize),
}

impl Deck {
    /// A deck of triangles in world space, in any order and either way round. They may overlap; upright ones, which have
    /// no area in plan, are left out.
    ///
    /// # Errors
    /// See [`DeckError`].
    pub fn new(triangles: &[SurfaceTriangle]) -> Result<Self, DeckError> {
        if let Some(index) = triangles.iter().position(|facet| !facet.iter().all(|corner| corner.is_finite()))
        {
            return Err(DeckError::NotFinite(index));
        }
        let facets: Vec<SurfaceTriangle> = triangles.iter().copied().filter_map(counter_clockwise).collect();
        let rects: Vec<Rect> = facets.iter().map(|facet| Rect::around(plan(facet))).collect();
        let bounds = Rect::around(rects.iter().flat_map(|rect| [rect.min, rect.max]));
        Ok(Self { facets, bounds, tree: RectTree::new(&rects) })
    }

    /// The height of the highest triangle over a world position, in meters; `None` where there is none.
    pub fn height_m(&self, at: DVec2) -> Option<f64> {
        let near = self.tree.meeting(&Rect { min: at, max: at }).map(|index| &self.facets[index]);
        near.filter(|facet| facet_contains(facet, at)).map(|facet| plane_z(facet, at)).reduce(f64::max)
    }

    /// The triangles, counter-clockwise seen from above.
    pub fn facets(&self) -> &[SurfaceTriangle] {
        &self.facets
    }

    /// The smallest world rectangle around the deck; empty where it has no triangle.
    pub fn bounds(&self) -> Rect {
        self.bounds
    }
}

fn counter_clockwise(facet: SurfaceTriangle) -> Option<SurfaceTriangle> {
    let ([a, b, c], area) = (facet, polygon::doubled_triangle_area(plan(&facet)));
    if area > 0.0 { Some(facet) } else { (area < 0.0).then_some([a, c, b]) }
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
    fn the_highest_triangle_over_a_point_counts() {
        let triangles = [slab((0.0, 0.0), (10.0, 4.0), 5.0), slab((2.0, 1.0), (4.0, 9.0), 7.0)].concat();
        let deck = Deck::new(&triangles).expect("sound");
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
