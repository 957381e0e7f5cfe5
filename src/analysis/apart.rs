//! Places that lie apart: the one rule of kinds that name the best of many places.

use glam::DVec2;

/// The first of the places, up to `most`, of which each lies `apart_m` or more from all before it; none lies where another does.
pub(crate) fn first_apart<T: Copy>(
    places: &[T],
    most: usize,
    apart_m: f64,
    at: impl Fn(T) -> DVec2,
) -> Vec<T> {
    let is_apart = |one: T, other: T| {
        let distance_m = at(one).distance(at(other));
        distance_m >= apart_m && distance_m > 0.0
    };
    let mut taken: Vec<T> = Vec::new();
    for &place in places {
        if taken.len() >= most {
            break;
        }
        if taken.iter().all(|&other| is_apart(other, place)) {
            taken.push(place);
        }
    }
    taken
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_just_so_far_apart_are_both_taken_and_one_place_once() {
        let places = [0.0, 99.0, 100.0, 200.0, 200.0].map(|x| DVec2::new(x, 0.0));
        let taken = |apart_m: f64, most: usize| {
            first_apart(&places, most, apart_m, |at| at).iter().map(|at| at.x).collect::<Vec<_>>()
        };
        assert_eq!(taken(100.0, 9), [0.0, 100.0, 200.0]);
        assert_eq!(taken(0.0, 9), [0.0, 99.0, 100.0, 200.0]);
        assert_eq!(taken(101.0, 9), [0.0, 200.0]);
        assert_eq!(taken(100.0, 2), [0.0, 100.0]);
        assert!(taken(100.0, 0).is_empty());
    }
}
