//! Curves as polylines: sampled so finely that they are straight between two points, and cut to a rectangle.

use glam::DVec2;

use sandtable_geom::rect::Rect;

/// Pieces of a curve before any is halved: it does not turn back within one.
const FIRST_PIECES: u32 = 64;
/// How often a piece is halved at most. A piece that is bent even then is a gap, such as the jump from one side of a map of
/// the world to the other.
const MOST_HALVINGS: u32 = 16;

/// A curve over the shares 0 to 1 of its length in its own system; `None` where it has no place.
pub type CurvePlace<'a> = &'a dyn Fn(f64) -> Option<DVec2>;

/// The parts of a curve that lie within `rect`, nowhere more than `miss_m` beside it.
pub fn parts_within(rect: &Rect, at: CurvePlace<'_>, miss_m: f64) -> Vec<Vec<DVec2>> {
    parts_on(rect, sampled(rect, at, miss_m).into_iter())
}

/// A point of a curve and its share.
#[derive(Clone, Copy)]
struct CurvePoint {
    share: f64,
    at: Option<DVec2>,
}

fn sampled(rect: &Rect, at: CurvePlace<'_>, miss_m: f64) -> Vec<Option<DVec2>> {
    let point = |piece: u32| {
        let share = f64::from(piece) / f64::from(FIRST_PIECES);
        CurvePoint { share, at: at(share) }
    };
    let mut before = point(0);
    let mut points = vec![before.at];
    for piece in 1..=FIRST_PIECES {
        let next = point(piece);
        halve(&CurveSampling { rect, at, miss_m }, [before, next], MOST_HALVINGS, &mut points);
        before = next;
    }
    points
}

struct CurveSampling<'a> {
    rect: &'a Rect,
    at: CurvePlace<'a>,
    miss_m: f64,
}

/// Adds the points after `from`, up to and with `to`.
fn halve(
    sampling: &CurveSampling<'_>,
    [from, to]: [CurvePoint; 2],
    halvings: u32,
    points: &mut Vec<Option<DVec2>>,
) {
    let share = from.share.midpoint(to.share);
    let middle = || CurvePoint { share, at: (sampling.at)(share) };
    let middle = match (from.at, to.at) {
        (None, None) => {
            points.push(None);
            return;
        }
        (Some(start), Some(end)) => {
            let middle = middle();
            if middle.at.is_some_and(|at| {
                let is_straight = off_chord(start, end, at) <= sampling.miss_m;
                is_straight || !is_near(sampling.rect, [start, at, end])
            }) {
                points.push(Some(end));
                return;
            }
            middle
        }
        _ => middle(),
    };
    if halvings == 0 {
        points.extend([None, to.at]);
        return;
    }
    halve(sampling, [from, middle], halvings - 1, points);
    halve(sampling, [middle, to], halvings - 1, points);
}

/// The distance of a point from the straight line between two others.
fn off_chord(start: DVec2, end: DVec2, at: DVec2) -> f64 {
    match (end - start).try_normalize() {
        // A point before the start or after the end is no place on the line between them.
        Some(along) if (0.0..=start.distance(end)).contains(&(at - start).dot(along)) => {
            along.perp_dot(at - start).abs()
        }
        _ => at.distance(start.midpoint(end)),
    }
}

/// Whether a piece through these points may come near `rect`.
fn is_near(rect: &Rect, points: [DVec2; 3]) -> bool {
    let around = Rect::around(points);
    around.grown(around.size().max_element()).meets(rect)
}

/// The parts of a line that lie within `rect`.
fn parts_on(rect: &Rect, points: impl Iterator<Item = Option<DVec2>>) -> Vec<Vec<DVec2>> {
    let (mut parts, mut before): (Vec<Vec<DVec2>>, Option<DVec2>) = (Vec::new(), None);
    for point in points {
        let piece = before.zip(point).and_then(|(from, to)| rect.clip_line(from, to));
        if let Some((from, to)) = piece.filter(|(from, to)| from != to) {
            match parts.last_mut().filter(|part| part.last() == Some(&from)) {
                Some(part) => part.push(to),
                None => parts.push(vec![from, to]),
            }
        }
        before = point;
    }
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    const RECT: Rect = Rect { min: DVec2::ZERO, max: DVec2::splat(10.0) };

    #[test]
    fn a_line_is_cut_to_the_model_and_broken_where_it_has_no_place() {
        let at = |x: f64| Some(DVec2::new(x, 5.0));
        let line = [at(-5.0), at(2.0), at(4.0), None, at(6.0), at(20.0)];
        let parts = parts_on(&RECT, line.into_iter());
        let ends: Vec<[f64; 2]> = parts.iter().map(|part| [part[0].x, part[part.len() - 1].x]).collect();
        assert_eq!(ends, [[0.0, 4.0], [6.0, 10.0]]);
        assert!(parts_on(&RECT, [Some(DVec2::splat(20.0)), Some(DVec2::splat(30.0))].into_iter()).is_empty());
    }

    #[test]
    fn a_circle_is_missed_by_no_more_than_is_said_and_a_straight_line_has_few_points() {
        for miss_m in [1e-1, 1e-3, 1e-5] {
            let circle = |share: f64| {
                let turn = share * std::f64::consts::TAU;
                Some(DVec2::splat(5.0) + 4.0 * DVec2::new(libm::cos(turn), libm::sin(turn)))
            };
            let parts = parts_within(&RECT, &circle, miss_m);
            assert_eq!(parts.len(), 1);
            for pair in parts[0].windows(2) {
                let off = 4.0 - pair[0].midpoint(pair[1]).distance(DVec2::splat(5.0));
                assert!(off.abs() <= miss_m * 1.01 + 1e-12, "{off}");
            }
        }
        let straight = parts_within(&RECT, &|share| Some(DVec2::new(share * 10.0, 3.0)), 1e-9);
        assert_eq!(straight[0].len(), FIRST_PIECES as usize + 1);
    }

    #[test]
    fn a_line_ends_where_its_place_does_and_a_jump_across_the_map_is_a_gap() {
        let ends = |share: f64| (share < 0.317).then_some(DVec2::new(share * 10.0, 3.0));
        let part = &parts_within(&RECT, &ends, 1e-3)[0];
        assert!((part[part.len() - 1].x - 3.17).abs() < 1e-3, "{part:?}");
        let jumps = |share: f64| Some(DVec2::new((7.0 + share * 10.0) % 10.0, 3.0));
        let parts = parts_within(&RECT, &jumps, 1e-3);
        assert_eq!(parts.len(), 2);
        assert!(parts.iter().flatten().all(|at| at.y == 3.0));
        assert!((parts[0][0].x - 7.0).abs() < 1e-9 && parts[0].iter().all(|at| at.x >= 7.0));
    }
}
