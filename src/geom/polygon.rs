//! Polygons with holes: the one door to `geo`.

use geo::TriangulateEarcut;
use glam::DVec2;

use crate::geom::rect::Rect;

/// Twice the signed area of the ring; positive where it runs counter-clockwise.
pub fn doubled_area(ring: &[DVec2]) -> f64 {
    edges(ring).map(|(from, to)| from.perp_dot(to)).sum()
}

/// The ring's edges, the closing one last.
pub fn edges(ring: &[DVec2]) -> impl Iterator<Item = (DVec2, DVec2)> + '_ {
    let next = ring.iter().cycle().skip(1);
    ring.iter().copied().zip(next.copied())
}

/// Whether `point` lies inside by the even-odd rule over all rings: inside the outer ring and in no hole.
pub fn contains<'a>(rings: impl IntoIterator<Item = &'a [DVec2]>, point: DVec2) -> bool {
    let crossings = rings.into_iter().flat_map(edges).filter(|&(from, to)| {
        (from.y > point.y) != (to.y > point.y)
            && point.x < from.x + (to.x - from.x) * (point.y - from.y) / (to.y - from.y)
    });
    crossings.count() % 2 == 1
}

/// Cuts the polygon with `exterior` and `holes` into counter-clockwise triangles (ear clipping).
///
/// Self-intersecting rings give some triangulation of their points, never a panic.
pub fn triangulate(exterior: &[DVec2], holes: &[Vec<DVec2>]) -> Vec<[DVec2; 3]> {
    let ring = |points: &[DVec2]| geo::LineString::from_iter(points.iter().map(|p| (p.x, p.y)));
    let polygon = geo::Polygon::new(ring(exterior), holes.iter().map(|hole| ring(hole)).collect());
    let corner = |at: geo::Coord| DVec2::new(at.x, at.y);
    polygon
        .earcut_triangles()
        .into_iter()
        .map(|triangle| [corner(triangle.v1()), corner(triangle.v2()), corner(triangle.v3())])
        .filter_map(counter_clockwise)
        .collect()
}

/// Cuts a polygon without holes into counter-clockwise triples of positions in `ring` (ear clipping).
///
/// Triangles without area are kept, so that every vertex of a folded ring may be used. Empty where no ear is
/// found.
pub fn triangulate_ring(ring: &[DVec2]) -> Vec<[usize; 3]> {
    let polygon = geo::Polygon::new(geo::LineString::from_iter(ring.iter().map(|p| (p.x, p.y))), Vec::new());
    // The ring is closed by `geo`, so its last vertex is the first again.
    let corner = |index: usize| index % ring.len();
    polygon
        .earcut_triangles_raw()
        .triangle_indices
        .chunks_exact(3)
        .map(|ids| [corner(ids[0]), corner(ids[1]), corner(ids[2])])
        .map(|[a, b, c]| {
            let area = (ring[b] - ring[a]).perp_dot(ring[c] - ring[a]);
            if area < 0.0 { [a, c, b] } else { [a, b, c] }
        })
        .collect()
}

fn counter_clockwise([a, b, c]: [DVec2; 3]) -> Option<[DVec2; 3]> {
    let area = (b - a).perp_dot(c - a);
    if area > 0.0 { Some([a, b, c]) } else { (area < 0.0).then_some([a, c, b]) }
}

/// The part of a convex counter-clockwise `polygon` that lies in a convex counter-clockwise `window`
/// (Sutherland and Hodgman 1974). Empty where they do not overlap.
///
/// `polygon` and `scratch` are working space: the result is left in `polygon`.
pub fn clip_convex(polygon: &mut Vec<DVec2>, scratch: &mut Vec<DVec2>, window: &[DVec2]) {
    for side in edges(window) {
        clip_half_plane(polygon, scratch, side);
    }
}

