//! The position of the sun in the sky: the low-precision formulas of the Astronomical Almanac (Michalsky 1988, "The
//! Astronomical Almanac's algorithm for approximate solar position"), within 0.01° from 1950 to 2050.

use glam::DVec2;

/// A direction in the sky.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SunPosition {
    /// Clockwise from true north, radians, 0..2π.
    pub azimuth_rad: f64,
    /// Above the horizon, radians, without refraction; negative below it.
    pub altitude_rad: f64,
}

/// The position of the sun at a time, in seconds since 1970 UTC, over longitude and latitude in degrees.
pub fn sun_position(unix_s: f64, place: DVec2) -> SunPosition {
    // Days since noon of the first of January 2000.
    let days = unix_s / 86_400.0 - 10_957.5;
    let mean_longitude = 280.460 + 0.985_647_4 * days;
    let anomaly = (357.528 + 0.985_600_3 * days).to_radians();
    let center = 1.915 * libm::sin(anomaly) + 0.020 * libm::sin(2.0 * anomaly);
    let longitude = (mean_longitude + center).to_radians();
    let tilt = (23.439 - 0.000_000_4 * days).to_radians();
    let ascension = libm::atan2(libm::cos(tilt) * libm::sin(longitude), libm::cos(longitude));
    let declination = libm::asin(libm::sin(tilt) * libm::sin(longitude));
    let sidereal = (280.460_618_37 + 360.985_647_366_29 * days + place.x).rem_euclid(360.0).to_radians();
    let (hour, latitude) = (sidereal - ascension, place.y.to_radians());
    let east = -libm::cos(declination) * libm::sin(hour);
    let north = libm::sin(declination) * libm::cos(latitude)
        - libm::cos(declination) * libm::cos(hour) * libm::sin(latitude);
    let up = libm::sin(declination) * libm::sin(latitude)
        + libm::cos(declination) * libm::cos(hour) * libm::cos(latitude);
    SunPosition {
        azimuth_rad: libm::atan2(east, north).rem_euclid(std::f64::consts::TAU),
        altitude_rad: libm::asin(up.clamp(-1.0, 1.0)),
    }
}

/// Seconds since 1970 UTC of a date and time with an offset as RFC 3339 has them; `None` for any other text.
pub fn unix_seconds(text: &str) -> Option<f64> {
    let (date, time) = text.split_once(['T', 't', ' '])?;
    let [year, month, day] = numbers(date, '-', [4, 2, 2])?;
    let zone = time.find(['Z', 'z', '+', '-'])?;
    let (clock, zone) = time.split_at(zone);
    let (clock, fraction) = clock.split_once('.').unwrap_or((clock, "0"));
    let [hour, minute, second] = numbers(clock, ':', [2, 2, 2])?;
    let offset_minutes = match zone {
        "Z" | "z" => 0,
        _ => {
            let [hours, minutes] = numbers(&zone[1..], ':', [2, 2])?;
            let minutes = (hours < 24 && minutes < 60).then_some(hours * 60 + minutes)?;
            if zone.starts_with('-') { -minutes } else { minutes }
        }
    };
    let is_leap = year % 4 == 0 && (year % 100 != 0 || year % 400 == 0);
    let days = [31, if is_leap { 29 } else { 28 }, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31];
    let days_before = usize::try_from(month).ok()?.checked_sub(1).filter(|&month| month < 12)?;
    if !(1..=days[days_before]).contains(&day) || hour > 23 || minute > 59 || second > 60 {
        return None;
    }
    let leap_days = |year: i64| year.div_euclid(4) - year.div_euclid(100) + year.div_euclid(400);
    let since_1970 = (year - 1970) * 365 + leap_days(year - 1) - leap_days(1969);
    let days = since_1970 + days[..days_before].iter().sum::<i64>() + day - 1;
    let fraction: f64 = format!("0.{fraction}").parse().ok().filter(|_| is_digits(fraction))?;
    Some((days * 86_400 + hour * 3600 + (minute - offset_minutes) * 60 + second) as f64 + fraction)
}

/// Numbers of these lengths in digits between separators.
fn numbers<const N: usize>(text: &str, separator: char, lengths: [usize; N]) -> Option<[i64; N]> {
    let mut parts = text.split(separator);
    let mut numbers = [0; N];
    for (number, length) in numbers.iter_mut().zip(lengths) {
        let part = parts.next().filter(|part| part.len() == length && is_digits(part))?;
        *number = part.parse().ok()?;
    }
    parts.next().is_none().then_some(numbers)
}

fn is_digits(text: &str) -> bool {
    !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_seconds_since_1970() {
        assert_eq!(unix_seconds("1970-01-01T00:00:00Z"), Some(0.0));
        assert_eq!(unix_seconds("2000-02-29T12:00:00.5+02:00"), Some(951_818_400.5));
        assert_eq!(unix_seconds("2026-06-21 09:30:00-05:30"), Some(1_782_054_000.0));
        assert_eq!(unix_seconds("1969-12-31T23:59:59Z"), Some(-1.0));
        let bad = [
            "",
            "noon",
            "2026-06-21",
            "2026-06-21T09:30:00",
            "2026-02-29T09:30:00Z",
            "2026-13-01T09:30:00Z",
            "2026-06-21T24:30:00Z",
            "2026-06-21T09:30Z",
            "2026-06-21T09:30:00.Z",
            "2026-06-21T09:30:00+2:00",
            "2026-06-21T09:30:00Zé",
            "20260-6-21T09:30:00Z",
            "2026-06-21T09:30:00é",
        ];
        for text in bad {
            assert_eq!(unix_seconds(text), None, "{text}");
        }
    }

    /// Azimuth and altitude as NREL's Solar Position Algorithm gives them (Reda and Andreas 2004, its worked example:
    /// Golden, Colorado), and where geometry leaves no choice.
    #[test]
    fn the_sun_stands_where_almanacs_have_it() {
        let at = |time: &str, longitude: f64, latitude: f64| {
            let sun = sun_position(unix_seconds(time).expect("a time"), DVec2::new(longitude, latitude));
            (sun.azimuth_rad.to_degrees(), sun.altitude_rad.to_degrees())
        };
        let (azimuth, altitude) = at("2003-10-17T12:30:30-07:00", -105.1786, 39.742476);
        assert!((azimuth - 194.340).abs() < 0.02, "{azimuth}");
        assert!((90.0 - altitude - 50.111).abs() < 0.03, "{altitude}, with refraction");
        let (_, at_the_pole) = at("2026-06-21T00:00:00Z", 0.0, 90.0);
        assert!((at_the_pole - 23.44).abs() < 0.01, "{at_the_pole}");
        let (_, at_midnight) = at("2026-12-21T00:00:00Z", 0.0, 51.5);
        assert!(at_midnight < -60.0, "{at_midnight}");
    }
}
