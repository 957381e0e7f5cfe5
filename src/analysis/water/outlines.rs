//! The outlines of posts, a cell around each, in map coordinates.

use glam::{DVec2, IVec2};

use crate::outcome::{FeatureRole, OutcomeFeature, OutcomeShape, PropertyValue};
use sandtable_geom::cell_outlines::cell_outlines;
use sandtable_terrain::lattice::{Lattice, Post};
use sandtable_terrain::post_rect::PostRect;

/// The rectangle of the posts for which `is_inside` holds of their numbers; `None` where it holds for none.
pub(crate) fn rect_of(ground: &Lattice, is_inside: impl Fn(usize) -> bool) -> Option<PostRect> {
    let inside = (0..ground.heights().len()).filter(|&index| is_inside(index));
    inside.map(|index| ground.post_at(index)).fold(None, |rect, post| Some(grown(rect, post)))
}

/// A rectangle with one more post.
pub(crate) fn grown(rect: Option<PostRect>, post: Post) -> PostRect {
    rect.unwrap_or(PostRect { first: post, last: post }).with(post)
}

/// The outlines of the posts for which `is_inside` holds of their numbers, as features with a property.
pub(crate) fn outline_features(
    ground: &Lattice,
    property: (&'static str, PropertyValue),
    is_inside: impl Fn(usize) -> bool + Copy,
) -> Vec<OutcomeFeature> {
    let shapes = rect_of(ground, is_inside).map(|rect| outlines(ground, rect, is_inside));
    let feature = |shape| OutcomeFeature {
        shape,
        name: String::new(),
        role: FeatureRole::Outline,
        properties: vec![property.clone()],
    };
    shapes.into_iter().flatten().map(feature).collect()
}

/// The outlines of the posts of a rectangle for which `is_inside` holds of their numbers.
pub(crate) fn outlines(
    ground: &Lattice,
    rect: PostRect,
    is_inside: impl Fn(usize) -> bool,
) -> Vec<OutcomeShape> {
    let columns = ground.columns() as usize;
    let (east, north) = (rect.first.column as usize, rect.first.row as usize);
    let corner = ground.map_position(rect.first) - ground.cell() * 0.5;
    let place = |at: &IVec2| corner + DVec2::new(f64::from(at.x), f64::from(at.y)) * ground.cell();
    let inside = |column: usize, row: usize| is_inside((north + row) * columns + east + column);
    cell_outlines(rect.width(), rect.height(), inside)
        .into_iter()
        .map(|outline| {
            let rings = std::iter::once(&outline.exterior).chain(&outline.holes);
            OutcomeShape::Area(rings.map(|ring| ring.iter().map(place).collect()).collect())
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_land::flat;

    #[test]
    fn an_outline_runs_half_a_cell_around_its_posts() {
        let land = flat(5, 4, 10.0);
        let is_inside = |index: usize| index == 7 || index == 8;
        let rect = rect_of(&land.ground, is_inside).expect("posts");
        let found = outlines(&land.ground, rect, is_inside);
        let ring = [(15.0, 5.0), (35.0, 5.0), (35.0, 15.0), (15.0, 15.0)].map(DVec2::from);
        let [OutcomeShape::Area(rings)] = &found[..] else { panic!("{found:?}") };
        assert_eq!(rings.len(), 1);
        assert!(ring.iter().all(|at| rings[0].contains(at)) && rings[0].len() == 4, "{rings:?}");
        assert_eq!(rect_of(&land.ground, |_| false), None);
    }
}
