//! Rings and polygons of the plane: area, containment, clipping and triangulation (by `geo`).

use geo::TriangulateEarcut;
use glam::DVec2;

use crate::rect::Rect;

/// Twice the signed area of the ring; positive where it runs counter-clockwise.
pub fn doubled_area(ring: &[DVec2]) -> f64 {
    edges(ring).map(|(from, to)| from.perp_dot(to)).sum()
}

/// The ring counter-clockwise.
pub fn counter_clockwise(ring: &[DVec2]) -> Vec<DVec2> {
    let mut ring = ring.to_vec();
    if doubled_area(&ring) < 0.0 {
        ring.reverse();
    }
    ring
}

/// Twice the signed area of a triangle; positive where it runs counter-clockwise.
pub fn doubled_triangle_area([a, b, c]: [DVec2; 3]) -> f64 {
    (b - a).perp_dot(c - a)
}

/// The ring's edges, the closing one last.
pub fn edges<T: Copy>(ring: &[T]) -> impl Iterator<Item = (T, T)> + '_ {
    let next = ring.iter().cycle().skip(1);
    ring.iter().copied().zip(next.copied())
}

/// The triangles of a convex ring's first vertex with each edge that does not end at it.
pub fn fan<T: Copy>(ring: &[T]) -> impl Iterator<Item = [T; 3]> + '_ {
    ring.get(1..).unwrap_or_default().windows(2).map(|pair| [ring[0], pair[0], pair[1]])
}

/// Whether `point` lies inside by the even-odd rule over all rings: inside the outer ring and in no hole.
pub fn contains<'a>(rings: impl IntoIterator<Item = &'a [DVec2]>, point: DVec2) -> bool {
    is_within(rings.into_iter().flat_map(edges), point)
}

/// [`contains`] for the edges of all rings.
pub fn is_within(edges: impl Iterator<Item = (DVec2, DVec2)>, point: DVec2) -> bool {
    let crossed = edges.filter(|&(from, to)| {
        (from.y > point.y) != (to.y > point.y)
            && point.x < from.x + (to.x - from.x) * (point.y - from.y) / (to.y - from.y)
    });
    crossed.count() % 2 == 1
}

/// Cuts the polygon with the outer `ring` and `holes` into counter-clockwise triangles (ear clipping).
///
/// Rings that cross themselves give some triangulation of their vertices, never a panic; those of less than three vertices
/// or with one that is not finite none. A hole that reaches beyond the box around the outer ring is none.
pub fn triangulate(ring: &[DVec2], holes: &[Vec<DVec2>]) -> Vec<[DVec2; 3]> {
    let Some(exterior) = closed(ring) else { return Vec::new() };
    // The cut sorts vertices by their place in that box, and panics on one outside.
    let around = bounds(ring);
    let is_within = |hole: &&Vec<DVec2>| hole.iter().all(|at| around.contains(*at));
    let polygon =
        geo::Polygon::new(exterior, holes.iter().filter(is_within).filter_map(|hole| closed(hole)).collect());
    let corner = |at: geo::Coord| DVec2::new(at.x, at.y);
    polygon
        .earcut_triangles()
        .into_iter()
        .map(|triangle| [corner(triangle.v1()), corner(triangle.v2()), corner(triangle.v3())])
        .filter_map(counter_clockwise_triangle)
        .collect()
}

/// Cuts a polygon without holes into counter-clockwise triples of positions in `ring` (ear clipping).
///
/// Triangles without area are kept, so that every vertex of a folded ring may be used. Empty where no ear is found.
pub fn triangulate_ring(ring: &[DVec2]) -> Vec<[usize; 3]> {
    let Some(exterior) = closed(ring) else { return Vec::new() };
    let polygon = geo::Polygon::new(exterior, Vec::new());
    // The ring is closed by `geo`, so its last vertex is the first again.
    let corner = |index: usize| index % ring.len();
    polygon
        .earcut_triangles_raw()
        .triangle_indices
        .chunks_exact(3)
        .map(|ids| [corner(ids[0]), corner(ids[1]), corner(ids[2])])
        .map(
            |ids| {
                if doubled_triangle_area(ids.map(|id| ring[id])) < 0.0 {
                    [ids[0], ids[2], ids[1]]
                } else {
                    ids
                }
            },
        )
        .collect()
}

