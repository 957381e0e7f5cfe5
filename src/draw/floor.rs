//! Whole numbers below others, quickly: noise of lattices takes two of each place.

use glam::Vec2;

/// The greatest whole number not above `value`: by a conversion where that is exact, which takes a fraction of the time of the
/// standard library's call where the processor is not known to round.
pub(crate) fn floor(value: f32) -> f32 {
    const EXACT: f32 = 8_388_608.0;
    if value.abs() < EXACT {
        let whole = value as i32 as f32;
        if whole > value { whole - 1.0 } else { whole }
    } else {
        value.floor()
    }
}

/// [`floor`] of X and of Y.
pub(crate) fn floor_each(at: Vec2) -> Vec2 {
    Vec2::new(floor(at.x), floor(at.y))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn floors_are_those_of_the_standard_library() {
        for value in [0.0, -0.0, 0.5, -0.5, 1.0, -1.0, 7.999, -7.001, 8_388_607.5, -8_388_607.5, 1e20, -1e20]
        {
            assert_eq!(floor(value), value.floor(), "{value}");
            assert_eq!(floor_each(Vec2::splat(value)), Vec2::splat(value).floor());
        }
        assert!(floor(f32::NAN).is_nan());
    }
}
