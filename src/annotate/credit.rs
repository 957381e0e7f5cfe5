//! The credit line: the source of the data, small along the lower border.

use glam::Vec2;

use crate::composer::Composer;
use crate::drawing::Drawing;
use crate::paragraph::written_lines;
use crate::sheet::INK;
use crate::text::TextStyle;

/// A credit cut shorter than this, in ems, names nobody and is left out.
const SHORTEST_EM: f32 = 10.0;

/// The line with its baseline starting at the origin, no wider than `most_px`; `None` where the text is empty or the
/// width too small.
pub fn compose(credit: &str, most_px: f32, composer: &mut Composer) -> Option<Drawing> {
    let text = written_lines(credit, usize::MAX).0.join(" · ");
    let style = composer.style(13.0, TextStyle::MEDIUM);
    let line = composer.fitted(&text, style, most_px)?;
    line.outline.as_ref()?;
    if line.shortened && line.advance < style.size_px * SHORTEST_EM {
        return None;
    }
    let mut drawing = Drawing::default();
    drawing.write_haloed(&line, Vec2::ZERO, composer.sheet.px(1.7).max(1.2), INK);
    drawing.record_text(credit, line.missing, line.shortened);
    Some(drawing)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(credit: &str, most_px: f32) -> Option<Drawing> {
        compose(credit, most_px, &mut Composer::new(1920, 1080))
    }

    #[test]
    fn a_credit_is_one_line_however_it_was_written() {
        let (one, two) = (line("USGS 3DEP", 900.0), line("USGS\n3DEP", 900.0));
        let height = |drawing: Option<Drawing>| drawing.expect("a line").bounds().size().y;
        assert!((height(one) - height(two)).abs() < 0.1);
    }

    #[test]
    fn a_credit_without_room_or_words_is_left_out_and_a_long_one_cut() {
        assert!(line("USGS 3DEP, National Map, public domain", 60.0).is_none());
        assert!(line(" ", 900.0).is_none());
        let cut = line("USGS 3DEP, National Map, public domain", 200.0).expect("a part fits");
        assert!(cut.texts[0].shortened);
    }
}
