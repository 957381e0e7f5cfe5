//! Fits text: removes characters that cannot be printed, cuts lines with an ellipsis, breaks lines between words.

use crate::composer::Composer;
use crate::text::{TextStyle, TypesetLine};

#[derive(Clone, Debug)]
pub struct Paragraph {
    /// The lines, first on top.
    pub lines: Vec<TypesetLine>,
    pub shortened: bool,
}

impl Paragraph {
    pub fn missing(&self) -> usize {
        self.lines.iter().map(|line| line.missing).sum()
    }
}

/// The lines of a text as written: split at line ends, without control characters, spaces single, none empty. At most
/// `most` lines are returned; the second value is true if any were dropped.
pub fn written_lines(text: &str, most: usize) -> (Vec<String>, bool) {
    let is_end = |c: char| matches!(c, '\n' | '\r' | '\u{85}' | '\u{2028}' | '\u{2029}' | '\u{b}' | '\u{c}');
    let mut lines = text.split(is_end).map(single_spaced).filter(|line| !line.is_empty());
    let kept: Vec<_> = lines.by_ref().take(most).collect();
    (kept, lines.next().is_some())
}

/// `text` without control characters, every run of white space a single space.
fn single_spaced(text: &str) -> String {
    let clean: String = text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    clean.split_whitespace().collect::<Vec<_>>().join(" ")
}

impl Composer {
    /// `text` as one line no wider than `most_px`, ending in an ellipsis where it is cut. `None` where not even a few
    /// letters before the ellipsis fit.
    pub fn fitted(&mut self, text: &str, style: TextStyle, most_px: f32) -> Option<TypesetLine> {
        let full = self.line(text, style);
        if full.advance <= most_px && !full.shortened {
            return Some(full);
        }
        let ends: Vec<usize> = text.char_indices().map(|(at, _)| at).take(400).collect();
        let mut cut = |keep: usize| {
            let kept = text[..ends.get(keep).copied().unwrap_or(text.len())].trim_end();
            let line = self.line(&format!("{kept}…"), style);
            (line.advance <= most_px).then_some(TypesetLine { shortened: true, ..line })
        };
        /// Fewer letters than this before an ellipsis are unreadable.
        const FEWEST: usize = 4;
        // The width grows with the letters kept (but for kerning): bisection finds the longest that fits.
        let (mut fits, mut too_long) = (FEWEST, ends.len());
        let mut best = cut(FEWEST)?;
        while too_long - fits > 1 {
            let middle = fits + (too_long - fits) / 2;
            match cut(middle) {
                Some(line) => (fits, best) = (middle, line),
                None => too_long = middle,
            }
        }
        Some(best)
    }

    /// `text` broken between words into at most `most_lines` lines of at most `most_px`. Written line ends are kept;
    /// text that does not fit is cut with an ellipsis. Empty where nothing fits.
    pub fn broken(&mut self, text: &str, style: TextStyle, most_px: f32, most_lines: usize) -> Paragraph {
        let (written, mut shortened) = written_lines(text, most_lines);
        let mut lines = Vec::new();
        for paragraph in &written {
            let mut rest = paragraph.as_str();
            while !rest.is_empty() && lines.len() < most_lines {
                let is_last = lines.len() + 1 == most_lines;
                let head = if is_last { rest } else { self.head_that_fits(rest, style, most_px) };
                lines.extend(self.fitted(head, style, most_px));
                rest = rest[head.len()..].trim_start();
                if lines.is_empty() {
                    break;
                }
            }
            shortened |= !rest.is_empty();
        }
        shortened |= lines.iter().any(|line| line.shortened);
        Paragraph { lines, shortened }
    }

    /// As many words from the start of `text` as fit; the first word alone where it does not.
    fn head_that_fits<'t>(&mut self, text: &'t str, style: TextStyle, most_px: f32) -> &'t str {
        let gaps = text.match_indices(' ').map(|(at, _)| at).chain([text.len()]).take(100);
        let mut head = text.split(' ').next().unwrap_or(text);
        for end in gaps {
            if self.line(&text[..end], style).advance > most_px {
                break;
            }
            head = &text[..end];
        }
        head
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::composer::widest;

    const FACE: TextStyle = TextStyle::new(20.0, TextStyle::REGULAR);

    #[test]
    fn written_lines_are_clean_and_never_empty() {
        let text = "  Cross\tMountain \r\n\n1062\u{0} m\u{2028}";
        assert_eq!(written_lines(text, 9), (vec!["Cross Mountain".to_owned(), "1062 m".to_owned()], false));
        assert_eq!(written_lines("a\nb\nc", 2), (vec!["a".to_owned(), "b".to_owned()], true));
        assert_eq!(written_lines("\n \t\n", 9), (vec![], false));
    }

    #[test]
    fn a_line_that_fits_is_left_alone_and_a_long_one_gets_an_ellipsis() {
        let mut setter = Composer::new(100, 100);
        let whole = setter.fitted("Norris", FACE, 500.0).expect("fits");
        assert!(!whole.shortened);
        let cut = setter.fitted("Norris Geyser Basin", FACE, 100.0).expect("fits when cut");
        assert!(cut.shortened && cut.advance <= 100.0 && cut.advance > 75.0, "{}", cut.advance);
        assert!(setter.fitted("Norris", FACE, 30.0).is_none(), "N… is no name");
    }

    #[test]
    fn cutting_never_parts_a_character() {
        let mut setter = Composer::new(100, 100);
        for width in 0..200 {
            setter.fitted("Źółć 富士山 👩‍👩‍👧 éé", FACE, width as f32);
        }
    }

    #[test]
    fn long_text_is_broken_between_words_and_the_last_line_cut() {
        let mut setter = Composer::new(100, 100);
        let text = "The quick brown fox jumps over the lazy dog and runs away into the hills";
        let two = setter.broken(text, FACE, 200.0, 2);
        assert_eq!(two.lines.len(), 2);
        assert!(two.shortened && widest(&two.lines) <= 200.0);
        let many = setter.broken(text, FACE, 200.0, 9);
        assert!(!many.shortened && many.lines.len() >= 4 && widest(&many.lines) <= 200.0);
    }

    #[test]
    fn where_nothing_fits_there_are_no_lines() {
        assert!(Composer::new(100, 100).broken("Norris Geyser", FACE, 2.0, 3).lines.is_empty());
        assert!(Composer::new(100, 100).broken("", FACE, 200.0, 3).lines.is_empty());
    }

    #[test]
    fn the_authors_line_ends_are_kept() {
        let lines = Composer::new(100, 100).broken("one\ntwo", FACE, 400.0, 3).lines;
        assert_eq!(lines.len(), 2);
    }
}
