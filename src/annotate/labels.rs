//! Labels: selection, style and placement.

use glam::Vec2;

use crate::annotate::annotation::PictureLabel;
use crate::annotate::composer::Composer;
use crate::annotate::drawing::{Drawing, polygon};
use crate::annotate::fonts::FontCut;
use crate::annotate::paragraph::{Paragraph, written_lines};
use crate::annotate::pixel_box::{PixelBox, PixelSegment};
use crate::annotate::place::{LabelCandidate, LabelField, LabelRequest, TextAlignment, place};
use crate::annotate::positions::LabelMetrics;
use crate::annotate::report::AnnotationReport;
use crate::annotate::sheet::{HALO, INK, PAPER, SOFT_INK, Sheet, WATER_INK};
use crate::annotate::text::{TextStyle, TypesetLine};
use crate::description::words::LabelKind;
use crate::draw::color::Srgba;

/// More labels are not tried: no picture has room for them, and the time grows with the square.
const MOST_LABELS: usize = 4096;
/// Lines of a label that are drawn; more would hide what they name.
const MOST_LINES: usize = 4;
/// The greatest width of a label's line, as a share of the picture's.
const WIDEST_SHARE: f32 = 0.33;
/// The longest leader line, as a share of the picture's height.
const LONGEST_LEADER_SHARE: f32 = 0.26;
/// From baseline to baseline, in ems of the lower line.
const LEADING: f32 = 1.16;

/// Draws the labels that are visible and find a free place beside `furniture`; reports the outcome of each.
pub fn draw_labels(
    labels: &[PictureLabel],
    furniture: &[PixelBox],
    composer: &mut Composer,
    report: &mut AnnotationReport,
) -> Drawing {
    let sheet = composer.sheet;
    let mut outcomes = vec![LabelOutcome::CrowdedOut; labels.len()];
    let mut prepared: Vec<PreparedLabel<'_>> = Vec::new();
    for (number, label) in by_importance(labels) {
        if !sheet.bounds().contains(label.anchor_px) {
            outcomes[number] = LabelOutcome::Outside;
        } else if !label.visible {
            outcomes[number] = LabelOutcome::Hidden;
        } else if prepared.len() < MOST_LABELS {
            match PreparedLabel::new(number, label, composer) {
                Ok(label) => prepared.push(label),
                Err(outcome) => outcomes[number] = outcome,
            }
        }
    }
    let requests: Vec<LabelRequest> = prepared.iter().map(PreparedLabel::request).collect();
    let field = field(furniture, &sheet);
    let choices = place(&requests, &field);
    let mut drawing = Drawing::default();
    let chosen = prepared.iter().zip(choices);
    let chosen: Vec<_> =
        chosen.filter_map(|(label, choice)| Some((label, label.positions[choice?]))).collect();
    // Symbols and leaders first, all texts over them.
    for (label, position) in &chosen {
        outcomes[label.number] = LabelOutcome::Placed;
        label.draw_symbol(position, &sheet, &mut drawing);
    }
    chosen.iter().for_each(|(label, position)| label.draw_text(position, &mut drawing));
    // In the order of the input.
    let mut in_order: Vec<_> = chosen.iter().map(|(label, _)| *label).collect();
    in_order.sort_by_key(|label| label.number);
    for label in in_order {
        drawing.record_text(&label.label.text, label.block.missing(), label.block.shortened);
    }
    report.add_texts(&drawing.texts);
    labels.iter().zip(outcomes).for_each(|(label, outcome)| outcome.report(&label.text, report));
    drawing
}

#[derive(Clone, Copy, Debug)]
enum LabelOutcome {
    Placed,
    Hidden,
    Outside,
    CrowdedOut,
    Empty,
}

impl LabelOutcome {
    fn report(self, text: &str, report: &mut AnnotationReport) {
        match self {
            Self::Placed => report.placed.push(text.to_owned()),
            Self::Hidden => report.hidden.push(text.to_owned()),
            Self::Outside => report.outside.push(text.to_owned()),
            Self::CrowdedOut => report.crowded_out.push(text.to_owned()),
            Self::Empty => report.empty += 1,
        }
    }
}

