//! Letters of icons as lines: a monoline alphabet of capitals, digits and a few signs.
//!
//! The letters of an icon are part of its drawing, not a text beside it: they are cut by no collision with other texts, and
//! whoever takes the lines of a graphic has them too. A letter is a list of strokes on a grid six wide and nine high, each
//! place as two digits, x and y.

use glam::DVec2;

/// Height of a capital on the grid.
const HIGH: f64 = 9.0;

/// From a letter's right edge to the next one's left on the grid.
const GAP: f64 = 2.2;

/// The height of a capital as a share of the size of the em, as of the typeface of labels.
pub const CAPITAL: f64 = 0.72;

/// Width on the grid and strokes of a sign; of an unknown one a box.
fn strokes_of(sign: char) -> (f64, &'static str) {
    const WIDE: f64 = 6.0;
    match sign {
        'A' => (WIDE, "00 39 60|13 53"),
        'B' => (WIDE, "05 45 64 61 40 00 09 49 58 56 45"),
        'C' => (WIDE, "62 40 20 02 07 29 49 67"),
        'D' => (WIDE, "00 09 39 66 63 30 00"),
        'E' => (WIDE, "60 00 09 69|05 45"),
        'F' => (WIDE, "00 09 69|05 45"),
        'G' => (WIDE, "67 49 29 07 02 20 40 62 64 44"),
        'H' => (WIDE, "00 09|60 69|05 65"),
        'I' => (0.0, "00 09"),
        'J' => (5.0, "02 20 30 52 59"),
        'K' => (WIDE, "00 09|69 04|26 60"),
        'L' => (WIDE, "09 00 60"),
        'M' => (WIDE, "00 09 34 69 60"),
        'N' => (WIDE, "00 09 60 69"),
        'O' | '0' => (WIDE, "20 40 62 67 49 29 07 02 20"),
        'P' => (WIDE, "00 09 49 67 66 44 04"),
        'Q' => (WIDE, "20 40 62 67 49 29 07 02 20|42 60"),
        'R' => (WIDE, "00 09 49 67 66 44 04|34 60"),
        'S' => (WIDE, "67 49 29 07 06 25 45 63 62 40 20 02"),
        'T' => (WIDE, "09 69|30 39"),
        'U' => (WIDE, "09 02 20 40 62 69"),
        'V' => (WIDE, "09 30 69"),
        'W' => (8.0, "09 20 46 60 89"),
        'X' => (WIDE, "00 69|09 60"),
        'Y' => (WIDE, "09 34 69|34 30"),
        'Z' => (WIDE, "09 69 00 60"),
        '1' => (3.0, "07 29 20"),
        '2' => (WIDE, "07 29 49 67 66 00 60"),
        '3' => (WIDE, "08 19 49 67 66 45 25|45 64 62 40 10 01"),
        '4' => (WIDE, "40 49 03 63"),
        '5' => (WIDE, "69 09 05 45 63 62 40 10 01"),
        '6' => (WIDE, "68 49 29 07 02 20 40 62 63 45 25 03"),
        '7' => (WIDE, "09 69 20"),
        '8' => (WIDE, "25 06 07 29 49 67 66 45 25 03 02 20 40 62 63 45"),
        '9' => (WIDE, "01 20 40 62 67 49 29 07 06 24 44 66"),
        '/' => (WIDE, "00 69"),
        '(' => (2.0, "29 07 02 20"),
        ')' => (2.0, "09 27 22 00"),
        '-' => (4.0, "05 45"),
        ' ' => (3.0, ""),
        _ => (WIDE, "00 09 69 60 00"),
    }
}

/// The lines of a text about the middle of its capitals, X right and Y up, in the units of `size`, the em.
pub fn letter_lines(text: &str, size: f64) -> Vec<Vec<DVec2>> {
    let unit = size * CAPITAL / HIGH;
    let signs: Vec<(f64, &str)> = text.chars().map(strokes_of).collect();
    let width: f64 = signs.iter().map(|(width, _)| width + GAP).sum::<f64>() - GAP;
    let (mut lines, mut left) = (Vec::new(), -width / 2.0);
    for (width, strokes) in signs {
        let place = |digits: &str| {
            let mut numbers = digits.bytes().map(|digit| f64::from(digit.saturating_sub(b'0')));
            let [x, y] = [numbers.next().unwrap_or(0.0), numbers.next().unwrap_or(0.0)];
            DVec2::new(left + x, y - HIGH / 2.0) * unit
        };
        let strokes = strokes.split('|').map(|stroke| stroke.split_whitespace().map(place).collect());
        lines.extend(strokes.filter(|line: &Vec<DVec2>| line.len() > 1));
        left += width + GAP;
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_is_centered_and_as_high_as_capitals() {
        let lines = letter_lines("SBY", 35.0);
        let [mut least, mut most] = [DVec2::INFINITY, DVec2::NEG_INFINITY];
        for &at in lines.iter().flatten() {
            (least, most) = (least.min(at), most.max(at));
        }
        assert!((least + most).length() < 1e-9, "{least} {most}");
        assert!((most.y - least.y - 35.0 * CAPITAL).abs() < 1e-9);
        assert!(most.x - least.x < 70.0, "three letters fit a box of 80");
    }

    #[test]
    fn every_sign_of_the_alphabet_stays_on_its_grid() {
        for sign in ('A'..='Z').chain('0'..='9').chain("/()- ".chars()) {
            let (width, strokes) = strokes_of(sign);
            for place in strokes.split(['|', ' ']).filter(|place| !place.is_empty()) {
                let [x, y] = [&place[..1], &place[1..]].map(|digit| digit.parse::<f64>().expect("a digit"));
                assert!(x <= width.max(0.0) && y <= HIGH, "{sign}: {place}");
            }
        }
    }
}