/// The ring with its first vertex at the end as well; `None` where it has less than three, which `geo` takes for a mistake of
/// its caller, or one that is not finite.
fn closed(ring: &[DVec2]) -> Option<geo::LineString> {
    if ring.iter().any(|at| !at.is_finite()) {
        return None;
    }
    let mut line: geo::LineString = ring.iter().map(|at| (at.x, at.y)).collect();
    line.close();
    (line.0.len() > 3).then_some(line)
}

fn counter_clockwise_triangle([a, b, c]: [DVec2; 3]) -> Option<[DVec2; 3]> {
    let area = doubled_triangle_area([a, b, c]);
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

/// Keeps the part of a convex `polygon` that lies to the left of the line `from`..`to` or on it. `scratch` is working
/// space.
pub fn clip_half_plane(polygon: &mut Vec<DVec2>, scratch: &mut Vec<DVec2>, (from, to): (DVec2, DVec2)) {
    scratch.clear();
    clip_to(polygon, scratch, (from, to));
    std::mem::swap(polygon, scratch);
}

/// Appends to `kept` the part of a convex `polygon` that lies to the left of the line `from`..`to` or on it.
fn clip_to(polygon: &[DVec2], kept: &mut Vec<DVec2>, (from, to): (DVec2, DVec2)) {
    let side = |point: DVec2| (to - from).perp_dot(point - from);
    clip(polygon, side, |before, here, part| before.lerp(here, part), kept);
}

/// Appends to `kept` the part of a ring where `side` is not negative (Sutherland and Hodgman 1974). Where an edge crosses
/// to the other side, `cut` gives the vertex at a part of it, 0..=1.
///
/// What is left of a concave ring may run back along the border by which it was cut.
pub fn clip(
    ring: &[DVec2],
    side: impl Fn(DVec2) -> f64,
    cut: impl Fn(DVec2, DVec2, f64) -> DVec2,
    kept: &mut Vec<DVec2>,
) {
    let Some(&last) = ring.last() else { return };
    let (mut before, mut side_before) = (last, side(last));
    for &here in ring {
        let side_here = side(here);
        if (side_before < 0.0) != (side_here < 0.0) {
            kept.push(cut(before, here, side_before / (side_before - side_here)));
        }
        if side_here >= 0.0 {
            kept.push(here);
        }
        (before, side_before) = (here, side_here);
    }
}

/// Adds the parts of a convex counter-clockwise `polygon` that lie outside a convex counter-clockwise `window` to
/// `outside`, as convex polygons that do not overlap.
///
/// The lines through the window's sides cut the parts off one after the other, so there are at most as many parts as
/// sides.
pub fn cut_away(mut polygon: Vec<DVec2>, window: &[DVec2], outside: &mut Vec<Vec<DVec2>>) {
    // A side cuts off one corner at the least, and adds two.
    let room = polygon.len() + window.len();
    let (mut beyond, mut scratch) = (Vec::with_capacity(room), Vec::with_capacity(room));
    for (from, to) in edges(window) {
        beyond.clear();
        clip_to(&polygon, &mut beyond, (to, from));
        if beyond.len() > 2 {
            outside.push(beyond.clone());
        }
        clip_half_plane(&mut polygon, &mut scratch, (from, to));
        if polygon.len() < 3 {
            return;
        }
    }
}

/// The X at which the edges of a polygon's `rings` cross the level line at `y`, from west to east: inside is from each
/// first to each second.
pub fn crossings<'a>(rings: impl IntoIterator<Item = &'a [DVec2]>, y: f64) -> Vec<f64> {
    let crossed = |(from, to): (DVec2, DVec2)| {
        let crosses = (from.y > y) != (to.y > y);
        crosses.then(|| from.x + (to.x - from.x) * (y - from.y) / (to.y - from.y))
    };
    let mut crossings: Vec<f64> = rings.into_iter().flat_map(edges).filter_map(crossed).collect();
    crossings.sort_by(f64::total_cmp);
    crossings
}

