//! Classes of round numbers for rasters whose kind has none of its own, so that pictures and legends show them alike.
//!
//! A few samples tell the range: steps of 1, 2 or 5 times a power of ten over it, steps on both sides of 0 where values lie on
//! both, and powers of ten where a few values are far above all others.

use crate::outcome::{Hatching, OutcomeRaster, ValueClass};
use sandtable_base::message::numbers::trimmed;

/// Values of a raster without classes that are looked at for its classes.
const MOST_SAMPLES: usize = 1 << 16;

/// The classes of a raster that has none of its own.
const CLASSES: usize = 7;

/// From this ratio of the largest to the middle value classes are powers of ten.
const LOGARITHMIC: f32 = 1e4;

/// The share of light that the tint of such a class stops, of 255.
const TINT_ALPHA: u8 = 125;

/// Their tints from low to high, of equal steps to the eye (viridis, van der Walt and Smith 2015).
const RAMP: [[u8; 3]; CLASSES] = [
    [68, 1, 84],
    [68, 57, 131],
    [49, 104, 142],
    [33, 145, 140],
    [53, 183, 121],
    [144, 215, 67],
    [253, 231, 37],
];

/// The tints of classes on both sides of 0, from far below to far above; what is near 0 is pale.
const SIDES: [[u8; 4]; 6] = [
    [33, 102, 172, 165],
    [67, 147, 195, 125],
    [146, 197, 222, 50],
    [244, 165, 130, 50],
    [214, 96, 77, 125],
    [178, 24, 43, 165],
];

/// Values are told by their side of 0 where the smaller side reaches at least this share as far as the larger one.
const TWO_SIDED: f32 = 0.2;

/// Square meters in a square kilometer.
const KM2: f32 = 1e6;

/// The share of light that the tint of a class by powers of ten stops, of 255.
const WATER_ALPHA: u8 = 215;

/// The tints of classes by powers of ten, the lowest of which is none: more water is darker.
const WATERS: [[u8; 3]; CLASSES] = [
    [255, 255, 255],
    [190, 215, 240],
    [140, 185, 230],
    [90, 150, 215],
    [50, 110, 195],
    [25, 75, 165],
    [10, 40, 120],
];

/// Classes of round numbers over the range of the values, by powers of ten where a few are far above all others.
pub(crate) fn round_classes(raster: &OutcomeRaster) -> Vec<ValueClass> {
    let stride = raster.values.len().div_ceil(MOST_SAMPLES).max(1);
    let values = (0..raster.values.len()).step_by(stride).map(|index| raster.values.value(index));
    let mut values: Vec<f32> = values.filter(|value| value.is_finite()).collect();
    values.sort_by(f32::total_cmp);
    let at = |share: f64| values.get(((values.len() as f64 - 1.0) * share) as usize).copied();
    let (Some(low), Some(middle), Some(high)) = (at(0.02), at(0.5), at(0.98)) else { return Vec::new() };
    if low < 0.0 && (-low).min(high) >= TWO_SIDED * (-low).max(high) {
        return sides((-low).max(high), raster.unit);
    }
    let greatest = (0..raster.values.len()).map(|index| raster.values.value(index)).fold(high, f32::max);
    let (froms, tints) = match middle > 0.0 && greatest / middle > LOGARITHMIC {
        true => (powers(middle, greatest), WATERS),
        false => (steps(low, high), RAMP),
    };
    let is_large = raster.unit == "m²" && froms.iter().any(|from| *from >= KM2 / 10.0);
    let (unit, scale) = if is_large { ("km²", 1.0 / KM2) } else { (raster.unit, 1.0) };
    let unit = after_number(unit);
    let written = |from: f32| short(from * scale);
    let class = |(index, &from): (usize, &f32)| {
        let label = match froms.get(index + 1) {
            Some(&to) => format!("{} to {}{unit}", written(from), written(to)),
            None => format!("{}{unit} and more", written(from)),
        };
        let place = index * (CLASSES - 1) / (froms.len() - 1).max(1);
        let [red, green, blue] = tints[place];
        let alpha = match tints == WATERS {
            true if index == 0 => 0,
            true => WATER_ALPHA,
            false => TINT_ALPHA,
        };
        let tint = if alpha == 0 { [0; 4] } else { [red, green, blue, alpha] };
        ValueClass::new(if index == 0 { f32::NEG_INFINITY } else { from }, label, tint, Hatching::None)
    };
    froms.iter().enumerate().map(class).collect()
}

/// Classes on both sides of 0 that part most values within `reach` of it.
fn sides(reach: f32, unit: &str) -> Vec<ValueClass> {
    let step = round_step(f64::from(reach) / 3.0) as f32;
    let unit = after_number(unit);
    let class = |(index, tint): (usize, [u8; 4])| {
        let (from, to) = (step * (index as f32 - 3.0), step * (index as f32 - 2.0));
        match index {
            0 => {
                ValueClass::new(f32::NEG_INFINITY, format!("below {}{unit}", short(to)), tint, Hatching::None)
            }
            5 => ValueClass::new(from, format!("{}{unit} and more", short(from)), tint, Hatching::None),
            _ => {
                let label = format!("{} to {}{unit}", short(from), short(to));
                ValueClass::new(from, label, tint, Hatching::None)
            }
        }
    };
    SIDES.into_iter().enumerate().map(class).collect()
}

