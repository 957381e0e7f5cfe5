//! The plots of inferred fields: parcels of some hundred meters, each laid out in strips of its own direction and tones.
//!
//! They are a symbol of farmed land. No plot is one of the place, so that none has a border that is drawn.

use glam::Vec2;

use crate::area_texture::{PARCEL_TONE, parcel, part_shown, strip_tone};

/// The mean width of a parcel and of its strips, meters.
pub(crate) const FIELD_M: [f32; 2] = [560.0, 110.0];

/// The tone of the plot at world X and Y, about -1..=1, over a pixel at most `pixel_m` meters wide; its mean is 0, which it is
/// from afar.
pub(crate) fn field_tone(at: Vec2, pixel_m: f32) -> f32 {
    let [parcel_m, strip_m] = FIELD_M;
    let shown = part_shown(parcel_m, pixel_m);
    if shown <= 0.0 {
        return 0.0;
    }
    let parcel = parcel(at, parcel_m);
    let strips = match part_shown(strip_m, pixel_m) {
        shown if shown > 0.0 => shown * strip_tone(strip_m, parcel.along(at), pixel_m, parcel.cell),
        _ => 0.0,
    };
    // At its border a parcel's tone blends into the next one's.
    let inside = (parcel.inside_m / pixel_m + 0.5).clamp(0.0, 1.0);
    shown * inside * (PARCEL_TONE * parcel.tone() + strips)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn places() -> impl Iterator<Item = Vec2> {
        (0..10_000).map(|index| Vec2::new((index % 100) as f32 * 61.3 - 900.0, (index / 100) as f32 * 57.7))
    }

    #[test]
    fn plots_differ_near_by_have_no_mean_and_are_gone_from_afar() {
        let spread = |pixel_m: f32| {
            let all: Vec<f32> = places().map(|at| field_tone(at, pixel_m)).collect();
            let mean = all.iter().sum::<f32>() / all.len() as f32;
            assert!(mean.abs() < 0.05 && all.iter().all(|tone| tone.abs() <= 1.5), "{pixel_m} m: {mean}");
            all.iter().map(|tone| (tone - mean).powi(2)).sum::<f32>() / all.len() as f32
        };
        assert!(spread(2.0) > 0.2 && spread(60.0) < 0.5 * spread(2.0));
        assert_eq!(spread(400.0), 0.0);
    }

    #[test]
    fn a_plot_is_wider_than_a_step() {
        let same =
            places().filter(|at| field_tone(*at, 1.0) == field_tone(*at + Vec2::splat(4.0), 1.0)).count();
        assert!(same > 8500, "{same}");
    }
}