/// The middle of the widest span inside a polygon's `rings` and `rect` along three level lines, and the width of that span;
/// `None` where none of them meets the polygon. A place for a name: inside, and away from the outline to either side.
pub fn inner_point<'a>(
    rings: impl IntoIterator<Item = &'a [DVec2]> + Clone,
    rect: &Rect,
) -> Option<(DVec2, f64)> {
    let around = rings.clone().into_iter().flatten().copied();
    let part = Rect::around(around).intersection(rect);
    if part.is_empty() {
        return None;
    }
    // The middle first: of equal spans the first counts.
    let spans = [0.5, 0.25, 0.75].into_iter().filter_map(|share| {
        let y = part.min.y + part.size().y * share;
        let crossings = crossings(rings.clone(), y);
        let clipped = |pair: &[f64]| (pair[0].max(part.min.x), pair[1].min(part.max.x));
        let spans = crossings.chunks_exact(2).map(clipped).filter(|(west, east)| west < east);
        let widest = spans.reduce(|best, next| if next.1 - next.0 > best.1 - best.0 { next } else { best });
        widest.map(|(west, east)| (DVec2::new((west + east) / 2.0, y), east - west))
    });
    spans.reduce(|best, next| if next.1 > best.1 { next } else { best })
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
    fn a_hole_beyond_the_ring_and_vertices_that_are_not_finite_do_not_panic() {
        // So many vertices that the cut sorts them.
        let at = |index: usize, radius: f64| {
            let angle = index as f64 * std::f64::consts::TAU / 100.0;
            DVec2::new(libm::cos(angle), libm::sin(angle)) * radius
        };
        let ring: Vec<DVec2> = (0..100).map(|index| at(index, 9.0)).collect();
        let hole: Vec<DVec2> = (0..100).rev().map(|index| at(index, 3.0)).collect();
        let far = vec![DVec2::splat(-20.0), DVec2::splat(-30.0), DVec2::new(-20.0, -30.0)];
        let area = |holes: &[Vec<DVec2>]| {
            triangulate(&ring, holes).into_iter().map(doubled_triangle_area).sum::<f64>() / 2.0
        };
        let whole = area(&[]);
        assert!((area(&[hole.clone(), far]) - whole * 8.0 / 9.0).abs() < 1e-6);
        let mut broken = ring.clone();
        broken[7].x = f64::NAN;
        assert!(
            triangulate(&broken, std::slice::from_ref(&hole)).is_empty()
                && triangulate_ring(&broken).is_empty()
        );
        let lost = [DVec2::new(f64::INFINITY, 0.0), DVec2::ZERO, DVec2::ONE];
        assert!((area(&[lost.to_vec()]) - whole).abs() < 1e-6);
    }

    #[test]
    fn an_inner_point_lies_in_the_widest_span_within_the_rectangle() {
        let all = Rect { min: DVec2::splat(-99.0), max: DVec2::splat(99.0) };
        // The letter L: its middle lies on its foot, not between its arms.
        let corners = [(0.0, 0.0), (10.0, 0.0), (10.0, 3.0), (2.0, 3.0), (2.0, 10.0), (0.0, 10.0)];
        let letter = corners.map(|(x, y)| DVec2::new(x, y));
        assert_eq!(inner_point([&letter[..]], &all), Some((DVec2::new(5.0, 2.5), 10.0)));
        let (outer, hole) = (square(0.0, 10.0), square(2.0, 8.0));
        let (at, _) = inner_point([&outer[..], &hole[..]], &all).expect("there is ground around the hole");
        assert!(contains([&outer[..], &hole[..]], at), "{at}");
        let west = Rect { min: DVec2::splat(-99.0), max: DVec2::new(4.0, 99.0) };
        assert_eq!(inner_point([&outer[..]], &west), Some((DVec2::new(2.0, 5.0), 4.0)));
        let beyond = Rect { min: DVec2::splat(20.0), max: DVec2::splat(99.0) };
        assert_eq!(inner_point([&outer[..]], &beyond), None);
    }

    #[test]
    fn triangles_cover_the_polygon_without_its_hole() {
        let triangles = triangulate(&square(0.0, 10.0), &[square(4.0, 6.0)]);
        let area: f64 = triangles.iter().map(|triangle| doubled_area(triangle) / 2.0).sum();
        assert!((area - 96.0).abs() < 1e-9);
        assert!(triangles.iter().all(|triangle| doubled_area(triangle) > 0.0));
    }

    #[test]
    fn rings_of_less_than_three_vertices_have_no_triangles() {
        let (a, b) = (DVec2::new(1.0, 2.0), DVec2::new(3.0, 4.0));
        for ring in [&[][..], &[a], &[a, a], &[a, b], &[a, b, a]] {
            assert!(triangulate(ring, &[]).is_empty() && triangulate_ring(ring).is_empty(), "{ring:?}");
            assert_eq!(triangulate(&square(0.0, 10.0), &[ring.to_vec()]).len(), 2, "{ring:?}");
        }
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
    fn the_parts_cut_away_and_the_part_inside_add_up_to_the_polygon() {
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
