//! Where a line on the ground ends: the first place with ground on the way from the border of the model.

use glam::DVec2;

/// How often the last step of the way is halved: to a millionth of a cell.
const HALVINGS: u32 = 20;

/// The end of a line on the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GroundEnd {
    /// World X and Y of the last place on the line with ground.
    pub at: DVec2,
    /// The direction in which the line goes on from there, of length 1.
    pub outward: DVec2,
    /// World Z of the ground there.
    pub ground_z: f64,
}

/// The end of the line `way`, which comes from the border: the first place that has ground by `ground_z`, not nearer to the
/// border than `inset_m`; steps of `step_m` are gone until there is some. `None` where the line meets no ground, or has no
/// length.
pub fn ground_end(
    way: &[DVec2],
    (inset_m, step_m): (f64, f64),
    ground_z: &dyn Fn(DVec2) -> Option<f64>,
) -> Option<GroundEnd> {
    let (mut gone_m, mut next_m, mut before_m) = (0.0, inset_m, None);
    for pair in way.windows(2) {
        let length_m = pair[0].distance(pair[1]);
        let Some(along) = (pair[1] - pair[0]).try_normalize() else { continue };
        while next_m <= gone_m + length_m {
            let place = |at_m: f64| pair[0] + along * (at_m - gone_m);
            if ground_z(place(next_m)).is_some() {
                // The way may have bent since the step before; what is cut off is shorter than a step.
                let bare_m = before_m.unwrap_or(next_m).max(gone_m);
                let end_m = first_ground(bare_m, next_m, &|at_m| ground_z(place(at_m)).is_some());
                let at = place(end_m);
                return Some(GroundEnd { at, outward: -along, ground_z: ground_z(at)? });
            }
            before_m = Some(next_m);
            next_m += step_m;
        }
        gone_m += length_m;
    }
    None
}

/// The least distance between `bare_m` and `ground_m` that has ground.
fn first_ground(mut bare_m: f64, mut ground_m: f64, has_ground: &dyn Fn(f64) -> bool) -> f64 {
    for _ in 0..HALVINGS {
        let middle_m = bare_m.midpoint(ground_m);
        if has_ground(middle_m) {
            ground_m = middle_m;
        } else {
            bare_m = middle_m;
        }
    }
    ground_m
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_ends_where_the_ground_does_along_the_line() {
        // Ground within 3 m of the diagonal.
        let ground = |at: DVec2| ((at.x - at.y).abs() < 3.0).then_some(7.0);
        let way = [DVec2::new(0.0, 20.0), DVec2::new(10.0, 20.0), DVec2::new(40.0, 20.0)];
        let end = ground_end(&way, (1e-4, 2.5), &ground).expect("it meets the diagonal");
        assert!((end.at - DVec2::new(17.0, 20.0)).length() < 1e-4, "{end:?}");
        assert_eq!((end.outward, end.ground_z), (DVec2::NEG_X, 7.0));
        let back: Vec<DVec2> = way.iter().rev().copied().collect();
        let end = ground_end(&back, (1e-4, 2.5), &ground).expect("it meets the diagonal");
        assert!((end.at.x - 23.0).abs() < 1e-4 && end.outward == DVec2::X, "{end:?}");
    }

    #[test]
    fn at_the_border_it_ends_there_and_without_ground_it_has_no_end() {
        let way = [DVec2::ZERO, DVec2::new(0.0, 50.0)];
        let end = ground_end(&way, (0.01, 10.0), &|_| Some(1.0)).expect("ground everywhere");
        assert_eq!((end.at, end.outward), (DVec2::new(0.0, 0.01), DVec2::NEG_Y));
        assert_eq!(ground_end(&way, (0.01, 10.0), &|_| None), None);
        assert_eq!(ground_end(&[DVec2::ZERO; 2], (0.01, 10.0), &|_| Some(1.0)), None);
    }
}
