//! Decoding of encoded polylines: many locations in few characters.
//!
//! After Google's *Encoded Polyline Algorithm Format*: each location is the step from the one before, latitude first,
//! in hundred-thousandths of a degree; a step is a zigzag number, five bits a character from the lowest on, each
//! character 63 more than its bits and 32 more again where another follows:
//!
//! ```text
//! _p~iF ~ps|U   _ulL nnqC          (38.5, −120.2), (40.7, −120.95)
//! └lat┘ └lng┘   └Δlat┘└Δlng┘
//! ```

use glam::DVec2;

use crate::reply::{HttpError, quoted};

const PER_DEGREE: f64 = 1e5;

/// The most characters of a step: 35 bits. The longest step on Earth, 360°, needs 27.
const LONGEST_STEP: u32 = 7;

/// The locations of an encoded polyline: longitude (x) and latitude (y) in degrees, which may be out of range.
pub fn decode(text: &str, most: usize) -> Result<Vec<DVec2>, HttpError> {
    let mut steps = DeltaReader { bytes: text.as_bytes(), at: 0 };
    // A location takes two characters or more.
    let mut locations = Vec::with_capacity((text.len() / 2).min(most));
    let (mut lat, mut lng) = (0i64, 0i64);
    while steps.at < steps.bytes.len() {
        if locations.len() == most {
            return Err(HttpError::wrong(format!(
                "the encoded polyline holds more than {most} locations, the most of one request"
            )));
        }
        let step = steps.next().zip(steps.next());
        let (north, east) = step.ok_or_else(|| refusal(text, steps.at))?;
        // The sum of ten thousand steps of 35 bits fits in 64 bits.
        (lat, lng) = (lat + north, lng + east);
        locations.push(DVec2::new(lng as f64 / PER_DEGREE, lat as f64 / PER_DEGREE));
    }
    Ok(locations)
}

fn refusal(text: &str, at: usize) -> HttpError {
    HttpError::wrong(format!(
        "locations {} has no comma, so it was read as an encoded polyline, which it is not, from character {} on; \
         write locations as lat,lng|lat,lng or as an encoded polyline",
        quoted(text),
        at + 1
    ))
}

/// Reads one step after another.
struct DeltaReader<'a> {
    bytes: &'a [u8],
    /// The next byte, or the wrong one.
    at: usize,
}

impl DeltaReader<'_> {
    /// The next step, or `None` where the text is wrong or at its end.
    fn next(&mut self) -> Option<i64> {
        let mut bits = 0i64;
        for place in 0..LONGEST_STEP {
            let digit = self.bytes.get(self.at)?.checked_sub(63).filter(|&digit| digit < 64)?;
            self.at += 1;
            bits |= i64::from(digit & 31) << (5 * place);
            if digit < 32 {
                return Some(if bits & 1 == 1 { !(bits >> 1) } else { bits >> 1 });
            }
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn encode(places: &[(i64, i64)]) -> String {
        let mut out = String::new();
        let mut last = (0, 0);
        for &(lat, lng) in places {
            for step in [lat - last.0, lng - last.1] {
                let mut bits = if step < 0 { !(step << 1) } else { step << 1 };
                while bits >= 32 {
                    out.push(char::from((bits & 31 | 32) as u8 + 63));
                    bits >>= 5;
                }
                out.push(char::from(bits as u8 + 63));
            }
            last = (lat, lng);
        }
        out
    }

    #[test]
    fn the_example_of_the_format_is_read() {
        let places = decode("_p~iF~ps|U_ulLnnqC_mqNvxq`@", 10).expect("sound");
        let expected = [(-120.2, 38.5), (-120.95, 40.7), (-126.453, 43.252)];
        assert_eq!(places, expected.map(|(x, y)| DVec2::new(x, y)));
        assert_eq!(decode("", 10), Ok(Vec::new()));
    }

    #[test]
    fn what_is_cut_short_foreign_or_too_long_is_refused() {
        for wrong in ["_p~iF", "_p~i", "~~~~~~~~~~~~", "_p~iF ~ps|U", "é", "\u{7f}\u{7f}", "12"] {
            assert!(decode(wrong, 10).is_err_and(|refusal| refusal.status() == 400), "{wrong}");
        }
        assert!(decode("????", 2).is_ok() && decode("??????", 2).is_err());
        let long = "?".repeat(1_000_000);
        assert!(decode(&long, 10_000).is_err());
    }

    proptest! {
        #[test]
        fn what_is_encoded_comes_back(
            places in proptest::collection::vec((-9_000_000i64..=9_000_000, -18_000_000i64..=18_000_000), 0..50)
        ) {
            let decoded = decode(&encode(&places), 50).expect("sound");
            let expected: Vec<DVec2> =
                places.iter().map(|&(lat, lng)| DVec2::new(lng as f64 / 1e5, lat as f64 / 1e5)).collect();
            prop_assert_eq!(decoded, expected);
        }

        #[test]
        fn no_text_breaks_the_reader(text in ".{0,80}") {
            if let Ok(places) = decode(&text, 20) {
                prop_assert!(places.len() <= 20);
            }
        }
    }
}
