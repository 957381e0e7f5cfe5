//! The profile of limited grade that lies nearest to given levels.

use crate::alignment::envelope::{above, below};
use crate::alignment::network::{SectionNetwork, StationLevels};

/// The profile that keeps the grade and whose greatest distance from `levels` is the least there is, midway between the
/// [envelopes](crate::alignment::envelope); NaN where no level reaches.
pub fn nearest(network: &SectionNetwork, levels: &StationLevels) -> StationLevels {
    let mut middle = above(network, levels);
    for (lower, upper) in middle.iter_mut().flatten().zip(below(network, levels).iter().flatten()) {
        // Both are infinite, of opposite signs, where no level reaches.
        *lower = (*lower + upper) / 2.0;
    }
    middle
}

/// As [`nearest`], and through `pins`, a level a node or NaN, as far as the grade allows from one to the others.
///
/// What the grade does not allow is shared: the pins themselves move to the nearest levels it does. Every other level then
/// gives way to the pins' cones.
pub fn through(network: &SectionNetwork, levels: &StationLevels, pins: &[f64]) -> StationLevels {
    let mut pinned = network.nowhere();
    for (section, levels) in network.sections.iter().zip(&mut pinned) {
        let last = levels.len() - 1;
        levels[0] = pins[section.ends[0].index()];
        levels[last] = pins[section.ends[1].index()];
    }
    let agreed = nearest(network, &pinned);
    for (pin, agreed) in pinned.iter_mut().flatten().zip(agreed.iter().flatten()) {
        *pin = if pin.is_nan() { f64::NAN } else { *agreed };
    }
    let mut fitted = nearest(network, levels);
    let (lower, upper) = (above(network, &pinned), below(network, &pinned));
    for (level, (lower, upper)) in
        fitted.iter_mut().flatten().zip(lower.iter().flatten().zip(upper.iter().flatten()))
    {
        if !level.is_nan() {
            *level = level.max(*lower).min(*upper);
        }
    }
    fitted
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::alignment::network::tests::section;

    fn road(levels: &[f64], step_m: f64, max_grade: f64) -> (SectionNetwork, StationLevels) {
        let stations_m = (0..levels.len()).map(|index| index as f64 * step_m).collect();
        let sections = vec![section([0, 1], stations_m, max_grade)];
        (SectionNetwork { nodes: 2, sections }, vec![levels.to_vec()])
    }

    #[test]
    fn ground_that_keeps_the_grade_is_followed_to_the_bit_of_rounding() {
        let (network, levels) = road(&[10.0, 10.5, 10.2, 11.0, 11.9], 10.0, 0.1);
        for (fitted, level) in nearest(&network, &levels)[0].iter().zip(&levels[0]) {
            assert!((fitted - level).abs() < 1e-12);
        }
    }

    #[test]
    fn a_step_is_climbed_with_as_much_cut_as_fill() {
        let levels: Vec<f64> = (0..41).map(|index| if index < 20 { 0.0 } else { 10.0 }).collect();
        let (network, levels) = road(&levels, 10.0, 0.05);
        let fitted = nearest(&network, &levels);
        assert_eq!(network.check(&fitted, 1e-9), Ok(()));
        let rises: Vec<f64> =
            fitted[0].iter().zip(&levels[0]).map(|(design, ground)| design - ground).collect();
        let highest = rises.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let deepest = rises.iter().copied().fold(f64::INFINITY, f64::min);
        assert!((highest - 4.75).abs() < 1e-9 && (deepest + 4.75).abs() < 1e-9, "{highest}, {deepest}");
    }

    #[test]
    fn pins_are_met_where_the_grade_allows_and_share_what_it_does_not() {
        let ridge: Vec<f64> = (0..21).map(|index| 30.0 - 3.0 * f64::abs(f64::from(index) - 10.0)).collect();
        let (network, levels) = road(&ridge, 10.0, 0.08);
        let fitted = through(&network, &levels, &[0.0, 5.0]);
        assert_eq!((fitted[0][0], fitted[0][20]), (0.0, 5.0));
        assert_eq!(network.check(&fitted, 1e-9), Ok(()));
        let fitted = through(&network, &levels, &[0.0, 36.0]);
        assert!((fitted[0][0] - 10.0).abs() < 1e-9 && (fitted[0][20] - 26.0).abs() < 1e-9, "{:?}", fitted[0]);
    }

    #[test]
    fn a_network_off_the_ground_has_no_profile() {
        let (network, _) = road(&[0.0; 4], 10.0, 0.1);
        assert!(through(&network, &network.nowhere(), &[f64::NAN; 2])[0].iter().all(|level| level.is_nan()));
    }
}
