//! Encodings of heights in the colors of a PNG, as map tiles use them.
//!
//! | encoding | meters | specification |
//! |---|---|---|
//! | terrain-RGB | −10000 + (65536 R + 256 G + B) / 10 | Mapbox, *Terrain-RGB v1*; MapTiler uses it too |
//! | Terrarium | 256 R + G + B / 256 − 32768 | Mapzen, *Terrain Tiles: Terrarium* |
//!
//! The file does not state its encoding: the same colors are heights in either, a few hundred meters or many thousand
//! apart. So the caller must state it.

use std::fmt;
use std::str::FromStr;

/// An encoding of heights in colors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HeightEncoding {
    /// Mapbox's, in tenths of a meter from −10000 m.
    TerrainRgb,
    /// Mapzen's, in 256ths of a meter from −32768 m.
    Terrarium,
}

impl HeightEncoding {
    /// The names that [`FromStr`] reads.
    pub const NAMES: [&str; 2] = ["terrain-rgb", "terrarium"];

    /// The height of a color in meters; exact but for the division by ten.
    pub fn meters(self, [red, green, blue]: [u8; 3]) -> f64 {
        let number = f64::from(u32::from_be_bytes([0, red, green, blue]));
        match self {
            Self::TerrainRgb => number / 10.0 - 10_000.0,
            Self::Terrarium => number / 256.0 - 32_768.0,
        }
    }

    /// The color whose height is nearest to one in meters: within 0.05 m for terrain-RGB and 1/512 m for Terrarium. The lowest
    /// or the highest where the encoding does not reach so far, and the lowest for NaN.
    pub fn color(self, meters: f64) -> [u8; 3] {
        let number = match self {
            Self::TerrainRgb => (meters + 10_000.0) * 10.0,
            Self::Terrarium => (meters + 32_768.0) * 256.0,
        };
        // Numbers beyond the range of a color, and NaN, become its ends.
        let number = (libm::round(number) as u32).min(0xff_ffff);
        let [_, red, green, blue] = number.to_be_bytes();
        [red, green, blue]
    }
}

/// A text names no encoding.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the encodings are {}", HeightEncoding::NAMES.join(" and "))]
pub struct HeightEncodingError;

impl FromStr for HeightEncoding {
    type Err = HeightEncodingError;

    fn from_str(text: &str) -> Result<Self, HeightEncodingError> {
        match text {
            "terrain-rgb" => Ok(Self::TerrainRgb),
            "terrarium" => Ok(Self::Terrarium),
            _ => Err(HeightEncodingError),
        }
    }
}

impl fmt::Display for HeightEncoding {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(match self {
            Self::TerrainRgb => Self::NAMES[0],
            Self::Terrarium => Self::NAMES[1],
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_makers_own_examples_come_out() {
        assert_eq!(HeightEncoding::TerrainRgb.meters([0, 0, 0]), -10_000.0);
        assert_eq!(HeightEncoding::TerrainRgb.meters([1, 134, 160]), 0.0);
        assert_eq!(HeightEncoding::Terrarium.meters([128, 0, 0]), 0.0);
        assert_eq!(HeightEncoding::Terrarium.meters([128, 1, 128]), 1.5);
    }

    #[test]
    fn heights_become_the_nearest_color_within_the_range() {
        assert_eq!(HeightEncoding::TerrainRgb.color(0.0), [1, 134, 160]);
        assert_eq!(HeightEncoding::Terrarium.color(1.5), [128, 1, 128]);
        // Everest and the Challenger Deep.
        assert_eq!(HeightEncoding::TerrainRgb.color(8848.86), [2, 224, 73]);
        assert_eq!(HeightEncoding::TerrainRgb.color(-10_935.0), [0, 0, 0]);
        for (encoding, half_step) in
            [(HeightEncoding::TerrainRgb, 0.05), (HeightEncoding::Terrarium, 1.0 / 512.0)]
        {
            for step in -20_000..20_000 {
                let height = f64::from(step) * 0.4321;
                let back = encoding.meters(encoding.color(height));
                assert!((back - height).abs() <= half_step + 1e-9, "{encoding}: {height} as {back}");
            }
            for [lowest, highest] in [[f64::NEG_INFINITY, f64::INFINITY], [f64::NAN, 1e9]] {
                assert_eq!(encoding.color(lowest), [0; 3]);
                assert_eq!(encoding.color(highest), [255; 3]);
            }
        }
    }

    #[test]
    fn names_are_read_as_they_are_written() {
        for name in HeightEncoding::NAMES {
            assert_eq!(name.parse::<HeightEncoding>().expect("known").to_string(), name);
        }
        assert!("rgb".parse::<HeightEncoding>().expect_err("unknown").to_string().contains("terrarium"));
    }
}
