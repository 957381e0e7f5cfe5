//! Colors and color ramps as a scene file writes them.

use crate::words::RampName;

/// A color as written: sRGB red, green, blue and straight alpha.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Color(pub [u8; 4]);

impl Color {
    /// The color that `#rgb`, `#rrggbb` or `#rrggbbaa` names; without alpha it is opaque.
    pub fn parse(text: &str) -> Option<Self> {
        let digits = text.strip_prefix('#')?.chars().map(|digit| digit.to_digit(16));
        let digits: Vec<u8> =
            digits.take(9).map(|digit| digit.map(|digit| digit as u8)).collect::<Option<_>>()?;
        match digits[..] {
            [r, g, b] => Some(Self([r * 17, g * 17, b * 17, 255])),
            [_, _, _, _, _, _] | [_, _, _, _, _, _, _, _] => {
                let mut channels = [255; 4];
                for (channel, pair) in channels.iter_mut().zip(digits.chunks(2)) {
                    *channel = pair[0] * 16 + pair[1];
                }
                Some(Self(channels))
            }
            _ => None,
        }
    }
}

/// A color ramp by its name or by its stops.
#[derive(Clone, Debug, PartialEq)]
pub enum RampChoice {
    /// A built-in ramp.
    Named(RampName),
    /// At least two heights in meters, rising, and their colors.
    Stops(Vec<(f64, Color)>),
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colors_have_three_six_or_eight_digits() {
        assert_eq!(Color::parse("#fa0"), Some(Color([255, 170, 0, 255])));
        assert_eq!(Color::parse("#102030"), Some(Color([16, 32, 48, 255])));
        assert_eq!(Color::parse("#10203040"), Some(Color([16, 32, 48, 64])));
        for bad in ["", "#", "102030", "#1020", "#12345", "#ggg", "#1020304050", "#１２３"] {
            assert_eq!(Color::parse(bad), None, "{bad}");
        }
    }
}