/// 1, 2 or 5 times a power of ten, at least `rough`.
fn round_step(rough: f64) -> f64 {
    let power = libm::pow(10.0, libm::log10(rough).floor());
    let step = [1.0, 2.0, 5.0, 10.0].map(|factor| factor * power).into_iter().find(|step| *step >= rough);
    step.unwrap_or(10.0 * power)
}

/// Round numbers from below `low` to `high`, at most [`CLASSES`] of them.
fn steps(low: f32, high: f32) -> Vec<f32> {
    let (low, high) = (f64::from(low), f64::from(high));
    let rough = ((high - low) / (CLASSES as f64 - 1.0)).max(low.abs().max(1.0) * 1e-6);
    let step = round_step(rough);
    let first = (low / step).floor();
    let count = ((high / step).floor() - first) as usize + 1;
    (0..count.clamp(1, CLASSES)).map(|index| ((first + index as f64) * step) as f32).collect()
}

/// The powers of ten from above `middle` to `greatest`, the last [`CLASSES`] of them.
fn powers(middle: f32, greatest: f32) -> Vec<f32> {
    let from = libm::log10(f64::from(middle)).ceil() as i32;
    let to = libm::log10(f64::from(greatest)).floor() as i32;
    let first = from.max(to - CLASSES as i32 + 1);
    (first..=to.max(first)).map(|power| libm::pow(10.0, f64::from(power)) as f32).collect()
}

/// A unit as it follows a number; nothing where there is none.
fn after_number(unit: &str) -> String {
    if unit.is_empty() { String::new() } else { format!(" {unit}") }
}

/// A number with three decimals at most.
fn short(number: f32) -> String {
    trimmed(number, 3)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::outcome::PostValues;

    fn raster(values: Vec<f32>) -> OutcomeRaster {
        OutcomeRaster { name: "test", unit: "m", values: PostValues::Numbers(values), classes: Vec::new() }
    }

    #[test]
    fn values_without_classes_have_round_steps_that_hold_each_of_them() {
        let raster = raster((0..=1000).map(|value| value as f32 * 0.37).chain([f32::NAN]).collect());
        let raster = raster.with_classes();
        let classes = &raster.classes;
        let froms: Vec<f32> = classes.iter().skip(1).map(|class| class.from).collect();
        assert_eq!(froms, [100.0, 200.0, 300.0]);
        assert_eq!(classes[1].label, "100 to 200 m");
        assert_eq!(raster.class_of(-5.0), Some(0));
        assert_eq!(raster.class_of(250.0), Some(2));
        assert_eq!(raster.class_of(f32::NAN), None);
    }

    #[test]
    fn values_on_both_sides_of_0_are_told_by_their_side() {
        let raster = raster((-100..=100).map(|value| value as f32 * 0.6).collect());
        let raster = raster.with_classes();
        let classes = &raster.classes;
        let froms: Vec<f32> = classes.iter().skip(1).map(|class| class.from).collect();
        assert_eq!(froms, [-40.0, -20.0, 0.0, 20.0, 40.0]);
        assert_eq!(
            [0, 1, 5].map(|index| &*classes[index].label),
            ["below -40 m", "-40 to -20 m", "40 m and more"]
        );
        assert_eq!(raster.class_of(-999.0), Some(0));
    }

    #[test]
    fn a_few_values_far_above_the_others_have_classes_by_powers_of_ten() {
        let raster = raster((0..900).map(|_| 30.0).chain([1e3, 1e5, 3e7]).collect());
        let raster = raster.with_classes();
        let classes = &raster.classes;
        let froms: Vec<f32> = classes.iter().skip(1).map(|class| class.from).collect();
        assert_eq!(froms, [1e3, 1e4, 1e5, 1e6, 1e7]);
        assert_eq!(classes[0].look.tint, [0; 4]);
    }

    #[test]
    fn a_raster_without_data_or_of_one_value_has_classes_all_the_same() {
        assert!(raster(vec![f32::NAN; 4]).with_classes().classes.is_empty());
        assert_eq!(raster(vec![4.0; 4]).with_classes().classes.len(), 1);
    }

    #[test]
    fn numbers_of_classes_are_those_of_the_values_and_held_ones_are_found() {
        let classes = vec![
            ValueClass::new(1.0, "low", [0; 4], Hatching::None),
            ValueClass::new(4.0, "middle", [0; 4], Hatching::None),
            ValueClass::new(9.0, "high", [0; 4], Hatching::None),
        ];
        let numbers = PostValues::Numbers(vec![0.5, 1.0, 8.9, 1e9, f32::NAN, 3.9]);
        let codes = PostValues::Codes(vec![0, 1, 8, PostValues::NO_CODE, 3, 4]);
        for (values, wanted) in [
            (numbers, [None, Some(0), Some(1), Some(2), None, Some(0)]),
            (codes, [None, Some(0), Some(1), None, Some(0), Some(1)]),
        ] {
            let raster = OutcomeRaster { name: "test", unit: "", values, classes: classes.clone() };
            let number = |class: Option<u16>| class.unwrap_or(OutcomeRaster::NO_CLASS);
            assert_eq!(raster.class_numbers(), wanted.map(number));
            let held: Vec<bool> = (0..3).map(|class| wanted.contains(&Some(class))).collect();
            assert_eq!(raster.held_classes(), held);
        }
    }
}