/// The field of labels: inside half of the margin, off the furniture.
fn field(furniture: &[PixelBox], sheet: &Sheet) -> LabelField {
    LabelField {
        bounds: sheet.bounds().grown(-(sheet.margin() * 0.4).round()),
        taken: furniture.iter().map(|taken| taken.grown(sheet.px(6.0))).collect(),
        leader_gap: sheet.px(5.0),
    }
}

/// Rank first, then kind, then the nearer, then by text; equal labels keep the input's order.
fn by_importance(labels: &[PictureLabel]) -> Vec<(usize, &PictureLabel)> {
    let by_kind = |kind| match kind {
        LabelKind::Summit => 0,
        LabelKind::Place => 1,
        LabelKind::Water => 2,
        LabelKind::Point => 3,
    };
    let mut order: Vec<_> = labels.iter().enumerate().collect();
    order.sort_by(|(_, a), (_, b)| {
        let by_rank = a.rank.total_cmp(&b.rank).then(by_kind(a.kind).cmp(&by_kind(b.kind)));
        by_rank.then(a.depth_m.total_cmp(&b.depth_m)).then_with(|| a.text.cmp(&b.text))
    });
    order
}

struct PreparedLabel<'a> {
    number: usize,
    label: &'a PictureLabel,
    style: LabelStyle,
    block: Paragraph,
    metrics: LabelMetrics,
    positions: Vec<LabelCandidate>,
}

impl<'a> PreparedLabel<'a> {
    fn new(number: usize, label: &'a PictureLabel, composer: &mut Composer) -> Result<Self, LabelOutcome> {
        let style = LabelStyle::new(label.kind, composer);
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
        Ok(Self { number, label, style, block, metrics, positions: metrics.positions() })
    }

    fn request(&self) -> LabelRequest {
        LabelRequest { candidates: self.positions.clone(), reserved: Some(self.metrics.symbol_box()) }
    }

    fn draw_symbol(&self, candidate: &LabelCandidate, sheet: &Sheet, drawing: &mut Drawing) {
        if let Some(line) = candidate.leader {
            let (line, width) = (uprighted(line), sheet.px(1.2).max(0.9));
            drawing.line(line, width + sheet.px(2.4).max(1.6), HALO);
            drawing.line(line, width, self.style.ink);
        }
        if candidate.symbol.is_some() {
            self.style.draw_symbol(self.label, sheet, drawing);
        }
    }

