//! A label at a place: its text, the positions that it may take, and how it is drawn.

use glam::Vec2;

use crate::annotation::PictureLabel;
use crate::composer::Composer;
use crate::drawing::Drawing;
use crate::halo::Halo;
use crate::label_style::LabelStyle;
use crate::paragraph::{Paragraph, written_lines};
use crate::pixel_box::{PixelBox, PixelSegment};
use crate::place::{LabelCandidate, LabelRequest, TextAlignment};
use crate::positions::LabelMetrics;
use crate::report::LabelOutcome;
use crate::sheet::Sheet;
use crate::text::{TextStyle, TypesetLine};
use sandtable_description::words::LabelKind;
use sandtable_draw::pixels::Pixels;

/// Lines of a label that are drawn; more would hide what they name.
const MOST_LINES: usize = 4;
/// The greatest width of a label's line, as a share of the picture's.
const WIDEST_SHARE: f32 = 0.33;
/// The longest leader line, as a share of the picture's height.
const LONGEST_LEADER_SHARE: f32 = 0.26;
/// From baseline to baseline, in ems of the lower line.
const LEADING: f32 = 1.16;

/// A label with its text set.
pub struct PreparedLabel<'a> {
    pub label: &'a PictureLabel,
    style: LabelStyle,
    pub block: Paragraph,
    metrics: LabelMetrics,
    pub positions: Vec<LabelCandidate>,
}

impl<'a> PreparedLabel<'a> {
    pub fn new(label: &'a PictureLabel, composer: &mut Composer) -> Result<Self, LabelOutcome> {
        let style = LabelStyle::new(label, composer);
        let block = set_lines(&label.text, &style, composer);
        if block.lines.is_empty() {
            return Err(if block.shortened { LabelOutcome::CrowdedOut } else { LabelOutcome::Empty });
        }
        // Space around the text, so that no two labels read as one.
        let space = composer.sheet.px(2.0);
        let texts = [TextAlignment::Left, TextAlignment::Center, TextAlignment::Right]
            .map(|alignment| block_box(&block.lines, alignment, style.halo).grown(space));
        if texts.iter().any(|text| text.size().cmple(Vec2::ZERO).any() || !text.size().is_finite()) {
            return Err(LabelOutcome::Empty);
        }
        let metrics = metrics(label, texts, &style, &composer.sheet);
        Ok(Self { label, style, block, metrics, positions: metrics.positions() })
    }

    /// The name of a line or an area that found no place along it: without the symbol of a point, and never led to one.
    pub fn without_symbol(mut self) -> Self {
        self.positions.retain(|position| position.leader.is_none());
        self.positions.iter_mut().for_each(|position| position.symbol = None);
        self
    }

    pub fn request(&self) -> LabelRequest {
        let has_symbol = self.positions.iter().any(|position| position.symbol.is_some());
        LabelRequest {
            candidates: self.positions.clone(),
            reserved: has_symbol.then(|| self.metrics.symbol_box()),
        }
    }

    pub fn draw_symbol(
        &self,
        candidate: &LabelCandidate,
        ground: &Pixels,
        sheet: &Sheet,
        drawing: &mut Drawing,
    ) {
        let halo = self.halo(candidate, ground);
        if let Some(line) = candidate.leader {
            let (line, width) = (uprighted(line), sheet.px(1.2).max(1.0));
            drawing.line(line, width + sheet.px(2.4).max(2.0), halo.color);
            drawing.line(line, width, self.style.ink);
        }
        if candidate.symbol.is_some() {
            self.style.draw_symbol(self.label, pixel_center(self.label.anchor_px), halo, sheet, drawing);
        }
    }

    /// The halo of everything drawn of it, notes in their fainter ink among it.
    fn halo(&self, candidate: &LabelCandidate, ground: &Pixels) -> Halo {
        let notes = self.block.lines.len() > 1;
        let faintest = if notes { self.style.note_ink } else { self.style.ink };
        Halo::over(ground, &candidate.text, faintest, self.style.halo)
    }

    /// Writes the text: all halos first, for the name's must not cover the height below it.
    pub fn draw_text(&self, position: &LabelCandidate, ground: &Pixels, drawing: &mut Drawing) {
        let text = self.metrics.texts[position.alignment as usize];
        let by = (position.text.min - text.min).round();
        let mut lines = baselines(&self.block.lines, position.alignment);
        lines.iter_mut().for_each(|(_, at)| *at += by);
        drawing.draw_halo(&lines, self.halo(position, ground));
        let inks = std::iter::once(self.style.ink).chain(std::iter::repeat(self.style.note_ink));
        lines.iter().zip(inks).for_each(|((line, at), ink)| drawing.write(line, *at, ink));
    }
}

fn metrics(label: &PictureLabel, texts: [PixelBox; 3], style: &LabelStyle, sheet: &Sheet) -> LabelMetrics {
    let longest = sheet.size.y * LONGEST_LEADER_SHARE;
    LabelMetrics {
        anchor: pixel_center(label.anchor_px),
        reach: reach(label, style.leader, longest),
        texts,
        symbol: Vec2::splat(style.symbol + style.halo),
        gap: sheet.px(1.0),
        longest,
        leads_first: label.top_px.is_some(),
        may_lie_on_place: label.kind == LabelKind::Water,
    }
}

