//! How far what is small shows in a picture: it fades before it is a few pixels wide, so that nothing sparkles.

/// How far what is `wide_m` meters wide shows where pixels are `pixel_m` wide: in full, 1, where it is `full_px` pixels wide or
/// more, and not at all, 0, where it is half as wide or less.
pub(crate) fn shown(wide_m: f32, full_px: f32, pixel_m: f32) -> f32 {
    (2.0 * wide_m / (full_px * pixel_m) - 1.0).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_fades_from_the_full_width_to_half_of_it() {
        let at = |pixel_m: f32| shown(12.0, 8.0, pixel_m);
        assert_eq!([at(0.1), at(1.5), at(2.0), at(3.0), at(9.0)], [1.0, 1.0, 0.5, 0.0, 0.0]);
    }
}
