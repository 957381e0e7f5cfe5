//! Moments as overlays and scenarios write them: ISO 8601 (RFC 3339), or milliseconds since 1970.

use std::fmt;

/// A moment: seconds since the beginning of 1970, UTC.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Moment(i64);

const DAY: i64 = 86_400;

impl Moment {
    /// The moment of milliseconds since the beginning of 1970; `None` beyond the years 0..=9999.
    pub fn from_milliseconds(milliseconds: f64) -> Option<Self> {
        let seconds = (milliseconds / 1000.0).floor();
        Self::within((seconds.abs() < 1e12).then_some(seconds as i64)?)
    }

    /// The moment of a text: a day, or a day and a time with seconds or without, in a zone (`Z`, `+02:00`, `-0400`) or in UTC.
    /// `None` where it is none.
    pub fn parse(text: &str) -> Option<Self> {
        let text = text.trim();
        let (day, rest) = (text.get(..10)?, text.get(10..)?);
        let [year, month, of_month] = parts(day, '-')?;
        let days = days_since_1970(year, month, of_month)?;
        let clock = match rest.strip_prefix(['T', 't', ' ']) {
            Some(clock) => clock,
            None if rest.is_empty() => return Self::within(days * DAY),
            None => return None,
        };
        let zone_at = clock.find(['Z', 'z', '+', '-']).unwrap_or(clock.len());
        let (time, zone) = clock.split_at(zone_at);
        let whole = time.split_once(['.', ',']).map_or(time, |(whole, _)| whole);
        let [hour, minute, second] = match whole.matches(':').count() {
            1 => parts(&format!("{whole}:00"), ':')?,
            _ => parts(whole, ':')?,
        };
        // A leap second is that after it; 24:00 is the end of the day.
        let is_sound = (0..24).contains(&hour) || (hour == 24 && minute == 0 && second == 0);
        if !is_sound || !(0..60).contains(&minute) || !(0..=60).contains(&second) {
            return None;
        }
        Self::within(days * DAY + hour * 3600 + minute * 60 + second - offset(zone)?)
    }

    fn within(seconds: i64) -> Option<Self> {
        /// From the year 0 to 9999.
        const SECONDS: std::ops::Range<i64> = -62_167_219_200..253_402_300_800;
        SECONDS.contains(&seconds).then_some(Self(seconds))
    }
}

/// Three numbers of digits alone.
fn parts(text: &str, separator: char) -> Option<[i64; 3]> {
    let mut numbers = text.split(separator).map(|part| {
        let is_number = !part.is_empty() && part.len() <= 4 && part.bytes().all(|byte| byte.is_ascii_digit());
        is_number.then(|| part.parse().ok()).flatten()
    });
    let three = [numbers.next()??, numbers.next()??, numbers.next()??];
    numbers.next().is_none().then_some(three)
}

/// The seconds by which a zone is ahead of UTC.
fn offset(zone: &str) -> Option<i64> {
    let (sign, digits) = match zone.as_bytes().first() {
        None | Some(b'Z' | b'z') => return (zone.len() <= 1).then_some(0),
        Some(b'+') => (1, &zone[1..]),
        _ => (-1, &zone[1..]),
    };
    let digits = digits.replace(':', "");
    if !digits.bytes().all(|byte| byte.is_ascii_digit()) {
        return None;
    }
    let (hours, minutes) = match digits.len() {
        2 => (digits.parse::<i64>().ok()?, 0),
        4 => (digits[..2].parse().ok()?, digits[2..].parse::<i64>().ok()?),
        _ => return None,
    };
    (hours <= 14 && minutes < 60).then_some(sign * (hours * 3600 + minutes * 60))
}

/// Days of the Gregorian calendar, which is extended to before its beginning.
fn days_since_1970(year: i64, month: i64, day: i64) -> Option<i64> {
    let is_leap = (year % 4 == 0 && year % 100 != 0) || year % 400 == 0;
    let lengths = [31, if is_leap { 29 } else { 28 }, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31];
    let index = usize::try_from(month - 1).ok()?;
    let length = *lengths.get(index)?;
    if !(1..=length).contains(&day) {
        return None;
    }
    let before = year - 1;
    let leaps = before.div_euclid(4) - before.div_euclid(100) + before.div_euclid(400);
    Some(before * 365 + leaps + lengths[..index].iter().sum::<i64>() + day - 1 - 719_162)
}

impl fmt::Display for Moment {
    /// `1982-05-21T16:00:00Z`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (mut day, second) = (self.0.div_euclid(DAY), self.0.rem_euclid(DAY));
        // Days from 1 March 0000 (Howard Hinnant, "chrono-compatible low-level date algorithms").
        day += 719_468;
        let era = day.div_euclid(146_097);
        let of_era = day.rem_euclid(146_097);
        let year_of_era = (of_era - of_era / 1460 + of_era / 36_524 - of_era / 146_096) / 365;
        let of_year = of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
        let shifted = (5 * of_year + 2) / 153;
        let of_month = of_year - (153 * shifted + 2) / 5 + 1;
        let month = if shifted < 10 { shifted + 3 } else { shifted - 9 };
        let year = year_of_era + era * 400 + i64::from(month <= 2);
        let (hour, minute, second) = (second / 3600, second / 60 % 60, second % 60);
        write!(f, "{year:04}-{month:02}-{of_month:02}T{hour:02}:{minute:02}:{second:02}Z")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_are_read_in_every_zone_and_written_in_utc() {
        for (text, expected) in [
            ("1982-03-11T10:00:00-04:00", "1982-03-11T14:00:00Z"),
            ("1940-04-09T01:00:00+02:00", "1940-04-08T23:00:00Z"),
            ("2025-06-01T00:00:00Z", "2025-06-01T00:00:00Z"),
            ("2024-02-29", "2024-02-29T00:00:00Z"),
            ("2024-02-29 23:59", "2024-02-29T23:59:00Z"),
            ("2024-12-31T23:30:00.250-0100", "2025-01-01T00:30:00Z"),
            ("1969-12-31T23:59:59Z", "1969-12-31T23:59:59Z"),
            ("0000-03-01", "0000-03-01T00:00:00Z"),
            ("2000-01-01T24:00:00", "2000-01-02T00:00:00Z"),
        ] {
            assert_eq!(
                Moment::parse(text).map(|moment| moment.to_string()).as_deref(),
                Some(expected),
                "{text}"
            );
        }
        assert_eq!(Moment::from_milliseconds(386_532_000_000.0), Moment::parse("1982-04-01T18:00:00Z"));
    }

    #[test]
    fn what_is_no_moment_is_none() {
        for text in [
            "",
            "1982",
            "1982-02-29",
            "1982-13-01",
            "1982-00-10",
            "1982-03-11T25:00",
            "1982-03-11T10:61",
            "1982-03-11X10:00",
            "1982-03-11T10:00+99:00",
            "+982-03-11",
            "1982-03-11T10:00:00ZZ",
            "äöüäöüäöü",
        ] {
            assert_eq!(Moment::parse(text), None, "{text}");
        }
        assert_eq!(Moment::from_milliseconds(f64::NAN), None);
        assert_eq!(Moment::from_milliseconds(1e300), None);
    }

    #[test]
    fn each_day_of_four_centuries_is_read_as_it_is_written() {
        let mut day = Moment::parse("1799-12-28").expect("a day");
        for _ in 0..146_097 {
            assert_eq!(Moment::parse(&day.to_string()), Some(day));
            day = Moment(day.0 + DAY);
        }
        assert_eq!(day.to_string(), "2199-12-28T00:00:00Z");
    }
}