/// The center of the pixel that holds `point`: makes symbols and upright lines crisp.
fn pixel_center(point: Vec2) -> Vec2 {
    point.floor() + 0.5
}

/// From the anchor to the preferred end of the leader: as given, but upward and of a sensible length.
fn reach(label: &PictureLabel, usual: f32, longest: f32) -> Vec2 {
    let given = label.top_px.map(|top| top - label.anchor_px).filter(|reach| reach.is_finite());
    match given {
        // Leaning more than 45° it would not read as a line upward.
        Some(reach) if reach.y < 0.0 && reach.x.abs() <= -reach.y => reach.clamp_length(usual, longest),
        _ => Vec2::new(0.0, -usual),
    }
}

fn set_lines(text: &str, style: &LabelStyle, composer: &mut Composer) -> Paragraph {
    let (written, dropped) = written_lines(text, MOST_LINES);
    let widest = composer.sheet.size.x * WIDEST_SHARE;
    let styles = std::iter::once(style.name).chain(std::iter::repeat(style.note));
    let set = |(text, style): (&String, TextStyle)| composer.fitted(text, style, widest);
    let lines: Vec<TypesetLine> = written.iter().zip(styles).filter_map(set).collect();
    let shortened = dropped || lines.len() < written.len() || lines.iter().any(|line| line.shortened);
    Paragraph { lines, shortened }
}

/// The lines with the starts of their baselines: the first at y = 0, all aligned to x = 0.
fn baselines(lines: &[TypesetLine], alignment: TextAlignment) -> Vec<(&TypesetLine, Vec2)> {
    let share = match alignment {
        TextAlignment::Left => 0.0,
        TextAlignment::Center => 0.5,
        TextAlignment::Right => 1.0,
    };
    let mut y = 0.0;
    let place = |(number, line): (usize, &'_ TypesetLine)| {
        if number > 0 {
            y += (line.style.size_px * LEADING).round();
        }
        Vec2::new((-line.advance * share).round(), y)
    };
    let starts: Vec<Vec2> = lines.iter().enumerate().map(place).collect();
    lines.iter().zip(starts).collect()
}

fn block_box(lines: &[TypesetLine], alignment: TextAlignment, halo: f32) -> PixelBox {
    let boxes = baselines(lines, alignment).into_iter().map(|(line, at)| line.bounds(halo).moved(at));
    boxes.fold(PixelBox::EMPTY, PixelBox::union)
}

/// An almost upright line, made upright; other lines as they are.
fn uprighted(line: PixelSegment) -> PixelSegment {
    if (line.to.x - line.from.x).abs() > 0.6 {
        return line;
    }
    PixelSegment { from: line.from, to: Vec2::new(line.from.x, line.to.y) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::annotation::samples::label;
    use crate::halo::worst_contrast;
    use sandtable_draw::color::Srgba;

    #[test]
    fn notes_stand_out_of_the_halo_too_on_every_ground() {
        let mut composer = Composer::new(1920, 1080);
        let noted = PictureLabel { kind: LabelKind::Summit, ..label("Peak\n1234 m", 400.0, 500.0) };
        let prepared = PreparedLabel::new(&noted, &mut composer).expect("letters");
        for light in (0..=255).step_by(15) {
            let ground = Pixels::filled(1920, 1080, Srgba::opaque(light, light, light));
            let halo = prepared.halo(&prepared.positions[0], &ground).color;
            let contrast = worst_contrast(halo, prepared.style.note_ink);
            assert!(contrast >= 4.5, "{light}: {contrast}");
        }
    }

    #[test]
    fn a_name_off_its_line_has_no_symbol_and_no_leader() {
        let mut composer = Composer::new(1920, 1080);
        let river = PictureLabel { kind: LabelKind::Water, ..label("Emory River", 400.0, 500.0) };
        let prepared = PreparedLabel::new(&river, &mut composer).expect("letters").without_symbol();
        let bare = |position: &LabelCandidate| position.symbol.is_none() && position.leader.is_none();
        assert!(prepared.positions.len() > 8 && prepared.positions.iter().all(bare));
        assert_eq!(prepared.request().reserved, None);
    }

    #[test]
    fn a_leader_goes_up_whatever_the_top_says() {
        for top in [Vec2::new(400.0, 900.0), Vec2::new(900.0, 499.0), Vec2::NAN, Vec2::new(400.0, 500.0)] {
            let odd = PictureLabel { top_px: Some(top), ..label("odd", 400.0, 500.0) };
            assert_eq!(reach(&odd, 40.0, 250.0), Vec2::new(0.0, -40.0), "{top}");
        }
        let long = PictureLabel { top_px: Some(Vec2::new(400.0, -9000.0)), ..label("long", 400.0, 500.0) };
        assert!((reach(&long, 40.0, 250.0) - Vec2::new(0.0, -250.0)).length() < 0.01);
    }
}
