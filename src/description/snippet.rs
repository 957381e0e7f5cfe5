//! One line of a text with a stretch of it underlined, fit for any terminal and any log.
//!
//! What is shown is not always what is in the file: tabs become spaces, so that the carets stand under
//! their characters; control and direction marks become `�`, so that a hostile file cannot steer the
//! terminal; long lines are cut on both sides of the stretch that matters. Carets count terminal cells,
//! of which an East Asian character takes two (Unicode Standard Annex 11, simplified to whole blocks).

use std::ops::Range;

/// The most cells of a line that are shown; narrow enough for a log beside a message.
const MAX_CELLS: usize = 100;
/// How many cells before the underlined stretch survive the cut.
const LEAD_CELLS: usize = 40;
/// How far a tab reaches.
const TAB_CELLS: usize = 4;

/// A line and what to write under it.
#[derive(Debug, PartialEq)]
pub(super) struct Snippet {
    /// The line, cut and made harmless.
    pub line: String,
    /// Spaces and carets.
    pub carets: String,
}

/// `line` with the bytes `mark` underlined; `mark` is clamped to the line and gets at least one caret.
pub(super) fn snippet(line: &str, mark: Range<usize>) -> Snippet {
    let cells_before_mark: usize = line
        .char_indices()
        .take_while(|(at, _)| *at < mark.start)
        .map(|(_, character)| cells(character))
        .sum();
    let skip = cells_before_mark.saturating_sub(LEAD_CELLS);
    let total: usize = line.chars().map(cells).sum();
    let cut = total > MAX_CELLS;
    let mut out = Snippet { line: String::new(), carets: String::new() };
    if cut && skip > 0 {
        out.push('…', 1, false);
    }
    let mut passed = 0;
    for (at, character) in line.char_indices() {
        let width = cells(character);
        passed += width;
        if cut && passed <= skip {
            continue;
        }
        if cut && passed > skip + MAX_CELLS {
            out.push('…', 1, false);
            break;
        }
        out.push(shown(character), width, at == mark.start || mark.contains(&at));
    }
    out.finish(mark.start >= line.len())
}

impl Snippet {
    fn push(&mut self, character: char, width: usize, marked: bool) {
        match character {
            '\t' => self.line.extend(std::iter::repeat_n(' ', width)),
            _ => self.line.push(character),
        }
        self.carets.extend(std::iter::repeat_n(if marked { '^' } else { ' ' }, width));
    }

    /// Trims the spaces after the last caret; an empty mark gets one caret where it stands.
    fn finish(mut self, at_end: bool) -> Self {
        if at_end || !self.carets.contains('^') {
            self.carets.push('^');
        }
        self.carets.truncate(self.carets.trim_end().len());
        self
    }
}

/// `text` without what could steer a terminal.
pub(super) fn harmless(text: &str) -> String {
    text.chars().map(|character| if character == '\t' { ' ' } else { shown(character) }).collect()
}

/// The character to print for `character`.
fn shown(character: char) -> char {
    match character {
        '\t' => '\t',
        '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}' => '\u{fffd}',
        _ if character.is_control() => '\u{fffd}',
        _ => character,
    }
}

/// How many terminal cells `character` takes.
fn cells(character: char) -> usize {
    match character {
        '\t' => TAB_CELLS,
        '\u{300}'..='\u{36f}' | '\u{200b}'..='\u{200d}' | '\u{fe00}'..='\u{fe0f}' | '\u{feff}' => 0,
        '\u{1100}'..='\u{115f}'
        | '\u{2e80}'..='\u{303e}'
        | '\u{3041}'..='\u{a4cf}'
        | '\u{ac00}'..='\u{d7a3}'
        | '\u{f900}'..='\u{faff}'
        | '\u{fe30}'..='\u{fe6f}'
        | '\u{ff00}'..='\u{ff60}'
        | '\u{ffe0}'..='\u{ffe6}'
        | '\u{1f300}'..='\u{1f64f}'
        | '\u{1f900}'..='\u{1f9ff}'
        | '\u{20000}'..='\u{3fffd}' => 2,
        _ => 1,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn under(line: &str, word: &str) -> Snippet {
        let start = line.find(word).expect("the word is in the line");
        snippet(line, start..start + word.len())
    }

    #[test]
    fn carets_stand_under_their_word() {
        assert_eq!(under("width = 3", "3").carets, "        ^");
        assert_eq!(under("\twidth = 3", "width").carets, "    ^^^^^");
        assert_eq!(under("名前 = 坏", "坏").carets, "       ^^");
    }

    #[test]
    fn an_empty_mark_gets_one_caret() {
        assert_eq!(snippet("a =", 3..3).carets, "   ^");
        assert_eq!(snippet("[terrain]", 0..0).carets, "^");
        assert_eq!(snippet("", 0..0).carets, "^");
        assert_eq!(snippet("a = 1", 9..12).carets, "     ^");
    }

    #[test]
    fn long_lines_are_cut_around_the_mark() {
        let line = format!("{}BAD{}", "x".repeat(500), "y".repeat(500));
        let cut = under(&line, "BAD");
        assert!(cut.line.chars().count() <= MAX_CELLS + 2, "{}", cut.line);
        let caret = cut.carets.find('^').expect("a caret");
        assert_eq!(cut.line.chars().skip(caret).take(3).collect::<String>(), "BAD");
    }

    #[test]
    fn control_characters_do_not_reach_the_terminal() {
        assert_eq!(snippet("a\u{1b}[31m\u{202e}", 0..1).line, "a\u{fffd}[31m\u{fffd}");
    }
}
