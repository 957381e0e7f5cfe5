//! Patterns in place of colors for print in black on white, coarse enough to survive a photocopier.
//!
//! A pattern is a function of the pixel, so that areas side by side make one pattern; its unit grows with the picture.

/// A pattern of black marks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum PrintPattern {
    /// Level lines: water.
    Lines,
    /// Staggered dots: wood.
    Dots,
    /// Small crosses in rows: orchards.
    Crosses,
    /// Staggered dashes: marsh.
    Dashes,
    /// Upright lines: fields.
    Furrows,
    /// Fine scattered dots: scrub, sand.
    Stipple,
    /// Lines that rise to the right: built-up ground.
    Hatching,
    /// Lines in both directions: industry, closed ground.
    CrossHatching,
}

/// Pixels of a pattern's unit on a picture 1080 pixels high: a mark is one unit wide, which two generations of copies keep.
const UNIT_PX: f32 = 1.5;

impl PrintPattern {
    /// The unit of patterns on a picture of this height, in whole pixels.
    pub fn unit_px(height: u32) -> u32 {
        (height as f32 / 1080.0 * UNIT_PX).round().max(1.0) as u32
    }

    /// Whether the pixel at a column and a row is black, with marks of `unit` pixels, at least 1.
    pub fn is_black(self, column: u32, row: u32, unit: u32) -> bool {
        let (x, y) = (column / unit.max(1), row / unit.max(1));
        match self {
            Self::Lines => y.is_multiple_of(4),
            Self::Dots => {
                let (x, y) = ((x + y / 5 % 2 * 4) % 8, y % 5);
                (x < 2 && y < 2) || (x == 2 && y == 0)
            }
            Self::Crosses => {
                let (x, y) = (x % 9, y % 9);
                (x == 4 && (2..=6).contains(&y)) || (y == 4 && (2..=6).contains(&x))
            }
            Self::Dashes => y.is_multiple_of(5) && (x + y / 5 % 2 * 6) % 12 < 6,
            Self::Furrows => x.is_multiple_of(5),
            Self::Stipple => y.is_multiple_of(4) && (x + y / 4 % 3 * 3) % 9 == 0,
            Self::Hatching => (x + y).is_multiple_of(6),
            Self::CrossHatching => (x + y).is_multiple_of(7) || (x + 7 - y % 7).is_multiple_of(7),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: [PrintPattern; 8] = [
        PrintPattern::Lines,
        PrintPattern::Dots,
        PrintPattern::Crosses,
        PrintPattern::Dashes,
        PrintPattern::Furrows,
        PrintPattern::Stipple,
        PrintPattern::Hatching,
        PrintPattern::CrossHatching,
    ];

    #[test]
    fn patterns_leave_most_of_the_paper_white_and_differ_from_one_another() {
        let marks = |pattern: PrintPattern| -> Vec<bool> {
            (0..2520u32).map(|at| pattern.is_black(at % 60, at / 60, 1)).collect()
        };
        for (index, &pattern) in ALL.iter().enumerate() {
            let black = marks(pattern).iter().filter(|black| **black).count() as f32 / 2520.0;
            assert!((0.02..0.35).contains(&black), "{pattern:?}: {black}");
            assert!(ALL[..index].iter().all(|&other| marks(other) != marks(pattern)), "{pattern:?}");
        }
    }

    #[test]
    fn marks_grow_with_the_picture() {
        assert_eq!([270, 1080, 2160, 8000].map(PrintPattern::unit_px), [1, 2, 3, 11]);
        let wide = |x: u32| PrintPattern::Furrows.is_black(x, 0, 3);
        assert_eq!([0, 1, 2, 3, 14, 15].map(wide), [true, true, true, false, false, true]);
    }
}