/// Leaves in a convex `polygon` what lies to the left of the line `from`..`to` or on it. `scratch` is working space.
pub fn clip_half_plane(polygon: &mut Vec<DVec2>, scratch: &mut Vec<DVec2>, (from, to): (DVec2, DVec2)) {
    let side = |point: DVec2| (to - from).perp_dot(point - from);
    scratch.clear();
    for (index, &here) in polygon.iter().enumerate() {
        let before = polygon[(index + polygon.len() - 1) % polygon.len()];
        let (side_before, side_here) = (side(before), side(here));
        if (side_before < 0.0) != (side_here < 0.0) {
            scratch.push(before.lerp(here, side_before / (side_before - side_here)));
        }
        if side_here >= 0.0 {
            scratch.push(here);
        }
    }
    std::mem::swap(polygon, scratch);
}

/// Adds the parts of a convex counter-clockwise `polygon` that lie outside a convex counter-clockwise `window` to
/// `outside`, as convex polygons that do not overlap; what lies inside is gone.
///
/// The lines through the window's sides cut the parts off one after the other, so there are at most as many as it has
/// sides.
pub fn cut_away(mut polygon: Vec<DVec2>, window: &[DVec2], outside: &mut Vec<Vec<DVec2>>) {
    let mut scratch = Vec::new();
    for (from, to) in edges(window) {
        let mut beyond = polygon.clone();
        clip_half_plane(&mut beyond, &mut scratch, (to, from));
        clip_half_plane(&mut polygon, &mut scratch, (from, to));
        if beyond.len() > 2 {
            outside.push(beyond);
        }
        if polygon.len() < 3 {
            return;
        }
    }
}

/// The smallest rectangle around the ring.
pub fn bounds(ring: &[DVec2]) -> Rect {
    Rect::around(ring.iter().copied())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(low: f64, high: f64) -> Vec<DVec2> {
        vec![DVec2::new(low, low), DVec2::new(high, low), DVec2::new(high, high), DVec2::new(low, high)]
    }

    #[test]
    fn triangles_cover_the_polygon_without_its_hole() {
        let triangles = triangulate(&square(0.0, 10.0), &[square(4.0, 6.0)]);
        let area: f64 = triangles.iter().map(|triangle| doubled_area(triangle) / 2.0).sum();
        assert!((area - 96.0).abs() < 1e-9);
        assert!(triangles.iter().all(|triangle| doubled_area(triangle) > 0.0));
    }

    #[test]
    fn a_point_in_a_hole_is_outside() {
        let (outer, hole) = (square(0.0, 10.0), square(4.0, 6.0));
        let rings = [outer.as_slice(), hole.as_slice()];
        assert!(contains(rings, DVec2::new(2.0, 5.0)));
        assert!(!contains(rings, DVec2::new(5.0, 5.0)));
        assert!(!contains(rings, DVec2::new(-1.0, 5.0)));
    }

    #[test]
    fn what_is_cut_away_and_what_is_clipped_make_up_the_whole() {
        let window = [DVec2::new(1.0, 1.0), DVec2::new(6.0, 2.0), DVec2::new(2.0, 3.5)];
        let mut inside = square(0.0, 4.0);
        clip_convex(&mut inside, &mut Vec::new(), &window);
        let mut outside = Vec::new();
        cut_away(square(0.0, 4.0), &window, &mut outside);
        let area = |polygon: &[DVec2]| doubled_area(polygon) / 2.0;
        let parts: f64 = outside.iter().map(|part| area(part)).sum();
        assert!((parts + area(&inside) - 16.0).abs() < 1e-12);
        assert!(outside.len() <= 3 && outside.iter().all(|part| area(part) > 0.0));
    }

    #[test]
    fn clipping_leaves_the_overlap() {
        let mut polygon = square(0.0, 4.0);
        clip_convex(&mut polygon, &mut Vec::new(), &square(3.0, 9.0));
        assert!((doubled_area(&polygon) / 2.0 - 1.0).abs() < 1e-12);
        clip_convex(&mut polygon, &mut Vec::new(), &square(20.0, 21.0));
        assert!(polygon.is_empty());
    }
}
