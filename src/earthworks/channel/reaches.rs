//! Reaches: the pieces of a channel along which water can fall without a canyon.
//!
//! A line seldom lies where the model has its valley: it is drawn from a map of another scale, the model is coarse or has
//! the tops of trees and bridges for ground. Small rises along it are errors of either and are mended: cut through, or
//! filled up to a bank. A rise that would need a deeper cut than is allowed is none: to cut through it would draw a canyon
//! that is not there, and lower the whole river below it. There the channel is broken, and the ground stays as it is.
//!
//! ```text
//!   ground ──╮     ╭─╮          ╭───╮ ┄ top: the next reach begins
//!            ╰─────╯ ╰──╮      ╱    ╰──╮
//!             a bump is │     ╱ climb: ╰────╮
//!             cut       ╰────╯   left as it is
//!                     low: the reach ends
//! ```

/// The ground and the banks at a station, in meters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Sill {
    /// The ground that water would have to be cut into.
    pub ground_m: f64,
    /// How high water may stand, at least `ground_m`.
    pub bank_m: f64,
}

/// The first and the last station of each reach of a channel, downstream; stations between two reaches climb.
///
/// Within a reach no ground is higher than `limit_m` above any bank before it. Between two reaches it rises by more, and
/// falls on the way by no more. Costs a step or two a station.
pub(super) fn reaches(sills: &[Sill], limit_m: f64) -> Vec<(usize, usize)> {
    let mut reaches = Vec::new();
    let mut start = 0;
    while start < sills.len() {
        let (last, beyond) = fall(sills, start, limit_m);
        reaches.push((start, last));
        start = beyond.map_or(sills.len(), |beyond| top(sills, beyond, limit_m));
    }
    reaches
}

/// Where the reach that begins at `start` ends, and the station beyond whose ground is too high for it, if there is one.
fn fall(sills: &[Sill], start: usize, limit_m: f64) -> (usize, Option<usize>) {
    let (mut lowest_m, mut last) = (f64::INFINITY, start);
    for (at, sill) in sills.iter().enumerate().skip(start) {
        if sill.ground_m - lowest_m > limit_m {
            return (last, Some(at));
        }
        if sill.bank_m <= lowest_m {
            (lowest_m, last) = (sill.bank_m, at);
        }
    }
    (sills.len() - 1, None)
}

/// The highest station from `from` on before the ground falls by more than the limit.
fn top(sills: &[Sill], from: usize, limit_m: f64) -> usize {
    let mut top = from;
    for (at, sill) in sills.iter().enumerate().skip(from) {
        if sill.ground_m >= sills[top].ground_m {
            top = at;
        } else if sills[top].ground_m - sill.ground_m > limit_m {
            break;
        }
    }
    top
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn sills(heights: &[f64]) -> Vec<Sill> {
        heights.iter().map(|&ground_m| Sill { ground_m, bank_m: ground_m }).collect()
    }

    #[test]
    fn a_bump_is_no_climb_and_a_hill_is() {
        assert_eq!(reaches(&sills(&[50.0, 40.0, 44.0, 30.0]), 5.0), [(0, 3)]);
        assert_eq!(reaches(&sills(&[50.0, 40.0, 44.0, 60.0, 58.0, 30.0]), 5.0), [(0, 1), (3, 5)]);
    }

    #[test]
    fn what_falls_has_one_reach_and_what_rises_all_the_way_two_ends() {
        assert_eq!(reaches(&sills(&[50.0, 10.0, 10.0, -30.0]), 5.0), [(0, 3)]);
        assert_eq!(reaches(&sills(&[10.0, 20.0, 30.0]), 5.0), [(0, 0), (2, 2)]);
        assert_eq!(reaches(&[], 5.0), []);
    }

    #[test]
    fn one_deep_pit_breaks_only_the_way_out_of_it() {
        assert_eq!(reaches(&sills(&[50.0, 49.0, 5.0, 48.0, 47.0]), 10.0), [(0, 2), (3, 4)]);
    }

    proptest! {
        #[test]
        fn no_reach_needs_a_cut_deeper_than_the_limit(
            heights in prop::collection::vec((-50.0..50.0f64, 0.0..9.0f64), 1..80), limit_m in 0.5..30.0f64,
        ) {
            let sills: Vec<Sill> =
                heights.iter().map(|&(ground_m, up)| Sill { ground_m, bank_m: ground_m + up }).collect();
            let found = reaches(&sills, limit_m);
            prop_assert_eq!(found[0].0, 0);
            prop_assert!(found.windows(2).all(|pair| pair[0].1 < pair[1].0));
            for &(first, last) in &found {
                let reach = &sills[first..=last];
                for (at, sill) in reach.iter().enumerate() {
                    prop_assert!(reach[..at].iter().all(|before| sill.ground_m - before.bank_m <= limit_m));
                }
            }
        }
    }
}
