//! Intervals and numbers of coordinate grids.

use sandtable_annotate::figure::CoordinateFigure;
use sandtable_annotate::grid::GridAxis;
use sandtable_annotate::nice::{NiceNumber, format_number, format_trimmed, grouped};
use sandtable_description::words::GridName;

/// The most lines of one axis: more than a sheet of paper shows.
const MOST_LINES: f64 = 400.0;

/// Intervals of geographic grids in seconds of arc, and how many of them are from index line to index line.
const SECONDS: [(f64, i64); 16] = [
    (1.0, 5),
    (2.0, 5),
    (5.0, 6),
    (10.0, 6),
    (15.0, 4),
    (30.0, 10),
    (60.0, 5),
    (120.0, 5),
    (300.0, 6),
    (600.0, 6),
    (900.0, 4),
    (1800.0, 2),
    (3600.0, 5),
    (7200.0, 5),
    (18_000.0, 2),
    (36_000.0, 3),
];

/// The distance between the lines of a grid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GridInterval {
    /// In the grid's unit: meters, or seconds of arc.
    pub value: f64,
    /// One in this many lines is an index line.
    pub index_every: i64,
}

impl GridInterval {
    /// The interval of a grid over `span` of its unit: `stated`, or the least that is not below `wanted`; more where that
    /// is too many lines.
    pub fn choose(name: GridName, stated: Option<f64>, wanted: f64, span: f64) -> Option<Self> {
        let least = stated.unwrap_or(wanted);
        if !(least > 0.0 && span.is_finite() && wanted.is_finite()) {
            return None;
        }
        let is_few = span / least <= MOST_LINES;
        match stated.filter(|_| is_few) {
            Some(value) => Some(Self { value, index_every: index_every(name, value) }),
            None => Self::at_least(name, least.max(span / MOST_LINES)),
        }
    }

    fn at_least(name: GridName, least: f64) -> Option<Self> {
        if name == GridName::Geographic {
            let found = SECONDS.iter().find(|(seconds, _)| *seconds >= least).or(SECONDS.last())?;
            return Some(Self { value: found.0, index_every: found.1 });
        }
        let mut nice = NiceNumber::at_least(least)?.value();
        if name != GridName::Metric {
            // Grid references count in powers of ten, and halves of them.
            if leading_digit(nice) == 2 {
                nice *= 2.5;
            }
            nice = nice.min(100_000.0);
        }
        Some(Self { value: nice, index_every: index_every(name, nice) })
    }

    /// The interval in words: `1 km`, `500 m`, `5′`.
    pub fn in_words(&self, name: GridName) -> String {
        if name == GridName::Geographic {
            let (unit, sign) = match self.value {
                3600.0.. => (3600.0, "°"),
                60.0.. => (60.0, "′"),
                _ => (1.0, "″"),
            };
            return format!("{}{sign}", format_trimmed(self.value / unit, 3));
        }
        let (unit, sign) = if self.value >= 1000.0 { (1000.0, "km") } else { (1.0, "m") };
        format!("{} {sign}", format_trimmed(self.value / unit, 3))
    }
}

fn leading_digit(value: f64) -> i64 {
    let exponent = libm::floor(libm::log10(value) + 1e-9);
    libm::round(value / libm::pow(10.0, exponent)) as i64
}

fn index_every(name: GridName, value: f64) -> i64 {
    if name == GridName::Geographic {
        return SECONDS.iter().find(|(seconds, _)| *seconds == value).map_or(5, |(_, every)| *every);
    }
    match leading_digit(value) {
        1 => 10,
        5 => 2,
        _ => 5,
    }
}

/// The number of a line at `value`, and in full.
pub fn figures(name: GridName, axis: GridAxis, value: f64, interval: GridInterval) -> [CoordinateFigure; 2] {
    let letter = if axis == GridAxis::East { "E" } else { "N" };
    match name {
        GridName::Geographic => {
            let text = degrees(axis, value, interval.value);
            [text.clone().into(), text.into()]
        }
        GridName::Utm | GridName::Mgrs if is_multiple(interval.value, 1.0) && value >= 0.0 => {
            military(value, interval.value, letter)
        }
        _ => {
            let number = grouped(&format_number(value, decimals(interval.value)));
            [number.clone().into(), format!("{number} {letter}").into()]
        }
    }
}

/// The decimals that multiples of an interval have, 0 to 6.
fn decimals(interval: f64) -> usize {
    const POWERS: [f64; 7] = [1.0, 10.0, 1e2, 1e3, 1e4, 1e5, 1e6];
    POWERS.iter().position(|power| is_multiple(interval * power, 1.0)).unwrap_or(6)
}

fn is_multiple(value: f64, of: f64) -> bool {
    let count = value / of;
    (count - libm::round(count)).abs() < 1e-6 * count
}

