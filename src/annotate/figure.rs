//! Coordinates as maps print them: plain, or with the digits that a grid reference is made of in larger type.
//!
//! ```text
//!  4 018 000 N         ⁴⁰18⁰⁰⁰ᵐN          ⁴⁰18
//!     plain         the first of a side  the others
//! ```

use glam::Vec2;

use crate::composer::Composer;
use crate::drawing::Drawing;
use crate::halo::Halo;
use crate::sheet::INK;
use crate::text::{TextStyle, TypesetLine};

/// The size of plain numbers, of principal digits, and of the digits around them, in design pixels.
const PLAIN: f32 = 14.0;
const PRINCIPAL: f32 = 19.0;
const AROUND: f32 = 11.5;

/// The gap between digits of different size, in ems of the larger.
const GAP_EM: f32 = 0.04;

/// A coordinate as it is printed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum CoordinateFigure {
    /// All in one size.
    Plain(String),
    /// A number of the military grid.
    Military {
        /// The digits before the principal ones, small and raised.
        before: String,
        /// The digits that grid references are made of.
        principal: String,
        /// What follows, small and raised; may be empty.
        after: String,
    },
}

impl From<String> for CoordinateFigure {
    fn from(text: String) -> Self {
        Self::Plain(text)
    }
}

/// A coordinate, typeset.
pub(crate) struct SetFigure {
    /// Lines with the starts of their baselines; the figure's lower left corner is the origin.
    parts: Vec<(TypesetLine, Vec2)>,
    /// Its width, and the height of its capitals.
    pub size: Vec2,
}

impl CoordinateFigure {
    pub(crate) fn set(&self, composer: &mut Composer) -> SetFigure {
        match self {
            Self::Plain(text) => {
                let line = composer.line(text, composer.style(PLAIN, TextStyle::REGULAR));
                let size = Vec2::new(line.advance, line.style.cap_px());
                SetFigure { parts: vec![(line, Vec2::ZERO)], size }
            }
            Self::Military { before, principal, after } => {
                let large = composer.style(PRINCIPAL, TextStyle::MEDIUM);
                let small = composer.style(AROUND, TextStyle::REGULAR);
                let raised = small.cap_px() - large.cap_px();
                let (mut parts, mut x) = (Vec::new(), 0.0);
                for (text, style, y) in
                    [(before, small, raised), (principal, large, 0.0), (after, small, raised)]
                {
                    if !text.is_empty() {
                        let line = composer.line(text, style);
                        let advance = line.advance;
                        parts.push((line, Vec2::new(x, y)));
                        x += advance + large.size_px * GAP_EM;
                    }
                }
                SetFigure { parts, size: Vec2::new((x - large.size_px * GAP_EM).max(0.0), large.cap_px()) }
            }
        }
    }
}

impl SetFigure {
    /// Writes it with its lower left corner at `at`, on a halo.
    pub fn write_haloed(&self, at: Vec2, halo: f32, drawing: &mut Drawing) {
        let lines: Vec<(&TypesetLine, Vec2)> =
            self.parts.iter().map(|(line, start)| (line, at + *start)).collect();
        drawing.draw_halo(&lines, Halo::paper(halo));
        lines.into_iter().for_each(|(line, at)| drawing.write(line, at, INK));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn principal_digits_are_larger_than_those_around_them() {
        let mut composer = Composer::new(1920, 1080);
        let figure = CoordinateFigure::Military {
            before: "40".into(),
            principal: "18".into(),
            after: "000 m N".into(),
        };
        let set = figure.set(&mut composer);
        let height = |part: usize| set.parts[part].0.style.cap_px();
        assert!(height(1) > 1.5 * height(0) && height(0) == height(2));
        let bare =
            CoordinateFigure::Military { before: "40".into(), principal: "18".into(), after: String::new() };
        assert!(bare.set(&mut composer).size.x < set.size.x);
    }
}