    /// Writes the text: all halos first, for the name's must not cover the height below it.
    fn draw_text(&self, position: &LabelCandidate, drawing: &mut Drawing) {
        let text = self.metrics.texts[position.alignment as usize];
        let by = (position.text.min - text.min).round();
        let mut lines = baselines(&self.block.lines, position.alignment);
        lines.iter_mut().for_each(|(_, at)| *at += by);
        drawing.draw_halo(&lines, self.style.halo);
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

struct LabelStyle {
    name: TextStyle,
    note: TextStyle,
    ink: Srgba,
    note_ink: Srgba,
    halo: f32,
    /// Half the size of the symbol.
    symbol: f32,
    leader: f32,
}

impl LabelStyle {
    fn new(kind: LabelKind, composer: &Composer) -> Self {
        let sheet = composer.sheet;
        let (size, cut, symbol, leader) = match kind {
            LabelKind::Summit => (20.0, FontCut::Bold, 6.0, 44.0),
            LabelKind::Place => (19.0, FontCut::Bold, 4.5, 34.0),
            LabelKind::Water => (19.0, FontCut::Italic, 3.0, 34.0),
            LabelKind::Point => (16.5, FontCut::Medium, 3.2, 26.0),
        };
        let (note_cut, tracking, ink, note_ink) = match kind {
            LabelKind::Water => (FontCut::Italic, 0.06, WATER_INK, WATER_INK),
            _ => (FontCut::Medium, 0.0, INK, SOFT_INK),
        };
        let tracked = |style: TextStyle| TextStyle { tracking, ..style };
        Self {
            name: tracked(composer.style(size, cut)),
            note: tracked(composer.style(size * 0.8, note_cut)),
            ink,
            note_ink,
            halo: sheet.px(2.2).max(1.5),
            symbol: sheet.px(symbol).max(2.6),
            leader: sheet.px(leader),
        }
    }

    fn draw_symbol(&self, label: &PictureLabel, sheet: &Sheet, drawing: &mut Drawing) {
        let (at, size, reach) = (pixel_center(label.anchor_px), self.symbol, self.halo * 0.8);
        if label.kind == LabelKind::Summit {
            let corners = [(0.0, -1.0), (0.95, 0.72), (-0.95, 0.72)];
            if let Some(triangle) = polygon(&corners.map(|(x, y)| at + Vec2::new(x, y) * size)) {
                drawing.fill_haloed(triangle, self.ink, reach);
            }
            return;
        }
        drawing.disc(at, size + reach, HALO);
        drawing.disc(at, size, self.ink);
        if label.kind == LabelKind::Place {
            drawing.disc(at, size - sheet.px(1.6).max(1.0), PAPER);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn label(text: &str, x: f32, y: f32) -> PictureLabel {
        let anchor_px = Vec2::new(x, y);
        let text = text.to_owned();
        PictureLabel {
            text,
            anchor_px,
            top_px: None,
            depth_m: 1000.0,
            visible: true,
            kind: LabelKind::Place,
            rank: 0.0,
        }
    }

    fn draw(labels: &[PictureLabel]) -> (Drawing, AnnotationReport) {
        let mut report = AnnotationReport::default();
        let drawing = draw_labels(labels, &[], &mut Composer::new(1920, 1080), &mut report);
        (drawing, report)
    }

    #[test]
    fn every_label_ends_in_exactly_one_list() {
        let labels = [
            label("seen", 400.0, 500.0),
            label("the same spot", 400.0, 500.0),
            PictureLabel { visible: false, ..label("behind the ridge", 800.0, 500.0) },
            label("off the sheet", -10.0, 500.0),
            label("nowhere", f32::NAN, 500.0),
            label(" \n ", 900.0, 500.0),
        ];
        let (_, report) = draw(&labels);
        assert_eq!(report.placed, ["seen"]);
        assert_eq!(report.crowded_out, ["the same spot"]);
        assert_eq!(report.hidden, ["behind the ridge"]);
        assert_eq!(report.outside, ["off the sheet", "nowhere"]);
        assert_eq!(report.empty, 1);
    }

    #[test]
    fn lower_ranks_go_first_then_summits_before_places_and_near_before_far() {
        let far = PictureLabel { depth_m: 9000.0, ..label("far", 400.0, 500.0) };
        let near = PictureLabel { depth_m: 900.0, ..label("near", 402.0, 500.0) };
        let summit = PictureLabel { kind: LabelKind::Summit, depth_m: 99e3, ..label("summit", 404.0, 500.0) };
        assert_eq!(draw(&[far.clone(), near.clone()]).1.placed, ["near"]);
        assert_eq!(draw(&[far.clone(), near.clone(), summit.clone()]).1.placed, ["summit"]);
        let [near, summit] = [near, summit].map(|label| PictureLabel { rank: 1.0, ..label });
        assert_eq!(draw(&[near, summit, far]).1.placed, ["far"], "whatever is of a lower rank");
    }

    #[test]
    fn the_order_of_the_input_does_not_matter() {
        let mut labels: Vec<_> =
            (0..40).map(|n| label(&format!("No {n}"), 300.0 + 37.0 * (n % 9) as f32, 500.0)).collect();
        let forth = draw(&labels).0.marks;
        labels.reverse();
        assert_eq!(draw(&labels).0.marks, forth);
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

    #[test]
    fn what_is_drawn_stays_inside_the_picture() {
        let labels: Vec<_> =
            (0..60).map(|n| label("At the border", 33.0 * n as f32, 18.5 * n as f32)).collect();
        let bounds = draw(&labels).0.bounds();
        assert!(Sheet::new(1920, 1080).bounds().holds(&bounds), "{bounds:?}");
    }

    #[test]
    fn a_label_as_long_as_a_book_is_cut_and_says_so() {
        let (drawing, report) = draw(&[label(&"word ".repeat(5000), 900.0, 500.0)]);
        assert_eq!((report.placed.len(), report.shortened.len()), (1, 1));
        assert!(drawing.bounds().size().x < 1920.0 * 0.4);
    }
}