/// The digits of meters: hundreds of kilometers small, then those that references are made of, then zeros.
fn military(value: f64, interval: f64, letter: &str) -> [CoordinateFigure; 2] {
    let meters = libm::round(value) as u64;
    let whole = libm::round(interval) as u64;
    // Zeros at the end of every number of the grid; of a grid of 100 km no digit of a reference is left.
    let zeros = (0..5).take_while(|&zeros| whole.is_multiple_of(10u64.pow(zeros + 1))).count();
    let (hundreds, within) = (meters / 100_000, meters % 100_000);
    let digits = format!("{within:05}");
    let principal = &digits[..5 - zeros];
    let (before, principal) = if principal.is_empty() {
        (String::new(), hundreds.to_string())
    } else {
        (hundreds.to_string(), principal.to_owned())
    };
    let after = format!("{}m{letter}", "0".repeat(zeros));
    let figure = |after: String| CoordinateFigure::Military {
        before: before.clone(),
        principal: principal.clone(),
        after,
    };
    [figure(String::new()), figure(after)]
}

/// Degrees with minutes, seconds and decimals of them as far as the interval needs them. The meridian of 180° is neither
/// east nor west.
fn degrees(axis: GridAxis, seconds: f64, interval: f64) -> String {
    let decimals = decimals(interval);
    let unit = 10u64.pow(decimals as u32);
    let total = libm::round(seconds.abs() * unit as f64) as u64;
    let hemisphere = match (axis, seconds < 0.0) {
        (GridAxis::East, _) if total == 180 * 3600 * unit => "",
        (GridAxis::East, false) => "E",
        (GridAxis::East, true) => "W",
        (GridAxis::North, false) => "N",
        (GridAxis::North, true) => "S",
    };
    let (degrees, minutes, rest) = (total / unit / 3600, total / unit / 60 % 60, total % (60 * unit));
    let mut text = format!("{degrees}°");
    if !is_multiple(interval, 3600.0) {
        text += &format!("{minutes:02}′");
    }
    if !is_multiple(interval, 60.0) {
        let (whole, part) = (rest / unit, rest % unit);
        text += &format!("{whole:02}");
        if decimals > 0 {
            text += &format!(".{part:0decimals$}");
        }
        text += "″";
    }
    text + hemisphere
}

#[cfg(test)]
mod tests {
    use super::*;

    fn interval(name: GridName, wanted: f64) -> f64 {
        GridInterval::choose(name, None, wanted, 30_000.0).expect("sound").value
    }

    #[test]
    fn intervals_are_those_that_the_system_counts_in() {
        assert_eq!(interval(GridName::Metric, 1300.0), 2000.0);
        assert_eq!(interval(GridName::Mgrs, 1300.0), 5000.0);
        assert_eq!(interval(GridName::Utm, 800.0), 1000.0);
        assert_eq!(interval(GridName::Geographic, 200.0), 300.0);
        let far = GridInterval::choose(GridName::Mgrs, None, 3e5, 3e6).expect("sound");
        assert_eq!((far.value, far.in_words(GridName::Mgrs).as_str()), (100_000.0, "100 km"));
    }

    #[test]
    fn a_stated_interval_counts_unless_it_means_too_many_lines() {
        let stated = |value| GridInterval::choose(GridName::Metric, Some(value), 1000.0, 30_000.0);
        assert_eq!(stated(750.0).map(|interval| interval.value), Some(750.0));
        assert_eq!(stated(1e-9).map(|interval| interval.value), Some(100.0));
        assert_eq!(stated(f64::NAN), None);
    }

    #[test]
    fn principal_digits_are_those_of_a_grid_reference() {
        let text = |value, interval| {
            let interval = GridInterval { value: interval, index_every: 10 };
            figures(GridName::Mgrs, GridAxis::North, value, interval).map(|figure| match figure {
                CoordinateFigure::Military { before, principal, after } => {
                    [before, principal, after].join("|")
                }
                CoordinateFigure::Plain(text) => text,
            })
        };
        assert_eq!(text(4_018_000.0, 1000.0), ["40|18|", "40|18|000mN"]);
        assert_eq!(text(4_020_000.0, 10_000.0), ["40|2|", "40|2|0000mN"]);
        assert_eq!(text(4_005_500.0, 500.0), ["40|055|", "40|055|00mN"]);
        assert_eq!(text(4_100_000.0, 100_000.0), ["|41|", "|41|00000mN"]);
        assert_eq!(text(4_018_002.5, 2.5), ["4 018 002.5", "4 018 002.5 N"]);
    }

    #[test]
    fn degrees_have_the_minutes_and_seconds_that_the_interval_needs() {
        let text = |axis, seconds, interval| degrees(axis, seconds, interval);
        assert_eq!(text(GridAxis::East, -84.25 * 3600.0, 300.0), "84°15′W");
        assert_eq!(text(GridAxis::North, 36.0 * 3600.0, 3600.0), "36°N");
        assert_eq!(text(GridAxis::North, -0.5, 1.0), "0°00′01″S");
        assert_eq!(text(GridAxis::East, 180.0 * 3600.0, 900.0), "180°00′");
        assert_eq!(text(GridAxis::North, 90.0, 90.0), "0°01′30″N");
        assert_eq!(text(GridAxis::North, 5400.0, 5400.0), "1°30′N");
        assert_eq!(text(GridAxis::East, -0.75, 0.25), "0°00′00.75″W");
    }
}
